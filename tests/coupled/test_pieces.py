"""Laws that bend: stops, friction, limits, each against a closed form; and that pieces of a step are no other scheme.

A float that surges in still water without radiation is a mass, free or on a spring.
"""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import solve_ivp

from solver.coupled import assembly
from solver.coupled import blocks as blocks_module
from solver.coupled.between import NODES, interpolate
from solver.coupled.blocks import blocks, energy_residual
from solver.coupled.energy import AT_START, JOINT_DAMPING, PTO, WORKS, energy
from solver.coupled.memory import Memory
from solver.coupled.pieces.fine import _fill_memory, new_fine, sample_drive
from solver.coupled.preparation import prepare
from solver.coupled.problem import HITS, HOLDS, LOAD, NOT_CONVERGED, RATE, TO_AND_FRO, UNTOLD, Drive, new_workspace
from solver.coupled.stages import copied
from solver.coupled.step import _halfway
from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.mooring import Mooring
from solver.multibody.joint_law import RELEASED, STOP_ZONE
from solver.record import probe
from solver.record.recorder import Recorder
from solver.run import simulate
from solver.scene import EndStops, Float, Scene, Settings, Water
from tests.awkward import SCENES, bare_legs

M = 2000.0  # [kg]
STIFF = 400.0  # of a stop over the mass [1/s²]: 20 rad/s, seven times faster than the steps


def mass(dt, seconds, motion=("surge",), **law):
    item = Float(
        name="mass", hull=Revolution.sphere(radius=1.0, draft=1.0), mass=M, inertia=(800.0,) * 3, hinge=(0, 0, 0),
        motion=motion, **law,
    )  # fmt: skip
    settings = Settings(
        duration=seconds, discard=0.0, ramp=0.0, time_step=dt, radiation=False, diffraction=False,
        froude_krylov="none", newton_tolerance=1e-10,
    )  # fmt: skip
    return Scene(water=Water(depth=inf), floats=(item,), settings=settings)


class Run:
    """Histories (m,) of the mass, and the march's state at the end."""

    def __init__(self, scene, rate=0.0, known=None, change=lambda state: None):
        self.system = prepare(scene, known)
        self.state = self.system.start()
        self.state.dz[0] = rate
        change(self.state)
        self.state.energy[AT_START] = energy(self.system.bodies, self.system.structure, self.state)
        parts = list(blocks(self.system, self.state, round(scene.settings.duration / self.system.dt)))
        self.t = np.concatenate([times for _, _, times in parts])
        first = self.system.structure.carrier.shape[0]
        self.y, self.dy = (np.concatenate([getattr(o, n)[:, first] for _, o, _ in parts]) for n in ("z", "dz"))
        contact = np.concatenate([out.contact for _, out, _ in parts])[:, :1]
        self.contact = contact.sum(axis=1)
        self.held = contact[:, 0, HOLDS] if contact.size else np.zeros(len(self.t))
        self.struck = np.concatenate([out.struck for _, out, _ in parts])[:, :, 0, 0]  # in surge

    def work(self, kind):
        return self.state.work[kind]

    @property
    def residual(self):
        stored = energy(self.system.bodies, self.system.structure, self.state)
        return energy_residual(self.state.work, stored, self.state.energy)


