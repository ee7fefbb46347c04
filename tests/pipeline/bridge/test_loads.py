"""Currents, marine growth and loads of a study reach the solver; what is wrong with them is told by file and key."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from pipeline.bridge import scenes
from pipeline.bridge.engine import Engine
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
from pipeline.study.reading import StudyError
from pipeline.tasks.task import expand
from solver.structure import modes
from solver.structure.members import MarineGrowth
from tests.pipeline.conftest import SMALL

ROOT = Path(__file__).parents[3]

WIND = "# gusts\ntime [s], Fz [N], Fx [N]\n0, -10, 100\n2000, 10, 300\n5000, 0, 0\n"
LOADED = """
[current]
direction = 0.5
profile = [{ depth = 0.0, speed = 1.5 }, { depth = 30.0, speed = 0.5 }]
[[platform.load_histories]]
node = "hinge:front"
file = "wind.csv"
[[platform.marine_growth]]
depth = 0
thickness = 0.1
density = 1325
"""


@pytest.fixture
def study_with(tmp_path):
    """The small study with further tables, and the wind beside it."""

    def made(more="", *, wind=WIND, member="", text=SMALL):
        (tmp_path / "wind.csv").write_text(wind)
        path = tmp_path / "study.toml"
        path.write_text(text.replace('material = "steel"\n', f'material = "steel"\n{member}\n') + more)
        return load(path)

    return made


def tasks(study):
    return {t.labels["platform"]: t for t in expand(study.content) if t.labels["sea_state"] == "calm"}


def test_all_of_them_reach_the_solver(study_with):
    study = study_with(LOADED, member="distributed_load = [10.0, 0.0, -5.0]")
    scene = scenes.scene(tasks(study)["elastic"].parameters)
    assert scene.platform.frame.growth == (MarineGrowth(depth=0.0, thickness=0.1, density=1325.0),)
    assert scene.platform.frame.members[0].distributed_load == (10.0, 0.0, -5.0)
    (history,) = scene.platform.load_histories
    assert history.node == "hinge:front"
    assert history.at(np.array([1000.0])) == approx(np.array([[200.0, 0.0, 0.0]]))
    speed = scene.current.velocity(np.array([-15.0]), 50.0)[0]
    assert speed == approx([np.cos(0.5), np.sin(0.5), 0.0])
    law = study_with("[current]\nspeed = 2.0\nexponent = 0.5\n")
    assert scenes.scene(tasks(law)["elastic"].parameters).current.velocity(np.array([-37.5]), 50.0)[0, 0] == approx(1.0)


@pytest.mark.parametrize(("name", "rule"), [("fatigue", "scf = 1.0"), ("utilisation", "material_factor = 1.3")])
def test_rules_of_outputs_that_nobody_asks_for_are_refused(study_with, name, rule):
    """The default's value, too; one variant that asks, or that has the rule, is enough."""
    text = SMALL.replace("density = 8012.0", "density = 8012.0\nyield_strength = 355e6")
    limit = rf"record\.{name} = given: is of the output {name}: ask for it in record\.outputs, too"
    outputs, rules = '[record]\noutputs = ["reactions"]\n', f"[record.{name}]\n{rule}\n"
    with pytest.raises(StudyError, match=limit):
        study_with(outputs + rules, text=text)
    with pytest.raises(StudyError, match=limit):
        study_with(f"{outputs}[variants.a]\n[variants.b]\nrecord.{name}.{rule}\n", text=text)
    study_with(f'{outputs}{rules}[variants.a]\n[variants.b]\n"record.outputs" = ["{name}"]\n', text=text)


def test_rules_of_a_base_are_let_pass(tmp_path):
    """No study that stands on it can take them back."""
    (tmp_path / "on.toml").write_text(f'base = "{ROOT}/studies/buan-fatigue.toml"\n[record]\noutputs = ["reactions"]\n')
    assert load(tmp_path / "on.toml").content.record.outputs == ("reactions",)


def test_what_utilises_tubes_reaches_the_solver(study_with):
    text = SMALL.replace("density = 8012.0", "density = 8012.0\nyield_strength = 355e6")
    outputs = '[record]\noutputs = ["utilisation"]\n[record.utilisation]\nmaterial_factor = 1.3\n'
    member = "buckling_length = 70.0\nmoment_factor = 0.85"
    scene = scenes.scene(tasks(study_with(outputs, member=member, text=text))["elastic"].parameters)
    (leg,) = scene.platform.frame.members
    assert (leg.material.yield_strength, leg.buckling_length, leg.moment_factor) == (355e6, 70.0, 0.85)
    assert scene.settings.outputs == ("utilisation",) and scene.settings.utilisation.material_factor == 1.3
    with pytest.raises(StudyError, match=r"record\.outputs = utilisation: is of tubes whose material has a yield_str"):
        study_with(outputs)
    thin = text.replace("thickness = 0.05", "thickness = 0.01")
    with pytest.raises(StudyError, match=r"record\.utilisation\.material_factor = 1\.3: must be >= 1\.45"):
        study_with(outputs, text=thin)


def test_tasks_without_them_are_what_they_were(study_with):
    """Ids go by what acts: not on a fixed platform, and the file by its content."""
    bare = {name: task.id for name, task in tasks(study_with()).items()}
    assert {name: task.id for name, task in tasks(study_with(member="distributed_load = [0, 0, 0.0]")).items()} == bare
    loaded = {name: task.id for name, task in tasks(study_with(LOADED)).items()}
    assert loaded["fixed"] == bare["fixed"]
    assert not {loaded["elastic"], loaded["elastic-no-floats"]} & set(bare.values())
    other = {name: task.id for name, task in tasks(study_with(LOADED, wind=WIND.replace("300", "301"))).items()}
    assert other["fixed"] == loaded["fixed"] and other["elastic"] != loaded["elastic"]


