"""What a memory's misfit does beside the waves is told, and counts where the memory is fitted again."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx
from scipy.signal import lfilter

from solver.coupled.linear import impedance, impedance_anywhere, linear_model
from solver.coupled.moving import force_of_waves
from solver.coupled.natural import system_modes
from solver.coupled.preparation import prepare
from solver.frequency.case import case_of
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.radiation.fitting import USUAL
from solver.record import refit
from solver.record.audit import unmet
from solver.record.beside import beside, bounced, changes, effects, importance_beside
from solver.record.channels import Channels
from solver.record.effects import coefficient_effects, memory_effect
from solver.record.response import drag_damping
from solver.record.sampling import least_force
from solver.record.shares import Shares
from solver.run import simulate
from solver.scene import EndStops, Float, Scene, Settings, Water
from solver.sea.current import Current
from solver.sea.realization import CALM
from solver.statistics import apart, moments
from solver.structure.members import PointMass
from solver.structure.sections import tube
from studies.validation import gaps
from tests.awkward import RHO, SCENES, known, scene, sea


@cache
def buoy():
    """A cylinder of a model basin whose spring gives it a surge of 3.6 s in waves of 2 s at most."""
    hull = Revolution.vertical_cylinder(radius=0.1, draft=0.12, freeboard=0.1)
    item = Float(
        name="buoy", hull=hull, mass=RHO * hull.volume, inertia=(0.01,) * 3, hinge=(0, 0, 0), cog=(0, 0, -0.09),
        motion=("surge", "heave", "pitch"), stiffness=(20.0, 0, 0), damping=(0.45, 0, 0), pto_damping=(0, 2.0, 0),
        quadratic_damping=(0, 30.0, 0.02),
    )  # fmt: skip
    waves = sea(Hs=0.05, Tp=1.1, band=(3.0, 14.0))
    settings = Settings(duration=600.0, discard=60.0, ramp=5.0, time_step=0.04)
    whole = Scene(water=Water(depth=np.inf, density=RHO), sea=waves, floats=(item,), settings=settings)
    return whole, known(whole, 1.4, 31.3, 40)


@cache
def slender():
    """A float on thin legs, in waves from ahead: their sway, and half a dozen more shapes, are faster than these."""
    whole = replace(SCENES["unequal_legs"]()[0], sea=sea(Hs=0.8))
    frame = whole.platform.frame
    legs = tuple(replace(m, section=tube(0.35, 0.012)) if m.name in "abc" else m for m in frame.members)
    frame = replace(frame, members=legs, masses=(PointMass(node="deck", mass=1e5),))
    item, _ = given(whole, None, time_step=0.1)
    item = replace(item, platform=replace(whole.platform, frame=frame, damping_ratio=0.005))
    return item, known(item, 0.45, 12.0, 36)


def barge():
    """The one with a surge of a minute, body-nonlinear."""
    return given(*SCENES["soft_mooring"](), froude_krylov="body-nonlinear", duration=1300.0, discard=200.0)


@cache
def drum():
    """Held by springs that differ in surge and sway, in waves at 30 degrees to them."""
    hull = Revolution.vertical_cylinder(radius=6.0, draft=4.0, freeboard=3.0)
    mass = RHO * hull.volume
    spring, damper = 1.7 * mass * (2 * np.pi / 40) ** 2, 0.06 * 1.7 * mass * 2 * np.pi / 40
    item = Float(
        name="drum", hull=hull, mass=mass, inertia=(12 * mass,) * 3, hinge=(0, 0, 0), cog=(0, 0, -0.8),
        motion=("surge", "sway", "heave"), stiffness=(spring, 1.3 * spring, 0), damping=(damper, damper, 3e5),
    )  # fmt: skip
    waves = sea(Hs=1.5, Tp=7.0, band=(0.5, 2.2), heading=np.pi / 6, seed=3)
    whole = scene([item], waves=waves, duration=1500.0, discard=300.0)
    return whole, known(whole, 0.15, 4.0, 28)


@cache
def soft_sea(seed):
    """A buoy whose soft spring swings it in 41 s, in waves of 1 m; with little or no damping it does so to the end."""
    hull = Revolution.vertical_cylinder(radius=3.0, draft=2.0, freeboard=2.0)
    item = Float(
        name="buoy", hull=hull, mass=RHO * hull.volume, inertia=(2e5, 2e5, 3e5), hinge=(0, 0, 0), cog=(0, 0, -0.5),
        motion=("surge", "heave"), stiffness=(2e3, 0),
    )  # fmt: skip
    waves = sea(Hs=1.0, Tp=7.0, band=(0.3, 3.0), seed=seed)
    settings = Settings(duration=300.0, discard=100.0)
    return Scene(water=Water(depth=40.0), sea=waves, floats=(item,), settings=settings)


@cache
def soft_known():
    return known(soft_sea(1), 0.1, 6.0, 40)


def soft(stiffness, damping, seed=1, **settings):
    item = soft_sea(seed)
    body = replace(item.floats[0], stiffness=(stiffness, 0), damping=(damping, 0))
    return given(replace(item, floats=(body,)), soft_known(), **settings)


def by_fit(system, h):
    return effects(system, h, system.fit.frequency).max(initial=0.0)


def given(item, h, **settings):
    return replace(item, settings=replace(item.settings, **settings)), h


@pytest.mark.parametrize(
    ("build", "poor"),
    [(buoy, 0.03), *(pytest.param(*case, marks=pytest.mark.slow) for case in [(barge, 0.1), (drum, 0.03)])],
)
def test_what_a_poor_memory_changes_below_the_waves_is_told(build, poor):
    """Against the march with a good one, whose own misfit is told, too: within a factor of 3."""
    std, told = [], []
    for tolerance in (3e-4, poor):
        item, h = given(*build(), memory_tolerance=tolerance)
        record = simulate(item, h)
        std.append(record.variables["motion"][1].reshape(-1, 5)[:, 4])
        told.append(by_fit(prepare(item, h), h))
        assert record.attrs["memory_effect"] >= told[-1] / 2  # of what is slow in the record, nearly all of its surge
    good, bad = told
    assert bad > 5 * good
    assert bad / 3 < np.abs(std[1] / std[0] - 1).max() < 3 * (bad + good)


@pytest.mark.parametrize(
    ("stiffness", "damping"),
    [(2e3, 0.0), (2e3, 3e3), *(pytest.param(*case, marks=pytest.mark.slow) for case in [(4e3, 0.0), (2e3, 300.0)])],
)
def test_what_a_poor_memory_changes_of_what_hardly_dies_is_told(stiffness, damping):
    """Where the record's length, not damping, bounds the resonance: the root mean square of two seas."""
    off = []
    for seed in (1, 2):
        runs = (simulate(*soft(stiffness, damping, seed, memory_tolerance=each)) for each in (1e-4, 0.03))
        exact, poor = (run.variables["motion"][1].reshape(-1, 5)[0, 4] for run in runs)
        off.append(poor / exact - 1)
    item, h = soft(stiffness, damping, memory_tolerance=0.03)
    true, told = np.sqrt(np.mean(np.square(off))), by_fit(prepare(item, h), h)
    assert true / 3 < told < 4 * true


