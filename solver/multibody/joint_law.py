"""The one law of the joints: what power take-off, damping, springs and end stops do at an axis's position y and rate ẏ.

    f_pto = σ min(c_pto |ẏ| + F_c, F_max) sign ẏ,    f_loss = (c + d|ẏ|) ẏ,    f_spring = k y - F₀

against the axis [N or N m]; σ is the share that is left in a sense which the power take-off is not made for. Or f_pto
follows a table by rate, or by position and rate: straight between its points (bilinear) and level beyond them. An end
stop is a spring and a damper beyond its bound, δ deep, that do not pull:

    f_stop = max(0, k_s δ + c_s δ̇) = k_s δ (stored) + max(c_s δ̇, -k_s δ) (lost),    δ > 0

WEC-Sim's stops are these (Simscape's "damped rebound") but for the pull of their damper on a float that leaves fast.
Where a zone tells that the float has come free, what the spring still stores counts as lost at once.
Lines couple the axes of a float: axis i has Σ Kᵢⱼ yⱼ more of f_spring and Σ Cᵢⱼ ẏⱼ more of f_loss, j its other axes;
those at a point of it what `moored` says.
At rest F_c holds the axis against up to as much, and so does a latch, which once it gives way does nothing until the
axis comes to rest again. A power take-off that lets go beyond a load takes the axis again as it turns round. Powers
f_pto ẏ (absorbed) and f_loss ẏ leave the scene, that of f_spring is stored. Motion, powers, record, both formulations
and the linear model ask here.

The law is smooth but where an axis leaves a zone: it meets a stop or comes free of it, turns round under F_c or a
latch, or its power take-off reaches F_max, lets go, or comes to a line of its table. In a zone each formula goes on
beyond that; `zones` tells where the zone ends.

A further kind of law of an axis is a field of JointLaw, called as the Float's, and its terms in `axis_load`,
`axis_damping` and, if it stores energy, `axis_energy`; if it bends, zones for it in `zones` and slopes in `tangent`.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import kernel
from solver.multibody.load_table import Tables, table_load, table_slopes
from solver.multibody.moored import Moorings, add_moored, add_moored_damping, moored_energy, moored_loss

OPEN, PRESSED, RELEASED = 0, 1, 2  # zones of the stops; + at the upper one, - at the lower one
LINEAR, SLIPS, LIMITED, HELD = 0, 1, 2, 3  # of the power take-off; SLIPS and LIMITED with the sign of the rate
GONE = 4  # the power take-off has let go, with the sign of the rate
TABLE = 5  # and from there on the pieces of a table, by rate: below its first, between that and the next, ...
STOP_ZONE, PTO_ZONE = 0, 1  # rows of zones (2, n)


class EndStops(NamedTuple):
    """Of n axes; infinite bounds where there are none."""

    lower: np.ndarray  # (n,) [m or rad]
    upper: np.ndarray  # (n,)
    stiffness: np.ndarray  # (n,) [N/m or N m/rad]
    damping: np.ndarray  # (n,) [N s/m or N m s/rad]


class Couplings(NamedTuple):
    """Of lines that couple axes: the e entries off the diagonals of the floats' matrices, both of each pair."""

    row: np.ndarray  # (e,) i
    column: np.ndarray  # (e,) j
    stiffness: np.ndarray  # (e,) [N/m, N/rad or N m/rad]
    damping: np.ndarray  # (e,) [N s/m, N s/rad or N m s/rad]


class JointLaw(NamedTuple):
    """Numbers of n axes: [N s/m], [N s²/m²] and [N/m] of those that slide, [N m s/rad] ... of those that turn."""

    pto_damping: np.ndarray  # (n,) linear damping that is absorbed power
    damping: np.ndarray  # (n,) other linear damping
    quadratic_damping: np.ndarray  # (n,) quadratic damping
    stiffness: np.ndarray  # (n,) linear spring about y = 0
    pto_stiffness: np.ndarray  # (n,) the power take-off's part of it
    preload: np.ndarray  # (n,) constant load in the axis's positive sense
    coulomb: np.ndarray  # (n,) load of the power take-off whatever the rate, against it; below both limits
    force_limit: np.ndarray  # (n,) that the power take-off's load does not exceed
    declutch_load: np.ndarray  # (n,) of the power take-off, beyond which it lets go until the axis turns round
    latch_load: np.ndarray  # (n,) up to which an axis that has come to rest is held there
    one_way: np.ndarray  # (n,) by how much that load is less for motion in the negative sense; < 0: in the positive
    end_stops: EndStops
    couplings: Couplings
    moorings: Moorings
    tables: Tables


