"""In which zone of its law an axis is, where it leaves that, and for which one."""

import numpy as np

from solver.kernels import kernel
from solver.multibody.joint_law import (
    GONE,
    HELD,
    LIMITED,
    LINEAR,
    OPEN,
    PRESSED,
    PTO_ZONE,
    RELEASED,
    SLIPS,
    STOP_ZONE,
    TABLE,
    JointLaw,
    axis_load,
    holding,
    largest,
)
from solver.multibody.load_table import beyond_piece, has_positions, has_table, next_piece, table_piece


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
def withstands(law: JointLaw, i: int) -> bool:
    """Whether an axis withstands any load at rest."""
    return law.coulomb[i] > 0 or law.latch_load[i] > 0


@kernel(inline="always")
def _turns_at_rest(law: JointLaw, i: int) -> bool:
    """Whether the law is another for each sense of motion, or holds the axis between them."""
    return withstands(law, i) or law.one_way[i] != 0


@kernel(inline="always")
def _limiting_rate(law: JointLaw, i: int) -> float:
    """|ẏ| at which the power take-off reaches F_max, or lets go."""
    if not law.pto_damping[i] > 0:
        return np.inf
    return (largest(law, i) - law.coulomb[i]) / law.pto_damping[i]


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
    return HELD if dy == 0 and withstands(law, i) else sense * SLIPS


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
    if withstands(law, i):
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


@kernel
def zones_at_rest(law: JointLaw, y: np.ndarray, zones: np.ndarray) -> None:
    """zones (2, n) in which small motions about rest at y (n,) are linear.

    A table by rate alone bends at rest and has no load there; one by position, too, may have.
    """
    for i in range(y.size):
        zones[STOP_ZONE, i], zones[PTO_ZONE, i] = stops_zone(law, i, y[i], 0.0), LINEAR
        if has_positions(law.tables, i):
            zones[PTO_ZONE, i] = pto_zone(law, i, y[i], 0.0)
