"""status.json of any shape: no verb minds, and a task whose status says nothing is done again."""

import contextlib
import copy
import json

import empty
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from pipeline.bridge import cache
from pipeline.bridge import engine as run
from pipeline.bridge.loading import load
from pipeline.cli import actions
from pipeline.cli.cli import app
from pipeline.results.status import Status, read_status
from pipeline.results.store import Store

VERBS = (
    *(("status",), ("status", "--json"), ("plan",), ("show", "seed=0"), ("show", "seed=1"), ("collect",), ("verify",)),
    *(("clean",), ("run", "--workers", "1")),
)
DEEP = b"[" * 100_000


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A study of two tasks, the first done and the second failed; its command line, and what was in their files."""

    def compute(parameters, coefficients):
        if parameters.seed:
            raise ValueError("too much")
        return empty.compute(parameters, coefficients)

    folder = tmp_path_factory.mktemp("odd")
    study, results = empty.study(folder, 2), folder / "results"
    with pytest.MonkeyPatch.context() as patch:
        engine = empty.without_physics(empty.coefficients, compute)
        patch.setattr(run, "Engine", lambda: engine)
        patch.setattr(cache.Cache.__init__, "__defaults__", (empty.require_whole,))
        patch.setattr(actions, "REPORTED", 0)

        def call(verb, *words):
            done = CliRunner().invoke(app, [verb, str(study), *words, "--results", str(results)])
            assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
            return done.output

        call("run", "--workers", "1")
        store = Store(results, "empty")
        files = [store.folder(task.id) / "status.json" for task in load(study).tasks]
        marks = [store.root / name for name in (".lock.json", ".statistics.json")]
        yield call, {file: file.read_bytes() for file in files}, marks


def put(data, path, value):
    """The data with the value in the place of what is at the path."""
    data = copy.deepcopy(data)
    place = data
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return data


LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | st.text(st.characters())
JSON = st.recursive(LEAVES, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=6)
HUGE = st.sampled_from([10**400, -(10**4000), 1e308, -1.0, 1e-320, float("nan"), float("inf")])
PLACES = st.sampled_from(
    [(key,) for key in Status.model_fields]
    + [("error", "kind"), ("error", "message"), ("labels", "platform"), ("provenance", "solver_sources")]
    + [("parameters", "record"), ("parameters", "record", "duration"), ("parameters", "record", "discard")]
)
CHANGES = st.lists(st.tuples(PLACES, JSON | HUGE), max_size=2)
OTHERS = JSON.map(lambda value: json.dumps(value).encode()) | st.binary()


@settings(deadline=None, max_examples=12)
@given(changes=CHANGES, other=st.none() | OTHERS, verbs=st.lists(st.sampled_from(VERBS), min_size=1, max_size=1))
@example(changes=[], other=DEEP, verbs=VERBS)
@example(changes=[], other=b'{"parameters": ' * 900 + b"{}" + b"}" * 900, verbs=VERBS)
@example(changes=[], other=b'{"state": ["done"]}', verbs=VERBS)
@example(changes=[], other=b'{"state": "failed"}', verbs=VERBS)
@example(changes=[(("error",), "x")], other=None, verbs=VERBS)
@example(changes=[(("wall_time",), 10**400)], other=None, verbs=VERBS)
@example(changes=[(("parameters", "record"), {"duration": -100.0})], other=None, verbs=VERBS)
def test_no_verb_minds_what_a_status_says(ran, changes, other, verbs):
    call, files, marks = ran
    for mark in marks if other is not None else ():
        mark.write_bytes(other)
    for file, whole in files.items():
        told = json.loads(whole)
        told["parameters"].setdefault("record", {})
        for path, value in changes:
            with contextlib.suppress(LookupError, TypeError):  # no such place, or no longer
                told = put(told, path, value)
        file.write_bytes(json.dumps(told).encode() if other is None else other)
    for words in verbs:
        call(*words)


TYPES = ('{"state": "done", "bytes": "12"}', '{"state": "done", "wall_time": true}', '{"state": 1}', "[]")


@pytest.mark.parametrize("text", ['{"state": "failed"}', *TYPES])
def test_a_status_of_another_shape_is_that_of_a_missing_task(tmp_path, text):
    path = tmp_path / "status.json"
    path.write_text(text)
    assert read_status(path) == Status()
    path.write_text('{"state": "done", "bytes": 12}')
    assert read_status(path).bytes == 12