def end_stops(lower: np.ndarray, upper: np.ndarray, stiffness: np.ndarray, damping: np.ndarray) -> EndStops:
    """Those of n axes; what has neither stiffness nor damping has no stops."""
    some = (stiffness > 0) | (damping > 0)
    return EndStops(np.where(some, lower, -np.inf), np.where(some, upper, np.inf), stiffness, damping)


class AxisLoad(NamedTuple):
    """Against the axis's positive sense [N or N m], by where its power goes: absorbed, lost, stored."""

    pto: float
    loss: float
    spring: float


@kernel(inline="always")
def axis_load(law: JointLaw, i: int, stops: int, pto: int, y: float, dy: float) -> AxisLoad:
    """AxisLoad of axis i at position y and rate dy, by the formulas of its zones `stops` and `pto`."""
    loss = (law.damping[i] + law.quadratic_damping[i] * abs(dy)) * dy
    spring = law.stiffness[i] * y - law.preload[i]
    if abs(stops) == PRESSED:
        spring += elastic(law, i, stops, y)
        loss += law.end_stops.damping[i] * dy
    if pto == LINEAR:
        return AxisLoad(_slope(law, i) * dy, loss, spring)
    return AxisLoad(_kinked_load(law, i, pto, y, dy), loss, spring)


@kernel(inline="always")
def elastic(law: JointLaw, i: int, side: int, y: float) -> float:
    """k_s δ against the positive sense, of the upper stop (side > 0) or the lower one."""
    return law.end_stops.stiffness[i] * (y - (law.end_stops.upper[i] if side > 0 else law.end_stops.lower[i]))


@kernel(inline="always")
def _slope(law: JointLaw, i: int) -> float:
    """∂f_pto/∂ẏ at rest, without F_c: between those of the two senses."""
    return law.pto_damping[i] * (1 - 0.5 * abs(law.one_way[i])) + law.tables.slope[i]


@kernel(inline="always")
def _share(law: JointLaw, i: int, sense: int) -> float:
    """σ of motion in a sense, +1 or -1."""
    return 1 - max(0.0, -sense * law.one_way[i])


@kernel(inline="always")
def _kinked_load(law: JointLaw, i: int, pto: int, y: float, dy: float) -> float:
    """f_pto in a zone other than LINEAR; what holds an axis does no work and is found by the motion."""
    if pto >= TABLE:
        return table_load(law.tables, i, pto - TABLE, y, dy)
    if pto == HELD or abs(pto) == GONE:
        return 0.0
    sense = 1 if pto > 0 else -1
    if pto * sense == LIMITED:
        return _share(law, i, sense) * sense * largest(law, i)
    return _share(law, i, sense) * (law.pto_damping[i] * dy + sense * law.coulomb[i])


@kernel(inline="always")
def largest(law: JointLaw, i: int) -> float:
    """F_max, or the load beyond which the power take-off lets go."""
    return min(law.force_limit[i], law.declutch_load[i])


@kernel(inline="always")
def holding(law: JointLaw, i: int, sense: int) -> float:
    """The largest load that an axis at rest withstands without moving in a sense, +1 or -1 [N or N m]."""
    return max(law.latch_load[i], _share(law, i, sense) * law.coulomb[i])


@kernel(inline="always")
def jumps(law: JointLaw, i: int) -> bool:
    """Whether the load jumps where the power take-off leaves a zone: one that holds at rest, or lets go."""
    return holding(law, i, 1) > 0 or holding(law, i, -1) > 0 or law.declutch_load[i] < np.inf


