"""What is put out along the legs: displacements and fibre stresses as linear maps of modal amplitudes."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.errors import InputError
from solver.kernels import fast_lean_kernel
from solver.statistics import vertex
from solver.structure import recovery, statics, water
from solver.structure.frame import FrameModel

BENDING = [0, 4, 5]  # N, My, Mz among the section forces


class Largest(NamedTuple):
    """Over all samples so far, of no legs."""

    square: np.ndarray  # (no nh,) of the displacement [m²]
    stress: np.ndarray  # (no ne 2,) magnitude [Pa]
    last_square: np.ndarray  # (2, no nh) the last two samples
    last_stress: np.ndarray


@dataclass(frozen=True, eq=False, kw_only=True)
class Legs:
    """Maps for nl legs of nh nodes, of which no respond each in their own way (mirror images do not)."""

    height: np.ndarray  # (nh,) above the leg's foot [m]
    twin: np.ndarray  # (nl,) which of the no legs responds like it, or as its mirror image in y = 0
    mirrored: np.ndarray  # (nl,) bool
    displacement: np.ndarray  # (nm, 3, no nh) [m]
    fibre: np.ndarray  # (nm, 3, no ne 2) N/A, c My/Iy, c Mz/Iz at both ends of each element [Pa]
    static_fibre: np.ndarray  # (3, no ne 2)

    @property
    def own(self) -> int:
        """Number of legs that respond each in their own way, no."""
        return int(self.twin.max(initial=-1)) + 1

    def nothing(self) -> Largest:
        """The largest values before the first sample."""
        nd, nf = self.displacement.shape[2], self.fibre.shape[2]
        return Largest(np.zeros(nd), np.zeros(nf), np.full((2, nd), np.nan), np.full((2, nf), np.nan))

    def response(self, p: np.ndarray, largest: Largest) -> tuple[np.ndarray, np.ndarray]:
        """Displacement of the tops (m, nl, 3) [m] and stress at the feet (m, nl) [Pa]; updates `largest`.

        The stress is that of the most compressive fibre, σ = N/A - ((c My/Iy)² + (c Mz/Iz)²)^½.
        """
        u, fibre = _map(p, self.displacement), _map(p, self.fibre)
        feet = np.empty((len(p), self.own))
        _respond(u, fibre, self.static_fibre, feet, *largest)
        tops = u.reshape(len(p), 3, self.own, -1)[..., -1].swapaxes(1, 2)[:, self.twin]
        return tops * np.where(self.mirrored[:, None], [1.0, -1.0, 1.0], 1.0), feet[:, self.twin]

    def envelopes(self, largest: Largest) -> tuple[np.ndarray, np.ndarray]:
        """Displacement (nl, nh) [m] and stress (nl, nh) [Pa]."""
        square, stress = largest.square.reshape(self.own, -1), largest.stress.reshape(self.own, -1, 2)
        return np.sqrt(square)[self.twin], at_nodes(stress)[self.twin]


@fast_lean_kernel
def _respond(u, fibre, static, feet, square, stress, last_square, last_stress):
    """Stress at the feet (m, no) and largest values, from displacements and fibres, sample by sample in place."""
    points = stress.size // feet.shape[1]
    for i in range(feet.shape[0]):
        for j in range(square.size):
            _take(u[i, 0, j] ** 2 + u[i, 1, j] ** 2 + u[i, 2, j] ** 2, j, square, last_square)
        axial, about_y, about_z = fibre[i, 0], fibre[i, 1], fibre[i, 2]
        for j in range(stress.size):
            axial[j] += static[0, j] - np.sqrt((about_y[j] + static[1, j]) ** 2 + (about_z[j] + static[2, j]) ** 2)
            _take(abs(axial[j]), j, stress, last_stress)
        for leg in range(feet.shape[1]):
            feet[i, leg] = axial[leg * points]


@fast_lean_kernel(inline="always")
def _take(new, j, largest, last):
    """A value >= 0, and the parabola through it and the two before: it rises above them by an eighth at most."""
    older, old = last[0, j], last[1, j]
    last[0, j], last[1, j] = old, new
    largest[j] = max(largest[j], new)
    if 1.125 * old > largest[j]:
        largest[j] = max(largest[j], vertex(older, old, new))


def at_nodes(ends: np.ndarray) -> np.ndarray:
    """Of the values (…, ne, 2) at the elements' ends, the larger of those that meet at each node, (…, ne + 1)."""
    first, last = ends[..., :1, 0], ends[..., -1:, 1]
    return np.concatenate([first, np.maximum(ends[..., 1:, 0], ends[..., :-1, 1]), last], axis=-1)


