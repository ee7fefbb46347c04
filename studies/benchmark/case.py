"""The representative coupled case, and how its run time and error are measured."""

import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from pipeline.bridge import cache, scenes
from pipeline.bridge.geometry import BEM_VERSION, bem_arguments, geometry_of
from pipeline.bridge.loading import load
from pipeline.tasks.task import Task, digest, expand
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.record.channels import Record
from solver.record.sampling import least_force
from solver.run import simulate
from solver.scene import Scene
from solver.statistics import FAINT, apart

OUT = Path("results/bench")
RUNS = 3  # of which the median counts
OUTPUTS = ("rotation", "motion", "absorbed_power", "hinge_force", "top_displacement", "bottom_stress")


def task(platform: str) -> Task:
    """The first realization of the representative sea of the Buan study."""
    content = load(Path("studies/buan.toml")).content
    wanted = {"sea_state": "representative", "platform": platform, "seed": 0}
    return next(t for t in expand(content) if all(t.labels[k] == v for k, v in wanted.items()))


def scene(platform: str, seed: int = 0) -> Scene:
    """Its scene, or that of another realization."""
    return scenes.scene(task(platform).parameters.model_copy(update={"seed": seed}))


def coefficients(name: str = "default", **changed) -> tuple[Hydrodynamics, float]:
    """The pair's coefficients with BEM arguments `changed`, and the time they took [s]; kept in a file."""
    OUT.mkdir(parents=True, exist_ok=True)
    arguments = bem_arguments(geometry_of(task("elastic").parameters)) | changed
    with np.printoptions(threshold=sys.maxsize):
        file = OUT / f"bem-{name}-{digest(repr(arguments), BEM_VERSION)}.nc"
    if file.exists():
        solution = cache.decode(file.read_bytes())
        return solution, float(file.with_suffix(".seconds").read_text())
    start = time.perf_counter()
    solution = bem.solve(**arguments)
    seconds = time.perf_counter() - start
    file.with_suffix(".seconds").write_text(f"{seconds}")
    file.write_bytes(cache.encode(solution))
    return solution, seconds


def with_settings(item: Scene, **changed) -> Scene:
    """The scene with other settings."""
    return replace(item, settings=replace(item.settings, **changed))


def median(function: Callable[[], object], runs: int = RUNS) -> float:
    """Median wall time [s] of `runs` calls."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def timed(item: Scene, known: Hydrodynamics | None, runs: int = RUNS) -> tuple[Record, float]:
    """Record, and median wall time [s]."""
    kept: list[Record] = []
    seconds = median(lambda: kept.append(simulate(item, known)), runs)
    return kept[-1], seconds


def worst(item: Scene, record: Record, exact: Record) -> tuple[float, str]:
    """Worst error of any mean, rms (of the rms) and std (of the std), and of what; as the audit counts them."""
    least = {"hinge_force": least_force(item)}
    return max(
        (apart(record.variables[name][1], exact.variables[name][1], least.get(name, 0.0)), name)
        for name in OUTPUTS
        if name in exact.variables
    )


def errors(item: Scene, record: Record, exact: Record) -> tuple[float, float]:
    """Worst error of mean, rms, std, and of max, min (of the larger one)."""
    extremes = [0.0]
    for name in set(OUTPUTS) & set(exact.variables):
        a, b = (r.variables[name][1].reshape(-1, 5) for r in (record, exact))
        used = b[:, 3] > FAINT * b[:, 3].max()
        a, b = a[used, :2], b[used, :2]
        extremes.append(float((np.abs(a - b) / np.abs(b).max(axis=1, keepdims=True)).max(initial=0.0)))
    return worst(item, record, exact)[0], max(extremes)