def restitution(zeta):
    """Of a mass on a damped spring that does not pull: exp(-ζ(π - 2 asin ζ)/(1-ζ²)^½) of the rate is left.

    δ = V/ω' exp(-ζωt) sin ω't comes free where kδ + cδ̇ = 0, at ω't = π - 2 asin ζ, with |δ̇| = V exp(-ζωt).
    """
    return np.exp(-zeta * (np.pi - 2 * np.arcsin(zeta)) / np.sqrt(1 - zeta**2))


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.5])
@pytest.mark.parametrize("dt", [0.4, 0.13])
def test_a_mass_bounces_between_stops_with_their_restitution(zeta, dt):
    """To 5e-4 of its rate at each hit, which is what pieces as bent as BEND leave; between the hits nothing acts."""
    damping = 2 * zeta * np.sqrt(STIFF) * M
    stops = EndStops(lower=-0.7, upper=1.0, stiffness=STIFF * M, damping=damping)
    run = Run(mass(dt, 7.8, end_stops=stops), rate=1.0)
    hits = run.contact[:, HITS].sum()
    e = restitution(zeta)
    # At the bound at 1 s, free after (π - 2 asin ζ)/ω' from where it then is.
    assert hits >= 2 and abs(run.dy[-1]) == approx(e**hits, rel=5e-4 * hits)
    assert run.contact[:, RATE].max() == approx(1.0, rel=1e-6)
    lost = 0.5 * M * (1 - e ** (2 * hits))
    assert run.work(JOINT_DAMPING) == approx(lost, abs=1e-3 * 0.5 * M)
    assert np.abs(run.struck).max() == approx(run.contact[:, LOAD].max(), rel=1e-6)  # nothing else bears the mass
    deepest = np.sqrt(1 / STIFF) * np.exp(-zeta / np.sqrt(1 - zeta**2) * np.arccos(zeta))  # of the free swing
    largest = {0.0: STIFF * M * deepest, 0.5: damping}  # of a spring; of a damper that is hit
    if zeta in largest:
        assert run.contact[:, LOAD].max() == approx(largest[zeta], rel=0.02)


@pytest.mark.parametrize("stiffness", [0.0, 1e4])
def test_a_stop_that_dampens_bears_most_at_the_instant_that_it_is_hit(stiffness):
    """c times the rate, up to a quarter more than at a piece's first stage."""
    stops = EndStops(lower=-0.7, upper=0.2, stiffness=stiffness, damping=2e4)
    record = simulate(replace(mass(0.1, 2.0, end_stops=stops, offset=-0.5, stiffness=4e4)), None)
    rate, load = (record.variables[name][1][0, 0] for name in ("impact_rate", "end_stop_load"))
    assert rate > 1.0 and load == approx(2e4 * rate, rel=1e-6)


@pytest.mark.parametrize(("dt", "seconds"), [(0.4, 7.6), (0.13, 7.8), (0.05, 7.8)])
def test_statistics_of_hits_are_those_of_pieces(dt, seconds):
    """F = kδ for half a period at ω: ∫F dt = 2MV and ∫F² dt = M²V²ωπ/2 of each hit, whatever samples see of it.

    To 1e-3 of F² a hit, as V² is by what pieces as bent as BEND leave.
    """
    scene = mass(dt, seconds, end_stops=EndStops(lower=-0.7, upper=1.0, stiffness=STIFF * M))
    system = prepare(scene, None)
    state, recorder = system.start(), Recorder(scene, None, layout=system.layout, bodies=system.bodies)
    state.dz[0] = 1.0
    state.energy[AT_START] = energy(system.bodies, system.structure, state)
    for samples, output, times in blocks(system, state, round(seconds / dt)):
        recorder.add(times, output, samples)
    hits, (most, least, mean, rms, _) = recorder.contact[0, HITS], recorder.tables()["hinge_force"][0, 0]
    assert hits == 4 and mean == approx(0, abs=2e-3 * hits * 2 * M / seconds)
    assert rms**2 == approx(hits * M**2 * np.sqrt(STIFF) * np.pi / 2 / seconds, rel=1e-3 * hits)
    assert [most, -least] == approx([M * np.sqrt(STIFF)] * 2, rel=0.02)


@pytest.mark.parametrize("dt", [0.4, 0.13])
def test_statistics_of_a_damper_that_is_hit_begin_with_its_load(dt):
    """F = cV exp(-ct/M) from the hit on, all at once: ∫F dt = MV and ∫F² dt = cMV²/2."""
    damping, seconds = 8.0 * M, 7.8
    scene = mass(dt, seconds, end_stops=EndStops(lower=-5.0, upper=1.05, stiffness=0.0, damping=damping))
    mean, rms = tables_of(scene, rate=1.0)["hinge_force"][0, 0, 2:4]
    assert abs(mean) * seconds == approx(M, rel=2e-3)
    assert rms**2 * seconds == approx(damping * M / 2, rel=2e-3)


