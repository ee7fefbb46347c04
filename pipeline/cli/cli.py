"""The command line: study new|keys|outputs|schema, and those of a study: plan, run, status, show, rerun and so on."""

from __future__ import annotations

import io
import json
import shlex
import sys
import time
from collections import Counter
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Literal

import typer

from pipeline import environment, interrupt
from pipeline.bridge.geometry import BEM_VERSION
from pipeline.bridge.loading import load
from pipeline.cli import actions, starters
from pipeline.cli.console import DONE, FAILED, Tally, finish, looked, say, store_of
from pipeline.cli.starters import Kind
from pipeline.results.status import read_status
from pipeline.results.store import Store, leftovers, remove
from pipeline.study.reading import COEFFICIENTS, StudyError
from pipeline.tasks.select import find, select
from pipeline.tasks.study import Study
from pipeline.tasks.task import MODEL_VERSION
from pipeline.tasks.tasklist import Tasks
from pipeline.terminal import err, out
from solver.errors import InputError, SimulationFailed

app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

StudyPath = Annotated[Path, typer.Argument(metavar="STUDY", help="A study file, such as studies/buan.toml")]
ResultsFolder = Annotated[Path, typer.Option(help="Folder of results")]
Select = Annotated[str, typer.Option("--select", help="Part of the study: platform=fixed,sea_state=2018,seed=0")]
Workers = Annotated[int, typer.Option(min=1, max=1024, help="Worker processes")]
Scheduler = Annotated[str | None, typer.Option(metavar="ADDRESS", help="A running dask scheduler's")]
KeepGoing = Annotated[bool, typer.Option("--keep-going/--fail-fast", help="Go on after a failed task, or stop")]
Timeout = Annotated[float | None, typer.Option(min=1e-3, max=1e7, metavar="SECONDS", help="Longest time of one task")]
Memory = Annotated[str, typer.Option(help="Limit of one worker, such as 2GB; auto: its share of the machine's")]
Tls = Annotated[
    tuple[Path, Path, Path] | None,
    typer.Option("--tls", metavar="CA CERT KEY", help="PEM files for a tls:// scheduler"),
]
Words = Annotated[list[str] | None, typer.Argument(metavar="TASK...", help="Ids, their beginnings, or labels")]

BAD_INPUT = 2
STATUSES = "Exit status: 0 all done, 1 a task failed or the machine did, 2 bad input, "
RESULTS = Path("results")
SHOWN = ("finished", "wall_time", "command", "sha256", "provenance", "unmet", "warnings")  # of a task's status


def main() -> None:
    """Exit status 0 done, 1 a task failed or the machine did, 2 bad input."""
    environment.prepare()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a locale may lack the letters of a title
    try:
        app()
    except StudyError as error:
        for problem in error.problems:
            say(problem, err)
        sys.exit(BAD_INPUT)
    except InputError as error:
        say(str(error), err)
        sys.exit(BAD_INPUT)
    except BrokenPipeError:
        sys.stderr.close()  # nobody listens any more
        sys.exit(FAILED)
    except OSError as error:
        what = f"{error.filename}: {error.strerror}" if error.filename else str(error)
        goes_on = f"; {interrupt.KEPT} once that is mended" if sys.argv[1:2] in (["run"], ["rerun"]) else ""
        say(f"{what}{goes_on}", err)
        sys.exit(FAILED)


def _print_version(asked: bool) -> None:
    if asked:
        say(f"study {environment.release()}, model version {MODEL_VERSION}, BEM version {BEM_VERSION}")
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Of program, model and coefficients")
]


@app.callback()
def options(
    version: Version = False,
) -> None:
    """Coupled wave energy converters and platforms: what a study file describes, run, kept and reported."""


@app.command(epilog="Exit status: 0 done, 2 bad input.")
def plan(study_file: StudyPath, results: ResultsFolder = RESULTS, select_: Select = "", workers: Workers = 2) -> None:
    """What a run would do, and about how long it would take."""
    from pipeline.cli.plan import Estimate

    study, tasks, store = _open(study_file, results, select_)
    actions.preflight(study, tasks)
    actions.look_at_rest(study, tasks)
    tally, estimate = Tally(), Estimate()
    for task in tasks:
        entry = store.look(task)
        say(f"{task.id} {entry.state:7} {task}")
        tally.see(task, entry)
        estimate.see(task, entry)
    say(str(tally))
    if words := estimate.words(results, workers):
        say(words)


