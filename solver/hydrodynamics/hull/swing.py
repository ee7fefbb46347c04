"""Whether floats on joints of one axis meet as they turn or slide: between end stops, or as far as a run took them."""

from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy  # spatial is slow to import, and few scenes have hinged floats so near

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull

STEP = 0.1  # between the angles of a stroke that are looked at, besides its ends [rad]
SLID, FAR = (8, 100), 50.0  # places on the way of what slides, at least and at most; sizes of its hull that it goes
FINE = 100  # shares of its hull's size that this way's ends are told to
AROUND = 24  # panels round a hull of revolution
ALONG = 6  # and along each segment of its meridian
ACROSS = 12  # points across the smaller hull
NEAREST = 4  # triangles near a point, of which one faces away from it where the hull holds it
INSIDE = 0.6  # turns round a point inside another hull, or below the waterplane of one that is open; 1/2 on it

Vector = tuple[float, ...]
Stroke = tuple[float, float]


class Jointed(NamedTuple):
    """A hull and the one axis of its joint."""

    hull: Hull
    hinge: Vector  # (3,) [m]
    arm: Vector  # (3,) [m], from there to the reference point at rest
    axis: Vector  # (3,) unit vector
    slides: bool = False  # along it, in place of turning about it


@lru_cache(maxsize=256)
def meeting(a: Jointed, b: Jointed, strokes: tuple[Stroke, Stroke]) -> tuple[float, float] | None:
    """Positions of both [rad or m] in their strokes at which the hulls meet, the least of those looked at.

    None where hulls meet at rest, which may be meant so, or where no point can come as far as they are apart.
    """
    way = sum(max(abs(low), abs(high)) * _reach(item) for item, (low, high) in zip((a, b), strokes, strict=True))
    if way <= _clear(_box(a, 0.0), _box(b, 0.0)) or way <= _gap(a, b):
        return None
    least = max(min(_sides(a.hull).min(), _sides(b.hull).min()), _size(a.hull, b.hull))
    first, second = (_places(item, stroke, least) for item, stroke in zip((a, b), strokes, strict=True))
    poses = sorted(product(first, second), key=lambda pose: max(abs(pose[0]), abs(pose[1])))
    at = next((pose for pose in poses if _overlap(a, b, pose)), None)
    return at if at is not None and any(at) else None


def inside(item: Jointed, low: float, high: float) -> Stroke:
    """A stroke to whole steps, so that much the same ones are looked at once; half a turn each way is all there is."""
    step, most = (_sides(item.hull).max() / FINE, np.inf) if item.slides else (STEP, np.pi)
    low, high = (float(np.trunc(np.clip(end, -most, most) / step)) for end in (low, high))
    return step * low, step * high


def _places(item: Jointed, stroke: Stroke, least: float) -> set[float]:
    """In a stroke [rad or m]; angles are those that others look at, too, the same numbers, and places no more than the
    `least` apart that hulls are wide.
    """
    if item.slides:
        far = FAR * _sides(item.hull).max()
        low, high = np.clip(stroke, -far, far).tolist()
        count = int(np.clip((high - low) / least + 2, *SLID))
        return {0.0, *np.linspace(low, high, count).tolist()}
    low, high = (int(np.trunc(end / STEP)) for end in stroke)
    return {0.0, *stroke, *(STEP * n for n in range(low, high + 1))}


@lru_cache(maxsize=64)
def _reach(item: Jointed) -> float:
    """Distance of the hull's farthest point from the hinge [m], which no point's way exceeds for an angle of one; of
    what slides 1."""
    if item.slides:
        return 1.0
    return float(np.linalg.norm(_panels(item.hull) + np.array(item.arm), axis=-1).max())


@lru_cache(maxsize=256)
def _gap(a: Jointed, b: Jointed) -> float:
    """Distance of the hulls at rest [m], at least; 0 where that is less than what lies between the points on them."""
    size = _size(a.hull, b.hull)
    points, others = (_points(item.hull, size) + np.add(item.hinge, item.arm) for item in (a, b))
    return max(0.0, float(scipy.spatial.cKDTree(points).query(others)[0].min()) - size)


def _clear(box: np.ndarray, other: np.ndarray) -> float:
    """Distance of two boxes [m], which the hulls in them exceed; most floats are told apart by that alone."""
    return float(np.linalg.norm(np.maximum(0.0, np.maximum(box[0] - other[1], other[0] - box[1]))))


@lru_cache(maxsize=4096)
def _box(item: Jointed, angle: float) -> np.ndarray:
    """Corners (2, 3) [m] of the box about a hull turned by an angle, or shifted by as much."""
    points = _posed(item, _panels(item.hull), angle).reshape(-1, 3)
    return np.stack([points.min(axis=0), points.max(axis=0)])


