"""What an elastic platform's sections and feet bear, as linear maps of the march's samples: see structure.influence."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import pairwise
from math import prod
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from solver.keys import firsts
from solver.sea.series import ROUNDING, factors, independent
from solver.structure import recovery, water
from solver.structure.frame_model import FrameModel
from solver.structure.influence import Influence, Wanted, influence
from solver.structure.legs import BENDING
from solver.structure.members import Member
from solver.structure.tubular import may_be_utilised

REACTIONS, SECTIONS, FIBRES, FATIGUE = "reactions", "section_forces", "fibre_stress", "fatigue"
TOPS, UTILISATION, STRESSES = "leg_tops", "utilisation", "member_stress"
SOIL = "soil:"  # of a member among the feet
SHEAR = [1, 2, 3]  # Vy, Vz, T among the section forces
MIRROR = np.array([1.0, -1.0, 1.0])
SAME = 1e-9  # of the largest force or moment by one cause: rounding of the static solutions
LITTLE = 1e-3  # of what a cause does to the one kind, beside which what it does to the other may be rounding
NEAR = 1e-12  # squares of what is that near are not apart by more than their rounding


class Ends(NamedTuple):
    """Sections at nl ends of members, as the legs' feet or their tops, nf fibres at most."""

    properties: np.ndarray  # (nl, 4) A, Iy, Iz, c
    thickness: np.ndarray  # (nl,) of the wall [m], as fatigue sees it
    fibre: np.ndarray  # (nl, nf, 2) local y and z [m], NaN where a leg has fewer
    axes: np.ndarray  # (nl, 3, 3) rows = local axes

    @property
    def stress(self) -> np.ndarray:
        """Signed stress for unit N, My, Mz, (nl, 3, nf): σ = N/A + My z/Iy - Mz y/Iz."""
        A, Iy, Iz, _ = self.properties.T[..., None]
        y, z = np.moveaxis(self.fibre, -1, 0)
        return np.stack([np.where(np.isnan(y), np.nan, 1 / A), z / Iy, -y / Iz], axis=1)

    @property
    def extreme(self) -> np.ndarray:
        """N/A, c My/Iy, c Mz/Iz for unit N, My, Mz, (nl, 3)."""
        A, Iy, Iz, c = self.properties.T
        return np.stack([1 / A, c / Iy, c / Iz], axis=-1)

    @property
    def place(self) -> np.ndarray:
        """Of the fibres from the leg's axis, global axes (nl, nf, 3) [m]."""
        return self.fibre @ self.axes[:, 1:]


class Columns(NamedTuple):
    """Which of the ny forces are what is asked for."""

    feet: np.ndarray  # (nl, 3) N, My, Mz at the legs' feet
    tops: np.ndarray  # (nl, 3) at their tops, or none
    sections: np.ndarray  # (nm, 2, 6) section forces at the members' ends
    along: np.ndarray  # (np, 3) N, My, Mz at all points of the tubes that are looked at, tube after tube
    shear: np.ndarray  # (no, 2, 3) Vy, Vz, T at their ends
    reactions: np.ndarray  # (nc, 6)

    @classmethod
    def of(cls, *shapes: tuple[int, ...]) -> "Columns":
        """One part after another."""
        ends = np.cumsum([0, *map(prod, shapes)]).tolist()
        return cls(*(np.arange(*ends).reshape(shape) for ends, shape in zip(pairwise(ends), shapes, strict=True)))

    def at(self, place: np.ndarray) -> "Columns":
        """With each where `place` (ny,) has it."""
        return Columns(*(place[part] for part in self))


