"""What the solver says of a study before anything runs: its scenes are built once each."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from pipeline.bridge.axis_checks import MOST_NAMED
from pipeline.bridge.engine import Engine
from pipeline.bridge.objections import objections
from pipeline.bridge.sea_checks import of_sea
from pipeline.results.status import without_numbers
from pipeline.study.layout import HINGE
from pipeline.study.reading import StudyError
from pipeline.study.schema import StudyFile
from pipeline.study.seas import Components, Regular, Still, Waves
from pipeline.tasks.study import Study
from pipeline.tasks.task import Label, Parameters, Task

REDUCED = 8  # frames and designs at rest, of more
CALM = Still(kind="still")
# Sea states and seeds are judged from the file alone, each value along an axis over keys once.
CONFIGURATION = ("platform", "pto_damping", "hinge_spacing")


def judge(study: Study, tasks: Iterable[Task], engine: Engine) -> list[str]:
    """Raise StudyError in the solver's words, under the study file's keys; else tell what is odd and yet no error."""
    configurations = _Configurations([axis.name for axis in study.content.varied])
    seas: dict[object, Task] = {}
    still = {label for label, sea in study.content.seas.items() if isinstance(sea, Still)}
    for task in tasks:
        labels, sea = configurations.see(task), task.labels["sea_state"]
        seas.setdefault((sea, *(labels if sea in still else ())), task)  # which some methods are not for
    distinct = configurations.distinct
    platforms = {
        (task.labels["platform"], task.parameters.solver, _frame(task.parameters)): task for task in distinct.values()
    }
    odd: dict[str, set[str]] = {}
    every = {task.id: task for task in (*distinct.values(), *seas.values())}
    problems = [problem for task in every.values() for problem in _problems(_Listener(engine, task, odd), task)]
    # A frame takes 0.4 s to reduce, so with the same settings one stands for all places of hinges, and some for many.
    problems = problems or [problem for task in _some(platforms.values()) for problem in _problems(engine.reduce, task)]
    warnings = _told(study.content, every.values(), odd)
    if problems:
        told = [*problems, *(f"warning: {text}" for text in warnings)]  # which may be why
        raise StudyError(study.path, dict.fromkeys(told))
    return warnings


def designs(content: StudyFile, tasks: Iterable[Task]) -> list[Task]:
    """Tasks of which it is looked whether floats rest in still water: one for all that rest alike, of many some."""
    configurations = _Configurations([axis.name for axis in content.varied])
    for task in tasks:
        configurations.see(task)
    different: dict[str, Task] = {}
    for task in configurations.distinct.values():
        if task.parameters.floats:
            different.setdefault(_at_rest(task.parameters), task)
    return _some(different.values())


def restless(content: StudyFile, tasks: Sequence[Task], said: Iterable[str]) -> list[str]:
    """What is said of tasks, if anything, as warnings."""
    odd: dict[str, set[str]] = {}
    for task, text in zip(tasks, said, strict=True):
        if text:
            odd.setdefault(text, set()).add(task.id)
    return _told(content, tasks, odd)


def _at_rest(parameters: Parameters) -> str:
    """What decides where a task's floats rest: seas and dampers do not."""
    from solver.multibody.of_axes import DAMPERS  # numba comes along, and a run with nothing to do needs none

    bare = tuple(f.model_copy(update=dict.fromkeys(DAMPERS, 0.0)) for f in parameters.floats)
    calm = {"waves": Waves(heading=parameters.waves.heading), "sea_state": CALM, "seed": 0, "floats": bare}
    return parameters.model_copy(update=calm).canonical()


@dataclass
class _Configurations:
    """Tasks that are not judged by their sea states and seeds, as they pass by."""

    named: Sequence[str]  # axes over keys, of which each value counts once
    distinct: dict[tuple[object, ...], Task] = field(default_factory=dict)
    met: set[tuple[str, object]] = field(default_factory=set)

    def see(self, task: Task) -> set[tuple[str, object]]:
        """One more task; its labels along those axes."""
        place = tuple(task.labels.get(axis) for axis in CONFIGURATION)
        labels: set[tuple[str, object]] = {(name, task.labels[name]) for name in self.named}
        self.distinct.setdefault(place, task)
        if fresh := labels - self.met:
            self.distinct[place, *fresh] = task
            self.met |= fresh
        return labels


def _told(content: StudyFile, tasks: Collection[Task], odd: Mapping[str, set[str]]) -> list[str]:
    """Sentences, each said of some tasks, as their ids tell, with the labels that it is of."""
    return [f"{_where(content, tasks, said, text)}{text}" for text, said in _alike(odd).items()]


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


def _where(content: StudyFile, tasks: Iterable[Task], said: set[str], text: str) -> str:
    """The labels that a warning is of, along each axis where it is not of all, as the ids of its tasks tell.

    The first task with a label stands for it: its other labels are those of the first task of all.
    """
    paths = {axis.name: f'axes."{next(iter(axis.keys))}"' for axis in content.varied if axis.own}
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
