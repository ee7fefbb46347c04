"""Starters: each can be planned as it is, and a small one run; completion; what --help says."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import get_args

import pytest
import xarray as xr
from jsonschema import Draft4Validator
from typer.testing import CliRunner

from pipeline.cli.cli import app
from pipeline.cli.starters import Kind
from pipeline.study.reading import StudyError
from pipeline.study.reference import json_schema


def study(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.mark.parametrize("kind", get_args(Kind))
def test_every_starter_can_be_planned_as_it_is(kind, tmp_path):
    made = study("new", tmp_path / "folder" / "mine", "--like", kind)
    assert made.exit_code == 0 and "mine.toml" in made.output
    path = tmp_path / "folder" / "mine.toml"
    text = path.read_text()
    assert "study run mine.toml" in text and "{" + "name}" not in text and "{" + "mesh}" not in text
    assert all("#" in line for line in text.splitlines() if line.startswith(("depth", "duration", "cog", "arm = [-")))
    planned = study("plan", path, "--results", tmp_path / "r")
    assert planned.exit_code == 0 and "missing" in planned.output and "warning" not in planned.output
    assert Draft4Validator(json_schema()).is_valid(tomllib.loads(text))


@pytest.mark.slow
def test_a_starter_runs_as_it_is(tmp_path):
    """From `new` to power against damping: the sphere absorbs something for each, in each sea."""
    assert study("new", tmp_path / "mine").exit_code == 0
    ran = study("run", tmp_path / "mine.toml", "--results", tmp_path / "r", "--workers", "1")
    assert ran.exit_code == 0, ran.output
    with xr.open_dataset(tmp_path / "r" / "mine" / "statistics.nc") as data:
        power = data.absorbed_power.sel(statistic="mean")
        assert power.sizes["pto_damping"] == 3 and (power > 1e3).all()
    assert "Along pto damping" in (tmp_path / "r" / "mine" / "report.html").read_text()


def test_a_commented_line_is_a_study_too(tmp_path):
    """The arm's length, as the starter says it."""
    study("new", tmp_path / "mine", "--like", "buan")
    path = tmp_path / "mine.toml"
    marks = ("# [[axes", "# name", '# "length', '# "floats')
    lines = [line.removeprefix("# ") if line.startswith(marks) else line for line in path.read_text().splitlines()]
    path.write_text("\n".join(lines))
    planned = study("plan", path, "--results", tmp_path / "r")
    assert planned.exit_code == 0 and "arm=3" in planned.output and "6 tasks" in planned.output


def test_what_is_to_be_typed_can_be(tmp_path):
    """Of a study whose name has a space: after `new`, in the file itself, and of a task that it lacks."""
    path = tmp_path / "mein Körper.toml"
    assert f"`study plan '{path}'` says" in study("new", tmp_path / "mein Körper").output
    assert "# `study plan 'mein Körper.toml'` says" in path.read_text(encoding="utf-8")
    shown = study("show", path, "x", "--results", tmp_path / "r")
    assert f"no such task; `study plan '{path}'` lists them" in str(shown.exception)


def test_nothing_is_written_over(tmp_path):
    assert study("new", tmp_path / "mine").exit_code == 0
    before = (tmp_path / "mine.toml").read_bytes()
    again = study("new", tmp_path / "mine", "--like", "mesh")
    assert isinstance(again.exception, StudyError) and "is there already" in str(again.exception)
    assert (tmp_path / "mine.toml").read_bytes() == before and not (tmp_path / "mine.gdf").exists()
    (tmp_path / "other.gdf").write_text("mine")
    assert "other.gdf is there already" in str(study("new", tmp_path / "other", "--like", "mesh").exception)
    assert not (tmp_path / "other.toml").exists() and (tmp_path / "other.gdf").read_text() == "mine"


@pytest.mark.parametrize("name", ["hydrodynamics", "-x", ".hidden"])
def test_names_that_no_study_may_have_are_refused(name, tmp_path):
    assert "must start with" in (told := str(study("new", tmp_path / name).exception)) or "rename the file" in told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("words", "offered"), [("study ke", "keys"), ("study new x --like f", "floating")])
def test_the_shell_completes_verbs_and_choices(words, offered):
    program = Path(sys.executable).with_name("study")
    asked = {"_STUDY_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(len(words.split()) - 1)}
    told = subprocess.run([program], env=os.environ | asked, capture_output=True, text=True, timeout=60)
    assert told.stdout.split() == [offered], told.stderr


@pytest.mark.parametrize("verb", ["run", "rerun"])
def test_help_lists_the_exit_statuses(verb):
    told = " ".join(study(verb, "--help").output.split())
    for status in ("0 all done", "1 a task failed", "2 bad input", "130 interrupted"):
        assert status in told
