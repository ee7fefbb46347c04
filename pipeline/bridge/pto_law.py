"""A power take-off's law from a user's Python file, as the table by which the solver follows it to a stated error.

The file has a function load(y, dy), with more arguments where the study gives `parameters`: the load against the motion
[N or N m] at position y [m or rad] and rate dy. It is called on a dense grid before anything runs; lines of the table
are laid where straight (bilinear) pieces between those that are there miss it most, until they do not miss it by more
than the error, and that is checked once more between the grid's points. Behind it are one of a FINER-th of the error
and the whole grid: by them a run tells what the table does to it, and goes on by a finer one where that is too much.
"""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache

import numpy as np

from pipeline.study.attachments import Attachment
from solver.errors import InputError
from solver.power_takeoff import PtoTable

RATES = 401  # of the grid, where the load goes by rate alone
GRID = 161  # points of the grid along either
MOST_LINES = 100  # either way, of the table by which a run begins
FINER = 10
LONGEST = 60.0  # that a table may take to make, of some 50,000 calls [s]
AMPLY = 0.8  # share of the error to which lines are laid, for what lies between the grid's points

Load = Callable[[float, float], float]
Ends = tuple[float, float]
Lines = tuple[list[int], list[int]]  # rows and columns of the grid


@lru_cache(maxsize=32)
def table(
    file: Attachment, velocity: Ends, position: Ends | None, error: float, parameters: tuple[float, ...], axis: str
) -> PtoTable:
    """The solver's table for the law in a file; InputError where there is none."""
    for name, ends in (("velocity", velocity), ("position", position)):
        if ends and not ends[0] < ends[1]:
            raise InputError(f"pto_table.{name}", list(ends), "must increase")
    v = _points(velocity, GRID if position else RATES)
    y = _points(position, GRID) if position else np.zeros(1)
    with _in_time():
        load = _function(file, parameters)
        exact = _sampled(load, y, v)
        rows, columns = laid = _lines(file, y, v, exact, error, MOST_LINES)
        _check_between(file, load, (y[rows], v[columns], exact[np.ix_(rows, columns)]), (y, v), error)
        close = _lines(file, y, v, exact, error / FINER, exact.size + 1)
    whole, made = (list(range(y.size)), list(range(v.size))), None
    levels = [whole, *(at for at, finer in ((close, whole), (laid, close)) if at != finer)]
    for rows, columns in levels:
        made = PtoTable(
            position=tuple(y[rows].tolist()) if position else (),
            velocity=tuple(v[columns].tolist()),
            force=tuple(exact[np.ix_(rows, columns)].ravel().tolist()),
            axis=axis,
            finer=made,
        )
    assert made is not None  # of the grid, at least
    return made


def _points(ends: Ends, count: int) -> np.ndarray:
    """Evenly between the ends, and zero."""
    inside = [0.0] if ends[0] < 0 < ends[1] else []
    return np.unique([*np.linspace(*ends, count), *inside])


def _function(file: Attachment, parameters: tuple[float, ...]) -> Load:
    """The file's function, which gives a finite number or an InputError that says what it gave."""
    names: dict[str, object] = {"__name__": "pto_law"}
    try:
        exec(compile(file.data, file.name, "exec"), names)  # the study's own code, asked for by its writer
    except (Exception, SystemExit) as error:
        raise InputError("pto_table.file", file, f"cannot be run: {_told(error)}") from None
    load = names.get("load")
    if not callable(load):
        raise InputError("pto_table.file", file, "needs a function load(y, dy)")

    def checked(y: float, dy: float) -> float:
        try:
            value = load(y, dy, *parameters)
        except (Exception, SystemExit) as error:
            raise refused(y, dy, f"fails: {_told(error)}") from None
        if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not math.isfinite(value):
            raise refused(y, dy, f"must be a finite number, is {str(value)[:40]}")
        return float(value)

    def refused(y: float, dy: float, why: str) -> InputError:
        call = f"load({', '.join(f'{x:g}' for x in (y, dy, *parameters))})"
        return InputError("pto_table.file", file, f"{call} {why}")

    return checked


@contextmanager
def _in_time() -> Iterator[None]:
    """A TimeoutError for what does not end within LONGEST; not in other threads, which no signal reaches."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(*_: object) -> None:
        raise TimeoutError(f"the law's table takes longer than {LONGEST:g} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _told(error: BaseException) -> str:
    line = f", line {error.lineno}" if isinstance(error, SyntaxError) else ""
    return f"{type(error).__name__}: {str(error)[:80]}{line}"


def _sampled(load: Load, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.array([[load(a, b) for b in v.tolist()] for a in y.tolist()])


def _between(lines: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Shares (x.size, lines.size) of values on the lines that make up those at x; one line does for all."""
    return np.array([np.interp(x, lines, unit) for unit in np.eye(lines.size)]).T


def _lines(file: Attachment, y: np.ndarray, v: np.ndarray, exact: np.ndarray, error: float, most: int) -> Lines:
    """Rows and columns of the grid (y.size, v.size) between which straight pieces miss it by no more than the error."""
    rows, columns = ({0, x.size - 1, int(np.abs(x).argmin())} for x in (y, v))
    allowed = AMPLY * error * np.abs(exact).max()
    while True:
        at = sorted(rows), sorted(columns)
        along_v = exact[:, at[1]] @ _between(v[at[1]], v).T
        along_y = _between(y[at[0]], y) @ exact[at[0]]
        missed = np.abs(_between(y[at[0]], y) @ along_v[at[0]] - exact)
        i, j = divmod(int(missed.argmax()), v.size)
        if missed[i, j] <= allowed:
            return at
        if max(len(rows), len(columns)) >= most:
            table = f"a table of {most} lines of {'velocity' if len(columns) >= most else 'position'}"
            limit = f"{AMPLY * error:.3g}, {AMPLY:g} of `error`, which leaves the rest to what lies between its points"
            raise _unlike(file, (y[i], v[j]), table, missed[i, j] / np.abs(exact).max(), limit)
        by_rate = abs(along_v[i, j] - exact[i, j]) >= abs(along_y[i, j] - exact[i, j])
        if (by_rate and j not in columns) or i in rows:
            columns.add(j)
        else:
            rows.add(i)


def _check_between(
    file: Attachment, load: Load, lines: tuple[np.ndarray, ...], grid: tuple[np.ndarray, np.ndarray], error: float
) -> None:
    """Refuse a law that the table misses between the grid's points."""
    y, v = (x if x.size == 1 else (x[1:] + x[:-1]) / 2 for x in grid)
    exact = _sampled(load, y, v)
    missed = np.abs(_between(lines[0], y) @ lines[2] @ _between(lines[1], v).T - exact)
    i, j = divmod(int(missed.argmax()), v.size)
    largest = max(np.abs(exact).max(), np.abs(lines[2]).max())
    if missed[i, j] > error * largest:
        table = "between the grid's points the table"
        raise _unlike(file, (y[i], v[j]), table, missed[i, j] / largest, f"{error:g}, `error`")


def _unlike(file: Attachment, at: tuple[float, float], table: str, missed: float, limit: str) -> InputError:
    where = f"near load({at[0]:.4g}, {at[1]:.4g}) {table} misses it by {missed:.3g} of its largest load"
    remedy = "give a narrower range of velocity or position, or a larger `error`; of loads that jump or bend use"
    jump = "`coulomb`, `force_limit`, `declutch_load` and `end_stops`"
    return InputError("pto_table.file", file, f"{where}, which must be <= {limit}; {remedy} {jump}")