def test_slow_motions_count_by_their_share_of_the_record():
    """In waves of a quarter of the height, by whose squares surge drifts."""
    item, h = buoy()
    low = replace(item, sea=replace(item.sea, amplitude=item.sea.amplitude / 4))
    exact, poor = (simulate(*given(low, h, memory_tolerance=each)) for each in (3e-4, 0.03))
    std = [run.variables["motion"][1].reshape(-1, 5)[0, 4] for run in (exact, poor)]
    told = poor.attrs["memory_effect"]
    assert told < by_fit(prepare(*given(low, h, memory_tolerance=0.03)), h) / 3
    assert told / 2 < abs(std[1] / std[0] - 1) < 2 * told


@pytest.mark.parametrize("build", [buoy, slender])
def test_a_shapes_share_is_that_of_its_lines_beside_the_waves(build):
    """Of outputs that move as it does, by one line there and by one among the waves."""
    item, h = given(*build(), memory_tolerance=0.03)
    system = prepare(item, h)
    of, wave, (nc, nm) = beside(system, h), np.sqrt(np.prod(item.sea.omega[[0, -1]])), system.structure.carrier.shape
    shares, dt, channels = Shares(system, h), system.dt / 2, Channels(item, system.support)
    times = dt * np.arange(1, int((item.settings.discard + item.settings.duration) / dt))
    kept = times > item.settings.discard
    swung = np.where(kept, 0.3, 3.0) * np.cos(of.omega[0] * times)
    x = np.outer(swung + 0.7 * np.cos(wave * times), of.shapes[0]) + 5.0
    for begin in range(0, times.size, 5000):
        part = slice(begin, begin + 5000)
        shares.add(times[part], x[part, :nm], np.concatenate([np.zeros((times[part].size, nc)), x[part, nm:]], axis=1))
    outputs = {
        **dict(channels.motions(x[kept, nm:])),
        "hinge_force": np.ones((2, len(item.floats), 3)) * [[[1e9]], [[-1e9]]],
    }
    if channels.legs:
        outputs["top_displacement"] = channels.legs.top_displacement(x[kept, :nm])
    tables = {name: moments(each.reshape(len(each), -1)).reshape(*each.shape[1:], 5) for name, each in outputs.items()}
    first, *others = shares.of(tables)
    assert first == approx(0.3**2 / (0.3**2 + 0.7**2), rel=0.03) and max(others, default=0.0) < 0.01
    calm = replace(item, sea=CALM)
    assert Shares(prepare(calm, h), h).of(tables) == 1.0  # where nothing is filtered


