"""Latches, power take-offs that let go, loads by position and rate: each against a solution of its own.

A float that surges and sways in still water without radiation is a mass on springs that couple both.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from solver.coupled.assembly import joint_law
from solver.coupled.energy import PTO
from solver.coupled.linear import linear_model
from solver.coupled.preparation import prepare
from solver.coupled.problem import HOLDS
from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution
from solver.mooring import Mooring
from solver.multibody import load_table
from solver.multibody.linearised import damping_of_gaussian, damping_of_harmonic
from solver.multibody.load_table import Points, tables
from solver.power_takeoff import PtoTable
from solver.record.recorder import Recorder
from solver.run import simulate
from solver.scene import EndStops, Float, Platform, Water
from solver.statistics import STATISTICS, Statistics
from solver.structure.frame import Frame
from solver.structure.members import Member, PointMass
from solver.structure.sections import tube
from tests import awkward
from tests.coupled.test_pieces import M, Run, mass

SPRINGS = np.array([[2.0, 0.5], [0.5, 1.0]])  # of surge and sway, over the mass [1/s²]
LATCH, DAMPING = 0.3, 1.0  # of surge, over the mass [m/s², 1/s]


def latched(dt, seconds):
    """Surge on a latch, driven by the sway to which a spring couples it."""
    bare = mass(dt, seconds)
    lines = Mooring(stiffness=tuple(map(tuple, (SPRINGS * M).tolist())))
    item = replace(bare.floats[0], motion=("surge", "sway"), mooring=lines, latch_load=(LATCH * M, 0.0),
                   damping=(DAMPING * M, 0.0),
                   offset=(0.0, 1.0))  # fmt: skip
    return replace(bare, floats=(item,))


def stages_of_a_latch(seconds):
    """[(start, whether it is held, surge, sway and their rates there)], each stage by its exponential."""
    free = np.block([[np.zeros((2, 2)), np.eye(2)], [-SPRINGS, np.diag([-DAMPING, 0.0])]])
    held = free.copy()
    held[[0, 2]] = 0.0
    stages, t, x, holds = [], 0.0, np.array([0.0, 1.0, 0.0, 0.0]), True
    while t < seconds:
        over = abs(SPRINGS[0] @ x[:2]) > LATCH
        stages.append((t, holds and not over, x))
        matrix = held if stages[-1][1] else free
        leaves = (lambda y: abs(SPRINGS[0] @ y[:2]) - LATCH) if stages[-1][1] else (lambda y: y[2])
        at = np.linspace(1e-6, 20.0, 4001)
        step, way = expm(matrix * (at[1] - at[0])), [expm(matrix * at[0]) @ x]
        for _ in at[1:]:
            way.append(step @ way[-1])
        sign = np.array([leaves(y) for y in way])
        n = int(np.flatnonzero(sign[1:] * sign[:-1] < 0)[0])
        tau = brentq(lambda s: leaves(expm(matrix * s) @ x), at[n], at[n + 1], xtol=1e-14)  # noqa: B023
        t, x, holds = t + tau, expm(matrix * tau) @ x, not stages[-1][1]
        x = np.where([0, 0, holds, 0], 0.0, x)
    return stages, held, free


def exact_latch(seconds):
    """Surge at times (m,), the stages of `stages_of_a_latch`, and their starts."""
    stages, held, free = stages_of_a_latch(seconds)
    starts = np.array([s[0] for s in stages])

    def surge(times):
        mine = [stages[k] for k in np.searchsorted(starts, times) - 1]
        return np.array(
            [(expm((held if s[1] else free) * (t - s[0])) @ s[2])[0] for t, s in zip(times, mine, strict=True)]
        )

    return surge, stages, starts


def test_a_latched_oscillator_rests_until_the_load_passes_its_threshold():
    """To fourth order; it takes no energy, and the share of the time in which it holds is told."""
    seconds, steps = 17.0, np.array([0.4, 0.2, 0.1, 0.05])
    surge, stages, starts = exact_latch(seconds)
    assert len(stages) > 6 and sum(s[1] for s in stages) >= 3
    errors = []
    for dt in steps:
        run = Run(latched(dt, seconds))
        errors.append(np.abs(run.y - surge(run.t)).max())
        assert run.residual < 0.012 * dt**4 and run.work(PTO) == 0.0
    assert errors[-1] < 1e-7 and np.polyfit(np.log(steps), np.log(errors), 1)[0] == approx(4, abs=0.2)
    ends = np.minimum(np.append(starts[1:], seconds), seconds)
    lasting = sum(b - a for a, b, s in zip(starts, ends, stages, strict=True) if s[1])
    assert run.held.mean() == approx(lasting / seconds, abs=1e-4)


def test_what_holds_an_axis_is_of_the_power_take_offs_force():
    """While it holds, what the springs bring; else nothing."""
    scene = latched(0.1, 17.0)
    _, stages, starts = exact_latch(17.0)
    stage_held = np.array([s[1] for s in stages])
    settings = replace(scene.settings, outputs=("pto_force",), keep_series=True)
    record = simulate(replace(scene, settings=settings), None)
    t, force = record.series["time"][1], record.series["pto_force"][1][:, 0, 0]
    motion = record.series["motion"][1][:, 0]
    holds = stage_held[np.searchsorted(starts, t - 1e-9) - 1]
    assert holds.sum() > 10
    assert force == approx(np.where(holds, M * motion @ SPRINGS[0], 0.0), abs=1e-4 * LATCH * M)
    high, low = record.variables["pto_force"][1][0, 0, :2]
    assert max(high, -low) == approx(LATCH * M, rel=1e-3)


FAINT = 1e-3  # of the offset and the latch's load beside: the levers at which the float pushes the column are nothing


def on_a_column(scene, *, stiffer, node):
    """That float on a column's top, of `node` times its mass; faint, see FAINT."""
    steel = replace(awkward.STEEL, E=awkward.STEEL.E * stiffer, G=awkward.STEEL.G * stiffer)
    column = Member(name="column", start="foot", end="hinge:mass", elements=2, section=tube(0.8, 0.02), material=steel)
    nodes = {"foot": (0.0, 0.0, -8.0), "hinge:mass": (0.0, 0.0, 0.0)}
    frame = Frame(
        nodes=nodes, members=(column,), clamped=("foot",), masses=(PointMass(node="hinge:mass", mass=node * M),)
    )
    item = scene.floats[0]
    weak = tuple(FAINT * x for x in item.latch_load)
    return replace(
        scene, water=Water(depth=8.0), floats=(replace(item, offset=(0.0, FAINT), latch_load=weak),),
        platform=Platform(frame=frame, legs=("column",), hinge_nodes={"mass": "hinge:mass"}, damping_ratio=0.01),
        settings=replace(scene.settings, newton_tolerance=1e-13),
    )  # fmt: skip


