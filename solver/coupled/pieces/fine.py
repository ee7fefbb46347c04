"""A step's problem for a piece: the constants that go by its length, and what the wave drives within."""

from typing import Any, NamedTuple

import numpy as np

from solver.coupled.between import NODES, nearest
from solver.coupled.memory import Memory, gauss
from solver.coupled.modal import fill_flexibility
from solver.coupled.newton import shorter_part
from solver.coupled.problem import LEAST, Drive, Problem
from solver.coupled.scheme import SMOOTHING, Scheme
from solver.kernels import inner_kernel, lean_kernel, part_kernel

SHORT = 0.25  # of a step: in such pieces pressure and drag are evaluated at their ends alone
ONE: Any = np.int64(1)  # a bare 1 is of another type, with which all that it is handed to would be compiled once more


POINTS, SHARES = gauss(8)


class Fine(NamedTuple):
    """What a problem of another step length has of its own."""

    memory: Memory
    inverse: np.ndarray
    H: np.ndarray
    constant: np.ndarray
    drive: Drive  # at the start, the middle and the end
    weight: np.ndarray  # (NODES,)
    smoothing: Scheme
    length: np.ndarray  # (1,) [s] of the step that all this is for; negative where it smooths
    shared: np.ndarray  # (1,) pieces that Newton's matrix has served; 0 if it is of another length or zone
    knots: np.ndarray  # (1,) [s] from the first to the last of the state's accelerations, through which they go on


def new_fine(problem: Problem, drive: Drive) -> Fine:
    """Room for pieces of this problem's steps, driven by so many quantities."""
    return Fine(
        memory=Memory(problem.memory.residue, *(np.empty_like(part) for part in problem.memory[1:])),
        inverse=np.empty_like(problem.inverse),
        H=np.empty_like(problem.H),
        constant=np.empty_like(problem.constant),
        drive=Drive(*(np.empty((3, *part.shape[1:])) for part in drive)),
        weight=np.empty(NODES),
        smoothing=SMOOTHING,
        length=np.zeros(1),
        shared=np.zeros(1, np.int64),
        knots=np.zeros(1),
    )


@part_kernel
def of_length(problem: Problem, length: float, smooths: bool, fine: Fine) -> Problem:
    """The problem for steps of this length [s]; Newton's tolerance goes by that: on a stop loads are large."""
    share, scheme = length / problem.dt, fine.smoothing if smooths else problem.scheme
    own = -length if smooths else length
    if fine.length[0] != own:
        _fill_memory(problem.beta, length, fine.memory)
        fill_flexibility(problem.structure, length, scheme, fine.inverse, fine.H)
        shorter_part(problem.bodies, problem.constant, problem.dt, length, fine.constant)
        fine.length[0], fine.shared[0] = own, 0
    return Problem(
        problem.bodies,
        problem.structure,
        fine.memory,
        fine.inverse,
        fine.H,
        fine.constant,
        problem.stiffness,
        problem.beta,
        problem.bent,
        problem.pace,
        problem.swing,
        length,
        max(problem.tolerance * share, LEAST),
        problem.near / share,
        problem.slight,
        problem.iterations,
        True,
        share <= SHORT,
        scheme,
    )


@lean_kernel
def _fill_memory(beta: np.ndarray, h: float, memory: Memory) -> None:
    """Decay, weights and direct part for steps of h [s], see assembly.memory; by Gauss's rule."""
    memory.direct[:] = 0.0
    for q in range(beta.size):
        half = np.exp(beta[q] * (h / 2))
        memory.decay[0, q], memory.decay[1, q] = half, half * half
        for s in range(2):
            for j in range(3):
                memory.weight[s, j, q] = 0.0
        for g in range(POINTS.size // 2):  # in pairs: what is left of one is what is lost of the other
            lost = np.exp(beta[q] * (h / 2 * POINTS[g]))
            left = half / lost
            for j in range(3):
                memory.weight[0, j, q] += h * (SHARES[g, 0, j] * left + SHARES[-1 - g, 0, j] * lost)
                memory.weight[1, j, q] += h * (SHARES[g, 1, j] * left * left + SHARES[-1 - g, 1, j] * lost * lost)
        for s in range(2):
            for j in range(2):
                real, imag = memory.weight[s, 1 + j, q].real, memory.weight[s, 1 + j, q].imag
                for i in range(memory.residue.shape[1]):
                    for k in range(memory.residue.shape[2]):
                        residue = memory.residue[q, i, k]
                        memory.direct[s, j, i, k] += residue.real * real - residue.imag * imag


@lean_kernel
def sample_drive(drive: Drive, at: float, n: int, fine: Fine) -> None:
    """What the wave drives at a sample that need not be whole, as row n of the piece's own drive."""
    first, count = nearest(at, drive.modal.shape[0], fine.weight), min(NODES, drive.modal.shape[0])
    own = fine.drive
    own.field[n] = 0.0
    own.excitation[n] = 0.0
    own.modal[n] = 0.0
    own.station[n] = 0.0
    own.wet[n] = 0.0
    own.push[n] = 0.0
    for j in range(count):
        w, m = fine.weight[j], first + j
        _add(w, drive.field[m], own.field[n])
        _add(w, drive.modal[m], own.modal[n])
        for b in range(own.excitation.shape[1]):
            _add(w, drive.excitation[m, b], own.excitation[n, b])
        for d in range(own.station.shape[1]):
            _add(w, drive.station[m, d], own.station[n, d])
        _add(w, drive.wet[m], own.wet[n])
        for d in range(own.push.shape[1]):
            _add(w, drive.push[m, d], own.push[n, d])


@inner_kernel
def _add(weight: float, source: np.ndarray, target: np.ndarray) -> None:
    for i in range(source.size):
        target[i] += weight * source[i]
