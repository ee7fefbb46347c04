"""Quadratic drag as the linear one that differs least from it in mean square: |u|u ≈ K u.

Over all instants of u, K = ⟨|u|u uᵀ⟩⟨u uᵀ⟩⁻¹. For a Gaussian u that is ⟨∂(|u|u)/∂u⟩ = ⟨|u| I + u uᵀ/|u|⟩, in one
direction √(8/π) σ (Borgman 1969); for one harmonic of amplitude U it is 8U/3π (Lorentz).
"""

import numpy as np
from scipy.special import ellipe, ellipkm1

PHASES = 64  # of a harmonic: its mean of |u|³ is then exact to 1e-5
ROUND = 1e-6  # of two variances that count as the same


def of_gaussian(S: np.ndarray) -> np.ndarray:
    """K (…, d, d) [m/s] of Gaussian velocities with covariance S (…, d, d) [m²/s²] that lie in a plane.

    With variances a ≥ b in that plane, m = 1 - b/a, and complete elliptic integrals E(m), K(m): mean speed
    √(2a/π) E, and ⟨u₁²/|u|⟩ = √(2a/π) (E - (b/a) K)/m; the other direction has the rest of the mean speed.
    """
    value, axis = np.linalg.eigh(S)
    a = value[..., -1].clip(min=0.0)
    b = value[..., -2].clip(min=0.0) if S.shape[-1] > 1 else np.zeros(a.shape)
    ratio = np.divide(b, a, out=np.ones(a.shape), where=a > 0)
    m = np.maximum(1 - ratio, ROUND)
    speed = np.sqrt(2 * a / np.pi) * ellipe(m)
    second = ratio * np.where(ratio > 0, ellipkm1(np.maximum(1 - m, np.finfo(float).tiny)), 0.0)
    along = np.where(1 - ratio > ROUND, np.sqrt(2 * a / np.pi) * (ellipe(m) - second) / m, speed / 2)
    K = np.broadcast_to(speed[..., None], value.shape).copy()
    K[..., -1] += along
    if S.shape[-1] > 1:
        K[..., -2] += speed - along
    return np.einsum("...ij,...j,...kj->...ik", axis, K, axis)


def of_harmonic(U: np.ndarray) -> np.ndarray:
    """K (…, d, d) [m/s] of velocities Re{U exp(-iωt)}, U (…, d) [m/s]."""
    turn = np.exp(-2j * np.pi * np.arange(PHASES) / PHASES)
    u = (U[..., None] * turn).real
    size = np.linalg.norm(u, axis=-2, keepdims=True)
    return (size * u) @ np.swapaxes(u, -1, -2) @ np.linalg.pinv(u @ np.swapaxes(u, -1, -2), hermitian=True)


def of_lines(u: np.ndarray) -> np.ndarray:
    """K (n, d, d) of velocities of lines (nw, d, n): of one harmonic, or of a Gaussian process."""
    return of_parts(np.concatenate([u.real, u.imag]))


def of_parts(u: np.ndarray) -> np.ndarray:
    """The same of lines as their real parts above their imaginary ones (2 nw, d, n)."""
    if len(u) == 2:
        return of_harmonic((u[0] + 1j * u[1]).T)
    d, n = u.shape[1:]
    S = np.empty((n, d, d))
    for i, j in np.ndindex(d, d):
        S[:, i, j] = S[:, j, i] if j < i else 0.5 * np.einsum("ws,ws->s", u[:, i], u[:, j])
    return of_gaussian(S)


def by_station(K: np.ndarray, u: np.ndarray) -> np.ndarray:
    """K u (m, d, n) of vectors u (m, d, n) at n stations, K (n, d, d) symmetric."""
    d = range(u.shape[1])
    return np.stack([sum(K[:, i, j] * u[:, j] for j in d) for i in d], axis=1)
