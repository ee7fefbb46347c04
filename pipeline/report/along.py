"""Power and motion along an axis of a study: of numbers, of words such as variants, of samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report.drawing import PAPER, canvas, categories, lanes, ratios
from pipeline.report.figures import (
    CROSS,
    PANELS,
    ROOM,
    SUPPORT,
    Measure,
    Results,
    draw_spread,
    finite,
    key,
    ring,
    series,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

VARIANT = "variant"
REGULAR = ("wave_height", "wave_period")  # which keys of a regular sea are, that stand there by themselves
MOST = 6  # quantities that change together which have a row of panels each
DECADE = 10.0  # largest over smallest number, from which equal ratios have a logarithmic scale
EVEN = 0.25  # of their mean, by which steps of the logarithm may differ from it: 1, 2, 5, 10, 20 are even
MANY, LOW = 8, 0.25  # so many numbers of which half lie in the lowest quarter, as samples of even ratios do


def along(results: Results, dim: str) -> Figure | None:
    """A panel for each quantity; words stand in rows, numbers that change together have a row of panels each."""
    labels, words = results.labels(dim), in_rows(results, dim)
    shown = [quantity for quantity in results.measures if _any(results, quantity, dim)][:PANELS]
    if not shown or len(labels) < 2:
        return None
    shown = [results.fitted(quantity, _shown(results, quantity, dim)) for quantity in shown]
    across = [dim] if words else abscissae(results, dim)
    figure = canvas(9.0, 1.2 + 0.45 * len(labels[:ROOM]) if words else 0.4 + 3.0 * len(across))
    grid = figure.subplots(len(across), len(shown), sharey=words, squeeze=False)
    for name, row in zip(across, grid, strict=True):
        for axes, quantity in zip(row, shown, strict=True):
            if words:
                _draw_words(axes, results, quantity, dim)
            else:
                _draw_numbers(axes, results, quantity, dim, name)
    marks = {
        sea: mark for sea, mark in results.marked.items() if any(_any(results, each, dim, [sea]) for each in shown)
    }
    key(figure, results, shown[-1].variable, {} if words else marks)
    return figure


def in_rows(results: Results, dim: str) -> bool:
    """Whether an axis is one of words."""
    return bool(_words(results, dim))


def _words(results: Results, dim: str) -> list[str]:
    """An axis's labels; where these are numbers that count what goes together in words alone, those; else none."""
    labels = results.labels(dim)
    if not labels or isinstance(labels[0], str):
        return labels
    told = [str(name) for name, c in results.data.coords.items() if c.dims == (dim,) and c.dtype.kind in "UOT"]
    varied = [results.labels(name) for name in told if len({*results.labels(name)}) > 1]
    return [", ".join(map(str, row)) for row in zip(*varied, strict=True)] if abscissae(results, dim) == [dim] else []


def abscissae(results: Results, dim: str) -> list[str]:
    """What stands along x: numbers that go with the labels where there are some, as with samples; or the labels."""
    beside = [str(name) for name, c in results.data.coords.items() if c.dims == (dim,) and c.dtype.kind in "iuf"]
    varied = [name for name in beside if name not in (dim, *REGULAR) and np.unique(results.data[name].values).size > 1]
    return varied[:MOST] or [dim]


def in_ratios(places: np.ndarray) -> bool:
    """Whether numbers are even in the logarithm, over a decade or more, or scattered so; two are even on any scale."""
    known = np.unique(places)
    if known.size < 3 or not 0 < DECADE * known[0] <= known[-1]:
        return False
    steps = np.diff(np.log(known))
    crowded = known.size >= MANY and np.median(known) - known[0] < LOW * np.ptp(known)
    return bool(crowded or (abs(steps - steps.mean()) <= EVEN * steps.mean()).all())


def _values(results: Results, quantity: Measure, dim: str, sea: str) -> xr.DataArray:
    others = {name: label for name, label in results.first.items() if name != dim}
    return results.of(quantity, sea_state=sea, **others)


