"""What linear damping leaves of loads that bend: lines that no wave makes, of joints' forces and an elastic platform.

And, in one wave, the harmonics of the members' drag; in a sea these are lines of the case (see beyond).

Loads that jump or are cut off, or go with the rate's square, have parts above the waves' frequencies, too, by which
frames swing on their own: see left. That goes with no rate in the mean, and so adds to the waves' variance. Of one wave
it is the harmonics of f.
"""

from collections.abc import Iterator

import numpy as np

from solver.errors import SimulationFailed
from solver.frequency import gaussian, left
from solver.frequency.bent import Load, rate_load
from solver.frequency.case import Case
from solver.frequency.outputs import Forces, Lacks, Rung, mean_forces, rate_lines
from solver.frequency.response import Response
from solver.frequency.shape import warped
from solver.frequency.steps import Steps
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import drag
from solver.record.steel import Steel
from solver.scene import DOFS

LITTLE = 0.1  # of the largest std of its kind: less is not looked at
HARMONICS = np.arange(3, gaussian.PHASES // 4, 2)
ROUNDS, AGREED = 30, 1e-4  # of drag by its own harmonics, and last change of these
BY_DRAG = np.arange(2, 13)  # in a current even ones, too; of those above accelerations have a hundredth


def rung(case: Case, law: JointLaw, response: Response, frame: Forces) -> Rung:
    """What a response moves a platform by, and the frame's and the joints' forces, with such lines where loads bend."""
    (nc, nm), of, model, support = case.system.structure.carrier.shape, case.process, case.model, case.system.support
    channels, rates, one = case.channels, rate_lines(case, response), case.omega.size == 1
    axes = np.flatnonzero((response.bends | (drag(law)[nc:] > 0)) & ~response.stuck & rates.any(axis=0))
    dragged = one and case.stations.size > 0
    if not (axes.size or dragged):
        return Rung(of, response.X[:, :nm], frame)
    load, moved = rate_load(law, nc + axes), rates[:, axes]
    if one:
        numbers = np.union1d(HARMONICS if axes.size else BY_DRAG, BY_DRAG if dragged else HARMONICS)
        omega, force = numbers * of.omega[0], _harmonics(numbers, load(gaussian.one_period(moved)))[:, None]
    else:
        omega, force = left.lines(case, load, moved, response.damping)
    many, at = force.shape[1], np.repeat(omega, force.shape[1])
    pushed = np.zeros((omega.size, many, len(model.mass)), complex)
    pushed[..., nm + axes] = -force
    borne = np.zeros((omega.size, many, frame.lines.shape[1]), complex)
    (X, Y), lacks = case.driven(omega, pushed, response.damping), None
    by_joints = np.stack([_borne(case, omega, Y, X[:, k]) for k in range(many)], axis=1)
    borne += by_joints
    if dragged:
        X[:, 0], of_drag = _swung(case, response, numbers, X[:, 0])
        lacks = _lacks(case, response, numbers, X[:, 0])
        if support is not None and support.forces is not None:
            borne[:, 0] = support.forces.whole(of_drag @ support.forces.drag) + _borne(case, omega, Y, X[:, 0])
    joints = np.empty((omega.size, many, len(case.system.scene.floats), 3), complex)
    for k in range(many):
        joints[:, k] = _across(case, axes, model.loads(omega, X[:, k], Y, np.zeros((1, 1, 1))))
    duration, begin = (2 * np.pi / of.omega[0], 0.0) if one else (of.duration, of.begin)
    process = gaussian.Process(np.append(of.omega, at), duration, 0 if one else of.others + at.size, begin)
    X = np.concatenate([response.X[:, :nm], X.reshape(at.size, -1)[:, :nm]])
    frame = frame._replace(lines=np.concatenate([frame.lines, borne.reshape(at.size, borne.shape[2])]))
    forces = np.concatenate([channels.hinge_force(response.wrench), joints.reshape(at.size, *joints.shape[2:])])
    mean = mean_forces(case, response)
    loads = np.concatenate([moved * _linear(load, gaussian.spread(moved)), force.reshape(at.size, -1)])
    ringing = by_joints.reshape(at.size, -1)
    if one:
        of_joints = gaussian.table(mean, forces, process)
        return Rung(process, X, frame, of_joints, *_of_steel(case, frame, ringing, loads, None), lacks)
    more = _beyond_gaussian(case, load, moved, response.excess[0, axes], loads)
    of_steel = _of_steel(case, frame, ringing, loads, more)
    return Rung(process, X, frame, _of_joints(case, mean, forces, loads, more), *of_steel)


def _linear(load: Load, sigma: np.ndarray) -> np.ndarray:
    """c = ⟨f v⟩/σ² (nj,) of loads f at Gaussian rates of std σ (nj,)."""
    v = gaussian.SIZES[:, None] * sigma
    return np.asarray(gaussian.WEIGHTS @ (load(v) * v) / sigma**2)


def _across(case: Case, axes: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    """Joints' forces (ne, nb, 3) of loads on the floats (ne, nb, 6), but along axes that slide: see outputs.bend."""
    force = case.channels.hinge_force(wrench)
    for j in axes:
        if case.channels.names[j] in DOFS[:3]:
            force[:, case.channels.owner[j], DOFS.index(case.channels.names[j])] = 0.0
    return force


def _beyond_gaussian(case: Case, load: Load, rates: np.ndarray, excess: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """r² - 1 (nj,) where loads' largest are r of those of Gaussian lines: loads (nl, nj), by rates (nw, nj) with an
    excess of kurtosis (nj,)."""
    fastest = gaussian.spread(rates) * warped(gaussian.peak(rates, case.process), excess)
    told = gaussian.spread(loads) * gaussian.peak(loads[: case.omega.size], case.process)
    largest = load(fastest[None])[0]
    return np.asarray(np.divide(largest, told, out=np.ones(told.size), where=told > 0) ** 2 - 1)


def _alike(y: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Squares (n, nj) of correlations of lines (nl, n) and (nl, nj)."""
    size = np.outer(gaussian.spread(y), gaussian.spread(loads))
    return np.divide(gaussian.covariance(y, loads), size, out=np.zeros(size.shape), where=size > 0) ** 2


def _of_joints(case: Case, mean: np.ndarray, forces: np.ndarray, loads: np.ndarray, more: np.ndarray) -> np.ndarray:
    """Statistics (nb, 3, 5) of forces with means (nb, 3) and lines (nl, nb, 3) in a sea.

    Largest ones are of as many cycles as the waves make: those of waves' own lines, or where loads have larger ones
    than Gaussian lines (1 + Σ s² (r² - 1))^½ of all lines', s the correlations with them.
    """
    table, every = gaussian.table(mean, forces[: case.omega.size], case.process), forces.reshape(len(forces), -1)
    usual, std = (gaussian.spread(lines).reshape(mean.shape) for lines in (every[: case.omega.size], every))
    grown = np.divide(std, usual, out=np.ones(std.shape), where=usual > 0)
    largest = np.sqrt((1 + _alike(every, loads) @ more).clip(min=0.0)).reshape(mean.shape)
    level = mean[..., None]
    table[..., :2] = level + np.maximum(1.0, largest * grown)[..., None] * (table[..., :2] - level)
    table[..., 4] *= grown
    table[..., 3] = np.hypot(mean, table[..., 4])
    return table


def _of_steel(
    case: Case, frame: Forces, ringing: np.ndarray, loads: np.ndarray, more: np.ndarray | None
) -> tuple[float, float]:
    """Largest ones to be expected of steel over those of Gaussian lines (nl, ny), and the share that joints ring by
    lines (ne, ny): the members' drag is no part of that.

    (1 + s² (r² - 1))^½ as of joints, of each load; not less than 1: what rings comes in bursts, and makes up for what
    loads that are cut off have less. loads (nl, nj): their lines; without `more` of one wave, whose phases are known.
    """
    steel, largest, rings = case.channels.steel, 1.0, 0.0
    if steel is None or not loads.size:
        return largest, rings
    for lines, own in zip(_borne_by(steel, frame.lines), _borne_by(steel, ringing), strict=True):
        size = gaussian.spread(lines)
        felt = size > LITTLE * size.max(initial=0.0)
        if more is not None:
            largest = float(np.max(np.sqrt(1 + _alike(lines[:, felt], loads) * more), initial=largest))
        rings = float(np.max((gaussian.spread(own)[felt] / size[felt]) ** 2, initial=rings))
    return largest, rings


def _borne_by(steel: Steel, forces: np.ndarray) -> Iterator[np.ndarray]:
    """Lines (nl, n) of each of steel's outputs and, where ranges are counted, of its fibres, by those of forces."""
    for _, lines in steel.channels(forces):
        yield lines.reshape(len(lines), -1)
    for at, ends in steel.ends(forces).items() if steel.counts else ():
        yield steel.fibres(ends, at).reshape(len(forces), -1)


def _harmonics(numbers: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Lines (ne, n) at so many times a wave's frequency of loads over its period (PHASES, n)."""
    return np.exp(1j * np.outer(numbers, gaussian.PHASE)) * (2 / gaussian.PHASES) @ load


def _swung(case: Case, response: Response, numbers: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines (ne, n) at so many times one wave's frequency, and of the drag (ne, nd ns) [N], where others' loads make X.

    The frame swings by it, and drag is of the water past that: again until it agrees with its own result.
    """
    nm, n = len(case.stations.shape), len(response.damping)
    rate = -1j * numbers[:, None] * response.omega[0]
    one = np.broadcast_to(np.eye(n)[:nm], (numbers.size, nm, n))
    moved, _ = case.driven(numbers * response.omega[0], one, response.damping)
    others, steps = X, Steps(case.model.length)
    for _ in range(ROUNDS):
        of_drag = _harmonics(numbers, _drag(case, response, numbers, rate * X[:, :nm]))
        push = of_drag @ case.stations.shape.T + rate * X[:, :nm] @ response.damping[:nm, :nm]
        found = others + (push[:, None] @ moved)[:, 0]
        if np.abs(found - X)[:, :nm].max() <= AGREED * np.abs(found)[:, :nm].max():
            return found, of_drag
        X = steps.after(X, found)
    raise SimulationFailed(f"harmonics of drag do not agree with their own result after {ROUNDS} rounds")


def _lacks(case: Case, response: Response, numbers: np.ndarray, X: np.ndarray) -> Lacks:
    """What harmonics X (ne, n) change of the mean drag and that at one wave's own frequency, and so of the response."""
    nm, omega, support = len(case.stations.shape), response.omega, case.system.support
    rates, none = -1j * numbers[:, None] * omega * X[:, :nm], np.zeros((numbers.size, nm))
    changed = np.subtract(*(_drag(case, response, numbers, each) for each in (rates, none)))
    load = np.stack([changed.mean(axis=0), _harmonics(np.ones(1), changed)[0]])
    push = np.zeros((2, len(response.damping)), complex)
    push[:, :nm] = load @ case.stations.shape.T
    (first, Y), level = case.driven(omega, push[1:, None], response.damping), case.shift(push[0].real)
    moved = np.stack([level, first[0, 0]])
    if support is None or support.forces is None:
        return Lacks(moved[:, :nm], np.zeros((2, 0), complex))
    held = support.forces.of_motion(none[:1], none[:1], case.carried_by(level)[None])
    borne = np.concatenate([support.forces.whole(held), _borne(case, omega, Y, first[0])])
    return Lacks(moved[:, :nm], borne + support.forces.whole(load @ support.forces.drag))


def _drag(case: Case, response: Response, numbers: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """|u|u (PHASES, nd ns) [N] of the water past the stations of a frame that moves with one wave, and at so many
    times its frequency by modal rates (ne, nm)."""
    stations, frame = case.stations, case.system.structure
    flow = stations.flow((-1j * response.omega[:, None] * response.X[:, : frame.omega.size]).T).view(complex)
    swings = (np.exp(-1j * np.outer(gaussian.PHASE, numbers)) @ rates).real @ stations.shape
    u = (gaussian.one_period(flow.reshape(1, -1)) - swings).reshape(-1, *stations.on)
    if stations.stream is not None:
        u = u + stations.stream
    force = frame.drag * np.linalg.norm(u, axis=1, keepdims=True) * u
    return np.asarray(force.reshape(len(u), -1))


def _borne(case: Case, omega: np.ndarray, Y: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Of the frame (ne, ny) in these motions, their drag aside, where what radiates has impedance Y (ne, na, na)."""
    support, model, rate = case.system.support, case.model, -1j * omega[:, None]
    if support is None or support.forces is None:
        return np.zeros((omega.size, 0), complex)
    P, none = X[:, : model.modes.shape[1]], np.zeros((omega.size, len(model.active)))
    carried = model.carried(omega, X @ model.shape.T, Y, none)
    return support.forces.whole(support.forces.of_motion(rate * P, rate**2 * P, carried))
