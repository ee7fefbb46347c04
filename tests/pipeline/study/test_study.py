"""Bad input: one line that names file, key, value and limit; exit status 2; no traceback."""

import math
import re
import tomllib

import pytest
from typer.testing import CliRunner

from pipeline.bridge import checks
from pipeline.bridge.loading import load
from pipeline.cli.cli import app
from pipeline.study.reading import StudyError
from pipeline.study.schema import StudyFile
from tests.pipeline.conftest import BUAN, SMALL

# what to replace in the small study, by what, and what the message must say
BAD = [
    ("depth = 50.0", "depth = -1.0", "water.depth = -1.0: must be > 0 m"),
    ("depth = 50.0", 'depth = "deep"', "water.depth = 'deep': must be a number [m]"),
    ("depth = 50.0", "depth = nan", "water.depth = nan: must be > 0 m"),
    ("depth = 50.0", "depth = true", "water.depth = True: must be a number [m]"),
    ("depth = 50.0", "", "water.depth: is missing [m]"),
    (
        "[waves]",
        "[waves]\nspreading = 10",
        "waves.spreading = 10: unknown key; waves are long-crested, and a sea has one",
    ),
    (
        "sea_state = [",
        'method = ["time", "frequency"]\nsea_state = [',
        ' together, and any other by its dotted path in quotes, "solver.method"',
    ),
    ("depth = 50.0", "depht = 50.0", "water.depht = 50.0: unknown key; did you mean depth?"),
    (
        "depth = 50.0",
        "depth = 0.9",
        "floats.front.hull = a draft of 1 m: must stay above the seabed, 0.9 m",
    ),
    ("[water]", "[watre]", "watre = {'depth': 50.0}: unknown key; did you mean water?"),
    ("[water]", "[water", "is not valid TOML"),
    ("band = [0.7, 3.4]", "band = [3.4, 0.7]", "waves.band = [3.4, 0.7]: must rise"),
    ("band = [0.7, 3.4]", "band = [0.7]", "waves.band"),
    (
        "[water]",
        '[record]\nseries = "decimated"\n[solver]\nmethod = "frequency"\nfroude_krylov = "linear"\n[water]',
        "record.series = decimated: needs to be left out with method",
    ),
    (
        "band = [0.7, 3.4]",
        "band = [0.7, 3.4]\ncomponents = 0",
        "waves.components = 0: must be >= 1",
    ),
    (
        "band = [0.7, 3.4]",
        "band = [0.7, 3.4]\ncomponents = 1.5",
        "waves.components = 1.5: must be a whole number",
    ),
    (
        "band = [0.7, 3.4]",
        'band = [0.7, 3.4]\nform = "peek"',
        "waves.form = 'peek': must be one of 'peak' or 'mean'",
    ),
    (
        "band = [0.7, 3.4]",
        "band = [0.7, 1.0]",
        "sea_states.calm.Tp = 5.0: must put the peak, 1.26 rad/s, inside",
    ),
    (
        "Hs = 2.0, Tp = 7.0",
        "Hs = 12.0, Tp = 7.0",
        "sea_states.rough.Hs = 12.0: must be <= 10.9 m, where waves of 7 s",
    ),
    ("Hs = 2.0, Tp = 7.0", "Hs = 0.0, Tp = 7.0", "sea_states.rough.Hs = 0.0: must be > 0 m"),
    ("Hs = 2.0, Tp = 7.0", "Hs = 2.0", "sea_states.rough.Tp: is missing [s]"),
    (
        'shape = "hemisphere-cylinder"',
        'shape = "cube"',
        "floats[0].hull.shape = 'cube': must be one of",
    ),
    ("radius = 1.0, height = 0.6", "radius = 1.0", "floats[0].hull.height: is missing [m]"),
    (
        "radius = 1.0, height",
        "radius = -1.0, height",
        "floats[0].hull.radius = -1.0: must be > 0 m",
    ),
    ('name = "front"', 'name = "frönt"', "floats[0].name = 'frönt': must be ASCII letters, digits, '_'"),
    ("mass = 2147.0", "mass = 0", "floats[0].mass = 0: must be > 0 kg"),
    (
        "[859.0, 859.0, 859.0]",
        "[859.0, 1.0, 1.0]",
        "floats.front.inertia = [859.0, 1.0, 1.0]: must meet the triangle",
    ),
    (
        "arm = [-2.36, 0.0, -2.6]",
        "arm = [-2.36, 0.0, -2.0]",
        "floats.front.arm = [-2.36, 0.0, -2.0]: must bring",
    ),
    (
        "arm = [-2.36, 0.0, -2.6]",
        "arm = [-2.36, 0.0, -52.6]",
        "lowest point at z = -51 m, depth 50 m",
    ),
    (
        "arm = [-2.36, 0.0, -2.6]",
        "arm = [0.0, 0.0, -2.6]\naxis = [0.0, 0.0, 1.0]",
        "must not lie along the hinge axis",
    ),
    (
        "pto_damping = 100e3",
        "pto_damping = -1.0",
        "floats[0].pto_damping = -1.0: must be >= 0 N m s/rad",
    ),
    (
        "thickness = 0.05",
        "thickness = 0.6",
        "platform.sections.tube.thickness = 0.6: must be <= diameter / 2 = 0.5 m",
    ),
    ("thickness = 0.05", "thickness = 0.05\nshear_factor = 0", "shear_factor = 0: must be > 0"),
    (
        'start = "foot"',
        'start = "fot"',
        "platform.members.leg.start = fot: must be one of foot, hinge:front",
    ),
    (
        'section = "tube"',
        'section = "pipe"',
        "platform.members.leg.section = pipe: must be one of tube",
    ),
    (
        'material = "steel"',
        'material = "wood"',
        "platform.members.leg.material = wood: must be one of steel",
    ),
    ('clamped = ["foot"]', "clamped = []", "platform.clamped = []: needs at least one node"),
    ('clamped = ["foot"]', 'clamped = ["feet"]', "platform.clamped[0] = feet: must be one of"),
    ('clamped = ["foot"]', "", "platform.clamped = []: needs at least one node, or one on a foundation"),
    (
        'clamped = ["foot"]',
        "foundation = { foot = [1e8, 1e8, 1e8, 0, 1e9, 1e9] }",
        "platform.foundation = foot: must hold what stands on it, which is free to turn about x",
    ),
    (
        'clamped = ["foot"]',
        "foundation = { foot = [1e8, 1e8, 1e8, 1e9, 1e9] }",
        "platform.foundation.foot[5]: is missing",
    ),
    (
        'clamped = ["foot"]',
        "foundation = { foot = [[1, 2], [3]] }",
        "platform.foundation.foot[0][2]: is missing",
    ),
    (
        'legs = ["leg"]',
        "damping_ratio = 0.01\nrayleigh_mass = 0.05",
        "platform.damping_ratio = 0.01: must be 0 or left out beside rayleigh_mass",
    ),
    ('legs = ["leg"]', 'legs = ["arm"]', "platform.legs[0] = arm: must be one of leg"),
    (
        "foot = [-1.5, 0.0, -50.0]",
        "foot = [-1.5, 0.0, -51.0]",
        "must not lie below the seabed, z = -50 m",
    ),
    (
        "foot = [-1.5, 0.0, -50.0]",
        "foot = [-1.5, 0.0, -50.0]\nlost = [0.0, 0.0, 0.0]",
        "platform.nodes = lost: must be joined to a clamped node by members",
    ),
    (
        "elements = 4",
        'elements = 4\nend_release = ["Mx"]',
        "platform.members[0].end_release[0] = 'Mx': must be one of 'N', 'Vy', 'Vz', 'T', 'My' or 'Mz'",
    ),
    (
        "elements = 4",
        'elements = 4\nstart_release = ["My"]',
        "platform.members = leg: with their releases leave hinge:front free to move along",
    ),
    ("elements = 4", "elements = 0", "platform.members[0].elements = 0: must be >= 1"),
    (
        'sea_state = ["calm", "rough"]',
        'sea_state = ["clam"]',
        "axes.sea_state = clam: must be one of [sea_states]",
    ),
    (
        'sea_state = ["calm", "rough"]',
        'sea_state = ["calm", "calm"]',
        "axes.sea_state = calm: given 2 times",
    ),
    (
        '"elastic", "fixed", "elastic-no-floats"',
        '"elastic", "fxed"',
        "axes.platform[1] = 'fxed': must be one of",
    ),
    ("seed = [0, 1]", "seed = []", "axes.seed = []: needs at least one value"),
    ("seed = [0, 1]", "seed = [-1]", "axes.seed[0] = -1: must be >= 0"),
    (
        "seed = [0, 1]",
        "seed = [0]\nhinge_spacing = [3.0]",
        "axes.hinge_spacing = [3.0]: needs exactly 2 floats, and the study has 1",
    ),
    (
        "[axes]",
        "[solver]\ntime_step = 0.5\n[axes]",
        "solver.time_step = 0.5: must be <= 0.308 s, a sixth of the",
    ),
    (
        "[axes]",
        "[solver]\ntimestep = 0.5\n[axes]",
        "solver.timestep = 0.5: unknown key; did you mean time_step?",
    ),
    (
        "[axes]",
        "[record]\nramp = 200.0\n[axes]",
        "record.ramp = 200.0: must be <= record.discard = 100 s",
    ),
    (
        "[axes]",
        "[record]\ndiscard = 0\n[axes]",
        "record.ramp = 50.0: must be <= record.discard = 0 s, as it is where none is given",
    ),
    ("[axes]", "[record]\nduration = 0\n[axes]", "record.duration = 0: must be >= 1 s"),
]


