"""Spectra and response amplitude operators from time records, and from lines of a linear model."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import linalg

BANDS = 60  # frequencies at which spectra are put out
MOMENTS = (0, 1, 2, 4)  # orders of spectral moments that are put out
LEAST = 4.0  # of the record's own resolution, 2π/T: a band's width at least
REACH = 5.0  # widths within which a band sees a line
SEEN = 3.0  # widths within which a band has to have a wave: a response farther off is that of rounding, or of leakage


Delay = Callable[[np.ndarray], np.ndarray]


class Bands(NamedTuple):
    """Gaussian bands of one width, about frequencies that the waves have."""

    omega: np.ndarray  # (nf,) [rad/s]
    width: float  # standard deviation [rad/s]


class Response(NamedTuple):
    """Of m outputs to the waves, band by band; NaN where there is nothing to divide by; see `waveless`."""

    transfer: np.ndarray  # (nf, m) complex, per wave amplitude
    coherence: np.ndarray  # (nf, m) share of the variance that follows the waves linearly
    density: np.ndarray  # (nf, m) of the output [unit² s/rad]


def bands(omega: np.ndarray, duration: float) -> Bands:
    """For waves of frequencies omega (nw,) [rad/s], some of several waves each, and a record of a duration [s]."""
    low, high = float(omega.min()), float(omega.max())
    count = BANDS if high > low else 1
    return Bands(np.linspace(low, high, count), max((high - low) / BANDS, LEAST * 2 * np.pi / duration))


def waveless(at: Bands, omega: np.ndarray) -> np.ndarray:
    """Which bands (nf,) have none of the waves at omega (nw,)."""
    apart = np.abs(at.omega[:, None] - omega).min(axis=1, initial=np.inf)
    return np.asarray(apart > SEEN * at.width)


def cross_spectra(
    omega: np.ndarray, wave: np.ndarray, lines: np.ndarray, at: Bands, later: Delay | None = None
) -> Response:
    """H = S_xy/S_xx (Heo et al. 2022, eq. 22), γ² = |S_xy|²/(S_xx S_yy) and S_yy, of lines at omega (n,).

    wave x (n,) and outputs y (n, m): amplitudes in Re Σ X exp(-iωt). Spectra are means over the bands, ½ Σ g X* Y: of
    what is far off along the waves the phase, which turns within a band, is taken out before and put in again at the
    band's middle; later: the waves' exp(ikx) at each (n, m), for any frequencies (n,).
    """
    g = np.exp(-0.5 * ((at.omega[:, None] - omega) / at.width) ** 2) / (at.width * np.sqrt(2 * np.pi))
    x = wave[:, None]
    here = lines if later is None else lines * later(omega).conj()
    xx, xy, yy = (0.5 * g @ product for product in (np.abs(x) ** 2, x.conj() * here, np.abs(lines) ** 2))
    with np.errstate(invalid="ignore", divide="ignore"):
        H = xy / xx
        return Response(H if later is None else H * later(at.omega), np.abs(xy) ** 2 / (xx * yy), yy)


def lines_of(record: np.ndarray, step: float, at: Bands) -> tuple[np.ndarray, np.ndarray]:
    """ω (n,) and amplitudes (n, m) within reach of the bands that an evenly sampled record (nt, m) is made of.

    Tapered (Hann), so that what is far off does not leak in; ½ Σ|Y|² is on average the record's variance.
    """
    omega, lines = all_lines(record, step)
    reach = REACH * at.width
    near = (omega > at.omega[0] - reach) & (omega < at.omega[-1] + reach)
    return omega[near], lines[near]


def all_lines(record: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """The same at all its frequencies but 0."""
    n = len(record)
    taper = np.hanning(n + 2)[1:-1]
    tapered = (taper * (record - record.mean(axis=0)).T).T
    lines = 2 * np.fft.rfft(tapered, axis=0).conj() / np.sqrt(n * np.sum(taper**2))
    return 2 * np.pi * np.fft.rfftfreq(n, step)[1:], lines[1:]


def moments(omega: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """m_k = ∫ ω^k S dω = ½ Σ ω^k |Y|² for k in MOMENTS (len(MOMENTS), …), of lines (n, …) at ω > 0 (n,)."""
    return 0.5 * np.tensordot(omega ** np.array(MOMENTS)[:, None], np.abs(lines) ** 2, axes=1)


def crossings(of_order: np.ndarray) -> np.ndarray:
    """Upcrossings of its mean a second (…) by moments (len(MOMENTS), …) of a Gaussian process; NaN where still."""
    m0, m2 = of_order[MOMENTS.index(0)], of_order[MOMENTS.index(2)]
    return np.sqrt(np.divide(m2, m0, out=np.full_like(m0, np.nan), where=m0 > 0)) / (2 * np.pi)


class Harmonics:
    """Complex amplitudes of Re Σ Y exp(-iωt) + const that fit a record best, from blocks of it.

    At the frequencies that a realization really has, least squares leaves no leakage, however
    uneven their spacing.
    """

    def __init__(self, omega: np.ndarray):
        self.omega, size = omega, 2 * omega.size + 1
        self.normal: np.ndarray = np.zeros((size, size))
        self.right: np.ndarray = np.zeros((size, 1))

    def add(self, time: np.ndarray, record: np.ndarray) -> None:
        """Take in samples (nt, n) at times (nt,)."""
        phase = np.outer(time, self.omega)
        basis = np.concatenate([np.cos(phase), np.sin(phase), np.ones((len(time), 1))], axis=1)
        # Normal equations: the columns are nearly orthogonal over a record of many periods.
        self.normal += basis.T @ basis
        self.right = self.right + basis.T @ record

    def amplitudes(self) -> np.ndarray:
        """Y (nw, n)."""
        found = linalg.solve(self.normal, self.right, assume_a="pos")
        n = self.omega.size
        return found[:n] + 1j * found[n : 2 * n]


def harmonics(time: np.ndarray, record: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Complex amplitudes (nw, …) of a whole record (nt, …), as by `Harmonics`."""
    fit = Harmonics(omega)
    fit.add(time, record.reshape(len(time), -1))
    return fit.amplitudes().reshape(omega.size, *record.shape[1:])


def transfer(time: np.ndarray, wave: np.ndarray, response: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Complex response per wave amplitude (nw, …): S_xy/S_xx (Heo et al. 2022, eq. 22) line by line.

    Each component of the sea is one spectral line, so cross- and auto-spectrum are Y X̄ and X X̄.
    """
    X, Y = harmonics(time, wave, omega), harmonics(time, response, omega)
    power = np.abs(X) ** 2
    return Y * (X.conj() / power).reshape(-1, *[1] * (Y.ndim - 1))


def smoothed_density(record: np.ndarray, step: float, bandwidth: float) -> tuple[np.ndarray, np.ndarray]:
    """ω [rad/s] and one-sided variance density S(ω) by a smoothed periodogram (Gaussian, `bandwidth` rad/s)."""
    n = len(record)
    omega = 2 * np.pi * np.fft.rfftfreq(n, step)
    density = np.abs(np.fft.rfft(record - record.mean())) ** 2 * step / (np.pi * n)
    half = int(np.ceil(4 * bandwidth / omega[1]))
    kernel = np.exp(-0.5 * (np.arange(-half, half + 1) * omega[1] / bandwidth) ** 2)
    return omega, np.convolve(density, kernel / kernel.sum(), mode="same")