@kernel(inline="always")
def axis_energy(law: JointLaw, i: int, stops: int, y: float) -> float:
    """Energy stored in axis i at position y [J], by the formula of its zone `stops`."""
    stored = 0.5 * law.stiffness[i] * y * y - law.preload[i] * y
    return stored + (stop_energy(law, i, stops, y) if abs(stops) == PRESSED else 0.0)


@kernel(inline="always")
def stop_energy(law: JointLaw, i: int, side: int, y: float) -> float:
    """½k_s δ² [J] of the upper stop (side > 0) or the lower one."""
    depth = y - (law.end_stops.upper[i] if side > 0 else law.end_stops.lower[i])
    return 0.5 * law.end_stops.stiffness[i] * depth * depth


@kernel(inline="always")
def add_coupled(
    law: JointLaw, y: np.ndarray, dy: np.ndarray, share: float, spring: np.ndarray, loss: np.ndarray
) -> None:
    """spring, loss (n,) += a share of what couplings and moorings put against the axes at y and dy (n,)."""
    row, column, stiffness, damping = law.couplings
    for e in range(row.size):
        spring[row[e]] += share * stiffness[e] * y[column[e]]
        loss[row[e]] += share * damping[e] * dy[column[e]]
    if law.moorings.axes.size > 0:
        add_moored(law.moorings, y, dy, share, spring, loss)


@kernel(inline="always")
def coupled_loss(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> float:
    """Power that couplings and moorings take at positions y and rates dy (n,) [W]."""
    row, column, _, damping = law.couplings
    power = 0.0
    for e in range(row.size):
        power += dy[row[e]] * damping[e] * dy[column[e]]
    if law.moorings.axes.size > 0:
        power += moored_loss(law.moorings, y, dy)
    return power


@kernel(inline="always")
def add_coupled_damping(law: JointLaw, share: float, matrix: np.ndarray) -> None:
    """matrix (n, n) += a share of the couplings' and, at rest, the moorings' damping, for Newton's matrix."""
    row, column, _, damping = law.couplings
    for e in range(row.size):
        matrix[row[e], column[e]] += share * damping[e]
    if law.moorings.axes.size > 0:
        add_moored_damping(law.moorings, share, matrix)


@kernel(inline="always")
def coupled_energy(law: JointLaw, y: np.ndarray) -> float:
    """Energy stored in couplings and moorings at positions y (n,) [J].

    Half of each coupling's, for both of a pair are there.
    """
    row, column, stiffness, _ = law.couplings
    energy = 0.0
    for e in range(row.size):
        energy += 0.5 * stiffness[e] * y[row[e]] * y[column[e]]
    if law.moorings.axes.size > 0:
        energy += moored_energy(law.moorings, y)
    return energy


@kernel(inline="always")
def axis_damping(law: JointLaw, i: int) -> float:
    """∂f/∂ẏ of axis i at rest, off its stops, for Newton's matrix."""
    return _slope(law, i) + law.damping[i]


@kernel(inline="always")
def tangent(law: JointLaw, i: int, stops: int, pto: int) -> tuple[float, float]:
    """∂f/∂y, and ∂f/∂ẏ less `axis_damping`, of stops and power take-off in their zones."""
    stiffness = damping = 0.0
    if abs(stops) == PRESSED:
        stiffness, damping = law.end_stops.stiffness[i], law.end_stops.damping[i]
    if pto >= TABLE:
        slopes = table_slopes(law.tables, i, pto - TABLE)
        stiffness += slopes[0]
        damping += slopes[1] - _slope(law, i)
    elif abs(pto) == SLIPS:
        damping += _share(law, i, pto) * law.pto_damping[i] - _slope(law, i)
    elif pto != LINEAR:
        damping -= _slope(law, i)
    return stiffness, damping


@kernel(inline="always")
def stop_load(law: JointLaw, i: int, stops: int, y: float, dy: float) -> float:
    """f_stop [N or N m]; zero where the axis does not press on a stop."""
    if abs(stops) != PRESSED:
        return 0.0
    depth = y - law.end_stops.upper[i] if stops > 0 else law.end_stops.lower[i] - y
    return max(0.0, law.end_stops.stiffness[i] * depth + law.end_stops.damping[i] * stops * dy)
