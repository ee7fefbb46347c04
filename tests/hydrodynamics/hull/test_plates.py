"""Plates of hulls: where they are, that their faces have panels alike, and the added mass of thin discs."""

from math import inf

import numpy as np
import pytest

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull import mesh
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.plates import Stretch, pieces, stretches
from solver.hydrodynamics.hull.revolution import Revolution
from tests.awkward import prism

RADIUS, DEEP = 15.0, 35.0
BULKY = Revolution.profile([(5.0, -12.0), (5.0, -11.0), (1.5, -11.0), (1.5, 3.0)])
SLOT = Revolution.profile(
    [(5.0, -12.0), (5.0, -9.0), (1.0, -9.0), (1.0, -8.8), (5.0, -8.8), (5.0, -5.0), (1.0, -5.0), (1.0, 3.0)]
)
TAPERED = Revolution.profile([(2.0, -30.0), (2.0, -25.2), (10.0, -25.1), (10.0, -24.9), (3.0, -24.7), (3.0, 5.0)])
WALLED = Revolution.profile([(2.9, -1.0), (2.9, -8.0), (3.0, -8.0), (3.0, 5.0)])


def spar(thickness, *, radius=RADIUS, spar=3.0, deep=DEEP):
    """On a heave plate at its foot."""
    return Revolution.profile([(radius, -deep), (radius, thickness - deep), (spar, thickness - deep), (spar, 5.0)])


def turned(points, sides=24):
    """The mesh of a line from pole to pole about the axis, one panel from point to point."""
    wider = np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))  # polygons as large as their circles
    around = wider * np.exp(2j * np.pi * np.arange(sides) / sides)
    vertices = np.array([(r * a.real, r * a.imag, z) for r, z in points for a in around])
    rows = np.arange(len(vertices)).reshape(-1, sides)
    beside = np.roll(rows, -1, axis=1)
    faces = np.stack([rows[:-1], beside[:-1], beside[1:], rows[1:]], axis=-1).reshape(-1, 4)
    return PanelHull.of(vertices, faces)


@pytest.mark.parametrize("hull", [Revolution.sphere(radius=2.0, draft=1.0), BULKY, SLOT, spar(2.0)])
def test_a_hull_without_plates_is_meshed_as_it_is(hull):
    assert [piece.segment for piece in pieces(hull)] == list(hull.wetted())
    assert not mesh.plates(hull, 432)


@pytest.mark.parametrize(
    ("hull", "twins", "ends"),
    [
        (spar(0.1), [(1, 3)], [(3.0, -DEEP)]),  # a face under the spar has no other behind it
        (TAPERED, [(3, 5)], [(3.0, -25.19)]),
        (WALLED, [(1, 3)], [(3.0, -1.0)]),  # an open pipe under a lid
    ],
)
def test_the_faces_of_a_plate_are_cut_opposite_each_other(hull, twins, ends):
    found = pieces(hull)
    assert [(n, p.twin) for n, p in enumerate(found) if p.twin > n] == twins
    assert all(found[twin].twin == n for n, twin in twins)
    corners = {s.start for s in hull.wetted()}
    assert [p.segment.start for p in found if p.segment.start not in corners] == [
        pytest.approx(e, abs=0.02) for e in ends
    ]
    assert sum(p.segment.area for p in found) == pytest.approx(hull.wetted_area)
    assert mesh.plates(hull, 432)


def test_panels_of_both_faces_are_each_others_images():
    vertices, faces = mesh.panels(spar(0.1), 48, refine=2, quarters=1)
    centres = vertices[faces].mean(axis=1)
    wide = np.hypot(*centres.T[:2]) > 3.0
    below, above = (centres[wide & (np.abs(centres[:, 2] + z) < 1e-6), :2] for z in (DEEP, DEEP - 0.1))
    assert len(below) == len(above) == 8 * 4 * 2  # eight round a quarter, four from edge to edge, halved
    assert np.abs(below[:, None] - above).sum(axis=-1).min(axis=1).max() < 1e-9


FEW = [(0.0, -3.0), (2.0, -2.0), (3.0, -1.0), (3.3, 0.0), (3.3, 2.0)]  # turns by 18 and 28 degrees
JAGGED = [*((3.0 + n % 2, -6.0 + n) for n in range(7)), (3.0, 3.0)]


