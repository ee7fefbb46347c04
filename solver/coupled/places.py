"""Which forces of an elastic platform's sections and feet are asked for."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import prod
from typing import NamedTuple

import numpy as np

from solver.keys import firsts
from solver.structure import recovery
from solver.structure.frame_model import FrameModel
from solver.structure.influence import Influence, Wanted, influence
from solver.structure.legs import BENDING
from solver.structure.members import Member
from solver.structure.tubular import may_be_utilised

REACTIONS, SECTIONS, FIBRES, FATIGUE = "reactions", "section_forces", "fibre_stress", "fatigue"
TOPS, UTILISATION, STRESSES = "leg_tops", "utilisation", "member_stress"
SOIL = "soil:"  # of a member among the feet
SHEAR = [1, 2, 3]  # Vy, Vz, T among the section forces
SAME = 1e-9  # of the largest force or moment by one cause: rounding of the static solutions


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
        """Tubes that bear what others do, or its mirror image, by maps (k, ny) as `forces` scales them, are left out.

        The second: (ny,) which of the forces are left.
        """
        frame, kept, columns = self.influence.model.frame, np.ones(maps.shape[1], bool), self.columns
        each = [columns.along[slice(*ends)] for ends in pairwise([0, *np.cumsum(self.points)])]
        makes = [(m.section, m.material, frame.buckling_length(m), m.moment_factor) for m in self.tubes]
        both = (each, columns.shear)
        like = firsts(
            len(makes),
            lambda i, k: (
                makes[i] == makes[k]
                and all(_alike(maps, part[i], part[k]) for part in both)
                and _alike(maps, each[i][:, :1], each[k][:, :1], signs=(1,))  # what is pulled does not buckle
            ),
        )
        first, twin = np.unique(like, return_inverse=True)
        for k in np.setdiff1d(np.arange(like.size), first):
            kept[each[k]], kept[columns.shear[k]] = False, False
        along = np.concatenate([each[k] for k in first]) if first.size else columns.along
        left = columns._replace(along=along, shear=columns.shear[first]).at(np.cumsum(kept) - 1)
        return replace(self, twin=twin, points=self.points[first], columns=left), kept


def places_of(model: FrameModel, legs: Iterable[str], outputs: Iterable[str]) -> Places:
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


def _alike(maps: np.ndarray, one: np.ndarray, other: np.ndarray, signs: tuple[int, ...] = (1, -1)) -> bool:
    """Whether what some columns (n, m) give is what others do, each of the m but for its sign."""
    if one.shape != other.shape:
        return False
    a, b = maps[:, one], maps[:, other]
    apart = np.min([np.abs(a - sign * b).max(axis=(0, 1)) for sign in signs], axis=0)
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
