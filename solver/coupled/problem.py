"""What a march is given, what it works in, and what it puts out."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from solver.coupled.energy import WORKS
from solver.coupled.memory import Memory
from solver.coupled.modal import Structure, answer, flexibility
from solver.coupled.newton import Newton, constant_part, new_newton
from solver.coupled.scheme import LOBATTO, Scheme
from solver.coupled.stages import Stages, Start, new_stages
from solver.multibody.bodies import Bodies, PressureRoom, pressure_room

# Pressure and drag are evaluated again where a stage has moved by so many tolerances since; nearer than that
# the hydrostatic stiffness stands for the change, and what is left of it, (dt ω)²/5, is below the tolerance. Of floats
# without coefficients nothing stands for it. A piece of a step, whose tolerance goes by its length, may be farther by
# as much as it is shorter.
NEAR = 25.0
LEAST = 1e-13  # of Newton's tolerances [m or rad]

OK, NOT_CONVERGED, EXCURSION, NOT_FINITE, UNBALANCED, TO_AND_FRO = range(6)
# Of end stops: number of hits, largest rate at one [m/s or rad/s], largest load [N or N m].
CONTACT = ("end_stop_hits", "impact_rate", "end_stop_load")
HITS, RATE, LOAD = range(len(CONTACT))
# And of an axis that is held, the share of the time; at the sample whether its power take-off has let go, and the load
# that it bears beyond what its position and rate tell: see zones.beyond_law.
HOLDS, LET_GO, BEYOND = range(len(CONTACT), len(CONTACT) + 3)
UNCUT, UNTOLD = -1.0, -2.0  # of a step that is cut, where there is no room for its pieces
PIECES = 4  # of steps that are cut for which there is room, over samples


class Drive(NamedTuple):
    """Samples of all that the wave drives; first axis time, samples dt/2 apart."""

    field: np.ndarray  # (m, 2 first_term[-1] + (nr + 1) first_along[-1]), see minimal.pressures
    excitation: np.ndarray  # (m, nb, 6)
    modal: np.ndarray  # (m, nm)
    station: np.ndarray  # (m, nd, ns) particle velocity normal to the members
    wet: np.ndarray  # (m, ns) and push (m, nd, ns), see modal.WaterAbout
    push: np.ndarray


class Between(NamedTuple):
    """Middles and ends of the pieces of steps that are cut, and starts where loads may jump, in their order."""

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
    slight: float  # [m] a mode may move until drag, which answers with less than the tolerance, is evaluated again
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
    resistance: np.ndarray,
    dt: float,
    tolerance: float,
    iterations: int,
) -> Problem:
    """Constants for steps of dt [s]; stiffness (nz, nz) of the floats at rest, for Newton's matrix alone; resistance
    (ns, nd, nd) of the drag's stations [N s/m], to tell how much drag answers."""
    nz = bodies.mechanism.size
    inverse, H = flexibility(structure, dt)
    answered = answer(structure, resistance, inverse, dt)
    constant = np.empty((2 * nz, 2 * nz))
    constant_part(bodies, memory, stiffness, dt, constant)
    fixed = (stiffness, np.array(beta, complex), bent, pace, swing)  # read-only poles would be another type to compile
    of_newton = (dt, tolerance, NEAR * tolerance, tolerance / answered if answered > 0 else np.inf, iterations)
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
    rows = room + 1 if contact.shape[1] else 0  # the last one is scratch
    arrays: list[Any] = [np.empty((rows, *part.shape[1:])) for part in (*parts, contact)]
    arrays += [np.empty(rows), np.empty(rows), np.empty(rows, np.int64), np.zeros(1, np.int64)]
    between = Between(*arrays)
    given: list[Any] = [*parts, contact, struck, np.full(len(contact), UNCUT), between]
    return Output(*given)
