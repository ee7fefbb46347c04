"""Hulls from mesh files in study files: known by content, refused and warned of under the study file's keys."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.bridge import hulls, scenes
from pipeline.bridge.engine import Engine
from pipeline.bridge.geometry import geometry_of, given_hydrodynamics
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
from pipeline.study import reference
from pipeline.study.reading import StudyError
from pipeline.tasks.tasklist import Tasks

STUDIES = Path(__file__).parents[3] / "studies"


@pytest.fixture
def barge(tmp_path):
    """A copy of the barge's study and its mesh."""
    for name in ("barge.toml", "barge.gdf"):
        (tmp_path / name).write_bytes((STUDIES / name).read_bytes())
    return tmp_path / "barge.toml"


def judged(study):
    """What the solver has to say before anything runs."""
    read = load(study)
    return judge(read, Tasks.of(read.content), Engine())


def test_a_task_is_known_by_the_mesh_and_not_by_its_name(barge):
    before = [task.id for task in Tasks.of(load(barge).content)]
    mesh = barge.with_name("barge.gdf")
    mesh.rename(barge.with_name("other.gdf"))
    barge.write_text(barge.read_text().replace("barge.gdf", "other.gdf"))
    assert [task.id for task in Tasks.of(load(barge).content)] == before
    other = barge.with_name("other.gdf")
    other.write_text(other.read_text().replace("-0.6000", "-0.6010"))
    assert [task.id for task in Tasks.of(load(barge).content)] != before


def test_the_examples_mesh_is_the_barge():
    (task, *_) = Tasks.of(load(STUDIES / "barge.toml").content)
    (item,) = scenes.scene(task.parameters).floats
    assert item.hull.volume == pytest.approx(4 * 3 * 0.6) and item.hull.closed and not item.hull.notes
    assert item.mass == pytest.approx(1025 * item.hull.volume) and geometry_of(task.parameters).planar


PLACES = """cog = ["balance", {2}, 0.1]
mooring = {{ stiffness = {3}, pretension = [900.0, -40.0, 0.0, 0.0, 0.0, 300.0], point = [{4}, {5}, 0.3] }}
hull = {{ shape = "mesh", file = "barge.gdf", origin = [{6}, {7}, 0.0] }}
arm = [{8}, {9}, -1.5]
lines = [{{ anchor = [-40.0, 3.0, -30.0], fairlead = [{0}, {1}, -0.2], length = 48.0, weight = 90.0, EA = 4e6 }}]"""
K = [[9e3 * (i == j) + 400.0 * (i + j == 4) for j in range(6)] for i in range(6)]


@pytest.mark.parametrize("away", [(0.7, 0.0), (-2.0, 0.4)])
def test_answers_do_not_go_with_the_origin_of_a_file(barge, away):
    """Loads that keep their directions act above the centre of buoyancy, not where a file has its origin."""
    text, floats = barge.read_text(), []
    old = [line for line in text.splitlines() if line.startswith(("hull =", "arm ="))]
    for x, y in ((0.0, 0.0), away):
        numbers = 1.2 - x, 0.3 - y, 0.2 - y, K, 0.5 - x, -y, x, y, x - 5.0, y
        barge.write_text(text.replace(old[0], PLACES.format(*numbers)).replace(old[1], ""))
        (task, *_) = Tasks.of(load(barge).content)
        (item,) = scenes.floats(task.parameters)
        told = np.add(item.cog, hulls.offset(task.parameters.floats[0].hull))  # from the study's reference point
        assert told[1:] == pytest.approx([0.2 - y, 0.1])
        floats.append((item, geometry_of(task.parameters)))
    (one, geometry), (other, same) = floats
    assert other.hull.vertices == pytest.approx(one.hull.vertices, abs=1e-12)
    for name in ("arm", "cog"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), abs=1e-9)
    assert other.lines[0].fairlead == pytest.approx(one.lines[0].fairlead)
    assert other.pulls == pytest.approx(one.pulls)
    assert other.moored.stiffness == pytest.approx(one.moored.stiffness)
    assert same.bodies[0].centre == pytest.approx(geometry.bodies[0].centre, abs=1e-12)


def test_a_file_of_coefficients_is_about_the_reference_point_of_the_study(barge, monkeypatch):
    asked = {}
    monkeypatch.setattr("pipeline.bridge.given.reading.read", lambda *_: None)
    monkeypatch.setattr("solver.hydrodynamics.bem.adopted.adopted", lambda *_, **words: asked.update(words))
    barge.write_text(barge.read_text().replace('"barge.gdf"', '"barge.gdf", origin = [0.7, 0.0, 0.0]'))
    (task, *_) = Tasks.of(load(barge).content)
    given_hydrodynamics(geometry_of(task.parameters).model_copy(update={"coefficients": True}))
    assert asked["points"] == pytest.approx(np.array([[-5.0, 0.0, 0.0]]))


def edited(study, change):
    """The mesh with its lines after the header changed."""
    mesh = study.with_name("barge.gdf")
    head, panels = (lines := mesh.read_text().splitlines())[:3], change(lines[4:])
    mesh.write_text("\n".join([*head, str(len(panels)), *panels]))


def test_an_inside_out_mesh_is_turned_with_a_warning(barge):
    def reverse(panels):
        corners = [[p.split()[i : i + 3] for i in (9, 6, 3, 0)] for p in panels]
        return [" ".join(x for corner in panel for x in corner) for panel in corners]

    edited(barge, reverse)
    (warning,) = judged(barge)
    assert warning.startswith("floats.barge.hull: the mesh was inside out")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda panels: panels[1:], "floats.barge.hull.file = barge.gdf: must be closed below still water: "),
        (lambda panels: [p.replace("-0.", "0.") for p in panels], "floats.barge.hull.file = barge.gdf, lowest"),
        (lambda panels: [], "floats.barge.hull.file = barge.gdf: holds no panels"),
        (lambda panels: [p for p in panels if p.count(" 0.6000") < 4], "floats.barge.hull = "),
    ],
)
def test_what_is_no_hull_is_refused_under_the_files_key(barge, change, message):
    edited(barge, change)
    with pytest.raises(StudyError) as caught:
        judged(barge)
    assert message in str(caught.value)


@pytest.mark.parametrize("placing", ["", ", rotation = [0, 0, 1.2], scale = 0.5"])
@pytest.mark.parametrize(("deepest", "refused"), [(-0.59, False), (-0.6, True), (-7.0, True)])
def test_an_origin_off_still_water_that_lifts_a_mesh_out_of_it_is_named(barge, placing, deepest, refused):
    """Its z is where still water is, of a barge of 0.6 m draft."""
    barge.write_text(barge.read_text().replace('"barge.gdf"', f'"barge.gdf", origin = [0.3, 0, {deepest}]{placing}'))
    try:
        told = "; ".join(judged(barge))
    except StudyError as error:
        told = str(error)
    assert ("must reach below still water, z = 0 m: hull.origin is the file's point" in told) == refused
    (key,) = (key for key in reference.find("origin") if key.path == "floats.*.hull.origin")
    assert "its z must be that of still water" in key.meaning
