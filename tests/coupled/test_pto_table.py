"""Power take-offs by a table of load and rate: against a damper, a limited one, and an integrator of its own."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import solve_ivp

from solver.coupled.assembly import joint_law
from solver.coupled.energy import PTO
from solver.errors import InputError
from solver.mooring import Mooring
from solver.multibody.joint_law import OPEN, PTO_ZONE, axis_damping, axis_load, tangent
from solver.multibody.of_axes import absorbing, bent
from solver.multibody.zones import leaving, next_zone, pto_zone
from solver.power_takeoff import PtoTable
from solver.run import simulate
from tests import awkward
from tests.coupled.test_pieces import M, Run, mass

DAMPING = 0.3 * M
LOPSIDED = PtoTable(velocity=(-0.8, -0.5, -0.2, 0.0, 0.1, 0.4, 0.6), force=(-700.0, -300, 0, 0, 250, 300, 100))


def swing(dt=0.1, seconds=8.0, **law):
    return Run(mass(dt, seconds, stiffness=M, offset=1.0, **law))


def line(*rates):
    return PtoTable(velocity=rates, force=tuple(DAMPING * v for v in rates))


@pytest.mark.parametrize("rates", [(0.0, 2.0), (0.0, 0.1, 0.2, 0.55, 2.0), (-3.0, -0.3, 0.2, 4.0)])
def test_a_straight_line_is_a_damper(rates):
    """Steps end where a piece of the line does: what differs is their own error, of fourth order."""
    ours, damper = swing(pto_table=line(*rates)), swing(pto_damping=DAMPING)
    zeta = DAMPING / M / 2
    turn = np.sqrt(1 - zeta**2)
    exact = np.exp(-zeta * ours.t) * (np.cos(turn * ours.t) + zeta / turn * np.sin(turn * ours.t))
    assert ours.y == approx(exact, abs=1e-6) and ours.y == approx(damper.y, abs=1e-6)
    assert ours.work(PTO) == approx(damper.work(PTO), rel=1e-5)


def test_level_beyond_its_end_it_is_a_damper_with_a_limit():
    table = PtoTable(velocity=(0.0, 0.4), force=(0.0, 0.4 * DAMPING))
    ours, limited = swing(pto_table=table), swing(pto_damping=DAMPING, force_limit=0.4 * DAMPING)
    assert ours.y == approx(limited.y, abs=1e-6)
    assert np.abs(ours.y - swing(pto_damping=DAMPING).y).max() > 0.01


def test_a_lopsided_table_is_followed_to_fourth_order_and_its_power_accounted_for():
    _, v, (f,) = LOPSIDED.points

    def rates(t, x):
        return [x[1], -x[0] - np.interp(x[1], v, f) / M]

    exact = solve_ivp(rates, (0, 8), (1.0, 0.0), rtol=1e-11, atol=1e-12, max_step=0.01).y[0, -1]
    steps = np.array([0.4, 0.2, 0.1])
    runs = [swing(dt, pto_table=LOPSIDED) for dt in steps]
    error = np.abs([run.y[-1] - exact for run in runs])
    assert error[-1] < 1e-6 and np.polyfit(np.log(steps), np.log(error), 1)[0] > 3
    assert runs[-1].residual < 1e-6


def test_the_law_is_the_table_and_its_zones_are_its_pieces():
    law = joint_law((replace(awkward.soft_mooring()[0].floats[0], pto_table=replace(LOPSIDED, axis="heave")),))
    _, v, (f,) = LOPSIDED.points
    assert bent(law).tolist() == absorbing(law).tolist() == [False, True, False]
    for dy in np.random.default_rng(0).uniform(-1, 1, 40):
        zone = pto_zone(law, 1, 0.0, dy)
        assert axis_load(law, 1, OPEN, zone, 0.0, dy).pto == approx(np.interp(dy, v, f), abs=1e-9)
        assert not leaving(law, 1, PTO_ZONE, zone, 0.0, dy) > 0
        slope = (np.interp(dy + 1e-7, v, f) - np.interp(dy - 1e-7, v, f)) / 2e-7
        assert tangent(law, 1, OPEN, zone)[1] + axis_damping(law, 1) == approx(slope + 0.0, abs=1e-3)
        other = pto_zone(law, 1, 0.0, -dy)
        while leaving(law, 1, PTO_ZONE, other, 0.0, dy) > 0:
            other = next_zone(law, 1, PTO_ZONE, other, 0.0, dy)
        assert other == zone


def test_in_waves_energy_closes_and_the_reference_path_agrees():
    whole, known = awkward.soft_mooring()
    table = PtoTable(velocity=(-0.3, -0.05, 0.0, 0.1, 0.2), force=(-4e4, -2e4, 0, 1e4, 5e4), axis="heave")
    settings = replace(whole.settings, duration=20.0, discard=0.0, ramp=5.0, time_step=0.05, keep_series=True,
                       outputs=("pto_force",))  # fmt: skip
    scene = replace(whole, floats=(replace(whole.floats[0], pto_table=table),), settings=settings)
    fast = simulate(scene, known)
    assert fast.attrs["energy_residual"] < 1e-3 and fast.attrs["work_pto"] > 0
    extremes = fast.variables["pto_force"][1][0, 1, :2]
    assert np.all(np.abs(extremes) <= 5e4) and extremes[0] > 1e3 > -1e3 > extremes[1]
    brief = replace(scene, settings=replace(settings, duration=8.0))
    slow = simulate(replace(brief, settings=replace(brief.settings, formulation="augmented")), known)
    y = slow.series["motion"][1][:, 0]
    # Which does not end its steps where the table bends; the memory is fitted for a record's length.
    assert y == approx(simulate(brief, known).series["motion"][1][:, 0], abs=1e-3 * np.abs(y).max())


def test_on_an_elastic_platform_a_line_is_a_damper_and_a_mooring_of_one_axis_a_spring():
    whole, known = awkward.unequal_legs()
    whole = replace(whole, settings=replace(whole.settings, duration=20.0, discard=5.0, ramp=5.0, time_step=0.1))
    (item,) = whole.floats
    table = PtoTable(velocity=(0.0, 0.02, 5.0), force=(0.0, 2e3, 5e5))
    lines = Mooring(stiffness=((3e4,),), damping=((2e3,),), pretension=(500.0,))
    pairs = [
        (replace(item, pto_damping=0.0, pto_table=table), item, 3e-4),
        (replace(item, mooring=lines), replace(item, stiffness=3e4, damping=2e3, preload=500.0), 0.0),
    ]
    # The table cuts steps, of which pieces tell the mean, where trapezoids through samples do of whole ones.
    for ours, plain, apart in pairs:
        a, b = (simulate(replace(whole, floats=(f,)), known) for f in (ours, plain))
        for name in ("rotation", "absorbed_power", "hinge_force", "top_displacement", "bottom_stress"):
            values = b.variables[name][1][..., 2:]
            assert a.variables[name][1][..., 2:] == approx(values, rel=0, abs=apart * np.abs(values).max()), name
        assert a.attrs["energy_residual"] < 1e-3


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: PtoTable(velocity=(0.0,), force=(0.0,)), r"pto_table.velocity = 1: must be 2 to 500 rates"),
        (lambda: PtoTable(velocity=(0.0, 1.0), force=(0.0,)), r"a load for each; there are 1 loads"),
        (lambda: PtoTable(velocity=(0.0, 2.0, 1.0), force=(0, 1, 2)), r"= 1.0: must increase; it follows 2"),
        (lambda: PtoTable(velocity=(0.5, 2.0), force=(1.0, 2.0)), r"must begin at 0, for both senses alike, or below"),
        (lambda: PtoTable(velocity=(-1.0, 1.0), force=(2.0, 2.0)), r"must take power: no load along .* here at -1"),
        (lambda: PtoTable(velocity=(-1.0, 1.0), force=(-2.0, 3.0)), r"= 0.5: must be 0 at rate 0"),
        (lambda: mass(0.1, 1.0, pto_table=line(0, 1), pto_damping=1.0), r"needs pto_damping to be left out"),
        (lambda: mass(0.1, 1.0, pto_table=replace(line(0, 1), axis="heave")), r"pto_table.axis = heave: must be one"),
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused(build, message):
    with pytest.raises(InputError, match=message):
        build()
