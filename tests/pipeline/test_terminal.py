"""A pass that takes long shows itself on a terminal, and nowhere else."""

import io
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.console import Console

from pipeline import terminal
from pipeline.cli import console
from pipeline.cli.console import Tally, finish
from pipeline.results.store import Store


@pytest.fixture
def screen(monkeypatch):
    """A terminal on which a second passes at every look at the clock."""
    file, seconds = io.StringIO(), iter(range(1000))
    monkeypatch.setattr(terminal, "err", Console(file=file, force_terminal=True, force_interactive=True, width=100))
    monkeypatch.setattr(terminal, "time", SimpleNamespace(monotonic=lambda: float(next(seconds))))
    return file


def test_a_long_pass_shows_how_far_it_is_and_an_estimate(screen):
    """Looked at after 64, 128, ... of 640: the third look is the first after more than 2 s, at 192 in 3 s."""
    assert list(terminal.passing(range(640), 640, "naming tasks")) == list(range(640))
    text = screen.getvalue()
    assert "naming tasks" in text
    assert "192/640" in text
    assert "about 7 s left" in text
    assert "64/640" not in text


def test_what_is_said_is_in_a_file_at_once(tmp_path):
    with (tmp_path / "log").open("w") as file:
        console.say("54 tasks: 50 done, 4 missing", Console(file=file))
        assert (tmp_path / "log").read_text() == "54 tasks: 50 done, 4 missing\n"


def test_a_short_pass_is_quiet(screen):
    assert list(terminal.passing(range(128), 128, "naming tasks")) == list(range(128))
    assert screen.getvalue() == ""


def test_elsewhere_a_long_pass_is_quiet(screen, monkeypatch):
    monkeypatch.setattr(terminal, "err", Console(file=screen))
    assert list(terminal.passing(iter(range(640)), 640, "naming tasks")) == list(range(640))
    assert screen.getvalue() == ""


CODES = {"done": 0, "stale": 0, "done failed missing": 1, "missing done": 2, "damaged done": 2}


@pytest.mark.parametrize(("states", "code"), CODES.items())
def test_the_exit_status_is_that_of_the_worst_task(states, code):
    assert Tally(counts=Counter(states.split())).code == code


class Word(str):
    """A task that is called by its name alone."""

    id = "task"


def failures(*reasons):
    """Tasks 0, 1, ... that fail for these reasons."""
    entries = (
        SimpleNamespace(state="failed", unmet="", warnings="", failure=f"InputError: {reason}") for reason in reasons
    )
    return Tally.of((Word(n), entry) for n, entry in enumerate(entries))


def test_what_is_odd_about_records_is_told_at_the_end(capsys):
    """Once for all that are odd in the same way, the first ways of many."""
    said = ["std is 0.4 rad", "", "std is 0.5 rad", "other", "sea: 1", "snap"]
    status = SimpleNamespace(provenance={})
    entries = [SimpleNamespace(state="stale", unmet="", failure="", warnings=text, status=status) for text in said]
    tally = Tally.of((Word(n), entry) for n, entry in enumerate(entries))
    assert finish(tally, SimpleNamespace(path="a.toml"), Store(Path("elsewhere"), "a")) == 0
    assert capsys.readouterr().err.splitlines() == [
        "warning: task 0: std is 0.4 rad (and 1 more)",
        "warning: task 3: other",
        "warning: task 4: sea: 1",
        "and 1 more of other warnings, as the report tells, and `study show` of each task",
    ]


def test_what_was_told_before_the_run_gives_way_to_others(capsys):
    """Of a sea by its name, of one variant, with other numbers; a sentence may have the sign between them in it."""
    told = ["sea_states.a: mean 1; 2 % lie outside", "variant = b: floats.f: out by 3 t (and 2 others)", "other parts"]
    status = SimpleNamespace(provenance={})
    said = [
        "sea: mean 4; 5 % lie outside; floats.f: out by 6 t",
        "sea: mean 4; 5 % lie outside; other",
        "floats.g: out by 3 t",
    ]
    entries = [SimpleNamespace(state="done", unmet="", failure="", warnings=text, status=status) for text in said]
    tally = Tally.of(((Word(n), entry) for n, entry in enumerate(entries)), told)
    assert finish(tally, SimpleNamespace(path="a.toml"), Store(Path("elsewhere"), "a")) == 0
    assert capsys.readouterr().err.splitlines() == ["warning: task 1: other", "warning: task 2: floats.g: out by 3 t"]


def test_a_reason_is_told_once_with_the_first_tasks_that_it_is_of(capsys, monkeypatch):
    """One of five tasks with others between; then more reasons than are listed."""
    study, store = SimpleNamespace(path="a.toml"), Store(Path("elsewhere"), "a")
    assert finish(failures("x", "y", "x", "x", "z", "x", "x"), study, store) == 1
    assert capsys.readouterr().err.splitlines()[:-1] == [
        "failed: task 0; task 2; task 3 and 2 more: InputError: x",
        "failed: task 1: InputError: y",
        "failed: task 4: InputError: z",
    ]
    finish(
        failures("w1 at -0.85, 2.3e+05 N", "w1 at +1.2, 3 N", "w2 at 1.2, 3 N"), study, store
    )  # a name's number counts
    assert capsys.readouterr().err.splitlines()[:-1] == [
        "failed: task 0; task 1: InputError: w1 at -0.85, 2.3e+05 N",
        "failed: task 2: InputError: w2 at 1.2, 3 N",
    ]
    monkeypatch.setattr(console, "MANY", 2)
    finish(failures("x", "y", "z", "z", "x"), study, store)
    assert capsys.readouterr().err.splitlines()[:-1] == [
        "failed: task 0; task 4: InputError: x",
        "failed: task 1: InputError: y",
        "and 2 more that `study plan a.toml --results elsewhere` lists",
    ]
