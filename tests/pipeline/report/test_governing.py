"""Which sea state governs each load and motion."""

import numpy as np
import xarray as xr

from pipeline.report.governing import NOTHING, SEVERAL, rows, table
from pipeline.report.tables import SURVIVORS

SEAS = ["mild", "rough", "long"]


def dataset(force, **coords):
    """Largest and least hinge force (sea_state, seed, float, direction)."""
    high, low = (np.asarray(side, float) for side in force)
    dims = ("sea_state", "seed", "float", "direction", "statistic")
    known = {"sea_state": SEAS, "float": ["front", "rear"], "direction": ["x", "z"], "statistic": ["max", "min"]}
    values = dims, np.stack([high, low], axis=-1), {"units": "N"}
    return xr.Dataset({"hinge_force": values}, coords=known | coords)


def forces():
    """Largest along x at rear in `rough`, downwards along z at front in `long`; two realizations."""
    high, low = np.ones((3, 2, 2, 2)), -np.ones((3, 2, 2, 2))
    high[1, :, 1, 0], high[2, :, 0, 0] = [7.0, 9.0], [6.0, 7.0]
    low[2, :, 0, 1] = [-3.0, -5.0]
    return high, low


def test_each_component_has_its_place_its_sea_and_the_next():
    data = dataset(forces())
    assert list(rows(data)) == [
        ("", "hinge_force x", "rear", "rough", "8", "N", "[7, 9]", "long", "6.5", "2"),
        ("", "hinge_force z", "front", "long", "4", "N", "[3, 5]", "mild", "1", "2"),
    ]
    told = table(data)
    assert told.lines == list(rows(data)) and {len(line) for line in told.lines} == {len(told.header)}


def test_of_one_sea_state_there_is_nothing_to_tell():
    data = dataset(forces())
    for one in (data.isel(sea_state=[0]), data.isel(sea_state=0), xr.Dataset()):
        assert table(one).lines == []


def test_a_component_that_is_rounding_has_no_line():
    high, low = forces()
    high[..., 1], low[..., 1] = 0.9 * NOTHING * high.max(), 0.0
    assert [line[1] for line in rows(dataset((high, low)))] == ["hinge_force x"]


def test_designs_have_lines_of_their_own_as_long_as_they_are_few():
    """Of many the largest has one, which says whose it is."""
    for count in (SEVERAL, SEVERAL + 1):
        sizes = xr.DataArray(np.arange(1.0, count + 1), dims="sample")
        data = (dataset(forces()) * sizes).assign_coords(sample=np.arange(count)).sel(direction=["x"])
        lines = list(rows(data))
        if count == SEVERAL:
            assert [line[0] for line in lines] == [f"sample {n}" for n in range(count)]
            assert [line[2] for line in lines] == ["rear"] * count and lines[-1][4] == f"{8 * count}"
        else:
            ((design, _, where, sea, largest, *_),) = lines
            assert (design, where, sea, largest) == ("", f"rear, sample {count - 1}", "rough", f"{8 * count}")


def test_realizations_and_seas_that_failed_are_told():
    high, low = forces()
    high[1, 1], low[1, 1] = np.nan, np.nan
    status = np.full((3, 2), "done", object)
    status[1, 1] = "failed"
    told = table(dataset((high, low)).assign(status=(("sea_state", "seed"), status.astype(str))))
    assert told.lines[0][3:7] == ("rough", "7", "N", "") and told.lines[0][-1] == "1, 1 failed"
    assert SURVIVORS in told.note
    high[1], low[1] = np.nan, np.nan
    first, second = rows(dataset((high, low)))
    assert first[3:8] == ("long (of 2 among 3)", "6.5", "N", "[6, 7]", "mild") and second[7] == "mild"
    high[2], low[2] = np.nan, np.nan
    assert [line[3:9] for line in rows(dataset((high, low)))] == [("mild (of 1 among 3)", "1", "N", "", "-", "-")] * 2


def test_of_many_designs_together_all_that_failed_are_told():
    """Those that failed in the rough sea have their largest elsewhere, which is then the next one."""
    many = xr.concat([dataset(forces())] * (SEVERAL + 1), "sample").assign_coords(sample=np.arange(SEVERAL + 1))
    status = np.full((SEVERAL + 1, 3, 2), "done", object)
    status[1:3, 1] = "failed"
    state = xr.DataArray(status.astype(str), dims=("sample", "sea_state", "seed"))
    told = table(many.where(state == "done").assign(status=state))
    assert told.lines[0][3] == "rough" and told.lines[0][-1] == "2, 4 failed" and SURVIVORS in told.note


