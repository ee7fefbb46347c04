"""A study from end to end with an engine without physics."""

import errno
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from pipeline.bridge import preflight
from pipeline.bridge.cache import Cache
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.loading import load
from pipeline.cli import actions
from pipeline.cli.cli import app
from pipeline.cli.plan import Estimate
from pipeline.report.page import facts, html, results_of
from pipeline.report.published import COLUMNS
from pipeline.results import dataset
from pipeline.results.netcdf import Variable
from pipeline.results.packs import packed
from pipeline.results.store import Store, remove
from pipeline.running import schedule
from pipeline.running.campaign import Campaign, unfinished
from pipeline.running.place import Place
from pipeline.study.reading import StudyError
from pipeline.tasks.task import expand
from solver.coupled.pieces.fine import Fine
from solver.errors import InputError

README = Path(__file__).parents[3] / "pipeline" / "README.md"


def campaign(path, results, engine, **how):
    return Campaign(study=path, results=results, store=Store(results, path.stem), engine=engine, place=Place(**how))


def run(path, results, engine, **how):
    study = load(path)
    job = campaign(path, results, engine, **how)
    heard = []
    todo = unfinished(study.tasks, job.store)
    failed = job.run(todo, lambda what, _: heard.append(type(what).__name__.lower()))
    return study, list(study.tasks), job.store, failed, heard


def contents(tasks, store):
    return {task.id: store.look(task).status.content for task in tasks}


@pytest.fixture
def cli(small, tmp_path, engine):
    def call(*words, code=0):
        verb, *rest = words
        result = CliRunner().invoke(app, [verb, str(small), "--results", str(tmp_path / "r"), *rest])
        assert result.exit_code == code, (result.output, result.exception)
        return result.output

    return call


def test_one_geometry_then_every_task_once(small, tmp_path, engine):
    _, tasks, store, failed, heard = run(small, tmp_path / "r", engine, workers=1)
    assert not failed
    assert heard.count("geometry") == 1
    assert heard.count("task") == len(tasks) == 12
    assert {store.look(task, checksums=True).state for task in tasks} == {"done"}


def test_a_second_run_runs_nothing(small, tmp_path, engine):
    run(small, tmp_path / "r", engine, workers=1)
    assert run(small, tmp_path / "r", engine, workers=1)[4] == []


def test_coefficients_are_not_solved_again(small, tmp_path, engine):
    run(small, tmp_path / "r", engine, workers=1)
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0, 1, 2]"))
    heard = run(small, tmp_path / "r", engine, workers=1)[4]
    assert heard == ["task"] * 6


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("workers", [1, 2])
def test_headings_share_what_radiates(small, tmp_path, engine, workers):
    """One solution in as many shares as workers, and a file for each heading and for each set of motions.

    An elastic platform moves a float that the waves pass at an angle in every way, a hinge on fixed ground in three.
    """

    def coefficients(geometries, shares):
        assert {(g.heading, bool(g.needed)) for g in geometries} == {(h, n) for h in (0.1, 0.2) for n in (True, False)}
        assert shares == [(n, workers) for n in range(workers)]
        return engine.coefficients(geometries, shares)

    share = replace(engine, share=lambda _, first, step: (first, step), coefficients=coefficients)
    small.write_text(small.read_text().replace("[axes]", '[axes]\n"waves.heading" = [0.1, 0.2]'))
    _, tasks, store, failed, heard = run(small, tmp_path / "r", share, workers=workers)
    assert not failed
    assert heard.count("geometry") == 4
    assert {store.look(task).state for task in tasks} == {"done"}


@pytest.mark.filterwarnings("default")
def test_a_share_that_fails_fails_the_tasks_of_all_its_headings_once(small, tmp_path, engine):
    def broken(_, first, step):
        if first == step - 1:
            raise ValueError("singular")

    small.write_text(small.read_text().replace("[axes]", '[axes]\n"waves.heading" = [0.1, 0.2]'))
    _, tasks, store, failed, heard = run(small, tmp_path / "r", replace(engine, share=broken), workers=2)
    assert heard.count("geometry") == 4
    assert len(failed) == len({t.id for t in failed}) == 2 * 8
    assert {store.look(t).state for t in tasks if not geometry_of(t.parameters)} == {"done"}


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize(("workers", "most"), [(1, 1), (2, 3)])
def test_tasks_of_a_geometry_run_before_all_others_are_solved(small, tmp_path, engine, workers, most):
    """So a stop loses little: no more than so many of six are ahead of their tasks, of which each has two."""
    text = small.read_text().replace('"elastic", "fixed", "elastic-no-floats"', '"fixed"').replace("[0, 1]", "[0]")
    small.write_text(text.replace("[axes]", '[axes]\n"water.density" = [1e3, 1001, 1002, 1003, 1004, 1005]'))
    slow = replace(engine, share=lambda *_: time.sleep(0.2))
    _, _, _, failed, heard = run(small, tmp_path / "r", slow, workers=workers)
    ahead = [heard[:n].count("geometry") - heard[:n].count("task") / 2 for n in range(len(heard))]
    assert not failed and len(heard) == 6 + 12
    assert max(ahead) <= most, heard


def in_shares(engine, monkeypatch, stop=10):
    """An engine whose boundary elements take two minutes, interrupted before the share of this number; those solved."""
    monkeypatch.setattr("pipeline.running.campaign.bem_time", lambda _: 119.0)
    solved = []

    def share(_, first, step):
        if first == stop:
            raise KeyboardInterrupt
        solved.append((first, step))
        return first, step

    def coefficients(geometries, shares):
        assert shares == [(n, 6) for n in range(6)]
        return engine.coefficients(geometries, shares)

    return replace(engine, share=share, coefficients=coefficients), solved


@pytest.mark.parametrize("damage", [False, True])
def test_a_long_solution_goes_on_where_a_run_was_ended(small, tmp_path, engine, monkeypatch, damage):
    """In shares of 20 s, each kept and told of; a damaged one is solved again, and none is left when all is there."""
    ended, solved = in_shares(engine, monkeypatch, stop=4)
    with pytest.raises(KeyboardInterrupt):
        run(small, tmp_path / "r", ended, workers=1)
    kept = sorted((tmp_path / "r" / "hydrodynamics").glob("*.share"))
    assert len(kept) == len(solved) == 4
    if damage:
        kept[1].write_bytes(kept[1].read_bytes()[:-1])
    whole, solved = in_shares(engine, monkeypatch)
    _, tasks, store, failed, heard = run(small, tmp_path / "r", whole, workers=1)
    assert not failed and {store.look(task).state for task in tasks} == {"done"}
    assert solved == [(1, 6)] * damage + [(4, 6), (5, 6)]
    assert heard.count("portion") == len(solved) and heard.count("geometry") == 1
    assert not list((tmp_path / "r" / "hydrodynamics").glob("*.share"))


def test_a_long_solution_that_was_whole_but_for_its_file_is_put_together(small, tmp_path, engine, monkeypatch):
    split, solved = in_shares(engine, monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        run(
            small,
            tmp_path / "r",
            replace(split, coefficients=lambda *_: (_ for _ in ()).throw(KeyboardInterrupt)),
            workers=1,
        )
    assert len(solved) == 6
    whole, solved = in_shares(engine, monkeypatch)
    _, _, _, failed, heard = run(small, tmp_path / "r", whole, workers=1)
    assert not failed and not solved and heard.count("geometry") == 1


def test_shares_that_make_no_whole_are_not_kept(small, tmp_path, engine, monkeypatch):
    """As of sources that have changed since."""
    split, _ = in_shares(engine, monkeypatch)
    _, _, _, failed, _ = run(small, tmp_path / "r", replace(split, coefficients=lambda *_: {}["whole"]), workers=1)
    assert failed and not list((tmp_path / "r").rglob("*.share"))


@pytest.mark.filterwarnings("default")  # dask warns while it shuts down
def test_serial_and_two_workers_agree_bit_for_bit(small, tmp_path, engine):
    _, tasks, one, _, _ = run(small, tmp_path / "one", engine, workers=1)
    _, _, two, failed, _ = run(small, tmp_path / "two", engine, workers=2)
    assert not failed
    assert contents(tasks, one) == contents(tasks, two)


@pytest.mark.filterwarnings("default")
def test_a_task_that_kills_its_worker_is_a_failure_and_the_others_go_on(small, tmp_path, engine):
    few = small.read_text().replace("seed = [0, 1]", "seed = [0, 1, 2, 3, 667]")
    small.write_text(
        few.replace('"elastic", "fixed", "elastic-no-floats"', '"fixed"').replace('"calm", "rough"', '"calm"')
    )
    _, tasks, store, failed, _ = run(small, tmp_path / "r", engine, workers=2)
    assert [t.labels["seed"] for t in failed] == [667]
    assert [store.look(t).state for t in tasks] == ["done"] * 4 + ["failed"]
    assert "every worker that had it died" in store.look(failed[0]).status.error.message


def test_failed_tasks_are_recorded_and_the_others_go_on(small, cli):
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0, 666]"))
    output = cli("run", "--workers", "1", code=1)
    assert output.count(": failed: RuntimeError") == 6
    told = [line for line in output.splitlines() if "the platform left" in line]
    assert len(told) == 1 and told[0].startswith("failed: ") and told[0].count("seed=666") == 3
    assert told[0].endswith(" and 3 more: RuntimeError: the platform left")
    assert "12 tasks: 6 done, 6 failed" in output
    assert "RuntimeError: the platform left" in cli("show", "sea_state=calm,platform=fixed,seed=666")
    assert "--failed" in output
    cli("run", "--workers", "1", code=1)  # a failed task is not tried again unasked
    assert cli("rerun", "--failed", "--workers", "1", code=1).count("no new record") == 6