def latched_on_a_column(system, seconds, glance=2e-4):
    """Surge at times (m,), and the share of the time in which it is held: modes, surge and sway by exponentials.

    A held axis has no acceleration, and what holds it is what its equation of motion then lacks.
    """
    model, t = linear_model(system), 0.0
    n = len(model.mass)
    i = n - 2

    def rates(holds):
        W, C, K = model.mass.copy(), model.damping.copy(), model.stiffness.copy()
        if holds:
            W[i], C[i], K[i] = np.eye(n)[i], 0.0, 0.0
        right = np.linalg.solve(W, np.concatenate([-K, -C], axis=1))
        return np.concatenate([np.eye(n, 2 * n, n), right])

    way = {holds: rates(holds) for holds in (True, False)}
    step = {holds: expm(way[holds] * glance) for holds in way}
    load = -(model.mass[i] @ way[True][n:] + np.concatenate([model.stiffness[i], model.damping[i]]))
    most = system.scene.floats[0].latch_load[0]
    over = lambda x: abs(load @ x) - most  # noqa: E731
    x = np.concatenate([np.zeros(i), system.start().z, np.zeros(n)])
    holds, stages = over(x) < 0, []
    while t < seconds:
        stages.append((t, holds, x))
        leaves = over if holds else (lambda y: y[n + i])
        before, now = x, step[holds] @ x
        while t < seconds and not (leaves(now) * leaves(before) < 0 and before is not x):
            t, before, now = t + glance, now, step[holds] @ now
        if t < seconds:
            tau = brentq(lambda s: leaves(expm(way[holds] * s) @ before), 0, glance, xtol=1e-14)  # noqa: B023
            t, x = t + tau, expm(way[holds] * tau) @ before
            x[n + i] = 0.0
            holds = not holds and over(x) < 0
    starts = np.array([s[0] for s in stages])
    lasting = np.diff(np.append(starts, seconds)) @ [s[1] for s in stages]

    def surge(times):
        mine = [stages[k] for k in np.searchsorted(starts, times) - 1]
        return np.array([(expm(way[s[1]] * (t - s[0])) @ s[2])[i] for t, s in zip(times, mine, strict=True)])

    return surge, lasting / seconds