def test_a_float_that_is_lifted_out_in_a_sea_has_not_failed_there():
    """All tasks are done. One that failed there is told, and one that lacks what the other realization has."""
    high, low = forces()
    high[1, :, 1], low[1, :, 1] = np.nan, np.nan
    data = dataset((high, low)).assign(status=(("sea_state", "seed"), np.full((3, 2), "done", dtype="U8")))
    told = table(data)
    assert [line[-1] for line in told.lines] == ["2", "2"] and SURVIVORS not in told.note
    assert [line[-1] for line in rows(data.isel(seed=0))] == ["1", "1"]
    failed = data.copy(deep=True)
    failed.status[1, 0] = "failed"
    assert [line[-1] for line in rows(failed)] == ["2, 1 failed"] * 2
    data.hinge_force[0, 1, 1] = np.nan
    assert [line[-1] for line in rows(data)] == ["2, 1 failed"] * 2


def test_designs_of_which_all_tasks_failed_are_told_last():
    """Not those of which nothing has run, nor a study that has nothing to tell; of many one line has them all."""
    count = SEVERAL + 3
    many = xr.concat([dataset(forces())] * count, "sample").assign_coords(sample=np.arange(count))
    status = np.full((count, 3, 2), "failed", object)
    status[0], status[1, 1:], status[2] = "done", "missing", "missing"
    status[0, 1, 1] = "failed"  # among others that have not
    state = xr.DataArray(status.astype(str), dims=("sample", "sea_state", "seed"))
    data = many.where(state == "done").assign(status=state)
    few = table(data.isel(sample=slice(5)))
    assert few.lines[-3:] == [(f"sample {n}", *["-"] * 8, f"-, {k} failed") for n, k in ((1, 2), (3, 6), (4, 6))]
    assert SURVIVORS in few.note and len(few.lines) == 5
    tasks = np.arange(count * 6).reshape(count, 3, 2)
    tasks[:, 0, 1] = tasks[:, 0, 0]  # a regular sea
    regular = data.assign(task=(state.dims, tasks.astype(str)))
    assert table(regular.isel(sample=[0, 3])).lines[-1][-1] == "-, 5 failed"
    assert table(data).lines[-1] == ("9 designs", *["-"] * 8, "-, 50 failed")
    assert not table(data.isel(sample=[3, 4])).lines


def test_what_no_sea_changes_none_governs():
    high, low = forces()
    high[..., 0], high[1, :, 1, 0] = 2.0, 2.0 + 1e-9
    first, second = rows(dataset((high, low)))
    assert first[3:9] == ("any", "2", "N", "", "-", "-") and second[3] == "long"


def test_what_a_record_has_one_number_of_and_units_by_the_axis():
    """Motions of joints differ in unit, and a rotation is one of them."""
    axes = ["heave", "pitch"]
    moved = np.array([[[[2.0, -3.0], [0.1, -0.1]]], [[[1.0, -1.0], [0.4, -0.2]]]])  # sea, float, axis, statistic
    data = xr.Dataset(
        {
            "motion": (("sea_state", "float", "axis", "statistic"), moved),
            "rotation": (("sea_state", "float", "statistic"), moved[..., 1, :]),
            "end_stop_load": (("sea_state", "float", "axis"), [[[5.0, 0.0]], [[9.0, 0.0]]]),
        },
        coords={"sea_state": SEAS[:2], "float": ["only"], "axis": axes, "statistic": ["max", "min"]},
    )
    assert [line[1:7] for line in rows(data)] == [
        ("motion heave", "", "mild", "3", "m", ""),
        ("motion pitch", "", "rough", "0.4", "rad", ""),
        ("end_stop_load heave", "", "rough", "9", "N", ""),
    ]
    assert [line[1:6] for line in rows(data[["rotation"]])] == [("rotation", "", "rough", "0.4", "rad")]


def test_what_labels_share_is_told_once():
    """A platform without floats has the same tasks whatever their power take-off; another has its own."""
    data = (dataset(forces()) * xr.DataArray(np.ones((2, 2)), dims=("platform", "pto_damping"))).sel(direction=["x"])
    data = data.assign_coords(platform=["elastic", "elastic-no-floats"], pto_damping=[1e5, 2e5])
    names = np.array([[[["a", "b"], ["c", "c"]]] * 2] * 3, dtype=object) + np.arange(6).astype(str).astype(
        object
    ).reshape(3, 2, 1, 1)
    task = ("sea_state", "seed", "platform", "pto_damping"), names.astype(str)
    assert [line[0] for line in rows(data.assign(task=task))] == [
        "elastic, pto_damping 100000", "elastic, pto_damping 200000", "elastic-no-floats",
    ]  # fmt: skip
    assert len(list(rows(data))) == 4
