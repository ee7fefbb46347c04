"""Tables of load by rate, or by position and rate, of axes: straight lines or bilinear pieces, level beyond their ends.

The pieces of a table are numbered by rate (columns), first those below its first position, then those between that and
the next, ... (rows). In a piece its formula goes on beyond its borders. What is called of a table is not made part of
the caller, as the rest of the joints' law is: few scenes have one, and all would be longer to compile.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from solver.kernels import kernel, lean_kernel


class Tables(NamedTuple):
    """Load of the power take-offs by position and rate, of those that have a table, one axis after another.

    Without positions an axis's load goes by its rate alone.
    """

    first: np.ndarray  # (n + 1,) of each axis's rates, and their number
    rate: np.ndarray  # (t,) [m/s or rad/s], increasing along an axis
    load: np.ndarray  # of each axis's rates at its first position, at its second, ..., against the axis [N or N m]
    slope: np.ndarray  # (n,) ∂f_pto/∂ẏ at rest, between those of the two senses; 0 without a table
    first_position: np.ndarray  # (n + 1,) of each axis's positions, and their number
    position: np.ndarray  # [m or rad], increasing along an axis
    first_load: np.ndarray  # (n + 1,) of each axis's loads, and their number


class Points(NamedTuple):
    """A table of one axis; all empty where there is none."""

    position: np.ndarray  # (p,); none where the load goes by rate alone
    rate: np.ndarray  # (t,)
    load: np.ndarray  # (max(p, 1), t)


NO_POINTS = Points(np.zeros(0), np.zeros(0), np.zeros((1, 0)))


def tables(points: Sequence[Points]) -> Tables:
    """Of n axes."""
    position, rate, load = ([p[k].ravel() for p in points] for k in range(3))
    return Tables(
        first=_ends(rate),
        rate=_joined(rate),
        load=_joined(load),
        slope=np.array([_slope_at_rest(p) for p in points]),
        first_position=_ends(position),
        position=_joined(position),
        first_load=_ends(load),
    )


def _ends(parts: Sequence[np.ndarray]) -> np.ndarray:
    return np.cumsum([0, *(part.size for part in parts)])


def _joined(parts: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *parts])


def _slope_at_rest(points: Points) -> float:
    """At position zero."""
    p, rate, load = points
    if not rate.size:
        return 0.0
    step = 0.5 * np.diff(rate).min(initial=np.inf)
    along = np.array([np.interp(0.0, p, column) for column in load.T]) if p.size else load[0]
    return float(np.diff(np.interp([-step, step], rate, along))[0] / (2 * step))


def equivalent_damping(tables: Tables, size: np.ndarray, share: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """⟨f ẏ⟩/⟨ẏ²⟩ (n,) of tables by rate alone, for rates of this size (n,): Σ of slopes by how much each counts.

    share(x): of what counts, that at rates below x times the size. By parts ⟨f ẏ⟩ is of f' alone: of a Gaussian
    σ²⟨f'⟩ (Stein's lemma), of V sin θ V²⟨f' cos²θ⟩.
    """
    damping = tables.slope.copy()
    for i in np.flatnonzero((np.diff(tables.first) > 0) & (size > 0)):
        rate = tables.rate[tables.first[i] : tables.first[i + 1]]
        load = tables.load[tables.first_load[i] :][: rate.size]
        damping[i] = np.diff(load) / np.diff(rate) @ np.diff(share(rate / size[i]))
    return damping


@kernel(inline="always")
def _columns(tables: Tables, i: int) -> int:
    """Pieces of a table that are one after another by rate."""
    return tables.first[i + 1] - tables.first[i] + 1


@kernel(inline="always")
def _line(tables: Tables, i: int, column: int, line: int, dy: float) -> float:
    """The load by the formula of a column of a table, along one of its lines of equal position."""
    rates = tables.first[i + 1] - tables.first[i]
    at = max(column - 1, 0)
    load, rate = tables.first_load[i] + line * rates + at, tables.first[i] + at
    return tables.load[load] + _line_slope(tables, i, column, line) * (dy - tables.rate[rate])


@kernel(inline="always")
def _line_slope(tables: Tables, i: int, column: int, line: int) -> float:
    """∂f_pto/∂ẏ along a line of equal position; 0 beyond the ends."""
    rates = tables.first[i + 1] - tables.first[i]
    if not 0 < column < rates:
        return 0.0
    after, load = tables.first[i] + column, tables.first_load[i] + line * rates + column
    return (tables.load[load] - tables.load[load - 1]) / (tables.rate[after] - tables.rate[after - 1])


@kernel(inline="always")
def _across(tables: Tables, i: int, row: int) -> float:
    """Distance of the lines of equal position on either side of a row of a table; 0 beyond its ends."""
    after = tables.first_position[i] + row
    if row == 0 or after == tables.first_position[i + 1]:
        return 0.0
    return tables.position[after] - tables.position[after - 1]


@lean_kernel
def table_load(tables: Tables, i: int, piece: int, y: float, dy: float) -> float:
    """f_pto by the formula of a piece of a table."""
    row, column = piece // _columns(tables, i), piece % _columns(tables, i)
    low, wide = max(row - 1, 0), _across(tables, i, row)
    load = _line(tables, i, column, low, dy)
    if wide > 0:
        share = (y - tables.position[tables.first_position[i] + low]) / wide
        load += share * (_line(tables, i, column, row, dy) - load)
    return load


@lean_kernel
def table_slopes(tables: Tables, i: int, piece: int) -> tuple[float, float]:
    """∂f_pto/∂y and ∂f_pto/∂ẏ in the middle of a piece of a table."""
    row, column = piece // _columns(tables, i), piece % _columns(tables, i)
    low, wide = max(row - 1, 0), _across(tables, i, row)
    slope = _line_slope(tables, i, column, low)
    if not wide > 0:
        return 0.0, slope
    first, last = tables.first[i], tables.first[i + 1] - 1
    rate = 0.5 * (tables.rate[max(first + column - 1, first)] + tables.rate[min(first + column, last)])
    stiffness = (_line(tables, i, column, row, rate) - _line(tables, i, column, low, rate)) / wide
    return stiffness, 0.5 * (slope + _line_slope(tables, i, column, row))


@lean_kernel
def table_piece(tables: Tables, i: int, y: float, dy: float) -> int:
    """The piece of a table that y, dy lie in."""
    column, row = tables.first[i], tables.first_position[i]
    while column < tables.first[i + 1] and dy > tables.rate[column]:
        column += 1
    while row < tables.first_position[i + 1] and y > tables.position[row]:
        row += 1
    return (row - tables.first_position[i]) * _columns(tables, i) + column - tables.first[i]


@kernel(inline="always")
def _beyond_column(tables: Tables, i: int, piece: int, dy: float) -> tuple[float, float]:
    """> 0 where dy is below, and above, a piece of a table; in shares of its lines' whole span."""
    first, last = tables.first[i], tables.first[i + 1]
    after = first + piece % _columns(tables, i)
    span = tables.rate[last - 1] - tables.rate[first]
    below = (tables.rate[after - 1] - dy) / span if after > first else -np.inf
    above = (dy - tables.rate[after]) / span if after < last else -np.inf
    return below, above


