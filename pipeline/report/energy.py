"""Energy that a year takes from the sea, of each float and of all, with its interval."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.report.tables import MANY, Table, marked, prefix, remarks, texts
from pipeline.report.yearly import (
    FAILED,
    HOUR,
    LEVEL,
    YEAR,
    Counts,
    cells,
    counts,
    failures,
    lost,
    of_part,
    off,
    over_seas,
    realized,
    weighed,
    with_errors,
)

if TYPE_CHECKING:
    import xarray as xr

OF = {"absorbed_power": "absorbed", "electrical_power": "electrical"}  # by variable
ALL = "all floats"
ABOVE = {"": "k", "k": "M"}  # prefixes, by the one a thousand times smaller
NOTE = (
    f"Mean over realizations and sea states, these by their occurrence; low and high: {LEVEL:.0%} by Student's t"
    " of the realizations' power. With one realization there are none."
)


class _Design(NamedTuple):
    """What a design takes."""

    power: float  # of all floats [W]; -inf of those of which it is not known
    lines: list[tuple[str, ...]]  # of each float and, last, of all


def energies(data: xr.Dataset, variable: str = "absorbed_power", weights: Any = None) -> xr.Dataset:
    """`power` [W] and `energy` of a year [J] over all sea states, dimensions `estimate` and `float`: see `over_seas`.

    variable: "absorbed_power" or "electrical_power" of a collected dataset; weights (sea_state,): its `occurrence`,
    else equal ones. Of several floats the last is `all floats`, whose interval is that of their sum. Means leave out
    realizations that failed, `failed_realizations` of all sea states.
    """
    import xarray as xr

    each = powers(data, variable)
    power = over_seas(each, weighed(data) if weights is None else weights)
    energy = power * YEAR * HOUR
    power.attrs, energy.attrs = {"units": "W"}, {"units": "J"}
    return xr.Dataset({"power": power, "energy": energy, FAILED: failures(each)})


def powers(data: xr.Dataset, variable: str) -> xr.DataArray:
    """Mean power in each task [W], of the floats and, last, of all; none of floats that are lifted out in some seas.

    Electrical power of a float without an efficiency, which is 1 each way, is what it absorbs: the mean of what a
    spring exchanges is 0. All are the floats that have numbers in some sea; unknown is their sum where one's is.
    """
    each = realized(data, _of_tasks(data, variable, "mean"))
    # An error is relative to the rms, and of a sum of floats at most the sum of theirs.
    return with_errors(data, each, _of_tasks(data, variable, "rms")) if "estimated_error" in data else each


def _of_tasks(data: xr.Dataset, variable: str, statistic: str) -> xr.DataArray:
    """A statistic of power in each task, of the floats and, last, of all."""
    import xarray as xr

    each = data[variable].sel(statistic=statistic, drop=True)
    if variable == "electrical_power":
        each = each.fillna(data["absorbed_power"].sel(statistic=statistic, drop=True))
    works = each.notnull().any([dim for dim in ("sea_state", "seed") if dim in each.dims])
    if "status" in data and "sea_state" in each.dims:
        lifted = works & each.isnull() & data["status"].isin(["done", "stale"])
        each = each.where(~lifted, 0.0)
    if each.sizes["float"] > 1:
        total = each.where(works, 0.0).sum("float", skipna=False).where(works.any("float")).assign_coords(float=ALL)
        each = xr.concat([each, total], dim="float", coords="minimal", compat="override")
    return each


def table(data: xr.Dataset) -> Table:
    """Of a study that says how often its sea states come."""
    data = weighed(data)
    told = "occurrence" in data.coords and any(name in data for name in OF)
    unit, scale = prefix(data[next(name for name in OF if name in data)].sel(statistic="mean")) if told else ("k", 1e3)
    columns = f"mean power [{unit}W]", "low", "high", f"energy a year [{ABOVE[unit]}Wh]", "low", "high", "realizations"
    lines = list(rows(data, scale)) if told else []
    return Table("Energy", ("", "", *columns), lines, NOTE + of_part(data) + remarks(lines))


def rows(data: xr.Dataset, scale: float = 1e3) -> Iterator[tuple[str, ...]]:
    """Of every platform and other label, each float and all of them, as text; power over its scale [W].

    Of many all floats come first, those with the most power on top, and then each float in the same order.
    """
    parts: list[tuple[str, ...]] = []
    for variable, word in OF.items():
        if variable not in data:
            continue
        designs = [*_by_design(data, variable, word, scale)]
        if len(designs) > MANY:
            designs.sort(key=lambda design: -design.power)
            parts += [line for design in designs for line in design.lines[:-1]]
            designs = [design._replace(lines=design.lines[-1:]) for design in designs]
        yield from (line for design in designs for line in design.lines)
    yield from parts


def _by_design(data: xr.Dataset, variable: str, word: str, scale: float) -> Iterator[_Design]:
    each = powers(data, variable).compute()
    # Of all designs at once: one by one they would cost more than their physics.
    whole = [of.transpose("float", ...).variable for of in (over_seas(each, data), off(each, data), *counts(each))]
    for labels, place in cells(each, ("float",)):
        power, error, *number = (of.isel(place).values for of in whole)
        lines = []
        for name, mean, other, *count in zip(each["float"].values.tolist(), power, error, *number, strict=True):
            if (of := Counts(*count)).most:
                figures = marked(mean, other, scale), texts(mean * YEAR / (1e3 * scale))
                lines.append((", ".join([*labels, name]), word, *figures[0], *figures[1], str(of)))
        yield _Design(-math.inf if np.isnan(power[-1, 0]) else float(power[-1, 0]), lines)
    for label, failed in lost(data, "elastic-no-floats"):
        yield _Design(-math.inf, [(label, word, *["-"] * 6, f"-, {failed} failed")])
