"""What bent joints bear and absorb: against long samples of the whole law, and the march."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.assembly import joint_law
from solver.frequency import bent, gaussian, left, shape
from solver.frequency.bent import rate_load
from solver.frequency.case import case_of
from solver.frequency.gaussian import Process
from solver.frequency.outputs import rate_lines
from solver.frequency.response import respond
from solver.multibody.of_axes import joint_loads
from solver.power_takeoff import PtoEfficiency, PtoTable
from solver.remarks import pulled
from solver.run import simulate
from solver.sea.realization import components, regular
from tests import awkward
from tests.frequency.test_linearised import by_lines, cylinder, given, heaving, hemisphere, hinged, pair

TABLE = PtoTable(velocity=(-2.0, -0.2, 0.2, 2.0), force=(-9e3, -5e3, 5e3, 9e3))
LAWS = [
    ({"pto_damping": 4e4, "force_limit": 6e3}, {"coulomb": 5e3}),
    ({"pto_damping": 4e4, "coulomb": 2e3, "force_limit": 6e3}, {"pto_damping": 2e4}),
    ({"pto_table": TABLE}, {"pto_damping": 1e4, "force_limit": 1e3}),
]


def axes_of(laws):
    """A law of two axes, and lines of their rates, which go together in 40 waves."""
    (item, *_), dice = hemisphere()[0].floats, np.random.default_rng(5)
    law = joint_law(tuple(replace(item, name=str(i), **of) for i, of in enumerate(laws)))
    lines = dice.normal(size=(40, 2, 2)) @ [1.0, 1j] * [0.1, 0.04] @ [[1.0, 0.5], [0.0, 1.0]]
    omega = np.linspace(0.8, 1.2, 40)
    return law, lines * np.exp(-25 * (omega - 1.0) ** 2)[:, None], omega


def samples(lines, count=200_000):
    turned = np.exp(2j * np.pi * np.random.default_rng(1).random((count, len(lines))))
    return (turned @ lines).real


@pytest.mark.parametrize("laws", LAWS)
def test_power_is_that_of_the_whole_law(laws):
    """Mean within 0.5 %, std within 3 %: of two axes that go together, as the squares of their rates do."""
    law, V, omega = axes_of(laws)
    v = samples(V)
    power = joint_loads(law, 0 * v, v).pto * v
    for axes in ([0], [1], [0, 1]):
        largest, least, mean, rms, std = bent.absorbed_table(
            bent.pto_load(law, axes), V[:, axes], Process(omega, 3600.0), np.zeros(len(axes))
        )
        exact = power[:, axes].sum(axis=1)
        assert mean == approx(exact.mean(), rel=5e-3)
        assert std == approx(exact.std(), rel=0.03)
        assert rms == approx(np.hypot(mean, std)) and least == 0.0
        assert np.quantile(exact, 0.999) < largest < 1.3 * exact.max()


@pytest.mark.parametrize("laws", LAWS)
def test_force_is_that_of_the_whole_law_with_all_that_is_linear(laws):
    """A spring's load, a quarter turn off, and a damper's beside it: std within 1 %."""
    law, V, omega = axes_of(laws)
    load, both = bent.pto_load(law, [0, 1]), V / (-1j * omega[:, None])
    linear = -3e3 * both - 2e3 * V
    v = samples(np.concatenate([V, linear], axis=1))
    exact = v[:, 2:] - load(v[:, :2])
    c = np.mean(load(v[:, :2]) * v[:, :2], axis=0) / np.mean(v[:, :2] ** 2, axis=0)
    F, mean = linear - c * V, np.array([50.0, -70.0])
    table = bent.borne_table(
        load, V, gaussian.table(mean, F, Process(omega, 3600.0)), F, Process(omega, 3600.0), np.zeros(2)
    )
    assert table[:, 2] == approx(mean)
    assert table[:, 4] == approx(exact.std(axis=0), rel=0.01)
    assert table[:, 0] - mean == approx(np.quantile(exact, 1 - 2e-4, axis=0), rel=0.12)
    assert table[:, 1] - mean == approx(mean - table[:, 0])


@pytest.mark.parametrize("quadratic", [15.0, 60.0, 240.0])
def test_quadratic_dampers_bear_what_rates_flatter_than_gaussian_ones_make(quadratic):
    """Std 5 to 10 % above, largest 1.3 to 1.9 times the march's, where rates were taken for Gaussian; motions 0.5 to
    3.4, power 1.2 to 7.8 % low, its std up to 17 and its largest up to 105 % high."""
    item, h = given(cylinder, {"quadratic_damping": quadratic, "pto_damping": 2.0}, one=False)
    item = replace(item, settings=replace(item.settings, outputs=("pto_force",)))
    seas = [awkward.sea(Hs=0.05, Tp=1.1, band=(3.0, 14.0), seed=seed) for seed in range(4)]
    every = [replace(item, sea=waves) for waves in seas]
    march, lines = ([run(each, h) for each in every] for run in (simulate, by_lines))
    borne, motion, power, pto = (
        [np.mean([r.variables[name][1][0].reshape(-1, 5)[row] for r in runs], axis=0) for runs in (march, lines)]
        for name, row in (("hinge_force", 2), ("motion", 0), ("absorbed_power", 0), ("pto_force", 0))
    )
    assert borne[1][4] == approx(borne[0][4], rel=0.03)
    assert np.ptp(borne[1][:2]) == approx(np.ptp(borne[0][:2]), rel=0.12)
    assert motion[1][4] == approx(motion[0][4], rel=4e-3)
    assert power[1][2] == approx(power[0][2], rel=6e-3)
    assert power[1][4] == approx(power[0][4], rel=0.07)
    assert power[1][0] == approx(power[0][0], rel=0.1)
    assert np.ptp(pto[1][:2]) == approx(np.ptp(pto[0][:2]), rel=0.08)


@pytest.mark.parametrize("kappa", [-1.4, -0.6, -0.3, -0.01, 0.0, 0.5])
def test_warped_samples_have_variance_one_and_their_kurtosis(kappa):
    x = shape.warped(gaussian.SIZES[:, None], np.array([kappa]))
    assert gaussian.WEIGHTS @ x**2 == approx(1.0)
    assert gaussian.WEIGHTS @ x**4 - 3 == approx(kappa, abs=2e-3 if kappa < 0 else 0.03)


def test_dampers_take_what_rates_of_a_shape_give_them():
    """Quadratic ones (1 + κ/8) of that at a Gaussian rate, friction (1 - κ/24), in one sense, too; linear ones the
    same, and what has both by their shares."""
    kappa, sigma = np.array([-0.5]), np.array([0.3])
    half = {"coulomb": 5.0, "pto_damping": np.sqrt(2 / np.pi) * 5.0 / 0.3}
    for law, share in (
        ({"coulomb": 5.0}, -1 / 24), ({"coulomb": 5.0, "one_way": 1.0}, -1 / 24), (half, -1 / 48),
        ({"coulomb": 5.0, "one_way": -0.5}, -1 / 24), ({"pto_damping": 3.0}, 0), ({"damping": 3.0}, 0),
    ):  # fmt: skip
        item = heaving("a", 3.0, **({"pto_damping": 0.0} | law))
        pto, quadratic = shape.more_damping(joint_law((item,)), sigma, kappa)
        assert pto == approx(share * kappa, rel=2e-3, abs=1e-9) and quadratic == approx(kappa / 8), law


def test_linear_laws_have_the_statistics_of_lines():
    law, V, omega = axes_of(({"pto_damping": 4e4}, {"pto_damping": 1e4}))
    load, c = bent.pto_load(law, [0, 1]), np.array([4e4, 1e4])
    for one in (slice(None), slice(7, 8)):
        rates, w = V[one], omega[one]
        usual = gaussian.table(np.zeros(2), -c * rates, Process(w, 3600.0))
        assert bent.borne_table(load, rates, usual, -c * rates, Process(w, 3600.0), np.zeros(2)) == approx(
            usual, rel=1e-3
        )
        power = gaussian.power_table(c, rates, Process(w, 3600.0))
        table = bent.absorbed_table(load, rates, Process(w, 3600.0), np.zeros(2))
        assert table == approx(power, rel=2e-2, abs=1e-9)


@pytest.mark.parametrize(("build", "law", "limit"), [
    (hemisphere, {"coulomb": 1e4}, 1e4),
    (pair, {"pto_damping": 1e5, "force_limit": 1.5e4}, 1.5e4), (hinged, {"pto_damping": 2e5, "force_limit": 3e3}, 3e3),
])  # fmt: skip
@pytest.mark.parametrize("one", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["sea", "wave"])
def test_forces_and_power_are_the_marchs(build, law, limit, one):
    """Power's std was 50 to 80 % high in a sea, the force's 10 to 20 % low: within 12 and 4 %; and both are bounded."""
    item, h = given(build, law, one=one)
    item = replace(item, settings=replace(item.settings, outputs=("pto_force",)))
    march, lines = simulate(item, h).variables, by_lines(item, h).variables
    (true, of_power), (force, of_force) = (
        [x[n][1][0] for x in (march, lines)] for n in ("absorbed_power", "pto_force")
    )
    assert of_power[2:] == approx(true[2:], rel=0.12)
    assert of_force[0, 3:] == approx(force[0, 3:], rel=0.04)
    assert of_force[0, :2] == approx([limit, -limit], rel=1e-3)
    if build is not hinged:
        hinge, of_hinge = (x["hinge_force"][1][0, 2] for x in (march, lines))
        assert of_hinge[3:] == approx(hinge[3:], rel=0.04)
        assert np.ptp(of_hinge[:2]) == approx(np.ptp(hinge[:2]), rel=0.05)


@pytest.mark.parametrize("on", ["float", "platform"])
def test_a_guide_on_what_moves_bears_its_whole_law(on):
    """Linear damping that absorbs as much has √(2/π) of a constant load's std. A float might tilt."""
    (item, h), outputs = pair() if on == "float" else awkward.unequal_legs(), ("pto_force",)
    carrier, slider = item.floats if on == "float" else (None, item.floats[0])
    law = {"motion": ("heave",), "pto_damping": 1e5, "force_limit": 1.5e3, "on": carrier.name if carrier else ""}
    slider = replace(slider, **law)
    floats = (replace(carrier, pto_damping=4e4), slider) if carrier else (slider,)
    item = replace(item, floats=floats, settings=replace(item.settings, froude_krylov="linear", outputs=outputs))
    march, lines = (run(item, h).variables for run in (simulate, by_lines))
    (true, of_joint), (_, of_law) = ([x[n][1][-1] for x in (march, lines)] for n in ("hinge_force", "pto_force"))
    assert of_joint[2, 4] == approx(true[2, 4], rel=0.08)
    assert of_joint[2, 4] == approx(of_law[0, 4], rel=1e-6)
    if on == "platform":
        assert np.ptp(of_joint[2, :2]) == approx(np.ptp(true[2, :2]), rel=0.02)
    else:
        assert np.ptp(of_joint[2, :2]) > 2 * np.ptp(of_law[0, :2])


