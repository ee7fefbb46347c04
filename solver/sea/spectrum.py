"""Variance density spectra S(ω) [m² s/rad] of the sea surface."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from solver.errors import InputError
from solver.quantities import require_positive, require_ranges


class Spectrum(Protocol):
    """A spectrum, as realizations ask for it."""

    @property
    def Hs(self) -> float:
        """4 √m₀ [m], m₀ = ∫ S dω over all frequencies."""
        ...

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad], one-sided, for ω [rad/s]."""
        ...


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

    def __post_init__(self) -> None:
        require_positive("Hs", self.Hs, "m")
        require_positive("Tp", self.Tp, "s")
        require_ranges(self, "spectrum")

    @property
    def peak_frequency(self) -> float:
        """Where S is largest [rad/s]; in the mean form (4/5 692)^(1/4) / T."""
        return 2 * np.pi / self.Tp if self.form == "peak" else (0.8 * 692) ** 0.25 / self.Tp

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad] in the form chosen, for ω > 0 [rad/s]: eq. 18 in the mean form."""
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

    def __post_init__(self) -> None:
        require_positive("Hs", self.Hs, "m")

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad], the same everywhere."""
        low, high = self.band
        return np.full_like(omega, self.Hs**2 / 16 / (high - low))


@dataclass(frozen=True, slots=True, kw_only=True)
class Jonswap:
    """JONSWAP: S = C S_PM γ^r, S_PM the peak form, r = exp(-(ω/ωp - 1)²/2σ²), σ = 0.07 up to ωp, 0.09 above.

    C keeps m₀ = Hs²/16 exactly: with y = 5/4 (ωp/ω)⁴ the variance of S_PM is spread as e⁻ʸ dy,
    so 1/C = ∫ γ^r e⁻ʸ dy.
    """

    Hs: float  # significant wave height [m]
    Tp: float  # peak period [s]
    gamma: float = 3.3  # peak enhancement [-]; 1 is Pierson-Moskowitz

    def __post_init__(self) -> None:
        require_positive("Hs", self.Hs, "m")
        require_positive("Tp", self.Tp, "s")
        if not 1 <= self.gamma <= 7:
            raise InputError("gamma", self.gamma, "JONSWAP needs 1 <= gamma <= 7")

    @property
    def peak_frequency(self) -> float:
        """Where S is largest [rad/s]."""
        return 2 * np.pi / self.Tp

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad] for ω > 0 [rad/s]."""
        wp = 2 * np.pi / self.Tp
        base = PiersonMoskowitz(Hs=self.Hs, Tp=self.Tp).density(omega)
        y = np.linspace(1e-9, 40.0, 40_001)  # e^-40 is below rounding
        share = np.trapezoid(np.exp(-y) * self._enhancement((1.25 / y) ** 0.25), y)
        return base * self._enhancement(omega / wp) / share

    def _enhancement(self, x: np.ndarray) -> np.ndarray:
        """γ^r at x = ω/ωp."""
        width = np.where(x <= 1, 0.07, 0.09)
        return self.gamma ** np.exp(-(((x - 1) / width) ** 2) / 2)


@dataclass(frozen=True, eq=False, kw_only=True)
class Tabulated:
    """A spectrum as a table: linear between them, zero outside."""

    omega: np.ndarray  # (n,) [rad/s], increasing
    S: np.ndarray  # (n,) [m² s/rad]

    def __post_init__(self) -> None:
        if len(self.omega) < 2 or not np.all(np.diff(self.omega) > 0):
            raise InputError("omega", _brief(self.omega), "needs at least two increasing frequencies [rad/s]")
        if not (np.all(self.S >= 0) and np.any(self.S > 0)):
            raise InputError("S", _brief(self.S), "must be >= 0, and somewhere > 0")

    @property
    def Hs(self) -> float:
        """Significant wave height 4 √m₀ [m]."""
        return float(4 * np.sqrt(np.trapezoid(self.S, self.omega)))

    def density(self, omega: np.ndarray) -> np.ndarray:
        """S(ω) [m² s/rad] for ω [rad/s]."""
        return np.interp(omega, self.omega, self.S, left=0.0, right=0.0)


def _brief(values: np.ndarray) -> str:
    return f"{len(values)} values" if len(values) > 4 else str(values.tolist())


def moment(omega: np.ndarray, variance: np.ndarray, n: int) -> float:
    """Spectral moment m_n = Σ ωⁿ ΔS of component variances ΔS [m²]."""
    return float(np.sum(omega**n * variance))
