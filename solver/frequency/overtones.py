"""What loads of joints that one wave moves do at three, five and seven times its frequency, and by that at its own.

A round of harmonic balance from the linear response v₁, whose load f(v₁) is c v₁ in the first harmonic: the higher ones
move the joints by v = v₁ + Σ vₖ, and f(v) has another first harmonic, which changes v₁.
"""

from typing import NamedTuple

import numpy as np

from solver.frequency import gaussian
from solver.frequency.bent import Load
from solver.frequency.case import Case

ORDERS = np.array([3, 5, 7])
TURNED = np.exp(-1j * np.outer(np.append(1, ORDERS), gaussian.PHASE))  # (4, PHASES)


class Overtones(NamedTuple):
    """Of one wave's response."""

    force: np.ndarray  # (nj,) change of the load in the first harmonic, against the joints
    rates: np.ndarray  # (PHASES, nj) of the joints by the higher harmonics


def overtones(case: Case, damping: np.ndarray, load: Load, V: np.ndarray, axes: np.ndarray) -> Overtones:
    """Of joints with rates V (1, nj), which coordinates (nj,) they are, their load by rate, and all damping (n, n) that
    the model has besides its own.
    """
    v, omega = gaussian.one_period(V), ORDERS * case.omega[0]
    parts = TURNED.conj() @ load(v) * (2 / gaussian.PHASES)
    force = np.zeros((ORDERS.size, len(damping)), complex)
    force[:, axes] = -parts[1:]
    X = case.driven(omega, force[:, None], damping)[0][:, 0]
    rates = (TURNED[1:].T @ (-1j * omega[:, None] * X)[:, axes]).real
    return Overtones(TURNED[0].conj() @ load(v + rates) * (2 / gaussian.PHASES) - parts[0], rates)


def power_error(load: Load, before: np.ndarray, after: np.ndarray) -> float:
    """Largest relative change of mean or std of what an axis absorbs, its load by rate, at rates (PHASES, nj)."""
    was, now = (load(rates) * rates for rates in (before, after))
    pairs = np.array([[x.mean(axis=0), x.std(axis=0)] for x in (was, now)])
    ratio = np.divide(pairs[1], pairs[0], out=np.ones(pairs[0].shape), where=pairs[0] > 0)
    return float(np.abs(ratio - 1).max(initial=0.0))
