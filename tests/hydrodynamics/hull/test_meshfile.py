"""What formats of mesh files declare besides corners, and how what is broken in them is told."""

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull import meshfile, surface
from solver.hydrodynamics.hull.panel_hull import PanelHull
from tests.hydrodynamics.shapes import box, hst, loose, obj, read, stl

DEMIHULL = box((10.0, 1.5, 2.0), (0.0, 3.0, 0.0))  # 1 m of draft
BARGE = box((4.0, 2.0, 1.0))
HALF = surface.below(BARGE[0][BARGE[1]], 1, sign=-1)
QUARTER = surface.below(HALF, 0, sign=-1)


@pytest.mark.parametrize("line", ["SYMMETRY_BODY 1 1", "SYMMETRY_BODY  1  1 ", "SYMMETRY 1", "SYMMETRY: 1"])
def test_a_catamaran_given_by_one_of_its_hulls_has_both(line):
    hull = read("a.hst", hst(*DEMIHULL, header=f"PROJECT: catamaran\n\n{line}\nNBBODY 1\nNUMPANEL 1 1 6"))
    assert hull.volume == approx(2 * 10 * 1.5 * 1.0) and hull.symmetry == (True, True)
    assert hull.box == approx(np.array([[-5, -3.75], [5, 3.75]]))


@pytest.mark.parametrize("first", [0, 1, 7])
@pytest.mark.parametrize(("planes", "part"), [(1, HALF), (2, QUARTER)])
def test_a_part_in_hydrostars_format_is_unfolded(planes, part, first):
    """Whatever its points' numbers begin with: 0 in a file that comes with BEMRosetta."""
    hull = read("a.hst", hst(*loose(part), header=f"SYMMETRY_BODY 1 {planes}", first=first))
    assert hull.volume == approx(4.0) and hull.closed and not hull.notes and hull.symmetry == (True, True)


def test_a_whole_body_in_hydrostars_format_stays_as_it_is():
    for line in ("SYMMETRY_BODY 1 0", "SYMMETRY_BODY 0 1", "# made by hand\nRHO 1025.0\nUSERS: us\nREFLENGTH 4"):
        assert read("a.hst", hst(*DEMIHULL, header=line)).volume == approx(15.0)
    corners = "\n".join(" ".join(map(str, p)) for p in DEMIHULL[0])
    panels = "\n".join(" ".join(map(str, f + 1)) for f in DEMIHULL[1])
    bare = f"COORDINATES\n{corners}\nENDCOORDINATES\nPANEL TYPE 0\n{panels}\nENDPANEL\n"
    assert read("a.hst", bare).volume == approx(15.0)


@pytest.mark.parametrize(
    ("header", "told"),
    [
        ("SYMMETRY_BODY 2 1", "line 1, 'SYMMETRY_BODY 2 1': one body alone"),
        ("NBBODY 2", "line 1, 'NBBODY 2': one body alone"),
        ("\nSYMMETRY_BODY 1 3", "line 2, 'SYMMETRY_BODY 1 3': "),
        ("ZONEDAMPING 0 1 0.5 0 1 0.5 0.1", "ZONEDAMPING with 7 values is not known"),
        ("SYMMETRIES 1", "SYMMETRIES with 1 values is not known"),
    ],
)
def test_what_hydrostars_header_says_and_is_not_known_is_refused_by_name(header, told):
    with pytest.raises(InputError) as error:
        read("a.hst", hst(*DEMIHULL, header=header))
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("\n3 -5.", "\n2 -5.", "line 5, '2 -5.000000000 3.750000000 -1.000000000': the same number again"),
        ("\n1 1 2 4 3\n", "\n1 1 2 9 3\n", "line 13: 9 is no point before it"),
        ("\n1 1 2 4 3\n", "\n1 1 2 4\n 1\n", "line 14, '1': 1 with 0 values"),
        ("\n2 -5.000", "\n2 -5.0x0", "line 4, "),
    ],
)
def test_what_is_broken_in_hydrostars_format_is_told_by_line(old, new, told):
    text = hst(*DEMIHULL)
    assert text.count(old) == 1
    with pytest.raises(InputError) as error:
        read("a.hst", text.replace(old, new))
    assert told in str(error.value)


WAVEFRONT = """# as modellers export it
mtllib hull.mtl
o hull
v -2 -1 -0.5
v -2 -1 0.5 1.0
v -2 1 -0.5
v -2 1 0.5 0.2 0.3 0.4
vt 0 0
vn -1 0 0
g stern
usemtl steel
s off
f 1/1/1 2//1 4/1 3
v 2 -1 -0.5
v 2 -1 0.5
v 2 1 -0.5
v 2 1 0.5
f -4 -2 -1 -3
f 1 5 6
f 1 6 2
f 3 4 8 7
f 1//1 3//1 7//1 5//1
f 2/1 6/1 8/1 4/1
"""


def test_wavefronts_corners_are_numbered_from_1_or_back_from_the_last():
    hull = read("a.obj", WAVEFRONT)
    assert hull.volume == approx(4.0) and hull.closed and not hull.notes and len(hull.vertices) == 8


