"""What an elastic platform's sections and feet bear, as linear maps of the march's samples: see structure.influence."""

from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from solver.coupled.places import SAME, Places
from solver.sea.series import ROUNDING, factors, independent
from solver.structure import water

MIRROR = np.array([1.0, -1.0, 1.0])
LITTLE = 1e-3  # of what a cause does to the one kind, beside which what it does to the other may be rounding
NEAR = 1e-12  # squares of what is that near are not apart by more than their rounding


class Part(NamedTuple):
    """n of the ny forces, y = [x, x S] + y₀ L: few of them go their own way, or differ so from what others tell."""

    kept: slice  # which of all x are theirs
    columns: slice  # which of the ny forces they are
    stations: np.ndarray | slice  # which of the drag has a part in x
    spread: np.ndarray  # S (r, n - r), of r that are kept
    others: np.ndarray  # (b,) which of the ny forces, of parts before, are y₀
    lever: np.ndarray  # L (b, n)


@dataclass(frozen=True, eq=False, kw_only=True)
class Forces:
    """Maps to the ny forces that are asked for, by x = w + p̈ A + ṗ B + h C + g D and parts, besides those at rest.

    What is along a tube goes by the forces at its start, and else by what acts on that tube alone.
    """

    places: Places
    waves: np.ndarray  # (2 np, r) of the wave's inertia load, as Support.waves: w is of these
    inertia: np.ndarray  # (nm, r) of modal accelerations
    damping: np.ndarray  # (nm, r) of modal rates, for a damping ratio of 1 until it is known: see damped
    carried: np.ndarray  # (nc, r) of the floats' loads on the carriers
    drag: np.ndarray  # (nd ns, r) of the drag at the stations
    applied: np.ndarray  # (na, r) of the forces that load histories have
    moments: np.ndarray  # (r,) which are moments
    parts: tuple[Part, ...]  # of which the first goes by no others
    at_rest: np.ndarray  # (ny,) of the frame alone: weight, constant loads, buoyancy
    first: np.ndarray  # (ny,) of each the first that is always as large, maybe itself
    sign: np.ndarray  # (ny,) 1 where it has that one's sign, -1 where it has not
    straining: np.ndarray | None = None  # (nm, r) more of modal rates, for 1 s of the stiffness as damping

    def damped(self, ratio: np.ndarray, beta: float) -> "Forces":
        """With the modes' damping ratios (nm,), of which β [s] of the stiffness is a part."""
        damping = ratio[:, None] * self.damping
        return replace(self, damping=damping if self.straining is None else damping + beta * self.straining)

    def of(
        self, waves: np.ndarray, dp: np.ndarray, ddp: np.ndarray, carried: np.ndarray, drag: np.ndarray
    ) -> np.ndarray:
        """y (m, ny) without those at rest, of samples: waves (m, r), dp, ddp, carried, drag (m, nd, ns)."""
        x, drag = self.of_motion(dp, ddp, carried), drag.reshape(len(drag), -1)
        x += waves
        for part, maps in zip(self.parts, self._drag, strict=True):
            if maps:
                x[:, part.kept] += reduce(np.matmul, maps, drag[:, part.stations])
        return self.whole(x)

    def of_motion(self, dp: np.ndarray, ddp: np.ndarray, carried: np.ndarray) -> np.ndarray:
        """x (m, r) without waves and drag."""
        return np.concatenate([ddp, dp, carried], axis=1) @ self._motion

    def whole(self, x: np.ndarray) -> np.ndarray:
        """y (m, ny) of x (m, r)."""
        y = np.empty((len(x), self.at_rest.size), x.dtype)
        ends, *others = self.parts
        own, r = x[:, ends.kept], ends.kept.stop
        y[:, :r] = own
        np.matmul(own, ends.spread, out=y[:, r : ends.columns.stop])
        if others:
            by, levers = self._levers
            np.matmul(y.take(by, axis=1), levers, out=y[:, ends.columns.stop :])
        for part in others:
            own, these = x[:, part.kept], y[:, part.columns]
            these[:, : own.shape[1]] += own
            if part.spread.size:
                these[:, own.shape[1] :] += own @ part.spread
        return y

    @cached_property
    def _levers(self) -> tuple[np.ndarray, np.ndarray]:
        """Which of the first part's forces (b,) others go by, and how (b, n): levers of all in one."""
        _, *others = self.parts
        by = np.unique(np.concatenate([part.others for part in others]))
        levers = np.zeros((by.size, self.at_rest.size - self.parts[0].columns.stop))
        for part in others:
            columns = np.arange(part.columns.start, part.columns.stop) - self.parts[0].columns.stop
            levers[np.searchsorted(by, part.others)[:, None], columns] = part.lever
        return by, levers

    @cached_property
    def _drag(self) -> list[tuple[np.ndarray, ...]]:
        maps = (self.drag[part.stations, part.kept] for part in self.parts)
        return [_by_few(drag) if drag.size else () for drag in maps]

    @cached_property
    def _motion(self) -> np.ndarray:
        return np.concatenate([self.inertia, self.damping, self.carried])


