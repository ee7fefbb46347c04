"""What others make of the files: compliance checker, xarray; and time series."""

import json
import re
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from conftest import SMALL

from pipeline.bridge import cache, engine
from pipeline.bridge.loading import load
from pipeline.results import dataset, records
from pipeline.results.netcdf import Variable, content, from_bytes, to_bytes
from pipeline.results.store import Store
from pipeline.results.variables import COORDINATES, KNOBS, OF_OUTPUTS, SERIES, VARIABLES, meaning, of_path
from pipeline.running.campaign import Campaign
from pipeline.running.place import Place
from pipeline.study.settings import Recording
from pipeline.tasks.task import wave_seed
from tests.once import made

SHORT = "[record]\nduration = 6.0\ndiscard = 1.0\nramp = 1.0\nseries = 'full'\n"
SPHERE = """
[water]
depth = inf
[waves]
band = [0.5, 2.0]
components = 20
[[floats]]
name = "sphere"
hull = { shape = "sphere", radius = 5.0, draft = 5.0 }
mass = 261.8e3
inertia = [2.6e6, 2.6e6, 2.6e6]
hinge = [0.0, 0.0, 0.0]
motion = ["heave"]
offset = 0.5
end_stops = { lower = -0.3, upper = 2.0, stiffness = 1e7, damping = 1e5 }
[sea_states]
still = { kind = "still" }
regular = { kind = "regular", height = 0.2, period = 3.5 }
"""
# A float that turns, hinged on one that slides: axes of both kinds.
CARRIED = """
[[floats]]
name = "front"
on = "sphere"
hull = { shape = "sphere", radius = 1.0, draft = 1.0 }
mass = 2147.0
inertia = [859.0, 859.0, 859.0]
hinge = [-5.0, 0.0, 2.6]
arm = [-3.5, 0.0, -2.6]
pto_damping = 5e4
[axes]
hinge_spacing = [5.0]
"""
LINES = '[solver]\nmethod = "frequency"\nfroude_krylov = "linear"\n[variants.a]\n'
OUTPUTS = 'outputs = ["fatigue", "leg_tops", "reactions", "section_forces", "fibre_stress", "utilisation", '
OUTPUTS += '"member_stress", "accelerations", "static_part", "moments"]\n'
OUTPUTS += "[record.fatigue]\nscf = 2.0\n"
YIELDING = SMALL.replace("density = 8012.0", "density = 8012.0\nyield_strength = 355e6")
CALM = "[sea_states]\ncalm = { Hs = 0.5, Tp = 5.0 }\n"
OFTEN = CALM.replace("5.0 }", "5.0, occurrence = 2000.0 }")
STOPS = "lower = -0.3, upper = 2.0, stiffness = 1e7, damping = 1e5"
MORE = "lower = [0, -1.0], upper = [0, 1.0], stiffness = [0, 1e7]"  # on one axis of two
MOORED = '["surge", "heave"]\nstiffness = [2e5, 0]\n'
MOORED += "lines = [{ anchor = [-60, 0, -20], fairlead = [-5, 0, 0], length = 60.0, weight = 100.0, EA = 1e6 }]"
TAKEOFF = "offset = 0.5\nhold = true\n"
TAKEOFF += "pto_damping = 1e4\npto_efficiency = { generating = 0.9 }\nlatch_load = 1e3\ndeclutch_load = 5e4"
PER_WAVE = "rao = true\nspectra = true\n"
FORCES = 'outputs = ["pto_force", "pto_stroke"]\n'
DRIFTING = "outputs = ['drift']\nrao = true\n" + LINES.replace("[variants.a]\n", "")
BALANCED = SPHERE.replace("mass = 261.8e3", 'mass = "balance"')
# Every kind of scene, sea, path and output.
REAL = {
    "elastic": SMALL.replace("seed = [0, 1]", "seed = [0]").replace('["calm", "rough"]', '["rough"]') + SHORT,
    "heave": BALANCED.replace("offset = 0.5", TAKEOFF) + SHORT + FORCES + PER_WAVE + "[solver]\ntolerance = 0.05\n",
    "floating": SPHERE.replace('["heave"]\noffset = 0.5', MOORED).replace(STOPS, MORE) + CARRIED + SHORT,
    "steel": YIELDING[: YIELDING.index("[axes]")] + OFTEN + SHORT + OUTPUTS,
    "drifting": SPHERE.replace(f"end_stops = {{ {STOPS} }}\n", "")
    .replace('["heave"]\noffset = 0.5', MOORED + "\ndamping = [1e4, 0]")
    .replace('still = { kind = "still" }\n', "")
    + SHORT.replace("full", "none")
    + DRIFTING,
    "lines": SMALL[: SMALL.index("[axes]")] + CALM + SHORT.replace("full", "none") + LINES,
    "paper": SMALL[: SMALL.index("[axes]")] + CALM + SHORT.replace("6.0", "1.0") + '[solver]\naccuracy = "reference"\n',
}


