"""Plates: parts of a meridian with water on both faces, many times as wide as thick, as a heave plate.

On panels wider than the plate is thick, each face acts on the other almost as on itself, and what moves the water is
the small difference. Panels of the two faces must therefore be each other's images; then that difference is the
lattice of dipoles of a thin plate, and converges evenly.
"""

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.edges import SHARP
from solver.hydrodynamics.hull.revolution import Revolution, Segment

THIN = 0.15  # thickness of a plate over its width, at most: panels of the usual size are as wide as that
ACROSS = 4  # panels from edge to edge before they are divided, at least: the added mass is then within 1 %
OPPOSED = -0.9  # cosine of the faces' normals, at most
NO_CUT = 1e-6  # of a length: an end that is nearer to another needs none
FEW = 3  # short pieces in a row that keep their ends
THINNER = 0.5  # thickness over a panel's side, below which panels of the two faces must be each other's images
ALIKE = 0.1  # of a side: two panels are each other's images if their middles are no further from that
KNOWN = 64


class Piece(NamedTuple):
    """A part of a meridian, and the number of that on the other face of a plate; -1: none."""

    segment: Segment
    twin: int


class Stretch(NamedTuple):
    """A part of a meridian that panels divide as one."""

    length: float  # [m]
    panels: int  # along it, along the outer half of the first


class Plates(NamedTuple):
    """Parts of a hull that are thinner than its panels."""

    share: float  # of the wetted surface
    unlike: float  # side over thickness, on their mean, of panels that have no image on the other face; 0: all have


def of_panels(corners: np.ndarray) -> Plates:
    """Of panels (n, 4, 3): behind those of plates the other face is nearer than THINNER of their side."""
    from scipy.spatial import cKDTree  # asked of meshes alone, and slow to import

    vectors, centres = surface.quad_vectors(corners), corners.mean(axis=1)
    areas = np.linalg.norm(vectors, axis=1)
    sides, normals, tree = np.sqrt(areas), vectors / np.maximum(areas, 1e-300)[:, None], cKDTree(centres)
    thin, unlike = np.zeros(len(corners)), np.zeros(len(corners))
    for n, near in enumerate(tree.query_ball_point(centres, sides)):
        behind = centres[n] - centres[[m for m in near if normals[m] @ normals[n] < OPPOSED]]
        depth = behind @ normals[n]
        behind, depth = (x[(depth > 0) & (depth < THINNER * sides[n])] for x in (behind, depth))
        if depth.size:
            aside = np.linalg.norm(behind - depth[:, None] * normals[n], axis=1)
            thin[n] = areas[n]
            unlike[n] = areas[n] * sides[n] / depth[aside.argmin()] * (aside.min() > ALIKE * sides[n])
    return Plates(float(thin.sum() / areas.sum()), float(unlike.sum() / max(thin.sum(), 1e-300)))


@lru_cache(maxsize=KNOWN)
def pieces(hull: Revolution) -> tuple[Piece, ...]:
    """The wetted meridian, each face of a plate cut opposite the ends of the other."""
    whole, cut = hull.wetted(), []
    for n, face in enumerate(whole):
        others = [other for other in whole[:n] + whole[n + 1 :] if _is_plate(face, other)]
        ends = np.sort([end for other in others for end in _shares(face, other)])
        inner = [end for end in ends if NO_CUT < end < 1 - NO_CUT]
        cut += _parts(face, inner) if inner else [face]
    twins = [[n for n, other in enumerate(cut) if other is not face and _is_plate(face, other)] for face in cut]
    return tuple(Piece(face, twin[0] if twin else -1) for face, twin in zip(cut, twins, strict=True))


def stretches(hull: Revolution, size: float) -> list[Stretch]:
    """What panels of about `size` [m] divide as one: pieces by themselves, but where these are many and short.

    Two panels at least along each would go by how many points a line is drawn through. Of short pieces in a row that
    turn by less than SHARP, more than panels that their length asks for, the ends are therefore no panels' corners.
    """
    whole, found = pieces(hull), []
    count = [max(2, round(face.length / size)) for face, _ in whole]
    for row in _rows(whole, size):
        length = sum(whole[n].segment.length for n in row)
        asked = max(2, round(length / size))
        if len(row) > max(FEW, asked):
            found.append(Stretch(length, asked))
            continue
        for n in row:
            twin = whole[n].twin
            along = count[n] if twin < 1 else max(ACROSS, count[n], count[twin])
            found.append(Stretch(whole[n].segment.length, along))
    return [Stretch(found[0].length, max(1, round(found[0].length / 2 / size))), *found[1:]]


def _rows(whole: tuple[Piece, ...], size: float) -> list[list[int]]:
    """Numbers of pieces in a row that meet smoothly and are each too short for two panels; of others alone."""
    short = [twin < 0 and round(face.length / size) < 2 for face, twin in whole]
    rows = [[0]]
    for n, (before, after) in enumerate(pairwise(whole), 1):
        turn = before.segment.normal(1.0) @ after.segment.normal(0.0)
        if short[n - 1] and short[n] and turn > np.cos(SHARP):
            rows[-1].append(n)
        else:
            rows.append([n])
    return rows


def _is_plate(face: Segment, other: Segment) -> bool:
    """Whether straight lines are the faces of a plate: opposed, one behind the other, and near for their width."""
    if face.centre is not None or other.centre is not None or face.normal(0.5) @ other.normal(0.5) > OPPOSED:
        return False
    low, high = np.clip(np.sort(_shares(face, other)), 0, 1)
    middle = face.at((low + high) / 2)
    opposite = other.at(np.clip(_share(other, middle), 0, 1))
    return bool(0 < (middle - opposite) @ face.normal(0.5) < THIN * (high - low) * face.length)


def _shares(face: Segment, other: Segment) -> list[float]:
    """Where the ends of another line lie along a line, as shares of its length."""
    return [_share(face, np.array(end)) for end in (other.start, other.end)]


def _share(face: Segment, point: np.ndarray) -> float:
    along = np.subtract(face.end, face.start)
    return float((point - face.start) @ along / (along @ along))


def _parts(face: Segment, inner: list[float]) -> list[Segment]:
    """A line cut at shares of its length."""
    ends = [face.start, *(tuple(face.at(share).tolist()) for share in inner), face.end]
    return [Segment(start=a, end=b) for a, b in zip(ends[:-1], ends[1:], strict=True)]
