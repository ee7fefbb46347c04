"""What exact rotation of arms does of second order, against the linear march: means, and motions below the waves."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.stats import skew

from solver.coupled.equilibrium import balance
from solver.coupled.linear import impedance_anywhere
from solver.coupled.preparation import prepare
from solver.frequency import exact, gaussian, harmonics, rotation, second_order
from solver.frequency.case import case_of
from solver.frequency.outputs import frame_forces
from solver.frequency.response import respond, respond_in
from solver.frequency.rotation import mean_shift, resonant, slow_motions
from solver.frequency.steps import Steps
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.record.response import carried, in_waves
from solver.run import simulate
from solver.scene import DOFS, Float
from solver.sea.realization import components, realize, regular
from solver.sea.spectrum import PiersonMoskowitz
from solver.statistics import STATISTICS
from tests.awkward import SCENES, known, rotors, scene, sea
from tests.frequency.test_frequency import linear, repeating


@pytest.mark.parametrize(
    ("name", "height"),
    [
        ("duck", 0.03),
        ("unequal_legs", 0.03),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (("flap", 0.01), ("oblique", 0.03), ("big_beside_small", 0.03))
        ),
    ],
)
def test_mean_angles_are_the_marchs(name, height):
    """c.o.g. off the reference point, a foot below, two that differ, a platform that moves.

    To 5 %: in lower waves the mean is no more than what statics leave of the equilibrium, higher ones are not small.
    """
    item, h = SCENES[name]()
    size = min(f.hull.size for f in item.floats)
    numerics = {"newton_tolerance": 1e-11 * size, "memory_tolerance": 1e-3}
    item, period = repeating(item, height * size)
    lasting = {"duration": period, "discard": 5 * period, "ramp": 2 * period, "ramp_form": "cosine"}
    item = linear(item, **numerics, **lasting, time_step=period / 400)
    lines = linear(item, method="frequency")
    case = case_of(lines, h)
    shift = mean_shift(case, respond(lines, h))[0]
    joints = len(item.floats)
    found = simulate(item, h).variables["rotation"][1][:, 2] - case.system.equilibrium[0][-joints:]
    assert np.abs(shift[-joints:] - found).max() < 0.05 * np.abs(found).max()


def test_mean_angles_grow_with_the_waves_height_squared():
    item, h = SCENES["flap"]()
    angles = []
    for height in (0.5, 1.0):
        lines = linear(replace(item, sea=replace(item.sea, amplitude=height * item.sea.amplitude)), method="frequency")
        angles.append(mean_shift(case_of(lines, h), respond(lines, h))[0])
    assert angles[1] == approx(4 * angles[0], rel=1e-6)


def test_a_float_on_a_clamped_node_loads_the_ground_as_on_springs():
    """To first order, in the mean of second order, and by exact angles; and in what elements are judged by."""
    item, h = SCENES["unequal_legs"]()
    item, frame, node = linear(item, method="frequency", outputs=("reactions",)), item.platform.frame, "hinge:float"
    clamped, held = (
        replace(item, platform=replace(item.platform, frame=replace(frame, **feet)))
        for feet in ({"clamped": (*frame.clamped, node)}, {"foundation": {node: (1e12,) * 6}})
    )
    lines, exact = (simulate(each, h) for each in (clamped, held))
    for name in ("base_shear", "overturning_moment"):
        ours, theirs = (record.variables[name][1] for record in (lines, exact))
        assert ours == approx(theirs, abs=3e-5 * theirs[..., 4].max()), name
    assert lines.attrs["rotation_effect"] == approx(exact.attrs["rotation_effect"], rel=5e-3)
    usual, waves = respond(clamped, h).carried, item.sea.omega.size
    system = prepare(clamped, h)
    judged = carried(system, h, in_waves(system, h).X)
    assert judged == approx(usual[:waves], abs=1e-9 * np.abs(usual).max())


def test_loads_on_a_frame_are_what_its_modes_need():
    """Lines to what rounds of the drag leave, and the mean."""
    item, h = SCENES["unequal_legs"]()
    case = case_of(linear(item, method="frequency"), h)
    frame, found = case.system.structure, rotation.turned(case, respond_in(case, case.law(item.floats)))
    nm = frame.omega.size
    needed = case.model.of_modes(found.omega) * found.X[:, :nm] - case.modal.T - found.drag.modes
    assert found.carried @ frame.carrier == approx(needed, abs=1e-5 * np.abs(needed).max())
    held = frame.omega**2 * found.mean.x[:nm]
    assert found.mean.carried @ frame.carrier == approx(held, abs=1e-9 * np.abs(held).max())


def test_a_load_that_speeds_a_float_up_freely_is_on_no_carrier():
    item, h = SCENES["unequal_legs"]()
    case = case_of(linear(item, method="frequency"), h)
    load = (case.model.floats[2] @ case.model.shape[:, -1] + 0j)[None]
    none, still = np.zeros((1, len(case.model.mass))), exact.Waves(*[None] * 7, against=case.model.floats[:1])
    assert np.abs(load[0, :-1]).max() > 1.0
    assert harmonics._carried(case, still, load, none, none) == approx(0.0, abs=1e-9 * np.abs(load).max())


def swinging(name, angle, waves):
    """A linear scene in which a float's angle has a std in these waves, as the frequency domain has it."""
    item, h = (SCENES | {each.__name__: each for each in (steep_arm, ring_on_a_spar, column)})[name]()
    item = linear(waves(item), method="frequency")
    turns = np.concatenate([f.turns for f in item.floats])
    std = np.linalg.norm(respond(item, h).Z[:, -turns.size :][:, turns], axis=0).max() / np.sqrt(2)
    return replace(item, sea=replace(item.sea, amplitude=angle / std * item.sea.amplitude)), h


