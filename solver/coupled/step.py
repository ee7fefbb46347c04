"""One step of the coupled system: see scheme.

A step is solved by Newton's method with the matrix of its start, or of a step's shortly before. The structure's
modes are eliminated exactly by their flexibility at the hinge nodes, however many there are
and however stiff; the radiation memory is exact for velocities quadratic in time.
"""

import numpy as np

from solver.coupled.energy import (
    BROUGHT,
    FRAME_DRAG,
    FRAME_INERTIA,
    JOINT_DAMPING,
    PTO,
    RADIATION,
    STRUCTURAL,
    WAVE,
    stored,
)
from solver.coupled.memory import memory_history, remember
from solver.coupled.modal import WaterAbout, drag
from solver.coupled.newton import Newton, Zones, factorize, hold, newton_matrix, newton_side, substitute
from solver.coupled.problem import NOT_CONVERGED, NOT_FINITE, OK, Between, Drive, Output, Problem, Workspace
from solver.coupled.stages import Stages, Start, State, collocate, coordinates, follow, load_bodies, moved, predict
from solver.kernels import inner_kernel, kernel, lean_kernel, part_kernel
from solver.multibody.joint_law import HELD, OPEN, PTO_ZONE, STOP_ZONE
from solver.multibody.minimal import powers, pressures
from solver.multibody.zones import off_stop

SURELY = 0.1  # of the tolerance: where a piece's next update is foreseen to be less it is not made


@lean_kernel(inline="always")
def copy(source: np.ndarray, target: np.ndarray) -> None:
    """target <- source (n,); numba's assignment allocates, should the two overlap."""
    for i in range(target.size):
        target[i] = source[i]


@kernel(inline="always")
def rings(problem: Problem) -> bool:
    """Whether a joint's law sets modes ringing where it changes: Newton then takes an iteration or two more."""
    return problem.bent.size > 0 and problem.structure.omega.size > 0


@part_kernel
def refresh(problem: Problem, room: Workspace) -> bool:
    """Newton's matrix of the step's start, factored; False when singular."""
    newton, bodies = room.newton, problem.bodies
    zones = Zones(room.stage.zone, problem.bent)
    motion, H, constant = room.stage.motion[1], problem.H, problem.constant
    newton_matrix(bodies, motion, zones, H, constant, problem.dt, problem.scheme, newton)
    return factorize(newton.K, newton.pivot)


