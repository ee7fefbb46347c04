"""Several floats together: where they are seen from above, how each moves by period, and what the array gains."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report.along import VARIANT
from pipeline.report.drawing import FAINT, INK, STEEL, canvas, colour, dash, legend, marker
from pipeline.report.figures import Results
from pipeline.report.report import first_known
from pipeline.report.sketch import first_scene
from pipeline.study.floats import Float
from pipeline.study.schema import StudyFile
from pipeline.study.seas import Still
from pipeline.tasks.task import Parameters, at_labels, firsts

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEADING = "heading"
MARGIN = 0.15  # about the floats, of their extent
DIGITS = 6  # of distances between anchors and floats [m], which differences of coordinates round


def from_above(study: StudyFile) -> Figure | None:
    """The floats of a scene that has several, to scale, and the way the waves go."""
    scene = first_scene(study)
    if len(scene.floats) < 2:
        return None
    figure = canvas(6.5, 5.0)
    axes = figure.add_subplot()
    for start, end in _members(scene):
        axes.plot([start[0], end[0]], [start[1], end[1]], color=STEEL, linewidth=1.2, zorder=1)
    for index, item in enumerate(scene.floats):
        _draw_float(axes, item, colour(index))
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(MARGIN)
    axes.grid(visible=False)
    axes.set(xlabel="x [m]", ylabel="y [m]")
    if not isinstance(scene.sea_state, Still):
        _draw_waves(axes, scene.waves.heading)
    return figure


def _members(scene: Parameters) -> Iterator[tuple[Any, Any]]:
    """Ends of the platform's members."""
    if scene.platform is not None:
        for member in scene.platform.members:
            yield scene.platform.nodes[member.start], scene.platform.nodes[member.end]


def _draw_float(axes: Axes, item: Float, fill: str) -> None:
    """Below still water, the waterline, a hinge's axis across the hull, and the name."""
    from matplotlib.collections import LineCollection, PolyCollection

    from pipeline.bridge import hulls, scenes

    (wet, waterline), placed = hulls.plan(item.hull), scenes.floating(item)
    at = np.asarray(placed.centre[:2])
    axes.add_collection(PolyCollection(list(wet + at), facecolors=fill, edgecolors=fill, linewidths=0.2, alpha=0.35))
    axes.add_collection(LineCollection(list(waterline + at), colors=fill, linewidths=1.4, zorder=3))
    axes.update_datalim((wet + at).reshape(-1, 2))
    if "hinge" in item.motion:
        along = np.divide(placed.axis[:2], np.linalg.norm(placed.axis))
        half = np.abs(wet.reshape(-1, 2) @ along).max()
        ends = placed.hinge[:2] + np.outer([-half, half], along)
        axes.plot(*ends.T, color=INK, linewidth=0.9, linestyle="--", zorder=4)
    axes.annotate(item.name, (at[0], at[1]), ha="center", va="center", fontsize="small", zorder=5)


def _draw_waves(axes: Axes, heading: float) -> None:
    """An arrow in the corner, in the sense in which the waves travel."""
    c, s = 0.07 * math.cos(heading), 0.07 * math.sin(heading)
    style: dict[str, Any] = {"arrowstyle": "->", "color": colour(0), "shrinkA": 0, "shrinkB": 0}
    x, y = 0.1, 0.88
    # Fractions of the axes are not equally long along x and y: the arrow is laid out in points.
    corner: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points"}
    axes.annotate("", (x, y), (-400 * c, -400 * s), arrowprops=style, **corner)
    axes.text(x + 0.02, y, "waves", transform=axes.transAxes, va="center", fontsize="small", color=colour(0))