@pytest.mark.parametrize(("stiffer", "node"), [(1.0, 20.0), (0.1, 2.0)])
def test_a_latch_on_an_elastic_platform_is_its_exponentials(stiffer, node):
    """Twelve modes up to 3474 rad/s, which ring from each jump of the load on: in pieces that they do not shorten surge
    is off by a hundredth. How long pieces are goes by the energy that they leave, near whose bound rounding decides:
    with the start's last digits surge is off by 7e-4 or by 2.3e-3 at the longest step."""
    seconds = 17.0
    item = partial(on_a_column, stiffer=stiffer, node=node)
    surge, share = latched_on_a_column(prepare(item(latched(0.1, seconds)), None), seconds)
    assert 0.1 < share < 0.2
    for dt, error in ((0.2, 4e-3), (0.05, 1e-3), (0.0125, 3e-4)):
        run = Run(item(latched(dt, seconds)))
        every = round(0.2 / (dt / 2))
        y, exact = (values[every - 1 :: every] for values in (run.y, surge(run.t)))
        assert y == approx(exact, abs=error * FAINT) and run.residual < 1e-4
        assert run.held.mean() == approx(share, abs=2 * error)


def test_a_latch_on_a_stiff_platform_is_one_on_a_fixed_support():
    """In proportion to the column's compliance and, as the float is beside it, to its top's lightness."""
    seconds = 17.0
    surge, _, _ = exact_latch(seconds)
    soft = np.array([0.1, 0.01, 0.001])
    runs = [Run(on_a_column(latched(0.05, seconds), stiffer=1 / x, node=20.0 / x)) for x in soft]
    errors = [np.abs(run.y / FAINT - surge(run.t)).max() for run in runs]
    assert errors[-1] < 1e-5 and np.polyfit(np.log(soft), np.log(errors), 1)[0] == approx(1, abs=0.1)


@pytest.mark.parametrize(("law", "open_by"), [
    ({"latch_load": 1e3}, 2e-4), ({"latch_load": 5e3}, 2e-4), ({"latch_load": 5e3, "pto_damping": 4e4}, 1e-3),
    ({"coulomb": 5e3}, 5e-5), ({"declutch_load": 8e3}, 5e-4),
])  # fmt: skip
def test_what_jumps_on_an_elastic_platform_keeps_the_energy(law, open_by):
    """As the waves grow, too, when little has been exchanged: a latch's runs ended within seconds, open by a tenth."""
    whole, h = awkward.unequal_legs()
    item = replace(whole.floats[0], **law)
    for dt in (0.2, 0.1, 0.05):
        settings = replace(whole.settings, duration=30.0, time_step=dt)
        run = Run(replace(whole, floats=(item,), settings=settings), known=h)
        assert run.residual < open_by and run.work(PTO) > 0


