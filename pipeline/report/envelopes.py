"""Largest |displacement| and |stress| along the legs, as in Fig. 14 of Heo, Koo and Kim (2022)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report.drawing import canvas, colour
from pipeline.report.figures import Results
from pipeline.study.layout import hinge_nodes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# variable, words, SI units in the unit shown, and the side on which the panel is empty at the foot
ENVELOPES = (
    ("displacement_envelope", "largest |displacement| [m]", 1.0, "right"),
    ("stress_envelope", "largest |stress| [MPa]", 1e6, "left"),
)
TAGS = (0.3, 0.8)  # of the height: where the platforms' names stand clear of each other


def leg_groups(results: Results) -> dict[str, list[int]]:
    """Legs of one height at the same x, from the weather side of heading 0 to the lee; by the dataset's labels."""
    labels, platform = results.labels("leg"), results.study.content.platform
    if platform is None or len(platform.legs) != len(labels):
        return {f"leg {label}": [label] for label in labels}
    nodes = dict(platform.nodes) | hinge_nodes(results.study.content.floats)
    kinds = {member.name: _kind(nodes[member.start], nodes[member.end]) for member in platform.members}
    places: dict[tuple[float, float], list[int]] = {}
    for label, name in sorted(zip(labels, platform.legs, strict=True), key=lambda pair: kinds[pair[1]]):
        places.setdefault(kinds[name], []).append(label)
    at = [x for x, _ in places]
    names = {1: ["legs"], 2: ["front legs", "rear legs"]}.get(len(places), [f"legs at x = {x:g} m" for x in at])
    if len(set(at)) < len(at):
        names = [f"legs at x = {x:g} m, {height:g} m high" for x, height in places]
    return dict(zip(names, places.values(), strict=True))


def _kind(start: Sequence[float], end: Sequence[float]) -> tuple[float, float]:
    """x of a leg's foot and its height [m], to the millimetre."""
    foot, top = sorted((start, end), key=lambda node: node[2])
    return round(foot[0], 3), round(top[2] - foot[2], 3)


def shown(results: Results) -> list[tuple[str, str, float, str]]:
    """The envelopes that the dataset has in the sea state shown."""
    return [entry for entry in ENVELOPES if results.has(entry[0], sea_state=results.sea)]


def profile(results: Results, name: str, platform: str, legs: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    """Heights of a group of legs, and the largest of them in every realization that there is, (height, realization)."""
    held = results.first_of(name)  # the frequency domain has no envelopes
    part = results.values(name, sea_state=results.sea, platform=platform, **held).sel(leg=list(legs))
    rows = part.transpose("leg", "height", ...).values
    rows = rows.reshape(*rows.shape[:2], -1).max(axis=0)
    rows = rows[:, np.isfinite(rows).any(axis=0)]
    nodes = np.isfinite(rows).all(axis=1)  # other legs' nodes are at other heights
    return results.data["height"].values[nodes], rows[nodes]


def draw(panels: Sequence[Axes], results: Results) -> None:
    """A panel for each envelope: mean of the realizations, and their range as a band."""
    every = results.data["height"].values
    for axes, (name, words, scale, _) in zip(panels, shown(results), strict=True):
        for j, platform in enumerate(results.supports(name)):
            for i, (_, legs) in enumerate(leg_groups(results).items()):
                heights, rows = profile(results, name, platform, legs)
                rows = rows / scale
                if rows.size:
                    band: dict[str, Any] = {"color": colour(i), "alpha": 0.15, "linewidth": 0}
                    axes.fill_betweenx(heights, rows.min(axis=1), rows.max(axis=1), **band)
                    axes.plot(rows.mean(axis=1), heights, "--" if j else "-", color=colour(i), linewidth=1.4)
                if rows.size and i == 0 and axes is panels[0]:
                    _tag(axes, rows.mean(axis=1), heights, j, results.carrying.get(platform, platform))
        axes.set_ylim(float(every.min()), float(every.max()))
        axes.set_xlim(left=0.0)
        axes.set_xlabel(words)
    _groups(panels[-1], list(leg_groups(results)), shown(results)[-1][-1])
    panels[0].set_ylabel("height above the foot of the leg [m]")


def _tag(axes: Axes, curve: np.ndarray, heights: np.ndarray, number: int, words: str) -> None:
    """A platform's name to the right of its curve."""
    place = int(TAGS[number % 2] * (len(heights) - 1))
    style: dict[str, Any] = {"xytext": (8, 0), "textcoords": "offset points", "va": "center"}
    axes.annotate(words, (float(curve[place]), float(heights[place])), **style)


def _groups(axes: Axes, names: Sequence[str], side: str) -> None:
    """Names of the legs in their colours, in the corner that the curves leave free."""
    for i, name in enumerate(names):
        place = (0.04 if side == "left" else 0.96, 0.03 + 0.07 * (len(names) - 1 - i))
        axes.annotate(name, place, xycoords="axes fraction", color=colour(i), ha=side)


def envelopes(results: Results) -> Figure | None:
    """The panels side by side."""
    if not shown(results):
        return None
    figure = canvas(9.0, 4.4)
    draw(figure.subplots(1, len(shown(results)), sharey=True, squeeze=False)[0], results)
    return figure
