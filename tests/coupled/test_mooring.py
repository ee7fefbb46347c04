"""Moorings whose matrices couple a float's axes: against closed forms, turned scenes, and both paths."""

from dataclasses import replace
from functools import cache
from math import inf

import numpy as np
import pytest
from numba import typeof
from pytest import approx
from scipy.linalg import expm, solve
from scipy.spatial.transform import Rotation

from solver.coupled.assembly import joint_law
from solver.coupled.linear import linear_model
from solver.coupled.natural import require_stable, system_modes
from solver.coupled.preparation import prepare
from solver.coupled.problem import new_output, new_workspace
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.hull.revolution import Revolution
from solver.mooring import Mooring
from solver.multibody.bodies import new_motion
from solver.multibody.minimal import move
from solver.multibody.of_axes import joint_energy, joint_loads
from solver.oddities import warnings
from solver.run import simulate
from solver.scene import DOFS, EndStops, Float, Scene, Settings, Water
from tests import awkward

M, TURNING = 2000.0, 800.0  # [kg], [kg m²]
K = np.array([[8e3, -2e3, 1.5e3], [-2e3, 5e3, 900.0], [1.5e3, 900.0, 3e3]])
C = np.array([[500.0, 100.0, -60.0], [100.0, 300.0, 40.0], [-60.0, 40.0, 200.0]])
SINES = np.array([1, 1, 1, 2, 2, 2])  # of differences of a rotation's elements
LEVEL = ("surge", "sway", "yaw")
PLANAR = ("surge", "heave", "pitch")


def rows(matrix):
    return tuple(tuple(float(x) for x in row) for row in matrix)


def lines(stiffness, damping=None, pretension=None):
    return Mooring(
        stiffness=rows(stiffness),
        damping=None if damping is None else rows(damping),
        pretension=None if pretension is None else tuple(float(x) for x in pretension),
    )


def floating(**joint):
    given = {"motion": LEVEL, "hinge": (0, 0, 0)} | joint
    ball = Revolution.sphere(radius=1.0, draft=1.0)
    return Float(name="ball", hull=ball, mass=M, inertia=(TURNING,) * 3, **given)


def dry(item, seconds=12.0, **settings):
    """A float on which nothing acts but its mooring, for what it can do is level."""
    given = {
        "duration": seconds, "discard": 0.0, "ramp": 0.0, "time_step": 0.05, "radiation": False, "diffraction": False,
        "froude_krylov": "none", "newton_tolerance": 1e-10, "keep_series": True,
    }  # fmt: skip
    return Scene(water=Water(depth=inf), floats=(item,), settings=Settings(**(given | settings)))


def exact(t, start, pull):
    """y(t) of M ÿ + C ẏ + K y = F₀, let go at rest from equilibrium and `start`."""
    mass = np.diag([M, M, TURNING])
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [-solve(mass, K), -solve(mass, C)]])
    return np.array([(expm(A * time) @ np.concatenate([start, np.zeros(3)]))[:3] for time in t]) + solve(K, pull)


@pytest.mark.parametrize("size", [3, 6])
def test_a_free_body_swings_on_a_coupled_spring_as_its_matrices_say(size):
    start, pull = np.array([0.4, -0.3, 0.2]), np.array([300.0, -200.0, 100.0])
    at = [DOFS.index(name) for name in LEVEL] if size == 6 else [0, 1, 2]
    stiffness, damping, pretension = np.zeros((size, size)), np.zeros((size, size)), np.zeros(size)
    stiffness[np.ix_(at, at)], damping[np.ix_(at, at)], pretension[at] = K, C, pull
    item = floating(mooring=lines(stiffness, damping, pretension), offset=tuple(start))
    record = simulate(dry(item))
    t, y = record.series["time"][1], record.series["motion"][1][:, 0]
    assert y == approx(exact(t, start, pull), abs=2e-5)
    assert record.attrs["energy_residual"] < 1e-6
    # What the lines' damping takes is what the body had; nothing is left of it after many periods.
    left = 0.5 * start @ K @ start
    assert simulate(dry(item, 60.0)).attrs["work_joint_damping"] == approx(left, rel=1e-4)


