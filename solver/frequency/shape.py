"""How far from Gaussian rates of joints are by their own loads, and what that does to statistics and extremes.

Beyond its linear part most of a load f(v) of a Gaussian rate v is a₃ H₃(v) = a₃ (v³ - 3σ²v). What that moves, by the
mobility H of the axis, changes the fourth cumulant by 4⟨v³ v₁⟩, v₁ = -a₃ H(H₃(v)): with R the covariance of the rate,

    κ = -24 a₃/σ⁴ ∫ h(τ) R(τ)³ dτ,

the mean of Re H over the spectrum of R³, lines of which are sums of three of the rate's. Of the motion y it is, with
R_yv = ⟨y v(t - τ)⟩, the mean of Re H/ω over the odd spectrum of R_yv³, and σ_y⁴ for σ⁴. Nothing is below κ = -2.

Such rates are as dense at x = v/σ as a Gaussian's, times 1 + κ/24 (x⁴ - 6x² + 3) (Gram and Charlier), and a linear
damping ⟨fv⟩/⟨v²⟩ takes as much power as a load: of a quadratic damper (1 + κ/8) of that of a Gaussian rate.
"""

from functools import lru_cache

import numpy as np

from solver.frequency import gaussian
from solver.keys import shared
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import joint_loads

BINS = 128  # of frequencies up to the highest
FLATTER = 200  # shapes that are flatter than a Gaussian's
TALLEST = 4.0  # kurtosis up to which that series is a density
TINY = 1e-9


