"""Linear dispersion of gravity waves."""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from solver.keys import Bits, shared

KNOWN = 64  # seas whose wavenumbers a process keeps
DEEP = 1e100  # [m] as good as infinite, of k = 0 too
SHALLOWEST = 0.1  # kh; of longer waves capytaine has no Green function


def wavenumber(omega: ArrayLike, depth: float, gravity: float = 9.81) -> np.ndarray:
    """Wavenumber k [1/m] of ω² = g k tanh(kh) for ω [rad/s] of any shape, depth h [m].

    Newton on y tanh y = ω²h/g from a start within 10 %; deep water (h = inf) is ω²/g.
    """
    omega = np.asarray(omega, dtype=float)
    deep = omega**2 / gravity
    if np.isinf(depth):
        return deep
    y0 = deep * depth
    y = np.where(y0 == 0, 0.0, y0 / np.sqrt(np.tanh(np.maximum(y0, 1e-300))))
    for _ in range(8):
        t = np.tanh(y)
        slope = t + y * (1 - t * t)
        y = y - np.where(slope > 0, (y * t - y0) / np.where(slope > 0, slope, 1.0), 0.0)
    return y / depth


def frequency(k: ArrayLike, depth: float, gravity: float) -> np.ndarray:
    """Frequency ω [rad/s] of wavenumbers k [1/m], √(gk tanh kh)."""
    k = np.asarray(k, float)
    return np.asarray(np.sqrt(gravity * k * np.tanh(k * min(depth, DEEP))))


def wavenumbers(omega: np.ndarray, depth: float, gravity: float) -> np.ndarray:
    """The same of a sea, whose parts share them."""
    return _wavenumbers(Bits(omega), depth, gravity)


@lru_cache(maxsize=KNOWN)
def _wavenumbers(omega: Bits[np.ndarray], depth: float, gravity: float) -> np.ndarray:
    return shared(wavenumber(omega.value, depth, gravity))


def group_velocity(omega: np.ndarray, depth: float, gravity: float) -> np.ndarray:
    """∂ω/∂k [m/s] at ω (nw,) [rad/s]."""
    k = wavenumbers(omega, depth, gravity)
    return omega / k * group_share(k, depth)


def group_share(k: ArrayLike, depth: float) -> np.ndarray:
    """The group's velocity over that of crests, (1 + 2kh/sinh 2kh)/2."""
    kh = np.minimum(np.multiply(k, depth), 300.0)
    share: np.ndarray = (1 + 2 * kh / np.sinh(2 * kh)) / 2
    return share


def over_depth(k: np.ndarray | float, z: np.ndarray, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """cosh k(z+h)/cosh kh and sinh k(z+h)/cosh kh at heights z (np,) [m], by exponentials that do not overflow."""
    down, up, both = np.exp(k * z), np.exp(-k * (z + 2 * depth)), 1 + np.exp(-2 * k * depth)
    return (down + up) / both, (down - up) / both


def longest(depth: float, gravity: float) -> float:
    """Frequency [rad/s] of the longest waves that have coefficients, those of kh = SHALLOWEST; 0 in deep water."""
    return float(np.sqrt(SHALLOWEST * np.tanh(SHALLOWEST) * gravity / depth))


def first_solved(depth: float, gravity: float) -> float:
    """Least frequency [rad/s] that coefficients start at, unless waves as long ask for less: just above `longest`."""
    return 1.001 * longest(depth, gravity)


def breaking_height(period: float, depth: float, gravity: float) -> float:
    """Miche's limit of a regular wave's height [m], 0.142 L tanh(kh), for its period [s]."""
    k = float(wavenumber(2 * np.pi / period, depth, gravity))
    return float(0.142 * 2 * np.pi / k * np.tanh(k * depth)) if k > 0 else np.inf
