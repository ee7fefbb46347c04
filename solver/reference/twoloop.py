"""Two-loop time integration of a constrained mechanism: see `augmented`."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from solver.errors import StepTooLong
from solver.reference.augmented import (
    INNER,
    NO_SUPPORTS,
    Augmented,
    Body,
    Errors,
    Mechanism,
    MechanismState,
    Surroundings,
    all_frames,
    lobatto,
    mechanism,
    spin,
)
from solver.reference.joints import Frames, Joint, constraint_loads

# Of the constraints. Where C_u loses rank a gap ε leaves √ε undecided, so it is kept at a hundred times rounding.
TOLERANCE = 1e-12
OUTER = 60  # iterations of the outer loop; five to ten suffice where a step is sane
STILL = 1e-12  # change of dt² a, dt v and orientation that ends the outer loop [m or rad]
LOST = 1e6  # the same in a loop that runs away, as it does where dampers or springs are stiff for the step


class Sample(NamedTuple):
    """One stage after convergence; joint_load (nj, 6) on each joint's second frame at its point."""

    time: float
    frames: Frames
    joint_load: np.ndarray
    errors: Errors


@dataclass(frozen=True, eq=False, kw_only=True)
class Trajectory:
    """Histories (nt, ...) of all bodies; joint_load on each joint's second frame, moment at its point."""

    time: np.ndarray  # [s]
    position: np.ndarray  # (nt, nb, 3)
    rotation: np.ndarray  # (nt, nb, 3, 3)
    velocity: np.ndarray  # (nt, nb, 6)
    joint_load: np.ndarray  # (nt, nj, 6)
    errors: Errors  # largest over the run


def evaluate(
    system: Mechanism, state: MechanismState, stage: int, t: float, surroundings: Surroundings, tolerance: float
) -> tuple[MechanismState, Sample]:
    """Inner loops at one stage: constraints of position, velocity and acceleration in turn.

    Returns the state with its accelerations and multipliers, its frames, loads at joints, errors.
    """
    supports = surroundings.supports(stage, t)
    frames = all_frames(state, supports)
    nb = len(state.position)
    if not nb:
        return state, Sample(t, frames, np.zeros((0, 6)), Errors(0.0, 0.0, 0.0))
    extra = surroundings.mechanism_inertia(stage, frames)
    kkt = Augmented(system if extra is None else system._replace(added_mass=system.added_mass + extra), frames)
    for _ in range(INNER):
        gap = np.abs(kkt.C).max(initial=0.0)
        if gap <= tolerance:
            break
        move = kkt.correction(kkt.C)
        q = state.quaternion + spin(move[:, 3:], state.quaternion) / 2
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        state = state._replace(position=state.position + move[:, :3], quaternion=q)
        frames = all_frames(state, supports)
        kkt.evaluate(frames)
    for _ in range(INNER):
        slip = kkt.J @ frames.velocity.ravel()
        if np.abs(slip).max(initial=0.0) <= tolerance:
            break
        state = state._replace(velocity=state.velocity + kkt.correction(slip))
        frames = all_frames(state, supports)
        kkt.evaluate(frames)
    surroundings.mechanism_inertia(stage, frames)
    load = surroundings.loads(stage, t, frames)
    of_supports = kkt.J[:, 6 * nb :] @ frames.acceleration[nb:].ravel()
    acceleration, multiplier, error = kkt.accelerations(np.ravel(load), -kkt.bias - of_supports, tolerance)
    state = state._replace(acceleration=acceleration, multiplier=multiplier)
    carried = -(kkt.J[:, 6 * nb :].T @ multiplier).reshape(-1, 6)[:-1]
    frames = frames._replace(acceleration=_with(frames, acceleration))
    held = -(kkt.Cu.T @ multiplier).reshape(-1, 6)
    surroundings.carried(stage, frames, held, carried)
    joints = np.empty((system.equations.joint.max(initial=-1) + 1, 6))
    constraint_loads(system.equations, frames, kkt.J, multiplier, joints)
    errors = Errors(gap, float(np.abs(slip).max(initial=0.0)), float(error))
    return state, Sample(t, frames, joints, errors)


def _with(frames: Frames, acceleration: np.ndarray) -> np.ndarray:
    out = frames.acceleration.copy()
    out[: len(acceleration)] = acceleration
    return out


