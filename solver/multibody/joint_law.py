"""The one law of the joints: what power take-off, damping, springs and end stops do at an axis's position y and rate ẏ.

    f_pto = σ min(c_pto |ẏ| + F_c, F_max) sign ẏ,    f_loss = (c + d|ẏ|) ẏ,    f_spring = k y - F₀

against the axis [N or N m]; σ is the share that is left in a sense which the power take-off is not made for. Or f_pto
follows a table by rate, straight between its points and level beyond them. An end stop is a spring and a damper
beyond its bound, δ deep, that do not pull:

    f_stop = max(0, k_s δ + c_s δ̇) = k_s δ (stored) + max(c_s δ̇, -k_s δ) (lost),    δ > 0

WEC-Sim's stops are these (Simscape's "damped rebound") but for the pull of their damper on a float that leaves fast.
Lines couple the axes of a float: axis i has Σ Kᵢⱼ yⱼ more of f_spring and Σ Cᵢⱼ ẏⱼ more of f_loss, j its other axes.
At rest F_c holds the axis against up to as much. Powers f_pto ẏ (absorbed) and f_loss ẏ leave the scene, that of
f_spring is stored. Motion, powers, record, both formulations and the linear model ask here.

The law is smooth but where an axis leaves a zone: it meets a stop or comes free of it, turns round under F_c, or its
power take-off reaches F_max or a point of its table. In a zone each formula goes on beyond that; `leaving` tells where
the zone ends.

A further kind of law of an axis is a field of JointLaw, called as the Float's, and its terms in `axis_load` and, if it
stores energy, `axis_energy`; if it bends, zones for it in `leaving` and what they call.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.special import erf

from solver.kernels import kernel

FAR = 40.0  # standard deviations
OPEN, PRESSED, RELEASED = 0, 1, 2  # zones of the stops; + at the upper one, - at the lower one
LINEAR, SLIPS, LIMITED, HELD = 0, 1, 2, 3  # of the power take-off; SLIPS and LIMITED with the sign of the rate
TABLE = 4  # and from there on the pieces of a table: below its first point, between that and the next, ...
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


class Tables(NamedTuple):
    """Load of the power take-offs by rate, of those that have a table; t points of all axes, one axis after another."""

    first: np.ndarray  # (n + 1,) of each axis's points, and t
    rate: np.ndarray  # (t,) [m/s or rad/s], increasing along an axis
    load: np.ndarray  # (t,) against the axis [N or N m]
    slope: np.ndarray  # (n,) ∂f_pto/∂ẏ at rest, between those of the two senses; 0 without a table


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
    one_way: np.ndarray  # (n,) by how much that load is less for motion in the negative sense; < 0: in the positive
    end_stops: EndStops
    couplings: Couplings
    tables: Tables


def tables(points: Sequence[tuple[np.ndarray, np.ndarray]]) -> Tables:
    """Of n axes from the rates and loads of each, none where it has no table."""
    ends = np.cumsum([0, *(rate.size for rate, _ in points)])
    rate, load = (np.concatenate([np.zeros(0), *(p[k] for p in points)]) for k in range(2))
    return Tables(ends, rate, load, np.array([_slope_at_rest(*p) for p in points]))


def _slope_at_rest(rate: np.ndarray, load: np.ndarray) -> float:
    step = 0.5 * np.diff(rate).min(initial=np.inf)
    return float(np.diff(np.interp([-step, step], rate, load))[0] / (2 * step)) if rate.size else 0.0


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
    if stops != OPEN:
        side = 1 if stops > 0 else -1
        bound = law.end_stops.upper[i] if stops > 0 else law.end_stops.lower[i]
        elastic = law.end_stops.stiffness[i] * (y - bound)
        spring += elastic
        loss += law.end_stops.damping[i] * dy if stops * side == PRESSED else -elastic
    if pto == LINEAR:
        return AxisLoad(_slope(law, i) * dy, loss, spring)
    return AxisLoad(_kinked_load(law, i, pto, dy), loss, spring)


@kernel(inline="always")
def _slope(law: JointLaw, i: int) -> float:
    """∂f_pto/∂ẏ at rest, without F_c: between those of the two senses."""
    return law.pto_damping[i] * (1 - 0.5 * abs(law.one_way[i])) + law.tables.slope[i]


@kernel(inline="always")
def _share(law: JointLaw, i: int, sense: int) -> float:
    """σ of motion in a sense, +1 or -1."""
    return 1 - max(0.0, -sense * law.one_way[i])


@kernel(inline="always")
def _kinked_load(law: JointLaw, i: int, pto: int, dy: float) -> float:
    """f_pto in a zone other than LINEAR; what holds an axis does no work and is found by the motion."""
    if pto == HELD:
        return 0.0
    if pto >= TABLE:
        return _table_load(law, i, pto - TABLE, dy)
    sense = 1 if pto > 0 else -1
    if pto * sense == LIMITED:
        return _share(law, i, sense) * sense * law.force_limit[i]
    return _share(law, i, sense) * (law.pto_damping[i] * dy + sense * _constant(law, i))


@kernel(inline="always")
def _table_slope(law: JointLaw, i: int, piece: int) -> float:
    """∂f_pto/∂ẏ on a piece of axis i's table; 0 beyond its ends."""
    after = law.tables.first[i] + piece
    if piece == 0 or after == law.tables.first[i + 1]:
        return 0.0
    rate, load = law.tables.rate, law.tables.load
    return (load[after] - load[after - 1]) / (rate[after] - rate[after - 1])


