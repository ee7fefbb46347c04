"""Run tasks: coefficients once for each geometry, then every task, each result kept as it comes."""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from pipeline import environment
from pipeline.bridge import preflight
from pipeline.bridge.cache import Cache
from pipeline.bridge.engine import (
    Engine,
    Failure,
    Outcome,
    attempt_coefficients,
    attempt_share,
    attempt_statics,
    attempt_tasks,
)
from pipeline.bridge.geometry import BEM_VERSION, Geometry, bem_time, geometry_of, of_joints
from pipeline.results.packs import Row
from pipeline.results.store import UNFINISHED, Store
from pipeline.running import schedule
from pipeline.running.batches import AHEAD, Batch, Batches
from pipeline.running.place import Place
from pipeline.running.schedule import Lost
from pipeline.study.schema import StudyFile
from pipeline.tasks.task import Task, axes, digest
from pipeline.tasks.tasklist import Tasks


class Portion(NamedTuple):
    """How much of a long solution of boundary elements is there."""

    geometry: Geometry
    done: int
    of: int


Watch = Callable[[Task | Geometry | Portion, Outcome], None]
TOGETHER = 1000  # outcomes written at once, at most
SHARED = 15.0  # boundary elements that take longer are worth the start of workers [s]
LONG, SHARE = 60.0, 20.0  # those that take longer come in shares of so much processor time [s], each of them kept
MOST_SHARES, FEW = 32, 8  # of one solution; solutions that are asked how long they take


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """How and where the tasks of a study are run and kept."""

    study: Path
    results: Path
    store: Store
    engine: Engine
    place: Place = field(default_factory=Place)
    keep_going: bool = True
    say: Callable[[str], None] = print

    def run(self, tasks: Tasks, watch: Watch, broken: Sequence[Geometry] = ()) -> list[Task]:
        """Run and keep all; the tasks that failed. `watch` hears of every outcome.

        broken: geometries whose coefficients are made again, whether or not a task needs them.
        """
        tasks = tasks.unique
        failed: list[Task] = []
        with schedule.pool(self._work(tasks, broken), self.place, self.say) as pool:
            for task, outcome in _Run(self, tasks.study, pool, watch).outcomes(tasks, broken):
                if isinstance(outcome.result, Failure):
                    failed.append(task)
                    if not self.keep_going:
                        break
        return failed

    def _work(self, tasks: Tasks, broken: Sequence[Geometry]) -> int:
        """How many pieces it is: of few tasks boundary elements may be worth a share for each worker."""
        count = len(tasks) + len(broken)
        if count > schedule.SMALL:
            return count
        cache, needed = Cache(self.results), {geometry_of(task.parameters) for task in tasks}
        solved = (g for g in {*broken, *filter(None, needed)} if not g.coefficients)
        unknown = (g for g in solved if g in broken or cache.get(g.key) is None)
        return count if sum(map(bem_time, unknown)) < SHARED else max(count, schedule.SMALL + 1)

    def keep(self, outcomes: Sequence[tuple[Task, Outcome]]) -> None:
        """Write what came of tasks; a record that is whole stays where a second run has come to no end."""
        kept: list[tuple[Task, bytes | Row | None, dict[str, Any]]] = []
        for task, outcome in outcomes:
            status: dict[str, Any] = {
                "wall_time": outcome.wall_time,
                "labels": task.written_labels,
                "provenance": outcome.provenance,
                "command": self.command(task),
                "log": outcome.log,
            }
            if isinstance(outcome.result, Failure):
                if outcome.result.kind == Lost.__name__ and self.store.look(task, checksums=True).state == "done":
                    self.say(f"{task.id} {task}: {outcome.result.message}; its record stays as it was")
                    continue
                kept.append((task, None, status | {"error": asdict(outcome.result)}))
            else:
                told = {"content": outcome.content, "unmet": outcome.unmet, "warnings": outcome.warnings}
                kept.append((task, outcome.result, status | told))
        self.store.keep(kept)

    def command(self, task: Task) -> str:
        """The command that reproduces a task."""
        return self.store.command("rerun", self.study, task.id)


@dataclass(eq=False)
class _Solution:
    """Coefficients in the making, of geometries that differ in heading alone: first shares of them, then the whole."""

    geometries: list[Geometry]
    shares: list[Outcome | None]
    names: list[str] | None  # of the shares' files, where they are kept
    united: bool = False

    @property
    def seconds(self) -> float:
        """Time that the shares took, together [s]."""
        return sum(share.wall_time for share in self.shares if share)


