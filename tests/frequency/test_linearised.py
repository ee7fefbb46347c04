"""How far a linearised power take-off is from the march, as each record tells, and where friction holds an axis."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pytest import approx

from solver.coupled.assembly import joint_law
from solver.frequency import gaussian, shape, yielding
from solver.frequency.response import respond
from solver.hydrodynamics.hull.revolution import Revolution
from solver.multibody.linearised import EVEN, GAUSSIAN, rest
from solver.power_takeoff import PtoTable
from solver.record.probe import UNTOLD
from solver.run import simulate
from solver.scene import Float
from solver.sea.realization import components, regular
from tests.awkward import RHO, SCENES, known, scene, sea

LONG = {"duration": 1800.0, "discard": 100.0, "froude_krylov": "linear"}
JUDGED = ("motion", "rotation", "absorbed_power", "pto_force", "hinge_force")


def heaving(name, radius, x=0.0, **law):
    hull = Revolution.sphere(radius=radius, draft=radius)
    fields = {"mass": RHO * hull.volume, "inertia": (1e5,) * 3, "hinge": (x, 0, 0), "motion": ("heave",)}
    return Float(name=name, hull=hull, **fields, **law)


@cache
def hemisphere():
    """Alone, in a sea and a wave that load it by 40 kN (std), and 33 kN."""
    whole = scene([heaving("a", 3.0)], depth=np.inf, waves=sea(Tp=6.0, band=(0.5, 2.6)), **LONG)
    return whole, known(whole, 0.3, 5.0, 30)


@cache
def pair():
    """The same with a smaller one behind it, which has a damper."""
    whole = hemisphere()[0]
    both = replace(whole, floats=(*whole.floats, heaving("b", 2.0, 9.0, pto_damping=2e4)))
    return both, known(both, 0.3, 5.0, 30)


@cache
def hinged():
    """Loaded by 12 kN m."""
    whole, h = SCENES["duck"]()
    return replace(whole, settings=replace(whole.settings, **LONG)), h


@cache
def flap():
    """Its joint bears most of what waves load it by."""
    whole, h = SCENES["flap"]()
    return replace(whole, sea=sea(Hs=0.2, Tp=5.0, band=(0.9, 2.6)), settings=replace(whole.settings, **LONG)), h


def given(build, law, *, one):
    whole, h = build()
    item = replace(whole, floats=(replace(whole.floats[0], **{"pto_damping": 0.0} | law), *whole.floats[1:]))
    if one:
        settings = replace(whole.settings, duration=100.0, discard=200.0)
        item = replace(item, sea=regular(height=0.4 if build is hinged else 0.6, period=5.0), settings=settings)
    return item, h


def by_lines(item, h, **settings):
    return simulate(replace(item, settings=replace(item.settings, method="frequency", **settings)), h)


def damped(damping, **law):
    """With as much linear damping about the law's."""
    return law | {"damping": damping}


CASES = [
    (hemisphere, {"coulomb": 1e4}), (hemisphere, damped(3e4, coulomb=1e4)), (hemisphere, damped(3e4, coulomb=3e4)),
    (pair, damped(2e4, coulomb=2e4)), (hinged, damped(4e4, coulomb=6e3)), (hinged, damped(4e4, coulomb=1.2e4)),
    (hemisphere, {"pto_damping": 1e5, "force_limit": 1.5e4}), (hinged, {"pto_damping": 2e5, "force_limit": 3e3}),
    (hinged, {"pto_damping": 2e5, "force_limit": 1e4}), (hemisphere, {"pto_damping": 2e4, "quadratic_damping": 5e4}),
    (hinged, {"pto_damping": 1e4, "quadratic_damping": 4e5}), (pair, {"pto_damping": 2e4, "quadratic_damping": 5e4}),
    (flap, {"coulomb": 3e4}), (flap, {"coulomb": 1e5}),
]  # fmt: skip