def coarse(geometries, _shares):
    """Coefficients in a second: their names are the fine ones'."""
    few = {"panels": 108}
    return [cache.encode(engine.hydrodynamics(g.model_copy(update=few)), g.key) for g in geometries]


@pytest.fixture(scope="module")
def real():
    """A folder of results that the solver itself has left, once for all workers of a run."""
    return made("real", leave) / "r"


def leave(folder):
    solver = engine.Engine(share=lambda *_: None, coefficients=coarse)
    for name, text in REAL.items():
        path = folder / f"{name}.toml"
        path.write_text(text)
        study, store = load(path), Store(folder / "r", name)
        job = Campaign(study=path, results=folder / "r", store=store, engine=solver, place=Place(workers=1))
        assert job.run(study.tasks, lambda *_: None) == []
        dataset.collect(study, store)


@pytest.fixture
def ran(small, tmp_path, engine):
    study = load(small)
    store = Store(tmp_path / "r", "small")
    tasks = study.tasks
    job = Campaign(study=small, results=tmp_path / "r", store=store, engine=engine, place=Place(workers=1))
    job.run(tasks, lambda *_: None)
    return study, store, list(tasks)


def complaints(path, tmp_path):
    """What compliance-checker says against CF-1.11."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # warnings of the checker
        from compliance_checker.runner import CheckSuite, ComplianceChecker

        CheckSuite.load_all_available_checkers()
        told = tmp_path / "told.json"
        ComplianceChecker.run_checker(
            str(path), ["cf:1.11"], 0, "normal", output_filename=str(told), output_format="json"
        )
    told_of = json.loads(told.read_text())["cf:1.11"]
    return [m for level in ("high", "medium", "low") for r in told_of[f"{level}_priorities"] for m in r["msgs"]]


def test_files_keep_what_they_are_given_and_are_whole_or_refused():
    """Text, whole numbers, doubles, scalars, empty words, sizes that are no multiple of four."""
    variables = {
        "float": Variable(("float",), np.array(["front", "größer"]), {"long_name": "Name"}),
        "power": Variable(("float", "statistic"), np.arange(6.0).reshape(2, 3), {"units": "W", "_FillValue": np.nan}),
        "statistic": Variable(("statistic",), np.array(["max", "min", "ab"]), {}),
        "leg": Variable(("leg",), np.arange(1, 4), {"long_name": ""}),
        "few": Variable(("few",), np.arange(5), {"valid_min": 0}),
        "task": Variable((), np.array("0123abcde"), {"units": "1", "number": 3}),
        "error": Variable((), np.asarray(1e-3), {}),
    }
    attrs = {"Conventions": "CF-1.11", "unmet": "", "wall_time": 0.5, "count": 7}
    whole = to_bytes(variables, attrs)
    read, said = from_bytes(whole)
    assert content(read, said) == content({name: variable_as_kept(v) for name, v in variables.items()}, attrs)
    head = whole.index(b"Conventions")
    for length in (*range(0, head, 3), *range(head, len(whole) - 3)):
        with pytest.raises(ValueError, match=r"netCDF-3|buffer"):
            from_bytes(whole[:length])
    with pytest.raises(ValueError, match="dimension leg is 3 and 4 long"):
        to_bytes({**variables, "more": Variable(("leg",), np.arange(4.0), {})}, attrs)


def variable_as_kept(variable):
    """With whole numbers of 32 bits."""
    array = np.asarray(variable.values)
    return variable._replace(values=array.astype("i4") if array.dtype.kind == "i" else array)


def test_dataset_and_records_are_clean_under_cf(ran, tmp_path):
    study, store, tasks = ran
    assert complaints(dataset.collect(study, store)[0], tmp_path) == []
    for task in tasks[::2]:
        assert complaints(store.look(task).record, tmp_path) == []


def variables(path):
    with xr.open_dataset(path, decode_cf=False) as data:
        return {str(name): (v.dims, v.dtype.kind, v.attrs) for name, v in data.variables.items()}


def test_the_one_table_names_all_that_runs_leave_and_nothing_else(real):
    """Elastic, fixed, no floats, guided, floating, RAO, series, tolerance, lines, the paper's way: all have units."""
    left = {}
    for path in real.glob("**/*.nc"):
        if path.parent.name != "hydrodynamics":
            left |= {(path, name): told for name, told in variables(path).items()}
    for (path, name), (dims, kind, attrs) in left.items():
        assert attrs.get("long_name"), (path, name)
        mixed = path.is_relative_to(real / "floating") and "axis" in dims
        assert "units" in attrs or kind in "OSU" or mixed, (path, name)
    listed = VARIABLES.keys() | KNOBS.keys() | COORDINATES.keys()
    assert {re.sub(f"({'|'.join([SERIES, *OF_OUTPUTS])})$", "", name) for _, name in left} == listed
    with xr.open_dataset(real / "heave" / "statistics.nc") as data:
        told = [data[name].attrs.get("units") for name in ("motion_spectrum", "pto_force_response", "motion_coherence")]
        assert told == ["m2 s rad-1", "N m-1", "1"]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("utilisation_m0", "1"), ("utilisation_m2", "rad2 s-2"), ("latched_spectrum", "s rad-1"),
        ("utilisation_response", "1 m-1"), ("bottom_stress_m0", "Pa2"), ("pto_force_spectrum", "(N m)2 s rad-1"),
        ("utilisation_coherence", "1"),
    ],
)  # fmt: skip
def test_what_goes_with_an_output_has_its_unit_squared(name, unit):
    assert meaning(name, ["pitch"])["units"] == unit