def test_fail_fast_stops(small, cli):
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [666, 0]"))
    output = cli("run", "--workers", "1", "--fail-fast", code=1)
    assert "1 failed" in output
    assert "11 missing; 1 run now" in output.replace(", 1 failed", "")


def test_records_that_are_moved_away_during_a_run_are_told_of(cli, monkeypatch, tmp_path):
    real = actions.run

    def emptied(*args, **how):
        real(*args, **how)
        shutil.rmtree(tmp_path / "r" / "small")

    monkeypatch.setattr(actions, "run", emptied)
    output = cli("run", "--workers", "1", code=1)
    assert "12 tasks: 12 missing; 0 run now" in output
    assert "12 records are not where runs put them" in output


def test_failed_coefficients_fail_their_tasks_alone(small, tmp_path, engine):
    def broken(*_):
        raise ValueError("singular")

    _, tasks, store, failed, _ = run(small, tmp_path / "r", replace(engine, coefficients=broken), workers=1)
    assert {t.labels["platform"] for t in failed} == {"elastic", "fixed"}
    assert {store.look(t).state for t in tasks if not geometry_of(t.parameters)} == {"done"}


def test_rerun_is_bitwise_the_same(cli, tmp_path):
    cli("run", "--workers", "1")
    before = {p: p.read_bytes() for p in (tmp_path / "r").rglob("record.nc")}
    output = cli("rerun", "platform=fixed,seed=1", "--workers", "1")
    assert output.count("bitwise the same as the old record") == 2
    assert len(before) == 12


def _elsewhere(monkeypatch, engine):
    """From now on the engine rounds otherwise."""

    def other(parameters, coefficients):
        record = engine.compute(parameters, coefficients)
        dims, values = record.variables["rotation"]
        record.variables["rotation"] = (dims, values + 1e-12)
        return record

    monkeypatch.setattr("pipeline.bridge.engine.Engine", lambda: replace(engine, compute=other))


def test_rerun_tells_what_changed(cli, monkeypatch, engine):
    cli("run", "--workers", "1")
    _elsewhere(monkeypatch, engine)
    output = cli("rerun", "platform=fixed,seed=1,sea_state=calm", "--workers", "1", code=1)
    assert "rotation: differs by up to 1e-12" in output


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("damaged", [False, True])
def test_a_rerun_that_comes_to_no_end_leaves_the_record_there(cli, monkeypatch, engine, tmp_path, damaged):
    """Its worker dies each time; a record that is whole stays, and the next rerun compares with it."""
    words = "platform=fixed,seed=1,sea_state=calm"
    cli("run", "--workers", "1")
    (task,) = re.findall(r"(?m)^\w{16}", cli("show", words))
    folder = tmp_path / "r" / "small" / "tasks" / task
    if damaged:
        record = folder / "record.nc"
        record.write_bytes(record.read_bytes()[:-1] + b"?")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with monkeypatch.context() as patch:
        lost = replace(engine, compute=lambda _parameters, _coefficients: os._exit(1))
        patch.setattr("pipeline.bridge.engine.Engine", lambda: lost)
        told = cli("rerun", words, "--timeout", "60", code=1)
    stays = "every worker that had it died: killed, over its memory or longer than --timeout = 60 s; its record stays"
    assert (stays in told) is (not damaged)
    assert f"{task}: no new record" in told
    assert ({path.name: path.read_bytes() for path in folder.iterdir()} == before) is (not damaged)
    again = cli("rerun", words, "--workers", "1")
    assert f"{task}: {'no old record to compare with' if damaged else 'bitwise the same as the old record'}" in again


def test_select_runs_a_part(cli):
    assert "2 tasks: 2 done" in cli("run", "--select", "platform=fixed,seed=0", "--workers", "1")
    assert "12 tasks: 10 missing, 2 done" in cli("status", code=2)
    assert "4 tasks: 4 done" in cli("run", "--select", "platform=fixed", "--workers", "1")


def test_the_table_above_a_selections_count_is_of_all_that_is_done(cli):
    first, rest = ["run", "--workers", "1", "--select", "sea_state=calm"], ["run", "--workers", "1"]
    assert "6 tasks: 6 done; 6 run now; table of all 6 that are done of the study's 12; " in cli(*first)
    assert "table of" not in cli(*rest)
    assert "6 tasks: 6 done; nothing to run; table of all 12 that are done of the study's 12; " in cli(*first)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("platfrom=fixed", "platfrom: unknown axis; did you mean platform?"),
        ("platform=fixd", "platform=fixd: no such value; did you mean fixed?"),
        ("fixed", "must be axis=value"),
    ],
)
def test_bad_selection_names_the_key(small, tmp_path, words, message):
    result = CliRunner().invoke(app, ["run", str(small), "--results", str(tmp_path / "r"), "--select", words])
    assert message in str(result.exception)


