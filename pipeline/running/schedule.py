"""Where work runs: in this process, on workers started here, or on somebody's dask cluster.

Both pools take work, hand back what is finished, and take more meanwhile. A worker that dies costs the work in its
hands, which dask gives to another.
"""

from __future__ import annotations

import asyncio
import contextlib
import faulthandler
import logging
import math
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from enum import Enum, auto
from queue import Empty, SimpleQueue
from typing import Any, Protocol

from pipeline import environment, interrupt
from pipeline.running.cluster import own_cluster, start_fork_server
from pipeline.running.place import Place, security_of

SETTINGS = {
    # Coefficients ride with the tasks, so that none depends on what another worker may lose; that is meant.
    "distributed.admin.large-graph-warning-threshold": "100MB",
    # One task in hand and none waiting behind it: a task that kills its worker takes no other along.
    "distributed.scheduler.worker-saturation": 1.0,
    # So many workers may die under a task, perhaps of something else, before it counts as their murderer.
    "distributed.scheduler.allowed-failures": 3,
    "distributed.comm.timeouts.connect": "10s",
    "distributed.worker.profile.enabled": False,  # who runs what, a hundred times a second: nobody looks at it
    # A fork of a process that has imported everything is up at once, also when a worker that died is replaced.
    "distributed.worker.multiprocessing-method": "forkserver",
    # Who may not connect gets no page either, with the labels of tasks, their errors and where they run.
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}
SMALL = 2  # so few pieces of work are done sooner than a cluster starts
START = "study-start"  # the topic on which workers tell that they begin a piece of work
GRACE = 2.0  # so long after its timeout a worker that was not told to stop ends itself [s]
TRANSFERS = 4  # results that come at once: one whose worker is silent stops no other, and few are in memory
LOOK = 0.5  # so often the worker of a result that has not come is looked for [s]
TRIES = 3  # so often may a result be lost on its way, before it counts as too large for workers or this process
HEARTBEAT = 5.0  # how often the cluster is looked at while nothing comes back [s]

Work = Callable[..., list[Any]]


class Lost(Exception):
    """A piece of work that came to no end: too late, or its workers died."""


class Pool(Protocol):
    """Something that runs functions."""

    @property
    def width(self) -> int:
        """How many pieces of work run at once; 0: one after another, in this process."""

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
        """Queue function(*args)."""
        self._queue.append((key, function, args))

    def finished(self) -> Iterator[tuple[Hashable, list[Any] | Lost]]:
        """Run what is queued, in order."""
        while self._queue:
            interrupt.check()
            key, function, args = self._queue.popleft()
            yield key, function(*args)


@dataclass(eq=False)
class _Job:
    key: Hashable
    future: Any
    function: Work
    args: tuple[Any, ...]
    tries: int
    deadline: float = math.inf  # by time.monotonic() [s]; none before it has begun, and none once it has ended
    transfer: Future[list[Any] | None] | None = None  # of the result, if there is one


class _Step(Enum):
    """What happens to a piece of work, in this order."""

    BEGUN = auto()
    ENDED = auto()
    HERE = auto()  # the transfer of its result is over


