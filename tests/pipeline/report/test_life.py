"""Damage and life over sea states, with intervals over realizations."""

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from rich.console import Console
from scipy import stats

from pipeline.report import life
from pipeline.report.life import NOTE, lives, rows, table
from pipeline.report.tables import OFF, SURVIVORS, show
from pipeline.report.yearly import LEVEL, of_part, over_seas

YEAR = 365.25 * 24


def dataset(values, **coords):
    """Damage (sea_state, seed, leg, fibre) of two fibres of one leg, the second with half of it."""
    values = np.asarray(values, float)[..., None, None] * [1.0, 0.5]
    known = {"leg": [1], "fibre": [1, 2], "sea_state": [f"s{i}" for i in range(len(values))], **coords}
    return xr.Dataset({"damage": (("sea_state", "seed", "leg", "fibre"), values)}, coords=known)


def ends(mean, half):
    """Value, low and high of an interval in the logarithm."""
    return [mean, mean * np.exp(-half / mean), mean * np.exp(half / mean)]


def test_one_sea_has_students_interval():
    x = np.array([1.0, 2.0, 4.0, 3.0]) * 1e-6
    found = lives(dataset([x]))
    half = stats.t.ppf(0.975, 3) * x.std(ddof=1) / 2
    assert LEVEL == 0.95 and found.damage.estimate.values.tolist() == ["value", "low", "high"]
    assert found.damage.isel(leg=0, fibre=0).values == approx(ends(x.mean(), half))
    years = found.life.isel(leg=0, fibre=0).values / 3600 / YEAR
    assert years == approx(1 / np.array(ends(x.mean(), -half)) / YEAR) and years[1] < years[0] < years[2]
    assert found.damage.isel(fibre=1).values == approx(found.damage.isel(fibre=0).values / 2)


def test_seas_count_by_their_occurrence():
    """Means and variances add by shares; Welch and Satterthwaite's degrees of freedom with different numbers."""
    first, second = np.array([1.0, 3.0, 2.0]) * 1e-6, np.array([9.0, 7.0, np.nan]) * 1e-6
    data = dataset([first, second]).assign_coords(occurrence=("sea_state", [300.0, 100.0]))
    found = lives(data).damage.isel(leg=0, fibre=0).values
    parts = np.array([0.75**2 * first.var(ddof=1) / 3, 0.25**2 * second[:2].var(ddof=1) / 2])
    freedom = parts.sum() ** 2 / (parts**2 / [2, 1]).sum()
    mean, half = 0.75 * 2e-6 + 0.25 * 8e-6, stats.t.ppf(0.975, freedom) * np.sqrt(parts.sum())
    assert found == approx(ends(mean, half))
    assert lives(data, weights=[1, 1]).damage.sel(estimate="value").values.ravel()[0] == approx(5e-6)
    assert lives(data.drop_vars("occurrence")).damage.sel(estimate="value").values.ravel()[0] == approx(5e-6)


def test_sea_states_of_the_same_waves_are_one():
    """They scatter together: mean and interval are those of one with both weights, which a failed realization keeps."""
    same, other = np.array([1.0, 3.0, 2.0, np.nan]) * 1e-6, np.array([9.0, 7.0, 8.0, 5.0]) * 1e-6
    found = lives(dataset([same, other, same]), weights=[0.1, 0.5, 0.4]).damage
    assert found.values == approx(lives(dataset([same, other]), weights=[0.5, 0.5]).damage.values)
    status = (("sea_state", "seed"), [["done"] * 3 + ["failed"], ["done"] * 4, ["done"] * 3 + ["failed"]])
    assert int(lives(dataset([same, other, same]).assign(status=status)).failed_realizations.max()) == 1
    none = dataset([[1e-6, np.nan], [np.nan, np.nan], [np.nan, np.nan]])
    failed = none.assign(status=(("sea_state", "seed"), [["done", "failed"]] + [["failed", "failed"]] * 2))
    assert (lives(failed).failed_realizations == 5).all()  # those without numbers may be of other waves


