"""Every task as a dot: how much extremes differ between realizations, and how large each run estimates its errors."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from pipeline.report.drawing import INK, PAPER, canvas, categories, colour, decades, lanes
from pipeline.report.figures import AUDIT, CROSS, FORCE, NAUGHT, SUPPORT, Results, finite, key, say_empty, series
from pipeline.report.sketch import first_scene
from pipeline.results.dataset import once

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LETTERS = 110  # of words below axes all across a figure


def directions(results: Results) -> list[str]:
    """Components of the hinge force that are not zero in what is shown: a planar scene has no y force, and of a body
    that slides in still water all is rounding beside its weight."""
    from pipeline.bridge import scenes

    values = results.values(FORCE, **results.first_of(FORCE))
    largest = {d: float(np.abs(finite(values.sel(direction=d))).max(initial=0.0)) for d in results.labels("direction")}
    scene = first_scene(results.study.content)
    weights = [item.mass * scene.water.gravity for item in scenes.floats(scene)]
    return [d for d, size in largest.items() if size > NAUGHT * max([*largest.values(), *weights])]


def hinge_forces(results: Results) -> Figure | None:
    """Largest and least force of every realization, float and sea state."""
    shown = directions(results) if results.has(FORCE) else []
    if not shown:
        return None
    floats, values = results.labels("float"), results.values(FORCE, **results.first_of(FORCE))
    figure = canvas(9.0, len(floats) * (0.8 + min(0.36 * len(results.sea_names), 10.0)))
    grid = figure.subplots(len(floats), len(shown), sharex="col", sharey=True, squeeze=False)
    for item, row in zip(floats, grid, strict=True):
        for direction, axes in zip(shown, row, strict=True):
            _extremes(axes, results, values.sel(float=item, direction=direction))
        row[0].set_title(item)
    for direction, axes in zip(shown, grid[-1], strict=True):
        axes.set_xlabel(f"{direction} force of the hinge on the float [{results.force[0]}]")
    key(figure, results, FORCE)
    return figure


def _extremes(axes: Axes, results: Results, values: xr.DataArray) -> None:
    """Two clouds a sea state: the least and the largest force of each realization, of a float along a direction."""
    item, direction = values["float"].item(), values["direction"].item()
    names = [name.splitlines()[0] for name in results.sea_names]
    categories(axes, names)
    axes.axvline(0.0, color=INK, linewidth=0.6)
    rows = [entry for entry in series(results, FORCE) if entry[0] == item]
    for place, sea in enumerate(results.seas):
        if not finite(values.sel(sea_state=sea)).size:
            say_empty(axes, place)
    for (_, support, look), lane in zip(rows, lanes(len(rows)), strict=True):
        for place, sea in enumerate(results.seas):
            for statistic in ("max", "min"):
                numbers = finite(values.sel(platform=support, sea_state=sea, statistic=statistic)) / results.force[1]
                axes.plot(numbers, np.full(numbers.size, place + lane), linestyle="", **look)
                labels = {"sea_state": sea, "platform": support, "float": item, "direction": direction}
                theirs = results.theirs(FORCE, statistic, **labels)
                if theirs is not None:
                    axes.plot(theirs / results.force[1], place + lane, CROSS, color=PAPER, markeredgewidth=1.1)


def audit(results: Results) -> Figure | None:
    """Energy residual, estimated error and wall time of every task, but for what is exactly zero in all."""
    shown = [(name, words) for name, words in AUDIT if results.has(name) and finite(results.values(name)).any()]
    if not shown:
        return None
    supports = results.labels("platform")
    texts = [textwrap.wrap(words, int(LETTERS / len(shown))) for _, words in shown]
    figure = canvas(9.0, 0.85 + 0.15 * max(map(len, texts)) + 0.45 * len(supports))
    rows = figure.subplots(1, len(shown), sharey=True, squeeze=False)[0]
    for axes, (name, _), lines in zip(rows, shown, texts, strict=True):
        values = results.values(name).where(once(results.values("task").values))
        every = np.abs(finite(values))
        every = every[every > 0]  # a logarithm has no place for exact zeros
        if every.size:
            decades(axes, float(every.min()), float(every.max()))
        categories(axes, [SUPPORT.get(str(s), str(s)) for s in supports])
        axes.set_xlabel("\n".join(lines))
        for place, support in enumerate(supports):
            numbers = np.abs(finite(values.sel(platform=support)))
            numbers = numbers[numbers > 0]
            height = place + np.linspace(-0.25, 0.25, numbers.size) if numbers.size > 1 else np.array([place])
            axes.plot(numbers, height[: numbers.size], "o", color=colour(0), alpha=0.6)
    return figure
