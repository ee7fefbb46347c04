"""What the command line says about tasks."""

from __future__ import annotations

import itertools
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from pipeline import environment
from pipeline.results.netcdf import Variable
from pipeline.results.status import FEW, MANY, without_numbers
from pipeline.results.store import Entry, Store
from pipeline.study.reading import StudyError
from pipeline.tasks.study import Study
from pipeline.tasks.task import Task
from pipeline.tasks.tasklist import Tasks
from pipeline.terminal import err, out

DONE, FAILED, INCOMPLETE = 0, 1, 2


def say(text: str, console: Console = out) -> None:
    """A plain line, whatever is in it; at once, for `status --watch` may go to a file that somebody reads meanwhile."""
    print(text, file=console.file, flush=True)


def store_of(study: Study, results: Path) -> Store:
    """Where a study's results are; refuses a path that is no folder."""
    store = Store(results, study.name)
    for folder in (results, store.root):
        if os.path.lexists(folder) and not folder.is_dir():
            link = "" if folder.exists() else ", and is a link to nothing"
            raise StudyError(study.path, [f"--results = {folder}: must be a folder{link}"])
    return store


def looked(tasks: Tasks, store: Store) -> Iterator[tuple[Task, Entry]]:
    """Every task with its state, one at a time: what is known of a million does not fit in memory."""
    return ((task, store.look(task)) for task in tasks.passing())


@dataclass
class Reasons:
    """What is said of tasks: scenes that are alike fail alike. Each is told once, by the first of its tasks."""

    counts: Counter[str] = field(default_factory=Counter)  # how many for each of the first reasons, without numbers
    first: dict[str, tuple[str, list[str]]] = field(default_factory=dict)  # that of the first of those, and they

    def see(self, task: Task, reason: str) -> None:
        """Count one more task of which something may be said."""
        alike = without_numbers(reason)
        if reason and (alike in self.counts or len(self.counts) < MANY):
            self.counts[alike] += 1
            if self.counts[alike] <= FEW:
                self.first.setdefault(alike, (reason, []))[1].append(f"{task.id} {task}")


@dataclass
class Tally:
    """What there is to say of many tasks, gathered as they pass by."""

    counts: Counter[str] = field(default_factory=Counter)
    other_sources: int = 0  # finished tasks from other solver sources than the present ones
    failed: Reasons = field(default_factory=Reasons)
    short: int = 0  # finished tasks of which more was asked than they met
    unmet: list[str] = field(default_factory=list)  # the first of them, in words
    odd: Reasons = field(default_factory=Reasons)  # warnings of finished tasks
    told: str = ""  # before they ran, a line each, without numbers

    @classmethod
    def of(cls, entries: Iterable[tuple[Task, Entry]], told: Iterable[str] = ()) -> Tally:
        """A tally of all these entries; warnings that were told already give way to others."""
        tally = cls(told="\n".join(map(without_numbers, told)))
        for task, entry in entries:
            tally.see(task, entry)
        return tally

    def see(self, task: Task, entry: Entry) -> None:
        """Count one more task."""
        self.counts[entry.state] += 1
        if entry.state == "done":
            mine = environment.sources()
            self.other_sources += entry.status.provenance.get("solver_sources", mine) != mine
        if entry.unmet:
            self.short += 1
            if self.short <= FEW:
                self.unmet.append(f"not met: {task.id} {task}: {entry.unmet}")
        self.odd.see(task, self._untold(entry.warnings))
        self.failed.see(task, entry.failure)

    def _untold(self, warnings: str) -> str:
        """Those of a task's sentences that were not told, with other numbers or of a sea by its name."""
        if not self.told:
            return warnings
        each = ((text, re.escape(without_numbers(text.removeprefix("sea: ")))) for text in warnings.split("; "))
        # Labels or a sea's name before it, and how many others after it.
        return "; ".join(t for t, alike in each if not re.search(rf"(^|[:;] ){alike}($|; | \(and )", self.told, re.M))

    @property
    def code(self) -> int:
        """The exit status."""
        if self.counts["failed"]:
            return FAILED
        return INCOMPLETE if self.counts["missing"] or self.counts["damaged"] else DONE

    def __str__(self) -> str:
        """54 tasks: 50 done, 3 missing, 1 failed."""
        others = f"; {self.other_sources} done by other solver sources of the same model version"
        states = ", ".join(f"{n} {state}" for state, n in self.counts.most_common() if n)
        short = f"; {self.short} did not meet what was asked"
        words = (others if self.other_sources else "") + (short if self.short else "")
        return f"{self.counts.total()} tasks: {states}{words}"


def finish(tally: Tally, study: Study, store: Store) -> int:
    """List what was asked and not met, what is odd, and what failed, with reason; the exit status."""
    for line in tally.unmet:
        say(line, err)
    if tally.short > FEW:
        say(f"and {tally.short - FEW} more that did not meet what was asked, as `study show` tells of each", err)
    for alike, (warning, tasks) in itertools.islice(tally.odd.first.items(), FEW):
        others = tally.odd.counts[alike] - 1
        say(f"warning: {tasks[0]}: {warning}{f' (and {others} more)' if others else ''}", err)
    if (more := len(tally.odd.first) - FEW) > 0:
        say(f"and {more} more of other warnings, as the report tells, and `study show` of each task", err)
    for alike, (reason, tasks) in tally.failed.first.items():
        others = tally.failed.counts[alike] - len(tasks)
        say(f"failed: {'; '.join(tasks)}{f' and {others} more' if others else ''}: {reason}", err)
    count = tally.counts["failed"]
    if unlisted := count - tally.failed.counts.total():
        say(f"and {unlisted} more that `{store.command('plan', study.path)}` lists", err)
    if count:
        see, repeat = store.command("show", study.path, "TASK"), store.command("rerun", study.path, "--failed")
        say(f"see `{see}`, repeat with `{repeat}`", err)
    return FAILED if count else DONE


def compare(task: Task, old: Mapping[str, Variable] | None, new: Mapping[str, Variable] | None) -> bool:
    """Say how the new record relates to the old one; False if both are there and differ."""
    from pipeline.results.records import differences

    if old is None or new is None:
        say(f"{task.id}: no old record to compare with" if new else f"{task.id}: no new record")
        return True
    lines = differences(old, new)
    say(f"{task.id}: " + ("differs from the old record" if lines else "bitwise the same as the old record"))
    for line in lines:
        say(f"  {line}")
    return not lines