def test_what_a_poor_memory_changes_above_the_waves_is_told():
    """Of what joints bear across the waves, by which no wave moves them."""
    item, h = slender()
    poor, good = (simulate(*given(item, h, memory_tolerance=each)) for each in (0.03, 1e-3))
    true = max(
        apart(poor.variables[name][1], good.variables[name][1], least)
        for name, least in (("rotation", 0.0), ("top_displacement", 0.0), ("hinge_force", least_force(item)))
    )
    assert 1 / 3 < poor.attrs["memory_effect"] / true < 3
    assert true > 10 * memory_effect(prepare(*given(item, h, memory_tolerance=0.03)), h, 0.0)


def test_no_shape_counts_above_the_frequencies_solved_for():
    item, h = slender()
    system = prepare(item, h)
    among = beside(system, h).omega
    assert among.size > 0 and np.all((among > item.sea.omega.max()) & (among < h.omega[-1]))
    assert system_modes(system, h).omega.max() > h.omega[-1]


def test_what_hardly_dies_does_not_spoil_the_memory_of_waves():
    item, h = soft(2e3, 0.0)
    fitted = refit.prepared(item, h)
    assert fitted.fit.error < 0.01 and coefficient_effects(fitted, h)[0] < refit.SWAYED


@pytest.mark.parametrize(
    ("damping", "start", "end"), [(1e-4, 0, 200), (1e-2, 0, 200), (1e-2, 150, 200), (0.06, 40, 300)]
)
def test_a_record_changes_as_that_of_an_oscillator_from_rest_in_white_noise(damping, start, end):
    """Root mean square of 800 realizations of y'' + B y' + y = f, whose scatter is some 3 %."""
    dt, small = 0.1, 0.03 / end
    drive = np.random.default_rng(1).standard_normal((800, int(end / dt)))

    def square(B, omega):
        pole = np.exp(dt * (-B / 2 + 1j * np.sqrt(omega**2 - B**2 / 4)))
        y = lfilter([0, 1], [1, -2 * pole.real, np.abs(pole) ** 2], drive)[:, int(start / dt) :]
        return np.mean(y**2, axis=1)

    usual = square(damping, 1.0).mean()
    damped = (1 - square(damping + small, 1.0).mean() / usual) / (2 * small)
    apart = square(damping, 1.0 + small / 2) - square(damping, 1.0 - small / 2)
    shifted = np.sqrt(np.mean(apart**2)) / (4 * usual * small)
    assert np.concatenate(changes(np.array([damping]), start, end)) == approx([damped, shifted], rel=0.1)


