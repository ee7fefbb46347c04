"""Whether one wave's response is left for one of twice its period: parametric resonance, which no harmonic shows.

Loads on levers that turn, and all else of N (see harmonics), have a slope by z that varies with the wave: along a taut
tether that is a pendulum's stiffness as the tether's load goes up and down. Beside the response X to a wave of ω,
ζ = Re Σ ζₘ exp(-i m·ω/2 t) of odd m has loads of odd m alone, as far as it is small

    δNₘ = Σₙ aₘₙ ζₙ + bₘₙ ζₙ*,

for -ω/2 and a harmonic make ω/2. With the receptance G = T Z⁻¹ Tᵀ at these frequencies, dampers as they were linearised
for X, it is steady, locked to the wave, where

    (1 - G a) ζ = G b ζ*,   that is   ζ = B ζ*,   B = (1 - G a)⁻¹ G b,

a system of twice as many real coordinates, whose determinant over that without b is the product of 1 - μ² over the
eigenvalues μ² of B B*. As b is scaled from 0 up, it changes its sign where one that is real comes to 1: from there on
a motion at ω/2 grows (Hill 1886). Of one coordinate, |b| ≥ |Z - a|; of Mathieu's ẍ + 2γẋ + (ω₀² + h cos ωt) x = 0 that
is (h/2)² ≥ (ω₀² - ω²/4)² + (γω)². b goes with the wave's height H, so that H/μ is about where it begins.

Dampers by the rate's square damp what grows half as much again as they damp X, which is left out; so are two shapes of
other frequencies, whose sum is ω, and seas, whose groups of high waves may make a motion grow for a while.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from solver.coupled.linear import jacobian
from solver.frequency.case import Case
from solver.frequency.exact import Lattice, Waves, beyond
from solver.frequency.response import Response

HALF = Lattice.of((1,), 11, 48)._replace(own=np.array([2]))  # of half the wave's frequency, as finely as one wave's
ODD = np.array([1, 3])  # times that: five in place of these change μ by less than 1e-3
NEAR = 1e-4  # [m or rad] of ζ: its cube is nothing there
REAL = 1e-2  # imaginary part, of its size, that a μ² may have of rounding where two are the same
MOST = 48  # coordinates of floats: δN of each takes loads of its own


class Growing(NamedTuple):
    """What swings up at half the wave's frequency."""

    joint: int
    size: float  # μ: the wave's height over that from which on it does so


def growing(case: Case, response: Response, X: np.ndarray) -> Growing | None:
    """Beside a response of harmonics X (nk, n) to one wave; None where nothing grows."""
    waves, T, damping = _waves(case), case.model.shape, response.damping
    if len(T) > MOST:
        return None
    a, b = _slopes(case, waves, X)
    Z = case.model.assembled(waves.omega[ODD], waves.against[ODD]) - 1j * waves.omega[ODD, None, None] * damping
    G = block_diag(*(T @ np.linalg.solve(Z, np.broadcast_to(T.T, (len(Z), *T.T.shape)))))
    square, ways = largest(np.linalg.solve(np.eye(len(G)) - G @ a, G @ b))
    if square < 1.0:
        return None
    nc, nm = case.system.structure.carrier.shape
    moved = np.abs(ways[nc : len(T)]) * case.model.length[nm:]
    return Growing(int(np.argmax(moved)), float(np.sqrt(square)))


def largest(B: np.ndarray) -> tuple[float, np.ndarray]:
    """μ² of B B* (m, m), the largest of those that are real, 0 if none is, and ζ (m,)."""
    squares, ways = np.linalg.eig(B @ B.conj())
    real = np.where(np.abs(squares.imag) <= REAL * np.abs(squares), squares.real, 0.0)
    return float(real.max()), ways[:, np.argmax(real)]


def _waves(case: Case) -> Waves:
    """That of a case, by lines of half its frequency."""
    omega = HALF.sums[:, 0] * case.waves[0] / 2
    Y = case.impedance_at(omega)
    excitation = HALF.first(case.excitation[:1])
    at_rest = jacobian(case.system.resting.value[0], case.system.resting.value[2])
    force = excitation.reshape(omega.size, -1) @ at_rest.reshape(-1, at_rest.shape[-1])
    against = case.model.of_floats(omega, Y)
    return Waves(HALF, np.ones(omega.size), omega, Y, excitation, force, against[:0], against)


def _slopes(case: Case, waves: Waves, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """a and b (2nz, 2nz), by lines of ODD and the floats' coordinates. N of odd lines is odd in ζ: one side will do."""
    Z = np.zeros((len(HALF.sums), len(case.model.shape)), complex)
    Z[: 2 * len(X) : 2] = X @ case.model.shape.T
    parts = np.empty((2, ODD.size * Z.shape[1], ODD.size * Z.shape[1]), complex)
    for part, phase in zip(parts, (1, 1j), strict=True):
        for k, at in enumerate((m, j) for m in ODD for j in range(Z.shape[1])):
            nearby = Z.copy()
            nearby[at] = NEAR * phase
            part[:, k] = beyond(case, waves, nearby)[0][ODD].ravel() / NEAR
    real, imaginary = parts
    return (real - 1j * imaginary) / 2, (real + 1j * imaginary) / 2
