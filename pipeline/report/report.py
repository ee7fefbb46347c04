"""The printed table: our numbers beside those that others published, or a summary."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.segment import Segments
from rich.table import Table

from pipeline.report import bearing, best, energy, governing, life, ranking
from pipeline.report.governing import COMPONENTS, unit
from pipeline.report.published import Published
from pipeline.report.tables import Table as Answer
from pipeline.report.units import factor
from pipeline.report.yearly import FAILED, counted, realized
from pipeline.results.arrays import INNER
from pipeline.results.dataset import NO_TASK, once
from pipeline.results.variables import OF_RECORDS, meaning

if TYPE_CHECKING:
    import xarray as xr

    from pipeline.study.schema import StudyFile

OFF = 1 / 3  # a ratio further from 1 than this gets a star, and its sentence if realizations are few
WIDTH = 120  # characters that the table may need; a narrower terminal wraps them
# Of the largest of a variable, whose axes may differ in unit and floats in size: less is none of theirs.
ROUNDING = 1e-9
ENOUGH = 20  # realizations whose range says something about one more


@dataclass(frozen=True, kw_only=True)
class Ours:
    """Mean, least and largest of our number over the realizations, in the printed unit."""

    mean: float
    low: float
    high: float
    count: int  # of the realizations
    realizations: str = ""  # that it is the mean of, and how many failed

    def verdict(self, published: Published) -> str:
        """Whether the published number, as one realization more, falls into the range; empty if too few tell."""
        if self.count < ENOUGH or self.low == self.high:
            return ""
        near = self.low - published.rounding <= published.value <= self.high + published.rounding
        return "inside" if near else "outside"

    def said(self, published: Published) -> bool:
        """Whether the published number needs its sentence."""
        verdict = self.verdict(published)
        return verdict == "outside" if verdict else self.off(published)

    def off(self, published: Published) -> bool:
        """Whether it is more than a third away."""
        return not abs(self.mean - published.value) <= OFF * abs(published.value)


def ours(data: xr.Dataset, row: Published) -> Ours | None:
    """Our number: extremes are means of each record's extreme; None if it has not been computed."""
    each = realizations(data, row)
    if each is None or (numbers := each.values[~np.isnan(each.values)]).size == 0:
        return None
    extremes = {"low": float(numbers.min()), "high": float(numbers.max())}
    return Ours(mean=float(numbers.mean()), count=numbers.size, realizations=counted(each), **extremes)


def realizations(data: xr.Dataset, row: Published) -> xr.DataArray | None:
    """Our number in every realization, in the printed unit; None if variable, label or unit are not the dataset's.

    Of all else that a study varies the first label is the published one; of platforms the first that has numbers.
    A statistic with a leading minus counts the other way round: "-min" is minus the minimum.
    """
    if row.variable not in data or not _same_unit(data, row):
        return None
    places: dict[Any, list[int]] = {dim: [0] for dim in data[row.variable].dims if dim not in ("platform", "seed")}
    for dim, labels in _wanted(row).items():
        if dim in data[row.variable].dims:
            places[dim] = [i for i, label in enumerate(data[dim].values.tolist()) if str(label) in labels]
        if not places.get(dim, dim in data.coords and str(data[dim].values) in labels):
            return None
    tasks = [name for name in ("task", "status") if name in data and "seed" in data[row.variable].dims]
    part = data[[row.variable, *tasks]].isel(places, missing_dims="ignore")
    values = realized(part, part[row.variable])
    values = values.isel({dim: 0 for dim, at in places.items() if len(at) == 1 and dim != "seed"})
    failed, over = values[FAILED], [dim for dim, at in places.items() if len(at) > 1 and dim != "seed"]
    values = values.drop_vars(FAILED).mean(over)
    values = values.assign_coords({FAILED: failed.any([dim for dim in over if dim in failed.dims])})
    return first_known(values, "platform") / (-row.scale if row.statistic.startswith("-") else row.scale)


def strange(data: xr.Dataset, rows: Sequence[Published], study: StudyFile) -> list[str]:
    """Rows that name what this study does not have, though it has their sea and platform: file, row, key and limit."""
    platform = study.platform
    own = {  # labels of records that are known before these are
        "float": [f.name for f in study.floats],
        "leg": [str(leg) for leg in range(1, len(platform.legs) + 1)] if platform else [],
        "member": [member.name for member in platform.members] if platform else [],
    }
    return [f"{row.file}: {row.place}: {words}" for row in rows for words in _strange(data, row, own)]