@pytest.mark.parametrize("one", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["sea", "wave"])
@pytest.mark.parametrize(("build", "law"), CASES)
def test_what_linear_damping_leaves_is_told(build, law, one):
    """Against the march, within a factor of 3; which is most of the error."""
    compare(*given(build, law, one=one))


@cache
def cylinder():
    """1:50, in heave."""
    hull = Revolution.vertical_cylinder(radius=0.1, draft=0.12, freeboard=0.1)
    item = Float(
        name="a", hull=hull, mass=RHO * hull.volume, inertia=(0.01,) * 3, hinge=(0, 0, 0), motion=("heave",)
    )  # fmt: skip
    settings = LONG | {"duration": 1500.0, "discard": 20.0, "ramp": 5.0}
    whole = scene([item], depth=np.inf, waves=sea(Hs=0.05, Tp=1.1, band=(3.0, 14.0)), **settings)
    return whole, known(whole, 2.5, 20.0, 40)


GIVING = PtoTable(velocity=(0.0, 0.0125, 0.025, 0.05, 0.1, 0.3), force=(0.0, 1.5e4, 2.56e4, 3.4e4, 3.84e4, 4e4))
GIVES = [
    (hinged, {"pto_table": GIVING}), (hemisphere, {"pto_damping": 4e5, "force_limit": 8e4}),
    (hemisphere, {"pto_damping": 1e6, "force_limit": 8e4}), (cylinder, {"pto_damping": 200.0, "force_limit": 4.0}),
]  # fmt: skip


@pytest.mark.parametrize(("build", "law"), GIVES)
def test_groups_of_waves_that_a_damper_gives_way_to_are_told(build, law):
    """It holds the axis but in these, in which motions grow by up to as much again."""
    compare(*given(build, law, one=False))


EASING = PtoTable(velocity=(0.0, 0.0045, 0.018, 0.054, 0.134), force=(0.0, 2.4, 6.4, 11.2, 14.4))
SMALL = [
    *({"pto_damping": 20.0, "force_limit": limit} for limit in (0.2, 0.4, 0.8, 1.6)), damped(5.0, coulomb=0.3),
    *({"pto_damping": 2.0, "quadratic_damping": drag} for drag in (15.0, 60.0, 240.0)), {"pto_table": EASING},
]  # fmt: skip


@pytest.mark.parametrize(
    "law", [pytest.param(law, marks=[pytest.mark.slow] * (n % 4 > 0)) for n, law in enumerate(SMALL)]
)
def test_what_linear_damping_leaves_is_told_of_a_model(law):
    compare(*given(cylinder, law, one=False))


def compare(item, h):
    """Of every mean, rms and std that is not next to nothing beside others of its kind; by several records where there
    is less to tell than one of them scatters."""
    item = replace(item, settings=replace(item.settings, outputs=("pto_force",)))
    marches, lines = [simulate(item, h)], by_lines(item, h)
    if item.sea.omega.size > 1 and item.floats[0].per_axis("quadratic_damping").any():
        for seed in range(4):
            turned = np.exp(2j * np.pi * np.random.default_rng(seed).random(item.sea.omega.size))
            sea_too = replace(item.sea, amplitude=item.sea.amplitude * turned)
            marches.append(simulate(replace(item, sea=sea_too), h))
    true = max(
        error(np.mean([march.variables[name][1] for march in marches], axis=0), lines.variables[name][1])
        for name in JUDGED if name in lines.variables
    )  # fmt: skip
    told = lines.attrs["linearisation_effect"]
    assert true > 2e-3 and 1 / 3 < told / true < 3, (true, told)
    assert lines.attrs["estimated_error"] >= told