@pytest.mark.parametrize("dt", [0.4, 0.28, 0.13])
def test_power_of_an_axis_that_is_let_go_of_is_that_of_pulses_shorter_than_steps(dt):
    """At work again as it turns round, where nothing jumps, until cẏ lets go, where all does: P = cẏ² in between."""
    damping, most, first, seconds = 0.4 * M, 0.25 * M, round(1.2 / dt) * dt, round(15.6 / dt) * dt
    scene = mass(dt, seconds, stiffness=2 * M, offset=1.0, pto_damping=damping, declutch_load=most)
    mean, rms = tables_of(replace(scene, settings=replace(scene.settings, discard=first)))["absorbed_power"][0, 2:4]
    work, squares = pulses(damping, most, first + seconds) - pulses(damping, most, first)
    assert mean * (seconds + dt / 2) == approx(work, rel=2e-3)  # both ends are samples
    assert rms**2 * (seconds + dt / 2) == approx(squares, rel=1e-2)


def test_a_law_that_changes_only_later_is_judged_too(monkeypatch):
    """A mass that a soft spring sets going, until its power take-off lets go, in the second block of steps."""
    monkeypatch.setattr(probe, "PROBE", 100)
    system = prepare(mass(0.4, 200.0, stiffness=6e-5 * M, offset=10.0, pto_damping=1.0, declutch_load=0.06), None)
    judge, later = probe.Probe(system), []
    for samples, output, times in blocks(system, system.start(), 500):
        judge.add(times, output, samples)
        later.append(judge.unaware(output))
        if judge.fresh:
            judge.errors(None)
    assert later == [False, True]


@pytest.mark.parametrize("tolerance", [1e-3, None])
def test_with_a_tolerance_all_that_follows_hits_is_judged(monkeypatch, tolerance):
    """Of a mass on a spring that meets a stop with each swing; the larger error counts."""
    monkeypatch.setattr(probe, "PROBE", 100)
    scene = mass(0.4, 200.0, stiffness=M, offset=1.0, end_stops=EndStops(lower=-0.5, upper=2.0, stiffness=STIFF * M))
    system = prepare(replace(scene, settings=replace(scene.settings, tolerance=tolerance)), None)
    state, judge = system.start(), probe.Probe(system)
    before, done, told = copied(state), 0, []
    for samples, output, times in blocks(system, state, 500):
        judge.add(times, output, samples)
        if judge.unaware(output):
            judge = judge.again(done, before)
            judge.add(times, output, samples)
        before, done = copied(state), done + len(times) // 2
        if judge.fresh:
            told.append(judge.errors(None)["discretization_error"])
    assert judge.full and told == sorted(told)
    if tolerance is None:
        assert len(told) == 1 and judge.first == 0 and judge.steps < 250
    else:
        assert len(told) == 2 and judge.first == 256 and judge.steps > 242


def tables_of(scene, rate=0.0):
    """Statistics by the march alone."""
    system = prepare(scene, None)
    state, recorder = system.start(), Recorder(scene, None, layout=system.layout, bodies=system.bodies)
    state.dz[0] = rate
    state.energy[AT_START] = energy(system.bodies, system.structure, state)
    steps = round((scene.settings.discard + scene.settings.duration) / system.dt)
    for samples, output, times in blocks(system, state, steps):
        recorder.add(times, output, samples)
    return recorder.tables()


def pulses(damping, most, seconds):
    """∫P dt and ∫P² dt of a mass on a spring of 2M, let go at 1 m, by scipy."""

    def slopes(_, x, at_work):
        power = at_work * damping * x[1] ** 2
        return x[1], -2 * x[0] - at_work * damping / M * x[1], power, power**2

    def lets_go(_, x, at_work):
        return damping * abs(x[1]) - most if at_work else -1.0

    def turns(_, x, at_work):
        return 1.0 if at_work else x[1]

    lets_go.terminal = turns.terminal = True
    lets_go.direction, x, t, at_work = 1, [1.0, 0.0, 0.0, 0.0], 0.0, True
    while t < seconds:
        way = solve_ivp(slopes, (t, seconds), x, args=(at_work,), events=(lets_go, turns), rtol=1e-10, atol=1e-9)
        t, x, at_work = way.t[-1], way.y[:, -1], not at_work
        x[1] = x[1] if not at_work else 0.0
    return x[2:]


