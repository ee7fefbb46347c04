"""The one law of the joints: what power take-off, damping, springs and end stops do at an axis's position y and rate ẏ.

    f_pto = σ min(c_pto |ẏ| + F_c, F_max) sign ẏ,    f_loss = (c + d|ẏ|) ẏ,    f_spring = k y - F₀

against the axis [N or N m]; σ is the share that is left in a sense which the power take-off is not made for. Or f_pto
follows a table by rate, or by position and rate: straight between its points (bilinear) and level beyond them. An end
stop is a spring and a damper beyond its bound, δ deep, that do not pull:

    f_stop = max(0, k_s δ + c_s δ̇) = k_s δ (stored) + max(c_s δ̇, -k_s δ) (lost),    δ > 0

WEC-Sim's stops are these (Simscape's "damped rebound") but for the pull of their damper on a float that leaves fast.
Where a zone tells that the float has come free, what the spring still stores counts as lost at once.
Lines couple the axes of a float: axis i has Σ Kᵢⱼ yⱼ more of f_spring and Σ Cᵢⱼ ẏⱼ more of f_loss, j its other axes.
At rest F_c holds the axis against up to as much, and so does a latch, which once it gives way does nothing until the
axis comes to rest again. A power take-off that lets go beyond a load takes the axis again as it turns round. Powers
f_pto ẏ (absorbed) and f_loss ẏ leave the scene, that of f_spring is stored. Motion, powers, record, both formulations
and the linear model ask here.

The law is smooth but where an axis leaves a zone: it meets a stop or comes free of it, turns round under F_c or a
latch, or its power take-off reaches F_max, lets go, or comes to a line of its table. In a zone each formula goes on
beyond that; `leaving` tells where the zone ends.

A further kind of law of an axis is a field of JointLaw, called as the Float's, and its terms in `axis_load` and, if it
stores energy, `axis_energy`; if it bends, zones for it in `leaving` and what they call.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.special import erf

from solver.kernels import kernel, whole_lean_kernel
from solver.multibody.load_table import (
    Tables,
    beyond_piece,
    equivalent_damping,
    has_positions,
    has_table,
    next_piece,
    table_load,
    table_piece,
    table_slopes,
)

DAMPERS = ("pto_damping", "damping", "quadratic_damping")  # linear or nearly, and nothing at rest
FAR = 40.0  # standard deviations
SIDE = 1e-5  # of differences by position [m or rad]
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
    coulomb: np.ndarray  # (n,) load of the power take-off whatever the rate, against it
    force_limit: np.ndarray  # (n,) that the power take-off's load does not exceed
    declutch_load: np.ndarray  # (n,) of the power take-off, beyond which it lets go until the axis turns round
    latch_load: np.ndarray  # (n,) up to which an axis that has come to rest is held there
    one_way: np.ndarray  # (n,) by how much that load is less for motion in the negative sense; < 0: in the positive
    end_stops: EndStops
    couplings: Couplings
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


class JointLoads(NamedTuple):
    """AxisLoad of n axes at m samples, each part (m, n)."""

    pto: np.ndarray
    loss: np.ndarray
    spring: np.ndarray


@kernel(inline="always")
def axis_load(law: JointLaw, i: int, stops: int, pto: int, y: float, dy: float) -> AxisLoad:
    """AxisLoad of axis i at position y and rate dy, by the formulas of its zones `stops` and `pto`."""
    loss = (law.damping[i] + law.quadratic_damping[i] * abs(dy)) * dy
    spring = law.stiffness[i] * y - law.preload[i]
    if abs(stops) == PRESSED:
        spring += _elastic(law, i, stops, y)
        loss += law.end_stops.damping[i] * dy
    if pto == LINEAR:
        return AxisLoad(_slope(law, i) * dy, loss, spring)
    return AxisLoad(_kinked_load(law, i, pto, y, dy), loss, spring)


@kernel(inline="always")
def _elastic(law: JointLaw, i: int, side: int, y: float) -> float:
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
        return _share(law, i, sense) * sense * _largest(law, i)
    return _share(law, i, sense) * (law.pto_damping[i] * dy + sense * _constant(law, i))


@kernel(inline="always")
def beyond_law(law: JointLaw, i: int, pto: int, y: float, dy: float, withstood: float) -> float:
    """What the power take-off bears in its zone over f_pto(y, ẏ), by which joint_loads has it [N or N m].

    Held that is what it withstands, within what it can; where it turns round ẏ is rounding, or a little beyond it on a
    platform that rings, and says nothing of its sense. Of one that has let go LET_GO tells.
    """
    if abs(pto) == GONE:
        return 0.0
    if pto == HELD:
        borne = min(max(withstood, -holding(law, i, -1)), holding(law, i, 1))
    else:
        sense = 1.0 if pto > 0 else -1.0
        rate = sense * max(sense * dy, 0.0) if abs(pto) == SLIPS else dy
        borne = axis_load(law, i, OPEN, pto, y, rate).pto
    return borne - axis_load(law, i, OPEN, pto_zone(law, i, y, dy), y, dy).pto


@kernel(inline="always")
def _constant(law: JointLaw, i: int) -> float:
    return min(law.coulomb[i], _largest(law, i))


@kernel(inline="always")
def _largest(law: JointLaw, i: int) -> float:
    """F_max, or the load beyond which the power take-off lets go."""
    return min(law.force_limit[i], law.declutch_load[i])


@kernel(inline="always")
def holding(law: JointLaw, i: int, sense: int) -> float:
    """The largest load that an axis at rest withstands without moving in a sense, +1 or -1 [N or N m]."""
    return max(law.latch_load[i], _share(law, i, sense) * _constant(law, i))


@kernel(inline="always")
def _holds(law: JointLaw, i: int) -> bool:
    """Whether an axis withstands any load at rest."""
    return law.coulomb[i] > 0 or law.latch_load[i] > 0


@kernel(inline="always")
def jumps(law: JointLaw, i: int) -> bool:
    """Whether the load jumps where the power take-off leaves a zone: one that holds at rest, or lets go."""
    return holding(law, i, 1) > 0 or holding(law, i, -1) > 0 or law.declutch_load[i] < np.inf


@kernel(inline="always")
def _turns_at_rest(law: JointLaw, i: int) -> bool:
    """Whether the law is another for each sense of motion, or holds the axis between them."""
    return _holds(law, i) or law.one_way[i] != 0


@kernel(inline="always")
def _limiting_rate(law: JointLaw, i: int) -> float:
    """|ẏ| at which the power take-off reaches F_max, or lets go."""
    if not law.pto_damping[i] > 0:
        return np.inf
    return (_largest(law, i) - _constant(law, i)) / law.pto_damping[i]


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
def add_coupled(law: JointLaw, y: np.ndarray, dy: np.ndarray, load: np.ndarray) -> None:
    """What couplings put against the axes at positions y and rates dy (n,) is taken from their load (n,)."""
    row, column, stiffness, damping = law.couplings
    for e in range(row.size):
        load[row[e]] -= stiffness[e] * y[column[e]] + damping[e] * dy[column[e]]


@kernel(inline="always")
def coupled_loss(law: JointLaw, dy: np.ndarray) -> float:
    """Power that couplings take at rates dy (n,) [W]."""
    row, column, _, damping = law.couplings
    power = 0.0
    for e in range(row.size):
        power += dy[row[e]] * damping[e] * dy[column[e]]
    return power


@kernel(inline="always")
def add_coupled_damping(law: JointLaw, share: float, matrix: np.ndarray) -> None:
    """matrix (n, n) += a share of the couplings' damping, for Newton's matrix."""
    row, column, _, damping = law.couplings
    for e in range(row.size):
        matrix[row[e], column[e]] += share * damping[e]


@kernel(inline="always")
def coupled_energy(law: JointLaw, y: np.ndarray) -> float:
    """Energy stored in the couplings at positions y (n,) [J]: half of each entry's, for both of a pair are there."""
    row, column, stiffness, _ = law.couplings
    energy = 0.0
    for e in range(row.size):
        energy += 0.5 * stiffness[e] * y[row[e]] * y[column[e]]
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


