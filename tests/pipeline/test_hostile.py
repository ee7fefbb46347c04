"""Input that wants to crash, hang or escape: file, key, value and limit on a line, exit status 2, nothing written."""

import os
import subprocess
from pathlib import Path

import empty
import kills
import pytest

from pipeline.bridge.loading import load
from pipeline.cli import cli
from pipeline.study.reading import StudyError

BARGE = Path(__file__).parents[2].joinpath("studies", "barge.gdf").read_text().splitlines()
HULL = 'hull = { shape = "hemisphere-cylinder", radius = 1.0, height = 0.6 }'
MESH = 'hull = { shape = "mesh", file = "hull.%s" }'
CALM = "calm = { Hs = 0.5, Tp = 5.0 }"
SEA = 'calm = { kind = "%s", file = "sea.csv" }'
BAND = "band = [0.7, 3.4]"
MEMBER = (
    '[[platform.members]]\nname = "m%d"\nstart = "foot"\nend = "hinge:front"\nsection = "tube"\nmaterial = "steel"\n'
)
FLOAT = '[[floats]]\nname = "f%d"\nhull = { shape = "sphere", radius = 1.0, draft = 1.0 }\nmass = 1.0\n'
FLOAT += "inertia = [1.0, 1.0, 1.0]\nhinge = [%d.0, 0.0, 0.0]\n"


def solver(line):
    return ("[axes]", f"[solver]\n{line}\n[axes]")


def record(line):
    return ("[axes]", f"[record]\n{line}\n[axes]")


def gdf(corner):
    """The barge with another number in its first panel."""
    words = BARGE[4].split()
    return {"hull.gdf": "\n".join([*BARGE[:4], " ".join([corner, *words[1:]]), *BARGE[5:]])}


