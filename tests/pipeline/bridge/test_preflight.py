"""Warnings of a study name the labels that they are of, as its errors do."""

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.bridge import preflight
from pipeline.bridge.engine import Engine
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
from pipeline.tasks.tasklist import Tasks

STUDIES = Path(__file__).parents[3] / "studies"
BASE = f'base = "{STUDIES}/sphere-waves.toml"\n'  # of one float, sphere


def told(folder, text, odd=None):
    """What is said of a study, by the solver or by `odd` of a task's parameters."""
    (path := folder / "study.toml").write_text(BASE + text)
    study = load(path)
    return judge(study, Tasks.of(study.content), replace(Engine(), judge=odd) if odd else Engine())


@pytest.mark.parametrize("names", ["heavy light", "light heavy"])
def test_a_warning_of_one_variant_names_it_wherever_it_stands(tmp_path, names):
    tables = {"heavy": '[variants.heavy]\n"floats.sphere.mass" = 5e5\n', "light": "[variants.light]\n"}
    (warning,) = told(tmp_path, "".join(tables[name] for name in names.split()))
    assert warning.startswith("variant = heavy: floats.sphere is out of equilibrium: ")


def test_a_warning_of_all_variants_names_none(tmp_path):
    (warning,) = told(tmp_path, '[[floats]]\nname = "sphere"\nmass = 5e5\n[variants.one]\n[variants.two]\n')
    assert warning.startswith("floats.sphere is out of equilibrium: ")


AXES = """
[axes]
pto_damping = [1e4, 2e4, 3e4]
"solver.froude_krylov" = ["linear", "body-nonlinear"]
"floats.sphere.damping" = [0.0, 1e3, 2e3]
sea_state = ["T10"]
"sea.height" = [0.4, 0.491]
[variants.a]
[variants.b]
title = "b"
"""


@pytest.mark.parametrize(
    ("odd", "place"),
    [
        (lambda p: p.solver.froude_krylov == "linear", 'axes."solver.froude_krylov" = linear: '),
        (lambda p: p.floats[0].pto_damping != 1e4, "pto_damping = 20000.0, 30000.0: "),
        (lambda p: p.floats[0].damping == 2e3, 'axes."floats.sphere.damping" = 2000.0: '),
        (lambda p: p.sea_state.height == 0.491, 'axes."sea.height" = 0.491: '),
        (lambda p: True, ""),
        (
            lambda p: p.floats[0].pto_damping == 1e4 and p.solver.froude_krylov == "linear",
            'pto_damping = 10000.0, axes."solver.froude_krylov" = linear: ',
        ),
    ],
)
def test_warnings_name_the_values_of_any_axis(tmp_path, odd, place):
    assert told(tmp_path, AXES, lambda p: ["floats.sphere: odd"] * bool(odd(p))) == [f"{place}floats.sphere: odd"]


def test_warnings_of_a_sea_name_it_once_and_of_a_float_in_one_sea_too(tmp_path):
    seas = """
[axes]
sea_state = ["low", "high"]
"floats.sphere.damping" = [0.0, 1e3]
[sea_states]
low = { Hs = 0.5, Tp = 6.0 }
high = { Hs = 1.5, Tp = 6.0 }
"""
    odd = told(tmp_path, seas, lambda p: ["sea: odd", "floats.sphere: odd"] * (p.sea_state.Hs == 1.5))
    assert odd == ["sea_states.high: odd", "sea_state = high: floats.sphere: odd"]


def test_of_many_frames_some_are_reduced_before_the_run(tmp_path):
    """Of a sweep over a leg's wall: each task that runs reduces its own."""
    walls = ", ".join(f"{0.010 + 1e-4 * n:.4f}" for n in range(40))
    path, reduced = tmp_path / "study.toml", []
    axes = "[axes]\nplatform = ['elastic']\nsea_state = ['2018']\nseed = [0]"
    path.write_text(f'base = "{STUDIES}/buan.toml"\n{axes}\n"platform.sections.leg.thickness" = [{walls}]\n')
    study = load(path)
    engine = replace(Engine(), judge=lambda given: [], reduce=lambda given: reduced.append(given.platform))
    judge(study, Tasks.of(study.content), engine)
    thickness = [table.sections["leg"].thickness for table in reduced]
    assert len(thickness) == preflight.REDUCED and (min(thickness), max(thickness)) == (0.010, 0.0139)


def test_warnings_that_differ_in_numbers_alone_are_one():
    odd = {f"legs buckle at {n} times gravity": {f"task {n}"} for n in (0.4, 0.5, 0.6)} | {"other": {"task 9"}}
    assert preflight._alike(odd) == {
        "legs buckle at 0.4 times gravity (and 2 others that differ in numbers)": {"task 0.4", "task 0.5", "task 0.6"},
        "other": {"task 9"},
    }
