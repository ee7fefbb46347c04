"""A joint's law at the border of a zone: the next zone, and the accelerations that it sets."""

import numpy as np

from solver.coupled.energy import JOINT_DAMPING, PTO
from solver.coupled.newton import factorize, substitute
from solver.coupled.pieces.leaving import SCAN, way
from solver.coupled.pieces.pace import begin_swing
from solver.coupled.pieces.parabolas import forget
from solver.coupled.problem import HITS, RATE, Between, Problem, Workspace
from solver.coupled.stages import State
from solver.coupled.step import rings
from solver.kernels import inner_kernel, kernel
from solver.multibody.joint_law import (
    HELD,
    PRESSED,
    PTO_ZONE,
    SLIPS,
    STOP_ZONE,
    TABLE,
    axis_energy,
    axis_load,
    holding,
    jumps,
)
from solver.multibody.minimal import mass_matrix, move, take_inertia
from solver.multibody.zones import next_zone, pto_zone


@inner_kernel
def change_law(
    problem: Problem,
    state: State,
    room: Workspace,
    i: int,
    kind: int,
    at_once: bool,
    length: float,
    contact: np.ndarray,
    between: Between,
) -> bool:
    """Axis i enters its next zone where the state is; False where the masses are singular.

    By how much loads jump is told in the first row of `between` that holds nothing yet.

    Of a table it leaves a piece at once into that where the stages, of a step of this length [s], have it next: where
    lines cross, as at rest, the borders do not tell.
    """
    start, nc = room.start, problem.structure.carrier.shape[0]
    law, old = problem.bodies.law, room.stage.zone[kind, i]
    if kind == PTO_ZONE and old == HELD:
        up, down = holding(law, i, 1) - state.held[i], holding(law, i, -1) + state.held[i]
        new = SLIPS if up < down else -SLIPS
    else:
        new = next_zone(law, i, kind, old, start.z[i], start.dz[i])
    if at_once and kind == PTO_ZONE and old >= TABLE:
        y, dy = way(problem, state, room, length, i, 1 / SCAN)
        soon = pto_zone(law, i, y, dy)
        new = soon if soon != old else new
    if kind == STOP_ZONE and abs(new) == PRESSED:
        begin_swing(problem, state, i)
        for n in range(problem.bent.size):
            if problem.bent[n] == i and new * start.dz[i] > 0:  # else it is slowed as it comes free, and presses again
                contact[n, HITS] += 1
                contact[n, RATE] = max(contact[n, RATE], abs(start.dz[i]))
    if kind == PTO_ZONE and rings(problem) and jumps(law, i):
        state.ring[0] = min(state.ring[0], 0.5 * problem.dt)
    if kind == PTO_ZONE and new == HELD:
        start.dz[i] = 0.0
        state.dz[i - nc] = 0.0
    between.wrench[between.number[0]] = 0.0
    between.carried[between.number[0]] = 0.0
    if not _enter(problem, state, room, i, kind, new, between):
        return False
    if kind == PTO_ZONE and new == HELD:
        load = state.held[i]
        if load > holding(law, i, 1) or -load > holding(law, i, -1):
            return _enter(problem, state, room, i, kind, SLIPS if load > 0 else -SLIPS, between)
    return True


@inner_kernel
def _enter(problem: Problem, state: State, room: Workspace, i: int, kind: int, new: int, between: Between) -> bool:
    """The zone, and the accelerations and powers that go with it."""
    law, stage, start = problem.bodies.law, room.stage, room.start
    old, pto = stage.zone[STOP_ZONE, i], stage.zone[PTO_ZONE, i]
    before = axis_load(law, i, old, pto, start.z[i], start.dz[i])
    stage.zone[kind, i] = new
    state.zone[kind, i] = new
    stops, pto = stage.zone[STOP_ZONE, i], stage.zone[PTO_ZONE, i]
    after = axis_load(law, i, stops, pto, start.z[i], start.dz[i])
    state.work[JOINT_DAMPING] += axis_energy(law, i, old, start.z[i]) - axis_energy(law, i, stops, start.z[i])
    change = after.pto - before.pto + after.loss - before.loss + after.spring - before.spring
    state.power[PTO] += (after.pto - before.pto) * start.dz[i]
    state.power[JOINT_DAMPING] += (after.loss - before.loss) * start.dz[i]
    move(problem.bodies, start.z, start.dz, stage.motion[1])
    done = _jump(problem, state, room, i, change, between)
    forget(state)
    return done


@kernel(no_cpython_wrapper=True)
def _jump(problem: Problem, state: State, room: Workspace, axis: int, change: float, between: Between) -> bool:
    """Accelerations of modes and joints after the load against an axis has changed; False where M is singular.

    Of carriers, which modes move by S: Δa_c = -S Sᵀ (M Δa)_c, and Δp̈ = -Sᵀ (M Δa)_c.
    """
    S, (nc, nm), nz = problem.structure.carrier, problem.structure.carrier.shape, state.zone.shape[1]
    M, K, pivot = np.empty((nz, nz)), np.empty((nz, nz)), np.empty(nz, np.int64)
    mass_matrix(problem.bodies, room.stage.motion[1], M)
    K[:] = M
    for i in range(nc):
        K[i] = 0.0
        for k in range(nc):
            yields = 0.0
            for m in range(nm):
                yields += S[i, m] * S[k, m]
            for j in range(nz):
                K[i, j] += yields * M[k, j]
        K[i, i] += 1.0
    update, moved = np.zeros(nz), np.zeros(nz)
    update[axis] = state.held[axis] - change
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if room.stage.zone[PTO_ZONE, i] == HELD:
            K[i] = 0.0
            K[i, i] = 1.0
            update[i] = -state.ddz[2, i - nc]
    if not factorize(K, pivot):
        return False
    substitute(K, pivot, update)
    for i in range(nz):
        for j in range(nz):
            moved[i] += M[i, j] * update[j]
    for n in range(problem.bent.size):
        i = problem.bent[n]
        if room.stage.zone[PTO_ZONE, i] == HELD:
            state.held[i] -= moved[i] + (change if i == axis else 0.0)
        else:
            state.held[i] = 0.0
    for m in range(nm):
        for i in range(nc):
            state.ddp[m] -= S[i, m] * moved[i]
            state.force[2, m] -= S[i, m] * moved[i]
    state.ddz[2] += update[nc:]
    take_inertia(problem.bodies, room.stage.motion[1], update, between.wrench[between.number[0]])
    between.carried[between.number[0]] -= moved[:nc]
    return True