@pytest.mark.parametrize(("dt", "gap"), [(0.4, 1.7), (0.13, 1.7), (0.4, 0.2)])
def test_no_rate_at_hits_is_beyond_that_of_the_mass(dt, gap):
    """Which bounces with ±V, whatever parabolas through samples on either side say; the last time with more hits than
    there is room for their pieces."""
    seconds, stops = 40 * dt, EndStops(lower=-gap / 2, upper=gap / 2, stiffness=100 * STIFF * M)
    scene = mass(dt, seconds, end_stops=stops)
    scene = replace(scene, settings=replace(scene.settings, outputs=("pto_stroke",)))
    system = prepare(scene, None)
    state, recorder = system.start(), Recorder(scene, None, layout=system.layout, bodies=system.bodies)
    state.dz[0], told = 1.0, []
    state.energy[AT_START] = energy(system.bodies, system.structure, state)
    for samples, output, times in blocks(system, state, 40):
        recorder.add(times, output, samples)
        told.append(output.lead)
    assert np.any(np.concatenate(told) == UNTOLD) == (gap < 1)
    assert recorder.tables()["pto_rate"][0, 0, :2] == approx([1.0, -1.0], rel=2e-3)


def test_rates_of_a_duck_on_hard_stops_are_those_of_short_steps():
    whole, known = SCENES["duck"]()
    floats = (replace(whole.floats[0], end_stops=EndStops(lower=-0.1, upper=0.1, stiffness=1e8)),)
    settings = replace(whole.settings, duration=60.0, outputs=("pto_stroke",))
    long, short = (
        simulate(replace(whole, floats=floats, settings=replace(settings, time_step=dt)), known) for dt in (0.2, 0.05)
    )
    assert long.variables["end_stop_hits"][1] > 5
    extremes = [record.variables["pto_rate"][1][0, 0, :2] for record in (long, short)]
    assert extremes[0] == approx(extremes[1], rel=2e-3)


@pytest.mark.parametrize("steps", [256.25, 256.75, 255.25])
def test_a_turn_at_the_edge_of_a_block_is_one_as_any_other(steps):
    """Of 256 steps; the fifth turn, at 5π/ω, in the first and second half of the next one's first, and in the last."""
    scene = mass(5 * np.pi / np.sqrt(2) / steps, 5.0, stiffness=2 * M, offset=1.0, coulomb=0.1 * M)
    record = simulate(replace(scene, settings=replace(scene.settings, discard=9.5)), None)
    assert record.variables["hinge_force"][1][0, 0, 0] == approx(1.1 * M, rel=1e-6)


def test_pieces_leave_no_trace_in_the_parabolas_of_envelopes():
    whole, known = SCENES["unequal_legs"]()
    floats = tuple(replace(f, coulomb=300.0) for f in whole.floats)
    system = prepare(replace(whole, floats=floats, settings=replace(whole.settings, discard=0.0)), known)
    recorder = Recorder(system.scene, system.support, layout=system.layout, bodies=system.bodies)
    samples, output, times = next(iter(blocks(system, system.start(), 256)))
    recorder.add(times, output, samples)
    shapes = recorder.channels.legs.displacement
    u = np.tensordot(output.p[-2:], shapes, axes=1)
    assert output.between.number[0] > 0
    assert recorder.largest.last_square == approx(np.sum(u**2, axis=1), rel=1e-9)


@pytest.mark.parametrize("dt", [0.4, 0.2])
def test_the_mean_power_of_friction_is_its_work(dt):
    """⟨F|v|⟩ has a kink at every turn: what pieces tell there would leave (ωh)²/12 of it to the samples between."""
    seconds, friction = 200.0, 0.002 * M
    scene = mass(dt, seconds, stiffness=M, offset=1.0, coulomb=friction)
    scene = replace(scene, settings=replace(scene.settings, keep_series=True))
    record = simulate(scene, None)
    power = record.series["absorbed_power"][1][:, 0]
    h = np.diff(record.series["time"][1][:2])[0]
    mean = record.variables["absorbed_power"][1][0, 2]
    told = mean * seconds - power[-1] * h / 2  # which samples count whole
    assert told == approx(record.attrs["work_pto"], rel=2e-4)


def test_friction_alone_is_all_that_the_hinge_bears():
    """At most that at which it slips, though a parabola through samples before and after a turn is higher."""
    friction = M
    for offset in (0.25, 0.26, 0.28, 0.3):
        scene = mass(0.1, 20.0, motion=("heave",), offset=offset, coulomb=friction)
        afloat = replace(scene.floats[0], mass=scene.water.density * 2 / 3 * np.pi)
        settings = replace(scene.settings, froude_krylov="linear")
        record = simulate(replace(scene, floats=(afloat,), settings=settings), None)
        assert record.variables["hinge_force"][1][0, 2, :2] == approx([friction, -friction], rel=1e-9)


