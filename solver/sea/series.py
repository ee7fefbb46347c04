"""Samples in time of what the waves drive: rows of their quantities, see solver.sea.field, as real matrix products."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import linalg

ROUNDING = 1e-14  # of what is factored: sums of 130 waves are little better
MANY = 8  # rows for each number in one, of which few are looked at first
WINDOWS = 2  # of a block: in shorter ones fewer instants are independent, but each is summed by itself


class Factored(NamedTuple):
    """Rows (m, n) = spread (m, r) @ basis (r, n), to rounding."""

    spread: np.ndarray
    basis: np.ndarray


def factored(rows: np.ndarray, size: np.ndarray) -> Factored:
    """Complex rows (m, n) by what is independent among them with real factors, each to ROUNDING of a size (m,)."""
    n = rows.shape[1]
    both = np.concatenate([rows.real, rows.imag], axis=1)
    both /= np.where(size > 0, size, 1.0)[:, None]
    spread, basis = factors(both)
    return Factored(size[:, None] * spread, basis[:, :n] + 1j * basis[:, n:])


class WaveSeries:
    """Samples of all rows at t = n·step, block after block, under the ramp.

    Neighbouring points of a narrow sea move nearly alike, and so do neighbouring instants: rows and instants
    are both factored into what is independent to rounding, and only that is summed over the waves. About the
    middle of a window cosines are even and sines odd, so that half of it tells the other.
    """

    def __init__(
        self,
        rows: Factored,
        omega: np.ndarray,
        step: float,
        block: int,
        ramp: Callable[[np.ndarray], np.ndarray],
        besides: Callable[[np.ndarray, np.ndarray], None] | None = None,
    ) -> None:
        """ramp(t) -> factor (…,); blocks of `block` samples; besides(t, y) adds what no wave drives."""
        self.rows, self.omega, self.step, self.ramp, self.besides = rows, omega, step, ramp, besides
        self.even, self.odd = _instants(tuple(omega.tolist()), step, -(-(block - 1) // (2 * WINDOWS)) or 1)

    def block(self, first: int, count: int) -> np.ndarray:
        """y (count, m) at samples first … first + count - 1, C-contiguous."""
        half = len(self.even.spread) - 1
        middles = range(half, max(count - 1, 1) + half, 2 * half)
        y = np.empty((middles[-1] + half + 1, len(self.rows.spread)))
        for middle in middles:
            # Re{W e^{-iω(t₀+τ)}} = Re(W e^{-iωt₀}) cos ωτ + Im(W e^{-iωt₀}) sin ωτ, t₀ that of the middle
            # exactly, so that nothing drifts over long records.
            turned = self.rows.basis * np.exp(-1j * self.omega * ((first + middle) * self.step))
            even, odd = (
                side.spread @ (side.basis @ part.T @ self.rows.spread.T)
                for side, part in ((self.even, turned.real), (self.odd, turned.imag))
            )
            np.subtract(even, odd, out=y[middle - half : middle + 1][::-1])
            np.add(even, odd, out=y[middle : middle + half + 1])
        y, t = y[:count], (first + np.arange(count)) * self.step
        if not np.all((grown := self.ramp(t)) == 1.0):
            y *= grown[:, None]
        if self.besides is not None:
            self.besides(t, y)
        return y


@lru_cache(maxsize=4)
def _instants(omega: tuple[float, ...], step: float, half: int) -> tuple[Factored, Factored]:
    """cos ωτ and sin ωτ at 0 … half steps from a window's middle (half + 1, n); runs in the same sea share them."""
    phase = np.outer(step * np.arange(half + 1), omega)
    return factors(np.cos(phase)), factors(np.sin(phase))


def factors(matrix: np.ndarray) -> Factored:
    """Of real rows (m, n), to ROUNDING of the largest: r of them, and sums of these; of MANY by orthogonal ones."""
    if len(matrix) > MANY * matrix.shape[1]:
        return _of_many(matrix)
    order, sums = independent(matrix.T, ROUNDING)
    r = len(sums)
    spread = np.zeros((len(matrix), r))
    spread[order[:r], range(r)], spread[order[r:]] = 1.0, sums.T
    return Factored(spread, matrix[order[:r]])


def _of_many(matrix: np.ndarray) -> Factored:
    """By the space of some rows, and of some of those that this leaves, until none is left."""
    n, left, Q = matrix.shape[1], matrix, np.zeros((matrix.shape[1], 0))
    least = ROUNDING * np.linalg.norm(matrix, axis=1).max()
    while (more := np.flatnonzero(np.linalg.norm(left, axis=1) > least)).size:
        some = left[more[:: 1 + more.size // n]].T
        q, upper, _ = linalg.qr(some, mode="economic", pivoting=True, check_finite=False)
        rank = np.sum(np.abs(np.diag(upper)) > 0.5 * least)
        Q = linalg.qr(np.concatenate([Q, q[:, :rank]], axis=1), mode="economic", check_finite=False)[0]
        left = (matrix @ Q) @ Q.T
        np.subtract(matrix, left, out=left)
    return Factored(matrix @ Q, Q.T)


def independent(columns: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Order of columns (k, n) in which the others are sums of the first r, and by which (r, n - r).

    No more than `tolerance` of the largest is left by a QR decomposition with pivots.
    """
    if not columns.any():
        return np.arange(columns.shape[1]), np.zeros((0, columns.shape[1]))
    upper, order = linalg.qr(columns, mode="r", pivoting=True, check_finite=False)
    pivots = np.abs(np.diag(upper))
    r = int(np.sum(pivots > tolerance * pivots[0]))
    return order, linalg.solve_triangular(upper[:r, :r], upper[:r, r:], check_finite=False)
