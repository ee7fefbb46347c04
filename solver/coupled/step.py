"""One step of the coupled system: see scheme.

A step is solved by Newton's method with the matrix of its start. The structure's
modes are eliminated exactly by their flexibility at the hinge nodes, however many there are
and however stiff; the radiation memory is exact for velocities quadratic in time.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

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
    WORKS,
    stored,
)
from solver.coupled.memory import Memory, memory_history, remember
from solver.coupled.modal import Structure, WaterAbout, drag, flexibility
from solver.coupled.newton import (
    Newton,
    Zones,
    constant_part,
    factorize,
    hold,
    new_newton,
    newton_matrix,
    newton_side,
    substitute,
)
from solver.coupled.scheme import LOBATTO, Scheme
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
from solver.kernels import inner_kernel, kernel, lean_kernel, part_kernel
from solver.multibody.joint_law import HELD, OPEN, PTO_ZONE, STOP_ZONE
from solver.multibody.minimal import Bodies, PressureRoom, powers, pressure_room, pressures
from solver.multibody.zones import off_stop

# Pressure and drag are evaluated again where a stage has moved by so many tolerances since; nearer than that
# the hydrostatic stiffness stands for the change, and what is left of it, (dt ω)²/5, is below the tolerance. A piece of
# a step, whose tolerance goes by its length, may be farther by as much as it is shorter.
NEAR = 25.0

SURELY = 0.1  # of the tolerance: where a piece's next update is foreseen to be less it is not made

OK, NOT_CONVERGED, EXCURSION, NOT_FINITE, UNBALANCED, TO_AND_FRO = range(6)
# Of end stops: number of hits, largest rate at one [m/s or rad/s], largest load [N or N m].
CONTACT = ("end_stop_hits", "impact_rate", "end_stop_load")
HITS, RATE, LOAD = range(len(CONTACT))
# And of an axis that is held, the share of the time; at the sample whether its power take-off has let go, and the load
# that it bears beyond what its position and rate tell: see joint_law.beyond_law.
HOLDS, LET_GO, BEYOND = range(len(CONTACT), len(CONTACT) + 3)


class Drive(NamedTuple):
    """Samples of all that the wave drives; first axis time, samples dt/2 apart."""

    field: np.ndarray  # (m, 2 terms of all floats), see minimal.pressures
    excitation: np.ndarray  # (m, nb, 6)
    modal: np.ndarray  # (m, nm)
    station: np.ndarray  # (m, nd, ns) particle velocity normal to the members
    wet: np.ndarray  # (m, ns) and push (m, nd, ns), see modal.WaterAbout
    push: np.ndarray


UNCUT, UNTOLD = -1.0, -2.0  # of a step that is cut, where there is no room for its pieces
PIECES = 4  # of steps that are cut for which there is room, over samples


class Between(NamedTuple):
    """Middles and ends of the pieces of steps that are cut, as Output's, in their order; `at` counts samples of it."""

    z: np.ndarray
    dz: np.ndarray
    p: np.ndarray
    wrench: np.ndarray
    dp: np.ndarray
    ddp: np.ndarray
    carried: np.ndarray
    drag: np.ndarray
    contact: np.ndarray
    at: np.ndarray  # (k,) row of the output where it lies, a fraction
    weight: np.ndarray  # (k,) in the mean over the time between two samples
    row: np.ndarray  # (k,) the row which that time ends at
    number: np.ndarray  # (1,) of what there is
    follows: np.ndarray  # (1,) whether the next piece begins with the loads that the last one ended with


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
    contact: np.ndarray  # (m, number of bent axes, 6) since the sample before: CONTACT, HOLDS, LET_GO, BEYOND
    struck: np.ndarray  # (m, number of bent axes, nb, 6) loads as `wrench`, when the axis's stop bore most since then
    lead: np.ndarray  # (m,) weight of the sample before in the mean over the time since then, by pieces; UNCUT; UNTOLD
    between: Between

    def thinned(self) -> "Output":
        """Every other sample, of steps that are not cut."""
        parts: list[Any] = [*(part[1::2] for part in self[:-1]), self.between]
        return Output(*parts)


class Problem(NamedTuple):
    """Constants of a march: the arrays of a system, and steps of one length."""

    bodies: Bodies
    structure: Structure
    memory: Memory
    inverse: np.ndarray  # (nm, 2, 2) and H (2, nc, 2, nc): see flexibility
    H: np.ndarray
    constant: np.ndarray  # (2nz, 2nz) of Newton's matrix
    stiffness: np.ndarray  # (nz, nz) of the floats at rest, off their stops
    beta: np.ndarray  # (p,) of the radiation memory
    bent: np.ndarray  # coordinates whose joint's law has several zones
    pace: np.ndarray  # (nz,) [s] in which whatever swings on a stop is followed
    swing: np.ndarray  # (nz,) [s] in which an axis is, that swings on a stop and what carries it does not
    dt: float
    tolerance: float  # of Newton's last update of any stage position [m or rad]
    near: float  # [m or rad] a stage may be from where its pressure and drag were evaluated, see NEAR
    iterations: int  # of Newton's method, at most
    part: bool  # whether steps are pieces of others, one like the other
    short: bool  # whether pressure and drag at a step's middle are near the mean of those at its ends
    scheme: Scheme


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
    beta: np.ndarray,
    bent: np.ndarray,
    pace: np.ndarray,
    swing: np.ndarray,
    dt: float,
    tolerance: float,
    iterations: int,
) -> Problem:
    """Constants for steps of dt [s]; stiffness (nz, nz) of the floats at rest, for Newton's matrix alone."""
    nz = bodies.mechanism.size
    inverse, H = flexibility(structure, dt, LOBATTO)
    constant = np.empty((2 * nz, 2 * nz))
    constant_part(bodies, memory, stiffness, dt, constant)
    fixed = (stiffness, np.ascontiguousarray(beta, dtype=complex), bent, pace, swing)
    of_newton = (dt, tolerance, NEAR * tolerance, iterations)
    return Problem(bodies, structure, memory, inverse, H, constant, *fixed, *of_newton, False, False, LOBATTO)


