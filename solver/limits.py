"""Bounds on every coordinate, within which a scene's model holds, and the message of a run that passes one."""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from solver import motions
from solver.mooring import line_stiffness
from solver.multibody.bodies import Bodies
from solver.multibody.way import ways as ways_of
from solver.scene import DOFS, FALLEN_OVER, Float, Platform, Scene, falls_at, poses, turning_bounds, uprights
from solver.sea.field import WaveField

# Of the sum of amplitudes, by which the local wave field may be off at the ends of the excursion; a record's
# `field_error` says how far off it was.
ROUGH = 1e-2

ROUNDING = 1e-12  # of a heading along an axis across it
DEEP = 100.0  # of 2kh: water is as deep as any
THIN = 4  # samples of a run of which one tells how far floats get
BINS = 400  # of how far that is
AWAY = 0.1  # of its hull's size, that a float rests beside where it is given: the waves' series is about there


class Rest(NamedTuple):
    """What the waves' series are about, of floats that rest away from where they are given; the others' is that."""

    places: tuple[tuple[float, ...], ...]  # (nb, 3) in still water [m]
    joints: tuple[float, ...]  # (nj,) that bring them there [m or rad]


def given(scene: Scene) -> Rest:
    """Of floats that all rest where they are given."""
    places = tuple(tuple(map(float, f.centre)) for f in scene.floats)
    return Rest(places, (0.0,) * sum(len(f.motion) for f in scene.floats))


def rest(scene: Scene, joints: np.ndarray) -> Rest:
    """Of floats that rest with joints (nj,) where these are."""
    places, levels, first = [], [], 0
    each = zip(scene.floats, poses(scene.floats, scene.carriers, joints), radii(scene), scene.nonlinear, strict=True)
    for item, (_, place), size, nonlinear in each:
        at = joints[first : (first := first + len(item.motion))]
        away = nonlinear and np.linalg.norm((place - item.centre)[:2]) > AWAY * size
        up = np.array([place[2] * (axis == "heave") for axis in item.motion])
        places.append((float(place[0]), float(place[1]), 0.0) if away else tuple(map(float, item.centre)))
        levels.extend((at - up if away else 0 * at).tolist())
    return Rest(tuple(places), tuple(levels))


def excursions(
    scene: Scene, field: WaveField, terms: Sequence[int], carrier_axes: np.ndarray, about: Rest | None = None
) -> np.ndarray:
    """Least and largest value (nz, 2) [m or rad] of each coordinate, carriers first; terms: of the wave fields, about
    where floats are given unless otherwise said."""
    rows: list[float] = []
    if scene.platform is not None:
        size = _extent(scene.platform)
        rows = [FALLEN_OVER if d >= 3 else size for d in carrier_axes] * len(scene.floats)
    bounds = [(-row, row) for row in rows]
    far, middles = ways(scene, field, terms), iter((about or given(scene)).joints)
    for item, away, way in zip(scene.floats, slidings(scene, field, far), far, strict=True):
        for name, middle in zip(item.motion, middles, strict=False):
            least, most = (middle - away, middle + away) if slides(name) else _turnable(scene, item, name, way, middle)
            low, high = (-np.inf, np.inf) if slides(name) else turning_bounds(item, name)
            bounds.append((max(low, least), min(high, most)))
    return np.array(bounds, float).reshape(-1, 2)


def _turnable(scene: Scene, item: Float, name: str, way: float, middle: float) -> tuple[float, float]:
    """Between what a float may turn about an axis by which it does not fall over [rad].

    Half a turn where pressure is linear and other axes tilt floats, or where a mooring 6 x 6 holds it beside other
    axes that turn: these go by the vector of the rotation, which is none for more. Else, beyond a right angle, until
    that takes it `way` [m] off, out of its local wave field about where it rests turned to the `middle`.
    """
    axis = item.direction(name)
    if np.isfinite(falls_at(axis)):
        return -np.inf, np.inf
    if item.moored_at_a_point and item.turns.sum() > 1:
        return -np.pi, np.pi
    if np.isinf(way):
        tilts = any(np.any(f.directions[f.turns, :2]) for f in scene.floats)
        most = np.pi if tilts and not all(scene.nonlinear) else np.inf
        return -most, most
    across = 2 * float(np.linalg.norm(np.cross(axis, item.arm)))
    most = np.inf if across <= way else max(FALLEN_OVER, 2 * float(np.arcsin(way / across)))
    return middle - most, middle + most


