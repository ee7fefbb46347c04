"""Figures of a collected dataset; each is None if its variables are missing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.report.drawing import INK, MARKERS, PAPER, above, canvas, categories, colour, lanes, marker, together
from pipeline.report.published import Published
from pipeline.report.tables import SURVIVORS, prefix
from pipeline.report.yearly import FAILED, realized
from pipeline.results.variables import axis_units
from pipeline.study.seas import height
from pipeline.tasks.study import Study
from pipeline.tasks.task import axes as axes_of
from pipeline.tasks.task import first_labels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHOWN = ("sea_state", "platform", "seed")  # axes that every figure goes along, or over
SUPPORT = {"elastic": "elastic", "fixed": "fixed", "elastic-no-floats": "no floats"}
ROOM = 24  # sea states in one figure
LINES = 12  # of floats in sea states on one platform that can be told apart
RINGED = " Ringed: some realizations have no numbers."
RING = 70.0  # square points, about a mark
CROSS = "x"  # marks a published number
NAUGHT = 1e-6  # share of the largest below which a component is zero but for rounding
PANELS = 4  # measures side by side


class Measure(NamedTuple):
    """What an axis shows: a variable's statistic in a unit that is so many SI units; its name in titles."""

    name: str
    variable: str
    statistic: str
    words: str
    scale: float
    axis: str = ""  # of a joint, which motion is along


POWER, FORCE, MOTION = "absorbed_power", "hinge_force", "motion"
ROTATION = Measure("rotation", "rotation", "rms", "RMS rotation [rad]", 1.0)
AUDIT = (
    ("energy_residual", "energy residual [share of the largest energy exchanged]"),
    ("estimated_error", "estimated error of any mean, rms or std [relative]"),
    ("wall_time", "wall time of a task [s]"),
)


