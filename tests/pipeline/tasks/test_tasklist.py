"""Many tasks as numbers are the tasks that the study has."""

from collections import Counter
from itertools import groupby

import pytest

from pipeline.bridge.geometry import of_joints
from pipeline.bridge.loading import load
from pipeline.study.reading import StudyError
from pipeline.tasks import tasklist
from pipeline.tasks.select import _pairs, find, select
from pipeline.tasks.task import expand


@pytest.fixture
def study(small):
    return load(small)


def test_the_same_tasks_in_the_same_order(study):
    lazy, direct = list(study.tasks), list(expand(study.content))
    assert [task.id for task in lazy] == [task.id for task in direct]
    assert [dict(task.labels) for task in lazy] == [dict(task.labels) for task in direct]
    assert [task.parameters for task in lazy] == [task.parameters for task in direct]
    assert [str(task) for task in lazy] == [str(task) for task in direct]


def test_cells_that_share_a_task_are_one_where_it_stands_first(small):
    """Without floats there is no damping: both its values are the same task."""
    small.write_text(small.read_text().replace("[axes]", "[axes]\npto_damping = [1e5, 2e5]"))
    tasks = load(small).tasks
    assert len(tasks) == 24
    assert [task.id for task in tasks.unique] == list(dict.fromkeys(task.id for task in tasks))
    assert len(tasks.unique) == 20


def test_groups_are_parts_in_order(study):
    groups = study.tasks.split(lambda task: task.labels["platform"])
    assert list(groups) == ["elastic", "fixed", "elastic-no-floats"]
    for platform, members in groups.items():
        wanted = study.tasks.where(lambda task, platform=platform: task.labels["platform"] == platform)
        assert [task.id for task in members] == [task.id for task in wanted]
        assert len(members) == 4


def test_a_task_is_found_by_the_beginning_of_its_id_if_no_other_begins_so(study):
    one, other, *_ = study.tasks
    assert find(study, [one.id, other.id[:15]]) == {one.id, other.id}
    with pytest.raises(StudyError, match="12 tasks begin so"):
        find(study, [""])
    first = Counter(task.id[0] for task in study.tasks)
    shared = next(digit for digit, count in first.items() if 1 < count < 12)
    with pytest.raises(StudyError, match=f"task = {shared}: {first[shared]} tasks begin so; give more digits"):
        find(study, [shared])
    with pytest.raises(StudyError, match="task = x: no such task"):
        find(study, ["x"])


def test_none_is_none(study):
    none = study.tasks.where(lambda _: False)
    assert not none
    assert list(none.unique) == []
    assert none.split(lambda task: task.id) == {}


def test_tasks_in_one_sea_go_one_after_another(small):
    """Dampings and a joint's springs vary fastest; what floats are otherwise does not."""
    path_axes = '"floats.*.stiffness" = [0.0, 1e3]\n"floats.front.mass" = [2147.0, 2148.0]\npto_damping = [1e5, 2e5]'
    small.write_text(small.read_text().replace("[axes]", f"[axes]\n{path_axes}"))
    study = load(small)
    assert of_joints(study.content) == {"pto_damping", "stiffness"}
    before, tasks = (list(t) for t in (study.tasks, study.tasks.fastest(of_joints(study.content))))
    assert sorted(task.id for task in tasks) == sorted(task.id for task in before)
    scenes = [tuple(v for k, v in task.labels.items() if k not in ("pto_damping", "stiffness")) for task in tasks]
    assert len(list(groupby(scenes))) == len(set(scenes)) == len(tasks) / 4
    assert [dict(task.labels) for task in study.tasks.fastest(set())] == [dict(task.labels) for task in before]


@pytest.fixture
def million(small):
    """100 sea states x 100 dampings x 100 seeds."""
    head = small.read_text().split("[axes]")[0]
    axes = f"""[axes]
platform = ["fixed"]
pto_damping = {[1e3 * i for i in range(100)]}
seed = {list(range(100))}
[sea_states]
"""
    small.write_text(head + axes + "\n".join(f"s{i} = {{ Hs = {0.5 + i / 100}, Tp = 5.0 }}" for i in range(100)))
    return load(small)


def test_selecting_makes_the_tasks_selected_and_no_others(million, monkeypatch):
    made, cell = [], tasklist.cell
    monkeypatch.setattr(tasklist, "cell", lambda study, *rest: made.append(rest) or cell(study, *rest))
    chosen = select(million, "seed=5,sea_state=s7,sea_state=s3,pto_damping=1000,pto_damping=99000")
    assert len(made) == 4
    labels = [(t.labels["sea_state"], t.labels["pto_damping"], t.labels["seed"]) for t in chosen]
    assert labels == [("s3", 1e3, 5), ("s3", 99e3, 5), ("s7", 1e3, 5), ("s7", 99e3, 5)]
    assert [task.id for task in chosen] == [cell(million.content, task.labels, task.varied).id for task in chosen]


def test_a_list_is_selected_as_it_is_written(small):
    """Commas within brackets part nothing, in a matrix neither."""
    assert list(_pairs("a=[0.3, 1.0, 0.0],b=1,c=[[1, 0], [0, 1]]")) == [
        "a=[0.3, 1.0, 0.0]",
        "b=1",
        "c=[[1, 0], [0, 1]]",
    ]
    axis = '[axes]\n"floats.front.cog" = [[0.0, 0.0, 0.1], [0.0, 0.0, 0.2]]\n'
    small.write_text(small.read_text().replace("[axes]\n", axis))
    study = load(small)
    chosen = select(study, "floats.front.cog=[0.0, 0.0, 0.2],seed=0")
    assert all("[0.0, 0.0, 0.2]" in task.labels.values() for task in chosen)
    assert 0 < len(chosen) < len(select(study, "seed=0"))
