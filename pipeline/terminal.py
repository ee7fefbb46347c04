"""The terminal: its two streams, and how far a long pass over many things has come."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

from rich.console import Console

PATIENCE = 2.0  # a pass that takes longer shows itself [s]
STRIDE = 64  # things from one look at the clock to the next
out, err = Console(), Console(stderr=True)

Item = TypeVar("Item")


def passing(items: Iterable[Item], total: int, words: str) -> Iterator[Item]:
    """The items; on a terminal, after a while, with a bar of how many have passed and how long the rest takes."""
    if not err.is_interactive:
        yield from items
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress  # 20 ms that only this needs

    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), "{task.fields[left]}")
    # What is printed meanwhile is left alone: it may go to a file.
    bar = Progress(*columns, console=err, transient=True, redirect_stdout=False)
    job, start = bar.add_task(words, total=total, left=""), time.monotonic()
    try:
        for number, item in enumerate(items):
            if number % STRIDE == 0 < number and (waited := time.monotonic() - start) > PATIENCE:
                bar.update(job, completed=number, left=f"{about(waited * (total - number) / number)} left")
                bar.start()
            yield item
    finally:
        bar.stop()


def about(seconds: float) -> str:
    """A time as precise as an estimate is."""
    if seconds < 90:
        return f"about {seconds:.0f} s"
    return f"about {seconds / 60:.0f} min" if seconds < 5400 else f"about {seconds / 3600:.1f} h"
