"""Answers as a dataset: quantities with their intervals, and differences between two designs in the same waves."""

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from scipy import stats

from pipeline.report.answers import answers, pair_of, table
from pipeline.report.energy import ALL, energies
from pipeline.report.life import lives

YEAR = 365.25 * 24 * 3600.0
SCATTER = np.array([[0.0, 300.0, -300.0], [900.0, -900.0, 0.0]])  # of both designs, by sea state and realization
AHEAD = np.array([[10.0, 12.0, 14.0], [40.0, 40.0, 43.0]])  # what the second design has more


def dataset(**coords):
    """Two dampings in two seas of three realizations, which differ far more than the dampings do."""
    first = 1e3 + SCATTER
    power = np.stack([first, first + AHEAD], axis=-1)[..., None] * [1.0, 2.0]  # (sea_state, seed, damping, float)
    dims = ("sea_state", "seed", "pto_damping", "float")
    return xr.Dataset(
        {
            "absorbed_power": ((*dims, "statistic"), power[..., None]),
            "wave_power": (dims[:3], np.broadcast_to(np.array([50.0, 90.0])[:, None, None], (2, 3, 2))),
            "damage": ((*dims[:3], "leg", "fibre"), power[..., :1, None] * 1e-9),
            "status": (dims[:3], np.full((2, 3, 2), "done", dtype="U8")),
            "task": (dims[:3], np.arange(12).reshape(2, 3, 2).astype("U16")),
        },
        {
            "statistic": ["mean"], "float": ["front", "rear"], "pto_damping": [1e5, 2e5], "leg": [1], "fibre": [1],
            "sea_state": ["calm", "rough"], "occurrence": ("sea_state", [0.75, 0.25]), **coords,
        },
        {"title": "Two dampings"},
    )  # fmt: skip


def test_quantities_are_those_of_the_tables():
    data = dataset()
    found = answers(data, None)
    known, steel = energies(data), lives(data)
    assert found.mean_power.values == approx(known.power.values) and found.annual_energy.attrs["units"] == "J"
    assert found.annual_energy.values == approx(known.energy.values)
    assert found.capture_width.values == approx(known.power.values / (0.75 * 50 + 0.25 * 90))
    assert found.life.values == approx(steel.life.values) and found.damage.values == approx(steel.damage.values)
    assert not [name for name in found if "difference" in str(name)] and found.attrs["title"] == "Two dampings"
    assert found.estimate.values.tolist() == ["value", "low", "high"] and found.life.attrs["units"] == "s"
    assert found.attrs["tasks"] == "12 done"
    assert all("comment" in answer.attrs for name, answer in found.items() if "estimate" in answer.dims), found


def test_a_difference_has_the_interval_of_differences_in_the_same_waves():
    data = dataset()
    found = answers(data, pair_of(data, ""))
    mean = 0.75 * 12.0 + 0.25 * 41.0
    parts = np.array([0.75**2 * AHEAD[0].var(ddof=1), 0.25**2 * AHEAD[1].var(ddof=1)]) / 3
    half = stats.t.ppf(0.975, parts.sum() ** 2 / (parts**2 / 2).sum()) * np.sqrt(parts.sum())
    ahead = found.mean_power_difference
    assert ahead.sel({"float": "front"}).values == approx([mean, mean - half, mean + half])
    assert ahead.sel({"float": ALL}).values == approx(3 * np.array([mean, mean - half, mean + half]))
    assert found.annual_energy_difference.values == approx(ahead.values * YEAR)
    assert found.damage_difference.values.ravel() == approx(ahead.sel({"float": "front"}).values * 1e-9)
    assert (ahead.attrs["first"], ahead.attrs["second"]) == ("pto_damping=200000", "pto_damping=100000")
    other = answers(data, pair_of(data, "pto_damping=1e5, 2e5")).mean_power_difference
    assert other.sel({"float": "front"}).values == approx([-mean, -mean - half, -mean + half])
    told = table(found)
    assert told.title.endswith("pto_damping=200000 less pto_damping=100000")
    assert ("front", "mean_power [W]", f"{mean:.3g}", f"{mean - half:.3g}", f"{mean + half:.3g}") in told.lines
    assert not table(answers(data, None)).lines


