"""Short versions of the scripts beside this file, a real cluster, and broken disks and workers."""

import contextlib
import errno
import json
import os
import re
import shutil
import subprocess
import sys
import time

import empty
import fuzz
import kills
import pytest

from pipeline.store import Store
from pipeline.study import load
from pipeline.tasks import expand


def study(*words, cwd=None, **env):
    """The command line with the engine of empty tasks."""
    return subprocess.run(
        kills.command(*words), env=kills.environment(**env), cwd=cwd, capture_output=True, text=True, timeout=120
    )


def contents(results):
    return {p.parent.name: json.loads(p.read_bytes())["content"] for p in results.glob("empty/tasks/*/status.json")}


@pytest.fixture
def small_study(tmp_path):
    return empty.study(tmp_path, 12)


@pytest.fixture
def results(tmp_path):
    return tmp_path / "results"


def test_random_study_files_are_refused_with_a_key(tmp_path):
    assert sum(fuzz.files(tmp_path, 60, seed=3).values()) == 60


@pytest.mark.slow
def test_killed_runs_lose_and_repeat_nothing(tmp_path):
    kills.storm(tmp_path, 2, tasks=60, seconds=0.05, longest=5.0, seed=1)


@contextlib.contextmanager
def cluster(folder, *security, workers=2):
    """`dask scheduler` and `dask worker` as a user starts them; workers know nothing of the client's folders."""
    away = folder / "away"
    away.mkdir()
    dask, env = [sys.executable, "-m", "dask"], kills.environment()
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": env, "cwd": away}
    where = away / "scheduler.json"
    host = ["--host", f"{'tls' if security else 'tcp'}://127.0.0.1"] if security else ["--host", "127.0.0.1"]
    processes = []
    try:
        scheduler = [*dask, "scheduler", *host, "--port", "0", "--no-dashboard", "--scheduler-file", str(where)]
        processes.append(subprocess.Popen([*scheduler, *security], **quiet))
        deadline = time.monotonic() + 30
        while not where.exists():
            assert time.monotonic() < deadline
            time.sleep(0.1)
        address = json.loads(where.read_text())["address"]
        for _ in range(workers):
            worker = [*dask, "worker", address, "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"]
            processes.append(subprocess.Popen([*worker, *security], **quiet))
        yield address
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            process.wait(20)


def test_bitwise_the_same_wherever_it_runs(tmp_path, small_study):
    """Serial, 1 worker, 2 workers, a cluster started from the command line, and a rerun."""
    found = {}
    for name, words in {"serial": ("--workers", 1), "one": ("--workers", 1, "--timeout", 60), "two": ()}.items():
        done = study("run", small_study, "--results", tmp_path / name, *words)
        assert done.returncode == 0, done.stderr
        found[name] = contents(tmp_path / name), kills.dataset(tmp_path / name)
    with cluster(tmp_path) as address:
        done = study("run", small_study, "--results", tmp_path / "cluster", "--scheduler", address)
    assert done.returncode == 0, done.stderr
    found["cluster"] = contents(tmp_path / "cluster"), kills.dataset(tmp_path / "cluster")
    assert not list((tmp_path / "away").rglob("record.nc"))
    assert all(len(of[0]) == 12 and of == found["serial"] for of in found.values())
    again = study("rerun", small_study, "seed=5", "--results", tmp_path / "two")
    assert "bitwise the same as the old record" in again.stdout


@pytest.mark.skipif(not shutil.which("openssl"), reason="needs openssl")
def test_tls_is_passed_through(tmp_path, small_study):
    key, cert = tmp_path / "key.pem", tmp_path / "cert.pem"
    make = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost"]
    subprocess.run([*make, "-keyout", key, "-out", cert], check=True, capture_output=True)
    security = ("--tls-ca-file", cert, "--tls-cert", cert, "--tls-key", key)
    with cluster(tmp_path, *map(str, security), workers=1) as address:
        assert address.startswith("tls://")
        run = ("run", small_study, "--results", tmp_path / "r", "--scheduler", address)
        assert study(*run, "--tls", cert, cert, key).returncode == 0
        refused = study(*run)
    assert refused.returncode != 0 or "nothing to run" in refused.stdout