@app.command(epilog=f"{STATUSES}130 interrupted; finished tasks are kept and not run again.")
def run(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    select_: Select = "",
    workers: Workers = 2,
    scheduler: Scheduler = None,
    keep_going: KeepGoing = True,
    timeout: Timeout = None,
    memory: Memory = "auto",
    tls: Tls = None,
) -> None:
    """Run what is missing, collect, print the table, and write the report of up to 1,000 tasks."""
    from pipeline.running.campaign import broken, unfinished
    from pipeline.running.place import Place, require_place

    place = Place(workers=workers, scheduler=scheduler, timeout=timeout, memory=memory, tls=tls)
    require_place(place)
    study, tasks, store = _open(study_file, results, select_)
    told = actions.make_ready(study, tasks, store, place)
    with store.lock(lambda text: say(text, err)):
        todo, again = unfinished(tasks, store), broken(tasks, results)
        if todo or again:
            actions.run(study, store, results, todo, place, keep_going=keep_going, broken=again)
        paths = actions.refresh(study, store)
    tally = Tally.of(looked(tasks, store), told)
    actions.print_table(study, paths[0])
    missing = tally.counts["missing"]
    what = [f"{max(len(todo) - missing, 0)} run now" if todo else "nothing to run"]
    if len(tasks.unique) < (whole := len(study.tasks.unique)):
        collected = Tally.of(looked(study.tasks.unique, store)).counts["done"]
        what.append(f"table of all {collected} that are done of the study's {whole}")
    say("; ".join([str(tally), *what, *map(str, paths)]))
    actions.tell_of_older(paths[0])
    code = finish(tally, study, store)
    if missing and code == DONE:
        say(f"{missing} records are not where runs put them: was {store.root} moved or emptied meanwhile?", err)
    raise typer.Exit(FAILED if missing else code)


@app.command()
def status(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    as_json: Annotated[bool, typer.Option("--json", help="For programs")] = False,
    watch: Annotated[bool, typer.Option("--watch", help="Until nothing is missing")] = False,
    every: Annotated[float, typer.Option(min=0.1, metavar="SECONDS", help="Pause of --watch")] = 2.0,
) -> None:
    """How far a study is, from files alone; exit status 0 done or stale, 1 failed, 2 incomplete."""
    study, tasks, store = _open(study_file, results)
    last = ""
    while True:
        text, tally = _status(study, tasks, store, as_json=as_json)
        if text != last:
            say(last := text)
        if not watch or not (tally.counts["missing"] or tally.counts["damaged"]):
            raise typer.Exit(tally.code)
        interrupt.check()
        time.sleep(every)


def _status(study: Study, tasks: Tasks, store: Store, *, as_json: bool) -> tuple[str, Tally]:
    tally, rows = Tally(), []
    for task, entry in looked(tasks, store):
        tally.see(task, entry)
        if as_json:
            notes = {"unmet": entry.unmet, "warnings": entry.warnings}
            row = {"id": task.id, "state": entry.state, "labels": task.written_labels, **notes}
            rows.append(json.dumps(row))
    holder = store.at_work()
    if as_json:
        head = json.dumps({"study": study.name, "holder": holder})[:-1]
        return f'{head}, "tasks": [\n' + ",\n".join(rows) + "\n]}", tally
    return str(tally) + (f"; in the hands of {holder}" if holder else ""), tally


def _open(study_file: Path, results: Path, selection: str = "") -> tuple[Study, Tasks, Store]:
    """A study, its tasks or those selected, and where its results are."""
    study = load(study_file)
    return study, select(study, selection), store_of(study, results)


@app.command()
def show(study_file: StudyPath, task: Annotated[str, typer.Argument()], results: ResultsFolder = RESULTS) -> None:
    """One task: labels, state, parameters, warnings, error, and the command that repeats it."""
    study, tasks, store = _open(study_file, results)
    chosen = find(study, [task])
    for match in tasks.where(lambda one: one.id in chosen):
        entry = store.look(match, checksums=True)
        say(f"{match.id} {entry.state} {match}")
        for key in SHOWN:
            if key in entry.status.model_fields_set:
                value = getattr(entry.status, key)
                say(f"{key}: {f'{value:.3g} s' if key == 'wall_time' and value is not None else value}")
        for line in entry.status.log:
            say(f"log: {line}")
        say(json.dumps(json.loads(match.parameters.canonical()), indent=1))
        if error := entry.status.error:
            say(error.traceback or error.message)


