"""Constraint drift of the reference path over a day: `python -m studies.stress.day [hours]`.

Both floats of the Buan study on fixed hinges in its representative sea, six DOF a body with multipliers; the
trapezoidal rule at a sixth of the shortest period, which is the coarsest that a study may ask for. Some ten
milliseconds a step: a day takes an hour. Exit status 1 if a hinge is ever off its place by more than 1e-9 m.
"""

import sys
import time

import numpy as np

from solver import reference
from studies.benchmark.case import coefficients, scene, with_settings

HOUR, LIMIT = 3600.0, 1e-9


def main(hours: float) -> int:
    """A line for each hour; the largest gap of all."""
    known, _ = coefficients()
    settings = {"duration": hours * HOUR, "discard": 0.0, "formulation": "augmented", "time_step": 0.3}
    case = reference._case(with_settings(scene("fixed"), **settings), known, kernel=None, surface=None,
                           panels=(71, 120), stages=2)  # fmt: skip
    start, largest, reported = time.perf_counter(), np.zeros(3), 0
    for sample in reference._march(case, reference.CONSTRAINTS):
        largest = np.maximum(largest, sample.errors)
        if sample.time >= (reported + 1) * HOUR - 1e-6:
            reported += 1
            spent = time.perf_counter() - start
            position, velocity, acceleration = largest
            print(f"{reported} h: hinge off its place by {position:.1e} m, {velocity:.1e} m/s, {acceleration:.1e} m/s2;"
                  f" {spent / 60:.0f} min, {spent / 60 * (hours / reported - 1):.0f} to go", flush=True)  # fmt: skip
    return int(not largest[0] <= LIMIT)


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 24.0))