@dataclass(frozen=True, kw_only=True)
class Results:
    """A study, its dataset and the published numbers."""

    study: Study
    data: xr.Dataset
    published: Sequence[Published] = ()
    tasks: Path | None = None  # the folder of the tasks' records, for time series

    def has(self, /, *names: str, **labels: Any) -> bool:
        """Whether there are numbers under all of these names, or in the part with these labels."""
        return all(name in self.data and bool(self.values(name, **labels).notnull().any()) for name in names)

    def values(self, name: str, /, **labels: Any) -> xr.DataArray:
        """A variable with all axes of a study as dimensions, or the part of it with these labels."""
        return self._part(self.data[name], labels)

    def survivors(self, names: Sequence[str], held: Mapping[str, Any], drawn: Mapping[str, Sequence[Any]]) -> str:
        """A sentence where a mean that is drawn of these variables leaves out realizations that failed."""
        every = (self._part(realized(self.data, self.data[name]), held).sel(drawn) for name in names)
        return SURVIVORS if any((each[FAILED] & each.notnull().any("seed")).any() for each in every) else ""

    def ringed(self, names: Sequence[str], held: Mapping[str, Any], drawn: Mapping[str, Sequence[Any]]) -> str:
        """A sentence where something that is drawn of these variables is of fewer realizations than there are."""
        there = [self.values(name, **held).sel(drawn).notnull() for name in names]
        return RINGED if any((each.any("seed") & ~each.all("seed")).any() for each in there) else ""

    def _part(self, values: xr.DataArray, labels: Mapping[str, Any]) -> xr.DataArray:
        for dim in axes_of(self.study.content):
            if dim not in values.dims:
                values = values.expand_dims({dim: 1} if dim not in values.coords else [dim])
        return values.sel({key: [label] for key, label in labels.items()})

    def labels(self, dim: str) -> list[Any]:
        """Labels along an axis, one if the study does not vary it."""
        return np.atleast_1d(self.data[dim].values).tolist() if dim in self.data.coords else []

    @cached_property
    def _start(self) -> dict[str, Any]:
        """The first task's label along every axis that figures do not show unless they are about it."""
        labels = first_labels(self.study.content)
        return {dim: label for dim, label in labels.items() if dim not in SHOWN and self.labels(dim)}

    @cached_property
    def known(self) -> str:
        """The variable that has numbers where a task has come to something to show; empty if there is none."""
        return next((name for name in (POWER, ROTATION.variable, "wall_time") if self.has(name)), "")

    @cached_property
    def first(self) -> dict[str, Any]:
        """What figures hold: the first task's labels, or others if it has come to nothing in the sea that is shown."""
        return self.first_of(self.known) if self.known else self._start

    def first_of(self, name: str, /, **given: Any) -> dict[str, Any]:
        """The first task's labels, or the first others with numbers of a variable, in the sea shown or at those given.

        Axis by axis: each label is one that has numbers with those before it, on as many platforms as any.
        """
        there = self.values(name, **{"sea_state": self.sea} | given).notnull()
        held = {}
        for dim, first in self._start.items():
            labels, label = there[dim].values.tolist(), given.get(dim, first)
            some = there.any([other for other in there.dims if other not in (dim, "platform")]).sum("platform")
            known = [one for one in (label, *labels) if one in labels and some.sel({dim: one})]
            held[dim] = max(known, key=lambda one: int(some.sel({dim: one})), default=label)
            there = there.sel({dim: [held[dim]]})
        return held

    @property
    def varied(self) -> list[str]:
        """The axes of `first` that have several labels."""
        return [dim for dim in self.first if len(self.labels(dim)) > 1]

    @property
    def seas(self) -> list[str]:
        """The sea states that a figure has room for."""
        return [str(label) for label in self.labels("sea_state")[:ROOM]]

    @property
    def marked(self) -> dict[str, str]:
        """Markers of sea states along an axis of numbers: of all if these and floats are few, else of the one shown."""
        every = [str(label) for label in self.labels("sea_state")]
        few = len(every) <= len(MARKERS) and len(every) * len(self.labels("float")) <= LINES
        return dict(zip(every if few else [self.sea], MARKERS, strict=False))

    @cached_property
    def sea(self) -> str:
        """The one that the published numbers are for, otherwise the highest; of those with numbers, if any has."""
        every = self.labels("sea_state")
        there = [label for label in every if self.known and self.has(self.known, sea_state=label)] or every
        named = [label for row in self.published for label in row.selection.get("sea_state", []) if label in there]
        return str(max(named, key=named.count)) if named else self.highest(there)

    def highest(self, seas: Sequence[str]) -> str:
        """Of these sea states the highest that designs are to work in, by the first task's numbers."""
        heights = np.nan_to_num(self.numbers("Hs", "wave_height", held=self._start))
        size = dict(zip(self.labels("sea_state"), heights, strict=True))
        states, survival = self.study.content.sea_states, self.study.content.survival
        calm = [sea for sea in seas if survival is None or height(states[sea]) <= survival.Hs]
        return str(max(calm or seas, key=size.__getitem__))

    def numbers(self, *names: str, held: Mapping[str, Any] | None = None) -> np.ndarray:
        """A number for each sea state, as it is shown, from the first of these coordinates that has one; else NaN."""
        labels = self.first if held is None else held
        per_sea = np.full(len(self.labels("sea_state")), np.nan)
        for name in reversed(names):
            if name in self.data.coords:
                values = self.data[name].sel({dim: labels[dim] for dim in labels if dim in self.data[name].dims}).values
                per_sea = np.where(np.isfinite(values), values, per_sea)
        return per_sea

    @cached_property
    def measures(self) -> list[Measure]:
        """Power, rotation and motion along other axes of joints, as far as they are there and not zero throughout."""
        every = [*([self.power] if POWER in self.data else []), ROTATION, *self._motions]
        there = [quantity for quantity in every if self.has(quantity.variable)]
        return [quantity for quantity in there if _some(self.of(quantity), self.data[quantity.variable])]

    @property
    def _motions(self) -> list[Measure]:
        """First those along axes that most floats have."""
        if not self.has(MOTION):
            return []
        floats = {
            axis: -int(self.values(MOTION, axis=axis).max(axes_of(self.study.content)).count())
            for axis in self.labels("axis")
        }
        axes = sorted((axis for axis in floats if axis != "hinge"), key=floats.__getitem__)
        units = dict(zip(axes, axis_units(axes), strict=True))
        return [Measure(axis, MOTION, "rms", f"RMS {axis} [{units[axis]}]", 1.0, axis) for axis in axes]

    def of(self, quantity: Measure, /, **labels: Any) -> xr.DataArray:
        """What a measure shows, in the dataset's unit, or the part of it with these labels."""
        along = {"axis": quantity.axis} if quantity.axis else {}
        return self.values(quantity.variable, statistic=quantity.statistic, **along, **labels)

    @cached_property
    def power(self) -> Measure:
        """Mean absorbed power, in the unit that suits it."""
        return self.fitted(Measure("power", POWER, "mean", "", 1.0), self.data[POWER].sel(statistic="mean"))

    def fitted(self, quantity: Measure, shown: xr.DataArray) -> Measure:
        """A measure in the unit that suits the numbers that are shown."""
        if quantity.variable != POWER:
            return quantity
        unit, scale = prefix(shown)
        return quantity._replace(words=f"mean absorbed power [{unit}W]", scale=scale)

    @cached_property
    def force(self) -> tuple[str, float]:
        """Unit of hinge forces and its factor."""
        unit, scale = prefix(self.values(FORCE, **self.first_of(FORCE)))
        return f"{unit}N", scale

    @property
    def carrying(self) -> dict[str, str]:
        """What elastic platforms are told apart by; nothing in a study without floats."""
        words = {"elastic": "with floats", "elastic-no-floats": "no floats"}
        return words if self.labels("float") else dict.fromkeys(words, "")

    def supports(self, name: str) -> list[str]:
        """The platforms for which a variable has numbers."""
        values = self.values(name)
        return [str(p) for p in self.labels("platform") if values.sel(platform=p).notnull().any()]

    def theirs(self, variable: str, statistic: str, **labels: str) -> float | None:
        """The published number with just these labels, SI."""
        wanted = {key: [label] for key, label in labels.items()}
        rows = (r for r in self.published if (r.variable, r.statistic, r.selection) == (variable, statistic, wanted))
        return next((row.value * row.scale for row in rows), None)

    @cached_property
    def sea_names(self) -> list[str]:
        """Sea states as 2017, and 1.39 m, 5.65 s in a line below."""
        heights, periods = self.numbers("Hs", "wave_height"), self.numbers("Tp", "wave_period")
        rows = zip(self.seas, heights, periods, strict=False)  # figures have less room than studies
        return [f"{n}\n{h:#.3g} m, {t:#.3g} s" if np.isfinite([h, t]).all() else n for n, h, t in rows]


