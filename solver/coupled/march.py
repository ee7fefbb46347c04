"""The time loop on the coupled system: see scheme.

Each step is solved by Newton's method with the matrix of the step's start. The structure's
modes are eliminated exactly by their flexibility at the hinge nodes, however many there are
and however stiff; the radiation memory is exact for velocities quadratic in time.
"""

from typing import NamedTuple

import numpy as np

from solver.coupled.energy import (
    FRAME_DRAG,
    FRAME_INERTIA,
    GAP,
    JOINT_DAMPING,
    PTO,
    RADIATION,
    SCALE,
    STRUCTURAL,
    WAVE,
    WORKS,
    open_by,
    stored,
)
from solver.coupled.memory import Memory, memory_history, remember
from solver.coupled.modal import Structure, carry, drag, flexibility
from solver.coupled.newton import Newton, constant_part, factorize, new_newton, newton_matrix, newton_side, substitute
from solver.coupled.scheme import SIMPSON
from solver.coupled.stages import (
    Stages,
    Start,
    State,
    collocate,
    coordinates,
    follow,
    load_bodies,
    moved,
    new_stages,
    predict,
)
from solver.kernels import kernel, lean_kernel
from solver.multibody.minimal import Bodies, PressureRoom, move, powers, pressure_room, pressures

REFRESH = 8  # steps that share Newton's matrix while it serves
WATCH = 8  # steps after which the energy balance is looked at
# Pressure and drag are evaluated again where a stage has moved by so many tolerances since; nearer than that
# the hydrostatic stiffness stands for the change, and what is left of it, (dt ω)²/5, is below the tolerance.
NEAR = 25.0

OK, NOT_CONVERGED, EXCURSION, NOT_FINITE, UNBALANCED = 0, 1, 2, 3, 4
GROSSLY = 0.1  # of the wave's work, by which the energy balance is never open


class Drive(NamedTuple):
    """Samples of all that the wave drives; first axis time, samples dt/2 apart."""

    field: np.ndarray  # (m, nb, 2, terms)
    excitation: np.ndarray  # (m, nb, 6)
    modal: np.ndarray  # (m, nm)
    station: np.ndarray  # (m, nd, ns) particle velocity normal to the members


class Output(NamedTuple):
    """Samples after the first: row i belongs to sample i + 1 of the drive."""

    z: np.ndarray  # (m, nz) carriers, then joints
    dz: np.ndarray  # (m, nz)
    p: np.ndarray  # (m, nm)
    wrench: np.ndarray  # (m, nb, 6) load of each float on its hinge node's side [N, N m]
    dp: np.ndarray  # (m, nm)
    ddp: np.ndarray  # (m, nm)
    carried: np.ndarray  # (m, nc) load of the floats on the support's nodes, along their carriers [N, N m]
    drag: np.ndarray  # (m, nd, ns) of the water on the frame at its stations [N]


class Problem(NamedTuple):
    """Constants of a march: the arrays of a system, and steps of one length."""

    bodies: Bodies
    structure: Structure
    memory: Memory
    inverse: np.ndarray  # (nm, 2, 2) and H (2, nc, 2, nc): see flexibility
    H: np.ndarray
    constant: np.ndarray  # (2nz, 2nz) of Newton's matrix
    dt: float
    tolerance: float  # of Newton's last update of any stage position [m or rad]
    iterations: int  # of Newton's method, at most


class Workspace(NamedTuple):
    """Scratch of a march."""

    start: Start
    stage: Stages
    newton: Newton
    power: np.ndarray  # (3, len(WORKS)) at the step's three points
    flow: np.ndarray  # (2, nd, ns) drag at the frame's stations, of both stages [N]
    pressure: PressureRoom


def new_problem(
    bodies: Bodies,
    structure: Structure,
    memory: Memory,
    stiffness: np.ndarray,
    *,
    dt: float,
    tolerance: float,
    iterations: int,
) -> Problem:
    """Constants for steps of dt [s]; stiffness (nz, nz) of the floats at rest, for Newton's matrix alone."""
    nz = bodies.mechanism.size
    inverse, H = flexibility(structure, dt)
    constant = np.empty((2 * nz, 2 * nz))
    constant_part(bodies, memory, stiffness, dt, constant)
    return Problem(bodies, structure, memory, inverse, H, constant, dt, tolerance, iterations)


def new_workspace(bodies: Bodies, structure: Structure) -> Workspace:
    """Scratch for marches of these bodies and modes."""
    nz = bodies.mechanism.size
    return Workspace(
        start=Start(np.empty(nz), np.empty(nz), np.empty(bodies.axes.size * bodies.active.size)),
        stage=new_stages(bodies, structure.omega.size),
        newton=new_newton(nz),
        power=np.zeros((3, len(WORKS))),
        flow=np.empty((2, *structure.station.shape[1:])),
        pressure=pressure_room(bodies),
    )


