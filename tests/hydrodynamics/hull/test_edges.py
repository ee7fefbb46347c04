"""Edges that jut out, and the panels cut along them."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem import problem as bem_problem
from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.edges import CUT, SHARP, jutting, narrowed
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.surface import area_vectors, divided, split, triangles
from tests.awkward import prism
from tests.hydrodynamics.shapes import box, graded_box, loose, meshed

SIZE = (4.0, 2.0, 1.0)
COUNTS = (4, 3), (6, 3), (13, 5), (3, 8), (8, 4), (7, 4)


def quads():
    """Of a box, six."""
    return PanelHull.of(*box(SIZE))


def flat():
    """As many panels of three corners, two a face."""
    vertices, faces = box(SIZE)
    corners = triangles(vertices[faces])
    return PanelHull.of(*loose(corners[:, [0, 1, 2, 2]]))


def box_panels(slant):
    """Of the box, leaning over by a slant."""
    vertices, faces = box(SIZE)
    return (vertices + slant * vertices[:, [2, 0, 1]])[faces]


def hanging(slant=0.0):
    """Each face divided otherwise, so that corners hang on their neighbours' sides."""
    even = [(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1)) for n, m in COUNTS]
    return np.concatenate([divided(f[None], *cuts) for f, cuts in zip(box_panels(slant), even, strict=True)])


def widths(panels):
    """Of panels (n, 4, 3): area over the longest side."""
    area = np.linalg.norm(np.cross(panels[:, 2] - panels[:, 0], panels[:, 3] - panels[:, 1]), axis=1) / 2
    return area / np.linalg.norm(panels - np.roll(panels, -1, axis=1), axis=2).max(axis=1)


@pytest.mark.parametrize("made", [quads, flat])
def test_panels_are_cut_along_the_edges_and_cover_what_they_did(made):
    hull = made()
    lines, turn = hull.edges
    right = turn > 1
    assert np.allclose(turn[right], np.pi / 2) and np.allclose(turn[~right], 0)
    assert np.linalg.norm(lines[right, 1] - lines[right, 0], axis=1).sum() == approx(2 * (4 + 2) + 4 * 0.5)
    even = split(hull.wetted, 0.5)
    cut = narrowed(even, *hull.edges)
    for panels in (even, cut):
        vectors = area_vectors(triangles(panels))
        assert np.linalg.norm(vectors, axis=1).sum() == approx(4 * 2 + 2 * (4 + 2) * 0.5)
        assert vectors.sum(axis=0) == approx([0, 0, -4 * 2], abs=1e-12)
    assert np.ptp(cut.reshape(-1, 3), axis=0) == approx([4, 2, 0.5])
    sides = np.stack([cut, np.roll(cut, -1, axis=1)], axis=2)
    long = np.any(sides[:, :, 0] != sides[:, :, 1], axis=2)
    at_side = np.any(np.all((np.abs(sides[..., 1]) == 1) & (sides[..., 2] == -0.5), axis=2) & long, axis=1)
    assert at_side.sum() > 2 * 8 and widths(cut[at_side]).max() < 1.01 * CUT * 0.5


@pytest.mark.parametrize("slant", [0.0, 0.3])
@pytest.mark.parametrize("made", [lambda panels: panels, lambda panels: triangles(panels)[:, [0, 1, 2, 2]]])
def test_edges_are_found_where_panels_meet_along_parts_of_their_sides(slant, made):
    """All along those of the box, and nowhere else."""
    plain, hull = (PanelHull.of(*loose(p)) for p in (box_panels(slant), made(hanging(slant))))
    (exact, sharp), (lines, turn) = ((x[t > SHARP], t[t > SHARP]) for x, t in (plain.edges, hull.edges))
    assert len(exact) == 8 and hull.sharpest == approx(sharp.max())

    def apart(points, sides):
        start, along = sides[:, 0], sides[:, 1] - sides[:, 0]
        way = np.einsum("psi,si->ps", points[:, None] - start, along) / np.sum(along**2, axis=1)
        feet = start + way.clip(0, 1)[..., None] * along
        return np.linalg.norm(points[:, None] - feet, axis=2)

    points = exact[:, :1] + np.linspace(0.01, 0.99, 41)[:, None] * (exact[:, 1:] - exact[:, :1])
    assert apart(points.reshape(-1, 3), lines).min(axis=1).max() < 1e-9
    assert np.maximum(apart(lines[:, 0], exact), apart(lines[:, 1], exact)).min(axis=1).max() < 1e-9
    for line, angle in zip(lines, turn, strict=True):
        assert angle == approx(sharp[apart(line.mean(axis=0)[None], exact).argmin()])


@pytest.mark.slow
def test_the_error_of_a_mesh_whose_corners_hang_is_what_it_is_said_to_be(monkeypatch):
    """Beside one that is narrow at all edges. Even panels there have five times the error in roll."""
    water = {"centres": [[0, 0, 0]], "density": 1000.0, "gravity": 9.81, "depth": np.inf, "planar": False}
    graded, hull = graded_box(SIZE, 0.2), PanelHull.of(*loose(hanging()))
    h = bem.solve((hull,), omega=[2.0], heading=0.4, **water)
    monkeypatch.setattr(bem_problem, "AFFORDABLE", 1e9)
    exact = bem.solve((graded,), omega=[2.0], heading=0.4, panels=len(graded.wetted), **water)
    for at in ((2, 2), (3, 3), (4, 4)):
        true, told, size = (x.added_mass[0][at] for x in (h, h.error, exact))
        assert abs(true - size) < min(3 * abs(told), 0.012 * size)  # measured 1.6 of what is told, 1 % of all


