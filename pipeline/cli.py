"""The command line: study plan|run|status|show|rerun|collect|verify|report|clean STUDY."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from pipeline import environment
from pipeline.console import DONE, FAILED, compare, err, finish, looked, out, say, store_of, tally
from pipeline.select import find, select
from pipeline.store import Entry, Store, read_json
from pipeline.study import Study, StudyError, load
from pipeline.tasks import Task, expand

app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)

File = Annotated[Path, typer.Argument(metavar="STUDY", help="A study file, such as studies/buan.toml")]
Results = Annotated[Path, typer.Option(help="Folder of results")]
Select = Annotated[str, typer.Option(help="Part of the study: platform=fixed,sea_state=2018,seed=0")]
Workers = Annotated[int, typer.Option(min=1, max=1024, help="Worker processes")]
Scheduler = Annotated[str | None, typer.Option(help="Address of a running dask scheduler")]
KeepGoing = Annotated[bool, typer.Option("--keep-going/--fail-fast", help="Go on after a failed task")]
Words = Annotated[list[str] | None, typer.Argument(metavar="TASK...", help="Ids, their beginnings, or labels")]

BAD_INPUT, INTERRUPTED = 2, 130
RESULTS = Path("results")


def main() -> None:
    """Exit status 0 done, 1 a task failed, 2 bad input."""
    environment.prepare()
    try:
        app()
    except StudyError as error:
        for problem in error.problems:
            say(problem, err)
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        say("interrupted; finished tasks are kept, and the same command goes on from here", err)
        sys.exit(INTERRUPTED)


@app.command()
def plan(
    study_file: File,
    results: Results = RESULTS,
    select_: Annotated[str, typer.Option("--select")] = "",
) -> None:
    """What a run would do."""
    study = load(study_file)
    tasks = select(study, expand(study.content), select_)
    entries = looked(tasks, store_of(study, results))
    for task, entry in entries:
        say(f"{task.id} {entry.state:7} {task}")
    say(tally(entries))
    times = [entry.status["wall_time"] for _, entry in entries if entry.state == "done"]
    todo = sum(entry.state in ("missing", "damaged") for _, entry in entries)
    if times and todo:
        say(f"about {todo * sum(times) / len(times) / 2:.0f} s with 2 workers, from the tasks that are done")


@app.command()
def run(
    study_file: File,
    results: Results = RESULTS,
    select_: Annotated[str, typer.Option("--select", help="Part: platform=fixed,sea_state=2018")] = "",
    workers: Workers = 2,
    scheduler: Scheduler = None,
    keep_going: KeepGoing = True,
) -> None:
    """Run what is missing, collect, and print the table."""
    study = load(study_file)
    tasks = select(study, expand(study.content), select_)
    store = store_of(study, results)
    with store.lock(lambda text: say(text, err)):
        todo = [task for task, entry in _unfinished(tasks, store)]
        if todo:
            _run(
                study,
                store,
                results,
                todo,
                workers=workers,
                scheduler=scheduler,
                keep_going=keep_going,
            )
        path = _collect(study, store)
    entries = looked(tasks, store)
    _print_table(study, path)
    say(f"{tally(entries)}; {'nothing to run' if not todo else f'{len(todo)} run now'}; {path}")
    finish(entries, study)


def _unfinished(tasks: Sequence[Task], store: Store) -> list[tuple[Task, Entry]]:
    from pipeline.campaign import unfinished

    return unfinished(list({task.id: task for task in tasks}.values()), store)


def _run(
    study: Study,
    store: Store,
    results: Path,
    tasks: list[Task],
    *,
    workers: int = 2,
    scheduler: str | None = None,
    keep_going: bool = True,
) -> list[Task]:
    from pipeline.campaign import Campaign
    from pipeline.progress import watching
    from pipeline.run import Engine

    campaign = Campaign(
        study=study.path,
        results=results,
        store=store,
        engine=Engine(),
        workers=workers,
        scheduler=scheduler,
        keep_going=keep_going,
    )
    with watching(err if err.is_terminal else out, len(tasks)) as watch:
        return campaign.run(tasks, watch)


def _collect(study: Study, store: Store) -> Path:
    from pipeline.dataset import collect as collect_dataset

    return collect_dataset(study, store, anew=False)[0]


def _print_table(study: Study, path: Path) -> None:
    from pipeline import dataset, report

    published = study.path.with_name(f"{study.name}-published.csv")
    data = dataset.load(path)
    if published.exists():
        report.show(data, report.published(published), out)
    else:
        report.summary(data, out)


@app.command()
def status(
    study_file: File,
    results: Results = RESULTS,
    as_json: Annotated[bool, typer.Option("--json", help="For programs")] = False,
) -> None:
    """How far a study is, from files alone; exit status 0 done, 1 failed, 2 incomplete."""
    study = load(study_file)
    entries = looked(list(expand(study.content)), store_of(study, results))
    if as_json:
        rows = [{"id": t.id, "state": e.state, "labels": dict(t.labels)} for t, e in entries]
        print(json.dumps({"study": study.name, "tasks": rows}, indent=1))
    else:
        say(tally(entries))
    states = {entry.state for _, entry in entries}
    raise typer.Exit(1 if "failed" in states else 2 if states & {"missing", "damaged"} else 0)


@app.command()
def show(study_file: File, task: Annotated[str, typer.Argument()], results: Results = RESULTS) -> None:
    """One task: labels, state, parameters, error, and the command that repeats it."""
    study = load(study_file)
    store = store_of(study, results)
    for found in find(study, list(expand(study.content)), [task]):
        entry = store.look(found, checksums=True)
        say(f"{found.id} {entry.state} {found}")
        for key in ("finished", "wall_time", "command", "sha256"):
            if key in entry.status:
                say(f"{key}: {entry.status[key]}")
        say(json.dumps(json.loads(found.parameters.canonical()), indent=1))
        if "error" in entry.status:
            say(entry.status["error"]["traceback"])


@app.command()
def rerun(
    study_file: File,
    tasks: Words = None,
    failed: Annotated[bool, typer.Option("--failed", help="All that failed")] = False,
    stale: Annotated[bool, typer.Option("--stale", help="All of an older model version")] = False,
    select_: Annotated[str, typer.Option("--select", help="Part: platform=fixed,seed=0")] = "",
    results: Results = RESULTS,
    workers: Workers = 2,
    scheduler: Scheduler = None,
) -> None:
    """Run tasks again, and compare with the old records bit for bit."""
    study = load(study_file)
    store, every = store_of(study, results), list(expand(study.content))
    chosen = {task.id: task for task in find(study, every, tasks or [])}
    chosen |= {task.id: task for task in select(study, every, select_)} if select_ else {}
    for task, entry in looked(every, store):
        if (failed and entry.state == "failed") or (stale and entry.state == "stale"):
            chosen[task.id] = task
    if not chosen:
        if not (failed or stale):
            raise StudyError(study.path, ["rerun: name a TASK, or --failed, --stale or --select"])
        say("nothing to rerun")
        return
    again = list(chosen.values())
    with store.lock(lambda text: say(text, err)):
        old = {task.id: _record(store, task) for task in again}
        _run(study, store, results, again, workers=workers, scheduler=scheduler)
        changed = [not compare(task, old[task.id], _record(store, task)) for task in again]
        _collect(study, store)
    finish(looked(again, store), study)
    raise typer.Exit(FAILED if any(changed) else DONE)


def _record(store: Store, task: Task) -> bytes | None:
    entry = store.look(task, checksums=True)
    return entry.record.read_bytes() if entry.state == "done" else None


@app.command()
def collect(study_file: File, results: Results = RESULTS) -> None:
    """Write results/<study>/statistics.nc from whatever is there."""
    from pipeline.dataset import collect as collect_dataset

    study = load(study_file)
    store = store_of(study, results)
    with store.lock(lambda text: say(text, err)):
        path, counts = collect_dataset(study, store)
    say(f"{path}: " + ", ".join(f"{n} {state}" for state, n in counts.items()))


@app.command()
def report(study_file: File, results: Results = RESULTS) -> None:
    """Print our numbers beside the published ones."""
    study = load(study_file)
    path = store_of(study, results).root / "statistics.nc"
    if not path.exists():
        raise StudyError(study.path, [f"{path}: not there yet; `study run {study.path}` makes it"])
    _print_table(study, path)


@app.command()
def verify(
    study_file: File,
    results: Results = RESULTS,
    rerun_: Annotated[int, typer.Option("--rerun", min=0, help="Repeat so many random tasks")] = 0,
) -> None:
    """Check every record against its checksum; with --rerun, repeat some and compare bit for bit."""
    import random

    study = load(study_file)
    store = store_of(study, results)
    tasks = list({task.id: task for task in expand(study.content)}.values())
    entries = [(task, store.look(task, checksums=True)) for task in tasks]
    say(tally(entries))
    damaged = [task for task, entry in entries if entry.state == "damaged"]
    for task in damaged:
        say(f"damaged: {task.id} {task}; `study run {study.path}` makes it again", err)
    done = [task for task, entry in entries if entry.state == "done"]
    chosen = random.sample(done, min(rerun_, len(done)))  # which ones does not matter, only that none is favoured
    if chosen:
        rerun(study_file, tasks=[task.id for task in chosen], results=results)
    raise typer.Exit(FAILED if damaged else DONE)


@app.command()
def clean(
    study_file: File,
    results: Results = RESULTS,
    orphans: Annotated[bool, typer.Option("--orphans", help="Remove tasks the study no longer has")] = False,
) -> None:
    """List, or with --orphans remove, results that belong to no task of the study."""
    study = load(study_file)
    store = store_of(study, results)
    tasks = list(expand(study.content))
    known = {task.id for task in tasks} | {older for task in tasks for older in task.older_ids}
    found = sorted(p for p in store.tasks.iterdir() if p.name not in known) if store.tasks.is_dir() else []
    for folder in found:
        parameters: dict[str, Any] = read_json(folder / "parameters.json") or {}
        say(f"{'removed' if orphans else 'orphan'}: {folder.name} {parameters.get('labels', '')}")
        if orphans:
            shutil.rmtree(folder)
    say(f"{len(found)} orphans")
