"""Time series of one realization, as in Figs. 11, 13 and 15-17 of Heo, Koo and Kim (2022).

The whole record stands on the left as a band from least to largest in each of many pieces, as dense lines look;
the minute about the largest value on the right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.bridge import realizations
from pipeline.report.drawing import COLOURS, INK, above, canvas, colour
from pipeline.report.figures import FORCE, MOTION, NAUGHT, POWER, told
from pipeline.report.strips import directions
from pipeline.report.tables import prefix
from pipeline.results.netcdf import Variable
from pipeline.results.records import decode
from pipeline.results.variables import SERIES, axis_units
from pipeline.study import seas
from pipeline.tasks.task import Label, at_labels, firsts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pipeline.report.figures import Results

PIECES = 500  # of a record that is drawn as a band
CLOSE = 60.0  # s, of the part that is drawn as it is
SMOOTH = 0.04  # bandwidth of the regenerated spectrum over its peak's frequency
ELAPSED = "elapsed_time"


class Line(NamedTuple):
    """A series and its name."""

    name: str
    time: np.ndarray  # (nt,) s
    values: np.ndarray  # (nt,)


class Row(NamedTuple):
    """What stands in one pair of axes."""

    words: str
    lines: Sequence[Line]


@dataclass(frozen=True)
class Series:
    """The series of one sea state and realization, on every platform."""

    results: Results

    @cached_property
    def records(self) -> Mapping[str, Mapping[str, Variable]]:
        """Platform -> record, of the first realization whose series are kept."""
        if not self.labels or self.results.tasks is None or "task" not in self.results.data:
            return {}
        pairs = ((str(p), self._record(str(p))) for p in self.results.labels("platform"))
        return {platform: record for platform, record in pairs if ELAPSED in record}

    @cached_property
    def labels(self) -> Mapping[str, Label]:
        """Of the first task with numbers that keeps series, whichever axis varies that; none of a study without."""
        study, known = self.results.study.content, self.results.known
        first, varied = firsts(study), (axis for axis in study.varied if "record.series" in axis.keys)
        given = [{axis.name: label} for axis in varied for label in axis.labels] or [{}]
        near = [(first(some), self.results.first_of(known, **some) if known else {}) for some in given]
        found = [{**one, **held} for one, held in near if one]
        return next((one for one in found if at_labels(study, one).record.series != "none"), {})

    def _record(self, platform: str) -> Mapping[str, Variable]:
        held = {dim: self.labels[dim] for dim in self.results.first}
        cells = self.results.values("task", sea_state=self.results.sea, platform=platform, **held)
        folder = self.results.tasks or Path()
        files = (folder / str(task) / "record.nc" for task in cells.values.ravel())
        return next((record for file in files if (record := _decoded(file))), {})

    def line(self, name: str, platform: str, variable: str, scale: float = 1.0, **labels: object) -> Iterator[Line]:
        """One component of a variable on one platform, if it is there."""
        record = self.records.get(platform, {})
        if (variable := variable + SERIES) not in record:
            return
        dims, values, _ = record[variable]
        known = {d: [str(label) for label in record[d].values.tolist()] for d in dims if d in labels}
        if any(str(labels[d]) not in those for d, those in known.items()):  # a float that is not in this sea's water
            return
        place = tuple(known[d].index(str(labels[d])) if d in known else slice(None) for d in dims)
        shown = np.asarray(values[place], float) / scale
        if shown.ndim == 1 and np.isfinite(shown).all():
            yield Line(name, np.asarray(record[ELAPSED].values, float), shown)

    @property
    def floats(self) -> list[str]:
        """Names of the floats."""
        return [str(name) for name in self.results.labels("float")]


def _decoded(file: Path) -> Mapping[str, Variable]:
    """A task's record, nothing if it is not there or damaged."""
    try:
        return decode(file.read_bytes())
    except (OSError, ValueError):
        return {}


