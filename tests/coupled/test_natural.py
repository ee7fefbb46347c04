"""Natural periods and shapes of the coupled system, critical damping, and equilibria that fall over."""

import re
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.interpolate import CubicSpline

from solver.coupled import equilibrium
from solver.coupled.blocks import _stability
from solver.coupled.equilibrium import righting
from solver.coupled.linear import linear_model
from solver.coupled.natural import (
    _in_water,
    _settled,
    _system_modes,
    _Undamped,
    require_stable,
    system_modes,
    with_critical_damping,
    with_usual_step,
)
from solver.coupled.preparation import prepare
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.hull.revolution import Revolution
from solver.keys import Bits
from solver.power_takeoff import PtoTable
from solver.run import simulate
from solver.scene import Float, Platform, two_digits
from solver.sea.current import Current
from solver.sea.realization import CALM
from solver.structure.frame import Frame
from solver.structure.load_history import LoadHistory
from solver.structure.members import Member, PointLoad, PointMass
from solver.structure.sections import tube
from tests.awkward import BUOYED, RHO, SCENES, STEEL, prism, scene
from tests.coupled.test_linear import hinged_by_hand


def linear(item):
    return replace(item, settings=replace(item.settings, froude_krylov="linear"))


def stepped(system, h):
    return with_usual_step(system, system_modes(system, h))


def modes(item, h):
    return system_modes(prepare(linear(item), h), h)


@pytest.mark.parametrize("name", ["duck", "flap", "big_beside_small", "model_scale"])
def test_periods_are_those_of_coefficients_alone(name):
    """det(C - ω²(M + A(ω))) = 0, and the shape is its null vector."""
    item, h = SCENES[name]()
    J, M, C = hinged_by_hand(item, h)
    A = CubicSpline(h.omega, h.added_mass)
    natural = modes(item, h)
    for omega, shape in zip(natural.omega, natural.shapes.T, strict=True):
        inside = np.clip(omega, *h.omega[[0, -1]])
        residual = (C - omega**2 * (M + J.T @ A(inside) @ J)) @ shape
        assert residual == approx(0, abs=1e-6 * np.abs(C @ shape).max())


@pytest.mark.parametrize("name", ["duck", "unequal_legs"])
def test_a_mass_that_is_not_above_zero_is_named(name):
    item, h = SCENES[name]()
    light = replace(h, added_mass_inf=h.added_mass_inf - 1e3 * np.diag(np.abs(np.diag(h.added_mass_inf))), memory=None)
    with pytest.raises(
        SimulationFailed, match=rf"the mass that moves in {item.floats[0].name} hinge.* is not above zero"
    ):
        modes(item, light)


def test_a_shape_is_named_by_what_moves():
    item, h = SCENES["oblique"]()
    assert all(name.split(" hinge")[0] in "ab" for name in modes(item, h).names)
    item, h = SCENES["unequal_legs"]()
    natural = modes(item, h)
    assert natural.omega.size == 1 + 6
    assert natural.names[0] == "float hinge"
    assert sum(name.startswith("platform") for name in natural.names) == 6
    barge, h = SCENES["soft_mooring"]()
    assert modes(barge, h).names[0].startswith("barge surge")


def test_what_nothing_holds_has_no_period():
    barge, h = SCENES["soft_mooring"]()
    loose = replace(barge, floats=(replace(barge.floats[0], stiffness=0.0),))
    assert modes(loose, h).omega[0] < 1e-3 * modes(loose, h).omega[1]


def test_what_nothing_holds_is_known_whatever_rounding_leaves_of_it():
    """Of six axes that mass and stiffness couple, one combination is held by nothing: ω is 0, no root of 1e-17."""
    random = np.random.default_rng(2)
    for _ in range(20):
        mix, free = random.normal(size=(2, 6, 6))
        mass, stiffness = free @ free.T + np.eye(6), mix.T @ np.diag([0.0, 1e-4, 1.0, 2.0, 3.0, 4.0]) @ mix
        undamped = _Undamped((stiffness + stiffness.T) / 2, mass, np.zeros((0, 6)), np.ones(6), np.zeros((0, 0)))
        found = _system_modes(Bits(undamped), None, tuple("abcdef"), None)
        assert found.omega[0] == 0.0 and np.isinf(found.period[0]) and found.omega[1] > 0.0


def test_platform_alone_has_the_frames_own_frequencies():
    bare, _ = SCENES["bare_legs"]()
    system = prepare(bare, None)
    assert modes(bare, None).omega == approx(np.sort(system.structure.omega)[:6])