def test_numbers_may_lie_in_files():
    """As xarray.open_mfdataset leaves them."""
    data = dataset([[1e-6, 3e-6], [2e-6, 5e-6], [1e-6, 3e-6]])
    assert lives(data.chunk()).damage.values == approx(lives(data).damage.values)


def test_seas_that_an_axis_makes_count_alike():
    """Their heights go along it: how often these come nobody said, and a line of all is their plain mean."""
    data = dataset([[1e-6], [9e-6]]).assign_coords(occurrence=("sea_state", [300.0, 100.0])).expand_dims(scale=[1, 2])
    own, others = (
        data.assign_coords(Hs=(dims, np.ones([2] * len(dims)))) for dims in (("sea_state",), ("sea_state", "scale"))
    )
    for each, mean in ((own, 3e-6), (others, 5e-6)):
        assert lives(each).damage.sel(estimate="value").values.ravel()[0] == approx(mean)
        assert float(table(each).lines[0][2]) == approx(mean * YEAR, rel=2e-3)  # three digits
        assert ("all of which count alike" in table(each).note) == (each is others)


def test_intervals_hold_what_they_say():
    """Of 2,000 studies of three seas and six realizations 95 % hold the true mean: within 3 (0.95 0.05/2000)^½."""
    rng = np.random.default_rng(4)
    true, w = np.array([1.0, 5.0, 2.0]) * 1e-6, np.array([0.5, 0.2, 0.3])
    x = true[:, None, None, None] * (1 + 0.3 * rng.normal(size=(3, 6, 2000, 1)))
    each = xr.Dataset({"damage": (("sea_state", "seed", "leg", "fibre"), x)})
    low, high = lives(each, weights=w).damage.values[1:, :, 0]
    assert np.mean((low <= true @ w) & (true @ w <= high)) == approx(0.95, abs=0.015)


def test_intervals_of_skewed_damage_hold_nearly_what_they_say():
    """Ten lognormal realizations that scatter by as much as their mean: of 20,000 studies more than `high` is true of
    0.084, and of 0.126 in Student's interval about the mean; within 3 (0.09 0.91/20000)^½."""
    x = np.exp(np.sqrt(np.log(2)) * np.random.default_rng(4).normal(size=(1, 10, 20000, 1))) / np.sqrt(2)
    each = xr.Dataset({"damage": (("sea_state", "seed", "leg", "fibre"), 1e-6 * x)})
    _, low, high = lives(each).damage.values[..., 0]
    plain = over_seas(each.damage, None).sel(estimate="high").values[:, 0]
    assert np.mean(high < 1e-6) == approx(0.084, abs=0.006) and np.mean(plain < 1e-6) == approx(0.126, abs=0.007)
    assert 0.005 < np.mean(low > 1e-6) < 0.025


def test_what_is_not_known_is_not_told():
    """A single realization has no interval; a sea state without a number leaves none for all; no damage, no end."""
    single = lives(dataset([[1e-6]])).isel(leg=0, fibre=0)
    assert single.damage.values == approx([1e-6, np.nan, np.nan], nan_ok=True)
    assert single.life.values == approx([3.6e9, np.nan, np.nan], nan_ok=True)
    missing = lives(dataset([[1e-6, 2e-6], [np.nan, np.nan]])).isel(leg=0, fibre=0)
    assert missing.damage.isnull().all() and missing.life.isnull().all()
    wide = lives(dataset([[0.0, 1e-6]])).isel(leg=0, fibre=0)
    assert 0 < wide.damage.sel(estimate="low") < 1e-11 and wide.life.sel(estimate="high") < np.inf
    assert [line[:3] for line in rows(dataset([[np.nan, 1e-6], [np.nan, np.nan]]))][::2] == [
        ("all seas", "foot", "-"),
        ("s1", "foot", "-"),
    ]
    still = lives(dataset([[0.0, 0.0]])).isel(leg=0, fibre=0)
    assert still.damage.values.tolist() == [0, 0, 0] and np.all(np.isinf(still.life.values))