def test_the_frequency_domain_has_no_ramp(small):
    text = small.read_text()
    small.write_text(text.replace("[axes]", '[record]\ndiscard = 0\n[solver]\nmethod = "frequency"\n[axes]', 1))
    assert load(small).content.record.ramp == 50.0


@pytest.mark.parametrize(
    ("axis", "more", "refused"),
    [
        ('"still"', "", False),
        ('"still", "calm"', "", True),
        ('"still"', '[variants.waves]\n"sea_states.still" = { kind = "regular", height = 1, period = 8 }\n', True),
        ('"still"', '[variants.stiller]\n"floats.front.pto_damping" = 2e5\n', False),
    ],
)
def test_still_water_has_no_ramp(small, axis, more, refused):
    """Of the seas that there are tasks in, as variants have them."""
    text = small.read_text().replace('"calm", "rough"', axis).replace("[axes]", "[record]\ndiscard = 0\n[axes]")
    small.write_text(text.replace("[sea_states]", '[sea_states]\nstill = { kind = "still" }') + more)
    if refused:
        with pytest.raises(StudyError, match=r"record\.ramp = 50\.0: must be <= record\.discard = 0 s"):
            load(small)
    else:
        assert load(small).content.record.discard == 0


@pytest.mark.parametrize(("old", "new", "message"), BAD, ids=[row[1][:40] for row in BAD])
def test_bad_study_is_refused_in_one_line(small, old, new, message):
    text = small.read_text()
    assert old in text
    small.write_text(text.replace(old, new, 1))
    with pytest.raises(StudyError) as caught:
        load(small)
    assert any(line.startswith(f"{small}: ") and message in line for line in caught.value.problems)


