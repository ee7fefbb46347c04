"""Shells: the surfaces of one mesh that share no edge. What two of them enclose displaces its water once.

Shells beside each other may touch, wall on wall, and so may one within another. For the test both are shrunk by a
hair, the smaller one by more: what cuts still does, what touches from outside or from within no longer.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # spatial is slow to import, and only meshes need it

from solver.errors import InputError
from solver.hydrodynamics.hull import mending, surface

LARGER, SMALLER = 1 * surface.WELD, 10 * surface.WELD  # of the extent: hairs; the faces at a corner go less far than it
FEW = 2**14  # pairs of boxes that are compared one by one
OPPOSED = -0.999999  # cosine of the normals of faces that lie on each other, at most
ALIKE = 3e-3  # of normals and, in extents, distances from the origin: planes that may be one
EDGE = 1e-9  # of a triangle: as far beyond its sides is on it


@dataclass(frozen=True, eq=False)
class Shell:
    """Triangles (n, 3) of vertices (nv, 3) [m] with normals outwards."""

    vertices: np.ndarray
    corners: np.ndarray

    @classmethod
    def of(cls, panels: np.ndarray) -> "Shell":
        """Of panels (n, 4, 3) [m]."""
        vertices, faces = mending.triangulated(panels)
        return cls(vertices, faces[:, :3])

    @cached_property
    def box(self) -> np.ndarray:
        """Corners (2, 3) [m] of the box about it."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def normals(self) -> np.ndarray:
        """At its vertices (nv, 3), of the triangles about each by their angles there: however a plane is cut."""
        corners = self.vertices[self.corners]
        ahead, back = (np.roll(corners, -k, axis=1) - corners for k in (1, 2))
        cross = np.cross(ahead, back)
        area = np.linalg.norm(cross, axis=2)
        angle = np.arctan2(area, np.sum(ahead * back, axis=2))
        total = np.zeros_like(self.vertices)
        np.add.at(total, self.corners, angle[..., None] * cross / area[..., None])
        return total / np.maximum(np.linalg.norm(total, axis=1), 1e-300)[:, None]

    def shrunk(self, by: float) -> np.ndarray:
        """Its triangles (n, 3, 3), each corner `by` [m] inwards."""
        return (self.vertices - by * self.normals)[self.corners]


def within(panels: np.ndarray, part: np.ndarray, closed: bool, key: str, name: str) -> np.ndarray:
    """Which panels (n, 4, 3), with normals outwards, are of a shell within another; `part`: the shell (n,) of each.

    Those of a mesh that is not closed count below still water, which closes them. Shells that cut are refused.
    """
    inner = np.zeros(len(panels), bool)
    if part.max() == 0:
        return inner
    hair = np.ptp(panels.reshape(-1, 3), axis=0).max()
    pieces = [panels[part == n] if closed else surface.below(panels[part == n]) for n in range(part.max() + 1)]
    outer: list[Shell] = []
    for n in sorted((n for n, p in enumerate(pieces) if len(p)), key=lambda n: -surface.volume(pieces[n])):
        shell = Shell.of(pieces[n])
        near = [o for o in outer if np.all((o.box[0] < shell.box[1]) & (shell.box[0] < o.box[1]))]
        for other in near:
            small, large = shell.shrunk(SMALLER * hair), other.shrunk(LARGER * hair)
            if len(cut := np.concatenate([_pierced(small, large), _pierced(large, small)])):
                where = f"near {surface.point_text(cut[0])}"
                raise InputError(key, name, f"has surfaces that cut each other {where}: one around both is needed")
            # Still water as a lid is less than half of all that is seen from below it.
            if surface.turns_round(large[:, [0, 1, 2, 2]], small[:1].mean(axis=1))[0] > 0.5:
                inner |= part == n
                break
        else:
            outer.append(shell)
    return inner


def walls(panels: np.ndarray) -> list[str]:
    """A note where panels (n, 4, 3) lie face to face below still water, on parts of each other.

    Those of the same corners are left out, see mending.once.
    """
    extent, triangles = np.ptp(panels.reshape(-1, 3), axis=0).max(), surface.triangles(surface.below(panels))
    normals = 2 * surface.area_vectors(triangles)
    area = np.linalg.norm(normals, axis=1)
    some = area > (SMALLER * extent) ** 2
    triangles, normals = triangles[some], normals[some] / area[some, None]
    planes = np.column_stack([normals, np.sum(normals * triangles.mean(axis=1), axis=1) / extent])
    opposed = np.isfinite(scipy.spatial.cKDTree(planes).query(-planes, distance_upper_bound=ALIKE)[0])
    meeting = _meeting(triangles[opposed], normals[opposed], SMALLER * extent) if opposed.any() else np.zeros((0, 3))
    if not len(meeting):
        return []
    where = surface.point_text(meeting[0])
    differ = "on panels that differ: no water is between them, but linear forces have such a wall"
    return [f"surfaces lie face to face near {where}, {differ}; unite them, or give both the same panels there"]