@pytest.mark.parametrize(
    ("more", "wind", "planar"),
    [
        ("[current]\nspeed = 1.0\n", WIND, True),
        ("[current]\nspeed = 1.0\ndirection = 3.141592653589793\n", WIND, True),
        ("[current]\nspeed = 1.0\ndirection = 0.1\n", WIND, False),
        ('[[platform.load_histories]]\nnode = "hinge:front"\nfile = "wind.csv"\n', WIND, True),
        ('[[platform.load_histories]]\nnode = "hinge:front"\nfile = "wind.csv"\n', WIND.replace("Fz", "Fy"), False),
        ('[[platform.masses]]\nnode = "hinge:front"\nmass = 100.0\n', WIND, True),
        ('[[platform.masses]]\nnode = "hinge:front"\nmass = 100.0\ncog = [0.0, 0.5, 0.0]\n', WIND, False),
    ],
)
def test_pipeline_and_solver_agree_on_what_is_planar(study_with, more, wind, planar):
    task = tasks(study_with(more, wind=wind))["elastic"]
    assert geometry_of(task.parameters).planar == scenes.scene(task.parameters).planar == planar


def test_a_speed_is_an_axis(study_with):
    study = study_with("[current]\nspeed = 0.0\n", text=SMALL.replace("[axes]", '[axes]\n"current.speed" = [0.5, 1.0]'))
    speeds = {t.parameters.current.speed for t in expand(study.content) if t.parameters.platform}
    assert speeds == {0.5, 1.0}


@pytest.mark.parametrize(
    ("more", "wind", "message"),
    [
        ("[current]\ndirection = 1.0\n", WIND, r"current\.speed = nothing: is missing"),
        ("[current]\nspeed = -1.0\n", WIND, r"current\.speed = -1\.0: must be >= 0 m/s"),
        (LOADED, "time\n0\n", r'wind\.csv: needs a column of Fx, Fy, Fz in its header'),
        (LOADED, "time, Fx, Mx\n0, 1, 2\n", r'wind\.csv: line 1: column Mx must be one of time, Fx, Fy, Fz'),
        (LOADED, "time, Fx, Fx\n0, 1, 2\n", r'wind\.csv: line 1: column Fx is there 2 times'),
        (LOADED, "time, Fx\n0, 1, 2\n", r'wind\.csv: line 2: has 3 cells, its header names 2 columns'),
        (LOADED, "time, Fx\n0, 1\n1, x\n", r"wind\.csv: line 3, column Fx: 'x' must be a finite number"),
        (LOADED, "Fx\n1\n", r"wind\.csv: line 1: needs a column time in its header"),
        (LOADED, "time, Fx [kN]\n0, 1\n", r"line 1, column Fx: needs its unit, \[N\], not \[kN\]"),
        (LOADED, "time, Fx\n0, 1\n10, 1\n", r"time = 0 to 10 s: must last from 0 to 3700 s"),
        (LOADED, "time, Fx\n5, 1\n5, 1\n", r"front\.file = wind\.csv: line 3, column time: 5 must be > 5, the one"),
        (LOADED, "# gusts\nFx, time [s]\n0, 0\n\n1, 10000.02\n# then\n0, 10000.01\n0, 9999\n",
         r"line 7, column time: 10000\.01 must be > 10000\.02, the one before"),
        (LOADED.replace('"hinge:front"', '"keel"'), WIND, r"load_histories\[0\]\.node = keel: must be one of foot"),
        (LOADED.replace("wind.csv", "gale.csv"), WIND, r"no such file: .*gale\.csv"),
        (LOADED.replace("0.1", "-0.1"), WIND, r"marine_growth\[0\]\.thickness = -0\.1: must be >= 0 m"),
        (LOADED.replace("depth = 30.0", "depth = 0.0"), WIND, r"current\.profile\[1\]\.depth = 0\.0: must be > 0 m"),
        (LOADED + '[solver]\nmethod = "frequency"\n', WIND, r'needs method = "time"'),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_by_file_and_key(study_with, more, wind, message):
    with pytest.raises(StudyError, match=message):
        study_with(more, wind=wind)


def test_a_current_needs_a_platform(study_with):
    text = SMALL[: SMALL.index("[platform]")] + "[sea_states]\ncalm = { Hs = 0.5, Tp = 5.0 }\n"
    with pytest.raises(StudyError, match=r"current = given: acts on the members of an elastic platform"):
        study_with("[current]\nspeed = 1.0\n", text=text)


@pytest.mark.parametrize("asked", ['modes = "all"', 'accuracy = "reference"', "axis"])
def test_all_modes_of_a_large_frame_are_refused_before_anything_runs(study_with, monkeypatch, asked):
    """With what is odd about it: elements that nobody gave are many where a stiffness is too small by a slip."""
    monkeypatch.setattr(modes, "MOST", 20)
    text = SMALL.replace("E = 2.1e11", "E = 2.1e5").replace('"elastic", "fixed", ', "")
    axis = '[axes]\n"solver.modes" = ["all", 6]'
    text = text.replace("[axes]", axis) if asked == "axis" else text + f"[solver]\n{asked}\n"
    study = study_with(text=text)
    with pytest.raises(StudyError) as caught:
        judge(study, study.tasks, Engine())
    refused, *told = caught.value.problems
    assert "solver.modes = all: needs a frame of at most 20 degrees of freedom: this one has 24" in refused
    assert "warning: platform: its buckling_factor is " in told[0] and "a slip of units" in told[1]
    monkeypatch.setattr(modes, "MOST", 24)
    assert len(judge(study, study.tasks, Engine())) == len(told)