def marched(item, h, period, count):
    """The march's tables, after the start has died away."""
    lasting = {"duration": count * period, "discard": 40 * period, "ramp": 5 * period, "ramp_form": "cosine"}
    numerics = {"memory_tolerance": 1e-3, "time_step": period / 400, "newton_tolerance": 1e-10}
    return simulate(linear(item, method="time", **lasting, **numerics), h).variables


def largest(march, lines, names):
    """Largest relative error of a std, or of a mean power, of what is not small beside others."""
    worst = 0.0
    for name in (name for name in names if name in march):
        for statistic in ("mean", "std") if name == "absorbed_power" else ("std",):
            at = STATISTICS.index(statistic)
            exact, told = (np.nan_to_num(x[name][1][..., at]) for x in (march, lines))
            used = exact > 0.02 * exact.max()
            worst = max(worst, np.abs(told[used] / exact[used] - 1).max(initial=0.0))
    return worst


BORNE = ("rotation", "motion", "absorbed_power", "hinge_force")


@pytest.mark.parametrize(
    ("name", "angle"),
    [
        ("duck", 0.1),
        ("unequal_legs", 0.03),
        pytest.param("flap", 0.1, marks=pytest.mark.slow),
        pytest.param("oblique", 0.1, marks=pytest.mark.slow),
        pytest.param("model_scale", 0.1, marks=pytest.mark.slow),
        pytest.param("unequal_legs", 0.1, marks=pytest.mark.slow),
        ("column", 0.05),
    ],
)
def test_what_turning_changes_in_one_wave_is_told_as_the_march_shows(name, angle):
    """Angles, power, joints' forces and stresses; of the legs three times the waves' frequency makes most of that."""
    item, h = swinging(name, angle, lambda item: replace(item, sea=one_wave(item)))
    lines = simulate(item, h)
    names = (*BORNE, *(["bottom_stress", "top_displacement"] if item.platform else []))
    march = marched(item, h, 2 * np.pi / item.sea.omega[0], 4)
    assert lines.attrs["rotation_effect"] == approx(largest(march, lines.variables, names), rel=0.25)