@pytest.mark.parametrize(("level", "far"), [(0.0, 0.02), (3.0, 0.04)])
def test_electrical_power_of_few_lines_varies_less_than_a_gaussian_processs(level, far):
    """Reactive control, by an hour of a hundred seas of four waves; what goes by a mean position varies as much."""
    omega, rng = np.array([0.71, 0.97, 1.31, 1.57]), np.random.default_rng(3)
    position = np.array([[1.0], [0.8j], [-0.6], [0.5]])
    axes = gaussian.Axes(
        lambda v: 2.0 * v,
        np.array([2.0]),
        np.array([-3.0]),
        np.full(1, level),
        position,
        -1j * omega[:, None] * position,
    )
    efficiency = PtoEfficiency(generating=0.9, motoring=0.7)
    told = gaussian.electrical_table(efficiency, axes, np.zeros(5), Process(omega, 3600.0))
    turn = np.exp(1j * rng.uniform(0, 2 * np.pi, (100_000, 4)))  # any phases, as they come in time
    power = efficiency.electrical(axes.power((turn @ position).real, (turn @ axes.rate).real)).ravel()
    assert told[[2, 4]] == approx([power.mean(), power.std()], rel=far)


def test_reactive_control_lends_power_in_the_frequency_domain():
    """The least, where next to nothing is taken at that time; by five minutes, in which waves do not repeat."""
    omega, rng, t = np.linspace(0.7, 1.5, 40), np.random.default_rng(3), np.arange(0.0, 300.0, 0.1)
    position = np.exp(-8 * (omega - 1.0) ** 2)[:, None] + 0j
    axes = gaussian.Axes(
        lambda v: 2.0 * v, np.array([2.0]), np.array([-0.8]), np.zeros(1), position, -1j * omega[:, None] * position
    )
    efficiency = PtoEfficiency(generating=0.9, motoring=0.7)
    told = gaussian.electrical_table(efficiency, axes, np.zeros(5), Process(omega, 300.0))
    turn, ends = np.exp(-1j * np.outer(t, omega)), []
    for _ in range(40):
        phase = np.exp(2j * np.pi * rng.uniform(size=(40, 1)))
        each = axes.power((turn @ (phase * position)).real, (turn @ (phase * axes.rate)).real)
        ends.append([efficiency.electrical(each).max(), efficiency.electrical(each).min()])
    assert told[:2] == approx(np.mean(ends, axis=0), rel=0.2)


