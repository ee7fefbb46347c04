"""What the pipeline itself costs: empty tasks, beside others that run such tasks.   python bench.py [TASKS]

The others keep nothing unless they say so: the table tells what each has left when it is killed.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import empty
import kills

LIMITS = {"run": 3.0, "run again": None, "status": 1.0, "plan": 1.0, "collect": 1.0}  # ms a task


def task(number: int) -> float:
    """An empty one."""
    return float(number)


def ours(tasks: int) -> dict[str, int]:
    """Every verb by itself, start-up included; the largest memory of each client [kB]."""
    with tempfile.TemporaryDirectory() as folder:
        return _ours(Path(folder), tasks)


def _ours(folder: Path, tasks: int) -> dict[str, int]:
    path, results, memory = empty.study(folder, tasks), folder / "results", {}
    for name, limit in LIMITS.items():
        start = time.perf_counter()
        words = kills.command(name.split()[0], path, "--results", results)
        process = subprocess.Popen(words, env=kills.environment(), stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        assert status == 0
        goal = f"(at most {limit:g})" if limit else ""
        cpu = (used.ru_utime + used.ru_stime) / tasks * 1e3
        memory[name] = used.ru_maxrss
        row(f"study {name}", wall, tasks, f"{goal:13} {cpu:5.2f} ms CPU of the client; {used.ru_maxrss >> 10} MB")
    size = sum(p.stat().st_size for p in results.rglob("*.*") if p.is_file())
    print(f"{'':26}{size / tasks / 1024:.1f} kB a task on disk")
    return memory


def growth(tasks: int) -> None:
    """What each task adds to a client's memory, from two sizes of study."""
    few, many = ours(tasks // 10), ours(tasks)
    each = {name: (many[name] - few[name]) / (tasks - tasks // 10) for name in LIMITS}
    print(f"{'':26}memory grows by {', '.join(f'{name} {kb:.2f}' for name, kb in each.items())} kB a task")


def row(name: str, wall: float, tasks: int, note: str) -> None:
    """One line of the table."""
    print(f"{name:24}{wall / tasks * 1e3:8.2f} ms a task  {note}", flush=True)


def dask_map(tasks: int) -> None:
    """client.map."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs="CRITICAL"
        ) as cluster,
        Client(cluster) as client,
    ):
        client.gather(client.map(task, range(tasks)))


def joblib_parallel(tasks: int) -> None:
    """joblib.Parallel, batches as it chooses them."""
    from joblib import Parallel, delayed

    Parallel(n_jobs=2)(delayed(task)(n) for n in range(tasks))


def pipefunc_map(tasks: int) -> None:
    """pipefunc with its run folder."""
    from pipefunc import Pipeline, pipefunc

    pipeline = Pipeline([pipefunc(output_name="y", mapspec="number[i] -> y[i]")(task)])
    with tempfile.TemporaryDirectory() as folder:
        pipeline.map({"number": list(range(tasks))}, run_folder=folder, parallel=True, show_progress=False)


def xyzpy_crop(tasks: int) -> None:
    """xyzpy's runner, in this process."""
    from xyzpy import Runner

    Runner(task, var_names=["y"]).run_combos({"number": list(range(tasks))}, verbosity=0)


OTHERS: dict[str, tuple[Callable[[int], None], str]] = {
    "distributed": (dask_map, "killed: all is lost, nothing is on the disk"),
    "joblib": (joblib_parallel, "killed: all is lost, unless every function is cached with Memory"),
    "pipefunc": (pipefunc_map, "killed: outputs in the run folder stay; no checksums, no failure records"),
    "xyzpy": (xyzpy_crop, "killed: all is lost, unless sown as a Crop of batches"),
}

if __name__ == "__main__":
    tasks = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    load = os.getloadavg()[0]
    print(f"{tasks} empty tasks, 2 workers on {os.cpu_count()} cores, load before {load:.1f}; start-up included")
    growth(tasks)
    for name, (run, note) in OTHERS.items():
        if importlib.util.find_spec(name) is None:
            print(f"{name:24} not installed")
            continue
        start = time.perf_counter()
        run(tasks)
        row(name, time.perf_counter() - start, tasks, note)
