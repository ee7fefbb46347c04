"""Where the solver stops, what it says then, and that what goes on is sane."""

import os
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from pipeline.bridge import cache
from solver import limits
from solver.coupled.blocks import blocks
from solver.coupled.energy import WORKS, open_by
from solver.coupled.march import WATCH
from solver.coupled.preparation import prepare
from solver.coupled.system import BLOCK_STEPS
from solver.errors import InputError, SimulationFailed, StepTooLong
from solver.hydrodynamics.hull.revolution import Revolution
from solver.multibody.bodies import new_motion
from solver.multibody.minimal import move
from solver.multibody.way import ways
from solver.run import _nearer, simulate
from solver.scene import DOFS, Float, Platform, straight_down
from solver.sea.field import WaveField
from solver.sea.realization import CALM, Realization, regular
from solver.statistics import STATISTICS
from solver.structure.frame import Frame
from solver.structure.members import Member, PointMass
from solver.structure.sections import tube
from tests.awkward import RHO, STEEL, known
from tests.awkward import scene as awkward_scene
from tests.interpreted import motions

HEAVY_DAMPING = 1e8  # a thousand times the optimum: the joints are locked [N m s/rad]


def calm(buan):
    return replace(buan.sea(), amplitude=np.zeros(130, complex))


def turned(buan, angle, **changes):
    """Floats let go turned by `angle` towards the sky (+) or the seabed (-), in still water."""
    front, rear = buan.floats(**changes)
    return buan.scene("fixed", sea=calm(buan), floats=(replace(front, offset=angle), replace(rear, offset=-angle)))


@pytest.mark.parametrize("ratio", [0.05, 0.3, 1.0, 1.5])
def test_equilibrium_carries_the_weight_on_the_side_where_the_arm_is(buan, coefficients, ratio):
    """Buoyancy at rest equals the weight, by the closed form of the sunk or lifted hemisphere and cylinder."""
    mass = ratio * 1025 * 2 / 3 * np.pi
    scene = buan.scene("fixed", sea=calm(buan), floats=buan.floats(mass=mass), arc_points=20, azimuths=24)
    system = prepare(scene, coefficients)
    front, rear = system.start().z
    # The arm's end rises by this much; the hull turns with it, which a sphere does not feel.
    assert front == approx(-rear, abs=1e-9) and abs(front) < straight_down(buan.floats()[1])
    if ratio <= 1:
        x, z = np.array([-2.36, -2.6])
        centre = 2.6 + z * np.cos(front) - x * np.sin(front)
        draft = 1.0 - centre
        assert np.pi * draft**2 * (1 - draft / 3) * 1025 == approx(mass, rel=1e-6)


def test_what_nothing_carries_has_no_equilibrium(buan, coefficients):
    """A guided float heavier than its whole hull's displacement sinks for ever."""
    sinking = buan.floats(mass=5000.0, motion=("heave",), pto_damping=0.0)
    with pytest.raises(SimulationFailed, match="no static equilibrium"):
        prepare(buan.scene("fixed", sea=calm(buan), floats=sinking), coefficients).start()


@pytest.mark.parametrize(
    "angle", [0.1, 1.2, -0.6, *(pytest.param(angle, marks=pytest.mark.slow) for angle in (0.9, -0.3))]
)
def test_dropped_and_drowned_floats_come_back(buan, coefficients, angle):
    """Out of the water and slamming back, or submerged whole: energy closes, and they come to rest."""
    record = simulate(turned(buan, angle), coefficients)
    assert record.attrs["energy_residual"] < 1e-3 and record.attrs["repeated"] == ""
    last = record.variables["rotation"][1][:, 3]
    # Rest is that of the quadrature, 4e-5 rad off for the default points.
    assert np.abs(last).max() < 1e-2 * abs(angle)


