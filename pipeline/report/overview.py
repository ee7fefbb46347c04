"""One figure that says what a study is and what came out, for a README."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.report import envelopes, sketch
from pipeline.report.drawing import canvas
from pipeline.report.figures import POWER, Results, draw_sea_states, key, told

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (14.0, 5.2)  # inches, at 100 dots each
TEXT = 13.0  # points; a README shows a little more than half of it


def overview(results: Results) -> Figure:
    """The scene, the envelopes along the legs, and the power in every sea state, as far as they are there."""
    count = len(envelopes.shown(results))
    power = results.has(POWER)
    figure = canvas(*SIZE)
    widths = [2.0] + [0.85] * count + [1.3] * power
    panels = figure.subplots(1, len(widths), squeeze=False, width_ratios=widths)[0]
    sketch.close_up(panels[0], sketch.first_scene(results.study.content))
    if count:
        envelopes.draw(panels[1 : 1 + count], results)
    for axes in panels[1 : 1 + count]:
        axes.set_xlabel(axes.get_xlabel().replace(" ", "\n", 1))
    for axes in panels[2 : 1 + count]:
        axes.tick_params(labelleft=False)
    if count:
        held = told(results, results.first_of(envelopes.shown(results)[0][0]))
        words = f"Along the legs: sea state {results.sea}.{held}"
        figure.text(0.005, 0.01, words, fontsize="small").set_in_layout(False)
    if power:
        draw_sea_states(panels[-1], results, results.power)
        key(figure, results, POWER)
    return figure
