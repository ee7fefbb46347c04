"""Floats that meet as they turn on their hinges: in closed form, between end stops, and in runs."""

from dataclasses import replace

import numpy as np
import pytest

from solver.errors import InputError
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.hydrodynamics.hull.swing import Jointed, meeting
from solver.remarks import met
from solver.run import simulate
from solver.scene import EndStops, Float, Scene, Settings, Water
from tests import awkward

SPAR = Revolution.vertical_cylinder(radius=1.0, draft=2.0, freeboard=1.0)
UP, APART = (0.0, 0.0, 1.0), 3.5


def swings(length=3.0):
    """Two cylinders on arms along x, which turn about upright axes APART in y."""
    return [Jointed(SPAR, (0.0, y, 0.0), (length, 0.0, 0.0), UP) for y in (0.0, APART)]


def touches(length=3.0):
    """Angle at which one touches the other at rest: (L cos θ - L)² + (L sin θ - d)² = (2 r)²."""
    side = (2 * length**2 + APART**2 - 4.0) / 2
    return np.arctan2(APART, length) - np.arccos(side / np.hypot(length**2, length * APART))


@pytest.mark.parametrize("length", [2.5, 3.0, 6.0])
def test_cylinders_meet_at_the_angle_of_the_closed_form(length):
    a, b = swings(length)
    least = touches(length)
    assert meeting(a, b, ((-1.0, 0.96 * least), (0.0, 0.0))) is None
    turned, other = meeting(a, b, ((-1.0, 1.04 * least), (0.0, 0.0)))
    assert least < turned <= 1.04 * least
    assert other == 0.0
    assert meeting(b, a, ((-1.04 * least, 1.0), (0.0, 0.0))) == (-turned, 0.0)


def test_both_turn_half_as_far_as_one():
    a, b = swings(30.0)
    least = touches(30.0) / 2
    assert meeting(a, b, ((0.0, 0.95 * least), (-0.95 * least, 0.0))) is None
    assert meeting(a, b, ((0.0, 1.1 * least), (-1.1 * least, 0.0))) == pytest.approx((1.1 * least, -1.1 * least))


def in_line(distance, **changes):
    """Two ducks, one behind the other, with their sterns so far apart: a beak reaches 2.5 m, and 2.3 m at rest."""
    hull = duck(radius=1.0, beak=2.5, elevation=0.4, submergence=0.5, width=3.0)
    one = Float(
        name="fore", hull=hull, mass=1000 * hull.volume, inertia=(1e4,) * 3, cog=(hull.buoyancy_point[0], 0.0, -0.2),
        hinge=(0.0, 0.0, -0.5), arm=(0.0, 0.0, 0.5), **changes,
    )  # fmt: skip
    return [one, replace(one, name="aft", hinge=(distance, 0.0, -0.5))]


def test_stops_that_let_floats_meet_are_refused_by_name_and_angle():
    stops = EndStops(lower=-1.2, upper=1.2, stiffness=1e6, damping=0.0)
    Scene(water=Water(depth=30.0, density=1000.0), floats=tuple(in_line(6.0, end_stops=stops)))
    near = in_line(3.3)
    Scene(water=Water(depth=30.0, density=1000.0), floats=tuple(near))
    aft = replace(near[1], end_stops=stops)
    with pytest.raises(InputError, match=r"floats.aft.end_stops.*-1.2 to 1.2 rad.*floats.fore.*meet at \+0 rad and -"):
        Scene(water=Water(depth=30.0, density=1000.0), floats=(near[0], aft))
    alone = Settings(interaction=False)
    Scene(water=Water(depth=30.0, density=1000.0), floats=(near[0], aft), settings=alone)


def test_a_float_turns_against_what_carries_it_and_not_with_it():
    fore, aft = in_line(6.0)
    stops = EndStops(lower=-0.6, upper=0.6, stiffness=1e6, damping=0.0)
    carried = replace(aft, on="fore", end_stops=stops)
    scene = Scene(water=Water(depth=30.0, density=1000.0), floats=(replace(fore, end_stops=stops), carried))
    assert not list(scene.meetings({"fore": (-3.0, 3.0)}))
    assert not list(scene.meetings({"aft": (-0.1, 0.1)}))


@pytest.mark.parametrize("method", ["time", "frequency"])
def test_a_run_says_which_floats_met(method):
    waves = awkward.sea(Hs=1.0, Tp=4.0)
    settings = {"radiation": False, "diffraction": False, "froude_krylov": "linear", "method": method}
    scene = awkward.scene(in_line(3.3, pto_damping=2e4), depth=300.0, waves=waves, **settings)
    h = awkward.known(scene, 0.6, 3.6, 5)  # for the waves' pressure alone
    told = simulate(scene, h)
    assert "floats.fore and floats.aft meet at" in told.attrs["warnings"]
    calm = replace(scene, sea=awkward.sea(Hs=0.01, Tp=4.0))
    assert "meet" not in simulate(calm, h).attrs.get("warnings", "")


