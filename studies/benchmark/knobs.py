"""Run time against error: each knob alone, against a run that takes every knob to where it no longer shows."""

import statistics
from collections import Counter
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import ScalarFormatter

from solver.record.channels import Record
from studies.benchmark.case import OUT, RUNS, coefficients, errors, scene, timed, with_settings, worst

SECONDS = 900.0  # analysed in each run
FINE = {
    "time_step": 0.05,
    "modes": 30,
    "stations_per_element": 4,
    "azimuths": 48,
    "arc_points": 16,
    "line_points": 10,
    "field_tolerance": 1e-10,
    "newton_tolerance": 1e-10,
    "memory_tolerance": 1e-4,
}
KNOBS = {
    "time_step": [0.3, 0.25, 0.2, 0.15, 0.1],
    "modes": [2, 6, 12, "all"],
    "stations_per_element": [1, 2, 3],
    "azimuths": [8, 12, 16, 32],
    "arc_points": [3, 4, 6, 8, 12],
    "line_points": [1, 2, 3, 6],
    "field_tolerance": [1e-2, 1e-3, 1e-4, 1e-5, 1e-8],
    "newton_tolerance": [1e-4, 1e-5, 1e-6, 1e-8],
    "memory_tolerance": [3e-2, 1e-2, 5e-3, 3e-3, 1e-3],
}
PANELS = [108, 432, 972]  # a body: the lattice has no other counts between
FREQUENCIES = [20, 40, 60]  # of a body alone; see bem.frequency_grid
TOLERANCES = [3e-2, 1e-2, 3e-3, 1e-3]
STEPS = [0.3, 0.2, 0.15, 0.1, 0.05]  # s
REALIZATIONS = 8  # of the same sea, to tell the order of the steps' error from luck
SEEDS = [1, 2, 3]  # other realizations of the same sea
BEST = {"panels": 1728}


class Row(NamedTuple):
    """One run."""

    knob: str
    value: str
    run_time: float  # [s]
    error: float  # worst of any mean, rms, std
    error_of_extremes: float
    estimate: float  # of the worst error, by the record

    def __str__(self) -> str:
        return (
            f"{self.knob:22s}{self.value:>10s}{self.run_time:10.2f} s"
            f"{self.error:14.1e}{self.error_of_extremes:14.1e}{self.estimate:12.1e}"
        )


HEADER = f"{'knob':22s}{'value':>10s}{'run time':>12s}{'mean,rms,std':>14s}{'max,min':>14s}{'estimated':>12s}"