def by_period(results: Results) -> Figure | None:
    """Amplitude of each float along each axis that any has; of several floats."""
    if not results.has("rao", "wave_frequency") or len(results.labels("float")) < 2:
        return None
    sea = widest(results)
    rao, period = _at(results, "rao", sea), 2 * np.pi / _at(results, "wave_frequency", sea).values
    moving = [axis for axis in rao.axis.values if rao.sel(axis=axis).notnull().any()] if "axis" in rao.dims else []
    if not moving or np.isfinite(period).sum() < 2:
        return None
    figure = canvas(9.0, 3.4 * math.ceil(len(moving) / 2))
    places = figure.subplots(math.ceil(len(moving) / 2), min(len(moving), 2), squeeze=False).ravel()
    order = np.argsort(period)
    for axes, axis in zip(places, moving, strict=False):
        for index, item in enumerate(results.labels("float")):
            numbers = rao.sel(axis=axis, float=item).values[order]
            known = np.isfinite(numbers)  # waves too small to say something would cut the line
            if known.any():
                axes.plot(
                    period[order][known], numbers[known], dash(index), color=colour(index), linewidth=1.3, label=item
                )
        unit = str(rao.sel(axis=axis).axis_unit.values) if "axis_unit" in rao.coords else ""
        axes.set(xlabel="period [s]", ylabel=f"{axis} [{unit}/m]" if unit else axis)
        axes.set_ylim(bottom=0.0)
        legend(axes)
    for axes in places[len(moving) :]:
        axes.set_visible(False)
    return figure


def _at(results: Results, name: str, sea: str, **labels: Any) -> xr.DataArray:
    """A variable in a sea, at these labels and the first of all other axes, in the first realization that is known."""
    values = first_known(results.data[name], "platform")
    wanted = {"sea_state": sea, **results.first, **labels}
    values = values.sel({dim: label for dim, label in wanted.items() if dim in values.dims})
    return first_known(values, "seed")


def widest(results: Results) -> str:
    """The sea state whose waves have most periods that say something of a float; without any the one that is shown."""
    if "rao" not in results.data:
        return results.sea
    counts = {sea: int(np.isfinite(_at(results, "rao", sea).values).sum()) for sea in results.labels("sea_state")}
    return str(max(counts, key=lambda sea: counts[sea]))


def alone(results: Results) -> tuple[str, list[str]] | None:
    """The variant in which one float alone absorbs, and those in which several like it do, that one among them."""
    if VARIANT not in results.data.dims or not results.has("absorbed_power"):
        return None
    power = results.data["absorbed_power"].sel(statistic="mean")
    some = (power > 0).any([dim for dim in power.dims if dim not in (VARIANT, "float")])
    absorbing = {
        str(label): [str(f) for f in some.float.values if bool(some.sel({VARIANT: label, "float": f}))]
        for label in some[VARIANT].values
    }
    single = [label for label, floats in absorbing.items() if len(floats) == 1]
    for label in single:
        several = [v for v, floats in absorbing.items() if len(floats) > 1 and absorbing[label][0] in floats]
        one = _but_place(_at_variant(results, label), absorbing[label][0])
        several = [v for v in several if all(_but_place(_at_variant(results, v), f) == one for f in absorbing[v])]
        if several:
            return label, several
    return None


def _at_variant(results: Results, variant: str) -> StudyFile:
    """The study of a variant's first task."""
    content = results.study.content
    return at_labels(content, firsts(content)({VARIANT: variant}))


def _but_place(study: StudyFile, name: str) -> dict[str, Any]:
    """All that a float is, wherever it is on the water, on whatever it hangs, and whence it is let go."""
    (item,) = (item for item in study.floats if item.name == name)
    x, y, _ = item.hinge  # its height is the arm's: the reference point lies at still water
    own = item.model_dump(mode="json", exclude={"name", "hinge", "on", "offset"})
    for line in own["lines"]:
        line["anchor"] = np.round(np.subtract(line["anchor"], (x, y, 0.0)), DIGITS).tolist()
    return own


def q_factor(results: Results, single: str, label: str) -> xr.DataArray:
    """Mean power of a variant's floats over as many times that of one alone, along all axes of the study."""
    power = results.data["absorbed_power"].sel(statistic="mean")
    mine, one = power.sel({VARIANT: label}), power.sel({VARIANT: single})
    dims = [dim for dim in mine.dims if dim != "float"]
    count = (mine > 0).any(dims).sum()
    return mine.sum("float", min_count=1) / (count * one.sum("float", min_count=1))