def test_damaged_records_are_found_and_made_again(cli, tmp_path):
    cli("run", "--workers", "1")
    record = next((tmp_path / "r").rglob("record.nc"))
    data = bytearray(record.read_bytes())
    data[len(data) // 2] ^= 1
    record.write_bytes(data)
    assert "1 damaged" in cli("verify", code=1)
    assert "1 damaged" in cli("collect")
    assert "1 run now" in cli("run", "--workers", "1")
    cli("verify")


@pytest.mark.parametrize("first", ["collect", "run", "report"])
def test_a_record_that_is_made_again_comes_back_into_the_dataset(small, cli, tmp_path, drawn, first):
    """Its damage is found only when it is read, by whatever collects: a run of other tasks, a report without a dataset.

    As long as it lasts a report collects each time.
    """
    cli("run", "--workers", "1")
    path, times = tmp_path / "r" / "small" / "statistics.nc", ["wall_time"]
    whole = dataset.loaded(path).drop_vars(times)
    task = next(task for task in load(small).tasks if task.labels["platform"] == "elastic")
    record = tmp_path / "r" / "small" / "tasks" / task.id / "record.nc"
    data = bytearray(record.read_bytes())
    data[len(data) // 2] ^= 1
    record.write_bytes(data)
    path.unlink()
    cli(first, *(["--select", "platform=fixed", "--workers", "1"] if first == "run" else []))
    assert sorted(dataset.loaded(path).status.values.ravel()) == ["damaged", *["done"] * 11]
    for _ in range(2):
        told = " ".join(cli("report").split())
        assert "held a damaged record, and is collected again: 1 damaged, 11 done" in told
    assert "1 run now" in cli("run", "--workers", "1")
    assert dataset.loaded(path).drop_vars(times).identical(whole)
    assert "collected again" not in cli("report")


def test_copied_results_are_found_and_made_again(small, cli, tmp_path):
    cli("run", "--workers", "1")
    (one,) = (tmp_path / "r" / "hydrodynamics").glob("*.nc")
    small.write_text(small.read_text().replace("depth = 50.0", "depth = 50.0\ndensity = 1000.0"))
    cli("run", "--workers", "1")
    other = one.with_name(f"{geometry_of(next(iter(load(small).tasks)).parameters).key}.nc")
    right = other.read_bytes()
    other.write_bytes(one.read_bytes())
    again = f"`study run {small} --results {tmp_path / 'r'}` makes it again"
    assert f"damaged: {other}; {again}" in cli("verify", code=1)
    told = cli("run", "--workers", "1")
    assert re.search(r"hydrodynamic coefficients of 1 float: [\d.]+ s, summed over workers\n", told)
    assert other.read_bytes() == right
    first, second, *_ = (tmp_path / "r" / "small" / "tasks" / task.id for task in load(small).tasks)
    shutil.copytree(first, second, dirs_exist_ok=True)
    assert f"damaged: {second.name}" in cli("verify", code=1)
    assert "1 damaged" in cli("collect")
    assert "1 run now" in cli("run", "--workers", "1")
    cli("verify")


def test_folders_where_files_should_be_stop_nothing(cli, tmp_path):
    cli("run", "--workers", "1")
    root, (bem,) = tmp_path / "r" / "small", (tmp_path / "r" / "hydrodynamics").glob("*.nc")
    one, other, third = list((root / "tasks").iterdir())[:3]
    files = [one / "record.nc", other / "status.json", third, root / "statistics.nc", root / ".lock", bem]
    for path in [*files, root / ".lock.json", root / ".statistics.json"]:
        remove(path)
        (path / "inside").mkdir(parents=True)
    assert "12 tasks: 9 done, 2 missing, 1 damaged" in cli("status", code=2)
    assert "12 done; 3 run now" in cli("run", "--workers", "1")
    assert all(path.is_file() for path in files if path != third)
    cli("verify")


def test_orphans_are_listed_and_removed_on_request(small, cli, tmp_path):
    cli("run", "--workers", "1")
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0]"))
    assert "6 orphans" in cli("clean")
    assert "removed" in cli("clean", "--orphans")
    assert "0 orphans" in cli("clean")
    assert len(list((tmp_path / "r").rglob("record.nc"))) == 6


def test_old_halves_of_coefficients_are_listed_and_removed_on_request(cli, tmp_path):
    """Of any study: whoever writes one now has touched it within the hour."""
    cli("run", "--workers", "1")
    old, new = ((tmp_path / "r" / "hydrodynamics" / f".{name}.nc.7.part") for name in ("old", "new"))
    for path in (old, new):
        path.touch()
    os.utime(old, (0, 0))
    assert f"orphan: {old.name}" in (told := cli("clean")) and "1 orphans" in told and old.exists()
    assert f"removed: {old.name}" in cli("clean", "--orphans")
    assert not old.exists() and new.exists()
    assert "0 orphans" in cli("clean")


@pytest.mark.parametrize(("seconds", "pieces"), [(2.0, 1), (40.0, schedule.SMALL + 1)])
def test_boundary_elements_that_take_long_are_shared_by_workers_of_few_tasks(
    small, tmp_path, engine, monkeypatch, seconds, pieces
):
    """One task alone runs here, and so would they, on one core of all; not once they are known."""
    monkeypatch.setattr("pipeline.running.campaign.bem_time", lambda _: seconds)
    tasks = load(small).tasks
    one = tasks.where(lambda task: task.id == next(iter(tasks)).id)
    runs = campaign(small, tmp_path / "r", engine)
    assert runs._work(one, ()) == pieces
    monkeypatch.setattr(Cache, "get", lambda *_: b"known")
    assert runs._work(one, ()) == 1
    monkeypatch.setattr("pipeline.running.campaign.geometry_of", None)  # of many nobody asks
    assert runs._work(tasks, ()) == len(tasks)


@pytest.mark.usefixtures("undrawn")
def test_a_run_leaves_an_up_to_date_report(small, cli, tmp_path, monkeypatch):
    monkeypatch.setattr(actions, "REPORTED", 12)
    page = tmp_path / "r" / "small" / "report.html"
    assert str(page) in cli("run", "--workers", "1", "--select", "seed=0")
    assert "6 done, 6 missing" in page.read_text()
    cli("run", "--workers", "1")
    assert "12 done" in page.read_text()
    page.write_text("mine")
    cli("run", "--workers", "1")
    assert page.read_text() == "mine"  # nothing has changed: a second run takes no time for figures
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0, 1, 2]"))
    assert "report.html" not in cli("run", "--workers", "1")  # too many to wait for it


@pytest.fixture
def drawn(monkeypatch):
    """What is drawn: pages and tables, by name."""
    from pipeline.report import page, report

    names = []

    def write(study, path):
        names.append("page")
        path.with_name("report.html").touch()

    def table(data, *rest, **_):
        names.append("table")
        rest[-1].print(rest[0][0].note if rest[:-1] else "a summary")

    monkeypatch.setattr(actions, "REPORTED", 12)
    monkeypatch.setattr(page, "write", write)
    monkeypatch.setattr(report, "print_summary", table)
    monkeypatch.setattr(report, "print_tables", table)
    monkeypatch.setattr(report, "speaks", lambda _, rows: bool(rows))
    return names


def test_table_and_report_are_drawn_again_only_from_other_sources(small, cli, tmp_path, drawn):
    assert "a summary" in cli("run", "--workers", "1")
    assert sorted(drawn) == ["page", "table"]
    assert "a summary" in cli("run")
    assert len(drawn) == 2
    published = tmp_path / "small-published.csv"
    for note in ("why", "because"):
        published.write_text(f"{','.join(COLUMNS)}\nT,power,absorbed_power,,,2.0,kW,{note}\n")
        drawn.clear()
        assert note in cli("run")
        assert sorted(drawn) == ["page", "table"]
    small.write_text(small.read_text().replace("mass = 2147.0", "mass = 2148.0"))
    cli("run", "--workers", "1")
    assert len(drawn) == 4


def test_a_report_that_is_current_is_not_written_again(cli, tmp_path, drawn):
    cli("run", "--workers", "1")
    told = cli("report")
    assert "a summary" in told and str(tmp_path / "r" / "small" / "report.html") in told
    assert drawn.count("page") == 1
    (tmp_path / "r" / "small" / "report.html").unlink()
    cli("report")
    assert drawn.count("page") == 2


def test_answers_are_printed_and_written_beside_the_dataset(cli, tmp_path):
    cli("answers", code=1)  # nothing has run
    cli("run", "--workers", "1", "--select", "platform=fixed")
    told = cli("answers", "--between", "platform=elastic,fixed")
    path = tmp_path / "r" / "small" / "answers.nc"
    assert str(path) in told.replace("\n", "") and "Differences" not in told
    assert "platform=elastic,fixed: no differences, which need a realization in common" in told
    with dataset.opened(path) as data:
        assert data.estimate.values.tolist() == ["value", "low", "high"]
    cli("answers", "--between", "seed=0,1", code=1)


def test_what_was_made_of_an_earlier_dataset_is_named(cli, tmp_path):
    """Its numbers are not those of the study any more, and neither `run` nor `figures` takes it away."""
    cli("run", "--workers", "1", "--select", "platform=fixed")
    cli("answers")
    (figures := tmp_path / "r" / "small" / "figures").mkdir()
    (figures / "of-before.svg").write_text("")
    assert "earlier" not in cli("run", "--workers", "1", "--select", "platform=fixed")
    for told in (cli("run", "--workers", "1"), cli("figures", "--format", "png")):
        assert "made of an earlier statistics.nc: answers.nc, figures/of-before.svg" in told.replace("\n", " ")
    cli("answers")
    assert "statistics.nc: figures/of-before.svg" in cli("run").replace("\n", " ")


def test_a_report_that_cannot_be_written_is_a_warning(cli, tmp_path, drawn, monkeypatch):
    """As in a folder for reading only, where neither page nor table can be kept."""
    from pipeline.report import page

    def read_only(path, *_):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    cli("run", "--workers", "1")
    root = tmp_path / "r" / "small"
    for name in (".report.json", ".table.json"):
        (root / name).unlink()
    monkeypatch.setattr(page, "write", lambda _, path: read_only(path.with_name("report.html")))
    monkeypatch.setattr(actions, "write_json", read_only)
    told = cli("report")
    assert "a summary" in told
    line = f"small.toml: warning: the page cannot be written: {root / 'report.html'}: Read-only file system"
    assert told.replace("\n", " ").count(line) == 1


