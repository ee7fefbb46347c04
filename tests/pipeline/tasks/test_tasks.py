"""Identity: the same physics has the same name, and nothing else decides it."""

import dataclasses
import json

import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from pipeline.bridge.geometry import geometry_of
from pipeline.study import seas, settings
from pipeline.study.schema import StudyFile
from pipeline.study.settings import Solver
from pipeline.study.tables import Unit, tables
from pipeline.tasks.task import Parameters, Task, canonical, dimensions, expand, wave_seed
from solver import scene as physics
from solver.quantities import quantities
from solver.sea import spectrum
from solver.structure import members


def ids(tables):
    return [task.id for task in expand(StudyFile.model_validate(tables))]


def one(tables, **labels):
    tasks = expand(StudyFile.model_validate(tables))
    (task,) = (t for t in tasks if all(t.labels[k] == v for k, v in labels.items()))
    return task


MINIMAL = {
    "water": {"depth": 50.0},
    "waves": {"band": [0.7, 3.4]},
    "sea_state": {"Hs": 1.28, "Tp": 5.46},
}


def test_id_is_pinned():
    """Users' results carry these names: if this fails, every result on every disk is orphaned."""
    task = Task(labels={}, make=lambda: Parameters.model_validate(MINIMAL), version=1)
    assert task.parameters.canonical() == (
        '{"sea_state":{"Hs":1.28,"Tp":5.46},"water":{"depth":50.0},"waves":{"band":[0.7,3.4]}}'
    )
    assert task.id == "3061316fdf65293b"


def test_integers_and_floats_are_one_number(buan_tables):
    before = ids(buan_tables)
    buan_tables["water"]["depth"] = 50
    buan_tables["floats"][0]["mass"] = 2147
    assert ids(buan_tables) == before


def test_negative_zero_is_zero():
    assert canonical({"a": -0.0, "b": [-0.0]}) == canonical({"a": 0.0, "b": [0.0]})


def test_how_often_a_sea_comes_is_no_part_of_a_task(buan_tables):
    """What is weighed by it is computed once; in the dataset it stands beside the sea state."""
    before = ids(buan_tables)
    buan_tables["sea_states"]["2017"]["occurrence"] = 310.0
    assert ids(buan_tables) == before
    sea = StudyFile.model_validate(buan_tables).sea_states["2017"]
    assert seas.labels(sea, seas.Waves()) == {"Hs": 1.387, "Tp": 5.65, "occurrence": 310.0}
    assert one(buan_tables, sea_state="2017", platform="fixed", seed=0).parameters.sea_state.occurrence is None


def test_a_parameter_at_its_default_keeps_the_id(buan_tables):
    before = ids(buan_tables)
    buan_tables["solver"]["time_step"] = Solver().time_step
    buan_tables["record"]["series"] = "none"
    assert ids(buan_tables) == before
    buan_tables["solver"] = {"time_step": 0.1}
    assert not set(ids(buan_tables)) & set(before)


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ("water", "density", 1000.0),
        ("waves", "heading", 0.1),
        ("record", "duration", 600.0),
        ("solver", "modes", 7),
        ("platform", "damping_ratio", 0.02),
    ],
)
def test_whatever_changes_the_physics_changes_the_id(buan_tables, table, key, value):
    before = one(buan_tables, sea_state="2019", platform="elastic", seed=1).id
    buan_tables.setdefault(table, {})[key] = value
    assert one(buan_tables, sea_state="2019", platform="elastic", seed=1).id != before


@pytest.mark.parametrize(
    ("sea", "waves", "other_sea", "other_waves"),
    [
        ({}, {}, {"spectrum": "pierson-moskowitz", "form": "peak"}, {}),
        ({}, {"form": "mean"}, {"form": "mean"}, {}),
        ({}, {}, {"spectrum": "pierson-moskowitz"}, {"spectrum": "jonswap", "gamma": 2.0}),
        ({}, {"spectrum": "jonswap", "gamma": 2.0}, {"gamma": 2.0}, {"spectrum": "jonswap"}),
        ({}, {"spectrum": "jonswap"}, {"spectrum": "jonswap", "gamma": 3.3}, {"spectrum": "jonswap", "gamma": 2.0}),
        ({"spectrum": "jonswap", "gamma": 3.3}, {}, {"spectrum": "jonswap"}, {"form": "mean"}),
        ({"spectrum": "jonswap", "gamma": 2.0}, {}, {"spectrum": "jonswap", "form": "peak"}, {"gamma": 2.0}),
        ({"kind": "white-noise"}, {}, {"kind": "white-noise"}, {"gamma": 2.0, "form": "mean"}),
    ],
)
def test_however_a_sea_is_written_it_is_one(buan_tables, sea, waves, other_sea, other_waves):
    """The first way is that of old results, whose names and waves stay."""

    def written(sea, waves):
        buan_tables["sea_states"]["2019"] = {"Hs": 1.0} | ({} if "kind" in sea else {"Tp": 6.0}) | sea
        buan_tables["waves"] = {"band": [0.7, 3.4]} | waves
        return one(buan_tables, sea_state="2019", platform="fixed", seed=1)

    task, other = written(sea, waves), written(other_sea, other_waves)
    assert (other.id, wave_seed(other.parameters)) == (task.id, wave_seed(task.parameters))
    text = json.loads(task.parameters.canonical())
    assert text["waves"] == {"band": [0.7, 3.4]} | waves
    assert {key: text["sea_state"][key] for key in sea} == sea