def test_what_moves_by_second_order_alone_is_told_by_name():
    """A round buoy on oblique waves: none of them turns it about the upright, differences of two do."""
    whole = 1025 * 2 / 3 * np.pi
    buoy = Float(
        name="buoy", hull=Revolution.hemisphere_cylinder(radius=1.0, height=0.6), mass=whole,
        inertia=(860.0, 770.0, 950.0), cog=(0, 0, -0.2), hinge=(0, 0, 0), motion=DOFS,
        stiffness=(190.0, 190.0, 0, 0, 0, 190.0), damping=tuple(0.3 * whole for _ in DOFS),
    )  # fmt: skip
    item, period = repeating(linear(scene([buoy], waves=sea(Hs=0.6, heading=0.6))), 0.15)
    h = known(item, 0.3, 6.5)
    lasting = {"duration": period, "discard": 5 * period, "ramp": 2 * period}
    march, lines = (simulate(linear(item, **lasting, method=m), h) for m in ("time", "frequency"))
    yaw, told = (of.variables["motion"][1][0, 5, 4] for of in (march, lines))
    assert told < 1e-2 * yaw
    assert lines.attrs["rotation_effect"] == approx(1.0, abs=0.02)
    assert "in no linear response, of floats.buoy yaw, about" in lines.attrs["warnings"]
    assert float(lines.attrs["warnings"].split("floats.buoy yaw, about ")[1].split()[0]) == approx(yaw, rel=0.5)


def test_tops_that_loads_push_aside_as_they_turn_are_told_of(monkeypatch):
    """With a second harmonic of 0.3 of the first in all modes each top's std is √1.09 of what it was."""
    item, h = SCENES["unequal_legs"]()
    item = linear(replace(item, sea=one_wave(item)), method="frequency")
    case = case_of(item, h)
    response, standing = respond_in(case, case.law(item.floats)), harmonics._Standing(np.zeros(1, int), np.ones(1), 1.0)
    waves = harmonics._waves(case, standing)
    usual = waves.lattice.first(response.X)
    second, modes = usual.copy(), case.system.structure.omega.size
    second[2, :modes] = 0.3 * response.X[0, :modes]
    assert harmonics._of_tops(case, waves, response, usual, second) == approx(1 - 1 / np.sqrt(1.09))
    monkeypatch.setattr(harmonics, "_of_tops", lambda *_: 7.0)
    assert simulate(item, h).attrs["rotation_effect"] == 7.0


def one_wave(item):
    """The largest, 1 cm high."""
    largest = np.abs(item.sea.amplitude).argmax()
    omega = item.sea.omega[largest : largest + 1]
    return components(amplitude=np.array([0.01]), omega=omega, phase=np.zeros(1), heading=item.sea.heading)


def steep_arm():
    """A ball of 3 m hinged 7 m up and 5 m aside: horizontal force times angle is first among what moves it."""
    ball = Revolution.sphere(radius=3.0, draft=3.0)
    mass = 1025 * ball.volume
    arm = {"hinge": (-5.0, 0, 7.0), "arm": (5.0, 0, -7.0), "pto_damping": 1e6}
    item = scene((Float(name="ball", hull=ball, mass=mass, inertia=(3.6 * mass,) * 3, **arm),), depth=20.0)
    return item, known(item, 0.3, 6.0)


def ring_on_a_spar():
    """Which the spar, pitching about a point below, carries up along itself: at sums of frequencies that heaves it."""
    spar = Revolution.vertical_cylinder(radius=1.0, draft=6.0, freeboard=3.0)
    collar = ring(((1.6, -0.8), (3.5, -0.8), (3.5, 1.2), (1.6, 1.2)))
    below = Float(
        name="spar", hull=spar, mass=1025 * spar.volume, inertia=(9e4, 9e4, 1e4), cog=(0, 0, -4), hinge=(0, 0, -4.0),
        arm=(0, 0, 4.0), motion=("surge", "heave", "pitch"), stiffness=(4e3, 0, 0), damping=(5e2, 1e3, 5e3),
    )  # fmt: skip
    of_ring = {"mass": 1025 * collar.volume, "inertia": (1e5, 1e5, 2e5), "cog": (0, 0, 0.2), "hinge": (0, 0, 0)}
    above = Float(name="ring", on="spar", hull=collar, motion=("heave",), pto_damping=2e4, **of_ring)
    item = scene((below, above), interaction=False)
    return item, known(item, 0.3, 6.0)


