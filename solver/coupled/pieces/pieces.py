"""A step in pieces."""

from typing import cast

import numpy as np

from solver.coupled.pieces.change import change_law
from solver.coupled.pieces.fine import ONE, Fine, of_length, sample_drive
from solver.coupled.pieces.kept import close_row, keep, keep_jump, note, open_row
from solver.coupled.pieces.leaving import NEVER, first_to_leave
from solver.coupled.pieces.pace import (
    GROWTH,
    SHORTEST,
    SLIVER,
    halve,
    misses,
    opening,
    quicken,
    settle,
    smooths,
    stored_before,
    too_long,
)
from solver.coupled.pieces.parabolas import again, forget, go_on
from solver.coupled.problem import NOT_FINITE, OK, TO_AND_FRO, Drive, Output, Problem, Workspace
from solver.coupled.stages import State
from solver.coupled.step import account_work, advance, attempt, put_stage, refresh
from solver.kernels import inner_kernel, part_kernel
from solver.multibody.joint_law import OPEN, PRESSED, PTO_ZONE, STOP_ZONE, jumps
from solver.multibody.minimal import move
from solver.multibody.zones import within_stops

PATIENCE = 2  # iterations of a piece, beyond which Newton's matrix is renewed
SHARE = 8  # pieces that share one
CHANGES = 200  # of laws in one step, at most
NOBODY = cast("int", np.int64(-1))  # a plain -1 is a type of its own to compile


@part_kernel
def in_contact(problem: Problem, state: State, room: Workspace) -> bool:
    """Whether an axis swings on its stop, or the platform since a load jumped, too fast for a whole step; or an axis
    goes on to its stop with its last acceleration, where a whole step would be tried in vain."""
    if state.ring[0] < problem.dt:
        return True
    start, dt, nc = room.start, problem.dt, problem.structure.carrier.shape[0]
    for n in range(problem.bent.size):
        i = problem.bent[n]
        zone = room.stage.zone[STOP_ZONE, i]
        if abs(zone) == PRESSED and state.pace[i] < dt:
            return True
        y = start.z[i] + dt * (start.dz[i] + 0.5 * dt * state.ddz[2, i - nc])
        if zone == OPEN and not within_stops(problem.bodies.law, i, y, y):
            return True
    return False


@inner_kernel
def bends(problem: Problem, state: State, room: Workspace) -> bool:
    """Whether the step that the stages hold leaves a zone, or is too long for a swing on a stop."""
    return first_to_leave(problem, state, room, problem.dt)[0] < NEVER or too_long(problem, state, room, problem.dt)


