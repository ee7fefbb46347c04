"""The two stages of a step, at ½ and 1: extrapolated, collocated, and the loads of the bodies there."""

from typing import NamedTuple

import numpy as np

from solver.coupled.memory import Memory, memory_loads
from solver.coupled.modal import Structure
from solver.coupled.scheme import C, Scheme
from solver.kernels import kernel, part_kernel
from solver.multibody.bodies import Bodies, Coordinates, Loads, Motion, WaterLoads, new_motion
from solver.multibody.minimal import loads, move


class State(NamedTuple):
    """Coordinates, rates, loads and works at the end of a step, where the next one starts; updated in place."""

    z: np.ndarray  # (nj,) joint coordinates
    dz: np.ndarray  # (nj,)
    ddz: np.ndarray  # (3, nj) at the last three samples, newest last
    p: np.ndarray  # (nm,) modal amplitudes
    dp: np.ndarray  # (nm,)
    ddp: np.ndarray  # (nm,)
    force: np.ndarray  # (3, nm) drag and hinge part of the modal load, last three samples
    memory: np.ndarray  # (p, na) complex
    power: np.ndarray  # (len(WORKS),) at the last sample [W]
    work: np.ndarray  # (len(WORKS),) [J] since the start
    energy: np.ndarray  # (3,) [J], see solver.coupled.energy
    zone: np.ndarray  # (2, nz) of the joints' laws, see joint_law
    held: np.ndarray  # (nz,) what holds an axis at rest [N or N m], in its zone HELD
    pace: np.ndarray  # (nz,) [s] in which an axis on its stop is followed now
    jolt: np.ndarray  # (nz,) pieces that are still to smooth what set in as an axis met its stop
    ring: np.ndarray  # (1,) [s] in which modes are followed since a load jumped; infinite if they are not
    fastest: np.ndarray  # (nz,) rate of each so far [m/s or rad/s]


def copied(state: State) -> State:
    """Another of the same values."""
    return State(*(part.copy() for part in state))


class Start(NamedTuple):
    """Where a step begins; its motion is that of the last step's end, stage.motion[1]."""

    z: np.ndarray  # (nz,) carriers, then joints
    dz: np.ndarray  # (nz,)
    velocity: np.ndarray  # (na,) of what radiates
    anchor: np.ndarray  # (nz,) coordinates at which pressure there was evaluated
    pressure: np.ndarray  # (nb, 6)
    drag: np.ndarray  # (nm,) on the modes, and (nd, ns) flow at the stations: see modal.drag
    flow: np.ndarray
    known: np.ndarray  # (1,) whether these have been evaluated


class Stages(NamedTuple):
    """Unknowns and loads at the two stages, one row each."""

    motion: tuple[Motion, Motion]
    z: np.ndarray  # (2, nz)
    dz: np.ndarray  # (2, nz)
    ddz: np.ndarray  # (2, nz)
    p: np.ndarray  # (2, nm)
    dp: np.ndarray  # (2, nm)
    ddp: np.ndarray  # (2, nm)
    known: np.ndarray  # (2, nm) modal loads that do not depend on the stages
    force: np.ndarray  # (2, nm) the rest, drag and what the floats' hinges bear
    drag: np.ndarray  # (2, nm)
    velocity: np.ndarray  # (2, na) of what radiates
    history: np.ndarray  # (2, na) memory's load from before the step
    memory: np.ndarray  # (2, na) and with the stages' velocities
    anchor: np.ndarray  # (2, nz) coordinates at which pressure and drag were evaluated
    since: np.ndarray  # (2, nz) what has been moved from there
    pressure: np.ndarray  # (2, nb, 6)
    residual: np.ndarray  # (2, nz)
    wrench: np.ndarray  # (2, nb, 6)
    external: np.ndarray  # (2, nb, 6)
    zone: np.ndarray  # (2, nz) in which the step begins, and goes on


def new_stages(bodies: Bodies, modes: int) -> Stages:
    """Zeros for these bodies and so many modes."""
    nb, nz = bodies.axes.size, bodies.mechanism.size
    return Stages(
        motion=(new_motion(bodies), new_motion(bodies)),
        zone=np.zeros((2, nz), np.int64),
        **{name: np.zeros((2, nz)) for name in ("z", "dz", "ddz", "anchor", "since", "residual")},
        **{name: np.zeros((2, modes)) for name in ("p", "dp", "ddp", "known", "force", "drag")},
        **{name: np.zeros((2, nb * bodies.active.size)) for name in ("velocity", "history", "memory")},
        **{name: np.zeros((2, nb, 6)) for name in ("pressure", "wrench", "external")},
    )


@kernel(inline="always")
def coordinates(stage: Stages, s: int) -> Coordinates:
    """Coordinates of stage s."""
    return Coordinates(stage.z[s], stage.dz[s], stage.ddz[s], stage.zone)


