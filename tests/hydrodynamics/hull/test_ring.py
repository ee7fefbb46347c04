"""Rings round a well: closed forms of what they displace, and the limit of a narrow well."""

from math import inf

import numpy as np
import pytest
from pytest import approx

from solver.errors import InputError
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring

SECTION = ((10.0, -3.0), (10.0, 2.0), (3.0, 2.0), (3.0, -3.0))


def test_volume_and_waterplane_are_exact():
    hull = ring(SECTION)
    area = np.pi * (10.0**2 - 3.0**2)
    assert hull.volume == approx(3 * area, rel=1e-12) and hull.symmetry == (True, True)
    assert hull.buoyancy_point == approx([0, 0, -1.5], abs=1e-12)
    assert hull.waterplane[0] == approx(area, rel=1e-12)
    assert hull.waterplane[3] == approx(np.pi / 4 * (10.0**4 - 3.0**4), rel=0.01)  # of polygons
    cone = ring(((4.0, -1.0), (2.0, 1.0), (2.0, -1.0)))  # its outer side a frustum's: π/3 (16 + 12 + 9) - 4π
    assert cone.volume == approx(np.pi * (37 / 3 - 4), rel=1e-12)


def test_either_way_round_is_the_same():
    one, other = ring(SECTION), ring(SECTION[::-1])
    assert one.volume == approx(other.volume, rel=1e-12) and not one.notes == other.notes == ()


def test_a_narrow_well_is_none():
    """A fortieth of the area is left out; its water goes along in surge, and hardly bears heave in long waves."""
    omega, water = np.array([0.5, 0.8]), {"depth": inf, "density": 1000.0, "panels": 200}
    solid = Revolution.vertical_cylinder(radius=5.0, draft=3.0, freeboard=2.0)
    holed = ring(((5.0, -3.0), (5.0, 2.0), (0.8, 2.0), (0.8, -3.0)))
    a, b = (bem.solve((hull,), np.zeros((1, 3)), omega=omega, **water) for hull in (solid, holed))
    i = a.dofs.index("surge"), a.dofs.index("heave")
    inside = np.array([1000 * np.pi * 0.8**2 * 3.0, 0.0])
    assert b.added_mass[:, i, i] == approx(a.added_mass[:, i, i] + inside, rel=0.03)
    assert b.radiation_damping[:, i, i] == approx(a.radiation_damping[:, i, i], rel=0.06)


@pytest.mark.parametrize(
    "points, told",
    [
        (((3.0, -1.0), (3.0, 1.0), (0.0, 1.0)), r"points = \(0.0, 1.0\): must be off the axis"),
        (((3.0, -1.0), (3.0, 1.0), (2.0, 1.0), (3.0, -1.0)), "the outline closes by itself"),
    ],
)
def test_outlines_that_cannot_be_are_refused(points, told):
    with pytest.raises(InputError, match=told):
        ring(points)
