"""Hulls from mesh files: what is read, mended, refused, and their hydrostatics."""

import re
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.clearance import borders, openings, slips, touching
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from tests.hydrodynamics.shapes import box, fine_box, gdf, hst, loose, meshed, nemoh, obj, read, stl

SIZE, CENTRE = (4.0, 2.0, 1.0), (0.5, 0.0, 0.1)  # 0.4 m of draft
VERTICES, FACES = box(SIZE, CENTRE)
PANELS = VERTICES[FACES]
NOT_FACES = {"hull.stl": stl(PANELS), "words.stl": stl(PANELS, text=True), "hull.gdf": gdf(PANELS)}
INDEXED = {"hull.dat": nemoh(VERTICES, FACES), "hull.HST": hst(VERTICES, FACES), "hull.obj": obj(VERTICES, FACES)}


@pytest.mark.parametrize("name", [*NOT_FACES, *INDEXED])
def test_every_format_gives_the_same_box(name):
    hull = read(name, (NOT_FACES | INDEXED)[name])
    # Single precision of a binary STL: 1e-7 of 4 m.
    assert hull.volume == approx(4 * 2 * 0.4, rel=1e-6)
    assert hull.buoyancy_point == approx([0.5, 0, -0.2], abs=1e-6)
    assert hull.closed and len(hull.vertices) == 8 and not hull.notes


def test_closed_forms_of_a_box():
    hull = PanelHull.of(VERTICES, FACES)
    area, ixx, iyy = 8.0, 4**3 * 2 / 12 + 8 * 0.5**2, 2**3 * 4 / 12
    assert hull.waterplane == approx([area, area * 0.5, 0, ixx, 0, iyy], abs=1e-12)
    assert hull.draft == approx(0.4) and hull.wetted_area == approx(8 + 12 * 0.4)
    assert hull.symmetry == (False, True)
    assert hull.largest_radius == approx(np.hypot(2.5, 1)) and hull.scale == approx(np.sqrt(8 / np.pi))
    assert hull.box == approx(np.array([[-1.5, -1], [2.5, 1]]))


@pytest.mark.parametrize(
    "content",
    [
        lambda half, _: gdf(half, isy=1),
        lambda half, _: gdf(half, isy=1, gravity=32.174, unit=0.3048),
        lambda _, quarter: gdf(quarter, isx=1, isy=1),
    ],
)
def test_gdf_symmetry_and_feet(content):
    panels = box(SIZE)[0][FACES]
    half = surface.below(panels, 1, sign=-1)
    # The cut of a closed box leaves no panel in the plane of symmetry.
    hull = read("a.gdf", content(half, surface.below(half, 0, sign=-1)))
    assert hull.volume == approx(4.0, rel=1e-8) and hull.symmetry == (True, True) and hull.closed


def test_nemoh_symmetry():
    half = surface.below(box(SIZE)[0][FACES], 1)
    assert read("a.dat", nemoh(*loose(half), symmetric=1)).volume == approx(4.0, rel=1e-8)


def test_an_inside_out_mesh_is_turned():
    hull = read("a.stl", stl(PANELS[:, ::-1]))
    assert hull.notes == ("the mesh was inside out: its normals were turned into the water",)
    assert hull.volume == approx(3.2, rel=1e-6)


def test_equal_hulls_have_one_hash_and_others_differ():
    hull = PanelHull.of(*box(SIZE)).moved(np.array([2.0, 0.0, 0.0]))  # corners at x = 0
    equal = replace(hull, vertices=np.where(hull.vertices == 0, -0.0, hull.vertices))
    assert equal.vertices.tobytes() != hull.vertices.tobytes()
    assert equal == hull and hash(equal) == hash(hull)
    assert replace(hull, finer=hull.wetted) != hull


@pytest.mark.parametrize("corner", range(4))
def test_a_triangle_may_repeat_any_corner(corner):
    """In a half that its format unfolds, too."""
    half = surface.below(box(SIZE)[0][FACES], 1, sign=-1)
    turned = np.roll(surface.triangles(half)[:, [0, 1, 2, 2]], corner, axis=1)
    hull = read("a.gdf", gdf(turned, isy=1))
    assert hull.volume == approx(4.0) and hull.closed and not hull.notes


def test_panels_wound_against_the_others_are_turned():
    mixed = FACES.copy()
    mixed[[1, 4]] = mixed[[1, 4], ::-1]
    hull = PanelHull.of(VERTICES, mixed)
    assert hull.volume == approx(3.2) and hull.notes == ("turned: 2 panels wound against their neighbours",)