def test_a_float_pushed_through_beneath_its_hinge_is_an_outcome(buan, coefficients):
    """Straight down is at 0.737 rad; 0.75 rad is past it, and buoyancy takes the float to the other side."""
    with pytest.raises(SimulationFailed, match=r"front hinge at -1.1\d at t = \d+\.\d s, beyond -1\.11 to \+1\.57"):
        simulate(turned(buan, -0.75), coefficients)


@pytest.mark.parametrize(("angle", "limit"), [(1.58, "-1.11 to +1.57"), (-1.12, "-1.11 to +1.57"), (30.0, "-1.11")])
def test_an_offset_past_what_a_run_would_end_at_is_refused(buan, angle, limit):
    with pytest.raises(InputError, match=re.escape(f"must be within {limit}")) as caught:
        turned(buan, angle)
    assert caught.value.key == "floats.front.offset" and caught.value.value == f"{angle:g} rad"
    turned(buan, 1.56 if angle > 0 else -1.1)


@pytest.mark.parametrize(
    "arm, axis, down",
    [
        ((2.36, 0.0, -2.6), (0.0, 1.0, 0.0), np.arctan2(2.36, 2.6)),
        ((-2.36, 0.0, -2.6), (0.0, 1.0, 0.0), -np.arctan2(2.36, 2.6)),
        ((2.36, 0.0, -2.6), (0.0, -3.0, 0.0), -np.arctan2(2.36, 2.6)),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), np.pi / 2),
        ((0.0, 1.0, -1.0), (1.0, 0.0, 0.0), -np.pi / 4),
        ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 0.0),
        ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0),  # turns about the plumb line: never beneath
    ],
)
def test_straight_down(buan, arm, axis, down):
    item = Float(
        name="f", hull=buan.floats()[0].hull, mass=1.0, inertia=(1.0,) * 3, hinge=(0, 0, 0), arm=arm, axis=axis
    )  # fmt: skip
    assert straight_down(item) == approx(down, abs=1e-12)


def test_bounds_follow_from_the_scene(buan):
    """Hinges half way past straight down, slides as far as the wave field is known, carriers the frame's size."""
    waves = WaveField(buan.sea(), 50.0, 9.81)
    scene = buan.scene()
    bound = limits.excursions(scene, waves, (16, 16), np.array([0, 2, 4]))
    size = np.linalg.norm([3.0, 2.4, 52.6])
    assert bound[:6] == approx(np.outer([size, size, np.pi / 2] * 2, [-1, 1]))
    down = np.arctan2(2.36, 2.6)
    assert bound[6:] == approx(np.array([[-1.5 * down, np.pi / 2], [-np.pi / 2, 1.5 * down]]))
    guided = replace(scene, floats=buan.floats(motion=("heave",)), platform=None)
    heave = limits.excursions(guided, waves, (16, 16), np.zeros(0, int))
    reach = heave[0, 1] + scene.floats[0].hull.size
    assert heave == approx(np.outer([1, 1], [-heave[0, 1], heave[0, 1]])) and waves.terms_for(reach, 1e-2) == 16


def test_more_waves_or_less_reach_need_fewer_terms(buan):
    """radius_for is terms_for turned round."""
    waves = WaveField(buan.sea(), 50.0, 9.81)
    for terms in (6, 12, 24):
        radius = waves.radius_for(terms, 1e-5)
        assert waves.terms_for(0.999 * radius, 1e-5) == terms and waves.terms_for(1.001 * radius, 1e-5) == terms + 1


def test_a_record_says_how_well_the_wave_field_was_known(buan, coefficients):
    """Within what was reckoned with, to less than the tolerance; linear floats need none."""
    guided = {"motion": ("heave",), "pto_damping": 0.0, "stiffness": 1e5}
    for start in (0.0, 0.4):
        floats = buan.floats(**guided, offset=start)
        scene = buan.scene("fixed", floats=floats, duration=5.0, discard=0.0, keep_series=True)
        system, record = prepare(scene, coefficients), simulate(scene, coefficients)
        reach = max(start, np.abs(record.series["motion"][1]).max()) + floats[0].hull.size
        assert record.attrs["field_error"] == approx(system.waves.left_out(system.terms[0], reach), rel=1e-9)
        assert 0 < record.attrs["field_error"] < scene.settings.field_tolerance
    flat = replace(scene, settings=replace(scene.settings, froude_krylov="linear"))
    assert simulate(flat, coefficients).attrs["field_error"] == 0


