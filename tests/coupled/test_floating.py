"""A floating support: a moored hull that carries other floats' hinges."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.boundary import coefficients as solved
from solver.coupled.preparation import prepare
from solver.coupled.system import BALANCE
from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.oddities import warnings
from solver.run import simulate
from solver.scene import Float, Platform, Scene, Settings, Water
from solver.sea.realization import CALM, realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.awkward import prism, sea
from tests.awkward import scene as awkward_scene
from tests.once import solve
from tests.reference.test_reference import FINE, HULL, alike, apart, both, pile
from tests.test_invariants import alone

COLUMN = Revolution.vertical_cylinder(radius=3.0, draft=3.0, freeboard=2.0)
WATER = Water(depth=100.0)
MASS = WATER.density * COLUMN.volume
MOORED = (2e5, 0.0, 0.0)
SEA = realize(PiersonMoskowitz(Hs=0.8, Tp=5.46), components=60, band=(0.7, 3.4), seed=3)


@pytest.fixture(scope="module")
def coefficients():
    omega = np.concatenate([np.linspace(0.4, 4.0, 13), np.linspace(4.7, 6.0, 3)])  # higher ones ask for more panels
    hulls, centres = (COLUMN, HULL), np.array([[0.0, 0, 0], [-6.0, 0, 0]])
    return solve(hulls, centres, depth=WATER.depth, omega=omega, panels=108)


def base(**more):
    common = {"motion": ("surge", "heave", "pitch"), "stiffness": MOORED, **more}
    return Float(name="base", hull=COLUMN, mass=MASS, inertia=(5e5,) * 3, cog=(0, 0, -1.0), hinge=(0, 0, 0), **common)


def arm(**more):
    common = {"on": "base", "pto_damping": 2e4, "mass": 2147.0, "inertia": (859.0,) * 3, **more}
    return Float(name="arm", hull=HULL, hinge=(-2.0, 0, 2.6), arm=(-4.0, 0, -2.6), **common)


def scene(*floats, sea=SEA, **settings):
    options = {**FINE, "duration": 4.0, "time_step": 0.05, **settings}
    return Scene(water=WATER, sea=sea, floats=floats or (base(), arm()), settings=Settings(**options))


@pytest.mark.parametrize("joint", [{}, pytest.param({"motion": ("heave",), "stiffness": 3e4}, marks=pytest.mark.slow)])
def test_fast_and_reference_path_agree(coefficients, joint):
    """Shared coordinates in the one, six DOF a body with multipliers in the other."""
    item = scene(base(), arm(**joint))
    fast, slow = both(item, coefficients, **alike(item, coefficients))
    for name in set(fast) & {"rotation", "motion", "absorbed_power", "hinge_force"}:
        assert apart(name, slow, fast) < 2e-5


def test_mooring_alone_holds_what_floats(coefficients):
    """The joint of the platform bears its springs alone: -k x in surge, nothing in heave."""
    series = {name: values for name, (_, values) in simulate(scene(), coefficients).series.items()}
    surge, force = series["motion"][:, 0, 0], series["hinge_force"][:, 0]
    assert force[:, 0] == approx(-MOORED[0] * surge, abs=1e-6 * np.abs(force[:, 0]).max() + 1e-3)
    assert np.abs(force[:, 2]).max() < 1e-6 * np.abs(series["hinge_force"][:, 1, 2]).max() + 1e-2


def test_held_fast_it_is_a_fixed_support(coefficients):
    held = base(stiffness=(1e10, 1e10, 1e11))
    on_it, on_ground = (simulate(scene(held, item), coefficients) for item in (arm(), arm(on="")))
    (_, a), (_, b) = (r.series["hinge_force"] for r in (on_it, on_ground))
    assert a[:, 1] == approx(b[:, 1], abs=1e-4 * np.abs(b[:, 1]).max())


def test_record_closes_and_the_hinge_stays_closed(coefficients):
    attrs = simulate(scene(duration=60.0, time_step=0.2, newton_tolerance=1e-5), coefficients).attrs
    assert attrs["energy_residual"] < 1e-3 and attrs["constraint_drift"] < 1e-9


def test_still_water_leaves_it_at_rest_and_loads_on_board_are_balanced(coefficients):
    record = simulate(scene(sea=CALM), coefficients)
    assert np.nanmax(np.ptp(record.series["motion"][1], axis=0)) < 1e-9
    assert warnings(scene(duration=60.0)) == ()
    heavy = scene(base(), arm(mass=9000.0))
    assert any(text.startswith("floats.base is out of equilibrium") for text in warnings(heavy))


STILL = {
    "float on board": (base(), arm()),
    "float in equilibrium elsewhere": (base(), arm(mass=4000.0)),
    "centre of gravity beside the centre": (
        replace(base(motion=("heave", "pitch"), stiffness=0.0), cog=(0.3, 0, -1)),
        arm(),
    ),
}


def shaken(h, size, seed):
    """Coefficients whose last bits are others, as another processor would have them."""
    random, names = np.random.default_rng(seed), ("added_mass", "added_mass_inf", "radiation_damping")
    matrices = {name: getattr(h, name) for name in (*names, "hydrostatic_stiffness")}
    return replace(h, **{name: x * (1 + size * random.normal(size=x.shape)) for name, x in matrices.items()})


@pytest.mark.parametrize(
    "settings", [pytest.param({"duration": 60.0}, marks=pytest.mark.slow), {"newton_tolerance": 1e-5, "time_step": 0.2}]
)
@pytest.mark.parametrize("name", STILL)
def test_rest_is_no_failure_whatever_the_last_bits(coefficients, name, settings):
    """Where next to nothing is exchanged the balance is judged against what Newton's tolerance and rounding leave.

    The drift is theirs too: where nothing holds the float an acceleration of 1e-12 g, for a minute.
    """
    for size in (0.0, 1e-15, 1e-14, 1e-13, 1e-12):
        other = shaken(coefficients, size, seed=round(1e15 * size))
        record = simulate(scene(*STILL[name], sea=CALM, **settings), other)
        assert record.attrs["repeated"] == ""
        assert np.nanmax(np.ptp(record.series["motion"][1], axis=0)) < 2e-8


def test_rest_of_what_only_turns(coefficients):
    """Of the hull's stiffness in pitch the weight's part is not in Newton's matrix, and the rest is negative."""
    turning = base(motion=("pitch",), stiffness=0.0)
    record = simulate(scene(turning, sea=CALM, newton_tolerance=1e-5, duration=20.0), alone(coefficients, 0))
    assert record.attrs["repeated"] == "" and record.attrs["energy_residual"] < 1e-4


