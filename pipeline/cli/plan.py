"""How long a run will take, from runs that were, or at rates of Buan's case."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict, deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from pipeline.bridge.cache import Cache
from pipeline.bridge.geometry import Geometry, bem_pace, bem_time, geometry_of
from pipeline.results.packs import lines
from pipeline.results.status import Status, parsed, read_status
from pipeline.results.store import Entry
from pipeline.tasks.task import Label, Task
from pipeline.terminal import about

SAMPLE = 200  # tasks of other studies looked at, of those in packs and of the others
KEPT = 10_000  # tasks of a kind whose times are known, the last ones
SOLUTIONS = 20  # whose times are reckoned; others take as long in the mean
# Of Buan, on the safe side, where nothing is known of this machine and study.
REAL_TIME = 3600  # simulated seconds in a second, elastic platform
SLOWER = 1600  # times as long takes the paper's own method
ANYWAY = 1000.0  # simulated seconds as long as which preparation and estimates take, of a task in the time domain
A_TASK = 0.01  # s in the frequency domain, however long the record

Kind = tuple[str, Label]  # method and platform


def _rates() -> deque[float]:
    """Wall times over `_work` [-], or of a task in the frequency domain [s]."""
    return deque(maxlen=KEPT)


@dataclass
class Estimate:
    """What is left to run and how fast such tasks ran, gathered as entries pass by."""

    left: int = 0  # tasks
    work: defaultdict[Kind, float] = field(default_factory=lambda: defaultdict(float))  # see _work
    usual: defaultdict[Kind, float] = field(default_factory=lambda: defaultdict(float))  # time at the rates above [s]
    geometries: set[Geometry] = field(default_factory=set)
    past: defaultdict[Kind, deque[float]] = field(default_factory=lambda: defaultdict(_rates))

    def see(self, task: Task, entry: Entry) -> None:
        """One more task of the study."""
        if entry.state in ("missing", "damaged"):
            parameters = task.parameters
            length = parameters.record.duration + parameters.record.discard
            kind, work = (parameters.solver.method, task.labels["platform"]), _work(parameters.solver.method, length)
            slower = SLOWER if parameters.solver.accuracy == "reference" else 1
            self.left += 1
            self.work[kind] += work
            frequency = parameters.solver.method == "frequency"
            self.usual[kind] += A_TASK if frequency else (slower * length + ANYWAY) / REAL_TIME
            geometry = geometry_of(parameters)
            if geometry and geometry.flow and not geometry.coefficients:  # else nothing is solved
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
            for status in _others(results):
                self._ran(status)
        methods = {method for method, _ in self.work}
        count = sum(len(rates) for (method, _), rates in self.past.items() if method in methods)
        usual = (
            f"{REAL_TIME} times real time and {ANYWAY / REAL_TIME:.1g} s a task"
            if "time" in methods
            else f"{1e3 * A_TASK:g} ms a task"
        )
        origin = f"from {count} {source}" if count else f"at {usual}, for there is no past run"
        time = f"{about(self._seconds() / workers)} on {workers} workers, {origin}"
        known = Cache(results)
        unknown = [one for one in self.geometries if known.get(one.key) is None]
        fresh = {one.radiating for one in unknown}
        bem = f" after {len(fresh)} boundary element solutions, {about(_effort(fresh) / workers)}" if fresh else ""
        if len(fresh) > 1 and len({one.model_copy(update={"band": None}) for one in fresh}) == 1:
            bem += f" ({_wide_band(unknown)} would make it one)"
        return f"to run: {self.left} tasks{bem}; {time}"

    def _ran(self, status: Status) -> None:
        method, length = status.parameters.solver.method, status.parameters.record.total
        self.past[method, status.labels.get("platform", "")].append(status.wall_time / _work(method, length))

    def _seconds(self) -> float:
        """By tasks of the same method and platform, or else by all of that method, or else as usual.

        Their median: what compiled first took a hundred times as long as others.
        """
        time = 0.0
        for kind, work in self.work.items():
            alike = itertools.chain(*(rates for known, rates in self.past.items() if known[0] == kind[0]))
            rates = self.past.get(kind) or list(alike)
            time += work * median(rates) if rates else self.usual[kind]
        return time


def _work(method: str, length: float) -> float:
    """What a task's time goes by: the length of its record [s] and what it takes whatever that is; in the frequency
    domain that there is one."""
    return 1.0 if method == "frequency" else length + ANYWAY


def _effort(fresh: Collection[Geometry]) -> float:
    """Time of solutions by one worker [s]."""
    some = [bem_time(one) for one in sorted(fresh, key=lambda one: one.key)[:SOLUTIONS]]
    return sum(some) / len(some) * len(fresh) * bem_pace()


def _wide_band(geometries: Collection[Geometry]) -> str:
    """The key that has the frequencies of all, rounded outwards, of geometries that differ in these."""
    lowest, highest = zip(*(one.band for one in geometries if one.band), strict=True)
    return f"waves.band = [{math.floor(1e3 * min(lowest)) / 1e3:g}, {math.ceil(1e3 * max(highest)) / 1e3:g}]"


def _others(results: Path) -> Iterator[Status]:
    alone = (read_status(path) for path in results.glob("*/tasks/*/status.json"))
    packed = (parsed(line) for path in results.glob("*/packs/*.jsonl") for line in lines(path))
    for statuses in (alone, packed):
        yield from itertools.islice((status for status in statuses if status.state == "done"), SAMPLE)
