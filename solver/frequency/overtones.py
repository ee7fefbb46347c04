"""What loads of joints that one wave moves do at three, five and seven times its frequency, and by that at its own.

A round of harmonic balance from the linear response v₁, whose load f(v₁) is c v₁ in the first harmonic: the higher ones
move the joints by v = v₁ + Σ vₖ, and f(v) has another first harmonic, which changes v₁.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solver.coupled.linear import LinearModel
from solver.frequency import gaussian

ORDERS = np.array([3, 5, 7])
TURNED = np.exp(-1j * np.outer(np.append(1, ORDERS), gaussian.PHASE))  # (4, PHASES)


class Overtones(NamedTuple):
    """Of one wave's response."""

    force: np.ndarray  # (nj,) change of the load in the first harmonic, against the joints
    rates: np.ndarray  # (PHASES, nj) of the joints by the higher harmonics


def overtones(
    model: LinearModel,
    omega: float,
    damping: np.ndarray,
    load: Callable[[np.ndarray], np.ndarray],
    V: np.ndarray,
    axes: np.ndarray,
) -> Overtones:
    """Of joints with rates V (1, nj), which coordinates (nj,) they are, their load by rate, and all damping (n, n) that
    the model has besides its own.

    Added mass at the higher frequencies is that at infinity, and nothing radiates there.
    """
    v = gaussian.one_period(V)
    parts = TURNED.conj() @ load(v) * (2 / gaussian.PHASES)
    w = (ORDERS * omega)[:, None, None]
    force = np.zeros((ORDERS.size, len(model.mass), 1), complex)
    force[:, axes, 0] = -parts[1:]
    X = np.linalg.solve(model.stiffness - w**2 * model.mass - 1j * w * (model.damping + damping), force)
    rates = (TURNED[1:].T @ (-1j * w * X)[:, axes, 0]).real
    return Overtones(TURNED[0].conj() @ load(v + rates) * (2 / gaussian.PHASES) - parts[0], rates)


def power_error(load: Callable[[np.ndarray], np.ndarray], before: np.ndarray, after: np.ndarray) -> float:
    """Largest relative change of mean or std of what an axis absorbs, its load by rate, at rates (PHASES, nj)."""
    was, now = (load(rates) * rates for rates in (before, after))
    pairs = np.array([[x.mean(axis=0), x.std(axis=0)] for x in (was, now)])
    ratio = np.divide(pairs[1], pairs[0], out=np.ones(pairs[0].shape), where=pairs[0] > 0)
    return float(np.abs(ratio - 1).max(initial=0.0))