class Dask:
    """A dask cluster."""

    def __init__(self, client: Any, place: Place, say: Callable[[str], None]) -> None:
        self._client, self._place, self._say = client, place, say
        self._running: dict[str, _Job] = {}
        self._events: SimpleQueue[tuple[str, _Step]] = SimpleQueue()
        self._here: deque[str] = deque()  # names of what is over, with the result here if there is one
        self._doors = asyncio.Semaphore(TRANSFERS)
        self._refused: set[str] = set()  # addresses of workers with other sources
        self.width = self._threads()
        if place.timeout:
            client.subscribe_topic(START, lambda event: self._events.put((event[1]["key"], _Step.BEGUN)))

    def _threads(self) -> int:
        # Idle clusters may yet grow, so at least one piece of work is always on offer.
        return max(1, sum(self._client.nthreads().values()))

    def submit(self, key: Hashable, function: Work, *args: Any) -> None:
        """Send function(*args) to a worker."""
        self._send(key, function, args, TRIES)

    def _send(self, key: Hashable, function: Work, args: tuple[Any, ...], tries: int) -> None:
        future = self._client.submit(_within, self._place.timeout, function, *args, pure=False, **self._where())
        self._running[future.key] = _Job(key, future, function, args, tries)
        future.add_done_callback(lambda done: self._events.put((done.key, _Step.ENDED)))

    def finished(self) -> Iterator[tuple[Hashable, list[Any] | Lost]]:
        """Results as they come; late work is cancelled, that of a worker with other sources is sent out again."""
        while self._running:
            name, late = self._next()
            job = self._running[name]
            results: list[Any] | Lost | None
            if late:
                job.future.cancel(force=True)
                results = Lost(f"ran longer than --timeout = {self._place.timeout:g} s")
            else:
                results = self._result(job)
            if isinstance(results, list) and self._foreign(name, results):
                results = None
            del self._running[name]
            job.future.release()
            if results is None:
                self._send(job.key, job.function, job.args, job.tries)
            else:
                yield job.key, results

    def give_up(self) -> None:
        """What is on its way will not be waited for: asyncio would tell of transfers that its loop's end cuts off."""
        for job in self._running.values():
            if job.transfer:
                job.transfer.cancel()

    def _foreign(self, name: str, results: list[Any]) -> bool:
        """Whether a worker with another solver has computed another study: another does it, and that one no more."""
        mine, theirs = environment.sources(), results[0].provenance["solver_sources"]
        if theirs == mine:
            return False
        for address in set(self._client.who_has([self._running[name].future])[name]) - self._refused:
            self._refused.add(address)
            self._say(f"the worker at {address} has solver sources {theirs}, this process {mine}: it gets no more work")
        return True

    def _where(self) -> dict[str, Any]:
        """For whom work is meant: anybody, or those that have not been refused as long as one of them lives."""
        if not self._refused:
            return {}
        trusted = [address for address in self._client.nthreads() if address not in self._refused]
        if not trusted:
            raise ConnectionError("no worker has this process's solver sources: install the same")
        return {"workers": trusted, "allow_other_workers": True}

    def _next(self) -> tuple[str, bool]:
        """The next piece of work that has come to an end, or is over its time; meanwhile, an eye on the cluster."""
        silent = False
        while True:
            interrupt.check()
            if not self._hear() and not self._here:
                self.width = self._threads()
                if not self._client.nthreads() and not silent:
                    self._say("the cluster has no workers; waiting for some")
                    silent = True
            if late := next((name for name in self._running if self._late(name)), ""):
                return late, True
            if self._here:
                return self._here.popleft(), False

    def _hear(self) -> bool:
        """Take in all that has happened; wait for something, unless there is something to do already."""
        soonest = min((job.deadline for job in self._running.values()), default=math.inf) - time.monotonic()
        wait, heard = 0.0 if self._here else min(max(soonest, 0.0), HEARTBEAT), False
        with contextlib.suppress(Empty):
            while True:
                name, step = self._events.get(timeout=wait)
                wait, heard = 0.0, True
                if job := self._running.get(name):
                    self._take_in(job, step)
        return heard

    def _take_in(self, job: _Job, step: _Step) -> None:
        """Its time runs from when it has begun until it has ended; a result is then sent for."""
        name = job.future.key
        if step is _Step.BEGUN:
            # Late, its worker left before the client cancelled it; with a transfer, dask has it done again.
            if not job.transfer and not self._late(name):
                job.deadline = time.monotonic() + (self._place.timeout or math.inf)
            return
        job.deadline = math.inf
        if step is _Step.ENDED and job.future.status == "finished":
            job.transfer = asyncio.run_coroutine_threadsafe(self._transferred(name), self._client.loop.asyncio_loop)
            job.transfer.add_done_callback(lambda _: self._events.put((name, _Step.HERE)))
        else:
            self._here.append(name)

    async def _transferred(self, name: str) -> list[Any] | None:
        """A result, however long it takes to come; None if its worker has left before.

        Nothing waits for it, so it need not be given up for others: its worker may be silent for a while in its next
        piece of work, or its record be large. dask's own gather would wait for a lost one to be computed again.
        """
        who_has = self._client.scheduler.who_has
        async with self._doors:
            holders = await who_has(keys=[name])
            if not any(holders.values()):
                return None
            sending = asyncio.ensure_future(self._sent(name, holders))
            try:
                while not (await asyncio.wait([sending], timeout=LOOK))[0]:
                    if await who_has(keys=[name]) != holders:
                        return None
                return sending.result()
            finally:
                sending.cancel()

    async def _sent(self, name: str, holders: dict[Any, list[str]]) -> list[Any] | None:
        """A result from a worker that is there, but may not answer at once; None if it cannot be taken in."""
        from distributed.utils_comm import gather_from_workers

        while True:
            if self._client.cluster:  # its workers are within reach, and the scheduler need not hold it, too
                data, _, failed, _ = await gather_from_workers(holders, self._client.rpc)
            else:
                data, failed = (await self._client.scheduler.gather(keys=[name])).get("data", {}), []
            results: Any = data.get(name)
            if results or failed:
                return results or None
            await asyncio.sleep(LOOK)

    def _late(self, name: str) -> bool:
        return self._running[name].deadline <= time.monotonic()

    def _result(self, job: _Job) -> list[Any] | Lost | None:
        """What came of it; None if the worker died with the result, so that it has to be done again."""
        from distributed import KilledWorker

        if job.transfer:
            with contextlib.suppress(OSError):  # the scheduler is lost
                if results := job.transfer.result():
                    return results
        if job.future.status != "error":
            if self._client.status != "running":
                raise _lost(self._client)
            job.tries -= 1
            return None if job.tries else Lost(f"its result was lost {TRIES} times: workers died, or memory is short")
        error = job.future.exception()
        if isinstance(error, KilledWorker):
            late = f" or longer than --timeout = {self._place.timeout:g} s" if self._place.timeout else ""
            return Lost(f"every worker that had it died: killed, over its memory{late}")
        return Lost(f"{type(error).__name__}: {error}")


