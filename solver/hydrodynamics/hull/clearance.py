"""Whether two hulls at rest keep clear of each other: seen from above, and where outlines overlap by their surfaces."""

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull

SQUARE = np.array([[-1.0, -1.0], [1.0, 1.0]])
AROUND, ALONG = 48, 12  # of a hull of revolution seen as panels: in a circle, and along a piece of its meridian
SIDES = 12  # points across the smaller hull, at which it is looked for in the other
NUDGE = 1.2345e-6, 2.3456e-6  # of the size: plumb lines that miss the corners of a regular mesh


def touching(a: Hull, at: np.ndarray, b: Hull, other: np.ndarray) -> bool:
    """Whether any of one hull's surface lies in the other; hulls at points `at` and `other` (3,) [m].

    Seen from above both the circles and the rectangles about them must overlap for that.
    """
    box, other_box = _rectangle(a) + at[:2], _rectangle(b) + other[:2]
    gap = np.maximum(box[0] - other_box[1], other_box[0] - box[1])
    if np.linalg.norm(at - other) > reach(a) + reach(b) or np.any(gap > 0):
        return False
    panels, others = _panels(a) + at, _panels(b) + other
    size = min(np.ptp(p.reshape(-1, 3), axis=0).max() for p in (panels, others)) / SIDES
    return bool(np.any(_inside(_points(panels, size), others)) or np.any(_inside(_points(others, size), panels)))


def reach(hull: Hull) -> float:
    """Radius of a whole hull of revolution, or of the wetted part of a mesh, whose deck may overhang [m]."""
    if isinstance(hull, PanelHull):
        return hull.largest_radius
    return float(max(s.at(np.linspace(0, 1, 65))[:, 0].max() for s in hull.meridian))


def _rectangle(hull: Hull) -> np.ndarray:
    """Corners (2, 2) [m]."""
    return hull.box if isinstance(hull, PanelHull) else reach(hull) * SQUARE


def _panels(hull: Hull) -> np.ndarray:
    """The whole surface (n, 4, 3) [m]; below still water where it is open above."""
    if isinstance(hull, PanelHull):
        return hull.panels if hull.closed else hull.wetted
    fractions = np.linspace(0, 1, ALONG + 1)
    line = np.concatenate([s.at(fractions[:-1]) for s in hull.meridian] + [hull.meridian[-1].at(fractions[-1:])])
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    grid = np.concatenate(
        [line[:, None, :1] * ring, np.broadcast_to(line[:, None, 1:], (len(line), AROUND, 1))], axis=2
    )
    turned = np.roll(grid, -1, axis=1)
    return np.stack([grid[:-1], turned[:-1], turned[1:], grid[1:]], axis=2).reshape(-1, 4, 3)


def _points(panels: np.ndarray, size: float) -> np.ndarray:
    """Middles of the panels' triangles, split until no side is longer than `size` [m]."""
    corners = surface.triangles(panels)
    return surface.split(np.concatenate([corners, corners[:, 2:]], axis=1), size)[:, :3].mean(axis=1)


def _inside(points: np.ndarray, panels: np.ndarray) -> np.ndarray:
    """Which points (n, 3) a plumb line leaves downwards across an odd number of a surface's triangles."""
    a, b, c = np.moveaxis(surface.triangles(panels), 1, 0)
    low, high = panels.reshape(-1, 3).min(axis=0), panels.reshape(-1, 3).max(axis=0)
    near = np.all((points > low) & (points < high), axis=1)
    found = np.zeros(len(points), bool)
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    steep = np.abs(area) < 1e-14 * (high - low).max() ** 2
    for i in np.flatnonzero(near):
        x, y = (points[i, :2] + np.multiply(NUDGE, (high - low).max()) - a[:, :2]).T
        with np.errstate(divide="ignore", invalid="ignore"):
            s, t = (x * v[:, 1] - y * v[:, 0]) / area, (u[:, 0] * y - u[:, 1] * x) / area
            crossed = (s >= 0) & (t >= 0) & (s + t <= 1) & (a[:, 2] + s * u[:, 2] + t * v[:, 2] < points[i, 2]) & ~steep
        found[i] = np.sum(crossed) % 2 == 1
    return found
