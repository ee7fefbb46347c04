"""Run time against error: `make bench` varies each knob alone on the representative Buan case.

One process, one core, the same seconds of the same sea. The reference takes every knob to where
its own change no longer shows. Output: a table, results/bench/bench.nc and results/bench/pareto.png.
"""

import statistics
import sys
import time
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr

from pipeline import scenes, study, tasks
from solver.hydrodynamics import bem
from solver.hydrodynamics.bem import Hydrodynamics
from solver.hydrodynamics.froude_krylov import pressure_load
from solver.hydrodynamics.panels import panel_load, revolution_mesh, waves_at
from solver.record import Record
from solver.scene import Scene
from solver.sea.field import WaveField
from solver.simulate import simulate
from solver.system import prepare

mpl.use("Agg")
import matplotlib.pyplot as plt

OUT = Path("results/bench")
RUNS = 3  # of which the median counts
SECONDS = 900.0  # analysed in each run of the knob table
FINE = {
    "time_step": 0.05,
    "modes": 30,
    "stations_per_element": 4,
    "azimuths": 48,
    "arc_points": 16,
    "line_points": 10,
    "field_tolerance": 1e-10,
    "newton_tolerance": 1e-10,
}
KNOBS = {
    "time_step": [0.3, 0.2, 0.15, 0.1, 0.075],
    "modes": [2, 6, 12],
    "stations_per_element": [1, 2, 3],
    "azimuths": [8, 16, 32],
    "arc_points": [4, 8, 12],
    "line_points": [2, 4, 6],
    "field_tolerance": [1e-3, 1e-4, 1e-6, 1e-8],
    "newton_tolerance": [1e-4, 1e-5, 1e-6, 1e-8],
    "memory_tolerance": [3e-2, 1e-2, 5e-3],
}
OUTPUTS = ("rotation", "absorbed_power", "hinge_force", "top_displacement", "bottom_stress")


def representative(platform: str) -> tuple[Scene, Hydrodynamics]:
    """Scene and coefficients of the first realization of the representative sea."""
    content = study.load(Path("studies/buan.toml")).content
    wanted = {"sea_state": "representative", "platform": platform, "seed": 0}
    task = next(t for t in tasks.expand(content) if all(t.labels[k] == v for k, v in wanted.items()))
    return scenes.scene(task.parameters), bem.solve(**scenes.bem_arguments(task.geometry))


def timed(scene: Scene, coefficients: Hydrodynamics, runs: int = RUNS) -> tuple[Record, float]:
    """Record, and median wall time [s] of `runs` runs."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        record = simulate(scene, coefficients)
        times.append(time.perf_counter() - start)
    return record, statistics.median(times)


def errors(record: Record, exact: Record) -> tuple[float, float]:
    """Worst error of mean, rms, std (of the rms; std of the std) and of max, min (of the larger one)."""
    moments = extremes = 0.0
    for name in OUTPUTS:
        a, b = (r.variables[name][1].reshape(-1, 5) for r in (record, exact))
        used = b[:, 3] > 1e-6 * b[:, 3].max()  # the planar scene's still directions
        # What hardly moves beside its like (heave of the deck) is measured by its own rms all the same.
        a, b = a[used], b[used]
        largest = np.maximum(np.abs(b[:, 0]), np.abs(b[:, 1]))
        difference = np.abs(a - b)
        moments = max(moments, (difference[:, 2:4] / b[:, 3:4]).max(), (difference[:, 4] / b[:, 4]).max())
        extremes = max(extremes, (difference[:, :2] / largest[:, None]).max())
    return float(moments), float(extremes)


def vary(scene: Scene, coefficients: Hydrodynamics) -> list[tuple[str, float, float, float, float]]:
    """(knob, value, run time, error of moments, error of extremes), defaults first."""
    short = replace(scene, settings=replace(scene.settings, duration=SECONDS))
    exact, slow = timed(replace(short, settings=replace(short.settings, **FINE)), coefficients, 1)
    default, usual = timed(short, coefficients)
    rows = [("default", np.nan, usual, *errors(default, exact)), ("reference", np.nan, slow, 0.0, 0.0)]
    for knob, values in KNOBS.items():
        for value in values:
            record, wall = timed(replace(short, settings=replace(short.settings, **{knob: value})), coefficients)
            rows.append((knob, value, wall, *errors(record, exact)))
            print_row(rows[-1])
    return rows


def print_row(row: tuple[str, float, float, float, float]) -> None:
    """One line of the table."""
    name, value, wall, moments, extremes = row
    print(f"{name:22s}{value:>10.4g}{wall:10.2f} s{moments:14.1e}{extremes:14.1e}", flush=True)


def pressure_pair(scene: Scene, coefficients: Hydrodynamics) -> tuple[float, float, float]:
    """Median time [µs] of one float's load by quadrature and by 8,520 panels, and their difference."""
    system = prepare(scene, coefficients)
    body, item = system.bodies, scene.floats[0]
    field = WaveField(scene.sea, scene.water.depth, scene.water.gravity)
    sample = 1000  # well after the ramp
    t = sample * system.dt / 2
    local = system.drive(system.series(system.dt).block(sample, 1)).field[0, 0]
    rule = body.rule._replace(patch=np.ascontiguousarray(body.rule.patch[0]))
    mesh = revolution_mesh(item.hull, along=71, around=120)
    sea = scene.sea
    waves = waves_at(
        field.k, sea.omega, sea.amplitude, depth=scene.water.depth, heading=sea.heading, t=t
    )  # fmt: skip
    position, turned = body.reference[0] + np.array([0.05, 0.0, 0.1]), np.eye(3)
    fast, slow = np.zeros(6), np.zeros(6)

    def quick(load):
        pressure_load(
            position, turned, rule, local, body.reference[0], body.wave_direction, body.rho_g, False, body.depth, load
        )

    def paper(load):
        panel_load(position, turned, mesh, waves, body.rho_g, False, load)

    quick(fast), paper(slow)
    pairs = [(_each(quick, 2000), _each(paper, 3)) for _ in range(5)]
    difference = np.abs(fast - slow).max() / np.abs(fast).max()
    return statistics.median(p[0] for p in pairs), statistics.median(p[1] for p in pairs), float(difference)


