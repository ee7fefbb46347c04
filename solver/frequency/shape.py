"""How far from Gaussian rates of joints are by their own loads, and what that does to statistics and extremes.

Beyond its linear part most of a load f(v) of a Gaussian rate v is a₃ H₃(v) = a₃ (v³ - 3σ²v). What that moves, by the
mobility H of the axis, changes the fourth cumulant by 4⟨v³ v₁⟩, v₁ = -a₃ H(H₃(v)): with R the covariance of the rate,

    κ = -24 a₃/σ⁴ ∫ h(τ) R(τ)³ dτ,

the mean of Re H over the spectrum of R³, lines of which are sums of three of the rate's. Nothing is below κ = -2.
"""

import numpy as np

from solver.frequency import gaussian
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import joint_loads

BINS = 128  # of frequencies up to the highest


def excess(law: JointLaw, omega: np.ndarray, V: np.ndarray, mobility: np.ndarray) -> np.ndarray:
    """κ (n,) of rates of lines V (n, nw) of axes with a law, H (n, nw) [m/N s] of each."""
    sigma = gaussian.spread(V.T)
    x = gaussian.SIZES[:, None]
    rates = x * sigma
    loads = joint_loads(law, np.zeros(rates.shape), rates)
    third = gaussian.WEIGHTS @ ((loads.pto + loads.loss) * (x**3 - 3 * x)) / 6  # a₃σ³
    kappa = np.zeros(sigma.size)
    for i in np.flatnonzero(sigma > 0):
        kappa[i] = -24 * third[i] / sigma[i] * _mean_mobility(omega, V[i], mobility[i].real)
    return np.where(kappa < 0, kappa / (1 - kappa / 2), kappa)


def _mean_mobility(omega: np.ndarray, v: np.ndarray, H: np.ndarray) -> float:
    """Of H (nw,) over the sums of three lines v (nw,) of either sign; none is known beyond the lines."""
    edges = np.linspace(0.0, omega.max(), BINS + 1)
    power, order = np.histogram(omega, edges, weights=np.abs(v) ** 2)[0], np.argsort(omega)
    both = np.concatenate([power[::-1], power]) / (2 * power.sum())
    three = np.convolve(np.convolve(both, both), both)[2 * BINS - 1 : 4 * BINS - 1]  # about zero, half a bin off
    at = np.abs((np.arange(2 * BINS) - BINS + 0.5) * edges[1])
    return float(three @ np.interp(at, omega[order], H[order], left=0.0))


def power_error(law: JointLaw, sigma: np.ndarray, kappa: np.ndarray) -> float:
    """Largest relative change of the std of what an axis absorbs at rates of std σ (n,) by their kurtosis.

    By Gram and Charlier's series, of weights 1 + κ/24 (x⁴ - 6x² + 3); of a linear load (1 + κ/2)^½.
    """
    x = gaussian.SIZES[:, None]
    rates = x * sigma
    power = joint_loads(law, np.zeros(rates.shape), rates).pto * rates
    usual = _variance(gaussian.WEIGHTS[:, None], power)
    more = _variance(gaussian.WEIGHTS[:, None] * (1 + kappa / 24 * (x**4 - 6 * x**2 + 3)), power)
    ratio = np.divide(more, usual, out=np.ones(usual.size), where=usual > 0)
    return float(np.abs(np.sqrt(ratio.clip(min=0.0)) - 1).max(initial=0.0))


def _variance(weight: np.ndarray, power: np.ndarray) -> np.ndarray:
    return np.sum(weight * power**2, axis=0) - np.sum(weight * power, axis=0) ** 2


def beyond_rayleigh(kappa: np.ndarray, peak: np.ndarray) -> np.ndarray:
    """Extremes expected of processes with κ (n,) over those u σ of Gaussian ones.

    Winterstein's x = u + h₄ (u³ - 3u), h₄ = ((1 + 1.5κ)^½ - 1)/18 (1988), and as much less where κ is negative.
    """
    return _factor(kappa, (peak**2 - 3).clip(min=0.0))


def warped(x: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    """Samples (m, n) of a process of variance 1 where a Gaussian one has x, (m, n) or (m, 1), by the same.

    Where κ is negative it is two thirds of that at first: linear dampers that stand for quadratic ones take the rate's
    std down, too, and the force, as the square of both, is the march's within 3 % in std (see tests).
    """
    usual = gaussian.SIZES[:, None]
    spread = np.sqrt(gaussian.WEIGHTS @ (usual * _factor(kappa, usual**2 - 3)) ** 2)
    return np.asarray(x * _factor(kappa, x**2 - 3) / spread)


def _factor(kappa: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """1 + h₄ (u² - 3), or one over it, by u² - 3 (…, n) of a Gaussian process."""
    factor = 1 + (np.sqrt(1 + 1.5 * np.abs(kappa)) - 1) / 18 * beyond
    return np.where(kappa < 0, 1 / factor, factor)