def new_output(bodies: Bodies, structure: Structure, samples: int) -> Output:
    """Room for so many samples."""
    nz, nb, (nc, nm) = bodies.mechanism.size, bodies.axes.size, structure.carrier.shape
    shapes = ((nz,), (nz,), (nm,), (nb, 6), (nm,), (nm,), (nc,), structure.station.shape[1:])
    return Output(*(np.empty((samples, *shape)) for shape in shapes))


@lean_kernel(inline="always")
def _copy(source: np.ndarray, target: np.ndarray) -> None:
    """target <- source (n,); numba's assignment allocates, should the two overlap."""
    for i in range(target.size):
        target[i] = source[i]


@lean_kernel
def march(
    problem: Problem, drive: Drive, state: State, room: Workspace, quiet: int, output: Output
) -> tuple[int, int, int]:
    """Advance `state` through all samples of `drive`; return (outcome, sample, iterations used).

    room: see new_workspace. Every WATCH steps the energy balance is checked; a gap from before step `quiet`, by
    the jolt of the start, is not counted. On an outcome other than OK, `sample` is where the run stopped; a state is
    never left with NaN unnoticed.
    """
    used = spent = 0
    _begin(problem, state, room)
    steps, nc = (drive.modal.shape[0] - 1) // 2, problem.structure.carrier.shape[0]
    for step in range(steps):
        sample = 2 * step  # where the step starts
        if step % WATCH == 0 and not _balanced(problem, state, room, step <= quiet):
            return UNBALANCED, sample, used
        if (step % REFRESH == 0 or spent > 2) and not _refresh(problem, room):
            return NOT_FINITE, sample, used
        memory_history(problem.memory, state.memory, room.start.velocity, room.stage.history)
        predict(problem.structure, problem.dt, drive.modal[sample + 1 : sample + 3], state, room.stage)
        outcome, spent = _converge(problem, drive, sample + 1, state, room)
        used += spent
        if outcome != OK:
            return outcome, sample + 1, used
        _finish(problem, drive, sample + 1, state, room)
        if not _within(problem.bodies.limit, room.stage.z[1]):
            _copy(room.stage.z[1, nc:], state.z)
            return EXCURSION, sample + 2, used
        _account_work(problem, drive, sample + 1, state, room)
        _put_out(room, output, sample)
        _advance(problem, state, room)
    return OK, 2 * steps, used


@kernel(inline="always")
def _begin(problem: Problem, state: State, room: Workspace) -> None:
    """The first step's start."""
    structure, start, motion = problem.structure, room.start, room.stage.motion[1]
    nc = structure.carrier.shape[0]
    carry(structure, state.p, start.z)
    carry(structure, state.dp, start.dz)
    _copy(state.z, start.z[nc:])
    _copy(state.dz, start.dz[nc:])
    move(problem.bodies, start.z, start.dz, motion)
    _copy(motion.active_velocity, start.velocity)


@kernel(inline="always")
def _balanced(problem: Problem, state: State, room: Workspace, settling: bool) -> bool:
    """Whether the gap of the energy balance has not grown by more than GROSSLY since the end of `settling`."""
    start, motion = room.start, room.stage.motion[1]
    now = stored(problem.bodies, problem.structure, state, start.z, start.dz, motion)
    gap = open_by(state.work, now, state.energy)
    if settling:
        state.energy[GAP] = gap
    return abs(gap - state.energy[GAP]) <= GROSSLY * state.energy[SCALE]


@kernel(inline="always")
def _refresh(problem: Problem, room: Workspace) -> bool:
    """Newton's matrix of the step's start, factored; False when singular."""
    newton = room.newton
    newton_matrix(problem.bodies, room.stage.motion[1], problem.H, problem.constant, newton)
    return factorize(newton.K, newton.pivot)


