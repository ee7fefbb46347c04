"""Few eigenvalues of large sparse matrices: Lanczos's method by blocks (Golub and Underwood 1977), all of them kept.

A block as wide as what is asked for, up to WIDEST, holds as many equal ones. It begins anywhere, at the same place in
each process.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import linalg, sparse

DENSE = 1000  # rows up to which LAPACK finds all of a full matrix about as fast
FEW = 3  # less than one in so many
WIDEST = 40  # columns of a block: of many values narrower ones need fewer products in all
OFTEN = 1.25  # times as large a basis, then, from one look at its values to the next
SPARE = 2  # columns of a block beyond those asked for, which converge sooner for it
EXACT = 1e-9  # of a value: what a shape may lack, of which the value lacks the square
ROUNDING = 1e-12  # of the value farthest from zero, which no value is told better than
DEPENDENT = 1e-14  # share of a block's largest square: columns below it are rounding of others


class Largest(NamedTuple):
    """Of A x = μ x, with xᵀGx = 1."""

    value: np.ndarray  # (count,) falling
    shapes: np.ndarray  # (n, count)
    least: float  # about the smallest of all μ


def largest(A: Callable[[np.ndarray], np.ndarray], G: sparse.csr_array, count: int, least: float = ROUNDING) -> Largest:
    """The largest μ of an operator on columns (n, b) that is symmetric in the product xᵀGy, G positive definite.

    least: share of the μ farthest from zero that a shape may lack, however small its own is.
    """
    n, narrow = G.shape[0], count + SPARE > WIDEST
    block = _orthonormal(np.random.default_rng(0).standard_normal((n, min(count + SPARE, WIDEST, n))), G)[0]
    basis, T, look = block, np.zeros((0, 0)), 2 * count if narrow else 0
    while True:
        image, known = A(block), len(T)
        within = basis.T @ (G @ image)
        rest = image - basis @ within
        rest -= basis @ (basis.T @ (G @ rest))  # rounding of the difference
        T = np.block([[T, within[:known]], [within[:known].T, (within[known:] + within[known:].T) / 2]])
        block, size = _orthonormal(rest, G)
        last = not 0 < block.shape[1] <= n - basis.shape[1]
        if last or len(T) >= look:
            look = int(OFTEN * len(T)) if narrow else 0
            value, mix = linalg.eigh(T)
            lacking = np.linalg.norm(size @ mix[known:, -count:], axis=0)
            enough = np.maximum(EXACT * value[-count:], least * np.abs(value).max())
            if last or np.all(lacking <= enough):
                return Largest(value[: -count - 1 : -1], basis @ mix[:, : -count - 1 : -1], float(value[0]))
        basis = np.concatenate([basis, block], axis=1)


def _orthonormal(columns: np.ndarray, G: sparse.csr_array) -> tuple[np.ndarray, np.ndarray]:
    """Q (n, r) and R (r, b) with QR = columns (n, b) and QᵀGQ = 1; r < b where these depend on each other.

    By the Gram matrix, twice, for once leaves as much rounding as its smallest eigenvalue is less than the largest.
    """
    R = np.eye(columns.shape[1])
    for _ in range(2):
        square, vectors = linalg.eigh(columns.T @ (G @ columns))
        kept = square > DEPENDENT * square[-1]
        root = np.sqrt(square[kept])
        columns, R = columns @ (vectors[:, kept] / root), root[:, None] * (vectors[:, kept].T @ R)
    return columns, R
