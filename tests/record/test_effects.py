"""What errors of coefficients do is asked of a model whose joints move as their bent laws let them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.linear import impedance, linear_model
from solver.coupled.moving import force_of_waves, moving_model
from solver.coupled.preparation import prepare
from solver.frequency.response import respond
from solver.hydrodynamics.hull.revolution import Revolution
from solver.power_takeoff import PtoTable
from solver.record import refit
from solver.record.effects import coefficient_effects, force_error
from solver.run import simulate
from solver.scene import EndStops, Float
from solver.sea.realization import CALM, regular
from tests.awkward import RHO, SCENES, known, prism, scene, sea
from tests.frequency.test_linearised import given, hemisphere, hinged, pair


def effects(build, law, *, one=False):
    item, h = given(build, law, one=one)
    return coefficient_effects(prepare(item, h), h)


def added(build, law, *, one=False):
    """Damping (nj,) that joints have beyond that at rest."""
    item, h = given(build, law, one=one)
    system = prepare(item, h)
    return np.diag(moving_model(system, h).damping - linear_model(system).damping)


@pytest.mark.parametrize("one", [False, True], ids=["sea", "wave"])
@pytest.mark.parametrize("build", [pair, hemisphere])
def test_a_joint_that_friction_locks_is_as_good_as_held(build, one):
    stuck, held, free = (effects(build, law, one=one) for law in ({"coulomb": 1e9}, {"pto_damping": 1e14}, {}))
    assert stuck == approx(held, rel=1e-2, abs=1e-9)
    assert build is hemisphere or abs(free[1] / held[1] - 1) > 0.1


@pytest.mark.parametrize("one", [False, True], ids=["sea", "wave"])
def test_a_damper_that_a_limit_lets_go_is_as_good_as_none(one):
    let_go, free = (
        effects(hemisphere, law, one=one) for law in ({"pto_damping": 1e9, "force_limit": 1.0}, {"pto_damping": 1.0})
    )
    assert let_go == approx(free, rel=1e-2)


@pytest.mark.parametrize("one", [False, True], ids=["sea", "wave"])
@pytest.mark.parametrize(("build", "law"), [
    (hemisphere, {"coulomb": 1e4}), (pair, {"coulomb": 2e4}), (hinged, {"pto_damping": 2e5, "force_limit": 3e3}),
])  # fmt: skip
def test_joints_are_damped_as_in_the_frequency_domain(build, law, one):
    item, h = given(build, law, one=one)
    lines = respond(replace(item, settings=replace(item.settings, method="frequency")), h)
    usual = np.array([f.per_axis("pto_damping")[0] for f in item.floats])
    # There by rates of the shape that friction makes: up to a twentieth less.
    assert added(build, law, one=one) == approx(lines.pto - usual, rel=2e-2 if one else 6e-2, abs=1.0)


@pytest.mark.parametrize("waves", [60, 1])
@pytest.mark.parametrize(
    "quadratic", [(1e5, 1e8), *(pytest.param(law, marks=pytest.mark.slow) for law in [(1e5, 1e6), (1e6, 1e7)])]
)
def test_what_a_mesh_does_where_quadratic_damping_bounds_a_resonance_is_the_frequency_domains(quadratic, waves):
    """A buoy that hardly radiates as it pitches, which linear damping alone would let swing by ten times as much."""
    hull = Revolution.vertical_cylinder(radius=3.0, draft=3.0, freeboard=3.0)
    item = Float(
        name="buoy", hull=hull, mass=RHO * hull.volume, inertia=(2e5,) * 3, hinge=(0, 0, 0), cog=(0, 0, -1.0),
        motion=("heave", "pitch"), quadratic_damping=quadratic,
    )  # fmt: skip
    item = scene([item], waves=sea(Hs=0.5, Tp=6.0, band=(0.4, 3.0)), depth=40.0, froude_krylov="linear")
    if waves == 1:
        item = replace(item, sea=regular(height=0.3, period=8.8))
    h = known(item, 0.3, 6.0, 40)
    lines = simulate(replace(item, settings=replace(item.settings, method="frequency")), h)
    assert coefficient_effects(prepare(item, h), h)[1] == approx(
        lines.attrs["mesh_effect"], rel=3e-2 if waves == 1 else 8e-2
    )


@pytest.mark.parametrize("law", [{"coulomb": 1e4}, {"quadratic_damping": 1e5}])
def test_waves_without_height_are_none(law):
    """One wave beside some of zero is one wave, whose linear damper is not a sea's."""
    item, h = given(hemisphere, law, one=True)
    omega = np.array([0.9, 1.0, 1.1]) * item.sea.omega[0]
    among = replace(item, sea=replace(item.sea, omega=omega, amplitude=np.array([0, item.sea.amplitude[0], 0])))
    alone, beside = (moving_model(prepare(each, h), h).damping for each in (item, among))
    assert beside == approx(alone, rel=1e-9)


def test_of_a_law_for_one_sense_half_is_left():
    assert added(hemisphere, {"coulomb": 2e4, "one_way": 1.0}) == approx(added(hemisphere, {"coulomb": 1e4}), rel=1e-2)


@pytest.mark.parametrize("law", [
    {"damping": 1e4}, {"end_stops": EndStops(lower=-1.0, upper=1.0, stiffness=1e6)},
    {"pto_table": PtoTable(position=(-1.0, 1.0), velocity=(-1.0, 0.0, 1.0), force=(-1e4, 0, 2e4, -3e4, 0, 1e4))},
    {"latch_load": 1e4},
])  # fmt: skip
def test_other_laws_have_the_model_of_before(law):
    item, h = given(hemisphere, law, one=False)
    system = prepare(item, h)
    assert moving_model(system, h) is linear_model(system)


