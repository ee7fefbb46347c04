"""Which of a study's designs takes the most power from each sea state, and from a year."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pipeline.report.energy import OF, powers
from pipeline.report.yearly import LEVEL, Table, by_sea, cells, counted, named, over_seas, prefix, texts

if TYPE_CHECKING:
    import xarray as xr

POWERS = ("electrical_power", "absorbed_power")  # the first that there is: what a design is for
SAME = 1e-6  # of a power: by less two do not differ
CHOSEN = ("pto_damping", "hinge_spacing")  # and any axis of the floats' keys
TITLE = "Best in each sea state"
NOTE = (
    f"Of all floats, mean over realizations; low and high: {LEVEL:.0%} by Student's t. All seas: by their occurrence."
    " A number at an end of its axis may be exceeded beyond. Compared are designs that have all realizations of a sea."
)


def table(data: xr.Dataset) -> Table:
    """Of a study with several designs."""
    variable = next((name for name in POWERS if name in data), "")
    if not variable:
        return Table(TITLE, (), [], NOTE)
    unit, scale = prefix(data[variable].sel(statistic="mean"))
    header = ("", "most power with", f"mean {OF[variable]} power [{unit}W]", "low", "high", "realizations")
    return Table(TITLE, header, list(rows(data, variable, scale)), NOTE)


def rows(data: xr.Dataset, variable: str, scale: float = 1e3) -> Iterator[tuple[str, ...]]:
    """Of every platform, of all seas together, if somebody said how often they come, and of each; power over scale [W].

    A design without a number in a sea, or in a realization that another has, is none of those that are compared in it.
    """
    total = powers(data, variable).isel(float=-1, drop=True).compute()
    designs = [dim for dim in total.dims if total.sizes[dim] > 1 and _is_design(data[dim])]
    for labels, part in cells(total, variable, designs) if designs else ():
        for sea, some in by_sea(part, variable):
            if some[variable].sizes.get("sea_state", 1) > 1 and "occurrence" not in some.coords:
                continue
            found = over_seas(some[variable], some)
            first = found.sel(estimate="value", drop=True).where(_whole(some[variable], designs))
            if not first.fillna(0.0).any():  # nor is there a best of none that takes power
                continue
            at = first.argmax(designs)
            beside = {dim: first.isel({other: at[other] for other in designs if other != dim}) for dim in designs}
            chosen = ", ".join(_told(beside[dim], int(at[dim])) for dim in designs)
            if (known := int(first.notnull().sum())) < first.size:
                chosen += f" (of {known} among {first.size})"
            label, power = ", ".join(filter(None, [*labels, sea])), found.isel(at).values
            yield label, chosen, *texts(power / scale), counted(some[variable].isel(at))


def _is_design(axis: xr.DataArray) -> bool:
    return axis.name in CHOSEN or "floats." in axis.attrs.get("long_name", "")


def _whole(each: xr.DataArray, designs: Sequence[Hashable]) -> xr.DataArray:
    """Which designs have all realizations that any has: of those that failed in some the others tell too much."""
    number = each.notnull().sum("seed") if "seed" in each.dims else each.notnull()
    whole = number == number.max(designs)
    return whole.all("sea_state") if "sea_state" in whole.dims else whole


def _told(power: xr.DataArray, number: int) -> str:
    """One of an axis's values with those that go along, and whether it is the last of some numbers to either side.

    power: along the axis. Numbers of samples have no end, nor has an axis that does not matter one that does.
    """
    (dim,) = power.dims
    axis = power[dim]
    label = named(dim, axis.values[number])
    along = [named(str(name).rpartition("floats.")[2], of.values[number]) for name, of in axis.coords.items()
             if name != dim and of.dims == (dim,)]  # fmt: skip
    if along:
        return f"{label} ({', '.join(along)})"
    matters = float(power.max() - power.min()) > SAME * abs(float(power.max()))
    ends = np.issubdtype(axis.dtype, np.number) and axis.values[number] in (axis.values.min(), axis.values.max())
    return label + " (an end)" * bool(ends and matters)
