"""Boxes: closed forms of what they displace, at the surface and below it."""

import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.hull.box import box


def test_a_barge_has_its_closed_forms():
    hull = box(length=12.0, width=5.0, height=3.0, draft=1.2)
    assert hull.volume == approx(12 * 5 * 1.2, rel=1e-12) and hull.symmetry == (True, True)
    assert hull.buoyancy_point == approx([0, 0, -0.6], abs=1e-12)
    assert hull.waterplane == approx([60, 0, 0, 5 * 12**3 / 12, 0, 12 * 5**3 / 12], abs=1e-9)
    assert hull.draft == approx(1.2) and not hull.notes


def test_under_water_it_displaces_all_of_itself():
    hull = box(length=1.8, width=18.0, height=2.0, draft=10.0)
    assert hull.volume == approx(1.8 * 18 * 2) and hull.buoyancy_point == approx([0, 0, -9.0], abs=1e-12)


def test_a_side_that_is_none_is_refused():
    with pytest.raises(InputError, match=r"hull.draft = -1.0: must be > 0"):
        box(length=1.0, width=1.0, height=1.0, draft=-1.0)
