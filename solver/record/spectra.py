"""Spectra and response amplitude operators from time records."""

import numpy as np
from scipy import linalg


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
