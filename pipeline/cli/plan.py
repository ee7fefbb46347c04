"""How long a run will take, from runs that were, or at the rates that README gives."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.bridge.cache import Cache
from pipeline.bridge.geometry import Geometry, bem_time, geometry_of
from pipeline.results.status import Status, read_status
from pipeline.results.store import Entry
from pipeline.tasks.task import Label, Task
from pipeline.terminal import about

SAMPLE = 200  # tasks of other studies looked at
SOLUTIONS = 20  # whose times are reckoned; others take as long in the mean
# Of Buan on one idle core, where nothing is known of this machine and study.
REAL_TIME = 3600  # simulated seconds in a second, elastic platform
SLOWER = 1600  # times as long takes the paper's own method


@dataclass
class Rate:
    """Wall time of a simulated second [-]."""

    total: float = 0.0
    tasks: int = 0

    def add(self, rate: float) -> None:
        """Take in the rate of one task [-]."""
        self.total, self.tasks = self.total + rate, self.tasks + 1

    @property
    def mean(self) -> float:
        """Mean over the tasks [-]; 0 without any."""
        return self.total / self.tasks if self.tasks else 0.0


@dataclass
class Estimate:
    """What is left to run and how fast such tasks ran, gathered as entries pass by."""

    left: int = 0  # tasks
    length: defaultdict[Label, float] = field(default_factory=lambda: defaultdict(float))  # of records, by platform [s]
    usual: float = 0.0  # time that they take at the rates above [s]
    geometries: set[Geometry] = field(default_factory=set)
    past: defaultdict[Label, Rate] = field(default_factory=lambda: defaultdict(Rate))

    def see(self, task: Task, entry: Entry) -> None:
        """One more task of the study."""
        if entry.state in ("missing", "damaged"):
            parameters, platform = task.parameters, task.labels["platform"]
            self.left += 1
            length = parameters.record.duration + parameters.record.discard
            self.length[platform] += length
            self.usual += length / REAL_TIME * (SLOWER if parameters.solver.accuracy == "reference" else 1)
            if (geometry := geometry_of(parameters)) and not geometry.coefficients:
                self.geometries.add(geometry)
        elif entry.state in ("done", "stale"):
            self._ran(entry.status)

    def words(self, results: Path, workers: int) -> str:
        """A sentence on the time that missing tasks will take; empty if nothing is missing."""
        if not self.left:
            return ""
        source = "tasks done"
        if not self.past:
            source = "tasks of other studies"
            for status in itertools.islice(_others(results), SAMPLE):
                self._ran(status)
        count = sum(rate.tasks for rate in self.past.values())
        origin = f"from {count} {source}" if count else f"at {REAL_TIME} times real time, for there is no past run"
        time = f"{about((self._seconds() if count else self.usual) / workers)} on {workers} workers, {origin}"
        fresh = {one.radiating for one in self.geometries if Cache(results).get(one.key) is None}
        bem = f" after {len(fresh)} boundary element solutions, {about(_effort(fresh) / workers)}" if fresh else ""
        return f"to run: {self.left} tasks{bem}; {time}"

    def _ran(self, status: Status) -> None:
        self.past[status.labels.get("platform", "")].add(status.wall_time / status.parameters.record.total)

    def _seconds(self) -> float:
        """By tasks with the same platform, or else by all."""
        every = Rate(sum(r.total for r in self.past.values()), sum(r.tasks for r in self.past.values()))
        return sum(length * self.past.get(platform, every).mean for platform, length in self.length.items())


def _effort(fresh: Collection[Geometry]) -> float:
    """Processor time of solutions [s]."""
    some = [bem_time(one) for one in sorted(fresh, key=lambda one: one.key)[:SOLUTIONS]]
    return sum(some) / len(some) * len(fresh)


def _others(results: Path) -> Iterator[Status]:
    for path in results.glob("*/tasks/*/status.json"):
        if (status := read_status(path)).state == "done":
            yield status
