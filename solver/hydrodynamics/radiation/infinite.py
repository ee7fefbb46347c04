"""Added mass at infinite frequency from the rest: what causality says of A and B.

A(ω) - A∞ = 2/π ⨍ B(s)/(s² - ω²) ds over s > 0 (Kramers and Kronig; Ogilvie 1964), a principal value.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

NODES = 801  # of B within the band, straight between them
TAIL = 201  # beyond it, up to FARTHEST times its end
FARTHEST = 300.0
FALL = 2.0, 12.0  # least and largest power of ω with which B falls beyond the band
DOUBT = 0.5
WITHIN = 0.25, 0.75  # shares of the band at which A∞ is asked for: far from its ends


class Infinite(NamedTuple):
    """Added mass at infinite frequency, and what speaks against it, each (n, n)."""

    value: np.ndarray
    scatter: np.ndarray  # its standard deviation over the band, 0 where A and B go together
    beyond: np.ndarray  # how far B beyond the band may put it off


def infinite_added_mass(omega: np.ndarray, added_mass: np.ndarray, damping: np.ndarray) -> Infinite:
    """A∞ of A, B (nw, n, n) at increasing ω (nw,) [rad/s].

    B is a spline from B(0) = 0 through the samples and goes on as a power of ω, as its last quarter falls.
    """
    shape = added_mass.shape[1:]
    B, A = damping.reshape(len(omega), -1), added_mass.reshape(len(omega), -1)
    inner = np.linspace(0, omega[-1], NODES)
    outer = omega[-1] * np.geomspace(1, FARTHEST, TAIL)[1:]
    quarter = len(omega) * 3 // 4
    fall = np.log(np.maximum(np.abs(B[quarter]), 1e-300) / np.maximum(np.abs(B[-1]), 1e-300))
    power = np.clip(fall / np.log(omega[-1] / omega[quarter]), *FALL)
    within = CubicSpline(np.concatenate([[0.0], omega]), np.vstack([0 * B[:1], B]))(inner)
    values = np.vstack([within, B[-1] * (omega[-1] / outer[:, None]) ** power])
    low, high = omega[0] + np.multiply(WITHIN, omega[-1] - omega[0])
    # Half-way between nodes, where the principal value of a straight piece is its logarithms.
    at = (inner[1:] + inner[:-1])[(inner[1:] > low) & (inner[:-1] < high)] / 2
    weights = 2 / np.pi * _principal(np.concatenate([inner, outer]), at)
    follows = CubicSpline(omega, A)(at) - weights @ values
    beyond = DOUBT * np.abs(weights[:, NODES:] @ values[NODES:]).mean(axis=0)
    beyond += np.where(fall < FALL[0], 2 / np.pi * np.abs(B[-1]) / omega[-1], 0.0)  # where B has not begun to fall
    return Infinite(*(x.reshape(shape) for x in (follows.mean(axis=0), follows.std(axis=0), beyond)))


def _principal(s: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights (len(at), len(s)) of nodal values in ⨍ f(s)/(s² - ω²) ds, f straight between nodes s, ω = at."""
    w = at[:, None]
    plain = np.diff(np.log(np.abs((s - w) / (s + w))), axis=1) / (2 * w)  # ∫ ds/(s² - ω²) over each piece
    first = np.diff(np.log(np.abs(s**2 - w**2)), axis=1) / 2  # ∫ s ds/(s² - ω²)
    step = np.diff(s)
    weights = np.zeros((len(at), len(s)))
    weights[:, :-1] += (s[1:] * plain - first) / step
    weights[:, 1:] += (first - s[:-1] * plain) / step
    return weights
