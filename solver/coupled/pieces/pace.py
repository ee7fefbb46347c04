"""How long pieces are: on a stop as the swing asks for, after a jump as the energy balance does."""

import numpy as np

from solver.coupled.energy import stored
from solver.coupled.pieces.fine import ONE, Fine
from solver.coupled.problem import Problem, Workspace
from solver.coupled.stages import State
from solver.coupled.step import gap, rings
from solver.kernels import inner_kernel, part_kernel
from solver.multibody.joint_law import HELD, OPEN, PRESSED, PTO_ZONE, STOP_ZONE, JointLaw, axis_load, jumps
from solver.multibody.zones import leaving, next_zone, pto_zone

SWING = 16  # pieces in the period of what swings on a stop
SMOOTH = 2  # pieces in the time of one of those, the first ones on an elastic platform
# Bend of an axis's acceleration in a piece, times its length, over the axis's largest rate so far: (ωh)³/4 of what
# swings. Pieces grow as long as it stays below, with the cube of their length; those above twice it that are longer
# than the swing on a stop asks for are halved.
BEND = 0.03
# Of the energy of an axis's fastest swing so far, by which a piece after a jump may open the balance: some hundred
# pieces a swing then keep it. One of twice the length opens it by GROWTH as much.
OPENED = 1e-5
GROWTH = 2**5
MISSED = 1e-3  # of an axis's largest rate so far, which such a piece may leave where the axis was to turn
KINK = 0.05  # of the load at that rate, by which it may jump where a law that only bends is changed that far off
SHORTEST = 2.0**-14  # of a step: in shorter pieces Newton's tolerance opens the balance
SLIVER = 1e-9  # of a step


@part_kernel
def _bend(problem: Problem, state: State, room: Workspace, i: int, length: float) -> float:
    """Of coordinate i's acceleration in the stages, times their step's length, over its largest rate so far."""
    stage, nc = room.stage, problem.structure.carrier.shape[0]
    bend = abs(state.ddz[2, i - nc] - 2 * stage.ddz[0, i] + stage.ddz[1, i]) * length
    rate = _fastest(state, room, i)
    return bend / rate if rate > 0 else 0.0


@part_kernel
def too_long(problem: Problem, state: State, room: Workspace, length: float) -> bool:
    """Whether a step of this length [s] does not follow a swing on a stop."""
    for n in range(problem.bent.size):
        i = problem.bent[n]
        presses = abs(room.stage.zone[STOP_ZONE, i]) == PRESSED
        if presses and length > problem.pace[i] * (1 + SLIVER) and _bend(problem, state, room, i, length) > 2 * BEND:
            return True
    return False


@inner_kernel
def begin_swing(problem: Problem, state: State, i: int) -> None:
    """Axis i meets its stop: pieces that smooth what that sets ringing, then such that follow the swing.

    On a platform that rings since a load jumped, energy tells the pieces' length, and nothing may take of it.
    """
    smooth = rings(problem) and state.ring[0] == np.inf
    state.jolt[i] = SMOOTH if smooth else 0
    state.pace[i] = problem.swing[i] / SMOOTH if smooth else problem.pace[i]


@part_kernel
def smooths(problem: Problem, state: State, room: Workspace) -> bool:
    """Whether the next piece does: one of the first on a stop."""
    if state.ring[0] < np.inf:
        return False
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if state.jolt[i] > 0 and abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            return True
    return False


@part_kernel
def settle(problem: Problem, state: State, room: Workspace) -> None:
    """One piece less to smooth; after the last one those that follow the swing."""
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if state.jolt[i] > 0 and abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            state.jolt[i] -= 1
            if state.jolt[i] == 0:
                state.pace[i] = problem.swing[i]


@inner_kernel
def halve(problem: Problem, state: State, room: Workspace, length: float) -> None:
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if abs(room.stage.zone[STOP_ZONE, i]) == PRESSED:
            state.pace[i] = max(min(problem.pace[i], length), 0.5 * length)


@part_kernel
def quicken(problem: Problem, state: State, room: Workspace, length: float) -> None:
    """Twice the pace where an axis's acceleration is so straight that it will be in a piece of that length, too."""
    for n in range(problem.bent.size):
        i = problem.bent[n]
        longer = 2 * state.pace[i] / length  # pieces may be shorter than their pace
        presses = abs(room.stage.zone[STOP_ZONE, i]) == PRESSED
        if presses and _bend(problem, state, room, i, length) * longer**3 < BEND:
            state.pace[i] *= 2


@part_kernel
def stored_before(problem: Problem, state: State, room: Workspace) -> float:
    """Energy [J] at the start of a piece that is to keep the balance."""
    start = room.start
    if state.ring[0] == np.inf:
        return 0.0
    return stored(
        problem.bodies, problem.structure, state.p, state.dp, state.zone, start.z, start.dz, room.stage.motion[1]
    )


@inner_kernel
def opening(problem: Problem, other: Problem, state: State, room: Workspace, fine: Fine, before: float) -> float:
    """By how many times what it may a piece opens the energy balance, with the energy [J] before it."""
    swing = 0.0
    for n in range(problem.bent.size):
        i = problem.bent[n]
        swing = max(swing, 0.5 * room.newton.mass[i, i] * _fastest(state, room, i) ** 2)
    opened = abs(before + gap(other, fine.drive, ONE, state, room))
    return opened / (OPENED * swing) if opened > 0 else 0.0


@part_kernel
def _fastest(state: State, room: Workspace, i: int) -> float:
    """Rate of axis i so far [m/s or rad/s]."""
    return max(state.fastest[i], abs(room.stage.dz[1, i]))


@inner_kernel
def misses(problem: Problem, length: float, state: State, room: Workspace, i: int) -> bool:
    """Whether a piece that was to end where axis i changes its law is too long for that, on a platform that rings."""
    law, stage = problem.bodies.law, room.stage
    zone = stage.zone[PTO_ZONE, i]
    if zone == HELD or not (rings(problem) and length > SHORTEST * problem.dt):
        return False
    y, dy, fastest = stage.z[1, i], stage.dz[1, i], _fastest(state, room, i)
    if jumps(law, i):
        return abs(leaving(law, i, PTO_ZONE, zone, y, dy)) > MISSED * fastest
    load = _taken(law, i, zone, y, dy)
    next_load = _taken(law, i, next_zone(law, i, PTO_ZONE, zone, y, dy), y, dy)
    return abs(next_load - load) > KINK * abs(_taken(law, i, pto_zone(law, i, y, fastest), y, fastest))


@part_kernel
def _taken(law: JointLaw, i: int, zone: int, y: float, dy: float) -> float:
    """Load of axis i's power take-off by a zone's formula."""
    return axis_load(law, i, OPEN, zone, y, dy).pto