@pytest.mark.parametrize("law", [
    {"pto_damping": 2.0, "quadratic_damping": 60.0}, {"pto_damping": 20.0, "force_limit": 0.8}, damped(20.0),
])  # fmt: skip
def test_extremes_are_of_rates_and_motions_of_the_shape_that_loads_make(law):
    """Kurtosis within 0.3 of the march's, and by that the largest motion of long records within 20 %: those of Gaussian
    ones are 28 % above the first."""
    item, h = given(cylinder, law, one=False)
    item = replace(item, settings=replace(item.settings, duration=3000.0, keep_series=True))
    march, lines = simulate(item, h), by_lines(item, h, keep_series=False)
    y, t = march.series["motion"][1][:, 0, 0], march.series["time"][1]
    known = respond(replace(item, settings=replace(item.settings, method="frequency", keep_series=False)), h).excess
    for x, kappa in zip((np.gradient(y, t), y), known[:, 0], strict=True):
        assert np.mean(x**4) / np.mean(x**2) ** 2 - 3 == approx(kappa, abs=0.3)
    most, told = (np.abs(x.variables["motion"][1][0, 0, :2]).mean() for x in (march, lines))
    assert told == approx(most, rel=0.2)
    assert known.any() == (law != damped(20.0))


@pytest.mark.parametrize(("law", "waves"), [
    ({"quadratic_damping": (5e4, 0.0, 0.0)}, {"Hs": 1.0, "Tp": 8.0}),
    ({"quadratic_damping": (2e5, 4e5, 1e7)}, {"Hs": 1.0, "Tp": 7.0}),
])  # fmt: skip
def test_what_a_rest_moves_below_the_waves_is_told(law, waves):
    """By three waves' differences, where a soft mooring resonates: linear damping knows of none there."""
    whole, h = SCENES["soft_mooring"]()
    settings = replace(whole.settings, duration=3600.0, discard=1500.0)
    item = replace(whole, sea=sea(**waves, band=(0.5, 2.0)), settings=settings)
    soft = replace(item, floats=(replace(item.floats[0], **law),))
    lines, march = by_lines(soft, h), simulate(soft, h)
    true = error(*(record.variables["motion"][1][0] for record in (march, lines)))
    assert true > 0.05 and 1 / 3 < lines.attrs["linearisation_effect"] / true < 3
    free = replace(soft, floats=(replace(soft.floats[0], stiffness=0.0),))
    assert by_lines(free, h).attrs["linearisation_effect"] > 1  # it drifts: 0.8 of the march's std is not known


def error(true, table):
    true, table = (x.reshape(-1, 5) for x in (true, table))
    moves = true[:, 3] > 1e-2 * np.nanmax(true[:, 3])
    mean, rms, std = np.abs(table - true)[moves, 2:].T
    return max(np.max(np.maximum(mean, rms) / true[moves, 3]), np.max(std / true[moves, 4]))


@pytest.mark.parametrize(("one", "coulomb"), [(False, 2e4), (True, 1e5)], ids=["sea", "wave"])
def test_a_joint_bears_what_friction_has_beyond_linear_damping(one, coulomb):
    """The std of its force across the axis within 2 %, of which the waves' lines have 5 % less and more."""
    item, h = given(flap, {"coulomb": coulomb}, one=one)
    march, lines = (x.variables["hinge_force"][1][0, 0, 4] for x in (simulate(item, h), by_lines(item, h)))
    assert lines == approx(march, rel=0.02)
    response = respond(replace(item, settings=replace(item.settings, method="frequency")), h)
    assert np.sqrt(np.sum(np.abs(response.wrench[:, 0, 0]) ** 2) / 2) < 0.95 * march


def test_linear_dampers_leave_nothing():
    assert by_lines(*given(hemisphere, {"damping": 3e4}, one=False)).attrs["linearisation_effect"] == 0.0
    unreached = {"pto_damping": 1e5, "force_limit": 4e4}
    assert by_lines(*given(hemisphere, unreached, one=True)).attrs["linearisation_effect"] < 1e-9
    assert by_lines(*given(hemisphere, unreached, one=False)).attrs["linearisation_effect"] > 1e-4