def entries(results: Results) -> list[tuple[str, str, Callable[[Results], Figure | None]]]:
    """Title, caption and maker of each figure; none of a study that keeps no series."""
    series = Series(results)
    if not series.records:
        return []
    at = f" Sea state {results.sea}.{told(results, {dim: series.labels[dim] for dim in results.first})}"
    bands = f"Left: the whole record, later lines over earlier ones; right: about the largest value.{at}"
    return [
        ("Waves", f"Elevation of one realization, and its spectrum beside theory.{at}", lambda _: waves(series)),
        ("Response of the platform", f"First leg. {bands}", lambda _: draw(response(series))),
        ("Hinge forces", f"Of the hinge on the float. {bands}", lambda _: draw(forces(series))),
        ("Rotation", bands, lambda _: draw(floats(series, "rotation", "rotation, [rad]", 1.0))),
        ("Motion", f"Along the axes of joints, from rest. {bands}", lambda _: draw(motions(series))),
        ("Absorbed power", bands, lambda _: draw(powers(series))),
    ]


def response(series: Series) -> list[Row]:
    """Fig. 13: displacement at the top and stress at the bottom of the first leg, with and without floats."""
    leg = str((series.results.labels("leg") or [""])[0])
    names = series.results.carrying

    def both(variable: str, scale: float, **labels: object) -> list[Line]:
        groups = (series.line(names[p], p, variable, scale, leg=leg, **labels) for p in names)
        return [line for lines in groups for line in lines]

    top = Row(f"x displacement, top of leg {leg} [m]", both("top_displacement", 1.0, direction="x"))
    return [top, Row(f"stress, bottom of leg {leg} [MPa]", both("bottom_stress", 1e6))]


def forces(series: Series) -> list[Row]:
    """Fig. 15: every component of the hinge forces that is not zero, on the elastic platform if there is one."""
    if not series.results.has(FORCE):
        return []
    platform = "elastic" if "elastic" in series.records else "fixed"
    unit, scale = series.results.force
    return [
        Row(
            f"{d} force on the float [{unit}]",
            [line for f in series.floats for line in series.line(f, platform, FORCE, scale, float=f, direction=d)],
        )
        for d in directions(series.results)
    ]


def powers(series: Series) -> list[Row]:
    """Fig. 17: what every float absorbs."""
    if POWER not in series.results.data:
        return []
    every = [np.abs(line.values).max() for row in floats(series, POWER, "", 1.0) for line in row.lines]
    unit, scale = prefix(np.array(every or [0.0]))
    return floats(series, POWER, f"absorbed power, [{unit}W]", scale)


def motions(series: Series) -> list[Row]:
    """Along each axis of a joint but a hinge's, which rotation is about; without those that only rounding moves."""
    axes = [axis for axis in series.results.labels("axis") if axis != "hinge"]
    rows = [
        row
        for axis, unit in zip(axes, axis_units(axes), strict=True)
        for row in floats(series, MOTION, f"{axis}, [{unit}]", 1.0, axis=axis)
    ]
    sizes = [max((float(np.abs(line.values).max()) for line in row.lines), default=0.0) for row in rows]
    return [row for row, size in zip(rows, sizes, strict=True) if size > NAUGHT * max(sizes)]


def floats(series: Series, variable: str, words: str, scale: float, **labels: object) -> list[Row]:
    """Figs. 16 and 17: one quantity of every float, on the elastic and on the fixed platform."""
    platforms = {"elastic": "elastic platform", "fixed": "fixed platform"}
    return [
        Row(
            f"{words.replace('[', f'{f} [')}",
            [
                line
                for p, name in platforms.items()
                for line in series.line(name, p, variable, scale, float=f, **labels)
            ],
        )
        for f in series.floats
    ]


def draw(rows: Sequence[Row]) -> Figure | None:
    """Each row that is not zero as its whole record and its minute about the largest value; None if there is none."""
    rows = [row for row in rows if any(line.values.any() for line in row.lines)]
    if not rows:
        return None
    figure = canvas(9.0, 0.6 + 1.9 * len(rows))
    grid = figure.subplots(len(rows), 2, sharey="row", squeeze=False, width_ratios=[1.7, 1.0])
    for (whole, close), row in zip(grid, rows, strict=True):
        start = window(row.lines)
        for number, line in enumerate(row.lines):
            _band(whole, line, number)
            inside = (line.time >= start) & (line.time <= start + CLOSE)
            close.plot(line.time[inside], line.values[inside], linewidth=1.1, **look(number))
        for axes in (whole, close):
            axes.grid(visible=True, axis="y")
            axes.margins(x=0)
        whole.set_title(row.words)
    grid[-1][0].set_xlabel("time [s], the whole record")
    times = [line.time for row in rows for line in row.lines]
    shown = min(CLOSE, max(float(np.ptp(time)) for time in times))
    grid[-1][1].set_xlabel(f"time [s], {shown:.3g} s about the largest value")
    _key(figure, rows)
    return figure


