"""What the command line says about tasks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from pipeline import environment
from pipeline.store import Entry, Store
from pipeline.study import Study, StudyError
from pipeline.tasks import Task

DONE, FAILED, INCOMPLETE = 0, 1, 2
Entries = Sequence[tuple[Task, Entry]]
out, err = Console(), Console(stderr=True)


def say(text: str, console: Console = out) -> None:
    """A plain line, whatever is in it."""
    print(text, file=console.file)


def store_of(study: Study, results: Path) -> Store:
    """Where a study's results are; refuses a path that is no folder."""
    if results.exists() and not results.is_dir():
        raise StudyError(study.path, [f"--results = {results}: must be a folder"])
    return Store(results, study.name)


def looked(tasks: Sequence[Task], store: Store) -> list[tuple[Task, Entry]]:
    """Every task, once, with its state."""
    return [(task, store.look(task)) for task in {task.id: task for task in tasks}.values()]


def tally(entries: Entries) -> str:
    """54 tasks: 50 done, 3 missing, 1 failed."""
    counts = Counter(entry.state for _, entry in entries)
    return (
        f"{len(entries)} tasks: "
        + ", ".join(f"{n} {state}" for state, n in counts.most_common())
        + other_sources(entries)
    )


def other_sources(entries: Entries) -> str:
    """A note if finished tasks came from other solver sources than the present ones."""
    mine = environment.sources()
    found = [e.status.get("provenance", {}).get("solver_sources", mine) for _, e in entries if e.state == "done"]
    count = sum(sources != mine for sources in found)
    return f"; {count} done by other solver sources of the same model version" if count else ""


def finish(entries: Entries, study: Study) -> int:
    """List what failed, with reason; the exit status."""
    failed = [(task, entry) for task, entry in entries if entry.state == "failed"]
    for task, entry in failed:
        error = entry.status.get("error", {})
        say(f"failed: {task.id} {task}: {error.get('kind')}: {error.get('message')}", err)
    if failed:
        say(f"see `study show {study.path} TASK`, repeat with `study rerun {study.path} --failed`", err)
    return FAILED if failed else DONE


def compare(task: Task, old: bytes | None, new: bytes | None) -> bool:
    """Say how the new record relates to the old one; False if both are there and differ."""
    from pipeline.records import differences

    if old is None or new is None:
        say(f"{task.id}: no old record to compare with" if new else f"{task.id}: no new record")
        return True
    lines = differences(old, new)
    say(f"{task.id}: " + ("differs from the old record" if lines else "bitwise the same as the old record"))
    for line in lines:
        say(f"  {line}")
    return not lines