@pytest.mark.parametrize("formulation", ["minimal", "augmented"])
def test_a_record_says_how_much_of_the_seabed_was_left_out(buan, coefficients, formulation):
    short = {"duration": 1.0, "discard": 0.0, "time_step": 0.1, "formulation": formulation}
    attrs = simulate(buan.scene("fixed", **short), coefficients).attrs
    assert attrs["seabed_error"] == coefficients.settings["seabed_error"] > 0
    assert attrs["mesh_error"] == coefficients.mesh_error > 0


def test_how_far_a_float_has_been_is_reckoned_from_the_support_on(buan, coefficients):
    """An arm of 3.5 m, on a platform that sways and turns: along the waves and up, as it is moved."""
    system = prepare(buan.scene(), coefficients)
    z = np.random.default_rng(1).uniform(-0.6, 0.6, (200, system.bodies.mechanism.size))
    motion, still = new_motion(system.bodies), np.zeros(z.shape[1])
    for row, way in zip(z, ways(system.bodies, z), strict=True):
        move(system.bodies, row, still, motion)
        gone = motion.position - system.bodies.about
        assert way == approx(np.hypot(gone @ system.near.direction, gone[:, 2]), abs=1e-12)
    alone, arm = prepare(buan.scene("fixed"), coefficients).bodies, np.hypot(2.36, 2.6)
    assert ways(alone, np.array([[0.8, 0.0]]))[0] == approx([2 * np.sin(0.4) * arm, 0.0])


def test_a_float_that_reaches_through_too_many_waves_is_refused(buan, coefficients):
    """A 40 m arm swings ±31 m through waves of 5.3 m: the series about its rest would be rounding."""
    front, rear = buan.floats()
    floats = (replace(front, arm=(-40.0, 0, -2.6)), rear)
    known = replace(coefficients, centres=np.array([f.centre for f in floats]))
    feels = r"around a float that feels them by 0\.[2-9]\d* of the largest wave force per amplitude, > 0\.1: "
    of = r"floats\.front\.arm = \(-40\.0, 0, -2\.6\): waves down to 5\.\d+ m are too short for a series 32\.\d m"
    with pytest.raises(InputError, match=f"{of} {feels}bring it down, or end the band lower"):
        prepare(buan.scene("fixed", floats=floats), known)
    # Linear pressure is that at rest, wherever the float is.
    assert prepare(buan.scene("fixed", floats=floats, froude_krylov="linear"), known).terms == (0, 0)


@pytest.mark.parametrize(
    ("motion", "changes", "key"),
    [
        (("surge", "heave"), {"offset": (60.0, 0.0)}, r"floats\.ball\.offset = \(60\.0, 0\.0\): waves down to"),
        (("surge", "heave"), {"offset": (0.0, -60.0)}, r"floats\.ball\.offset = \(0\.0, -60\.0\): waves down to"),
        (("sway", "pitch"), {"offset": (60.0, 0.0)}, "sea = waves down to"),
        (("heave",), {"arm": (60.0, 0.0, 0.0), "hinge": (-60.0, 0.0, 0.0)}, "sea = waves down to"),
    ],
)
def test_what_takes_a_float_through_too_many_waves_is_named(motion, changes, key):
    """Along them or up and down, by where it is let go; across them, or on an arm that does not turn, they are short
    already beside the hull."""
    ball = Revolution.sphere(radius=10.0, draft=10.0)
    item = Float(
        name="ball", hull=ball, mass=RHO * ball.volume, inertia=(9e7,) * 3, cog=(0, 0, -2.0), motion=motion,
        **({"hinge": (0, 0, 0)} | changes),
    )  # fmt: skip
    waves = Realization(omega=np.array([0.9, 6.5]), amplitude=np.array([0.4, 0.1 + 0.1j]))
    whole = awkward_scene([item], depth=400.0, waves=waves)
    settings = replace(whole.settings, radiation=False, diffraction=False)
    with pytest.raises(InputError, match=f"^{key}"):
        prepare(replace(whole, settings=settings), None)


