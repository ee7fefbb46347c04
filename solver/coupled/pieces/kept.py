"""What pieces leave in the record: their stages beside the samples, with weights, and what presses on the stops."""

import numpy as np

from solver.coupled.pieces.fine import Fine
from solver.coupled.pieces.pace import smooths
from solver.coupled.problem import BEYOND, HOLDS, LET_GO, LOAD, UNTOLD, Between, Output, Problem, Workspace
from solver.coupled.stages import State
from solver.coupled.step import copy, put_stage
from solver.kernels import kernel, lean_kernel, part_kernel
from solver.multibody.joint_law import GONE, HELD, PTO_ZONE, STOP_ZONE, stop_load
from solver.multibody.zones import beyond_law


@lean_kernel
def open_row(output: Output, row: int) -> int:
    """How many rows are kept before those of pieces up to the output's `row`."""
    output.lead[row] = 0.0
    return int(output.between.number[0])


@part_kernel
def keep(
    problem: Problem,
    length: float,
    state: State,
    room: Workspace,
    fine: Fine,
    output: Output,
    row: int,
    first: int,
    done: float,
) -> None:
    """Both stages of a piece, which begins at the share `done` of the time up to `row`, with their weights in it.

    first: of the rows that are kept of that time. The weights are the scheme's own.
    """
    between, n = output.between, output.between.number[0]
    if not _has_room(output, row, 2):
        return
    share = length / (0.5 * problem.dt)
    w = fine.smoothing.work if smooths(problem, state, room) else problem.scheme.work
    if n == first:
        output.lead[row] += share * w[0]
    else:
        between.weight[n - 1] += share * w[0]
    for s in range(2):
        put_stage(room, s, between, n + s)
        between.at[n + s] = row - 1 + done + 0.5 * (s + 1) * share
        between.weight[n + s] = share * w[1 + s]
        between.row[n + s] = row
        between.contact[n + s] = 0.0
        for k in range(problem.bent.size):
            i = problem.bent[k]
            _put_contact(between.contact[n + s, k], room.stage.zone[PTO_ZONE, i], _over_law(problem, room, s, i))
    between.number[0] = n + 2


@part_kernel
def keep_jump(
    problem: Problem, state: State, room: Workspace, output: Output, row: int, first: int, done: float
) -> None:
    """What the next piece begins with, where the law has changed: the last row, or sample, with loads that have jumped.

    Not where that piece passes over them; of a block's first sample the one before is not known.
    """
    between, n = output.between, output.between.number[0]
    if smooths(problem, state, room) or (n == first and row == 0) or not _has_room(output, row, 1):
        return
    copy(room.start.z, between.z[n])
    copy(room.start.dz, between.dz[n])
    copy(state.p, between.p[n])
    copy(state.dp, between.dp[n])
    copy(state.ddp, between.ddp[n])
    if n == first:
        _add_last(output.wrench[row - 1], output.carried[row - 1], output.drag[row - 1], between, n)
    else:
        _add_last(between.wrench[n - 1], between.carried[n - 1], between.drag[n - 1], between, n)
    between.at[n], between.weight[n], between.row[n] = row - 1 + done, 0.0, row
    between.contact[n] = 0.0
    for k in range(problem.bent.size):
        i = problem.bent[k]
        pto, y, dy = room.stage.zone[PTO_ZONE, i], room.start.z[i], room.start.dz[i]
        _put_contact(between.contact[n, k], pto, beyond_law(problem.bodies.law, i, pto, y, dy, state.held[i]))
    between.number[0] = n + 1


@kernel(inline="always")
def _put_contact(contact: np.ndarray, pto: int, beyond: float) -> None:
    """Of an axis, by the zone of its power take-off."""
    contact[HOLDS] = 1.0 if pto == HELD else 0.0
    contact[LET_GO] = 1.0 if abs(pto) == GONE else 0.0
    contact[BEYOND] = beyond


@lean_kernel
def _add_last(wrench: np.ndarray, carried: np.ndarray, drag: np.ndarray, between: Between, n: int) -> None:
    """Loads before the law has changed, to what they change by."""
    for b in range(wrench.shape[0]):
        for r in range(6):
            between.wrench[n, b, r] += wrench[b, r]
    for i in range(carried.size):
        between.carried[n, i] += carried[i]
    for d in range(drag.shape[0]):
        copy(drag[d], between.drag[n, d])


@part_kernel
def _has_room(output: Output, row: int, more: int) -> bool:
    """Whether there is room for so many rows more, and was for all pieces up to `row`; one more is for what jumps."""
    if output.between.number[0] + more >= output.between.at.size:
        output.lead[row] = UNTOLD
    return output.lead[row] != UNTOLD


@lean_kernel
def close_row(output: Output, row: int, first: int) -> None:
    """Where there was no room for all pieces up to `row`, none are kept."""
    if output.lead[row] == UNTOLD:
        output.between.number[0] = first


@part_kernel
def note(problem: Problem, room: Workspace, output: Output, length: float, middle: int, end: int) -> None:
    """Of a step of this length [s], of which half goes to each of the output's rows `middle` and `end`: the stages'
    loads on the stops, where larger than those noted there, with all loads then, and what is held or let go of."""
    stage, rows = room.stage, (middle, end)
    for n in range(problem.bent.size):
        i = problem.bent[n]
        pto = stage.zone[PTO_ZONE, i]
        for s in range(2):
            load = stop_load(problem.bodies.law, i, stage.zone[STOP_ZONE, i], stage.z[s, i], stage.dz[s, i])
            contact = output.contact[rows[s], n]
            if load > contact[LOAD]:
                contact[LOAD] = load
                for b in range(stage.wrench.shape[1]):
                    copy(stage.wrench[s, b], output.struck[rows[s], n, b])
            contact[HOLDS] += length / problem.dt if pto == HELD else 0.0
            contact[LET_GO] = 1.0 if abs(pto) == GONE else 0.0
            contact[BEYOND] = _over_law(problem, room, s, i)


@kernel(inline="always")
def _over_law(problem: Problem, room: Workspace, s: int, i: int) -> float:
    stage, law = room.stage, problem.bodies.law
    return beyond_law(law, i, stage.zone[PTO_ZONE, i], stage.z[s, i], stage.dz[s, i], stage.residual[s, i])
