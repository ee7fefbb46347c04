"""One realization of a long-crested sea: frequencies, complex amplitudes, ramp."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solver.errors import InputError
from solver.sea.spectrum import Spectrum, moment


@dataclass(frozen=True, eq=False, kw_only=True)
class Realization:
    """η(x, t) = Re Σ aᵢ exp(i(kᵢ s - ωᵢ t)), s = x cos β + y sin β.

    omega (n,) [rad/s], amplitude (n,) complex a = A e^{iε} [m], heading β [rad].
    repeat_period [s]: after this time the record repeats (inf for random intervals).
    """

    omega: np.ndarray
    amplitude: np.ndarray
    heading: float = 0.0
    peak_frequency: float = np.nan
    repeat_period: float = np.inf

    def parameters(self) -> dict[str, float]:
        """Hm0 [m], Tp, Te, Tz [s] that the components really carry (band cut included)."""
        variance = np.abs(self.amplitude) ** 2 / 2
        if not variance.any():
            return {"Hm0": 0.0, "Tp": np.nan, "Te": np.nan, "Tz": np.nan}
        m = {n: moment(self.omega, variance, n) for n in (-1, 0, 2)}
        return {
            "Hm0": 4 * np.sqrt(m[0]),
            "Tp": 2 * np.pi / self.peak_frequency,
            "Te": 2 * np.pi * m[-1] / m[0],
            "Tz": 2 * np.pi * np.sqrt(m[0] / m[2]),
        }


CALM = Realization(omega=np.array([1.0]), amplitude=np.zeros(1, complex))


def realize(
    spectrum: Spectrum,
    *,
    components: int,
    band: tuple[float, float],
    seed: int | Sequence[int],
    intervals: Literal["random", "even"] = "random",
    heading: float = 0.0,
) -> Realization:
    """Draw phases, and interval widths if "random", for `components` waves in `band` [rad/s].

    Aᵢ = √(2 S(ωᵢ) Δωᵢ), ωᵢ the middle of interval i. Random: each inner edge of an even
    partition moves by up to ±0.4 of a width, so that frequencies share no period.
    """
    low, high = band
    if not 0 < low < high:
        raise InputError("band", list(band), "needs 0 < low < high [rad/s]")
    if components < 1:
        raise InputError("components", components, "must be at least 1")
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    width = (high - low) / components
    edges = low + width * np.arange(components + 1.0)
    if intervals == "random":
        edges[1:-1] += width * rng.uniform(-0.4, 0.4, components - 1)
    omega = (edges[1:] + edges[:-1]) / 2
    density = spectrum.density(omega)
    amplitude = np.sqrt(2 * density * np.diff(edges)) * np.exp(1j * rng.uniform(0, 2 * np.pi, components))
    return Realization(
        omega=omega,
        amplitude=amplitude,
        heading=heading,
        peak_frequency=float(omega[np.argmax(density)]),
        repeat_period=2 * np.pi / width if intervals == "even" else np.inf,
    )


def ramp(t: np.ndarray, duration: float, form: Literal["paper", "cosine"] = "paper") -> np.ndarray:
    """Factor 0 -> 1 on every wave-driven quantity during the first `duration` seconds.

    "paper": 1 - cos(πt/2T) (Heo et al. 2022, eq. 21; its slope jumps at T);
    "cosine": ½(1 - cos(πt/T)), smooth at both ends.
    """
    if duration <= 0:
        return np.ones_like(t)
    phase = np.pi * np.minimum(t / duration, 1.0)
    return 1 - np.cos(phase / 2) if form == "paper" else (1 - np.cos(phase)) / 2
