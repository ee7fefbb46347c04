"""Results come whatever their size, and however silent or short-lived the workers that have them."""

import os
import resource
import signal
import time
from types import SimpleNamespace

import dask
import psutil
import pytest

from pipeline import environment
from pipeline.bridge.engine import Outcome
from pipeline.running import cluster, schedule
from pipeline.running.place import Place
from pipeline.running.schedule import Dask, Lost

SILENT = 10.0  # [s]


def piece(size, pause=0.0):
    """So many bytes after so long [s]; first of all, which process made them."""
    time.sleep(pause)
    return [Outcome(result=str(os.getpid()).encode().ljust(size), provenance=environment.provenance())]


def listening(address):
    port = int(address.rpartition(":")[2])
    (pid,) = {c.pid for c in psutil.net_connections("tcp") if c.laddr.port == port and c.status == "LISTEN"}
    return psutil.Process(pid)


@pytest.fixture
def meddling(monkeypatch):
    """A pool of two workers; meddle(process) of a worker before it sends a result."""
    meddled, transferred = [], Dask._transferred

    async def sent(self, name):
        for address in (await self._client.scheduler.who_has(keys=[name]))[name]:
            for meddle in meddled:
                meddle(listening(address))
        return await transferred(self, name)

    monkeypatch.setattr(Dask, "_transferred", sent)
    with schedule.pool(3, Place(), print) as pool:
        yield pool, meddled.append


def test_a_result_takes_as_long_as_it_takes():
    """300 MB that two processes encrypt and a third deciphers: some seconds, while others come."""
    with schedule.pool(3, Place(), print) as pool:
        for size in (150_000_000, 10, 150_000_001):
            pool.submit(size, piece, size)
        assert {size: len(results[0].result) for size, results in pool.finished()} == {
            size: size for size in (150_000_000, 10, 150_000_001)
        }


@pytest.mark.parametrize(
    ("limit", "workers", "told"),
    [(41, 2, "2 take 42 open files, and"), (42, 2, ""), (1024, 200, "may have 1024 .ulimit -n"), (-1, 200, "")],
)
def test_workers_that_take_more_files_than_there_may_be_are_not_started(monkeypatch, limit, workers, told):
    def starts():
        raise ChildProcessError("would start")

    few = SimpleNamespace(**{**vars(resource), "getrlimit": lambda _: (limit, limit)})
    monkeypatch.setattr(cluster, "resource", few)  # not the module itself: libraries ask it, too, what there may be
    monkeypatch.setattr(cluster, "start_fork_server", starts)
    with pytest.raises(ChildProcessError, match=told or "would start"), cluster.own_cluster(workers, "auto"):
        pass


def test_a_cluster_is_nobody_elses_default():
    """What else in this process uses dask does so as before, while the pool is there and when it is lost."""
    with schedule.pool(3, Place(), print) as pool:
        assert dask.config.get("scheduler", None) is None
        pool.submit("one", piece, 10)
        assert [size for size, _ in pool.finished()] == ["one"]


def test_a_worker_that_is_silent_stops_no_other(meddling):
    """Its result comes when it speaks again; neither is anything computed twice."""
    pool, meddle = meddling
    silent = []

    def suspend(process):
        if not silent:
            silent.append(process)
            process.suspend()
            pool._client.loop.call_later(SILENT, process.resume)

    meddle(suspend)
    start, arrived = time.monotonic(), {}
    for n in range(4):
        pool.submit(n, piece, 1_000_000, 0.2)
    for n, results in pool.finished():
        arrived[n] = time.monotonic() - start, int(results[0].result)
    late = [when for when, pid in arrived.values() if pid == silent[0].pid]
    early = [when for when, pid in arrived.values() if pid != silent[0].pid]
    assert max(early) < SILENT < max(late)


def test_what_a_worker_died_with_is_done_again(meddling):
    pool, meddle = meddling
    dead = []

    def kill(process):
        if not dead:
            dead.append(process.pid)
            process.kill()

    meddle(kill)
    pool.submit("it", piece, 10_000_000)
    ((name, results),) = pool.finished()
    assert name == "it" and int(results[0].result) != dead[0]


def test_what_no_worker_survives_to_send_is_lost(meddling):
    """A result that is too large for their memory would otherwise be made for ever."""
    pool, meddle = meddling
    dead = []

    def kill(process):
        dead.append(process.pid)
        process.kill()

    meddle(kill)
    pool.submit("it", piece, 10)
    ((_, lost),) = pool.finished()
    assert isinstance(lost, Lost) and str(lost).startswith("its result was lost 3 times")
    assert len(dead) == 3


@pytest.fixture
def interruptible():
    """Whoever runs the tests: what a shell starts in the background ignores Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_an_interruption_waits_for_no_transfer(meddling, capfd):
    """Nor for a worker that is silent for longer."""
    pool, meddle = meddling
    interrupted = []

    def interrupt():
        interrupted.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    def suspend(process):
        process.suspend()
        pool._client.loop.call_later(SILENT, process.resume)
        pool._client.loop.call_later(0.2, interrupt)

    meddle(suspend)
    pool.submit("it", piece, 1_000_000)
    with pytest.raises(KeyboardInterrupt):
        list(pool.finished())
    assert time.monotonic() - interrupted[0] < SILENT / 2
    pool.give_up()
    pool._client.close()
    assert capfd.readouterr() == ("", "")
