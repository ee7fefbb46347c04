"""What formats of mesh files declare besides corners, and how what is broken in them is told."""

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.panel_hull import PanelHull
from tests.hydrodynamics.shapes import box, hst, loose

DEMIHULL = box((10.0, 1.5, 2.0), (0.0, 3.0, 0.0))  # 1 m of draft
BARGE = box((4.0, 2.0, 1.0))
HALF = surface.below(BARGE[0][BARGE[1]], 1, sign=-1)
QUARTER = surface.below(HALF, 0, sign=-1)


def read(name, text):
    return PanelHull.read(name, text.encode())


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
