"""Wherever tasks run, the numbers are the same to the last bit: here, on workers, on somebody's cluster."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from importlib import import_module

import empty
import kills
import psutil
import pytest

from pipeline.interrupt import KEPT
from pipeline.running.cluster import IMPORTED

SHORT = "[record]\nduration = 20.0\ndiscard = 5.0\nramp = 5.0\n"


@pytest.fixture
def small_study(tmp_path):
    return empty.study(tmp_path, 12)


def study(*words, solver=False, **env):
    """The command line, with the engine of empty tasks or with the solver."""
    command = [sys.executable, "-m", "pipeline", *map(str, words)] if solver else kills.command(*words)
    return subprocess.run(command, env=kills.environment(**env), capture_output=True, text=True, timeout=900)


def other_sources(folder):
    """The project with a solver that is not the same, for PYTHONPATH."""
    for package in ("solver", "pipeline"):
        shutil.copytree(kills.ROOT / package, folder / package)
    with (folder / "solver" / "errors.py").open("a") as file:
        file.write("# other\n")
    return f"{folder}{os.pathsep}{kills.HERE}"


@contextlib.contextmanager
def cluster(folder, *security, workers=2, strangers=0):
    """`dask scheduler` and `dask worker` as a user starts them; workers know nothing of the client's folders.

    strangers: so many of the workers have other sources.
    """
    paths = [other_sources(folder / "other")] * strangers + [kills.environment()["PYTHONPATH"]] * (workers - strangers)
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
        while not where.exists():
            assert processes[0].poll() is None
            time.sleep(0.1)
        address = json.loads(where.read_text())["address"]
        for path in paths:
            worker = [*dask, "worker", address, "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"]
            processes.append(subprocess.Popen([*worker, *security], **{**quiet, "env": {**env, "PYTHONPATH": path}}))
        yield address
    finally:
        for process in reversed(processes):
            process.terminate()
        # A worker whose scheduler was killed may wait for it for ever, whatever it is told.
        for process in processes:
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                for child in (*psutil.Process(process.pid).children(recursive=True), process):
                    child.kill()
                process.wait()


def computed(results):
    """All that a study has computed: digests of the records, coefficients, the dataset."""
    (root,) = (path.parent for path in results.glob("*/statistics.nc"))
    records = {task: json.loads(status)["content"] for task, status in kills.finished(results).items()}
    coefficients = {p.name: p.read_bytes() for p in results.glob("hydrodynamics/*.nc")}
    return records, coefficients, kills.dataset(results, root.name)


@pytest.mark.slow
@pytest.mark.parametrize("solver", [False, True])
def test_bitwise_the_same_wherever_it_runs(tmp_path, small_study, small, solver):
    """Serial, 1 worker, 2 workers, a cluster started from the command line, and reruns of single tasks."""
    if solver:
        small.write_text(small.read_text() + SHORT)
    path, tasks = (small, "platform=elastic,seed=1") if solver else (small_study, "seed=5")
    places = {"serial": ("--workers", 1), "one": ("--workers", 1, "--timeout", 600), "two": ("--workers", 2)}
    for name, words in places.items():
        done = study("run", path, "--results", tmp_path / name, *words, solver=solver)
        assert done.returncode == 0, done.stderr
    with cluster(tmp_path) as address:
        done = study("run", path, "--results", tmp_path / "far", "--scheduler", address, solver=solver)
    assert done.returncode == 0, done.stderr
    assert not list((tmp_path / "away").rglob("*.nc"))
    first = computed(tmp_path / "serial")
    assert len(first[0]) == 12 and len(first[1]) == 1
    assert all(computed(tmp_path / name) == first for name in ("one", "two", "far"))
    again = study("rerun", path, tasks, "--results", tmp_path / "far", "--workers", 1, solver=solver)
    assert again.stdout.count("bitwise the same as the old record") == (2 if solver else 1), again.stderr
    assert computed(tmp_path / "far") == first


@pytest.mark.skipif(not shutil.which("openssl"), reason="needs openssl")
@pytest.mark.slow
def test_tls_is_passed_through(tmp_path, small_study):
    key, cert = tmp_path / "key.pem", tmp_path / "cert.pem"
    make = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost"]
    subprocess.run([*make, "-keyout", key, "-out", cert], check=True, capture_output=True)
    security = ("--tls-ca-file", cert, "--tls-cert", cert, "--tls-key", key)
    with cluster(tmp_path, *map(str, security), workers=1) as address:
        assert address.startswith("tls://")
        run = ("run", small_study, "--scheduler", address, "--results")
        assert study(*run, tmp_path / "r", "--tls", cert, cert, key).returncode == 0
        refused = study(*run, tmp_path / "other")
    assert refused.returncode == 2
    assert refused.stderr == f"--scheduler = {address}: needs --tls CA CERT KEY, or dask's own tls settings\n"


@pytest.mark.slow
def test_a_worker_with_other_sources_gets_no_more_work(tmp_path, small_study):
    """The other worker does all."""
    with cluster(tmp_path, strangers=1) as address:
        run = ("run", small_study, "--scheduler", address, "--results", tmp_path / "r")
        done = study(*run, EMPTY_SECONDS="0.5")
    assert done.returncode == 0, done.stderr
    assert "12 tasks: 12 done" in done.stdout
    assert done.stderr.count("it gets no more work") == 1


@pytest.mark.slow
def test_tasks_for_which_there_are_only_other_sources_stay_missing(tmp_path, small_study):
    with cluster(tmp_path, workers=1, strangers=1) as address:
        done = study("run", small_study, "--scheduler", address, "--results", tmp_path / "r")
    assert done.returncode == 1
    assert "no worker has this process's solver sources: install the same; finished tasks are kept" in done.stderr
    assert "12 tasks: 12 missing" in study("status", small_study, "--results", tmp_path / "r").stdout


@pytest.mark.slow
def test_a_scheduler_that_is_killed_is_one_line(tmp_path):
    with cluster(tmp_path) as address, kills.at_work(tmp_path, "--scheduler", address, tasks=3000, begun=0) as client:
        while not kills.finished(tmp_path / "results"):
            assert client.poll() is None
            time.sleep(0.05)
        port = int(address.rpartition(":")[2])
        (listening,) = {c.pid for c in psutil.net_connections("tcp") if c.laddr.port == port and c.status == "LISTEN"}
        os.kill(listening, signal.SIGKILL)
        told = client.communicate(timeout=120)[1]
    assert client.returncode == 1
    # On a loaded machine the workers come after the client.
    assert (
        told.removeprefix("the cluster has no workers; waiting for some\n")
        == f"lost the scheduler at {address}; {KEPT} once that is mended\n"
    )


def test_no_scheduler_there(small_study, tmp_path):
    done = study(
        "run",
        small_study,
        "--results",
        tmp_path / "r",
        "--scheduler",
        "tcp://127.0.0.1:9",
        DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT="1s",
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "127.0.0.1:9" in done.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--scheduler", "nowhere"], "--scheduler = nowhere: must be an address such as tls://10.0.0.1:8786"),
        (["--scheduler", "http://x:1"], "--scheduler = http://x:1: must be an address such as tls://10.0.0.1:8786"),
        (["--scheduler", "tls://x:1", "--tls", "a", "b", "c"], "--tls = a: must be three PEM files: authority"),
        (["--tls", __file__, __file__, __file__], f"{__file__}: goes with --scheduler tls://HOST:PORT"),
        (["--scheduler", "tcp://[::1:1"], "--scheduler = tcp://[::1:1: must be an address such as"),
        (["--scheduler", "tcp://x:1234567"], "--scheduler = tcp://x:1234567: must be an address such as"),
        (["--scheduler", "tls://x:1", "--tls", __file__, __file__, __file__], "must be PEM files that belong together"),
        (["--memory", "1e400"], "--memory = 1e400: must be a size such as 2GB, at least 100MB, or auto"),
        (["--memory", "0"], "--memory = 0: must be a size such as 2GB, at least 100MB, or auto"),
        (["--timeout", "1e300"], "Invalid value for '--timeout'"),
        (["--memory", "much"], "--memory = much: must be a size such as 2GB, at least 100MB, or auto"),
    ],
)
def test_a_place_that_cannot_be_is_refused(small_study, words, message, monkeypatch, capsys):
    from pipeline.cli import cli

    monkeypatch.setattr("sys.argv", ["study", "run", str(small_study), *words])
    with pytest.raises(SystemExit) as exit_:
        cli.main()
    assert exit_.value.code == 2
    assert message in capsys.readouterr().err


def test_workers_can_import_what_they_shall_before_their_first_step():
    """A fork server passes over a module that does not exist, or imports one that does not."""
    import_module(IMPORTED)
