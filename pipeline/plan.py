"""How long a run will take, from runs that were."""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pipeline.cache import Cache
from pipeline.progress import about
from pipeline.schema import Recording
from pipeline.store import Entry, read_json
from pipeline.tasks import Geometry, Label, Task

SAMPLE = 200  # tasks of other studies looked at


def estimate(entries: Sequence[tuple[Task, Entry]], results: Path, workers: int) -> str:
    """A sentence on the time that missing tasks will take; empty if nothing is missing."""
    todo = [task for task, entry in entries if entry.state in ("missing", "damaged")]
    if not todo:
        return ""
    past = [entry.status for _, entry in entries if entry.state in ("done", "stale")]
    source = f"{len(past)} tasks done"
    if not past:
        past = list(itertools.islice(_others(results), SAMPLE))
        source = f"{len(past)} tasks of other studies"
    rates = {label: _rate(past, label) for label in {task.labels["platform"] for task in todo}}
    lengths = ((task.labels["platform"], task.parameters.record) for task in todo)
    seconds = sum(rates[label] * (record.duration + record.discard) for label, record in lengths) / workers
    words = f"{about(seconds)} on {workers} workers, from {source}" if past else "no past run tells how long they take"
    fresh = _unsolved(todo, results)
    return f"to run: {len(todo)} tasks" + (f" after {fresh} boundary element solutions" if fresh else "") + f"; {words}"


def _rate(past: Sequence[dict[str, Any]], platform: Label) -> float:
    """Mean wall time of a simulated second, of tasks with the same platform label or else of all [-]."""
    alike = [s for s in past if s.get("labels", {}).get("platform") == platform] or past
    return statistics.fmean(s.get("wall_time", 0.0) / _length(s) for s in alike) if alike else 0.0


def _length(status: dict[str, Any]) -> float:
    default, given = Recording(), status.get("parameters", {}).get("record", {})
    return float(given.get("duration", default.duration) + given.get("discard", default.discard))


def _others(results: Path) -> Iterator[dict[str, Any]]:
    for path in results.glob("*/tasks/*/status.json"):
        if (status := read_json(path)) and status.get("state") == "done":
            yield status


def _unsolved(tasks: Sequence[Task], results: Path) -> int:
    geometries: set[Geometry] = {task.geometry for task in tasks if task.geometry}
    return sum(Cache(results).get(geometry.key) is None for geometry in geometries)
