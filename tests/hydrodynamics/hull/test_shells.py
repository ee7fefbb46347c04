"""Several surfaces in one mesh: those within another count for nothing, those that cut are refused, others add up."""

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull import shells, surface
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from tests import awkward
from tests.hydrodynamics.shapes import box, fine_box, loose, meshed

WALL = "surfaces lie face to face near"
SIZE = (4.0, 2.0, 1.4)
AWAY = np.array([4.0, 0.0, 0.0])
HULL = box(SIZE, (0, 0, -0.1))  # 0.8 m of draft, 0.6 m of freeboard
VOLUME = 4 * 2 * 0.8
CAVITY = box((3.0, 1.0, 0.6), (0, 0, -0.1))


def mesh_of(hull):
    return hull.vertices, hull.faces


def together(*meshes):
    return PanelHull.of(*surface.merged(meshes), name="a.stl")


def backwards(mesh):
    return mesh[0], mesh[1][:, ::-1]


def below(mesh):
    """As files without decks have it."""
    return loose(surface.below(mesh[0][mesh[1]]))


def turned(mesh, scale=1.0):
    """About all axes, the origin staying below."""
    return surface.placed(mesh[0], (0, 0, 0), (0.1, -0.2, 0.7), scale), mesh[1]


@pytest.mark.parametrize("wound", [lambda mesh: mesh, backwards])
@pytest.mark.parametrize("cut", [lambda mesh: mesh, below])
def test_a_cavity_is_left_out_however_it_is_wound(wound, cut):
    """As is what lies in the cavity, and a tank without a lid in a hull without a deck."""
    parts = [
        wound(cut(CAVITY)),
        cut(HULL),
        cut(box((0.2, 0.2, 0.4), (0, 0, -0.1))),
        cut(box((3.9, 0.2, 0.01), (0, 0.8, 0))),
    ]
    hull = together(*parts)
    assert hull.volume == approx(VOLUME) and len(hull.faces) == len(cut(HULL)[1])
    left = sum(len(part[1]) for part in parts) - len(hull.faces)
    assert hull.notes == (f"left out: {left} panels of surfaces within another, where no water is",)
    assert hull.closed == (cut is not below) and not len(hull.holes)


def test_notes_are_those_of_what_is_left():
    """A hull inside out about a cavity of which a panel is."""
    mixed = CAVITY[0], np.concatenate([CAVITY[1][:1, ::-1], CAVITY[1][1:]])
    assert [note.partition(":")[0] for note in together(mixed, HULL).notes] == ["left out"]
    assert "inside out" in together(CAVITY, backwards(HULL)).notes[1]


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_cavity_that_touches_the_wall_is_one_at_any_scale_and_turn(scale):
    """Its side in the hull's wall, where panels are cut otherwise; a board between walls; the hull in other panels."""
    fine = fine_box((1.0, 0.5, 0.3), (1.5, 0, -0.1), 0.2)
    both = fine_box(SIZE, (0, 0, -0.1), 0.9)
    for inner in (mesh_of(fine), box((4, 2, 0.01), (0, 0, -0.1)), mesh_of(both)):
        mesh = turned(surface.merged([HULL, inner]), scale)
        assert PanelHull.of(*mesh).volume == approx(PanelHull.of(*turned(HULL, scale)).volume)


AWKWARD = {
    "a column that reaches down into the box": box((1, 1, 2.15), (0.3, 0.2, 0.525)),
    "wholly above water, into the deck": box((1, 1, 1), (0.3, 0.2, 1.0)),
    "bars that cross, no corner of one in the other": box((0.5, 6, 0.5), (0, 0, -0.2)),
    "as high and as wide": box(SIZE, (1, 0, -0.1)),
    "through the deck, where it has corners": mesh_of(fine_box((1, 1, 1.6), (0.3, 0.2, 0.6), 0.3)),
    "a plate that it passes through": box((14, 14, 0.05), (4, 0, -0.3)),
    "a needle": box((1e-3, 1e-3, 1), (0.317, 0.123, -0.9)),
}


@pytest.mark.parametrize("other", AWKWARD.values(), ids=AWKWARD)
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("turn", [lambda mesh: mesh, turned])
def test_surfaces_that_cut_each_other_are_refused(other, order, turn):
    with pytest.raises(InputError, match=r"surfaces that cut each other near \(.*\) m") as error:
        together(*map(turn, (HULL, other)[::order]))
    assert error.value.key == "hull.file" and error.value.value == "a.stl"


def test_the_place_where_surfaces_cut_is_on_both():
    with pytest.raises(InputError) as error:
        together(HULL, AWKWARD["a needle"])
    x, y, z = map(float, str(error.value).partition("(")[2].partition(")")[0].split(","))
    assert (x, y, z) == approx((0.317, 0.123, -0.8), abs=2e-3)


