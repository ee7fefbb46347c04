"""Floats on joints of every kind, from a study file to the solver's scene."""

import re
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.bridge import engine, hulls, preflight, pto_law, scenes
from pipeline.bridge.engine import Engine
from pipeline.bridge.geometry import bem_arguments, bem_time, geometry_of
from pipeline.bridge.loading import load
from pipeline.study.hulls import Profile, Ring
from pipeline.study.reading import StudyError
from pipeline.tasks.task import dimensions, expand
from solver.record.channels import Record
from solver.scene import PER_AXIS

TEXT = """
[water]
depth = 50.0
[waves]
band = [0.5, 3.0]
{waves}
[[floats]]
name = "only"
hull = {{ shape = "sphere", radius = 1.0, draft = 1.0 }}
mass = 2147.0
inertia = [859.0, 859.0, 859.0]
{keys}
[sea_states]
only = {{ Hs = 0.5, Tp = 5.0 }}
"""
FREE = 'hinge = [0.0, 0.0, 0.0]\nmotion = ["surge", "heave", "pitch"]\n'
HINGED = "hinge = [-2.0, 0.0, 2.0]\narm = [2.0, 0.0, -2.0]\n"


@pytest.fixture
def study_with(tmp_path):
    """A study of one float with these keys."""

    def made(keys, waves=""):
        path = tmp_path / "joint.toml"
        path.write_text(TEXT.format(keys=keys, waves=waves))
        return load(path)

    return made


def task(study):
    return next(iter(expand(study.content)))


def test_all_that_belongs_to_a_joint_reaches_the_solver(study_with):
    keys = FREE + (
        "pto_damping = [1.0, 2.0, 3.0]\ndamping = [0.0, 5.0, 0.0]\n"
        "critical_damping = [0.25, 0.0, 0.0]\nquadratic_damping = [7.0, 0.0, 8.0]\n"
        "stiffness = [1e3, 0.0, 0.0]\nmechanism_inertia = [0.0, 0.0, 9.0]\noffset = [0.0, -0.5, 0.1]\n"
        "preload = [4.0, 0.0, -4.0]\ncoulomb = [0.0, 6.0, 0.0]\nforce_limit = [1e3, 2e3, 3e3]\none_way = [0, 1, -0.5]\n"
        "latch_load = [0.0, 0.0, 5e3]\n"
        "end_stops = { lower = [-1.0, -2.0, 0.0], upper = [1.0, 2.0, 0.0], stiffness = [1e6, 1e7, 0.0] }\n"
    )
    (item,) = scenes.scene(task(study_with(keys)).parameters).floats
    assert item.motion == ("surge", "heave", "pitch")
    values = {name: item.per_axis(name).tolist() for name in PER_AXIS}
    assert values == {
        "pto_damping": [1, 2, 3],
        "pto_stiffness": [0, 0, 0],
        "damping": [0, 5, 0],
        "critical_damping": [0.25, 0, 0],
        "quadratic_damping": [7, 0, 8],
        "stiffness": [1e3, 0, 0],
        "mechanism_inertia": [0, 0, 9],
        "offset": [0, -0.5, 0.1],
        "preload": [4, 0, -4],
        "coulomb": [0, 6, 0],
        "force_limit": [1e3, 2e3, 3e3],
        "declutch_load": [np.inf] * 3,
        "latch_load": [0, 0, 5e3],
        "one_way": [0, 1, -0.5],
        "end_stops.lower": [-1, -2, 0],
        "end_stops.upper": [1, 2, 0],
        "end_stops.stiffness": [1e6, 1e7, 0],
        "end_stops.damping": [0, 0, 0],
    }


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("", 'motion = ["hinge"]'),
        ("damping = 3.0", "damping = [3.0]"),
        ("damping = 0.0", "damping = [0.0]"),
        ("offset = -0.1", "offset = [-0.1]"),
        (
            "end_stops = { lower = -1, upper = 1, stiffness = 1e6 }",
            "end_stops = { lower = [-1.0], upper = [1.0], stiffness = [1e6], damping = 0.0 }",
        ),
        ("", "arm = [2.0, 0.0, -2.0]"),
    ],
)
def test_two_spellings_of_one_joint_are_one_task(study_with, one, other):
    base = HINGED if "arm" not in other else HINGED.splitlines()[0] + "\n"
    first = base + one if "arm" not in other else HINGED
    assert task(study_with(first)).id == task(study_with(base + other)).id