@dataclass(frozen=True, eq=False, kw_only=True)
class Places:
    """Which of a frame's forces are asked for: of the legs' ends, the members' ends, tubes, the ground."""

    feet: Ends
    tops: Ends  # where they are asked for, else of no legs
    members: tuple[str, ...]
    ends: Ends  # of these, start and end in turn, where their stress is asked for, else of none
    checked: tuple[str, ...]  # nk tubes that are utilised
    twin: np.ndarray  # (nk,) which of the no that are looked at bears what each does, or its mirror image
    points: np.ndarray  # (no,) of each: its ends, and where two of its elements meet and bear the same
    grounded: tuple[str, ...]  # nc nodes, and members in soil
    foot: np.ndarray  # (nc, 3) where their reactions are [m]
    columns: Columns
    wanted: Wanted
    influence: Influence

    def parts(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Columns that are reckoned together (n,), those before them (b,) that they go by, and how (b, n): see Forces.

        Along a tube, N = N₀, My = My₀ + Vz₀ x and Mz = Mz₀ - Vy₀ x from its start, but for what acts on it up to x.
        """
        model, along = self.influence.model, self.columns.along
        ends = [slice(*between) for between in pairwise([0, *np.cumsum(self.points).tolist()])]
        first = np.concatenate([part.ravel() for part in self.columns._replace(along=along[[at.start for at in ends]])])
        yield (first := np.unique(first)), np.zeros(0, int), np.zeros((0, first.size))
        for tube, at, (Vy, Vz, _) in zip(self.tubes, ends, self.columns.shear[:, 0], strict=True):
            x = np.cumsum(model.length[model.member_elements[tube.name]])
            N, My, Mz = along[at].T
            yield N[1:], N[:1], np.ones((1, x.size))
            yield My[1:], np.array([My[0], Vz]), np.array([np.ones(x.size), x])
            yield Mz[1:], np.array([Mz[0], Vy]), np.array([np.ones(x.size), -x])

    @property
    def tubes(self) -> list[Member]:
        """The no that are looked at."""
        members = {m.name: m for m in self.influence.model.frame.members}
        return [members[self.checked[k]] for k in np.unique(self.twin, return_index=True)[1]]

    def without_twins(self, maps: np.ndarray) -> tuple["Places", np.ndarray]:
        """Tubes that bear the same as others, or its mirror image, by `_scaled` maps (k, ny) are not looked at.

        The second: (ny,) which of the forces are left.
        """
        frame, kept, columns = self.influence.model.frame, np.ones(maps.shape[1], bool), self.columns
        each = [columns.along[slice(*ends)] for ends in pairwise([0, *np.cumsum(self.points)])]
        makes = [(m.section, m.material, frame.buckling_length(m), m.moment_factor) for m in self.tubes]
        both = (each, columns.shear)
        like = firsts(
            len(makes),
            lambda i, k: makes[i] == makes[k] and all(_mirrored(maps, part[i], part[k]) for part in both),
        )
        first, twin = np.unique(like, return_inverse=True)
        for k in np.setdiff1d(np.arange(like.size), first):
            kept[each[k]], kept[columns.shear[k]] = False, False
        along = np.concatenate([each[k] for k in first]) if first.size else columns.along
        left = columns._replace(along=along, shear=columns.shear[first]).at(np.cumsum(kept) - 1)
        return replace(self, twin=twin, points=self.points[first], columns=left), kept


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


def places(model: FrameModel, legs: Iterable[str], outputs: Iterable[str]) -> Places:
    """Those that a scene's legs and outputs need."""
    frame, legs = model.frame, tuple(legs)
    outputs = tuple(outputs)
    members = tuple(m.name for m in frame.members) if {SECTIONS, STRESSES} & set(outputs) else ()
    checked = tuple(filter(may_be_utilised, frame.members)) if UTILISATION in outputs else ()
    grounded, buried = (frame.grounded, tuple(frame.buried)) if REACTIONS in outputs else ((), ())
    feet = [_foot(model, name) for name in legs]
    tops = [sum(_ends(model, name)) - foot for name, foot in zip(legs, feet, strict=True)] if TOPS in outputs else []
    both = [end for name in members for end in _ends(model, name)]
    along = [end for m in checked for end in _points(model, m.name)]
    shear = [end for m in checked for end in _ends(model, m.name)]
    nodes = np.array([model.node_index[name] for name in grounded], int)
    wanted = Wanted(
        end=np.concatenate([np.repeat(e, n) for e, n in ((feet + tops, 3), (both, 6), (along + shear, 3))]).astype(int),
        component=np.concatenate(
            [
                np.tile(BENDING, len(feet + tops)),
                np.tile(np.arange(6), len(both)),
                np.tile(BENDING, len(along)),
                np.tile(SHEAR, len(shear)),
            ]
        ).astype(int),
        grounded=(6 * nodes[:, None] + np.arange(6)).ravel(),
        buried=buried,
    )
    foot = [*model.xyz[nodes], *(model.soil_reaction(member)[1] for member in buried)]
    return Places(
        feet=_sections(model, feet),
        tops=_sections(model, tops),
        members=members,
        ends=_sections(model, both if STRESSES in outputs else []),
        checked=tuple(m.name for m in checked),
        twin=np.arange(len(checked)),
        points=np.array([m.elements + 1 for m in checked], int),
        grounded=(*grounded, *(SOIL + member.name for member in buried)),
        foot=np.reshape(foot, (-1, 3)),
        columns=Columns.of(
            (len(feet), 3), (len(tops), 3), (len(members), 2, 6), (len(along), 3), (len(checked), 2, 3), (len(foot), 6)
        ),
        wanted=wanted,
        influence=influence(model, wanted),
    )


def _mirrored(maps: np.ndarray, one: np.ndarray, other: np.ndarray) -> bool:
    """Whether what some columns (n, 3) give is what others do, each of the three but for its sign."""
    if one.shape != other.shape:
        return False
    a, b = maps[:, one], maps[:, other]
    apart = np.minimum(*(np.abs(a - sign * b).max(axis=(0, 1)) for sign in (1, -1)))
    return bool(apart.max() <= SAME)


def _ends(model: FrameModel, name: str) -> tuple[int, int]:
    """A member's start and end among the ends of elements."""
    elements = model.member_elements[name]
    return 2 * elements[0], 2 * elements[-1] + 1


def _points(model: FrameModel, name: str) -> list[int]:
    """A member's start and the ends of all its elements, among the ends of elements."""
    elements = model.member_elements[name]
    return [2 * elements[0], *(2 * e + 1 for e in elements)]


def _foot(model: FrameModel, name: str) -> int:
    """The lower of a member's ends."""
    start, end = model.member_nodes[name][[0, -1]]
    return _ends(model, name)[int(model.xyz[start, 2] > model.xyz[end, 2])]


def _sections(model: FrameModel, given: list[int]) -> Ends:
    ends = np.array(given, int)
    sections = [model.section_at(end) for end in given]
    most = max((len(section.fibres) for section in sections), default=0)
    fibre = np.full((len(ends), most, 2), np.nan)
    for row, section in zip(fibre, sections, strict=True):
        row[: len(section.fibres)] = section.fibres
    return Ends(
        properties=recovery.properties(sections),
        thickness=np.array([section.wall for section in sections]),
        fibre=fibre,
        axes=model.rotation[ends // 2],
    )


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
