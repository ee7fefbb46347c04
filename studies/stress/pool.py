"""Two processes that take jobs one by one; one that overruns its limit is killed and replaced."""

import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from typing import Any


class _Worker:
    """A process, its end of the pipe, and the job in its hands."""

    def __init__(self, work: Callable[[Any], Any]):
        self.pipe, theirs = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=_serve, args=(theirs, work), daemon=True)
        self.process.start()
        self.job, self.deadline = -1, float("inf")

    def give(self, number: int, job: Any, limit: float) -> None:
        self.job, self.deadline = number, time.monotonic() + limit
        self.pipe.send(job)

    def stop(self) -> None:
        self.process.kill()
        self.process.join()


def _serve(pipe: Connection, work: Callable[[Any], Any]) -> None:
    while True:
        pipe.send(work(pipe.recv()))


def run(work: Callable[[Any], Any], jobs: Sequence[Any], limits: Sequence[float], processes: int = 2) -> Iterator:
    """(number, result) as they come; the result of a job that overran its limit [s] or died is None.

    Compiled code cannot be interrupted from within, so a hang ends with its process.
    """
    waiting = iter(range(len(jobs)))
    workers = [_Worker(work) for _ in range(min(processes, len(jobs)))]
    busy = [w for w in workers if _next(w, waiting, jobs, limits)]
    while busy:
        wait([w.pipe for w in busy], timeout=1.0)
        for i, worker in enumerate(busy):
            late = time.monotonic() > worker.deadline
            if not (worker.pipe.poll() or late):
                continue
            try:
                result = worker.pipe.recv() if worker.pipe.poll() else None
            except EOFError:
                result = None
            yield worker.job, result
            if result is None:
                worker.stop()
                busy[i] = _Worker(work)
            if not _next(busy[i], waiting, jobs, limits):
                busy[i].stop()
        busy = [w for w in busy if w.process.is_alive()]


def _next(worker: _Worker, waiting: Iterator[int], jobs: Sequence[Any], limits: Sequence[float]) -> bool:
    number = next(waiting, None)
    if number is None:
        return False
    worker.give(number, jobs[number], limits[number])
    return True