def test_a_number_out_of_its_range_is_not_told_that_it_is_no_word(small):
    small.write_text(small.read_text() + "\n[solver]\nmodes = 0\n")
    with pytest.raises(StudyError) as caught:
        load(small)
    assert caught.value.problems == [f"{small}: solver.modes = 0: must be >= 1"]


@pytest.mark.parametrize("ratio", ["", "damping_ratio = 0.0\n"])
def test_rayleighs_damping_may_stand_alone(small, ratio):
    text = small.read_text()
    small.write_text(text.replace('legs = ["leg"]', f"{ratio}rayleigh_stiffness = 0.01"))
    assert all(
        t.parameters.platform.rayleigh_stiffness == 0.01 for t in load(small).tasks if t.parameters.platform is not None
    )
    variants = "[variants.ratio]\n'platform.damping_ratio' = 0.02\n[variants.rayleigh.platform]\nrayleigh_mass = 0.05\n"
    small.write_text(text.replace("[sea_states", variants + "[sea_states", 1))
    assert load(small).tasks
    small.write_text(small.read_text().replace('legs = ["leg"]', "damping_ratio = 0.01"))
    with pytest.raises(StudyError, match=r"variant = rayleigh: platform\.damping_ratio = 0\.01: must be 0 or left out"):
        load(small)


