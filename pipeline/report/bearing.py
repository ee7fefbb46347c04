"""Whether the steel bears it: the tube with the largest utilisation of each design and sea state, and how many fail."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pipeline.report.yearly import MANY, MARK, Table, by_sea, cells, counted, named, of_survivors, realized

if TYPE_CHECKING:
    import xarray as xr

VARIABLE = "utilisation"
FAILS = 1.0  # above
HEADER = ("", "worst tube", "utilisation", "largest of any", "tubes above 1", "realizations")
NOTE = (
    "By NORSOK N-004, 6.3: a record's largest, mean over realizations, of the tube where that is largest, and the"
    f" largest of any of these;{MARK}: above 1, the tube fails. Tubes above 1 by their means, and those that are so in"
    f" some realization. Of more than {MANY} designs each has its worst sea state, the worst design first."
)


def table(data: xr.Dataset) -> Table:
    """Of a study that reckons utilisation."""
    lines = list(rows(data)) if VARIABLE in data else []
    return Table("Utilisation of tubes", HEADER, lines, NOTE + of_survivors(lines))


def rows(data: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Of every platform and other label each sea state, as text; of many the worst."""
    values = realized(data, data[VARIABLE].sel(statistic="max", drop=True)).compute()
    designs = [[*_by_sea(part, labels)] for labels, part in cells(values, VARIABLE, ("tube",))]
    if len(designs) > MANY:
        designs = [sorted((max(lines) for lines in designs), reverse=True)]
    yield from (line for lines in designs for _, line in lines)


def _by_sea(part: xr.Dataset, labels: list[str]) -> Iterator[tuple[float, tuple[str, ...]]]:
    """Largest of the tubes' means, -inf where there is none, and the line of each sea state."""
    seas = [*by_sea(part, VARIABLE)]
    for sea, some in seas[1:] or seas:  # the first of several is all of them
        each, label = some[VARIABLE], ", ".join(filter(None, [*labels, sea]))
        each = each.isel(sea_state=0) if "sea_state" in each.dims else each
        mean = each.mean("seed") if "seed" in each.dims else each
        if mean.isnull().all():
            yield -math.inf, (label, *["-"] * (len(HEADER) - 2), counted(each))
            continue
        worst = mean.argmax("tube")
        there = each.isel(tube=worst)
        tube = named("tube", there["tube"].values.item())
        figures = _marked(float(mean.max())), _marked(float(there.max()))
        yield float(mean.max()), (label, tube, *figures, _failing(each, mean), counted(there))


def _marked(number: float) -> str:
    return f"{number:.3g}" + MARK * (number > FAILS)


def _failing(each: xr.DataArray, mean: xr.DataArray) -> str:
    """How many tubes are above by their means, of how many, and how many in some realization, if these are more."""
    among = [dim for dim in each.dims if dim != "tube"]
    usual, once = int((mean > FAILS).sum()), int((each.max(among) > FAILS).sum())
    return f"{usual} of {int(mean.notnull().sum())}" + f", {once} in some" * (once > usual)
