"""What joints of bent laws bear and absorb: statistics over their rates as these are distributed, by the whole law.

Rates are Gaussian, one harmonic, or the sum of waves of known phases, as the linear model has them; loads f(v) are
alike in both senses.
"""

from collections.abc import Callable

import numpy as np

from solver.frequency import gaussian
from solver.frequency.shape import density, shaped, warped
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import JointLoads, bent, joint_loads
from solver.statistics import moments

Load = Callable[[np.ndarray], np.ndarray]  # of power take-offs (m, n) at rates (m, n)
ONE = np.full(gaussian.PHASES, 1 / gaussian.PHASES)  # weights of a harmonic's samples in means
FEW = range(2, 6)  # waves, whose rates are far from Gaussian ones
COS, SIN = np.cos(gaussian.PHASE)[:, None], np.sin(gaussian.PHASE)[:, None]


def pto_load(law: JointLaw, axes: np.ndarray) -> Load:
    """Of power take-offs by rate, of some axes (n,) of a law."""
    return lambda rates: _loads(law, axes, rates).pto[:, axes]


def rate_load(law: JointLaw, axes: np.ndarray) -> Load:
    """All that goes by rate."""

    def load(rates: np.ndarray) -> np.ndarray:
        loads = _loads(law, axes, rates)
        return (loads.pto + loads.loss)[:, axes]

    return load


def _loads(law: JointLaw, axes: np.ndarray, rates: np.ndarray) -> JointLoads:
    every = np.zeros((len(rates), bent(law).size))
    every[:, axes] = rates
    return joint_loads(law, np.zeros(every.shape), every)


def borne_table(
    load: Load, V: np.ndarray, usual: np.ndarray, F: np.ndarray, of: gaussian.Process, kappa: np.ndarray
) -> np.ndarray:
    """(n, 5) of forces that are linear but for -f(v), of which their lines F (nl, n) and statistics have -cv, (n, 5).

    c = ⟨fv⟩/⟨v²⟩ of one harmonic, or a rate with the kurtosis κ (n,) beyond a Gaussian's. Of waves whose phases are
    known, those of the sum. Else what c leaves goes with nothing linear, σ² = σ_L² + ⟨(f - cv)²⟩, and extremes are
    those of the cycle in which the rate is largest: all that is linear, L = F + cv, has a part in phase with v and one
    a quarter turn off.
    """
    mean, sigma, one = usual[:, 2], gaussian.spread(V), len(V) == 1
    variance = np.where(sigma > 0, sigma**2, 1.0)
    size = np.sqrt(variance)
    v, weights = (gaussian.one_period(V), ONE[:, None]) if one else (gaussian.SIZES[:, None] * sigma, density(kappa))
    c = np.sum(weights * load(v) * v, axis=0) / variance
    if (rates := of.sampled(V)) is not None and (linear := of.sampled(F)) is not None:
        level = mean + linear - linear.mean(axis=0) + c * rates
        return moments(level - load(rates if one else shaped(rates, sigma, kappa)))  # of loads that may jump
    v = sigma * warped(gaussian.SIZES[:, None], kappa)
    f, L = load(v), F + c * V
    c = gaussian.WEIGHTS @ (f * v) / variance
    std = np.sqrt(gaussian.spread(L - c * V) ** 2 + gaussian.WEIGHTS @ (f - c * v) ** 2)
    fastest = shaped(gaussian.table(np.zeros(len(c)), V, of)[:, 0], sigma, kappa)
    phase = 0.5 * np.sum((L * V.conj()).real, axis=0) / variance
    off = gaussian.spread(L - phase * V) * fastest / size
    cycle = phase * fastest * COS - load(fastest * COS) + off * SIN
    return np.stack([mean + cycle.max(axis=0), mean + cycle.min(axis=0), mean, np.hypot(mean, std), std], axis=-1)


def fastest(V: np.ndarray, of: gaussian.Process, kappa: np.ndarray) -> np.ndarray:
    """The largest sizes (n,) of rates of lines V (nl, n) and kurtosis κ (n,) beyond a Gaussian's, in either sense."""
    return shaped(gaussian.fastest(V, of), gaussian.spread(V), kappa)


def absorbed_table(load: Load, V: np.ndarray, of: gaussian.Process, kappa: np.ndarray) -> np.ndarray:
    """(5,) of P = Σ fᵢ(vᵢ) vᵢ of axes with rates of lines V (nl, n) and kurtosis κ (n,) beyond a Gaussian's.

    Two axes' powers go together as squares of their rates do, by ρᵢⱼ², and vary less by few lines as theirs do. What
    the largest is above the mean is the largest eigenvalue of ρᵢⱼ √(pᵢpⱼ), p of each alone: that of linear laws, see
    gaussian.power_table.
    """
    S = gaussian.covariance(V, V)
    sigma = np.sqrt(np.diag(S))
    if (v := gaussian.met(V) if len(V) in FEW and not of.known else of.sampled(V)) is not None:
        v = v if len(V) == 1 else shaped(v, sigma, kappa)
        return gaussian.tabulated([np.sum(load(v) * v, axis=1, keepdims=True)])[0]
    v = sigma * warped(gaussian.SIZES[:, None], kappa)
    cycle = fastest(V, of, kappa) * COS
    power = load(v) * v
    each = gaussian.WEIGHTS @ power
    std = np.sqrt((gaussian.WEIGHTS @ power**2 - each**2).clip(min=0.0))
    above = np.sqrt((np.max(load(cycle) * cycle, axis=0) - each).clip(min=0.0))
    alike = np.divide(S, np.outer(sigma, sigma), out=np.zeros(S.shape), where=np.outer(sigma, sigma) > 0)
    linear = np.divide(each, sigma**2, out=np.zeros(each.size), where=sigma > 0)
    mean, total = each.sum(), np.sqrt(std @ alike**2 @ std) * gaussian.of_lines(np.diag(linear), V)
    largest = mean + np.linalg.eigvalsh(alike * np.outer(above, above)).max(initial=0.0)
    return np.array([largest, 0.0, mean, np.hypot(mean, total), total])
