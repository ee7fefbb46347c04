"""Output along the legs: displacements and fibre stresses as linear maps of modal amplitudes."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from solver.errors import InputError
from solver.kernels import fast_lean_kernel, lean_kernel, whole_lean_kernel
from solver.keys import firsts
from solver.statistics import vertex
from solver.structure import recovery, water
from solver.structure.frame import COINCIDENT
from solver.structure.frame_model import FrameModel

BENDING = [0, 4, 5]  # N, My, Mz among the section forces
MIRROR = np.array([1.0, -1.0, 1.0])  # a displacement seen in the plane y = 0
HALVINGS = 20  # of the time between three samples, in which a fibre is relieved the most
SAME, SAME_STRESS = 1e-9, 1e-6  # of the largest value: rounding of shapes, and of what their differences strain


class Largest(NamedTuple):
    """Over all samples so far, at the nn nodes and both ends of the ne elements of the no legs."""

    square: np.ndarray  # (nn,) of the displacement [m²]
    stress: np.ndarray  # (ne 2,) magnitude [Pa]
    relieved: np.ndarray  # (no,) the most compressive fibres' stress at the feet [Pa]
    last_square: np.ndarray  # (2, nn) the last two samples
    last_stress: np.ndarray  # (2, ne 2)
    last_feet: np.ndarray  # (2, no, 3)


@dataclass(frozen=True, eq=False, kw_only=True)
class Legs:
    """Maps for nl legs, of which no respond differently: mirror images in y = 0 respond alike.

    One after another and foot first they have nn nodes, at nh different heights, and ne elements.
    """

    height: np.ndarray  # (nh,) above the leg's foot [m]
    place: np.ndarray  # (nn,) which of the heights is the node's
    ends: np.ndarray  # (no,) where each leg's nodes end
    twin: np.ndarray  # (nl,) which of the no legs responds like it, or as its mirror image in y = 0
    mirrored: np.ndarray  # (nl,) bool
    displacement: np.ndarray  # (nm, 3, nn) [m]
    fibre: np.ndarray  # (nm, 3, ne 2) N/A, c My/Iy, c Mz/Iz at both ends of each element [Pa]
    static_fibre: np.ndarray  # (3, ne 2)

    @cached_property
    def nodes(self) -> list[slice]:
        """Each of the no legs' nodes among the nn."""
        return [slice(*pair) for pair in pairwise([0, *self.ends])]

    @cached_property
    def element_ends(self) -> list[slice]:
        """Each of the no legs' element ends, two of every element; a leg has one element less than nodes."""
        return [slice(2 * (at.start - leg), 2 * (at.stop - leg - 1)) for leg, at in enumerate(self.nodes)]

    @cached_property
    def tops(self) -> np.ndarray:
        """Displacement of the tops (nm, nl, 3)."""
        own = self.displacement[..., self.ends - 1].swapaxes(1, 2)[:, self.twin]
        return own * np.where(self.mirrored[:, None], MIRROR, 1.0)

    @cached_property
    def first(self) -> np.ndarray:
        """(no,) which of the nl legs is the first that responds like each."""
        return np.unique(self.twin, return_index=True)[1]

    @cached_property
    def _feet(self) -> np.ndarray:
        """Place of each of the no legs' foot among the element ends."""
        return np.array([at.start for at in self.element_ends])

    def nothing(self) -> Largest:
        """The largest values before the first sample."""
        nd, nf, no = self.displacement.shape[2], self.fibre.shape[2], self.ends.size
        last = (np.full((2, *shape), np.nan) for shape in ((nd,), (nf,), (no, 3)))
        return Largest(np.zeros(nd), np.zeros(nf), np.full(no, -np.inf), *last)

    def top_displacement(self, p: np.ndarray) -> np.ndarray:
        """(m, nl, 3) [m] of modal amplitudes (m, nm)."""
        return np.tensordot(p, self.tops, axes=1)

    def enlarge(self, largest: Largest, p: np.ndarray, feet: np.ndarray, smooth: np.ndarray) -> None:
        """Update `largest` by displacements, sizes of stress and the most compressive fibres: see `compressive`.

        At the feet these are of N/A, c My/Iy, c Mz/Iz (m, nl, 3) there; elsewhere of the nodes' displacements.
        smooth (m,): see Statistics.add.
        """
        u, fibre, feet = _map(p, self.displacement), _map(p, self.fibre), feet[:, self.first]
        fibre[:, :, self._feet] = feet.swapaxes(1, 2) - self.static_fibre[:, self._feet]
        square, stress, relieved, last_square, last_stress, last_feet = largest
        _respond(u, fibre, self.static_fibre, smooth, square, stress, last_square, last_stress)
        feet = np.concatenate([last_feet, feet])
        _relieve(feet, smooth, relieved)
        last_feet[:] = feet[-2:]

    def envelopes(self, largest: Largest) -> tuple[np.ndarray, np.ndarray]:
        """Displacement (nl, nh) [m] and stress (nl, nh) [Pa], NaN at heights where a leg has no node."""
        displacement, stress = np.full((2, self.ends.size, self.height.size), np.nan)
        for leg, (nodes, ends) in enumerate(zip(self.nodes, self.element_ends, strict=True)):
            displacement[leg, self.place[nodes]] = np.sqrt(largest.square[nodes])
            stress[leg, self.place[nodes]] = at_nodes(largest.stress[ends].reshape(-1, 2))
        return displacement[self.twin], stress[self.twin]


