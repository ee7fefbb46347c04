"""Natural modes of a frame, all of them or only those that a plane of symmetry lets through."""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from solver.errors import InputError
from solver.structure import lanczos
from solver.structure.frame_model import FrameModel

MIRROR_Y = np.array([1, -1, 1, -1, 1, -1])  # a displacement and an axial vector seen in the plane y = 0
SAME_PLACE = 1e-6  # share of the frame's size within which a node and a mirror image are the same
UNRESOLVED = 1e-10  # of the slowest mode's 1/ω²: what rounding leaves of those below is not exact
MOST = 3000  # degrees of freedom of which all modes are made, by time as their third power, memory as their square
LARGE, MANY = 1000, 300  # of one with more, so many in place of all, where static shapes have what the rest would add
TOLD = 12  # lowest frequencies of a large frame, of which the dataset has six
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


def frequencies(K: sparse.csr_array, M: sparse.csr_array, free: np.ndarray) -> np.ndarray:
    """Of all modes [rad/s], rising, or of a large frame's lowest; without shapes they take a third of the time."""
    stiffness, mass = (A[free][:, free] for A in (K, M))
    if free.size > lanczos.DENSE:
        return _lowest_few(stiffness, mass, TOLD)[0]
    stiffness, mass = stiffness.toarray(), mass.toarray()
    try:
        inverse = linalg.eigh(mass, stiffness, eigvals_only=True)[::-1]
    except linalg.LinAlgError:
        raise _buckled(stiffness, mass) from None
    squared = linalg.eigh(stiffness, mass, eigvals_only=True)
    slow = _slow(inverse, squared)
    return np.sqrt(np.append(1 / inverse[:slow], squared[slow:]))


def modes_in(basis: sparse.csr_array, K: sparse.csr_array, M: sparse.csr_array, count: int | None = None) -> Modes:
    """The lowest modes within the span of an orthonormal basis, sparse (6n, nb).

    Dense LAPACK: 0.2 s for all 708 modes of a platform, and as its third power for others; few of a large frame cost
    as their number. InputError where the lowest ω² is not above zero: under its weight the frame buckles.
    """
    K, M = (basis.T @ A @ basis for A in (K, M))
    if count is not None and basis.shape[1] > max(lanczos.DENSE, lanczos.FEW * count):
        omega, vectors = _lowest_few(K, M, count)
    else:
        omega, vectors = lowest(K.toarray(), M.toarray(), count)
    return Modes(omega, _signed(basis @ vectors))


def _lowest_few(K: sparse.csr_array, M: sparse.csr_array, count: int) -> tuple[np.ndarray, np.ndarray]:
    """As `lowest`, of sparse K and M: of K⁻¹M x = x/ω²."""
    factors = splu(K.tocsc())
    inverse, vectors, least = lanczos.largest(lambda x: factors.solve(M @ x), M, count)
    if least < -UNRESOLVED * abs(inverse[0]):
        raise _buckles(1 / least)
    return 1 / np.sqrt(inverse), vectors


def lowest(K: np.ndarray, M: np.ndarray, count: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """The lowest frequencies (nm,) [rad/s] and mass-normalised shapes (n, nm) of dense K and M (n, n).

    Of M x = K x/ω²: rounding is a share of the largest eigenvalue, which is the slowest mode's here; of K x = ω² M x
    it is the fastest one's, that of the stiffest and lightest member, and the slow modes would drown in it. All modes
    are the slower half of the first, by powers of ten, and the rest of the second.
    """
    n = len(K)
    inverse, vectors = _inverted(K, M, n if count is None else min(count, n))
    if inverse.size < n and inverse[-1] > UNRESOLVED * inverse[0]:
        return 1 / np.sqrt(inverse), vectors / np.sqrt(inverse)
    squared, fast = linalg.eigh(K, M)
    slow = _slow(inverse, squared)
    omega = np.sqrt(np.append(1 / inverse[:slow], squared[slow : inverse.size]))
    return omega, np.concatenate([vectors[:, :slow] / np.sqrt(inverse[:slow]), fast[:, slow : inverse.size]], axis=1)


def _slow(inverse: np.ndarray, squared: np.ndarray) -> int:
    """How many of 1/ω², falling, are in the slower half, with ω² of all, rising."""
    return int(np.sum(inverse > np.sqrt(inverse[0] / squared[-1])))


def _inverted(K: np.ndarray, M: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The largest 1/ω² (count,) of M x = K x/ω² and shapes (n, count), falling; InputError where K holds not all."""
    n = len(K)
    try:
        inverse, vectors = linalg.eigh(M, K, subset_by_index=[n - count, n - 1])
    except linalg.LinAlgError:
        raise _buckled(K, M) from None
    return inverse[::-1], vectors[:, ::-1]


def _buckled(K: np.ndarray, M: np.ndarray) -> InputError:
    """K is not positive definite: softened beyond its Euler load, with modes that cannot be marched."""
    return _buckles(linalg.eigh(K, M, eigvals_only=True, subset_by_index=[0, 0])[0])


def _buckles(squared: float) -> InputError:
    return InputError("frame: lowest omega^2", f"{squared:.3g} (rad/s)^2", "must be > 0: the frame buckles")


def static_remainder(kept: Modes, load: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """What the left-out modes add quasi-statically: K⁻¹f - Σ φ (φᵀf)/ω² over the kept ones (mode acceleration).

    Load f, its whole K⁻¹f and the answer are (6n,), or (6n, nl) for several loads.
    """
    return whole - kept.shapes @ ((kept.shapes / kept.omega**2).T @ load)


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
    near, images = SAME_PLACE * model.size, model.xyz * [1, -1, 1]
    tree = cKDTree(model.xyz)
    gap, partner = tree.query(images)
    if gap.max() > near:
        return None
    for i in {i for pair in tree.query_pairs(near) for i in pair}:  # where members cross, say
        seen = _block(model, i) * np.outer(MIRROR_Y, MIRROR_Y)
        partner[i] = min(tree.query_ball_point(images[i], near), key=partial(_unlike, model, seen))
    rows = np.arange(6 * len(partner))
    columns = (6 * partner[:, None] + np.arange(6)).ravel()
    image = sparse.csr_array((np.tile(MIRROR_Y, len(partner)).astype(float), (rows, columns)))
    same = all(abs(image @ A @ image.T - A).max() <= SAME_VALUE * abs(A).max() for A in (model.K, model.M, *others))
    return image if same and np.isin(columns[model.free], model.free).all() else None


def _block(model: FrameModel, node: int) -> np.ndarray:
    """A node's own stiffness (6, 6)."""
    at = slice(6 * node, 6 * node + 6)
    block: np.ndarray = model.K[at, at].toarray()
    return block


def _unlike(model: FrameModel, stiffness: np.ndarray, node: int) -> float:
    """How far a node's own stiffness is from another (6, 6)."""
    return float(np.abs(_block(model, node) - stiffness).max())


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
