"""Paired differences, ratios and slow parts, on numbers made up here."""

import hashlib

import numpy as np
import pytest
import xarray as xr

from pipeline.bridge.loading import load
from pipeline.report.published import Published, read_published
from pipeline.results.netcdf import Variable, to_bytes
from pipeline.tasks.select import select
from pipeline.tasks.task import digest
from studies import paper


def published(value="1.0", **changed):
    row = {"table": "T", "label": "a", "variable": "rotation", "selection": {"platform": ["fixed"]}, "statistic": "std",
           "value": float(value), "text": value, "unit": "rad", "note": ""}  # fmt: skip
    return Published(**row | changed)


def study(values, *, height=1.28):
    """Rotations of so many seeds on one platform."""
    dims = ("sea_state", "platform", "seed")
    count = len(values)
    return xr.Dataset(
        {
            "rotation": ((*dims, "statistic"), np.reshape(values, (1, 1, count, 1)).astype(float)),
            "Hm0": (dims, np.full((1, 1, count), height)),
        },
        coords={"sea_state": ["s"], "platform": ["fixed"], "seed": np.arange(count), "statistic": ["std"]},
    )


def test_differences_of_the_same_seas_are_paired():
    """Half as much again in every realization: 50 %, and no scatter however much the realizations differ."""
    base = study([1.0, 2.0, 3.0, 4.0, 5.0, 90.0])
    share, error = paper.change(base, study([1.5, 2.5, 3.5, 4.5, 5.5]), published())
    assert (share, error) == pytest.approx((0.5 / 3.0, 0.0), abs=1e-15)
    other = study([1.5, 2.5, 3.5, 4.5, 5.5], height=1.3)
    share, error = paper.change(base, other, published())
    assert share == pytest.approx(0.5 / 3.0)
    assert error == pytest.approx(np.sqrt(2 * 2.5 / 5) / 3.0)  # both variances are 2.5


def test_a_task_that_failed_is_left_out_of_both():
    base = study([1.0, 2.0, 3.0])
    share, _ = paper.change(base, study([2.0, np.nan, 4.0]), published())
    assert share == pytest.approx(1.0 / 2.0)
    assert paper.change(base, study([np.nan] * 3), published()) is None


def test_a_change_that_brings_the_published_number_into_our_range_is_bold():
    base = study(np.linspace(0.9, 1.1, 21))
    twice = study(2 * np.linspace(0.9, 1.1, 21))
    assert paper.cell(base, twice, published("2.00")) == "**+100.0 ± 1.4**"
    assert paper.cell(base, twice, published("2.20")) == "+100.0 ± 1.4"


def test_what_is_slower_than_the_waves(tmp_path):
    """A sine of 0.3 rad/s and amplitude 0.1 beside a larger one of 1.2 rad/s: RMS 0.1/√2; whole periods, no leakage."""
    step = 2 * np.pi / 0.3 / 200
    time = step * np.arange(4000)
    values = 0.7 + 0.1 * np.sin(0.3 * time) + 0.4 * np.sin(1.2 * time)
    folder = tmp_path / "buan-series" / "tasks" / "t1"
    folder.mkdir(parents=True)
    record = {
        "float": Variable(("float",), np.array(["front"]), {}),
        "elapsed_time": Variable(("elapsed_time",), time, {}),
        "rotation_series": Variable(("elapsed_time", "float"), values[:, None], {}),
    }
    (folder / "record.nc").write_bytes(to_bytes(record, {}))
    data = xr.Dataset({"task": (("platform", "seed"), [["t1"]])}, coords={"platform": ["fixed"], "seed": [0]})
    assert paper.below(tmp_path, data, "fixed", "front") == pytest.approx(0.1 / np.sqrt(2), rel=1e-9)


def test_every_finding_names_published_numbers():
    known = {(row.variable, row.label, row.statistic) for row in read_published(paper.PUBLISHED)}
    for _, variable, top, bottom in (*paper.FINDINGS, *paper.PEAKS):
        assert {(variable, *top), (variable, *bottom)} <= known


def test_the_page_has_a_place_for_every_section_and_keeps_its_prose():
    names = ("tables", "variants", "dry tops", "findings", "peaks", "slow rotation")
    page = paper.PAGE.read_text()
    new = paper.renewed(page, {name: f"new {name}" for name in names})
    assert all(f"<!-- {name} -->\nnew {name}\n<!-- /{name} -->" in new for name in names)
    kept = [line for line in page.splitlines() if line.startswith("## ")]
    assert [line for line in new.splitlines() if line.startswith("## ")] == kept


# SHA-256 of the ids of all tasks, sorted, as model version 6 has them: those of the files that paper.toml replaces, and
# since then with the deck beams' one element written down.
SAME_TASKS = "4a4fd1763ad70f92ca18f186ed9395c0543ba013adef19bfb090ca0f03d3a928"


def test_the_study_is_the_case_and_its_variants():
    """The tasks are those of the twenty studies that this one replaces; seeds of a variant are among the case's."""
    study = load(paper.STUDY)
    ids = {
        name: {digest(t.parameters.canonical(), 6) for t in select(study, f"variant={name}")}
        for name in study.content.variants
    }
    assert hashlib.sha256(" ".join(sorted(set().union(*ids.values()))).encode()).hexdigest() == SAME_TASKS
    assert sum(map(len, ids.values())) == len(study.tasks) == 332
    case = ids.pop("buan")
    assert len(case) == 117 and not case & set().union(*ids.values())
    assert {name: len(own) for name, own in ids.items() if len(own) != 10} == {"dry-tops": 40, "printed-spectrum": 15}


def test_geometric_stiffness_is_refused_and_so_no_variant():
    assert "gravity is 2.25 times the Euler load" in paper.refusal()


def test_variants_are_compared_with_the_first_and_counted_where_they_have_tasks():
    base, other = study([1.0, 2.0, 3.0, 4.0, 5.0]), study([1.5, 2.5, 3.5, 4.5, np.nan])
    data = xr.concat([base, other], xr.DataArray(["case", "more"], dims="variant", name="variant"))
    data["status"] = xr.where(data.rotation.notnull().squeeze("statistic", drop=True), "done", "no task")
    data["variant_title"] = ("variant", ["The case", "Half more"])
    text = "\n".join(paper.variants(data, [published("2.75", selection={"platform": ["fixed"]})]))
    assert "- `more`: Half more (4 done)" in text
    assert "| +20.0 |" in text