def test_rest_of_what_nothing_holds_needs_no_coefficients():
    free = base(motion=("surge", "sway", "heave", "roll", "pitch", "yaw"), stiffness=0.0)
    record = simulate(scene(free, sea=CALM, radiation=False, diffraction=False, duration=200.0))
    assert record.attrs["repeated"] == "" and record.attrs["energy_residual"] < 1e-4


def test_rounding_of_the_stored_energy_is_never_an_open_balance(coefficients):
    """A float deep in the water stores 1e5 times what a metre of its weight would: 1e-16 of it are many bits."""
    for depth in (0.0, -1.0, -1e3):
        deep = prepare(scene(replace(base(), cog=(0, 0, depth)), arm(), sea=CALM), coefficients)
        stored = abs(deep.start().energy[0])
        assert BALANCE * deep.least_energy() > 100 * np.finfo(float).eps * stored


def test_mooring_is_in_newtons_matrix_without_coefficients_too():
    """A spring and a mass: fourth order leaves 1e-9 of the energy, where a frozen spring would show."""
    item = scene(base(motion=("surge",), stiffness=2e5, offset=0.01), sea=CALM, radiation=False, diffraction=False)
    coarse = replace(item, settings=replace(item.settings, newton_tolerance=1e-5, time_step=0.2, duration=200.0))
    attrs = simulate(coarse).attrs
    assert attrs["repeated"] == "" and attrs["energy_residual"] < 1e-6


