"""Files appear whole or not at all, and only a whole record counts."""

import os

import pytest

from pipeline.bridge.loading import load
from pipeline.results import store as module
from pipeline.results.store import Store, sha256, write_atomic
from pipeline.tasks.task import Task, expand


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
    with pytest.raises(OSError, match="No space"):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["file"]


def test_a_record_without_status_is_not_done(store, task, monkeypatch):
    rename = os.replace

    def crash_at_the_status(part, path):
        if path.name == "status.json":
            raise KeyboardInterrupt
        rename(part, path)

    with monkeypatch.context() as patch:
        patch.setattr(module.os, "replace", crash_at_the_status)
        with pytest.raises(KeyboardInterrupt):
            store.done(task, b"record", {})
    assert store.look(task).record.exists()
    assert store.look(task).state == "missing"


def test_done_and_failed(store, task):
    assert store.look(task).state == "missing"
    store.failed(task, {"error": {"kind": "ValueError"}})
    assert store.look(task).state == "failed"
    store.done(task, b"record", {})
    entry = store.look(task, checksums=True)
    assert entry.state == "done"
    assert entry.status["sha256"] == sha256(b"record")


def test_short_and_flipped_records_are_damaged(store, task):
    store.done(task, b"record", {})
    record = store.look(task).record
    record.write_bytes(b"rec")
    assert store.look(task).state == "damaged"
    record.write_bytes(b"recorc")
    assert store.look(task).state == "done"  # a look at the size is not enough,
    assert store.look(task, checksums=True).state == "damaged"  # a checksum is


def test_results_of_an_older_model_are_stale(store, task):
    store.done(task, b"record", {})
    newer = Task(labels=task.labels, make=task.make, version=task.version + 1)
    assert store.look(newer).state == "stale"
    store.done(newer, b"record", {})
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