def test_kernels_are_not_compiled_once_more_for_lines_legs_or_stops():
    """All that a march is handed is of one type, whatever the scene has: another type is minutes of the compiler."""
    frame, _ = awkward.bare_legs()
    stops = EndStops(lower=(-1.0,) * 3, upper=(1.0,) * 3, stiffness=(1e4,) * 3, damping=(0.0,) * 3)
    bodies = floating(mooring=lines(K, C)), floating(), floating(end_stops=stops, coulomb=(9.0,) * 3)
    scenes = [*map(dry, bodies), replace(frame, settings=replace(frame.settings, radiation=False))]
    assert len({typeof(handed(prepare(item, None))) for item in scenes}) == 1


def handed(system):
    problem = system.problem()
    parts = system.drive(np.zeros((3, len(system.rows)))), system.start(), new_output(problem, 2)
    return problem, *parts, new_workspace(system.bodies, system.structure)


def test_periods_and_the_linear_model_have_the_matrices():
    system = prepare(dry(floating(mooring=lines(K, C))), None)
    model = linear_model(system)
    assert model.stiffness == approx(K, abs=1e-6 * K.max()) and model.damping == approx(C, abs=1e-6 * C.max())
    mass = np.diag([M, M, TURNING])
    omega = np.sqrt(np.sort(np.linalg.eigvals(solve(mass, K)).real))
    assert system_modes(system, None).omega == approx(omega, rel=1e-7)


def moved(bodies, y):
    """Motion (6,) of the first float's reference point at positions of its axes."""
    at = new_motion(bodies)
    move(bodies, y, np.zeros(y.size), at)
    R = at.rotation[0]
    return np.concatenate([at.position[0], [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]]) / SINES


def test_six_by_six_is_of_the_reference_point():
    """Its potential ½ xᵀ K x - F₀ x, x the motion that the chain of axes makes of it, is that of the axes near rest."""
    six = np.random.default_rng(1).normal(size=(6, 6))
    six, pull = 1e4 * (six @ six.T), 1e3 * np.arange(1.0, 7.0)
    for motion, hinge in [(PLANAR, (1.0, 0, 2.0)), (("hinge",), (-2.0, 1.0, 2.5)), (DOFS[::-1], (0.5, -0.4, -1.0))]:
        item = floating(motion=motion, hinge=hinge, arm=tuple(-np.array(hinge)), axis=(0.6, 0.8, 0.0),
                        mooring=lines(six, pretension=pull))  # fmt: skip
        moored, slack = item.moored, replace(item, mooring=lines(six)).moored.stiffness
        bodies = prepare(dry(replace(item, mooring=lines(six))), None).bodies
        y = 1e-5 * np.random.default_rng(2).normal(size=len(motion))
        x = moved(bodies, y)
        assert y @ slack @ y == approx(x @ six @ x, rel=1e-3)
        assert y @ moored.pretension == approx(x @ pull, rel=1e-3)
        # What is even in y is of second order: the point goes round, and the pull with it.
        even = (moved(bodies, 300 * y) + moved(bodies, -300 * y)) / 300**2
        assert y @ (moored.stiffness - slack) @ y == approx(-pull @ even, rel=1e-3)


def law_of(motion, **given):
    """Of a float that is moored off its reference point, hinged off it, too."""
    joint = {"hinge": (0.5, -0.4, -1.0), "arm": (-0.5, 0.4, 1.0), "axis": (0.6, 0.8, 0.0)}
    return joint_law((floating(motion=motion, **joint, mooring=Mooring(point=(0.3, 0.2, -0.7), **given)),))


def against(law, y, dy):
    """Load and energy of the axes at y (n,), and the power that is lost at rates dy (n,)."""
    loads = joint_loads(law, y[None], dy[None])
    return loads.spring[0], joint_energy(law, y), float(loads.loss[0] @ dy)


def random_lines(seed=5):
    six = np.random.default_rng(seed).normal(size=(2, 6, 6))
    K, C = 1e4 * (six[0] @ six[0].T), 1e3 * (six[1] @ six[1].T)
    return {"stiffness": rows(K), "damping": rows(C), "pretension": tuple(1e3 * np.arange(1.0, 7.0))}


