"""Where work runs: in this process, on workers of our own, or on somebody's dask cluster.

The only import of dask. Both pools take work, hand back what is finished, and may be given more
meanwhile. A worker that dies costs the work in its hands, which dask gives to another.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Protocol

from pipeline import environment

SETTINGS = {
    # Coefficients ride with the tasks, so that none depends on what another worker may lose; that is meant.
    "distributed.admin.large-graph-warning-threshold": "100MB",
    # One task in hand and none waiting behind it: a task that kills its worker takes no other along.
    "distributed.scheduler.worker-saturation": 1.0,
    # So many workers may die under a task, perhaps of something else, before it counts as their murderer.
    "distributed.scheduler.allowed-failures": 3,
    "distributed.comm.timeouts.connect": "10s",
}
SMALL = 2  # so few pieces of work are done sooner than a cluster starts
LATE = "study-late"  # the topic on which workers tell that a piece of work is over its time
GRACE = 2.0  # between telling so and leaving, and between that and being made to leave [s]
FETCH = 2.0  # after so long without a result, see whether its worker is still there [s]
HEARTBEAT = 5.0  # how often the cluster is looked at while nothing comes back [s]

Work = Callable[..., list[Any]]


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where tasks run, and within which bounds."""

    workers: int = 2
    scheduler: str | None = None  # address of a dask scheduler
    timeout: float | None = None  # of one task [s]
    memory: str = "auto"  # of one embedded worker; auto: an equal share of the machine's
    tls: tuple[Path, Path, Path] | None = None  # authority, certificate and key, for a tls:// scheduler


class Lost(Exception):
    """A piece of work that came to no end: too late, or its workers died."""


class Pool(Protocol):
    """Something that runs functions."""

    @property
    def width(self) -> int:
        """How many pieces of work run at once; 0: this process, where nothing is gained by batches."""

    def submit(self, key: Hashable, function: Work, *args: Any) -> None:
        """Have function(*args) run."""

    def finished(self) -> Iterator[tuple[Hashable, list[Any] | Lost]]:
        """Results as they come, until nothing is left, later submissions included."""


class Here:
    """This process, one piece of work after another."""

    width = 0

    def __init__(self) -> None:
        self._queue: deque[tuple[Hashable, Work, tuple[Any, ...]]] = deque()

    def submit(self, key: Hashable, function: Work, *args: Any) -> None:
        self._queue.append((key, function, args))

    def finished(self) -> Iterator[tuple[Hashable, list[Any] | Lost]]:
        while self._queue:
            key, function, args = self._queue.popleft()
            yield key, function(*args)


@dataclass(frozen=True, eq=False)
class _Job:
    key: Hashable
    future: Any
    function: Work
    args: tuple[Any, ...]


class Dask:
    """A dask cluster."""

    def __init__(self, client: Any, place: Place, say: Callable[[str], None]) -> None:
        self._client, self._place, self._say = client, place, say
        self._running: dict[str, _Job] = {}
        self._events: SimpleQueue[tuple[str, bool]] = SimpleQueue()
        self.width = self._threads()
        if place.timeout:
            client.subscribe_topic(LATE, lambda event: self._events.put((event[1]["key"], True)))

    def _threads(self) -> int:
        # Idle clusters may yet grow, so at least one piece of work is always on offer.
        return max(1, sum(self._client.nthreads().values()))

    def submit(self, key: Hashable, function: Work, *args: Any) -> None:
        future = self._client.submit(_within, self._place.timeout, function, *args, pure=False)
        self._running[future.key] = _Job(key, future, function, args)
        future.add_done_callback(lambda done: self._events.put((done.key, False)))

    def finished(self) -> Iterator[tuple[Hashable, list[Any] | Lost]]:
        while self._running:
            name, late = self._next()
            if name not in self._running:
                continue  # late, and done all the same
            job = self._running.pop(name)
            if late:
                job.future.cancel(force=True)
                results: list[Any] | Lost | None = Lost(f"ran longer than --timeout = {self._place.timeout:g} s")
            else:
                results = self._result(job.future)
            job.future.release()
            if results is None:
                self.submit(job.key, job.function, *job.args)
            else:
                yield job.key, results

    def _next(self) -> tuple[str, bool]:
        """The next event; meanwhile, an eye on the cluster."""
        from queue import Empty

        silent = False
        while True:
            try:
                return self._events.get(timeout=HEARTBEAT)
            except Empty:
                self.width = self._threads()
                if not self._client.nthreads() and not silent:
                    self._say("the cluster has no workers; waiting for some")
                    silent = True

    def _result(self, future: Any) -> list[Any] | Lost | None:
        """What came of it; None if the worker died with the result, for dask may wait for that for ever."""
        from distributed import KilledWorker

        while future.status == "finished":
            with contextlib.suppress(TimeoutError, KilledWorker):
                return list(future.result(timeout=FETCH))
        if future.status != "error":
            if self._client.status == "running":
                return None
            raise ConnectionError(f"lost the scheduler at {self._client.scheduler.address}")
        error = future.exception()
        if isinstance(error, KilledWorker):
            late = f" or longer than --timeout = {self._place.timeout:g} s" if self._place.timeout else ""
            return Lost(f"every worker that had it died: killed, over its memory{late}")
        return Lost(f"{type(error).__name__}: {error}")


def _within(seconds: float | None, function: Work, *args: Any) -> list[Any]:
    """Call, and if it takes too long say so and leave: nothing else stops a thread that hangs."""
    if seconds is None:
        return function(*args)
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()

    def leave() -> None:
        worker.loop.add_callback(worker.log_event, LATE, {"key": key})
        time.sleep(GRACE)
        os._exit(1)

    timer = threading.Timer(seconds, leave)
    timer.daemon = True
    timer.start()
    # Compiled code may hold the interpreter, and the timer with it; this one needs no interpreter.
    faulthandler.dump_traceback_later(seconds + 2 * GRACE, exit=True)
    try:
        return function(*args)
    finally:
        timer.cancel()
        faulthandler.cancel_dump_traceback_later()


@contextlib.contextmanager
def pool(work: int, place: Place, say: Callable[[str], None]) -> Iterator[Pool]:
    """The place for so many pieces of work."""
    environment.prepare()
    if place.scheduler is None and not place.timeout and (work <= SMALL or place.workers <= 1):
        yield Here()
        return
    import dask
    from distributed import Client

    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(SETTINGS))
        address = place.scheduler or stack.enter_context(_cluster(min(place.workers, work), place.memory))
        client = Client(address, timeout="10s", security=_security(place.tls))
        yield Dask(stack.enter_context(client), place, say)


def _cluster(workers: int, memory: str) -> Any:
    """Workers of our own: processes of one thread, on loopback alone, no dashboard."""
    from distributed import LocalCluster

    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",  # dask insists on some port, where it then shows nothing
        scheduler_kwargs={"dashboard": False},
        memory_limit=memory,
        silence_logs="CRITICAL",
    )


def _security(tls: tuple[Path, Path, Path] | None) -> Any:
    """None: whatever dask's own configuration says."""
    if tls is None:
        return None
    from distributed import Security

    authority, certificate, key = map(str, tls)
    return Security(tls_ca_file=authority, tls_client_cert=certificate, tls_client_key=key, require_encryption=True)
