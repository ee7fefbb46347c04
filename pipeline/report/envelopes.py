"""Largest |displacement| and |stress| along the legs, as in Fig. 14 of Heo, Koo and Kim (2022)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.report.drawing import INK, canvas, colour, legend
from pipeline.report.figures import Results
from pipeline.study.layout import hinge_nodes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# variable, words, and SI units in the unit shown
ENVELOPES = (
    ("displacement_envelope", "largest |displacement| [m]", 1.0),
    ("stress_envelope", "largest |stress| [MPa]", 1e6),
)


def leg_groups(results: Results) -> dict[str, list[int]]:
    """Legs of one height whose feet have the same x, from the weather side of heading 0 to the lee, by the dataset's
    labels; called by their feet, for battered legs have another x at each height."""
    labels, platform = results.labels("leg"), results.study.content.platform
    if platform is None or len(platform.legs) != len(labels):
        return {f"leg {label}": [label] for label in labels}
    nodes = dict(platform.nodes) | hinge_nodes(results.study.content.floats)
    kinds = {member.name: _kind(nodes[member.start], nodes[member.end]) for member in platform.members}
    places: dict[tuple[float, float], list[int]] = {}
    for label, name in sorted(zip(labels, platform.legs, strict=True), key=lambda pair: kinds[pair[1]]):
        places.setdefault(kinds[name], []).append(label)
    at = [x for x, _ in places]
    if len(places) <= 2 and len(set(at)) == len(at):
        return dict(zip(["legs"] if len(at) == 1 else ["front legs", "rear legs"], places.values(), strict=True))
    alike = len(set(at)) < len(at)
    return {_called(legs, x) + f", {height:g} m high" * alike: legs for (x, height), legs in places.items()}


def _called(legs: Sequence[int], x: float) -> str:
    leg, foot = ("leg", "foot") if len(legs) == 1 else ("legs", "feet")
    return f"{leg} {', '.join(map(str, legs))} ({foot} at x = {x:g} m)"


def _kind(start: Sequence[float], end: Sequence[float]) -> tuple[float, float]:
    """x of a leg's foot and its height [m], to the millimetre."""
    foot, top = sorted((start, end), key=lambda node: node[2])
    return round(foot[0], 3), round(top[2] - foot[2], 3)


def shown(results: Results) -> list[tuple[str, str, float]]:
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
    every, groups = results.data["height"].values, leg_groups(results)
    for axes, (name, words, scale) in zip(panels, shown(results), strict=True):
        for j, platform in enumerate(results.supports(name)):
            for i, (group, legs) in enumerate(groups.items()):
                heights, rows = profile(results, name, platform, legs)
                rows = rows / scale
                if rows.size:
                    band: dict[str, Any] = {"color": colour(i), "alpha": 0.15, "linewidth": 0}
                    axes.fill_betweenx(heights, rows.min(axis=1), rows.max(axis=1), **band)
                    named: dict[str, Any] = {} if j else {"label": group}
                    axes.plot(rows.mean(axis=1), heights, "--" if j else "-", color=colour(i), linewidth=1.4, **named)
            if axes is panels[0] and (told := results.carrying.get(platform, platform)):
                axes.plot([], [], "--" if j else "-", color=INK, linewidth=1.4, label=told)
        axes.set_ylim(float(every.min()), float(every.max()))
        axes.set_xlim(left=0.0)
        axes.set_xlabel(words)
    legend(panels[0], loc="lower right")  # a foot moves next to nothing
    panels[0].set_ylabel("height above the foot of the leg [m]")


def envelopes(results: Results) -> Figure | None:
    """The panels side by side."""
    if not shown(results):
        return None
    figure = canvas(9.0, 4.4)
    draw(figure.subplots(1, len(shown(results)), sharey=True, squeeze=False)[0], results)
    return figure