def test_waves_that_a_hull_hardly_feels_may_be_too_short_for_a_series():
    """Of 2 m at a sphere of 10 m: their pressure is linear, that of the others is integrated as if they were alone."""
    ball = Revolution.sphere(radius=10.0, draft=10.0)
    item = Float(
        name="ball", hull=ball, mass=RHO * ball.volume, inertia=(9e7,) * 3, hinge=(0, 0, 0), motion=("heave",),
        cog=(0, 0, -2.0),
    )  # fmt: skip
    waves = Realization(omega=np.array([0.9, 5.5]), amplitude=np.array([0.4, 0.1 + 0.1j]))
    both = awkward_scene([item], depth=400.0, waves=waves)
    h = known(both, 0.3, 6.0, 30)
    alone = replace(both, sea=replace(waves, amplitude=waves.amplitude * [1, 0]))
    short, long = prepare(both, h), prepare(alone, h)
    assert short.near != short.waves and long.near == long.waves
    told = replace(both, settings=replace(both.settings, diffraction=False), sea=replace(waves, heading=0.3))
    with pytest.raises(InputError, match=r"sea.heading = 0.3: must be 0 rad, that of the coefficients"):
        prepare(told, h)
    at = short.layout.excitation
    assert np.all(short.rows[short.layout.field] == long.rows[long.layout.field])
    assert np.all(short.rows[at][:, 0] == long.rows[long.layout.excitation][:, 0])
    total = (h.excitation(waves.omega[1:]) * waves.amplitude[1])[0]
    moved = [DOFS.index(d) for d in h.dofs]
    assert short.rows[at][moved, 1] == approx(total)
    record, other, linear = (
        simulate(replace(s, settings=replace(s.settings, duration=60.0, discard=20.0, froude_krylov=kind)), h)
        for s, kind in ((both, "body-nonlinear"), (alone, "body-nonlinear"), (both, "linear"))
    )
    assert "of 2.04 m and less, which floats hardly feel: it is linear (0.11 of the" in record.attrs["skipped"]
    heave = [r.variables["motion"][1][0, 0, 4] for r in (record, other, linear)]
    assert heave[0] == approx(heave[1], rel=0.01) and heave[0] == approx(heave[2], rel=0.02)


def test_a_sliding_float_may_follow_the_waves(buan, coefficients):
    """Bounds of what slides hold twice the significant wave height beside where it is let go, and end."""
    for Hs in (0.5, 2.0):
        guided = buan.scene("fixed", sea=buan.sea(Hs=Hs), floats=buan.floats(motion=("heave",)))
        low, high = prepare(guided, coefficients).bodies.limit[0]
        assert 2 * guided.sea.parameters()["Hm0"] < high == -low < 10 * Hs + 5


def test_locked_joints_close_their_balance_at_the_default_step(buan, coefficients):
    scene = buan.scene("fixed", floats=buan.floats(pto_damping=HEAVY_DAMPING))
    attrs = simulate(scene, coefficients).attrs
    assert attrs["repeated"] == "" and attrs["energy_residual"] < 1e-3


def test_what_a_finer_step_helps_is_repeated_once_and_the_record_says_so(buan, coefficients, monkeypatch):
    monkeypatch.setattr(sys.modules["solver.run"], "BALANCE", 3e-7)
    scene = buan.scene("fixed", time_step=0.2)
    attrs = simulate(scene, coefficients).attrs
    assert attrs["repeated"].startswith("energy balance at t = ")
    assert attrs["time_step"] == scene.settings.time_step / 4 and attrs["energy_residual"] < 3e-7