def vary() -> list[Row]:
    """Rows of the elastic scene: default, reference, every knob, other seeds, errors asked for, boundary elements."""
    usual, _ = coefficients()
    best, _ = coefficients("best", **BEST)
    short = with_settings(scene("elastic"), duration=SECONDS, time_step=scene("elastic").usual_step)
    exact, slow = timed(with_settings(short, **FINE), usual, 1)

    _, default = timed(short, usual, 2 * RUNS)

    def run(knob: str, value, item, known=usual, against=exact) -> Row:
        record, ratio = paired(item, known, short, usual)
        row = Row(knob, f"{value}", ratio * default, *errors(item, record, against), record.attrs["estimated_error"])
        print(row, flush=True)
        return row

    rows = [run("default", "", short), Row("reference", "", slow, 0.0, 0.0, exact.attrs["estimated_error"])]
    rows += [
        run(knob, value, with_settings(short, **{knob: value})) for knob, values in KNOBS.items() for value in values
    ]
    for support, seeds in (("elastic", SEEDS), ("fixed", [0, *SEEDS])):
        for seed in seeds:
            other = with_settings(scene(support, seed), duration=SECONDS)
            truth, _ = timed(with_settings(other, **FINE), usual, 1)
            rows.append(run(f"seed, {support}", seed, other, usual, truth))
    rows += [run("tolerance", value, with_settings(short, tolerance=value)) for value in TOLERANCES]
    # Other coefficients, same numerics: what the mesh and the frequency grid do alone.
    true, _ = timed(short, best, 1)
    for panels in PANELS:
        known, _ = coefficients(f"panels-{panels}", panels=panels)
        rows.append(run("panels", known.settings["panels"] // len(known.centres), short, known, true))
    fine, _ = coefficients("frequencies-120", omega=_grid(120))
    against, _ = timed(short, fine, 1)
    for count in FREQUENCIES:
        known, _ = coefficients(f"frequencies-{count}", omega=_grid(count))
        rows.append(run("frequencies", count, short, known, against))
    return rows


def steps(platform: str) -> None:
    """Print each step's error over realizations: median and extremes, the record's estimate, the worst number."""
    usual, _ = coefficients()
    print(f"{'time_step':>10s}{'median':>10s}{'least':>10s}{'largest':>10s}{'estimate':>10s}  worst, {platform}")
    errors_of: dict[float, list] = {step: [] for step in STEPS}
    for seed in range(REALIZATIONS):
        item = with_settings(scene(platform, seed), duration=SECONDS)
        finest = {"time_step": min(STEPS) / 2, "newton_tolerance": FINE["newton_tolerance"]}
        exact, _ = timed(with_settings(item, **finest), usual, 1)
        for step in STEPS:
            record, _ = timed(with_settings(item, time_step=step), usual, 1)
            errors_of[step].append((*worst(item, record, exact), record.attrs["discretization_error"]))
    for step, rows in errors_of.items():
        error, names, told = zip(*rows, strict=True)
        common = ", ".join(f"{name} {n} times" for name, n in Counter(names).most_common(2))
        numbers = (statistics.median(error), min(error), max(error), statistics.median(told))
        print(f"{step:10g}" + "".join(f"{x:10.1e}" for x in numbers) + f"  {common}", flush=True)


def paired(item, known, usual, usual_known) -> tuple[Record, float]:
    """Record, and run time over the default's, medians of runs in turn: what slows the machine slows both."""
    kept, times = [], ([], [])
    for _ in range(RUNS):
        for place, (one, h) in zip(times, ((item, known), (usual, usual_known)), strict=True):
            record, wall = timed(one, h, 1)
            place.append(wall)
            kept.append(record)
    return kept[-2], statistics.median(times[0]) / statistics.median(times[1])


def _grid(count: int) -> np.ndarray:
    """The pair's frequencies, as many times closer as `count` is of the default."""
    usual = coefficients()[0].omega
    at = np.linspace(0, len(usual) - 1, round(len(usual) * count / 40))
    return np.interp(at, np.arange(len(usual)), usual)


def picture(rows: list[Row]) -> None:
    """Run time against error; every knob a line, the default marked."""
    figure, axes = plt.subplots(figsize=(9, 5.5))
    for knob in [*KNOBS, "tolerance"]:
        part = [(r.run_time, max(r.error, 1e-6)) for r in rows if r.knob == knob]
        style = {"color": "k", "lw": 2.0} if knob == "tolerance" else {"lw": 0.9}
        axes.plot(*np.array(part).T, "o-", ms=4, label=knob, **style)
    axes.plot(rows[0].run_time, rows[0].error, "k*", ms=15, label="default", zorder=5)
    axes.axhline(1e-3, color="0.6", lw=0.8)
    axes.text(axes.get_xlim()[1], 1.05e-3, "0.1 %", ha="right", va="bottom", color="0.4")
    axes.set(
        xscale="log", yscale="log", xlabel=f"run time of {SECONDS:.0f} + 100 s on one core [s]",
        ylabel="worst error of any mean, rms or std", title="Each knob alone: representative sea, elastic platform",
    )  # fmt: skip
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_formatter(ScalarFormatter())
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper right")
    axes.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    figure.savefig(OUT / "pareto.png", dpi=130)
    plt.close(figure)
