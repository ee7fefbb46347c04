"""Where work runs: in this process, on two workers of our own, or on somebody's dask cluster.

The only import of dask. Both pools take work, hand back what is finished, and may be given more
meanwhile. A worker that dies costs the work in its hands, which dask gives to another.
"""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Callable, Hashable, Iterator
from typing import Any, Protocol

from pipeline import environment
from pipeline.run import Failure, Outcome

SETTINGS = {
    # The coefficients of a geometry ride in the graph, once each; that is meant.
    "distributed.admin.large-graph-warning-threshold": "100MB",
    # One task in hand and none waiting behind it: a task that kills its worker takes no other along.
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.scheduler.allowed-failures": 1,
    "distributed.comm.timeouts.connect": "10s",
}
SMALL = 2  # so few pieces of work are done sooner than a cluster starts


class Pool(Protocol):
    """Something that runs functions."""

    def share(self, name: str, value: Any) -> Any:
        """A handle on a large value that many pieces of work take as an argument."""

    def submit(self, key: Hashable, function: Callable[..., Outcome], *args: Any) -> None:
        """Have function(*args) run."""

    def finished(self) -> Iterator[tuple[Hashable, Outcome]]:
        """Outcomes as they come, until nothing is left, later submissions included."""


class Here:
    """This process, one piece of work after another."""

    def __init__(self) -> None:
        self._queue: deque[tuple[Hashable, Callable[..., Outcome], tuple[Any, ...]]] = deque()

    def share(self, name: str, value: Any) -> Any:  # noqa: ARG002
        return value

    def submit(self, key: Hashable, function: Callable[..., Outcome], *args: Any) -> None:
        self._queue.append((key, function, args))

    def finished(self) -> Iterator[tuple[Hashable, Outcome]]:
        while self._queue:
            key, function, args = self._queue.popleft()
            yield key, function(*args)


class Dask:
    """A dask cluster."""

    def __init__(self, client: Any) -> None:
        from distributed import as_completed

        self._client = client
        self._futures = as_completed([])
        self._keys: dict[str, Hashable] = {}

    def share(self, name: str, value: Any) -> Any:
        # A task and not a scatter: should the worker that holds it die, dask makes it again.
        return self._client.submit(_itself, value, key=name, pure=False)

    def submit(self, key: Hashable, function: Callable[..., Outcome], *args: Any) -> None:
        future = self._client.submit(function, *args, pure=False)
        self._keys[future.key] = key
        self._futures.add(future)

    def finished(self) -> Iterator[tuple[Hashable, Outcome]]:
        for future in self._futures:
            key = self._keys.pop(future.key)
            # dask reports what happened around the work, say a worker that kept dying.
            error = future.exception() if future.status != "finished" else None
            yield key, _lost(error) if error else future.result()
            future.release()


def _itself(value: Any) -> Any:
    return value


def _lost(error: BaseException) -> Outcome:
    return Outcome(result=Failure.of(error), provenance=environment.provenance())


@contextlib.contextmanager
def pool(work: int, *, workers: int, scheduler: str | None) -> Iterator[Pool]:
    """The place for so many pieces of work."""
    environment.prepare()
    if scheduler is None and (work <= SMALL or workers <= 1):
        yield Here()
        return
    import dask
    from distributed import Client, LocalCluster

    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set(SETTINGS))
        if scheduler is None:
            scheduler = stack.enter_context(
                LocalCluster(
                    n_workers=min(workers, work),
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address=None,
                    silence_logs="CRITICAL",
                )
            )
        yield Dask(stack.enter_context(Client(scheduler, timeout="30s")))