def _within(seconds: float | None, function: Work, *args: Any) -> list[Any]:
    """Call, and if it takes too long end this process: nothing else stops a thread that hangs."""
    if seconds is None:
        return function(*args)
    _announce()
    timer = threading.Timer(seconds + GRACE, os._exit, (1,))
    timer.daemon = True
    timer.start()
    # Compiled code may hold the interpreter, and the timer with it; this one needs no interpreter.
    faulthandler.dump_traceback_later(seconds + 2 * GRACE, exit=True)
    try:
        return function(*args)
    finally:
        timer.cancel()
        faulthandler.cancel_dump_traceback_later()


def _announce() -> None:
    """Tell the client that its time runs, and be sure that it is told: compiled code may leave no other chance."""
    from distributed import get_worker
    from distributed.utils import sync

    worker = get_worker()
    sync(worker.loop, worker.scheduler.log_event, topic=START, msg={"key": worker.get_current_task()})


def warm_up(work: int, place: Place) -> None:
    """Start the process that workers are forked from, so that it imports while this one still checks the study."""
    if place.scheduler is None and not _small(work, place):
        start_fork_server()


def _small(work: int, place: Place) -> bool:
    """Whether this process is as good as workers."""
    return not place.timeout and (work <= SMALL or place.workers <= 1)


@contextlib.contextmanager
def pool(work: int, place: Place, say: Callable[[str], None]) -> Iterator[Pool]:
    """The place for so many pieces of work."""
    environment.prepare()
    if place.scheduler is None and _small(work, place):
        yield Here()
        return
    with environment.importing():
        import dask
        from distributed import Client
        from distributed.comm.core import CommClosedError

    for name in ("distributed", "distributed.client"):
        # Dask tells in tracebacks how a cluster breaks; what a user can do about it is said here.
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(SETTINGS))
        own = None if place.scheduler else stack.enter_context(own_cluster(min(place.workers, work), place.memory))
        security = own.security if own else security_of(place.tls)
        # Not the default for all that uses dask in this process: one that is lost would stay that.
        client = stack.enter_context(
            Client(own or place.scheduler, timeout="10s", security=security, set_as_default=False)
        )
        cluster = Dask(client, place, say)
        try:
            yield cluster
        except CommClosedError:
            raise _lost(client) from None
        finally:
            cluster.give_up()


def _lost(client: Any) -> ConnectionError:
    return ConnectionError(f"lost the scheduler at {client.scheduler.address}")
