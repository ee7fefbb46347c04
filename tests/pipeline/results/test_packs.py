"""Records that lie many to a file: each comes out as it went in, and counts only while the file is whole."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from pipeline.bridge.loading import load
from pipeline.results import packs
from pipeline.results import store as module
from pipeline.results.dataset import collect, current
from pipeline.results.netcdf import Variable, content
from pipeline.results.packs import packed
from pipeline.results.store import Store, together
from pipeline.tasks.task import Task, expand

README = Path(__file__).parents[3] / "pipeline" / "README.md"
ERROR = {"error": {"kind": "ValueError", "message": "too much", "traceback": ""}}


def record(task, number, legs=("a", "b")):
    """Labels, numbers that differ and numbers that do not, a scalar, a word."""
    variables = {
        "leg": Variable(("leg",), np.array(legs), {"long_name": "Leg"}),
        "power": Variable(("leg",), number + np.arange(len(legs)) / 3, {"units": "W"}),
        "frequency": Variable(("mode",), np.array([1.0, np.nan]), {"units": "rad s-1"}),
        "error": Variable((), np.array(number * 1e-3), {}),
        "task": Variable((), np.array(task), {}),
    }
    return variables, {"host": "here", "seed": f"{number}", "wall_time": 0.5 * number}


@pytest.fixture
def tasks(small):
    return list(expand(load(small).content))[:6]


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "results", "small")


def keep(store, tasks, numbers):
    rows = packed([record(task.id, n) for task, n in zip(tasks, numbers, strict=True)])
    store.keep([(task, row, {"content": str(n)}) for task, row, n in zip(tasks, rows, numbers, strict=True)])


def states(store, tasks):
    return [store.look(task, checksums=True).state for task in tasks]


def powers(store, tasks):
    return [store.look(task).made()[0]["power"].values[0] for task in tasks]


def test_each_record_comes_out_as_it_went_in(store, tasks):
    """Of two forms, in two files; a number that is the same in all is there once."""
    given = [record(task.id, n, ("a", "b") if n % 3 else ("a",)) for n, task in enumerate(tasks)]
    store.keep([(task, row, {}) for task, row in zip(tasks, packed(given), strict=True)])
    assert len(list(store.packs.folder.glob("*.nc"))) == 2
    for task, (variables, attrs) in zip(tasks, given, strict=True):
        entry = store.look(task, checksums=True)
        found, told = entry.made()
        assert entry.state == "done" and content(found) == content(variables) and told == attrs
    with xr.open_dataset(store.packs.folder / "000001.nc") as data:
        assert data.frequency.dims == ("mode",) and data.power.dims == ("task", "leg")
        assert sorted(data.task.values.tolist() + [tasks[i].id for i in (1, 2, 4, 5)]) == sorted(t.id for t in tasks)


def test_packs_of_different_forms_open_together_as_the_readme_says(store, tasks):
    """Of labels that some have and others lack; numbers that all tasks of a pack share are there once."""
    for some, legs in ((tasks[:2], ("a", "b")), (tasks[2:4], ("b", "c"))):
        given = [record(task.id, n, legs) for n, task in enumerate(some, 1)]
        for variables, _ in given if legs[0] == "b" else ():
            variables["side"] = Variable((), np.array("lee"), {})
            variables["leg"].attrs["coordinates"] = "side"
        store.keep([(task, row, {}) for task, row in zip(some, packed(given), strict=True)])
    folder = store.packs.folder
    recipe = next(block for block in README.read_text().split("packs = ")[1:])
    with eval(recipe.partition("\n\n")[0].replace("results/many/packs", str(folder)), {"xr": xr}) as data:
        assert data.task.values.tolist() == [task.id for task in tasks[:4]]
        for task in tasks[:4]:
            power = data.power.sel(task=task.id).dropna("leg")
            assert power.values.tolist() == store.look(task).made()[0]["power"].values.tolist()


def test_several_come_out_together(store, tasks):
    """In the order asked for; attributes that differ are no variables; another's row is refused."""
    keep(store, tasks[:4], [1, 2, 3, 4])
    entries = [store.look(tasks[n]) for n in (3, 0)]
    found = together(entries)
    assert found["power"].dims == ("task", "leg") and found["power"].values[:, 0].tolist() == [4, 1]
    assert found["frequency"].dims == ("mode",) and found["task"].values.tolist() == [tasks[3].id, tasks[0].id]
    assert found.keys() == entries[0].made()[0].keys()
    wrong = replace(entries[1], place=entries[1].place._replace(number=1))
    with pytest.raises(ValueError, match="not what was written"):
        together([entries[0], wrong])


