"""Hulls that stand on the seabed, as caissons and foundations do: there is no water beneath them, nor flow."""

import numpy as np

from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution

ON_SEABED = 1e-6  # of the depth: what is as near to the seabed lies on it
LEVEL = 1e-6  # of an area, that one on the seabed may have along x and y


def stands(hull: Revolution | PanelHull, depth: float) -> bool:
    """Whether a hull at still water has a foot, flat on the seabed in `depth` [m, may be inf]."""
    if not np.isfinite(depth) or abs(hull.draft - depth) > ON_SEABED * depth:
        return False
    if isinstance(hull, Revolution):
        first = hull.meridian[0]
        return first.centre is None and first.start[1] == first.end[1]
    return bool(np.any(_lying(hull.wetted, depth)))


def _lying(corners: np.ndarray, depth: float) -> np.ndarray:
    """Which panels (n, 4, 3) [m] lie on the seabed (n,)."""
    return np.all(corners[..., 2] <= -(1 - ON_SEABED) * depth, axis=1)


def walls(vertices: np.ndarray, faces: np.ndarray, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """The panels of a hull that stands in `depth` [m] but for its foot, the lowest corners of others at the seabed."""
    lowest = vertices[:, 2].min()  # deeper by what makes the volume of coarse panels exact
    vertices = vertices * np.array([1.0, 1.0, -depth / lowest])
    return vertices, faces[~_lying(vertices[faces], depth)]


def wetted(points: np.ndarray, areas: np.ndarray, depth: float) -> np.ndarray:
    """Which of a surface's points (np, 3) [m] with areas n dS (np, 3) [m²] have water before them (np,)."""
    level = np.hypot(*areas[:, :2].T) <= LEVEL * np.linalg.norm(areas, axis=1)
    return ~(level & (points[:, 2] <= -(1 - ON_SEABED) * depth))
