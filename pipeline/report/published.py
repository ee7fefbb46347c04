"""Numbers that others published, as studies/<name>-published.csv has them."""

from __future__ import annotations

import csv
import difflib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, get_args

from pipeline.report.units import allowed, factor
from pipeline.results.variables import VARIABLES, known, meaning
from pipeline.study.axes import Support
from pipeline.study.reading import StudyError

STATISTICS = ("max", "min", "mean", "rms", "std")
AXES = ("heave", "pitch")  # one that slides and one that turns: units go by them alone
COLUMNS = ("table", "label", "variable", "selection", "statistic", "value", "unit", "note")
MORE = "more"  # what a row has beyond these


@dataclass(frozen=True, kw_only=True)
class Published:
    """One published number, and where ours stands in the dataset."""

    table: str
    label: str
    variable: str
    selection: dict[str, list[str]]
    statistic: str
    value: float
    text: str  # as it is printed
    unit: str
    note: str
    file: str = ""
    place: str = ""  # row and label

    @property
    def rounding(self) -> float:
        """Half a unit of the last printed digit."""
        return 0.5 * 10.0 ** int(Decimal(self.text).as_tuple().exponent)

    @property
    def own(self) -> list[str]:
        """Units that the dataset may have the variable in: some go by the axis, which the selection may tell."""
        each = (meaning(self.variable, [axis]).get("units") for axis in self.selection.get("axis", AXES))
        return list(dict.fromkeys(unit for unit in each if unit is not None))

    @property
    def scale(self) -> float:
        """SI units in one of the printed unit; NaN of a unit that the variable cannot have."""
        return next((size for own in self.own if (size := factor(self.unit, own)) is not None), math.nan)


def read_published(path: Path) -> list[Published]:
    """Rows of a file of published numbers."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = csv.DictReader((line for line in file if not line.startswith("#")), restkey=MORE, restval="")
        try:
            if tuple(rows.fieldnames or ()) != COLUMNS:
                raise StudyError(path, [f"columns = {rows.fieldnames}: must be {', '.join(COLUMNS)}"])
            each = {f"row {number} = {row['label']!r}": row for number, row in enumerate(rows, start=1)}
        except (UnicodeDecodeError, csv.Error) as error:
            raise StudyError(path, [f"is no table of text: {error}"]) from None
    if problems := [f"{place}: {problem}" for place, row in each.items() for problem in _misread(row)]:
        raise StudyError(path, problems)
    made = [_row(path, place, row) for place, row in each.items()]
    if problems := [f"{row.place}: {problem}" for row in made for problem in _problems(row)]:
        raise StudyError(path, problems)
    return made


def _misread(row: dict[str, Any]) -> Iterator[str]:
    """What is no number, no selection, or more than a row has."""
    if more := row.get(MORE):
        limit = f"must be the last of {len(COLUMNS)}, and {','.join(more)!r} follows: commas in a text need quotes"
        yield f"note = {row['note']!r}: {limit}"
    try:
        float(row["value"])
    except ValueError:
        yield f"value = {row['value']!r}: must be a number"
    named: set[str] = set()
    for pair in _pairs(row):
        key, *labels = pair.split("=")
        if not key or len(labels) != 1 or not all(labels[0].split("+")):
            yield f"selection = {pair!r}: must be dimension=label, with + between labels and ; before another dimension"
        elif key in named:
            yield f"selection {key} = {labels[0]}: must be named once, with + between labels"
        named.add(key)


def _pairs(row: dict[str, str]) -> list[str]:
    return ["=".join(map(str.strip, pair.split("="))) for pair in row["selection"].split(";") if pair.strip()]


def _row(path: Path, place: str, row: dict[str, str]) -> Published:
    words = {key: row[key] for key in ("table", "label", "variable", "statistic", "unit", "note")}
    selection = {key: labels.split("+") for key, labels in (pair.split("=") for pair in _pairs(row))}
    text = row["value"]
    return Published(**words, selection=selection, value=float(text), text=text, file=path.name, place=place)


def _problems(row: Published) -> Iterator[str]:
    """Words and numbers that no dataset has."""
    if not math.isfinite(row.value):
        yield f"value = {row.text}: must be finite"
    if not (known(row.variable) and row.own):
        close = difflib.get_close_matches(row.variable, [name for name, of in VARIABLES.items() if of.units], n=1)
        yield f"variable = {row.variable!r}: must be an output with numbers" + f": {''.join(close)}?" * bool(close)
    elif math.isnan(row.scale):
        yield f"unit = {row.unit!r}: must be that of {row.variable}: {'; or '.join(map(allowed, row.own))}"
    if row.statistic and row.statistic.removeprefix("-") not in STATISTICS:
        yield f"statistic = {row.statistic!r}: must be {', '.join(STATISTICS)}, or one with - before it"
    for label in row.selection.get("platform", ()):
        if label not in get_args(Support):
            yield f"selection platform = {label!r}: must be {', '.join(get_args(Support))}"