def ways(scene: Scene, field: WaveField, terms: Sequence[int]) -> list[float]:
    """How far each float may go from rest in its local wave field [m], which is for pressure at the instantaneous
    place; linear loads are those at rest, however far."""
    each = zip(terms, radii(scene), scene.nonlinear, strict=True)
    return [field.radius_for(count, ROUGH) - size if nonlinear else np.inf for count, size, nonlinear in each]


def slidings(scene: Scene, field: WaveField, away: Sequence[float]) -> list[float]:
    """How far each float may slide on each axis [m], so that all of them take it no further along the waves."""
    return [way / max(1.0, ahead(f, field.direction).sum()) for f, way in zip(scene.floats, away, strict=True)]


def ahead(item: Float, heading: np.ndarray) -> np.ndarray:
    """How far each axis of a joint that slides on the level takes it along the waves (nj,), of what it slides by."""
    return np.array([abs(item.direction(axis) @ heading) * (axis in DOFS[:2]) for axis in item.motion])


def pushed(scene: Scene, field: WaveField) -> list[dict[str, float]]:
    """How far waves may push each float along each horizontal axis of its joint [m]; inf where nothing holds it.

    They push at most as on a wall as wide as it and all that it carries which sends all of them back, by
    ½ρga² (1 + 2kh/sinh 2kh) each per width. Each axis has its own springs alone.
    """
    wide = [0.0] * len(scene.floats)
    for b, item in enumerate(scene.floats):
        for bearer in scene.bearers(b):
            wide[bearer] += 2 * item.hull.largest_radius
    deep = np.minimum(2 * field.k * field.depth, DEEP)
    powers = 0.5 * np.abs(field.sea.amplitude) ** 2 * (1 + deep / np.sinh(deep))
    load = scene.water.density * scene.water.gravity * float(powers.sum())
    return [_pushed(f, load * w, field.direction) if load > 0 else {} for f, w in zip(scene.floats, wide, strict=True)]


def pushed_along(scene: Scene, field: WaveField) -> list[float]:
    """How far that is along the waves (nb,) [m], all axes together."""
    return [
        sum(share * far.get(axis, 0.0) for axis, share in zip(f.motion, ahead(f, field.direction), strict=True))
        for f, far in zip(scene.floats, pushed(scene, field), strict=True)
    ]


def _pushed(item: Float, load: float, heading: np.ndarray) -> dict[str, float]:
    if not set(item.motion) & set(DOFS[:2]):
        return {}
    held = springs(item)
    far = {}
    for axis, spring, share in zip(item.motion, held, ahead(item, heading), strict=True):
        push = load * share
        if push > ROUNDING * load:
            far[axis] = push / spring if spring > 0 else np.inf
    return far


def springs(item: Float) -> np.ndarray:
    """Stiffness of each axis of a joint (nj,), its moorings' with it."""
    lines = np.diag(line_stiffness(item.lines, item.centre))
    own = np.diag(item.moored[0]) + item.per_axis("stiffness") + item.per_axis("pto_stiffness")
    return own + [lines[DOFS.index(axis)] if slides(axis) else 0.0 for axis in item.motion]


def _extent(platform: Platform) -> float:
    """Diagonal of the frame's nodes [m]: displaced by as much, it is no small displacement of a frame."""
    xyz = np.array(list(platform.frame.nodes.values()))
    return float(np.linalg.norm(np.ptp(xyz, axis=0)))


def sight(flat: bool) -> np.ndarray:
    """Factors (3,) of a way in the waves: y counts for nothing where a float does not leave its plane."""
    return np.array([1.0, 0.0 if flat else 1.0, 1.0])


def radii(scene: Scene) -> list[float]:
    """Distance from each float's reference point within which its hull lies, of what the waves' field goes by [m]."""
    flat = motions.in_plane(scene)
    return [f.hull.profile_size if stays else f.hull.size for f, stays in zip(scene.floats, flat, strict=True)]