@pytest.mark.parametrize(
    "damaged", [lambda data: np.random.default_rng(1).bytes(100), lambda data: data[: len(data) // 2], lambda data: b""]
)
def test_a_damaged_dataset_is_collected_again_by_the_report(cli, tmp_path, drawn, damaged):
    cli("run", "--workers", "1")
    path = tmp_path / "r" / "small" / "statistics.nc"
    with dataset.opened(path) as data:
        whole = data.load()
    path.write_bytes(damaged(path.read_bytes()))
    assert "statistics.nc: was not what had been collected, and is collected again" in cli("report")
    with dataset.opened(path) as data:
        assert data.identical(whole)
    assert "collected again" not in cli("report")


@pytest.mark.parametrize("mark", [b"", b"[]", b'{"of": "'])
def test_a_dataset_whose_mark_cannot_be_read_is_collected_again_by_the_report(cli, tmp_path, drawn, mark):
    """What it was made of is not known; where there are no records, it is all there is."""
    cli("run", "--workers", "1")
    path = tmp_path / "r" / "small" / "statistics.nc"
    whole = path.read_bytes()
    path.write_bytes(b"nothing")
    path.with_name(dataset.MARK).write_bytes(mark)
    assert "statistics.nc: had a mark that cannot be read, and is collected again" in cli("report")
    assert path.read_bytes() == whole and "collected again" not in cli("report")
    path.with_name(dataset.MARK).write_bytes(mark)
    remove(tmp_path / "r" / "small" / "tasks")
    assert "collected again" not in cli("report")


def test_the_report_is_of_the_records_that_are_there(cli, tmp_path, drawn):
    """Not of those that had been collected: of twelve one has lost its status, one half of its record."""
    cli("run", "--workers", "1")
    root = tmp_path / "r" / "small"
    first, second, *_ = sorted((root / "tasks").iterdir())
    (first / "status.json").unlink()
    record = second / "record.nc"
    record.write_bytes(record.read_bytes()[:100])
    told = cli("report")
    assert (
        "statistics.nc: was of other records than are there, and is collected again: 1 damaged, 10 done, 1 missing"
        in (re.sub(r"\s+", " ", told))
    )
    with dataset.opened(root / "statistics.nc") as data:
        states = data.status.values.ravel().tolist()
    assert sorted(states) == ["damaged", *["done"] * 10, "missing"]
    assert "collected again" not in cli("report")
    (root / "statistics.nc").unlink()
    assert "statistics.nc: was not there, and is collected again: 1 damaged, 10 done" in re.sub(
        r"\s+", " ", cli("report")
    )
    assert (root / "statistics.nc").exists()


def test_the_report_of_a_folder_without_records_stands(cli, tmp_path, drawn):
    """Records may have been put away, and the dataset is all that is left."""
    cli("report", code=1)
    cli("run", "--workers", "1")
    root = tmp_path / "r" / "small"
    whole = (root / "statistics.nc").read_bytes()
    remove(root / "tasks")
    assert "collected again" not in cli("report")
    assert (root / "statistics.nc").read_bytes() == whole


def test_a_damaged_dataset_without_a_mark_is_named_and_what_makes_it_again(cli, tmp_path, drawn):
    """One from elsewhere is none of ours to write over."""
    cli("run", "--workers", "1")
    path = tmp_path / "r" / "small" / "statistics.nc"
    path.with_name(dataset.MARK).unlink()
    assert "collected again" not in cli("report")
    path.write_bytes(b"nothing")
    with pytest.raises(StudyError, match="is damaged; `study collect` makes it again"):
        dataset.opened(path)
    cli("report", code=1)
    cli("collect")
    cli("report")


def test_a_rerun_to_the_same_bits_leaves_dataset_and_report_alone(cli, tmp_path, drawn, monkeypatch, engine):
    cli("run", "--workers", "1")
    path = tmp_path / "r" / "small" / "statistics.nc"
    before = path.stat().st_ino, path.stat().st_mtime_ns
    cli("rerun", "platform=fixed,seed=1", "--workers", "1")
    assert (path.stat().st_ino, path.stat().st_mtime_ns) == before
    assert drawn.count("page") == 1
    _elsewhere(monkeypatch, engine)
    cli("rerun", "platform=fixed,seed=1,sea_state=calm", "--workers", "1", code=1)
    assert path.stat().st_ino != before[0]
    assert drawn.count("page") == 2


def test_a_run_says_that_it_compiles(cli, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert "compiling the solver:" not in cli("plan")  # its statics alone
    assert "compiling" in cli("run", "--workers", "1")
    assert "compiling" not in cli("run")  # nothing to run
    monkeypatch.setattr("pipeline.environment.compiled", lambda _bends: True)
    assert "compiling" not in cli("rerun", "platform=fixed,seed=1", "--workers", "1")


@pytest.mark.parametrize(
    ("more", "bends"),
    [
        ("[solver]\nmethod = 'frequency'", None),
        ("", False),
        ("[[floats]]\nname = 'front'\nend_stops = { lower = -0.9, upper = 0.9, stiffness = 1e7 }", True),
        ("[axes]\n'floats.front.coulomb' = [0.0, 1e3]", True),
        ("[solver]\nmethod = 'frequency'\n[axes]\n'floats.front.coulomb' = [0.0, 1e3]", None),
        ("[solver]\nmethod = 'frequency'\n[axes]\n'floats.front.coulomb' = [1e3]\n'solver.method' = ['time']", True),
    ],
)
def test_kernels_of_laws_that_bend_are_told_apart(small, tmp_path, monkeypatch, more, bends):
    """By the index in which numba names the arguments of what it compiled; nothing where no task marches."""
    told = []
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(actions, "say", lambda text, _console: told.append(text))
    path = small.with_name("more.toml")
    path.write_text(f"base = '{small.name}'\n{more}\n")
    index = tmp_path / "coupled_1" / "march.march-20.py311.nbi"
    index.parent.mkdir()
    for kernels, silent in ((None, False), ("solver.coupled.march", not bends), (Fine.__module__, True)):
        if kernels:
            index.write_text(kernels)
        actions.tell_of_compiler(load(path).content)
        assert (told == []) == (silent or bends is None)
        told.clear()


def test_preflight_judges_what_runs_each_task_once(cli, monkeypatch, engine, tmp_path):
    judged = []
    watchful = replace(engine, judge=judged.append, reduce=lambda _: None)
    monkeypatch.setattr("pipeline.bridge.engine.Engine", lambda: watchful)
    cli("run", "--workers", "1", "--select", "platform=fixed")
    assert {parameters.platform for parameters in judged} == {None}
    judged.clear()
    cli("run", "--workers", "1", "--select", "sea_state=rough")
    assert all(p.platform and p.sea_state.Hs == 2.0 for p in judged)  # the others of them are done
    judged.clear()
    cli("run", "--workers", "1", "--select", "platform=fixed")
    assert judged == []
    cli("rerun", "platform=fixed,seed=1,sea_state=calm", "--workers", "1")
    assert judged == []  # it has run, so what it would say has been said
    for record in tmp_path.glob("r/small/tasks/*/*.nc"):
        record.unlink()
    cli("rerun", "platform=fixed,seed=1,sea_state=calm", "--workers", "1")
    assert len(judged) == 1


def test_a_warning_is_told_once_by_a_run_and_again_where_nothing_is_left_to_run(cli, monkeypatch, engine):
    def odd(parameters, coefficients):
        record = engine.compute(parameters, coefficients)
        record.attrs["warnings"] = "sea: odd by 2 %; met in the run"
        return record

    worried = replace(engine, compute=odd, judge=lambda _: ["sea: odd by 1 %"])
    monkeypatch.setattr("pipeline.bridge.engine.Engine", lambda: worried)
    first, second = (cli("run", "--workers", "1", "--select", "sea_state=calm") for _ in range(2))
    assert "warning: sea_states.calm: odd by 1 %" in first and first.count("odd by") == 1
    assert ": met in the run (and 5 more)" in first and ": sea: odd by 2 %; met in the run (and 5 more)" in second


def test_nothing_to_do_imports_nothing_heavy(small, cli, tmp_path, drawn, monkeypatch):
    monkeypatch.setattr("pipeline.bridge.cache.Cache.__init__.__defaults__", (lambda data, key: data,))
    for _ in range(2):  # the second finds the coefficients whole
        cli("run", "--workers", "1")
    program = (
        "import sys; from pipeline.cli.cli import app\n"
        "app(sys.argv[1:], standalone_mode=False)\n"
        "heavy = {'xarray', 'netCDF4', 'numba', 'matplotlib', 'dask', 'distributed', 'capytaine', 'scipy.sparse'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)"
    )
    words = ["run", str(small), "--results", str(tmp_path / "r")]
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "nothing to run" in done.stdout


def test_status_as_json(cli):
    assert {row["state"] for row in json.loads(cli("status", "--json", code=2))["tasks"]} == {"missing"}


@pytest.fixture
def collected(small, tmp_path, engine):
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0, 666]"))
    study, _, store, _, _ = run(small, tmp_path / "r", engine, workers=1)
    path, counts = dataset.collect(study, store)
    with xr.open_dataset(path) as data:
        return data.load(), counts


def test_a_task_of_several_cells_is_counted_once(small, tmp_path, engine):
    """As `run` and `status` count: without floats there is one of both dampings."""
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0]\npto_damping = [1e5, 2e5]"))
    study, tasks, store, _, _ = run(small, tmp_path / "r", engine, workers=1)
    path, counts = dataset.collect(study, store)
    assert (len(tasks), counts) == (12, {"done": 10})
    assert dict(facts(results_of(study, path)))["Tasks"] == "10 done of 10"


def test_dimensions_and_labels(collected):
    data, counts = collected
    assert counts == {"done": 6, "failed": 6}
    assert data.rotation.dims == ("sea_state", "platform", "seed", "float", "statistic")
    assert data.natural_frequency.dims == ("mode",)
    assert data.displacement_envelope.dims == ("sea_state", "platform", "seed", "leg", "height")
    assert data.platform.values.tolist() == ["elastic", "fixed", "elastic-no-floats"]
    assert data.statistic.values.tolist() == ["max", "min", "mean", "rms", "std"]
    assert data.float.values.tolist() == ["front"]
    assert data.Hs.dims == data.Tp.dims == ("sea_state",)
    assert data.Tp.values.tolist() == [5.0, 7.0]
    assert data.pto_damping.dims == ()
    assert float(data.pto_damping) == 100e3


def test_failed_cells_are_nan_with_their_status(collected):
    data, _ = collected
    assert (data.status.sel(seed=666) == "failed").all()
    told = data.failure.astype(str)
    assert (told.sel(seed=666) == told.values[data.status == "failed"][0]).all()
    assert told.values[data.status == "failed"][0].startswith("RuntimeError: ")
    assert (told.where(data.status == "done", "") == "").all()
    assert (data.status.sel(seed=0) == "done").all()
    assert data.wave_elevation.sel(seed=666).isnull().all()
    assert data.wave_elevation.sel(seed=0).notnull().all()
    assert data.rotation.sel(platform="elastic-no-floats").isnull().all()
    assert data.rotation.sel(platform="fixed", seed=0).notnull().all()


def test_numbers_stand_in_their_own_cells(collected, small, engine):
    data, _ = collected
    for task in expand(load(small).content):
        if task.labels["seed"] == 0:
            record = engine.compute(task.parameters, geometry_of(task.parameters) and b"x")
            cell = data.sel(**{k: task.labels[k] for k in ("sea_state", "platform", "seed")})
            for name, (dims, values) in record.variables.items():
                np.testing.assert_array_equal(
                    cell[name].transpose(*dims).sel({d: record.coords[d] for d in dims}), values
                )


def test_attributes_come_from_the_one_table(collected):
    data, _ = collected
    assert data.attrs["Conventions"] == "CF-1.11"
    assert data.rotation.attrs["units"] == "rad"
    assert data.Tp_realized.attrs["units"] == "s"
    assert all("long_name" in v.attrs for v in data.variables.values())
    assert all("_FillValue" not in data[c].encoding for c in data.coords)


@pytest.fixture
def changed(small, tmp_path, engine):
    """The dataset of a study whose records have been changed: change(parameters, record)."""

    def collect(change):
        def compute(parameters, coefficients):
            record = engine.compute(parameters, coefficients)
            change(parameters, record)
            return record

        study, _, store, failed, _ = run(small, tmp_path / "r", replace(engine, compute=compute), workers=1)
        assert not failed
        return dataset.loaded(dataset.collect(study, store)[0])

    return collect


def test_parts_of_a_study_open_together(small, tmp_path, engine):
    """By the readme's call, which keeps what each part has of its sea; of attributes it has the first part's."""
    (call,) = re.findall(r"^    parts = (xr\.open_mfdataset\(.*?\))$", README.read_text(encoding="utf-8"), re.M | re.S)
    words, paths, both = small.read_text(), [], 'sea_state = ["calm", "rough"]\n'
    rough = words.replace(both, 'sea_state = ["rough"]\n')
    calm = re.sub("^rough = .*$", "", words.replace(both, ""), flags=re.M)  # whose one sea state is no dimension
    for name, step, part in (("calm", 0.2, calm), ("rough", 0.1, rough)):
        (file := small.with_name(f"many-{name}.toml")).write_text(part)
        told = replace(engine, compute=lambda *given, step=step: stepped(engine.compute(*given), step))
        study, _, store, _, _ = run(file, tmp_path / "results", told, workers=1)
        paths.append(str(dataset.collect(study, store)[0]))
    with eval(call.replace('"results/many-*/statistics.nc"', "paths"), {"xr": xr, "paths": paths}) as data:
        assert data.sea_state.values.tolist() == ["calm", "rough"] and data.attrs["time_step"] == 0.2
        for i, path in enumerate(paths):
            with xr.open_dataset(path) as one:
                assert ("sea_state" in one.dims) == bool(i)
                for known in ("Hs", "rotation", "status"):
                    alone = one[known].isel(sea_state=0, missing_dims="ignore")
                    together = data[known].isel(sea_state=i).transpose(*alone.dims)
                    np.testing.assert_array_equal(together.values, alone.values)


def stepped(record, step):
    record.attrs["time_step"] = step
    return record


def test_a_knob_is_an_attribute_unless_tasks_differ(changed):
    data = changed(
        lambda parameters, record: record.attrs.update(time_step=0.2, newton_tolerance=1e-5 / (1 + parameters.seed))
    )
    assert data.attrs["time_step"] == 0.2 and "time_step" not in data
    assert data.newton_tolerance.sel(seed=1, sea_state="calm", platform="fixed") == 5e-6
    assert data.newton_tolerance.dims == ("sea_state", "platform", "seed")
    assert data.newton_tolerance.attrs["units"] == "m"
    assert "newton_tolerance" not in data.attrs


def test_frequencies_that_differ_are_not_shown_as_one(changed):
    def soften(parameters, record):
        if parameters.platform and parameters.seed:
            record.variables["natural_frequency"] = (("mode",), np.array([0.4, 3.1 * (1 - 1e-6)]))

    data = changed(soften)
    assert data.natural_frequency.dims == ("sea_state", "platform", "seed", "mode")
    assert data.natural_frequency.sel(sea_state="calm", platform="elastic", mode=2).values.tolist() == [
        3.1,
        3.1 * (1 - 1e-6),
    ]


def test_axes_over_keys_are_dimensions_with_unit_and_path(changed, small):
    lines = (
        '"floats.*.mass" = [2147.0, 2200.0]\n"solver.time_step" = [0.1, 0.2]\n"solver.diffraction" = [true, false]\n'
    )
    group = "[[axes.together]]\nname = 'tuning'\nperiod = [4, 5]\n'water.depth' = [50.0, 60.0]\n"
    group += "'floats.front.offset' = [0.0, 0.1]\n"
    text = small.read_text().replace("seed = [0, 1]", "seed = [0]\n" + lines + group)
    small.write_text(text)
    data = changed(lambda parameters, record: record.attrs.update(time_step=parameters.solver.time_step, mass=1.0))
    assert data.rotation.dims[:7] == ("sea_state", "platform", "mass", "time_step", "diffraction", "tuning", "seed")
    assert (data.status == "done").all() and data.sizes["mass"] == 2
    assert data.mass.attrs == {"units": "kg", "long_name": "mass (floats.*.mass)"}
    assert data.time_step.values.tolist() == [0.1, 0.2] and data.time_step.attrs["units"] == "s"
    assert data.diffraction.values.tolist() == ["true", "false"] and "units" not in data.diffraction.attrs
    assert data.tuning.values.tolist() == [1, 2] and data.depth.dims == ("tuning",)
    assert data.depth.attrs["units"] == "m" and data.offset.attrs["units"] == "rad"
    assert data.period.values.tolist() == [4, 5]
    chosen = data.task.sel(
        mass=2200.0, time_step=0.1, diffraction="false", tuning=2, sea_state="calm", platform="fixed"
    )
    (task,) = (t for t in load(small).tasks if f"{t.id}" == chosen.item())
    parameters = task.parameters
    assert (parameters.floats[0].mass, parameters.water.depth, parameters.floats[0].offset) == (2200.0, 60.0, 0.1)
    assert parameters.solver.time_step == 0.1 and not parameters.solver.diffraction


def test_keys_of_one_dimension_are_called_as_dimensions_are(changed, small):
    """Beside an output of the same name, a knob, a name that another dimension's key has, too."""
    group = "[[axes.together]]\nname = 'kind'\n'record.rao' = [true, false]\n'solver.time_step' = [0.1, 0.2]\n"
    group += "'floats.front.mass' = ['balance', 2200.0]\n'water.density' = [1025.0, 1000.0]\n"
    group += "[samples]\ncount = 2\n'platform.materials.steel.density' = { from = 8e3, to = 9e3 }\n"
    only = small.read_text().replace('["calm", "rough"]', '["calm"]').replace("seed = [0, 1]", "seed = [0]")
    small.write_text(only.replace("[sea_states", f"{group}[sea_states", 1))
    data = changed(
        lambda parameters, record: record.attrs.update(time_step=parameters.solver.time_step, mass=2147.0, rao=1.0)
    )
    assert (data.status == "done").all() and data.rao.sizes["kind"] == data.mass_found.sizes["kind"] == 2
    coords = {name: c.values.tolist() for name, c in data.coords.items() if c.dims == ("kind",)}
    assert coords == {
        "kind": [1, 2],
        "record.rao": ["true", "false"],
        "time_step": [0.1, 0.2],
        "mass": ["balance", "2200.0"],
        "water.density": [1025.0, 1000.0],
    }
    assert data["platform.materials.steel.density"].dims == ("sample",) and "time_step_found" not in data


def test_a_knob_that_a_tolerance_chose_stands_beside_the_axis_over_it(changed, small):
    """Else what goes along the axis looks converged."""
    small.write_text(small.read_text().replace("seed = [0, 1]", 'seed = [0]\n"solver.time_step" = [0.1, 0.2]'))
    data = changed(lambda parameters, record: record.attrs.update(time_step=0.05))
    assert data.time_step.values.tolist() == [0.1, 0.2] and (data.time_step_found == 0.05).all()


MANY_AXES = """
platform = ["elastic"]
sea_state = ["calm"]
seed = [0]
water.depth = [50.0, 60.0]
waves.heading = [0.0]
"floats.*.pto_damping" = { from = 1e4, to = 1e6, count = 2, spacing = "log" }
"platform.damping_ratio" = [0.01]
"solver.froude_krylov" = ["body-nonlinear"]
[[axes.together]]
name = "size"
label = ["small", "large"]
"volume [m3]" = [2.09, 2.79]
"floats.front.hull.radius" = [1.0, 1.1]
"floats.front.mass" = [2147.0, 2857.0]
[samples]
count = 4
"platform.sections.tube.thickness" = { from = 0.04, to = 0.06 }
"water.density" = { mean = 1025.0, std = 1.0 }
"""


def test_five_axes_a_paired_one_and_samples_from_run_to_xarray(small, cli, tmp_path):
    """Over keys of five tables: run; extended to 16 samples and another value; of a part, what is new is run."""
    head, tail = small.read_text().split("[axes]")[0], small.read_text()[small.read_text().index("[sea_states]") :]
    small.write_text(head + "[axes]" + MANY_AXES + tail)
    assert "32 tasks: 32 done; 32 run now" in cli("run", "--workers", "1")
    wider = MANY_AXES.replace("count = 4", "count = 16").replace("heading = [0.0]", "heading = [0.5, 0.0]")
    small.write_text(head + "[axes]" + wider + tail)
    assert "256 tasks: 224 missing, 32 done" in cli("plan")
    part = cli("run", "--workers", "1", "--select", "depth=50,sample=0..7,floats.*.pto_damping=1e4..2e4,heading=0")
    assert "16 tasks: 16 done; 8 run now" in part
    assert "256 tasks: 216 missing, 40 done" in cli("status", code=2)
    with xr.open_dataset(tmp_path / "r" / "small" / "statistics.nc") as data:
        power = data.rotation.sel(depth=50.0, heading=0.0, pto_damping=1e4, size=2, statistic="mean", float="front")
        assert power.squeeze().dims == ("sample",) and int(power.notnull().sum()) == 8
        assert data.thickness.dims == ("sample",) and data.thickness.attrs["units"] == "m"
        assert data.volume.values.tolist() == [2.09, 2.79] and data.volume.attrs["units"] == "m3"
        assert data.label.values.tolist() == ["small", "large"] and data.radius.values.tolist() == [1.0, 1.1]
        assert data.sizes["sample"] == 16 and data.froude_krylov.values.tolist() == ["body-nonlinear"]


@pytest.mark.usefixtures("undrawn")
def test_cells_that_no_variant_goes_along_have_no_task(small, cli, tmp_path):
    tables = "[variants.usual]\n[variants.deep]\ntitle = 'Deeper'\naxes = { seed = [1] }\n'water.depth' = 60.0\n"
    small.write_text(small.read_text().replace("[sea_states", tables + "[sea_states", 1))
    output = cli("run", "--workers", "1")
    assert "18 tasks: 18 done" in output and "no task" not in output
    with xr.open_dataset(tmp_path / "r" / "small" / "statistics.nc") as data:
        deep = data.sel(variant="deep")
        assert (deep.status.sel(seed=0) == "no task").all() and (deep.status.sel(seed=1) == "done").all()
        assert (data.status.sel(variant="usual") == "done").all()
        assert deep.wave_elevation.sel(seed=0).isnull().all() and deep.wave_elevation.sel(seed=1).notnull().all()
        assert deep.variant_title.item() == "Deeper"
        assert data.variant_title.sel(variant="usual").item() == "usual"
    study = load(small)
    tasks = {str(t.labels): t.id for t in expand(study.content)}
    assert len(set(tasks.values())) == 18
    page = html(results_of(study, tmp_path / "r" / "small" / "statistics.nc"))
    assert "18 done of 18<" in page and "no task" not in page


def test_deep_water_is_a_value_of_an_axis(changed, small):
    small.write_text(small.read_text().replace("seed = [0, 1]", 'seed = [0]\n"water.depth" = [50.0, inf]'))
    text = small.read_text().replace('platform = ["elastic", "fixed", "elastic-no-floats"]', 'platform = ["fixed"]')
    small.write_text(text)
    data = changed(lambda parameters, record: record.attrs.update(time_step=0.2))
    assert data.depth.values.tolist() == [50.0, np.inf] and (data.status == "done").all()


def test_a_table_of_the_dataset_has_room_for_the_lowest_modes_alone(changed, tmp_path):
    """A row for every combination of labels, of which a platform may have 708; the record has them all."""

    def refine(parameters, record):
        if parameters.platform:
            record.coords["mode"] = np.arange(1, 709)
            record.variables["natural_frequency"] = (("mode",), np.sqrt(np.arange(1.0, 709.0)))

    data = changed(refine)
    np.testing.assert_array_equal(data.natural_frequency, np.sqrt(np.arange(1.0, 7.0)))
    assert data.mode.values.tolist() == [1, 2, 3, 4, 5, 6]
    assert len(data.to_dataframe()) == 12 * 6 * 5 * 2  # tasks, modes, statistics, heights; one float, one leg
    path = next(tmp_path / "r" / "small" / "tasks" / task for task in data.task.sel(platform="elastic").values.ravel())
    with xr.open_dataset(path / "record.nc") as one:
        assert one.sizes["mode"] == 708


def test_collecting_twice_gives_the_same_file(small, tmp_path, engine):
    study, _, store, _, _ = run(small, tmp_path / "r", engine, workers=1)
    first = dataset.collect(study, store)[0].read_bytes()
    (store.root / ".statistics.json").unlink()
    assert dataset.collect(study, store)[0].read_bytes() == first


def test_a_failure_alone_makes_the_dataset_anew(small, tmp_path):
    """It has no record, and so the content of a task that is missing."""
    study, store = load(small), Store(tmp_path / "r", "small")
    store.root.mkdir(parents=True)
    states = []
    for _ in range(2):
        with xr.open_dataset(dataset.current(study, store)) as data:
            states.append(sorted(set(data.status.values.ravel())))
        error = {"kind": "ValueError", "message": "too much", "traceback": ""}
        store.keep([(next(iter(study.tasks)), None, {"error": error})])
    assert states == [["missing"], ["failed", "missing"]]


def test_command_line_exits_with_2_and_one_line(small):
    small.write_text(small.read_text().replace("depth = 50.0", "depth = -1.0"))
    done = subprocess.run(
        [sys.executable, "-m", "pipeline", "run", str(small)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr == f"{small}: water.depth = -1.0: must be > 0 m\n"


def test_a_killed_run_leaves_no_lock_and_loses_nothing(small, tmp_path, engine):
    """SIGKILL while the lock is held: the next run takes it at once, and says whose it was."""
    code = (
        "import sys, time; from pathlib import Path; from pipeline.results.store import Store\n"
        "with Store(Path(sys.argv[1]), 'small').lock(print): print('held', flush=True); time.sleep(60)"
    )
    holder = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "r")], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "held\n"
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    holder.stdout.close()
    words = []
    with Store(tmp_path / "r", "small").lock(words.append):
        assert f"left by process {holder.pid}" in words[0]
    with Store(tmp_path / "r", "small").lock(pytest.fail):
        pass


def test_warnings_of_a_task_are_in_its_log(cli, engine, monkeypatch):
    def worried(parameters, coefficients):
        warnings.warn("the platform sways", stacklevel=1)
        return engine.compute(parameters, coefficients)

    monkeypatch.setattr("pipeline.bridge.engine.Engine", lambda: replace(engine, compute=worried))
    cli("run", "--workers", "1", "--select", "platform=fixed")
    assert "log: UserWarning: the platform sways" in cli("show", "platform=fixed,seed=0,sea_state=calm")


def test_random_tasks_are_repeated_and_compared(cli):
    cli("run", "--workers", "1")
    assert cli("verify", "--rerun", "2").count("bitwise the same as the old record") == 2
    assert cli("verify", "--rerun", "100").count("bitwise the same as the old record") == 12


@pytest.fixture
def three_seas(small):
    """The small study with a sea state between its two: of several, the first and the last are easily met."""
    text = small.read_text().replace('["calm", "rough"]', '["calm", "mild", "rough"]')
    small.write_text(text + "mild = { Hs = 1.0, Tp = 6.0 }\n")
    return small


def test_every_sea_and_every_configuration_is_judged_before_anything_runs(three_seas, engine):
    three_seas.write_text(three_seas.read_text().replace("[axes]", "[axes]\npto_damping = [1e5, 2e5]"))
    study, judged = load(three_seas), []
    preflight.judge(study, expand(study.content), replace(engine, judge=judged.append))
    assert {parameters.sea_state.Hs for parameters in judged} == {0.5, 1.0, 2.0}
    assert {(bool(parameters.platform), *(f.pto_damping for f in parameters.floats)) for parameters in judged} == {
        (elastic, damping) for elastic in (True, False) for damping in (1e5, 2e5)
    } | {(True,)}
    assert len(judged) < len(study.tasks)


def test_every_frame_is_reduced_once_wherever_its_hinges_are(small, engine):
    axes = "[axes]\n'platform.damping_ratio' = [0.01, 0.02]\n'floats.front.hinge.0' = [-1.5, -1.6]"
    small.write_text(small.read_text().replace("[axes]", axes))
    study, reduced = load(small), []
    preflight.judge(study, expand(study.content), replace(engine, reduce=reduced.append))
    assert [p.platform.damping_ratio for p in reduced if p.platform and p.floats] == [0.01, 0.02]


def test_odd_and_impossible_seas_are_named_whichever_they_are(three_seas, engine):
    study = load(three_seas)
    for label, height in (("calm", 0.5), ("mild", 1.0), ("rough", 2.0)):
        odd = replace(
            engine, judge=lambda parameters, height=height: ["sea: odd"] * (parameters.sea_state.Hs == height)
        )
        assert preflight.judge(study, expand(study.content), odd) == [f"sea_states.{label}: odd"]

        def refuse(parameters, height=height):
            if parameters.sea_state.Hs == height:
                raise InputError("sea", height, "must be calm")

        with pytest.raises(StudyError, match=f"sea = {height}: must be calm"):
            preflight.judge(study, expand(study.content), replace(engine, judge=refuse))


def overturning(p):
    """What is said of stiff joints' floats, as if those fell over."""
    return "the equilibrium is unstable" * (p.floats[0].pto_stiffness == 2.0)


STIFFNESS = "[axes]\n'floats.front.pto_stiffness' = [1.0, 2.0]\n'floats.front.damping' = [0.0, 1e3]"


@pytest.mark.parametrize("workers", [1, 2])
def test_what_does_not_rest_is_told_by_a_run_before_its_boundary_elements(small, engine, tmp_path, workers):
    """Once, of each design, by a worker or here; and no more where the coefficients are there."""
    small.write_text(small.read_text().replace("[axes]", STIFFNESS))
    told, heard = [], []
    job = replace(
        campaign(small, tmp_path / "r", replace(engine, statics=overturning), workers=workers), say=told.append
    )
    tasks = load(small).tasks

    def watch(what, _):
        heard.append((type(what).__name__, len(told)))

    job.run(tasks, watch)
    where = 'axes."floats.front.pto_stiffness" = 2.0'
    assert told == [f"{small}: warning: {where}: the equilibrium is unstable"]
    if workers == 1:
        assert ("Geometry", 1) in heard
    told.clear()
    job.run(tasks, watch)
    assert told == []


def test_plan_tells_what_does_not_rest_and_that_it_compiles_for_that(small, cli, engine, monkeypatch, tmp_path):
    small.write_text(small.read_text().replace("[axes]", STIFFNESS))
    monkeypatch.setattr("pipeline.bridge.engine.Engine", lambda: replace(engine, statics=overturning))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    told = cli("plan")
    assert "compiling the solver's statics: about a minute" in told
    assert 'axes."floats.front.pto_stiffness" = 2.0: the equilibrium is unstable\n' in told
    (folder := tmp_path / "coupled_1").mkdir()
    (folder / "equilibrium._balances-61.py311.nbi").touch()
    assert "compiling" not in cli("plan")


def test_one_of_those_that_rest_alike_is_looked_at_and_of_many_some(small):
    small.write_text(small.read_text().replace("[axes]", STIFFNESS + "\n'sea.Hs' = [0.5, 0.6]"))
    content = load(small).content
    looked = [task.parameters for task in preflight.designs(content, expand(content))]
    assert [(bool(p.platform), p.floats[0].pto_stiffness) for p in looked] == [(True, 1.0), (True, 2.0), (False, 1.0)]
    values = ", ".join(map(str, range(1, 41)))
    small.write_text(small.read_text().replace("[1.0, 2.0]", f"[{values}]"))
    content = load(small).content
    looked = preflight.designs(content, expand(content))
    assert len(looked) == preflight.REDUCED


def test_where_nothing_is_solved_for_none_is_told_of(small, cli):
    """Linear pressure alone still has a file of its own."""
    text = small.read_text().replace(
        "[waves]", '[solver]\nradiation = false\ndiffraction = false\nfroude_krylov = "linear"\n[waves]'
    )
    small.write_text(text)
    assert "to run: 12 tasks; about 16 s on 1 workers" in cli("plan", "--workers", "1")
    told = cli("run", "--workers", "1")
    assert re.search(r"(?m)^pressure of the undisturbed waves on 1 float: ", told) and "coefficients" not in told


def test_plan_tells_of_a_band_that_seas_could_share(small, cli, monkeypatch):
    """Where hulls are others, too, no band does."""
    monkeypatch.setattr("pipeline.cli.plan.bem_pace", lambda: 60.0)
    apart = small.read_text().replace("band = [0.7, 3.4]\n", "").replace("Tp = 7.0", "Tp = 14.0")
    small.write_text(apart)
    told = re.sub(r"\s+", " ", cli("plan"))
    band = re.search(r"after 2 .* \(waves.band = \[(.*), (.*)\] would make it one\); about", told)
    low, high = map(float, band.groups())
    bands = [geometry.band for task in load(small).tasks if (geometry := geometry_of(task.parameters))]
    assert 0 <= min(low for low, _ in bands) - low < 1e-3 and 0 <= high - max(high for _, high in bands) < 1e-3
    small.write_text(apart.replace("[waves]\n", f"[waves]\nband = [{low}, {high}]\n"))
    assert "after 1 boundary element solutions, " in cli("plan") and "would make it" not in cli("plan")
    small.write_text(apart.replace("[axes]\n", '[axes]\n"floats.front.hull.radius" = [1.0, 1.1]\n'))
    assert "would make it" not in cli("plan")


def test_plan_tells_states_and_time_from_past_runs(small, cli, monkeypatch):
    monkeypatch.setattr("pipeline.cli.plan.bem_pace", lambda: 60.0)
    assert "after 1 boundary element solutions, about 18 s; " in cli("plan", "--workers", "2")
    monkeypatch.setattr("pipeline.cli.plan.bem_pace", lambda: 1.0)
    told = cli("plan", "--workers", "1")  # twelve records of 3,700 s; a geometry with one float
    assert "to run: 12 tasks after 1 boundary element solutions, about 1 s; about 16 s on 1 workers, at 3600 " in told
    assert "about 8 s on 2 workers" in cli("plan")
    small.write_text(small.read_text().replace("depth = 50.0", "depth = 5.0").replace(", -50.0]", ", -5.0]"))
    assert "after 1 boundary element solutions, about 1 s; " in cli("plan", "--workers", "1")
    small.write_text(small.read_text().replace("depth = 5.0", "depth = 50.0").replace(", -5.0]", ", -50.0]"))
    small.write_text(small.read_text() + '[solver]\naccuracy = "reference"\n')
    assert "about 2.7 h on 2 workers, at 3600 times real time" in cli("plan")
    small.write_text(small.read_text().replace('[solver]\naccuracy = "reference"\n', ""))
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0, 666]"))
    cli("run", "--workers", "1", "--select", "sea_state=calm", code=1)
    output = cli("plan")
    assert "12 tasks: 6 missing, 3 done, 3 failed" in output
    assert "about 0 s on 2 workers, from 3 tasks done" in output
    assert "about 0 s on 7 workers" in cli("plan", "--workers", "7")