@dataclass(eq=False)
class _Designs:
    """Tasks of which it is looked whether they rest in still water, beside the boundary elements they wait for."""

    tasks: list[Task]


@dataclass
class _Run:
    """One run of a campaign on an open pool."""

    campaign: Campaign
    study: StudyFile
    pool: schedule.Pool
    watch: Watch
    batches: Batches = field(default_factory=Batches)
    shares: deque[tuple[_Solution, int]] = field(default_factory=deque)  # that the pool does not have yet
    out: int = 0  # pieces of work that it has
    waiting: dict[Geometry, Tasks] = field(default_factory=dict)  # for their coefficients
    block: int = 1  # tasks one after another that differ in their joints alone

    def outcomes(self, tasks: Tasks, broken: Sequence[Geometry]) -> Iterator[tuple[Task, Outcome]]:
        """Every task with what came of it, kept."""
        self._start(tasks, broken)
        self._offer()
        for key, results in self.pool.finished():
            self.out -= 1
            arriving = self._arrived(key, results)
            while arrived := list(itertools.islice(arriving, TOGETHER)):
                self.campaign.keep(arrived)
                for task, outcome in arrived:
                    self.watch(task, outcome)
                    yield task, outcome
            self._offer()

    def _start(self, tasks: Tasks, broken: Sequence[Geometry]) -> None:
        """Coefficients that are not known go first; tasks that need none of those are ready."""
        cache, none = Cache(self.campaign.results), tasks.where(lambda _: False)
        table, joints = axes(tasks.study), of_joints(tasks.study)
        self.block = math.prod(len(values) for name, values in table.items() if name in joints)
        groups = dict.fromkeys(broken, none) | tasks.split(lambda task: geometry_of(task.parameters))
        for geometry, some in groups.items():
            members = some.fastest(joints)
            if geometry is None:
                self.batches.add(members, None, self.block)
            elif (data := cache.get(geometry.key)) is not None:
                self.batches.add(members, data, self.block)
            else:
                self.waiting[geometry] = members
        self._look()
        self._solve()

    def _look(self) -> None:
        """A piece of work like any other, for it may have to compile first, which tasks would do later."""
        solved = [some for geometry, some in self.waiting.items() if geometry.flow and not geometry.coefficients]
        if designs := preflight.designs(self.study, itertools.chain(*solved)):
            some = [task.parameters for task in designs]
            self._submit(_Designs(designs), attempt_statics, some)

    def _solve(self) -> None:
        """Each worker has a share of the frequencies of whatever radiates, or several; headings go along."""
        alike: dict[Geometry, list[Geometry]] = {}
        for geometry in self.waiting:
            alike.setdefault(geometry.radiating, []).append(geometry)
        for radiating, geometries in alike.items():
            count = 1 if radiating.coefficients else max(1, self.pool.width)
            effort = bem_time(radiating) if len(alike) <= FEW and not radiating.coefficients else 0.0
            solution = _Solution(geometries, [None] * count, None)
            if effort > LONG:
                count = max(count, min(math.ceil(effort / SHARE), MOST_SHARES))
                solution = self._kept(geometries, count)
            self.shares.extend((solution, n) for n, share in enumerate(solution.shares) if share is None)
            self._unite(solution)
        self._share_out()

    def _share_out(self) -> None:
        """One share waits for the next worker that is free, and no more: what comes of the others goes before them."""
        while self.shares and self.out <= self.pool.width:
            solution, n = self.shares.popleft()
            self._submit((solution, n), attempt_share, solution.geometries, n, len(solution.shares))

    def _kept(self, geometries: list[Geometry], count: int) -> _Solution:
        """With the shares that a run before this one left."""
        whole = digest(" ".join(geometry.key for geometry in geometries), BEM_VERSION)
        names = [f"{whole}-{n}-of-{count}" for n in range(count)]
        kept, provenance = map(Cache(self.campaign.results).share, names), environment.provenance()
        return _Solution(
            geometries, [Outcome(result=one, provenance=provenance) if one else None for one in kept], names
        )

    def _offer(self) -> None:
        """Keep as much on offer as keeps the pool busy, tasks first; the rest stays here, where it costs little."""
        while self.batches and self.out < max(1, AHEAD * self.pool.width):
            batch = self.batches.take(self.pool.width)
            pairs = [(task.id, task.parameters) for task in batch.tasks]
            self._submit(batch, attempt_tasks, pairs, batch.coefficients)
        self._share_out()

    def _submit(self, key: Hashable, attempt: Callable[..., list[Outcome]], *args: Any) -> None:
        self.pool.submit(key, attempt, self.campaign.engine, *args)
        self.out += 1

    def _arrived(self, key: Hashable, results: list[Outcome] | Lost) -> Iterator[tuple[Task, Outcome]]:
        """Outcomes of tasks. A lost batch is tried once more, task by task; a lost task has failed."""
        if isinstance(key, tuple):
            solution, n = key
            yield from self._share_arrived(solution, n, _outcome(results))
        elif isinstance(key, _Solution):
            outcomes = [_outcome(results)] * len(key.geometries) if isinstance(results, Lost) else results
            yield from self._solved(key, outcomes)
            if key.names and not isinstance(results, Lost):  # nor are they good for a second time if the whole failed
                Cache(self.campaign.results).drop_shares(key.names)
        elif isinstance(key, _Designs) and not isinstance(results, Lost):
            for text in preflight.restless(self.study, key.tasks, [outcome.warnings for outcome in results]):
                self.campaign.say(f"{self.campaign.study}: warning: {text}")
        elif isinstance(key, Batch):
            if isinstance(results, Lost) and len(key.tasks) > 1:
                self.batches.add_alone(key)
                return
            outcomes = [_outcome(results)] if isinstance(results, Lost) else results
            for task, outcome in zip(key.tasks, outcomes, strict=True):
                self.batches.heard(outcome.wall_time)
                yield task, outcome

    def _share_arrived(self, solution: _Solution, n: int, outcome: Outcome) -> Iterator[tuple[Task, Outcome]]:
        """With the last share, the whole can be made; without one of them, the tasks have failed too."""
        solution.shares[n] = outcome
        if solution.united:
            return
        if isinstance(outcome.result, Failure):
            solution.united = True
            yield from self._solved(solution, [outcome] * len(solution.geometries))
            return
        if solution.names and isinstance(outcome.result, bytes):
            Cache(self.campaign.results).put_share(solution.names[n], outcome.result)
            done = sum(share is not None for share in solution.shares)
            self.watch(Portion(solution.geometries[0], done, len(solution.shares)), outcome)
        self._unite(solution)

    def _unite(self, solution: _Solution) -> None:
        """Once all shares are there."""
        if all(solution.shares):
            solution.united = True
            parts = [share.result for share in solution.shares if share]
            self._submit(solution, attempt_coefficients, solution.geometries, parts)

    def _solved(self, solution: _Solution, outcomes: Sequence[Outcome]) -> Iterator[tuple[Task, Outcome]]:
        """Keep coefficients and let their tasks go; without them, the tasks have failed too."""
        each = (outcomes[0].wall_time + solution.seconds) / len(outcomes)  # headings are solved for together
        for geometry, outcome in zip(solution.geometries, outcomes, strict=True):
            tasks = self.waiting.pop(geometry)
            self.watch(geometry, replace(outcome, wall_time=each))
            if isinstance(outcome.result, Failure):
                yield from ((task, outcome) for task in tasks)
            elif isinstance(outcome.result, bytes):
                Cache(self.campaign.results).put(geometry.key, outcome.result)
                self.batches.add(tasks, outcome.result, self.block)


def _outcome(results: list[Outcome] | Lost) -> Outcome:
    """The only one; lost work is a failure."""
    if isinstance(results, Lost):
        return Outcome(result=Failure.of(results), provenance=environment.provenance())
    return results[0]


def unfinished(tasks: Tasks, store: Store) -> Tasks:
    """What a run has to do."""
    return tasks.where(lambda task: store.look(task, checksums=True).state in UNFINISHED)


def broken(tasks: Tasks, results: Path) -> list[Geometry]:
    """The geometries whose coefficients are there and damaged; no task is made to find that there are none."""
    damaged = Cache(results).damaged()
    groups = tasks.split(lambda task: geometry_of(task.parameters)) if damaged else {}
    return [geometry for geometry in groups if geometry and geometry.key in damaged]