def test_a_key_of_several_floats_has_the_unit_of_their_axes():
    """Though others slide."""
    motions = {"base": ("heave", "surge"), "rotor-1": ("hinge",), "rotor-2": ("hinge",)}
    for path, unit in (("floats.rotor-*.pto_damping", "N m s rad-1"), ("floats.base.damping", "N s m-1")):
        assert of_path(path, [1e5, 2e5], motions)["units"] == unit
    assert "units" not in of_path("floats.*.damping", [1e5, 2e5], motions)
    motions = {"base": ("heave", "pitch"), "rotor": ("hinge",)}  # of which a place is that axis's
    for place, unit in ((0, "N s m-1"), (1, "N m s rad-1"), (2, None)):
        assert of_path(f"floats.base.damping.{place}", [1e5, 2e5], motions).get("units") == unit


def test_motion_along_an_axis_has_its_unit(real):
    """Where axes slide and turn, the unit is beside the axis."""
    with xr.open_dataset(real / "heave" / "statistics.nc") as data:
        assert (data.motion.attrs["units"], data.rao.attrs["units"]) == ("m", "m m-1")
        assert (data.impact_rate.attrs["units"], data.end_stop_load.attrs["units"]) == ("m s-1", "N")
        still = data.sel(sea_state="still")
        assert still.end_stop_hits.item() == 1 and 0 < still.impact_rate.item() < 0.5
        assert data.axis_unit.values.tolist() == ["m"]
    for path in (real / "floating").glob("**/*.nc"):
        with xr.open_dataset(path) as data:
            assert "units" not in data.motion.attrs
            assert dict(zip(data.axis.values, data.motion.axis_unit.values, strict=True)) == {
                "surge": "m", "heave": "m", "hinge": "rad"
            }  # fmt: skip


@pytest.mark.slow
def test_what_the_solver_itself_leaves_is_clean_under_cf(real, tmp_path):
    for path in [
        *(real / name / "statistics.nc" for name in ("floating", "steel")),
        next(real.glob("heave/tasks/*/record.nc")),
    ]:
        assert complaints(path, tmp_path) == [], path


def test_records_of_different_platforms_open_together(real):
    """The default of xarray, coords="different", wants every coordinate in every file."""
    paths = sorted((real / "elastic" / "tasks").glob("*/record.nc"))
    with xr.open_mfdataset(paths, combine="nested", concat_dim="task", coords="minimal", join="outer") as data:
        assert data.task.values.tolist() == [path.parent.name for path in paths]
        for path in paths:
            with xr.open_dataset(path) as one:
                row = data.sel(task=path.parent.name)
                for name, values in one.data_vars.items():
                    xr.testing.assert_equal(row[name].drop_vars("task").reindex_like(values), values.drop_vars("task"))
                assert row.bottom_stress.isnull().all() == ("leg" not in one.coords)