@pytest.mark.parametrize("motion", [DOFS, ("yaw", "surge", "pitch", "roll"), PLANAR, ("hinge",)])
def test_lines_at_a_point_have_a_potential_and_take_power(motion):
    law, rng = law_of(motion, **random_lines()), np.random.default_rng(1)
    for size in (1e-3, 0.02, 0.7):  # below and above where a series is taken for an angle
        y, dy = size * rng.uniform(-1, 1, (2, len(motion)))
        spring, _, lost = against(law, y, dy)
        steps = 1e-6 * np.eye(y.size)
        slope = [(against(law, y + h, dy)[1] - against(law, y - h, dy)[1]) / 2e-6 for h in steps]
        assert spring == approx(slope, rel=1e-6, abs=1e-6 * np.abs(spring).max())
        assert lost > 0


def test_lines_at_a_point_are_the_same_whatever_turns_the_float_first():
    """One pose, reached by roll, pitch, yaw or yaw, pitch, roll, has one energy; and one load, seen from either."""
    given, angle = random_lines(), np.array([0.5, -0.4, 0.6])
    shift, joints = np.array([0.3, -0.2, 0.1]), ((*LEVEL[:2], "heave", *DOFS[3:]), (*LEVEL[:2], "heave", *DOFS[:2:-1]))
    one, two = (law_of(motion, **given) for motion in joints)
    turned = Rotation.from_euler("XYZ", angle)  # about axes that the float carries
    there = np.concatenate([shift, turned.as_euler("ZYX")])
    (load, energy, _), (other, same, _) = (
        against(law, y, np.ones(6)) for law, y in ((one, np.concatenate([shift, angle])), (two, there))
    )
    assert energy == approx(same, rel=1e-12) and load[:3] == approx(other[:3], rel=1e-10)
    assert abs(load[3:] - other[:2:-1]).max() > 0.05 * abs(load).max()  # axes that lie otherwise
    # A float at the point, turned by 0.4 about one axis and held by a spring against surge alone.
    law = joint_law((floating(motion=DOFS[4:5], hinge=(0, 0, 2.0), arm=(0, 0, -2.0),
                              mooring=lines(np.diag([1e4, 0, 0, 0, 0, 0]))),))  # fmt: skip
    assert against(law, np.array([0.4]), np.ones(1))[0] == approx(1e4 * 4.0 * np.sin(0.4) * np.cos(0.4), rel=1e-12)


def test_a_single_axis_may_turn_more_than_once():
    law = joint_law((floating(motion=("yaw",), mooring=lines(np.diag([1e4, 0, 0, 0, 0, 700.0]))),))
    spring, energy, _ = against(law, np.array([7.0]), np.ones(1))
    assert spring == approx([4900.0]) and energy == approx(0.5 * 700 * 49)


def test_a_free_body_swings_far_on_six_by_six_and_loses_no_energy():
    given = random_lines() | {"damping": None, "pretension": None}
    start = (0.4, -0.3, 0.2, 0.5, -0.4, 0.6)
    item = floating(motion=DOFS, mooring=Mooring(**given), offset=start)
    scene = dry(item, 10.0, time_step=0.02)
    record = simulate(replace(scene, water=Water(depth=inf, gravity=1e-9)))
    turning = record.series["motion"][1][:, 0, 3:]
    assert np.abs(turning).max() > 0.5 and record.attrs["energy_residual"] < 1e-5
    damped = floating(motion=DOFS, mooring=Mooring(**(random_lines() | {"pretension": None})), offset=start)
    lost = simulate(replace(dry(damped, 60.0, time_step=0.02), water=Water(depth=inf, gravity=1e-9)))
    assert lost.attrs["work_joint_damping"] == approx(joint_energy(joint_law((item,)), np.array(start)), rel=1e-3)


def test_a_diagonal_matrix_is_the_stiffness_of_each_axis():
    whole, known = awkward.soft_mooring()
    (item,) = whole.floats
    plain = simulate(whole, known)
    held = lines(np.diag(item.per_axis("stiffness")), np.diag(item.per_axis("damping")))
    moored = simulate(replace(whole, floats=(replace(item, stiffness=0.0, damping=0.0, mooring=held),)), known)
    for name, (_, values) in plain.variables.items():
        assert np.array_equal(moored.variables[name][1], values, equal_nan=True), name


