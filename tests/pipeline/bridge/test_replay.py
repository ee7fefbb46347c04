"""What is shown of a march is where things were: closed forms, the record's own series, and the sketch at rest."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from pipeline.bridge import scenes
from pipeline.bridge.hulls import outline, silhouette
from pipeline.bridge.replay import Replay, replay, require_history
from pipeline.report import sketch
from pipeline.study.hulls import BoxHull, Sphere
from pipeline.tasks.task import expand
from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.run import simulate

BARE = {"radiation": False, "diffraction": False, "time_step": 0.05}


@pytest.fixture
def parameters(buan_tables, study_of):
    """Of Buan's floats and platform in a short record without boundary elements; changes: of its tables."""

    def made(platform, **changes):
        record = {"duration": 4.0, "discard": 1.0, "ramp": 1.0, "series": "full"}
        content = study_of({**buan_tables, "record": record, "solver": BARE, **changes}).content
        return next(t for t in expand(content) if t.labels["platform"] == platform).parameters

    return made


def at(parameters, z, p=(), **changes):
    """A replay of one instant with these coordinates."""
    scene = scenes.scene(parameters)
    system = prepare(replace(scene, settings=replace(scene.settings, radiation=False)), None)
    given = {"times": np.zeros(1), "z": np.atleast_2d(z), "p": np.atleast_2d(p), "magnify": 1.0} | changes
    return Replay(parameters=parameters, system=system, **given)


@pytest.mark.parametrize("angle", [0.0, 0.3, -1.0])
def test_a_hinge_moves_its_hull_on_a_circle(parameters, angle):
    """x' = x cos θ + z sin θ and z' = z cos θ - x sin θ from the hinge; at rest it is the sketch's."""
    scene = parameters("fixed")
    (pose,) = at(scene, [angle, 0.0]).poses()
    front, rear = scene.floats
    hinge, rest = np.array(front.hinge)[::2], np.array(sketch.float_outline(front))
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    assert pose.hulls[0] == approx(hinge + (rest - hinge) @ turn.T, abs=1e-12)
    assert pose.hulls[1] == approx(np.array(sketch.float_outline(rear)), abs=1e-12)
    assert pose.centres[0] == approx(hinge + turn @ np.array(front.arm)[::2], abs=1e-12)
    assert pose.hinges == approx(np.array([f.hinge for f in scene.floats])[:, ::2], abs=1e-12)
    assert pose.members == []


def test_floats_and_moorings_of_a_float_go_with_it(parameters, buan_tables):
    """What carries others moves their hinges; a line's fairlead goes with its float."""
    front, rear = buan_tables["floats"]
    line = {"fairlead": [0.0, 0.0, -1.0], "anchor": [-40.0, 0.0, -50.0], "length": 70.0, "weight": 500.0, "EA": 1e8}
    base = front | {"name": "base", "motion": ["surge", "heave", "pitch"], "hinge": [0.0, 0.0, 0.0], "arm": [0.0] * 3}
    base |= {"pto_damping": 0.0, "lines": [line]}
    scene = parameters("fixed", floats=[base, rear | {"on": "base"}])
    (pose,) = at(scene, [2.0, 0.5, 0.2, 0.0]).poses()
    turn = np.array([[np.cos(0.2), np.sin(0.2)], [-np.sin(0.2), np.cos(0.2)]])
    shift = np.array([2.0, 0.5])
    assert pose.hinges[1] == approx(shift + turn @ np.array(rear["hinge"])[::2], abs=1e-12)
    assert pose.hulls[1] == approx(shift + np.array(sketch.float_outline(scene.floats[1])) @ turn.T, abs=1e-12)
    assert pose.fairleads[0] == approx((shift + turn @ [0.0, -1.0])[None], abs=1e-12)
    assert len(pose.fairleads[1]) == 0


