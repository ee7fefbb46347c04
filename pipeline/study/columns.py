"""Numbers in columns: comma-separated text with a header, units in brackets; each fault has its line and column.

# lines that begin with a hash are comments
time [s], elevation [m]
0.0, 0.12
"""

from __future__ import annotations

import io
import itertools
import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from pipeline.study.attachments import Attachment
from pipeline.study.tables import LARGEST
from solver.errors import InputError


class Column(NamedTuple):
    """What a column may hold: factors of its units to SI, the first being meant where the header names none."""

    units: Mapping[str, float]
    least: float = -math.inf
    implied: bool = True  # whether the unit may be left out


TURN = 2 * math.pi
QUANTITIES = {
    "time": Column({"s": 1.0}),
    "elevation": Column({"m": 1.0}),
    "amplitude": Column({"m": 1.0}, least=0.0),
    "phase": Column({"rad": 1.0, "deg": math.pi / 180}),
    "omega": Column({"rad/s": 1.0}, least=0.0),
    # People mean either by this word, and a factor of 2π is not for us to guess.
    "frequency": Column({"Hz": TURN, "rad/s": 1.0}, least=0.0, implied=False),
    "position": Column({"m": 1.0, "rad": 1.0}),
    "velocity": Column({"m/s": 1.0, "rad/s": 1.0}),
    "force": Column({"N": 1.0, "N m": 1.0}),
    **{name: Column({"N": 1.0}) for name in ("Fx", "Fy", "Fz")},
    "S": Column({"m2 s/rad": 1.0, "m2/Hz": 1 / TURN}, least=0.0),
}
ALIASES = {"omega": ("omega", "frequency")}
DIRECTIONAL = "direction", "heading", "spread"  # parts of titles of columns by which waves go several ways


@lru_cache(maxsize=32)
def read(file: Attachment, wanted: tuple[str, ...]) -> dict[str, np.ndarray]:
    """The wanted columns in SI units, in any order in the file; others are passed over. Raises InputError.

    Refused are a wanted one that is there twice, and a line of more cells than there are columns.
    """
    number, header = next(_rows(file), (1, [""]))
    places = {name: _place(file, number, header, name) for name in wanted}
    if (table := _plain(file, len(header))) is not None:
        values = {name: factor * table[:, at] for name, (at, _, factor) in places.items()}
        if all(_allowed(title, table[:, at]) for at, title, _ in places.values()):
            return values
    numbers: dict[str, list[float]] = {name: [] for name in wanted}
    for line, cells in itertools.islice(_rows(file), 1, None):
        if any(cells[len(header) :]):
            raise InputError(
                "file", file, f"line {line}: has {len(cells)} cells, its header names {len(header)} columns"
            )
        for name, (at, title, factor) in places.items():
            numbers[name].append(factor * _number(file, line, cells, at, title))
    if not numbers[wanted[0]]:
        raise InputError("file", file, "has a header and no numbers")
    return {name: np.array(values) for name, values in numbers.items()}


def _plain(file: Attachment, columns: int) -> np.ndarray | None:
    """All numbers below the header, where there is nothing else: in a part of the time that a look at each cell takes,
    which tells what is wrong."""
    # Lines and not the file: numpy's own end at fewer marks.
    words = (words for _, words in itertools.islice(_lines(file), 1, None))
    try:
        with warnings.catch_warnings(action="ignore"):  # of files without any
            table = np.loadtxt(words, delimiter=",", comments=None, ndmin=2)
    except ValueError:
        return None
    return table if table.shape[1] == columns and len(table) else None


def _allowed(title: str, values: np.ndarray) -> bool:
    """Whether all are numbers that a column may hold."""
    return bool(np.all((values >= QUANTITIES[title].least) & (np.abs(values) <= LARGEST)))


def require_rising(file: Attachment, name: str, values: np.ndarray) -> None:
    """Refuse a line whose number, of those read, is not above that of the one before; raises InputError."""
    falls = np.flatnonzero(~(np.diff(values) > 0))
    if falls.size:
        (number, header), *rows = _rows(file)
        at, title, _ = _place(file, number, header, name)
        (_, before), (line, cells) = rows[falls[0] : falls[0] + 2]
        limit = f"line {line}, column {title}: {cells[at]} must be > {before[at]}, the one before"
        raise InputError("file", file, limit)


