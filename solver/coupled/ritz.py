"""Ritz shapes of a frame: its lowest modes, those that load histories set swinging, and static ones of loads."""

from collections.abc import Iterable
from functools import lru_cache

import numpy as np
from scipy import linalg, sparse

from solver.errors import InputError
from solver.scene import Platform, StructuralDamping
from solver.structure import modes as natural
from solver.structure import statics, water
from solver.structure.frame_model import FrameModel
from solver.structure.load_history import LoadHistory
from solver.structure.ringing import lines, sizes

SWUNG = 3e-3  # of all that load histories move: modes that they set swinging by more are kept
FAR_LESS = 0.1  # of the leg's top that moves most: what moves by less is not judged
FAINT = 0.01  # the same of the forces on the ground along x, y and z
PATTERN = 1e-3  # principal wave-load shapes smaller than this share of the largest are left out
KNOWN = 8  # frames whose modes a process keeps


@lru_cache(maxsize=KNOWN)
def kept_modes(
    model: FrameModel, density: float, planar: bool, count: int | None
) -> tuple[sparse.csr_array, natural.Modes, sparse.csr_array | None]:
    """Mass with the water's, and the lowest modes; in a planar scene the symmetric ones and the basis of all
    symmetric displacements, else None."""
    added = water.added_mass(model, density)
    M = model.M + added
    if not planar:
        return M, natural.modes(model.K, M, model.free, count), None
    symmetric = natural.symmetric_basis(model, added, water.drag_matrix(model))
    if symmetric is None:
        limit = "a planar scene needs a symmetric frame, its coefficients of drag and inertia included"
        raise InputError("platform.frame", "not symmetric in y = 0", limit)
    return M, natural.modes_in(symmetric, model.K, M, count), symmetric


def with_swung(
    every: natural.Modes,
    lowest: int,
    platform: Platform,
    applied: np.ndarray,
    model: FrameModel,
    M: sparse.csr_array,
    damping: StructuralDamping,
) -> tuple[natural.Modes, float]:
    """The lowest modes and those that the loads set swinging, of a frame by itself; and `unswung`.

    By strain energy, by what the legs' tops do and by what the ground bears: a mode that stretches a mast moves next to
    nothing and carries all of its axial force. applied (na, nm): modal load of unit forces.
    """
    omega, shapes = every
    ratio = damping.of(omega, np.einsum("ij,ij->j", shapes, model.M @ shapes))
    end = min(history.time[-1] for history in platform.load_histories)
    told = sizes(lines(platform.load_histories, end), omega, ratio, applied)
    of_tops = np.abs(shapes[tops_of(model, platform.legs)]) / omega
    on_ground = omega * np.abs(thrust(M, shapes))
    parts = ((np.ones((1, omega.size)), 0.0), (of_tops, FAR_LESS), (on_ground, FAINT))
    moved = np.hypot(told.swings, told.pushed)
    swings = np.concatenate(
        [of_whole(does, told.swings, np.linalg.norm(does * moved, axis=1), least) for does, least in parts]
    )
    kept = (np.arange(omega.size) < lowest) | (swings.max(axis=0, initial=0.0) > SWUNG)
    left = np.linalg.norm(swings[:, ~kept], axis=1).max(initial=0.0)
    return natural.Modes(omega[kept], shapes[:, kept]), float(left)


def of_whole(does: np.ndarray, swings: np.ndarray, whole: np.ndarray, least: float) -> np.ndarray:
    """What modes' swings (nm,) do, `does` (k, nm) for a unit, of the `whole` (k,) of each, where that is more than
    `least` of the largest."""
    judged = whole > least * whole.max(initial=0.0)
    return does[judged] * swings / whole[judged, None]


