"""The table of natural periods, from the records of tasks."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from pipeline.bridge.loading import load
from pipeline.report import figures, page
from pipeline.report.periods import natural_periods
from pipeline.results.netcdf import Variable, to_bytes


@pytest.fixture
def results(small, tmp_path):
    """The first task of the fixed support has no record, the second is damaged; without floats there is none at all."""
    coords = {"sea_state": ["calm", "rough"], "platform": ["elastic", "fixed", "elastic-no-floats"], "seed": [0, 1]}
    tasks = np.array([f"t{i}" for i in range(12)]).reshape(2, 3, 2)
    data = xr.Dataset({"task": (tuple(coords), tasks)}, coords=coords)
    periods = {"t0": [5.5, np.inf], "t2": None, "t3": b"cut", "t8": [2.25, 0.125]}
    for task, values in periods.items():
        folder = tmp_path / task
        folder.mkdir()
        if isinstance(values, bytes):
            (folder / "record.nc").write_bytes(values)
        elif values:
            known = {"system_period": Variable(("system_mode",), np.array(values), {})}
            shapes = {"system_shapes": "front hinge - rear hinge; <platform> x"}
            (folder / "record.nc").write_bytes(to_bytes(known, shapes))
    return figures.Results(study=load(small), data=data, tasks=tmp_path)


def test_each_support_has_its_first_record_that_has_periods(results):
    assert dict(natural_periods(results)) == {
        "elastic": [("5.5", "front hinge - rear hinge"), ("inf", "<platform> x")],
        "fixed": [("2.25", "front hinge - rear hinge"), ("0.125", "<platform> x")],
    }


def test_the_page_says_of_which_labels_they_are(results, small):
    small.write_text(small.read_text().replace("[sea_states", "[axes.water]\ndepth = [50.0, 60.0]\n[sea_states", 1))
    data = xr.concat([results.data] * 2, "depth").assign_coords(depth=[50.0, 60.0])
    assert "against it (-). Shown at depth 50.</p>" in page.html(replace(results, study=load(small), data=data))


def test_the_page_has_the_table_where_there_are_periods(results):
    assert '<td>2.25</td><td class="word">front hinge - rear hinge</td>' in page.html(results)
    assert "&lt;platform&gt; x" in page.html(results)
    assert "Natural periods" not in page.html(replace(results, tasks=None))