def test_a_zone_is_left_by_what_stays_beyond_it():
    """Also by what draws nearer to its border, as what rings may where it lets go of a stop that it still presses on:
    it would pass through the stop."""

    def let_go(state):
        state.zone[STOP_ZONE], state.ddz[:] = RELEASED, -1.2

    scene = mass(0.1, 0.1, stiffness=M, offset=1.2, end_stops=EndStops(lower=-2.0, upper=1.0, stiffness=STIFF * M))
    pressed, released = Run(scene), Run(scene, change=let_go)
    assert pressed.y[-1] < 1.0 and [released.y[-1], released.dy[-1]] == approx([pressed.y[-1], pressed.dy[-1]])


def test_the_force_at_a_hit_does_not_wait_for_a_sample():
    """Half the period on the stop is 0.16 s; in the record too, whose samples are as far apart as half a step."""
    stops = EndStops(lower=-0.5, upper=2.0, stiffness=STIFF * M, damping=0.4 * np.sqrt(STIFF) * M)
    scene = mass(0.26, 20.0, stiffness=M, offset=1.0, end_stops=stops)
    records = [simulate(replace(scene, settings=replace(scene.settings, time_step=dt))) for dt in (0.26, 0.01)]
    coarse, fine = (record.variables["hinge_force"][1][0, 0, :2] for record in records)
    assert coarse == approx(fine, rel=0.01)


def test_pieces_are_of_fourth_order():
    """Turning round under a constant load, and a limit that is reached: without pieces this is of first order."""
    steps = np.array([0.4, 0.2, 0.1])
    laws = [
        {"stiffness": M, "offset": 1.0, "coulomb": 0.03 * M},
        {"stiffness": M, "offset": 1.0, "pto_damping": 0.5 * M, "force_limit": 0.2 * M},
        {"stiffness": M, "offset": 1.0, "pto_damping": 0.5 * M, "one_way": 1.0},
        {"stiffness": M, "offset": 1.0, "pto_damping": 0.5 * M, "declutch_load": 0.2 * M},
    ]
    for law in laws:
        ends = [Run(mass(dt, 8.0, **law)).y[-1] for dt in (*steps, 0.0125)]
        error = np.abs(np.array(ends[:-1]) - ends[-1])
        assert np.polyfit(np.log(steps), np.log(error), 1)[0] == approx(4, abs=0.4), law


@pytest.mark.parametrize("share", [0.1, 0.07, 0.03])
def test_coulomb_friction_takes_its_part_of_each_swing(share):
    """Each half swing is 2F/k less, a linear envelope; at rest the load holds what is left of the spring's."""
    run = Run(mass(0.2, 20.0, stiffness=M, offset=1.0, coulomb=share * M))
    peaks = [1.0]
    while abs(peaks[-1]) > share * (1 + 1e-9):
        peaks.append(-np.sign(peaks[-1]) * (abs(peaks[-1]) - 2 * share))
    half = np.minimum((run.t / np.pi).astype(int), len(peaks) - 1)
    middle = np.where(half % 2 == 0, 1, -1) * share
    exact = middle + (np.array(peaks)[half] - middle) * np.cos(run.t - half * np.pi)
    exact = np.where(half == len(peaks) - 1, peaks[-1], exact) if run.t[-1] > np.pi * (len(peaks) - 1) else exact
    assert run.y == approx(exact, abs=3e-5)
    path = np.abs(np.diff(peaks)).sum()
    if run.t[-1] > np.pi * (len(peaks) - 1):
        assert run.work(PTO) == approx(share * M * path, rel=1e-6)
        assert run.state.held[0] == approx(-M * peaks[-1], abs=1e-4 * M) and run.dy[-1] == 0.0
    assert run.residual < 1e-6


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_what_friction_holds_goes_the_way_that_it_is_pushed(side):
    """A swing across pushes an axis, that comes to rest, beyond its friction again and again: it pays F a metre."""
    F, coupled = 0.3 * M, np.array([[1.0, 0.5], [0.5, 1.0]]) * M
    lines = Mooring(stiffness=tuple(map(tuple, coupled.tolist())))
    law = {"coulomb": (F, 0.0), "mooring": lines, "offset": (0.0, side)}
    run = Run(mass(0.05, 12.0, motion=("surge", "sway"), **law))
    moves = np.abs(run.dy) > 1e-3
    begins = np.flatnonzero(~moves[:-1] & moves[1:])
    assert len(begins) >= 2 and np.all(np.sign(run.dy[begins + 2]) == side * (-1.0) ** np.arange(len(begins)))
    assert run.work(PTO) == approx(F * np.abs(np.diff(run.y)).sum(), rel=2e-3)
    assert run.residual < 1e-5


