"""Tasks ready to run, handed out so that a worker is busy for a while with each piece of work."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from pipeline.tasks.task import Task
from pipeline.tasks.tasklist import Tasks

BUSY = 0.5  # a batch takes about this long: longer tasks go out one by one [s]
MOST = 100  # tasks in a batch
AHEAD = 3  # pieces of work on offer for each that runs
SHARE = 0.1  # of the newest outcome in the running mean


@dataclass(frozen=True, eq=False)
class Batch:
    """Tasks that go to a worker together, and the coefficients that they share."""

    tasks: tuple[Task, ...]
    coefficients: bytes | None


@dataclass(eq=False)
class _Group:
    """What is left of tasks with the same coefficients."""

    tasks: Iterator[Task]
    left: int
    coefficients: bytes | None
    block: int  # so many, one after another, share more than that
    taken: int = 0


class Batches:
    """A queue; short tasks leave it many at a time: a message to a worker or a record's own file costs 1 ms and more.

    In this process that is so as long as there are MOST.
    """

    def __init__(self) -> None:
        self._ready: deque[_Group] = deque()
        self._alone: deque[Batch] = deque()
        self._mean: float | None = None

    def __len__(self) -> int:
        return self._left() + len(self._alone)

    def _left(self) -> int:
        return sum(group.left for group in self._ready)

    def add(self, tasks: Tasks, coefficients: bytes | None, block: int = 1) -> None:
        """Queue tasks, with the file of their coefficients; a batch that reaches the end of a block ends with one."""
        if tasks:
            self._ready.append(_Group(iter(tasks), len(tasks), coefficients, block))

    def add_alone(self, lost: Batch) -> None:
        """Queue the tasks of a lost batch one by one: only the guilty one fails again."""
        self._alone.extend(Batch((task,), lost.coefficients) for task in lost.tasks)

    def heard(self, seconds: float) -> None:
        """Take in how long a task took [s], for the size of the next batches."""
        self._mean = seconds if self._mean is None else self._mean + SHARE * (seconds - self._mean)

    def take(self, width: int) -> Batch:
        """The next batch for a pool that runs so many at once; 0: for this process."""
        if self._alone:
            return self._alone.popleft()
        group = self._ready[0]
        size = self._size(width)
        beyond = (group.taken + size) % group.block
        tasks = tuple(itertools.islice(group.tasks, size - beyond if size > beyond else size))
        group.taken += len(tasks)
        group.left -= len(tasks)
        if not group.left:
            self._ready.popleft()
        return Batch(tasks, group.coefficients)

    def _size(self, width: int) -> int:
        if self._mean is None:
            return 1
        fair = self._left() // (AHEAD * width) if width else self._left() // MOST * MOST
        return max(1, min(MOST, fair, int(BUSY / max(self._mean, BUSY / MOST))))