def test_a_platform_is_judged_also_where_no_task_has_one(small):
    text = small.read_text().replace('"elastic", "fixed", "elastic-no-floats"', '"fixed"')
    small.write_text(text.replace("elements = 4", 'elements = 4\nstart_release = ["My"]'))
    with pytest.raises(StudyError, match="leave hinge:front free to move"):
        load(small)


def test_each_place_of_the_hinges_is_judged(tmp_path):
    """Seas and seeds are judged from the file; floats meet in the second place alone."""
    path, text = tmp_path / "near.toml", BUAN.read_text()
    inwards = text.replace("arm = [-2.36", "arm = [+2.36").replace("arm = [2.36", "arm = [-2.36")
    for spacing in ("[8.0]", "[8.0, 6.0]"):
        path.write_text(inwards.replace("[axes]", f"[axes]\nhinge_spacing = {spacing}"))
        if "6.0" in spacing:
            with pytest.raises(StudyError, match=r"distance of floats\.front and floats\.rear"):
                load(path)
        else:
            load(path)


def test_missing_file_names_its_neighbours(small):
    with pytest.raises(StudyError, match=re.escape(f"no such file; {small.parent} has small.toml")):
        load(small.with_name("smal.toml"))
    for name in ("small-2", "big", "dim", "deep", "other"):
        small.with_name(f"{name}.toml").touch()
    with pytest.raises(StudyError, match=r"has deep\.toml, \w+\.toml, \S+\.toml and 3 others$"):
        load(small.with_name("dep.toml"))


def test_a_folder_is_no_study(tmp_path):
    with pytest.raises(StudyError, match="cannot be read"):
        load(tmp_path)


def test_binary_is_no_study(tmp_path):
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(StudyError, match="not UTF-8"):
        load(tmp_path / "b.toml")


@pytest.mark.parametrize("command", ["plan", "run", "status", "collect", "report", "verify", "clean"])
def test_every_verb_refuses_bad_input_alike(small, tmp_path, command):
    small.write_text(small.read_text().replace("depth = 50.0", "depth = -1.0"))
    result = CliRunner().invoke(app, [command, str(small), "--results", str(tmp_path / "r")])
    assert isinstance(result.exception, StudyError)  # main() prints it and exits with 2
    assert not (tmp_path / "r").exists()