def test_what_friction_beside_a_spring_and_a_damper_bears():
    """Reactive control: force, and the electrical power that goes by it."""
    law = {"coulomb": 8e3, "damping": 2e4, "pto_stiffness": -3e4}
    law["pto_efficiency"] = PtoEfficiency(generating=0.9, motoring=0.7)
    item, h = given(hemisphere, law, one=False)
    item = replace(item, settings=replace(item.settings, outputs=("pto_force",)))
    march, lines = simulate(item, h).variables, by_lines(item, h).variables
    for name, far in (("pto_force", 0.05), ("hinge_force", 0.05), ("electrical_power", 0.1)):
        a, b = (np.asarray(x[name][1]).reshape(-1, 5)[-1] for x in (march, lines))
        assert b[2:] == approx(a[2:], rel=far, abs=0.02 * a[3])


def test_a_bent_law_in_waves_of_known_phases():
    """Friction in three waves that meet: as a march has it, whose force jumps where the rate turns."""
    scene, h = awkward.SCENES["oblique"]()
    waves = {"amplitude": [0.03, 0.04, 0.03], "omega": [1.0, 1.1, 1.2], "phase": [90.0, 99.0, 108.0]}
    group = components(**waves, heading=scene.sea.heading)
    floats = tuple(replace(f, coulomb=8e2, pto_damping=4e4) for f in scene.floats)
    settings = replace(
        scene.settings, froude_krylov="linear", duration=20 * np.pi, discard=60.0, outputs=("pto_force", "pto_stroke")
    )
    scene = replace(scene, floats=floats, sea=group, settings=settings)
    march, told = simulate(scene, h), simulate(replace(scene, settings=replace(settings, method="frequency")), h)
    for name, within in (("pto_force", 0.03), ("absorbed_power", 0.05), ("pto_travel", 0.1)):
        exact, ours = (r.variables[name][1] for r in (march, told))
        size, kept = np.nanmax(np.abs(exact)), {"pto_force": [2, 3, 4], "absorbed_power": [2]}.get(name)
        exact, ours = (x[..., kept] if kept else x for x in (exact, ours))
        assert ours == approx(exact, abs=within * size, nan_ok=True)


