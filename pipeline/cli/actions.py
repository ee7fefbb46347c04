"""What the verbs of the command line do when they have read their words."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline import environment
from pipeline.bridge.geometry import Geometry
from pipeline.cli.console import DONE, FAILED, Tally, compare, finish, looked, say
from pipeline.results.netcdf import Variable, to_file
from pipeline.results.status import read_json
from pipeline.results.store import UNFINISHED, Store, appearing, sha256, write_json
from pipeline.running.place import Place
from pipeline.study.reading import StudyError
from pipeline.study.schema import StudyFile
from pipeline.study.settings import Recording
from pipeline.tasks.study import Study
from pipeline.tasks.task import Parameters, Task
from pipeline.tasks.tasklist import Tasks
from pipeline.terminal import err, out

if TYPE_CHECKING:
    import numpy as np

SHOWN, FRAMES = 30.0, 2000  # of a moving picture: usual length [s], and most frames
FEWEST = 8  # frames of a wave's period, where it is not said how fast time goes
# Of a joint, keys by which its law bends or jumps.
BENT = {
    "coulomb", "declutch_load", "end_stops", "force_limit", "latch_load", "one_way", "pto_law", "pto_table",
}  # fmt: skip
REPORTED = 1000  # tasks up to which the report comes by itself: its figures take 3 s, and longer with more dots


def preflight(study: Study, tasks: Tasks) -> list[str]:
    """The solver's objections and warnings, before anything runs, and those to published numbers, not hours later.

    What was told.
    """
    from pipeline.bridge.engine import Engine
    from pipeline.bridge.preflight import judge

    if study.published:
        from pipeline.report.published import read_published

        read_published(study.published)
    told = judge(study, tasks.passing(), Engine())
    for text in told:
        say(f"{study.path}: warning: {text}", err)
    return told


def look_at_rest(study: Study, tasks: Tasks) -> None:
    """Whether floats rest in still water, which a run looks at beside its boundary elements."""
    from pipeline.bridge.engine import Engine, attempt_statics
    from pipeline.bridge.preflight import designs, restless

    some, engine = designs(study.content, tasks.passing()), Engine()
    if some and not environment.statics_compiled():
        say("compiling the solver's statics: about a minute, once for each state of its sources", err)
    outcomes = attempt_statics(engine, [task.parameters for task in some])
    for text in restless(study.content, some, [outcome.warnings for outcome in outcomes]):
        say(f"{study.path}: warning: {text}", err)


def tell_of_compiler(content: StudyFile) -> None:
    """Where the study's marches, which its keys tell of, are yet to be compiled: a run is silent meanwhile."""
    varied = {part for axis in content.varied for path in axis.keys for part in path.split(".")}
    bends = bool(BENT & varied.union(*(item.model_fields_set for item in content.floats)))
    if (content.solver.method == "time" or "method" in varied) and not environment.compiled(bends):
        laws = " and, apart, for joints' laws that bend" if bends else ""
        say(f"compiling the solver: about a minute, once for each state of its sources{laws}", err)


def make_ready(study: Study, tasks: Tasks, store: Store, place: Place) -> list[str]:
    """If there is something to run, have workers begin to start while the solver looks at the study; its warnings."""
    from pipeline.running.schedule import warm_up

    todo = tasks.where(lambda task: store.look(task).state in UNFINISHED)
    if not todo:
        return []
    warm_up(len(todo), place)
    tell_of_compiler(study.content)
    return preflight(study, todo)


def run(
    study: Study,
    store: Store,
    results: Path,
    tasks: Tasks,
    place: Place,
    *,
    keep_going: bool = True,
    broken: Sequence[Geometry] = (),
) -> list[Task]:
    """Run tasks, with a bar or lines about it; and make broken coefficients again. Those that failed."""
    from pipeline.bridge.engine import Engine
    from pipeline.cli.progress import watching
    from pipeline.running.campaign import Campaign

    campaign = Campaign(
        study=study.path,
        results=results,
        store=store,
        engine=Engine(),
        place=place,
        keep_going=keep_going,
        say=lambda text: say(text, err),
    )
    with watching(err if err.is_terminal else out, len(tasks)) as watch:
        return campaign.run(tasks, watch, broken)