def test_a_one_way_power_take_off_takes_from_every_other_half_swing():
    """Half a swing at ω' = (1 - ζ²)^½ ω leaves exp(-πζ/(1 - ζ²)^½) of it, the next one is free."""
    zeta, run = 0.25, Run(mass(0.1, 10.0, stiffness=M, offset=1.0, pto_damping=0.5 * M, one_way=1.0))
    swift = np.sqrt(1 - zeta**2)
    whole = np.pi * (1 + 1 / swift)  # one free half towards the negative, one damped back
    kept = np.exp(-np.pi * zeta / swift)
    at = lambda t: np.interp(t, run.t, run.y)  # noqa: E731
    # Samples 0.05 s apart, between which a straight line at a peak is (0.05)²/8 off.
    assert at(np.pi) == approx(-1.0, abs=4e-4) and at(whole) == approx(kept, abs=4e-4)
    assert run.residual < 1e-5


def test_a_limited_power_take_off_is_what_it_says():
    law = {"stiffness": M, "offset": 1.0, "pto_damping": 0.8 * M, "coulomb": 0.05 * M, "force_limit": 0.2 * M}
    run = Run(mass(0.1, 5.5, preload=0.3 * M, one_way=-0.5, **law))

    def rates(_, x):
        v = x[1]
        load = (0.5 if v > 0 else 1.0) * np.sign(v) * min(0.8 * abs(v) + 0.05, 0.2)
        return [v, 0.3 - x[0] - load]

    # Let go 1 m from equilibrium, which the preload moves by 0.3 m.
    exact = solve_ivp(rates, (0, 5.5), [1.3, 0.0], t_eval=run.t, rtol=1e-10, atol=1e-12, max_step=2e-3).y[0]
    assert run.y == approx(exact, abs=2e-5)
    assert run.residual < 1e-5


def test_a_stop_that_is_not_met_changes_nothing():
    far = EndStops(lower=-5.0, upper=5.0, stiffness=1e7, damping=1e5)
    bare, stopped = (
        Run(mass(0.2, 10.0, stiffness=M, damping=0.1 * M, offset=1.0, **x)) for x in ({}, {"end_stops": far})
    )
    assert np.array_equal(bare.y, stopped.y) and np.array_equal(bare.state.work, stopped.state.work)
    assert not stopped.contact.any()


@pytest.mark.parametrize("name", ["oblique", "unequal_legs", "soft_mooring"])
def test_pieces_of_a_step_lead_where_the_step_leads(name):
    """Stops of next to no stiffness cut steps at every passage, with memory, waves and platform, and change nothing.

    What is left is the scheme's own error, which pieces make smaller.
    """
    scene, known = SCENES[name]()
    short = replace(scene.settings, duration=25.0, discard=0.0, ramp=5.0, newton_tolerance=1e-10)
    n = len(scene.floats[0].motion)
    stops = EndStops(lower=(-0.02,) * n, upper=(0.02,) * n, stiffness=(1e-6,) * n, damping=(1e-6,) * n)
    floats = tuple(replace(f, end_stops=stops) for f in scene.floats)
    ends = []
    for items in (scene.floats, floats):
        system = prepare(replace(scene, floats=items, settings=short), known)
        state, hits = system.start(), 0
        for _, output, _ in blocks(system, state, int(25.0 / system.dt)):
            hits += output.contact[..., HITS].sum()
        ends.append(np.concatenate([state.z, state.dz]))
    assert hits > 3
    assert ends[1] == approx(ends[0], abs=2e-3 * np.abs(ends[0]).max())