@pytest.mark.parametrize("magnify", [1.0, 20.0])
def test_a_platform_takes_hinges_along_magnified_or_not(parameters, magnify):
    scene = parameters("elastic")
    still = at(scene, [0.0] * 8)
    p = np.arange(1.0, 1.0 + len(still.system.structure.omega)) * 1e-2
    carriers = still.system.structure.carrier @ p
    (pose,) = at(scene, [*carriers, 0.0, 0.0], p, magnify=magnify).poses()
    (true,) = at(scene, [*carriers, 0.0, 0.0], p).poses()
    moved, hinges = carriers.reshape(2, 3)[:, :2], np.array([f.hinge for f in scene.floats])[:, ::2]
    assert np.abs(moved).max() > 1e-4
    c, s = np.cos(carriers[2]), np.sin(carriers[2])
    arm = np.array([[c, s], [-s, c]]) @ np.array(scene.floats[0].arm)[::2]
    assert true.centres[0] == approx(hinges[0] + moved[0] + arm, abs=1e-12)
    assert pose.hinges == approx(hinges + magnify * moved, abs=1e-12)
    assert pose.hulls[0] == approx(true.hulls[0] + (magnify - 1) * moved[0], abs=1e-12)
    assert pose.centres[1] == approx(true.centres[1] + (magnify - 1) * moved[1], abs=1e-12)
    ends = {m.end: u[-1] for m, u in zip(scene.platform.members, pose.members, strict=True)}
    assert ends["hinge:front"] == approx(magnify * moved[0], abs=1e-12)
    feet = {m.start: u[0] for m, u in zip(scene.platform.members, pose.members, strict=True)}
    assert feet["foot1"] == approx(np.zeros(2), abs=1e-15)
    assert still.stations() == [len(u) for u in pose.members] and max(still.stations()) > 2


@pytest.mark.parametrize("turned", ["roll", "yaw"])
def test_a_hull_that_turns_out_of_the_plane_keeps_its_size(turned):
    """A sphere looks as it does, a box shows its width."""
    c, s = np.cos(0.5), np.sin(0.5)
    R = np.array({"roll": [[1, 0, 0], [0, c, -s], [0, s, c]], "yaw": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[turned])
    ball = silhouette(Sphere(shape="sphere", radius=2.0, draft=2.0), R)
    assert np.ptp(ball, axis=0) == approx([4.0, 4.0], rel=0.02)
    box = BoxHull(shape="box", length=4.0, width=2.0, height=3.0, draft=1.5)
    size = {"roll": [4.0, 3.0 * c + 2.0 * s], "yaw": [4.0 * c + 2.0 * s, 3.0]}[turned]
    assert np.ptp(silhouette(box, R), axis=0) == approx(size, rel=1e-9)
    assert silhouette(box, np.eye(3)) == approx(np.array(outline(box)))


@pytest.mark.parametrize("platform", ["fixed", "elastic"])
def test_a_replay_is_the_records_own(parameters, platform):
    """At samples of the record its rotations and the waves at the origin; at t = 0 floats are where they are let go."""
    scene = parameters(platform)
    record = simulate(scenes.scene(scene))
    told, eta, time = (record.series[name][1] for name in ("rotation", "wave_elevation", "time"))
    shares = []
    film = replay(scene, None, np.append(0.0, time), shares.append)
    assert film.z[1:, -2:] == approx(told, abs=1e-9)
    assert film.elevation(np.zeros(1))[1:, 0] == approx(eta, abs=1e-9)
    assert film.elevation(np.zeros(1))[0, 0] == 0.0  # the ramp begins
    assert film.z[0] == approx(film.system.equilibrium[0]) and film.p[0] == approx(film.system.equilibrium[1])
    assert shares == sorted(shares) and shares[-1] == approx(1.0)
    between = replay(scene, None, (time[1:] + time[:-1]) / 2, shares.append)
    assert between.z == approx((film.z[1:-1] + film.z[2:]) / 2, abs=2e-3)


def test_a_run_that_begins_again_is_kept_from_its_beginning(parameters, monkeypatch):
    scene = parameters("fixed")
    times = np.linspace(0.0, 5.0, 11)
    once = replay(scene, None, times, lambda _: None)

    def twice(scene, known, watch):
        simulate(replace(scene, settings=replace(scene.settings, time_step=0.1)), known, watch)
        return simulate(scene, known, watch)

    monkeypatch.setattr("solver.run.simulate", twice)
    again = replay(scene, None, times, lambda _: None)
    assert again.system.dt == once.system.dt == 0.05 and np.array_equal(again.z, once.z)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [("method", "frequency", "solver.method = frequency"), ("accuracy", "reference", 'accuracy = "standard"')],
)
def test_what_has_no_history_is_refused(parameters, key, value, words):
    with pytest.raises(InputError, match=words):
        require_history(parameters("fixed", solver={key: value}, record={}))
    require_history(parameters("fixed"))
