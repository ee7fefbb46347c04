"""A system's steps in blocks, and what is wrong where they fail."""

from collections.abc import Iterator

import numpy as np

from solver import limits
from solver.coupled.energy import GAP, SCALE, energy, open_by
from solver.coupled.equilibrium import righting
from solver.coupled.march import GROSSLY, march
from solver.coupled.pieces.fine import new_fine
from solver.coupled.pieces.pieces import CHANGES
from solver.coupled.problem import (
    EXCURSION,
    NOT_CONVERGED,
    OK,
    TO_AND_FRO,
    UNBALANCED,
    Output,
    new_output,
    new_workspace,
)
from solver.coupled.stages import State
from solver.coupled.system import BLOCK_STEPS, ITERATIONS, System
from solver.errors import SimulationFailed, StepTooLong
from solver.limits import slides
from solver.scene import STEPS, falls_at

FLOWN = 1e3  # [m or rad]: a joint so far off was shot there by a step that its laws are too stiff for


def blocks(system: System, state: State, steps: int, done: int = 0) -> Iterator[tuple[np.ndarray, Output, np.ndarray]]:
    """March from step `done` to step `steps`, yielding (wave samples, output, times) block by block.

    `state` is that after `done` steps, and all that a run needs to go on: to the last bit where `done` is a
    multiple of BLOCK_STEPS, elsewhere to Newton's tolerance.
    """
    h, series = system.dt / 2, system.series(system.dt)
    problem, empty = system.problem(), system.drive(np.zeros((1, len(system.rows))))
    room = new_workspace(system.bodies, system.structure)
    fine = new_fine(problem, empty) if problem.bent.size else None
    # Up to the longest wave's period after the start little has been exchanged, and that with a jolt.
    quiet = int(2 * np.pi / system.scene.sea.omega.min() / system.dt)
    for first in range(done, steps, BLOCK_STEPS):
        count = min(BLOCK_STEPS, steps - first)
        samples = series.block(2 * first, 2 * count + 1)
        output = new_output(problem, 2 * count)
        state.energy[SCALE] = max(state.energy[SCALE], system.least_energy(first + count))
        outcome, sample, _ = march(problem, system.drive(samples), state, room, fine, quiet - first, output)
        if outcome != OK:
            raise _failure(outcome, (2 * first + sample) * h, system, state)
        yield samples[1:], output, (2 * first + 1 + np.arange(2 * count)) * h


def _failure(outcome: int, t: float, system: System, state: State) -> SimulationFailed:
    when = f"at t = {t:.1f} s"
    if outcome == EXCURSION and np.abs(state.z).max(initial=0.0) > FLOWN:
        return StepTooLong(f"a joint flew off {when}: reduce time_step = {system.dt:g} s", t=t)
    if outcome == EXCURSION:
        told = limits.explain(system.scene, state.z, system.bodies.limit, when)
        return SimulationFailed(told + _stability(system, state.z))
    if outcome == UNBALANCED:
        stored = energy(system.bodies, system.structure, state)
        return unbalanced(energy_residual(state.work, stored, state.energy, state.energy[GAP]), GROSSLY, t, system)
    troubles = {
        NOT_CONVERGED: f"no convergence in {ITERATIONS} iterations",
        TO_AND_FRO: f"a joint's law changes over {CHANGES} times in a step",
    }
    told = f"{troubles.get(outcome, 'not finite')} {when}: reduce time_step = {system.dt:g} s"
    return StepTooLong(told + _ringing(system) * (outcome == TO_AND_FRO), t=t)


def _ringing(system: System) -> str:
    """What helps where even the platform's slowest mode swings within a few steps, for the message of laws that change
    with each of its swings."""
    slowest = 2 * np.pi / system.structure.omega.min(initial=np.inf)
    if not 0 < slowest < STEPS * system.dt:
        return ""
    return (
        f"; the elastic platform's slowest mode has a period of {slowest:.2g} s and rings since a joint's load jumped:"
        f" a fixed platform, or time_step up to {slowest / STEPS:.2g} s"
    )


def _stability(system: System, joints: np.ndarray) -> str:
    """Between which angles a hinge that is beyond its bounds rights itself, for the message that says so."""
    bodies, carriers = system.bodies, system.bodies.mechanism.size - joints.size
    if (first := limits.beyond(system.scene, joints, bodies.limit)) is None:
        return ""
    i, item, axis = first
    if slides(axis) or np.isinf(most := falls_at(item.direction(axis))):
        return ""
    rest = system.equilibrium[0]
    back, forth = (rest[carriers + i] + way for way in righting(bodies, rest, carriers + i, most))
    return f"; in still water it rights itself between {back:+.2f} and {forth:+.2f} rad"


def energy_residual(work: np.ndarray, stored: float, exchanged: np.ndarray, allowed: float = 0.0) -> float:
    """Gap of the energy balance, but for `allowed` [J], over the largest exchanged so far; see energy.open_by."""
    gap = open_by(work, stored, exchanged) - allowed
    return float(abs(gap) / exchanged[SCALE]) if gap else 0.0


def unbalanced(gap: float, limit: float, t: float, system: System) -> StepTooLong:
    """The error of a run whose energy balance is open by too large a share of the energy exchanged."""
    return StepTooLong(
        f"energy balance at t = {t:.1f} s open by {gap:.1e} of the energy exchanged, > {limit:g}: reduce time_step ="
        f" {system.dt:g} s and newton_tolerance = {system.scene.settings.newton_tolerance:g}",
        gap,
        t,
    )