def thrust(M: sparse.csr_array, shapes: np.ndarray) -> np.ndarray:
    """Force on the ground along x, y, z for unit -q̈ of each mode, tᵀMφ of the frame's shifts t: (3, nm) [kg^½]."""
    shifts = np.tile(np.eye(6)[:3], len(shapes) // 6)
    return np.asarray(shifts @ (M @ shapes))


def loaded_by(model: FrameModel, histories: Iterable[LoadHistory]) -> np.ndarray:
    """Degrees of freedom (na,) that load histories act on, one after another."""
    return np.concatenate([np.zeros(0, int), *(model.translations(h.node)[h.axes] for h in histories)])


def unit_loads(size: int, dof: np.ndarray) -> np.ndarray:
    """One on each of some degrees of freedom (size, nd)."""
    unit = np.zeros((size, dof.size))
    unit[dof, np.arange(dof.size)] = 1.0
    return unit


def ritz_basis(
    model: FrameModel,
    M: sparse.csr_array,
    kept: natural.Modes,
    symmetric: sparse.csr_array | None,
    steady: np.ndarray,
    patterns: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Ritz frequencies and shapes (6n, nm), mass-normalised with M.

    Static shapes of each of the loads `steady` (6n, ns), and the principal ones of the waves', `patterns` (6n, n), of
    which moments are over the frame's size.
    """
    if symmetric is None:
        principal = _principal(patterns)
    else:  # in half the rows, and those of the clamped nodes, whose loads move nothing but count in what is principal
        clamped = np.setdiff1d(np.arange(len(patterns)), model.free)
        few = _principal(np.concatenate([symmetric.T @ patterns, patterns[clamped]]))
        principal = symmetric @ few[: symmetric.shape[1]]
    load = np.concatenate([steady, principal * model.arms[:, None]], axis=1)
    # Only what the kept modes lack: without this the large common part would hide the rest.
    whole = statics.static(model, load)
    rest = natural.static_remainder(kept, load, whole)
    if symmetric is not None:
        rest = symmetric @ (symmetric.T @ rest)  # rounding of the difference is not, and legs would differ by it
    size = np.sqrt(np.einsum("ij,ij->j", rest, M @ rest))
    new = size > 1e-9 * np.sqrt(np.einsum("ij,ij->j", whole, M @ whole))
    rest = rest[:, new] / size[new]
    value, vector = linalg.eigh(rest.T @ (M @ rest))
    used = value > 1e-10
    basis = np.concatenate([kept.shapes, rest @ (vector[:, used] / np.sqrt(value[used]))], axis=1)
    omega, mix = natural.lowest(basis.T @ (model.K @ basis), basis.T @ (M @ basis))
    return omega, basis @ mix


def _principal(patterns: np.ndarray) -> np.ndarray:
    """Orthonormal shapes (6n, r) of loads (6n, m), without what is less than PATTERN of the largest.

    By the smaller Gram matrix, whose rounding is far below PATTERN²; most rows are of dry nodes or have no load.
    """
    loaded = patterns.any(axis=1)
    rows = patterns[loaded]
    few = len(rows) < rows.shape[1]
    squares, vectors = linalg.eigh(rows @ rows.T if few else rows.T @ rows)
    large = squares > PATTERN**2 * squares.max(initial=0.0)
    principal = np.zeros((len(patterns), np.sum(large)))
    principal[loaded] = vectors[:, large] if few else rows @ (vectors[:, large] / np.sqrt(squares[large]))
    return principal


def tops_of(model: FrameModel, names: Iterable[str]) -> np.ndarray:
    """Degrees of freedom (nt,): x, y and z of each leg's upper end."""
    ends = [model.member_nodes[name][[0, -1]] for name in names]
    nodes = np.array([pair[np.argmax(model.xyz[pair, 2])] for pair in ends], int)
    return (6 * nodes[:, None] + np.arange(3)).ravel()


def rest_of(
    model: FrameModel, tops: np.ndarray, symmetric: sparse.csr_array | None, omega: np.ndarray, shapes: np.ndarray
) -> np.ndarray:
    """(6n, nt): displacement of some degrees of freedom (nt,) for unit loads, less that in the shapes, φ φᵀ/ω²."""
    unit = unit_loads(len(shapes), tops)
    if symmetric is not None:
        unit = symmetric @ (symmetric.T @ unit)
    return statics.static(model, unit) - shapes @ (shapes[tops] / omega**2).T