def column():
    """Free, its joint at still water: what turns is no arm, but a centre of gravity 8 m below the reference point."""
    hull = Revolution.vertical_cylinder(radius=3.0, draft=12.0, freeboard=4.0)
    mass, free = 1025 * hull.volume, {"motion": ("surge", "heave", "pitch"), "damping": (2e4, 2e4, 1e6)}
    body = {"hull": hull, "mass": mass, "inertia": (20 * mass,) * 3, "cog": (0, 0, -8.0), "hinge": (0, 0, 0)}
    item = scene((Float(name="column", **body, **free, stiffness=(2e4, 0, 0)),), waves=sea(Tp=7.0, band=(0.6, 2.4)))
    return item, known(item, 0.3, 6.0)


APART = np.array([16, 19, 22, 28, 34, 43, 52])  # no sums or differences of two or three of which are the same


def sea_of(item):
    unit, amplitude = np.median(item.sea.omega) / 30, 0.01 * np.linspace(1.0, 0.4, APART.size)
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, APART.size)
    waves = components(amplitude=amplitude, omega=unit * APART, phase=phase, heading=item.sea.heading)
    return replace(item, sea=waves)


@pytest.mark.parametrize(
    ("name", "angle"),
    [
        ("model_scale", 0.1),
        ("steep_arm", 0.06),
        ("ring_on_a_spar", 0.04),
        ("column", 0.05),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (
                ("duck", 0.1), ("flap", 0.1), ("oblique", 0.1), ("oblique", 0.05), ("unequal_legs", 0.1),
                ("unequal_legs", 0.03), ("steep_arm", 0.03), ("ring_on_a_spar", 0.02),
            )
        ),
    ],
)  # fmt: skip
def test_in_a_sea_it_is_told_as_the_march_shows(name, angle):
    """Of all that it is told of the largest, where arms turn little and where they lean much on what turns little."""

    item, h = swinging(name, angle, sea_of)
    period = 2 * np.pi * APART[0] / item.sea.omega[0]
    lasting = {"duration": period, "discard": 14 * period, "ramp": 2 * period, "ramp_form": "cosine"}
    lines = simulate(linear(item, **lasting), h)
    numerics = {"memory_tolerance": 1e-3, "time_step": period / 1200, "newton_tolerance": 1e-10}
    record = simulate(linear(item, method="time", keep_series=True, **lasting, **numerics), h)
    seen = largest(
        record.variables, lines.variables, (*BORNE, *(["bottom_stress", "top_displacement"] if item.platform else []))
    )
    assert 0.55 < seen / lines.attrs["rotation_effect"] < 1.4
    # Joints' forces are about as skewed, by which their extremes are to be larger.
    case = case_of(item, h)
    law = case.law(item.floats)
    response = respond_in(case, law)
    tables = {name: values for name, (_, values) in lines.variables.items()}
    told = rotation.rotation_effect(case, law, response, frame_forces(case, response), tables).extremes
    force = case.channels.hinge_force(response.wrench)
    force = force.reshape(len(force), -1)
    y = record.series["hinge_force"][1].reshape(-1, force.shape[1])
    used = y.std(axis=0) > 0.02 * y.std(axis=0).max()
    u = gaussian.peak(force[:, used], case.process)
    assert told - 1 == approx(np.max(np.abs(skew(y[:, used])) * (u - 1 / u)) / 6, rel=0.5, abs=0.13)


