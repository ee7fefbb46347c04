"""How far floats may turn: about vertical, level and other axes, alone and by several at once."""

import numpy as np
import pytest
from pytest import approx
from scipy.spatial.transform import Rotation

from solver import limits
from solver.coupled.preparation import prepare
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.hull.revolution import Revolution
from solver.multibody.bodies import new_motion
from solver.multibody.minimal import move
from solver.run import simulate
from solver.scene import Float, falls_at, poses, turning_bounds, uprights
from solver.sea.field import WaveField
from solver.sea.realization import CALM, Realization
from tests import awkward

DRUM = Revolution.vertical_cylinder(radius=0.7, draft=0.9, freeboard=0.6)
DRY = {"radiation": False, "diffraction": False, "froude_krylov": "none"}
BRIEF = {"duration": 6.0, "discard": 0.0, "ramp": 0.0}
WAVES = Realization(omega=np.array([1.1, 2.6]), amplitude=np.array([0.2, 0.1j]))
OBLIQUE = (0.48, 0.6, 0.64)  # 50° from the vertical
STEEP = (0.36, 0.48, 0.8)  # 37°


def drum(name="drum", **changes) -> Float:
    given = {"mass": 900.0, "inertia": (500.0, 700.0, 600.0), "hinge": (0, 0, 0), "motion": ("yaw",)}
    return Float(name=name, hull=DRUM, **given | changes)


def dry(*floats, waves=CALM, **settings):
    return awkward.scene(floats, depth=np.inf, waves=waves, **DRY | BRIEF | settings)


def in_air(item):
    return simulate(item, awkward.vacuum(item))


def pair(**changes) -> tuple[Float, Float]:
    """One on a spring, and what it carries on a faster one."""
    one = {"motion": ("pitch",), "stiffness": 9e4, "offset": 0.9}
    other = {"motion": ("pitch",), "stiffness": 1.2e5, "mass": 5.0, "inertia": (90.0,) * 3, "hinge": (0, 3.0, 0)}
    return drum("one", **one), drum("other", on="one", **other | changes)


@pytest.mark.parametrize("axis", [{}, {"motion": ("hinge",), "axis": (0, 0, -2.0), "cog": (0, 0.2, -0.3)}])
def test_a_turntable_swings_as_far_as_its_spring_takes_it(axis):
    """By 2.4 rad about a rest that a preload brings to 1.3 rad, water or none: I q̈ + Kq = F."""
    arm, cog = np.array([0.0, -2.0, 0.0]), np.array(axis.get("cog", (0, 0, 0)))
    inertia, K = 600.0 + 900.0 * np.linalg.norm((arm + cog)[:2]) ** 2, 5e3
    item = drum(arm=tuple(arm), stiffness=K, preload=1.3 * K, offset=2.4, **axis)
    record = in_air(dry(item, keep_series=True))
    t, q = record.series["time"][1], record.series["rotation" if "axis" in axis else "motion"][1].ravel()
    assert q == approx(1.3 + 2.4 * np.cos(np.sqrt(K / inertia) * t), abs=0.01)
    assert q.max() > 3.6


@pytest.mark.parametrize(
    ("axis", "most"), [((0, 1, 0), np.pi / 2), (OBLIQUE, 2.338), (STEEP, np.inf), ((0, 1e-12, 1), np.inf)]
)
def test_an_axis_alone_turns_a_float_over_where_its_own_vertical_lies_level(axis, most):
    item = drum(motion=("hinge",), axis=axis)
    assert falls_at(np.array(axis, float)) == approx(most, abs=1e-3)
    assert turning_bounds(item, "hinge") == approx((-most, most), abs=1e-3)
    for angle in np.linspace(-3, 3, 13):
        (up,) = uprights((item,), (-1,), np.array([angle]))
        assert (up > 0) == (abs(angle) < most)
        assert up == approx(Rotation.from_rotvec(angle * np.array(axis)).as_matrix()[2, 2], abs=1e-12)


def test_floats_are_upright_by_all_axes_of_theirs_and_of_their_carriers():
    """Where a yaw lies between them roll and pitch add up; slides do nothing."""
    carrier = drum("one", motion=("roll", "heave", "yaw", "pitch"))
    carried = drum("other", motion=("hinge",), axis=OBLIQUE, on="one")
    joints = np.array([0.9, 5.0, 1.5, -1.1, 0.4])
    R = Rotation.from_euler("XZY", joints[[0, 2, 3]])
    both = R * Rotation.from_rotvec(0.4 * np.array(OBLIQUE))
    told = uprights((carrier, carried), (-1, 0), joints)
    assert told == approx([R.as_matrix()[2, 2], both.as_matrix()[2, 2]], abs=1e-12)