def test_no_damping_leaves_the_records_length_as_the_bound():
    for B, real, imaginary in ((1e-9, 300 / 6, 300 / 360**0.5), (10.0, 1 / 20, 1 / 20 / 3000**0.5)):
        damped, shifted = changes(np.array([B]), 0.0, 300.0)
        assert damped == approx(real, rel=2e-3) and shifted == approx(imaginary, rel=2e-3)


def test_a_memory_fitted_again_leaves_slow_motions_as_they_were():
    item, h = buoy()
    usual, fitted = prepare(item, h), refit.prepared(item, h)
    assert fitted.fit is not usual.fit
    assert coefficient_effects(fitted, h)[0] <= coefficient_effects(usual, h)[0]
    assert by_fit(fitted, h) < max(by_fit(usual, h), refit.SWAYED)
    exact, _ = given(item, h, memory_tolerance=3e-4)
    std = [simulate(each, h).variables["motion"][1].reshape(-1, 5)[0, 4] for each in (exact, item)]
    assert std[1] == approx(std[0], rel=refit.SWAYED)


def test_what_a_change_of_damping_does_is_what_the_linear_model_has_of_a_flat_drive():
    """Over the resonance, with B larger by what the misfit has."""
    item, h = buoy()
    item = replace(item, floats=(replace(item.floats[0], quadratic_damping=0.0),))
    system = prepare(item, h)
    model, shapes, small = linear_model(system), beside(system, h), 1e-3
    omega = np.linspace(0.8, 1.2, 4001) * shapes.omega[0]
    force = np.broadcast_to(np.eye(3)[0], (omega.size, 3))
    Y = np.broadcast_to(impedance_anywhere(system, h, shapes.omega), (omega.size, 3, 3))
    more = np.zeros((3, 3))
    more[0, 0] = small * shapes.damping[0] / shapes.moved[0, 0] ** 2
    before, after = (np.linalg.norm(model.response(omega, y, force)[:, 0]) for y in (Y, Y + more))
    assert before / after - 1 == approx(small / 2, rel=0.1)  # the resonance's skirts are beyond
    counts = importance_beside(system, h)
    used = np.flatnonzero(counts.any(axis=(1, 2)))
    assert h.omega[used[0]] < shapes.omega[0] < h.omega[used[1]] and used.size == 2
    assert counts[used[0], 0, 0] * more[0, 0] == approx(small / 2, rel=0.01)  # the start is in the record


def test_what_shifts_a_resonance_changes_its_std_in_a_record_of_some_length():
    item, h = buoy()
    system = prepare(item, h)
    shapes, s = beside(system, h), item.settings
    small = 1e-3 * shapes.damping[0]
    off = np.zeros((3, 3), complex)
    off[0, 0] = 1j * small / shapes.moved[0, 0] ** 2
    shifted = changes(shapes.damping, s.discard, s.discard + s.duration)[1][0]
    assert effects(system, h, lambda w: impedance_anywhere(system, h, w) + off) == approx(shifted * small, rel=1e-6)


def test_the_lowest_frequency_solved_counts_for_what_is_below_it():
    item, h = barge()
    system = prepare(item, h)
    assert beside(system, h).omega[0] < h.omega[0]
    assert np.flatnonzero(importance_beside(system, h).any(axis=(1, 2))).tolist() == [0]


