"""The still water in gaps between hulls and in their wells, as panels of a damping lid."""

from collections.abc import Sequence

import numpy as np
import scipy  # spatial is slow to import, and asked of scenes with a lid alone

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull, inside, nearest
from solver.hydrodynamics.hull.revolution import Revolution, polygon_radius

CIRCLE = 64  # sides of the polygon, as large as its circle, that stands for a round waterplane
ALONG = 1 / 4  # of the width: points of the outlines by which it is judged
FINEST = 1 / 8  # of the panels' side: shorter pieces of an outline are not divided further
CORNER = 0.1  # of the width squared: in a square corner a circle leaves (1 - π/4)/4 of its diameter's square free
FLAT = 1e-9  # area over the sides' squares: corners of flatter triangles lie in one line
SLIVER = 1e-3  # of a square of that side: smaller panels are left out


def gaps(hulls: Sequence[Hull], centres: np.ndarray, width: float, side: float) -> np.ndarray:
    """Triangles (n, 4, 3) [m], normals down, about `side` [m] long, on water where no circle of diameter `width` fits.

    That is, outside the hulls, their outlines' α-shape (Edelsbrunner, Kirkpatrick and Seidel 1983): Delaunay's
    triangles between points of the outlines, whose circles no other point is in, where those are that small. Patches
    smaller than a panel and a tenth of width², as in the corners of a wider well, are none.
    """
    lines = np.concatenate([outline(hull) + at[:2] for hull, at in zip(hulls, centres, strict=True)])
    points = _points(lines, min(side, ALONG * width))
    if len(points) < 3:
        return np.zeros((0, 4, 3))
    judged = scipy.spatial.Delaunay(points)
    circles, middles = _circumcentres(points[judged.simplices]), points[judged.simplices].mean(axis=1)
    narrow = 2 * nearest(circles, lines)[1] <= width
    narrow &= ~inside(middles, lines)  # all at once: of bodies that adjoin each has an open outline
    narrow = _large(judged, narrow, min(side**2, CORNER * width**2))
    meshed = scipy.spatial.Delaunay(np.concatenate([_points(lines, side), _within(judged, narrow, side)]))
    triangles = meshed.points[meshed.simplices]
    place = judged.find_simplex(triangles.mean(axis=1))
    kept = triangles[(place >= 0) & narrow[place] & (_area(triangles) > SLIVER * side**2)]
    level = np.pad(kept, ((0, 0), (0, 0), (0, 1)))
    return level[:, [0, 2, 1, 1]]  # Delaunay's run counter-clockwise


def outline(hull: Hull) -> np.ndarray:
    """Segments (ns, 2, 2) [m] in which a hull meets still water."""
    if not isinstance(hull, Revolution):
        return hull.waterline
    angle = 2 * np.pi * np.arange(CIRCLE) / CIRCLE
    radius = hull.waterplane_radius * polygon_radius(CIRCLE)
    corners = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)[: CIRCLE * (radius > 0)]


def _points(lines: np.ndarray, side: float) -> np.ndarray:
    """Ends (n, 2) of segments halved until they are no longer than `side`, nor than the gap beside them is wide."""
    while True:
        ends = np.unique(np.round(lines.reshape(-1, 2) / (surface.WELD * side)), axis=0) * (surface.WELD * side)
        length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
        middle = lines.mean(axis=1)
        if not len(ends):
            return ends
        beside = scipy.spatial.cKDTree(ends).query_ball_point(middle, 0.999 * length / 2, return_length=True) > 0
        long = (length > side) | (beside & (length > 2 * FINEST * side))
        if not long.any():
            return ends
        halves = [np.stack([lines[long, 0], middle[long]], axis=1), np.stack([middle[long], lines[long, 1]], axis=1)]
        lines = np.concatenate([lines[~long], *halves])


def _within(mesh: "scipy.spatial.Delaunay", kept: np.ndarray, side: float) -> np.ndarray:
    """Points of a lattice (n, 2) inside a mesh's triangles that are kept, no nearer than half a side to its points."""
    low, high = np.floor(mesh.points.min(axis=0) / side), np.ceil(mesh.points.max(axis=0) / side)
    x, y = (side * (np.arange(a, b) + 0.5) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    place = mesh.find_simplex(points)
    points = points[(place >= 0) & kept[place]]
    return points[scipy.spatial.cKDTree(mesh.points).query(points)[0] > side / 2]


def _large(mesh: "scipy.spatial.Delaunay", kept: np.ndarray, least: float) -> np.ndarray:
    """Which of the triangles kept (nt,) are in patches of at least that area [m²]."""
    pairs = np.stack([np.repeat(np.arange(len(kept)), 3), mesh.neighbors.ravel()], axis=1)
    pairs = pairs[(pairs[:, 1] >= 0) & kept[pairs[:, 0]] & kept[pairs[:, 1]]]
    _, patch = surface.connected(pairs, len(kept))
    return kept & (np.bincount(patch, _area(mesh.points[mesh.simplices]))[patch] >= least)


def _area(triangles: np.ndarray) -> np.ndarray:
    a, b = (triangles[:, 1:] - triangles[:, :1]).transpose(1, 0, 2)
    return np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2


def _circumcentres(triangles: np.ndarray) -> np.ndarray:
    """Of triangles (n, 3, 2), the last two sides a and b from the first corner: (a² b - b² a) × z / (2 a × b)."""
    a, b = (triangles[:, 1:] - triangles[:, :1]).transpose(1, 0, 2)
    twice = np.maximum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], FLAT * np.sum(a**2 + b**2, axis=1))
    x, y = (np.sum(a**2, axis=1)[:, None] * b - np.sum(b**2, axis=1)[:, None] * a).T
    return triangles[:, 0] + np.stack([y, -x], axis=1) / (2 * twice)[:, None]
