"""Responses to the waves by frequency: of time records and, beside them, of the frequency domain."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report.drawing import PAPER, canvas, colour, legend
from pipeline.report.figures import Results
from pipeline.report.governing import unit
from pipeline.report.report import first_known
from pipeline.results.variables import axis_units

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

OUTPUTS = ("rotation", "motion", "hinge_force", "top_displacement", "pto_force", "fibre_stress")
PANELS = 4  # outputs that are drawn
LINES = 4  # of each, the largest
ROOM = 0.1  # above the largest for each name, of its height
SMALL = 0.05  # share of the largest response below which a component is left out
FAINT = 1e-3  # share of the largest wave spectrum below which a band has no waves to speak of
METHOD, BAND, WAVES = "method", "frequency_band", "wave_elevation_spectrum"


def beside(results: Results) -> list[dict[str, Any]]:
    """Labels at which responses are shown, of each method that has numbers there: the frequency domain's stand, dashed,
    beside those of records."""
    at, names = shown_at(results), _outputs(results)
    words = [label for label in results.labels(METHOD) if isinstance(label, str)]  # numbers count what goes together
    every = [at | {METHOD: label} for label in words] or [at]
    return [each for each in every if any(_part(results, name, each).notnull().any() for name in names)]


def responses(results: Results) -> Figure | None:
    """Response per wave amplitude and coherence; the frequency domain as dashed lines where a study has both."""
    methods = beside(results)
    known = [(name, axes) for name in OUTPUTS if results.has(f"{name}_response") for axes in _alike(results, name)]
    there = [each for each in known if any(_largest(results, *each, at) for at in methods)]
    moves = any(name == "motion" for name, _ in there)  # of which rotation is the part about hinges
    shown = [(name, axes) for name, axes in there if name != "rotation" or not moves][:PANELS]
    if not shown:
        return None
    figure = canvas(9.0, 4.6)
    grid = figure.subplots(2, len(shown), sharex=True, squeeze=False, height_ratios=[3, 1])
    for (name, along), (upper, lower) in zip(shown, grid.T, strict=True):
        for at in methods:
            theory = at.get(METHOD) == "frequency" and len(methods) > 1
            style: dict[str, Any] = {"linestyle": "--", "color": PAPER, "linewidth": 0.9} if theory else {}
            omega, bands = _bands(results, at)
            style |= {"marker": "o"} if bands.sum() == 1 else {}  # no line goes through one point
            for i, (words, place) in enumerate(_largest(results, name, along, at)):
                look = {"color": colour(i), "linewidth": 1.6} | style
                label = None if theory else words
                values = (_part(results, f"{name}_{kind}", at).sel(place) for kind in ("response", "coherence"))
                for axes, numbers in zip((upper, lower), values, strict=True):
                    axes.plot(omega[bands], numbers.values[bands], label=label, **look)
        own = unit(results.data[f"{name}_response"], ["axis"] * len(along), along)
        upper.set_title(name.replace("_", " ") + (f" [{own}]" if own else ""))
        upper.set_ylim(0.0, (1.05 + ROOM * len(upper.get_legend_handles_labels()[0])) * upper.dataLim.y1)
        legend(upper, loc="upper right")
        lower.set_ylim(0.0, 1.05)
        lower.set_xlabel("frequency [rad/s]")
    grid[1][0].set_ylabel("coherence")
    return figure


def shown_at(results: Results) -> dict[str, Any]:
    """At which labels responses are shown: in the report's sea, or the highest other if it has no several bands; where
    records have numbers, if any has."""
    outputs = _outputs(results)
    if not outputs:
        return {"sea_state": results.sea, **results.first}
    bands = _waved(results.values(WAVES)).sum(BAND)
    bands = bands.max([dim for dim in bands.dims if dim != "sea_state"])
    wide = [str(sea) for sea in results.labels("sea_state") if bands.sel(sea_state=sea) > 1]
    sea = results.sea if results.sea in wide or not wide else results.highest(wide)
    marched = {"sea_state": sea, METHOD: "time"}
    there = "time" in results.labels(METHOD) and results.has(outputs[0], **marched)
    return {"sea_state": sea, **results.first_of(outputs[0], **(marched if there else {"sea_state": sea}))}


def _outputs(results: Results) -> list[str]:
    """The variables that have numbers."""
    return [f"{name}_response" for name in OUTPUTS if results.has(f"{name}_response")]


def _waved(spectrum: xr.DataArray) -> xr.DataArray:
    """Which bands have waves."""
    return spectrum > FAINT * spectrum.max(BAND)


def _alike(results: Results, name: str) -> list[list[str]]:
    """Axes of a joint along which an output's response has one unit; none where it is along no axis."""
    data = results.data
    if "axis" not in data[f"{name}_response"].dims:
        return [[]]
    labels = data["axis"].values.tolist()
    units = axis_units(labels)
    return [[label for label, own in zip(labels, units, strict=True) if own == kind] for kind in dict.fromkeys(units)]


def _part(results: Results, variable: str, at: dict[str, Any]) -> xr.DataArray:
    """A variable at these labels, on the first platform and in the first realization that have numbers."""
    values = results.data[variable]
    values = values.sel({dim: label for dim, label in at.items() if dim in values.dims})
    return first_known(first_known(values, "platform"), "seed")


def _bands(results: Results, at: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (n,), and which of them (n,) have waves."""
    return _part(results, "band_frequency", at).values, _waved(_part(results, WAVES, at)).values


def _largest(results: Results, name: str, along: list[str], at: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Words and labels of the components that respond most, of these axes; what has no numbers, as a carrier's
    rotation, does not."""
    values = _part(results, f"{name}_response", at)
    values = values.sel(axis=along) if along else values
    inner = [str(dim) for dim in values.dims if dim != BAND]
    size = values.where(_bands(results, at)[1]).max(BAND).fillna(0.0)
    places = [dict(zip(inner, labels, strict=True)) for labels in product(*(values[d].values.tolist() for d in inner))]
    sizes = [float(size.sel(place)) for place in places]
    order = sorted((i for i in range(len(places)) if sizes[i] > SMALL * max(sizes)), key=lambda i: -sizes[i])
    chosen = [places[i] for i in sorted(order[:LINES])]
    return [(", ".join(f"{d} {x}" if d in ("leg", "fibre") else str(x) for d, x in p.items()), p) for p in chosen]
