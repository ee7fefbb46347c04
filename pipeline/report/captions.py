"""The report's figures in order: title, caption, and what draws each."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pipeline.report import arrays, envelopes, figures, series, sketch, strips
from pipeline.report import responses as responding
from pipeline.report.along import along, drawn, in_rows
from pipeline.report.figures import ROOM, Results, short, told
from pipeline.report.responses import METHOD, beside, responses, shown_at
from pipeline.report.tables import SURVIVORS
from pipeline.study.seas import is_random

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNSEEN = SURVIVORS.replace("are in no mean", "have no dots")
REALIZED = "Least and largest force in each realization, one dot each"
EXPECTED = "Least and largest force that are to be expected of a record, one dot each"


def entries(results: Results) -> list[tuple[str, str, Callable[[Results], Figure | None]]]:
    """Title, caption and maker of each figure, in order."""
    cut = _cut(results, "sea_state")
    at, legs = held(results) + cut, envelopes.shown(results)
    of_legs = ""
    if legs:
        at_legs = results.first_of(legs[0][0])
        of_legs = results.survivors([name for name, *_ in legs], at_legs, {"sea_state": [results.sea]})
        of_legs += told(results, at_legs)
    of_force = _filled(results, [figures.FORCE])
    if figures.FORCE in results.data:
        at_force = results.first_of(figures.FORCE)
        of_force += UNSEEN * bool(results.survivors([figures.FORCE], at_force, {"sea_state": results.seas}))
        of_force += told(results, at_force)
    at_waves = shown_at(results)
    both = len(beside(results)) > 1
    of_waves = told(results, {dim: at_waves[dim] for dim in results.first if not (both and dim == METHOD)})
    shown = figures.shown(results)
    *names, last = [quantity.name for quantity in shown] or [""]
    measures, variables = (", ".join(names) + " and " * bool(names) + last).capitalize(), [q.variable for q in shown]
    of_seas = results.ringed(variables, results.first, {"sea_state": results.seas})
    of_seas += results.survivors(variables, results.first, {"sea_state": results.seas})
    fixed = _filled(results, variables) + _first(results)
    several, expected = _several(results), _expected(results, figures.FORCE)
    spread = f"Dots: mean over realizations; bars: least and largest.{fixed}" if several else f"One dot each.{fixed}"
    spread_along = ", mean over realizations; bars: least and largest." if several else "."
    dashed = " Dashed: the frequency domain." if both else ""
    of_bands = f"Per wave amplitude, averaged in bands of frequency, of the {responding.LINES} lines of a panel that"
    of_bands += f" are largest; sea state {at_waves['sea_state']}, first realization there is."
    of_each = f"Per wave amplitude, of each wave by itself; sea state {arrays.widest(results)}, first realization"
    of_each += " there is."
    of_extremes = "Lines: extremes of the record, of legs drawn as one the largest."
    if several:
        of_extremes = (
            "Lines: mean of the realizations' extremes, of legs drawn as one the largest; bands: least and largest."
        )
    return [
        (
            "Scene",
            "Side view along y, at rest, to scale.",
            _scene,
        ),
        (
            "From above",
            "Floats at rest: dark where they meet still water, light what they have below; dashed: axes of hinges.",
            _from_above,
        ),
        (
            "Envelopes along the legs",
            f"Sea state {results.sea}. {of_extremes}{of_legs}",
            envelopes.envelopes,
        ),
        (
            f"{measures} in each sea state{_at(results)}",
            f"{spread}{of_seas}{_headed(results)}{at}",
            figures.sea_states,
        ),
        *[
            (
                f"Along {dim.replace('_', ' ')}{_at(results, dim)}",
                f"{_of_seas(results, dim)}{spread_along}{fixed}{_of_axis(results, dim)}",
                _along(dim),
            )
            for dim in results.varied
        ],
        (
            "Extremes of the hinge force",
            f"{EXPECTED if expected else REALIZED}.{of_force}{cut}",
            strips.hinge_forces,
        ),
        (
            "Response to the waves",
            f"{of_bands}{dashed}{of_waves}",
            responses,
        ),
        (
            "Motion of each float by period",
            f"{of_each}{at}",
            arrays.by_period,
        ),
        (
            "Gain of the array",
            f"q: mean power over that of as many floats alone, floats that are alike; {arrays.of_gain(results)}.{at}",
            arrays.gain,
        ),
        *series.entries(results),
        ("What the runs say of themselves", "One dot a task, magnitudes. All seas and realizations.", strips.audit),
    ]


def _several(results: Results) -> bool:
    """Whether there are realizations that may differ: several seeds of a sea that is random."""
    states = [results.study.content.sea_states.get(sea) for sea in results.seas]
    return len(results.labels("seed")) > 1 and any(state is None or is_random(state) for state in states)


def _expected(results: Results, name: str) -> bool:
    """Whether a variable is shown of the frequency domain, which has no records."""
    own = results.study.content.solver.method
    return name in results.data and results.first_of(name).get(METHOD, own) == "frequency"


def _first(results: Results) -> str:
    """That a figure has no room for all measures."""
    count = len(results.measures)
    return f" The first {figures.PANELS} of {count} quantities." if count > figures.PANELS else ""


def _filled(results: Results, drawn: list[str]) -> str:
    """How marks tell the platforms that these have numbers for."""
    several = any(len(results.supports(name)) > 1 for name in drawn if name in results.data)
    return " Filled: elastic platform; open: fixed." if several else ""


def _cut(results: Results, dim: str) -> str:
    """That a figure has no room for all labels, which stand in rows where they are words."""
    labels, seas = results.labels(dim), " sea states" if dim == "sea_state" else ""
    rows = len(labels) > ROOM and in_rows(results, dim)
    return f" The first {ROOM} of {len(labels)}{seas}." if rows else ""


def _headed(results: Results) -> str:
    """What the numbers beside the names of sea states are."""
    known = (
        ("Sea states with Hs, Tp.", "Hs", "Tp"),
        ("Regular waves with height, period.", "wave_height", "wave_period"),
    )
    shown = len(results.seas)
    return "".join(
        f" {words}"
        for words, height, period in known
        if np.isfinite(results.numbers(height) + results.numbers(period))[:shown].any()
    )


def _of_seas(results: Results, dim: str) -> str:
    """Which sea states a figure along an axis is of: where words stand in rows there is room for one."""
    several = len(results.marked) > 1 and not in_rows(results, dim)
    return "Each sea state" if several else f"Sea state {results.sea}"


def _of_axis(results: Results, dim: str) -> str:
    """What a figure along an axis leaves out of its means, is held at, and has no room for."""
    variables = [quantity.variable for quantity in results.measures]
    others = {name: label for name, label in results.first.items() if name != dim}
    shown = drawn(results, dim)
    missing = results.ringed(variables, others, shown) + results.survivors(variables, others, shown)
    return missing + held(results, dim) + _cut(results, dim)


def _at(results: Results, *about: str) -> str:
    """At which labels of varied axes a figure is that is about these axes alone, for its title."""
    words = [f"{dim.replace('_', ' ')} {short(results.first[dim])}" for dim in results.varied if dim not in about]
    return f" at {', '.join(words)}" if words else ""


def held(results: Results, *about: str) -> str:
    """At which labels something is that is about these axes alone, where others are varied."""
    return told(results, {dim: label for dim, label in results.first.items() if dim not in about})


def _scene(results: Results) -> Figure | None:
    return sketch.side_view(results.study.content)


def _from_above(results: Results) -> Figure | None:
    return arrays.from_above(results.study.content)


def _along(dim: str) -> Callable[[Results], Figure | None]:
    return lambda results: along(results, dim)