def outputs(names, model: FrameModel, sea, at_rest: np.ndarray, shapes: np.ndarray) -> Legs:
    """Maps for the named members from the basis shapes (6n, nm), with the static forces of rest."""
    nm = shapes.shape[1]
    loads = statics.self_weight(model, sea.gravity) + water.buoyancy(model, sea.density, sea.gravity)
    still = recovery.section_forces(model, at_rest, loads).reshape(-1, 2, 6)[..., BENDING]
    moving = (recovery.section_force_matrix(model) @ shapes).reshape(-1, 2, 6, nm)[:, :, BENDING]
    A, Iy, Iz, c = np.moveaxis(recovery.section_properties(model).reshape(-1, 2, 4), -1, 0)
    to_stress = np.stack([1 / A, c / Iy, c / Iz], axis=-1)
    still, moving = still * to_stress, moving * to_stress[..., None]
    counts = {leg: len(model.member_elements[leg]) for leg in names}
    if len(set(counts.values())) > 1:
        raise InputError("platform.legs", counts, "must have as many elements each: they share the heights")
    displacement, fibre, static = [], [], []
    for leg in names:
        nodes, elements = model.member_nodes[leg], np.array(model.member_elements[leg])
        end = slice(None)
        if model.xyz[nodes[0], 2] > model.xyz[nodes[-1], 2]:  # foot first
            nodes, elements, end = nodes[::-1], elements[::-1], slice(None, None, -1)
        displacement.append(shapes.reshape(-1, 6, nm)[nodes, :3])
        fibre.append(moving[elements][:, end])
        static.append(still[elements][:, end])
    own, twin, mirrored = _alike(np.array(displacement))
    return Legs(
        height=model.xyz[nodes, 2] - model.xyz[nodes[0], 2],
        twin=twin,
        mirrored=mirrored,
        displacement=_innermost(np.array(displacement)[own].transpose(3, 2, 0, 1), 2),
        fibre=_innermost(np.array(fibre)[own].transpose(4, 3, 0, 1, 2), 2),
        static_fibre=_innermost(np.array(static)[own].transpose(3, 0, 1, 2), 1),
    )


def _alike(displacement: np.ndarray) -> tuple[list[int], np.ndarray, np.ndarray]:
    """Of legs (nl, nh, 3, nm) those whose response is their own; which of them each follows; which are mirrored."""
    own: list[int] = []
    twin, mirrored = np.zeros(len(displacement), int), np.zeros(len(displacement), bool)
    mirror, close = np.array([1.0, -1.0, 1.0])[:, None], 1e-9 * np.abs(displacement).max()
    for i, leg in enumerate(displacement):
        for place, j in enumerate(own):
            same = np.allclose(leg, displacement[j], rtol=0, atol=close)
            if same or np.allclose(leg, displacement[j] * mirror, rtol=0, atol=close):
                twin[i], mirrored[i] = place, not same
                break
        else:
            twin[i] = len(own)
            own.append(i)
    return own, twin, mirrored


def _innermost(values: np.ndarray, kept: int) -> np.ndarray:
    """All axes after the first `kept` as one, along memory."""
    return np.ascontiguousarray(values).reshape(*values.shape[:kept], -1)


def _map(p: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Modal amplitudes (m, nm) times shapes (nm, …): (m, …)."""
    return (p @ shapes.reshape(len(shapes), -1)).reshape(len(p), *shapes.shape[1:])
