"""Natural modes of a frame, all of them or only those that a plane of symmetry lets through."""

from typing import NamedTuple

import numpy as np
from scipy import linalg, sparse
from scipy.spatial import cKDTree

from solver.errors import InputError
from solver.structure.frame import FrameModel
from solver.structure.statics import static

MIRROR_Y = np.array([1, -1, 1, -1, 1, -1])  # a displacement and an axial vector seen in the plane y = 0
SAME_PLACE = 1e-6  # share of the frame's size within which a node and a mirror image are the same
SAME_VALUE = 1e-9  # rounding of K and M, relative to their largest entry


class Modes(NamedTuple):
    """Mass-normalised natural modes: ΦᵀMΦ = I, ΦᵀKΦ = diag(ω²)."""

    omega: np.ndarray  # (nm,) rising [rad/s]
    shapes: np.ndarray  # (6n, nm), zero on clamped degrees of freedom


def modes(K: sparse.csr_array, M: sparse.csr_array, free: np.ndarray, count: int | None = None) -> Modes:
    """The lowest `count` modes (default: all) of (K - ω²M)φ = 0 on the free degrees of freedom: those of eq. 17.

    K, M: sparse (6n, 6n); free: numbers of the degrees of freedom that are not clamped.
    """
    return modes_in(_columns(free, np.arange(len(free)), np.ones(len(free)), K.shape[0]), K, M, count)


def modes_in(basis: sparse.csr_array, K: sparse.csr_array, M: sparse.csr_array, count: int | None = None) -> Modes:
    """The lowest modes within the span of an orthonormal basis, sparse (6n, nb).

    Dense LAPACK: 0.2 s for all 708 modes of a platform. InputError where the lowest ω² is not above zero: under its
    weight the frame buckles.
    """
    reduced = [(basis.T @ matrix @ basis).toarray() for matrix in (K, M)]
    window = None if count is None else [0, min(count, basis.shape[1]) - 1]
    squared, vectors = linalg.eigh(*reduced, subset_by_index=window)
    # A frame softened beyond its Euler load has ω² < 0: not a mode that can be marched.
    if squared[0] <= 0:
        raise InputError("frame: lowest omega^2", f"{squared[0]:.3g} (rad/s)^2", "must be > 0: the frame buckles")
    return Modes(np.sqrt(squared), _signed(basis @ vectors))


def static_remainder(model: FrameModel, kept: Modes, load: np.ndarray) -> np.ndarray:
    """What the left-out modes add quasi-statically: K⁻¹f - Σ φ (φᵀf)/ω² over the kept ones (mode acceleration).

    Load and answer are (6n,), or (6n, nl) for several loads.
    """
    return static(model, load) - kept.shapes @ ((kept.shapes / kept.omega**2).T @ load)


def _signed(shapes: np.ndarray) -> np.ndarray:
    """Largest component positive; the first of equals, or rounding would choose the sign."""
    size = np.abs(shapes)
    leading = np.argmax(size > (1 - 1e-6) * size.max(axis=0), axis=0)
    return shapes * np.sign(shapes[leading, np.arange(shapes.shape[1])])


def mirror(model: FrameModel, *others: sparse.csr_array) -> sparse.csr_array | None:
    """Mirror image about the plane y = 0 of every displacement, sparse (6n, 6n).

    None if the frame is not symmetric: nodes must pair up, and K, M, the supports and other matrices (6n, 6n),
    such as the water's, must not change in the mirror.
    """
    size = np.ptp(model.xyz, axis=0).max()
    gap, partner = cKDTree(model.xyz).query(model.xyz * [1, -1, 1])
    if gap.max() > SAME_PLACE * size:
        return None
    rows = np.arange(6 * len(partner))
    columns = (6 * partner[:, None] + np.arange(6)).ravel()
    image = sparse.csr_array((np.tile(MIRROR_Y, len(partner)).astype(float), (rows, columns)))
    same = all(abs(image @ A @ image.T - A).max() <= SAME_VALUE * abs(A).max() for A in (model.K, model.M, *others))
    return image if same and np.isin(columns[model.free], model.free).all() else None


def symmetric_basis(model: FrameModel, *others: sparse.csr_array) -> sparse.csr_array | None:
    """Orthonormal basis of the displacements symmetric in y = 0, sparse (6n, nb).

    Waves along x load a symmetric platform only through these. None if the frame is not symmetric, see mirror.
    """
    image = mirror(model, *others)
    if image is None:
        return None
    here = model.free
    there, sign = image.indices[here], image.data[here]
    pair = here < there
    alone = (here == there) & (sign > 0)
    order = np.arange(pair.sum())
    both = _columns(here[pair], order, np.sqrt(0.5) * np.ones(len(order)), len(image.data))
    both = both + _columns(there[pair], order, np.sqrt(0.5) * sign[pair], len(image.data))
    in_plane = _columns(here[alone], np.arange(alone.sum()), np.ones(alone.sum()), len(image.data))
    return sparse.csr_array(sparse.hstack([both, in_plane]))


def _columns(rows: np.ndarray, columns: np.ndarray, values: np.ndarray, size: int) -> sparse.csr_array:
    return sparse.csr_array((values, (rows, columns)), shape=(size, len(columns)))