@pytest.mark.parametrize("side", range(3))
def test_a_triangle_is_cut_along_whichever_side(side):
    corners = np.roll([[0.0, 0, 0], [2, 0, 0], [0, 1, 0]], side, axis=0)[[0, 1, 2, 2]]
    cut = narrowed(corners[None], np.array([[[2.0, 0, 0], [0, 1, 0]]]), np.array([np.pi / 2]))
    areas = (
        np.linalg.norm(area_vectors(triangles(cut[:1])).sum(axis=0)),
        np.linalg.norm(area_vectors(triangles(cut)).sum(0)),
    )
    assert len(cut) == 2 and areas == approx(((1 - CUT) ** 2, 1.0))
    far = 1 - cut[0] @ [0.5, 1.0, 0.0]
    assert far.min() == approx(CUT)


def test_an_edge_ends_where_it_does():
    """Of four panels in a row the two beside it."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    row = square + np.arange(4)[:, None, None] * [1.0, 0.0, 0.0]
    assert len(narrowed(row, np.array([[[0.0, 0, 0], [2, 0, 0]]]), np.array([np.pi / 2]))) == 4 + 2


def test_what_turns_little_or_inwards_is_no_edge_to_cut_at():
    bent = prism([(-2, -1.0), (0, -1.2), (2, -1.0), (2, 1.0), (-2, 1.0)], 3.0)
    lines, turn = jutting(bent.wetted)
    keel = np.all(lines[..., 2] == -1.2, axis=1)
    assert turn[keel] == approx(2 * np.arctan(0.1))
    cut = narrowed(bent.wetted, lines[keel], turn[keel])
    assert len(cut) == len(bent.wetted)


def test_a_mesh_that_is_fine_already_stays_as_its_author_made_it():
    """And so does one that edges would make finer than half its sides would."""
    fine = PanelHull.of(*loose(split(quads().panels, 0.15)))
    assert not meshes.halving(fine, 108).narrow and meshes.halving(quads(), 108).narrow
    assert len(meshes.panels(fine, 108)[1]) == len(fine.wetted)
    assert meshes.halved_count(quads(), 108) == len(meshes.panels(quads(), 108)[1]) < 4 * 108


@pytest.mark.slow
def test_two_even_meshes_go_before_one_that_is_narrow_at_edges(monkeypatch):
    """And two narrow ones before these, where they do not cost too much."""

    def made(affordable):
        monkeypatch.setattr(bem_problem, "AFFORDABLE", affordable)
        return bem_problem._meshing((quads(), quads()), np.array([[0.0, 0, 0], [9, 30, 0]]), (432, 432))

    even, narrow = ((2 * 4 * meshes.halved_count(quads(), 108, narrow=choice)) ** 2 for choice in (False, True))
    assert even < narrow
    assert [made(limit) for limit in (narrow, narrow - 1, even - 1)] == [((2, 1), True), ((2, 1), False), ((1,), True)]
    problem = bem.Problem.of((quads(),), np.zeros((1, 3)), depth=np.inf, omega=np.array([1.0]), planar=False)
    counts = []
    for limit in (1e9, (4 * meshes.halved_count(quads(), 108)) ** 2 / 4 - 1):
        monkeypatch.setattr(bem_problem, "AFFORDABLE", limit)
        counts.append(bem.part(replace(problem))[0][0].panels)
    assert counts[1] == 4 * meshes.halved_count(quads(), 108, narrow=False) < counts[0]


def test_more_panels_are_taken_only_where_two_narrow_meshes_of_them_are(monkeypatch):
    """Of four hulls where 1,728 panels each, half or a quarter of them may be too many; none falls below 432."""
    barge, places = quads(), np.array([[0.0, 0, 0], [9, 0, 0], [0, 6, 0], [10, 7, 0]])

    def chosen(panels, affordable, hull=barge):
        monkeypatch.setattr(bem_problem, "AFFORDABLE", affordable)
        how = {"depth": np.inf, "omega": np.array([1.0]), "planar": False, "panels": panels}
        problem = bem.Problem.of((hull,) * 4, places, **how)
        return problem.counts[0], problem.meshing

    def cost(count, narrow, hull=barge):
        return (4 * 4 * meshes.halved_count(hull, count // 4, narrow=narrow)) ** 2

    two, ball = (2, 1), meshed(Revolution.sphere(radius=1.0, draft=0.9), 6)
    assert chosen(1728, cost(1728, True)) == (1728, (two, True))
    assert chosen(1728, cost(1728, True) - 1) == (432, (two, True))
    assert chosen(1728, cost(432, True) - 1) == (432, (two, False))
    assert chosen(1728, cost(864, True, ball), ball) == (864, (two, True))
    assert chosen(1728, 1.0) == (1728, ((1,), True)) and chosen(500, 1.0)[0] == 500
    assert chosen(216, cost(216, True) - 1)[0] == 216