def test_a_power_take_off_lets_go_beyond_a_load_until_the_axis_turns_round():
    c, most = 0.5, 0.2
    run = Run(mass(0.1, 9.0, stiffness=M, offset=1.0, pto_damping=c * M, declutch_load=most * M))
    x, t, parts, taken, at_work = np.array([1.0, 0.0]), 0.0, [], 0.0, True
    while t < 9.0:
        rate = c if at_work else 0.0
        ends = (lambda _, y: most - c * abs(y[1])) if at_work else (lambda _, y: y[1])
        ends.terminal = True
        solved = solve_ivp(lambda _, y: [y[1], -y[0] - rate * y[1], rate * y[1] ** 2],  # noqa: B023
                           (t, 9.0), [*x, 0.0], events=ends, rtol=1e-11, atol=1e-13, dense_output=True,
                           first_step=1e-3)  # fmt: skip
        parts.append((t, solved.sol))
        t, x, taken, at_work = solved.t[-1], solved.y[:2, -1], taken + solved.y[2, -1], not at_work
    assert len(parts) > 4
    starts = [p[0] for p in parts]
    exact = [parts[np.searchsorted(starts, s) - 1][1](s)[0] for s in run.t]
    assert run.y == approx(exact, abs=2e-5)
    assert run.work(PTO) == approx(M * taken, rel=1e-4) and run.residual < 1e-5


POSITIONS, RATES = (-0.7, -0.1, 0.25, 0.9), (-1.5, -0.4, 0.0, 0.3, 1.6)


def grid(load, positions=POSITIONS, rates=RATES):
    return PtoTable(position=positions, velocity=rates, force=tuple(M * load(y, v) for y in positions for v in rates))


def test_a_load_straight_in_position_and_rate_is_a_spring_and_a_damper():
    law = {"offset": 0.8, "stiffness": 0.6 * M}
    ours = Run(mass(0.1, 8.0, pto_table=grid(lambda y, v: 0.4 * y + 0.3 * v), **law))
    plain = Run(mass(0.1, 8.0, pto_damping=0.3 * M, **law | {"stiffness": M}))
    assert ours.y == approx(plain.y, abs=2e-6)


def test_a_bilinear_load_is_followed_and_its_power_accounted_for():
    """Level beyond its ends, which the swing passes; what it gives back counts as less absorbed."""

    def load(y, v):
        return 0.1 + 0.2 * y + 0.5 * v + 0.6 * y * v

    def rates(_, x):
        inside = np.clip(x[0], POSITIONS[0], POSITIONS[-1]), np.clip(x[1], RATES[0], RATES[-1])
        f = load(*inside)
        return [x[1], -x[0] - f, f * x[1]]

    run = Run(mass(0.1, 8.0, stiffness=M, offset=1.6, pto_table=grid(load)))
    start = run.system.start().z[0]
    exact = solve_ivp(rates, (0, 8.0), (start, 0.0, 0.0), t_eval=run.t, rtol=1e-10, atol=1e-12, max_step=5e-3).y
    assert run.y == approx(exact[0], abs=2e-5)
    assert run.work(PTO) == approx(M * exact[2, -1], rel=1e-4) and run.residual < 1e-5
    # At rest it pushes: 0.1 + 1.2 y = 0.
    assert run.system.equilibrium[0] == approx([-0.1 / 1.2], abs=1e-9)


def test_pieces_of_a_table_meet_at_its_lines():
    dice = np.random.default_rng(1)
    y, v = np.array(POSITIONS), np.array(RATES)
    points = Points(y, v, dice.normal(size=(y.size, v.size)))
    one = tables([load_table.NO_POINTS, points])
    for at in dice.uniform(-2, 2, (60, 2)):
        piece = load_table.table_piece(one, 1, *at)
        inner = np.clip(at[0], y[0], y[-1]), np.clip(at[1], v[0], v[-1])
        lines = [np.interp(inner[1], v, row) for row in points.load]
        assert load_table.table_load(one, 1, piece, *at) == approx(np.interp(inner[0], y, lines), abs=1e-12)
        assert not load_table.beyond_piece(one, 1, piece, *at) > 0
        way = [load_table.table_piece(one, 1, *dice.uniform(-2, 2, 2))]
        while load_table.beyond_piece(one, 1, way[-1], *at) > 0:
            way.append(load_table.next_piece(one, 1, way[-1], *at))
            assert len(way) < 10
        assert way[-1] == piece