# what to replace in the small study, by what; files beside it; and what the message must say
TABLE = [
    # counts
    (
        solver("time_step = 1e-9"),
        {},
        "solver.time_step = 1e-09: must be >= 0.00037 s, or 3700 s take more than 10000000",
    ),
    (solver("time_step = 1e-308"), {}, "solver.time_step = 1e-308: must be >= 1e-20 s"),
    (solver("time_step = 5e-324"), {}, "solver.time_step = 5e-324: must be >= 1e-20 s"),
    (record("duration = 1e300"), {}, "record.duration = 1e+300: must be <= 1e+06 s"),
    (record("duration = 1e7"), {}, "record.duration = 10000000.0: must be <= 1e+06 s"),
    (record('outputs = ["tears"]'), {}, "record.outputs[0] = 'tears': must be one of 'reactions', 'section_forces'"),
    (record("[record.fatigue]\nscf = 0"), {}, "record.fatigue.scf = 0: must be > 0"),
    (record('[record.fatigue]\ncurve = "Z"'), {}, "record.fatigue.curve = 'Z': must be one of 'B1', 'B2', 'C'"),
    (solver("azimuths = 1_000_000_000"), {}, "solver.azimuths = 1000000000: must be <= 1000"),
    (solver("arc_points = 1001"), {}, "solver.arc_points = 1001: must be <= 1000"),
    (solver("modes = 1_000_000"), {}, "solver.modes = 1000000: must be <= 1000"),
    (solver("panel_size = 1e-9"), {}, "solver.panel_size = 1e-09: must be >= 0.01"),
    (solver("newton_tolerance = 1e-300"), {}, "solver.newton_tolerance = 1e-300: must be >= 1e-14"),
    (solver("newton_tolerance = 1e-16"), {}, "solver.newton_tolerance = 1e-16: must be >= 1e-14"),
    (solver("memory_tolerance = 1.0"), {}, "solver.memory_tolerance = 1.0: must be < 1"),
    ((BAND, BAND + "\ncomponents = 1_000_000_000"), {}, "waves.components = 1000000000: must be <= 10000"),
    (("elements = 4", "elements = 10_001"), {}, "platform.members[0].elements = 10001: must be <= 1000"),
    (
        ("[axes]", "".join(MEMBER % i + "elements = 1000\n" for i in range(11)) + "[axes]"),
        {},
        "platform.members = 11004 elements: must be <= 10000",
    ),
    (
        ("[platform]", "".join(FLOAT % (i, 9 * i) for i in range(101)) + "[platform]"),
        {},
        "floats = 102 floats: must be",
    ),
    (
        ("seed = [0, 1]", f"seed = {list(range(2000))}\npto_damping = {[float(i) for i in range(2000)]}"),
        {},
        "axes = 24000000 tasks: must be <= 10000000: split the study",
    ),
    (("seed = [0, 1]", f"seed = [{'9' * 4000}]"), {}, "axes.seed[0] = 9999"),
    (("depth = 50.0", f"depth = {'9' * 5000}"), {}, "is not valid TOML: Exceeds the limit (4300 digits)"),
    # sizes
    (("depth = 50.0", "depth = 1e308"), {}, "water.depth = 1e+308: must be <= 100000 m, or inf"),
    (("depth = 50.0", "depth = 1e-300"), {}, "water.depth = 1e-300: must be >= 1e-20 m"),
    (("depth = 50.0", "depth = 50.0\ngravity = 1e308"), {}, "water.gravity = 1e+308: must be <= 1e+20 m/s2"),
    (("hinge = [-1.5", "hinge = [-1e200"), {}, "floats[0].hinge[0] = -1e+200: must be >= -1e+20 m"),
    (
        ("pto_damping = 100e3", "pto_damping = inf"),
        {},
        "floats[0].pto_damping = inf: must be a finite number [N m s/rad",
    ),
    (("pto_damping = 100e3", "stiffness = 1e308"), {}, "floats[0].stiffness = 1e+308: must be <= 1e+20 N m/rad"),
    (("Tp = 5.0", "Tp = 1e-19"), {}, "sea_states.calm.Tp = 1e-19: must be >= 0.0628 s"),
    (("Tp = 5.0", "Tp = 1e19"), {}, "sea_states.calm.Tp = 1e+19: must be <= 60 s"),
    (("mass = 2147.0", "mass = 1979-05-27"), {}, "floats[0].mass = datetime.date(1979, 5, 27): must be a number [kg]"),
    # files
    ((HULL, MESH % "gdf"), gdf("1e300"), "hull.file = hull.gdf: has a corner at 1e+300 m, must be within 100000 m"),
    ((HULL, MESH % "gdf"), gdf("nan"), "hull.file = hull.gdf: has coordinates that are not finite numbers"),
    ((HULL, MESH % "stl"), {"hull.stl": "vertex 1 1 -1e99 " * 3}, "hull.stl: has a corner at 1e+99 m"),
    ((HULL, MESH % "stl"), {"hull.stl": "\0" * 84}, "hull.stl: holds no panels"),
    (
        (CALM, SEA % "components"),
        {"sea.csv": "omega,amplitude,phase\n1,1e308,0"},
        "column amplitude: '1e308' must be <=",
    ),
    (
        (CALM, SEA % "components"),
        {"sea.csv": "omega,amplitude,phase\n1,1e19,0"},
        "sea_states.calm.file: Hm0 = 2.83e+19: ",
    ),
    (
        (CALM, SEA % "components"),
        {"sea.csv": "omega,amplitude,phase\n1e-300,1,0"},
        "frequencies must be >= 1e-06 rad/s",
    ),
    ((CALM, SEA % "spectrum"), {"sea.csv": "omega,S\n1,inf\n2,1"}, "line 2, column S: 'inf' must be a finite number"),
    (
        (CALM, SEA % "elevation"),
        {"sea.csv": "time,elevation\n" + "0,1e300\n" * 9},
        "elevation: '1e300' must be <= 1e+20",
    ),
    ((CALM, SEA.replace("sea.csv", "/dev/zero") % "elevation"), {}, "sea_states.calm.file = '/dev/zero': no such file"),
    ((CALM, SEA.replace("sea.csv", "x" * 5000) % "elevation"), {}, "cannot be read: File name too long"),
    # structure
    (("[axes]", f"[{'.'.join('a' * 1000)}]\nb = 1\n[axes]"), {}, "is not a study: tables are nested more than 20 deep"),
    (
        ("[water]", f"[waves.{'.'.join('a' * 1000)}]\n[water]"),
        {},
        "is not a study: tables are nested more than 20 deep",
    ),
    (
        ("[water]", f"title = {'[' * 300}{']' * 300}\n[water]"),
        {},
        "is not a study: tables are nested more than 20 deep",
    ),
    (("[water]", f"title = {'[' * 9000}{']' * 9000}\n[water]"), {}, "is not valid TOML: nested too deeply"),
    (("[water]", f'title = "{"x" * 10**6}"\n[water]'), {}, "title = 'xxxxx"),
    (("[water]", 'title = "\\u001b[31m"\n[water]'), {}, "title = '\\x1b[31m': must be one line, without control"),
    (('name = "front"', f'name = "{"x" * 10**5}"'), {}, "must have at most 100 characters"),
    (("[waves]\n" + BAND, "[[waves]]\n" + BAND), {}, "waves = [{'band': [0.7, 3.4]}]: must be a table"),
    (('legs = ["leg"]', 'legs = ["leg", "leg"]'), {}, "platform.legs = leg: given 2 times, must be unique"),
    (("[water]", "\0[water]"), {}, "is not valid TOML"),
    # bases
    (("[water]", 'base = "small.toml"\n[water]'), {}, "base = 'small.toml': must be another study file"),
    (("[water]", 'base = ""\n[water]'), {}, "base = '': must be the path of a study file"),
    (("[water]", f'base = "{"x" * 5000}"\n[water]'), {}, "cannot be read: File name too long"),
    (("[water]", 'base = "/dev/zero"\n[water]'), {}, "base = '/dev/zero': no such file"),
    (("[water]", 'base = "."\n[water]'), {}, "base = '.': is a folder"),
    (("[water]", 'base = "loop"\n[water]'), {}, "base = 'loop': no such file"),
    (
        ("[water]", 'base = "0.toml"\n[water]'),
        {f"{i}.toml": f'base = "{i + 1}.toml"' for i in range(999)},
        "at most 20 files may stand on each other",
    ),
]