@inner_kernel
def in_pieces(
    problem: Problem, drive: Drive, sample: int, state: State, room: Workspace, fine: Fine, output: Output
) -> tuple[int, int]:
    """Advance `state` by the step from `sample` on; (outcome, iterations). Pieces end at the step's middle, too."""
    used = changes = 0
    at, i, kind = NEVER, NOBODY, STOP_ZONE
    fine.shared[0], fine.knots[0], room.newton.rate[0] = 0, problem.dt, np.inf
    most = np.inf  # length of the next piece, after one too long
    before = stored_before(problem, state, room)
    for half in range(2):
        row, done, whole = sample + half, 0.0, 0.5 * problem.dt
        first, cut = open_row(output, row), 0.0  # length of a piece that ends where an axis leaves its zone
        while done < whole * (1 - SLIVER):
            length = cut if cut > 0 else _length(problem, state, room, min(whole - done, most), fine)
            other = of_length(problem, length, smooths(problem, state, room), fine)
            outcome, spent = _piece(other, drive, sample + half + 2 * done / problem.dt, problem.dt, state, room, fine)
            used += spent
            if outcome != OK:
                if length <= SHORTEST * problem.dt:
                    return outcome, used
                most, cut, fine.shared[0] = 0.5 * length, 0.0, 0
                forget(state)
                move(problem.bodies, room.start.z, room.start.dz, room.stage.motion[1])  # whose matrix is Newton's
                continue
            if cut > 0:
                cut = 0.0
                if kind == PTO_ZONE and misses(problem, length, state, room, i):
                    most = 0.5 * length
                    if jumps(problem.bodies.law, i):
                        state.ring[0] = most
                    continue
            else:
                if not smooths(problem, state, room) and too_long(problem, state, room, length):
                    halve(problem, state, room, length)
                    again(state, room, fine)
                    continue
                if state.ring[0] < np.inf:
                    share = opening(problem, other, state, room, fine, before)
                    if share > 1 and length > SHORTEST * problem.dt:
                        state.ring[0] = 0.5 * length
                        again(state, room, fine)
                        continue
                    if share * GROWTH < 1:
                        state.ring[0] = max(state.ring[0], 2 * length) if 2 * length < problem.dt else np.inf
                at, i, kind = first_to_leave(problem, state, room, length)
                if 0 < at < NEVER:
                    cut = length * at
                    again(state, room, fine)
                    continue
            if at > 0:
                keep(problem, length, state, room, fine, output, row, first, done / whole)
                _take(problem, other, state, room, fine, output, row)
                done, most = done + length, np.inf
                before = stored_before(problem, state, room)
            if at < NEVER:
                changes += 1
                fine.shared[0] = 0
                if changes > CHANGES:
                    return TO_AND_FRO, used
                if not change_law(problem, state, room, i, kind, at == 0, length, output.contact[row], output.between):
                    return NOT_FINITE, used
                if abs(room.stage.zone[STOP_ZONE, i]) == PRESSED if kind == STOP_ZONE else jumps(problem.bodies.law, i):
                    keep_jump(problem, state, room, output, row, first, done / whole)
                before = stored_before(problem, state, room)
        put_stage(room, ONE, output, row)
        close_row(output, row, first)
    room.newton.first[0] = 0.0
    go_on(state, fine, problem.dt)
    return OK, max(used, 4)  # so that Newton's matrix is renewed


@part_kernel
def _length(problem: Problem, state: State, room: Workspace, left: float, fine: Fine) -> float:
    """Of the next piece [s]: all that is left of the half, or a whole part of it.

    That of the last one where rounding alone is between them: its constants serve again.
    """
    pace = min(left, state.ring[0])
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            pace = min(pace, state.pace[i])
    length = left / np.ceil(left / pace - SLIVER)
    last = abs(fine.length[0])
    return last if abs(length - last) < SLIVER * length else length


@part_kernel
def _piece(
    other: Problem, drive: Drive, sample: float, dt: float, state: State, room: Workspace, fine: Fine
) -> tuple[int, int]:
    """The stages of a step of the problem `other` that starts at a sample, which need not be whole, of steps of dt."""
    for n in (1, 2):
        sample_drive(drive, sample + n * other.dt / dt, n, fine)
    if fine.shared[0] == 0 and not refresh(other, room):
        return NOT_FINITE, 0
    room.newton.first[0] = 0.0  # what the stages hold is of another length
    room.newton.rate[0] *= max(1.0, other.dt / fine.knots[0]) ** 2  # as what the matrix leaves out goes
    go_on(state, fine, other.dt)
    outcome, spent = attempt(other, fine.drive, ONE, state, room)
    fine.shared[0] = 0 if spent > PATIENCE else (fine.shared[0] + 1) % SHARE
    return outcome, spent


@part_kernel
def _take(
    problem: Problem, other: Problem, state: State, room: Workspace, fine: Fine, output: Output, row: int
) -> None:
    """The piece's end becomes the next one's start; what presses on the stops is noted."""
    smoothed = fine.length[0] < 0
    account_work(other, fine.drive, ONE, state, room)
    note(problem, room, output, other.dt, row, row)
    if smoothed:
        settle(problem, state, room)
    else:
        quicken(problem, state, room, other.dt)
    advance(other, state, room)
    if smoothed:  # of a start whose accelerations the scheme passes over
        forget(state)