def test_hulls_that_meet_at_rest_are_not_told_again():
    scene = awkward.scene(in_line(3.0))
    assert not list(met(scene, ("hinge",), {"rotation": np.zeros((2, 5))}))


def test_linear_angles_of_many_turns_are_looked_at_once():
    angles = np.tile([900.0, -900.0, 0.0, 0.0, 0.0], (2, 1))
    assert len(list(met(awkward.scene(in_line(3.3)), ("hinge",), {"rotation": angles}))) == 1


def test_floats_far_apart_are_told_by_their_boxes(monkeypatch):
    """And others are not: the box of a cylinder goes as far as the cylinder, but for the corners."""
    monkeypatch.setattr("scipy.spatial.cKDTree", None)
    a, b = swings(5.0)
    far = b._replace(hinge=(0.0, 40.0, 0.0))
    assert meeting(a, far, ((-1.0, 1.0), (-1.0, 1.0))) is None
    with pytest.raises(TypeError):
        meeting(a, b, ((-1.0, 1.0), (-1.0, 1.0)))


def sliding(gap, **changes):
    """Two upright cylinders, guided along x, of which the second one has a way of `gap` [m] to the first."""
    one = Float(
        name="fore", hull=SPAR, mass=1025 * SPAR.volume, inertia=(1e4,) * 3, hinge=(0.0, 0.0, 0.0), motion=("surge",),
        stiffness=1e4, **changes,
    )  # fmt: skip
    return [one, replace(one, name="aft", hinge=(2.0 + gap, 0.0, 0.0))]


@pytest.mark.parametrize("scale", [1.0, 0.05])
def test_cylinders_that_slide_meet_once_they_went_as_far_as_they_are_apart(scale):
    hull = Revolution.vertical_cylinder(radius=scale, draft=2.0 * scale, freeboard=scale)
    along = (1.0, 0.0, 0.0)
    a, b = (Jointed(hull, (x * scale, 0.0, 0.0), (0.0, 0.0, 0.0), along, slides=True) for x in (0.0, 2.3))
    still, back, near = (0.0, 0.0), (-0.29 * scale, 0.0), (0.0, 0.29 * scale)
    assert meeting(a, b, (near, still)) is None and meeting(a, b, (still, back)) is None
    assert meeting(a, b, (still, (0.0, 5.0 * scale))) is None
    for far in (5.0, 20.0, 60.0):  # whatever lies between the ends
        gap = b._replace(hinge=((2.3 + far / 3) * scale, 0.0, 0.0))
        assert meeting(a, gap, (still, (-far * scale, far * scale))) is not None
    assert meeting(a, b, ((0.0, 0.33 * scale), still)) == pytest.approx((0.33 * scale, 0.0))
    assert meeting(a, b, ((0.0, 0.2 * scale), (-0.2 * scale, 0.0))) == pytest.approx(
        (0.2 * scale, -0.2 * scale), rel=0.3
    )


def test_stops_of_what_slides_are_refused_by_name_and_place():
    stops = EndStops(lower=-0.5, upper=0.5, stiffness=1e6)
    fore, aft = sliding(0.3)
    water = Water(depth=30.0)
    with pytest.raises(InputError, match=r"floats.aft.end_stops = -0.5 to 0.5 m: must keep .* meet at \+0 m and -0.3"):
        Scene(water=water, floats=(fore, replace(aft, end_stops=stops)))
    Scene(water=water, floats=(fore, replace(aft, hinge=(2.6, 0.0, 0.0), end_stops=stops)))


def test_a_ring_that_runs_onto_its_spars_plate_is_told():
    """Whatever its carrier, of several axes, does: 0.1 m above the plate at rest, by its own axis alone."""
    spar = Float(
        name="spar", hull=Revolution.profile([(5.0, -4.0), (5.0, -3.1), (1.0, -3.1), (1.0, 4.0)]), mass=1e5,
        inertia=(1e6,) * 3, hinge=(0.0, 0.0, 0.0), motion=("surge", "heave", "pitch"),
    )  # fmt: skip
    collar = Float(
        name="ring", on="spar", hull=ring(((6.0, -3.0), (6.0, 2.0), (2.0, 2.0), (2.0, -3.0))), mass=1e5,
        inertia=(1e6,) * 3, hinge=(0.0, 0.0, 0.0), motion=("heave",),
    )  # fmt: skip
    scene, axes = awkward.scene([spar, collar]), ("surge", "heave", "pitch")
    motion = np.full((2, 3, 5), np.nan)
    motion[0] = [9.0, -9.0, 0.0, 3.0, 3.0]
    for least, told in ((-0.05, []), (-0.3, ["floats.spar and floats.ring meet at -0."])):
        motion[1, 1, :2] = 0.4, least
        assert [note[:39] for note in met(scene, axes, {"motion": motion})] == told
