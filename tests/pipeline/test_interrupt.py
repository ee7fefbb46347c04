"""Ctrl-C ends a run wherever Python is then: some places discard the exception, others take it for an error."""

import operator
import os
import signal
import subprocess
import sys
import weakref
from types import SimpleNamespace

import pytest

from pipeline import __main__, interrupt
from pipeline.bridge.engine import Engine, attempt_tasks
from pipeline.cli import cli
from pipeline.running import schedule
from pipeline.running.place import Place

LINE = f"interrupted; {interrupt.KEPT}\n"
IMPORTS = """
import os, signal, weakref
from pipeline import interrupt
interrupt.heed()
class A: pass
a = A()
r = weakref.ref(a, lambda _: os.kill(os.getpid(), signal.SIGINT))
del a
print("goes on")
"""


@pytest.fixture(autouse=True)
def unwinding(monkeypatch):
    """As in a run whose imports are over."""
    before = signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    interrupt.unwind()
    yield
    signal.signal(signal.SIGINT, before)


class Thing:
    """That may have a weak reference."""


def discarded(*_):
    """Ctrl-C where Python discards all exceptions."""
    thing = Thing()
    reference = weakref.ref(thing, lambda _: os.kill(os.getpid(), signal.SIGINT))
    del thing
    return [reference()]


def taken_for_an_error(*_):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except interrupt.Interrupted as error:
        raise ValueError("Error building a validator: Interrupted") from error


def test_imports_leave_at_once():
    done = subprocess.run([sys.executable, "-c", IMPORTS], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (interrupt.STATUS, "", LINE)


@pytest.mark.parametrize("meets", [discarded, taken_for_an_error])
def test_a_command_that_loses_it_ends_as_interrupted(meets, monkeypatch, capfd):
    monkeypatch.setattr(cli, "main", meets)
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert ended.value.code == interrupt.STATUS
    assert capfd.readouterr() == ("", LINE)


@pytest.mark.parametrize("error", [ValueError("one of its own"), None])
def test_other_ends_stay_as_they_are(error, monkeypatch):
    def main():
        if error:
            raise error

    monkeypatch.setattr(cli, "main", main)
    if error is None:
        assert __main__.main() is None
    else:
        with pytest.raises(ValueError, match="one of its own"):
            __main__.main()


def test_one_that_is_discarded_costs_a_task_in_this_process():
    """What has been done is handed on, and nothing more begins."""
    pool, done = schedule.Here(), []
    for name, piece in (("first", list), ("second", discarded), ("third", list)):
        pool.submit(name, piece)
    with pytest.raises(interrupt.Interrupted):
        done.extend(map(operator.itemgetter(0), pool.finished()))
    assert done == ["first", "second"]


def test_one_that_is_discarded_ends_the_wait_for_workers(monkeypatch):
    monkeypatch.setattr(schedule, "HEARTBEAT", 0.0)
    looks = iter([{"a worker": 1}])
    client = SimpleNamespace(
        nthreads=lambda: next(looks),
        submit=lambda *_, **__: SimpleNamespace(key="long", add_done_callback=lambda _: None),
    )
    pool = schedule.Dask(client, Place(), print)
    pool.submit("it", discarded)
    discarded()
    with pytest.raises(interrupt.Interrupted):
        next(pool.finished())


def test_what_it_breaks_is_no_failed_task():
    with pytest.raises(interrupt.Interrupted):
        attempt_tasks(Engine(compute=taken_for_an_error), [("id", None)], None)