def test_only_what_is_driven_below_waves_and_rings_there_is_slow():
    item, h = barge()
    (body,) = item.floats
    single = replace(item.sea, amplitude=item.sea.amplitude * (np.arange(item.sea.omega.size) == 20))
    fast = replace(body, stiffness=(100 * body.stiffness[0], 0, 0))
    braked = replace(body, damping=(2e4, 0, 0))
    others = [
        given(item, h, froude_krylov="linear")[0], replace(item, sea=single), replace(item, sea=CALM),
        replace(item, floats=(fast,)), replace(item, floats=(braked,)),
        replace(item, floats=(replace(body, stiffness=0.0),)),
    ]  # fmt: skip
    assert beside(prepare(item, h), h).omega.size == 1
    for other in others:
        assert beside(prepare(other, h), h).omega.size == 0 and by_fit(prepare(other, h), h) == 0
    braked_by_square = replace(body, quadratic_damping=(1e3, 0, 0))
    bent = replace(body, coulomb=(100.0, 0, 0))
    for driven in (braked_by_square, bent):
        linear = replace(others[0], floats=(driven,))
        assert beside(prepare(linear, h), h).omega.size == 1


def test_quadratic_damping_damps_what_is_slow():
    """Of a joint, by what it moves in waves."""
    item, h = barge()
    rough = replace(item, floats=(replace(item.floats[0], quadratic_damping=(1e4, 0, 0)),))
    calm, steep = (beside(prepare(each, h), h) for each in (item, rough))
    system, omega = prepare(item, h), item.sea.omega
    x = linear_model(system).response(omega, impedance(system, h, omega), force_of_waves(system, h))[:, 0]
    rate = np.sqrt(np.sum(np.abs(omega * x) ** 2) / 2)
    assert steep.damping - calm.damping == approx(1e4 * np.sqrt(8 / np.pi) * rate * calm.moved[:, 0] ** 2, rel=1e-2)


def test_drag_damps_a_frame_as_in_the_frequency_domain():
    """In still water and in a current, of shapes below the waves, too: the deck is heavy."""
    item, h = SCENES["unequal_legs"]()
    heavy = replace(item.platform.frame, masses=(PointMass(node="deck", mass=6e7),))
    item = replace(item, platform=replace(item.platform, frame=heavy))
    found = []
    for current in (None, Current(speed=1.0, direction=0.3)):
        flowing = replace(item, current=current)
        lines = replace(flowing, settings=replace(item.settings, method="frequency", froude_krylov="linear"))
        system = prepare(flowing, h)
        damping = drag_damping(system)
        assert damping == approx(case_of(lines, h).drag_at_rest[1], rel=1e-6, abs=1e-9 * damping.max())
        found.append(beside(system, h))
    assert found[0].omega.size > 0 and np.all(found[1].damping > found[0].damping)


def test_a_knob_that_nobody_set_is_unmet_only_by_what_it_does():
    item, h = buoy()
    poor, good = (replace(prepare(item, h).fit, error=x * USUAL) for x in (2, 0.5))
    little, much = ({"estimated_error": 1e-2, "memory_effect": x * refit.SWAYED} for x in (0.9, 1.1))
    asked = replace(item, settings=replace(item.settings, memory_tolerance=USUAL))
    exact = replace(item, settings=replace(item.settings, tolerance=0.1))
    assert unmet(item, poor, little) == unmet(asked, good, much) == unmet(exact, poor, much) == []
    assert len(unmet(item, poor, much)) == len(unmet(item, good, much)) == len(unmet(asked, poor, little)) == 1


