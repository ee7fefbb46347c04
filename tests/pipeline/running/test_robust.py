"""Short versions of the scripts in the folder above, a real cluster, and broken disks and workers."""

import contextlib
import errno
import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import empty
import fuzz
import kills
import psutil
import pytest

from pipeline.bridge.loading import load
from pipeline.cli import cli
from pipeline.results.store import Store
from pipeline.running import batches
from pipeline.tasks.task import expand


def study(*words, cwd=None, **env):
    """The command line with the engine of empty tasks."""
    return subprocess.run(
        kills.command(*words), env=kills.environment(**env), cwd=cwd, capture_output=True, text=True, timeout=600
    )


def here(*words):
    """The same in this process, for what needs none of its own."""
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        empty.install(patch.setattr)
        patch.setattr(sys, "argv", ["study", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
    return SimpleNamespace(returncode=ended.value.code, stdout=out.getvalue(), stderr=err.getvalue())


def contents(results):
    return {task: json.loads(status)["content"] for task, status in kills.finished(results).items()}


@pytest.fixture
def small_study(tmp_path):
    return empty.study(tmp_path, 12)


@pytest.fixture
def results(tmp_path):
    return tmp_path / "results"


@pytest.mark.slow
def test_random_study_files_are_refused_with_a_key(tmp_path):
    assert sum(fuzz.files(tmp_path, 60, seed=3).values()) == 60


@pytest.mark.slow
def test_killed_runs_lose_and_repeat_nothing(tmp_path):
    kills.storm(tmp_path, 2, tasks=60, seconds=0.05, longest=5.0, seed=1)


def test_a_second_run_waits_and_says_so(small_study, results, tmp_path):
    gate = tmp_path / "gate"

    def start(*words, **streams):
        env = kills.environment(EMPTY_GATE=str(gate), PYTHONUNBUFFERED="1")
        return subprocess.Popen(kills.command(*words, "--results", results), env=env, text=True, **streams)

    first = start("run", small_study, "--workers", 1, stdout=subprocess.DEVNULL)
    while not (results / "empty" / ".lock.json").exists():
        assert first.poll() is None
        time.sleep(0.05)
    watching = start("status", small_study, "--watch", "--every", "0.2", stdout=subprocess.PIPE)
    second = start("run", small_study, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert f"in the hands of process {first.pid}" in watching.stdout.readline()
    assert f"in use by process {first.pid}" in second.stderr.readline()
    gate.touch()
    assert watching.communicate()[0].splitlines()[-1].startswith("12 tasks: 12 done")
    assert watching.returncode == 0 and first.wait() == 0
    assert "nothing to run" in second.communicate()[0]


@pytest.mark.parametrize("compiled", [pytest.param("", marks=pytest.mark.slow), "1"])
def test_a_task_that_hangs_is_stopped_and_the_others_go_on(tmp_path, results, compiled):
    """Compiled code holds the interpreter and cannot be spoken to; it is stopped and not tried again all the same."""
    path, log = empty.study(tmp_path, 4), tmp_path / "log"
    hangs = {"EMPTY_SECONDS": "600", "EMPTY_SLOW_SEED": "2", "EMPTY_COMPILED": compiled, "EMPTY_LOG": str(log)}
    done = study("run", path, "--results", results, "--timeout", "4", **hangs)
    assert done.returncode == 1
    assert log.read_text().split().count("2") == 1
    assert "4 tasks: 3 done, 1 failed" in done.stdout
    assert re.search(r"failed: \w+ seed=2: Lost: ran longer than --timeout = 4 s", done.stderr)
    assert here("rerun", path, "--failed", "--results", results, "--workers", 1).returncode == 0


INTERRUPTED = "interrupted; finished tasks are kept, and the same command goes on from here\n"


@pytest.mark.parametrize(("times", "workers"), [*(pytest.param(1, n, marks=pytest.mark.slow) for n in (1, 2)), (2, 2)])
def test_ctrl_c_says_what_is_kept_in_one_line(tmp_path, times, workers):
    """A terminal sends it to workers as well. The second one waits for nobody."""
    pause = "1" if times == 1 else "300"
    with kills.at_work(tmp_path, "--workers", workers, begun=workers, EMPTY_SECONDS=pause) as client:
        every = psutil.Process(client.pid).children(recursive=True)
        os.killpg(client.pid, signal.SIGINT)
        assert client.stderr.readline() == INTERRUPTED
        if times == 2:
            os.killpg(client.pid, signal.SIGINT)
        assert client.wait(120) == 130
        assert client.stderr.read() == ""
        assert not psutil.wait_procs(every, timeout=60)[1]
    done = here("run", tmp_path / "empty.toml", "--results", tmp_path / "results", "--workers", 1)
    assert "12 tasks: 12 done" in done.stdout


def test_a_fork_server_that_is_killed_is_one_line(tmp_path):
    with kills.at_work(tmp_path, begun=0) as client:
        while client.poll() is None:
            with contextlib.suppress(psutil.NoSuchProcess):
                for child in psutil.Process(client.pid).children():
                    if "multiprocessing.forkserver" in "".join(child.cmdline()):
                        child.kill()
            time.sleep(0.05)
        told = client.stderr.read()
    assert client.returncode == 1
    assert told.startswith("workers do not start: they are killed, or this machine refuses them; finished tasks")
    assert told.count("\n") == 1


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
        done = here("run", path, "--results", full, "--workers", 1)
        assert done.returncode == 1
        kept = "No space left on device; finished tasks are kept, and the same command goes on from here once that is"
        assert f"{full / path.stem}: {kept}" in done.stderr
        kept = len(contents(full))
        assert 0 < kept < 200
        assert here("verify", path, "--results", full).returncode == 0
        subprocess.run(["mount", "-o", "remount,size=20m", full], check=True)
        done = here("run", path, "--results", full, "--workers", 1)
        assert f"200 tasks: 200 done; {200 - kept} run now" in done.stdout, done.stderr
        assert not list(full.rglob("*.part"))
        (dataset,) = full.rglob("statistics.nc")
        dataset.unlink()
        with contextlib.suppress(OSError), (full / "others").open("wb", buffering=0) as file:
            while True:
                file.write(bytes(4096))
        done = here("collect", path, "--results", full)
        assert done.returncode == 1 and f"{dataset}: " in done.stderr and "Traceback" not in done.stderr
        assert "finished tasks are kept" not in done.stderr  # which is said of what runs tasks
        assert not list(full.rglob("*.part")) and not dataset.exists()


def test_read_only_results(tmp_path, small_study):
    with tmpfs(tmp_path / "ro", "size=1m") as folder:
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        done = here("run", small_study, "--results", folder)
        assert done.returncode == 1
        assert "Read-only file system" in done.stderr
        assert "Traceback" not in done.stderr
        assert here("status", small_study, "--results", folder).returncode == 2


def test_the_report_of_results_for_reading_only(tmp_path, small_study):
    """All is there and as it would be drawn again."""
    with tmpfs(tmp_path / "ro", "size=20m") as folder:
        for verb in (("run", "--workers", 1), ("report",)):
            assert here(verb[0], small_study, "--results", folder, *verb[1:]).returncode == 0
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        done = here("report", small_study, "--results", folder)
        assert (done.returncode, done.stderr) == (0, "") and done.stdout.endswith("report.html\n")


def test_damaged_results_are_named_and_made_again(tmp_path, small_study, results):
    """Cut, a bit flipped, empty, gone; and half a status."""
    assert here("run", small_study, "--results", results, "--workers", 1).returncode == 0
    before = contents(results)
    cut, flipped, empty_, gone, half, *_ = sorted(results.rglob("record.nc"))
    cut.write_bytes(cut.read_bytes()[:100])
    data = bytearray(flipped.read_bytes())
    data[len(data) // 2] ^= 16
    flipped.write_bytes(data)
    empty_.write_bytes(b"")
    gone.unlink()
    status = half.with_name("status.json")
    status.write_bytes(status.read_bytes()[:50])
    verified = here("verify", small_study, "--results", results)
    assert "4 damaged" in verified.stdout and "1 missing" in verified.stdout
    again = here("run", small_study, "--results", results, "--workers", 1)
    assert "12 done; 5 run now" in again.stdout
    assert contents(results) == before


def test_a_clock_that_goes_backwards(small_study, results, tmp_path, monkeypatch):
    from pipeline.bridge import cache
    from pipeline.running.campaign import Campaign, unfinished

    monkeypatch.setattr(cache.Cache.__init__, "__defaults__", (empty.require_whole,))
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

    monkeypatch.setattr("pipeline.results.store.flush", full)
    with pytest.raises(OSError, match="No space") as told:
        store.keep([(task, b"new", {}) for task in tasks[2:9]])
    assert told.value.filename == str(store.root)
    assert not list(results.rglob("*.part"))
    assert [store.look(t, checksums=True).state for t in tasks[:3]] == ["done", "done", "missing"]


def test_short_tasks_lie_many_to_a_file(tmp_path, results, monkeypatch):
    """The dataset is that of files of their own, a rerun of one the same to the bit, and a loss is made good."""
    path = empty.study(tmp_path, 200)
    assert study("run", path, "--results", results).returncode == 0
    with monkeypatch.context() as one_by_one:
        one_by_one.setattr(batches, "MOST", 1)
        assert here("run", path, "--results", tmp_path / "alone", "--workers", 1).returncode == 0
    packs = sorted(results.glob("empty/packs/*.nc"))
    assert 3 <= len(packs) < 50 and not list(tmp_path.glob("alone/empty/packs/*"))
    assert contents(results) == contents(tmp_path / "alone")
    assert kills.dataset(results) == kills.dataset(tmp_path / "alone")
    again = here("rerun", path, "seed=199", "--results", results, "--workers", 1)
    assert "bitwise the same as the old record" in again.stdout
    data = bytearray(packs[-1].read_bytes())
    data[-1] ^= 1
    packs[-1].write_bytes(data)
    lost = int(re.search(r"(\d+) damaged", here("verify", path, "--results", results).stdout)[1])
    assert lost > 1
    again = study("run", path, "--results", results)
    assert f"200 done; {lost} run now" in again.stdout, again.stdout + again.stderr
    assert kills.dataset(results) == kills.dataset(tmp_path / "alone")
    assert here("clean", path, "--orphans", "--results", results).stdout.count("removed") <= 2
    assert here("verify", path, "--results", results).returncode == 0
