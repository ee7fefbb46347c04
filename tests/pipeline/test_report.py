"""The table beside the published numbers."""

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

from pipeline import report
from pipeline.study import StudyError
from pipeline.variables import VARIABLES

HEAD = ",".join(report.COLUMNS)


@pytest.fixture
def data():
    values = np.array([[[1e3, 2e3, 3e3], [4e3, 5e3, 6e3]]])
    return xr.Dataset(
        {"absorbed_power": (("platform", "float", "seed"), values)},
        coords={
            "platform": ["fixed"],
            "float": ["front", "rear"],
            "seed": [0, 1, 2],
            "sea_state": "mild",
        },
    )


def row(path, text):
    path.write_text(f"{HEAD}\n{text}\n")
    return report.published(path)[0]


@pytest.mark.parametrize(
    ("selection", "mean", "low", "high"),
    [
        ("platform=fixed;float=front", 2.0, 1.0, 3.0),
        ("platform=fixed;float=front+rear", 3.5, 2.5, 4.5),
        ("platform=fixed;float=rear;seed=1;sea_state=mild", 5.0, 5.0, 5.0),
    ],
)
def test_selection_units_and_spread(data, tmp_path, selection, mean, low, high):
    mine = report.ours(data, row(tmp_path / "p.csv", f"T,power,absorbed_power,{selection},,2.0,kW,"))
    assert (mine.mean, mine.low, mine.high) == (mean, low, high)


@pytest.mark.parametrize("selection", ["platform=elastic", "platform=fixed;leg=1", "sea_state=rough"])
def test_what_is_not_there_is_not_invented(data, tmp_path, selection):
    assert report.ours(data, row(tmp_path / "p.csv", f"T,power,absorbed_power,{selection},,2.0,kW,")) is None


def test_a_number_far_off_gets_its_sentence(data, tmp_path):
    rows = [
        row(tmp_path / "a.csv", "T,power,absorbed_power,float=front,,8.0,kW,the paper's spike"),
        row(tmp_path / "b.csv", "T,other,absorbed_power,float=front,,2.1,kW,never said"),
    ]
    console = Console(record=True, width=120)
    report.show(data, rows, console)
    text = console.export_text()
    assert "* power: the paper's spike" in text
    assert "never said" not in text
    assert "0.25 *" in text


def test_bad_rows_are_named(tmp_path):
    with pytest.raises(StudyError, match="row 1 = 'power': could not convert"):
        row(tmp_path / "p.csv", "T,power,absorbed_power,,,many,kW,")
    (tmp_path / "q.csv").write_text("a,b\n1,2\n")
    with pytest.raises(StudyError, match="must be table, label"):
        report.published(tmp_path / "q.csv")


def test_published_numbers_of_the_project_name_known_variables():
    for path in (Path(__file__).parents[2] / "studies").glob("*-published.csv"):
        rows = report.published(path)
        assert rows
        assert {r.variable for r in rows} <= VARIABLES.keys()
        with path.open(newline="") as file:
            assert all(None not in r for r in csv.DictReader(line for line in file if not line.startswith("#")))