def test_matrices_stand_at_the_axes_of_their_float():
    first = floating(mooring=lines(K, C, (1.0, 2.0, 3.0)), stiffness=(10.0, 0, 0))
    second = floating(motion=("heave", "pitch"), mooring=lines([[4.0, 1.0], [1.0, 5.0]]))
    law = joint_law((first, second), carriers=2)
    y, dy = np.random.default_rng(3).normal(size=(2, 1, 7))
    y[:, :2] = dy[:, :2] = 0.0
    loads = joint_loads(law, y, dy)
    expected = [0, 0, *(K @ y[0, 2:5] - [1, 2, 3] + [10 * y[0, 2], 0, 0]), *([[4, 1], [1, 5]] @ y[0, 5:])]
    assert loads.spring[0] == approx(expected, rel=1e-12)
    assert loads.loss[0] == approx([0, 0, *(C @ dy[0, 2:5]), 0, 0], rel=1e-12)


@cache
def column(heading):
    hull = Revolution.vertical_cylinder(radius=3.0, draft=3.0, freeboard=2.0)
    item = Float(name="column", hull=hull, mass=1025 * hull.volume, inertia=(5e5, 5e5, 5e5), cog=(0, 0, -1.0),
                 hinge=(0, 0, 0), motion=DOFS)  # fmt: skip
    waves = awkward.sea(Hs=0.05, Tp=6.0, band=(0.6, 2.2), heading=heading)
    whole = awkward.scene(
        [item], depth=100.0, waves=waves, froude_krylov="linear", duration=40.0, discard=0.0, ramp=10.0
    )
    return whole, awkward.known(whole, 0.3, 4.0, 20)


def six_lines():
    six = np.diag([4e4, 2e4, 1e4, 3e5, 2e5, 4e5])
    six[0, 4] = six[4, 0] = -5e4
    six[1, 3] = six[3, 1] = 4e4
    six[0, 1] = six[1, 0] = 6e3
    return six, 0.05 * six, np.array([250.0, -120.0, -500.0, 120.0, 250.0, 60.0])


def in_waves(heading, mooring):
    whole, known = column(heading)
    settings = replace(whole.settings, keep_series=True)
    scene = replace(whole, floats=(replace(whole.floats[0], mooring=mooring),), settings=settings)
    return simulate(scene, known).series["motion"][1][:, 0]