def look(number: int) -> dict[str, Any]:
    """Style of a line by its number, from 0: the second is dashed, so that the first shows where they nearly agree.

    Where colours begin again dashes are others.
    """
    return {
        "color": colour(number),
        "linestyle": ("-", (0, (3, 1)), ":", "-.")[number % 2 + 2 * (number // len(COLOURS) % 2)],
    }


def window(lines: Sequence[Line]) -> float:
    """Where the minute begins: the largest distance from its line's mean is in its middle [s]."""
    size = [np.abs(line.values - line.values.mean()) for line in lines]
    largest = max(range(len(lines)), key=lambda i: float(size[i].max()))
    time = lines[largest].time
    middle = float(time[int(size[largest].argmax())])
    return max(float(time[0]), min(middle - CLOSE / 2, float(time[-1]) - CLOSE))


def extremes(values: np.ndarray, pieces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First sample, least and largest value of each of so many pieces; neighbours share a sample, so bands join."""
    edges = np.unique(np.linspace(0, len(values) - 1, min(pieces, len(values) - 1) + 1).astype(int))
    spans = [values[a : b + 1] for a, b in zip(edges[:-1], edges[1:], strict=True)]
    return edges[:-1], np.array([s.min() for s in spans]), np.array([s.max() for s in spans])


def _band(axes: Axes, line: Line, number: int) -> None:
    at, low, high = extremes(line.values, PIECES)
    axes.fill_between(line.time[at], low, high, color=colour(number), linewidth=0.3, zorder=2 + number)


def _key(figure: Figure, rows: Sequence[Row]) -> None:
    from matplotlib.lines import Line2D

    names = max(([line.name for line in row.lines] for row in rows), key=len)
    if len(names) > 1:
        marks = [Line2D([], [], linewidth=2.0, label=name, **look(i)) for i, name in enumerate(names)]
        above(figure, marks)


def waves(series: Series) -> Figure | None:
    """Fig. 11: the elevation, and the spectrum regenerated from it beside the one that it was drawn from."""
    groups = (series.line("", platform, "wave_elevation") for platform in series.records)
    line = next((line for lines in groups for line in lines), None)
    if line is None or not line.values.any():
        return None
    figure = canvas(9.0, 2.9)
    left, right = figure.subplots(1, 2)
    _band(left, line, 0)
    left.margins(x=0)
    left.set_xlabel("time [s]")
    left.set_ylabel("elevation at the origin [m]")
    _spectrum(right, series, line)
    return figure


def _spectrum(axes: Axes, series: Series, line: Line) -> None:
    from solver.record.spectra import smoothed_density

    study = at_labels(series.results.study.content, series.labels)
    state, waves = study.sea_states[series.results.sea], study.waves  # of the record, whichever axes vary them
    span = seas.frequencies(state, waves)
    if span is None or not seas.is_random(state):
        axes.set_visible(False)
        return
    grid = np.linspace(*span, 400)
    theory = realizations.spectrum(state, waves).density(grid)  # type: ignore[arg-type]  # it is a random one
    omega, density = smoothed_density(line.values, line.time[1] - line.time[0], SMOOTH * grid[theory.argmax()])
    shown = (omega > 0.7 * span[0]) & (omega < 1.1 * span[1])
    axes.plot(omega[shown], density[shown], color=colour(0), linewidth=1.4, label="from the record, smoothed FFT")
    axes.plot(grid, theory, "--", color=INK, linewidth=1.2, label="theory")
    axes.set_xlabel("ω [rad/s]")
    axes.set_ylabel("S(ω) [m² s/rad]")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False)
