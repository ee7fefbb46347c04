"""Dense meshes in fewer panels: as large, as sharp, as symmetric, and solved within what they tell of their error."""

import importlib
from functools import cache, partial

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.bem import bem, problem
from solver.hydrodynamics.hull import mending, surface
from solver.hydrodynamics.hull.coarse import coarse, fewer
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.reference.panels import revolution_mesh
from tests.hydrodynamics.shapes import box, fine_box, loose

SIZE = (4.0, 2.0, 1.0)
SPHERE = Revolution.sphere(radius=1.0, draft=1.0)
CYLINDER = Revolution.vertical_cylinder(radius=1.0, draft=0.5, freeboard=0.5)
DUCK = duck(radius=1.0, beak=2.0, elevation=0.6, submergence=0.4, width=3.0)
solve = partial(bem.solve, centres=[[0, 0, 0]], density=1000.0, gravity=9.81, depth=np.inf, heading=0.3)
solve = partial(solve, omega=np.sqrt(9.81 * np.array([0.3, 1.0, 2.0])), planar=False)


def posed(hulls):
    """A problem in which each is where it is."""
    return problem.Problem.of(hulls, np.zeros((len(hulls), 3)), depth=np.inf, omega=np.ones(1), panels=108)


def triangulated(panels):
    return surface.triangles(panels)[:, [0, 1, 2, 2]]


def dense(hull, side):
    """The same surface in triangles without a side longer than that."""
    panels = triangulated(hull.panels)
    while np.linalg.norm(panels - np.roll(panels, -1, axis=1), axis=2).max() > side:
        panels = surface.quartered(panels)
    return PanelHull.of(*loose(panels))


def revolved(hull, along):
    """8 along² triangles, turned so that no plane of symmetry is x = 0 or y = 0."""
    vertices, faces = revolution_mesh(hull, along=along, around=2 * along)
    c, s = np.cos(0.1), np.sin(0.1)
    vertices = vertices @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return PanelHull.of(*loose(triangulated(vertices[faces])))


def drawn(sides):
    """The cylinder as programs for drawing give it: sides of two long triangles, fans at the ends."""
    angle = 2 * np.pi * np.arange(sides) / sides + 0.1
    r = np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    rim = np.column_stack([r * np.cos(angle), r * np.sin(angle)])
    low, high = (np.insert(rim, 2, z, axis=1) for z in (-0.5, 0.5))
    on, up = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    foot, top = low * [0, 0, 1], high * [0, 0, 1]
    panels = [[low, on, up, up], [low, up, high, high], [foot, on, low, low], [top, high, up, up]]
    return PanelHull.of(*loose(np.concatenate([np.stack(corners, axis=1) for corners in panels])))


@cache
def ball():
    return revolved(SPHERE, 28)


@cache
def barge():
    return dense(PanelHull.of(*box(SIZE)), 0.13)


CASES = {
    "sphere": lambda: (ball(), SPHERE, 1728),
    "cylinder": lambda: (revolved(CYLINDER, 28), CYLINDER, 1728),
    "drawn": lambda: (drawn(1000), CYLINDER, 1728),
    "box": lambda: (barge(), PanelHull.of(*box(SIZE)), 4000),
    "duck": lambda: (dense(DUCK, 0.3), DUCK, 3000),
}


def quality(panels):
    """4√3 area over the sum of the squared sides, of each triangle."""
    corners = surface.triangles(panels)
    sides = np.sum((corners - np.roll(corners, 1, axis=1)) ** 2, axis=(1, 2))
    return 4 * np.sqrt(3) * np.linalg.norm(surface.area_vectors(corners), axis=1) / sides


def rim(panels):
    """Edges (n, 2, 3) of one panel alone."""
    vertices, faces, _ = mending.welded(panels.reshape(-1, 3), loose(panels)[1])
    pairs, _ = surface.edges(faces)
    return vertices[pairs[surface._alone(pairs)]]


DENSE = {"ball": ball, "barge": barge, "drawn": lambda: drawn(400), "duck": lambda: dense(DUCK, 0.5)}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "drawn")) for n in DENSE])
def test_as_many_panels_as_asked_for_well_shaped_and_watertight(name):
    hull = DENSE[name]()
    made = coarse(hull, 216)
    assert 216 <= len(made.wetted) < 1.2 * 216 and len(made.finer) == 4 * len(made.wetted)
    for panels in (made.wetted, made.finer):
        assert quality(panels).min() > 0.5 and quality(panels).mean() > 0.85
        # The misfit at fourth order in the panels' sides: measured 2e-4 of the coarser ones, on the duck.
        assert surface.volume(panels) == approx(hull.volume, rel=5e-4)
        assert np.all(rim(panels)[..., 2] == 0.0)  # open in still water alone
    assert made.symmetry == hull.symmetry