def _strange(data: xr.Dataset, row: Published, own: Mapping[str, list[str]]) -> Iterator[str]:
    wanted = _wanted(row)
    there = {dim: [*map(str, np.atleast_1d(data[dim].values).tolist())] for dim in wanted if dim in data.coords}
    if any(not {*there[dim]} & {*wanted[dim]} for dim in ("sea_state", "platform") if dim in there and dim in wanted):
        return  # a study that stands on another may be of other seas
    ran = "status" not in data or bool(data["status"].isin(["done", "stale", NO_TASK]).all())
    if row.variable not in data:
        if ran:
            yield f"variable = {row.variable}: is no output of this study"
        return
    dims = data[row.variable].dims
    for dim, labels in wanted.items():
        key = dim if dim == "statistic" else f"selection {dim}"
        if dim not in there or not (dim in dims or data[dim].ndim == 0):
            yield f"{key} = {'+'.join(labels)}: must be left out: {row.variable} has {', '.join(map(str, dims))}"
            continue
        known = there[dim]
        if dim in INNER and not ran:  # labels of the records' own are known when all tasks have run, or by the study
            known = own.get(dim) or labels
        if lacking := [label for label in labels if label not in known]:
            yield f"{key} = {'+'.join(lacking)}: must be {', '.join(known)}"
    if not _same_unit(data, row):
        yield f"unit = {row.unit!r}: must be that of the axis that the selection names, of {', '.join(row.own)}"


def _wanted(row: Published) -> dict[str, list[str]]:
    """Labels of ours by dimension."""
    return row.selection | ({"statistic": [row.statistic.removeprefix("-")]} if row.statistic else {})


def _same_unit(data: xr.Dataset, row: Published) -> bool:
    """Whether the printed unit is one of the variable's along the axis that is compared."""
    values = data[row.variable]
    axis = row.selection.get(
        "axis", [str(label) for label in values["axis"].values[:1]] if "axis" in values.dims else []
    )
    own = meaning(row.variable, axis).get("units") if axis else values.attrs.get("units")
    return own is None or factor(row.unit, own) is not None


def first_known(values: xr.DataArray, dim: str) -> xr.DataArray:
    """At the first label along a dimension that has numbers."""
    if dim not in values.dims:
        return values
    known = values.notnull().any([other for other in values.dims if other != dim])
    return values.isel({dim: int(known.argmax(dim))})


def tables(data: xr.Dataset, rows: Sequence[Published]) -> dict[str, list[tuple[Published, Ours | None]]]:
    """Published and ours by the table's title, where there is anything of ours."""
    beside: dict[str, list[tuple[Published, Ours | None]]] = {}
    for row in rows:
        beside.setdefault(row.table, []).append((row, ours(data, row)))
    return {title: mine for title, mine in beside.items() if any(number for _, number in mine)}


def speaks(data: xr.Dataset, rows: Sequence[Published]) -> bool:
    """Whether the published tables say all that there is; a study that is made from another is of other seas."""
    return bool(rows) and len(tables(data, rows)) == len({row.table for row in rows})


def print_tables(data: xr.Dataset, rows: Sequence[Published], console: Console, study: StudyFile) -> None:
    """Print every table, and a sentence for each number that is far off."""
    for title, mine in tables(data, rows).items():
        table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)
        for name in ("", "", "theirs", "ours", "[least, largest]", "ratio", "verdict", "unit", "realizations"):
            table.add_column(name, justify="left" if name in ("", "verdict", "unit") else "right", no_wrap=True)
        for row, number in mine:
            table.add_row(*map(escape, line(row, number)))
        _print_whole(table, console)
        for sentence in sentences(mine):
            console.print(f"  * {sentence}", soft_wrap=True, highlight=False, markup=False)
        console.print()
    for words in strange(data, rows, study):
        console.print(words, soft_wrap=True, highlight=False, markup=False)
    if words := verdicts(data, rows):
        console.print(words, soft_wrap=True, highlight=False, markup=False)


def verdicts(data: xr.Dataset, rows: Sequence[Published]) -> str:
    """How many numbers are inside, and how often they would be if they came from the same process."""
    judged = [(row, number) for row in rows if (number := ours(data, row)) is not None and number.verdict(row)]
    if not judged:
        return ""
    inside = sum(number.verdict(row) == "inside" for row, number in judged)
    counts = {number.count for _, number in judged}
    # The range of n holds one more of the same with this chance, whatever the distribution.
    chance = "; ".join(f"{(n - 1) / (n + 1):.1%} of {n}" for n in sorted(counts))
    return (
        f"{inside} of {len(judged)} published numbers lie inside [least, largest]; "
        f"one more realization of ours would, with a chance of {chance} realizations."
    )