@kernel(inline="always")
def _table_load(law: JointLaw, i: int, piece: int, dy: float) -> float:
    """f_pto by the formula of a piece of axis i's table."""
    at = law.tables.first[i] + max(piece - 1, 0)
    return law.tables.load[at] + _table_slope(law, i, piece) * (dy - law.tables.rate[at])


@kernel(inline="always")
def _table_piece(law: JointLaw, i: int, dy: float) -> int:
    """The piece of axis i's table that dy lies in."""
    first, after = law.tables.first[i], law.tables.first[i]
    while after < law.tables.first[i + 1] and dy > law.tables.rate[after]:
        after += 1
    return after - first


@kernel(inline="always")
def _beyond_piece(law: JointLaw, i: int, piece: int, dy: float) -> tuple[float, float]:
    """> 0 where dy is below, and above, a piece of axis i's table."""
    after = law.tables.first[i] + piece
    below = law.tables.rate[after - 1] - dy if piece > 0 else -np.inf
    above = dy - law.tables.rate[after] if after < law.tables.first[i + 1] else -np.inf
    return below, above


@kernel(inline="always")
def _tabled(law: JointLaw, i: int) -> bool:
    return law.tables.first[i + 1] > law.tables.first[i]


@kernel(inline="always")
def _constant(law: JointLaw, i: int) -> float:
    return min(law.coulomb[i], law.force_limit[i])


@kernel(inline="always")
def holding(law: JointLaw, i: int, sense: int) -> float:
    """The largest load that an axis at rest withstands without moving in a sense, +1 or -1 [N or N m]."""
    return _share(law, i, sense) * _constant(law, i)


@kernel(inline="always")
def _turns_at_rest(law: JointLaw, i: int) -> bool:
    """Whether the law is another for each sense of motion."""
    return law.coulomb[i] > 0 or law.one_way[i] != 0


@kernel(inline="always")
def _limiting_rate(law: JointLaw, i: int) -> float:
    """|ẏ| at which the power take-off reaches F_max."""
    if not law.pto_damping[i] > 0:
        return np.inf
    return (law.force_limit[i] - _constant(law, i)) / law.pto_damping[i]