def test_the_rest_of_a_load_is_what_no_damping_takes():
    """Of friction F (1 - 2/π)^½ and F (1 - 8/π²)^½; of d|v|v, √(3 - 8/π) d σ²; of linear damping none."""
    item, _ = pair()
    a, b = item.floats
    law = joint_law((replace(a, coulomb=1e4, damping=5e3), b, replace(a, name="c", quadratic_damping=7e3)))
    std = np.array([0.3, 0.2, 0.5])
    friction, none, drag = rest(law, std, GAUSSIAN[:, None])
    assert friction == approx(1e4 * np.sqrt(1 - 2 / np.pi), rel=2e-3) and none < 1e-9 * 2e4
    assert drag == approx(7e3 * np.sqrt(3 - 8 / np.pi) * 0.25, rel=3e-2)  # tails
    harmonic = np.sqrt(2) * np.sin(2 * np.pi * EVEN)[:, None]
    assert rest(law, std, harmonic)[0] == approx(1e4 * np.sqrt(1 - 8 / np.pi**2), rel=2e-3)
    assert rest(law, np.zeros(3), GAUSSIAN[:, None]) == approx(np.zeros(3))


@pytest.mark.parametrize(("one", "coulomb", "slips"), [
    (False, 3.5e4, None), (False, 5.2e4, True), (False, 8e4, True), (False, 1.6e5, False),
    (True, 3e4, None), (True, 4.5e4, True), (True, 8e4, False),
])  # fmt: skip
def test_a_float_that_friction_holds_is_no_result_unless_it_never_moves(one, coulomb, slips):
    """It moves where √(2/π) F_c is less than 40 kN (std), 142 kN the largest; in one wave 4/π F_c less than 47 kN."""
    item, h = given(hemisphere, damped(3e4, coulomb=coulomb), one=one)
    told, march = by_lines(item, h, outputs=("pto_force",)), simulate(item, h)
    notes, moves = told.attrs.get("warnings", ""), march.variables["motion"][1][0, 0, 4] > 1e-9
    assert moves == (slips is not False)
    assert ("friction holds heave in the linear model" in notes) == bool(slips)
    assert (told.attrs["linearisation_effect"] == UNTOLD) == bool(slips)
    if slips is None:
        return
    assert told.variables["motion"][1][0, 0, 4] < 1e-11 and told.variables["absorbed_power"][1][0, 2] < 1e-6
    if not slips:
        assert told.attrs["linearisation_effect"] == 0.0
    held, _ = given(hemisphere, {"damping": 1e15}, one=one)
    force = (x.variables["hinge_force"][1] for x in (told, by_lines(held, h)))
    bound = np.abs(told.variables["pto_force"][1]).max()
    assert bound <= coulomb and next(force) == approx(next(force), rel=1e-6, abs=1.0)


def test_others_move_beside_one_that_friction_holds():
    item, h = given(pair, {"coulomb": 6e4}, one=False)
    (a, b), lines = item.floats, by_lines(item, h)
    alone = by_lines(replace(item, floats=(replace(a, coulomb=0.0, damping=1e15), b)), h)
    assert lines.variables["motion"][1][1] == approx(alone.variables["motion"][1][1], rel=1e-6)
    assert "floats.a: friction holds heave" in lines.attrs["warnings"]
    assert respond(replace(item, settings=replace(item.settings, method="frequency")), h).stuck.tolist() == [
        True,
        False,
    ]


def test_a_brake_stays_held_while_another_axis_takes_many_rounds():
    """The less an axis moves the more friction damps it, round by round, down to rates whose squares are zero."""
    item, h = given(pair, {"coulomb": 1e9}, one=False)
    a, b = item.floats
    lines = by_lines(replace(item, floats=(a, replace(b, pto_damping=0.0, coulomb=2.399e4))), h)
    assert lines.attrs["drag_rounds"] > 8
    assert lines.variables["motion"][1][0, 0, 4] < 1e-12 and lines.variables["motion"][1][1, 0, 4] > 1e-3


