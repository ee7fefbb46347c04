"""Dense meshes in fewer panels, for the boundary elements alone.

Sides are cut, collapsed and flipped, and corners moved on the hull, until all are about as long as each other (Botsch
and Kobbelt 2004, A remeshing approach to multiresolution modeling). Corners stay; sharp edges, the waterline and the
planes of symmetry keep their curves.
"""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from math import sqrt

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import halved_count, indexed
from solver.hydrodynamics.hull.original import AT_CORNER, FREE, ON_EDGE, Original, Point, key, point
from solver.hydrodynamics.hull.panel_hull import PanelHull

TRIANGLES = 2  # for each panel asked for: with sides as long as quadrilaterals have
SHORT, LONG = 0.8, 4 / 3  # of the side aimed at: what is shorter collapses, what is longer is cut, if that does well
LEAN, TURN = 0.5, 0.7  # cosines: of a panel's normal to the hull's at its corners, and to what it was, at least
PASSES = 12
LEVEL = 0.1  # of the largest: lesser squares of normals about a corner tell nothing of how it moves

Triangle = tuple[int, int, int]


def fewer(hull: PanelHull, count: int, divided: int) -> PanelHull:
    """A mesh of more panels than one made for about `count` needs as that, to be divided; any other as it is.

    So is one with holes, which others close, and one whose edges and corners leave no fewer panels.
    """
    if len(hull.holes) or not dense(hull, count):
        return hull
    made = coarse(hull, TRIANGLES * (count // divided**2))
    return made if divided**2 * len(made.wetted) < halved_count(hull, count) else hull


def dense(hull: PanelHull, count: int) -> bool:
    """Whether a mesh has more panels than one made for about `count` needs."""
    return halved_count(hull, count) > TRIANGLES * count


@lru_cache(maxsize=16)
def coarse(hull: PanelHull, count: int) -> PanelHull:
    """The wetted part of a hull in `count` triangles or a few more; its `finer` panels have their corners on the hull.

    Symmetric where the hull is. What folds or tears is made without symmetry, and if that does, too, the hull stays.
    """
    own = tuple(axis for axis in (0, 1) if hull.symmetry[axis])
    for planes in dict.fromkeys((own, ())):
        with suppress(InputError, np.linalg.LinAlgError):  # of panels that are not the file's
            made = _coarse(hull, count, planes)
            if not len(made.holes):
                return made
    return hull


def _coarse(hull: PanelHull, count: int, planes: tuple[int, ...]) -> PanelHull:
    """The same, symmetric in x = 0 or y = 0 for 0 or 1 in `planes`."""
    longest = min(sqrt(4 / sqrt(3) * hull.wetted_area / count), hull.waterplane_width / 2)
    original = Original(_part(hull, planes), longest)
    net = _Net(original)
    _remesh(net, longest, count / 2 ** len(planes))
    base, finer = (_as_large(*mesh, original, planes) for mesh in (net.mesh(), net.quartered()))
    for axis in planes:
        sign = np.where(np.arange(3) == axis, -1.0, 1.0)
        base, finer = (np.concatenate([p, (p * sign)[:, [0, 2, 1, 1]]]) for p in (base, finer))
    return replace(PanelHull.of(*indexed(base), name=hull.name), finer=finer)


def _part(hull: PanelHull, planes: tuple[int, ...]) -> np.ndarray:
    """Panels (n, 4, 3) [m] below still water, on one side of planes of symmetry."""
    pieces = hull.wetted
    for axis in planes:
        pieces = surface.below(pieces, axis, sign=-1)
    return pieces


def _remesh(net: "_Net", longest: float, count: float) -> None:
    """Sides of a length at which there are `count` triangles or a few more, little above `longest` [m] at most."""
    side = longest
    for done in range(1, 4 * PASSES):
        net.collapse(side)
        net.cut(side)
        net.flip()
        net.relax()
        if done >= PASSES and len(net.faces) >= count:
            break
        if len(net.faces) < count or done < PASSES // 2:
            side = min(LONG * longest, side * sqrt(len(net.faces) / count) * (0.99 if len(net.faces) < count else 1.0))


def _as_large(points: np.ndarray, faces: np.ndarray, original: "Original", planes: tuple[int, ...]) -> np.ndarray:
    """Panels (n, 4, 3) [m] of triangles with their corners on the hull, moved off it until as much lies within.

    Over a triangle on a curved hull the mean distance is 3/4 of that at its middle, δ. Each corner moves by u with
    n·u = 3/4 δ of the triangles about it, in their least squares, but stays in still water and in planes of symmetry.
    """
    corners = points[faces]
    vectors, middles = surface.area_vectors(corners), corners.mean(axis=1)
    areas = np.linalg.norm(vectors, axis=1)
    if not areas.all():
        raise np.linalg.LinAlgError("a triangle without area has no normal")
    normals = vectors / areas[:, None]
    off = 0.75 * np.sum((original.nearest(middles, normals)[0] - middles) * normals, axis=1)
    n = np.where((corners == 0.0) & np.isin(np.arange(3), [*planes, 2]), 0.0, normals[:, None])
    squares, rest = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
    np.add.at(squares, faces, areas[:, None, None, None] * n[..., None] * n[..., None, :])
    np.add.at(rest, faces, (areas * off)[:, None, None] * n)
    moved = points + np.einsum("nij,nj->ni", np.linalg.pinv(squares, rcond=LEVEL, hermitian=True), rest)
    return moved[faces[:, [0, 1, 2, 2]]]


class _Net:
    """Triangles that share corners, and what of their sides lies on curves of the original."""

    def __init__(self, original: Original):
        self.original = original
        self.points = [point(p) for p in original.points]
        self.normals = [point(n) for n in original.around]
        self.rank = original.rank.tolist()
        self.curves = dict(original.curves)
        self.faces: dict[int, Triangle] = {}
        self.around: list[set[int]] = [set() for _ in self.points]
        self._count = 0
        for a, b, c in original.faces.tolist():
            self._add((a, b, c))

    def mesh(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners (nv, 3) [m] and triangles (n, 3)."""
        used, faces = np.unique(list(self.faces.values()), return_inverse=True)
        return np.array(self.points)[used], faces.reshape(-1, 3)

    def quartered(self) -> tuple[np.ndarray, np.ndarray]:
        """Each triangle as four, the middles of their sides moved to the original."""
        points, faces = self.mesh()
        sides = {pair: len(points) + n for n, (_, pair) in enumerate(self._sides())}
        middles = self._middles(set(sides))
        found = []
        for (a, b, c), (u, v, w) in zip(faces.tolist(), self.faces.values(), strict=True):
            ab, bc, ca = sides[key(u, v)], sides[key(v, w)], sides[key(w, u)]
            found += [(a, ab, ca), (ab, b, bc), (bc, c, ca), (ab, bc, ca)]
        return np.concatenate([points, [middles[pair][0] for pair in sides]]), np.array(found)

    def collapse(self, side: float) -> None:
        """Sides shorter than SHORT of `side` [m], the shortest first, where nothing becomes longer than LONG of it."""
        for length, (a, b) in self._sides():
            if length > SHORT * side:
                break
            if b in self._neighbours(a) and self._length(a, b) < SHORT * side:
                gone, kept = (a, b) if self.rank[a] < self.rank[b] else (b, a)
                if not self._collapsed(gone, kept, LONG * side) and self.rank[a] == self.rank[b]:
                    self._collapsed(kept, gone, LONG * side)

    def cut(self, side: float) -> None:
        """Sides longer than LONG of `side` [m], the longest first."""
        while long := [pair for length, pair in self._sides() if length > LONG * side]:
            middles = self._middles(set(long))
            if not sum([self._halved(pair, *middles[pair]) for pair in reversed(long)]):
                break

    def flip(self) -> None:
        """Sides between two triangles, if that makes the worse of them better."""
        for _, (a, b) in self._sides():
            faces = self.around[a] & self.around[b]
            if key(a, b) in self.curves or len(faces) != 2:
                continue
            one, other = faces
            old = [self.faces[one], self.faces[other]]
            c, d = (next(v for v in f if v not in (a, b)) for f in old)
            if d in self._neighbours(c):
                continue
            if not _follows(old[0], a, b):
                c, d = d, c
            new: list[Triangle] = [(a, d, c), (d, b, c)]
            normal = _sum(self._vector(f) for f in old)
            if min(map(self._quality, new)) > min(map(self._quality, old)) and all(self._fits(f, normal) for f in new):
                self._remove(one)
                self._remove(other)
                for f in new:
                    self._add(f)

    def relax(self) -> None:
        """Corners moved to the middle of those about them, and back to the hull."""
        free = [v for v, faces in enumerate(self.around) if faces and self.rank[v] == FREE]
        if free:
            places, normals = self.original.nearest(
                np.array([self._middle(v) for v in free]), np.array([self.normals[v] for v in free])
            )
            for v, place, normal in zip(free, places, normals, strict=True):
                self._move(v, point(place), point(normal))
        for v, faces in enumerate(self.around):
            if faces and self.rank[v] == ON_EDGE:
                a, b = self._along(v)
                middle = _scaled(_sum((self.points[a], self.points[b])), 0.5)
                self._move(v, self.original.on_curve(middle, self.curves[key(v, a)]), self.normals[v])

    def _sides(self) -> list[tuple[float, tuple[int, int]]]:
        """Lengths [m] and ends of all sides, the shortest first."""
        return sorted(
            (self._length(*pair), pair)
            for pair in {key(*pair) for a, b, c in self.faces.values() for pair in ((a, b), (b, c), (c, a))}
        )

    def _middles(self, pairs: set[tuple[int, int]]) -> dict[tuple[int, int], tuple[Point, Point]]:
        """Of sides: the middle, moved to the original, and the normal there."""
        half = {pair: _scaled(_sum(self.points[v] for v in pair), 0.5) for pair in sorted(pairs)}
        normals = {p: _sum(self._vector(self.faces[f]) for f in self.around[p[0]] & self.around[p[1]]) for p in half}
        free = [pair for pair in half if pair not in self.curves]
        found = {p: (self.original.on_curve(half[p], self.curves[p]), normals[p]) for p in half if p in self.curves}
        if free:
            places, there = self.original.nearest(
                np.array([half[p] for p in free]), np.array([normals[p] for p in free])
            )
            found |= {p: (point(x), point(n)) for p, x, n in zip(free, places, there, strict=True)}
        return found

    def _collapsed(self, gone: int, kept: int, longest: float) -> bool:
        """Whether a side could be collapsed into its end `kept`, and was."""
        shared = self.around[gone] & self.around[kept]
        rim = {v for f in shared for v in self.faces[f]} - {gone, kept}
        curve = self.curves.get(key(gone, kept))
        if self.rank[gone] == AT_CORNER or (self.rank[gone] == ON_EDGE and curve is None):
            return False
        if self._neighbours(gone) & self._neighbours(kept) != rim:
            return False
        other = -1
        if self.rank[gone] == ON_EDGE:
            a, b = self._along(gone)
            other = b if a == kept else a
            if other in self._neighbours(kept):
                return False
        new: list[Triangle] = []
        for f in self.around[gone] - shared:
            old = self.faces[f]
            a, b, c = (kept if v == gone else v for v in old)
            if self._longest((a, b, c)) > max(longest, self._longest(old)):
                return False
            if not self._fits((a, b, c), self._vector(old)):
                return False
            new.append((a, b, c))
        for f in list(self.around[gone]):
            self._remove(f)
        for triangle in new:
            self._add(triangle)
        if curve is not None and self.rank[gone] == ON_EDGE:
            del self.curves[key(gone, kept)], self.curves[key(gone, other)]
            self.curves[key(kept, other)] = curve
        return True

    def _halved(self, pair: tuple[int, int], place: Point, normal: Point) -> bool:
        """Whether a side could be cut there, and was."""
        faces, v = self.around[pair[0]] & self.around[pair[1]], len(self.points)
        new: list[tuple[Triangle, Point]] = []
        for f in faces:
            for end in pair:
                x, y, z = (v if w == end else w for w in self.faces[f])
                new.append(((x, y, z), self._vector(self.faces[f])))
        self.points.append(place)
        self.normals.append(_scaled(normal, 1 / max(_norm(normal), 1e-300)))
        self.rank.append(FREE if pair not in self.curves else ON_EDGE)
        self.around.append(set())
        if not all(self._fits(triangle, before) for triangle, before in new):
            for row in (self.points, self.normals, self.rank, self.around):
                row.pop()
            return False
        for f in faces:
            self._remove(f)
        for triangle, _ in new:
            self._add(triangle)
        if pair in self.curves:
            curve = self.curves.pop(pair)
            self.curves |= {key(end, v): curve for end in pair}
        return True

    def _move(self, v: int, place: Point, normal: Point) -> None:
        """A corner and its normal, if all triangles about it stay what they should be."""
        before = [self._vector(self.faces[f]) for f in self.around[v]]
        worst = min(self._quality(self.faces[f]) for f in self.around[v])
        old = self.points[v], self.normals[v]
        self.points[v], self.normals[v] = place, normal
        faces = [self.faces[f] for f in self.around[v]]
        if not all(map(self._fits, faces, before)) or min(map(self._quality, faces)) < worst / 2:
            self.points[v], self.normals[v] = old

    def _middle(self, v: int) -> Point:
        """Of the triangles about a corner, their centroid."""
        total, weight = (0.0, 0.0, 0.0), 0.0
        for f in self.around[v]:
            area = _norm(self._vector(self.faces[f]))
            total = _sum((total, _scaled(_sum(self.points[w] for w in self.faces[f]), area / 3)))
            weight += area
        return _scaled(total, 1 / weight)

    def _along(self, v: int) -> list[int]:
        """The neighbours on the curve of a corner that lies on one."""
        return [w for w in self._neighbours(v) if key(v, w) in self.curves]

    def _neighbours(self, v: int) -> set[int]:
        return {w for f in self.around[v] for w in self.faces[f]} - {v}

    def _fits(self, triangle: Triangle, before: Point) -> bool:
        """Whether a triangle faces as one did `before`, and as the hull does at its free corners."""
        vector = self._vector(triangle)
        size = _norm(vector)
        if size == 0 or _dot(vector, before) < TURN * size * _norm(before):
            return False
        return all(_dot(vector, self.normals[v]) > LEAN * size for v in triangle if self.rank[v] == FREE)

    def _quality(self, triangle: Triangle) -> float:
        """4√3 area over the sum of the squared sides."""
        a, b, c = triangle
        sides = self._length(a, b) ** 2 + self._length(b, c) ** 2 + self._length(c, a) ** 2
        return 2 * sqrt(3) * _norm(self._vector(triangle)) / sides if sides else 0.0

    def _vector(self, triangle: Triangle) -> Point:
        """Twice n dS."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (self.points[v] for v in triangle)
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx

    def _longest(self, triangle: Triangle) -> float:
        a, b, c = triangle
        return max(self._length(a, b), self._length(b, c), self._length(c, a))

    def _length(self, a: int, b: int) -> float:
        (ax, ay, az), (bx, by, bz) = self.points[a], self.points[b]
        return sqrt((ax - bx) ** 2 + (ay - by) ** 2 + (az - bz) ** 2)

    def _add(self, triangle: Triangle) -> None:
        self.faces[self._count] = triangle
        for v in triangle:
            self.around[v].add(self._count)
        self._count += 1

    def _remove(self, face: int) -> None:
        for v in self.faces.pop(face):
            self.around[v].discard(face)


def _follows(triangle: Triangle, a: int, b: int) -> bool:
    """Whether b comes after a."""
    return triangle[(triangle.index(a) + 1) % 3] == b


def _sum(rows: Iterable[Point]) -> Point:
    x, y, z = (sum(part) for part in zip(*rows, strict=True))
    return x, y, z


def _scaled(p: Point, by: float) -> Point:
    return p[0] * by, p[1] * by, p[2] * by


def _dot(p: Point, q: Point) -> float:
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def _norm(p: Point) -> float:
    return sqrt(_dot(p, p))
