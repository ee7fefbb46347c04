"""Whether a response is left for one of twice the waves' period: parametric resonance, which no harmonic shows.

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

In a sea each wave k pushes a shape φ of frequency ω₀ that swings at half of its own by b_k ζ*, from slopes and
curvatures of second order (see rotation), so that it would grow by itself where

    μ_k = |b_k| / |φᵀ Z(ω_k/2) φ| ≥ 1.

By all waves, which come and go in groups, its mean square grows where Σ μ_k² ≥ 1. With m damping the rate, γ, of a
shape whose load has the spectrum S at 2ω₀ that is 4πγS m² ≥ 1 as Stratonovich (1963) averages, of a band wider than 4γ;
of a narrower one that of one wave with the sea's variance.

Dampers by the rate's square damp what grows half as much again as they damp X, which is left out; so are two shapes of
other frequencies, whose sum is a wave's.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from solver.frequency import second_order
from solver.frequency.case import KNOWN, Case
from solver.frequency.exact import Lattice, Linear, Waves, beyond
from solver.frequency.response import Response
from solver.lines import squares

HALF = Lattice.of((1,), 11, 48)._replace(own=np.array([2]))  # of half the wave's frequency, as finely as one wave's
ODD = np.array([1, 3])  # times that: five in place of these change μ by less than 1e-3
NEAR = 1e-4  # [m or rad] of ζ: its cube is nothing there
REAL = 1e-2  # imaginary part, of its size, that a μ² may have of rounding where two are the same
BESIDE = 1.25  # times the waves' frequencies, or over it: there twice a shape's own may lie
MOST = 48  # coordinates of floats: δN of each takes loads of its own, and curvatures memory with their cube


class Growing(NamedTuple):
    """What swings up at half the waves' frequencies."""

    joint: int
    size: float  # μ: waves' height over that from which on it does so


class _Halved(NamedTuple):
    """A shape φ (n,) that swings at half of each wave's frequency; nz coordinates of floats."""

    shape: np.ndarray
    Z: np.ndarray  # (nw,) φᵀZφ without dampers
    along: second_order.Along
    swinging: np.ndarray  # (nw, 5nz) itself as the second of two lines

    def pushed(self, z: np.ndarray, s: np.ndarray, added: np.ndarray) -> np.ndarray:
        """b (nw,) by waves' z (nw, nz), s (nw, 3nz) and W' (nw, 6nb)."""
        return second_order.load(self.along.first(z, s, added), self.swinging)


def growing(case: Case, response: Response, X: np.ndarray) -> Growing | None:
    """Beside a response, of harmonics X (nk, n) where it is one wave's; None where nothing grows."""
    if len(case.model.shape) > MOST:
        return None
    return _in_one_wave(case, response, X) if case.waves.size == 1 else _in_sea(case, response)


def _in_one_wave(case: Case, response: Response, X: np.ndarray) -> Growing | None:
    waves, T, damping = _waves(case), case.model.shape, response.damping
    a, b = _slopes(case, waves, X)
    Z = waves.Z[ODD] - 1j * waves.omega[ODD, None, None] * damping
    G = block_diag(*(T @ np.linalg.solve(Z, np.broadcast_to(T.T, (len(Z), *T.T.shape)))))
    square, ways = largest(np.linalg.solve(np.eye(len(G)) - G @ a, G @ b))
    if square < 1.0:
        return None
    nc = case.system.structure.carrier.shape[0]
    return Growing(_joint(case, ways[nc : len(T)]), float(np.sqrt(square)))


def _in_sea(case: Case, response: Response) -> Growing | None:
    if not (shapes := _halved(case)):
        return None
    waves, nm = case.waves.size, case.model.modes.shape[1]
    z, X, wrench = response.Z[:waves], response.X[:waves], response.wrench[:waves]
    s, added = second_order.states(case.waves, z), second_order.added(case, case.waves, X, wrench)
    sizes = []
    for of in shapes:
        Z = of.Z - 0.5j * case.waves * (of.shape @ response.damping @ of.shape)
        sizes.append(float(np.sqrt(np.sum(squares(of.pushed(z, s, added) / Z)))))
    k = int(np.argmax(sizes))
    return Growing(_joint(case, shapes[k].shape[nm:]), sizes[k]) if sizes[k] >= 1.0 else None


@lru_cache(maxsize=KNOWN)
def _halved(case: Case) -> tuple[_Halved, ...]:
    """Of shapes whose frequency is about half of a wave's; scenes that differ in their dampers alone share them."""
    model, omega, modes, found = case.model, case.waves, case.modes, []
    about = (2 * modes.omega * BESIDE > omega.min()) & (2 * modes.omega < BESIDE * omega.max())
    if not about.any():
        return ()
    Y, none = case.impedance_at(omega / 2), np.zeros((omega.size, len(case.system.scene.floats), 6), complex)
    stiffness = model.dynamic_stiffness(omega / 2, Y)
    for shape in modes.shapes[:, about].T:
        along, X = model.shape @ shape, np.tile(shape.astype(complex), (omega.size, 1))
        of, z = second_order.Along.of(case.system.resting, along), X @ model.shape.T
        added = second_order.added(case, omega / 2, X, model.loads(omega / 2, X, Y, none))
        Z = np.einsum("i,wij,j->w", shape, stiffness, shape)
        found.append(_Halved(shape, Z, of, of.second(z, second_order.states(omega / 2, z), added)))
    return tuple(found)


def _joint(case: Case, joints: np.ndarray) -> int:
    """Which of them (nj,) moves most."""
    return int(np.argmax(np.abs(joints) * case.model.length[case.model.modes.shape[1] :]))


def largest(B: np.ndarray) -> tuple[float, np.ndarray]:
    """μ² of B B* (m, m), the largest of those that are real, 0 if none is, and ζ (m,)."""
    squares, ways = np.linalg.eig(B @ B.conj())
    real = np.where(np.abs(squares.imag) <= REAL * np.abs(squares), squares.real, 0.0)
    return float(real.max()), ways[:, np.argmax(real)]


def _waves(case: Case) -> Waves:
    """That of a case, by lines of half its frequency."""
    omega = HALF.sums[:, 0] * case.waves[0] / 2
    return Waves.of(case, HALF, np.ones(omega.size), Linear.of(case, omega), case.excitation[:1])


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
