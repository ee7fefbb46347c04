"""How often surfaces wind round points, beside the solid angles themselves."""

import numpy as np

from solver.hydrodynamics.hull import surface
from tests import awkward


def by_sides(panels, points):
    """Van Oosterom and Strackee's formula as it stands, of the sides that each point sees."""
    a, b, c = np.moveaxis(surface.triangles(panels)[None] - points[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
    ab, bc, ca = (np.sum(x * y, axis=-1) for x, y in ((a, b), (b, c), (c, a)))
    triple = np.sum(a * np.cross(b, c), axis=-1)
    return np.arctan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb).sum(axis=1) / (2 * np.pi)


def test_a_duck_winds_once_round_what_is_inside_wherever_it_is(monkeypatch):
    """Near its faces and corners, far from the origin, and in parts of a few points."""
    panels = awkward.duck()[0].floats[0].hull.panels
    rng = np.random.default_rng(0)
    points = rng.uniform(-3, 3, (400, 3))
    near = panels.reshape(-1, 3)[:50] + rng.normal(scale=1e-3, size=(50, 3))
    points = np.concatenate([points, near, panels.mean(axis=1) * (1 - 1e-6)])
    winding = by_sides(panels, points)
    assert 20 < np.sum(winding > 0.5) < 400
    for shift in ([0, 0, 0], [1e4, -3e3, 20]):
        np.testing.assert_allclose(surface.turns_round(panels + shift, points + shift), winding, atol=1e-6)
    monkeypatch.setattr(surface, "PAIRS", 7 * len(panels))
    np.testing.assert_allclose(surface.turns_round(panels, points), winding, atol=1e-9)
    assert surface.turns_round(panels, points[:0]).shape == (0,)


def test_a_point_in_a_faces_plane_but_beside_it_is_outside():
    box = awkward.soft_mooring()[0].floats[0].hull.panels
    beside = np.array([[0.0, 5.0, 1.0], [0.0, 5.0, -1.2], [5.0, 0.1, 3.0]])
    np.testing.assert_allclose(surface.turns_round(box, beside), 0.0, atol=1e-12)
