"""Utilisation of tubes by NORSOK N-004 (Rev. 3, 2013), 6.3: axial force with bending, and shear and torsion.

Eqs. 6.13, 6.14 and 6.26 to 6.30, by resistances: see solver.structure.tubular. Bending with shear or torsion at a time
(6.3.8.3, 6.3.8.4) and hydrostatic pressure (6.3.9) are not here.
"""

import numpy as np

from solver.kernels import lean_kernel, whole_lean_kernel
from solver.structure.tubular import Resistance

AMPLIFIED = 0.01  # 1 - N/N_E, at least: nearer to Euler's load the column has failed, by N/N_c,Rd alone


def bending_utilisation(along: np.ndarray, points: np.ndarray, of: Resistance) -> np.ndarray:
    """Of axial force with bending, the largest of each tube's points (m, n).

    along (m, all points, 3): N, My, Mz, tube by tube, which have `points` (n,) each; of: (n,).
    """
    largest = np.empty((len(along), len(points)))
    _fill(along, points, of, largest)
    return largest


@whole_lean_kernel
def _fill(along: np.ndarray, points: np.ndarray, of: Resistance, largest: np.ndarray) -> None:
    for s in range(along.shape[0]):
        at = 0
        for k in range(points.size):
            most = 0.0
            for _ in range(points[k]):
                moment = np.sqrt(along[s, at, 1] ** 2 + along[s, at, 2] ** 2)
                most = max(most, _axial_and_bending(along[s, at, 0], moment, of, k))
                at += 1
            largest[s, k] = most


@lean_kernel(inline="always")
def _axial_and_bending(N: float, moment: float, of: Resistance, k: int) -> float:
    """Eq. 6.26 in tension, the larger of 6.27 and 6.28 in compression, of the k-th tube; N, tension positive."""
    M = moment / of.bending[k]
    if N > 0:
        n = N / of.tension[k]
        return n * n / np.sqrt(np.sqrt(n)) + M  # n^1.75
    amplified = of.moment_factor[k] * M / max(1 + N / of.euler[k], AMPLIFIED)
    return max(amplified - N / of.column[k], M - N / of.local[k])


def shear_utilisation(Vy: np.ndarray, Vz: np.ndarray, T: np.ndarray, of: Resistance) -> np.ndarray:
    """Of shear and of torsion (…,), the larger: eqs. 6.13 and 6.14; Vy and Vz [N], T [N m]."""
    return np.maximum(np.hypot(Vy, Vz) / of.shear, np.abs(T) / of.torsion)