def test_tables_are_linearised_as_they_take_power():
    """Against means of f ẏ over a sine's phases and over the normal distribution; at rest the mean slope."""
    table = PtoTable(velocity=(0.0, 0.3, 0.5, 1.1), force=(0.0, 6e3, 7e3, 5e3))
    law = joint_law(mass(0.1, 1.0, pto_table=table).floats[:1])
    (_, v, (f,)), phase, x = table.points, (np.arange(20000) + 0.5) * np.pi / 20000, np.linspace(-9, 9, 40001)
    gaussian = np.exp(-(x**2) / 2) / np.exp(-(x**2) / 2).sum()
    cases = [
        (damping_of_harmonic, np.sin(phase), np.full(phase.size, 1 / phase.size)),
        (damping_of_gaussian, x, gaussian),
    ]
    for equivalent, shape, weight in cases:
        for size in (0.1, 0.4, 3.0):
            rate = size * shape
            taken = np.sum(weight * np.interp(rate, v, f) * rate) / np.sum(weight * rate**2)
            assert equivalent(law, np.array([size])) == approx([taken], rel=1e-5)
        assert equivalent(law, np.zeros(1)) == approx([2e4])
    assert table.alike and not grid(lambda y, v: v).alike
    assert not PtoTable(velocity=(-1.0, 0.0, 1.0), force=(-2.0, 0, 1)).alike


LAWS = {
    "latch": {"latch_load": (0.0, 4e4, 0.0), "pto_damping": (0.0, 1e5, 0.0)},
    "declutch": {"pto_damping": (0.0, 1e5, 0.0), "declutch_load": (np.inf, 1e4, np.inf)},
    "table": {"pto_table": PtoTable(position=(-0.1, 0.1), velocity=(-0.2, 0.0, 0.2), axis="heave",
                                    force=(-2e4, 0.0, 1e4, -1e4, 2e3, 3e4))},
}  # fmt: skip


@pytest.mark.parametrize("law", LAWS)
def test_control_in_waves_closes_the_balance_and_is_told(law):
    whole, known = awkward.soft_mooring()
    settings = replace(whole.settings, duration=30.0, discard=10.0, ramp=5.0, outputs=("pto_force", "pto_stroke"))
    record = simulate(replace(whole, floats=(replace(whole.floats[0], **LAWS[law]),), settings=settings), known)
    assert record.attrs["energy_residual"] < 1e-3 and record.attrs["work_pto"] > 0
    share = {name: values[1][0, 1] for name, values in record.variables.items() if name in ("latched", "declutched")}
    assert set(share) == {"latch": {"latched"}, "declutch": {"declutched"}, "table": set()}[law]
    stroke, travel, motion, rate = (
        record.variables[n][1][0] for n in ("pto_stroke", "pto_travel", "motion", "pto_rate")
    )
    assert stroke == approx(motion[:, 0] - motion[:, 1], rel=1e-12) and record.variables["pto_stroke"][0][1] == "axis"
    # Of a Gaussian rate the mean size is 0.8 of the rms, and in no case more than that.
    assert np.all((0.5 * rate[:, 3] < travel / 3600) & (travel / 3600 < rate[:, 3]))
    for of in share.values():
        assert 0.02 < of[2] < 0.98 and of[0] == 1.0 and of[1] == 0.0
        assert of[3:] == approx([np.sqrt(of[2]), np.sqrt(of[2] * (1 - of[2]))])  # as what is on or off
    if law == "declutch":
        power, force = (record.variables[name][1] for name in ("absorbed_power", "pto_force"))
        assert np.abs(force[0, 1, :2]).max() <= 1e4 and power[0, 1] >= 0