def test_no_year_is_told_of_seas_whose_occurrence_is_another():
    """Of which an axis changes the height; without any occurrence all sea states count alike, which is said."""
    data = dataset().rename(pto_damping="Hs")
    data["Hs"] = ("Hs", [1.0, 2.0], {"long_name": "Hs (sea_states.*.Hs)"})
    found = answers(data, None)
    assert "annual_energy" not in found and found.mean_power.attrs["comment"].endswith("which all count alike")
    assert "annual_energy" in answers(dataset().drop_vars("occurrence"), None)
    told = table(answers(dataset().drop_vars("occurrence"), pair_of(dataset(), ""))).note
    assert "sea states, which all count alike; low" in told


def test_realizations_that_failed_are_counted():
    data = dataset().copy(deep=True)
    data.absorbed_power[0, 1, 1] = np.nan
    data.status[0, 1, 1] = "failed"
    data.task[1, 0, 1] = data.task[1, 0, 0]  # as of a regular sea, whose realizations are one
    found = answers(data, pair_of(data, ""))
    assert found.attrs["tasks"] == "10 done, 1 failed"
    assert found.failed_realizations.sel({"float": "front"}).values.tolist() == [0, 1]
    assert found.mean_power_difference.sel({"float": "front", "estimate": "value"}) == approx(0.75 * 12 + 0.25 * 41)


def test_damage_has_a_count_of_its_own():
    """One of it fails where there is power, and at the top where there is one at the foot."""
    data = dataset().copy(deep=True)
    data["damage_top"] = data.damage.copy(deep=True)
    data.damage[0, 1, 1] = np.nan
    data.damage_top[0, :2] = np.nan
    found = answers(data, None)
    assert not found.failed_realizations.any() and "float" in found.failed_realizations.dims
    assert found.damage_failed_realizations.values.ravel().tolist() == [0, 1]
    assert found.damage_top_failed_realizations.values.ravel().tolist() == [2, 2]
    alone = answers(data.drop_vars(["absorbed_power", "wave_power"]), None)
    assert alone.failed_realizations.identical(found.damage_failed_realizations.rename("failed_realizations"))


def test_a_single_sea_of_a_single_realization_is_written(tmp_path):
    """A count over no dimension is one: what is true or false no file takes."""
    data = dataset().isel(sea_state=[0], seed=0, drop=True)
    data.absorbed_power[0, 1] = np.nan
    data.status[0, 1] = "failed"
    one = data.squeeze("sea_state", drop=True)
    found = answers(one, pair_of(one, ""))
    assert found.failed_realizations.dtype == int and lives(one).failed_realizations.dtype == int
    found.to_netcdf(tmp_path / "answers.nc")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("mass=1,2", "must begin with an axis: pto_damping"),
        ("pto_damping", "must be pto_damping=FIRST,SECOND, two of 100000, 200000"),
        ("pto_damping=1e5,3e5", "two of 100000, 200000"),
        ("pto_damping=1e5,1e5", "two of 100000, 200000"),
    ],
)
def test_what_is_no_pair_is_refused(words, told):
    with pytest.raises(ValueError, match=told):
        pair_of(dataset(), words)


@pytest.mark.parametrize(
    ("labels", "words", "told"),
    [
        ((2100.0004, 2100.0005), "2100.0005,2100.0004", "2100.0005"),
        ((1e4, 31622.776601), "31622.776601,1e4", "31622.8"),
    ],
)
def test_labels_that_six_digits_do_not_tell_apart_are_told_by_all(labels, words, told):
    data = dataset(pto_damping=list(labels))
    pair = pair_of(data, f"pto_damping={words}")
    assert pair.labels == labels[::-1]
    assert answers(data, pair).mean_power_difference.attrs["first"] == f"pto_damping={told}"


def test_designs_that_meet_other_waves_have_no_difference():
    data = dataset(pto_damping=("pto_damping", [1e5, 2e5], {"long_name": "depth (water.depth)"}))
    assert pair_of(data, "") is None
    with pytest.raises(ValueError, match="along pto_damping waves differ in depth"):
        pair_of(data, "pto_damping=1e5,2e5")


def test_a_dataset_without_power_or_damage_has_no_answers():
    found = answers(dataset()[["wave_power", "status", "task"]], None)
    assert not found.data_vars and found.estimate.size == 3
