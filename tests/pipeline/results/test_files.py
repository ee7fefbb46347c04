"""What others make of the files: compliance checker, xarray; and time series."""

import json
import re
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from pipeline.bridge.loading import load
from pipeline.results import dataset, records
from pipeline.results.store import Store
from pipeline.running.campaign import Campaign
from pipeline.running.schedule import Place
from pipeline.study.schema import Recording
from pipeline.tasks.task import wave_seed


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
        warnings.simplefilter("ignore")  # the checker's own
        from compliance_checker.runner import CheckSuite, ComplianceChecker

        CheckSuite.load_all_available_checkers()
        told = tmp_path / "told.json"
        ComplianceChecker.run_checker(
            str(path), ["cf:1.11"], 0, "normal", output_filename=str(told), output_format="json"
        )
    found = json.loads(told.read_text())["cf:1.11"]
    return [m for level in ("high", "medium", "low") for r in found[f"{level}_priorities"] for m in r["msgs"]]


def test_dataset_and_records_are_clean_under_cf(ran, tmp_path):
    study, store, tasks = ran
    assert complaints(dataset.collect(study, store)[0], tmp_path) == []
    for task in tasks[::2]:
        assert complaints(store.look(task).record, tmp_path) == []


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
    path.write_bytes(records.encode(record, parameters, {"task": "x"})[0])
    with xr.open_dataset(path) as data:
        np.testing.assert_array_equal(data.wave_elevation_series, np.sin(time[::step]))
        assert data.wave_elevation.dims == ("statistic",)
    assert complaints(path, tmp_path) == []
