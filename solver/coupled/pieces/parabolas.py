"""The parabolas of a step's accelerations and forces, with which the next one goes on."""

import numpy as np

from solver.coupled.pieces.fine import Fine
from solver.coupled.problem import Workspace
from solver.coupled.stages import State
from solver.coupled.step import copy
from solver.kernels import inner_kernel, lean_kernel

LONGER = 2.0  # times the last one may be what goes on with its parabolas


@inner_kernel
def forget(state: State) -> None:
    """Nothing to extrapolate from: loads have jumped."""
    for n in range(2):
        copy(state.ddz[2], state.ddz[n])
        copy(state.force[2], state.force[n])


@inner_kernel
def go_on(state: State, fine: Fine, length: float) -> None:
    """The next step, of this length [s], goes on with the parabolas of the last one, unless far longer."""
    share = length / fine.knots[0]
    fine.knots[0] = length
    if share > LONGER:
        forget(state)
    elif share != 1:
        _space(state.ddz, share)
        _space(state.force, share)


@lean_kernel
def _space(knots: np.ndarray, share: float) -> None:
    """Values (3, n) at -1, -1/2 and 0 become those at -share, -share/2 and 0, of the same parabolas."""
    for i in range(knots.shape[1]):
        a, b, c = knots[0, i], knots[1, i], knots[2, i]
        first, second = share * (a - 4 * b + 3 * c), share * share * (2 * a - 4 * b + 2 * c)
        knots[0, i], knots[1, i] = c - first + second, c - 0.5 * first + 0.25 * second


@inner_kernel
def again(state: State, room: Workspace, fine: Fine) -> None:
    """The next step is a part of that in the stages, and goes on with its parabolas."""
    if fine.length[0] > 0:
        nc = room.stage.ddz.shape[1] - state.ddz.shape[1]
        _turn_back(room.stage.ddz[:, nc:], state.ddz)
        _turn_back(room.stage.force, state.force)


@lean_kernel
def _turn_back(stages: np.ndarray, knots: np.ndarray) -> None:
    """Values (3, n) at -1 and -1/2 of the parabolas through those at 0, 1/2 and 1, these two in the stages (2, n)."""
    for i in range(knots.shape[1]):
        a, b, c = knots[2, i], stages[0, i], stages[1, i]
        knots[0, i], knots[1, i] = 6 * a - 8 * b + 3 * c, 3 * a - 3 * b + c