@app.command(epilog=f"{STATUSES}130 interrupted. A task whose record differs from the old one counts as failed.")
def rerun(
    study_file: StudyPath,
    words: Words = None,
    failed: Annotated[bool, typer.Option("--failed", help="All that failed")] = False,
    stale: Annotated[bool, typer.Option("--stale", help="All of an older model version")] = False,
    select_: Select = "",
    results: ResultsFolder = RESULTS,
    workers: Workers = 2,
    scheduler: Scheduler = None,
    timeout: Timeout = None,
    memory: Memory = "auto",
    tls: Tls = None,
) -> None:
    """Run tasks again, and compare with the old records bit for bit."""
    from pipeline.running.place import Place, require_place

    place = Place(workers=workers, scheduler=scheduler, timeout=timeout, memory=memory, tls=tls)
    require_place(place)
    study, every, store = _open(study_file, results)
    named = find(study, words or []) | ({task.id for task in select(study, select_)} if select_ else set())
    states = {state for state, asked in {"failed": failed, "stale": stale}.items() if asked}
    chosen = every.where(lambda task: task.id in named or (bool(states) and store.look(task).state in states))
    if not chosen and not (failed or stale):
        raise StudyError(study.path, ["rerun: name a TASK, or --failed, --stale or --select"])
    if not chosen:
        say("nothing to rerun")
        return
    # Of a task that has run, its own run says all that can be said.
    actions.preflight(study, chosen.where(lambda task: store.look(task).state != "done"))
    raise typer.Exit(actions.rerun(study, store, results, chosen, place))


@app.command()
def new(
    name: Annotated[Path, typer.Argument(metavar="NAME", help="Of the study, and of its file NAME.toml")],
    like: Annotated[Kind, typer.Option(help="What it is to be like")] = "sphere",
) -> None:
    """Write a study file to start from, with comments, which runs as it is."""
    path = name if name.suffix == ".toml" else name.with_name(f"{name.name}.toml")
    for made in starters.write(path, like):
        say(f"written: {made}")
    say(
        f"`{shlex.join(['study', 'plan', str(path)])}` says what would run; `study keys` what else a study file may say"
    )


@app.command()
def keys(word: Annotated[str, typer.Argument(metavar="[WORD]", help="In a path, values or meaning")] = "") -> None:
    """What a study file may say: every key's path, unit, default, values and meaning, or of those with a WORD."""
    from pipeline.cli import reference

    reference.print_keys(word, out)


@app.command()
def outputs(word: Annotated[str, typer.Argument(metavar="[WORD]", help="In a name or meaning")] = "") -> None:
    """What datasets may have: every output's name, unit and meaning, or of those with a WORD."""
    from pipeline.cli import reference

    reference.print_outputs(word, out)


@app.command()
def schema() -> None:
    """The same as JSON Schema, with which editors complete and check study files."""
    from pipeline.study.reference import json_schema

    say(json.dumps(json_schema(), indent=1, ensure_ascii=False, allow_nan=False))


@app.command()
def collect(study_file: StudyPath, results: ResultsFolder = RESULTS) -> None:
    """Write results/<study>/statistics.nc from whatever is there."""
    from pipeline.results.dataset import collect as write_dataset

    study, _, store = _open(study_file, results)
    path, counts = write_dataset(study, store)
    say(f"{path}: {_counted(counts)}")


def _counted(counts: dict[str, int]) -> str:
    return ", ".join(f"{n} {state}" for state, n in counts.items())


@app.command()
def report(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    figure: Annotated[
        Path | None, typer.Option(metavar="PNG", dir_okay=False, help="Write the summary as one figure, too")
    ] = None,
    best: Annotated[
        int | None,
        typer.Option("--best", min=1, metavar="N", help="Print a study's lines with the N best designs"),
    ] = None,
) -> None:
    """Print our numbers beside the published ones, and write results/<study>/report.html."""
    from pipeline.report import page, ranking
    from pipeline.results import dataset

    study = load(study_file)
    if figure and figure.suffix.lower() != ".png":
        raise StudyError(study.path, [f"--figure = {figure}: must end with .png, the one format it has"])
    path = _up_to_date(study, results)
    actions.print_table(study, path)
    if best:
        with dataset.opened(path) as data:
            say(ranking.block(study.content, data, best) or "no designs to choose from")
    if figure:
        page.write_figure(study, path, figure)
    try:
        drawn = actions.draw(study, path)
    except OSError as error:  # a folder for reading only, say, of whose results the table has told
        say(f"{study.path}: warning: the page cannot be written: {error.filename}: {error.strerror}", err)
    else:
        say(str(drawn))


def _up_to_date(study: Study, results: Path) -> Path:
    """The dataset's path, where there is anything; collected again if need be."""
    from pipeline.results import dataset

    store = store_of(study, results)
    path = store.root / "statistics.nc"
    if not (path.exists() or store.begun()):
        raise StudyError(study.path, [f"{path}: not there yet; `{store.command('run', study.path)}` makes it"])
    if why := dataset.outdated(study, store):
        _, counts = dataset.collect(study, store)
        say(f"{path}: {why}, and is collected again: {_counted(counts)}", err)
    return path