@pytest.mark.parametrize(
    ("keys", "waves", "planar"),
    [
        (HINGED, "", True),
        (HINGED, f"heading = {np.pi}", True),
        (HINGED, "heading = 0.1", False),
        (HINGED + "axis = [0.0, 2.0, 0.0]", "", True),
        (HINGED + "axis = [1.0, 2.0, 0.0]", "", False),
        (HINGED + "cog = [0.0, 0.1, 0.0]", "", False),
        (FREE, "", True),
        (FREE + "axis = [1.0, 0.0, 0.0]", "", True),
        (FREE.replace('"pitch"', '"roll"'), "", False),
        (FREE.replace('"surge"', '"sway"'), "", False),
        (FREE.replace('"surge"', '"yaw"'), "", False),
    ],
)
def test_pipeline_and_solver_agree_on_what_is_planar(study_with, keys, waves, planar):
    """Else a scene would get coefficients without the motions that it needs."""
    first = task(study_with(keys, waves))
    assert geometry_of(first.parameters).planar == scenes.scene(first.parameters).planar == planar


def test_an_axis_of_pto_damping_is_for_floats_with_one_axis(study_with, tmp_path):
    one = study_with(HINGED + "pto_damping = 5.0\n[axes]\npto_damping = [1.0, 2.0]")
    assert [t.parameters.floats[0].pto_damping for t in expand(one.content)] == [1.0, 2.0]
    assert "pto_damping" in dimensions(one.content)
    single = r'axes.pto_damping = .*: needs floats with a single axis, and only has several: vary "floats.only.pto_damp'
    with pytest.raises(StudyError, match=single):
        study_with(FREE + "[axes]\npto_damping = [1.0, 2.0]")
    assert "pto_damping" not in task(study_with(FREE + "pto_damping = [1.0, 2.0, 3.0]")).labels


@pytest.mark.parametrize("also", ["pto_damping = 5.0", "[axes]\npto_damping = [1.0, 2.0]"])
def test_a_motion_that_names_an_axis_twice_is_refused_for_that_alone(study_with, also):
    with pytest.raises(StudyError) as told:
        study_with(FREE.replace('"surge"', '"heave"') + also)
    (problem,) = told.value.problems
    assert "floats.only.motion = " in problem and "must name each axis once" in problem


def test_a_float_out_of_equilibrium_is_told_of_and_not_refused(study_with):
    study = study_with(HINGED)
    assert preflight.judge(study, expand(study.content), Engine()) == []
    study.path.write_text(study.path.read_text().replace("mass = 2147.0", "mass = 2200.0"))
    heavy = load(study.path)
    (told,) = preflight.judge(heavy, expand(heavy.content), Engine())
    assert "floats.only" in told and "2200 kg" in told and "2146.75 kg" in told


def test_lines_and_efficiency_reach_the_solver_and_leave_other_ids_alone(study_with):
    plain = task(study_with(FREE)).id
    keys = FREE + (
        "pto_stiffness = [0, -2e3, 0]\npto_efficiency = { generating = 0.9, motoring = 0.8 }\n"
        "mooring = { stiffness = [[1e4, 0, -3e3], [0, 0, 0], [-3e3, 0, 5e4]], pretension = [100, 0, 0] }\n"
    )
    (item,) = scenes.scene(task(study_with(keys)).parameters).floats
    assert item.per_axis("pto_stiffness").tolist() == [0, -2e3, 0]
    assert (item.pto_efficiency.generating, item.pto_efficiency.motoring) == (0.9, 0.8)
    assert item.moored.stiffness.tolist() == [[1e4, 0, -3e3], [0, 0, 0], [-3e3, 0, 5e4]]
    assert (item.moored.pretension.tolist(), item.mooring.damping) == ([100, 0, 0], None)
    assert task(study_with(keys)).id != plain == task(study_with(FREE + "pto_stiffness = [0.0, 0.0, 0.0]")).id
    axis = '\n[axes]\n"floats.only.mooring.stiffness" = [[[1.0]], [[2.0]]]\n'
    moored = study_with(HINGED + "mooring = { stiffness = [[1.0]] }" + axis)
    found = [scenes.scene(t.parameters).floats[0].moored.stiffness[0, 0] for t in expand(moored.content)]
    assert found == [1.0, 2.0]


