"""The cubic spline of scipy.interpolate, to the bit, without the 0.13 s that importing it takes with all it brings."""

import numpy as np
from scipy.linalg import solve_banded


class CubicSpline:
    """Through values y (n, ...) at increasing x (n,): twice smooth, one cubic on two pieces at each end.

    Through three points a parabola, through two a straight line.

    On each piece y + s t + c t² + d t³, t from its start. The slopes s at the knots, with h = Δx and m = Δy/h, solve
    hᵢ sᵢ₋₁ + 2(hᵢ₋₁ + hᵢ) sᵢ + hᵢ₋₁ sᵢ₊₁ = 3(hᵢ mᵢ₋₁ + hᵢ₋₁ mᵢ).
    """

    def __init__(self, x: np.ndarray, y: np.ndarray):
        flat = y.reshape(len(y), -1)
        h = np.diff(x)[:, None]
        m = np.diff(flat, axis=0) / h
        slope = _slopes(x, m) if len(x) > 3 else _few_slopes(h, m)
        t = (slope[:-1] + slope[1:] - 2 * m) / h
        self.x, self.shape = x, y.shape[1:]
        self.pieces = flat[:-1], slope[:-1], (m - slope[:-1]) / h - t, t / h

    def __call__(self, at: np.ndarray | float) -> np.ndarray:
        """Values (..., ...) at any x (...): beyond the ends those of the first and last piece."""
        where = np.clip(np.searchsorted(self.x, at, side="right") - 1, 0, len(self.x) - 2)
        t = (at - self.x[where])[..., None]
        y, s, c, d = (part[where] for part in self.pieces)
        return (y + s * t + c * (t * t) + d * (t * t * t)).reshape(np.shape(at) + self.shape)


def _slopes(x: np.ndarray, m: np.ndarray) -> np.ndarray:
    """(n, k) at the knots x (n,), from those of the chords (n - 1, k)."""
    dx = np.diff(x)
    h, bands, b = dx[:, None], np.zeros((3, len(x))), np.empty((len(x), m.shape[1]), m.dtype)
    bands[1, 1:-1], bands[0, 2:], bands[2, :-2] = 2 * (dx[:-1] + dx[1:]), dx[:-1], dx[1:]
    b[1:-1] = 3 * (h[1:] * m[:-1] + h[:-1] * m[1:])
    first, last = x[2] - x[0], x[-1] - x[-3]
    bands[1, 0], bands[0, 1], bands[1, -1], bands[2, -2] = dx[1], first, dx[-2], last
    b[0] = ((dx[0] + 2 * first) * dx[1] * m[0] + dx[0] ** 2 * m[1]) / first
    b[-1] = (dx[-1] ** 2 * m[-2] + (2 * last + dx[-1]) * dx[-2] * m[-1]) / last
    return np.asarray(solve_banded((1, 1), bands, b))


def _few_slopes(h: np.ndarray, m: np.ndarray) -> np.ndarray:
    """The same of one or two chords, h wide."""
    if len(m) == 1:
        return np.concatenate([m, m])
    middle = (h[1:] * m[:-1] + h[:-1] * m[1:]) / (h[1:] + h[:-1])
    return np.concatenate([2 * m[:1] - middle, middle, 2 * m[1:] - middle])