@pytest.mark.parametrize("damping", [0.0, 0.05])
@pytest.mark.parametrize(("apart", "off", "told"), [(4.6, 12, True), (4.6, 8, False), (5.2, 12, False)])
def test_a_memory_far_off_tells_of_water_that_may_ring_in_a_gap(damping, apart, off, told):
    """Of boxes 8 m long, 0.6 and 1.2 m apart, where no lid damps it yet."""
    item = gaps.scene("boxes 0.6 m apart", damping, "time")
    second = replace(item.floats[1], hinge=(apart, 0, 0))
    item = replace(item, floats=(item.floats[0], second), settings=replace(item.settings, memory_tolerance=1e-3))
    fit = replace(prepare(*buoy()).fit, error=off * 1e-3)
    (note,) = unmet(item, fit, {"estimated_error": 1e-2, "memory_effect": 1e-2})
    assert ("solver.gap_damping and gap_width" in note) == (told and not damping)
    apart_from_others = replace(item, settings=replace(item.settings, interaction=False, gap_damping=0, gap_width=0))
    (note,) = unmet(apart_from_others, fit, {"estimated_error": 1e-2, "memory_effect": 1e-2})
    assert "gap" not in note


def struck(share, **settings):
    """The flap between stops that it meets in most waves, so stiff that there it swings at a share of the highest
    frequency solved for."""
    item, h = SCENES["flap"]()
    inertia = linear_model(prepare(item, h)).mass[-1, -1]
    stops = EndStops(lower=-0.04, upper=0.04, stiffness=float(inertia * (share * h.omega[-1]) ** 2))
    floats = (replace(item.floats[0], end_stops=stops),)
    return replace(item, floats=floats, settings=replace(item.settings, duration=400.0, **settings)), h


@pytest.mark.parametrize("off", [1e5, -1e5, 1e5j])
def test_a_bounce_leaves_what_its_damping_lets_it(off):
    """Against mẍ + Bẋ + kx = 0 over half a period, with B and B + |δ|; what adds to the inertia shifts it in time."""
    item, h = struck(0.7)
    item = replace(item, floats=(replace(item.floats[0], pto_damping=2e6),))
    system = prepare(item, h)
    model, stiffness = linear_model(system), item.floats[0].end_stops.stiffness
    moved, mass = model.active[:, -1], model.mass[-1, -1]
    misfit = off * np.outer(moved, moved) / (moved @ moved) ** 2
    told = bounced(system, h, lambda omega: impedance_anywhere(system, h, omega) + misfit)
    radiated = moved @ impedance_anywhere(system, h, np.sqrt([stiffness / mass]))[0].real @ moved
    B = radiated + item.floats[0].pto_damping
    left = [np.exp(-np.pi * b / np.sqrt(4 * stiffness * mass - b**2)) for b in (B, B + abs(off))]
    assert told == approx(left[0] - left[1], rel=0.2)


@pytest.mark.parametrize("share", [0.7, 1.0])
def test_a_memory_that_counts_bounces_is_nearer_there(share):
    """What it changes of power is what the usual one told."""
    item, h = struck(share)
    usual, fitted = prepare(item, h), refit.prepared(item, h)
    told, after = (bounced(of, h, of.fit.frequency) for of in (usual, fitted))
    assert told > refit.SWAYED > after
    before, best = simulate(*struck(share, memory_tolerance=USUAL)), simulate(item, h)
    assert (before.attrs["memory_effect"], best.attrs["memory_effect"]) == (approx(told), approx(after))
    power, exact = (run.variables["absorbed_power"][1][0] for run in (before, best))
    assert told / 3 < abs(power[3] / exact[3] - 1) < 3 * told


def test_bounces_count_as_often_as_they_are():
    item, h = struck(1.0, memory_tolerance=USUAL)
    rarely = replace(item, sea=replace(item.sea, amplitude=0.6 * item.sea.amplitude))
    often, seldom = simulate(item, h), simulate(rarely, h)
    hits = float(seldom.variables["end_stop_hits"][1][0])
    share = hits * rarely.sea.parameters()["Te"] / item.settings.duration
    assert 0 < share < 1
    assert seldom.attrs["memory_effect"] == approx(share * often.attrs["memory_effect"], rel=1e-6)
