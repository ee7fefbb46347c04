"""Whether the steel bears it: the tube with the largest utilisation of each design and sea state, and how many fail."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pipeline.report.tables import MANY, MARK, Table, of_none, of_survivors
from pipeline.report.yearly import Counts, by_sea, cells, counts, lost, named, realized

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
    lines = [*rows(data), *of_none(lost(data, "fixed"), len(HEADER))] if VARIABLE in data else []
    return Table("Utilisation of tubes", HEADER, lines, NOTE + of_survivors(lines))


def rows(data: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Of every platform and other label each sea state, as text; of many the worst."""
    values = realized(data, data[VARIABLE].sel(statistic="max", drop=True)).compute()
    seas = [*by_sea(values.to_dataset(name=VARIABLE), VARIABLE)]
    # The first of several is all of them. Of all designs at once: one by one they would cost more than their physics.
    found = [(sea, _worst(some[VARIABLE])) for sea, some in seas[1:] or seas]
    every = cells(values, ("tube",))
    designs = [[_line([*labels, sea], [of.isel(at) for of in worst]) for sea, worst in found] for labels, at in every]
    if len(designs) > MANY:
        designs = [sorted((max(lines) for lines in designs), reverse=True)]
    yield from (line for lines in designs for _, line in lines)


def _worst(each: xr.DataArray) -> list[xr.DataArray]:
    """Of the tube of each design with the largest mean in a sea: that, and the largest of any realization; how many
    tubes there are, fail by their means, and in some realization; `counts`, of the most where no mean is known."""
    each = each.isel(sea_state=0) if "sea_state" in each.dims else each
    each = each if "seed" in each.dims else each.expand_dims("seed")
    mean, largest = each.mean("seed"), each.max("seed")
    worst, known = mean.fillna(-math.inf).argmax("tube"), mean.notnull().any("tube")
    tubes = mean.count("tube"), (mean > FAILS).sum("tube"), (largest > FAILS).sum("tube")
    count = (of.isel(tube=worst).where(known, of.max("tube")) for of in counts(each))
    return [mean.isel(tube=worst), largest.isel(tube=worst), *tubes, *count]


def _line(words: list[str], worst: list[xr.DataArray]) -> tuple[float, tuple[str, ...]]:
    """Largest of the tubes' means, -inf where there is none, and the line."""
    mean, largest, tubes, usual, once, *count = (of.item() for of in worst)
    label = ", ".join(filter(None, words))
    if math.isnan(mean):
        return -math.inf, (label, *["-"] * (len(HEADER) - 2), str(Counts(*count)))
    failing = f"{usual} of {tubes}" + f", {once} in some" * (once > usual)
    tube = named("tube", worst[0]["tube"].item())
    return mean, (label, tube, _marked(mean), _marked(largest), failing, str(Counts(*count)))


def _marked(number: float) -> str:
    return f"{number:.3g}" + MARK * (number > FAILS)