def test_designs_are_reckoned_at_once_and_each_has_the_lines_that_it_has_alone(monkeypatch):
    """All sea states together and each by itself, wherever the worst fibre is, or none is known."""
    reckoned = []
    monkeypatch.setattr(life, "over_seas", lambda *given: reckoned.append(given) or over_seas(*given))
    data = xr.concat([dataset(1e-6 * np.random.default_rng(i).lognormal(size=(2, 3))) for i in range(4)], "pto_damping")
    data = data.assign_coords(pto_damping=[1.0, 2.0, 3.0, 4.0])
    data.damage[1] = data.damage[1, ..., ::-1].values
    data.damage[2, 0] = data.damage[3, 1, 1] = np.nan
    alone = [line for i in range(4) for line in rows(data.isel(pto_damping=[i]))]
    reckoned.clear()
    assert list(rows(data)) == alone and len(reckoned) == 3
    assert [line[1] for line in alone[::3]] == [f"foot of leg 1, fibre {n}" for n in "12"] + ["foot", alone[0][1]]
    assert [line[-1] for line in alone[-3:]] == ["2 to 3, 1 failed", "3", "2, 1 failed"]


def test_damage_that_records_may_be_off_by_more_than_the_interval_is_marked():
    """By three times what stresses are."""
    data = dataset([[1e-6, 1.1e-6, 1.2e-6]])
    half = np.expm1(stats.t.ppf(0.975, 2) * 0.1 / np.sqrt(3) / 1.1)
    for error in (0.32 * half, 0.34 * half):
        told = table(data.assign(estimated_error=(("sea_state", "seed"), np.full((1, 3), error))))
        assert told.lines[0][2].endswith(" *") == (OFF in told.note) == (error > half / 3)
    assert OFF not in table(data).note


def test_rows_are_of_each_label_whatever_its_axis_is_called():
    """Numbers, and names that the reckoning or xarray might have for itself."""
    data = dataset([[1e-6, 3e-6]]).expand_dims(cell=[0.5, 1.5], method=["time"], error=[1])
    assert [line[0] for line in rows(data)] == [f"cell {x}, time, error 1, s0" for x in (0.5, 1.5)]


@pytest.mark.parametrize("held", [True, False])
def test_rows_name_the_worst_fibre(held):
    """Of each platform, all seas and each by itself; of a study of one sea without axes one line."""
    data = dataset([[1e-6, 3e-6], [5e-6, 7e-6]]).expand_dims(platform=["elastic"])
    data = data.isel(sea_state=0, platform=0) if held else data
    lines = list(rows(data))
    assert [line[0] for line in lines] == ([""] if held else ["elastic, all seas", "elastic, s0", "elastic, s1"])
    assert all(line[1] == "foot of leg 1, fibre 1" and line[-1] == "2" for line in lines)
    assert float(lines[0][2]) == approx((2e-6 if held else 4e-6) * YEAR, rel=5e-3)
    console = Console(width=200)
    with console.capture() as drawn:
        show(table(data), console)
    assert "Student's t" in drawn.get() and "foot of leg 1, fibre 1" in drawn.get()
    with console.capture() as drawn:
        show(table(data.drop_vars("damage")), console)
    assert drawn.get() == ""


def test_a_regular_sea_has_one_realization_whatever_the_seeds():
    """Its one task stands at each of them, and has no scatter: all seas have the irregular one's."""
    data = dataset([[4e-6] * 3, [1e-6, 2e-6, 3e-6]])
    data["task"] = (("sea_state", "seed"), [["a", "a", "a"], ["b", "c", "d"]])
    found = lives(data).damage.isel(leg=0, fibre=0).values
    half = 0.5 * 1e-6 / np.sqrt(3) * stats.t.ppf(0.975, 2)
    assert found == approx(ends(3e-6, half))
    every, regular, irregular = rows(data)
    assert (every[-1], regular[-1], irregular[-1]) == ("1 to 3", "1", "3")
    assert regular[3] == regular[4] == regular[2] and "-" not in (*irregular, *every)
    alone = data.isel(seed=[0])
    assert np.isnan(lives(alone).damage.sel(estimate="low")).all()