@kernel(inline="always")
def _converge(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> tuple[int, int]:
    """Newton's method on the stages, of which ½ is at `sample`; (outcome, iterations)."""
    stage, newton, tolerance = room.stage, room.newton, problem.tolerance
    stage.p[:] = np.inf
    for spent in range(1, problem.iterations + 1):
        change = collocate(problem.structure, problem.inverse, problem.dt, state, room.start, stage)
        follow(problem.bodies, problem.memory, stage)
        if spent == 1 or stage.z.size == 0 or moved(stage) > NEAR * tolerance:
            _evaluate(problem, drive, sample, room)
        load_bodies(problem.bodies, drive.excitation[sample : sample + 2], stage)
        newton_side(problem.structure, problem.inverse, stage, newton.update)
        substitute(newton.K, newton.pivot, newton.update)
        change = max(change, _update(problem, stage, newton))
        if not np.isfinite(np.sum(newton.update)):
            return NOT_FINITE, spent
        if change < tolerance:
            return OK, spent
    return NOT_CONVERGED, problem.iterations


@kernel(inline="always")
def _evaluate(problem: Problem, drive: Drive, sample: int, room: Workspace) -> None:
    """Pressure and drag where the stages are: expensive, and slowly varying."""
    stage = room.stage
    stage.drag[:] = 0.0
    for s in range(2):
        _copy(stage.z[s], stage.anchor[s])
        pressures(problem.bodies, stage.motion[s], drive.field[sample + s], room.pressure, stage.pressure[s])
        water = drive.station[sample + s]
        room.power[1 + s, FRAME_DRAG] = drag(problem.structure, water, stage.dp[s], stage.drag[s], room.flow[s])


@kernel(inline="always")
def _update(problem: Problem, stage: Stages, newton: Newton) -> float:
    """Joint accelerations and modal loads by Newton's update; the largest change of a position [m or rad]."""
    nz, (nc, nm) = stage.z.shape[1], problem.structure.carrier.shape
    change = 0.0
    for s in range(2):
        for i in range(nz):
            change = max(change, problem.dt * problem.dt * abs(newton.update[s * nz + i]) * 0.2)
        for i in range(nc, nz):
            stage.ddz[s, i] += newton.update[s * nz + i]
        _copy(stage.drag[s], stage.force[s])
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
    collocate(problem.structure, problem.inverse, problem.dt, state, room.start, room.stage)
    follow(problem.bodies, problem.memory, room.stage)
    load_bodies(problem.bodies, drive.excitation[sample : sample + 2], room.stage)


@kernel(inline="always")
def _within(limit: np.ndarray, z: np.ndarray) -> bool:
    """Whether all coordinates are within their limits, and none is NaN."""
    within = True
    for i in range(z.size):
        within = within and limit[i, 0] < z[i] < limit[i, 1]
    return within


@kernel(inline="always")
def _account_work(problem: Problem, drive: Drive, sample: int, state: State, room: Workspace) -> None:
    """Works by Simpson's rule over the step's three points."""
    structure, stage, power = problem.structure, room.stage, room.power
    for s in range(2):
        inertia = structural = 0.0
        for m in range(structure.omega.size):
            inertia += drive.modal[sample + s, m] * stage.dp[s, m]
            structural += 2 * structure.damping[m] * structure.omega[m] * stage.dp[s, m] ** 2
        power[1 + s, FRAME_INERTIA], power[1 + s, STRUCTURAL] = inertia, structural
        of_floats = powers(problem.bodies, coordinates(stage, s), stage.motion[s], stage.external[s], stage.memory[s])
        power[1 + s, WAVE], power[1 + s, RADIATION], power[1 + s, PTO], power[1 + s, JOINT_DAMPING] = of_floats
    _copy(state.power, power[0])
    for i in range(state.work.size):
        state.work[i] += problem.dt * (SIMPSON[0] * power[0, i] + SIMPSON[1] * power[1, i] + SIMPSON[2] * power[2, i])
    _copy(power[2], state.power)


@kernel(inline="always")
def _put_out(room: Workspace, output: Output, row: int) -> None:
    """Both stages as rows of the output."""
    stage, nc = room.stage, output.carried.shape[1]
    for s in range(2):
        _copy(stage.z[s], output.z[row + s])
        _copy(stage.dz[s], output.dz[row + s])
        _copy(stage.p[s], output.p[row + s])
        for b in range(stage.wrench.shape[1]):
            _copy(stage.wrench[s, b], output.wrench[row + s, b])
        _copy(stage.dp[s], output.dp[row + s])
        _copy(stage.ddp[s], output.ddp[row + s])
        _copy(stage.residual[s, :nc], output.carried[row + s])
        for d in range(room.flow.shape[1]):
            _copy(room.flow[s, d], output.drag[row + s, d])


@kernel(inline="always")
def _advance(problem: Problem, state: State, room: Workspace) -> None:
    """The step's end becomes the next one's start."""
    start, stage, nc = room.start, room.stage, problem.structure.carrier.shape[0]
    remember(problem.memory, state.memory, start.velocity, stage.velocity)
    _copy(stage.velocity[1], start.velocity)
    _copy(state.ddz[2], state.ddz[0])
    _copy(state.force[2], state.force[0])
    for s in range(2):
        _copy(stage.ddz[s, nc:], state.ddz[1 + s])
        _copy(stage.force[s], state.force[1 + s])
    _copy(stage.z[1], start.z)
    _copy(stage.dz[1], start.dz)
    _copy(start.z[nc:], state.z)
    _copy(start.dz[nc:], state.dz)
    _copy(stage.p[1], state.p)
    _copy(stage.dp[1], state.dp)
    _copy(stage.ddp[1], state.ddp)