@kernel(inline="always")
def stops_zone(law: JointLaw, i: int, y: float, dy: float) -> int:
    """The zone of the stops that y, dy lie in."""
    side = 1 if y > law.end_stops.upper[i] else -1
    depth = y - law.end_stops.upper[i] if side > 0 else law.end_stops.lower[i] - y
    if not depth > 0:
        return OPEN
    presses = law.end_stops.stiffness[i] * depth + law.end_stops.damping[i] * side * dy > 0
    return side * (PRESSED if presses else RELEASED)


@kernel(inline="always")
def pto_zone(law: JointLaw, i: int, y: float, dy: float) -> int:
    """The zone of the power take-off that y, dy lie in; HELD at rest where something holds there.

    One that has let go is not told from one at work.
    """
    if has_table(law.tables, i):
        return TABLE + table_piece(law.tables, i, y, dy)
    sense = 1 if dy > 0 else -1
    if abs(dy) > _limiting_rate(law, i):
        return sense * LIMITED
    if not _turns_at_rest(law, i):
        return LINEAR
    return HELD if dy == 0 and _holds(law, i) else sense * SLIPS


@kernel(inline="always")
def limited(law: JointLaw, i: int) -> bool:
    """Whether the power take-off of axis i has another law from some rate on."""
    return _limiting_rate(law, i) < np.inf