class BeyondSeries:
    """What the local wave field about each float leaves out on its hull as it goes, as a share of the amplitudes' sum.

    At most: all waves' crests add up there. None where pressure is linear.
    """

    def __init__(self, scene: Scene, field: WaveField, terms: Sequence[int]) -> None:
        """terms: of the series about each float."""
        self.field, self.terms, self.sizes = field, terms, radii(scene)
        self.felt, self.met = bool(field.sea.amplitude.any()) and any(terms), list[np.ndarray]()

    def add(self, bodies: Bodies, states: np.ndarray) -> None:
        """Take in states z (m, nz) of a run, of which a few tell how far floats get."""
        if self.felt:
            self.met.append(ways_of(bodies, states[::THIN]))

    @cached_property
    def furthest(self) -> np.ndarray:
        """(nb,) that reference points got from the middles of their series, along the waves and up [m]."""
        return np.max([np.zeros(len(self.sizes)), *(ways.max(axis=0) for ways in self.met)], axis=0)

    @property
    def largest(self) -> float:
        """Of any float at its furthest."""
        return max(map(self._beyond, range(len(self.sizes)), self.furthest), default=0.0) if self.felt else 0.0

    def rms(self) -> list[float]:
        """Of each over the run (nb,); 0 of those that never have as much as ROUGH."""
        far = [self.felt and self._beyond(b, way) > ROUGH for b, way in enumerate(self.furthest)]
        return [self._rms(b) if away else 0.0 for b, away in enumerate(far)]

    def _rms(self, b: int) -> float:
        count, edges = np.histogram(np.concatenate(self.met)[:, b], BINS, (0.0, self.furthest[b]))
        left = np.array([self._beyond(b, way) for way in (edges[1:] + edges[:-1]) / 2])
        return float(np.sqrt(count @ left**2 / count.sum()))

    def _beyond(self, b: int, way: float) -> float:
        return self.field.left_out(self.terms[b], self.sizes[b] + way) if self.terms[b] else 0.0


def slides(name: str) -> bool:
    """Whether a joint's axis of that name is a translation."""
    return name in DOFS[:3]


def beyond(scene: Scene, joints: np.ndarray, bounds: np.ndarray) -> tuple[int, Float, str] | None:
    """Number, float and axis of the first of joints (nj,) that is beyond its bounds, the last of bounds (nz, 2)."""
    axes = [(f, axis) for f in scene.floats for axis in f.motion]
    low, high = bounds[len(bounds) - len(axes) :].T
    past = np.flatnonzero(~((low < joints) & (joints < high)))
    return (int(past[0]), *axes[past[0]]) if past.size else None


def overturned(scene: Scene, joints: np.ndarray) -> str:
    """The first float whose own vertical points down with all joints (nj,) where they are, and these; "" if none."""
    for f, up in zip(scene.floats, uprights(scene.floats, scene.carriers, joints), strict=True):
        if not up > 0:
            names = [f"{g.name} {axis}" for g in scene.floats for axis in g.motion]
            at = ", ".join(f"{name} {value:+.2f}" for name, value in zip(names, joints, strict=True) if value)
            return f"{f.name} is turned over at {at}"
    return ""


def explain(scene: Scene, joints: np.ndarray, bounds: np.ndarray, when: str) -> str:
    """The message that names the coordinate beyond its bound; joints (nj,) where the run stopped, bounds (nz, 2)."""
    remedy = "; hold it by more stiffness or damping, or let it go nearer to its rest"
    if scene.sea.amplitude.any():
        remedy = "; the sea is too high for this joint and its damping"
    if (first := beyond(scene, joints, bounds)) is None:
        if over := overturned(scene, joints):
            return f"{over} {when}{remedy}"
        return f"a hinge of the platform moved by more than the platform's size {when}: it is too soft for its loads"
    j, item, axis = first
    low, high = bounds[len(bounds) - len(joints) + j]
    where = f"{item.name} {axis} at {joints[j]:+.2f} {when}, beyond {low:+.2f} to {high:+.2f}: the float "
    if not slides(axis) and np.isfinite(falls := falls_at(item.direction(axis))):
        lies = (low if joints[j] < 0 else high) in (-falls, falls)
        return f"{where}{'is turned over' if lies else 'swung through beneath its hinge'}{remedy}"
    if high == np.pi:
        return (
            f"{where}turned too far round, beside axes that tilt floats, for linear pressure or a mooring 6 x 6; hold"
            ' it by more stiffness, or set froude_krylov = "body-nonlinear"'
        )
    return (
        f"{where}drifted out of the waves summed about its place at rest; hold it by a stiffer mooring, or"
        ' set froude_krylov = "linear", which has no such bound'
    )