def reduced(places: Places, at_rest: np.ndarray, **maps: np.ndarray) -> Forces:
    """Of maps (…, ny) to all ny forces.

    Of forces at ends that are always the same there is one. Those of a part that are kept are rows of the maps
    themselves, less what others tell of them, by which a QR decomposition with pivots leaves no more than rounding;
    what drives them counts by its largest effect, a force or a moment by the largest of its kind.
    """
    whole = np.concatenate([*maps.values()])
    scaled = _scaled(np.vstack([whole, at_rest]), places.wanted.moments)
    places, left = places.without_twins(scaled)
    whole, moment = whole[:, left], places.wanted.moments[left]
    size = np.where(moment, *(np.abs(whole[:, kind]).max(initial=0.0) for kind in (moment, ~moment)))
    size[size == 0] = 1.0
    ends = np.cumsum([len(values) for values in maps.values()])[:-1]
    largest = [np.abs(map_ / size).max(initial=0.0) for map_ in np.split(whole, ends)]
    most = np.repeat(largest, [*map(len, maps.values())])  # that drivers of one kind do
    at_ends, *_ = next(places.parts())  # along tubes none are
    first, sign = np.arange(moment.size), np.ones(moment.size)
    found, sign[at_ends] = _alike(scaled[:, left][:, at_ends], moment[at_ends])
    first[at_ends] = at_ends[found]
    places = replace(places, columns=places.columns.at(np.where(sign > 0, first, np.arange(first.size))))
    x: list[np.ndarray] = []
    parts: list[Part] = []
    order, place = np.zeros(0, int), np.empty(size.size, int)
    for columns, others, lever in places.parts():
        rest = whole[:, columns] - whole[:, others] @ lever
        effect = np.abs(rest / size[columns]).max(axis=1, initial=0.0)
        acts = effect > (SAME * most if others.size else 0.0)
        rest[~acts] = 0.0  # it acts elsewhere
        alike = rest[acts] / size[columns] / effect[acts, None]
        mine, spread = independent(alike, SAME if others.size else ROUNDING)
        r, taken, ordered = len(spread), sum(part.shape[1] for part in x), columns[mine]
        x.append(rest[:, mine[:r]])
        drag = dict(zip(maps, np.split(x[-1], ends), strict=True))["drag"]
        parts.append(
            Part(
                kept=slice(taken, taken + r),
                columns=slice(order.size, order.size + ordered.size),
                stations=_compact(np.flatnonzero(drag.any(axis=1))) if others.size else slice(None),
                spread=spread * size[ordered[r:]] / size[ordered[:r], None],
                others=place[others],
                lever=lever[:, mine],
            )
        )
        order, place[ordered] = np.append(order, ordered), order.size + np.arange(ordered.size)
    return Forces(
        places=replace(places, columns=places.columns.at(place)),
        **dict(zip(maps, np.split(np.concatenate(x, axis=1), ends), strict=True)),
        moments=np.concatenate([moment[order[part.columns]][: len(part.spread)] for part in parts]),
        parts=tuple(parts),
        at_rest=at_rest[left][order],
        first=place[first[order]],
        sign=sign[order],
    )


def _scaled(maps: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Maps (k, ny) with each of the k causes counted by its largest effect, a force or a moment by that of its kind.

    What a cause does to the one kind is rounding where it does little beside what it does to the other.
    """
    scale = np.array([np.abs(maps[:, kind]).max(axis=1, initial=0.0) for kind in (moment, ~moment)])
    size = np.maximum(scale.max(axis=1, keepdims=True), np.finfo(float).tiny)
    of_moments, of_forces = np.maximum(scale, LITTLE * size * (scale / size).max(axis=0))[..., None]
    return maps / np.maximum(np.where(moment, of_moments, of_forces), np.finfo(float).tiny)


def _alike(maps: np.ndarray, moment: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) of each column of `_scaled` maps (k, n) the first of its kind that is the same but for its sign, the sign.

    Few pairs have squares as near as those of columns that are the same: only these are compared.
    """
    squares, products = np.sum(maps**2, axis=0), maps.T @ maps
    apart = squares[:, None] + squares - 2 * np.abs(products)
    near = (apart <= NEAR * len(maps)) & (moment[:, None] == moment)
    first, sign = np.arange(len(squares)), np.ones(len(squares))
    for j in first:
        for i in np.flatnonzero(near[:j, j] & (first[:j] == np.arange(j))):
            way = -1.0 if products[i, j] < 0 else 1.0
            if np.abs(maps[:, i] - way * maps[:, j]).max() <= SAME:
                first[j], sign[j] = i, way
                break
    return first, sign


def _by_few(drag: np.ndarray) -> tuple[np.ndarray, ...]:
    """A map (n, r) as the product of one or two: beyond a member its loads count by what they do to its ends alone."""
    few = factors(drag)
    return few if few.spread.size + few.basis.size < drag.size else (drag,)


def _compact(places: np.ndarray) -> np.ndarray | slice:
    """A slice, which copies nothing, where places in ascending order are neighbours."""
    if not places.size or np.ptp(places) >= places.size:
        return places
    return slice(int(places[0]), int(places[-1]) + 1)


def of_drag(
    places: Places, at: water.Stations, kept: np.ndarray, directions: np.ndarray, *, planar: bool
) -> np.ndarray:
    """(nd ns, ny) of drag at the march's stations, which are those `kept` (mask) of all, in the directions it has.

    In a planar scene those of one side have the drag of both: half of it acts on each.
    """
    unit = places.influence.of_points(at)
    mine = unit[kept]
    if planar:
        _, other = cKDTree(_keys(at.position, at.tangent)).query(
            _keys(at.position[kept] * MIRROR, at.tangent[kept] * MIRROR)
        )
        mine = (mine + MIRROR[:, None] * unit[other]) / 2
    return mine.transpose(1, 0, 2)[directions].reshape(-1, unit.shape[2])


def _keys(position: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Points of members that cross there differ by their tangents (ns, 12)."""
    along = tangent[:, :, None] * tangent[:, None, :]
    return np.concatenate([position, along.reshape(-1, 9)], axis=1)
