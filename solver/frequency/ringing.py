"""What linear damping leaves of loads that bend: lines that no wave makes, of joints' forces and an elastic platform.

And, in one wave, the harmonics of the members' drag; in a sea these are lines of the case (see beyond).

Loads that jump or are cut off, or go with the rate's square, have parts above the waves' frequencies, too, by which
frames swing on their own: see left. That goes with no rate in the mean, and so adds to the waves' variance. Of one wave
it is the harmonics of f.
"""

import numpy as np

from solver.frequency import gaussian, left
from solver.frequency.bent import Load, rate_load
from solver.frequency.case import Case
from solver.frequency.outputs import Forces, Rung, rate_lines
from solver.frequency.response import Response
from solver.frequency.shape import warped
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import drag

FASTEST = 40.0  # times the fastest wave's frequency, up to which modes are looked at
LITTLE = 0.1  # of the largest std of its kind: less is not looked at
HARMONICS = np.arange(3, gaussian.PHASES // 4, 2)
BY_DRAG = np.arange(2, 13)  # in a current even ones, too; of those above accelerations have a hundredth


def rung(case: Case, law: JointLaw, response: Response, frame: Forces) -> Rung:
    """What a response moves a platform by, and the frame's and the joints' forces, with such lines where loads bend."""
    (nc, nm), of, model, support = case.system.structure.carrier.shape, case.process, case.model, case.system.support
    channels, rates, one = case.channels, rate_lines(case, response), case.omega.size == 1
    waves = Rung(of, response.X[:, :nm], frame, channels.hinge_force(response.wrench))
    axes = np.flatnonzero((response.bends | (drag(law)[nc:] > 0)) & ~response.stuck & rates.any(axis=0))
    dragged = one and case.stations.size > 0
    if not (axes.size or dragged):
        return waves
    load, moved = rate_load(law, nc + axes), rates[:, axes]
    if one:
        numbers = np.union1d(HARMONICS if axes.size else BY_DRAG, BY_DRAG if dragged else HARMONICS)
        omega, force = numbers * of.omega[0], _harmonics(numbers, load(gaussian.one_period(moved)))
        process = gaussian.Process(np.append(of.omega, omega), 2 * np.pi / of.omega[0], begin=0.0)
    else:
        omega, force = left.lines(case, load, moved, response.damping, FASTEST)
        process = gaussian.Process(np.append(of.omega, omega), of.duration, of.others + omega.size, of.begin)
    pushed = np.zeros((len(omega), len(model.mass)), complex)
    pushed[:, nm + axes] = -force
    borne = np.zeros((len(omega), frame.lines.shape[1]), complex)
    if dragged and support is not None:
        of_drag = _harmonics(numbers, _drag(case, response))
        pushed[:, :nm] = of_drag @ case.stations.shape.T
        borne = support.forces.whole(of_drag @ support.forces.drag) if support.forces is not None else borne
    X, Y = case.driven(omega, pushed, response.damping)
    joints = channels.hinge_force(model.loads(omega, X, Y, np.zeros((1, 1, 1))))
    every = Rung(
        process,
        np.concatenate([waves.X, X[:, :nm]]),
        frame._replace(lines=np.concatenate([frame.lines, borne + _borne(case, omega, Y, X)])),
        np.concatenate([waves.joints, joints]),
    )
    if one:
        return every
    loads = np.concatenate([moved * np.diag(response.damping)[nm + axes], force])
    extremes, rings = _beside_gaussian(case, load, moved, response.excess[0, axes], loads, every.frame.lines)
    return every._replace(extremes=extremes, rings=rings)


def _beside_gaussian(
    case: Case, load: Load, rates: np.ndarray, excess: np.ndarray, loads: np.ndarray, frame: np.ndarray
) -> tuple[float, float]:
    """Largest ones to be expected of steel over those of Gaussian lines (nl, ny), and the share that rings.

    Where loads' largest are r of those, (1 + s² (r² - 1))^½ of what goes with them by a correlation s; not less than 1:
    what rings comes in bursts, and makes up for what loads that are cut off have less.
    loads (nl, nj): their lines, by rates with an excess of kurtosis (nj,).
    """
    steel, largest, rings, of = case.channels.steel, 1.0, 0.0, case.process
    fastest = gaussian.spread(rates) * warped(gaussian.peak(rates, of), excess)
    told = gaussian.spread(loads) * gaussian.peak(loads[: of.omega.size], of)
    more = (load(fastest[None])[0] / told) ** 2 - 1
    for _, lines in steel.channels(frame) if steel is not None else ():
        every = lines.reshape(len(lines), -1)
        size = gaussian.spread(every)
        y = every[:, size > LITTLE * size.max(initial=0.0)]
        s = gaussian.covariance(y, loads) / np.outer(gaussian.spread(y), gaussian.spread(loads))
        largest = float(np.max(np.sqrt(1 + s**2 * more), initial=largest))
        rings = max(rings, gaussian.share(y, slice(of.omega.size, None)))
    return largest, rings


def _harmonics(numbers: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Lines (ne, n) at so many times a wave's frequency of loads over its period (PHASES, n)."""
    return np.exp(1j * np.outer(numbers, gaussian.PHASE)) * (2 / gaussian.PHASES) @ load


def _drag(case: Case, response: Response) -> np.ndarray:
    """|u|u (PHASES, nd ns) [N] of the water past the stations of a frame that moves with one wave."""
    stations, frame = case.stations, case.system.structure
    flow = stations.flow((-1j * response.omega[:, None] * response.X[:, : frame.omega.size]).T).view(complex)
    u = gaussian.one_period(flow.reshape(1, -1)).reshape(-1, *stations.on)
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