def test_what_two_waves_show_is_that_of_seven_with_more_of_it():
    """⟨x⁴⟩ of n equal waves is (3 - 1.5/n)σ⁴, half of what x² varies by at sums; below zero radiates the conjugate."""
    item, h = swinging("steep_arm", 0.06, sea_of)
    case, n = case_of(item, h), 7
    waves = harmonics._waves(case, harmonics._Standing(np.array([0, 1]), np.ones(2), n))  # ω₁ - 2ω₂ < 0
    t = np.arange(5000) * 2 * np.pi / 5000
    sums, differences = (np.zeros(2), np.zeros(2))
    for k, lines in enumerate((np.array([51, 450]), np.array([1, 8, 64, 125, 216, 343, 512]))):
        x = np.sqrt(2 / len(lines)) * np.cos(np.outer(t, lines)).sum(axis=1)
        square = np.abs(np.fft.rfft(x**2)[1:] / t.size) ** 2 * 2
        at = np.unique(np.add.outer(lines, lines)) - 1
        sums[k], differences[k] = square[at.astype(int)].sum(), square.sum() - square[at.astype(int)].sum()
    own, difference = waves.lattice.own[0], np.flatnonzero((waves.lattice.sums == [1, -1]).all(axis=1))
    assert waves.more[own] == approx(sums[1] / sums[0]) and waves.more[difference] == approx(
        differences[1] / differences[0]
    )
    below = waves.omega < 0
    Y = impedance_anywhere(case.system, h, -waves.omega[below])
    assert below.any() and waves.Y[below] == approx(Y.conj(), rel=1e-12)


def test_that_turning_skews_forces_is_told():
    for angle, told in ((0.06, True), (0.01, False)):
        item, h = swinging("steep_arm", angle, lambda item: item)
        text = simulate(item, h).attrs.get("warnings", "")
        assert ("arms turn, and forces of joints are not linear" in text) is told


def test_waves_of_one_frequency_make_no_difference():
    """Nor do two whose sum is none; a shape that nothing holds is not moved by either."""
    item, h = column()
    free = replace(item.floats[0], stiffness=(0.0, 0.0, 0.0))
    for omega in ([1.0, 1.0], [0.9, 0.9, 1.3], [0.8, 1.6]):
        waves = components(amplitude=np.full(len(omega), 0.05), omega=np.array(omega), phase=np.arange(len(omega)))
        record = simulate(linear(replace(item, floats=(free,), sea=waves), method="frequency"), h)
        assert 0 < record.attrs["rotation_effect"] < 0.05


@pytest.mark.parametrize(("name", "angle", "most"), [("column", 0.2, 0.08), ("oblique", 0.25, 0.5)])
def test_rounds_that_go_to_and_fro_are_brought_to_agree(name, angle, most):
    """A free column's drift shifts its phase, and so its drift."""
    little, large = (simulate(*swinging(name, a, sea_of)).attrs["rotation_effect"] for a in (angle / 2, angle))
    assert 2 * little < large < most


def test_of_what_is_linear_few_rounds_are_enough():
    """Where three ways grow, that many differences find what agrees, however long each is."""
    growth, of = np.diag([1.5, -1.3, -0.8, 0.0]), np.array([1.0, 2e3, 3.0, 4.0])
    turn = np.linalg.qr(np.vander([1.0, 2.0, 3.0, 4.0]))[0]
    x, steps = np.zeros((1, 2), complex), Steps(np.array([1.0, 1e-3]))
    for _ in range(5):
        found = ((turn @ growth @ turn.T) @ x.view(float)[0] + of).view(complex)[None]
        x = steps.after(x, found)
    assert x.view(float)[0] == approx(np.linalg.solve(np.eye(4) - turn @ growth @ turn.T, of), rel=1e-9)


def test_a_wave_that_no_round_agrees_for_is_not_told():
    item, h = SCENES["duck"]()
    high = linear(replace(item, sea=regular(height=30.0, period=4.0)), method="frequency")
    record = simulate(high, h)
    assert record.attrs["rotation_effect"] == 1.0 and harmonics.NO_BALANCE in record.attrs["warnings"]


@pytest.fixture(scope="module")
def spar():
    """A column too deep to follow the waves, 17 s in heave, that carries two floats."""
    column = Revolution.vertical_cylinder(radius=2.0, draft=70.0, freeboard=2.0)
    mass, ball = 1025 * column.volume, Revolution.hemisphere_cylinder(radius=1.0, height=0.6)
    free = {"motion": ("heave",), "damping": (3e3,)}
    base = Float(name="base", hull=column, mass=mass, inertia=(4 * mass,) * 3, cog=(0, 0, -36), hinge=(0, 0, 0), **free)
    of_arm = {"on": "base", "hull": ball, "mass": 2147.0, "inertia": (859.0,) * 3, "pto_damping": 2e4}
    fore, aft = ({"hinge": (way * 2.0, 0, 2.6), "arm": (way * 4.0, 0, -2.6)} for way in (-1, 1))
    item = scene(
        (base, Float(name="fore", **fore, **of_arm), Float(name="aft", **aft, **of_arm)),
        depth=100.0, froude_krylov="linear", duration=10800.0, discard=600.0,
    )  # fmt: skip
    return item, known(item, 0.3, 6.0, count=12)