@pytest.mark.parametrize(
    ("helped", "step", "attempt"),
    [(0.0, 0.05, "second"), pytest.param(0.5, 0.003125, "fourth", marks=pytest.mark.slow)],
)
def test_what_a_finer_step_does_not_help_fails_with_both_messages(
    buan, coefficients, monkeypatch, helped, step, attempt
):
    """After the first that comes no nearer to a balance, or the last that may be tried."""
    monkeypatch.setattr(sys.modules["solver.run"], "BALANCE", 0.0)
    monkeypatch.setattr(sys.modules["solver.run"], "HELPED", helped)
    with pytest.raises(
        SimulationFailed, match=rf"time_step = {step} s.*{attempt} attempt; the first: .*0\.2 s"
    ) as error:
        simulate(buan.scene("fixed", time_step=0.2), coefficients)
    assert not isinstance(error.value, StepTooLong)


@pytest.mark.parametrize(
    ("error", "last", "nearer"),
    [
        (StepTooLong("", t=2.0), StepTooLong("", t=0.5), True),
        (StepTooLong("", t=0.5), StepTooLong("", t=0.5), False),
        (StepTooLong("", gap=0.15, t=10.0), StepTooLong("", t=10.0), True),
        (StepTooLong("", t=9.0), StepTooLong("", gap=0.15, t=10.0), False),
        (StepTooLong("", gap=0.05, t=10.0), StepTooLong("", gap=0.15, t=10.0), True),
        (StepTooLong("", gap=0.14, t=10.0), StepTooLong("", gap=0.15, t=10.0), False),
    ],
)
def test_who_gets_further_or_nearer_to_a_balance_may_try_again(error, last, nearer):
    """Where Newton's method fails there is no balance to be near to."""
    assert _nearer(error, last) is nearer


@pytest.mark.slow
def test_waves_that_begin_at_once_set_a_pile_swinging():
    """Shorter steps until the balance closes, as long as each comes nearer to it; the same numbers as by short ones."""
    pile = Member(
        name="pile", start="foot", end="top", elements=4, section=tube(1.2, 0.025), material=STEEL,
        inertia_coefficient=2.0,
    )  # fmt: skip
    frame = Frame(
        nodes={"foot": (0.0, 0.0, -20.0), "top": (0.0, 0.0, 5.0)}, members=(pile,), clamped=("foot",),
        masses=(PointMass(node="top", mass=1.2e4),),
    )  # fmt: skip
    platform = Platform(frame=frame, legs=("pile",), damping_ratio=0.02)
    waves = regular(height=1.0, period=12.0, phase=np.pi / 2)
    scene = awkward_scene((), depth=20.0, waves=waves, platform=platform, ramp=0.0, duration=600.0, discard=100.0)
    usual, fine = (simulate(replace(scene, settings=replace(scene.settings, time_step=dt))) for dt in (None, 0.01))
    first = float(re.search(r"time_step = (\S+) s", usual.attrs["repeated"])[1])
    assert first / usual.attrs["time_step"] == approx(64) and usual.attrs["energy_residual"] < 1e-3
    assert fine.attrs["repeated"] == ""
    std = [record.variables["top_displacement"][1][0, 0, STATISTICS.index("std")] for record in (usual, fine)]
    assert std[0] == approx(std[1], rel=1e-3)


@pytest.mark.parametrize("Hs", [1.28, 0.01, 1e-4])
def test_energy_from_nowhere_ends_a_run_within_a_few_steps(buan, coefficients, Hs):
    """An added mass that is not symmetric does work which no term of the balance accounts for."""
    system = prepare(buan.scene("fixed", sea=buan.sea(Hs=Hs)), coefficients)
    twist = np.zeros_like(system.bodies.added_mass)
    twist[0, 4], twist[4, 0] = 2e4, -2e4
    odd = replace(system, bodies=system.bodies._replace(added_mass=system.bodies.added_mass + twist))
    with pytest.raises(StepTooLong, match=r"open by .* of the energy exchanged, > 0\.1") as error:
        list(blocks(odd, odd.start(), BLOCK_STEPS))
    step = float(str(error.value).split("t = ")[1].split(" s")[0]) / system.dt
    assert 40 < step < BLOCK_STEPS and round(step) % WATCH == 0


