"""What pieces leave in the record: their stages beside the samples, with weights, and what presses on the stops."""

from solver.coupled.pieces.fine import Fine
from solver.coupled.pieces.pace import smooths
from solver.coupled.problem import BEYOND, HOLDS, LET_GO, LOAD, UNTOLD, Output, Problem, Workspace
from solver.coupled.stages import State
from solver.coupled.step import copy, put_stage
from solver.kernels import kernel, lean_kernel, part_kernel
from solver.multibody.joint_law import GONE, HELD, PTO_ZONE, STOP_ZONE, stop_load
from solver.multibody.zones import beyond_law


@lean_kernel
def open_row(output: Output, row: int) -> int:
    """How many rows are kept before those of pieces up to the output's `row`."""
    between = output.between
    output.lead[row] = 0.0
    between.follows[0] = True
    return int(between.number[0])


@part_kernel
def keep(
    problem: Problem,
    length: float,
    state: State,
    room: Workspace,
    fine: Fine,
    output: Output,
    row: int,
    done: float,
) -> None:
    """Both stages of a piece, which begins at the share `done` of the time up to `row`, with their weights in it.

    The scheme's own weights: Simpson's; where loads jump at its start, of which the stages know nothing, the middle's.
    """
    between, n = output.between, output.between.number[0]
    if n + 2 > between.at.size:
        output.lead[row] = UNTOLD
    if output.lead[row] == UNTOLD:
        return
    share = length / (0.5 * problem.dt)
    simpson = between.follows[0] and not smooths(problem, state, room)
    w = problem.scheme.work if simpson else fine.smoothing.work
    if done == 0:
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
            pto = room.stage.zone[PTO_ZONE, i]
            between.contact[n + s, k, HOLDS] = 1.0 if pto == HELD else 0.0
            between.contact[n + s, k, LET_GO] = 1.0 if abs(pto) == GONE else 0.0
            between.contact[n + s, k, BEYOND] = _over_law(problem, room, s, i)
    between.number[0] = n + 2
    between.follows[0] = True


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