def q_by_period(results: Results, single: str, label: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Periods (n,) and q (n,) where power take-offs are linear: Σ c|rao|² of a variant over that of one alone."""
    if not results.has("rao", "wave_frequency"):
        return None
    sea = widest(results)
    each = []
    for variant in (label, single):
        study = _at_variant(results, variant)
        rao = _at(results, "rao", sea, variant=variant)
        powers = [_linear(item, rao) for item in study.floats if item.name not in study.left_out]
        if any(p is None for p in powers):
            return None
        absorbed = [p for p in powers if p is not None and np.nanmax(p, initial=0.0) > 0]
        each.append((np.sum(absorbed, axis=0), len(absorbed)))
    (mine, count), (one, _) = each
    frequency, others = (_at(results, "wave_frequency", sea, variant=variant).values for variant in (label, single))
    if not np.array_equal(frequency, others, equal_nan=True):
        return None
    period = 2 * np.pi / frequency
    order = np.argsort(period)
    with np.errstate(divide="ignore", invalid="ignore"):
        return period[order], (mine / (count * one))[order]


def _linear(item: Float, rao: xr.DataArray) -> np.ndarray | None:
    """Σ c|rao|² (nc,) over a float's axes; None where its power take-off is not linear."""
    from pipeline.bridge import scenes

    if scenes.bent(item):
        return None
    total = np.zeros(rao.sizes["component"])
    for axis, c in zip(item.motion, scenes.floating(item).per_axis("pto_damping"), strict=True):
        if c > 0:
            total = total + c * rao.sel(float=item.name, axis=axis).values ** 2
    return total


def gain(results: Results) -> Figure | None:
    """q by period, by heading where the study varies that, and by sea state."""
    found = alone(results)
    if found is None:
        return None
    single, several = found
    curves = {label: q_by_period(results, single, label) for label in several}
    panels = [name for name, shown in (("period", any(curves.values())), (HEADING, _turns(results))) if shown]
    figure = canvas(9.0, 3.6)
    for axes, name in zip(figure.subplots(1, len(panels) + 1, squeeze=False)[0], [*panels, "sea"], strict=True):
        for index, label in enumerate(several):
            if name == "period":
                if (curve := curves[label]) is not None:
                    axes.plot(*curve, dash(index), color=colour(index), label=label)
            elif name == HEADING:
                q = _held(results, q_factor(results, single, label)).sel(sea_state=results.sea)
                axes.plot(
                    np.degrees(q[HEADING].values), q.values, marker(index) + "-", color=colour(index), label=label
                )
            else:
                q = _held(results, q_factor(results, single, label), HEADING)
                values = q.sel(sea_state=results.seas).values
                axes.plot(results.seas, values, marker(index), color=colour(index), label=label)
        axes.axhline(1.0, color=FAINT, linewidth=0.9, zorder=0)
        axes.set_ylim(bottom=0.0)
        axes.set(xlabel={"period": "period [s]", HEADING: "heading [°]", "sea": "sea state"}[name], ylabel="q")
        legend(axes)
        if name == "sea":
            axes.tick_params(axis="x", rotation=45)
    return figure


def of_gain(results: Results) -> str:
    """Which seas the gain by period, and by heading, is of."""
    return f"by period from the RAO in {widest(results)}" + f", by heading in {results.sea}" * _turns(results)


def _turns(results: Results) -> bool:
    return HEADING in results.data.dims and len(results.labels(HEADING)) > 1


def _held(results: Results, values: xr.DataArray, *more: str) -> xr.DataArray:
    """At the first label of all axes but seas and headings, mean over realizations; more: axes that are held, too."""
    values = first_known(values, "platform")
    first = {d: label for d, label in results.first.items() if d in values.dims and (d != HEADING or d in more)}
    values = values.sel(first)
    values = values.mean("seed") if "seed" in values.dims else values
    return values if "sea_state" in values.dims else values.expand_dims("sea_state")