def drawn(results: Results, dim: str) -> dict[str, list[Any]]:
    """The sea states and labels that there is room for: where words stand in rows one sea."""
    words = in_rows(results, dim)
    seas = [results.sea] if words else list(results.marked)
    return {"sea_state": seas, dim: results.labels(dim)[: ROOM if words else None]}


def _shown(results: Results, quantity: Measure, dim: str) -> xr.DataArray:
    others = {name: label for name, label in results.first.items() if name != dim}
    return results.of(quantity, **others).sel(drawn(results, dim))


def _any(results: Results, quantity: Measure, dim: str, seas: Sequence[str] = ()) -> bool:
    """Whether there are numbers to draw, of these sea states or of any."""
    part = drawn(results, dim)
    among = seas or part["sea_state"]
    return any(finite(_values(results, quantity, dim, sea).sel({dim: part[dim]})).size > 0 for sea in among)


def _draw_words(axes: Axes, results: Results, quantity: Measure, dim: str) -> None:
    """A row for each word; published numbers stand beside the first variant's."""
    labels = results.labels(dim)[:ROOM]
    values, every = _values(results, quantity, dim, results.sea), list(series(results, quantity.variable))
    categories(axes, _words(results, dim)[:ROOM])
    for (item, support, look), lane in zip(every, lanes(len(every)), strict=True):
        for row, label in enumerate(labels):
            part = values.sel({"platform": [support], "float": [item], dim: [label]})
            draw_spread(axes, part, quantity.scale, row + lane, look)
        theirs = {"sea_state": results.sea, "platform": support, "float": item}
        known = results.theirs(quantity.variable, quantity.statistic, **theirs) if dim == VARIANT else None
        if known is not None:
            axes.plot(known / quantity.scale, lane, CROSS, color=PAPER, markeredgewidth=1.1)
    axes.locator_params(axis="x", nbins=6)
    axes.set_xlabel(quantity.words)


def _draw_numbers(axes: Axes, results: Results, quantity: Measure, dim: str, name: str) -> None:
    """Means over the numbers called `name`, joined by lines unless they are samples, of each sea state if they are few.

    If one is infinite, which no scale has a place for, they stand one after another; on a logarithmic scale if they are
    spaced so.
    """
    places = results.data[name].values
    if not np.isfinite(places).all():
        known, places = np.unique(places, return_inverse=True)
        axes.set_xticks(range(len(known)), [f"{number:g}" for number in known])
    style: dict[str, Any] = {"linestyle": "" if dim == "sample" else "-", "linewidth": 1.0}
    for sea, marker in results.marked.items():
        values = _values(results, quantity, dim, sea)
        for item, support, look in series(results, quantity.variable):
            shown = {**look, "marker": marker} if len(results.marked) > 1 else look
            part = values.sel({"platform": support, "float": item})
            means = [finite(part.isel({dim: i})) / quantity.scale for i in range(len(places))]
            kept = sorted((place, numbers.mean()) for place, numbers in zip(places, means, strict=True) if numbers.size)
            axes.plot(*np.array(kept).reshape(-1, 2).T, label=f"{item}, {SUPPORT[support]}", **style, **shown)
            for i, (place, numbers) in enumerate(zip(places, means, strict=True)):
                if numbers.size:
                    axes.vlines(place, numbers.min(), numbers.max(), color=look["color"], linewidth=1.0)
                    ring(axes, part.isel({dim: i}), place, numbers.mean(), look["color"])
    if in_ratios(places):
        ratios(axes, places)
    elif np.isfinite(results.data[name].values).all():
        axes.locator_params(axis="x", nbins=6)
    axes.set_ylabel(quantity.words)
    unit = results.data[name].attrs.get("units", "1")
    axes.set_xlabel(name.replace("_", " ") + (f" [{unit}]" if unit != "1" else ""))