@lru_cache(maxsize=32)
def unread(file: Attachment, wanted: tuple[str, ...]) -> tuple[str, ...]:
    """Columns that a file of waves has besides the wanted ones; refused is one by which waves go several ways."""
    line, header = next(_rows(file), (1, [""]))
    known = {title for name in wanted for title in ALIASES.get(name, (name,))}
    others = tuple(title for title in _titles(header) if title and title not in known)
    for title in others:
        if any(part in title.lower() for part in DIRECTIONAL):
            limit = "must not be there: waves are long-crested, and all go along waves.heading"
            raise InputError("file", file, f"line {line}: column {title} {limit}")
    return others


def among(file: Attachment, known: tuple[str, ...]) -> list[str]:
    """Columns that a file has of the known ones, and no others; raises InputError."""
    line, header = next(_rows(file), (1, [""]))
    titles = [title for title in _titles(header) if title]
    for title in titles:
        if title not in known:
            raise InputError("file", file, f"line {line}: column {title} must be one of {', '.join(known)}")
    return titles


def _titles(header: Sequence[str]) -> list[str]:
    """Without units."""
    return [cell.partition("[")[0].strip() for cell in header]


def _rows(file: Attachment) -> Iterator[tuple[int, list[str]]]:
    """Line numbers and cells of the lines that say something; a header that other marks than commas part is refused."""
    for place, (line, words) in enumerate(_lines(file)):
        if place == 0:
            _require_commas(file, line, words)
        yield line, [cell.strip() for cell in words.split(",")]


def _require_commas(file: Attachment, line: int, header: str) -> None:
    for mark, called in ((";", "semicolons"), ("\t", "tabs")):
        if mark in header and "," not in header:
            limit = f"line {line}: commas must part columns, not {called}, and numbers have decimal points"
            raise InputError("file", file, limit)


def _lines(file: Attachment) -> Iterator[tuple[int, str]]:
    """Numbers and words of the lines that say something, one by one: all at once take many times the file's room."""
    data = file.data
    try:
        data.decode()
    except UnicodeDecodeError as error:
        raise InputError("file", file, f"is not UTF-8 text (byte {error.start})") from None
    pieces = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="\n")
    lines = itertools.chain.from_iterable(map(str.splitlines, pieces))
    for number, words in enumerate(lines, 1):
        said = words.lstrip()
        if said and not said.startswith("#"):
            yield number, words


def _place(file: Attachment, line: int, header: Sequence[str], name: str) -> tuple[int, str, float]:
    """Which column, what it is called there, and the factor to SI."""
    names = ALIASES.get(name, (name,))
    titles = _titles(header)
    for at, title in enumerate(titles):
        if title in names:
            if titles.count(title) > 1:
                raise InputError("file", file, f"line {line}: column {title} is there {titles.count(title)} times")
            unit = " ".join(header[at].partition("[")[2].rstrip("] ").split()).replace("^", "").replace("²", "2")
            quantity = QUANTITIES[title]
            if title == "S" and "omega" not in titles:
                quantity = quantity._replace(implied=False)  # beside hertz either unit may be meant
            return at, title, _factor(file, f"line {line}, column {title}", quantity, unit)
    columns = ", ".join(cell for cell in header if cell) or "none"
    raise InputError(
        "file", file, f"line {line}: needs a column {' or '.join(names)} in its header; has {columns[:100]}"
    )


def _factor(file: Attachment, where: str, quantity: Column, unit: str) -> float:
    if unit in quantity.units:
        return quantity.units[unit]
    if not unit and quantity.implied:
        return next(iter(quantity.units.values()))
    known = " or ".join(f"[{known}]" for known in quantity.units)
    raise InputError("file", file, f"{where}: needs its unit, {known}" + (f", not [{unit}]" if unit else ""))


def _number(file: Attachment, line: int, cells: Sequence[str], at: int, title: str) -> float:
    text = cells[at] if at < len(cells) else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    least = QUANTITIES[title].least
    if least <= value and abs(value) <= LARGEST:
        return value
    limit = "must be a finite number" if not math.isfinite(value) else f"must be >= {max(least, -LARGEST):g}"
    limit = f"must be <= {LARGEST:g}" if LARGEST < value < math.inf else limit
    raise InputError("file", file, f"line {line}, column {title}: {text[:40]!r} {limit}")
