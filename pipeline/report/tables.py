"""Tables of means over realizations and sea states, as text."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from rich.console import Console

PLAIN = 100.0  # below which numbers are told without a prefix [W or N]
WORDS = 2  # columns of a table that are words
ROWS = 60  # that a terminal shows of a table
MANY = 10  # designs; of more than these the first of a ranking are told, and all floats before each
MARK = " *"
OFF = (
    f"{MARK}: by their estimated_error records may be off by more than this interval, which is of their scatter alone."
)
SURVIVORS = " Realizations that failed, as a rule the roughest, are in no mean."


class Table(NamedTuple):
    """Lines of text under a header, the first WORDS of each in words; and how to read them."""

    title: str
    header: tuple[str, ...]
    lines: list[tuple[str, ...]]
    note: str


def of_survivors(lines: Iterable[tuple[str, ...]]) -> str:
    """A sentence where realizations failed, as the last column has it."""
    return SURVIVORS if any("failed" in line[-1] for line in lines) else ""


def of_none(none: Iterable[tuple[str, int]], columns: int, most: int = MANY) -> list[tuple[str, ...]]:
    """Lines of designs that failed whole, with how many tasks; of more than so many designs one of all."""
    every = list(none)
    if len(every) > most:
        every = [(f"{len(every)} designs", sum(count for _, count in every))]
    return [(label, *["-"] * (columns - 2), f"-, {count} failed") for label, count in every]


def remarks(lines: Collection[tuple[str, ...]]) -> str:
    """Sentences where numbers are marked, and where realizations failed."""
    return OFF * any(line[WORDS].endswith(MARK) for line in lines) + of_survivors(lines)


def prefix(values: xr.DataArray | np.ndarray) -> tuple[str, float]:
    """Of the unit in which numbers are told, and its factor: thousands, or the unit itself of a model's."""
    return ("", 1.0) if float(np.abs(values).max()) < PLAIN else ("k", 1e3)


def texts(numbers: np.ndarray) -> list[str]:
    """Three digits of each."""
    return ["-" if np.isnan(number) else f"{number:z.3g}" for number in numbers]


def marked(found: np.ndarray, error: Any, scale: float) -> list[str]:
    """Value, low and high over scale as text; the value with a mark if it may be off by more."""
    value, *ends = texts(found / scale)
    return [value + MARK * bool(error > found[2] - found[0]), *ends]


def show(table: Table, console: Console, whole: str = "report.html") -> None:
    """The table, if it has lines; a narrow terminal wraps them. whole: the file that has all of a long one."""
    if not table.lines:
        return
    widths = [max(map(len, column)) for column in zip(table.header, *table.lines, strict=True)]
    console.print(table.title, style="bold")
    for line in (table.header, *table.lines[:ROWS]):
        columns = enumerate(zip(line, widths, strict=True))
        row = [word.ljust(n) if i < WORDS else word.rjust(n) for i, (word, n) in columns]
        console.print("  ".join(row), soft_wrap=True, highlight=False, markup=False)
    if (more := len(table.lines) - ROWS) > 0:
        console.print(f"  ... and {more:,} more, in {whole}", highlight=False, markup=False)
    console.print(f"  {table.note}", soft_wrap=True, highlight=False, markup=False)