def _each(function, count: int) -> float:
    load = np.zeros(6)
    start = time.perf_counter()
    for _ in range(count):
        function(load)
    return (time.perf_counter() - start) / count * 1e6


def picture(rows) -> None:
    """Run time against error; every knob a line, the default marked."""
    figure, axes = plt.subplots(figsize=(8, 5))
    for knob in KNOBS:
        part = [(w, m) for name, _, w, m, _ in rows if name == knob]
        axes.plot(*np.array(part).T, "o-", ms=4, lw=0.8, label=knob)
    default = rows[0]
    axes.plot(default[2], default[3], "k*", ms=14, label="default")
    axes.axhline(1e-3, color="0.6", lw=0.8)
    axes.text(axes.get_xlim()[1], 1.05e-3, "0.1 %", ha="right", va="bottom", color="0.4")
    axes.set(
        xscale="log", yscale="log", xlabel=f"run time of {SECONDS:.0f} + 100 s on one core [s]",
        ylabel="worst error of any mean, rms or std", title="Buan, representative sea, elastic platform",
    )  # fmt: skip
    axes.legend(frameon=False, fontsize=8, ncols=2)
    axes.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    figure.savefig(OUT / "pareto.png", dpi=130)


def main() -> int:
    """Table, file and figure."""
    OUT.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    elastic, coefficients = representative("elastic")
    print(f"BEM of the pair: {time.perf_counter() - start:.1f} s")
    fixed = replace(elastic, platform=None)
    for scene in (elastic, fixed):  # compile, and load what is cached
        simulate(replace(scene, settings=replace(scene.settings, duration=50.0)), coefficients)
    whole = {name: timed(s, coefficients)[1] for name, s in (("elastic", elastic), ("fixed", fixed))}
    for name, wall in whole.items():
        print(f"3,700 s, {name}: {wall:.2f} s, {3700 / wall:.0f} times real time")
    quick, paper, difference = pressure_pair(fixed, coefficients)
    print(f"pressure load of one float: quadrature {quick:.2f} µs, 8,520 panels x 130 waves {paper:.0f} µs:")
    print(f"  {paper / quick:.0f} times, difference {difference:.1e} (the panels' own error)")
    print(f"{'knob':22s}{'value':>10s}{'run time':>12s}{'mean,rms,std':>14s}{'max,min':>14s}")
    rows = vary(elastic, coefficients)
    for row in rows[:2]:
        print_row(row)
    columns = dict(
        zip(("knob", "value", "run_time", "error", "error_of_extremes"), zip(*rows, strict=True), strict=True)
    )
    data = xr.Dataset({name: ("case", np.array(values)) for name, values in columns.items()})
    data["run_time"].attrs = {"units": "s", "long_name": "median wall time of one run"}
    data.attrs = {f"run_time_3700_s_{k}": v for k, v in whole.items()} | {"pressure_speed_up": paper / quick}
    data.to_netcdf(OUT / "bench.nc", engine="netcdf4")
    picture(rows)
    print(f"table in {OUT}/bench.nc, figure in {OUT}/pareto.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