def test_a_table_comes_from_a_file_by_its_content(study_with, tmp_path):
    def written(text, name="load.csv", more=""):
        (tmp_path / name).write_text(text)
        return study_with(f'{HINGED}pto_table = {{ file = "{name}" }}\n{more}')

    text = "velocity [rad/s], force [N m]\n0, 0\n0.5, 2e4\n1.0, 3e4\n"
    study = written(text)
    (item,) = scenes.scene(task(study).parameters).floats
    _, rates, loads = item.pto_points[0]
    assert [rates.tolist(), loads[0].tolist()] == [[-1, -0.5, 0, 0.5, 1], [-3e4, -2e4, 0, 2e4, 3e4]]
    assert task(written(text, "other.csv")).id == task(study).id != task(written(text.replace("2e4", "1e4"))).id
    for wrong, message in [
        ("velocity [km/h], force [N]\n0, 0\n", "line 1, column velocity: needs its unit, [m/s] or [rad/s]"),
        ("velocity, force\n0, x\n", "line 2, column force: 'x' must be a finite number"),
        ("velocity, force\n0, 0\n1, -2\n", "floats.only.pto_table.force = -2.0: must take power"),
    ]:
        with pytest.raises(StudyError) as caught:
            written(wrong)
        assert message in str(caught.value)
    in_frequency = '[solver]\nmethod = "frequency"\n'
    assert scenes.scene(task(written(text, more=in_frequency)).parameters).settings.method == "frequency"
    with pytest.raises(StudyError, match=r'pto_table = given: needs method = "time"'):
        written(text.replace("0, 0\n", "-1.0, -1e4\n0, 0\n"), more=in_frequency)


def test_a_table_by_position_comes_from_a_file_in_any_order(study_with, tmp_path):
    lines = ["0.5, -1, -3e4", "-0.5, 0, 0", "-0.5, 1, 1e4", "0.5, 1, 2e4", "0.5, 0, 5e2", "-0.5, -1, -1e4"]
    (tmp_path / "load.csv").write_text("position [rad], velocity [rad/s], force [N m]\n" + "\n".join(lines))
    study = study_with(f'{HINGED}pto_table = {{ file = "load.csv" }}\n')
    y, v, f = scenes.scene(task(study).parameters).floats[0].pto_points[0]
    assert (y.tolist(), v.tolist()) == ([-0.5, 0.5], [-1, 0, 1]) and f.tolist() == [[-1e4, 0, 1e4], [-3e4, 5e2, 2e4]]
    for wrong in (lines[:-1], [*lines, lines[0]], [*lines[:-1], lines[0]]):
        (tmp_path / "load.csv").write_text("position, velocity, force\n" + "\n".join(wrong))
        with pytest.raises(StudyError, match=r"needs one load for each of 3 velocities at each of 2 positions; has"):
            study_with(f'{HINGED}pto_table = {{ file = "load.csv" }}\n')


LAW = "import math\ndef load(y, dy, c=3e4):\n    return c * (1 + y * y) * math.tanh(dy / 0.3)\n"


def test_a_law_of_ones_own_becomes_a_table_within_its_error(study_with, tmp_path):
    """Anywhere, also between the points that it was made of; a task goes by the file's content and the parameters."""

    def written(text, more="", name="law.py"):
        (tmp_path / name).write_text(text)
        return study_with(f'{HINGED}pto_law = {{ file = "{name}", velocity = [-1, 1]{more} }}\n')

    study = written(LAW, ", position = [-0.8, 0.6], error = 0.02")
    y, v, f = scenes.scene(task(study).parameters).floats[0].pto_points[0]
    largest, dice = 3e4 * 1.64 * np.tanh(1 / 0.3), np.random.default_rng(0)
    for at in dice.uniform((-0.8, -1), (0.6, 1), (300, 2)):
        got = np.interp(at[0], y, [np.interp(at[1], v, row) for row in f])
        assert got == pytest.approx(3e4 * (1 + at[0] ** 2) * np.tanh(at[1] / 0.3), abs=0.02 * largest)
    assert y.size < 10 and v.size < 20 and 0 in v
    flat = written(LAW, ", parameters = [1e4]")
    y, v, f = scenes.scene(task(flat).parameters).floats[0].pto_points[0]
    assert y.size == 0 and f[0][-1] == pytest.approx(1e4 * np.tanh(1 / 0.3), rel=1e-12)
    ids = [task(written(text, ", parameters = [1e4]", name)).id for text, name in
           ((LAW, "law.py"), (LAW, "other.py"), (LAW + "# another\n", "law.py"))]  # fmt: skip
    assert ids[0] == ids[1] == task(flat).id != ids[2]
    assert task(written(LAW, ", parameters = [2e4]")).id != ids[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("def load(y, dy) return dy", "cannot be run: SyntaxError"),
        ("raise SystemExit(3)", "cannot be run: SystemExit: 3"),
        ("def lode(y, dy): return dy", "needs a function load(y, dy)"),
        ("def load(y): return y", "load(0, -1) fails: TypeError"),
        ("def load(y, dy): return 1 / dy", "load(0, 0) fails: ZeroDivisionError"),
        ("def load(y, dy): return float('nan')", "load(0, -1) must be a finite number, is nan"),
        ("def load(y, dy): return [dy]", "load(0, -1) must be a finite number, is [-1.0]"),
        ("def load(y, dy): return (dy > 0) - (dy < 0)", "the grid's points the table misses it by 0.5 of its"),
        ("def load(y, dy): return -dy", "floats.only.pto_law.force = 1.0: must take power"),
    ],
)  # fmt: skip
def test_a_law_that_is_none_is_refused(study_with, tmp_path, text, message):
    (tmp_path / "law.py").write_text(text)
    with pytest.raises(StudyError) as caught:
        study_with(f'{HINGED}pto_law = {{ file = "law.py", velocity = [-1, 1] }}\n')
    assert message in str(caught.value) and "floats.only.pto_law." in str(caught.value)