def test_without_a_deck_what_cuts_at_or_above_still_water_is_nothing():
    open_, house = (HULL[0], np.delete(HULL[1], 5, axis=0)), box((1, 1, 1), (2.0, 0.2, 1.0))
    assert together(open_, house).volume == approx(VOLUME)
    column = below(AWKWARD["a column that reaches down into the box"])
    assert together(below(HULL), column).volume == approx(VOLUME)
    with pytest.raises(InputError, match="cut each other"):
        together(below(HULL), below(AWKWARD["bars that cross, no corner of one in the other"]))


BESIDE = {
    "apart": box((1, 1, 1), (5, 0, 0)),
    "wall on wall": box((1, 1, 1), (2.5, 0.2, 0)),
    "on the deck": box((1, 1, 1), (0.3, 0.2, 1.1)),
    "under the bottom": box((1, 1, 1), (0.3, 0.2, -1.3)),
    "edge on edge, half as long": mesh_of(fine_box((1, 1, 1.4), (2.5, 1.5, -0.1), 0.3)),
    "a corner in a wall": (np.array([[2, 0.1, 0], [3, 0, 0], [3, 1, 0], [3, 0, -1]]), np.array(
        [[0, 1, 2, 2], [0, 3, 1, 1], [1, 3, 2, 2], [0, 2, 3, 3]])),
}  # fmt: skip


@pytest.mark.parametrize("name", BESIDE)
@pytest.mark.parametrize("cut", [lambda mesh: mesh, below])
@pytest.mark.parametrize("turn", [lambda mesh: mesh, turned])
def test_what_stands_beside_adds_up(name, cut, turn):
    """A part of a wall that both have is told where it is under water."""
    other = BESIDE[name]
    hull = together(cut(turn(HULL)), cut(turn(other)))
    alone, whole = (surface.volume(surface.below(turn(mesh)[0][mesh[1]])) for mesh in (other, HULL))
    assert hull.volume == approx(whole + alone)
    assert [WALL in note for note in hull.notes] == [True] * (name in ("wall on wall", "under the bottom"))


def test_no_wall_is_left_where_panels_are_the_same():
    """Of as many on each side, half of one face: what differs is told, what is alike is left out."""
    halves = loose(surface.split(HULL[0][HULL[1]], 1.1))
    beside = loose(surface.split(HULL[0][HULL[1]] + AWAY, 1.1))
    apart = loose(surface.split(HULL[0][HULL[1]] + AWAY, 0.6))
    assert not any(WALL in note for note in together(halves, beside).notes)
    assert any(WALL in note for note in together(halves, apart).notes)


def test_a_ball_in_a_well_and_a_duck_about_a_ball():
    """A ball no wall of the ring touches, and one within the ring's own section; then a duck's inner side, curved."""
    well = ring(((3.0, -1.0), (3.0, 1.0), (2.0, 1.0), (2.0, -1.0)))
    ball = mesh_of(meshed(Revolution.sphere(radius=0.8, draft=0.9), 8))
    small = ball[0] * 0.4 + (0, 2.5, 0), ball[1]
    hull = together(mesh_of(well), ball, small)
    assert hull.volume == approx(well.volume + PanelHull.of(*ball).volume) and len(hull.notes) == 1
    duck = awkward.duck()[0].floats[0].hull
    inner = duck.vertices.mean(axis=0) + 0.5 * (duck.vertices - duck.vertices.mean(axis=0)), duck.faces
    assert together(mesh_of(duck), inner).volume == approx(duck.volume)
    with pytest.raises(InputError, match="cut each other"):
        together(mesh_of(duck), (inner[0] + np.ptp(duck.vertices, axis=0) * (0.5, 0, 0), inner[1]))


def test_pairs_of_boxes_that_meet_are_all_found(monkeypatch):
    """Whether compared one by one or halved first."""
    rng = np.random.default_rng(1)
    one, other = (rng.uniform(-1, 1, (n, 1, 3)) + rng.normal(scale=0.1, size=(n, 3, 3)) for n in (300, 170))
    meet = (one.min(axis=1)[:, None] <= other.max(axis=1)) & (one.max(axis=1)[:, None] >= other.min(axis=1))
    pairs = np.argwhere(meet.all(axis=2))
    for few in (2**14, 10):
        monkeypatch.setattr(shells, "FEW", few)
        found = shells._close(one, other)
        assert len(pairs) > 100 and np.array_equal(found[np.lexsort(found.T[::-1])], pairs)


def test_of_thousands_of_triangles_few_pairs_are_compared():
    outer, inner = (meshed(Revolution.sphere(radius=r, draft=r), 28) for r in (2.0, 1.9))
    assert together(mesh_of(outer), mesh_of(inner)).volume == approx(outer.volume)
    one, other = (surface.triangles(hull.panels) for hull in (outer, inner))
    assert len(one) > 1500 and len(shells._close(one, other)) < 10 * len(one)