def test_a_design_that_failed_whole_is_told():
    """But no platform without legs."""
    data = dataset([[4e-6] * 3, [1e-6] * 3]).expand_dims(platform=["elastic", "fixed"], sample=[1, 2]).copy(deep=True)
    data = data.assign(status=(data.damage.dims[:4], np.full(data.damage.shape[:4], "failed", "U8")))
    data.damage[1], data.damage[:, 1], data.status[0, 0] = np.nan, np.nan, "done"
    told = table(data)
    assert told.lines[-1] == ("elastic, sample 2", *["-"] * 7, "-, 6 failed") and SURVIVORS in told.note
    assert not any("fixed" in line[0] for line in told.lines)


def test_realizations_that_failed_are_told_those_that_have_not_run_are_not():
    """Nor is what no task stands for, a regular sea's other seeds, or a platform without legs."""
    data = dataset([[4e-6] * 3, [1e-6, np.nan, np.nan]]).expand_dims(platform=["elastic", "fixed"]).copy(deep=True)
    data.damage[1] = np.nan
    data["task"] = (("sea_state", "seed"), [["a", "a", "a"], ["b", "c", "d"]])
    data["status"] = (("sea_state", "seed"), [["done"] * 3, ["done", "failed", "missing"]])
    assert [line[-1] for line in rows(data)] == ["1, 1 failed", "1", "1, 1 failed"]
    assert lives(data).failed_realizations.isel(leg=0, fibre=0).values.tolist() == [1, 0]
    assert table(data).note.endswith(SURVIVORS)
    failed = data.where(data.sea_state != "s0").assign(
        task=data.task, status=data.status.where([[False], [True]], "failed")
    )
    assert lives(failed).failed_realizations.isel(platform=0, leg=0, fibre=0) == 2
    assert [line[1:] for line in rows(failed)][1] == ("foot", *["-"] * 6, "0, 1 failed")  # the first sea
    data["status"][1, 1] = "missing"
    assert not lives(data).failed_realizations.any() and SURVIVORS not in table(data).note


def test_a_count_that_fails_in_all_realizations_of_a_sea_is_told():
    """Though their tasks are done: no sea lifts a leg out."""
    data = dataset([[4e-6] * 3, [np.nan] * 3]).assign(status=(("sea_state", "seed"), np.full((2, 3), "done")))
    assert (lives(data).failed_realizations == 3).all()
    assert [line[-1] for line in rows(data)] == ["0 to 3, 3 failed", "3", "0, 3 failed"]


@pytest.mark.parametrize(
    ("hours", "share"),
    [
        ([3000.0, 2000.0, 500.0], "63% of a year"),
        ([20.0, 4.5], "0% of a year (24% if percent)"),
        ([50.0, 35.0, 5.0], "if these are hours, they are 1% of a year (90% if percent), and the rest"),
        ([8760.0], ""),
        ([8000.0, 12000.0], "if these are hours, they are 228% of a year, and were scaled down to one."),
        ([8784.0], ""),
        ([8000.0, 2000.0], "114% of a year, and were scaled down to one."),
        ([1e5], ""),
        ([0.5, 0.3, 0.2], ""),
        ([0.5, 0.3, 0.192], ""),
        ([0.45, 0.15], "if these are shares, they are 60% of a year, and the rest counts as if the same seas went on"),
        ([0.7, 0.5], "if these are shares, they are 120% of a year, and were scaled down to one."),
        ([62.0, 30.2, 7.7], ""),
        ([999.0, 1.5], ""),
        (None, ""),
    ],
)
def test_hours_and_shares_of_another_time_than_a_year_are_told(hours, share):
    """Those of one year are not, nor percent and their like; nor is a study that gives none."""
    data = dataset([[1e-6, 3e-6]] * len(hours or [1]))
    data = data if hours is None else data.assign_coords(occurrence=("sea_state", hours))
    console = Console(width=200)
    with console.capture() as drawn:
        show(table(data), console)
    assert ("if these are" in drawn.get()) == bool(share) and share in drawn.get()
    assert bool(of_part(data)) == bool(share) and NOTE in table(data.isel(sea_state=0)).note  # one sea's