@app.command()
def answers(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    between: Annotated[
        str,
        typer.Option(
            "--between",
            metavar="AXIS=A,B",
            help="Two designs of which differences are told, A less B; left out, those of an axis that alone has two",
        ),
    ] = "",
) -> None:
    """Print what a study is for, and write results/<study>/answers.nc: energy, life, differences, with intervals."""
    study = load(study_file)
    path = _up_to_date(study, results)
    written, states = actions.answer(study, path, between)
    say(f"{written}: {states}")


@app.command()
def figures(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    form: Annotated[Literal["svg", "png", "pdf"], typer.Option("--format", help="Of the files")] = "svg",
) -> None:
    """Write each of the report's figures by itself to results/<study>/figures."""
    from pipeline.report import page

    study = load(study_file)
    path = _up_to_date(study, results)
    for file in page.write_figures(study, path, form):
        say(str(file))
    actions.tell_of_older(path)


@app.command(epilog="Exit status: 0 done, 1 the task fails, 2 bad input.")
def animate(
    study_file: StudyPath,
    task: Annotated[str, typer.Argument(help="Its id, the beginning of it, or labels")],
    results: ResultsFolder = RESULTS,
    start: Annotated[float | None, typer.Option("--from", help="Of the task [s]; left out: of its record")] = None,
    seconds: Annotated[float | None, typer.Option(help="Of the task; left out: 30, or what it has")] = None,
    speed: Annotated[
        float | None,
        typer.Option(help="Seconds of the task in one of the picture; left out: 1, or fewer by which waves are seen"),
    ] = None,
    fps: Annotated[float, typer.Option(help="Frames a second, in steps that GIFs know")] = 10.0,
    magnify: Annotated[float, typer.Option(help="Times the elastic platform's displacements")] = 1.0,
) -> None:
    """March one task again and write results/<study>/animation-<task id>.gif: a side view that moves."""
    study, tasks, store = _open(study_file, results)
    chosen = find(study, [task])
    if len(chosen) > 1:
        raise StudyError(study.path, [f"task = {task}: {len(chosen)} tasks have these labels; name one"])
    asked = actions.Filming(start=start, seconds=seconds, speed=speed, fps=fps, magnify=magnify)
    (one,) = tasks.where(lambda each: each.id in chosen)
    try:
        say(str(actions.animate(study, store, results, one, asked)))
    except SimulationFailed as error:
        say(f"failed: {one.id} {one}: {error}", err)
        raise typer.Exit(FAILED) from None


@app.command(epilog="Exit status: 0 all whole, 1 something damaged or another record at the second time, 2 bad input.")
def verify(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    rerun_: Annotated[int, typer.Option("--rerun", min=0, help="Repeat so many random tasks")] = 0,
) -> None:
    """Check every record and its coefficients against their checksums; --rerun: repeat some, compare bit for bit."""
    import random

    from pipeline.bridge.cache import Cache
    from pipeline.running.campaign import broken
    from pipeline.running.place import Place

    study, tasks, store = _open(study_file, results)
    by_state = tasks.split(lambda task: store.look(task, checksums=True).state)
    counts: Counter[str] = Counter({state: len(members) for state, members in by_state.items()})
    say(str(Tally(counts)))
    again = f"`{store.command('run', study.path)}` makes it again"
    for task in by_state.get("damaged", ()):
        say(f"damaged: {task.id} {task}; {again}", err)
    spoilt = [Cache(results).path(geometry.key) for geometry in broken(tasks, results)]
    for path in spoilt:
        say(f"damaged: {path}; {again}", err)
    done = [task.id for task in by_state.get("done", ())]
    chosen = set(random.sample(done, min(rerun_, len(done))))  # any will do, if only none is favoured
    repeated = tasks.where(lambda task: task.id in chosen)
    code = actions.rerun(study, store, results, repeated, Place()) if chosen else DONE
    raise typer.Exit(FAILED if counts["damaged"] or spoilt else code)


@app.command()
def clean(
    study_file: StudyPath,
    results: ResultsFolder = RESULTS,
    orphans: Annotated[bool, typer.Option("--orphans", help="Remove them")] = False,
) -> None:
    """List, or with --orphans remove, results of no task of the study, and halves of coefficients of killed runs."""
    _, tasks, store = _open(study_file, results)
    known = {name for task in tasks.passing() for name in (task.id, *task.under(task.older_versions))}
    with store.lock(lambda text: say(text, err)) if orphans else nullcontext():  # a run's new files look like strays
        strays = sorted(p for p in store.tasks.iterdir() if p.name not in known) if store.tasks.is_dir() else []
        strays += [*store.packs.strays(known), *sorted(leftovers(results / COEFFICIENTS))]
        for folder in strays:
            labels = read_status(folder / "status.json").labels
            say(f"{'removed' if orphans else 'orphan'}: {folder.name} {labels or ''}")
            if orphans:
                remove(folder)
    say(f"{len(strays)} orphans")