def rerun(study: Study, store: Store, results: Path, tasks: Tasks, place: Place) -> int:
    """Run tasks again and compare; the exit status."""
    tell_of_compiler(study.content)
    with store.lock(lambda text: say(text, err)):
        old = {task.id: _record(store, task) for task in tasks}
        failed = {task.id for task in run(study, store, results, tasks, place)}
        # A record that stayed, for its second run came to no end, is not to be taken for a second one.
        new = {task.id: None if task.id in failed else _record(store, task) for task in tasks}
        changed = [not compare(task, old[task.id], new[task.id]) for task in tasks]
        refresh(study, store)
    return max(finish(Tally.of(looked(tasks, store)), study, store), FAILED if any(changed) or failed else DONE)


def _record(store: Store, task: Task) -> Mapping[str, Variable] | None:
    entry = store.look(task, checksums=True)
    return entry.made()[0] if entry.state == "done" else None


def refresh(study: Study, store: Store) -> list[Path]:
    """The dataset and, of a study that is not large, the report; each is written only if its sources are others."""
    from pipeline.results import dataset

    path = dataset.current(study, store)
    return [path] if len(study.tasks.unique) > REPORTED else [path, draw(study, path)]


def tell_of_older(path: Path) -> None:
    """Name what has been made of the dataset at `path` as it was before, and is not renewed by `run`."""
    made, beside = path.stat().st_mtime_ns, [path.with_name("answers.nc"), *sorted(path.parent.glob("figures/*"))]
    older = [str(file.relative_to(path.parent)) for file in beside if file.is_file() and file.stat().st_mtime_ns < made]
    if older:
        say(f"{path.parent}: made of an earlier {path.name}: {', '.join(older)}", err)


def draw(study: Study, path: Path) -> Path:
    """The report beside the dataset at `path`, written only if its sources are others."""
    page, mark, source = path.with_name("report.html"), path.with_name(".report.json"), {"of": _drawn_from(study, path)}
    if read_json(mark) != source or not page.is_file():
        from pipeline.report.page import write

        write(study, path)
        write_json(mark, source)
    return page


def print_table(study: Study, path: Path) -> None:
    """Ours beside the published numbers, or a summary; drawn again only if its sources are others."""
    kept, source = path.with_name(".table.json"), [_drawn_from(study, path), out.width, out.color_system]
    known = read_json(kept) or {}
    if known.get("of") != source or not isinstance(known.get("text"), str):
        known = {"of": source, "text": _table(study, path)}
        with contextlib.suppress(OSError):  # it saves time alone, and the folder may be for reading only
            write_json(kept, known)
    print(known["text"], end="", file=out.file)


def animate(study: Study, store: Store, results: Path, task: Task, asked: Filming) -> Path:
    """Write a task's moving picture beside the study's dataset; StudyError for what cannot be shown."""
    from pipeline.bridge.cache import Cache
    from pipeline.bridge.geometry import geometry_of
    from pipeline.bridge.objections import objections
    from pipeline.bridge.replay import replay, require_history
    from pipeline.cli.progress import share
    from pipeline.report import animation
    from pipeline.tasks.task import cell

    scene = task.parameters
    if problems := [str(error) for error in objections(lambda: require_history(scene))]:
        raise StudyError(study.path, problems)
    times, pause = asked.times(study.path, scene.record, _period(scene))
    coefficients, geometry = None, geometry_of(scene)
    if geometry and (coefficients := (cache := Cache(results)).get(geometry.key)) is None:
        again = store.command("run", study.path)
        raise StudyError(study.path, [f"{cache.path(geometry.key)}: not there yet; `{again}` makes it"])
    tell_of_compiler(study.content)
    with share(err, "marching") as told:
        film = replay(scene, coefficients, times, told, magnify=asked.magnify)
    # A platform that does not move is drawn, too.
    platform = cell(study.content, {**task.labels, "platform": "elastic"}, ()).parameters.platform
    path = store.root / f"animation-{task.id}.gif"
    path.parent.mkdir(parents=True, exist_ok=True)
    with share(err, "drawing") as told:
        drawn = scene.model_copy(update={"platform": platform})
        animation.write(path, drawn, film, f"{study.name}: {task}".removesuffix(": ").replace(",", ", "), pause, told)
    return path


