"""Whether two hulls at rest keep clear of each other, seen from above."""

import numpy as np

from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull

SQUARE = np.array([[-1.0, -1.0], [1.0, 1.0]])


def touching(a: Hull, at: np.ndarray, b: Hull, other: np.ndarray) -> bool:
    """Whether both the circles and the rectangles about two hulls at points `at` and `other` (3,) [m] overlap."""
    box, other_box = _rectangle(a) + at[:2], _rectangle(b) + other[:2]
    gap = np.maximum(box[0] - other_box[1], other_box[0] - box[1])
    return bool(np.linalg.norm(at - other) <= reach(a) + reach(b) and np.all(gap <= 0))


def reach(hull: Hull) -> float:
    """Radius of a whole hull of revolution, or of the wetted part of a mesh, whose deck may overhang [m]."""
    if isinstance(hull, PanelHull):
        return hull.largest_radius
    return float(max(s.at(np.linspace(0, 1, 65))[:, 0].max() for s in hull.meridian))


def _rectangle(hull: Hull) -> np.ndarray:
    """Corners (2, 2) [m]."""
    return hull.box if isinstance(hull, PanelHull) else reach(hull) * SQUARE
