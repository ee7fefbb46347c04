"""What the solver says of a study before anything runs: its scenes are built once each."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

from pipeline.bridge.checks import MOST_NAMED
from pipeline.bridge.engine import Engine
from pipeline.bridge.objections import objections
from pipeline.bridge.sea_checks import of_sea
from pipeline.results.status import without_numbers
from pipeline.study.layout import HINGE
from pipeline.study.reading import StudyError
from pipeline.study.seas import Components, Regular, Still
from pipeline.tasks.study import Study
from pipeline.tasks.task import Label, Parameters, Task

REDUCED = 8  # frames, of more
# Sea states and seeds are judged from the file alone, each value along an axis over keys once.
CONFIGURATION = ("platform", "pto_damping", "hinge_spacing")


def judge(study: Study, tasks: Iterable[Task], engine: Engine) -> list[str]:
    """Raise StudyError in the solver's words, under the study file's keys; else tell what is odd and yet no error."""
    distinct: dict[tuple[object, ...], Task] = {}
    seas: dict[object, Task] = {}
    still = {label for label, sea in study.content.seas.items() if isinstance(sea, Still)}
    named = [axis.name for axis in study.content.varied]
    met: set[tuple[str, object]] = set()
    for task in tasks:
        place, labels = tuple(task.labels.get(axis) for axis in CONFIGURATION), {(n, task.labels[n]) for n in named}
        if place not in distinct:
            distinct[place] = task
        if fresh := labels - met:
            distinct[place, *fresh] = task
            met |= fresh
        sea = task.labels["sea_state"]
        seas.setdefault((sea, *(labels if sea in still else ())), task)  # which some methods are not for
    platforms = {
        (task.labels["platform"], task.parameters.solver, _frame(task.parameters)): task for task in distinct.values()
    }
    odd: dict[str, set[str]] = {}
    every = {task.id: task for task in (*distinct.values(), *seas.values())}
    problems = [problem for task in every.values() for problem in _problems(_Listener(engine, task, odd), task)]
    # A frame takes 0.4 s to reduce, so with the same settings one stands for all places of hinges, and some for many.
    problems = problems or [problem for task in _some(platforms.values()) for problem in _problems(engine.reduce, task)]
    warnings = [f"{_where(study, every.values(), said, text)}{text}" for text, said in _alike(odd).items()]
    if problems:
        told = [*problems, *(f"warning: {text}" for text in warnings)]  # which may be why
        raise StudyError(study.path, dict.fromkeys(told))
    return warnings


def _some(tasks: Collection[Task]) -> list[Task]:
    """The first, the last, and as far apart between them: each task that runs looks at its own."""
    every, last = list(tasks), len(tasks) - 1
    return every if last < REDUCED else [every[i * last // (REDUCED - 1)] for i in range(REDUCED)]


def _alike(odd: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """Sentences that differ in numbers alone as the first of them, said of all their tasks."""
    alike: dict[str, tuple[str, list[set[str]]]] = {}
    for text, said in odd.items():
        alike.setdefault(without_numbers(text), (text, []))[1].append(said)
    return {
        text + f" (and {len(each) - 1} others that differ in numbers)" * (len(each) > 1): set().union(*each)
        for text, each in alike.values()
    }


def _frame(parameters: Parameters) -> str:
    """The table of the platform, wherever hinges are; empty without one."""
    if (table := parameters.platform) is None:
        return ""
    return table.model_dump_json(exclude={"nodes": {name for name in table.nodes if name.startswith(HINGE)}})


def _where(study: Study, tasks: Iterable[Task], said: set[str], text: str) -> str:
    """The labels that a warning is of, along each axis where it is not of all, as the ids of its tasks tell.

    The first task with a label stands for it: its other labels are those of the first task of all.
    """
    paths = {axis.name: f'axes."{next(iter(axis.keys))}"' for axis in study.content.varied if axis.own}
    named = {"seed", "sea_state"} if text.startswith("sea_states.") else {"seed"}  # already, or judged by one alone
    has: dict[str, dict[Label, bool]] = {}
    for task in tasks:
        for axis, label in task.labels.items():
            has.setdefault(axis, {}).setdefault(label, task.id in said)
    places = []
    for axis, holds in has.items():
        labels = [str(label) for label in holds if holds[label]]
        if axis not in named and 0 < len(labels) < len(holds):
            more = ["..."] * (len(labels) > MOST_NAMED)
            places.append(f"{paths.get(axis, axis)} = {', '.join([*labels[:MOST_NAMED], *more])}")
    return f"{', '.join(places)}: " if places else ""


@dataclass(frozen=True)
class _Listener:
    """What the engine says of a task; its warnings are kept under the study file's keys."""

    engine: Engine
    task: Task
    odd: dict[str, set[str]]  # by which tasks, as their ids tell

    def __call__(self, parameters: Parameters) -> None:
        for text in self.engine.judge(parameters) or ():
            first, colon, rest = text.partition(": ")
            told = f"sea_states.{self.task.labels['sea_state']}{colon}{rest}" if first == "sea" else text
            self.odd.setdefault(told, set()).add(self.task.id)


def _problems(judge: Callable[[Parameters], object], task: Task) -> Iterator[str]:
    given, sea = task.parameters, f"sea_states.{task.labels['sea_state']}"
    try:
        for error in objections(partial(judge, given)):
            own = given.waves.band is None or isinstance(given.sea_state, Regular | Components)
            yield str(of_sea(error, sea, given.sea_state) if own and error.key == "waves.band" else error)
    except Exception:
        # Not bad input: the task will meet it again, and its failure is recorded with all there is to know.
        return