def test_what_was_asked_and_not_met_is_told(small, cli, engine, monkeypatch, tmp_path):
    def short(parameters, coefficients):
        record = engine.compute(parameters, coefficients)
        missed = "tolerance 1e-3 asked, 2.1e-3 estimated" if parameters.platform and parameters.floats else ""
        odd = "" if parameters.platform else "a float rests elsewhere"
        return replace(record, attrs={**record.attrs, "unmet": missed, "warnings": odd})

    monkeypatch.setattr("pipeline.bridge.engine.Engine", lambda: replace(engine, compute=short))
    output = cli("run", "--workers", "1")
    assert output.count(": tolerance 1e-3 asked, 2.1e-3 estimated") == 3  # the first of them
    assert "and 1 more that did not meet what was asked" in output
    told = "12 tasks: 12 done; 4 did not meet what was asked"
    assert told in output
    assert told in cli("status")
    rows = json.loads(cli("status", "--json"))["tasks"]
    assert [row["id"] for row in rows if row["unmet"]] == [
        task.id for task in load(small).tasks if task.labels["platform"] == "elastic"
    ]
    assert {row["warnings"] for row in rows if row["labels"]["platform"] == "fixed"} == {"a float rests elsewhere"}
    shown = cli("show", "sea_state=calm,platform=elastic,seed=0")
    assert "unmet: tolerance 1e-3 asked" in shown and re.search(r"(?m)^wall_time: [\d.]{1,8}(e-\d+)? s$", shown)
    assert "warnings: a float rests elsewhere" in cli("show", "sea_state=calm,platform=fixed,seed=0")
    with xr.open_dataset(tmp_path / "r" / "small" / "statistics.nc") as data:
        assert (data.unmet.sel(platform="elastic") == "tolerance 1e-3 asked, 2.1e-3 estimated").all()
        assert (data.unmet.sel(platform=["fixed", "elastic-no-floats"]) == "").all()
        assert (data.warnings.sel(platform="fixed") == "a float rests elsewhere").all()
        assert (data.warnings.sel(platform="elastic") == "").all()
    tasks = {task.labels["platform"]: tmp_path / "r" / "small" / "tasks" / task.id for task in load(small).tasks}
    shutil.copytree(tasks["elastic"], tasks["fixed"], dirs_exist_ok=True)  # says nothing of the other
    assert told.replace("12 done", "11 done, 1 damaged") in cli("status", code=2)
    cli("collect")
    with xr.open_dataset(tmp_path / "r" / "small" / "statistics.nc") as data:
        assert (data.unmet.sel(platform="fixed") == "").all()


