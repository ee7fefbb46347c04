"""The radiation memory within a step: exact for velocities quadratic in time."""

from typing import NamedTuple

import numpy as np

from solver.kernels import lean_kernel, part_kernel


class Memory(NamedTuple):
    """Radiation memory for one step length: see solver.hydrodynamics.radiation.memory."""

    residue: np.ndarray  # (p, na, na) complex, symmetric
    decay: np.ndarray  # (2, p) complex exp(β c dt)
    weight: np.ndarray  # (2, 3, p) complex, stage s from velocities at 0, ½, 1
    direct: np.ndarray  # (2, 2, na, na) load at stage s from velocity at stage j


def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss's points (n,) of 0 to 1, and their shares (n, 2, 3) in integrals up to ½ and 1 of the parabolas that are 1
    at 0, ½ and 1, and 0 at the others."""
    points, weights = np.polynomial.legendre.leggauss(count)
    x = (points + 1) / 2
    tau = np.stack([x / 2, x], axis=1)
    parabolas = [2 * (tau - 0.5) * (tau - 1), -4 * tau * (tau - 1), 2 * tau * (tau - 0.5)]
    return x, (weights / 2)[:, None, None] * [[0.5], [1.0]] * np.stack(parabolas, axis=2)


@part_kernel
def memory_loads(memory: Memory, history: np.ndarray, velocity: np.ndarray, out: np.ndarray) -> None:
    """Memory load (2, na) at both stages: history plus that of the stages' velocities (2, na)."""
    for s in range(2):
        for i in range(out.shape[1]):
            total = history[s, i]
            for j in range(2):
                for k in range(out.shape[1]):
                    total += memory.direct[s, j, i, k] * velocity[j, k]
            out[s, i] = total


@lean_kernel(forceinline=True)
def memory_history(memory: Memory, past: np.ndarray, velocity: np.ndarray, history: np.ndarray) -> None:
    """Load (2, na) at the stages from the memory so far, past (p, na), and the velocity at the step's start."""
    history[:] = 0.0
    for q in range(memory.residue.shape[0]):
        for s in range(2):
            for k in range(velocity.size):
                r = memory.decay[s, q] * past[q, k] + memory.weight[s, 0, q] * velocity[k]
                if r == 0.0:  # a motion that there is not
                    continue
                for i in range(velocity.size):
                    history[s, i] += (memory.residue[q, k, i] * r).real


@lean_kernel(forceinline=True)
def remember(memory: Memory, past: np.ndarray, start: np.ndarray, stages: np.ndarray) -> None:
    """past (p, na) at the step's end from velocities at its three points."""
    for q in range(memory.residue.shape[0]):
        for k in range(start.size):
            past[q, k] = (
                memory.decay[1, q] * past[q, k]
                + memory.weight[1, 0, q] * start[k]
                + memory.weight[1, 1, q] * stages[0, k]
                + memory.weight[1, 2, q] * stages[1, k]
            )