@pytest.mark.parametrize(("name", "ratio"), [("duck", 0.6), ("flap", 0.3), ("model_scale", 0.5)])
def test_critical_damping_damps_by_as_much(name, ratio):
    """The roots of C - iω(B + b) - ω²(M + A) = 0 with A and b of ω₀ have |Im ω| = κω₀."""
    item, h = SCENES[name]()
    asked = replace(item.floats[0], pto_damping=0.0, damping=0.0, critical_damping=ratio)
    damped = with_critical_damping(linear(replace(item, floats=(asked,))), h)
    J, M, C = hinged_by_hand(item, h)
    (omega,) = modes(item, h).omega
    A, b = (CubicSpline(h.omega, x)(np.clip(omega, *h.omega[[0, -1]])) for x in (h.added_mass, h.radiation_damping))
    mass, radiated = (M + J.T @ A @ J)[0, 0], (J.T @ b @ J)[0, 0]
    (total,) = damped.floats[0].per_axis("damping") + radiated
    assert total / (2 * np.sqrt(mass * C[0, 0])) == approx(ratio, rel=1e-6)
    assert not np.any(damped.floats[0].critical_damping)


def test_critical_damping_does_not_hang_on_rounding_where_added_mass_rings():
    """Frequency and added mass in turn would go round: where A rises faster than 2(M + A)/ω, that is no contraction."""
    item, h = SCENES["flap"]()
    J, M, C = hinged_by_hand(item, h)
    mass = (M + J.T @ h.added_mass_inf @ J)[0, 0]
    ringing = 0.9 * mass * np.sin(np.pi / 2 * np.arange(h.omega.size)) / (J.T @ J)[0, 0]
    h = replace(h, added_mass=h.added_mass + ringing[:, None, None] * np.eye(len(h.added_mass_inf)))
    damping = []
    for off in (0.0, 1e-9):
        f = replace(item.floats[0], pto_damping=0.0, critical_damping=3.0, stiffness=2 * C[0, 0] * (1 + off))
        (total,) = with_critical_damping(linear(replace(item, floats=(f,))), h).floats[0].per_axis("damping")
        damping.append(total)
    assert damping[1] == approx(damping[0], rel=1e-6)
    curves = (CubicSpline(h.omega, x) for x in (h.added_mass, h.radiation_damping))
    grid = np.linspace(*h.omega[[0, -1]], 20001)
    A, b = ((J.T @ curve(grid) @ J)[:, 0, 0] for curve in curves)
    own = np.abs((damping[0] + b) / (2 * 3.0 * (M[0, 0] + A) * grid) - 1)
    restored = np.abs((M[0, 0] + A) * grid**2 / (3 * C[0, 0]) - 1)
    assert np.min(own + restored) < 1e-2


def test_critical_damping_is_what_a_decay_shows():
    """Let go, two extremes of one sign fall by exp(-2πκ/√(1 - κ²)); what else there is of radiation is in κ."""
    item, h = SCENES["model_scale"]()
    time = np.sqrt(1 / 20)
    held = replace(item.floats[0], pto_damping=0.0, critical_damping=0.35, offset=0.002)
    settings = replace(
        item.settings, froude_krylov="linear", keep_series=True, duration=40 * time, discard=0.0, ramp=0.0,
        newton_tolerance=1e-9, memory_tolerance=1e-3, time_step=0.1 * time,
    )  # fmt: skip
    record = simulate(replace(item, floats=(held,), sea=CALM, settings=settings), h)
    y = record.series["rotation"][1][:, 0]
    inner = y[1:-1]
    peaks = np.abs(inner[(np.abs(inner) > np.abs(y[:-2])) & (np.abs(inner) >= np.abs(y[2:]))])
    assert peaks[1] / peaks[0] == approx(np.exp(-np.pi * 0.35 / np.sqrt(1 - 0.35**2)), rel=0.15)


def test_damping_that_radiation_exceeds_or_nothing_restores_is_refused():
    item, h = SCENES["model_scale"]()
    little = replace(item.floats[0], critical_damping=1e-3)
    with pytest.raises(InputError, match=r"model\.critical_damping = 0\.001: must be >= 0\.\d+: radiation alone"):
        with_critical_damping(linear(replace(item, floats=(little,))), h)
    barge, h = SCENES["soft_mooring"]()
    loose = replace(barge.floats[0], stiffness=0.0, critical_damping=(0.1, 0, 0))
    with pytest.raises(InputError, match=r"critical_damping of surge = 0\.1: needs an axis that something restores"):
        with_critical_damping(linear(replace(barge, floats=(loose,))), h)