@pytest.mark.parametrize("lines", [(-1.0, 0.0, 1.0), (-1.0, 1.0)])
def test_a_table_whose_lines_cross_at_rest_is_left_where_the_float_goes(lines):
    """As a damper that it is: at rest between four pieces none of their borders tells which is next."""
    whole, known = awkward.soft_mooring()
    # One memory for both: of laws that may bend, and so drive the surge, it is fitted to that, too.
    settings = replace(whole.settings, duration=30.0, discard=10.0, ramp=5.0, memory_tolerance=1e-2)
    rates = (-2.0, 0.0, 2.0)
    straight = PtoTable(
        position=lines, velocity=rates, axis="heave", force=tuple(1e5 * v for _ in lines for v in rates)
    )
    laws = {"pto_table": straight}, {"pto_damping": (0.0, 1e5, 0.0)}
    one, other = (
        simulate(replace(whole, floats=(replace(whole.floats[0], **law),), settings=settings), known) for law in laws
    )
    for name in ("motion", "absorbed_power"):
        told, exact = one.variables[name][1], other.variables[name][1]
        assert told == approx(exact, rel=2e-3, abs=2e-3 * np.abs(exact).max()), name


@pytest.mark.parametrize("one_way", [1.0, -1.0])
@pytest.mark.parametrize("dt", [0.2, 0.1])
def test_friction_in_one_sense_alone(one_way, dt):
    """It holds in one sense and not at all in the other: an axis slips towards the nearer of the two loads."""
    whole, known = awkward.soft_mooring()
    settings = replace(whole.settings, duration=30.0, discard=0.0, ramp=0.0, time_step=dt)
    law = {"pto_damping": (0.0, 1e5, 0.0), "coulomb": (0.0, 1e4, 0.0), "one_way": (0.0, one_way, 0.0)}
    record = simulate(replace(whole, floats=(replace(whole.floats[0], **law),), settings=settings), known)
    assert record.attrs["energy_residual"] < 1e-3 and record.attrs["work_pto"] > 0


@pytest.mark.parametrize("one_way", [1.0, 0.5, -1.0])
def test_what_takes_power_one_way_alone_starts_from_rest(one_way):
    """In waves that grow from nothing: no load holds it there, whichever way it begins to move."""
    whole, known = awkward.soft_mooring()
    settings = replace(whole.settings, duration=30.0, discard=0.0, ramp=5.0, time_step=0.05, keep_series=True)
    law = {"pto_damping": (0.0, 1e5, 0.0), "one_way": (0.0, one_way, 0.0)}
    record = simulate(replace(whole, floats=(replace(whole.floats[0], **law),), settings=settings), known)
    assert record.attrs["energy_residual"] < 1e-3 and record.attrs["work_pto"] > 0
    mean, last = record.variables["absorbed_power"][1][0, 2], record.series["absorbed_power"][1][-1, 0]
    assert mean * 30.0 - last * 0.0125 == approx(record.attrs["work_pto"], rel=1e-4)  # whose last sample counts whole


def test_no_power_is_beyond_the_rate_at_which_a_power_take_off_lets_go():
    """Of samples before that rate, at it nearly, and after it the parabola's vertex is higher than the law allows."""
    scene = mass(0.1, 1.0, pto_damping=1e5, coulomb=2e3, declutch_load=1e4)
    recorder = Recorder(scene, None, layout=prepare(scene, None).layout)
    rate = np.array([[0.07], [0.079], [0.09], [0.2]])
    recorder.statistics["rates"] = rates = Statistics()
    rates.add(rate)
    recorder.statistics["absorbed_power"] = power = Statistics()
    recorder.shapes["absorbed_power"] = (1,)
    power.add(np.where(rate < 0.08, (2e3 + 1e5 * rate) * rate, 0.0))
    assert power.table()[0, 0] > 800.0
    assert recorder.tables()["absorbed_power"][0, 0] == approx(1e4 * 0.08)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: mass(0.1, 1.0, declutch_load=1e3), r"declutch_load = 1000.*needs pto_damping, which reaches it"),
        (lambda: mass(0.1, 1.0, declutch_load=1e3, force_limit=1e3, pto_damping=1.0), r"left out beside a force_limit"),
        (lambda: mass(0.1, 1.0, declutch_load=1e3, pto_damping=1.0, coulomb=2e3), r"coulomb = 2000.*< declutch_load"),
        (lambda: mass(0.1, 1.0, declutch_load=1e3, pto_damping=1.0, pto_stiffness=1.0), r"0 beside a declutch_load"),
        (lambda: mass(0.1, 1.0, latch_load=1.0, pto_table=grid(lambda y, v: v)), r"needs latch_load to be left out"),
        (lambda: PtoTable(position=(0.0,), velocity=(-1.0, 1.0), force=(0.0, 1.0)), r"position = 1: must be 2 to 500"),
        (lambda: PtoTable(position=(0, 1), velocity=(-1, 1), force=(0.0, 1)), r"at each of 2 positions; there are 2"),
        (lambda: PtoTable(position=(1, 0), velocity=(-1, 1), force=(0.0,) * 4), r"position = 0: must increase"),
        (lambda: PtoTable(position=(0, 1), velocity=(0, 1), force=(0.0, 1, 0.5, 1)), r"force = 0.5: must be 0 at rate"),
    ],
)  # fmt: skip
def test_control_that_cannot_be_is_refused(build, message):
    with pytest.raises(InputError, match=message):
        build()