@fast_lean_kernel
def _respond(
    u: np.ndarray,
    fibre: np.ndarray,
    static: np.ndarray,
    smooth: np.ndarray,
    square: np.ndarray,
    stress: np.ndarray,
    last_square: np.ndarray,
    last_stress: np.ndarray,
) -> None:
    """Update the largest values by displacements (m, 3, nn) and fibres (m, 3, ne 2), sample by sample."""
    for i in range(smooth.size):
        for j in range(square.size):
            _take(u[i, 0, j] ** 2 + u[i, 1, j] ** 2 + u[i, 2, j] ** 2, j, smooth[i], square, last_square)
        axial, about_y, about_z = fibre[i, 0], fibre[i, 1], fibre[i, 2]
        for j in range(stress.size):
            bending = np.sqrt((about_y[j] + static[1, j]) ** 2 + (about_z[j] + static[2, j]) ** 2)
            _take(bending + abs(axial[j] + static[0, j]), j, smooth[i], stress, last_stress)


@fast_lean_kernel(inline="always")
def _take(new: float, j: int, smooth: bool, largest: np.ndarray, last: np.ndarray) -> None:
    """Raise largest[j] to a sample, or, where smooth, to the vertex of the parabola through it and two before.

    None is negative, and the vertex lies above the middle sample by an eighth at most.
    """
    older, old = last[0, j], last[1, j]
    last[0, j], last[1, j] = old, new
    largest[j] = max(largest[j], new)
    if smooth and 1.125 * old > largest[j]:
        largest[j] = max(largest[j], vertex(older, old, new))


@whole_lean_kernel
def _relieve(fibre: np.ndarray, smooth: np.ndarray, relieved: np.ndarray) -> None:
    """Raise the largest stress of the most compressive fibres (n,) by samples of N/A, c My/Iy, c Mz/Iz (2 + m, n, 3).

    It has a corner where the moment passes zero, and parabolas through samples of it go beyond: these, where smooth, go
    through each of the parts.
    """
    for i in range(smooth.size):
        for c in range(relieved.size):
            older, old, new = fibre[i, c], fibre[i + 1, c], fibre[i + 2, c]
            relieved[c] = max(relieved[c], _stress(new))
            bend = abs(older[0] - 2 * old[0] + new[0])
            if not smooth[i] or not max(older[0], old[0], new[0]) + bend / 8 > relieved[c]:  # N/A is the most it can be
                continue
            if _stress(old) > max(_stress(older), _stress(new)):
                relieved[c] = max(relieved[c], _crest(older, old, new))


@lean_kernel(inline="always")
def _stress(fibre: np.ndarray) -> float:
    """`compressive` (3,)."""
    return fibre[0] - np.sqrt(fibre[1] ** 2 + fibre[2] ** 2)


@lean_kernel(inline="always")
def _crest(older: np.ndarray, old: np.ndarray, new: np.ndarray) -> float:
    """Largest stress between three samples, of which the middle one is the largest, by halves."""
    at, most, step = 0.0, _stress(old), 0.5
    for _ in range(HALVINGS):
        for s in (at - step, at + step):
            stress = _between(older, old, new, s)
            if stress > most:
                most, at = stress, s
                break
        step /= 2
    return most


@lean_kernel(inline="always")
def _between(older: np.ndarray, old: np.ndarray, new: np.ndarray, s: float) -> float:
    """Stress by the parabolas through three samples (3,) at s = -1, 0 and 1."""
    before, now, after = s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2
    about_y = before * older[1] + now * old[1] + after * new[1]
    about_z = before * older[2] + now * old[2] + after * new[2]
    return before * older[0] + now * old[0] + after * new[0] - np.sqrt(about_y**2 + about_z**2)


def at_nodes(ends: np.ndarray) -> np.ndarray:
    """The larger of the two values that meet at each node (…, ne + 1), from values (…, ne, 2) at element ends."""
    first, last = ends[..., :1, 0], ends[..., -1:, 1]
    return np.concatenate([first, np.maximum(ends[..., 1:, 0], ends[..., :-1, 1]), last], axis=-1)