def test_edges_corners_and_waterline_stay():
    made = coarse(barge(), 216)
    for panels in (made.wetted, made.finer):
        assert surface.alike(panels, PanelHull.of(*box(SIZE)).wetted, 1e-9)
        outline = rim(panels)[..., :2]
        assert np.linalg.norm(outline[:, 1] - outline[:, 0], axis=1).sum() == approx(2 * (4 + 2))
    assert made.sharpest == approx(np.pi / 2)


def as_a_file(hull, angle=0.0, noise=0.0, up=0.0, unit=1.0):
    """Turned, raised [m], in that unit [m] and single precision, off by `noise` [m]; and turned back."""
    R = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    written = ((hull.vertices + np.array([0, 0, up])) @ R.T / unit).astype("f4") * unit
    vertices = written.astype(float) @ R + noise * np.random.default_rng(1).normal(size=hull.vertices.shape)
    return PanelHull.of(vertices, hull.faces)


@cache
def ellipsoid():
    """Its axes along x and y, as planes of symmetry that corners lie on."""
    vertices, faces = revolution_mesh(SPHERE, along=16, around=40)
    return PanelHull.of(*loose(triangulated((vertices * [1.6, 0.8, 1.0])[faces])))


@cache
def lopsided():
    """A hull without planes of symmetry."""
    x, y, z = ellipsoid().vertices.T
    return PanelHull.of(np.column_stack([x + 0.1 * x**2 + 0.05 * x * y, y + 0.1 * y**2, z]), ellipsoid().faces)


@cache
def refined(shape):
    """A hull finer at one end, where corners lie on the sides of the panels beside it."""
    panels = shape().panels
    fine = panels[..., 0].mean(axis=1) > 0.7
    return PanelHull.of(*loose(np.concatenate([panels[~fine], surface.quartered(panels[fine])])), name="refined")


def test_panels_that_meet_along_parts_of_their_sides_are_made_as_few():
    """A box in quadrilaterals, and in triangles: an edge of the hull is not where its panels' size changes."""
    for shape in (flat, lambda: fine_box(SIZE, (0, 0, 0), 0.3)):
        hull, made = refined(shape), coarse(refined(shape), 100)
        assert hull.closed and made.symmetry == hull.symmetry
        assert 100 <= len(made.wetted) < 130 and quality(made.finer).min() > 0.5
        assert surface.alike(made.finer, PanelHull.of(*box(SIZE)).wetted, 1e-9)


def test_a_sliver_hangs_on_nothing():
    """A triangle whose own corner lies on its side, as rounding leaves them at a rim, and one beside it."""
    points = np.array([[0, 0, 0], [2, 0, 0], [1, 1e-9, 0], [1, 1, 0], [0.5, -1, 0], [1.5, -1, 0]], float)
    sliver, above, below = [0, 1, 2, 2], [[0, 2, 3, 3], [2, 1, 3, 3]], [0, 4, 1, 1]
    more, _, _ = mending.hanging(points, np.array([sliver, above[0]]))
    assert not more.any()
    more, pairs, owner = mending.hanging(points, np.array([below, *above]))
    assert more.tolist() == [True, False, False]
    assert sorted(pairs[owner == 0].tolist()) == [[0, 4], [1, 2], [2, 0], [4, 1]]


@cache
def flat():
    return dense(PanelHull.of(*box(SIZE)), 0.4)