def integrate(
    system: Mechanism,
    state: MechanismState,
    surroundings: Surroundings,
    *,
    t_end: float,
    dt: float,
    stages: int = 3,
    tolerance: float = TOLERANCE,
    still: float = STILL,
    stuck: float = 0.0,
) -> Iterator[Sample]:
    """Samples at the start and at every stage of every step; t = n dt + c dt.

    tolerance: of the constraints [m, m/s, m/s2]; still: last change of a stage that ends the outer loop [m]; stuck:
    the same after half of all iterations, for mechanisms that pass singular positions, where rounding keeps the last
    digits moving.
    """
    c, A = lobatto(stages)
    ahead = _extrapolation(c)
    state, sample = _first(system, state, dt, surroundings, tolerance)
    yield sample
    chain = [state] * stages
    for n in range(round(t_end / dt)):
        t = n * dt
        surroundings.begin(t, dt, chain[-1])
        a = np.einsum("sj,jbk->sbk", ahead, np.array([s.acceleration for s in chain]))
        chain, samples = _step(system, chain[-1], a, t, dt, (c, A), surroundings, (tolerance, still, stuck))
        surroundings.finish()
        yield from samples


def _first(
    system: Mechanism, state: MechanismState, dt: float, surroundings: Surroundings, tolerance: float
) -> tuple[MechanismState, Sample]:
    """Accelerations at t = 0, of bodies and supports together."""
    surroundings.begin(0.0, dt, state)
    for _ in range(OUTER):
        moved = surroundings.iterate()
        new, sample = _evaluated(system, state, 0, (0.0, dt), surroundings, tolerance)
        change = _largest(moved, dt * dt * (new.acceleration - state.acceleration))
        state = new
        if not change < LOST:
            break
        if change < STILL:
            return state, sample
    raise _lost(change, 0.0, dt)


def _extrapolation(c: np.ndarray) -> np.ndarray:
    """(s, s) values at the next step's points of the polynomial through this step's."""
    basis = np.vander(c, increasing=True)
    return np.vander(c + 1, increasing=True) @ np.linalg.inv(basis)