def outputs(
    names: Iterable[str], model: FrameModel, density: float, gravity: float, at_rest: np.ndarray, shapes: np.ndarray
) -> Legs:
    """Maps for the named members from the basis shapes (6n, nm), with the static forces of rest."""
    nm = shapes.shape[1]
    loads = water.spread_load(model, density, gravity)
    still = recovery.section_forces(model, at_rest, loads).reshape(-1, 2, 6)[..., BENDING]
    moving = (recovery.section_force_matrix(model) @ shapes).reshape(-1, 2, 6, nm)[:, :, BENDING]
    A, Iy, Iz, c = np.moveaxis(recovery.section_properties(model).reshape(-1, 2, 4), -1, 0)
    to_stress = np.stack([1 / A, c / Iy, c / Iz], axis=-1)
    still, moving = still * to_stress, moving * to_stress[..., None]
    legs = []
    for name in names:
        nodes, elements = model.member_nodes[name], np.array(model.member_elements[name])
        end = slice(None)
        if model.xyz[nodes[0], 2] > model.xyz[nodes[-1], 2]:  # foot first
            nodes, elements, end = nodes[::-1], elements[::-1], slice(None, None, -1)
        height = model.xyz[nodes, 2] - model.xyz[nodes[0], 2]
        if not height[-1] > COINCIDENT * model.length[elements].sum():
            raise InputError("platform.legs", name, "must rise: what it does is put out by height")
        shape = shapes.reshape(-1, 6, nm)[nodes, :3]
        legs.append(_Leg(height, shape, moving[elements][:, end], still[elements][:, end]))
    distinct, twin, mirrored = _alike(legs)
    height = _grid(distinct)
    return Legs(
        height=height,
        place=np.concatenate([np.abs(leg.height[:, None] - height).argmin(axis=1) for leg in distinct]),
        ends=np.cumsum([leg.height.size for leg in distinct]),
        twin=twin,
        mirrored=mirrored,
        displacement=_innermost(np.concatenate([leg.displacement for leg in distinct]).transpose(2, 1, 0), 2),
        fibre=_innermost(np.concatenate([leg.fibre for leg in distinct]).transpose(3, 2, 0, 1), 2),
        static_fibre=_innermost(np.concatenate([leg.static for leg in distinct]).transpose(2, 0, 1), 1),
    )


class _Leg(NamedTuple):
    """A member of n nodes, foot first."""

    height: np.ndarray  # (n,) above its foot [m]
    displacement: np.ndarray  # (n, 3, nm)
    fibre: np.ndarray  # (n - 1, 2, 3, nm) as in Legs
    static: np.ndarray  # (n - 1, 2, 3)


def _grid(legs: list[_Leg]) -> np.ndarray:
    """Heights at which any of the legs has a node, each once."""
    every = np.sort(np.concatenate([leg.height for leg in legs]))
    return every[np.diff(every, prepend=-np.inf) > COINCIDENT * every[-1]]


def _alike(legs: list[_Leg]) -> tuple[list[_Leg], np.ndarray, np.ndarray]:
    """The legs that respond differently; which of them each leg responds like; which legs are mirrored."""
    close = SAME * max(np.abs(leg.displacement).max() for leg in legs)

    def same(i: int, j: int, seen: np.ndarray | float = 1.0) -> bool:
        return _within(legs[j].displacement, legs[i].displacement * seen, close)

    like = firsts(len(legs), lambda i, j: _same_make(legs[j], legs[i]) and (same(i, j) or same(i, j, MIRROR[:, None])))
    first, twin = np.unique(like, return_inverse=True)
    return [legs[i] for i in first], twin, np.array([not same(i, j) for j, i in enumerate(like)])


def _same_make(leg: _Leg, other: _Leg) -> bool:
    """Whether two legs have nodes at the same heights, and stresses of the same size, at rest and in each shape."""
    if leg.height.size != other.height.size:
        return False
    sizes = ((one.height, np.abs(one.fibre), compressive(one.static)) for one in (leg, other))
    return all(_within(a, b, SAME_STRESS * np.abs(b).max()) for a, b in zip(*sizes, strict=True))


def _within(a: np.ndarray, b: np.ndarray, allowed: float) -> bool:
    return bool(np.abs(a - b).max(initial=0.0) <= allowed)


def compressive(fibre: np.ndarray) -> np.ndarray:
    """Stress [Pa] of the most compressive fibre, from N/A, c My/Iy and c Mz/Iz (…, 3) [Pa].

    Exact for a circular section; c of a rectangle is half the diagonal, on the safe side of the corner's stress.
    """
    return fibre[..., 0] - np.hypot(fibre[..., 1], fibre[..., 2])


def _innermost(values: np.ndarray, kept: int) -> np.ndarray:
    """All axes after the first `kept` as one, along memory."""
    return np.ascontiguousarray(values).reshape(*values.shape[:kept], -1)


def _map(p: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Modal amplitudes (m, nm) times shapes (nm, …): (m, …)."""
    return (p @ shapes.reshape(len(shapes), -1)).reshape(len(p), *shapes.shape[1:])
