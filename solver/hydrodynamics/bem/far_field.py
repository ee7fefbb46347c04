"""The waves that bodies send far off: Kochin functions, and what power, force and moment those waves carry away.

Green's identity between an outgoing potential φ and plane waves that run against θ,

    ψ_θ = f(z) exp(-ik(x cosθ + y sinθ)),  f = cosh k(z + h)/cosh kh,  H(θ) = ∫ (φ ∂ψ_θ/∂n - ψ_θ ∂φ/∂n) dS on hulls,

has far off φ → e^{iπ/4} H(θ) f e^{ikR}/(2N √(2πkR)), N = ∫ f² dz = c c_g/g, c the waves' speed, c_g their energy's.
H = Σ hₘ exp(imθ), m = -M ... M. Beside the wave of amplitude a towards β, in the mean over a period:

    outgoing power   P_out = ρω/(16πN) ∫|H|² dθ
    absorbed power   P = ½ρg Re{a* H(β)} - P_out, by bodies and damping lids
    drift force      F = (½ρg Re{a* H(β)} e_β - ρω/(16πN) ∫|H|² e_θ dθ)/c
    drift moment     M_z = ρg/(2ω) Im{a* H'(β)} - ρ/(16πN) Im ∫H* H' dθ

(Maruo 1960 and Newman 1967, at any depth: momentum is energy over c, angular momentum of order m energy times m/ω.) The
incident wave's Bernoulli constant is zero: its set-down is counted where the bodies are as where they are not.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.sea.dispersion import group_share, over_depth, wavenumber

FURTHER = 4.0  # orders beyond kr, besides as many times (kr)^⅓: of higher ones 1e-6 is left


class FarField(NamedTuple):
    """Of bodies about `origin`: modes hₘ of H for unit velocity of each motion, and of the unit wave's scattering."""

    origin: np.ndarray  # (2,) x and y of phase zero [m]
    radiated: np.ndarray  # (nw, n, 2M + 1)
    scattered: np.ndarray  # (nw, 2M + 1)


class PlaneWaves(NamedTuple):
    """ψ_θ (np, nθ) and its normal derivative at points of a surface, θ evenly spaced from 0."""

    value: np.ndarray
    slope: np.ndarray


def orders(k: float, reach: float) -> int:
    """M for bodies within that reach [m] of the origin, and waves of up to k [1/m]."""
    return int(np.ceil(k * reach + FURTHER * (1 + np.cbrt(k * reach))))


def plane_waves(points: np.ndarray, normals: np.ndarray, k: float, depth: float, most: int) -> PlaneWaves:
    """At points (np, 3) from the origin with these normals, as many directions as there are orders up to `most`."""
    angle = 2 * np.pi * np.arange(2 * most + 1) / (2 * most + 1)
    e = np.stack([np.cos(angle), np.sin(angle)])
    level, rise = over_depth(k, points[:, 2], depth)
    phase = np.exp(-1j * k * (points[:, :2] @ e))
    value = phase * level[:, None]
    climb = k * (normals[:, 2] * rise)[:, None] * phase
    return PlaneWaves(value, -1j * k * (normals[:, :2] @ e) * value + climb)


def modes(H: np.ndarray) -> np.ndarray:
    """hₘ (…, 2M + 1), m = -M ... M, of H at as many directions (…, 2M + 1)."""
    return np.fft.fftshift(np.fft.fft(H, axis=-1), axes=-1) / H.shape[-1]


def _orders_of(h: np.ndarray) -> np.ndarray:
    return np.arange(h.shape[-1]) - h.shape[-1] // 2


def towards(h: np.ndarray, angle: float, derivative: int = 0) -> np.ndarray:
    """H(θ) (…), or a derivative by θ, of modes (…, 2M + 1)."""
    m = _orders_of(h)
    return h @ ((1j * m) ** derivative * np.exp(1j * m * angle))


@dataclass(frozen=True, eq=False, kw_only=True)
class Waves:
    """What comes and what leaves at frequencies (nw,): waves of amplitude a towards `heading`, and modes of H."""

    omega: np.ndarray  # (nw,) [rad/s]
    amplitude: np.ndarray  # (nw,) complex a at the modes' origin [m]
    modes: np.ndarray  # (nw, 2M + 1) hₘ of all that is scattered and radiated [m³/s]
    heading: float
    depth: float
    density: float
    gravity: float

    @property
    def outgoing_power(self) -> np.ndarray:
        """P_out (nw,) [W]."""
        return self._carried * np.sum(np.abs(self.modes) ** 2, axis=1)

    @property
    def absorbed_power(self) -> np.ndarray:
        """P (nw,) [W]."""
        return self._shadow - self.outgoing_power

    @property
    def drift_force(self) -> np.ndarray:
        """Fx and Fy (nw, 2) [N]."""
        h, beta = self.modes, self.heading
        turned = self._carried * np.sum(h[:, :-1] * h[:, 1:].conj(), axis=1)  # of |H|² exp(iθ)
        force = self._shadow * np.exp(1j * beta) - turned
        return np.stack([force.real, force.imag], axis=-1) * (self._k / self.omega)[:, None]

    @property
    def drift_moment(self) -> np.ndarray:
        """M_z (nw,) about the origin of the modes [N m]."""
        turning = towards(self.modes, self.heading, derivative=1)
        shadow = 0.5 * self.density * self.gravity * (self.amplitude.conj() * turning).imag
        return (shadow - self._carried * (np.abs(self.modes) ** 2 @ _orders_of(self.modes))) / self.omega

    @property
    def _k(self) -> np.ndarray:
        return wavenumber(self.omega, self.depth, self.gravity)

    @property
    def _carried(self) -> np.ndarray:
        """ρω/8N: power (nw,) of Σ|hₘ|² = 1."""
        return self.density * self.omega / (8 * spread(self._k, self.depth))

    @property
    def _shadow(self) -> np.ndarray:
        """Power (nw,) that the incident wave loses to its shadow, ½ρg Re{a* H(β)}."""
        return 0.5 * self.density * self.gravity * (self.amplitude.conj() * towards(self.modes, self.heading)).real


def spread(k: np.ndarray, depth: float) -> np.ndarray:
    """N = ∫ f² dz = tanh kh (1 + 2kh/sinh 2kh)/2k [m]."""
    return np.tanh(k * depth) * group_share(k, depth) / k


def radiation_damping(far: FarField, omega: np.ndarray, *, depth: float, density: float, gravity: float) -> np.ndarray:
    """B (nw, n, n) whose power leaves: ρω/(8πN) ∫ H_i H_j* dθ."""
    N = spread(wavenumber(omega, depth, gravity), depth)
    sums = np.einsum("wim,wjm->wij", far.radiated, far.radiated.conj()).real
    return (density * omega / (4 * N))[:, None, None] * sums


def excitation(far: FarField, heading: float, *, density: float, gravity: float) -> np.ndarray:
    """Haskind's force (nw, n) of the unit wave at the modes' origin: ρg H_j(β + π)."""
    return density * gravity * towards(far.radiated, heading + np.pi)
