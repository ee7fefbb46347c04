"""What the tables of power take-offs' laws leave out, told by each record, against tables of many points."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import j1

from pipeline.bridge.pto_law import table
from pipeline.study.attachments import Attachment
from solver.hydrodynamics.hull.revolution import Revolution
from solver.power_takeoff import PtoTable
from solver.record import probe
from solver.record.accuracy import DEFAULT
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import regular
from solver.statistics import apart
from tests.awkward import MODEL, RHO, SCENES, scene

LAW = b"""
import math
def load(y, dy, c, v, a):
    return c * v * math.tanh(dy / v) if not a else c * dy * (1.5 * (y / a) ** 2 - 0.2)
"""
JUDGED = ("rotation", "motion", "absorbed_power")
RADIUS, DRAFT, GRAVITY = 2.0, 3.0, 9.81
MASS, STIFFNESS = RHO * np.pi * RADIUS**2 * DRAFT, RHO * GRAVITY * np.pi * RADIUS**2


def law(damping, rate, place=0.0, *, error=0.01, axis=""):
    """Linear damping up to a typical rate; or, with a typical place, some that gives at rest what it takes off it."""
    ends = (-4 * rate, 4 * rate), (-4 * place, 4 * place) if place else None
    return table(Attachment.of("law.py", LAW), *ends, error, (damping, rate, place), axis)


def heaving(waves, pto, **settings):
    """A cylinder of one degree of freedom, without radiation."""
    hull = Revolution.vertical_cylinder(radius=RADIUS, draft=DRAFT, freeboard=2.0)
    item = Float(
        name="cyl", hull=hull, mass=MASS, inertia=(1e5,) * 3, cog=(0, 0, -1.0), hinge=(0, 0, 0), motion=("heave",),
        pto_table=pto,
    )  # fmt: skip
    given = {"froude_krylov": "linear", "diffraction": False, "radiation": False, "time_step": 0.1} | settings
    return scene([item], depth=np.inf, waves=waves, **given)


def with_law(name, pto, time_step):
    whole, h = SCENES[name]()
    item = replace(whole.floats[0], pto_damping=0.0, pto_table=pto)
    return replace(whole, floats=(item, *whole.floats[1:]), settings=replace(whole.settings, time_step=time_step)), h


CASES = {
    "regular": lambda: (heaving(regular(height=1.0, period=5.0), law(4e4, 0.3)), None),
    "irregular": lambda: (heaving(None, law(4e4, 0.4, 0.4)), None),
    "hinge, body-nonlinear": lambda: with_law("duck", law(8e4, 0.1), 0.15),
    "radiating, by position": lambda: with_law("soft_mooring", law(3e5, 0.15, 0.2, axis="heave"), 0.2),
    "model": lambda: with_law("model_scale", law(8e5 * MODEL**4.5, 0.1 / MODEL**0.5), 0.15 * MODEL**0.5),
    "elastic": lambda: with_law("unequal_legs", law(2e5, 0.1), 0.15),
}  # fmt: skip


QUICK = ("irregular", "hinge, body-nonlinear")


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n not in QUICK)) for n in CASES])
def test_records_tell_what_their_tables_leave_out(name):
    """True error over estimate between 1/3 and 3."""
    item, h = CASES[name]()
    first = item.floats[0]
    exact = replace(item, floats=(replace(first, pto_table=first.pto_table.finer.finer), *item.floats[1:]))
    usual, fine = simulate(item, h), simulate(exact, h)
    true = max(apart(*(x.variables[k][1] for x in (usual, fine))) for k in JUDGED if k in fine.variables)
    told = usual.attrs["law_effect"]
    assert true > 5e-4 and 1 / 3 < true / told < 3, (true, told)
    assert usual.attrs["estimated_error"] >= told and fine.attrs["law_effect"] == 0


HEIGHT, PERIOD = 1.0, 4.5
PUMP = b"def load(y, dy):\n    return -4e3 * dy + 6e3 * y * y * dy\n"


def pumped(**settings):
    """A law that gives power near rest, over a range far wider than the motion; for 40 periods after 40."""
    pto = table(Attachment.of("law.py", PUMP), (-5.0, 5.0), (-4.0, 4.0), 0.01, (), "")
    times = {"duration": 40 * PERIOD, "discard": 40 * PERIOD, "ramp": 0.0}
    return heaving(regular(height=HEIGHT, period=PERIOD), pto, **times | settings)


def exact():
    """Statistics of motion and power in the same wave, whose pressure on the bottom is ρg a e^(-kd) 2 J₁(kr)/kr."""
    omega = 2 * np.pi / PERIOD
    k = omega**2 / GRAVITY
    force = HEIGHT / 2 * STIFFNESS * np.exp(-k * DRAFT) * 2 * j1(k * RADIUS) / (k * RADIUS)

    def load(y, dy):
        return (-4e3 + 6e3 * y**2) * dy

    def rates(t, x):
        return [x[1], (force * np.cos(omega * t) - STIFFNESS * x[0] - load(*x)) / MASS]

    t = np.linspace(40 * PERIOD, 80 * PERIOD, 8001)[1:]
    y, dy = solve_ivp(rates, (0, t[-1]), (0.0, 0.0), t_eval=t, rtol=1e-9, atol=1e-9).y
    channels = {"motion": y, "absorbed_power": load(y, dy) * dy}
    return {name: table_of(x) for name, x in channels.items()}


def table_of(x):
    return np.array([x.max(), x.min(), x.mean(), np.sqrt(np.mean(x**2)), x.std()])


@pytest.mark.slow
def test_a_run_goes_on_by_a_finer_table_where_its_start_tells_that_it_must():
    """Unless its step is given, or by the tolerance; and `unmet` names the law where no table is fine enough."""
    given = simulate(pumped())
    chosen, asked, strict = (simulate(pumped(time_step=None, tolerance=t)) for t in (None, 2e-2, 1e-3))
    own = exact()
    true = [max(apart(x.variables[k][1].reshape(-1), own[k]) for k in own) for x in (given, chosen, asked)]
    assert true[0] > 2e-2 and 1 / 3 < true[0] / given.attrs["law_effect"] < 3, (true, given.attrs["law_effect"])
    for error, record in zip(true[1:], (chosen, asked), strict=True):
        assert error < true[0] / 3 and error < 3 * record.attrs["estimated_error"], true
        assert record.attrs["law_effect"] < given.attrs["law_effect"] / 5
    assert given.attrs["law_effect"] > DEFAULT and asked.attrs["unmet"] == ""
    assert "by law_effect" in strict.attrs["unmet"]


def test_a_bilinear_law_costs_no_error_and_a_scene_without_one_no_run(monkeypatch):
    straight = table(
        Attachment.of("law.py", b"def load(y, dy): return 2e4 * dy - 3e4 * y"), (-5, 5), (-4, 4), 0.01, (), ""
    )
    waves = regular(height=HEIGHT, period=PERIOD)
    assert simulate(heaving(waves, straight, duration=20.0)).attrs["law_effect"] < 1e-12
    made = []
    monkeypatch.setattr(probe, "prepare", lambda *given: made.append(given))
    plain = heaving(waves, replace(straight, finer=None), duration=20.0)
    assert simulate(plain).attrs["law_effect"] == 0 and not made


@pytest.mark.parametrize("period", [3.06, 3.345])
def test_steps_pass_one_line_after_the_other_where_these_lie_close(period):
    """Twenty lines in a step, some of them passed within an eighth of what is left of it."""
    v = np.linspace(-2, 2, 401)
    close = PtoTable(velocity=tuple(v.tolist()), force=tuple((1e5 * (v + v * np.abs(v))).tolist()))
    few = heaving(regular(height=3.0, period=period), close, duration=30.0, time_step=0.3)
    item = replace(few.floats[0], pto_table=None, damping=1e5, quadratic_damping=1e5)
    record, exact = simulate(few), simulate(replace(few, floats=(item,)))
    assert not record.attrs["repeated"]
    assert apart(*(x.variables["motion"][1] for x in (record, exact))) < 2e-3


def test_in_the_frequency_domain_too():
    few = heaving(None, law(4e4, 0.4), method="frequency", time_step=None)
    pto = few.floats[0].pto_table
    fine = replace(few, floats=(replace(few.floats[0], pto_table=pto.finer.finer),))
    usual, exact = simulate(few), simulate(fine)
    true = max(apart(*(x.variables[k][1] for x in (usual, exact))) for k in JUDGED[1:])
    assert 1 / 3 < true / usual.attrs["law_effect"] < 3 and usual.attrs["estimated_error"] >= usual.attrs["law_effect"]


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_motion_beyond_what_a_law_is_given_for_is_among_the_warnings(method):
    """With what was met; not where it stays within, nor where the load is level at its end, as a limit's is."""
    waves = None if method == "frequency" else regular(height=HEIGHT, period=PERIOD)
    settings = {"method": method, "outputs": ("pto_stroke",)} | ({"time_step": None} if waves is None else {})

    def told(velocity, force, position=()):
        pto = PtoTable(velocity=velocity, force=force, position=position)
        record = simulate(heaving(waves, pto, **settings))
        return record, record.attrs.get("warnings", "")

    record, text = told((0.0, 0.1), (0.0, 2e3))
    most = record.variables["pto_rate"][1][0, 0, 0]
    found = re.search(r"floats.cyl: the rate of heave was (\S+) to (\S+) m/s, beyond -0.1 to \+0.1 m/s", text)
    assert most > 0.2 and float(found[2]) >= 0.99 * most
    assert "the rate" not in told((0.0, 9.0), (0.0, 1.8e5))[1] + told((0.0, 0.1, 0.2), (0.0, 2e3, 2e3))[1]
    if method == "time":
        assert "position of heave was" in told((-9.0, 9.0), (-1.8e5, 1.8e5, -1.7e5, 1.9e5), (-0.1, 0.1))[1]