def line(row: Published, number: Ours | None) -> tuple[str, ...]:
    """A row of a table, as text."""
    count = number.realizations if number is not None else ""
    return row.label, row.statistic, row.text, *cells(row, number), row.unit, count


def cells(row: Published, number: Ours | None) -> list[str]:
    """Ours, its range, the ratio with a star if it is far off, and the verdict, as text."""
    if number is None:
        return ["-", "", "", ""]
    ratio = f"{number.mean / row.value:z.2f}" if row.value and math.isfinite(number.mean) else ""
    spread = "" if number.low == number.high else f"[{number.low:z.4g}, {number.high:z.4g}]"
    return [f"{number.mean:.4g}", spread, ratio + (" *" if number.off(row) else ""), number.verdict(row)]


def sentences(mine: list[tuple[Published, Ours | None]]) -> Iterator[str]:
    """Why a number is outside or far off; numbers with the same reason share the sentence."""
    reasons: dict[str, list[str]] = {}
    for row, number in mine:
        if number is not None and number.said(row):
            name = f"{row.label} {row.statistic}".strip()
            reasons.setdefault(row.note or "not explained yet.", []).append(name)
    for note, names in reasons.items():
        yield f"{'; '.join(names)}: {note}"


def answers(data: xr.Dataset) -> list[Answer]:
    """What a study is for, as far as it is of that: the best designs, energy, governing seas, steel and its life."""
    return [of.table(data) for of in (best, ranking, energy, governing, bearing, life)]


def estimated(data: xr.Dataset) -> str:
    """What records say of the error of any mean, rms or std: the range over tasks, whose the largest is, and what is
    not judged."""
    each = data["estimated_error"].compute() if "estimated_error" in data else None
    if each is None or each.isnull().all():
        return ""
    worst = each.isel(each.argmax(...))
    least, largest = (f"{float(end):.1e}" for end in (each.min(), worst))
    at = ", ".join(f"{dim}={worst[dim].values}" for dim in each.dims if each.sizes[dim] > 1)
    text = largest if not at or least == largest else f"{least} to {largest}, the largest of {at}"
    unjudged = ", ".join(name for name in governing.ASKED_FOR if name in data)
    return f"{text}; not of {unjudged}" if unjudged else text


def print_summary(data: xr.Dataset, console: Console) -> None:
    """Where published numbers do not say it: mean and range of every variable that has statistics."""
    table = Table(box=None, pad_edge=False)
    for name in ("variable", "statistic", "mean", "least", "largest", "unit"):
        table.add_column(name, justify="left" if name in ("variable", "statistic", "unit") else "right", no_wrap=True)
    for row in summary_rows(data):
        table.add_row(*row)
    _print_whole(table, console)


def _print_whole(table: Table, console: Console) -> None:
    """A narrow terminal wraps lines and cuts no number."""
    wide = console.options.update(width=max(console.width, WIDTH))  # print() itself keeps to the terminal
    console.print(Segments(console.render(table, wide)), end="", crop=False, soft_wrap=True)


def summary_rows(data: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Variable, statistic, mean, least, largest and unit, as text, of each component that there is.

    What is rounding beside the variable's largest is 0, as the force of a hinge along an axis that it leaves free.
    Electrical power of a float without an efficiency is what it absorbs, as in its energy.
    """
    # Of a regular sea there is one task, whatever the seed.
    own = data["task"].copy(data=once(data["task"].values)) if "task" in data else True
    for label in data.data_vars:
        known = "statistic" in data[label].dims or label in OF_RECORDS
        if not known or (values := data[label].compute()).isnull().all():
            continue
        if label == "electrical_power":
            values = values.fillna(data["absorbed_power"].compute())
        values = values.where(own)
        if label in OF_RECORDS:
            values = values.expand_dims(statistic=[""])
        size = abs(values)
        values = values.where(~(size < ROUNDING * size.max()), 0.0)
        along = [dim for dim in COMPONENTS if dim in values.dims]
        for at in itertools.product(*(values[dim].values for dim in along)):
            component = values.sel(dict(zip(along, at, strict=True)))
            if at and not component.fillna(0.0).any() and size.max() > 0:
                continue  # such as what leaves the plane of a scene that stays in it
            name = " ".join(map(str, (label, *at)))
            of = unit(values, along, at)
            for statistic in values.statistic.values:
                part = component.sel(statistic=statistic)
                figures = (f"{float(f()):z.4g}" for f in (part.mean, part.min, part.max))
                yield (name, str(statistic), *figures, of)
