"""The tube with the largest utilisation, and how many fail."""

import numpy as np
import xarray as xr

from pipeline.report import bearing
from pipeline.report.bearing import HEADER, NOTE, rows, table
from pipeline.report.report import answers
from pipeline.report.tables import MANY, SURVIVORS
from pipeline.report.yearly import counts

EACH = [[[0.2, 0.4], [0.3, 0.1]], [[0.8, 1.5], [0.7, 1.2]], [[1.4, 1.1], [0.5, 0.7]]]  # sea, seed, tube


def dataset(each=EACH, **coords):
    """Largest utilisation (sea_state, seed, tube); the least does not count."""
    values = np.stack([np.array(each, float), -9 + 0 * np.array(each, float)], axis=-1)
    known = {"sea_state": ["mild", "rough", "long"], "tube": ["leg", "brace"], "statistic": ["max", "min"]}
    dims = ("sea_state", "seed", "tube", "statistic")
    return xr.Dataset({"utilisation": (dims, values, {"units": "1"})}, coords=known | coords)


def test_each_sea_has_its_worst_tube_and_marks_those_that_fail():
    """By means, beside the largest of a realization, which may be above 1 where the mean is not, as of the leg."""
    data = dataset()
    assert list(rows(data)) == [
        ("mild", "leg", "0.25", "0.3", "0 of 2", "2"),
        ("rough", "brace", "1.35 *", "1.5 *", "1 of 2", "2"),
        ("long", "leg", "0.95", "1.4 *", "0 of 2, 2 in some", "2"),
    ]
    told = table(data)
    assert told in answers(data) and {len(line) for line in told.lines} == {len(HEADER)} and "fails" in NOTE


def test_a_study_of_one_sea_and_record_or_of_none():
    one = dataset().isel(seed=0)
    assert list(rows(one.isel(sea_state=1))) == [("", "brace", "1.5 *", "1.5 *", "1 of 2", "1")]
    assert [line[0] for line in rows(one.isel(sea_state=[1]))] == ["rough"]
    assert table(xr.Dataset()).lines == []


def test_of_many_designs_each_has_its_worst_sea_and_the_worst_is_the_first():
    for count in (MANY, MANY + 1):
        size = xr.DataArray(np.arange(1.0, count + 1), dims="sample")
        data = (dataset() * size).assign_coords(sample=np.arange(count))
        lines = [line[0] for line in rows(data)]
        if count == MANY:
            assert lines[:3] == ["sample 0, mild", "sample 0, rough", "sample 0, long"] and len(lines) == 3 * count
        else:
            assert lines == [f"sample {n}, rough" for n in range(MANY, -1, -1)]


def test_a_design_that_failed_whole_is_told():
    """A line of its own, or of more than MANY one for all."""
    for count in (2, MANY + 2):
        data = dataset().expand_dims(sample=np.arange(count)).copy(deep=True)
        data = data.assign(status=(("sample", "sea_state", "seed"), np.full((count, 3, 2), "failed", "U8")))
        data.status[0], data.utilisation[1:] = "done", np.nan
        told = table(data)
        label = "sample 1" if count == 2 else f"{count - 1} designs"
        assert told.lines[-1] == (label, *["-"] * 4, f"-, {6 * (count - 1)} failed")
        assert SURVIVORS in told.note and len({*map(len, told.lines)}) == 1


def test_realizations_that_failed_are_told():
    data = dataset().assign(status=(("sea_state", "seed"), [["done"] * 2, ["done", "failed"], ["failed"] * 2]))
    data.utilisation[1, 1] = data.utilisation[2] = np.nan
    told = table(data)
    assert told.lines[1][2:] == ("1.5 *", "1.5 *", "1 of 2", "1, 1 failed") and SURVIVORS in told.note
    assert told.lines[2] == ("long", "-", "-", "-", "-", "0, 2 failed")  # as many of each tube


def test_designs_are_reckoned_at_once_and_each_has_the_lines_that_it_has_alone(monkeypatch):
    """Wherever the worst tube is, or none is known."""
    reckoned = []
    monkeypatch.setattr(bearing, "counts", lambda each: reckoned.append(each) or counts(each))
    data = xr.concat([dataset(), dataset(2 * np.array(EACH)[..., ::-1]), dataset()], "sample")
    data = data.assign_coords(sample=[0, 1, 2])
    data.utilisation[2, 0] = data.utilisation[2, 1, 1] = np.nan
    alone = [line for i in range(3) for line in rows(data.isel(sample=[i]))]
    reckoned.clear()
    assert list(rows(data)) == alone and len(reckoned) == 3
    assert alone[6][1:] == ("-", "-", "-", "-", "0, 2 failed") and alone[7][1:3] == ("brace", "1.5 *")