def test_records_open_one_by_one_and_together(ran):
    _, store, tasks = ran
    paths = [store.look(task).record for task in tasks[:2]]
    with xr.open_dataset(paths[0]) as one:
        assert one.statistic.values.tolist() == ["max", "min", "mean", "rms", "std"]
    with xr.open_mfdataset(paths, combine="nested", concat_dim="task") as both:
        assert both.rotation.dims == ("task", "float", "statistic")
        assert both.task.values.astype(str).tolist() == [task.id for task in tasks[:2]]


def test_provenance_is_in_the_attributes(ran):
    _, store, tasks = ran
    with xr.open_dataset(store.look(tasks[0]).record) as data:
        assert json.loads(data.attrs["parameters"])["sea_state"] == {"Hs": 0.5, "Tp": 5.0}
        assert data.attrs["wave_seed"].split() == [str(word) for word in wave_seed(tasks[0].parameters)]
        assert re.fullmatch(r"[0-9a-f]{40}(-dirty)?|unknown", data.attrs["commit"])
        assert {"host", "numpy", "numba", "solver_sources", "wall_time", "task"} <= data.attrs.keys()


WHOLE = Variable(("float",), np.array([1.0, 0.0]), {"units": "m"})


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"values": np.array([1.0, 1e-300])}, "x: differs by up to 1e-300"),
        ({"values": np.array([1.0, -0.0])}, "x: differs by up to 0"),
        ({"values": np.array([1.0, 0.0], "f4")}, "x: float64(2,) became float32(2,)"),
        ({"values": np.array([1, 0], "i4")}, "x: float64(2,) became int32(2,)"),
        ({"values": np.array([1.0, 0.0, 0.0])}, "x: float64(2,) became float64(3,)"),
        ({"values": np.array(["1.0", "0.0"])}, "x: float64(2,) became <U3(2,)"),
        ({"dims": ("leg",)}, "x: dimensions float became leg"),
        ({"attrs": {"units": "km"}}, "x: units m became km"),
        ({"attrs": {}}, "x: units m became None"),
    ],
)
def test_whatever_changes_in_a_record_is_named_and_changes_its_digest(changed, words):
    old, new = {"x": WHOLE}, {"x": WHOLE._replace(**changed)}
    assert records.differences(old, new) == [words]
    assert content(old) != content(new)


def test_a_digest_is_of_types_and_attributes_too():
    """Zeros have the same bits in numbers of either kind."""
    x, n = ({"x": Variable(("leg",), np.zeros(2, kind), {})} for kind in ("f4", "i4"))
    assert len({content(x), content(n), content(x, {"unit": "m"}), content(x, {"unit": "km"})}) == 4


def test_labels_that_change_are_named():
    old, new = ({"leg": Variable(("leg",), np.array(names), {})} for names in (["a", "b"], ["a", "c"]))
    assert records.differences(old, new) == ["leg: other labels"]
    assert records.differences(old, from_bytes(to_bytes(old, {"host": "other"}))[0]) == []
    assert content(old) != content(new)


@pytest.mark.parametrize(("series", "step"), [("full", 1), ("decimated", 6)])
def test_series_stand_beside_the_statistics(ran, tmp_path, series, step):
    """Every sixth sample: four in the shortest wave, 2π/3.4 s, at 0.075 s a sample."""
    _, _, tasks = ran
    parameters = tasks[0].parameters.model_copy(update={"record": Recording(series=series)})
    time = 100 + 0.075 * np.arange(60)
    record = SimpleNamespace(
        variables={"wave_elevation": (("statistic",), np.arange(2.0))},
        coords={"statistic": np.array(["max", "min"])},
        attrs={},
        series={"wave_elevation": (("time",), np.sin(time)), "time": (("time",), time)},
    )
    path = tmp_path / "record.nc"
    path.write_bytes(to_bytes(*records.made(record, parameters, {"task": "x"})[0]))
    with xr.open_dataset(path) as data:
        np.testing.assert_array_equal(data.wave_elevation_series, np.sin(time[::step]))
        assert data.wave_elevation.dims == ("statistic",)
    assert complaints(path, tmp_path) == []


def test_a_series_of_one_sample_is_kept(ran):
    parameters = ran[2][0].parameters.model_copy(update={"record": Recording(series="decimated")})
    short = SimpleNamespace(variables={}, coords={}, attrs={}, series={"time": (("time",), np.array([100.0]))})
    (variables, _), _ = records.made(short, parameters, {"task": "x"})
    assert variables["elapsed_time"].values.tolist() == [100.0]
