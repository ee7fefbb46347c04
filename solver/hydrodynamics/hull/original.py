"""The surface of a dense mesh as one to be met by a coarser: its nearest points, its corners, and its curves.

Curves are sharp edges and rims between corners.
"""

import numpy as np
import scipy  # sparse and spatial are slow to import, and the command line needs scenes but rarely meshes

from solver.hydrodynamics.hull import mending, surface

SHARP = np.cos(np.pi / 6)  # of the angle between normals, below which the edge between two panels is one of the hull
CORNER = 0.5  # cosine of an edge's turn, below which it has a corner there
FREE, ON_EDGE, AT_CORNER = range(3)

Point = tuple[float, float, float]


def key(a: int, b: int) -> tuple[int, int]:
    """Of a side, whichever way round."""
    return (a, b) if a < b else (b, a)


def point(row: np.ndarray) -> Point:
    """Of an array (3,), for arithmetic on one at a time."""
    x, y, z = row.tolist()
    return x, y, z


class Original:
    """The surface that is to be met, and its curves: sharp edges and rims between corners."""

    def __init__(self, wetted: np.ndarray, side: float):
        self.points, self.faces = _conforming(*mending.triangulated(wetted))
        vectors = surface.area_vectors(self.points[self.faces])
        self.normals = vectors / np.linalg.norm(vectors, axis=1)[:, None]
        pairs = self._sharp()
        self.rank = self._ranks(pairs)
        inner = np.where(self.rank[pairs] == AT_CORNER, -1, pairs)
        links = scipy.sparse.coo_array(
            (np.ones(inner.size), (np.repeat(np.arange(len(pairs)), 2), inner.ravel() + 1)),
            shape=(len(pairs), len(self.points) + 1),
        ).tocsc()[:, 1:]
        _, curve = scipy.sparse.csgraph.connected_components(links @ links.T, directed=False)
        self.curves = {key(*pair): int(c) for pair, c in zip(pairs.tolist(), curve, strict=True)}
        self._segments = [self.points[pairs[curve == c]] for c in range(curve.max(initial=-1) + 1)]
        around = np.zeros_like(self.points)
        np.add.at(around, self.faces.ravel(), np.repeat(vectors, 3, axis=0))
        self.around = around / np.maximum(np.linalg.norm(around, axis=1), 1e-300)[:, None]
        panels = self.points[self.faces[:, [0, 1, 2, 2]]]
        self._parts = surface.split(panels, side)[:, :3]  # none that reaches far from its centre
        vectors = surface.area_vectors(self._parts)
        self._facing = vectors / np.linalg.norm(vectors, axis=1)[:, None]
        self._centres = self._parts.mean(axis=1)
        self._reach = np.linalg.norm(self._parts - self._centres[:, None], axis=2).max(axis=1)

    def _sharp(self) -> np.ndarray:
        """Edges (n, 2) of one face, or of two at an angle."""
        sides = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        pairs, place, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        total = np.zeros((len(pairs), 3))
        np.add.at(total, place, np.repeat(self.normals, 3, axis=0))
        # |n + m|² = 2 + 2 n·m
        return pairs[(count != 2) | (np.sum(total**2, axis=1) < 2 + 2 * SHARP)]

    def _ranks(self, pairs: np.ndarray) -> np.ndarray:
        """Of each point: free, on an edge, or at a corner, where edges end, meet or turn."""
        degree = np.bincount(pairs.ravel(), minlength=len(self.points))
        along = self.points[pairs[:, 1]] - self.points[pairs[:, 0]]
        along /= np.linalg.norm(along, axis=1)[:, None]
        total = np.zeros_like(self.points)
        for end, sign in ((0, 1), (1, -1)):
            np.add.at(total, pairs[:, end], sign * along)
        # |a + b|² = 2 + 2 a·b of the two directions away from the point, a = -b where it is straight
        turned = np.sum(total**2, axis=1) > 2 - 2 * CORNER
        return np.where(degree == 0, FREE, np.where((degree == 2) & ~turned, ON_EDGE, AT_CORNER))

    def nearest(self, points: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The points (n, 3) nearest to others on what faces the same way as normals (n, 3), and the normals there."""
        places, there = np.empty_like(points), np.empty_like(points)
        step = max(1, surface.PAIRS // len(self._centres))
        for part in (slice(n, n + step) for n in range(0, len(points), step)):
            far = scipy.spatial.distance.cdist(points[part], self._centres)
            away = normals[part] @ self._facing.T <= 0
            far[away & ~away.all(axis=1, keepdims=True)] = np.inf
            near = _on_triangles(points[part], self._parts[np.argmin(far + self._reach, axis=1)])
            bound = np.linalg.norm(near - points[part], axis=1)[:, None] * (1 + 1e-9)
            which, face = np.nonzero((far - self._reach <= bound) & np.isfinite(far))
            place = _on_triangles(points[part][which], self._parts[face])
            order = np.lexsort((np.linalg.norm(place - points[part][which], axis=1), which))
            best = order[np.unique(which[order], return_index=True)[1]]
            places[part], there[part] = place[best], self._facing[face[best]]
        return places, there

    def on_curve(self, near: Point, curve: int) -> Point:
        """The nearest point of a curve."""
        start, end = np.moveaxis(self._segments[curve], 1, 0)
        along = end - start
        way = np.clip(np.sum((near - start) * along, axis=1) / np.sum(along**2, axis=1), 0, 1)
        place = start + way[:, None] * along
        return point(place[np.argmin(np.sum((place - near) ** 2, axis=1))])


def _conforming(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (np, 3) and triangles (n, 3) that meet along whole sides, of faces (nf, 4) that may along parts of them.

    One on whose sides corners of others lie becomes several about its middle.
    """
    more, pairs, owner = mending.hanging(points, faces)
    middle = len(points) - 1 + np.cumsum(more)
    parts = np.column_stack([pairs, middle[owner]])[more[owner]]
    points = np.concatenate([points, points[faces[more, :3]].mean(axis=1)])
    return points, np.concatenate([faces[~more, :3], parts])


def _on_triangles(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The point (n, 3) of each triangle (n, 3, 3) that is nearest to one of points (n, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    u, v, w = b - a, c - a, points - a
    uu, uv, vv, wu, wv = (np.sum(x * y, axis=1) for x, y in ((u, u), (u, v), (v, v), (w, u), (w, v)))
    area = np.maximum(uu * vv - uv**2, 1e-300)
    s, t = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    best = a + s[:, None] * u + t[:, None] * v
    outside = (s < 0) | (t < 0) | (s + t > 1)
    gap = np.where(outside, np.inf, 0.0)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        way = np.clip(np.sum((points - start) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-300), 0, 1)
        place = start + way[:, None] * along
        off = np.linalg.norm(place - points, axis=1)
        nearer = off < gap
        best[nearer], gap[nearer] = place[nearer], off[nearer]
    return best