@pytest.mark.parametrize(
    ("text", "keys", "most", "table"),
    [
        ("30 * dy**3", "velocity = [-4, 4], error = 1e-4", 8e-5, "a table of 100 lines of velocity"),
        ("dy * (1 + y**4)", "velocity = [-1, 1], position = [-3, 3], error = 1e-4", 8e-5, "100 lines of position"),
        ("dy + dy * (abs(dy - 0.0025) < 2e-3)", "velocity = [0, 2], error = 1e-3", 1e-3, "between the grid's points"),
    ],
)
def test_a_law_that_a_table_misses_is_refused_by_the_limit_that_it_is_over(
    study_with, tmp_path, text, keys, most, table
):
    """A hair above it, too: what is between the grid's points needs a part of the error."""
    (tmp_path / "law.py").write_text(f"def load(y, dy): return {text}\n")
    with pytest.raises(StudyError, match=table) as caught:
        study_with(f'{HINGED}pto_law = {{ file = "law.py", {keys} }}\n')
    missed, limit = re.findall(r"(?:misses it by|must be <=) ([\d.e-]+)", str(caught.value))
    assert float(missed) >= float(limit) == pytest.approx(most)
    assert "narrower range of velocity or position, or a larger `error`" in str(caught.value)


@pytest.mark.parametrize("law", ["while True: pass\n", "def load(y, dy):\n    while True: pass\n"])
def test_a_law_that_does_not_return_is_refused(study_with, tmp_path, monkeypatch, law):
    monkeypatch.setattr(pto_law, "LONGEST", 0.2)
    (tmp_path / "law.py").write_text(law)
    with pytest.raises(StudyError, match=r"TimeoutError: the law's table takes longer than 0.2 s"):
        study_with(f'{HINGED}pto_law = {{ file = "law.py", velocity = [-1, 1] }}\n')


@pytest.mark.parametrize("ends", ["velocity = [1, -1]", "velocity = [1, 1]", "velocity = [-1, 1], position = [1, -1]"])
def test_a_law_is_followed_from_the_least_to_the_largest(study_with, tmp_path, ends):
    (tmp_path / "law.py").write_text(LAW)
    with pytest.raises(StudyError, match=r"floats\.only\.pto_law\.\w+ = \[1.*\]: must increase"):
        study_with(f'{HINGED}pto_law = {{ file = "law.py", {ends} }}\n')


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("velocity = [-1, 1] }\npto_damping = 1e4", "floats.only.pto_law = given: needs pto_damping to be left out"),
        ("velocity = [0.5, 1] }", "floats.only.pto_law.velocity = [0.5, 1.0]: must begin at 0"),
        ("velocity = [-1, 1], axis = 'heave' }", "floats.only.pto_law.axis = heave: must be one of hinge"),
    ],
)
def test_what_a_law_may_not_be_is_said_of_the_law(study_with, keys, message, tmp_path):
    """Not of the table that is made of it, and with numbers as a study file has them."""
    (tmp_path / "law.py").write_text("def load(y, dy): return dy\n")
    with pytest.raises(StudyError) as caught:
        study_with(f'{HINGED}pto_law = {{ file = "law.py", {keys}\n')
    assert message in str(caught.value)


def test_forces_of_power_take_offs_need_no_platform(study_with):
    study = study_with(HINGED + '[record]\noutputs = ["pto_force"]\n')
    assert scenes.scene(task(study).parameters).settings.outputs == ("pto_force",)
    with pytest.raises(StudyError, match=r"record.outputs = \['reactions'\]: are of an elastic platform"):
        study_with(HINGED + '[record]\noutputs = ["pto_force", "reactions"]\n')


