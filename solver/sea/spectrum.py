"""Variance density spectra S(ω) [m² s/rad] of the sea surface."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from solver.errors import InputError


class Spectrum(Protocol):
    """What a realization needs of a spectrum."""

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad], one-sided, for ω [rad/s]."""
        ...


def _positive(**values: float) -> None:
    for key, value in values.items():
        if not 0 < value < np.inf:
            raise InputError(key, value, "must be positive and finite")


@dataclass(frozen=True, slots=True, kw_only=True)
class PiersonMoskowitz:
    """Two-parameter Pierson-Moskowitz spectrum.

    form "peak" (T is the peak period):  S = 5/16 Hs² ωp⁴ ω⁻⁵ exp(-5/4 (ωp/ω)⁴), ωp = 2π/T
    form "mean" (T is the mean period T1): S = 173 Hs² T⁻⁴ ω⁻⁵ exp(-692 T⁻⁴ ω⁻⁴)

    Heo, Koo and Kim (2022) print the second with T_p in it (eq. 18); their text and
    band fit the first.
    """

    Hs: float  # significant wave height [m]
    Tp: float  # peak (or mean) period [s]
    form: Literal["peak", "mean"] = "peak"

    def __post_init__(self):
        _positive(Hs=self.Hs, Tp=self.Tp)

    def density(self, omega):
        if self.form == "peak":
            wp = 2 * np.pi / self.Tp
            return 5 / 16 * self.Hs**2 * wp**4 * omega**-5.0 * np.exp(-1.25 * (wp / omega) ** 4)
        T4 = self.Tp**-4.0
        return 173 * self.Hs**2 * T4 * omega**-5.0 * np.exp(-692 * T4 * omega**-4.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class WhiteNoise:
    """Constant density over the band of the realization: S = Hs²/(16 (ω₂ - ω₁))."""

    Hs: float
    band: tuple[float, float]  # [rad/s]

    def __post_init__(self):
        _positive(Hs=self.Hs)

    def density(self, omega):
        low, high = self.band
        return np.full_like(omega, self.Hs**2 / 16 / (high - low))


def moment(omega: np.ndarray, variance: np.ndarray, n: int) -> float:
    """Spectral moment m_n = Σ ωⁿ ΔS of component variances ΔS [m²]."""
    return float(np.sum(omega**n * variance))
