"""Radiation memory K(t) as a passive state space: a sum of exponentials with poles common to all entries.

Force on the bodies: f = -A∞ a - ∫ K(τ) v(t - τ) dτ. With motions Re{V exp(-iωt)} the memory's
transfer from velocity to -force is Y(ω) = ∫ K exp(iωt) dt = B(ω) - iω(A(ω) - A∞), which must have
a positive semidefinite real part at every ω, or the fit would pump energy into the bodies.
"""

from dataclasses import dataclass

import numpy as np

from solver.hydrodynamics.radiation.infinite import continued, principal


@dataclass(frozen=True, eq=False, kw_only=True)
class RadiationMemory:
    """K(t) = Re Σ residue exp(beta t), t >= 0; one of each conjugate pair is stored."""

    beta: np.ndarray  # (p,) complex [rad/s], real parts < 0
    residue: np.ndarray  # (p, n, n) complex, symmetric [N/m, ...]
    added_mass_inf: np.ndarray  # (n, n) that goes with this memory; may differ from the BEM's by the fit's error
    error: float  # largest misfit, see `fit`; above the tolerance if no order met it

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """K at times t >= 0, (nt, n, n) [N/m, ...]."""
        return np.einsum("tp,pij->tij", np.exp(np.multiply.outer(t, self.beta)), self.residue).real

    def frequency(self, omega: np.ndarray) -> np.ndarray:
        """Y(ω) = B - iω(A - A∞) of the memory, (nw, n, n) complex: ½ Σ r/(-iω - β) + r*/(-iω - β*)."""
        s = -1j * np.asarray(omega, float)[:, None]
        half = np.einsum("wp,pij->wij", 1 / (s - self.beta), self.residue)
        other = np.einsum("wp,pij->wij", 1 / (s - self.beta.conj()), self.residue.conj())
        return (half + other) / 2


def retardation(omega: np.ndarray, radiation_damping: np.ndarray, t: np.ndarray) -> np.ndarray:
    """K(t) = 2/π ∫ B(ω) cos(ωt) dω, (nt, ...), of B (nw, ...) at ω > 0 (nw,): the paper's eq. 14, reference path.

    B is a spline from B(0) = 0 through the samples and goes on as a power of ω, as its last quarter
    falls off, ω^-2 at least. Then, linear between some thousand close points, each piece is exact.
    """
    x, y = _continued(omega, radiation_damping)
    slope = np.diff(y, axis=0) / np.diff(x)[:, None]
    # A linear piece integrates to [y sin(xt)/t] + slope [cos(xt)]/t²; the first bracket telescopes.
    values = np.empty((len(t), y.shape[1]))
    for i, at in enumerate(np.asarray(t, float)):
        if at == 0:
            values[i] = np.trapezoid(y, x, axis=0)
        else:
            values[i] = y[-1] * np.sin(x[-1] * at) / at + np.diff(np.cos(x * at)) @ slope / at**2
    return 2 / np.pi * values.reshape(len(t), *radiation_damping.shape[1:])


def transfer(omega: np.ndarray, radiation_damping: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Y = B - iω(A - A∞) of that K at ω (nt,), (nt, ...): as damping between those told (nw, ...) asks for added mass.

    Below the first of the close points as there.
    """
    x, y = _continued(omega, radiation_damping)
    w = np.clip(at, x[1] / 2, None)
    w = np.where(np.isin(w, x), w * (1 + 1e-9), w)  # at a node two logarithms take each other back
    B = np.stack([np.interp(at, x, entry) for entry in y.T], axis=1)
    added = np.concatenate([2 / np.pi * principal(x, some) @ y for some in np.array_split(w, len(w) // 1000 + 1)])
    return (B - 1j * at[:, None] * added).reshape(len(at), *radiation_damping.shape[1:])


def _continued(omega: np.ndarray, radiation_damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Close points (m,) and B there, entry by entry (m, n)."""
    return continued(omega, radiation_damping.reshape(len(omega), -1), nodes=4001, tail=2001, farthest=1e3)