def test_a_pack_is_opened_once_for_a_dataset(store, small, monkeypatch):
    """Though its tasks stand among those of others; numbers come to their own cells."""
    study = load(small)
    tasks = list(study.tasks)
    for part in range(3):
        keep(store, tasks[part::3], [n + 1 for n in range(len(tasks))[part::3]])
    opened = []
    monkeypatch.setattr(packs, "from_bytes", lambda data, read=packs.from_bytes: opened.append(data) or read(data))
    packs._opened.cache_clear()
    path, states = collect(study, store)
    assert len(opened) == 3 and states == {"done": len(tasks)}
    with xr.open_dataset(path) as data:
        cells = [data.sel({dim: label for dim, label in task.labels.items() if dim in data.dims}) for task in tasks]
        assert [float(cell.power[0]) for cell in cells] == [n + 1 for n in range(len(tasks))]
        assert [str(cell.task.values) for cell in cells] == [task.id for task in tasks]


def test_a_pack_that_is_made_again_comes_back_into_the_dataset(store, small):
    """To the same bits: nothing but the bytes of the old one told that it was damaged."""
    study = load(small)
    tasks = list(study.tasks)
    keep(store, tasks, range(len(tasks)))
    path = current(study, store)
    with xr.open_dataset(path) as data:
        whole = data.load()
    pack = store.look(tasks[0]).record
    right = pack.read_bytes()
    os.utime(pack, ns=(1, 1))  # a later change may be in the same tick of the clock
    pack.write_bytes(right[:-1] + bytes([right[-1] ^ 1]))
    assert collect(study, store)[1] == {"damaged": len(tasks)}
    keep(store, tasks, range(len(tasks)))
    assert current(study, store) == path
    with xr.open_dataset(path) as data:
        assert data.identical(whole)


def test_records_of_other_labels_lie_elsewhere(store, tasks):
    given = [record(task.id, 1, legs) for task, legs in zip(tasks, (("a", "b"), ("a", "c"), ("a", "b")), strict=False)]
    assert len({row.pack for row in packed(given)}) == 2


def test_another_process_sees_what_was_added_and_removed(store, tasks):
    """Also within the tick of a file system's clock; and it overwrites nothing."""
    other = Store(store.root.parent, "small")
    keep(store, tasks[:2], [1, 2])
    assert states(other, tasks[:3]) == ["done", "done", "missing"]
    at = store.packs.folder.stat().st_mtime_ns
    keep(store, tasks[2:3], [3])
    os.utime(store.packs.folder, ns=(at, at))
    assert states(other, tasks[:4]) == ["done"] * 3 + ["missing"]
    keep(other, tasks[:2], [5, 6])
    assert powers(store, tasks[:3]) == powers(other, tasks[:3]) == [5, 6, 3]
    keep(store, tasks[2:3], [4])
    keep(store, tasks[2:3], [3])
    assert powers(store, tasks[:3]) == powers(other, tasks[:3]) == [5, 6, 3]
    for path in (store.look(tasks[0]).record, store.look(tasks[0]).record.with_suffix(".jsonl")):
        path.unlink()
    assert powers(store, tasks[:3]) == powers(other, tasks[:3]) == [1, 2, 3]