@pytest.mark.parametrize("one", [False, True], ids=["sea", "wave"])
def test_a_stiff_damper_that_a_limit_lets_go_holds_nothing(one):
    item, h = given(hemisphere, {}, one=one)
    stiff, stiffer = (
        by_lines(replace(item, floats=(replace(item.floats[0], pto_damping=c, force_limit=3e3),)), h)
        for c in (1e9, 1e12)
    )
    assert stiff.variables["motion"][1][0, 0, 4] > 0.2
    assert stiffer.variables["motion"][1] == approx(stiff.variables["motion"][1], rel=1e-4)


@pytest.mark.parametrize("build", [hemisphere, pair, hinged])
def test_a_limit_that_is_never_reached_changes_nothing(build):
    """Nor does what linear dampers take make rates less Gaussian."""
    item, h = given(build, {"pto_damping": 2e4, "damping": 3e4, "force_limit": 1e12}, one=False)
    attrs = by_lines(item, h).attrs
    assert attrs["linearisation_effect"] == approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("law", "third"),
    [
        ({"damping": 1.0}, 0.0), ({"coulomb": 1.0}, -np.sqrt(2 / np.pi) / 6),
        ({"quadratic_damping": 1.0}, np.sqrt(2 / np.pi) / 3), ({"damping": 50.0, "quadratic_damping": 1.0}, 0.2660),
    ],
)  # fmt: skip
def test_the_third_cumulant_of_a_load_is_that_of_a_gaussian_rate(law, third):
    """a₃ of |v|v, of sgn v and of none, of rates of std 1: κ = -24 a₃ H for a mobility that is the same everywhere."""
    omega, H = np.linspace(0.001, 4.0, 200), 1e-4
    V = np.zeros((1, omega.size), complex)
    V[0, :40] = np.sqrt(2 / 40)  # of which three add to no more than the highest
    item = heaving("a", 3.0, **({"pto_damping": 0.0} | law))
    (kappa, _), h = shape.excess(joint_law((item,)), omega, V, np.full((1, omega.size), H))
    expected = -24 * third * H
    assert kappa == approx(expected / (1 - expected / 2) if expected < 0 else expected, rel=2e-3, abs=1e-9)
    assert h == approx(H, rel=2e-3)
    V[0, :] = 0.1  # of which three add to more than that
    assert shape.excess(joint_law((item,)), omega, V, np.full((1, omega.size), H))[1] == approx(H, rel=2e-3)


@pytest.mark.parametrize("kappa", [-0.4, 0.4])
def test_what_no_kurtosis_tells_of_power_is_what_is_beyond_the_third_order(kappa):
    """Of friction, σ_P² = 1 - ⟨|x|⟩², ⟨|x|⟩ = √(2/π)(1 - κ/24): 1 - 1/(3π)/(1 - 2/π) of the change, and κ/2 if > 0."""
    law = joint_law((heaving("a", 3.0, pto_damping=0.0, coulomb=5.0),))
    changed = np.sqrt((1 - 2 / np.pi * (1 - kappa / 24) ** 2) / (1 - 2 / np.pi)) - 1
    share = 1 - 1 / (3 * np.pi) / (1 - 2 / np.pi) + max(kappa, 0.0) / 2
    assert shape.power_error(law, np.array([2.0]), np.array([kappa])) == approx(share * abs(changed), rel=1e-3)


def yielded(h, size=1.0, kappa=0.0, **law):
    """Rates and error told of one axis, rates of std `size`."""
    item = heaving("a", 3.0, **({"pto_damping": 0.0} | law))
    of = joint_law((item,)), np.array([size]), np.array([kappa]), np.array([h])
    return yielding.yielded(*of)[:, 0] / size, yielding.power_error(*of)


