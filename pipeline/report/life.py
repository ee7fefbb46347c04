"""Fatigue damage and life of the steel over all sea states, each a mean over realizations with its interval."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report.tables import Table, marked, of_none, remarks, texts
from pipeline.report.yearly import (
    ESTIMATES,
    FAILED,
    HOUR,
    LEVEL,
    YEAR,
    Counts,
    by_sea,
    cells,
    counts,
    failures,
    lost,
    of_part,
    off,
    once_told,
    over_seas,
    realized,
    shared,
    weighed,
    with_errors,
)

if TYPE_CHECKING:
    import xarray as xr

STEEP = 3.0  # the least slope of curves: damage is off by as many times what stress is
AT = {"damage": "foot", "damage_top": "top"}  # of the legs, by variable
HEADER = ("", "where", "damage a year", "low", "high", "life [years]", "low", "high", "realizations")
NOTE = (
    f"; low and high: {LEVEL:.0%} by Student's t, of the damage's logarithm. With one realization there are none; of"
    " few or short ones, among which damage is skewed, more of it than `high` is likelier than that says. Life is"
    " 1/damage, of the fibre with the most."
)


def lives(data: xr.Dataset, variable: str = "damage", weights: Any = None) -> xr.Dataset:
    """`damage` [1/h] and `life` [s] over all sea states, dimension `estimate`: see `over_seas`.

    variable: "damage" or "damage_top" of a collected dataset; weights (sea_state,): its `occurrence`, else equal ones.
    Realizations' damage is skewed, and so the interval is that of its logarithm, D exp(±h/D) by half the width h that
    `over_seas` has: of ten lognormal realizations that scatter by as much as their mean, more than `high` is true of
    8 % and not of 13 %. Life is 1/D, the interval's ends change places; of no damage it has no end. Means leave out
    realizations that failed, `failed_realizations` of all sea states.
    """
    return _lives(realized(data, data[variable]), weighed(data) if weights is None else weights)


def _lives(each: xr.DataArray, weights: Any) -> xr.Dataset:
    import xarray as xr

    damage = over_seas(each, weights)
    value = damage.sel(estimate="value", drop=True)
    damage = damage.where(value == 0, value * np.exp(damage / value - 1))
    with np.errstate(divide="ignore"):
        life = (HOUR / damage).isel(estimate=[0, 2, 1]).assign_coords(estimate=list(ESTIMATES))
    damage.attrs, life.attrs = {"units": "h-1"}, {"units": "s"}
    return xr.Dataset({"damage": damage, "life": life, FAILED: failures(each)})


def table(data: xr.Dataset) -> Table:
    """Of a study that reckons damage."""
    data = weighed(data)
    lines = list(rows(data))
    lines += of_none(lost(data, "fixed"), len(HEADER)) if lines else []
    seas = "these by their occurrence" if "occurrence" in data.coords else "all of which count alike"
    note = f"Mean damage over realizations and sea states, {seas}{NOTE}"
    return Table("Fatigue", HEADER, lines, note + of_part(data) + remarks(lines))


def rows(data: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Of every platform and other label, at feet and tops: all seas together, and each by itself, as text."""
    for variable, end in AT.items():
        if variable in data:
            values = realized(data, data[variable])
            if "estimated_error" in data:
                values = with_errors(data, values, STEEP * data[variable])
            values = values.compute()
            every = by_sea(values.to_dataset(name=variable), variable)
            seas = [(sea, _worst(some[variable], some)) for sea, some in every]
            same = shared(data, [dim for dim in values.dims if dim not in ("sea_state", "seed", "leg", "fibre")])
            for every_label, place in cells(values, ("leg", "fibre")):
                if (labels := once_told(every_label, place, same)) is None:
                    continue
                for sea, worst in seas:
                    yield _line([*labels, sea], [of.isel(place) for of in worst], end)


def _worst(each: xr.DataArray, weights: Any) -> list[xr.DataArray]:
    """Of the fibre of each design with the most damage: that, life, what damage may be off by, and `counts`. Of all
    designs at once: one by one they would cost more than their physics."""
    found = _lives(each, weights)
    worst = found.damage.sel(estimate="value", drop=True).fillna(-1.0).argmax(["leg", "fibre"])
    return [of.isel(worst) for of in (found.damage, found.life, off(each, weights), *counts(each))]


def _line(words: list[str], worst: list[xr.DataArray], end: str) -> tuple[str, ...]:
    damage, life, error, *count = worst
    label = ", ".join(filter(None, words))
    if np.isnan(damage.values[0]):
        return (label, end, *["-"] * (len(HEADER) - 3), str(Counts(*count)))
    where = f"{end} of leg {damage.leg.values}, fibre {damage.fibre.values}"
    yearly, years = marked(damage.values, error.values, 1 / YEAR), texts(life.values / HOUR / YEAR)
    return label, where, *yearly, *years, str(Counts(*count))