def test_a_number_that_became_free_is_not_taken_again(store, tasks):
    """What is packed last comes last, whatever was removed before it."""
    keep(store, tasks[:1], [1])
    keep(store, tasks[1:2], [2])
    for path in store.packs.folder.glob("000001.*"):
        path.unlink()
    keep(Store(store.root.parent, "small"), tasks[1:2], [3])
    assert powers(Store(store.root.parent, "small"), tasks[1:2]) == [3]


def test_older_names_are_asked_for_where_there_are_older_versions(store, tasks):
    keep(store, tasks[:1], [1])
    store.keep([(tasks[2], b"record", {})])
    missing = Task(labels={}, make=lambda: pytest.fail("no older name can be here"), known="0" * 16)
    assert store.look(missing).state == "missing"
    newer = [Task(labels=task.labels, make=task.make, version=task.version + 1) for task in tasks[:3]]
    assert [store.look(task).state for task in newer] == ["stale", "missing", "stale"]


def test_the_last_outcome_counts(store, tasks):
    """A later pack before an earlier one; a task's own folder before both, until it is packed again."""
    keep(store, tasks[:2], [1, 2])
    keep(store, tasks[1:3], [5, 6])
    assert powers(store, tasks[:3]) == [1, 5, 6]
    store.keep([(tasks[1], None, ERROR)])
    assert states(store, tasks[:3]) == ["done", "failed", "done"]
    store.keep([(tasks[2], b"cut", {})])
    store.look(tasks[2]).record.write_bytes(b"cu")
    assert states(store, tasks[:3]) == ["done", "failed", "damaged"]
    keep(store, tasks[1:3], [7, 8])
    assert powers(store, tasks[:3]) == [1, 7, 8] and states(store, tasks[:3]) == ["done"] * 3


def test_a_damaged_pack_is_all_its_tasks(store, tasks):
    keep(store, tasks[:2], [1, 2])
    keep(store, tasks[2:4], [3, 4])
    path = store.look(tasks[0]).record
    data = bytearray(path.read_bytes())
    data[-1] ^= 1
    path.write_bytes(data)
    assert states(store, tasks[:4]) == ["damaged", "damaged", "done", "done"]
    with pytest.raises(ValueError, match="not what was written"):
        store.look(tasks[0]).made()
    with pytest.raises(ValueError, match="not what was written"):
        together([store.look(task) for task in tasks[:2]])
    path.unlink()
    assert states(store, tasks[:4]) == ["damaged", "damaged", "done", "done"]


def test_a_pack_under_anothers_name_is_damaged(store, tasks):
    keep(store, tasks[:2], [1, 2])
    keep(store, tasks[2:4], [3, 4])
    one, other = sorted(store.packs.folder.glob("*.nc"))
    one.write_bytes(other.read_bytes())
    assert states(store, tasks[:4]) == ["damaged", "damaged", "done", "done"]


def test_a_kill_before_the_lines_leaves_nothing(store, tasks, monkeypatch):
    keep(store, tasks[:2], [1, 2])
    rename = os.replace

    def crash_at_the_lines(part, path):
        if path.suffix == ".jsonl":
            raise KeyboardInterrupt
        rename(part, path)

    with monkeypatch.context() as patch:
        patch.setattr(module.os, "replace", crash_at_the_lines)
        with pytest.raises(KeyboardInterrupt):
            keep(store, tasks[1:4], [5, 6, 7])
    assert states(store, tasks[:4]) == ["done", "done", "missing", "missing"]
    assert powers(store, tasks[:2]) == [1, 2]
    keep(store, tasks[2:4], [3, 4])
    assert powers(store, tasks[:4]) == [1, 2, 3, 4]
    assert [path.name for path in store.packs.strays({task.id for task in tasks})] == ["000002.nc"]


def test_lines_that_say_nothing_are_no_outcome(store, tasks):
    keep(store, tasks[:3], [1, 2, 3])
    path = store.look(tasks[0]).record.with_suffix(".jsonl")
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(lines[0] + lines[1][:40] + b"\n" + lines[2])
    assert states(Store(store.root.parent, "small"), tasks[:3]) == ["done", "missing", "done"]
