"""Every key has its meaning and its unit, once; and page, table and schema say the same."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft4Validator
from typer.testing import CliRunner

from pipeline.bridge.loading import load
from pipeline.cli.cli import app
from pipeline.results.variables import VARIABLES
from pipeline.study import reference
from pipeline.study.inherit import merged
from pipeline.study.schema import tables, unit_of
from studies import keys as page

STUDIES = Path(__file__).parents[3] / "studies"
SCHEMA = reference.json_schema()
VALID = Draft4Validator(SCHEMA)
# Numbers that count, number or choose have no unit; all other numbers of study files have one.
PURE = {"gamma", "components", "base_seed", "elements", "count", "seed", "axis", "start", "to", "mean", "std"}
PURE |= {"modes", "azimuths", "arc_points", "line_points", "panel_size", "field_tolerance", "memory_tolerance"}
PURE |= {"one_way", "stations_per_element", "newton_tolerance", "tolerance", "critical_damping", "damping_ratio"}
PURE |= {"drag_coefficient", "inertia_coefficient", "from", "scale", "scf", "exponent", "shear_factor", '"PATH"'}
PURE |= {
    "generating",
    "motoring",
    "error",
    "parameters",
    "material_factor",
    "moment_factor",
    "occurrence",
    "gap_damping",
}


def test_every_key_has_a_meaning_and_every_quantity_a_unit():
    for key in reference.find():
        last = key.path.rpartition(".")[2]
        assert key.meaning and key.meaning[0] in key.meaning[0].upper() + '"', key
        if "number" in key.values:
            assert (key.unit == "-") == (last in PURE), key
        assert key.values != "any value" or key.path in ('variants.*."PATH"', 'survival."PATH"'), key


def test_meanings_units_and_limits_are_the_solvers():
    """One of each kind: by path, unit, default, range, meaning."""
    found = {key.path: key for key in reference.find()}
    assert found["water.density"] == ("water.density", "kg/m3", "1025.0", "number > 0", "Density of the water", ())
    assert found["waves.band"][1:4] == ("rad/s", "", "2 of: number > 0, <= 100")
    assert found["floats.*.motion"].default == '["hinge"]'
    assert found["platform.damping_ratio"].values == "number >= 0, < 1"
    assert found["solver.modes"].values == 'whole number >= 1, <= 1000 or "all"'
    assert found["floats.*.pto_damping"].values == "number >= 0, or a list"
    assert found["sea_states.*.kind"].default == '"irregular"' and len(found["sea_states.*.kind"].of) == 7
    assert found["floats.*.mass"].default == "required" and found["platform.legs"].default == ""
    assert 'axes."PATH"' in found and 'variants.*."PATH"' in found and "platform.materials.*.E" in found
    assert found["record.rao"].values == "true, false" and found["floats.*.hull.file"].values == "file"


def test_a_word_finds_keys_by_path_and_meaning():
    every = reference.find()
    assert {key.path for key in reference.find("DRAG")} >= {"platform.members.*.drag_coefficient"}
    assert any("drag" not in key.path for key in reference.find("drag"))
    assert 0 < len(reference.find("damping")) < len(every) == len({(k.path, k.meaning) for k in every})
    told = CliRunner().invoke(app, ["keys", "pto_damping"])
    assert told.exit_code == 0 and "N m s/rad or N s/m" in told.output and "floats.*.mass" not in told.output
    assert {"record.outputs"} <= {key.path for key in reference.find("section_forces")}  # among its values
    wrong = CliRunner().invoke(app, ["keys", "dampnig"])
    assert "WORD = dampnig: is in no key; did you mean damping?" in str(wrong.exception)


def test_a_word_finds_outputs_by_name_and_meaning():
    every = CliRunner().invoke(app, ["outputs"]).output
    assert all(name in every for name in (*VARIABLES, "<name>_spectrum"))
    told = CliRunner().invoke(app, ["outputs", "tension"]).output
    assert "line_tension" in told and "absorbed_power" not in told
    wrong = CliRunner().invoke(app, ["outputs", "absorbed_pwoer"])
    assert "WORD = absorbed_pwoer: is in no output; did you mean absorbed_power?" in str(wrong.exception)


def test_the_page_has_the_keys_that_there_are():
    assert page.PAGE.read_text() == page.page(), "python -m studies.keys renews studies/README.md"


BLOCKS = re.findall(r"```toml\n(.*?)```", (STUDIES / "README.md").read_text(), re.DOTALL)


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_every_block_of_the_page_is_a_piece_of_a_study(number, tmp_path):
    block = BLOCKS[number].replace('base = "', f'base = "{STUDIES}/').replace('file = "', f'file = "{STUDIES}/')
    path = tmp_path / "block.toml"
    path.write_text(block)
    study = load(path)
    base = load(STUDIES / tomllib.loads(BLOCKS[number])["base"])
    assert study.content != base.content or "mesh" in block
    assert len(study.tasks) > 0
    assert VALID.is_valid(tomllib.loads(block))


def test_the_schema_is_one_of_draft_4():
    told = CliRunner().invoke(app, ["schema"])
    assert json.loads(told.output, parse_constant=pytest.fail) == SCHEMA  # JSON has no Infinity
    Draft4Validator.check_schema(SCHEMA)
    refers = set(re.findall(r'"#/definitions/(\w+)"', json.dumps(SCHEMA)))
    assert refers == SCHEMA["definitions"].keys() - {"Normal"} or refers == SCHEMA["definitions"].keys()


@pytest.mark.parametrize("path", sorted(STUDIES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_study_is_valid_by_the_schema(path):
    assert list(VALID.iter_errors(tomllib.loads(path.read_text()))) == []


WRONG = {
    "water.depht = 50.0": ("$.water", "'depht' was unexpected"),
    "water.depth = 0.0": ("$.water.depth", "less than or equal to the minimum"),
    "waves.gamma = 8": ("$.waves.gamma", "greater than the maximum"),
    'waves.spectrum = "jonswop"': ("$.waves.spectrum", "not one of"),
    "waves.band = [1.0]": ("$.waves.band", "too short"),
    "axes.seeds = [0]": ("$.axes", "'seeds' does not match any"),
    'axes.sea_state = "2018"': ("$.axes.sea_state", "not valid under any"),
    'axes."water.depth" = 50.0': ("$.axes['water.depth']", "not valid under any"),
    'axes."water.depth" = { from = 1.0, upto = 2.0 }': ("$.axes['water.depth']", "not valid under any"),
    "solver.modes = 0": ("$.solver.modes", "not valid under any"),
    "platform.damping_ratio = 1.0": ("$.platform.damping_ratio", "greater than or equal to the maximum"),
    'floats = [{ hull = { shape = "cube" } }]': ("$.floats[0].hull", "not valid under any"),
    "sea_states.a = { Hs = 1.0, Tq = 2.0 }": ("$.sea_states.a", "not valid under any"),
    "variants.a.title = 3": ("$.variants.a.title", "not of type 'string'"),
    "samples.method = 'sobal'": ("$.samples.method", "not one of"),
}


@pytest.mark.parametrize("line", WRONG)
def test_the_schema_notices(line):
    place, limit = WRONG[line]
    errors = list(VALID.iter_errors(merged({"water": {"depth": 50.0}}, tomllib.loads(line))))
    assert any(error.json_path == place and limit in error.message for error in errors), errors


def test_the_schema_lets_pass_what_is_good():
    assert VALID.is_valid({"water": {"depth": float("inf")}})
    water = {"water": {"depth": 50.0}}
    axes = {"coefficients": ["a.nc"], "left_out": [[], ["rear"]], "floats.*.mass": [1.0]}
    assert VALID.is_valid({**water, "axes": axes}) and not VALID.is_valid({**water, "axes": {"mass": [1.0]}})
    assert not VALID.is_valid({"title": "nothing"})


def test_a_key_has_the_same_unit_in_every_table():
    """Units are asked for by the key alone."""
    symbols = {}
    for table in tables():
        for key, field in table.model_fields.items():
            symbols.setdefault(key, set()).add(unit_of(field))
    assert not {key: found for key, found in symbols.items() if len(found - {"-"}) > 1}
