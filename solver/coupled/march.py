"""The time loop on the coupled system: see step, and pieces for the steps in which a joint's law changes."""

from solver.coupled.energy import GAP, SCALE, open_by, stored
from solver.coupled.modal import carry
from solver.coupled.pieces.fine import Fine
from solver.coupled.pieces.kept import note
from solver.coupled.pieces.leaving import undisturbed
from solver.coupled.pieces.pieces import bends, in_contact, in_pieces
from solver.coupled.problem import EXCURSION, NOT_FINITE, OK, UNBALANCED, Drive, Output, Problem, Workspace
from solver.coupled.stages import State
from solver.coupled.step import account_work, advance, attempt, copy, put_out, refresh, rings, within
from solver.kernels import kernel, whole_lean_kernel
from solver.multibody.minimal import move

REFRESH = 8  # steps that share Newton's matrix while it serves
WATCH = 8  # steps after which the energy balance is looked at
GROSSLY = 0.1  # of the energy exchanged, by which the energy balance is never open


@whole_lean_kernel
def march(
    problem: Problem, drive: Drive, state: State, room: Workspace, fine: Fine | None, quiet: int, output: Output
) -> tuple[int, int, int]:
    """Advance `state` through all samples of `drive`; return (outcome, sample, iterations used).

    room: see new_workspace. fine: see pieces.fine; None where no joint's law bends, and then nothing of pieces is even
    compiled. Every WATCH steps the energy balance is checked; a gap from before step `quiet`, by the jolt of the
    start, is not counted. On an outcome other than OK, `sample` is where the run stopped; a state is never left with
    NaN unnoticed.
    """
    used, spent, calm = 0, 0, True
    _begin(problem, state, room)
    patience = 3 if rings(problem) else 2
    steps, nc = (drive.modal.shape[0] - 1) // 2, problem.structure.carrier.shape[0]
    for step in range(steps):
        sample = 2 * step  # where the step starts
        if step % WATCH == 0 and not _balanced(problem, state, room, step <= quiet):
            return UNBALANCED, sample, used
        outcome, whole = OK, True
        if fine is not None:
            whole = not in_contact(problem, state, room)
        if whole:
            if (step % REFRESH == 0 or spent > patience) and not refresh(problem, room):
                return NOT_FINITE, sample, used
            outcome, spent = attempt(problem, drive, sample + 1, state, room)
            used += spent
        if fine is not None:
            calm = whole and outcome == OK and undisturbed(problem, room)
            whole = whole and outcome == OK and (calm or not bends(problem, state, room))
            if not whole:
                outcome, spent = in_pieces(problem, drive, sample, state, room, fine, output)
                used += spent
        if outcome != OK:
            return outcome, sample + 1, used
        if not within(problem.bodies.limit, room.stage.z[1], room.stage.motion[1].rotation):
            copy(room.stage.z[1, nc:], state.z)
            return EXCURSION, sample + 2, used
        if whole:
            account_work(problem, drive, sample + 1, state, room)
            put_out(room, output, sample)
            if fine is not None and not calm:
                note(problem, room, output, problem.dt, sample, sample + 1)
            advance(problem, state, room)
    return OK, 2 * steps, used


@kernel(inline="always")
def _begin(problem: Problem, state: State, room: Workspace) -> None:
    """The first step's start."""
    structure, start, motion = problem.structure, room.start, room.stage.motion[1]
    nc = structure.carrier.shape[0]
    carry(structure, state.p, start.z)
    carry(structure, state.dp, start.dz)
    copy(state.z, start.z[nc:])
    copy(state.dz, start.dz[nc:])
    move(problem.bodies, start.z, start.dz, motion)
    copy(motion.active_velocity, start.velocity)
    room.newton.first[0] = 0.0
    start.known[0] = False
    for kind in range(2):
        copy(state.zone[kind], room.stage.zone[kind])


@kernel(inline="always")
def _balanced(problem: Problem, state: State, room: Workspace, settling: bool) -> bool:
    """Whether the gap of the energy balance has not grown by more than GROSSLY since the end of `settling`."""
    start, motion = room.start, room.stage.motion[1]
    now = stored(problem.bodies, problem.structure, state.p, state.dp, state.zone, start.z, start.dz, motion)
    gap = open_by(state.work, now, state.energy)
    if settling:
        state.energy[GAP] = gap
    return abs(gap - state.energy[GAP]) <= GROSSLY * state.energy[SCALE]
