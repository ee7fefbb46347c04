"""Panels that lie on each other are left out; what stays encloses what the mesh without them does."""

import itertools

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.coarse import coarse
from solver.hydrodynamics.hull.panel_hull import PanelHull
from tests.hydrodynamics.shapes import box, loose

VERTICES, FACES = box((4.0, 2.0, 1.6), (0.3, 0.2, 0.1))
QUADS = VERTICES[FACES]
TRIANGLES = surface.triangles(QUADS)[:, [0, 1, 2, 2]]
ORDERS = {
    "triangles": (TRIANGLES, [[*order, order[-1]] for order in itertools.permutations(range(3))]),
    "quadrilaterals": (QUADS, [list(np.roll(way, n)) for way in ([0, 1, 2, 3], [3, 2, 1, 0]) for n in range(4)]),
}


@pytest.mark.parametrize("kind", ORDERS)
@pytest.mark.parametrize("places", [(0,), (0, 1, 4), (2, 2, 3)])  # alone, side by side, and one twice
def test_a_panel_given_again_counts_once_from_any_corner_and_either_way_round(kind, places):
    """Before or after the one that it repeats."""
    panels, orders = ORDERS[kind]
    for order in orders:
        copies = panels[list(places)][:, order]
        for given in ([panels, copies], [copies, panels]):
            hull = PanelHull.of(*loose(np.concatenate(given)))
            assert hull.closed and len(hull.faces) == len(panels) and hull.volume == approx(4 * 2 * 0.7)
            assert any(f"left out: {len(places)} panels given twice" in note for note in hull.notes)


@pytest.mark.parametrize("kind", ORDERS)
def test_a_mesh_of_two_sided_panels_is_its_surface(kind):
    panels, orders = ORDERS[kind]
    assert PanelHull.of(*loose(np.concatenate([panels[:, orders[-1]], panels]))).volume == approx(4 * 2 * 0.7)


@pytest.mark.parametrize("kind", ORDERS)
def test_a_wall_that_two_bodies_share_is_inside_of_one(kind):
    """Whichever corner its panels begin at."""
    panels, orders = ORDERS[kind]
    beside = (panels * [-1, 1, 1] + [0.6 + 4.0, 0, 0])[:, orders[-1]]  # mirrored in its wall x = 2.3, wound outwards
    hull = PanelHull.of(*loose(np.concatenate([panels, beside])))
    per = len(panels) // 6
    assert hull.closed and len(hull.faces) == 10 * per and hull.volume == approx(2 * 4 * 2 * 0.7)
    assert hull.notes == (f"left out: {per} panels of walls between bodies, on either side",)
    assert surface.areas(hull.wetted).sum() == approx(8 * 2 + 2 * (8 + 2) * 0.7)


def sharp(half, stations=4):
    """Quadrilaterals of a V-shaped boat of 8 m, half as wide as `half` [m] 0.1 m before its stem."""
    x = np.interp(np.linspace(0, 3, stations), range(4), [-4.0, 0.0, 3.9, 4.0])
    wide = np.interp(x, [-4.0, 0.0, 3.9, 4.0], [1.5, 1.5, half, 0.0])
    across, up = np.array([0, 1, 1, -1, -1]), np.array([-1.0, 0, 0.9, 0.9, 0])
    points = np.stack(np.broadcast_arrays(x[:, None], wide[:, None] * across, up), axis=-1)
    ahead, beside = points[1:], np.roll(points, -1, axis=1)
    sides = np.stack([points[:-1], beside[:-1], beside[1:], ahead], axis=2).reshape(-1, 4, 3)
    transom = points[0][[[0, 4, 1, 1], [1, 4, 3, 2]]]
    return np.concatenate([sides, transom])


def enclosed(panels):
    """Below still water [m³], of panels as they are given."""
    return surface.volume(surface.below(panels))


def runs_both_ways(faces):
    """Whether each edge is one panel's, and another's in the other sense."""
    pairs = surface.edges(faces)[0].tolist()
    return len(pairs) == len({*map(tuple, pairs)}) and {(a, b) for a, b in pairs} == {(b, a) for a, b in pairs}


def mirrored(panels):
    """Panels with their port side cut as the starboard side is, which is not so of quadrilaterals cut all round."""
    most, least = panels[..., 1].max(axis=1), panels[..., 1].min(axis=1)
    one, across = (most <= 0) & (least < 0), (most > 0) & (least < 0)
    return np.concatenate([panels[one | across], (panels[one] * [1, -1, 1])[:, [0, 2, 1, 1]]])


CUTS = {
    "quadrilaterals": lambda p: p,
    "triangles": lambda p: surface.triangles(p)[:, [0, 1, 2, 2]],
    "mirrored": lambda p: mirrored(surface.triangles(p)[:, [0, 1, 2, 2]]),
}


@pytest.mark.parametrize("stations", [4, 31])
@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("half", [1e-3, 6e-5, 1e-5, 3e-6, 1e-6, 1e-8])
def test_a_stem_may_be_as_sharp_as_one_likes(half, cut, stations):
    """Near the plane of symmetry, where corners within 1e-5 of the size are moved onto it."""
    panels = CUTS[cut](sharp(half, stations))
    hull = PanelHull.of(*loose(panels))
    folded = any("folds flat" in note for note in hull.notes)
    assert folded == (half < 8e-5) and not any("turned" in note or "twice" in note for note in hull.notes)
    assert hull.closed and runs_both_ways(hull.faces)
    assert hull.volume == approx(enclosed(panels), abs=4 * half if folded else 1e-9)