@pytest.mark.parametrize("pressure", ["linear", "body-nonlinear"])
def test_a_barge_with_its_weight_too_high_is_refused(pressure):
    """GM = B²/12T - T/2 + ... < 0 by the position of the centre of gravity alone: 6 m² / 1.2 m above the keel."""
    hull = prism([(-2, -1.2), (2, -1.2), (2, 4.0), (-2, 4.0)], 8.0)
    metacentre = -0.6 + 4.0**2 / 12 / 1.2
    barges = [
        Float(
            name="barge", hull=hull, mass=RHO * hull.volume, inertia=(8e5, 6e5, 8e5), hinge=(0, 0, 0),
            motion=("heave", "pitch"), cog=(0, 0, metacentre + above),
        )
        for above in (-0.05, 0.05)
    ]  # fmt: skip
    _, h = SCENES["soft_mooring"]()
    stiff = [h.density * h.gravity * 8.0 * 4.0, h.density * h.gravity * hull.volume * metacentre]
    known = replace(h, hydrostatic_stiffness=np.diag([0.0, *stiff]), displaced_mass=np.array([RHO * hull.volume]))
    stable, unstable = (
        replace(scene([item]), settings=replace(scene([item]).settings, froude_krylov=pressure)) for item in barges
    )
    require_stable(prepare(stable, known))
    match = r"equilibrium in still water is unstable: barge pitch falls away with a stiffness of \S+ N m/rad"
    with pytest.raises(SimulationFailed, match=match) as caught:
        require_stable(prepare(unstable, known))
    told = float(str(caught.value).partition("stiffness of ")[2].split()[0])
    assert told == approx(-0.05 * h.density * h.gravity * hull.volume, rel=5e-3)  # of three digits


@pytest.mark.parametrize("name", ["duck", "soft_mooring", "unequal_legs"])
def test_usual_step_follows_the_shortest_wave_and_own_periods_near_it(name):
    """Nine in the shortest wave; a shape as fast as that wave, stiffened below, is followed as well."""
    item, h = SCENES[name]()
    shortest = 2 * np.pi / item.sea.omega.max()
    system = stepped(prepare(item, h), h)
    assert 0.9 * shortest / 9 < system.dt <= shortest / 9
    modes = system_modes(system, h)
    floats = np.array([not name.startswith("platform") for name in modes.names])
    assert np.all((system.dt <= modes.period / 9) | (modes.period < shortest / 2) | ~floats)
    given_ = replace(item, settings=replace(item.settings, time_step=0.0123))
    assert stepped(prepare(given_, h), h).dt == 0.0123


def test_a_float_as_fast_as_two_thirds_of_the_shortest_wave_shortens_the_step():
    item, h = SCENES["model_scale"]()
    shortest = 2 * np.pi / item.sea.omega.max()
    slow = system_modes(prepare(item, h), h).period[0]
    soft = linear_model(prepare(item, h)).stiffness[0, 0]
    stiff = replace(item.floats[0], stiffness=soft * ((1.5 * slow / shortest) ** 2 - 1))
    system = prepare(replace(item, floats=(stiff,)), h)
    period = system_modes(system, h).period[0]
    assert period == approx(shortest / 1.5, rel=0.2)
    assert 0.9 * period / 9 < stepped(system, h).dt <= period / 9
    stiffer = replace(item.floats[0], stiffness=soft * (4 * slow / shortest) ** 2)
    quiet = prepare(replace(item, floats=(stiffer,)), h)
    assert stepped(quiet, h).dt == two_digits(shortest / 9)  # it follows the waves without swinging


def test_a_decay_has_twenty_steps_in_the_period_of_what_is_let_go_and_nine_in_others():
    item, h = SCENES["soft_mooring"]()
    for offset, count in (((1.0, 0, 0), 9), ((0, 0.3, 0), 20)):
        let_go = replace(item, sea=CALM, floats=(replace(item.floats[0], offset=offset),))
        system = prepare(let_go, h)
        _, _, heaving = system_modes(system, h).period
        assert 0.9 * heaving / count < stepped(system, h).dt <= heaving / count


def test_a_step_that_no_run_would_end_with_is_refused(monkeypatch):
    item, h = SCENES["soft_mooring"]()
    let_go = replace(item, sea=CALM, floats=(replace(item.floats[0], offset=(0, 0.3, 0)),))
    monkeypatch.setattr("solver.coupled.natural.MOST_STEPS", 10)
    with pytest.raises(SimulationFailed, match=r"the scene's own periods ask for steps of .* s, more than 10 in"):
        stepped(prepare(let_go, h), h)


def test_waves_alone_have_the_step_of_the_shortest():
    bare = scene([])
    assert stepped(prepare(bare, None), None).dt == bare.usual_step


