"""One realization of a long-crested sea: frequencies, complex amplitudes, ramp."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from solver.errors import InputError
from solver.quantities import require_positive
from solver.sea.spectrum import Jonswap, PiersonMoskowitz, Spectrum, moment

Intervals = Literal["random", "even"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Realization:
    """η(x, t) = Re Σ aᵢ exp(i(kᵢ s - ωᵢ t)), s = x cos β + y sin β.

    omega (n,) [rad/s], amplitude (n,) complex a = A e^{iε} [m], heading β [rad].
    nominal: Hs [m] and Tp [s] of the spectrum that the components stand for, where it has a peak.
    known: whether phases are given, not drawn.
    notes: sentences for the user on how the components came about.
    """

    omega: np.ndarray
    amplitude: np.ndarray
    heading: float = 0.0
    peak_frequency: float = np.nan
    nominal: tuple[float, float] | None = None
    known: bool = False
    notes: tuple[str, ...] = ()

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


MISSED = 0.03  # of a spectrum's height: the usual band cuts 0.8 % off, and 50 components in it miss 1.2 % at most
SLOWEST = 1e-6  # a wave of ten weeks [rad/s]
ROUNDING = 1e-12  # of waves of one frequency that cancel
CALM = Realization(omega=np.array([1.0]), amplitude=np.zeros(1, complex))


def realize(
    spectrum: Spectrum,
    *,
    components: int,
    band: tuple[float, float],
    seed: int | Sequence[int],
    intervals: Intervals = "random",
    heading: float = 0.0,
) -> Realization:
    """Draw phases, and interval widths if "random", for `components` waves in `band` [rad/s].

    Aᵢ = √(2 S(ωᵢ) Δωᵢ), ωᵢ the middle of interval i. Random: each inner edge of an even
    partition moves by up to ±0.4 of a width, so that frequencies share no period.
    """
    low, high = band
    require_rising(band)
    if components < 1:
        raise InputError("components", components, "must be at least 1")
    if intervals not in get_args(Intervals):
        raise InputError("intervals", intervals, f"must be one of {', '.join(get_args(Intervals))}")
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    width = (high - low) / components
    edges = low + width * np.arange(components + 1.0)
    if intervals == "random":
        edges[1:-1] += width * rng.uniform(-0.4, 0.4, components - 1)
    omega = (edges[1:] + edges[:-1]) / 2
    density = spectrum.density(omega)
    nominal = None
    if isinstance(spectrum, PiersonMoskowitz | Jonswap):
        nominal = spectrum.Hs, 2 * np.pi / spectrum.peak_frequency
    amplitude = np.sqrt(2 * density * np.diff(edges)) * np.exp(1j * rng.uniform(0, 2 * np.pi, components))
    made = Realization(
        omega=omega,
        amplitude=amplitude,
        heading=heading,
        peak_frequency=float(omega[np.argmax(density)]),
        nominal=nominal,
    )
    return replace(made, notes=_missed(made, spectrum, band))


def _missed(made: Realization, spectrum: Spectrum, band: tuple[float, float]) -> tuple[str, ...]:
    """A sentence where a sea is not as high as its spectrum, 4 √m₀: with the height that its band leaves of that."""
    height = made.parameters()["Hm0"]
    if abs(height / spectrum.Hs - 1) <= MISSED:
        return ()
    grid = np.linspace(*band, 20_001)
    within = 4 * np.sqrt(np.trapezoid(spectrum.density(grid), grid))
    outside = max(0.0, 1 - (within / spectrum.Hs) ** 2)
    lost = f"{outside:.2%} of its variance that lies outside {band[0]:.4g} to {band[1]:.4g} rad/s"
    waves = f"components = {made.omega.size} have Hm0 = {height:.3g} m"
    return (f"{waves}, and their spectrum has {spectrum.Hs:.3g} m: {within:.3g} m without the {lost}",)


def require_rising(band: tuple[float, float]) -> None:
    """Refuse a band [rad/s] that does not rise from above 0."""
    if not 0 < band[0] < band[1]:
        raise InputError("band", list(band), "must rise: 0 < low < high [rad/s]")


def regular(*, height: float, period: float, phase: float = 0.0, heading: float = 0.0) -> Realization:
    """One wave, η = H/2 cos(ks - ωt + ε) of height H [m], period [s] and phase ε [rad]."""
    require_positive("height", height, "m")
    require_positive("period", period, "s")
    return components(amplitude=[height / 2], omega=[2 * np.pi / period], phase=[phase], heading=heading)


def components(*, amplitude: ArrayLike, omega: ArrayLike, phase: ArrayLike, heading: float = 0.0) -> Realization:
    """Waves listed one by one: η = Σ Aᵢ cos(kᵢs - ωᵢt + εᵢ), A (n,) [m], ω (n,) [rad/s], ε (n,) [rad].

    Those of one frequency are one wave.
    """
    A, w, e = (np.asarray(x, float) for x in (amplitude, omega, phase))
    if not A.shape == w.shape == e.shape or A.size == 0:
        limit = f"needs one at least, and as many as omega ({w.size}) and phase ({e.size})"
        raise InputError("amplitude", f"{A.size} values", limit)
    for key, values in (("amplitude", A), ("omega", w), ("phase", e)):
        if not np.all(np.isfinite(values)):
            raise InputError(key, values[~np.isfinite(values)][0], "must be a finite number")
    if not np.all(w >= SLOWEST):
        raise InputError("omega", w.min(), f"frequencies must be >= {SLOWEST:g} rad/s")
    omega, of = np.unique(w, return_inverse=True)
    amplitude = np.zeros(omega.size, complex)
    np.add.at(amplitude, of, A * np.exp(1j * e))
    amplitude[np.abs(amplitude) <= ROUNDING * np.bincount(of, np.abs(A))] = 0.0  # what cancels
    return Realization(
        omega=omega,
        amplitude=amplitude,
        heading=heading,
        peak_frequency=float(omega[np.argmax(np.abs(amplitude))]),
        known=True,
    )


def measured(*, time: ArrayLike, elevation: ArrayLike, band: tuple[float, float], heading: float = 0.0) -> Realization:
    """A record of η [m] at the origin, at even times [s], as its Fourier components in `band` [rad/s].

    With all of them it comes back exactly at its samples, and repeats after n Δt. The mean level and
    what lies outside the band are left out; the notes say how much that was.
    """
    t, eta = np.asarray(time, float), np.asarray(elevation, float)
    step = _even_step(t, eta)
    low, high = band
    n, level = len(eta), eta.mean()
    omega = 2 * np.pi / step * np.fft.rfftfreq(n)
    # rfft has η = Re Σ X exp(iωt); ours is Re Σ a exp(-iωt), and the record begins at t[0].
    amplitude = np.fft.rfft(eta - level).conj() * np.exp(1j * omega * t[0]) * 2 / n
    if n % 2 == 0:
        amplitude[-1] /= 2
    inside = (omega >= low) & (omega <= high) & (omega > 0)
    if not np.abs(amplitude[inside]).any():
        raise InputError("band", list(band), "holds none of the record's waves [rad/s]")
    power = np.abs(amplitude) ** 2
    note = (
        f"elevation record: mean level {level:.3g} m taken off; {power[~inside].sum() / power.sum():.2%} of the"
        f" variance lies outside {low:g} to {high:g} rad/s and is left out; it repeats after {n * step:g} s"
    )
    # A raw periodogram has its highest line anywhere near the peak.
    smooth = np.convolve(power, np.hanning(min(2 * int(np.sqrt(n) / 2) + 3, power.size)), mode="same")
    return Realization(
        omega=omega[inside],
        amplitude=amplitude[inside],
        heading=heading,
        peak_frequency=float(omega[inside][np.argmax(smooth[inside])]),
        known=True,
        notes=(note,),
    )


def _even_step(t: np.ndarray, eta: np.ndarray) -> float:
    """The step of even times [s]; times may be rounded to a hundredth of it."""
    if t.shape != eta.shape or t.size < 4:
        raise InputError("time", f"{t.size} samples", f"needs at least 4, and as many as elevations ({eta.size})")
    if not np.all(np.isfinite([t, eta])):
        raise InputError("elevation", "a gap", "every time and elevation must be a finite number")
    step = float(t[-1] - t[0]) / (t.size - 1)
    off = np.abs(t - t[0] - step * np.arange(t.size))
    if not step > 0 or off.max() > 0.01 * step:
        worst = int(off.argmax())
        raise InputError("time", t[worst], f"sample {worst + 1} must lie at even steps of {step:g} s")
    return step


def ramp(t: np.ndarray | float, duration: float, form: Literal["paper", "cosine"] = "paper") -> np.ndarray:
    """Factor 0 -> 1 on every wave-driven quantity during the first `duration` seconds.

    "paper": 1 - cos(πt/2T) (Heo et al. 2022, eq. 21; its slope jumps at T);
    "cosine": ½(1 - cos(πt/T)), smooth at both ends.
    """
    if duration <= 0:
        return np.ones_like(t)
    phase = np.pi * np.minimum(t / duration, 1.0)
    return 1 - np.cos(phase / 2) if form == "paper" else (1 - np.cos(phase)) / 2