@pytest.mark.parametrize(
    ("points", "size", "count"),
    [(FEW, 0.5, [2, 3, 2]), (FEW, 1.35, [1, 2, 2]), (FEW, 2.4, [1, 2, 2]), (JAGGED, 2.0, [1, 2, 2, 2, 2, 2, 2])],
)
def test_panels_end_where_pieces_do_that_are_few_or_turn_sharply(points, size, count):
    hull = Revolution.profile(points)
    lengths = [segment.length for segment in hull.wetted()]
    assert stretches(hull, size) == list(map(Stretch, lengths, count))


def test_many_short_pieces_in_a_row_are_divided_as_one():
    """A bilge of eight pieces between bottom and wall; but not the faces of a plate."""
    angle = np.linspace(0, np.pi / 2, 9)
    bilge = np.column_stack([3 + 2 * np.sin(angle), -4 - 2 * np.cos(angle)])
    bottom, rounding, wall = stretches(Revolution.profile([*bilge, (5.0, 3.0)]), 1.35)
    assert (bottom, wall) == (Stretch(3.0, 1), Stretch(4.0, 3))
    assert rounding == Stretch(pytest.approx(np.pi, rel=2e-3), 2)
    across = np.linspace(3.0, 15.0, 7)
    plate = Revolution.profile([*((r, -35.0) for r in across), *((r, -34.9) for r in across[::-1]), (3.0, 5.0)])
    assert [s.panels for s in stretches(plate, 4.0)] == [1, *6 * [4], 2, *6 * [4], 9]


def test_a_mesh_is_told_from_a_plate_by_its_panels():
    barge = prism([(-5, -1.2), (5, -1.2), (5, 1.0), (-5, 1.0)], 8.0)
    assert not mesh.plates(barge, 432)
    fan = [(1e-3, -5.0), (4.0, -5.0), (4.0, -4.5), (1.0, -4.5), (1.0, 2.0), (1e-3, 2.0)]
    assert mesh.plates(turned(fan), 108).unlike > 1 and not mesh.plates(turned(fan), 3000)
    both = [(1e-3, -5.0), (1.0, -5.0), (2.5, -5.0), (4.0, -5.0), (4.0, -4.7), (2.5, -4.7), (1.0, -4.7), (1.0, 2.0)]
    alike = mesh.plates(turned([*both, (1e-3, 2.0)], sides=12), 108)
    assert alike.unlike == 0.0 and 0.5 < alike.share < 1


def heave(hull, panels=432):
    """Added mass at infinite frequency, as found and what it may be off [kg]."""
    problem = bem.Problem.of(
        (hull,), np.zeros((1, 3)), depth=inf, density=1000.0, omega=np.array([0.3]), panels=panels, planar=True
    )
    known = bem.united(problem, [bem.part(problem)])[0]
    return known.added_mass_inf[1, 1], abs(known.error.added_mass_inf[1, 1])


REST = pytest.mark.slow  # of three that differ in a number


@pytest.mark.parametrize(
    ("ratio", "exact"),
    [pytest.param(20, 9.131e6, marks=REST), pytest.param(50, 8.874e6, marks=REST), (150, 8.715e6)],
)
def test_added_mass_of_a_spar_with_a_heave_plate(ratio, exact):
    """Against bands of sources about the axis, 400 of them and finer to all edges: to 0.1 %."""
    found, error = heave(spar(RADIUS / ratio))
    assert found == pytest.approx(exact, rel=0.01)
    assert abs(found - exact) < 3 * error and error < 0.02 * exact


def test_added_mass_of_a_disc():
    """8/3 ρR³ (Lamb, article 108) for a disc in water without end; one of 1/150, on a rod, has 1 to 2 % more."""
    assert heave(spar(2 / 150, radius=2.0, spar=0.2, deep=5.0), 216)[0] == pytest.approx(8 / 3 * 8e3, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [0.75, 0.3, 0.1])
@pytest.mark.parametrize("points", [[], [3.0, 6.0, 9.0, 12.0, 14.0], [2.0, 5.0, 8.0, 11.0, 13.0]])
def test_what_a_meshed_plate_may_be_off_is_said(points, thickness):
    """Panels as large as the plate, alike on both faces, and not: off by up to 30 %."""
    exact = {0.75: 9.131e6, 0.3: 8.874e6, 0.1: 8.715e6}[thickness]
    upper = [(r, thickness - DEEP) for r in (15.0, 14.0, 12.0, 9.0, 6.0)] if points else [(15.0, thickness - DEEP)]
    line = [(1e-3, -DEEP), *((r, -DEEP) for r in points), (15.0, -DEEP), *upper, (3.0, thickness - DEEP)]
    found, error = heave(turned([*line, *((3.0, z) for z in (-25.0, -15.0, -5.0, 5.0)), (1e-3, 5.0)]))
    assert abs(found - exact) < 3 * error
