"""Files appear whole or not at all, and only a whole record counts."""

import json
import os
import re
import shutil
import subprocess
import sys
import time
from functools import partial

import pytest

from pipeline.bridge.loading import load
from pipeline.results import store as module
from pipeline.results.store import Store, sha256, write_atomic
from pipeline.study.reading import StudyError
from pipeline.tasks.task import Task, expand

ERROR = {"error": {"kind": "ValueError", "message": "too much", "traceback": ""}}


@pytest.fixture
def task(small):
    return next(iter(expand(load(small).content)))


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "results", "small")


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_crash_while_writing_leaves_the_old_file(tmp_path, monkeypatch, step):
    path = tmp_path / "file"
    write_atomic(path, b"old")

    def crash(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(module.os, step, crash)
    with pytest.raises(OSError, match="No space") as told:
        write_atomic(path, b"new")
    assert told.value.filename == str(path)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["file"]


def test_processes_with_the_same_number_write_to_names_of_their_own(tmp_path):
    """As in two containers that share a folder of results."""
    words = "import os; os.getpid = lambda: 7; from pipeline.results.store import *; "
    words += "from pathlib import Path\nwith appearing(Path('file')) as part: print(part); part.touch()"
    run = partial(subprocess.check_output, [sys.executable, "-c", words], cwd=tmp_path, text=True)
    one, other = (run().strip() for _ in range(2))
    assert one != other and all(re.fullmatch(r"\.file\.7-\w{8}\.part", name) for name in (one, other))


@pytest.mark.parametrize(("hours", "left"), [(0.9, True), (1.1, False)])
@pytest.mark.parametrize("name", [".statistics.nc.7.part", "packs/.000019.nc.7.part"])
def test_what_a_killed_run_had_half_written_is_removed_by_the_next(store, name, hours, left):
    """Unless it is so young that `collect`, which needs no lock, may be writing to it."""
    part = store.root / name
    part.parent.mkdir(parents=True)
    other = part.with_name("mine.part")
    for path in (part, other):
        path.touch()
        os.utime(path, (since := time.time() - 3600 * hours, since))
    with store.lock(print):
        assert part.exists() is left and other.exists()


def test_a_record_without_status_is_not_done(store, task, monkeypatch):
    rename = os.replace

    def crash_at_the_status(part, path):
        if path.name == "status.json":
            raise KeyboardInterrupt
        rename(part, path)

    with monkeypatch.context() as patch:
        patch.setattr(module.os, "replace", crash_at_the_status)
        with pytest.raises(KeyboardInterrupt):
            store.keep([(task, b"record", {})])
    assert store.look(task).record.exists()
    assert store.look(task).state == "missing"


def test_an_outcome_is_withdrawn_before_another_is_written(store, task, monkeypatch):
    """A task run again that is killed in between has no outcome, and not the older one beside another record."""
    store.keep([(task, b"record", {})])

    def crash(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(module.os, "replace", crash)
        with pytest.raises(KeyboardInterrupt):
            store.keep([(task, b"other", {})])
    assert store.look(task).state == "missing" and store.look(task).record.read_bytes() == b"record"


def test_done_and_failed(store, task):
    assert store.look(task).state == "missing"
    store.keep([(task, None, ERROR)])
    assert store.look(task).state == "failed"
    store.keep([(task, b"record", {})])
    entry = store.look(task, checksums=True)
    assert entry.state == "done"
    assert entry.status.sha256 == sha256(b"record")


def test_short_and_flipped_records_are_damaged(store, task):
    store.keep([(task, b"record", {})])
    record = store.look(task).record
    record.write_bytes(b"rec")
    assert store.look(task).state == "damaged"
    record.write_bytes(b"recorc")
    assert store.look(task).state == "done"  # a look at the size is not enough,
    assert store.look(task, checksums=True).state == "damaged"  # a checksum is


def test_a_longer_record_is_damaged(store, task):
    store.keep([(task, b"record", {})])
    store.look(task).record.write_bytes(b"record and more")
    assert store.look(task).state == "damaged"


def test_a_folder_copied_over_another_is_damaged(store, small):
    """Record and status fit each other, and are another task's."""
    one, other, third = list(expand(load(small).content))[:3]
    store.keep([(one, b"record", {})])
    store.keep([(third, None, ERROR)])
    for source, target in ((one, other), (third, one)):
        shutil.copytree(store.folder(source.id), store.folder(target.id), dirs_exist_ok=True)
        assert store.look(target).state == "damaged"


def test_results_of_an_older_model_are_stale(store, task):
    newer = Task(labels=task.labels, make=task.make, version=task.version + 1)
    store.keep([(task, None, ERROR)])
    assert store.look(newer).state == "missing"  # nothing to show for it
    store.keep([(task, b"record", {})])
    assert store.look(newer).state == "stale"
    store.keep([(newer, b"record", {})])
    assert store.look(newer).state == "done"


def test_a_second_user_waits_and_is_told(store):
    from filelock import Timeout

    words = []

    def waiting(text):
        words.append(text)
        raise Timeout("enough")

    with store.lock(waiting):
        other = Store(store.root.parent, "small")
        with pytest.raises(Timeout), other.lock(waiting):
            pass
    assert f"in use by process {os.getpid()}" in words[0]
    with store.lock(waiting):
        assert len(words) == 1


@pytest.mark.parametrize("place", ["/proc/x", "file/x"])
def test_results_where_no_folder_can_be_are_refused(tmp_path, place):
    """By the place alone: nothing is there that was kept, and the same command would not go on."""
    (tmp_path / "file").touch()
    store = Store(tmp_path / place, "small")
    with pytest.raises(StudyError) as caught, store.lock(print):
        pass
    (problem,) = caught.value.problems
    assert problem.startswith(f"{store.root}: no folder can be made there: ") and "kept" not in problem


def test_a_killed_process_works_on_nothing(store):
    ended = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, check=True)
    for pid, host, works in (
        (int(ended.stdout), os.uname().nodename, False),
        (os.getpid(), os.uname().nodename, True),
        (int(ended.stdout), "elsewhere", True),
    ):
        store.root.mkdir(parents=True, exist_ok=True)
        (store.root / ".lock.json").write_text(json.dumps({"pid": pid, "host": host, "since": "now"}))
        assert store.at_work() == (store.holder() if works else "")
        assert f"process {pid} on {host}" in store.holder()


@pytest.mark.parametrize("name", ["record.nc", "status.json", ".status.json.1.part"])
def test_a_folder_where_a_file_should_be_makes_way(store, task, name):
    folder = store.folder(task.id) / name
    (folder / "inside").mkdir(parents=True)
    assert store.look(task, checksums=True).state == "missing"
    store.keep([(task, b"record", {})])
    assert store.look(task, checksums=True).state == "done"


def test_a_file_where_a_folder_should_be_makes_way(store, task):
    store.tasks.mkdir(parents=True)
    store.folder(task.id).write_text("no folder")
    assert store.look(task, checksums=True).state == "missing"
    store.keep([(task, b"record", {})])
    assert store.look(task, checksums=True).state == "done"


def test_an_error_that_holds_no_text_is_kept(store, task):
    """A lone surrogate stands for a byte of a file's name; JSON and terminals have none."""
    store.keep([(task, None, {"error": {**ERROR["error"], "message": "no file named \udcff"}})])
    assert store.look(task).status.error.message == "no file named ?"
