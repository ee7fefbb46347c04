"""What a user sees while tasks run: a bar on a terminal, one line a task elsewhere."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from pipeline.run import Failure, Outcome
from pipeline.tasks import Geometry, Task

Watch = Callable[[Task | Geometry, Outcome], None]


@contextlib.contextmanager
def watching(console: Console, total: int) -> Iterator[Watch]:
    """A watch for so many tasks."""
    clock = Clock(total)
    if not console.is_terminal:
        yield lambda what, outcome: console.print(
            clock.line(what, outcome), soft_wrap=True, highlight=False, markup=False
        )
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, TextColumn("{task.fields[left]}"), console=console) as bar:
        job = bar.add_task("tasks", total=total, left="")

        def watch(what: Task | Geometry, outcome: Outcome) -> None:
            line = clock.line(what, outcome)
            if isinstance(what, Geometry) or isinstance(outcome.result, Failure):
                bar.console.print(line, highlight=False, markup=False)
            bar.update(job, completed=clock.done, left=clock.left())

        yield watch


class Clock:
    """Counts outcomes and tells how long the rest will take."""

    def __init__(self, total: int):
        self.total, self.done, self.start = total, 0, time.monotonic()
        self.first = 0.0  # when the first task came in: set-up and compilation lie before it [s]

    def line(self, what: Task | Geometry, outcome: Outcome) -> str:
        """One outcome in words."""
        result = outcome.result
        if isinstance(what, Geometry):
            how = f"failed: {result.message}" if isinstance(result, Failure) else f"{outcome.wall_time:.1f} s"
            return f"hydrodynamic coefficients of {len(what.bodies)} floats: {how}"
        self.done += 1
        self.first = self.first or time.monotonic() - self.start
        how = (
            f"failed: {result.kind}: {result.message}" if isinstance(result, Failure) else f"{outcome.wall_time:.1f} s"
        )
        width = len(str(self.total))
        return f"[{self.done:{width}}/{self.total}] {what.id} {what}: {how}{self._comma_left()}"

    def left(self) -> str:
        """An estimate of the time left, from the tasks after the first."""
        remaining = self.total - self.done
        if self.done < 2 or not remaining:
            return ""
        pace = (time.monotonic() - self.start - self.first) / (self.done - 1)
        seconds = pace * remaining
        return f"about {seconds:.0f} s left" if seconds < 90 else f"about {seconds / 60:.0f} min left"

    def _comma_left(self) -> str:
        left = self.left()
        return f", {left}" if left else ""
