"""SIGKILL a running study at random moments - its client, a worker, or both - and resume it, again and again.

In the end the dataset must be the one of an undisturbed run, bit for bit but for wall times, and no
finished task may have been run again.   python tests/pipeline/kills.py [KILLS] [SEED]
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import psutil

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


def command(*words) -> list[str]:
    """`study` with the engine of empty tasks."""
    return [sys.executable, str(HERE / "empty.py"), *map(str, words)]


def environment(**more) -> dict[str, str]:
    """What makes the project and the engine importable, here and in the workers."""
    return {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{HERE}", **more}


@contextlib.contextmanager
def at_work(folder: Path, *words, tasks: int = 12, begun: int = 2, **env) -> Iterator[subprocess.Popen]:
    """A run in a new session that has begun so many tasks; what is left of it in the end is killed."""
    from empty import study

    log = folder / "log"
    client = subprocess.Popen(
        command("run", study(folder, tasks), "--results", folder / "results", *words),
        env=environment(EMPTY_LOG=str(log), **env),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        deadline = time.monotonic() + 120
        while begun and not (log.exists() and len(log.read_text().split()) >= begun):
            assert client.poll() is None and time.monotonic() < deadline
            time.sleep(0.05)
        yield client
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(client.pid, signal.SIGKILL)
        client.communicate()


def finished(results: Path) -> dict[str, bytes]:
    """Statuses of accepted tasks, from files of their own or from packs."""
    lines = [line for path in sorted(results.glob("*/packs/*.jsonl")) for line in path.read_bytes().splitlines()]
    alone = {path.parent.name: path.read_bytes() for path in results.glob("*/tasks/*/status.json")}
    return {json.loads(line)["id"]: line for line in lines} | alone


def dataset(results: Path, study: str = "empty") -> dict[str, bytes]:
    """Every variable of the collected dataset but the wall times."""
    from pipeline.results.dataset import loaded

    data = loaded(results / study / "statistics.nc")
    return {
        str(n): np.asarray(v.values.astype(str) if v.dtype == object else v.values).tobytes()
        for n, v in data.variables.items()
        if n != "wall_time"
    }


def strike(study: Path, results: Path, dice: random.Random, env: dict[str, str], longest: float) -> str:
    """Start a run, and kill something in it after a while; what was hit."""
    client = subprocess.Popen(
        command("run", study, "--results", results),
        env=env,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    target = dice.choice(("client", "worker", "both"))
    time.sleep(dice.uniform(0.3, longest))
    workers = _workers(client.pid)
    victims = ([dice.choice(workers)] if workers and target != "client" else []) + (
        [psutil.Process(client.pid)] if target != "worker" and client.poll() is None else []
    )
    for victim in victims:
        try:
            victim.kill()
        except psutil.NoSuchProcess:
            target += " (gone)"
    if target.startswith("worker"):
        time.sleep(dice.uniform(0, 1.0))  # the run goes on without the worker for a while
    try:
        os.killpg(client.pid, signal.SIGKILL)  # whatever is left of this run: nothing else is in its session
    except ProcessLookupError:
        target += " (over)"
    client.wait()
    return target


def _workers(pid: int) -> list[psutil.Process]:
    """What the client's children have forked."""
    try:
        return [worker for child in psutil.Process(pid).children() for worker in child.children()]
    except psutil.NoSuchProcess:
        return []


def storm(folder: Path, kills: int, *, tasks: int, seconds: float, longest: float, seed: int = 0) -> dict[str, int]:
    """So many kills, a fresh study whenever one is complete; AssertionError if anything is lost or repeated."""
    from empty import study

    dice, env, struck = random.Random(seed), environment(EMPTY_SECONDS=str(seconds)), {}
    path = study(folder, tasks)
    calm, results = folder / "calm", folder / "storm0"
    subprocess.run(command("run", path, "--results", calm), env=env, check=True, capture_output=True)
    rounds = 0
    for kill in range(kills):
        before = finished(results)
        hit = strike(path, results, dice, env, longest)
        struck[hit] = struck.get(hit, 0) + 1
        after = finished(results)
        again = [name for name, status in before.items() if after.get(name) != status]
        assert not again, f"kill {kill} ({hit}): run again or lost: {again}"
        if len(after) == tasks or kill == kills - 1:
            _compare(path, calm, results, env)
            rounds += 1
            results = folder / f"storm{rounds}"
    return struck | {"complete studies": rounds}


def _compare(path: Path, calm: Path, results: Path, env: dict[str, str]) -> None:
    before = finished(results)
    for verb in ("run", "verify"):
        done = subprocess.run(command(verb, path, "--results", results), env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    after = finished(results)
    assert all(after[name] == status for name, status in before.items()), "a finished task was run again"
    assert dataset(results) == dataset(calm), "the dataset is not that of an undisturbed run"
    assert not list(results.glob("*/.statistics.nc.*.part"))[1:], "leftovers pile up"


if __name__ == "__main__":
    kills, seed = map(int, (*sys.argv[1:], *("200", "0")[len(sys.argv) - 1 :]))
    with tempfile.TemporaryDirectory() as folder:
        start = time.time()
        struck = storm(Path(folder), kills, tasks=300, seconds=0.01, longest=5.0, seed=seed)
        print(f"{kills} kills in {time.time() - start:.0f} s: {struck}")
        print("every dataset bitwise that of an undisturbed run, nothing finished run again")
