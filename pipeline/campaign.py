"""Run tasks: coefficients once for each geometry, then every task, each result kept as it comes."""

from __future__ import annotations

import shlex
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pipeline import schedule
from pipeline.cache import Cache
from pipeline.run import Engine, Failure, Outcome, attempt_geometry, attempt_task
from pipeline.store import Entry, Store
from pipeline.tasks import Geometry, Task

Watch = Callable[[Task | Geometry, Outcome], None]


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """How and where the tasks of a study are run and kept."""

    study: Path
    results: Path
    store: Store
    engine: Engine
    workers: int = 2
    scheduler: str | None = None
    keep_going: bool = True

    def run(self, tasks: Sequence[Task], watch: Watch) -> list[Task]:
        """Run and keep all; the tasks that failed. `watch` hears of every outcome."""
        tasks = list({task.id: task for task in tasks}.values())
        known, unknown, free = self._geometries(tasks)
        failed: list[Task] = []
        with schedule.pool(len(tasks) + len(unknown), workers=self.workers, scheduler=self.scheduler) as pool:
            for geometry, _ in unknown.values():
                pool.submit(geometry, attempt_geometry, self.engine, geometry)
            for task in free:
                self._submit(pool, task, None)
            for name, (data, waiting) in known.items():
                self._release(pool, name, data, waiting)
            for key, outcome in pool.finished():
                if isinstance(key, Geometry):
                    watch(key, outcome)
                    failed += self._geometry_done(pool, outcome, key, unknown[key.key][1], watch)
                elif isinstance(key, Task):
                    failed += [key] if self._keep(key, outcome) else []
                    watch(key, outcome)
                if failed and not self.keep_going:
                    break
        return failed

    def _geometries(
        self, tasks: Sequence[Task]
    ) -> tuple[dict[str, tuple[bytes, list[Task]]], dict[str, tuple[Geometry, list[Task]]], list[Task]]:
        """Tasks whose coefficients are known, those that wait for them, and those that need none."""
        groups: defaultdict[Geometry | None, list[Task]] = defaultdict(list)
        for task in tasks:
            groups[task.geometry].append(task)
        free = groups.pop(None, [])
        known, unknown, cache = {}, {}, Cache(self.results)
        for geometry, members in groups.items():
            assert geometry is not None
            if (data := cache.get(geometry.key)) is not None:
                known[geometry.key] = (data, members)
            else:
                unknown[geometry.key] = (geometry, members)
        return known, unknown, free

    def _geometry_done(
        self,
        pool: schedule.Pool,
        outcome: Outcome,
        geometry: Geometry,
        waiting: list[Task],
        watch: Watch,
    ) -> list[Task]:
        """Keep coefficients and let their tasks go; without them, the tasks have failed too."""
        if isinstance(outcome.result, Failure):
            for task in waiting:
                self._keep(task, outcome)
                watch(task, outcome)
            return waiting
        Cache(self.results).put(geometry.key, outcome.result)
        self._release(pool, geometry.key, outcome.result, waiting)
        return []

    def _release(self, pool: schedule.Pool, key: str, data: bytes, waiting: list[Task]) -> None:
        shared = pool.share(f"hydrodynamics-{key}", data)
        for task in waiting:
            self._submit(pool, task, shared)

    def _submit(self, pool: schedule.Pool, task: Task, coefficients: Any) -> None:
        pool.submit(task, attempt_task, self.engine, task.id, task.parameters, coefficients)

    def _keep(self, task: Task, outcome: Outcome) -> bool:
        """Write what came of a task; whether it failed."""
        status: dict[str, Any] = {
            "wall_time": outcome.wall_time,
            "labels": dict(task.labels),
            "provenance": outcome.provenance,
            "command": self.command(task),
        }
        if isinstance(outcome.result, Failure):
            self.store.failed(task, status | {"error": asdict(outcome.result)})
            return True
        self.store.done(task, outcome.result, status | {"content": outcome.content})
        return False

    def command(self, task: Task) -> str:
        """What reproduces a task."""
        where = [] if self.results == Path("results") else ["--results", str(self.results)]
        return shlex.join(["study", "rerun", str(self.study), task.id, *where])


def unfinished(tasks: Sequence[Task], store: Store) -> list[tuple[Task, Entry]]:
    """What a run has to do: all but done tasks, stale ones (kept until asked for) and failed ones."""
    looked = ((task, store.look(task, checksums=True)) for task in tasks)
    return [(task, entry) for task, entry in looked if entry.state in ("missing", "damaged")]