def test_two_floats_in_one_mesh_are_turned_each_for_itself():
    other = box((1.0, 1.0, 1.0), (5, 0, 0))
    both = surface.merged([(VERTICES, FACES[:, ::-1]), other])
    hull = PanelHull.of(*both)
    assert hull.volume == approx(3.2 + 0.5) and "inside out" in hull.notes[0]


def test_double_and_degenerate_panels_are_left_out():
    faces = np.concatenate([FACES, FACES[:1], [[0, 1, 0, 1], [2, 2, 2, 3]]])
    hull = PanelHull.of(VERTICES, faces)
    assert hull.volume == approx(3.2)
    assert hull.notes == ("left out: 2 panels without area", "left out: 1 panels given twice")


def test_a_mesh_without_its_top_is_open():
    hull = PanelHull.of(VERTICES, FACES[:5])
    assert not hull.closed and hull.volume == approx(3.2) and not len(hull.holes)
    wetted = PanelHull.of(*loose(hull.wetted))  # as a GDF file has it
    assert not wetted.closed and wetted.volume == approx(3.2)


@pytest.mark.parametrize("face", range(6))
def test_corners_may_lie_on_other_panels_sides(face):
    others = [VERTICES[f] for i, f in enumerate(FACES) if i != face]
    a, b, c, d = VERTICES[FACES[face]]
    low, high = (a + b) / 2, (c + d) / 2
    quarters = surface.quartered(np.array([low, b, c, high])[None])
    mixed = np.array([*others, [a, low, high, d], *quarters])
    mixed[::2] = mixed[::2, ::-1]
    hull = PanelHull.of(*loose(mixed))
    assert hull.closed and hull.volume == approx(3.2) and hull.buoyancy_point == approx([0.5, 0, -0.2])
    assert any("turned: " in note for note in hull.notes)
    assert hull.symmetry == (False, True)


def test_a_mirror_image_may_be_cut_along_the_other_diagonal():
    halves = np.array([[p[0], p[1], p[2], p[2]] for p in PANELS] + [[p[0], p[2], p[3], p[3]] for p in PANELS])
    assert PanelHull.of(*loose(halves)).symmetry == (False, True)
    skew = halves.copy()
    skew[np.all(skew == VERTICES[7], axis=2)] += [0.0, 0.01, 0.0]
    assert PanelHull.of(*loose(skew)).symmetry == (False, False)


def test_bodies_that_adjoin_close_each_others_openings():
    """A box cut in two at x = 0: neither half has a wall there."""
    halves = [PanelHull.of(*loose(surface.below(box((2.0, 2.0, 1.0))[0][FACES], 0, sign=s))) for s in (1, -1)]
    assert all(not h.closed and len(h.holes) for h in halves) and sum(h.volume for h in halves) == approx(2.0)
    origin = np.zeros(3)
    assert len(openings(halves, [origin, origin])) == 0 and not touching(halves[0], origin, halves[1], origin)
    apart, alone = openings(halves, [origin, np.array([0.1, 0, 0])]), openings(halves[:1], [origin])
    assert len(alone) == 3 and not slips(halves, alone) and len(apart) and not slips(halves, apart)
    assert slips(halves, alone / 100)


def test_open_edges_are_told_of_the_bodies_that_have_them():
    """Halves that close each other, a body without the half that would close it, and one that is closed."""
    halves = [PanelHull.of(*loose(surface.below(box((2.0, 2.0, 1.0))[0][FACES], 0, sign=s))) for s in (1, -1)]
    hulls = [*halves, halves[0], PanelHull.of(*box((1.0, 1.0, 1.0))), Revolution.sphere(radius=1.0, draft=1.0)]
    places = [np.array([x, 0.0, 0.0]) for x in (0, 0, 9, 20, 30)]
    edges = openings(hulls, places)
    assert [borders(h, at, edges) for h, at in zip(hulls, places, strict=True)] == [False, False, True, False, False]
    parts = np.concatenate([edges, edges.mean(axis=1, keepdims=True)], axis=1)[0, [0, 2]][None]
    assert borders(halves[0], places[2], parts) and not borders(halves[0], places[0], parts)


SECTION = ((3.0, -1.0), (3.0, 1.0), (2.0, 1.0), (2.0, -1.0))