def test_rates_yield_as_their_loads_do():
    """Not at all of a linear load, nor of one that moves nothing; of friction F by v = (u - hF)/(1 - hc), c = √(2/π) F
    of rates of std 1, from where it lets go."""
    u, F, h = gaussian.SIZES, 2.0, 0.4
    for rates, told in (yielded(0.1, 3.0, pto_damping=5.0), yielded(0.0, 3.0, pto_damping=50.0, force_limit=20.0)):
        assert rates == approx(u, rel=1e-9) and told == approx(0.0, abs=1e-9)
    c = np.sqrt(2 / np.pi) * F
    exact = ((u - h * F) / (1 - h * c)).clip(min=0.0)
    rates, told = yielded(h, coulomb=F)
    assert rates == approx(exact, abs=0.04)  # one step of the rates that are looked at
    mean, gaussians = F * (gaussian.WEIGHTS @ exact), F * np.sqrt(2 / np.pi)
    rms = F * np.sqrt(gaussian.WEIGHTS @ exact**2)
    std = np.sqrt(rms**2 - mean**2)
    usual = np.array([gaussians / rms - mean / rms, F / rms - 1, np.sqrt(F**2 - gaussians**2) / std - 1])
    assert told == approx(np.abs(usual).max(), rel=0.02)
    c *= 1 + 1 / 24  # of rates that are flatter
    flatter, _ = yielded(h, kappa=-1.0, coulomb=F)
    assert flatter == approx(((u - h * F) / (1 - h * c)).clip(min=0.0), abs=0.04)
    assert yielded(0.0, kappa=-1.0, pto_damping=1.0)[1] == approx(1 - np.sqrt(0.5), rel=0.01)  # ⟨v⁴⟩ = 2, in place of 3


def test_of_small_loads_rates_yield_by_the_kurtosis_of_first_order():
    """κ = -24 a₃σ² h, where a₃σ² = √(2/π)/3 Bσ of B|v|v."""
    h, size = 1e-3, 3.0
    rates, _ = yielded(h, size, quadratic_damping=1.0)
    kurtosis = gaussian.WEIGHTS @ rates**4 / (gaussian.WEIGHTS @ rates**2) ** 2 - 3
    assert kurtosis == approx(-8 * np.sqrt(2 / np.pi) * size * h, rel=0.02)


def test_arms_that_friction_holds_do_not_turn():
    """By rounding alone, whose changes tell nothing."""
    item, h = given(hinged, {"coulomb": 1e9}, one=False)
    told = by_lines(item, h).attrs
    assert told["rotation_effect"] == told["linearisation_effect"] == 0.0


@pytest.mark.parametrize("count", [2, 3])
def test_friction_s_power_in_a_few_waves_varies_as_their_sum_does(count):
    """It goes by the rate's size, and not as a square, of which few waves leave less."""
    item, h = given(flap, {"coulomb": 3e4}, one=False)
    few = components(amplitude=[0.05] * count, omega=[1.1, 1.31, 1.57][:count], phase=[0.0] * count)
    item = replace(item, sea=replace(few, known=False))
    march, lines = (x.variables["absorbed_power"][1][0, 4] for x in (simulate(item, h), by_lines(item, h)))
    assert lines == approx(march, rel=0.08)


@pytest.mark.parametrize(("law", "most"), [({"coulomb": 2e4}, 1.2), ({"quadratic_damping": 3e8}, 1.5)])
def test_largest_forces_of_joints_go_by_what_loads_they_have(law, most):
    """Friction's are cut off, quadratic damping's are more than Gaussian ones."""
    item, h = given(flap, law, one=False)
    item = replace(item, settings=replace(item.settings, duration=7200.0))
    march, lines = (x.variables["hinge_force"][1][0, 0] for x in (simulate(item, h), by_lines(item, h)))
    assert lines[4] == approx(march[4], rel=0.05)
    assert 0.8 < np.abs(lines[:2]).mean() / np.abs(march[:2]).mean() < most
