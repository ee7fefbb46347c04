"""Moving pictures: at rest they are the sketch, they have the frames and the time that were asked for."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image, ImageSequence
from pytest import approx
from typer.testing import CliRunner

from pipeline.bridge import scenes
from pipeline.bridge.replay import Replay
from pipeline.cli import actions, cli
from pipeline.cli.actions import Filming
from pipeline.report import animation, sketch
from pipeline.report.drawing import plain
from pipeline.study.reading import StudyError
from pipeline.study.settings import Recording
from pipeline.tasks.select import find
from pipeline.tasks.task import expand
from solver.coupled.preparation import prepare

BARE = "[solver]\nradiation = false\ndiffraction = false\ntime_step = 0.05\n"
SHORT = "[record]\nduration = 4.0\ndiscard = 2.0\nramp = 2.0\n"
TIDY = {"start": None, "seconds": None, "speed": 1.0, "fps": 10.0, "magnify": 1.0}


@pytest.fixture
def bare(small):
    """The small study, without boundary elements and short."""
    small.write_text(small.read_text() + SHORT + BARE)
    return small


def still(content, platform, count=1, magnify=1.0):
    """A task's scene, and where it stays in still water as the sketch has it."""
    scene = next(t for t in expand(content) if t.labels["platform"] == platform).parameters
    system = prepare(scenes.scene(scene), None)
    z = np.zeros((count, system.bodies.mechanism.size))
    times, p = np.arange(float(count)) - count, np.zeros((count, system.structure.omega.size))
    return scene, Replay(parameters=scene, system=system, times=times, z=z, p=p, magnify=magnify)


@pytest.mark.parametrize("platform", ["elastic", "fixed"])
def test_at_rest_the_picture_is_the_sketch(study_of, buan_tables, platform):
    """All that moves is where the report's figure has it; of members along their elements, too."""
    buan_tables |= {"solver": {"radiation": False, "diffraction": False}, "waves": buan_tables["waves"]}
    buan_tables["sea_states"] = {name: {"kind": "still"} for name in buan_tables["sea_states"]}
    buan_tables["record"] = {"duration": 60.0, "discard": 0.0, "ramp": 0.0}
    content = study_of(buan_tables).content
    scene, replay = still(content, platform)
    with plain():
        film = animation.Film(scene, replay, "buan")
        _, views = sketch.views(scene, sketch.about_water(scene))
        (pose,) = replay.poses()
        film.show(0, pose)
    assert len(film.views) == len(views) == (2 if platform == "elastic" else 1)
    for shown, drawn in zip(film.views, views, strict=True):
        for kind in ("hulls", "arms"):
            for one, other in zip(getattr(shown, kind), getattr(drawn, kind), strict=True):
                assert np.array(one.get_path().vertices) == approx(np.array(other.get_path().vertices), abs=1e-12)
        dots = [[np.array(view.hinges[n].get_xydata()) for n in (0, 1)] for view in (shown, drawn)]
        assert np.array(dots[0]) == approx(np.array(dots[1]))
        names = [[text.xy for text in view.names.values()] for view in (shown, drawn)]
        assert np.array(names[0]) == approx(np.array(names[1]), abs=1e-3)
        for one, other in zip(shown.members, drawn.members, strict=True):
            corners = [np.array(bar.get_path().vertices) for bar in (one, other)]
            assert np.ptp(corners[0], axis=0) == approx(np.ptp(corners[1], axis=0), abs=1e-12)
            assert len(corners[0]) >= len(corners[1])
    assert all(not crests.any() for crests in film.crests)


def test_waves_and_members_are_where_they_are_at_that_time(bare):
    """On both sides of a bent leg its points have moved alike, and those at its foot not at all."""
    scene, replay = still(cli.load(bare).content, "elastic", count=3)
    p = np.array([[0.0], [1.0], [2.0]]) * np.full(replay.p.shape[1], 2000.0)
    replay = dataclasses.replace(replay, times=np.array([40.0, 41.0, 42.0]), p=p)
    with plain():
        film = animation.Film(scene, replay, "bent")
        for number, pose in enumerate(replay.poses()):
            film.show(number, pose)
            (bar,), (moved,) = film.views[1].members, pose.members
            change = np.array(bar.get_xy())[:-1] - film.rest[0]
            assert change == approx(np.concatenate([moved, moved[::-1]])) and not change[[0, -1]].any()
            assert (np.abs(change[len(moved) - 1]).max() > 1.0) == (number > 0)
            left, right = film.views[1].axes.get_xlim()
            assert left < np.array(bar.get_xy())[len(moved), 0] < right
            for water, surface, x in film.sea:
                crest = replay.elevation(x)[number]
                assert np.abs(crest).max() > 0.01 and np.array(surface.get_ydata()) == approx(crest)
                assert np.array(water.get_xy())[1:-2, 1] == approx(crest)


def test_a_clock_and_what_is_magnified_are_said(bare):
    content = cli.load(bare).content
    for magnify, words in ((1.0, "t = -1.0 s"), (30.0, "t = -1.0 s; the platform's displacements × 30")):
        scene, replay = still(content, "elastic", magnify=magnify)
        with plain():
            film = animation.Film(scene, replay, "a $ title")
            film.show(0, next(replay.poses()))
        assert film.clock.get_text() == f"a $ title\n{words}" and not film.clock.get_parse_math()


