"""How long a study takes before its first step, and what a second worker gains.   python startup.py [SECONDS]

With the solver, compiled and with known coefficients: a study of floats on a platform, SECONDS long records.
Two cores of a machine may share what they compute with, so plain processes that do the same are timed beside it:
no pipeline can gain more.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import kills

BUAN = kills.ROOT / "studies" / "buan.toml"
SEEDS = 12
PLAIN = """
import sys, time
from studies.benchmark.case import coefficients, scene
from solver.run import simulate
known, item = coefficients()[0], scene("elastic")
simulate(item, known)
time.sleep(max(0.0, float(sys.argv[1]) - time.time()))
start = time.perf_counter()
for _ in range(6):
    simulate(item, known)
print(time.perf_counter() - start)
"""


def study(folder: Path, seconds: float) -> Path:
    """The Buan study with short records and one sea state."""
    text = BUAN.read_text()
    for key, value in {"duration": f"{seconds}", "discard": "10.0", "ramp": "10.0"}.items():
        text = _with(text, key, value)
    text = _with(_with(text, "sea_state", '["2018"]'), "seed", str(list(range(SEEDS))))
    path = folder / "short.toml"
    path.write_text(_with(text, "platform", '["elastic", "fixed"]'))
    return path


def _with(text: str, key: str, value: str) -> str:
    """The study with another value of a key."""
    lines = [f"{key} = {value}" if line.split("=")[0].strip() == key else line for line in text.splitlines()]
    assert lines != text.splitlines(), key
    return "\n".join(lines) + "\n"


def run(path: Path, results: Path, workers: int, *more: str) -> tuple[float, float, float]:
    """Start a run: seconds until its first step, as its records tell, until its end, and from task to task."""
    from pipeline.results.netcdf import from_bytes

    command = [sys.executable, "-m", "pipeline", "run", path, "--results", results, "--workers", workers, *more]
    start, since = time.time(), time.perf_counter()
    subprocess.run(list(map(str, command)), env=kills.environment(), check=True, stdout=subprocess.DEVNULL)
    whole = time.perf_counter() - since
    records = list(results.glob("short/tasks/*/record.nc"))
    steps = [r.stat().st_mtime - float(from_bytes(r.read_bytes())[1]["march_time"]) for r in records]
    ends = [r.stat().st_mtime for r in records]
    return min(steps) - start, whole, (max(ends) - min(ends)) / max(1, len(ends) - 1)


def side_by_side(processes: int) -> float:
    """Mean seconds in which each of so many plain processes simulates the same records, all at once."""
    command = [sys.executable, "-c", PLAIN, str(time.time() + 20)]
    started = [
        subprocess.Popen(command, cwd=kills.ROOT, env=kills.environment(), stdout=subprocess.PIPE, text=True)
        for _ in range(processes)
    ]
    return sum(float(p.communicate()[0]) for p in started) / processes


if __name__ == "__main__":
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 3600.0
    folder = Path(tempfile.mkdtemp())
    try:
        path = study(folder, seconds)
        print(
            f"{2 * SEEDS} tasks of {seconds + 10:g} s on {os.cpu_count()} cores, load before {os.getloadavg()[0]:.1f}"
        )
        run(path, folder / "first", 2)  # compiles, and solves for the coefficients
        walls: dict[int, float] = {}
        paces: dict[int, float] = {}
        for workers in (1, 2):
            results = folder / f"workers{workers}"
            shutil.copytree(folder / "first" / "hydrodynamics", results / "hydrodynamics")
            first, walls[workers], paces[workers] = run(path, results, workers)
            print(f"{workers} workers: first step after {first:.2f} s, end after {walls[workers]:.2f} s", flush=True)
        ones = []
        for results in (folder / "one", folder / "another", folder / "third"):
            shutil.copytree(folder / "first" / "hydrodynamics", results / "hydrodynamics")
            ones.append(run(path, results, 2, "--select", "platform=fixed,seed=0")[0])
        print(f"one task, in the command's own process: first step after {min(ones):.2f} s")
        again = min(run(path, results, 2)[1] for _ in range(3))
        print(f"nothing to do: {again:.2f} s (at most 0.8)")
        alone, together = side_by_side(1), side_by_side(2)
        print(
            f"2 workers are {walls[1] / walls[2]:.2f} times as fast as 1 with start and report,"
            f" {paces[1] / paces[2]:.2f} times from task to task; 2 plain processes {2 * alone / together:.2f} times"
        )
    finally:
        shutil.rmtree(folder)