def light_column(**settings):
    """Almost without mass, ten tonnes on top: the fastest of its modes told takes 7 ms."""
    feather = replace(STEEL, density=1.0)
    member = Member(
        name="leg", start="foot", end="top", elements=8, section=tube(0.3, 0.01), material=feather,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(
        nodes={"foot": (0.0, 0.0, -9.0), "top": (0.0, 0.0, 3.0)}, members=(member,), clamped=("foot",),
        masses=(PointMass(node="top", mass=1e4),), loads=(PointLoad(node="top", force=(200.0, 0.0, 0.0)),),
    )  # fmt: skip
    platform = Platform(frame=frame, legs=("leg",), damping_ratio=0.02)
    return scene([], depth=10.0, platform=platform, waves=CALM, **{"discard": 0.0, "ramp": 0.0} | settings)


@pytest.mark.parametrize("current", [None, Current(speed=0.8)], ids=["still", "current"])
def test_a_frame_without_floats_needs_no_steps_of_its_own_in_still_water(current):
    """Nothing sets it swinging: not its weight and loads, which it bears from the start on, nor a current."""
    item = replace(light_column(duration=3600.0), current=current)
    system = prepare(item, None)
    assert system_modes(system, None).period.min() < 1e-2
    assert stepped(system, None).dt == item.usual_step
    record = simulate(item)
    tops = record.variables["top_displacement"][1]
    assert np.ptp(tops[..., :4], axis=-1).max() <= 1e-9 * np.abs(record.variables["static_displacement"][1]).max()
    assert (tops[..., 2].max() > 1e-4) == (current is not None)
    assert record.attrs["estimated_error"] < 1e-9


def test_a_push_of_that_frame_has_steps_of_what_it_sets_swinging():
    time = np.array([0.0, 1.0, 1.4, 20.0])
    push = LoadHistory(node="top", time=time, force=np.outer([0, 0, 1, 1], [2e3, 0, 0]))
    item = light_column(duration=20.0)
    item = replace(item, platform=replace(item.platform, load_histories=(push,)))
    system = prepare(item, None)
    slowest, second = system_modes(system, None).period[[0, 1]]
    assert second / 9 < stepped(system, None).dt <= slowest / 9


def test_two_digits_never_lengthen_a_step():
    for step, rounded in ((0.2053, 0.20), (0.2, 0.2), (0.0999, 0.099), (1.0, 1.0), (12.9, 12.0), (3e-7, 3e-7)):
        assert two_digits(step) == approx(rounded, rel=1e-12)


def test_a_shape_whose_mass_in_water_is_negative_has_no_frequency():
    """Of two coupled ones that the added mass leaves one: K = diag(1, 4), M = [[1, 0.2], [0.2, -0.5]] by hand."""
    stiffness, added = np.array([1.0, 4.0]), np.array([[0.0, 0.2], [0.2, -1.5]])
    omega, shape = _settled(stiffness, lambda _: _in_water(stiffness, added), 0)
    # det(K - xM) = -0.54 x² - 3.5 x + 4
    assert omega**2 == approx((-3.5 + np.sqrt(3.5**2 + 4 * 0.54 * 4)) / (2 * 0.54), rel=1e-12)
    mass = np.array([[1.0, 0.2], [0.2, -0.5]])
    assert np.array([1.0, 4.0]) * shape == approx(omega**2 * mass @ shape, rel=1e-9) and shape @ mass @ shape == approx(
        1
    )


def test_each_shape_has_a_frequency_of_its_own():
    """Two alike, coupled by the added mass ±1/2 (1 + ω²) alone: x = ω² of x² ± x/2 - 1 = 0, one each."""
    stiffness, coupling = np.ones(2), np.array([[0.0, 0.5], [0.5, 0.0]])
    (slow, together), (fast, against) = (
        _settled(stiffness, lambda omega: _in_water(stiffness, coupling / (1 + omega**2)), i) for i in (0, 1)
    )
    assert [slow**2, fast**2] == approx([(np.sqrt(4.25) - 0.5) / 2, (np.sqrt(4.25) + 0.5) / 2], rel=1e-8)
    assert together[0] * together[1] > 0 > against[0] * against[1]


def test_a_shape_is_found_where_added_mass_rises_steeply():
    """Frequency and added mass in turn go round there: (2 + tanh 20(ω - 1)) ω² = 2, at ω = 1 exactly."""
    stiffness = np.array([2.0])
    omega, _ = _settled(stiffness, lambda at: _in_water(stiffness, np.array([[1 + np.tanh(20 * (at - 1))]])), 0)
    assert omega == approx(1.0, rel=1e-8)


def test_a_shape_without_mass_is_left_out():
    stiffness, added = np.array([1.0, 4.0]), np.array([[0.0, 0.2], [0.2, -1.5]])
    assert _settled(stiffness, lambda _: _in_water(stiffness, added), 1)[0] == np.inf


@pytest.mark.parametrize("side", [-1, 1])
def test_how_far_from_rest_a_hinge_is_pushed_back(side):
    """A ball about its own middle, held level by a constant load: mg(c cos θ - b sin θ - c), zero at tan θ/2 = -b/c."""
    sphere = Revolution.sphere(radius=1.0, draft=1.0)
    c, b = 0.5 * side, 0.15
    ball = Float(
        name="ball", hull=sphere, mass=BUOYED, inertia=(859.0,) * 3, hinge=(0, 0, 0), arm=(0, 0, 0), cog=(c, 0, -b),
        preload=-BUOYED * 9.81 * c,
    )  # fmt: skip
    system = prepare(scene([ball], radiation=False, diffraction=False), None)
    assert system.equilibrium[0] == approx([0.0], abs=1e-9)
    lost = 2 * np.arctan(b / abs(c))
    expected = (-lost, 1.5) if side > 0 else (-1.5, lost)
    assert righting(system.bodies, system.equilibrium[0], 0, 1.5) == approx(expected, abs=0.016)
    # With another load it rests at 0.1 rad, and the message counts from where it is given, as its angle does.
    load = -BUOYED * 9.81 * (c * np.cos(0.1) - b * np.sin(0.1))
    leaning = prepare(scene([replace(ball, preload=load)], radiation=False, diffraction=False), None)
    lost = -2 * np.arctan2(b, abs(c)) * side - 0.1
    told = re.search(r"between (\S+) and (\S+) rad", _stability(leaning, np.array([4.0])))
    assert any(float(angle) == approx(lost, abs=0.025) for angle in told.groups())


def heaving(**keys):
    """A cylinder of radius 2 m and draft 3 m on a guide, in still water, without radiation, a little too heavy."""
    hull = Revolution.vertical_cylinder(radius=2.0, draft=3.0, freeboard=2.0)
    item = Float(
        name="cyl", hull=hull, mass=1.001 * RHO * hull.volume, inertia=(1e5,) * 3, cog=(0, 0, -1), hinge=(0, 0, 0),
        motion=("heave",), **keys,
    )  # fmt: skip
    return prepare(scene([item], waves=CALM, diffraction=False, radiation=False), None)


@pytest.mark.parametrize("by", ["stiffness", "table"])
def test_a_power_take_off_that_pushes_a_float_away_is_refused(by):
    """By its stiffness, or by that of its table at rest, though beyond the table's ends, 4 m off, it would hold."""
    K, places, rates = RHO * 9.81 * np.pi * 2.0**2, (-4.0, 0.0, 4.0), (-5.0, 0.0, 5.0)

    def held_by(k):
        load = tuple(k * y + 1e4 * v for y in places for v in rates)
        return {"pto_stiffness": k} if by == "stiffness" else {
            "pto_table": PtoTable(position=places, velocity=rates, force=load)
        }  # fmt: skip

    stays, falls = (heaving(**held_by(-share * K)) for share in (0.9, 1.1))
    require_stable(stays)
    assert stays.joints_at_rest == approx(-0.001 * 3.0 / 0.1, rel=1e-6)
    with pytest.raises(
        SimulationFailed, match=r"unstable: cyl heave falls away.*let the power take-off push"
    ) as caught:
        require_stable(falls)
    told = [float(x) for x in re.findall(r"(\S+) (?:N per metre|of water|of the power)", str(caught.value))]
    assert told == approx([-0.1 * K, K, -1.1 * K], rel=5e-3)


def test_what_rounding_leaves_of_a_soft_structure_s_rest_is_a_rest(monkeypatch):
    """It moves that by more than a stiffer one is asked to have settled to."""
    item, h = SCENES["unequal_legs"]()
    system = prepare(item, h)
    frame = system.structure
    soft = system.bodies, frame.omega / 5, frame.carrier, np.zeros(frame.omega.size), 1.0
    usual = equilibrium.equilibrium(*soft)
    monkeypatch.setattr(equilibrium, "SETTLED", 0.0)
    for one, other in zip(equilibrium.equilibrium(*soft), usual, strict=True):
        assert one == approx(other, abs=1e-10)
    monkeypatch.setattr(equilibrium, "WANDERS", 0.0)
    with pytest.raises(SimulationFailed, match="they still move by"):
        equilibrium.equilibrium(*soft)