@pytest.mark.parametrize("cut", ["quadrilaterals", "mirrored"])
@pytest.mark.parametrize("half", [1e-4, 1e-5, 3e-6, 1e-8])
def test_a_stem_beside_the_planes_folds_where_its_corners_coincide(half, cut):
    """Within 1e-6 of the size, 8e-6 m."""
    panels = CUTS[cut](sharp(half)) + np.array([0.3, 0.7, 0])
    hull = PanelHull.of(*loose(panels))
    folded = any("folds flat" in note for note in hull.notes)
    assert folded == (half < 4e-6) and hull.closed and runs_both_ways(hull.faces)
    assert hull.volume == approx(enclosed(panels), abs=4 * half if folded else 1e-9)


@pytest.mark.parametrize("beside", [0.0, 0.7])
def test_a_panel_across_a_stem_folds_along_its_diagonal(beside):
    """Of the tip of a blade, one with two corners on the stem and one on each side."""
    half, tip = 1e-6, np.array([[4.0, 0, -1], [4.5, 0, -0.4], [4.0, 0, 0.2]])
    low, ahead, high = tip + np.array([0, beside, 0])
    port, starboard = (np.array([4.2, beside + side, -0.4]) for side in (half, -half))
    blade = [[low, starboard, high, port], [low, ahead, starboard, starboard], [ahead, high, starboard, starboard]]
    blade += [[ahead, low, port, port], [high, ahead, port, port]]
    hull = PanelHull.of(*loose(np.concatenate([QUADS, blade])))
    assert len(hull.faces) == len(QUADS) and hull.volume == approx(4 * 2 * 0.7)


def test_of_copies_with_noise_one_stays():
    noise = 1e-7 * np.random.default_rng(1).uniform(-1, 1, TRIANGLES[3, :3].shape)
    copy = (TRIANGLES[3, :3] + noise)[[1, 2, 0, 0]]
    hull = PanelHull.of(*loose(np.concatenate([TRIANGLES, [copy]])))
    assert hull.notes == ("left out: 1 panels given twice",) and hull.volume == approx(4 * 2 * 0.7, rel=1e-6)


@pytest.mark.parametrize("cut", [[(0, 1, 2, 3), (3, 2, 1, 0)], [(0, 1, 2), (0, 2, 3), (3, 1, 0), (3, 2, 1)]])
def test_a_plate_of_two_sides_without_a_thickness_is_refused(cut):
    """In a plane of symmetry, too, along a box's bottom: it would vanish."""
    panels = CUTS["triangles"](QUADS - np.array([0.3, 1.2, 0.0]))
    low = panels[..., 2].min()
    fin = np.array([[-2.0, 0, low], [2, 0, low], [2, 0, low - 1], [-2, 0, low - 1]])
    plate = [fin[[*order, order[-1]][:4]] for order in map(list, cut)]
    with pytest.raises(InputError, match="panels meet at an edge near"):
        PanelHull.of(*loose(np.concatenate([panels, plate])))


def test_a_plate_of_two_sides_without_a_thickness_is_told():
    corners = [[2.3, -0.8, -0.7], [-1.7, -0.8, -0.7], [-1.7, -0.8, -2], [2.3, -0.8, -2]]
    plate = np.array([corners, corners[::-1]])
    with pytest.raises(InputError, match="1 panels given twice, 1 of them wound the other way: 3 panels meet"):
        PanelHull.of(*loose(np.concatenate([QUADS, plate])))


def test_a_plate_of_two_sides_without_a_thickness_apart_from_a_hull_is_refused():
    """One side of it stays, open all round."""
    plate = np.array([[1.0, 1, -2], [-1, 1, -2], [-1, -1, -2], [1, -1, -2]])
    with pytest.raises(InputError, match=r"given twice.* open below still water near \(.*: plates need a thickness"):
        PanelHull.of(*loose(np.concatenate([QUADS, [plate, plate[::-1]]])))


def test_a_wall_a_hair_off_a_plane_stays():
    hull = PanelHull.of(*loose(CUTS["triangles"](QUADS - np.array([0.3, 1.2 + 1e-6, 0.0]))))
    assert hull.closed and hull.volume == approx(4 * 2 * 0.7, rel=1e-6) and not hull.notes


def test_a_thin_plate_stays():
    panels, faces = box((4.0, 1e-3, 1.0), (0.0, 0.0, -2.0))
    hull = PanelHull.of(*loose(np.concatenate([QUADS, panels[faces]])))
    assert hull.volume == approx(4 * 2 * 0.7 + 4e-3) and not hull.notes


def test_a_fine_boat_with_a_folded_stem_is_made_coarser():
    fine = surface.quartered(surface.quartered(CUTS["mirrored"](sharp(1e-5, 31))))
    hull = PanelHull.of(*loose(fine))
    assert any("folds flat" in note for note in hull.notes) and hull.symmetry[1]
    made = coarse(hull, 216)
    assert 216 <= len(made.wetted) < 1.3 * 216 and not len(made.holes)
    assert surface.volume(made.finer) == approx(enclosed(fine), rel=1e-3)