def test_a_sea_has_the_keys_of_its_spectrum():
    for name, keys in seas.FURTHER.items():
        shape = getattr(spectrum, "".join(map(str.capitalize, name.split("-"))))
        assert {"Hs", "Tp", *keys} == {field.name for field in dataclasses.fields(shape)}


def test_rules_of_outputs_that_there_are_not_do_not_change_the_id(buan_tables):
    def named(outputs, **rules):
        buan_tables["record"] |= {"outputs": outputs, **rules}
        return {p: one(buan_tables, sea_state="2019", platform=p, seed=1).id for p in ("elastic", "fixed")}

    rules = {"fatigue": {"scf": 1.7}, "utilisation": {"material_factor": 1.3}}
    for asked, needs in ((["fatigue"], "fatigue"), (["utilisation"], "utilisation")):
        before = named(asked, fatigue={}, utilisation={})
        for key, rule in rules.items():
            changed = named(asked, **{"fatigue": {}, "utilisation": {}, key: rule})
            assert changed["fixed"] == before["fixed"] and (changed["elastic"] == before["elastic"]) == (key != needs)


@pytest.mark.parametrize("key", ["mass", "cog", "hinge", "pto_damping"])
def test_whatever_changes_a_float_changes_the_id(buan_tables, key):
    before = one(buan_tables, sea_state="2019", platform="fixed", seed=1).id
    value = buan_tables["floats"][0].get(key, [0.0, 0.0, 0.0])
    buan_tables["floats"][0][key] = [value[0], value[1] + 0.1, value[2]] if isinstance(value, list) else value + 1.0
    assert one(buan_tables, sea_state="2019", platform="fixed", seed=1).id != before


def test_labels_and_order_do_not_matter(buan_tables):
    before = set(ids(buan_tables))
    buan_tables["sea_states"]["mild"] = buan_tables["sea_states"].pop("2019")
    buan_tables["axes"]["sea_state"] = ["mild", "2021", "representative", "2017", "2018", "2020"]
    buan_tables["axes"]["seed"].reverse()
    assert set(ids(buan_tables)) == before


@pytest.mark.parametrize(
    ("axis", "value"),
    [("seed", 3), ("sea_state", "storm"), ("pto_damping", 50e3), ("hinge_spacing", 4.0)],
)
def test_adding_a_value_orphans_nothing(buan_tables, axis, value):
    buan_tables["axes"] |= {"pto_damping": [100e3], "hinge_spacing": [3.0]}
    buan_tables["sea_states"]["storm"] = {"Hs": 2.0, "Tp": 7.0}
    before = set(ids(buan_tables))
    buan_tables["axes"][axis].append(value)
    assert before < set(ids(buan_tables))


def test_an_axis_with_the_files_own_value_changes_nothing(buan_tables):
    before = ids(buan_tables)
    buan_tables["axes"] |= {"pto_damping": [100e3], "hinge_spacing": [3.0]}
    assert ids(buan_tables) == before


def test_platforms_and_dampings_meet_the_same_waves(buan_tables):
    buan_tables["axes"]["pto_damping"] = [100e3, 50e3]
    seeds = {}
    for task in expand(StudyFile.model_validate(buan_tables)):
        cell = (task.labels["sea_state"], task.labels["seed"])
        seeds.setdefault(cell, set()).add(wave_seed(task.parameters))
    assert all(len(each) == 1 for each in seeds.values())
    assert len({next(iter(each)) for each in seeds.values()}) == len(seeds)