def test_what_cannot_be_carried_is_refused():
    with pytest.raises(InputError, match=r"floats\.arm\.on = elsewhere: must name a float that is listed before"):
        scene(base(), arm(on="elsewhere"))
    with pytest.raises(InputError, match=r"floats\.arm\.on = base: must name a float that is listed before"):
        scene(arm(), base())
    nodes = {"base": "h1", "arm": "h2"}
    with pytest.raises(InputError, match=r"floats\.arm\.on = base: must be empty"):
        replace(scene(), platform=Platform(frame=pile(), hinge_nodes=nodes))


@pytest.mark.parametrize("length", [0.2, 1.0, 400.0])
def test_rest_goes_with_the_scale(length):
    """A soft mooring's shift under 1e-5 of the weight, and the list of a hull that is not stable upright."""
    l = length
    hull = prism([(-0.5 * l, -0.15 * l), (0.5 * l, -0.15 * l), (0.5 * l, 0.1 * l), (-0.5 * l, 0.1 * l)], 0.3 * l)
    mass = 1025.0 * hull.volume
    soft, push = mass * (2 * np.pi / 30) ** 2 / l, 1e-5 * mass * 9.81

    def rest(height, aside=0.0, **joint):
        item = Float(
            name="hull", hull=hull, mass=mass, inertia=tuple(mass * (k * l) ** 2 for k in (0.1, 0.28, 0.28)),
            hinge=(0, 0, 0), cog=(0, aside * l, height * l), **joint,
        )  # fmt: skip
        given = {"radiation": False, "diffraction": False, "duration": 5 * l**0.5}
        waves = sea(Hs=0.01 * l, Tp=1.2 * l**0.5, band=(4 / l**0.5, 12 / l**0.5))
        whole = awkward_scene([item], depth=3 * l, waves=waves, **given)
        return prepare(whole, solved(whole)).joints_at_rest

    surge = rest(-0.03, motion=("surge", "heave", "pitch"), stiffness=(soft, 0, 0), preload=(push, 0, 0))[0]
    assert surge / l == approx(push / soft / l, rel=1e-6)
    roll = rest(-0.024, 1e-4, motion=("sway", "heave", "roll"))[2]
    assert abs(roll) == approx(0.234, abs=2e-3)


@pytest.mark.parametrize("held", [1e4, 1e7])
def test_a_soft_mooring_rests_as_it_does_beside_what_is_held_stiffly(held):
    """A barge of 91 t that swings in 300 s, pushed by half a metre, and a light float on a spring."""
    hull, ball = prism([(-5, -1.2), (5, -1.2), (5, 1.0), (-5, 1.0)], 8.0), Revolution.sphere(radius=0.36, draft=0.36)
    mass = 1025.0 * hull.volume
    soft = mass * (2 * np.pi / 300) ** 2
    barge = Float(
        name="barge", hull=hull, mass=mass, inertia=(8e5, 1.2e6, 1.6e6), hinge=(0, 0, 0), cog=(0, 0, -0.3),
        motion=("surge", "heave", "pitch"), stiffness=(soft, 0, 0), preload=(0.5 * soft, 0, 0),
    )  # fmt: skip
    light = Float(
        name="light", hull=ball, mass=1025.0 * ball.volume, inertia=(5.0,) * 3, hinge=(12.0, 0, 0), motion=("heave",),
        stiffness=held,
    )  # fmt: skip
    whole = awkward_scene([barge, light], radiation=False, diffraction=False)
    assert prepare(whole, solved(whole)).joints_at_rest[:2] == approx([0.5, 0.0], abs=1e-9)