def _meeting(triangles: np.ndarray, normals: np.ndarray, hair: float) -> np.ndarray:
    """Middles (n, 3) of triangles (n, 3, 3) that overlap opposed ones in one plane."""
    i, j = _close(triangles, triangles, hair).T
    off = np.abs(np.einsum("nkd,nd->nk", triangles[j] - triangles[i, :1], normals[i])).max(axis=1)
    flat = (np.sum(normals[i] * normals[j], axis=1) < OPPOSED) & (off < hair)
    i, j = i[flat], j[flat]
    pair = triangles[i], triangles[j]
    apart = np.zeros(len(i), bool)
    for triangle in pair:
        for k in range(3):
            axis = np.cross(normals[i], triangle[:, (k + 1) % 3] - triangle[:, k])
            axis /= np.maximum(np.linalg.norm(axis, axis=1), 1e-300)[:, None]
            x, y = (np.einsum("nkd,nd->nk", t, axis) for t in pair)
            apart |= np.minimum(x.max(axis=1), y.max(axis=1)) - np.maximum(x.min(axis=1), y.min(axis=1)) < hair
    return np.asarray(triangles[i[~apart]].mean(axis=1))


def _pierced(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Where (n, 3) sides of triangles (n, 3, 3) go through those of another surface."""
    sides = np.concatenate([one[:, [k, (k + 1) % 3]] for k in range(3)])
    line, face = _close(sides, other).T
    start, along = sides[line, 0], sides[line, 1] - sides[line, 0]
    a, (u, v) = other[face, 0], (other[face, k] - other[face, 0] for k in (1, 2))
    normal = np.cross(u, v)
    from_, to = np.sum((start - a) * normal, axis=1), np.sum((start + along - a) * normal, axis=1)
    through = from_ * to < 0
    start, along, a, u, v, normal, from_, to = (x[through] for x in (start, along, a, u, v, normal, from_, to))
    at = start + (from_ / (from_ - to))[:, None] * along
    square = np.sum(normal**2, axis=1)
    s = np.sum(np.cross(at - a, v) * normal, axis=1) / square
    t = np.sum(np.cross(u, at - a) * normal, axis=1) / square
    return at[(s > -EDGE) & (t > -EDGE) & (s + t < 1 + EDGE)]


def _close(one: np.ndarray, other: np.ndarray, hair: float = 0.0) -> np.ndarray:
    """Pairs (n, 2) of figures (n, corners, 3) whose boxes meet within a hair [m]: sets are halved until few pairs are
    left to compare.
    """
    low, high = one.min(axis=1) - hair, one.max(axis=1) + hair
    other_low, other_high = other.min(axis=1), other.max(axis=1)
    pairs, left = [np.zeros((0, 2), int)], [(np.arange(len(one)), np.arange(len(other)))]
    while left:
        i, j = left.pop()
        i = i[np.all((low[i] <= other_high[j].max(axis=0)) & (high[i] >= other_low[j].min(axis=0)), axis=1)]
        if not len(i):
            continue
        j = j[np.all((other_low[j] <= high[i].max(axis=0)) & (other_high[j] >= low[i].min(axis=0)), axis=1)]
        if len(i) * len(j) <= FEW:
            meet = (low[i, None] <= other_high[j]) & (high[i, None] >= other_low[j])
            a, b = np.nonzero(meet.all(axis=2))
            pairs.append(np.column_stack([i[a], j[b]]))
        elif len(i) >= len(j):
            left += [(half, j) for half in _halves(i, low + high)]
        else:
            left += [(i, half) for half in _halves(j, other_low + other_high)]
    return np.concatenate(pairs)


def _halves(some: np.ndarray, places: np.ndarray) -> list[np.ndarray]:
    """Two halves of them, apart along the axis that they reach farthest along."""
    ordered = some[np.argsort(places[some, np.argmax(np.ptp(places[some], axis=0))])]
    return np.array_split(ordered, 2)