@pytest.mark.parametrize(("workers", "time"), [(1, "about 62 s"), (2, "about 31 s"), (10, "about 6 s")])
def test_a_plans_time_is_shared_by_its_workers(small, tmp_path, engine, workers, time):
    """Six of twelve tasks are done and took 10.4 s each."""
    study, store = load(small), Store(tmp_path / "r", "small")
    estimate = Estimate()
    for task in study.tasks:
        if task.labels["seed"] == 0:
            store.keep([(task, b"record", {"wall_time": 10.4, "labels": dict(task.labels)})])
        estimate.see(task, store.look(task))
    assert f"; {time} on {workers} workers, from 6 tasks done" in estimate.words(tmp_path / "r", workers)


def test_a_plan_does_not_go_by_the_tasks_that_compiled(small, tmp_path, engine):
    """Of eight tasks on each platform two waited for a compiler; four are left, of 10.4 s."""
    small.write_text(small.read_text().replace("seed = [0, 1]", "seed = [0, 1, 2, 3, 4, 5]"))
    study, store, estimate = load(small), Store(tmp_path / "r", "small"), Estimate()
    for task in study.tasks:
        if (seed := task.labels["seed"]) < 4:
            seconds = 10.4 if seed else 1000.0
            store.keep([(task, b"record", {"wall_time": seconds, "labels": dict(task.labels)})])
        estimate.see(task, store.look(task))
    assert "; about 2 min on 1 workers, from 24 tasks done" in estimate.words(tmp_path / "r", 1)