def test_ringing_after_hits_leaves_newton_within_its_tolerance():
    """A thousandth of its tolerance changes less than a hundredth of what a quarter of the step does."""
    whole, h = SCENES["unequal_legs"]()
    stops = EndStops(lower=-0.08, upper=0.08, stiffness=4e6, damping=4e4)
    scene = replace(whole, floats=(replace(whole.floats[0], end_stops=stops, pto_damping=1e4),))
    motions = []
    for dt, tolerance in ((0.1, 1e-6), (0.1, 1e-9), (0.025, 1e-9)):
        settings = replace(scene.settings, duration=40.0, discard=0.0, time_step=dt, newton_tolerance=tolerance)
        run = Run(replace(scene, settings=settings), known=h)
        assert run.contact[:, HITS].sum() == 10 and run.residual < 1e-3
        every = round(0.1 / dt)
        motions.append(run.y[2 * every - 1 :: 2 * every])
    usual, tight, finer = motions
    assert np.abs(usual - tight).max() < 0.01 * np.abs(finer - tight).max()


def test_at_a_short_piece_s_middle_pressure_and_drag_are_between_those_of_its_ends():
    system = prepare(*SCENES["unequal_legs"]())
    room, dice = new_workspace(system.bodies, system.structure), np.random.default_rng(3)
    start, stage = room.start, room.stage
    ends = [(start.anchor, stage.anchor), (start.pressure, stage.pressure), (start.drag, stage.drag)]
    ends += [(start.flow, room.flow)]
    for part in sum(ends, ()):
        part[:] = dice.normal(size=part.shape)
    _halfway(start, stage, room.flow)
    for before, after in ends:
        assert after[0] == approx((before + after[1]) / 2)


def test_the_memory_of_a_piece_is_that_of_a_step():
    scene, known = SCENES["oblique"]()
    system = prepare(scene, known)
    own = Memory(system.memory.residue, *(np.empty_like(part) for part in system.memory[1:]))
    for dt in (0.3, 0.013):
        _fill_memory(np.asarray(system.fit.beta, complex), dt, own)
        for part, exact in zip(own, assembly.memory(system.fit, dt, own.direct.shape[2]), strict=True):
            assert part == approx(exact, rel=1e-9, abs=1e-9 * np.abs(exact).max())


def test_the_drive_between_samples_is_a_polynomial_through_them():
    scene, known = SCENES["unequal_legs"]()
    system = prepare(scene, known)
    count, at = len(system.rows), np.arange(12.0)
    power = np.arange(count) % 6
    drive = system.drive((at[:, None] / 10) ** power)
    fine = new_fine(system.problem(), drive)
    for where in (0.0, 0.3, 5.5, 7.0, 10.9):
        sample_drive(drive, where, 1, fine)
        exact = system.drive(((where / 10) ** power)[None])
        for mine, theirs in zip(fine.drive, exact, strict=True):
            assert mine[1] == approx(theirs[0], abs=1e-12)
    assert isinstance(fine.drive, Drive)


@pytest.mark.parametrize(("count", "degree"), [(20, 5), (6, 5), (4, 3), (1, 0)])
def test_between_samples_a_polynomial_through_the_nearest_is_met(count, degree):
    """Of as high a degree as there are samples for; at a sample, before the first and after the last one, too."""
    power, at = np.arange(degree + 1), np.array([0.0, -0.5, 0.25 * count, count - 1.0, count - 0.5])
    samples, values = np.arange(count)[:, None] ** power / count**power, np.empty((at.size, power.size))
    interpolate(samples, at, np.empty(NODES), values)
    assert values == approx(at[:, None] ** power / count**power, abs=1e-12)


@pytest.mark.slow
def test_high_seas_are_survived_on_stops(buan, coefficients):
    """Where a float without them swings through beneath its hinge; the balance closes, hits are counted."""
    stops = EndStops(lower=-0.9, upper=0.9, stiffness=2e7, damping=2e5)
    rough = {"sea": buan.sea(Hs=6.0, Tp=9.0), "duration": 120.0}
    record = simulate(buan.scene("fixed", floats=buan.floats(end_stops=stops, pto_damping=1e4), **rough), coefficients)
    assert record.attrs["energy_residual"] < 1e-3
    hits, load = (record.variables[name][1] for name in ("end_stop_hits", "end_stop_load"))
    assert hits.sum() > 0 and np.nanmax(load) > 1e4
    assert record.variables["end_stop_hit_rate"][1] == approx(hits * 3600 / 120.0, rel=0.01)
    assert np.abs(record.variables["rotation"][1][:, :2]).max() < 0.9 + np.nanmax(load) / 2e7