def excess(law: JointLaw, omega: np.ndarray, V: np.ndarray, mobility: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """κ (2, n) of rates of lines V (n, nw), and of their motions, of axes with a law, H (n, nw) [m/N s] of each.

    And h (n,), the first mean of Re H, with that at the highest line for all beyond: see yielding.
    """
    sigma = gaussian.spread(V.T)
    x = gaussian.SIZES[:, None]
    third = gaussian.WEIGHTS @ (rate_loads(law, x * sigma).sum(axis=0) * (x**3 - 3 * x)) / 6  # a₃σ³
    kappa, h, highest = np.zeros((2, sigma.size)), np.zeros(sigma.size), np.argmax(omega)
    for i in np.flatnonzero(sigma > 0):
        means, within = _mean_mobilities(omega, np.abs(V[i]) ** 2, mobility[i].real)
        kappa[:, i] = -24 * third[i] / sigma[i] * means
        h[i] = means[0] + (1 - within) * mobility[i, highest].real
    return np.where(kappa < 0, kappa / (1 - kappa / 2), np.minimum(kappa, TALLEST)), h


def more_damping(law: JointLaw, sigma: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    """By how much more of it power take-offs damp, and quadratic dampers (2, n), for κ (n,) of rates of std σ (n,)."""
    x = gaussian.SIZES[:, None]
    taken = x * rate_loads(law, x * sigma)[0]
    usual, shaped = (np.sum(weights * taken, axis=0) for weights in (gaussian.WEIGHTS[:, None], density(kappa)))
    return np.stack([np.divide(shaped - usual, usual, out=np.zeros(usual.shape), where=usual > 0), kappa / 8])


def rate_loads(law: JointLaw, rates: np.ndarray) -> np.ndarray:
    """(2, m, n) of power take-offs, and all else by rate, at rates (m, n): of either sense the mean."""
    there, back = (joint_loads(law, np.zeros(rates.shape), v) for v in (rates, -rates))
    return np.stack((there.pto - back.pto, there.loss - back.loss)) / 2


def density(kappa: np.ndarray) -> np.ndarray:
    """Weights (…, n) of SIZES of rates with κ (n,), for means of what is even."""
    x = gaussian.SIZES[:, None]
    return np.asarray(gaussian.WEIGHTS[:, None] * (1 + kappa / 24 * (x**4 - 6 * x**2 + 3)))


def _mean_mobilities(omega: np.ndarray, square: np.ndarray, H: np.ndarray) -> tuple[np.ndarray, float]:
    """(2,) of H (nw,) over the sums of three lines |v|² (nw,) of either sign, even and odd; none is known beyond the
    lines. And the even ones' share that is not beyond."""
    edges = np.linspace(0.0, omega.max(), BINS + 1)
    at, order = (np.arange(2 * BINS) - BINS + 0.5) * edges[1], np.argsort(omega)  # about zero, half a bin off
    there = np.interp(np.abs(at), omega[order], H[order], left=0.0)
    sums = []
    for share, sense, heard in ((square, 1, there), (square / omega, -1, -there / at)):
        power = np.histogram(omega, edges, weights=share)[0]
        both = np.concatenate([sense * power[::-1], power]) / 2
        seen = np.convolve(np.convolve(both, both), both)[2 * BINS - 1 : 4 * BINS - 1]
        sums.append((seen @ heard, seen.sum()))
    (even, within), (odd, _) = sums
    size, cube = np.sum(square / omega**2), square.sum() ** 3
    return np.array([even / cube, odd / (square.sum() * size**2)]), within / cube


def power_error(law: JointLaw, sigma: np.ndarray, kappa: np.ndarray) -> float:
    """Largest relative error of the std of what an axis absorbs at rates of std σ (n,) by what κ does not tell.

    By Gram and Charlier's series κ makes a linear load's (1 + κ/2)^½ of what it is. Of that change, as much as of what
    linear damping leaves of the loads is beyond the third order, 1 - 3! a₃²σ⁶/⟨(f - cv)²⟩: 0.06 of it by quadratic
    dampers, 0.71 by friction. And κ is of first order in a₃: what bounds it below, a share of κ/2 of it, is what a
    positive one may lack.
    """
    x = gaussian.SIZES[:, None]
    rates = x * sigma
    f, power = rate_loads(law, rates).sum(axis=0), joint_loads(law, np.zeros(rates.shape), rates).pto * rates
    linear, third = (gaussian.WEIGHTS @ (f * order) for order in (x, x**3 - 3 * x))
    left = gaussian.WEIGHTS @ f**2 - linear**2
    beyond = 1 - np.divide(third**2 / 6, left, out=np.ones(left.size), where=left > third**2 / 6)
    usual = _variance(gaussian.WEIGHTS[:, None], power)
    more = _variance(density(kappa), power)
    ratio = np.divide(more, usual, out=np.ones(usual.size), where=usual > 0)
    unknown = np.minimum(beyond + kappa.clip(min=0.0) / 2, 1.0)
    return float((unknown * np.abs(np.sqrt(ratio.clip(min=0.0)) - 1)).max(initial=0.0))


def _variance(weight: np.ndarray, power: np.ndarray) -> np.ndarray:
    return np.sum(weight * power**2, axis=0) - np.sum(weight * power, axis=0) ** 2


def reached(table: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    """Statistics (n, 5) of processes with κ (n,), by those of Gaussian ones."""
    mean, std = table[:, 2], table[:, 4]
    return np.concatenate([(mean + shaped(table[:, :2].T - mean, std, kappa)).T, table[:, 2:]], axis=1)


def shaped(x: np.ndarray, sigma: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    """Samples (…, n) of processes with std σ and κ (n,) where Gaussian ones of that std have x (…, n)."""
    size = np.where(sigma > 0, sigma, 1.0)
    return np.asarray(size * warped(x / size, kappa))


def warped(u: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    """Samples (m, n) of a process of variance 1 with κ (n,) where a Gaussian one has u, (m, n) or (m, 1).

    By Winterstein (1988): in proportion x = u + h (u³ - 3u), h = ((1 + 1.5κ)^½ - 1)/18, and of a negative κ
    x + h (x³ - 3x) = u, by the h < ⅓ that has this κ.
    """
    every = gaussian.SIZES[:, None]
    return np.asarray(_cubic(u, kappa) / np.sqrt(gaussian.WEIGHTS @ _cubic(every, kappa) ** 2))


def _cubic(u: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    h, kurtosis = _flatter()
    tall = (np.sqrt(1 + 1.5 * kappa.clip(min=0.0)) - 1) / 18
    x = np.asarray(u * (1 + tall * (u**2 - 3)))
    return np.where(kappa < 0, _inverse(u, np.interp(-kappa, kurtosis, h)), x) if np.any(kappa < 0) else x


def _inverse(u: np.ndarray, h: np.ndarray) -> np.ndarray:
    """x of x + h (x³ - 3x) = u, 0 <= h < ⅓."""
    p = 1 / np.maximum(h, TINY) - 3
    return np.asarray(2 * np.sqrt(p / 3) * np.sinh(np.arcsinh(1.5 * u * (1 + 3 / p) * np.sqrt(3 / p)) / 3))


@lru_cache(maxsize=1)
def _flatter() -> tuple[np.ndarray, np.ndarray]:
    """h, and -κ of the x that it makes, which grows with that."""
    h = np.linspace(0.0, 0.33, FLATTER)
    x = _inverse(gaussian.SIZES[:, None], h)
    kurtosis = 3 - (gaussian.WEIGHTS @ x**4) / (gaussian.WEIGHTS @ x**2) ** 2
    return shared(h), shared(kurtosis)