def test_a_turned_scene_has_the_turned_answer():
    angle = 0.7
    c, s = np.cos(angle), np.sin(angle)
    R = np.kron(np.eye(2), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
    stiffness, damping, pull = six_lines()
    here = in_waves(0.0, lines(stiffness, damping, pull))
    there = in_waves(angle, lines(R @ stiffness @ R.T, R @ damping @ R.T, R @ pull))
    # Turns about three axes one after another are no vector but for small ones; panels do not turn with the scene.
    for part in (slice(0, 3), slice(3, 6)):
        assert there[:, part] == approx(here[:, part] @ R[:3, :3].T, abs=5e-3 * np.abs(here[:, part]).max())
    assert np.abs(here[:, 1]).max() > 0.05 * np.abs(here[:, 0]).max()  # across the waves: by the lines alone


def test_it_rests_where_lines_and_water_balance():
    stiffness, _, pull = six_lines()
    whole, known = column(0.7)
    item = replace(whole.floats[0], mooring=lines(stiffness, pretension=pull))
    system = prepare(replace(whole, floats=(item,)), known)
    weight = 9.81 * item.mass * np.diag([0, 0, 0, 1.0, 1.0, 0])  # 1 m below the reference point
    water = known.hydrostatic_stiffness + weight
    assert system.equilibrium[0] == approx(solve(stiffness + water, pull), rel=2e-2, abs=1e-5)
    assert any("out of equilibrium" in text for text in warnings(system.scene))
    lighter = replace(item, mass=item.mass - 4e3 / 9.81, mooring=lines(stiffness, pretension=(0, 0, -4e3, 0, 0, 0)))
    assert not any("out of equilibrium" in text for text in warnings(replace(whole, floats=(lighter,))))


def test_time_and_frequency_have_the_same_answer_and_the_energy_closes():
    stiffness, damping, _ = six_lines()
    whole, known = column(0.7)
    item = replace(whole.floats[0], mooring=lines(stiffness, damping))
    waves = replace(whole.sea, omega=np.array([1.1]), amplitude=np.array([0.02 + 0j]))
    settings = replace(whole.settings, duration=2 * np.pi / 1.1 * 8, discard=300.0, ramp=30.0)
    scene = replace(whole, floats=(item,), sea=waves, settings=settings)
    time = simulate(scene, known)
    frequency = simulate(replace(scene, settings=replace(settings, method="frequency")), known)
    std, expected = (r.variables["motion"][1][0, :, 4] for r in (time, frequency))
    assert std == approx(expected, rel=1e-2, abs=3e-3 * expected.max())
    assert time.attrs["energy_residual"] < 1e-3
    assert time.attrs["work_joint_damping"] > 0


@pytest.mark.parametrize("size", [3, 6])
def test_reference_and_fast_path_agree(size):
    whole, known = awkward.soft_mooring()
    (item,) = whole.floats
    stiffness = np.diag(item.per_axis("stiffness")) + np.array([[0, 0, -2e4], [0, 5e3, 0], [-2e4, 0, 6e5]])
    damping = np.array([[2e3, 0, 3e3], [0, 1e3, 0], [3e3, 0, 2e4]])
    at, pull = [DOFS.index(axis) for axis in item.motion] if size == 6 else range(3), np.zeros(size)
    held = np.zeros((2, size, size))
    held[:, *np.ix_(at, at)], pull[at] = (stiffness, damping), (500.0, -2e3, 1e3)
    item = replace(item, stiffness=0.0, damping=0.0, mooring=lines(*held, pull), offset=(0.3, -0.2, 0.15))
    settings = replace(whole.settings, duration=6.0, discard=0.0, ramp=3.0, keep_series=True, time_step=0.1)
    scene = replace(whole, floats=(item,), settings=settings)
    fast = simulate(scene, known)
    slow = simulate(replace(scene, settings=replace(settings, formulation="augmented")), known)
    for name in ("motion", "hinge_force"):
        values = fast.series[name][1]
        assert slow.series[name][1] == approx(values, abs=1e-4 * np.abs(values).max()), name
    for name in ("work_joint_damping", "stored_energy_change"):
        assert slow.attrs[name] == approx(fast.attrs[name], rel=1e-3), name


def test_lines_that_let_it_fall_away_are_refused():
    coupled = np.array([[1e3, -3e3, 0], [-3e3, 1e3, 0], [0, 0, 1e3]])
    with pytest.raises(SimulationFailed, match=r"unstable: ball surge, ball sway falls away"):
        require_stable(prepare(dry(floating(mooring=lines(coupled))), None))


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: lines(()), r"mooring.stiffness .* must have rows: one for each axis, or six"),
        (lambda: lines(np.ones((2, 3))), r"mooring.stiffness .* must be square, with 2 rows"),
        (lambda: lines([[1.0, 2.0], [3.0, 4.0]]), r"must be symmetric; row 1, column 2 has 2, the reverse 3"),
        (lambda: lines(np.eye(3), np.eye(2)), r"mooring.damping .* must be square, with 3 rows"),
        (lambda: lines(np.eye(2), [[1.0, 2.0], [2.0, 1.0]]), r"mooring.damping .* must be passive"),
        (lambda: lines(np.eye(2), [[0.0, 1e-3], [1e-3, 1.0]]), r"mooring.damping .* must be passive"),
        (lambda: lines(np.eye(2), pretension=(1.0,)), r"mooring.pretension .* must have 2 numbers"),
        (lambda: lines([[inf]]), r"mooring.stiffness .* must be finite"),
        (lambda: floating(mooring=lines(np.eye(2))), r"ball.mooring.stiffness .* must be 3 x 3, for surge, sway"),
        (lambda: floating(motion=(), mooring=lines(np.eye(6))), r"must be left out: a fixed body has no axis"),
    ],
)  # fmt: skip
def test_what_is_no_mooring_is_refused(build, message):
    with pytest.raises(InputError, match=message):
        build()
