"""Whether hulls at rest keep clear of each other, seen from above, and close each other's openings."""

from collections.abc import Sequence
from functools import lru_cache
from itertools import permutations

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull, panels
from solver.hydrodynamics.hull.panel_hull import PanelHull

WITHIN = 0.4  # turns round a point within or on a surface; beside a hole of another, on one's own side, 1/4 at most
SLIP = 0.01  # of the smallest surface
FINE = 432  # panels that stand for a hull of revolution
SQUARE = np.array([[-1.0, -1.0], [1.0, 1.0]])


@lru_cache(maxsize=64)
def _meeting(a: Hull, b: Hull, shift: tuple[float, float]) -> bool:
    """Whether a panel's middle of one wetted surface is on or within the other, b's point at `shift` from a's."""
    surfaces = _wetted(a), _wetted(b) + np.array([*shift, 0.0])
    return any(bool(np.any(_turns(one, _middles(other)) > WITHIN)) for one, other in permutations(surfaces))


def touching(a: Hull, at: np.ndarray, b: Hull, other: np.ndarray) -> bool:
    """Whether two hulls at points `at` and `other` (3,) [m] meet.

    Where both the circles and the rectangles about them overlap, meshes are judged by their wetted surfaces: one may
    lie in the other's well, above or below it, or adjoin it where both are open.
    """
    box, other_box = _rectangle(a) + at[:2], _rectangle(b) + other[:2]
    gap = np.maximum(box[0] - other_box[1], other_box[0] - box[1])
    if np.linalg.norm(at - other) > reach(a) + reach(b) or np.any(gap > 0):
        return False
    meshed = isinstance(a, PanelHull) or isinstance(b, PanelHull)
    return not meshed or _meeting(a, b, tuple(float(x) for x in (other - at)[:2]))


def _wetted(hull: Hull) -> np.ndarray:
    """Panels (n, 4, 3) [m] below still water."""
    if isinstance(hull, PanelHull):
        return hull.wetted
    vertices, faces = panels(hull, FINE)
    return vertices[faces]


def _middles(wetted: np.ndarray) -> np.ndarray:
    return surface.triangles(wetted).mean(axis=1)


def _turns(wetted: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How often a wetted surface, closed by its image in still water, winds round points (m, 3)."""
    image = wetted[:, ::-1] * np.array([1.0, 1.0, -1.0])
    return surface.turns_round(np.concatenate([wetted, image]), points)


def reach(hull: Hull) -> float:
    """Radius of a whole hull of revolution, or of the wetted part of a mesh, whose deck may overhang [m]."""
    if isinstance(hull, PanelHull):
        return hull.largest_radius
    return float(max(s.at(np.linspace(0, 1, 65))[:, 0].max() for s in hull.meridian))


def _rectangle(hull: Hull) -> np.ndarray:
    """Corners (2, 2) [m]."""
    return hull.box if isinstance(hull, PanelHull) else reach(hull) * SQUARE


def uncovered(hulls: Sequence[Hull], places: Sequence[np.ndarray]) -> np.ndarray:
    """Open edges (n, 2, 3) [m] below still water that hulls at these points do not close among them.

    Bodies that adjoin, as a flap and the base that bears it, have no wetted face between them: each ends where the
    other does. Slips of a mesh that enclose next to nothing are let pass.
    """
    opened = [(h, at) for h, at in zip(hulls, places, strict=True) if isinstance(h, PanelHull) and len(h.holes)]
    if not opened:
        return np.zeros((0, 2, 3))
    left = surface.unmatched(np.concatenate([h.holes + at for h, at in opened]))
    return left if surface.enclosed(left) > SLIP * min(h.wetted_area for h, _ in opened) else left[:0]
