"""Utilisation of tubes by NORSOK N-004 (Rev. 3, 2013), 6.3: axial force with bending, and shear and torsion.

Eqs. 6.13, 6.14 and 6.26 to 6.30, by resistances: see solver.structure.tubular. Bending with shear or torsion at a time
(6.3.8.3, 6.3.8.4) and hydrostatic pressure (6.3.9) are not here.
"""

import numpy as np

from solver.kernels import whole_lean_kernel
from solver.structure.tubular import Resistance

AMPLIFIED = 0.01  # 1 - N/N_E, at least: nearer to Euler's load the column has failed, by N/N_c,Rd alone


def bending_utilisation(y: np.ndarray, along: np.ndarray, points: np.ndarray, of: Resistance) -> np.ndarray:
    """Of axial force with bending, the largest of each tube's points (m, n).

    y (m, …): forces, among them N, My, Mz of all points, tube by tube, where `along` (all points, 3) says; points (n,)
    of each tube; of: (n,).
    """
    largest = np.empty((len(y), len(points)))
    _fill(y, along, points, of, largest)
    return largest


@whole_lean_kernel
def _fill(y: np.ndarray, along: np.ndarray, points: np.ndarray, of: Resistance, largest: np.ndarray) -> None:
    """Eq. 6.26 in tension, the larger of 6.27 and 6.28 in compression; N, tension positive."""
    first = 0
    for k in range(points.size):
        tension, column, local = 1 / of.tension[k], 1 / of.column[k], 1 / of.local[k]
        euler, bending, factor = 1 / of.euler[k], 1 / of.bending[k], of.moment_factor[k]
        for s in range(y.shape[0]):
            most = 0.0
            for i in range(first, first + points[k]):
                N, My, Mz = y[s, along[i, 0]], y[s, along[i, 1]], y[s, along[i, 2]]
                M = np.sqrt(My**2 + Mz**2) * bending
                if N > 0:
                    n = N * tension
                    used = n * n / np.sqrt(np.sqrt(n)) + M  # n^1.75
                else:
                    amplified = factor * M / max(1 + N * euler, AMPLIFIED)
                    used = max(amplified - N * column, M - N * local)
                most = max(most, used)
            largest[s, k] = most
        first += points[k]


def shear_utilisation(Vy: np.ndarray, Vz: np.ndarray, T: np.ndarray, of: Resistance) -> np.ndarray:
    """Of shear and of torsion (…,), the larger: eqs. 6.13 and 6.14; Vy and Vz [N], T [N m]."""
    return np.maximum(np.hypot(Vy, Vz) / of.shear, np.abs(T) / of.torsion)