RUNG = ("section_force", "section_moment", "fibre_stress", "bottom_stress", "top_displacement")


@pytest.mark.parametrize(
    ("law", "waves", "damage"),
    [
        pytest.param({"coulomb": 2e3}, None, (0.5, 1.3), marks=pytest.mark.slow),
        ({"quadratic_damping": 1e6, "pto_damping": 0.0}, None, (0.3, 1.3)),
        ({"coulomb": 2e3}, regular(height=0.5, period=5.0, heading=np.pi / 6), (0.6, 1.4)),
    ],
)
def test_laws_that_bend_ring_an_elastic_platform(law, waves, damage):
    """Jumps and kinks drive the legs' modes above the waves, by half of their stresses' std and most of the damage."""
    scene, h = awkward.SCENES["unequal_legs"]()
    floats = tuple(replace(f, **law) for f in scene.floats)
    outputs = ("section_forces", "fibre_stress", "fatigue")
    settings = replace(scene.settings, froude_krylov="linear", outputs=outputs, duration=100.0 if waves else 600.0)
    scene = replace(scene, floats=floats, settings=settings, sea=waves or scene.sea)
    march, told = simulate(scene, h), simulate(replace(scene, settings=replace(settings, method="frequency")), h)
    for name in RUNG:
        exact, ours = (np.asarray(record.variables[name][1])[..., 4] for record in (march, told))
        some = exact > 0.05 * exact.max()
        assert ours[some] == approx(exact[some], rel=0.22 if waves else 0.13), name
    exact, ours = (np.asarray(record.variables["section_moment"][1]) for record in (march, told))
    some = exact[..., 4] > 0.1 * exact[..., 4].max()
    ratio = ((exact[..., 0] - exact[..., 2]) / (ours[..., 0] - ours[..., 2]))[some]
    if law.get("quadratic_damping"):  # by loads that go as |v|v of rates flat as these
        assert ratio.min() > 0.9 and ratio.max() < 1.45
    assert "joints' loads ring" in told.attrs["warnings"]
    exact, ours = (record.variables["damage"][1] for record in (march, told))
    most = exact > 0.2 * exact.max()
    assert np.all((ours > damage[0] * exact)[most] & (ours < damage[1] * exact)[most])