@pytest.fixture
def refused(monkeypatch, capsys):
    """What `study plan FILE` says when it refuses; it is one line for each problem, and nothing else."""

    def told(path):
        results = path.parent / "results"
        monkeypatch.setattr("sys.argv", ["study", "plan", "--results", str(results), "--", str(path)])
        with pytest.raises(SystemExit) as exit_:
            cli.main()
        out, err = capsys.readouterr()
        assert (exit_.value.code, out) == (2, "")
        assert not results.exists()
        return err

    return told


@pytest.mark.parametrize(("change", "files", "message"), TABLE, ids=[row[2][:50] for row in TABLE])
def test_hostile_input_is_refused_in_a_line(small, refused, change, files, message):
    old, new = change
    assert old in small.read_text()
    small.write_text(small.read_text().replace(old, new, 1))
    small.with_name("loop").symlink_to("loop")
    for name, text in files.items():
        small.with_name(name).write_text(text)
    told = refused(small)
    assert any(message in line and line.startswith(str(small.parent)) for line in told.splitlines()), told
    assert max(map(len, told.splitlines())) < 1000


@pytest.mark.parametrize("name", ["..", "-x", ".hidden", "hydrodynamics", "Hydrodynamics", "x\ny", "a\\b", "*", ""])
def test_a_study_whose_name_is_no_folder_of_its_own_is_refused(small, refused, name):
    """results/<name> would be above the results, the coefficients', hidden, or an option of the next command."""
    path = small.rename(small.with_name(f"{name}.toml"))
    assert f": name = {path.stem!r}: " in refused(path)


@pytest.mark.parametrize("name", ["été 2019", "2019", "_x", "a.b", "x-y"])
def test_other_names_are_for_the_user_to_choose(small, name):
    assert load(small.rename(small.with_name(f"{name}.toml"))).name == name


def test_what_is_no_file_is_no_study(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "loop.toml").symlink_to("loop.toml")
    (tmp_path / "large.toml").write_bytes(b"#" * 10_000_001)
    for name, why in {"pipe": "is no regular file", "loop": "Too many levels", "large": "has 10 MB"}.items():
        with pytest.raises(StudyError, match=f"cannot be read: {why}"):
            load(tmp_path / f"{name}.toml")
    with pytest.raises(StudyError, match="cannot be read: is no regular file"):
        load(Path("/dev/zero"))


def test_a_float_given_twice_on_a_base_is_not_chosen_from(small):
    child = small.with_name("child.toml")
    child.write_text('base = "small.toml"\n' + '[[floats]]\nname = "front"\nmass = 3.0\n' * 2)
    with pytest.raises(StudyError, match=r"floats\[1\]"):
        load(child)
    child.write_text('base = "small.toml"\n[[floats]]\nname = ["front"]\n')
    with pytest.raises(StudyError, match=r"floats\[0\].name = \['front'\]: must be a string"):
        load(child)


def test_a_mark_of_byte_order_is_no_text(small):
    plain = load(small).content
    small.write_bytes(b"\xef\xbb\xbf" + small.read_bytes())
    assert load(small).content == plain


@pytest.mark.slow
def test_letters_that_a_locale_lacks(tmp_path):
    path = empty.study(tmp_path, 1)
    path.write_text('title = "Überlast µ 波"\n' + path.read_text(), encoding="utf-8")
    c = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": ""}
    env = {**kills.environment(), **c}
    for verb in ("plan", "run", "show", "report"):
        words = kills.command(verb, path, *(["seed=0"] if verb == "show" else []), "--results", tmp_path / "results")
        done = subprocess.run(words, env=env, capture_output=True, text=True, timeout=120)
        told = [
            line for line in done.stderr.splitlines() if not line.startswith("compiling the solver")
        ]  # if it is new
        assert (done.returncode, told) == (0, []), verb
    path.write_text(path.read_text(encoding="utf-8").replace("depth = 50.0", 'depth = "波"'), encoding="utf-8")
    done = subprocess.run(kills.command("plan", path), env=env, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert "water.depth = '\\u6ce2': must be a number [m]" in done.stderr


@pytest.mark.parametrize("name", ["", "summary.pdf", "summary"])
def test_a_figure_has_a_name_of_its_format(small, name, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["study", "report", str(small), "--figure", name])
    with pytest.raises(SystemExit) as exit_:
        cli.main()
    assert exit_.value.code == 2
    assert "--figure" in capsys.readouterr().err
