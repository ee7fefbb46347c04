"""What hits on end stops cost: a storm's run beside one of floats that are damped too much to reach them."""

import statistics
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from pipeline.bridge import scenes
from pipeline.bridge.geometry import bem_arguments, geometry_of
from pipeline.bridge.loading import load
from pipeline.tasks.task import Task, expand
from solver.run import simulate
from studies.benchmark.case import coefficients

PAIRS = 15
DAMPED = 5.0  # times the power take-offs' damping, with which no float reaches its stops


def task(platform: str) -> Task:
    """Buan's floats on stops in Hs 6 m."""
    wanted = {"sea_state": "Hs6", "platform": platform, "seed": 0, "variant": "working"}
    return next(t for t in expand(load(Path("studies/storm.toml")).content) if wanted.items() <= t.labels.items())


def table() -> dict[str, float]:
    """Print the median ratio of both runs' processor times, in turns."""
    known, _ = coefficients("storm", **bem_arguments(geometry_of(task("elastic").parameters)))
    ratios = {}
    for platform in ("elastic", "fixed"):
        rough = scenes.scene(task(platform).parameters)
        damped = (replace(f, pto_damping=DAMPED * f.pto_damping, end_stops=None) for f in rough.floats)
        pair = rough, replace(rough, floats=tuple(damped))
        records = [simulate(item, known) for item in pair]  # compile, and load what is cached
        seconds = np.empty((PAIRS, 2))
        for times in seconds:
            for i, item in enumerate(pair):
                start = time.process_time()
                simulate(item, known)
                times[i] = time.process_time() - start
        ratio = ratios[platform] = statistics.median(seconds[:, 0] / seconds[:, 1])
        told, other = (record.attrs for record in records)
        print(
            f"1,800 s in Hs 6 m, {platform}: {records[0].variables['end_stop_hits'][1].sum():.0f} hits on stops,"
            f" {ratio:.2f} times a run without (steps of {told['time_step']:g} and {other['time_step']:g} s),"
            f" energy balance open by {told['energy_residual']:.0e}"
        )
    return {f"hits_{platform}": ratio for platform, ratio in ratios.items()}


if __name__ == "__main__":
    table()