@pytest.mark.parametrize(
    "law, told",
    [
        ({"end_stops": {"lower": 1.0, "upper": -1.0}}, r"floats\.mass\.end_stops\.lower = 1.*must be < upper"),
        ({"end_stops": {"lower": (-1.0, 0.0), "upper": 1.0}}, r"end_stops\.lower = .*one number for each of surge"),
        ({"coulomb": 5.0, "force_limit": 4.0}, r"floats\.mass\.coulomb = 5.*must be < force_limit"),
        ({"one_way": 2.0}, r"floats\.mass\.one_way = 2.*must be <= 1"),
    ],
)
def test_laws_that_cannot_be_are_refused(law, told):
    if "end_stops" in law:
        law = law | {"end_stops": EndStops(stiffness=1e5, **law["end_stops"])}
    with pytest.raises(InputError, match=told):
        mass(0.1, 1.0, **law)


def test_methods_without_a_law_say_so(buan):
    stops = buan.floats(end_stops=EndStops(lower=-1.0, upper=1.0, stiffness=1e6))
    with pytest.raises(InputError, match=r"floats\.front\.end_stops = given: needs method = .time."):
        buan.scene("fixed", floats=stops, method="frequency", froude_krylov="linear")
    with pytest.raises(InputError, match=r"floats\.front\.coulomb = .*needs formulation = .minimal."):
        buan.scene("fixed", floats=buan.floats(coulomb=100.0), formulation="augmented")
    assert len(WORKS) == 7


def test_what_a_hit_sets_ringing_faster_than_it_swings_takes_no_pieces(buan, coefficients, monkeypatch):
    """On a platform whose hinges have modes of 1,400 rad/s, of which a hit of 22 rad/s makes half of the damper's load.

    Followed to their end they take four times as many of Newton's iterations as a fixed platform.
    """
    spent, march = [], blocks_module.march

    def counted(*args):
        ended = march(*args)
        spent.append(ended[2])
        return ended

    monkeypatch.setattr(blocks_module, "march", counted)
    stops = EndStops(lower=-0.9, upper=0.9, stiffness=2e7, damping=2e5)
    rough = {"floats": buan.floats(end_stops=stops), "sea": buan.sea(Hs=8.0, Tp=12.0), "duration": 100.0}
    used, loads = [], []
    for platform, dt in (("fixed", 0.2), ("elastic", 0.2), ("elastic", 0.05)):
        spent.clear()
        run = Run(buan.scene(platform, time_step=dt, discard=0.0, **rough), known=coefficients)
        assert run.contact[:, HITS].sum() > 20 and run.residual < 1e-3
        used.append(sum(spent))
        loads.append(run.contact[:, LOAD].max())
    assert used[1] < 2 * used[0]
    assert loads[1] == approx(loads[2], rel=0.01)


def test_a_law_that_changes_without_end_is_what_a_run_ends_by():
    system = prepare(mass(0.1, 1.0, coulomb=5.0), None)
    told = [
        str(blocks_module._failure(outcome, 1.0, system, system.start())) for outcome in (TO_AND_FRO, NOT_CONVERGED)
    ]
    assert told[0].startswith("a joint's law changes over 200 times in a step at t = 1.0 s: reduce time_step")
    assert told[1].startswith("no convergence in 40 iterations at t = 1.0 s")


def test_laws_that_change_with_a_stiff_platforms_ringing_are_said_to():
    """With a platform that is stiff beside the step, and that alone: what to do."""
    whole = bare_legs()[0]
    for step, stiff in ((0.3, True), (0.001, False)):
        system = prepare(replace(whole, settings=replace(whole.settings, time_step=step)), None)
        told = {n: str(blocks_module._failure(n, 1.0, system, system.start())) for n in (TO_AND_FRO, NOT_CONVERGED)}
        assert ("a fixed platform, or time_step up to" in told[TO_AND_FRO]) == stiff
        assert told[NOT_CONVERGED].endswith(f"reduce time_step = {step:g} s")