@kernel(inline="always")
def _beyond_row(tables: Tables, i: int, piece: int, y: float) -> tuple[float, float]:
    """The same of its positions."""
    first, last = tables.first_position[i], tables.first_position[i + 1]
    after = first + piece // _columns(tables, i)
    if first == last:
        return -np.inf, -np.inf
    span = tables.position[last - 1] - tables.position[first]
    below = (tables.position[after - 1] - y) / span if after > first else -np.inf
    above = (y - tables.position[after]) / span if after < last else -np.inf
    return below, above


@lean_kernel
def beyond_piece(tables: Tables, i: int, piece: int, y: float, dy: float) -> float:
    """> 0 where y, dy are beyond a piece of a table."""
    slower, faster = _beyond_column(tables, i, piece, dy)
    lower, upper = _beyond_row(tables, i, piece, y)
    return max(slower, faster, lower, upper)


@lean_kernel
def next_piece(tables: Tables, i: int, piece: int, y: float, dy: float) -> int:
    """The piece of a table across the border that y, dy lie farthest beyond."""
    slower, faster = _beyond_column(tables, i, piece, dy)
    lower, upper = _beyond_row(tables, i, piece, y)
    if max(lower, upper) > max(slower, faster):
        return piece + _columns(tables, i) if upper > lower else piece - _columns(tables, i)
    return piece + 1 if faster > slower else piece - 1


@kernel(inline="always")
def has_table(tables: Tables, i: int) -> bool:
    """Whether axis i has one."""
    return tables.first[i + 1] > tables.first[i]


@kernel(inline="always")
def has_positions(tables: Tables, i: int) -> bool:
    """Whether axis i has a table that goes by position, too."""
    return tables.first_position[i + 1] > tables.first_position[i]