def test_a_plan_goes_by_tasks_in_packs(small, tmp_path, engine):
    """Six of twelve tasks in the frequency domain took 3 s each, of the study itself or of another."""
    small.write_text(small.read_text() + '\n[solver]\nmethod = "frequency"\n')
    study, results = load(small), tmp_path / "r"
    done = [task for task in study.tasks if task.labels["seed"] == 0]
    rows = packed([({"task": Variable((), np.array(task.id), {})}, {}) for task in done])
    status = {"wall_time": 3.0}
    Store(results, "small").keep([(task, row, status) for task, row in zip(done, rows, strict=True)])
    for name, told in (
        ("small", "18 s on 1 workers, from 6 tasks done"),
        ("b", "36 s on 1 workers, from 6 tasks of other"),
    ):
        estimate = Estimate()
        for task in study.tasks:
            estimate.see(task, Store(results, name).look(task))
        assert told in estimate.words(results, 1)


def test_a_plan_goes_by_tasks_of_the_same_method(small, tmp_path, engine):
    """Runs of the march that took days say nothing of tasks in the frequency domain."""
    other = small.with_name("linear.toml")
    other.write_text(small.read_text() + '\n[solver]\nmethod = "frequency"\n')
    store, results = Store(tmp_path / "r", "small"), tmp_path / "r"
    for task in load(small).tasks:
        store.keep([(task, b"record", {"wall_time": 1e6, "labels": dict(task.labels)})])
    for path, told in (
        (other, "; about 0 s on 1 workers, at 10 ms a task"),
        (other.with_name("again.toml"), "from 12 tasks of other studies"),
    ):
        path.write_text(other.read_text() if path is other else small.read_text() + "\n[record]\nduration = 77.0\n")
        study, estimate = load(path), Estimate()
        for task in study.tasks:
            estimate.see(task, Store(results, path.stem).look(task))
        assert told in estimate.words(results, 1)