def _step(
    system: Mechanism,
    start: MechanismState,
    a: np.ndarray,
    t: float,
    dt: float,
    tableau: tuple[np.ndarray, np.ndarray],
    surroundings: Surroundings,
    limits: tuple[float, float, float],
) -> tuple[list[MechanismState], list[Sample]]:
    """Outer loop: accelerations of the stages, until they stand still."""
    (c, A), (tolerance, still, stuck) = tableau, limits
    a[0] = start.acceleration
    chain = [start] * len(c)
    for n in range(OUTER):
        change, samples = surroundings.iterate(), []
        v = start.velocity + dt * np.einsum("sj,jbk->sbk", A, a)
        x = start.position + dt * np.einsum("sj,jbk->sbk", A, v[..., :3])
        dq = np.array([spin(v[j, :, 3:], chain[j].quaternion) / 2 for j in range(len(c))])
        q = start.quaternion + dt * np.einsum("sj,jbk->sbk", A, dq)
        q /= np.linalg.norm(q, axis=-1, keepdims=True)
        for s in range(1, len(c)):
            guess = MechanismState(x[s], q[s], v[s], a[s], chain[s].multiplier)
            new, sample = _evaluated(system, guess, s, (t + c[s] * dt, dt), surroundings, tolerance)
            turned = new.quaternion - chain[s].quaternion
            change = _largest(change, dt * dt * (new.acceleration - a[s]), turned)
            a[s], chain[s] = new.acceleration, new
            samples.append(sample)
        if not change < LOST:
            break
        if change < (still if n < OUTER // 2 else max(still, stuck)):
            return chain, samples
    raise _lost(change, t + dt, dt)


def _evaluated(
    system: Mechanism,
    state: MechanismState,
    stage: int,
    when: tuple[float, float],
    surroundings: Surroundings,
    tolerance: float,
) -> tuple[MechanismState, Sample]:
    """As `evaluate` at when = (t, dt); StepTooLong where its equations are singular."""
    try:
        return evaluate(system, state, stage, when[0], surroundings, tolerance)
    except np.linalg.LinAlgError as error:
        t, dt = when
        raise StepTooLong(f"joints lost at t = {t:.3f} s ({error}): reduce time_step = {dt:g} s") from None


def _largest(*changes: np.ndarray | float) -> float:
    """Magnitude of the largest, NaN if any is: Python's max would drop it."""
    return float(np.max([np.abs(change).max(initial=0.0) for change in changes]))


def _lost(change: float, t: float, dt: float) -> StepTooLong:
    """The error of a run whose outer loop does not settle."""
    trouble = "runs away" if np.isfinite(change) else "is not finite"
    if change < LOST:
        trouble = f"does not settle in {OUTER} iterations"
    return StepTooLong(
        f"motion of the stages {trouble} at t = {t:.3f} s, last change {change:.1e} m or rad: reduce time_step ="
        f" {dt:g} s, which stiff dampers, springs and light supports ask for in the augmented formulation"
    )


Loads = Callable[[float, Frames], np.ndarray]  # (nb, 6) at a time, with the frames there
Motion = Callable[[float], tuple[ArrayLike, ...]]  # (position, rotation, velocity (6,), acceleration (6,)) of a support


class PrescribedSurroundings:
    """Surroundings of which the motion of supports and the loads are known functions."""

    def __init__(self, forces: Loads, supports: tuple[Motion, ...]) -> None:
        self.forces, self.motions = forces, supports

    def begin(self, _t: float, _dt: float, _state: MechanismState) -> None:
        """Nothing to prepare."""

    def iterate(self) -> float:
        """0: supports do not depend on loads."""
        return 0.0

    def mechanism_inertia(self, _stage: int, _frames: Frames) -> np.ndarray | None:
        """None: the bodies have no mechanisms."""
        return None

    def supports(self, _stage: int, t: float) -> Frames:
        """Poses and motions (position, rotation, velocity, acceleration) of the supports at time t [s]."""
        if not self.motions:
            return NO_SUPPORTS
        return Frames(*(np.array(x, float) for x in zip(*(motion(t) for motion in self.motions), strict=True)))

    def loads(self, _stage: int, t: float, frames: Frames) -> np.ndarray:
        """The prescribed loads (nb, 6) at time t [s]."""
        return self.forces(t, frames)

    def carried(self, _stage: int, _frames: Frames, _held: np.ndarray, _load: np.ndarray) -> None:
        """Not used."""

    def finish(self) -> None:
        """Nothing to carry on."""


def simulate_mechanism(
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    forces: Callable[[float, Frames], np.ndarray] | None,
    t_end: float,
    dt: float,
    *,
    supports: tuple[Motion, ...] = (),
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81),
    added_mass: np.ndarray | None = None,
    stages: int = 3,
    tolerance: float = TOLERANCE,
    stuck: float = 0.0,
) -> Trajectory:
    """Motion of bodies held by joints, sampled at every stage (steps of dt/2 with 3 stages).

    forces(t, frames): loads (nb, 6) about the bodies' origins, world axes, besides gravity;
    supports: t -> (position, rotation, velocity (6,), acceleration (6,)), frames nb, nb + 1, …;
    GROUND is frame -1. tolerance: of the constraints [m, m/s, m/s2]; stuck: see `integrate`.
    """
    none = np.zeros((len(bodies), 6))
    prescribed = PrescribedSurroundings(forces or (lambda *_: none), supports)
    system, state = mechanism(bodies, joints, prescribed.supports(0, 0.0), gravity=gravity, added_mass=added_mass)
    samples = list(
        integrate(system, state, prescribed, t_end=t_end, dt=dt, stages=stages, tolerance=tolerance, stuck=stuck)
    )
    nb = len(bodies)
    return Trajectory(
        time=np.array([s.time for s in samples]),
        position=np.array([s.frames.position[:nb] for s in samples]),
        rotation=np.array([s.frames.rotation[:nb] for s in samples]),
        velocity=np.array([s.frames.velocity[:nb] for s in samples]),
        joint_load=np.array([s.joint_load for s in samples]),
        errors=Errors(*np.max([s.errors for s in samples], axis=0)),
    )


def mechanical_energy(
    bodies: tuple[Body, ...], trajectory: Trajectory, gravity: Sequence[float] = (0.0, 0.0, -9.81)
) -> np.ndarray:
    """Kinetic and potential energy of gravity (nt,) [J]."""
    total = np.zeros(len(trajectory.time))
    for b, body in enumerate(bodies):
        R, v = trajectory.rotation[:, b], trajectory.velocity[:, b]
        lever = R @ np.array(body.cog, float)
        at_cog = v[:, :3] + np.cross(v[:, 3:], lever)
        spin_in_body = np.einsum("tij,ti->tj", R, v[:, 3:])
        spinning = np.einsum("ti,ij,tj->t", spin_in_body, body.inertia_tensor, spin_in_body)
        total += 0.5 * body.mass * np.sum(at_cog**2, axis=1) + 0.5 * spinning
        total -= body.mass * (trajectory.position[:, b] + lever) @ np.array(gravity)
    return total
