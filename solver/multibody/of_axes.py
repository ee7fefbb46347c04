"""What the law is and does for all axes together: loads, bounds, and which axes have what."""

from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from solver.kernels import kernel, whole_lean_kernel
from solver.multibody.joint_law import (
    RELEASED,
    JointLaw,
    add_coupled,
    axis_energy,
    axis_load,
    coupled_energy,
    elastic,
    stop_load,
)
from solver.multibody.zones import pto_zone, stops_zone

DAMPERS = ("pto_damping", "damping", "quadratic_damping")  # linear or nearly, and nothing at rest
SIDE = 1e-5  # of differences by position [m or rad]


class JointLoads(NamedTuple):
    """AxisLoad of n axes at m samples, each part (m, n)."""

    pto: np.ndarray
    loss: np.ndarray
    spring: np.ndarray


def joint_loads(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> JointLoads:
    """Loads of all axes from positions and rates (m, n), in the zones where these lie: no power take-off has let go."""
    loads = JointLoads(*np.empty((3, *y.shape)))
    _fill(law, y, dy, loads)
    return loads


@whole_lean_kernel
def _fill(law: JointLaw, y: np.ndarray, dy: np.ndarray, loads: JointLoads) -> None:
    for s in range(y.shape[0]):
        for i in range(y.shape[1]):
            stops, zone = stops_zone(law, i, y[s, i], dy[s, i]), pto_zone(law, i, y[s, i], dy[s, i])
            load = axis_load(law, i, stops, zone, y[s, i], dy[s, i])
            left = elastic(law, i, stops, y[s, i]) if abs(stops) == RELEASED else 0.0
            loads.pto[s, i], loads.loss[s, i], loads.spring[s, i] = load.pto, load.loss - left, load.spring + left
        add_coupled(law, y[s], dy[s], 1.0, loads.spring[s], loads.loss[s])


def pto_loads(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> np.ndarray:
    """Load of the power take-offs against their axes (m, n), stiffness included; that by which one holds is not."""
    return joint_loads(law, y, dy).pto + law.pto_stiffness * y


def pto_stiffness_at_rest(law: JointLaw, y: np.ndarray) -> np.ndarray:
    """∂f_pto/∂y (n,) at rest at y (n,), between those to either side."""
    sides = pto_loads(law, y + SIDE * np.array([[-1.0], [1.0]]), np.zeros((2, y.size)))
    return np.diff(sides, axis=0)[0] / (2 * SIDE)


def pto_bounds(law: JointLaw) -> np.ndarray:
    """What the magnitude of a power take-off's load cannot exceed (n,), but for that by which one holds."""
    limit = np.minimum(law.force_limit, law.declutch_load)
    limit = np.where(law.pto_damping > 0, limit, np.minimum(limit, law.coulomb))
    loads = [law.tables.load[a:b] for a, b in pairwise(law.tables.first_load)]
    largest = [np.abs(load).max() if load.size else most for load, most in zip(loads, limit, strict=True)]
    return np.where(law.pto_stiffness == 0, largest, np.inf)


def borne_at_most(law: JointLaw) -> np.ndarray:
    """The same of what it bears, held or not (n,)."""
    return np.maximum(pto_bounds(law), law.latch_load)


def working_rates(law: JointLaw) -> np.ndarray:
    """The rate beyond which a power take-off has let go and does no work (n,); infinite where it never does."""
    lets_go = np.isfinite(law.declutch_load) & (law.pto_damping > 0)
    never = np.full(lets_go.size, np.inf)
    return np.divide(law.declutch_load - law.coulomb, law.pto_damping, out=never, where=lets_go)


@kernel
def stop_loads(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> np.ndarray:
    """f_stop of all axes (m, n) from positions and rates."""
    load = np.empty(y.shape)
    for s in range(y.shape[0]):
        for i in range(y.shape[1]):
            load[s, i] = stop_load(law, i, stops_zone(law, i, y[s, i], dy[s, i]), y[s, i], dy[s, i])
    return load


@kernel
def joint_energy(law: JointLaw, y: np.ndarray) -> float:
    """Energy stored in all axes at positions y (n,) [J]."""
    energy = coupled_energy(law, y)
    for i in range(y.size):
        energy += axis_energy(law, i, stops_zone(law, i, y[i], 0.0), y[i])
    return energy


def at_rest(law: JointLaw) -> JointLaw:
    """Without what only motion brings about: the loads at rest of all laws that differ in their damping alone."""
    still = np.zeros(law.damping.shape)
    return law._replace(pto_damping=still, damping=still, quadratic_damping=still)


def damped(law: JointLaw, more: Mapping[str, np.ndarray]) -> JointLaw:
    """The law with more of its DAMPERS, (n,) each."""
    return law._replace(**{name: getattr(law, name) + more[name] for name in DAMPERS})


def dampers(law: JointLaw) -> np.ndarray:
    """Of a linear model (n,): damping of the power take-offs and beside them."""
    return law.pto_damping + law.damping


def drag(law: JointLaw) -> np.ndarray:
    """Of a linear model (n,): what times |ẏ|ẏ is to be linearised."""
    return law.quadratic_damping


def absorbing(law: JointLaw) -> np.ndarray:
    """Which axes absorb power (n,)."""
    return (law.pto_damping > 0) | (law.coulomb > 0) | tabled(law)


def taking(law: JointLaw) -> np.ndarray:
    """Which axes have a power take-off, be it a spring alone (n,)."""
    return absorbing(law) | (law.pto_stiffness != 0)


def tabled(law: JointLaw) -> np.ndarray:
    """Which axes have a power take-off by a table (n,)."""
    return law.tables.first[1:] > law.tables.first[:-1]


def positioned(law: JointLaw) -> np.ndarray:
    """Which axes have a table that goes by position, too (n,)."""
    return law.tables.first_position[1:] > law.tables.first_position[:-1]


def stopped(law: JointLaw) -> np.ndarray:
    """Which axes have end stops (n,)."""
    return np.isfinite(law.end_stops.upper)


def turning(law: JointLaw) -> np.ndarray:
    """Which axes have a law that is another for each sense of motion, or a latch (n,)."""
    return holds(law) | (law.one_way != 0)


def holds(law: JointLaw) -> np.ndarray:
    """Which axes withstand loads at rest (n,)."""
    return (law.coulomb > 0) | latched(law)


def friction(law: JointLaw) -> np.ndarray:
    """By which power take-offs withstand loads at rest, latches aside (n,) [N or N m]."""
    return law.coulomb


def limits(law: JointLaw) -> np.ndarray:
    """Beyond which the load of a power take-off no longer rises (n,) [N or N m]; infinite where it always does."""
    return law.force_limit


def latched(law: JointLaw) -> np.ndarray:
    """Which axes have a latch (n,)."""
    return law.latch_load > 0


def declutched(law: JointLaw) -> np.ndarray:
    """Which axes have a power take-off that lets go (n,)."""
    return np.isfinite(law.declutch_load) & (law.pto_damping > 0)


def bent(law: JointLaw) -> np.ndarray:
    """Which axes have more than one zone (n,)."""
    limited = np.isfinite(np.minimum(law.force_limit, law.declutch_load)) & (law.pto_damping > 0)
    return stopped(law) | turning(law) | limited | tabled(law)


def latch_loads(law: JointLaw) -> np.ndarray:
    """Which latches hold against (n,) [N or N m]."""
    return law.latch_load


def room(law: JointLaw, y: np.ndarray) -> np.ndarray:
    """From positions y (n,) to the nearest end stop (n,) [m or rad]; infinite where there is none."""
    return np.minimum(law.end_stops.upper - y, y - law.end_stops.lower)


def stop_stiffness(law: JointLaw) -> np.ndarray:
    """Of the axes' end stops (n,) [N/m or N m/rad]."""
    return law.end_stops.stiffness


def stop_damping(law: JointLaw) -> np.ndarray:
    """Of the axes' end stops (n,) [N s/m or N m s/rad]: times the rate what a stop bears at first."""
    return law.end_stops.damping


def stop_rates(law: JointLaw, compliance: np.ndarray) -> np.ndarray:
    """How fast an axis of inertia 1/compliance swings on its stops (n,): (k_s/m)^½ + c_s/m [rad/s]."""
    return np.sqrt(law.end_stops.stiffness * compliance) + law.end_stops.damping * compliance