@kernel(inline="always")
def within_stops(law: JointLaw, i: int, low: float, high: float) -> bool:
    """Whether positions of axis i between these two are off its stops."""
    return law.end_stops.lower[i] < low and high < law.end_stops.upper[i]


@kernel(inline="always")
def off_stop(law: JointLaw, i: int, stops: int, y: float) -> bool:
    """Whether an axis that has come free of a stop is off it: then it may meet either one; no load changes."""
    if abs(stops) != RELEASED:
        return False
    return y < law.end_stops.upper[i] if stops > 0 else y > law.end_stops.lower[i]


@kernel(inline="always")
def leaving(law: JointLaw, i: int, kind: int, zone: int, y: float, dy: float) -> float:
    """> 0 where y, dy are beyond a zone of the stops or of the power take-off (kind); for HELD see `holding`."""
    if kind == STOP_ZONE:
        if zone == OPEN:
            return max(y - law.end_stops.upper[i], law.end_stops.lower[i] - y)
        side = 1 if zone > 0 else -1
        depth = y - law.end_stops.upper[i] if side > 0 else law.end_stops.lower[i] - y
        press = law.end_stops.stiffness[i] * depth + law.end_stops.damping[i] * side * dy
        return -press if zone * side == PRESSED else min(depth, press)
    if zone == HELD:
        return -1.0
    if zone >= TABLE:
        return beyond_piece(law.tables, i, zone - TABLE, y, dy)
    rate = _limiting_rate(law, i)
    if zone == LINEAR:
        return abs(dy) - rate
    sense = 1 if zone > 0 else -1
    if zone * sense == LIMITED:
        return rate - sense * dy
    if zone * sense == GONE:
        return -sense * dy
    return max(-sense * dy, sense * dy - rate)


@kernel(inline="always")
def _turned(law: JointLaw, i: int, zone: int) -> int:
    """The zone of an axis that was in another, with its sign, and has turned round."""
    if _holds(law, i):
        return HELD
    return -SLIPS if zone > 0 else SLIPS


@kernel(inline="always")
def next_zone(law: JointLaw, i: int, kind: int, zone: int, y: float, dy: float) -> int:
    """The zone behind the border of another at y, dy."""
    if kind == STOP_ZONE:
        if zone == OPEN:
            return PRESSED if y - law.end_stops.upper[i] > law.end_stops.lower[i] - y else -PRESSED
        side = 1 if zone > 0 else -1
        return side * (RELEASED if zone * side == PRESSED else PRESSED)
    if zone >= TABLE:
        return TABLE + next_piece(law.tables, i, zone - TABLE, y, dy)
    sense = 1 if dy > 0 else -1
    reached = sense * (GONE if law.declutch_load[i] < np.inf else LIMITED)
    if zone == LINEAR:
        return reached
    if abs(zone) == GONE:
        return _turned(law, i, zone) if _turns_at_rest(law, i) else LINEAR
    if abs(zone) == LIMITED:
        return (1 if zone > 0 else -1) * SLIPS if _turns_at_rest(law, i) else LINEAR
    rate = _limiting_rate(law, i)
    return _turned(law, i, zone) if abs(dy) < 0.5 * rate else reached


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
            left = _elastic(law, i, stops, y[s, i]) if abs(stops) == RELEASED else 0.0
            loads.pto[s, i], loads.loss[s, i], loads.spring[s, i] = load.pto, load.loss - left, load.spring + left
        row, column, stiffness, damping = law.couplings
        for e in range(row.size):
            loads.spring[s, row[e]] += stiffness[e] * y[s, column[e]]
            loads.loss[s, row[e]] += damping[e] * dy[s, column[e]]


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