def in_sea(item, Hs, seed, **settings):
    waves = realize(PiersonMoskowitz(Hs=Hs, Tp=5.46), components=600, band=(0.7, 3.4), seed=seed)
    return replace(item, sea=waves, settings=replace(item.settings, **settings))


def heave(record):
    return record.variables["motion"][1][0, 0, STATISTICS.index("std")]


def test_what_swings_below_the_waves_is_told_though_no_line_has_it(spar):
    """Linear theory has a tenth of the heave; the mean of its square over some records."""
    item, h = spar
    lines = in_sea(item, 0.6, 1, method="frequency")
    record, case = simulate(lines, h), case_of(lines, h)
    response = respond(lines, h)
    expected = np.hypot(slow_motions(case, response, resonant(case, response))[0], heave(record))
    marched = np.sqrt(np.mean([heave(simulate(in_sea(item, 0.6, seed), h)) ** 2 for seed in (1, 2, 3)]))
    assert expected == approx(marched, rel=0.15)
    assert record.attrs["rotation_effect"] == approx(1 - heave(record) / expected, rel=0.05)
    assert marched > 5 * heave(record) and "rotation_effect" in record.attrs["warnings"]


def test_evenly_spaced_waves_have_few_differences(spar):
    """Between which the spar swings: a spectrum would say 2.4 times as much."""
    item, h = spar
    seas = [
        realize(PiersonMoskowitz(Hs=0.6, Tp=5.46), components=20, band=(0.7, 3.4), seed=seed, intervals="even")
        for seed in (1, 2, 3)
    ]
    lines = replace(item, sea=seas[0], settings=replace(item.settings, method="frequency"))
    case, response = case_of(lines, h), respond(lines, h)
    expected = np.hypot(slow_motions(case, response, resonant(case, response))[0], heave(simulate(lines, h)))
    marched = np.sqrt(np.mean([heave(simulate(replace(item, sea=waves), h)) ** 2 for waves in seas]))
    assert expected == approx(marched, rel=0.3)


@pytest.mark.slow
def test_it_grows_with_the_waves_height_squared_and_one_wave_has_none(spar):
    item, h = spar
    low, high = (in_sea(item, Hs, 1, method="frequency") for Hs in (0.3, 0.6))

    def slow(item):
        case, response = case_of(item, h), respond(item, h)
        return slow_motions(case, response, resonant(case, response))

    low_std, high_std = map(slow, (low, high))
    assert high_std == approx(4 * low_std, rel=1e-6) and high_std[0] > 0
    one = replace(low, sea=regular(height=0.5, period=5.0))
    assert slow(one).max() == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("times", [50.0, 500.0])
def test_what_heavy_dampers_let_creep_below_the_waves_is_told(times):
    """Of ducks on a moored barge, against the march of waves 20 times lower, in which they creep by nothing."""
    item = rotors()
    h = known(item, 0.3, 4.0, 12)
    damped = tuple(replace(f, pto_damping=tuple(times * f.per_axis("pto_damping"))) for f in item.floats)
    waves = realize(PiersonMoskowitz(Hs=2.1, Tp=6.0), components=120, band=(0.7, 2.6), seed=1)
    item = linear(replace(item, floats=damped, sea=waves), duration=1800.0, discard=400.0, ramp=60.0)
    told = simulate(linear(item, method="frequency"), h).attrs["rotation_effect"]
    low = replace(item, sea=replace(waves, amplitude=0.05 * waves.amplitude))
    high, small = (simulate(each, h).variables for each in (item, low))
    scaled = {
        name: (dims, values * (400 if name == "absorbed_power" else 20)) for name, (dims, values) in small.items()
    }
    seen = largest(high, scaled, BORNE)
    assert 0.5 < seen / told < 2.5