BAD = [
    ('motion = ["heave", "heave"]', "floats.only.motion = ['heave', 'heave']: must name each axis once"),
    ('motion = ["heaves"]', "floats[0].motion[0] = 'heaves': must be one of 'hinge', 'surge'"),
    ('motion = "heave"', "floats[0].motion = 'heave'"),
    ('motion = ["hinge", "pitch"]', "floats.only.motion = ['hinge', 'pitch']: must turn about different axes"),
    ("axis = [0.0, 0.0, 0.0]", "floats.only.axis = [0.0, 0.0, 0.0]: must not be zero"),
    ("damping = -1.0", "floats[0].damping = -1.0: must be >= 0 N m s/rad or N s/m"),
    ("damping = [1.0, 2.0]", "floats.only.damping = [1.0, 2.0]: needs one number for each of hinge"),
    ("damping = [-1.0]", "floats[0].damping[0] = -1.0: must be >= 0 N m s/rad"),
    ("offset = [1.0, 2.0]", "floats.only.offset = [1.0, 2.0]: needs one number for each of hinge"),
    ('offset = "up"', "floats[0].offset = 'up': must be a number [rad or m]"),
    ("stiffness = []", "floats[0].stiffness"),
    ("end_stops = { lower = -1.0, upper = 1.0 }", "floats[0].end_stops.stiffness"),
    (
        "end_stops = { lower = -1.0, upper = 1.0, stiffness = -1.0 }",
        "floats[0].end_stops.stiffness = -1.0: must be >= 0 N m/rad or N/m",
    ),
    (
        "end_stops = { lower = 1.0, upper = -1.0, stiffness = 1.0 }",
        "floats.only.end_stops.lower = 1.0: must be < upper",
    ),
    (
        "end_stops = { lower = -1, upper = [1, 2], stiffness = 1.0 }",
        "floats.only.end_stops.upper = [1.0, 2.0]: needs one number for each of hinge",
    ),
    (
        "mooring = { stiffness = [[1.0, 0.0]] }",
        "floats.only.mooring.stiffness = [[1.0, 0.0]]: must be square, with 1 rows as `stiffness` has",
    ),
    (
        "mooring = { stiffness = [[1.0, 0.0], [0.0, 1.0]] }",
        "floats.only.mooring.stiffness = [[1.0, 0.0], [0.0, 1.0]]: must be 1 x 1, for hinge, or 6 x 6",
    ),
    ('mooring = { stiffness = [["a"]] }', "floats[0].mooring.stiffness[0][0] = 'a': must be a number"),
    (
        "mooring = { stiffness = [] }",
        "floats.only.mooring.stiffness = []: must have rows: one for each axis, or six",
    ),
    ("mooring = { stiffness = 3.0 }", "floats[0].mooring.stiffness = 3.0: must be a list"),
    ("mooring = { pretension = [1.0] }", "floats[0].mooring.stiffness: is missing"),
    ("pto_efficiency = { generating = 0.0 }", "floats[0].pto_efficiency.generating = 0.0: must be > 0"),
    ("pto_efficiency = { motoring = 1.2 }", "floats[0].pto_efficiency.motoring = 1.2: must be <= 1"),
    ("pto_stiffness = -1.0\nforce_limit = 4.0", "floats.only.pto_stiffness = -1.0: must be 0 beside a force_limit"),
    ("force_limit = 0.0", "floats[0].force_limit = 0.0: must be > 0 N m or N"),
    ("force_limit = -inf", "floats[0].force_limit = -inf: must be > 0 N m or N"),
    ("coulomb = 5.0\nforce_limit = 4.0", "floats.only.coulomb = 5.0: must be < force_limit"),
    ("one_way = 2", "floats[0].one_way = 2: must be <= 1"),
    ("mechanism_inertia = nan", "floats[0].mechanism_inertia = nan: must be a finite number [kg m2 or kg]"),
]


@pytest.mark.parametrize(("keys", "message"), BAD, ids=[row[0] for row in BAD])
def test_bad_joints_are_refused_in_one_line(study_with, keys, message):
    with pytest.raises(StudyError) as caught:
        study_with(HINGED + keys)
    assert any(message in line for line in caught.value.problems), caught.value.problems