def test_extremes_of_steel_that_are_far_above_those_told_are_said():
    assert not [*pulled(1.05, 0.1)]
    assert "2.3 times those told" in next(pulled(2.3, 0.0)) and "25% of the variance" in next(pulled(1.0, 0.25))


def test_waves_of_known_phases_do_the_damage_of_their_sum():
    """A group, by rainflow: its spectrum's Gaussian process does less than a tenth of it."""
    scene, h = awkward.SCENES["unequal_legs"]()
    omega = np.linspace(0.8, 2.2, 20)
    amplitude, phase = 0.02 * np.exp(-4 * (omega - 1.3) ** 2), 60.0 * omega
    waves = components(amplitude=amplitude, omega=omega, phase=phase, heading=scene.sea.heading)
    settings = replace(scene.settings, froude_krylov="linear", duration=60.0, discard=30.0, outputs=("fatigue",))
    scene = replace(scene, sea=waves, settings=settings)
    march, told = simulate(scene, h), simulate(replace(scene, settings=replace(settings, method="frequency")), h)
    assert told.variables["damage"][1] == approx(march.variables["damage"][1], rel=0.1)


def test_loads_that_no_platform_bears_together_are_looked_at_each_by_itself():
    """Two floats on the ground: joints' forces as with all pairs of loads."""
    item, h = given(pair, {"coulomb": 1e4}, one=False)
    scene = replace(item, settings=replace(item.settings, method="frequency"))
    case = case_of(scene, h)
    law = case.law(scene.floats)
    response = respond(scene, h)
    load, rates = rate_load(law, np.arange(2)), rate_lines(case, response)
    at = np.linspace(1.0, 8.0, 9)  # [rad/s]
    whole, apart = (left.spectrum(load, rates, case.omega, at, 0.5, 40.0, apart=which) for which in (False, True))
    assert np.diagonal(whole, axis1=1, axis2=2) == approx(np.diagonal(apart, axis1=1, axis2=2))
    assert np.abs(whole[:, 0, 1]).max() > 0 and not apart[:, 0, 1].any()


@pytest.mark.slow
def test_damage_by_what_rings_in_waves_of_known_phases():
    """Of a sum of waves no cycle rings: it was told a hundred times too little."""
    scene, h = awkward.SCENES["unequal_legs"]()
    floats = tuple(replace(f, coulomb=3e3) for f in scene.floats)
    settings = replace(scene.settings, froude_krylov="linear", outputs=("fatigue",), duration=600.0)
    scene = replace(scene, floats=floats, settings=settings, sea=replace(scene.sea, known=True))
    march, told = simulate(scene, h), simulate(replace(scene, settings=replace(settings, method="frequency")), h)
    exact, ours = (record.variables["damage"][1] for record in (march, told))
    most = exact > 0.2 * exact.max()
    assert np.all((ours > 0.3 * exact)[most] & (ours < 3 * exact)[most])


def test_legs_that_ring_in_one_wave_alone_have_no_joints():
    whole, h = awkward.SCENES["bare_legs"]()
    settings = replace(whole.settings, froude_krylov="linear", method="frequency")
    record = simulate(replace(whole, sea=regular(height=0.5, period=6.0), settings=settings), h)
    assert "top_displacement" in record.variables and "hinge_force" not in record.variables


def test_what_rings_in_one_wave_has_larger_forces_than_those_told():
    """Up to four times: friction hardly damps it between its jumps."""
    scene, h = awkward.SCENES["unequal_legs"]()
    first, *others = scene.floats
    settings = replace(scene.settings, froude_krylov="linear", outputs=("reactions",), duration=100.0, discard=100.0)
    floats = (replace(first, coulomb=3e3, pto_damping=0.0), *others)
    scene = replace(
        scene, floats=floats, sea=regular(height=0.3, period=5.0, heading=scene.sea.heading), settings=settings
    )
    march, told = simulate(scene, h), simulate(replace(scene, settings=replace(settings, method="frequency")), h)
    exact, ours = (np.ptp(x.variables["base_shear"][1][..., :2], axis=-1).ravel()[2] for x in (march, told))
    assert 2.0 < exact / ours < 4.0 and "four times in one wave" in told.attrs["warnings"]
