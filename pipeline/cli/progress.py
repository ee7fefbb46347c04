"""What a user sees while tasks run: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from pipeline import interrupt
from pipeline.bridge.engine import Failure, Outcome
from pipeline.bridge.geometry import Geometry
from pipeline.running.campaign import Portion, Watch
from pipeline.tasks.task import Task
from pipeline.terminal import PATIENCE, about

PAUSE = 0.2  # between two lines about tasks that went well [s]


@contextlib.contextmanager
def watching(console: Console, total: int) -> Iterator[Watch]:
    """A watch for so many tasks."""
    clock = Clock(total)
    if not console.is_terminal:
        yield lambda what, outcome: _print(clock, console, what, outcome)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, TextColumn("{task.fields[left]}"), console=console) as bar:
        job = bar.add_task("tasks", total=total, left="")

        def watch(what: Task | Geometry | Portion, outcome: Outcome) -> None:
            clock.count(what)
            if not isinstance(what, Task) or isinstance(outcome.result, Failure):
                bar.console.print(clock.line(what, outcome), highlight=False, markup=False)
            bar.update(job, completed=clock.done, left=clock.left())

        yield watch


def _print(clock: Clock, console: Console, what: Task | Geometry | Portion, outcome: Outcome) -> None:
    """Every failure and the last task have their line; the others not more often than can be read."""
    clock.count(what)
    if clock.due() or isinstance(outcome.result, Failure) or not isinstance(what, Task):
        console.print(clock.line(what, outcome), soft_wrap=True, highlight=False, markup=False)


@contextlib.contextmanager
def share(console: Console, words: str) -> Iterator[Callable[[float], None]]:
    """What is told the share of some work that is done; on a terminal, after a while, with a bar."""
    if not console.is_interactive:
        yield lambda _: interrupt.check()
        return
    bar = Progress(TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), console=console, transient=True)
    job, start = bar.add_task(words, total=1.0), time.monotonic()

    def told(done: float) -> None:
        interrupt.check()
        bar.update(job, completed=done)
        if time.monotonic() - start > PATIENCE:
            bar.start()

    try:
        yield told
    finally:
        bar.stop()


class Clock:
    """Counts outcomes and tells how long the rest will take."""

    def __init__(self, total: int):
        self.total, self.done, self.start = total, 0, time.monotonic()
        self.first = 0.0  # when the first task came in: set-up and compilation lie before it [s]
        self.spoke = -PAUSE  # when a line was last due
        self.portions = 0  # of long solutions, that came in

    def count(self, what: Task | Geometry | Portion) -> None:
        """Count an outcome, if it is that of a task or a share."""
        if isinstance(what, Task):
            self.done += 1
            self.first = self.first or time.monotonic() - self.start
        elif isinstance(what, Portion):
            self.portions += 1

    def due(self) -> bool:
        """Whether the last line is some time ago, or this is the last."""
        now = time.monotonic() - self.start
        if now - self.spoke < PAUSE and self.done < self.total:
            return False
        self.spoke = now
        return True

    def line(self, what: Task | Geometry | Portion, outcome: Outcome) -> str:
        """One outcome in words."""
        result = outcome.result
        if isinstance(what, Portion):
            pace = (time.monotonic() - self.start) / max(self.portions, 1)
            return (
                f"{_made(what.geometry)}: {what.done} of {what.of} shares, {about(pace * (what.of - what.done))} left"
            )
        if isinstance(what, Geometry):
            seconds = f"{outcome.wall_time:.1f} s, summed over workers"
            return f"{_made(what)}: {f'failed: {result.message}' if isinstance(result, Failure) else seconds}"
        # Why is told once of all tasks that fail so, when the run is over.
        how = f"failed: {result.kind}" if isinstance(result, Failure) else f"{outcome.wall_time:.1f} s"
        left = self.left()
        width = len(str(self.total))
        return f"[{self.done:{width}}/{self.total}] {what.id} {what}: {how}{', ' if left else ''}{left}"

    def left(self) -> str:
        """An estimate of the time left, from the tasks after the first."""
        remaining = self.total - self.done
        if self.done < 2 or not remaining:
            return ""
        pace = (time.monotonic() - self.start - self.first) / (self.done - 1)
        return about(pace * remaining) + " left"


def _made(geometry: Geometry) -> str:
    """What is made for a geometry."""
    count = len(geometry.bodies)
    made = "hydrodynamic coefficients of" if geometry.flow else "pressure of the undisturbed waves on"
    return f"{made} {count} float{'s' * (count > 1)}"
