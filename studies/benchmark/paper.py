"""The paper's method (panels, 130 waves summed at each, direct convolution, all modes) beside ours."""

import time
from typing import NamedTuple

import numpy as np
from benchmark.case import coefficients, scene, with_settings

from solver.reference import simulate_reference
from solver.simulate import simulate

SECONDS = 12.0  # simulated, after a ramp of a third of that


class Beside(NamedTuple):
    """Wall times [s] of the march of the same seconds, and how far apart the rotations are."""

    paper: float
    ours: float
    difference: float


def beside(platform: str) -> Beside:
    """Both methods on the first seconds of the representative case, each with the default step."""
    known, _ = coefficients()
    item = with_settings(scene(platform), duration=SECONDS, discard=0.0, ramp=SECONDS / 3, keep_series=True)
    every = with_settings(item, modes="all")
    simulate_reference(with_settings(every, duration=0.3), known)  # compile
    start = time.perf_counter()
    slow = simulate_reference(every, known)
    paper = time.perf_counter() - start
    record = simulate(item, known)
    ours = simulate(item, known).attrs["march_time"]
    fast = record.series["rotation"][1]
    exact = slow.rotation[-len(fast) :]
    return Beside(paper, ours, float((np.sqrt(np.mean((fast - exact) ** 2, 0)) / np.sqrt(np.mean(exact**2, 0))).max()))