@inner_kernel
def attempt(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> tuple[int, int]:
    """The stages of a step from `state`, ½ of which is at `sample`, in its start's zones; (outcome, iterations)."""
    memory_history(problem.memory, state.memory, room.start.velocity, room.stage.history)
    predict(problem.structure, problem.dt, problem.scheme, drive.modal[sample : sample + 2], state, room.stage)
    outcome, spent = _converge(problem, drive, sample, state, room)
    if outcome == OK:
        _finish(problem, drive, sample, state, room)
    return outcome, spent


@kernel(inline="always")
def _converge(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> tuple[int, int]:
    """Newton's method on the stages, of which ½ is at `sample`; (outcome, iterations)."""
    stage, newton, tolerance, ringing = room.stage, room.newton, problem.tolerance, rings(problem)
    first, update = 1, np.inf
    if ringing and newton.first[0] > problem.near:
        _carry_on(stage)
        first = 2
    stage.p[:] = np.inf
    for spent in range(1, problem.iterations + 1):
        change = collocate(problem.structure, problem.inverse, problem.dt, problem.scheme, state, room.start, stage)
        follow(problem.bodies, problem.memory, stage)
        far = spent > first and (moved(stage) > problem.near or change > problem.slight)
        fresh = spent == first or stage.z.size == 0 or far
        if fresh:
            _evaluate(problem, drive, sample, room)
        load_bodies(problem.bodies, drive.excitation[sample : sample + 2], stage)
        newton_side(problem.structure, problem.inverse, stage, newton.update)
        hold(problem.bent, stage, newton.update)
        substitute(newton.K, newton.pivot, newton.update)
        before, update = update, _update(problem, stage, newton)
        if not np.isfinite(np.sum(newton.update)):
            return NOT_FINITE, spent
        if spent == 1:
            newton.first[0] = update
            known = problem.part and newton.rate[0] < np.inf
            if known and update < problem.near and update * newton.rate[0] < SURELY * tolerance:
                return OK, spent
        elif spent == 2:
            newton.rate[0] = update / before if before > 0 else np.inf
        if ringing and spent > first and not fresh and before > 0:  # modes follow as they followed the update before
            change *= update / before
        if spent >= first and max(change, update) < tolerance:
            return OK, spent
    return NOT_CONVERGED, problem.iterations


@kernel(inline="always")
def _carry_on(stage: Stages) -> None:
    """Pressure, drag and the coordinates that they are of go on straight through the last step's two stages.

    Of modes that ring no extrapolated acceleration is near, but pressure is smooth: with it Newton's first update puts
    the stages so near that pressure need be evaluated only once.
    """
    _go_on(stage.anchor)
    _go_on(stage.drag)
    for b in range(stage.pressure.shape[1]):
        _go_on(stage.pressure[:, b])


@kernel(inline="always")
def _go_on(part: np.ndarray) -> None:
    for i in range(part.shape[1]):
        change = part[1, i] - part[0, i]
        part[0, i] = part[1, i] + change
        part[1, i] = part[0, i] + change


@kernel(inline="always")
def _evaluate(problem: Problem, drive: Drive, sample: int, room: Workspace) -> None:
    """Pressure and drag where the stages are: expensive, and slowly varying."""
    stage, between = room.stage, problem.short and room.start.known[0]
    stage.drag[:] = 0.0
    since = 1 if between else 0
    for s in range(since, 2):
        copy(stage.z[s], stage.anchor[s])
        pressures(problem.bodies, stage.motion[s], drive.field[sample + s], room.pressure, stage.pressure[s])
    end = sample + 2
    water = WaterAbout(drive.station[sample:end], drive.wet[sample:end], drive.push[sample:end])
    drag(problem.structure, water, stage.dp, since, stage.drag, room.flow)
    if between:
        _halfway(room.start, stage, room.flow)


@kernel(inline="always")
def _halfway(start: Start, stage: Stages, flow: np.ndarray) -> None:
    """Pressure and drag at a step's middle, from those at its ends; flow (2, nd, ns): see modal.drag."""
    for m in range(start.drag.size):
        stage.drag[0, m] = 0.5 * (start.drag[m] + stage.drag[1, m])
    for d in range(start.flow.shape[0]):
        for i in range(start.flow.shape[1]):
            flow[0, d, i] = 0.5 * (start.flow[d, i] + flow[1, d, i])
    for i in range(stage.z.shape[1]):
        stage.anchor[0, i] = 0.5 * (start.anchor[i] + stage.anchor[1, i])
    for b in range(stage.pressure.shape[1]):
        for i in range(6):
            stage.pressure[0, b, i] = 0.5 * (start.pressure[b, i] + stage.pressure[1, b, i])


@kernel(inline="always")
def _update(problem: Problem, stage: Stages, newton: Newton) -> float:
    """Joint accelerations and modal loads by Newton's update; about the largest change of a position [m or rad]."""
    nz, (nc, nm) = stage.z.shape[1], problem.structure.carrier.shape
    change = 0.0
    for s in range(2):
        for i in range(nz):
            change = max(change, problem.dt * problem.dt * abs(newton.update[s * nz + i]) * 0.2)
        for i in range(nc, nz):
            stage.ddz[s, i] += newton.update[s * nz + i]
        copy(stage.drag[s], stage.force[s])
        for i in range(nc):
            value = stage.residual[s, i]
            for j in range(2 * nz):
                value -= newton.Z[s * nz + i, j] * newton.update[j]
            for m in range(nm):
                stage.force[s, m] += problem.structure.carrier[i, m] * value
    return change


@kernel(inline="always")
def _finish(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> None:
    """Carry the last update, free accuracy, into the stage values and the joints' forces.

    Of the accelerations before, those forces are off by mass times the update.
    """
    collocate(problem.structure, problem.inverse, problem.dt, problem.scheme, state, room.start, room.stage)
    follow(problem.bodies, problem.memory, room.stage)
    load_bodies(problem.bodies, drive.excitation[sample : sample + 2], room.stage)


@part_kernel
def account_work(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> None:
    """Works over the step, by powers at its three points."""
    power_at(problem, drive, sample, state, room)
    for i in range(state.work.size):
        state.work[i] += _work(problem, room.power, i)
    copy(room.power[2], state.power)


@kernel(inline="always")
def _work(problem: Problem, power: np.ndarray, i: int) -> float:
    w = problem.scheme.work
    return problem.dt * (w[0] * power[0, i] + w[1] * power[1, i] + w[2] * power[2, i])


@part_kernel
def power_at(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> None:
    """Fill room.power, at the step's three points."""
    structure, stage, power = problem.structure, room.stage, room.power
    for s in range(2):
        inertia = drag = structural = 0.0
        for m in range(structure.omega.size):
            inertia += drive.modal[sample + s, m] * stage.dp[s, m]
            drag += stage.drag[s, m] * stage.dp[s, m]
            structural += 2 * structure.damping[m] * structure.omega[m] * stage.dp[s, m] ** 2
        power[1 + s, FRAME_INERTIA], power[1 + s, FRAME_DRAG], power[1 + s, STRUCTURAL] = inertia, drag, structural
        of_floats = powers(problem.bodies, coordinates(stage, s), stage.motion[s], stage.external[s], stage.memory[s])
        power[1 + s, WAVE], power[1 + s, RADIATION], power[1 + s, PTO], power[1 + s, JOINT_DAMPING] = of_floats
    copy(state.power, power[0])


@inner_kernel
def gap(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> float:
    """Work [J] of the step that the stages hold, less the energy that is stored at its end."""
    power_at(problem, drive, sample, state, room)
    stage, balance = room.stage, 0.0
    for i in range(state.work.size):
        work = _work(problem, room.power, i)
        balance += work if i in BROUGHT else -work
    end = stage.motion[1]
    return balance - stored(
        problem.bodies, problem.structure, stage.p[1], stage.dp[1], stage.zone, stage.z[1], stage.dz[1], end
    )


@part_kernel
def put_out(room: Workspace, output: Output, row: int) -> None:
    """Both stages as rows of the output."""
    for s in range(2):
        put_stage(room, s, output, row + s)


@part_kernel
def put_stage(room: Workspace, s: int, output: Output | Between, row: int) -> None:
    """Stage s as a row of the output."""
    stage, nc = room.stage, output.carried.shape[1]
    copy(stage.z[s], output.z[row])
    copy(stage.dz[s], output.dz[row])
    copy(stage.p[s], output.p[row])
    for b in range(stage.wrench.shape[1]):
        copy(stage.wrench[s, b], output.wrench[row, b])
    copy(stage.dp[s], output.dp[row])
    copy(stage.ddp[s], output.ddp[row])
    copy(stage.residual[s, :nc], output.carried[row])
    for d in range(room.flow.shape[1]):
        copy(room.flow[s, d], output.drag[row, d])


@part_kernel
def advance(problem: Problem, state: State, room: Workspace) -> None:
    """The step's end becomes the next one's start."""
    start, stage, nc = room.start, room.stage, problem.structure.carrier.shape[0]
    remember(problem.memory, state.memory, start.velocity, stage.velocity)
    copy(stage.velocity[1], start.velocity)
    copy(state.ddz[2], state.ddz[0])
    copy(state.force[2], state.force[0])
    for s in range(2):
        copy(stage.ddz[s, nc:], state.ddz[1 + s])
        copy(stage.force[s], state.force[1 + s])
    for n in range(problem.bent.size):
        i = problem.bent[n]
        state.held[i] = stage.residual[1, i] if stage.zone[PTO_ZONE, i] == HELD else 0.0
        state.fastest[i] = max(state.fastest[i], abs(stage.dz[1, i]))
        if off_stop(problem.bodies.law, i, stage.zone[STOP_ZONE, i], stage.z[1, i]):
            stage.zone[STOP_ZONE, i] = state.zone[STOP_ZONE, i] = OPEN
    copy(stage.z[1], start.z)
    copy(stage.dz[1], start.dz)
    start.known[0] = True
    copy(stage.anchor[1], start.anchor)
    for b in range(stage.pressure.shape[1]):
        copy(stage.pressure[1, b], start.pressure[b])
    copy(stage.drag[1], start.drag)
    for d in range(room.flow.shape[1]):
        copy(room.flow[1, d], start.flow[d])
    copy(start.z[nc:], state.z)
    copy(start.dz[nc:], state.dz)
    copy(stage.p[1], state.p)
    copy(stage.dp[1], state.dp)
    copy(stage.ddp[1], state.ddp)


@kernel(inline="always")
def within(limit: np.ndarray, z: np.ndarray, rotation: np.ndarray) -> bool:
    """Whether all coordinates are within their limits, no body (nb, 3, 3) is turned over, and nothing is NaN."""
    within = True
    for i in range(z.size):
        within = within and limit[i, 0] < z[i] < limit[i, 1]
    for b in range(rotation.shape[0]):
        within = within and rotation[b, 2, 2] > 0.0
    return within