def test_methods_without_control_say_so():
    bare = mass(0.1, 1.0, latch_load=5.0)
    for path in ({"method": "frequency", "froude_krylov": "linear"}, {"formulation": "augmented"}):
        with pytest.raises(InputError, match=r"floats\.mass\.latch_load = 5.*needs"):
            replace(bare, settings=replace(bare.settings, **path))
    assert prepare(bare, None).bent.tolist() == [0] and HOLDS == 3


def test_a_straight_table_is_a_damper_in_the_frequency_domain():
    whole, known = awkward.soft_mooring()
    settings = replace(whole.settings, method="frequency", outputs=("pto_force", "pto_stroke"))
    table = PtoTable(velocity=(0.0, 0.02, 9.0), force=(0.0, 2e3, 9e5), axis="heave")
    laws = ({"pto_table": table}, {"pto_damping": (0.0, 1e5, 0.0)})
    ours, plain = (
        simulate(replace(whole, floats=(replace(whole.floats[0], **law),), settings=settings), known) for law in laws
    )
    for name in ("motion", "absorbed_power", "pto_force", "pto_rate"):
        values = plain.variables[name][1]
        assert ours.variables[name][1] == approx(values, rel=1e-6, abs=1e-9 * np.abs(values).max()), name


@pytest.mark.parametrize(
    "law", [{"force_limit": 2e4}, {"end_stops": EndStops(lower=-0.05, upper=0.05, stiffness=2e8, damping=1e6)}]
)
def test_a_float_on_a_pile_s_bare_head_may_be_limited_and_stopped(law):
    """Where a load bends, an arm joined to a node of next to no inertia goes on otherwise than the step foretold.

    Taken into its law's next zone half way to the border, or by Newton's method from an acceleration that lasts
    microseconds, it left everything finite.
    """
    pile = Member(
        name="pile", start="foot", end="hinge:float", elements=10, section=tube(1.2, 0.03), material=awkward.STEEL,
        drag_coefficient=1.0, inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(nodes={"foot": (0, 0, -20.0), "hinge:float": (0, 0, 3.0)}, members=(pile,), clamped=("foot",))
    hull = Revolution.hemisphere_cylinder(radius=1.2, height=1.5)
    item = Float(
        name="float", hull=hull, mass=awkward.RHO * hull.volume, inertia=(3e3,) * 3, hinge=(0, 0, 3.0),
        arm=(-4.0, 0, -3.0), pto_damping=1e6, damping=3e4, **law,
    )  # fmt: skip
    rough = {"waves": awkward.sea(Hs=2.0, Tp=6.0), "radiation": False, "diffraction": False, "duration": 60.0}
    whole = awkward.scene(
        [item], depth=20.0, platform=Platform(frame=frame, hinge_nodes={"float": "hinge:float"}), **rough
    )
    run, finer = (simulate(replace(whole, settings=replace(whole.settings, time_step=dt))) for dt in (0.2, 0.02))
    assert run.attrs["repeated"] == "" and run.attrs["energy_residual"] < 1e-3
    rotation, true = (r.variables["rotation"][1][0, STATISTICS.index("std")] for r in (run, finer))
    assert rotation == approx(true, rel=0.02)