@lru_cache(maxsize=4096)
def _overlap(a: Jointed, b: Jointed, pose: tuple[float, float]) -> bool:
    """Whether a point of one hull is inside the other."""
    box, other_box = _box(a, pose[0]), _box(b, pose[1])
    if np.any(box[0] >= other_box[1]) or np.any(other_box[0] >= box[1]):
        return False
    size = _size(a.hull, b.hull)
    for one, other, (angle, of_other) in ((a, b, pose), (b, a, pose[::-1])):
        points = _unposed(one, _posed(other, _points(other.hull, size), of_other), angle)
        inside = points[_behind(one.hull, points, size)]
        if len(inside) and np.any(surface.turns_round(_panels(one.hull), inside) > INSIDE):
            return True
    return False


def _behind(hull: Hull, points: np.ndarray, size: float) -> np.ndarray:
    """Which points (n, 3) are near a hull and behind any of the triangles nearest to them, as all are that it holds
    where another cuts it: to count turns round others takes most of the time."""
    tree, normals = _surface(hull, size)
    apart, nearest = tree.query(points, NEAREST, distance_upper_bound=2 * size)
    known = apart < np.inf
    nearest = np.where(known, nearest, 0)
    return np.any(
        known & (np.einsum("nki,nki->nk", points[:, None] - tree.data[nearest], normals[nearest]) <= 0), axis=1
    )


@lru_cache(maxsize=64)
def _surface(hull: Hull, size: float) -> tuple["scipy.spatial.cKDTree", np.ndarray]:
    """Middles of its triangles, and normals (n, 3) there."""
    triangles = _triangles(hull, size)
    return scipy.spatial.cKDTree(triangles.mean(axis=1)), surface.area_vectors(triangles)


def _posed(item: Jointed, points: np.ndarray, angle: float) -> np.ndarray:
    """Points (…, 3) [m] of a hull, turned by an angle about its hinge: by Rodrigues' formula; or shifted by as much."""
    axis, lever = np.array(item.axis), points + np.array(item.arm)
    if item.slides:
        return lever + angle * axis + np.array(item.hinge)
    along = (lever @ axis)[..., None] * axis
    turned = along + np.cos(angle) * (lever - along) + np.sin(angle) * np.cross(axis, lever)
    return turned + np.array(item.hinge)


def _unposed(item: Jointed, points: np.ndarray, angle: float) -> np.ndarray:
    """Points (…, 3) [m] from the reference point of a hull that is turned by an angle, or shifted by as much."""
    hinge, arm = np.array(item.hinge), np.array(item.arm)
    if item.slides:
        return points - angle * np.array(item.axis) - hinge - arm
    back = item._replace(hinge=(0.0, 0.0, 0.0), arm=(0.0, 0.0, 0.0))
    return _posed(back, points - hinge, -angle) - arm


def _size(*hulls: Hull) -> float:
    return min(_sides(hull).max() for hull in hulls) / ACROSS


@lru_cache(maxsize=64)
def _sides(hull: Hull) -> np.ndarray:
    """Its lengths (3,) [m] along x, y and z."""
    return np.asarray(np.ptp(_panels(hull).reshape(-1, 3), axis=0))


@lru_cache(maxsize=64)
def _points(hull: Hull, size: float) -> np.ndarray:
    """Middles and corners (n, 3) [m] of its triangles."""
    triangles = _triangles(hull, size)
    return np.concatenate([triangles.mean(axis=1), np.unique(triangles.reshape(-1, 3), axis=0)])


@lru_cache(maxsize=64)
def _triangles(hull: Hull, size: float) -> np.ndarray:
    """(n, 3, 3) [m] of its panels, split until no side is longer than `size` [m]."""
    return np.asarray(surface.split(surface.triangles(_panels(hull))[:, [0, 1, 2, 2]], size)[:, :3])


@lru_cache(maxsize=64)
def _panels(hull: Hull) -> np.ndarray:
    """Panels (n, 4, 3) [m] of the whole hull, below and above still water, normals outwards."""
    if isinstance(hull, PanelHull):
        return hull.panels
    rings = [s.at(np.arange(ALONG) / ALONG) for s in hull.meridian]
    r, z = np.concatenate([*rings, [hull.meridian[-1].end]]).T
    at = r[:, None] * np.exp(2j * np.pi * np.arange(AROUND + 1) / AROUND)
    points = np.stack([at.real, at.imag, np.broadcast_to(z[:, None], at.shape)], axis=-1)
    return np.stack([points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]], axis=2).reshape(-1, 4, 3)