def test_floats_are_where_the_march_has_them():
    """On slides and turns, on each other, at a hinge off the carrier's point."""
    carrier = drum("one", motion=("surge", "roll", "heave", "yaw"), hinge=(0.4, 0, 1.0), arm=(0.3, 0, -1.0))
    carried = drum(
        "other", motion=("hinge", "heave"), axis=OBLIQUE, on="one", hinge=(2, 1.0, 0.5), arm=(1.0, 0.2, -0.5)
    )
    item, joints = dry(carrier, carried), np.array([0.7, 0.5, -0.3, 0.8, -0.6, 0.2])
    body = prepare(item, awkward.vacuum(item)).bodies
    motion = new_motion(body)
    move(body, joints, np.zeros(6), motion)
    for b, (R, place) in enumerate(poses(item.floats, item.carriers, joints)):
        assert approx(motion.rotation[b], abs=1e-12) == R
        assert place == approx(motion.position[b], abs=1e-12)


def test_what_several_axes_turn_over_ends_its_run():
    """A right angle for neither pitch alone. Still water is not too high."""
    with pytest.raises(
        SimulationFailed, match=r"^other is turned over at one pitch ([+-])\d\.\d+, other pitch \1"
    ) as e:
        in_air(dry(*pair(offset=-0.85)))
    assert "at t = " in str(e.value) and "sea" not in str(e.value) and "rights itself" not in str(e.value)
    in_air(dry(*pair(offset=-0.5)))


def test_a_float_let_go_turned_over_from_its_rest_is_refused():
    """Offsets count from there."""
    item = drum(motion=("sway", "pitch"), stiffness=(1e4, 5e3), preload=(0.0, 4e3), offset=(0.2, 0.9))
    with pytest.raises(
        InputError, match=r"must be within -2\.37 to \+0\.771 rad of pitch, from its rest at \+0\.8"
    ) as e:
        in_air(dry(item))
    assert (e.value.key, e.value.value) == ("floats.drum.offset", "0.9 rad")
    with pytest.raises(InputError, match="must leave floats upright: other is turned over at one pitch"):
        in_air(dry(*pair(offset=0.8)))


def test_what_ends_a_run_is_told_of_the_axis_and_of_the_water():
    """Nothing turns over by yaw, and still water is not too high."""
    for waves, words in ((CALM, "let it go nearer to its rest"), (WAVES, "the sea is too high")):
        scene = dry(drum(motion=("yaw", "pitch")), waves=waves)
        bounds = np.array([[-np.pi, np.pi], [-np.pi / 2, np.pi / 2]])
        told = limits.explain(scene, np.array([2.0, 1.6]), bounds, "at t = 3.0 s")
        assert told.startswith("drum pitch at +1.60 at t = 3.0 s, beyond -1.57 to +1.57: the float is turned over;")
        assert words in told
        told = limits.explain(scene, np.array([3.2, 0.0]), bounds, "at t = 3.0 s")
        assert "too far round, beside axes that tilt floats, for linear pressure" in told and "sea" not in told


def test_a_hinge_swings_through_beneath_to_one_side_and_turns_over_to_the_other():
    item = drum(motion=("hinge",), hinge=(-1.5, 0, 1.0), arm=(1.5, 0, -1.0))
    bounds = np.array([turning_bounds(item, "hinge")])
    for angle, words in ((1.5, "beyond -1.57 to +1.47: the float swung through beneath"), (-1.6, "is turned over")):
        assert words in limits.explain(dry(item), np.array([angle]), bounds, "at t = 3.0 s")


@pytest.mark.parametrize(
    ("settings", "motion", "waves", "most"),
    [
        ({}, ("yaw",), WAVES, np.inf),
        ({}, ("surge", "yaw"), WAVES, np.inf),
        ({}, ("yaw", "pitch"), WAVES, np.pi),
        ({"froude_krylov": "body-nonlinear"}, ("yaw", "pitch"), CALM, np.inf),
        ({"froude_krylov": "body-nonlinear"}, ("yaw",), WAVES, "field"),
    ],
)
def test_a_vertical_axis_is_bounded_by_what_is_known_of_the_water(settings, motion, waves, most):
    """Half a turn of the rotation's vector, the circle on which pressure's waves are known, or nothing."""
    arm = 12.0
    scene = dry(drum(motion=motion, arm=(arm, 0, 0)), waves=waves, **settings)
    field = WaveField(waves, np.inf, 9.81)
    bounds = limits.excursions(scene, field, (40,), np.zeros(0, int))
    if most == "field":
        (way,) = limits.ways(scene, field, (40,))
        most = 2 * np.arcsin(way / 2 / arm)
        assert np.pi / 2 < most < 2.0
    assert bounds[motion.index("yaw")] == approx((-most, most))