def test_a_limit_of_one_axis_leaves_the_others_without(tmp_path):
    """TOML's inf, in the file, in the task's identity, and as what a number must not be otherwise."""

    def read(limit):
        path = tmp_path / "s.toml"
        motion = 'pto_damping = [1e4, 1e4]\nmotion = ["surge", "heave"]\nstiffness = [1e4, 0.0]\n'
        text = SMALL.replace("pto_damping = 100e3\n", motion + limit).replace(
            '["elastic", "fixed", "elastic-no-floats"]', '["fixed"]'
        )
        path.write_text(text)
        return load(path)

    found = read("force_limit = [inf, 2e4]\n")
    assert {task.parameters.floats[0].force_limit for task in found.tasks.unique} == {(math.inf, 2e4)}
    ids = [
        {t.id for t in read(limit).tasks.unique}
        for limit in ("force_limit = [inf, 2e4]\n", "force_limit = [inf, 3e4]\n", "")
    ]
    assert not ids[0] & ids[1] and not ids[0] & ids[2]
    for limit, words in (
        (
            "[nan, 1e300]",
            [r"force_limit\[0\] = nan: must be > 0 N m or N", r"force_limit\[1\] = 1e\+300: must be <= 1e\+20"],
        ),
        ("[-inf, 1.0]", [r"force_limit\[0\] = -inf: must be > 0"]),
        ("[]", [r"force_limit = \[\]: must have 1 at least"]),
    ):
        with pytest.raises(StudyError) as error:
            read(f"force_limit = {limit}\n")
        assert len(error.value.problems) == len(words)
        assert all(re.search(word, text) for word, text in zip(words, error.value.problems, strict=True))


@pytest.mark.parametrize("axes", [{}, {"floats.rear.pto_damping": [1e4, 2e4]}, {"left_out": [["rear"], []]}])
def test_a_name_that_two_floats_have_is_all_that_is_told(axes):
    """Not that the frame has no node for the other one, nor that what is said of it leads nowhere."""
    tables = tomllib.loads(BUAN.read_text())
    tables["floats"][1]["name"] = "front"
    tables["axes"] |= axes
    told = checks.problems(StudyFile.model_validate(tables))
    assert [str(problem) for problem in told] == ["floats.name = front: given 2 times, must be unique"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("depth = 50.0", 'depth = 50.0\n"a\\u001b[31m\\nb\\u202e" = 1'), r"water.a\x1b[31m\nb\u202e = 1: unknown key"),
        (('name = "leg"\nstart', 'name = "leg"\n"ü\\n" = 1\nstart'), r"members[0].ü\n = 1: unknown key"),
    ],
)
def test_keys_that_would_steer_a_terminal_are_spelled_out(tmp_path, change, message):
    path = tmp_path / "small.toml"
    path.write_text(SMALL.replace(*change))
    with pytest.raises(StudyError) as caught:
        load(path)
    assert message in str(caught.value) and str(caught.value).isprintable()


@pytest.mark.parametrize("sign", ["", "-"])
def test_a_number_of_too_many_digits_is_called_that(tmp_path, sign):
    path = tmp_path / "small.toml"
    path.write_text(SMALL.replace("depth = 50.0", f"depth = {sign}{'9' * 400}"))
    with pytest.raises(StudyError, match=r"\.\.\.: has too many digits for a number \[m\]$"):
        load(path)


@pytest.mark.parametrize(("letter", "most"), [("n", 241), ("ü", 120)])
def test_a_name_is_as_long_as_files_named_after_it_may_be(tmp_path, letter, most):
    for count in (most, most + 1):
        (path := tmp_path / f"{letter * count}.toml").write_text(SMALL)
        if count == most:
            assert load(path).published is None
            continue
        with pytest.raises(StudyError, match="must have at most 241 bytes"):
            load(path)


@pytest.mark.parametrize("verb", ["plan", "run", "collect", "status"])
@pytest.mark.parametrize("place", ["r", "r/small"])
def test_results_in_a_link_to_nothing_are_refused(tmp_path, verb, place):
    """Before anything runs."""
    path, link = tmp_path / "small.toml", tmp_path / place
    path.write_text(SMALL)
    link.parent.mkdir(exist_ok=True)
    link.symlink_to(tmp_path / "nowhere" / "x")
    told = CliRunner().invoke(app, [verb, str(path), "--results", str(tmp_path / "r")])
    assert str(told.exception) == f"{path}: --results = {link}: must be a folder, and is a link to nothing"