@kernel
def zones_at_rest(law: JointLaw, y: np.ndarray, zones: np.ndarray) -> None:
    """zones (2, n) in which small motions about rest at y (n,) are linear.

    A table by rate alone bends at rest and has no load there; one by position, too, may have.
    """
    for i in range(y.size):
        zones[STOP_ZONE, i], zones[PTO_ZONE, i] = stops_zone(law, i, y[i], 0.0), LINEAR
        if has_positions(law.tables, i):
            zones[PTO_ZONE, i] = pto_zone(law, i, y[i], 0.0)


def damping_of_gaussian(law: JointLaw, std: np.ndarray) -> np.ndarray:
    """⟨f_pto ẏ⟩/⟨ẏ²⟩ (n,) of Gaussian rates with std (n,): the linear damping that takes as much power.

    With a = (F_max - F_c)/c_pto and x = a/σ: c (erf(x/√2) - √(2/π) x exp(-x²/2)) for what is linear, and
    √(2/π)/σ times F_c (1 - exp(-x²/2)) + F_max exp(-x²/2). At σ = 0 that of the linear part alone. Of tables the mean
    slope.
    """
    x, rate, constant = _reached(law, std)
    beyond = np.exp(-0.5 * x**2)
    with_limit = np.sqrt(2 / np.pi) * (constant * (1 - beyond) + _limit(law, beyond)) / rate
    linear = law.pto_damping * (erf(x / np.sqrt(2)) - np.sqrt(2 / np.pi) * np.minimum(x, FAR) * beyond)
    whole = np.where(std > 0, linear + with_limit, law.pto_damping)
    return whole + equivalent_damping(law.tables, std, lambda x: 0.5 * erf(x / np.sqrt(2)))


def damping_at_rest(law: JointLaw) -> np.ndarray:
    """The same (n,) of rates that are next to nothing."""
    return law.pto_damping + law.tables.slope


def damping_of_harmonic(law: JointLaw, amplitude: np.ndarray) -> np.ndarray:
    """The same (n,) of a rate V sin θ, V (n,): its describing function, with sin θ₁ = a/V where the limit is reached.

    (4/π) [c (θ₁/2 - sin 2θ₁/4) + (F_c (1 - cos θ₁) + F_max cos θ₁)/V]
    """
    x, rate, constant = _reached(law, amplitude)
    at = np.arcsin(np.minimum(1.0, x))
    beyond = np.where(x < 1, np.cos(at), 0.0)
    linear = law.pto_damping * (at / 2 - np.sin(2 * at) / 4)
    total = 4 / np.pi * (linear + (constant * (1 - beyond) + _limit(law, beyond)) / rate)
    whole = np.where(amplitude > 0, total, law.pto_damping)
    return whole + equivalent_damping(law.tables, amplitude, _share_of_harmonic)


def _share_of_harmonic(x: np.ndarray) -> np.ndarray:
    """∫ 2 cos²θ dθ/2π of the phases at which sin θ is below x, from those of the mean."""
    at = np.arcsin(np.clip(x, -1, 1))
    return 2 / np.pi * (at / 2 + np.sin(2 * at) / 4)


def _reached(law: JointLaw, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of n axes: rate at which F_max is reached over a rate, that rate or 1 where it is zero, and F_c."""
    some = np.where(rate > 0, rate, 1.0)
    limiting = np.divide(
        law.force_limit - law.coulomb, law.pto_damping, out=np.full(rate.shape, np.inf), where=law.pto_damping > 0
    )
    return limiting / some, some, law.coulomb


def _limit(law: JointLaw, share: np.ndarray) -> np.ndarray:
    """F_max times a share, which is zero where there is no limit."""
    return np.where(np.isfinite(law.force_limit), law.force_limit, 0.0) * share


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


def stopped(law: JointLaw) -> np.ndarray:
    """Which axes have end stops (n,)."""
    return np.isfinite(law.end_stops.upper)


def turning(law: JointLaw) -> np.ndarray:
    """Which axes have a law that is another for each sense of motion, or a latch (n,)."""
    return holds(law) | (law.one_way != 0)


def holds(law: JointLaw) -> np.ndarray:
    """Which axes withstand loads at rest (n,)."""
    return (law.coulomb > 0) | latched(law)


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


def stop_rates(law: JointLaw, compliance: np.ndarray) -> np.ndarray:
    """How fast an axis of inertia 1/compliance swings on its stops (n,): (k_s/m)^½ + c_s/m [rad/s]."""
    return np.sqrt(law.end_stops.stiffness * compliance) + law.end_stops.damping * compliance