@kernel(inline="always")
def axis_energy(law: JointLaw, i: int, y: float) -> float:
    """Energy stored in axis i at position y [J]."""
    depth = max(0.0, y - law.end_stops.upper[i], law.end_stops.lower[i] - y)
    stored = 0.5 * law.stiffness[i] * y * y - law.preload[i] * y
    return stored + 0.5 * law.end_stops.stiffness[i] * depth * depth


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
        damping += _table_slope(law, i, pto - TABLE) - _slope(law, i)
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
def pto_zone(law: JointLaw, i: int, dy: float) -> int:
    """The zone of the power take-off that dy lies in; HELD at rest where F_c, or another sense, begins there."""
    if _tabled(law, i):
        return TABLE + _table_piece(law, i, dy)
    sense = 1 if dy > 0 else -1
    if abs(dy) > _limiting_rate(law, i):
        return sense * LIMITED
    if not _turns_at_rest(law, i):
        return LINEAR
    return HELD if dy == 0 else sense * SLIPS


@kernel(inline="always")
def leaving(law: JointLaw, i: int, kind: int, zone: int, y: float, dy: float) -> float:
    """> 0 where y, dy are beyond a zone of the stops or of the power take-off (kind); for HELD see `holding`."""
    if kind == STOP_ZONE:
        if zone == OPEN:
            return max(y - law.end_stops.upper[i], law.end_stops.lower[i] - y)
        side = 1 if zone > 0 else -1
        depth = y - law.end_stops.upper[i] if side > 0 else law.end_stops.lower[i] - y
        press = law.end_stops.stiffness[i] * depth + law.end_stops.damping[i] * side * dy
        return -press if zone * side == PRESSED else max(-depth, press)
    if zone == HELD:
        return -1.0
    if zone >= TABLE:
        below, above = _beyond_piece(law, i, zone - TABLE, dy)
        return max(below, above)
    rate = _limiting_rate(law, i)
    if zone == LINEAR:
        return abs(dy) - rate
    sense = 1 if zone > 0 else -1
    if zone * sense == LIMITED:
        return rate - sense * dy
    return max(-sense * dy, sense * dy - rate)


@kernel(inline="always")
def next_zone(law: JointLaw, i: int, kind: int, zone: int, y: float, dy: float) -> int:
    """The zone behind the border of another at y, dy; HELD where the rate is zero there."""
    if kind == STOP_ZONE:
        if zone == OPEN:
            return PRESSED if y - law.end_stops.upper[i] > law.end_stops.lower[i] - y else -PRESSED
        side = 1 if zone > 0 else -1
        if zone * side == PRESSED:
            return side * RELEASED
        depth = y - law.end_stops.upper[i] if side > 0 else law.end_stops.lower[i] - y
        press = law.end_stops.stiffness[i] * depth + law.end_stops.damping[i] * side * dy
        return side * PRESSED if press > -depth else OPEN
    if zone >= TABLE:
        below, above = _beyond_piece(law, i, zone - TABLE, dy)
        return zone + 1 if above > below else zone - 1
    sense = 1 if dy > 0 else -1
    if zone == LINEAR:
        return sense * LIMITED
    if abs(zone) == LIMITED:
        return (1 if zone > 0 else -1) * SLIPS if _turns_at_rest(law, i) else LINEAR
    rate = _limiting_rate(law, i)
    return HELD if abs(dy) < 0.5 * rate else sense * LIMITED