def test_all_that_is_wrong_is_told_at_once_and_once(study_with):
    """Each key of a float, and of a platform that no task of the study has."""
    platform = """
[axes]
platform = ["fixed"]
[platform]
nodes = { foot = [0.0, 0.0, -51.0] }
materials = { steel = { E = 2.1e11, G = 8.33e10, density = 8012.0 } }
sections = { pipe = { shape = "tube", diameter = 1.0, thickness = 0.6 } }
members = [
    { name = "leg", start = "foot", end = "top", section = "pipe", material = "steel" },
    { name = "arm", start = "foot", end = "foot", section = "tube", material = "steel" },
]
clamped = ["foot"]
"""
    with pytest.raises(StudyError) as caught:
        study_with(HINGED + "damping = [1.0, 2.0]\noffset = [1.0, 2.0]" + platform)
    keys = [line.split(": ", 1)[1].split(" = ")[0] for line in caught.value.problems]
    assert keys == [
        "floats.only.damping",
        "floats.only.offset",
        "platform.sections.pipe.thickness",
        "platform.members.arm.section",
    ]
    path = caught.value.problems[0].split(": ")[0]
    text = (
        Path(path)
        .read_text()
        .replace("thickness = 0.6", "thickness = 0.1")
        .replace('section = "tube"', 'section = "pipe"')
    )
    Path(path).write_text(text.replace("[1.0, 2.0]", "1.0"))
    with pytest.raises(StudyError) as caught:
        load(Path(path))
    assert [line.split(": ", 1)[1].split(" = ")[0] for line in caught.value.problems] == ["platform.members.arm.end"]


DUCK = """
[[floats]]
name = "rotor"
on = "only"
hull = { shape = "duck", radius = 1.2, beak = 2.4, elevation = 0.5, submergence = 0.6, width = 3.0 }
mass = 5e3
cog = ["balance", 0.0, -0.5]
inertia = [6e3, 4e3, 6e3]
hinge = [-5.0, 0.0, -0.6]
arm = [0.0, 0.0, 0.6]
"""


def test_mass_and_place_are_found_and_told(study_with, monkeypatch):
    """A carrier that bears its rotor; the geometry is that of the same floats with numbers."""
    study = study_with(FREE + DUCK)
    path = study.path
    path.write_text(path.read_text().replace("mass = 2147.0", 'mass = "balance"\ncog = ["balance", "balance", -0.1]'))
    parameters = task(load(path)).parameters
    carrier, rotor = scenes.scene(parameters).floats
    lift, away = 1025 * rotor.hull.volume - 5e3, hulls.offset(parameters.floats[1].hull)  # of what the study gives
    assert rotor.mass == 5e3 and away[0] + rotor.cog[0] == pytest.approx(1025 * rotor.hull.volume * away[0] / 5e3)
    assert carrier.mass == pytest.approx(1025 * carrier.hull.volume + lift)
    assert carrier.cog == pytest.approx((-5.0 * lift / carrier.mass, 0.0, -0.1)) and carrier.cog[1] == 0.0
    assert geometry_of(parameters).key == geometry_of(task(study).parameters).key
    bare = Record(variables={}, coords={}, attrs={})
    monkeypatch.setattr(engine, "simulate", lambda scene, known: bare)
    told = engine.compute(parameters, None).variables
    assert told["mass"][0] == ("float",) and told["mass"][1].tolist() == [carrier.mass, 5e3]
    assert told["cog"][0] == ("float", "direction")
    assert told["cog"][1].tolist() == [[*carrier.cog], [*(rotor.cog + away)]]
    assert engine.compute(task(study_with(FREE)).parameters, None) is bare


def test_a_float_that_is_held_has_its_preload_told(study_with, monkeypatch):
    """And moves as with that preload as a number; the others' are told beside it."""
    study = study_with(FREE + DUCK.replace('"balance"', "0.4"))
    before = task(study)
    study.path.write_text(study.path.read_text().replace("arm = [0.0, 0.0, 0.6]", "arm = [0.0, 0.0, 0.6]\nhold = true"))
    held = task(load(study.path))
    assert held.id != before.id
    carrier, rotor = scenes.scene(held.parameters).floats
    lever = 1025 * rotor.hull.volume * hulls.offset(held.parameters.floats[1].hull)[0] - 5e3 * 0.4
    assert rotor.preload == pytest.approx((9.81 * lever,))  # up at a lever along x turns towards -y
    assert np.all(carrier.per_axis("preload") == 0)
    monkeypatch.setattr(engine, "simulate", lambda scene, known: Record(variables={}, coords={}, attrs={}))
    told = engine.compute(held.parameters, None)
    dims, load_ = told.variables["preload"]
    at = [told.coords["axis"].tolist().index("hinge")]
    assert dims == ("float", "axis") and load_[1, at] == pytest.approx(rotor.preload) and np.isnan(load_[0, at])
    fixed = task(study_with(FREE.replace('"surge", "heave", "pitch"', "") + "hold = true\n"))  # has no axis
    assert not engine.compute(fixed.parameters, None).variables


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mass = 2147.0", 'mass = "balanced"', r"floats[0].mass = 'balanced': must be a number [kg], or 'balance'"),
        ("mass = 2147.0", "mass = 0.0", "floats[0].mass = 0.0: must be > 0 kg"),
        (
            "mass = 2147.0",
            'mass = "balance"\non = "only"',
            "floats.only.on = only: must name a float that",
        ),
        (
            "only = { Hs",
            'low = { Hs = 0.1, Tp = 6.0 }\ncalm = { kind = "still" }\nonly = { Hs',
            "solver.method = frequency: needs waves: a decay is a matter of the time domain",
        ),
        ('["balance", 0.0, -0.5]', '[0.0, 0.0, "balance"]', "floats[1].cog[2] = 'balance': must be a number"),
        ("mass = 5e3", "mass = 8e5", "floats.only.mass = balance: leaves nothing"),
        ("beak = 2.4", "beak = 1.1", "floats.rotor.hull.beak = 1.1: must be > radius, 1.2 m"),
        ("elevation = 0.5", "elevation = 2.0, sides = 8", "floats[1].hull.sides = 8: unknown key"),
    ],
)
def test_what_cannot_be_balanced_or_built_is_refused_with_the_key(study_with, old, new, message):
    path = study_with(FREE + DUCK, '\n[variants.a]\n[variants.b]\nsolver.method = "frequency"\n[variants.c]').path
    path.write_text(path.read_text().replace(old, new, 1))
    if "leaves nothing" in message:
        path.write_text(path.read_text().replace("mass = 2147.0", 'mass = "balance"'))
    with pytest.raises(StudyError) as caught:
        preflight.judge(study := load(path), expand(study.content), Engine())
    assert message in str(caught.value)


