"""Lobatto IIIA collocation: fourth order, A-stable, no numerical damping.

A step of length dt has its collocation points at 0, ½ and 1, so records are uniform with dt/2
and meet the equations of motion at every sample. Stage values from stage accelerations a:
    v_s = v₀ + dt Σ A_sj a_j,    q_s = q₀ + dt Σ A_sj v_j,    A = [5 8 -1; 4 16 4]/24.
"""

import numpy as np

A0 = np.array([5 / 24, 1 / 6])  # weight of the step's start
A = np.array([[8 / 24, -1 / 24], [4 / 6, 1 / 6]])  # weights of the stages ½ and 1
C = np.array([0.5, 1.0])
AA0, AA = A @ A0, A @ A
SIMPSON = np.array([1 / 6, 4 / 6, 1 / 6])