def test_bodies_are_judged_by_their_surfaces():
    """A ring about a cylinder, the same cylinder moved into the ring, and a box that shares a wall with another."""
    well, inner, away = ring(SECTION), Revolution.vertical_cylinder(radius=1.0, draft=1.0, freeboard=1.0), 1.5
    assert not touching(well, np.zeros(3), inner, np.zeros(3)) and touching(
        well, np.zeros(3), inner, np.array([away, 0, 0])
    )
    small, large = (PanelHull.of(*box((a, a, 1.0))) for a in (1.0, 4.0))
    assert touching(large, np.zeros(3), small, np.array([1.0, 0, 0]))  # wholly within
    assert touching(large, np.zeros(3), small, np.array([2.5, 0, 0]))  # wall on wall
    assert touching(large, np.zeros(3), large, np.array([3.5, 3.5, 0]))  # corner in corner
    assert not touching(large, np.zeros(3), small, np.array([2.6, 0, 0]))


def test_bodies_of_revolution_touch_where_both_are_wide_at_one_height():
    """A ball above a spar's plate and at the spar, a can down to the plate, shoulders in air, walls side by side."""
    line = [(8.0, -20.0), (8.0, -19.5), (2.0, -19.5), (2.0, 3.0), (5.0, 3.0), (5.0, 4.0)]
    spar, still = Revolution.profile(line), np.zeros(3)
    ball, tall = (Revolution.sphere(radius=2.5, draft=d) for d in (2.5, 1.4))
    deep = Revolution.vertical_cylinder(radius=1.0, draft=19.6, freeboard=1.0)
    for hull, at, touches in ((ball, 4.6, False), (ball, 4.4, True), (deep, 8.9, True), (tall, 6.6, True)):
        for a, b in ((spar, hull), (hull, spar)):
            assert touching(a, still, b, np.array([0.0, -at, 0.0])) is touches, at
    can = Revolution.vertical_cylinder(radius=1.1, draft=2.0, freeboard=1.0)
    assert touching(can, still, can, np.array([2.2, 0, 0])) and not touching(can, still, can, np.array([2.21, 0, 0]))


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        ((VERTICES + np.array([0, 0, 5]), FACES), "must reach below still water"),
        ((VERTICES, np.concatenate([FACES, [[0, 1, 7, 7]]])), "3 panels meet"),
        ((VERTICES, FACES[:1] * 0), "no panel with an area"),
    ],
)
def test_what_is_no_hull_is_refused(mesh, reason):
    with pytest.raises(InputError, match=reason) as error:
        PanelHull.of(*mesh, name="a.stl")
    assert error.value.key == "hull.file"


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.7])
@pytest.mark.parametrize(("kept", "edges"), [([0, 1, 2, 3, 5], 4), ([0, 2, 3], 5)])
def test_walls_without_a_bottom_are_told_to_be_open(turn, kept, edges):
    """Above which there is no volume but what rounding of turned walls seems to leave."""
    corners = surface.placed(VERTICES, (-7, 4, 0), (0, 0, turn), 1.0)
    with pytest.raises(
        InputError, match=rf"must be > 0: it is open below still water, at {edges} edges, the first"
    ) as told:
        PanelHull.of(corners, FACES[kept])
    near = np.array(re.findall(r"[-.\d]+", str(told.value).rpartition("(")[2])[:3], float)
    middles = corners[np.array([[0, 2], [0, 4], [2, 6], [4, 6], [4, 5], [6, 7]])].mean(axis=1)
    assert np.linalg.norm(middles * [1, 1, 0] - near * [1, 1, 0], axis=1).min() < 2e-3 and near[2] <= 0


def test_a_thin_plate_has_a_volume():
    assert PanelHull.of(*box((100.0, 100.0, 0.02))).volume == approx(100.0)


def test_a_moebius_strip_is_refused():
    turn = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    across = np.stack([np.cos(turn / 2) * np.cos(turn), np.cos(turn / 2) * np.sin(turn), np.sin(turn / 2)], axis=1)
    middle = 5 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    a, b, n = middle + across, middle - across, np.arange(12)
    faces = np.stack([n, n + 12, (n + 1) % 12 + 12, (n + 1) % 12], axis=1)
    faces[11] = [11, 23, 0, 12]
    with pytest.raises(InputError, match="one side"):
        PanelHull.of(np.concatenate([a, b]), faces)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.stl", b""),
        ("a.stl", b"solid\nvertex 0 0 0\nendsolid"),
        ("a.stl", stl(PANELS)[:-7]),
        ("a.stl", b"solid\nvertex nan 0 0\nvertex 1 0 0\nvertex 0 1 0\nendsolid"),
        ("a.stl", b"solid\nvertex O 0 0\nvertex 1 0 0\nvertex 0 1 0\nendsolid"),
        ("a.gdf", b"title\n1 9.81\n0 0\n2\n0 0 0"),
        ("a.gdf", b"title\n1 9.81\n-1 0\n0\n"),
        ("a.gdf", b"title"),
        ("a.dat", b"2 0\n1 0 0 0\n0 0 0 0\n1 2 3 4\n0 0 0 0"),
        ("a.dat", b"nonsense"),
        ("a.xyz", b"nonsense"),
        ("a.stl", stl(np.full((1, 4, 3), np.nan))),
    ],
)
def test_what_cannot_be_read_is_refused_with_the_files_name(name, content):
    with pytest.raises(InputError) as error:
        read(name, content)
    assert error.value.key == "hull.file" and error.value.value == name


