"""Lobatto IIIA collocation: fourth order, A-stable, no numerical damping; and one of second order that is L-stable.

A step of length dt has its collocation points at 0, ½ and 1, so records are uniform with dt/2
and meet the equations of motion at every sample. Stage values from stage accelerations a:
    v_s = v₀ + dt Σ A_sj a_j,    q_s = q₀ + dt Σ A_sj v_j,    A = [5 8 -1; 4 16 4]/24.

SMOOTHING collocates at ½ and 1 alone, A = [0 3 -1; 0 4 0]/4. Where a load jumps, the start's acceleration is that of
modes far faster than a step, which Lobatto's points would carry on. This one leaves of them, at ω,
    |R|² = (1 + y²/16)/(1 + y²/16 + y⁴/16),    y = ωdt,
so that they come to follow the load, as in the first steps of Rannacher (1984).
"""

from typing import NamedTuple

import numpy as np

C = np.array([0.5, 1.0])


class Scheme(NamedTuple):
    """Weights of the stages ½ and 1."""

    A0: np.ndarray  # (2,) of the start's acceleration, in rates
    A: np.ndarray  # (2, 2) of the stages' accelerations
    AA0: np.ndarray  # (2,) and in positions
    AA: np.ndarray  # (2, 2)
    work: np.ndarray  # (3,) of powers at 0, ½ and 1


def _scheme(A0: list[float], A: list[list[float]]) -> Scheme:
    start, own = np.array(A0), np.array(A)
    return Scheme(start, own, own @ start, own @ own, np.array([A0[1], *A[1]]))


LOBATTO = _scheme([5 / 24, 1 / 6], [[8 / 24, -1 / 24], [4 / 6, 1 / 6]])
SMOOTHING = _scheme([0.0, 0.0], [[3 / 4, -1 / 4], [1.0, 0.0]])