@pytest.mark.parametrize(("count", "memory"), [(8, True), (9, False)])
def test_the_frequency_domain_of_a_large_array_has_no_memory_fitted(study_with, count, memory):
    """Of three motions a float that there are; smaller scenes share one file with the time domain."""
    path = study_with(FREE).path
    text = path.read_text()
    first = text[text.index("[[floats]]") : text.index("[sea_states]")]
    more = [
        first.replace('"only"', f'"f{i}"').replace("[0.0, 0.0, 0.0]", f"[0.0, {9.0 * i}, 0.0]", 1)
        for i in range(1, count)
    ]
    text = text.replace("[sea_states]", "".join(more) + "[sea_states]")
    geometries = []
    for method in ("time", "frequency"):
        path.write_text(f'{text}\n[solver]\nfroude_krylov = "linear"\nmethod = "{method}"\n')
        geometries.append(geometry_of(task(load(path)).parameters))
    time, frequency = geometries
    assert time.memory and frequency.memory is memory and (time.key == frequency.key) is memory


def test_the_memory_is_of_the_motions_that_a_float_can_have(study_with, monkeypatch):
    """Those are part of the file's name, unless they are all; what is solved for and what radiates is the same."""
    guided = geometry_of(task(study_with(FREE.replace('"surge", "heave", "pitch"', '"heave"'))).parameters)
    free = geometry_of(task(study_with(FREE)).parameters)
    hinged = geometry_of(task(study_with(HINGED)).parameters)
    assert (free.needed, guided.needed, hinged.needed) == ((), (("heave",),), ())
    assert guided.key != free.key and guided.radiating == free.radiating
    assert "needed" not in free.model_dump(exclude_defaults=True)
    still = geometry_of(task(study_with("hinge = [0.0, 0.0, 0.0]\nmotion = []\n")).parameters)
    assert still.needed == ((),)
    fits = unsolved(monkeypatch)
    turned = guided.model_copy(update={"heading": 0.5})
    known = engine._known([free, guided, turned], [None])
    assert [k.memory for k in known] == [1, 2, 2] and [ways for _, ways in fits] == [(), (("heave",),)]
    assert known[1].memory_motions == (("heave",),)
    assert [k.omega.size for k in known] == [9, 8, 8]  # as the memory has it


def test_waves_of_other_periods_share_what_radiates(study_with, monkeypatch):
    """Solved at the same frequencies; the memory, which is sought up to the waves', is of each.

    What rings is of each heading, too, whichever others there are: its forces judge that.
    """
    free = geometry_of(task(study_with(FREE)).parameters)
    slow, fast, faster = (free.model_copy(update={"band": band}) for band in ((1.0, 2.0), (2.0, 4.0), (4.0, 60.0)))
    assert slow.key != fast.key and slow.radiating == fast.radiating != faster.radiating
    fits = unsolved(monkeypatch)
    known = engine._known([slow, fast, slow.model_copy(update={"heading": 0.5})], [None])
    assert [k.waves_to for k in known] == [2.0, 4.0, 2.0]
    assert [k.rings for k in known] == [(x, f"shifted {x}") for x in ("2 towards 0", "4 towards 0", "2 towards 0.5")]
    assert [(h.waves_to, h.heading) for h, _ in fits] == [(2.0, slow.heading), (4.0, slow.heading)]