def test_no_scheduler_there(small_study, results):
    done = study(
        "run",
        small_study,
        "--results",
        results,
        "--scheduler",
        "tcp://127.0.0.1:9",
        DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT="1s",
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "127.0.0.1:9" in done.stderr


def test_a_second_run_waits_and_says_so(small_study, results):
    words = kills.command("run", small_study, "--results", results)
    first = subprocess.Popen(words, env=kills.environment(EMPTY_SECONDS="0.5"), stdout=subprocess.DEVNULL)
    while not (results / "empty" / ".lock.json").exists():
        time.sleep(0.05)
    second = study("run", small_study, "--results", results)
    assert first.wait() == 0
    assert f"in use by process {first.pid}" in second.stderr
    assert "nothing to run" in second.stdout


def test_a_task_that_hangs_is_stopped_and_the_others_go_on(tmp_path, results):
    path = empty.study(tmp_path, 4)
    done = study("run", path, "--results", results, "--timeout", "1.5", EMPTY_SECONDS="60", EMPTY_SLOW_SEED="2")
    assert done.returncode == 1
    assert "4 tasks: 3 done, 1 failed" in done.stdout
    assert re.search(r"failed: \w+ seed=2: Lost: ran longer than --timeout = 1.5 s", done.stderr)
    assert study("rerun", path, "--failed", "--results", results).returncode == 0


@pytest.mark.slow
def test_a_worker_over_its_memory(tmp_path, results):
    path = empty.study(tmp_path, 3)
    greedy = {"EMPTY_MEGABYTES": "1500", "EMPTY_SECONDS": "1", "EMPTY_SLOW_SEED": "1"}
    done = study("run", path, "--results", results, "--memory", "600MB", **greedy)
    assert done.returncode == 1
    assert "3 tasks: 2 done, 1 failed" in done.stdout
    assert "over its memory" in done.stderr
    assert study("rerun", path, "--failed", "--results", results).returncode == 0


@contextlib.contextmanager
def tmpfs(folder, options):
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True).returncode:
        pytest.skip("needs the right to mount")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=True)


def test_disk_full(tmp_path):
    path = empty.study(tmp_path, 200)
    with tmpfs(tmp_path / "full", "size=300k") as full:
        done = study("run", path, "--results", full, "--workers", 1)
        assert done.returncode == 1
        assert "No space left on device; finished tasks are kept" in done.stderr
        kept = len(contents(full))
        assert 0 < kept < 200
        assert study("verify", path, "--results", full).returncode == 0
        subprocess.run(["mount", "-o", "remount,size=20m", full], check=True)
        done = study("run", path, "--results", full, "--workers", 1)
        assert f"200 tasks: 200 done; {200 - kept} run now" in done.stdout, done.stderr
        assert not list(full.rglob("*.part"))


def test_read_only_results(tmp_path, small_study):
    with tmpfs(tmp_path / "ro", "size=1m") as folder:
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        done = study("run", small_study, "--results", folder)
        assert done.returncode == 1
        assert "Read-only file system" in done.stderr
        assert "Traceback" not in done.stderr
        assert study("status", small_study, "--results", folder).returncode == 2


@pytest.mark.parametrize("damage", ["cut", "flip", "empty", "gone", "status"])
def test_damaged_results_are_named_and_made_again(small_study, results, damage):
    study("run", small_study, "--results", results, "--workers", 1)
    before = contents(results)
    record = next(results.rglob("record.nc"))
    data = bytearray(record.read_bytes())
    data[len(data) // 2] ^= 16
    status = record.with_name("status.json")
    if damage == "gone":
        record.unlink()
    elif damage == "status":
        status.write_bytes(status.read_bytes()[:50])
    else:
        record.write_bytes({"cut": data[:100], "flip": data, "empty": b""}[damage])
    found = study("verify", small_study, "--results", results)
    assert ("1 missing" if damage == "status" else "1 damaged") in found.stdout
    again = study("run", small_study, "--results", results, "--workers", 1)
    assert "12 done; 1 run now" in again.stdout
    assert contents(results) == before


def test_a_clock_that_goes_backwards(small_study, results, tmp_path, monkeypatch):
    from pipeline import cache
    from pipeline.campaign import Campaign, unfinished

    monkeypatch.setattr(cache.Cache.__init__, "__defaults__", (len,))
    now = iter(range(10**9, 0, -3600))
    monkeypatch.setattr(time, "gmtime", lambda *_: time.struct_time((2000, 1, 1, next(now) % 24, 0, 0, 0, 1, 0)))
    store, tasks = Store(results, "empty"), load(small_study).tasks
    campaign = Campaign(study=small_study, results=results, store=store, engine=empty.ENGINE)
    campaign.run(tasks.where(lambda task: task.labels["seed"] < 6), lambda *_: None)
    campaign.run(unfinished(tasks, store), lambda *_: None)
    assert not unfinished(tasks, store)


def test_an_error_while_a_batch_is_written_leaves_no_part(small_study, results, monkeypatch):
    store, tasks = Store(results, "empty"), list(expand(load(small_study).content))
    store.keep([(task, b"old", {}) for task in tasks[:2]])

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("pipeline.store.flush", full)
    with pytest.raises(OSError, match="No space"):
        store.keep([(task, b"new", {}) for task in tasks[2:9]])
    assert not list(results.rglob("*.part"))
    assert [store.look(t, checksums=True).state for t in tasks[:3]] == ["done", "done", "missing"]
