"""Hulls from mesh files in study files: known by content, refused and warned of under the study file's keys."""

from pathlib import Path

import pytest

from pipeline.bridge import scenes
from pipeline.bridge.engine import Engine
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.loading import load
from pipeline.bridge.preflight import judge
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