def test_clipping_keeps_volume_and_area():
    """Any cut of a closed box: what is below and what is above make the whole."""
    panels = surface.split(PANELS, 0.3)
    low, high = surface.below(panels), surface.below(panels, sign=-1)
    area = [np.linalg.norm(surface.area_vectors(surface.triangles(p)), axis=1).sum() for p in (low, high, panels)]
    assert area[0] + area[1] == approx(area[2], rel=1e-12)
    assert low[:, :, 2].max() <= 0 <= high[:, :, 2].min()


@pytest.mark.parametrize("change", [lambda p: surface.split(p, 0.37), surface.quartered])
def test_splitting_changes_nothing_but_the_count(change):
    whole, corners = PANELS, surface.triangles(PANELS)
    for panels in (whole, np.concatenate([corners, corners[:, 2:]], axis=1)):
        parts = change(panels)
        area = surface.area_vectors(surface.triangles(parts))
        assert len(parts) >= 4 * len(panels) and np.linalg.norm(area, axis=1).sum() == approx(2 * (8 + 4 + 2))
        assert PanelHull.of(*loose(parts)).volume == approx(3.2)


def test_a_meshed_sphere_approaches_the_sphere_at_second_order():
    sphere = Revolution.sphere(radius=1.0, draft=0.7)
    along = np.array([12, 24, 48])
    error = [abs(meshed(sphere, int(n)).centre_of_buoyancy - sphere.centre_of_buoyancy) for n in along]
    assert np.polyfit(np.log(1 / along), np.log(error), 1)[0] == approx(2, abs=0.1)
    assert meshed(sphere, 12).symmetry == (True, True)


def test_symmetry_does_not_depend_on_the_diagonals():
    diagonals = surface.triangles(PANELS - [0.5, 0, 0])
    hull = PanelHull.of(*loose(np.concatenate([diagonals, diagonals[:, 2:]], axis=1)))
    assert hull.symmetry == (True, True)
    assert fine_box(SIZE, (0, 0.2, 0), 0.5).symmetry == (True, False)


def test_a_mesh_is_shifted_turned_and_scaled():
    """About x, then y, then z, through the origin; a point on x goes where y's turn and z's take it."""
    point = np.array([[1003.0, 2000.0, -500.0]])
    a, b, c = 0.3, 0.5, -0.7
    moved = surface.placed(point, (1000.0, 2000.0, -500.0), (a, b, c), 0.001)
    assert moved[0] == pytest.approx(0.003 * np.array([np.cos(b) * np.cos(c), np.cos(b) * np.sin(c), -np.sin(b)]))
    up = surface.placed(np.array([[0.0, 0, 1]]), (0, 0, 0), (a, 0, 0), 1.0)
    assert up[0] == pytest.approx([0, -np.sin(a), np.cos(a)])


@pytest.mark.parametrize("twist", [0.02, 0.3, 0.5])
def test_a_panel_that_is_not_plane_is_folded_at_still_water_as_everywhere(twist):
    """A prism turned as it rises, its sides one panel each from keel to deck: the same as of triangles."""
    angle = np.arange(4) * np.pi / 2
    turn = np.exp(1j * np.array([[0.0], [twist]]))
    ring = np.array([[4.0], [4.8]]) * np.exp(1j * angle) * turn
    corners = np.stack([ring.real, ring.imag, np.broadcast_to([[-2.2], [1.7]], ring.shape)], axis=-1).reshape(-1, 3)
    sides = [[i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4] for i in range(4)]
    faces = np.array([*sides, [3, 2, 1, 0], [4, 5, 6, 7]])
    folded = surface.triangles(corners[faces])[:, [0, 1, 2, 2]]
    quads, triangles = PanelHull.of(corners, faces), PanelHull.of(*loose(folded))
    assert quads.volume == approx(triangles.volume, rel=1e-12)
    assert quads.waterplane == approx(triangles.waterplane, rel=1e-9, abs=1e-9)
    assert quads.buoyancy_point == approx(triangles.buoyancy_point, abs=1e-12)