@part_kernel
def predict(structure: Structure, dt: float, scheme: Scheme, modal: np.ndarray, state: State, stage: Stages) -> None:
    """Fill stage.known with what the step's start says of the modal loads, and extrapolate the others.

    modal (2, nm): the wave's loads at the stages. Loads and joint accelerations go on as parabolas through the
    last three samples.

    Loads, not accelerations, of the modes are extrapolated: stiff modes ring in the latter.
    """
    nc, nm = structure.carrier.shape
    for s in range(2):
        a, b, c = (1.0, -3.0, 3.0) if s == 0 else (3.0, -8.0, 6.0)
        A0, _, _, AA0, _, _ = _weights(scheme, s)
        for m in range(nm):
            w, cv = structure.omega[m], state.dp[m] + dt * A0 * state.ddp[m]
            cq = state.p[m] + dt * C[s] * state.dp[m] + dt * dt * AA0 * state.ddp[m]
            stage.known[s, m] = modal[s, m] - 2 * structure.damping[m] * w * cv - w * w * cq
            stage.force[s, m] = a * state.force[0, m] + b * state.force[1, m] + c * state.force[2, m]
        for i in range(state.z.size):
            stage.ddz[s, nc + i] = a * state.ddz[0, i] + b * state.ddz[1, i] + c * state.ddz[2, i]


@kernel(inline="always")
def _weights(scheme: Scheme, s: int) -> tuple[float, float, float, float, float, float]:
    """Of stage s: of the start's and both stages' accelerations in rates, and in positions; out of the inner loops."""
    A0, A, AA0, AA, _ = scheme
    return A0[s], A[s, 0], A[s, 1], AA0[s], AA[s, 0], AA[s, 1]


@part_kernel
def collocate(
    structure: Structure, inverse: np.ndarray, dt: float, scheme: Scheme, state: State, start: Start, stage: Stages
) -> float:
    """Stage values of modes, carriers and joints from modal loads and joint accelerations.

    Returns the largest change of a modal displacement [m] since the last call.
    """
    p, dp, ddp, z, dz, ddz = stage.p, stage.dp, stage.ddp, stage.z, stage.dz, stage.ddz
    nc, nm = structure.carrier.shape
    change = 0.0
    for m in range(nm):
        f0, f1 = stage.known[0, m] + stage.force[0, m], stage.known[1, m] + stage.force[1, m]
        ddp[0, m] = inverse[m, 0, 0] * f0 + inverse[m, 0, 1] * f1
        ddp[1, m] = inverse[m, 1, 0] * f0 + inverse[m, 1, 1] * f1
    for s in range(2):
        A0, A, B, AA0, AA, BB = _weights(scheme, s)
        for m in range(nm):
            a0, a1, a2 = state.ddp[m], ddp[0, m], ddp[1, m]
            dp[s, m] = state.dp[m] + dt * (A0 * a0 + A * a1 + B * a2)
            new = state.p[m] + dt * C[s] * state.dp[m] + dt * dt * (AA0 * a0 + AA * a1 + BB * a2)
            change = max(change, abs(new - p[s, m]) * structure.scale[m])
            p[s, m] = new
        for i in range(nc):
            q0 = q1 = q2 = 0.0
            for m in range(nm):
                q0 += structure.carrier[i, m] * p[s, m]
                q1 += structure.carrier[i, m] * dp[s, m]
                q2 += structure.carrier[i, m] * ddp[s, m]
            z[s, i], dz[s, i], ddz[s, i] = q0, q1, q2
        for i in range(nc, z.shape[1]):
            a0, a1, a2 = state.ddz[2, i - nc], ddz[0, i], ddz[1, i]
            dz[s, i] = start.dz[i] + dt * (A0 * a0 + A * a1 + B * a2)
            z[s, i] = start.z[i] + dt * C[s] * start.dz[i] + dt * dt * (AA0 * a0 + AA * a1 + BB * a2)
    return change


@kernel(inline="always")
def follow(bodies: Bodies, memory: Memory, stage: Stages) -> None:
    """Move the bodies to the stages, and evaluate the memory's load of their velocities."""
    for s in range(2):
        move(bodies, stage.z[s], stage.dz[s], stage.motion[s])
        velocity = stage.motion[s].active_velocity
        for i in range(velocity.size):
            stage.velocity[s, i] = velocity[i]
    memory_loads(memory, stage.history, stage.velocity, stage.memory)


@kernel(inline="always")
def moved(stage: Stages) -> float:
    """Farthest that a coordinate is from where pressure and drag were evaluated [m or rad]."""
    most = 0.0
    for s in range(2):
        for i in range(stage.z.shape[1]):
            most = max(most, abs(stage.z[s, i] - stage.anchor[s, i]))
    return most


@kernel(inline="always")
def load_bodies(bodies: Bodies, excitation: np.ndarray, stage: Stages) -> None:
    """Residuals and loads of the bodies at both stages; excitation (2, nb, 6)."""
    for s in range(2):
        for i in range(stage.z.shape[1]):
            stage.since[s, i] = stage.z[s, i] - stage.anchor[s, i]
        water = WaterLoads(stage.pressure[s], stage.since[s], excitation[s], stage.memory[s])
        out = Loads(stage.residual[s], stage.wrench[s], stage.external[s])
        loads(bodies, coordinates(stage, s), stage.motion[s], water, out)
