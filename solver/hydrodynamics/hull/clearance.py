"""Whether hulls at rest keep clear of each other, seen from above, and close each other's openings."""

from collections.abc import Sequence
from functools import lru_cache
from itertools import permutations

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull, panels
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution

WITHIN = 0.4  # turns round a point within or on a surface; beside a hole of another, on one's own side, 1/4 at most
SAME = 1e-9  # [m]
SIDES = 12  # points across the smaller surface
SLIP = 0.01  # of the smallest surface
FINE = 432  # panels that stand for a hull of revolution
ALONG = np.linspace(0.0, 1.0, 65)  # of a part of a meridian
SQUARE = np.array([[-1.0, -1.0], [1.0, 1.0]])


def touching(a: Hull, at: np.ndarray, b: Hull, other: np.ndarray) -> bool:
    """Whether two hulls at points `at` and `other` (3,) [m] meet."""
    return _touching(a, tuple(at.tolist()), b, tuple(other.tolist()))


Point = tuple[float, ...]


@lru_cache(maxsize=64)
def _touching(a: Hull, at: Point, b: Hull, other: Point) -> bool:
    """The same; scenes that differ in their joints alone ask it again.

    Where both the circles and the rectangles about them overlap, whole radii at each height decide of two bodies of
    revolution, wetted surfaces of others: one may lie in the other's well, above or below it, or adjoin it where both
    are open.
    """
    way = np.subtract(other, at)
    box, other_box = _rectangle(a) + at[:2], _rectangle(b) + other[:2]
    gap = np.maximum(box[0] - other_box[1], other_box[0] - box[1])
    if np.linalg.norm(way) > reach(a) + reach(b) or np.any(gap > 0):
        return False
    if isinstance(a, Revolution) and isinstance(b, Revolution):
        return bool(np.linalg.norm(way) <= _widest(a, b))
    return _meeting(a, b, tuple(float(x) for x in way[:2]))


def _widest(*hulls: Revolution) -> float:
    """Largest sum of radii at one height [m]; level parts end where others are as wide."""
    lines = [[s.at(ALONG)[:: 1 if s.start[1] < s.end[1] else -1].T for s in h.meridian] for h in hulls]
    heights = np.concatenate([z for each in lines for _, z in each])
    radii = [[np.interp(heights, z, r, -np.inf, -np.inf) for r, z in each if z[0] < z[-1]] for each in lines]
    return float(sum(np.max(each, axis=0) for each in radii).max())


@lru_cache(maxsize=64)
def _meeting(a: Hull, b: Hull, shift: tuple[float, float]) -> bool:
    """Whether a point of one wetted surface is on or within the other, b's reference point at `shift` from a's."""
    surfaces = _wetted(a), _wetted(b) + np.array([*shift, 0.0])
    size = min(np.ptp(s.reshape(-1, 3), axis=0).max() for s in surfaces) / SIDES
    return any(bool(np.any(_turns(one, _points(other, size)) > WITHIN)) for one, other in permutations(surfaces))


def _wetted(hull: Hull) -> np.ndarray:
    """Panels (n, 4, 3) [m] below still water."""
    if isinstance(hull, PanelHull):
        return hull.wetted
    vertices, faces = panels(hull, FINE)
    return vertices[faces]


def _points(wetted: np.ndarray, size: float) -> np.ndarray:
    """Middles of the panels' triangles, split until no side is longer than `size` [m]."""
    corners = surface.triangles(wetted)
    return surface.split(corners[:, [0, 1, 2, 2]], size)[:, :3].mean(axis=1)


def _turns(wetted: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How often a wetted surface, closed by its image in still water, winds round those of points (m, 3) in its box."""
    low, high = wetted.reshape(-1, 3).min(axis=0), wetted.reshape(-1, 3).max(axis=0)
    near = points[np.all((points >= low - SAME) & (points <= high + SAME), axis=1)]
    image = wetted[:, ::-1] * np.array([1.0, 1.0, -1.0])
    return surface.turns_round(np.concatenate([wetted, image]), near)


def reach(hull: Hull) -> float:
    """Radius of a whole hull of revolution, or of the wetted part of a mesh, whose deck may overhang [m]."""
    if isinstance(hull, PanelHull):
        return hull.largest_radius
    return max(s.widest for s in hull.meridian)


def _rectangle(hull: Hull) -> np.ndarray:
    """Corners (2, 2) [m]."""
    return hull.box if isinstance(hull, PanelHull) else reach(hull) * SQUARE


def openings(hulls: Sequence[Hull], places: Sequence[np.ndarray]) -> np.ndarray:
    """Open edges (n, 2, 3) [m] below still water that hulls at these points do not close among them.

    Bodies that adjoin, as a flap and the base that bears it, have no wetted face between them: each ends where the
    other does.
    """
    opened = [h.holes + at for h, at in zip(hulls, places, strict=True) if isinstance(h, PanelHull)]
    return surface.unmatched(np.concatenate([np.zeros((0, 2, 3)), *opened]))


def borders(hull: Hull, place: np.ndarray, edges: np.ndarray) -> bool:
    """Whether any of the edges (n, 2, 3) that `openings` found lies on a hole of the hull at this point."""
    if not isinstance(hull, PanelHull):
        return False
    both = np.concatenate([hull.holes + place, edges])
    left, whole = (np.linalg.norm(x[:, 1] - x[:, 0], axis=1).sum() for x in (surface.unmatched(both), both))
    return bool(left < whole - SAME)


def slips(hulls: Sequence[Hull], edges: np.ndarray) -> bool:
    """Whether openings enclose next to nothing of the hulls' surfaces, as slips of a mesh do."""
    return surface.enclosed(edges) <= SLIP * min(h.wetted_area for h in hulls)