def test_waves_do_not_depend_on_the_place_in_the_list(buan_tables):
    before = wave_seed(one(buan_tables, sea_state="2019", platform="fixed", seed=1).parameters)
    buan_tables["axes"]["sea_state"] = ["2021", "2019"]
    assert wave_seed(one(buan_tables, sea_state="2019", platform="fixed", seed=1).parameters) == before


def test_the_same_waves_come_from_any_direction(buan_tables):
    before = wave_seed(one(buan_tables, sea_state="2019", platform="fixed", seed=1).parameters)
    buan_tables["waves"]["heading"] = 0.5
    assert wave_seed(one(buan_tables, sea_state="2019", platform="fixed", seed=1).parameters) == before


def test_base_seed_changes_the_waves(buan_tables):
    before = wave_seed(one(buan_tables, sea_state="2019", platform="fixed", seed=1).parameters)
    buan_tables["waves"]["base_seed"] += 1
    assert wave_seed(one(buan_tables, sea_state="2019", platform="fixed", seed=1).parameters) != before


def test_hinge_spacing_moves_hinges_and_their_nodes_and_keeps_arms(buan_tables):
    buan_tables["axes"]["hinge_spacing"] = [3.0, 5.0]
    task = one(buan_tables, sea_state="2017", platform="elastic", seed=0, hinge_spacing=5.0)
    front, rear = task.parameters.floats
    assert (front.hinge, rear.hinge) == ((-2.5, 0.0, 2.6), (2.5, 0.0, 2.6))
    assert task.parameters.platform.nodes["hinge:front"] == front.hinge
    assert front.arm == (-2.36, 0.0, -2.6)


def test_platform_without_floats_keeps_its_hinge_nodes(buan_tables):
    task = one(buan_tables, sea_state="2017", platform="elastic-no-floats", seed=0)
    assert task.parameters.floats == ()
    assert "hinge:rear" in task.parameters.platform.nodes
    assert geometry_of(task.parameters) is None


def test_one_geometry_for_the_whole_study(buan_tables):
    tasks = expand(StudyFile.model_validate(buan_tables))
    assert len({geometry.key for task in tasks if (geometry := geometry_of(task.parameters))}) == 1


def test_listed_axes_are_dimensions_and_others_are_not(buan_tables):
    assert dimensions(StudyFile.model_validate(buan_tables)) == ["sea_state", "platform", "seed"]


def test_older_versions_are_known_by_name(buan_tables):
    task = one(buan_tables, sea_state="2017", platform="fixed", seed=0)
    newer = Task(labels=task.labels, make=task.make, version=task.version + 1)
    older_ids = newer.under(newer.older_versions)
    assert older_ids[0] == task.id != newer.id
    every = [Task(labels=task.labels, make=task.make, version=version).id for version in range(task.version, 0, -1)]
    assert older_ids == every


@examples(max_examples=30)
@given(
    st.recursive(
        st.floats(allow_nan=False, allow_infinity=False) | st.text() | st.booleans() | st.none(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    )
)
def test_canonical_text_is_lossless(data):
    assert json.loads(canonical(data)) == data


@pytest.mark.parametrize("name", ["Water", "Float", "Member", "Material", "PointMass", "PointLoad"])
def test_a_tables_fields_are_the_solvers(name):
    """An id leaves out what is at its default, and a number without range or unit would pass."""
    inputs = getattr(members, name, None) or getattr(physics, name)
    table = {table.__name__: table for table in tables()}[name]
    theirs = {f.name: f.default for f in dataclasses.fields(inputs) if f.default is not dataclasses.MISSING}
    ours = {key: f.default for key, f in table.model_fields.items() if not f.is_required()}
    more = {"Member": {"elements": None}, "Float": {"pto_law": None, "hold": False}}.get(name, {})
    assert set(table.model_fields) == {f.name for f in dataclasses.fields(inputs)} | more.keys()
    assert ours == theirs | more
    for key, quantity in quantities(inputs).items():
        assert Unit(quantity.unit) in table.model_fields[key].metadata


def test_knobs_of_the_solver_are_its_own():
    ours = settings.Recording().model_dump(exclude={"series"}) | Solver().model_dump()
    assert settings.Recording().series == "none"  # becomes Settings.keep_series
    theirs = dataclasses.asdict(physics.Settings())
    assert ours == {name: value for name, value in theirs.items() if name != "keep_series"}


@pytest.mark.parametrize("value", ["a", -1, float("nan"), [1]])
def test_knobs_are_strict(buan_tables, value):
    from pydantic import ValidationError

    for knob in Solver.model_fields:
        buan_tables["solver"] = {knob: value}
        with pytest.raises(ValidationError):
            StudyFile.model_validate(buan_tables)