ROUNDED = {
    "angles": (ellipsoid, [{"angle": angle} for angle in (0.3, np.pi / 6, 0.7, 1.2, 2.5)]),
    "noise": (ellipsoid, [{"noise": 10.0**n} for n in range(-9, -2)]),
    "turned, in mm": (ellipsoid, [{"angle": angle, "unit": 1e-3} for angle in (0.3, np.pi / 6)]),
    "raised": (ellipsoid, [{"angle": 0.7, "up": 0.05}, {"angle": 0.7, "up": -0.08}, {"noise": 1e-7, "up": 0.05}]),
    "lopsided": (lopsided, [{"angle": 0.7}, {"noise": 1e-7}, {"noise": 1e-5}, {"noise": 1e-5, "up": 0.05}]),
    "flat faces": (flat, [{"angle": 0.3}, {"angle": 0.7, "up": 0.1}, {"noise": 1e-8}]),
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in ("noise", "lopsided"))) for n in ROUNDED]
)
def test_corners_that_rounding_moved_off_a_cut_leave_no_slivers(name):
    shape, each = ROUNDED[name]
    for how in each:
        hull = as_a_file(shape(), **how)
        made = coarse(hull, 120)
        assert made.symmetry == hull.symmetry and len(made.wetted) < 180
        assert all(hull.symmetry) == (shape is not lopsided and how.get("noise", 0.0) < 1e-6)
        for panels in (made.wetted, made.finer):
            assert quality(panels).min() > 0.3
            assert surface.volume(panels) == approx(hull.volume, rel=2e-3)
            assert np.all(rim(panels)[..., 2] == 0.0)


def test_what_folds_is_not_the_files_fault(monkeypatch):
    """One half that does is made whole; and there is always the hull as it is."""
    module = importlib.import_module("solver.hydrodynamics.hull.coarse")
    made = module._coarse

    def folds(hull, count, planes):
        if len(planes) >= fewest:
            raise InputError("hull.file", hull.name, "4 panels meet at an edge")
        return made(hull, count, planes)

    monkeypatch.setattr(module, "_coarse", folds)
    fewest, hull = 1, as_a_file(ellipsoid(), angle=0.31)
    whole = coarse(hull, 120)
    assert hull.symmetry == (True, True) and whole.symmetry == (False, False) and len(whole.wetted) < 180
    fewest, hull = 0, as_a_file(ellipsoid(), angle=0.32)
    assert fewer(hull, 60, 1) is hull
    said = posed((hull,)).coarser
    assert said.startswith("hull mesh: ") and said.endswith("mesh's 600, as fewer do not keep its edges and corners")


@pytest.mark.parametrize("most", [pytest.param(1e9, marks=pytest.mark.slow), 0.0])
def test_dense_hulls_that_close_each_other_say_how_many_panels_they_have(most, monkeypatch):
    monkeypatch.setattr(problem, "AFFORDABLE", most)
    panels = fine_box((4.0, 1.3, 1.0), (0, 0, 0), 0.17).panels
    halves = [PanelHull.of(*loose(surface.below(panels, 0, sign=s)), name="half") for s in (1, -1)]
    asked, given = posed(halves), len(halves[0].wetted)
    each = bem.part(asked)[0][0].panels // 2
    assert asked.coarser == f"hull half: {each} panels for its dense mesh's {given}, as other hulls close it"


@pytest.mark.parametrize("side, edge", [(1.0, np.pi / 2), (-1.0, 0.0)])
def test_the_sharpest_edge_is_one_that_juts_out(side, edge):
    """Two walls that meet at a right angle, seen from without and from within."""
    walls = np.array([[[0, 0, 0], [0, 0, -1], [1, 0, -1], [1, 0, 0]], [[0, 0, 0], [0, 1, 0], [0, 1, -1], [0, 0, -1]]])
    hull = PanelHull(vertices=(walls * [1.0, side, 1.0]).reshape(-1, 3), faces=np.arange(8).reshape(2, 4))
    assert hull.sharpest == approx(edge)


def test_what_is_not_dense_or_cannot_be_coarser_stays_as_it_is():
    few = dense(PanelHull.of(*box(SIZE)), 0.6)
    assert fewer(few, 432, 2) is few
    panels = barge().panels
    lost = np.all(panels[..., 2] == -0.5, axis=1) & (panels[..., 0].min(axis=1) >= 0)
    opened = PanelHull.of(*loose(panels[~lost]))
    assert len(opened.holes) and fewer(opened, 432, 2) is opened
    assert len(fewer(barge(), 432, 2).finer) < len(barge().wetted)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_error_is_what_it_is_said_to_be(name, monkeypatch):
    hull, given, panels = CASES[name]()
    ours = solve((hull,))
    assert 864 <= ours.settings["panels"] < 1100
    assert "panels for" in ours.settings["coarser"]
    monkeypatch.setattr(problem, "AFFORDABLE", 1e9)
    exact = solve((given,), panels=panels)
    for kind, told in ours.error._asdict().items():
        largest = np.abs(getattr(exact, kind)).max()
        error = np.abs(getattr(ours, kind) - getattr(exact, kind)).max()
        assert 1 / 3 < error / np.abs(told).max() < 3
        assert error < 0.02 * largest