def test_energy_that_only_goes_to_and_fro_is_no_alarm(buan, coefficients):
    """Free decay without any loss: all works return to nothing once a period."""
    floats = [replace(f, offset=0.1, pto_damping=0.0) for f in buan.floats()]
    still = {"sea": CALM, "radiation": False, "diffraction": False, "duration": 200.0}
    attrs = simulate(buan.scene("fixed", floats=tuple(floats), **still), coefficients).attrs
    assert attrs["repeated"] == "" and attrs["energy_residual"] < 1e-3


@pytest.mark.parametrize("Hs", [0.01, 0.05, 0.2])
def test_calm_seas_close_their_balance_at_the_default_step(buan, coefficients, Hs):
    """Weight and buoyancy are far larger than what varies: their work is that of the step's last velocities."""
    attrs = simulate(buan.scene("fixed", sea=buan.sea(Hs=Hs), duration=200.0), coefficients).attrs
    assert attrs["repeated"] == "" and attrs["energy_residual"] < 5e-4


@pytest.mark.parametrize("place", range(len(WORKS) + 1))
def test_a_balance_with_nan_is_open(place):
    values = np.ones(len(WORKS) + 1)
    values[place] = np.nan
    assert np.isnan(open_by(values[:-1], values[-1], np.array([0.0, 1.0, 0.0])))


def test_a_jolt_at_the_start_is_no_alarm(buan):
    """Without a ramp a stiff platform rings: the work of that is lost between samples, and then no more."""
    stiff = buan.platform(frame=buan.frame(stiffer=1e3))
    attrs = simulate(buan.scene(floats=(), platform=stiff, ramp=0.0, duration=900.0), None).attrs
    assert attrs["energy_residual"] < 1e-3 and "> 0.1:" not in attrs["repeated"]


def test_a_step_too_long_for_the_waves_is_refused(buan):
    with pytest.raises(InputError, match="a sixth of the shortest"):
        buan.scene("fixed", time_step=0.47)


@pytest.mark.parametrize("stiffer", [1e-2, pytest.param(1e2, marks=pytest.mark.slow), 1e6])
@pytest.mark.parametrize("ratio", [0.05, pytest.param(1.0, marks=pytest.mark.slow), 1.5])
def test_default_step_is_stable_for_soft_and_stiff_platforms_and_light_and_heavy_floats(
    buan, coefficients, stiffer, ratio
):
    mass = ratio * 1025 * 2 / 3 * np.pi
    scene = buan.scene(
        platform=buan.platform(frame=buan.frame(stiffer=stiffer)),
        floats=buan.floats(mass=mass, inertia=(859.0 * ratio,) * 3),
    )
    attrs = simulate(scene, coefficients).attrs
    assert attrs["energy_residual"] < 1e-3 and attrs["repeated"] == ""


@pytest.mark.slow
def test_interpreted_and_compiled_kernels_agree(coefficients, tmp_path):
    """The same short runs without the compiler, in another process.

    1e-9 of the largest value: the compiler reorders sums, and the weight that cancels buoyancy is
    up to 1e4 times what moves the float, so rounding (1e-16) may come to 1e-12 a step.
    """
    (tmp_path / "coefficients.nc").write_bytes(cache.encode(coefficients))
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.getcwd()}
    files = [str(tmp_path / name) for name in ("coefficients.nc", "interpreted.npz")]
    subprocess.run([sys.executable, "tests/interpreted.py", *files], env=environment, check=True, timeout=600)
    with np.load(files[1]) as interpreted:
        for name, compiled in motions(coefficients).items():
            largest = np.abs(compiled).max(initial=0.0)
            assert interpreted[name] == approx(compiled, abs=1e-9 * largest), name