@kernel
def joint_loads(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> JointLoads:
    """Loads of all axes from positions and rates (m, n), in the zones where these lie."""
    pto, loss, spring = np.empty(y.shape), np.empty(y.shape), np.empty(y.shape)
    for s in range(y.shape[0]):
        for i in range(y.shape[1]):
            stops, zone = stops_zone(law, i, y[s, i], dy[s, i]), pto_zone(law, i, dy[s, i])
            load = axis_load(law, i, stops, zone, y[s, i], dy[s, i])
            pto[s, i], loss[s, i], spring[s, i] = load.pto, load.loss, load.spring
        row, column, stiffness, damping = law.couplings
        for e in range(row.size):
            spring[s, row[e]] += stiffness[e] * y[s, column[e]]
            loss[s, row[e]] += damping[e] * dy[s, column[e]]
    return JointLoads(pto, loss, spring)


def pto_loads(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> np.ndarray:
    """Load of the power take-offs against their axes (m, n), stiffness included; that by which one holds is not."""
    return joint_loads(law, y, dy).pto + law.pto_stiffness * y


def pto_bounds(law: JointLaw) -> np.ndarray:
    """What the magnitude of a power take-off's load cannot exceed (n,)."""
    tables = [law.tables.load[a:b] for a, b in pairwise(law.tables.first)]
    largest = [np.abs(load).max() if load.size else limit for load, limit in zip(tables, law.force_limit, strict=True)]
    return np.where(law.pto_stiffness == 0, largest, np.inf)


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
        energy += axis_energy(law, i, y[i])
    return energy


@kernel
def zones_at_rest(law: JointLaw, y: np.ndarray, zones: np.ndarray) -> None:
    """zones (2, n) in which small motions about rest at y (n,) are linear."""
    for i in range(y.size):
        zones[STOP_ZONE, i], zones[PTO_ZONE, i] = stops_zone(law, i, y[i], 0.0), LINEAR


def damping_of_gaussian(law: JointLaw, std: np.ndarray) -> np.ndarray:
    """⟨f_pto ẏ⟩/⟨ẏ²⟩ (n,) of Gaussian rates with std (n,): the linear damping that takes as much power.

    With a = (F_max - F_c)/c_pto and x = a/σ: c (erf(x/√2) - √(2/π) x exp(-x²/2)) for what is linear, and
    √(2/π)/σ times F_c (1 - exp(-x²/2)) + F_max exp(-x²/2). At σ = 0 that of the linear part alone.
    """
    x, rate, constant = _reached(law, std)
    beyond = np.exp(-0.5 * x**2)
    with_limit = np.sqrt(2 / np.pi) * (constant * (1 - beyond) + _limit(law, beyond)) / rate
    linear = law.pto_damping * (erf(x / np.sqrt(2)) - np.sqrt(2 / np.pi) * np.minimum(x, FAR) * beyond)
    return np.where(std > 0, linear + with_limit, law.pto_damping)


def damping_of_harmonic(law: JointLaw, amplitude: np.ndarray) -> np.ndarray:
    """The same (n,) of a rate V sin θ, V (n,): its describing function, with sin θ₁ = a/V where the limit is reached.

    (4/π) [c (θ₁/2 - sin 2θ₁/4) + (F_c (1 - cos θ₁) + F_max cos θ₁)/V]
    """
    x, rate, constant = _reached(law, amplitude)
    at = np.arcsin(np.minimum(1.0, x))
    beyond = np.where(x < 1, np.cos(at), 0.0)
    linear = law.pto_damping * (at / 2 - np.sin(2 * at) / 4)
    total = 4 / np.pi * (linear + (constant * (1 - beyond) + _limit(law, beyond)) / rate)
    return np.where(amplitude > 0, total, law.pto_damping)


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


def drag(law: JointLaw) -> np.ndarray:
    """Of a linear model (n,): what times |ẏ|ẏ is to be linearised."""
    return law.quadratic_damping


def absorbing(law: JointLaw) -> np.ndarray:
    """Which axes absorb power (n,)."""
    return (law.pto_damping > 0) | (law.coulomb > 0) | tabled(law)


def tabled(law: JointLaw) -> np.ndarray:
    """Which axes have a power take-off by a table (n,)."""
    return np.diff(law.tables.first) > 0


def stopped(law: JointLaw) -> np.ndarray:
    """Which axes have end stops (n,)."""
    return np.isfinite(law.end_stops.upper)


def turning(law: JointLaw) -> np.ndarray:
    """Which axes have a law that is another for each sense of motion (n,)."""
    return (law.coulomb > 0) | (law.one_way != 0)


def bent(law: JointLaw) -> np.ndarray:
    """Which axes have more than one zone (n,)."""
    limited = np.isfinite(law.force_limit) & (law.pto_damping > 0)
    return stopped(law) | turning(law) | limited | tabled(law)


def stop_rates(law: JointLaw, compliance: np.ndarray) -> np.ndarray:
    """How fast an axis of inertia 1/compliance swings on its stops (n,): (k_s/m)^½ + c_s/m [rad/s]."""
    return np.sqrt(law.end_stops.stiffness * compliance) + law.end_stops.damping * compliance
