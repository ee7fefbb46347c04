"""Fatigue damage and life of the steel over all sea states, each a mean over realizations with its interval."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.results.dataset import once

if TYPE_CHECKING:
    import xarray as xr
    from rich.console import Console

LEVEL = 0.95  # of the intervals
HOUR, YEAR = 3600.0, 365.25 * 24.0  # [s], [h]
ESTIMATES = ("value", "low", "high")
AT = {"damage": "foot", "damage_top": "top"}  # of the legs, by variable
HEADER = ("", "where", "damage a year", "low", "high", "life [years]", "low", "high", "realizations")
NOTE = (
    f"Mean damage over realizations and sea states, these by their occurrence; low and high: {LEVEL:.0%} by Student's t"
    " of the realizations' damage. With one realization there are none. Life is 1/damage, of the fibre with the most."
)


class _Mean(NamedTuple):
    """Of damage rates over realizations: mean [1/h], its variance and their number, in each sea state."""

    mean: xr.DataArray
    variance: xr.DataArray  # of the mean; NaN where one realization tells nothing of it
    number: xr.DataArray


def lives(data: xr.Dataset, variable: str = "damage", weights: Any = None) -> xr.Dataset:
    """`damage` [1/h] and `life` [s] over all sea states, dimension `estimate`: value, low, high at 95 %.

    variable: "damage" or "damage_top" of a collected dataset. D = Σ wⱼ d̄ⱼ/Σ wⱼ of the means d̄ⱼ over the nⱼ
    realizations of each sea state j, by weights w (sea_state,): its `occurrence`, else equal ones. The interval is
    D ± t s, not below zero, with s² = Σ (wⱼ/Σw)² sⱼ²/nⱼ of independent realizations and Student's t at the degrees of
    freedom of Welch and Satterthwaite, (Σ vⱼ)²/Σ vⱼ²/(nⱼ - 1). NaN: value where a sea state has no number, interval
    where one has a single realization. Life is 1/D, the interval's ends change places; of no damage it has no end.
    """
    return _estimates(_weighted(_means(_realized(data, variable)), data if weights is None else weights))


def _realized(data: xr.Dataset, variable: str) -> xr.DataArray:
    """A variable where a realization has a task of its own: a regular or still sea has one, whatever the seed."""
    import xarray as xr

    if "task" not in data or "seed" not in data["task"].dims:
        return data[variable]
    along: dict[str, Any] = {"input_core_dims": [["seed"]], "output_core_dims": [["seed"]], "vectorize": True}
    return data[variable].where(xr.apply_ufunc(once, data["task"].compute(), **along))


def _means(each: xr.DataArray) -> _Mean:
    """Over realizations, those that have a number."""
    each = each.expand_dims([dim for dim in ("seed", "sea_state") if dim not in each.dims])
    number = each.notnull().sum("seed")
    return _Mean(each.mean("seed"), each.var("seed", ddof=1) / number.where(number > 1), number)


def _weighted(of: _Mean, weights: Any) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """Mean over sea states, its standard error, and degrees of freedom."""
    w = occurrence(weights, of.mean)
    parts = w**2 * of.variance
    variance = parts.sum("sea_state", skipna=False)
    freedom = variance**2 / (parts**2 / (of.number - 1).where(of.number > 1)).sum("sea_state", skipna=False)
    return (w * of.mean).sum("sea_state", skipna=False), variance**0.5, freedom


def occurrence(weights: Any, values: xr.DataArray) -> xr.DataArray:
    """Shares of the sea states (sea_state,) that add up to one, from a dataset's `occurrence` or numbers."""
    import xarray as xr

    known = weights.coords.get("occurrence") if isinstance(weights, xr.Dataset) else weights
    if known is None:
        known = np.ones(values.sizes["sea_state"])
    w = xr.DataArray(np.broadcast_to(np.asarray(known, float), values.sizes["sea_state"]), dims="sea_state")
    return w / w.sum(skipna=False)


def _estimates(found: tuple[xr.DataArray, xr.DataArray, xr.DataArray]) -> xr.Dataset:
    import xarray as xr
    from scipy import stats

    mean, error, freedom = found
    with np.errstate(invalid="ignore", divide="ignore"):
        # Where no realization differs there is no scatter, and no degree of freedom either.
        half = (stats.t.ppf((1 + LEVEL) / 2, freedom) * error).where(error != 0, 0.0)
        damage = xr.concat([mean, (mean - half).clip(min=0.0), mean + half], dim="estimate").assign_coords(
            estimate=list(ESTIMATES)
        )
        life = HOUR / damage.where(~(damage <= 0), 0.0).isel(estimate=[0, 2, 1])
    life = life.assign_coords(estimate=list(ESTIMATES))
    damage.attrs, life.attrs = {"units": "h-1"}, {"units": "s"}
    return xr.Dataset({"damage": damage, "life": life})


def rows(data: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Of every platform and other label, at feet and tops: all seas together, and each by itself, as text."""
    for variable, end in AT.items():
        if variable not in data or not (values := _realized(data, variable).compute()).notnull().any():
            continue
        outer = [dim for dim in values.dims if dim not in ("seed", "sea_state", "leg", "fibre")]
        for labels in itertools.product(*(values[dim].values for dim in outer)):
            part = values.to_dataset(name=variable).sel(dict(zip(outer, labels, strict=True)))
            if part[variable].notnull().any():
                yield from _of_cell(part, variable, [str(label) for label in labels], end)


def _of_cell(part: xr.Dataset, variable: str, words: list[str], end: str) -> Iterator[tuple[str, ...]]:
    seas = np.atleast_1d(part["sea_state"].values).tolist() if "sea_state" in part[variable].dims else []
    chosen = [("all seas", part), *((str(sea), part.sel(sea_state=[sea])) for sea in seas if len(seas) > 1)]
    for name, some in chosen:
        found = lives(some, variable)
        first = found.damage.sel(estimate="value", drop=True)
        label = ", ".join([*words, *([name] if seas else [])])
        if first.isnull().all():
            yield (label, end, *["-"] * (len(HEADER) - 2))
            continue
        worst = first.argmax(["leg", "fibre"])
        at = found.isel(worst)
        where = f"{end} of leg {at.leg.values}, fibre {at.fibre.values}"
        yearly, years = at.damage.values * YEAR, at.life.values / HOUR / YEAR
        counts = some[variable].notnull().isel(worst)
        count = counts.sum("seed").values if "seed" in counts.dims else counts.values
        yield (
            label,
            where,
            *map(_text, yearly),
            *map(_text, years),
            "/".join(map(str, np.unique(np.asarray(count, int)))),
        )


def _text(number: float) -> str:
    return "-" if np.isnan(number) else f"{number:.3g}"


def print_lives(data: xr.Dataset, console: Console) -> None:
    """The table, where the study reckons damage; a narrow terminal wraps its lines."""
    lines = list(rows(data))
    if not lines:
        return
    widths = [max(map(len, column)) for column in zip(HEADER, *lines, strict=True)]
    console.print("Fatigue", style="bold")
    for line in (HEADER, *lines):
        cells = [w.ljust(n) if i < 2 else w.rjust(n) for i, (w, n) in enumerate(zip(line, widths, strict=True))]
        console.print("  ".join(cells), soft_wrap=True, highlight=False, markup=False)
    console.print(f"  {NOTE}", soft_wrap=True, highlight=False, markup=False)