def test_of_many_floats_two_waves_tell_of_differences_too(monkeypatch):
    item, h = swinging("ring_on_a_spar", 0.04, lambda item: item)
    told = simulate(item, h).attrs["rotation_effect"]
    monkeypatch.setattr(rotation, "CURVED", 3)
    assert simulate(item, h).attrs["rotation_effect"] == approx(told, rel=0.3) and told > 0.01


def test_what_only_slides_has_none():
    """A buoy on a soft spring below the waves."""
    item, h = SCENES["soft_mooring"]()
    barge = item.floats[0]
    sliding = replace(barge, motion=("surge",), stiffness=barge.stiffness[:1], damping=barge.damping[:1])
    record = simulate(linear(replace(item, floats=(sliding,)), method="frequency"), h)
    assert record.attrs["rotation_effect"] < 1e-9


def test_the_load_of_two_waves_is_what_the_assembled_loads_make_of_their_motions(spar):
    """At the difference of their frequencies, without what waves add: the even part of the loads, sampled in time."""
    item, h = spar
    waves = components(amplitude=np.full(2, 0.1), omega=np.array([1.0, 1.5]), phase=np.zeros(2))
    case = case_of(replace(item, sea=waves, settings=replace(item.settings, method="frequency")), h)
    (swinging,), model = rotation._swinging(case), case.model
    rate, rng = -1j * case.waves[:, None], np.random.default_rng(1)
    X = 1e-3 * (rng.normal(size=(2, len(model.mass))) + 1j * rng.normal(size=(2, len(model.mass))))
    still = sum(np.einsum("wn,bdn->wbd", rate**k * X, slope) for k, slope in enumerate(model.wrench))
    alone = swinging._replace(pairs=np.array([[1], [0]]))
    told = rotation._spectrum(
        alone, np.ones(1), case.waves, X @ model.shape.T, second_order.added(case, case.waves, X, still)
    )
    t = np.arange(400) * 4 * np.pi / 400  # two turns of one wave and three of the other
    s = [(np.exp(np.outer(t, rate[:, 0])) @ (rate**k * X @ model.shape.T)).real for k in range(3)]
    z, body = case.system.equilibrium[0], case.system.bodies
    even = sum(balance(body, z + sign * s[0], sign * s[1], sign * s[2])[0] for sign in (1, -1)) / 2
    load = even @ (model.shape @ swinging.shape)
    assert told == approx(0.5 * np.abs(2 * np.mean(load * np.exp(0.5j * t))) ** 2, rel=1e-3)


def test_pairs_of_waves_move_what_their_loads_of_second_order_do():
    """Few waves stand for themselves alone: the sum over their pairs, one by one."""
    item, h = SCENES["duck"]()
    waves = components(amplitude=np.full(3, 0.1), omega=np.array([1.0, 1.3, 1.5]), phase=np.arange(3.0))
    item = linear(replace(item, sea=waves), method="frequency")
    case, found = case_of(item, h), respond(item, h)
    of, body = rotation._slowly(case), case.system.resting
    s, W = (
        second_order.states(case.waves, found.Z[:3]),
        second_order.added(case, case.waves, found.X[:3], found.wrench[:3]),
    )
    levers = second_order.turning(body).levers.reshape(found.Z.shape[1], -1, found.Z.shape[1])
    expected = 0.0
    for i, j in ((1, 0), (2, 0), (2, 1)):
        ways = (np.einsum("i,iwk,w->k", found.Z[a], levers, W[b].conj()) for a, b in ((i, j), (j, i)))
        f = 0.5 * (next(ways) + next(ways).conj() + second_order.curvature(body) @ s[j].conj() @ s[i])
        k = np.argmin(np.abs(np.log(of.omega / (case.waves[i] - case.waves[j]))))
        Z = of.Z[k] - 1j * of.omega[k] * found.damping
        expected += 0.5 * np.abs(np.linalg.solve(Z, of.others @ f)) ** 2
    assert np.all(expected > 0)
    assert rotation.below_the_waves(case, found) == approx(expected, rel=1e-9)