def prism(outline, bottom=-1.0, top=1.0):
    """In Wavefront's format, with outline (n, 2) as bottom and deck, each one polygon."""
    n, x = len(outline), np.array(outline, float)
    corners = np.concatenate([np.column_stack([x, np.full(n, z)]) for z in (bottom, top)])
    sides = [[i, (i + 1) % n, (i + 1) % n + n, i + n] for i in range(n)]
    return obj(corners, [np.array(f) for f in (*sides, np.arange(n)[::-1], np.arange(n) + n)])


def shoelace(outline):
    x, y = np.array(outline, float).T
    return (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2


ROUND = [(3 * np.cos(a), 3 * np.sin(a)) for a in np.arange(64) * np.pi / 32]
U = [(0, 0), (6, 0), (6, 5), (4, 5), (4, 1), (3, 1), (2, 1), (2, 5), (0, 5)]  # (3, 1) on a straight side
DART = [(0, 0), (20, -2), (18, -0.5), (18, 0.5), (20, 2)]  # whose shortest cut leaves corners outside
STAR = [(r * np.cos(a), r * np.sin(a)) for a, r in zip(np.arange(10) * np.pi / 5, [4, 1] * 5, strict=True)]


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("outline", [ROUND, U, U[4:] + U[:4], DART, STAR, STAR[3:] + STAR[:3]])
def test_polygons_are_cut_into_triangles_that_cover_them_once(outline, turn):
    """Areas add up to the polygon's, which those of a fan of one that is not convex do not."""
    c, s = np.cos(turn), np.sin(turn)
    hull = read("a.obj", prism(np.array(outline) @ [[c, s], [-s, c]]))
    area, sides = abs(shoelace(outline)), np.linalg.norm(np.array(outline) - np.roll(outline, 1, axis=0), axis=1).sum()
    assert hull.closed and hull.volume == approx(area) and hull.wetted_area == approx(area + sides)
    assert hull.waterplane[0] == approx(area) and not hull.notes


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("f 3 4 8 7", "f 3 4 9 7", ": 9 is no point before it"),
        ("f -4 -2 -1 -3", "f -9 -2 -1 -3", ": -9 is no point before it"),
        ("f 3 4 8 7", "f 0 4 8 7", ": 0 is no point before it"),
        ("f 1 5 6", "f 1 5", ", 'f 1 5': f with 2 values"),
        ("f 1 5 6", "f 1 x 6", ", 'f 1 x 6': "),
        ("v 2 1 0.5", "v 2 1", ", 'v 2 1': v with 2 values"),
        ("f 1 5 6", "surf 0 1 0 1 1 2 3 4", ", 'surf 0 1 0 1 1 2 3 4': surf with"),
        ("f 3 4 8 7", "f 3 4 3 4 3", ", 'f 3 4 3 4 3': has no area, or its sides cross"),
    ],
)
def test_what_is_broken_in_wavefronts_format_is_told_by_line(old, new, told):
    before, after = WAVEFRONT.split(f"{old}\n")
    with pytest.raises(InputError) as error:
        read("a.obj", f"{before}{new}\n{after}")
    assert f"line {before.count(chr(10)) + 1}{told}" in str(error.value)


def test_a_format_that_is_not_known_says_what_to_install():
    with pytest.raises(InputError, match=r"xyz mesh: known are stl, .* obj, .*: pip install meshio$"):
        read("a.xyz", "nonsense")


def test_what_writers_add_to_a_file_is_no_part_of_it():
    """A byte-order mark, words in capitals, bytes after the last triangle; lengths in millimetres."""
    panels = BARGE[0][BARGE[1]]
    words, packed = stl(panels, text=True), stl(panels)
    for name, content in {
        "a.obj": b"\xef\xbb\xbf" + obj(*BARGE).encode(), "a.stl": words.upper(), "b.stl": packed + b"\0\0",
    }.items():  # fmt: skip
        hull = read(name, content)
        assert hull.volume == approx(4.0) and hull.closed and not hull.notes, name
    vertices, faces = meshfile.read("ship.stl", stl(1e5 * panels))
    assert PanelHull.of(surface.placed(vertices, (0, 0, 0), (0, 0, 0), 1e-3), faces).volume == approx(4e6)
    with pytest.raises(InputError, match=r"has a corner at 2e\+05 m, must be within 100000 m; see hull.scale"):
        PanelHull.of(vertices, faces)


def test_panels_that_nothing_joins_are_told_for_that():
    """Their corners 1 mm apart, as of a surface that CAD did not sew: of a brick's bond half are open, and meet."""
    rng = np.random.default_rng(3)
    triangles = surface.triangles(surface.split(BARGE[0][BARGE[1]], 0.5))
    torn = (triangles + 1e-3 * rng.normal(size=triangles.shape))[:, [0, 1, 2, 2]]
    sides = 3 * len(torn)
    with pytest.raises(InputError, match=f"is open at {sides} of its {sides} edges: corners .* lie 0.001.* m apart"):
        read("torn.stl", stl(torn))