def _some(part: xr.DataArray, whole: xr.DataArray) -> bool:
    """Whether there is more than rounding beside the largest of a variable."""
    return bool((abs(part) > NAUGHT * abs(whole).max()).any())


def finite(values: xr.DataArray) -> np.ndarray:
    """All numbers, in a row."""
    flat = values.values.ravel()
    return np.asarray(flat[np.isfinite(flat)])


def series(results: Results, name: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Every float on every platform: float, platform, and how its marks look."""
    supports = results.supports(name)
    for i, item in enumerate(results.labels("float")):
        for support in supports:
            face = colour(i) if support == "elastic" or len(supports) == 1 else "white"
            yield item, support, {"color": colour(i), "marker": marker(i), "markerfacecolor": face}


def draw_spread(axes: Axes, values: xr.DataArray, scale: float, place: float, look: dict[str, Any]) -> bool:
    """Mean of realizations as a dot at a place on the y axis, least and largest as a line through it; if there are
    any."""
    numbers = finite(values) / scale
    if numbers.size:
        axes.plot([numbers.min(), numbers.max()], [place] * 2, color=look["color"], linewidth=1.0)
        axes.plot(numbers.mean(), place, linestyle="", **look)
        ring(axes, values, numbers.mean(), place, look["color"])
    return bool(numbers.size)


def ring(axes: Axes, values: xr.DataArray, x: float, y: float, shade: str) -> None:
    """About the mark of a mean, where some realizations have no numbers."""
    if not values.notnull().any([dim for dim in values.dims if dim != "seed"]).all():
        axes.scatter([x], [y], s=RING, facecolors="none", edgecolors=shade, linewidths=0.8)


def say_empty(axes: Axes, row: int) -> None:
    """In a row that has no marks."""
    axes.text(0.02, row, "no numbers", transform=axes.get_yaxis_transform(), va="center", fontsize="small")


def draw_sea_states(axes: Axes, results: Results, quantity: Measure) -> None:
    """Mean over realizations with least and largest, and the published number, for each sea state."""
    values = results.of(quantity, **results.first).sel(sea_state=results.seas)
    _, name, statistic, words, scale, _ = results.fitted(quantity, values)
    every = list(series(results, name))
    categories(axes, results.sea_names)
    empty = set(range(len(results.seas)))
    for (item, support, look), lane in zip(every, lanes(len(every)), strict=True):
        for row, sea in enumerate(results.seas):
            part = values.sel(platform=[support], float=[item], sea_state=[sea])
            if not draw_spread(axes, part, scale, row + lane, look):
                continue
            empty.discard(row)
            theirs = results.theirs(name, statistic, sea_state=sea, platform=support, float=item)
            if theirs is not None:
                axes.plot(theirs / scale, row + lane, CROSS, color=PAPER, markeredgewidth=1.1)
    for row in empty:
        say_empty(axes, row)
    axes.locator_params(axis="x", nbins=6)
    axes.set_xlabel(words)


def crossed(figure: Figure) -> bool:
    """Whether published numbers are in a drawn figure: a study that stands on another may have none of its labels."""
    return any(line.get_marker() == CROSS for axes in figure.axes for line in axes.lines)


def key(figure: Figure, results: Results, name: str, markers: Mapping[str, str] | None = None) -> None:
    """What the marks of a drawn figure mean, above it; of sea states, if there are several, their markers.

    Where lines have names, those that hide one another everywhere stand together.
    """
    from matplotlib.lines import Line2D

    several = len(results.supports(name)) > 1
    looks = {f"{item}, {SUPPORT[support]}": look for item, support, look in series(results, name)}
    marks = []
    for group in together(figure.axes, looks) or [[label] for label in looks]:
        words = "; ".join(group) if several else ", ".join(label.rpartition(", ")[0] for label in group)
        marks.append(Line2D([], [], linestyle="", label=words, **looks[group[-1]]))
    if markers and len(markers) > 1:
        marks += [Line2D([], [], marker=marker, linestyle="", color=INK, label=sea) for sea, marker in markers.items()]
    if crossed(figure):
        marks.append(Line2D([], [], marker=CROSS, linestyle="", color=PAPER, label="published"))
    above(figure, marks)


def shown(results: Results) -> list[Measure]:
    """The first measures of which there are numbers of the seas and at the labels that are drawn."""
    there = ((each, results.of(each, **results.first)) for each in results.measures)
    return [quantity for quantity, values in there if values.sel(sea_state=results.seas).notnull().any()][:PANELS]


def sea_states(results: Results) -> Figure | None:
    """Power and motion of every float in every sea state."""
    measures = shown(results)
    if not measures:
        return None
    figure = canvas(9.0, 1.2 + min(0.62 * len(results.sea_names), 15.0))
    rows = figure.subplots(1, len(measures), sharey=True, squeeze=False)[0]
    for axes, quantity in zip(rows, measures, strict=True):
        draw_sea_states(axes, results, quantity)
        axes.locator_params(axis="x", nbins=min(6, 12 // len(measures)))
    key(figure, results, measures[-1].variable)
    return figure


def told(results: Results, labels: Mapping[str, Any]) -> str:
    """At which labels something is shown, where others are varied."""
    words = "; ".join(f"{dim.replace('_', ' ')} {short(label)}" for dim, label in labels.items())
    return f" Shown at {words}." if labels.keys() & set(results.varied) else ""


def short(label: object) -> str:
    """A word, or the digits of a number."""
    return label if isinstance(label, str) else f"{label:g}"