def test_a_task_is_written_and_all_of_it_moves(bare, tmp_path):
    """Frames as asked for, none like the last; written a second time the file is the same."""
    labels = "platform=elastic,sea_state=rough,seed=1"
    words = ["animate", str(bare), labels, "--results", str(tmp_path), "--seconds", "2", "--fps", "4", "--speed", "2"]
    (task,) = find(study := cli.load(bare), [labels])
    path, made = tmp_path / study.name / f"animation-{task}.gif", []
    for _ in range(2):
        told = CliRunner().invoke(cli.app, words, catch_exceptions=False)
        assert told.exit_code == 0 and told.output.splitlines()[-1] == str(path)
        made.append(path.read_bytes())
    assert made[0] == made[1] and [*path.parent.iterdir()] == [path]
    with Image.open(path) as picture:
        assert picture.n_frames == 5 and picture.info["duration"] == 250
        frames = [np.array(frame.convert("RGB")) for frame in ImageSequence.Iterator(picture)]
    assert all((one != other).any() for one, other in pairwise(frames))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["nothing"], "task = nothing: no such task"),
        (["platform=fixed"], "task = platform=fixed: 4 tasks have these labels; name one"),
        (["@", "--from", "7"], "--from = 7 s: must be within 0 to 6 s"),
        (["@", "--from", "nan"], "--from = nan s: must be within 0 to 6 s"),
        (["@", "--seconds", "5"], "--seconds = 5 s: must be within 0 to 4 s"),
        (["@", "--speed", "0"], "--speed = 0: must be within 0.01 to 1000"),
        (["@", "--fps", "60"], "--fps = 60: must be within 1 to 50"),
        (["@", "--magnify", "inf"], "--magnify = inf: must be within 0 to 1e+06"),
        (["@", "--speed", "0.01", "--fps", "50"], "--seconds = 4 s: would make 20001 frames: must be at most 2000"),
    ],
)
def test_what_cannot_be_shown_is_one_line(bare, tmp_path, words, line):
    words = [word.replace("@", "platform=fixed,sea_state=calm,seed=0") for word in words]
    with pytest.raises(StudyError) as told:
        cli.animate(bare, words[0], tmp_path / "r", **options(words[1:]))
    (problem,) = told.value.problems
    assert problem.startswith(f"{bare}: {line}") and not (tmp_path / "r").exists()


def options(words):
    """Of the verb, as it is called by them."""
    given = {name.removeprefix("--"): float(value) for name, value in zip(words[::2], words[1::2], strict=True)}
    return {"start": given.pop("from", None), "seconds": None, "speed": 1.0, "fps": 10.0, "magnify": 1.0} | given


def test_a_study_that_has_not_run_lacks_boundary_elements(small, tmp_path):
    with pytest.raises(StudyError, match=r"hydrodynamics/[0-9a-f]+\.nc: not there yet; `study run .*` makes it"):
        cli.animate(small, "platform=fixed,sea_state=calm,seed=0", tmp_path / "r", **options([]))


@pytest.mark.parametrize(
    ("given", "first", "step", "count", "pause"),
    [
        ({}, 20.0, 0.1, 301, 100),
        ({"start": 0.0, "seconds": 3.0, "speed": 2.0}, 0.0, 0.2, 16, 100),
        ({"fps": 30.0, "seconds": 3.0}, 20.0, 0.03, 101, 30),  # a GIF has hundredths of seconds
        ({"start": 75.0}, 75.0, 0.1, 51, 100),
        ({"seconds": 0.0}, 20.0, 0.1, 1, 100),
    ],
)
def test_frames_are_as_far_apart_as_they_are_shown(tmp_path, given, first, step, count, pause):
    times, shown = Filming(**{**TIDY, **given}).times(tmp_path, Recording(duration=60.0, discard=20.0, ramp=20.0))
    assert shown == pause and times == approx(first + step * np.arange(count))


@pytest.mark.parametrize(
    ("period", "given", "step", "count"),
    [
        (8.0, {}, 0.1, 301),
        (0.2, {}, 0.025, 301),  # eight frames a period, and a film as long as others
        (0.2, {"speed": 1.0}, 0.1, 301),  # as asked for
        (0.2, {"seconds": 1.0}, 0.025, 41),
    ],
)
def test_short_waves_are_seen_to_pass(tmp_path, period, given, step, count):
    asked = Filming(**{**TIDY, "speed": None, **given})
    times, pause = asked.times(tmp_path, Recording(duration=60.0, discard=20.0, ramp=20.0), period)
    assert pause == 100 and times == approx(20.0 + step * np.arange(count))


@pytest.mark.parametrize(("sea", "period"), [
    ({"kind": "regular", "period": 0.3, "height": 1e-3}, 0.3),
    ({"Hs": 1.0, "Tp": 6.0}, 6.0),
    ({"kind": "white-noise", "Hs": 1.0}, np.pi),
    ({"kind": "still"}, np.inf),
])  # fmt: skip
def test_the_waves_period_is_their_peaks_or_their_shortest(study_of, buan_tables, sea, period):
    buan_tables |= {"sea_states": {"one": sea}, "waves": {"band": [0.5, 2.0]}}
    buan_tables["axes"]["sea_state"] = ["one"]
    assert actions._period(next(iter(expand(study_of(buan_tables).content))).parameters) == approx(period)


@pytest.mark.parametrize(
    ("step", "words"), [(0.5, "t = 0.5 s"), (0.1, "t = 0.1 s"), (0.025, "t = 0.03 s"), (2e-3, "t = 0.002 s")]
)
def test_the_clock_has_the_digits_of_its_step(bare, step, words):
    scene, replay = still(cli.load(bare).content, "fixed", count=2)
    with plain():
        film = animation.Film(scene, dataclasses.replace(replay, times=step * np.arange(2)), "title")
    assert film.words(step) == f"title\n{words}"
