"""Radiation memory by direct convolution, eq. 13: the slow twin of the state space.

f(t) = ∫ K(τ) v(t - τ) dτ with velocities that are polynomials within each step, through its
collocation points: linear for two, quadratic for three. The product with K is integrated by Gauss
points, and nothing of the past is left out.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.radiation.memory import retardation, transfer

GAUSS = 8  # points a step: exact to rounding where a step is sane for K,
FRESH, DENSE = 4, 32  # but fitted kernels may have a fast, short-lived part: in the last steps so many


class Kernel(Protocol):
    """A retardation function (nt, n, n) and the added mass that goes with it; RadiationMemory is one."""

    @property
    def added_mass_inf(self) -> np.ndarray:
        """A∞ (n, n)."""
        ...

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """K (nt, n, n) at times t >= 0 (nt,) [s]."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class CosineTransform:
    """K(t) = 2/π ∫ B(ω) cos(ωt) dω of the BEM's damping, eq. 14."""

    omega: np.ndarray
    radiation_damping: np.ndarray
    added_mass_inf: np.ndarray

    @classmethod
    def of(cls, h: Hydrodynamics) -> "CosineTransform":
        """That of a set of coefficients."""
        return cls(omega=h.omega, radiation_damping=h.radiation_damping, added_mass_inf=h.added_mass_inf)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """K (nt, n, n) at times t >= 0 (nt,) [s]."""
        return retardation(self.omega, self.radiation_damping, t)

    def frequency(self, omega: np.ndarray) -> np.ndarray:
        """Y(ω) = B - iω(A - A∞) of it (nw, n, n)."""
        return transfer(self.omega, self.radiation_damping, omega)


class Convolution:
    """History of velocities and the weights of the past for steps of length dt and points c (s,)."""

    def __init__(self, kernel: Kernel, *, dt: float, c: np.ndarray, steps: int) -> None:
        steps = max(steps, FRESH)
        back = np.arange(steps + 1.0)
        recent, old = (_weights(kernel, dt, c, part, n) for part, n in ((back[:FRESH], DENSE), (back[FRESH:], GAUSS)))
        self.now = recent[:, 0]  # (s, s, n, n)
        past = np.concatenate([recent[:, 1:], old], axis=1)
        s, _, _, n, _ = past.shape
        # One row a stage and direction; columns are steps back, their points and directions.
        self.past = np.moveaxis(past, 3, 1).reshape(s, n, -1)
        self.velocities = np.zeros((steps, len(c), n))  # newest first
        self.history = np.zeros((s, n))

    def remember(self, velocity: np.ndarray) -> None:
        """Take in the velocities (s, n) of a finished step."""
        self.velocities = np.roll(self.velocities, 1, axis=0)
        self.velocities[0] = velocity
        self.history = self.past @ self.velocities.ravel()

    def load(self, stage: int, velocity: np.ndarray) -> np.ndarray:
        """f (n,) at a stage, from the present step's velocities (s, n) and the past."""
        return self.history[stage] + np.einsum("lij,lj->i", self.now[stage], velocity)


def _weights(kernel: Kernel, dt: float, c: np.ndarray, back: np.ndarray, points: int) -> np.ndarray:
    """∫ K((back + c_s - τ) dt) L_l(τ) dt dτ over each step `back` (nb,) steps ago, (s, nb, l, n, n).

    In the present step, back = 0, the integral ends at c_s.
    """
    x, w = np.polynomial.legendre.leggauss(points)
    inverse = np.linalg.inv(np.vander(c, increasing=True))
    rows = []
    for at in c:
        end = np.where(back == 0, at, 1.0)[:, None]
        tau = end * (x + 1) / 2
        lagrange = (np.vander(tau.ravel(), len(c), increasing=True) @ inverse).reshape(*tau.shape, -1)
        K = kernel.impulse(((back[:, None] + at - tau) * dt).ravel())
        K = K.reshape(*tau.shape, *K.shape[1:])
        rows.append(np.einsum("bgij,bgl,bg->blij", K, lagrange, end * w / 2 * dt))
    return np.array(rows)