@pytest.mark.parametrize(("one", "lower", "upper"), [(False, -0.05, 0.2), (True, -0.05, 0.2), (False, -1e9, 0.05)])
def test_end_stops_bound_what_the_model_moves(one, lower, upper):
    item, h = given(hemisphere, {"end_stops": EndStops(lower=lower, upper=upper, stiffness=1e6)}, one=one)
    system = prepare(item, h)
    X = moving_model(system, h).response(
        item.sea.omega, impedance(system, h, item.sea.omega), force_of_waves(system, h)
    )
    assert np.linalg.norm(X) == approx(0.05, rel=0.05)


def test_what_rests_on_its_stop_moves_next_to_nothing():
    item, h = given(hemisphere, {"end_stops": EndStops(lower=0.0, upper=1.0, stiffness=1e6)}, one=False)
    system, omega = prepare(item, h), item.sea.omega
    free, bound = (
        np.linalg.norm(model.response(omega, impedance(system, h, omega), force_of_waves(system, h)))
        for model in (linear_model(system), moving_model(system, h))
    )
    assert 0 < bound < 0.02 * free


def test_a_latch_holds_until_waves_tear_it_off():
    stuck, held = (effects(hemisphere, law) for law in ({"latch_load": 1e9}, {"damping": 1e14}))
    assert stuck == approx(held, rel=1e-2, abs=1e-7)


def test_forces_of_a_small_float_count_beside_a_large_one():
    """A joint that bears 1e-4 of what another does, off by a tenth; what it hardly bears itself counts as zero."""
    water, floats = SimpleNamespace(gravity=9.81), (SimpleNamespace(mass=1e6), SimpleNamespace(mass=1.0))
    system = SimpleNamespace(scene=SimpleNamespace(water=water, floats=floats))
    exact = np.array([[[1e5, 1e5, 2e5], [0.0, 10.0, 20.0]]]) + 0j
    of_small, of_large = np.array([[[[0.0, 0.0, 0.0], [0.001, 0.0, 2.0]]], [[[3.0, 0.0, 0.0], [0.0, 0.0, 0.0]]]])
    assert force_error(system, exact + of_small, exact) == approx(0.1)
    assert force_error(system, exact + of_large, exact) == approx(3e-5)


def test_still_water_moves_nothing():
    item, h = given(hemisphere, {"coulomb": 1e4}, one=False)
    system = prepare(replace(item, sea=CALM), h)
    assert moving_model(system, h) is linear_model(system)


def test_friction_holds_a_platforms_float():
    """The modes are solved for apart, and keep their own damping."""
    whole, h = SCENES["unequal_legs"]()
    law = {"pto_damping": 0.0, "coulomb": 1e9}
    system = prepare(replace(whole, floats=(replace(whole.floats[0], **law),)), h)
    model, usual = moving_model(system, h), linear_model(system)
    assert np.array_equal(model.modes, usual.modes) and np.array_equal(model.floats[::2], usual.floats[::2])
    more = model.damping - usual.damping
    assert more[-1, -1] > 1e9 and np.all(np.delete(more.ravel(), -1) == 0)


def test_a_memory_is_not_fitted_again_to_what_friction_holds():
    item, h = SCENES["flap"]()
    body, settings = replace(item.floats[0], pto_damping=0.0), replace(item.settings, froude_krylov="linear")
    item = replace(item, floats=(body,), settings=settings)
    braked, usual = replace(item, floats=(replace(body, coulomb=1e9),)), prepare(item, h).fit
    assert refit._swayed(prepare(item, h), h) > refit.SWAYED and refit._swayed(prepare(braked, h), h) < 1e-6
    assert refit.prepared(item, h).fit is not usual and refit.prepared(braked, h).fit is usual


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_errors_of_forces_that_are_those_of_radiation_cancel(method):
    """A long barge in beam seas goes with its water: of its roll 3.4 % were told, by the error of forces alone."""
    hull = prism([(-11, -1.5), (11, -1.5), (11, 1.3), (-11, 1.3)], 5.5)
    m = RHO * hull.volume
    barge = Float(
        name="barge", hull=hull, mass=m, inertia=(3.6 * m, 42 * m, 43 * m), hinge=(0, 0, 0), cog=(0, 0, 0.25),
        motion=("sway", "heave", "roll"), stiffness=(5e4, 0, 0), damping=(2e4, 0, 0), quadratic_damping=(0, 0, 9e5),
        pto_damping=(0, 3e4, 0),
    )  # fmt: skip
    waves = sea(Hs=0.6, Tp=5.5, band=(0.6, 2.4), heading=np.pi / 2, seed=9)
    item = scene([barge], depth=25.0, waves=waves, froude_krylov="linear")
    ours, fine = (known(item, 0.3, 3.6, panels=panels) for panels in (108, 432))
    lines = replace(item, settings=replace(item.settings, method="frequency"))
    coarse, exact = (simulate(lines, h) for h in (ours, fine))
    motion, true = (r.variables["motion"][1][..., 4] for r in (coarse, exact))
    power, best = (r.variables["absorbed_power"][1][..., 2] for r in (coarse, exact))
    off = np.nanmax(np.abs(np.append(motion / true, power[best > 0] / best[best > 0]) - 1))
    told = coarse.attrs["mesh_effect"] if method == "frequency" else coefficient_effects(prepare(item, ours), ours)[1]
    assert 1 / 3 < off / told < 3 and off > 2e-3, (off, told)
