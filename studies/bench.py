"""Run time and error, side by side: `make bench` on the representative Buan case.

One process, one core, the same seconds of the same sea. Output: tables, results/bench/bench.nc,
and the figures pareto.png (each knob alone) and scaling.png (cost against size).
"""

import os
import sys
from pathlib import Path
from platform import processor

import matplotlib as mpl

mpl.use("Agg")
import numpy as np
import xarray as xr

from studies.benchmark import boundary, estimates, knobs, outputs, paper, parts, scaling, stops
from studies.benchmark.case import OUT, coefficients, scene, timed, with_settings


def main() -> int:
    """Tables, file and figures."""
    OUT.mkdir(parents=True, exist_ok=True)
    print(f"{machine()}, load {os.getloadavg()[0]:.1f}")
    print(f"boundary elements of the pair, default mesh: {coefficients()[1]:.1f} s; known: nothing")
    boundary.table()
    attrs = {}
    for platform in ("elastic", "fixed"):
        case, (known, _) = scene(platform), coefficients()
        timed(with_settings(case, duration=50.0), known, 1)  # compile, and load what is cached
        _, wall = timed(case, known)
        attrs[f"run_time_3700_s_{platform}"] = wall
        print(f"3,700 s, {platform}: {wall:.2f} s, {3700 / wall:.0f} times real time")
    attrs |= of_parts() | of_pressure() | of_paper() | outputs.table() | stops.table()
    attrs["memory_of_three_hours_MB"] = scaling.memory_of_three_hours()
    print(f"largest memory of a 3-hour record: {attrs['memory_of_three_hours_MB']:.0f} MB")
    sizes = scaling.measure()
    scaling.picture(sizes)
    print(knobs.HEADER)
    rows = knobs.vary()
    for platform in ("fixed", "elastic"):
        knobs.steps(platform)
    estimates.table()
    estimates.bent()
    estimates.tolerances()
    knobs.picture(rows)
    save(rows, sizes, attrs)
    print(f"tables in {OUT}/bench.nc, figures in {OUT}/pareto.png and scaling.png")
    return 0


def machine() -> str:
    """Processor and number of cores: times are this machine's, ratios hold on others."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")] or [processor()]
    return f"{names[0]}, {os.cpu_count()} cores"


def of_parts() -> dict[str, float]:
    """Print what a step is made of."""
    for platform in ("elastic", "fixed"):
        print(f"one step, {platform}: {parts.whole_step(platform):.1f} µs, of which")
        for name, each, calls in parts.of_a_step(platform):
            print(f"  {name:32s}{each:8.2f} µs x {calls:g}")
    fit = parts.memory_fit()
    print(f"fit of the pair's radiation memory: {fit:.2f} s, once a geometry")
    damping, sea = (1e3 * seconds for seconds in parts.frequency_task())
    print(
        f"a task in the frequency domain, elastic: {damping:.1f} ms with another damping each, {sea:.0f} in another sea"
    )
    return {"memory_fit": fit, "frequency_task": damping / 1e3, "frequency_sea": sea / 1e3}


def of_pressure() -> dict[str, float]:
    """Print one float's pressure load both ways."""
    quick, slow, difference = parts.pressure_pair()
    print(f"pressure load of one float: quadrature {quick:.2f} µs, 8,520 panels x 130 waves {slow:.0f} µs:")
    print(f"  {slow / quick:.0f} times, difference {difference:.1e} (the error of the panels)")
    return {"pressure_speed_up": slow / quick}


def of_paper() -> dict[str, float]:
    """Print the paper's method beside ours on the same seconds of the same sea."""
    minute = paper.beside("elastic")
    print(f"{paper.SECONDS:g} s of the case: {minute.paper:.1f} s by the paper's method, {minute.ours:.4f} s by ours:")
    print(f"  {minute.paper / minute.ours:.0f} times, largest difference {minute.difference:.1e} of the rms")
    return {"paper_speed_up": minute.paper / minute.ours}


def save(rows: list[knobs.Row], sizes: dict, attrs: dict[str, float]) -> None:
    """Everything as one dataset."""
    data = xr.Dataset({name: ("case", np.array([getattr(r, name) for r in rows])) for name in knobs.Row._fields})
    data["run_time"].attrs = {"units": "s", "long_name": "median wall time of one run"}
    for name, (size, times) in sizes.items():
        key = name.split("[")[0].split("(")[0].strip().replace(" ", "_")
        data[f"march_time_by_{key}"] = (key, np.array(times), {"units": "s", "long_name": f"march, by {name}"})
        data = data.assign_coords({key: np.array(size, float)})
    data.attrs = attrs
    data.to_netcdf(OUT / "bench.nc", engine="netcdf4")


if __name__ == "__main__":
    sys.exit(main())