def _period(scene: Parameters) -> float:
    """Of the waves' peak or the one wave, else the shortest that there is [s]; infinite in still water."""
    from pipeline.study import seas

    known = seas.labels(scene.sea_state, scene.waves)
    span = seas.frequencies(scene.sea_state, scene.waves)
    return known.get("Tp") or known.get("wave_period") or (2 * math.pi / span[1] if span else math.inf)


@dataclass(frozen=True, kw_only=True)
class Filming:
    """What a moving picture is to show: from when, how much, how fast; None: of the record's start what it has, as fast
    as time goes or as waves are seen to pass."""

    start: float | None
    seconds: float | None
    speed: float | None
    fps: float
    magnify: float

    def times(self, file: Path, record: Recording, period: float = math.inf) -> tuple[np.ndarray, int]:
        """Of its frames (n,) [s], and how long each of them stays [ms]; StudyError for what is out of range. period: of
        the waves [s]."""
        import numpy as np

        pause = 10 * round(100 / max(1.0, min(50.0, self.fps)))  # GIFs count hundredths of a second
        usual = min(1.0, 1000 * period / FEWEST / pause)
        speed = usual if self.speed is None else self.speed
        end = record.discard + record.duration
        start = record.discard if self.start is None else self.start
        seconds = min(SHOWN * (usual if self.speed is None else 1.0), end - start)
        seconds = seconds if self.seconds is None else self.seconds
        limits = (
            ("--from", start, 0.0, end, " s"),
            ("--seconds", seconds, 0.0, end - start, " s"),
            ("--speed", 1.0 if self.speed is None else speed, 0.01, 1000.0, ""),
            ("--fps", self.fps, 1.0, 50.0, ""),
            ("--magnify", self.magnify, 0.0, 1e6, ""),
        )
        for option, value, low, high, unit in limits:
            if not low <= value <= high:
                raise StudyError(file, [f"{option} = {value:g}{unit}: must be within {low:g} to {high:g}{unit}"])
        count = int(seconds / (step := speed * pause / 1000) + 1e-9) + 1
        if count > FRAMES:
            limit = f"would make {count} frames: must be at most {FRAMES}; fewer fps or more --speed"
            raise StudyError(file, [f"--seconds = {seconds:g} s: {limit}"])
        return start + step * np.arange(count), pause


def answer(study: Study, path: Path, between: str) -> tuple[Path, str]:
    """Print the answers of the dataset at `path`, and write them beside it; how many tasks are in which state."""
    from pipeline.report import answers, report
    from pipeline.report.tables import show
    from pipeline.results import dataset

    with dataset.opened(path) as data:
        try:
            pair = answers.pair_of(data, between)
        except ValueError as error:
            raise StudyError(study.path, [f"--between = {between}: {error}"]) from None
        written = path.with_name("answers.nc")
        for table in report.answers(data):
            show(table, out)
        show(differences := answers.table(found := answers.answers(data, pair)), out, written.name)
        if between and not differences.lines:
            say(f"--between = {between}: no differences, which need a realization in common in every sea state")
        with appearing(written) as part:
            to_file(part, answers.variables(found), found.attrs)
    return written, found.attrs["tasks"]


def _table(study: Study, path: Path) -> str:
    from pipeline.report import report
    from pipeline.report.published import read_published
    from pipeline.report.tables import show
    from pipeline.results import dataset

    with dataset.opened(path) as data, out.capture() as drawn:
        rows = read_published(study.published) if study.published else []
        if rows:
            report.print_tables(data, rows, out, study=study.content)
        if not report.speaks(data, rows):
            report.print_summary(data, out)
        if error := report.estimated(data):
            text = f"Estimated error of any mean, rms or std: {error}"
            out.print(text, soft_wrap=True, highlight=False, markup=False)
        for table in report.answers(data):
            show(table, out)
    return drawn.get()


def _drawn_from(study: Study, path: Path) -> str:
    """Digest of all that table and report show: numbers, ours and published, the study, and the code that draws."""
    from pipeline.results import dataset

    files = [dataset.checksum(file) for file in (path, study.published) if file]
    words = [environment.sources("pipeline"), study.content.model_dump_json(), *files]
    return sha256("\0".join(words).encode())