@dataclass
class Unsolved:
    """Coefficients of one heading that nobody asks for."""

    heading: float
    waves_to: float = np.inf
    memory: int = 0
    memory_tolerance: float = 0.0
    memory_motions: tuple = ()
    rings: tuple = ()
    added: str = ""
    omega: np.ndarray = field(default_factory=lambda: np.arange(9.0))

    def first(self, count):
        return replace(self, omega=self.omega[:count])

    @property
    def ringing(self):
        return f"{self.added}{self.waves_to:g} towards {self.heading:g}"

    @property
    def shifted(self):
        return replace(self, added="shifted ")


def unsolved(monkeypatch):
    """Coefficients and motions that memories are fitted to from now on, which nothing is solved for."""
    from solver.coupled import preparation
    from solver.hydrodynamics.bem import bem

    fits = []
    monkeypatch.setattr(bem, "united", lambda problem, _: list(map(Unsolved, problem.headings)))

    def remembering(h, _hulls, ways):
        fits.append((h, ways))
        return replace(h.first(9 - len(ways)), memory=len(fits), memory_motions=ways)

    monkeypatch.setattr(preparation, "remembering", remembering)
    return fits


def test_what_neither_radiates_nor_diffracts_is_not_solved(study_with, monkeypatch):
    """Waves' pressure and buoyancy are those of the whole solution; no memory is fitted, nothing is foreseen."""
    from solver.hydrodynamics.bem import bem

    whole = task(study_with(FREE)).parameters
    off = 'radiation = false\ndiffraction = false\nfroude_krylov = "linear"\n'
    bare = geometry_of(task(study_with(FREE, waves=f"[solver]\n{off}")).parameters)
    assert bare.key != geometry_of(whole).key and bem_time(bare) == 0
    solved = bem.solve(**bem_arguments(geometry_of(whole)) | {"omega": np.array([0.8, 1.2]), "panels": 108})
    monkeypatch.setattr(bem, "_coefficients", lambda *_, **__: pytest.fail("solved"))
    fits = []
    monkeypatch.setattr("solver.coupled.preparation.remembering", lambda *given: fits.append(given))
    known = engine.hydrodynamics(bare)
    assert not fits and not known.added_mass.any() and not known.radiation_damping.any() and not known.diffraction.any()
    assert known.hydrostatic_stiffness == pytest.approx(solved.hydrostatic_stiffness)
    there = known.excitation(solved.omega, "froude_krylov")
    assert there == pytest.approx(solved.froude_krylov, rel=1e-3, abs=1e-3 * np.abs(there).max())
    assert known.mesh_error == 0


def test_a_hull_with_a_plate_has_other_coefficients_than_before(study_with):
    """Its panels are others; those of hulls without are not, nor is the name of their file."""
    text = task(study_with(FREE)).parameters
    plain = geometry_of(text)
    disc = [(9.0, -12.0), (9.0, -11.9), (1.0, -11.9), (1.0, 1.0)]
    hull = Profile(shape="profile", points=disc)
    spar = geometry_of(text.model_copy(update={"floats": (text.floats[0].model_copy(update={"hull": hull}),)}))
    assert spar.plates and "plates" in spar.model_dump(exclude_defaults=True)
    assert not plain.plates and "plates" not in plain.model_dump(exclude_defaults=True)


def test_a_hull_with_a_well_has_other_coefficients_than_before(study_with):
    """Its lid and panels are others; the name of other hulls' file stays."""
    text = task(study_with(FREE)).parameters
    plain = geometry_of(text)
    hull = Ring(shape="ring", points=[(9.0, -2.0), (9.0, 1.0), (4.0, 1.0), (4.0, -2.0)])
    well = geometry_of(text.model_copy(update={"floats": (text.floats[0].model_copy(update={"hull": hull}),)}))
    assert well.outlines and "outlines" in well.model_dump(exclude_defaults=True)
    assert not plain.outlines and "outlines" not in plain.model_dump(exclude_defaults=True)


def test_without_need_of_a_memory_none_is_fitted(study_with, monkeypatch):
    from solver.hydrodynamics.bem import bem

    monkeypatch.setattr(bem, "part", lambda *arguments: [])
    fits = unsolved(monkeypatch)
    geometry = geometry_of(task(study_with(FREE)).parameters)
    known = engine.hydrodynamics(geometry.model_copy(update={"memory": False}))
    assert isinstance(known, Unsolved) and not fits and known.rings
