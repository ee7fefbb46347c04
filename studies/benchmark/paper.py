"""The paper's method (panels, 130 waves summed at each, direct convolution, all modes) beside ours."""

from typing import NamedTuple

import numpy as np

from solver.run import simulate
from studies.benchmark.case import coefficients, scene, with_settings

SECONDS = 60.0  # simulated, with a ramp of a third of that


class Beside(NamedTuple):
    """Wall times [s] of the march of the same seconds, and how far apart the rotations are."""

    paper: float
    ours: float
    difference: float


def beside(platform: str) -> Beside:
    """Both methods on the first seconds of the representative case, each with the default step."""
    known, _ = coefficients()
    item = with_settings(scene(platform), duration=SECONDS, discard=0.0, ramp=SECONDS / 3, keep_series=True)
    papers = with_settings(item, accuracy="reference")
    for either in (papers, item):
        simulate(with_settings(either, duration=1.0), known)  # compile
    slow, quick = simulate(papers, known), simulate(item, known)
    paper, ours = slow.attrs["march_time"], quick.attrs["march_time"]
    exact, fast = (record.series["rotation"][1] for record in (slow, quick))
    return Beside(paper, ours, float((np.sqrt(np.mean((fast - exact) ** 2, 0)) / np.sqrt(np.mean(exact**2, 0))).max()))
