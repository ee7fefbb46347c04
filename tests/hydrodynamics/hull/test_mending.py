"""Panels that lie on each other are left out; what stays encloses what the mesh without them does."""

import itertools

import numpy as np
import pytest
from pytest import approx

from solver.hydrodynamics.hull import surface
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
            assert f"left out: {len(places)} panels given twice" in hull.notes


@pytest.mark.parametrize("kind", ORDERS)
def test_a_mesh_of_two_sided_panels_is_its_surface(kind):
    panels, orders = ORDERS[kind]
    assert PanelHull.of(*loose(np.concatenate([panels[:, orders[-1]], panels]))).volume == approx(4 * 2 * 0.7)
