"""Energy a year over sea states, of each float and of all, with intervals over realizations."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from rich.console import Console
from scipy import stats

from pipeline.report import best, energy
from pipeline.report.energy import ALL, energies, rows, table
from pipeline.report.tables import MANY, OFF, ROWS, SURVIVORS, Table, show
from pipeline.report.yearly import over_seas

README = Path(__file__).parents[3] / "studies" / "README.md"
HOURS = 365.25 * 24
STATISTICS = ["max", "min", "mean", "rms", "std"]


def dataset(power, occurrence=(3.0, 1.0), **coords):
    """Mean power (sea_state, seed, float) beside other statistics, which do not count."""
    power = np.asarray(power, float)
    each = np.stack([power if name == "mean" else 9e9 + 0 * power for name in STATISTICS], axis=-1)
    known = {"float": FLOATS[: power.shape[2]], "sea_state": [f"s{i}" for i in range(len(power))]}
    data = xr.Dataset(
        {"absorbed_power": (("sea_state", "seed", "float", "statistic"), each)},
        coords={"statistic": STATISTICS, **known, **coords},
    )
    return data if occurrence is None else data.assign_coords(occurrence=("sea_state", list(occurrence)))


FLOATS = ["front", "rear"]
MIRRORED = [[[2e3, 1e3], [1e3, 2e3]], [[8e3, 4e3], [6e3, 6e3]]]  # what one float has less the other has more


def test_all_floats_have_the_interval_of_their_sum():
    """Not that of floats that know nothing of each other: here the sum is the same in every realization."""
    found = energies(dataset(MIRRORED))
    assert found["float"].values.tolist() == ["front", "rear", ALL]
    mean = 0.75 * 1.5e3 + 0.25 * 7e3
    parts = np.array([0.75**2 * 0.5e6 / 2, 0.25**2 * 2e6 / 2])
    half = stats.t.ppf(0.975, parts.sum() ** 2 / (parts**2).sum()) * np.sqrt(parts.sum())
    assert found.power.sel({"float": "front"}).values == approx([mean, mean - half, mean + half])
    total = 0.75 * 3e3 + 0.25 * 12e3
    assert found.power.sel({"float": ALL}).values == approx([total] * 3)
    assert found.energy.sel({"float": ALL}).values == approx([total * HOURS * 3600] * 3)
    assert energies(dataset(MIRRORED), weights=[1, 1]).power.values[0, 2] == approx(7.5e3)


def test_what_records_may_be_off_by_more_than_the_interval_is_marked():
    """Errors are relative to the rms, here twice the mean, and add up over sea states; of all floats, too."""
    data = dataset(MIRRORED).copy(deep=True)
    data.absorbed_power.loc[{"statistic": "rms"}] = 2 * data.absorbed_power.sel(statistic="mean")
    low, high = energies(data).power.sel({"float": "front"}).values[1:]
    for error, floats in ((0.49, []), (0.51, ["front"])):
        share = error * (high - low) / 2 / energies(data).power.values[0, 0]
        told = table(data.assign(estimated_error=(("sea_state", "seed"), np.full((2, 2), share))))
        assert [line[0] for line in told.lines if line[2].endswith(" *")] == [*floats, ALL]  # whose sum is the same
        assert OFF in told.note and energies(data).power.equals(energies(data.assign(estimated_error=share)).power)
    assert OFF not in table(data).note


def test_a_line_for_each_float_and_label():
    """Of every power that there is; of a float that a variant does without none, and all are the others."""
    data = dataset(MIRRORED).expand_dims(pto_damping=[1e5, 2e5]).copy(deep=True)
    data["electrical_power"] = 0.8 * data.absorbed_power
    data.absorbed_power[1, ..., 1, :] = np.nan
    lines = list(rows(data))
    assert [line[:2] for line in lines[:5]] == [
        ("pto_damping 100000, front", "absorbed"),
        ("pto_damping 100000, rear", "absorbed"),
        (f"pto_damping 100000, {ALL}", "absorbed"),
        ("pto_damping 200000, front", "absorbed"),
        (f"pto_damping 200000, {ALL}", "absorbed"),
    ]
    assert {line[1] for line in lines[5:]} == {"electrical"} and len(lines) == 11
    total = 0.75 * 3 + 0.25 * 12
    assert lines[2][2:] == ("5.25", "5.25", "5.25", *3 * [f"{total * HOURS / 1e3:.3g}"], "2")
    assert lines[4][2:] == lines[3][2:]


def test_of_many_designs_all_floats_come_first_those_with_the_most_power_on_top():
    """Of each power; one that failed is the last, and each float stands below in the same order."""
    size = xr.DataArray(np.arange(1.0, MANY + 2), dims="sample")
    data = (dataset(MIRRORED) * size).assign_coords(sample=np.arange(MANY + 1)).copy(deep=True)
    data.absorbed_power[0, ..., 0] = np.nan
    data["electrical_power"] = data.absorbed_power / size**2
    lines = [line[:2] for line in rows(data)]
    order = {"absorbed": [*range(MANY, 0, -1), 0], "electrical": [*range(1, MANY + 1), 0]}
    assert lines[: 2 * MANY + 2] == [(f"sample {n}, {ALL}", word) for word, every in order.items() for n in every]
    parts = [(f"sample {n}, {name}", word) for word, every in order.items() for n in every for name in FLOATS]
    assert lines[2 * MANY + 2 :] == parts
    few = [line[0] for line in rows(data.isel(sample=slice(MANY)))]
    assert few[:3] == ["sample 0, front", "sample 0, rear", f"sample 0, {ALL}"]


def test_designs_are_reckoned_at_once_and_each_has_the_lines_that_it_has_alone(monkeypatch):
    """Where sea states are the same waves in one of them alone, as well; and where a realization failed."""
    rng, reckoned = np.random.default_rng(4), []
    monkeypatch.setattr(energy, "over_seas", lambda *given: reckoned.append(given) or over_seas(*given))
    each = rng.lognormal(7, 1, (3, 3, 3, 2))
    each[0, 1] = each[0, 0]
    each[2, :2, 0] = each[2, 2, 1] = np.nan
    data = xr.concat([dataset(one, (3.0, 1.0, 2.0)) for one in each], "pto_damping")
    status = np.where(np.isnan(each).any(axis=-1), "failed", "done")
    data = data.assign(status=(("pto_damping", "sea_state", "seed"), status)).assign_coords(pto_damping=[1.0, 2.0, 3.0])
    alone = [line for i in range(3) for line in rows(data.isel(pto_damping=[i]))]
    reckoned.clear()
    assert list(rows(data)) == alone and len(reckoned) == 1
    assert [line[-1] for line in alone[::3]] == ["3", "3", "2, 3 failed"]
    twins = energies(data.isel(pto_damping=[0])).power  # of one with both weights
    single = energies(data.isel(pto_damping=[0], sea_state=[0, 2]), weights=[4.0, 2.0]).power
    assert twins.values == approx(single.values)


def test_a_single_float_and_a_single_realization():
    (line,) = rows(dataset([[[2e3]], [[6e3]]]))
    assert line == ("front", "absorbed", "3", "-", "-", f"{3 * HOURS / 1e3:.3g}", "-", "-", "1")


def test_the_readmes_line_is_of_all_floats_of_a_single_one_as_well():
    (line,) = re.findall(r"^    (energies\(data\).*)$", README.read_text(encoding="utf-8"), re.M)
    for power, total in ((MIRRORED, 0.75 * 3e3 + 0.25 * 12e3), ([[[2e3]], [[6e3]]], 3e3)):
        assert eval(line, {"energies": energies, "data": dataset(power)}) == approx(total * HOURS / 1e6)


def test_a_sea_state_without_a_number_leaves_none():
    assert [line[2:] for line in rows(dataset([[[np.nan] * 2], [[1e3] * 2]]))] == [(*6 * ["-"], "0 to 1, 1 failed")] * 3


def test_nothing_is_told_where_nobody_said_how_often_seas_come():
    console = Console(width=200)
    with console.capture() as drawn:
        show(table(dataset(MIRRORED, occurrence=None)), console)
    assert drawn.get() == ""
    with console.capture() as drawn:
        show(table(dataset(MIRRORED)), console)
    assert "energy a year [MWh]" in drawn.get() and ALL in drawn.get()
    model = table(1e-3 * dataset(MIRRORED))
    assert model.header[2] == "mean power [W]" and model.header[5] == "energy a year [kWh]"
    assert model.lines == table(dataset(MIRRORED)).lines
    assert "of a year" in table(dataset(MIRRORED, occurrence=[4000.0, 1000.0])).note


def test_seas_that_an_axis_makes_have_no_part_in_how_often_others_come():
    """Nine seas of one that blows 3000 h a year are no nine years; what keeps the seas leaves the table."""
    whole = dataset(MIRRORED, occurrence=(3000.0, 1000.0), Hs=("sea_state", [1.0, 2.0]), Tp=("sea_state", [6.0, 8.0]))
    scaled = xr.concat([whole, 2 * whole], "pto_damping").assign_coords(pto_damping=[1e5, 2e5])
    assert len(table(scaled).lines) == 6 and best.table(scaled).lines[0][0] == "all seas"
    bare = scaled.drop_vars(["Hs", "Tp"])
    for data in (
        bare.expand_dims(Hs=[0.5, 1.0, 1.5]),
        bare.expand_dims(sample=[1, 2]).assign_coords(wave_period=("sample", [5.0, 7.0])),
        bare.expand_dims(variant=["a", "b"]).assign_coords(Tp=(("sea_state", "variant"), [[5.0, 6.0], [8.0, 8.0]])),
    ):
        assert not table(data).lines and not any("all seas" in line[0] for line in best.table(data).lines)


@pytest.mark.parametrize(
    ("attrs", "other"),
    [
        ({"long_name": "file (sea_states.x.file)"}, True),
        ({"long_name": "heading (waves.heading)"}, True),
        ({"long_name": "Values of floats.x.mass, water.depth, sea.gamma"}, True),
        ({"long_name": "Name of the set of values", "comment": "Values of solver.method, waves.form"}, True),
        ({"long_name": "Values of waves.base_seed, waves.components, waves.intervals"}, False),
        ({"long_name": "mass (floats.waves.mass)"}, False),
    ],
)
def test_seas_that_an_axis_makes_are_known_by_its_paths(attrs, other):
    """Other realizations are of the same seas; an axis of one label makes one sea of each."""
    whole = dataset(MIRRORED)
    data = xr.concat([whole, whole], "axis").assign_coords(axis=("axis", ["a", "b"], attrs))
    assert bool(table(data).lines) != other and table(data.isel(axis=[0])).lines


def test_a_float_that_is_lifted_out_in_some_seas_takes_nothing_there():
    """Its task is done; of one that failed nothing is known, and a float that is in no sea has no line."""
    data = dataset(MIRRORED)
    data["status"] = ("sea_state", "seed"), np.full((2, 2), "done")
    data.absorbed_power[1, :, 0] = np.nan
    power = energies(data).power.sel(estimate="value")
    assert power.values == approx([0.75 * 1.5e3, 0.75 * 1.5e3 + 0.25 * 5e3, 0.75 * 3e3 + 0.25 * 5e3])
    data.absorbed_power[1] = np.nan
    assert energies(data).power.sel(estimate="value").values[-1] == approx(0.75 * 3e3)
    data.absorbed_power[:, :, 0] = np.nan
    assert [line[0] for line in rows(data)] == ["rear", ALL]
    data["status"][1] = "failed"
    assert np.isnan(energies(data).power.sel(estimate="value").values).all()


def test_electrical_power_of_a_float_without_an_efficiency_is_what_it_absorbs():
    """Of all floats as well; without any where the float was left out, and in a sea where it is lifted nothing."""
    data = dataset(MIRRORED)
    data["electrical_power"] = data.absorbed_power * xr.DataArray([0.8, np.nan], dims="float")
    power = energies(data, "electrical_power").power.sel(estimate="value")
    front, rear = (0.75 * mean[0] + 0.25 * mean[1] for mean in ((1.5e3, 7e3), (1.5e3, 5e3)))
    assert power.values == approx([0.8 * front, rear, 0.8 * front + rear])
    data["status"] = ("sea_state", "seed"), np.full((2, 2), "done")
    data.absorbed_power[1, :, 1] = np.nan
    assert energies(data, "electrical_power").power.sel({"float": ALL})[0] == approx(0.8 * front + 0.75 * 1.5e3)
    data.absorbed_power[:, :, 1] = np.nan
    assert energies(data, "electrical_power").power.sel({"float": ALL})[0] == approx(0.8 * front)
    data.absorbed_power[...] = data.electrical_power[...] = np.nan
    assert not list(rows(data))


def test_the_sum_is_unknown_where_a_floats_number_is():
    """In a realization that one has and another lacks; means are of the others."""
    data = dataset(MIRRORED)
    data["status"] = ("sea_state", "seed"), [["done", "failed"], ["done", "done"]]
    data.absorbed_power[0, 1, 0] = np.nan
    assert energies(data).power.sel(estimate="value")[-1] == approx(0.75 * 3e3 + 0.25 * 12e3)
    assert energies(data).failed_realizations.values.tolist() == [1, 0, 1]
    assert [line[-1] for line in rows(data)] == ["1 to 2, 1 failed", "2", "1 to 2, 1 failed"]
    assert table(data).note.endswith(SURVIVORS) and not table(dataset(MIRRORED)).note.endswith(SURVIVORS)
    data.absorbed_power[0, 0, 1] = np.nan
    data["status"][0] = "failed"
    assert np.isnan(energies(data).power.sel(estimate="value")[-1])


def test_a_design_of_which_all_tasks_failed_has_a_line():
    """The last of each power, of many as well."""
    for count in (2, MANY + 1):
        data = xr.concat([dataset(MIRRORED)] * count, "hull").assign_coords(hull=[f"h{n}" for n in range(count)])
        state = xr.DataArray(np.full((count, 2, 2), "done", dtype="U8"), dims=("hull", "sea_state", "seed"))
        state[0] = "failed"
        told = table(data.where(state == "done").assign(status=state))
        place = -1 if count == 2 else count - 1  # before each float of many
        assert told.lines[place] == ("h0", "absorbed", *["-"] * 6, "-, 4 failed") and SURVIVORS in told.note
        assert sum(line[0].startswith("h0") for line in told.lines) == 1


def test_a_terminal_shows_the_first_rows_of_many():
    """And says how many there are in the report, or another file."""
    table = Table("Energy", ("design", "float", "of"), [(str(i), "a", "b") for i in range(ROWS + 1200)], "note")
    for file in ([], ["answers.nc"]):
        console = Console(width=100)
        with console.capture() as drawn:
            show(table, console, *file)
        lines = drawn.get().splitlines()
        told = f"... and 1,200 more, in {file[0] if file else 'report.html'}"
        assert len(lines) == ROWS + 4 and lines[-2].strip() == told and "note" in lines[-1]