def new_workspace(bodies: Bodies, structure: Structure) -> Workspace:
    """Scratch for marches of these bodies and modes."""
    nz = bodies.mechanism.size
    return Workspace(
        start=Start(
            np.empty(nz),
            np.empty(nz),
            np.empty(bodies.axes.size * bodies.active.size),
            np.empty(nz),
            np.empty((bodies.axes.size, 6)),
            np.empty(structure.omega.size),
            np.empty(structure.station.shape[1:]),
            np.zeros(1),
            np.zeros(1, np.bool_),
        ),
        stage=new_stages(bodies, structure.omega.size),
        newton=new_newton(nz),
        power=np.zeros((3, len(WORKS))),
        flow=np.empty((2, *structure.station.shape[1:])),
        pressure=pressure_room(bodies),
    )


def new_output(problem: Problem, samples: int) -> Output:
    """Room for so many samples; no contact yet."""
    bodies, structure = problem.bodies, problem.structure
    nz, nb, (nc, nm) = bodies.mechanism.size, bodies.axes.size, structure.carrier.shape
    shapes = ((nz,), (nz,), (nm,), (nb, 6), (nm,), (nm,), (nc,), structure.station.shape[1:])
    contact = np.zeros((samples, problem.bent.size, BEYOND + 1))
    struck = np.zeros((samples, problem.bent.size, nb, 6))
    return whole_output([np.empty((samples, *shape)) for shape in shapes], contact, struck, PIECES * samples)


def whole_output(parts: Sequence[np.ndarray], contact: np.ndarray, struck: np.ndarray, room: int = 0) -> Output:
    """Of the arrays z to drag, no step of which is cut yet; room for so many middles and ends of pieces."""
    rows = room if contact.shape[1] else 0
    arrays: list[Any] = [np.empty((rows, *part.shape[1:])) for part in (*parts, contact)]
    arrays += [np.empty(rows), np.empty(rows), np.empty(rows, np.int64), np.zeros(1, np.int64), np.zeros(1, np.bool_)]
    between = Between(*arrays)
    given: list[Any] = [*parts, contact, struck, np.full(len(contact), UNCUT), between]
    return Output(*given)


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
        fresh = spent == first or stage.z.size == 0 or (spent > first and moved(stage) > problem.near)
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
    end, power = sample + 2, room.power[1:, FRAME_DRAG]
    water = WaterAbout(drive.station[sample:end], drive.wet[sample:end], drive.push[sample:end])
    drag(problem.structure, water, stage.dp, since, stage.drag, room.flow, power)
    if between:
        _halfway(room.start, stage, room.flow, power)


@kernel(inline="always")
def _halfway(start: Start, stage: Stages, flow: np.ndarray, power: np.ndarray) -> None:
    """Pressure and drag at a step's middle, from those at its ends; flow (2, nd, ns), power (2,): see modal.drag."""
    for m in range(start.drag.size):
        stage.drag[0, m] = 0.5 * (start.drag[m] + stage.drag[1, m])
    for d in range(start.flow.shape[0]):
        for i in range(start.flow.shape[1]):
            flow[0, d, i] = 0.5 * (start.flow[d, i] + flow[1, d, i])
    power[0] = 0.5 * (start.power[0] + power[1])
    for i in range(stage.z.shape[1]):
        stage.anchor[0, i] = 0.5 * (start.anchor[i] + stage.anchor[1, i])
    for b in range(stage.pressure.shape[1]):
        for i in range(6):
            stage.pressure[0, b, i] = 0.5 * (start.pressure[b, i] + stage.pressure[1, b, i])


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
        inertia = structural = 0.0
        for m in range(structure.omega.size):
            inertia += drive.modal[sample + s, m] * stage.dp[s, m]
            structural += 2 * structure.damping[m] * structure.omega[m] * stage.dp[s, m] ** 2
        power[1 + s, FRAME_INERTIA], power[1 + s, STRUCTURAL] = inertia, structural
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
    start.power[0] = room.power[2, FRAME_DRAG]
    copy(start.z[nc:], state.z)
    copy(start.dz[nc:], state.dz)
    copy(stage.p[1], state.p)
    copy(stage.dp[1], state.dp)
    copy(stage.ddp[1], state.ddp)


@kernel(inline="always")
def within(limit: np.ndarray, z: np.ndarray) -> bool:
    """Whether all coordinates are within their limits, and none is NaN."""
    within = True
    for i in range(z.size):
        within = within and limit[i, 0] < z[i] < limit[i, 1]
    return within
