"""Rates of joints whose dampers give way, where that is most of what they move against.

What linear damping c leaves of a load f(v) moves the axis by its mobility H, which is much the same at all frequencies
where a damper holds the axis more than its mass and its springs do. By one h for them, with u the Gaussian rate that c
alone lets it have,

    v = u - h (f(v) - cv),

which has no memory: each u makes a v. To first order that is κ = -24 a₃σ² h, shape's, by h the mean of Re H over the
spectrum of R³. To all orders groups of high waves grow as a whole once f rises no more: a v of any size goes with
little more of u, by 1 - hc of its own.
"""

import numpy as np

from solver.frequency import gaussian
from solver.frequency.shape import density, rate_loads, warped
from solver.multibody.joint_law import JointLaw

RATES = np.sinh(np.linspace(0.0, 7.0, 256))[:, None]  # over their std, dense where small


def power_error(law: JointLaw, sigma: np.ndarray, kappa: np.ndarray, h: np.ndarray) -> float:
    """Largest relative error of mean (of the rms), rms and std of what an axis absorbs, if by κ and not by h (n,)."""
    shaped = sigma * warped(gaussian.SIZES[:, None], kappa)
    told, true = (_absorbed(law, v) for v in (shaped, yielded(law, sigma, kappa, h)))
    size = true[[1, 1, 2]]
    return float(np.divide(np.abs(told - true), size, out=np.zeros(size.shape), where=size > 0).max(initial=0.0))


def yielded(law: JointLaw, sigma: np.ndarray, kappa: np.ndarray, h: np.ndarray) -> np.ndarray:
    """v (m, n) where u, of std σ (n,), has SIZES, of several the least; c takes as much power as f of rates with κ."""
    x, rates = gaussian.SIZES[:, None], RATES * sigma
    load = np.sum(density(kappa) * rate_loads(law, x * sigma).sum(axis=0) * x, axis=0)
    c = np.divide(load, sigma, out=np.zeros(sigma.size), where=sigma > 0)
    u = np.maximum.accumulate(rates + h * (rate_loads(law, rates).sum(axis=0) - c * rates))
    return np.column_stack([np.interp(*axis) for axis in zip((x * sigma).T, u.T, rates.T, strict=True)])


def _absorbed(law: JointLaw, rates: np.ndarray) -> np.ndarray:
    """Mean, rms and std (3, n) of power at rates (m, n) where a Gaussian one has SIZES."""
    power = rates * rate_loads(law, rates)[0]
    mean, square = gaussian.WEIGHTS @ power, gaussian.WEIGHTS @ power**2
    return np.stack([mean, np.sqrt(square), np.sqrt((square - mean**2).clip(min=0.0))])
