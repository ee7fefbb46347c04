"""The design that takes the most power, in each sea state and over a year."""

import numpy as np
import xarray as xr
from pytest import approx
from scipy import stats

from pipeline.report.best import OF_WARNED, UNCOUNTED, table
from pipeline.report.best import rows as rows_of

DAMPINGS = [1e5, 2e5, 4e5]


def rows(data):
    return rows_of(data, "absorbed_power")


def dataset(mild, rough, **coords):
    """Mean power [kW] of one float by damping, two realizations that differ by 2 kW, on two platforms."""
    power = 1e3 * np.array([mild, rough], float)[:, :, None, None, None, None] + [[[[[-1e3]], [[1e3]]]]]
    each = np.concatenate([power, 2 * power], axis=2) * np.ones((2, 3, 2, 2, 1, 1))
    dims = ("sea_state", "pto_damping", "platform", "seed", "float", "statistic")
    known = {"pto_damping": DAMPINGS, "platform": ["elastic", "fixed"], "float": ["only"], "statistic": ["mean"]}
    return xr.Dataset({"absorbed_power": (dims, each)}, coords=known | {"sea_state": ["mild", "rough"]} | coords)


def test_each_sea_has_its_best_and_a_year_another():
    """Of a year the middle damping is best, which is best in neither sea; one at an end of the axis is told so."""
    often = {"occurrence": ("sea_state", [3.0, 1.0])}
    lines = list(rows(dataset([4, 3.9, 1], [1, 9, 9.5], **often)))
    assert [line[:3] for line in lines[:3]] == [
        ("elastic, all seas", "pto_damping 200000", "5.17"),
        ("elastic, mild", "pto_damping 100000 (an end)", "4"),
        ("elastic, rough", "pto_damping 400000 (an end)", "9.5"),
    ]
    assert [line[0] for line in lines[3:]] == ["fixed, all seas", "fixed, mild", "fixed, rough"]
    assert all(line[-1] == "2" and float(line[3]) < float(line[2]) < float(line[4]) for line in lines)


def test_the_best_that_is_warned_of_beyond_its_estimated_error_is_marked():
    """In the sea where it is so, by one task of it; not by other warnings, nor by those of other designs."""
    data = dataset([4, 3.9, 1], [1, 9, 9.5], occurrence=("sea_state", [3.0, 1.0])).isel(platform=0)
    words = np.full((2, 3, 2), "", object)
    words[1, 2, 1], words[0, 0], words[1, 1, 0] = f"it drifts: {UNCOUNTED}", "components repeat", UNCOUNTED
    words[0, 2, 0] = UNCOUNTED  # no best one
    told = table(data.assign(warnings=(("sea_state", "pto_damping", "seed"), words)))
    assert [line[1].partition(" (warned)")[1] for line in told.lines] == [" (warned)", "", " (warned)"]
    assert OF_WARNED in told.note and OF_WARNED not in table(data).note
    words[:, :] = ""
    assert OF_WARNED not in table(data.assign(warnings=(("sea_state", "pto_damping", "seed"), words))).note


def test_of_seas_that_nobody_said_the_occurrence_of_each_stands_by_itself():
    data = dataset([4, 3.9, np.nan], [np.nan] * 3)
    assert [line[:3] for line in rows(data.sel(platform="elastic"))] == [
        ("mild", "pto_damping 100000 (an end) (of 2 among 3)", "4")
    ]
    assert not table(data.sel(pto_damping=[1e5])).lines and not table(xr.Dataset()).lines
    assert [line[:2] for line in rows(data.isel(sea_state=0, platform=0))] == [
        ("", "pto_damping 100000 (an end) (of 2 among 3)")
    ]


def test_a_models_power_is_told_in_watts():
    large = dataset([4, 3.9, 1], [1, 9, 9.5])
    for data, unit in ((large, "kW"), (1e-3 * large, "W")):
        told = table(data)
        assert told.header[2] == f"mean absorbed power [{unit}]" and [line[2] for line in told.lines[:2]] == [
            "4",
            "9.5",
        ]


def test_several_axes_are_one_design():
    data = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(platform=0).drop_vars("platform").expand_dims(hull=["box", "duck"])
    data = data.assign(absorbed_power=data.absorbed_power * xr.DataArray([1.0, 1.5], dims="hull"))
    assert [line[0] for line in rows(data)][:3:2] == ["box, mild", "duck, mild"]  # of what nobody chooses each
    data.hull.attrs["long_name"] = "hull (floats.only.hull)"
    assert [line[:2] for line in rows(data)] == [
        ("mild", "duck, pto_damping 100000 (an end)"),
        ("rough", "duck, pto_damping 400000 (an end)"),
    ]


def test_power_is_that_of_all_floats():
    one = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(platform=0, drop=True)
    other = (one * xr.DataArray([1.0, 2.0, 1.0], dims="pto_damping")).assign_coords({"float": ["other"]})
    assert [line[1:3] for line in rows(xr.concat([one, other], dim="float"))] == [
        ("pto_damping 200000", "11.7"),
        ("pto_damping 200000", "27"),
    ]


def test_where_nothing_takes_power_nothing_is_best():
    """Of a scene without power take-off, and of a sea that the floats lie still in; what costs power is told."""
    whole = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(platform=0, drop=True)
    none = whole.assign(absorbed_power=0 * whole.absorbed_power)
    assert not table(none).lines and not table(none.where(none.seed == 0)).lines
    rough = whole.assign(absorbed_power=whole.absorbed_power.where(whole.sea_state == "rough", 0.0))
    assert [line[0] for line in rows(rough)] == ["rough"]
    dying = whole.assign(absorbed_power=whole.absorbed_power.where(whole.sea_state == "rough", 1e-16))
    assert [line[0] for line in rows(dying)] == ["rough"]
    assert [line[0] for line in rows(whole.assign(absorbed_power=-whole.absorbed_power))] == ["mild", "rough"]


def test_designs_that_failed_in_a_realization_that_another_has_are_not_compared():
    """The first damping takes most in the realization that it has, and less than the second there."""
    data = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(platform=0, drop=True)
    data.absorbed_power[0, 0, 0] = np.nan
    assert [line[:2] for line in rows(data)] == [
        ("mild", "pto_damping 200000 (of 2 among 3)"),
        ("rough", "pto_damping 400000 (an end)"),
    ]


def test_designs_that_failed_in_different_realizations_have_met_different_waves():
    """Each by its own two of three, 6 m has far more; in the one that both have it has less. Nothing is compared."""
    scatter = np.array([0.0, 4.0, -4.0])
    data = of_spacing([5 + scatter, 4.9 + scatter], [9 + scatter, 8 + scatter])
    data.absorbed_power[0, 0, 1] = data.absorbed_power[0, 1, 2] = np.nan
    every, mild, rough = table(data).lines
    assert mild == ("mild", "none (of 0 among 2)", "-", "-", "-", "-", "-", "2, 2 failed")
    assert every[:2] == ("all seas", "none (of 0 among 2)") and every[-1] == "2 to 3, 2 failed"
    assert rough[1] == "hinge_spacing 4 (an end)" and rough[5:] == ("hinge_spacing 6", "1 [1, 1]", "3")
    third = of_spacing([5 + scatter, 4.9 + scatter, 3 + scatter], [9 + scatter, 8 + scatter, 7 + scatter])
    third.absorbed_power[0, :2] = data.absorbed_power[0]
    assert table(third).lines[1][1] == "hinge_spacing 8 (of 1 among 3)"


def test_a_sample_has_no_end_and_tells_its_values():
    """Nor an axis whose keys do nothing."""
    data = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(platform=0, drop=True).rename(pto_damping="sample")
    data = data.assign_coords(sample=("sample", [1, 2, 3], {"long_name": "floats.only.mass"}))
    data = data.assign_coords({"floats.only.mass": ("sample", [5e3, 6e3, 7e3])})
    assert [line[1] for line in rows(data)] == ["sample 1 (only.mass 5000)", "sample 3 (only.mass 7000)"]
    names = {"variant": ("variant", ["one", "two", "three"], {"long_name": "floats.only.mass"})}
    titled = data.drop_vars("floats.only.mass").rename(sample="variant")
    titled = titled.assign_coords(names | {"variant_title": ("variant", ["one", "two", "heavy"])})
    assert [line[1] for line in rows(titled)] == ["one", "three (heavy)"]
    alike = dataset([4, 4, 4], [1, 1, 1])
    assert {line[1] for line in rows(alike)} == {"any"}


def test_designs_that_meet_other_waves_are_not_compared():
    """Of what changes seas or water, too, each stands by itself, and so does what makes other realizations."""
    data = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(platform=[0]).rename(platform="tuned")
    two = xr.concat([data, 2 * data], "tuned")
    for path in ("sea.Hs", "waves.heading", "water.depth", "waves.base_seed"):
        both = two.assign_coords(tuned=("tuned", [1, 2], {"long_name": f"Values of floats.only.mass, {path}"}))
        assert [line[0] for line in rows(both)] == [
            "tuned 1, mild",
            "tuned 1, rough",
            "tuned 2, mild",
            "tuned 2, rough",
        ]
        assert not table(both.isel(pto_damping=[0])).lines


def test_a_single_sea_has_its_name():
    one = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(sea_state=[1], platform=0, drop=True)
    assert [line[0] for line in rows(one)] == ["rough"]


def test_of_a_single_sea_and_realization_an_end_is_told():
    """Where no dimension but the designs' is left, along which what failed lies, too."""
    one = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(sea_state=1, platform=0, seed=0)
    assert [line[1] for line in rows(one)] == ["pto_damping 400000 (an end)"]
    sample = one.rename(pto_damping="sample").assign_coords(sample=("sample", [1, 2, 3]))
    sample["sample"].attrs["long_name"] = "floats.only.mass"
    sample = sample.assign_coords({"floats.only.mass": ("sample", [5e3, 6e3, 7e3])})
    assert [line[1] for line in rows(sample)] == ["sample 3 (only.mass 7000)"]


def test_with_an_efficiency_the_best_is_that_of_electrical_power():
    """Of all floats: what one without an efficiency absorbs is its own; the header says of which power it is."""
    front = dataset([4, 5, 6], [7, 8, 9]).isel(platform=0, drop=True)
    share = xr.DataArray([0.8, 0.8, 0.5], dims="pto_damping")
    front = front.assign(electrical_power=share * front.absorbed_power)
    rear = dataset([0, 0, 0], [0, 0, 2]).isel(platform=0, drop=True).assign_coords({"float": ["rear"]})
    rear = rear.assign(electrical_power=np.nan * rear.absorbed_power)
    told = table(xr.concat([front, rear], dim="float"))
    assert told.header[2] == "mean electrical power [kW]"
    assert [line[:3] for line in told.lines] == [
        ("mild", "pto_damping 200000", "4"),
        ("rough", "pto_damping 400000", "6.5"),
    ]


def of_spacing(mild, rough):
    """Power [kW] (hinge_spacing, seed) of one float in seas of which the rough one comes a quarter of the time."""
    power = 1e3 * np.array([mild, rough], float)[..., None, None]
    return xr.Dataset(
        {"absorbed_power": (("sea_state", "hinge_spacing", "seed", "float", "statistic"), power)},
        coords={"hinge_spacing": [4.0, 6.0, 8.0][: power.shape[1]], "sea_state": ["mild", "rough"]}
        | {"float": ["only"], "statistic": ["mean"], "occurrence": ("sea_state", [3.0, 1.0])},
    )


def test_the_next_best_has_less_by_paired_differences():
    """Seeds scatter by far more than designs differ in each sea: that is decided. Of a year it is not."""
    scatter, less = np.array([-0.5, 0.1, 0.4]), np.array([0.03, 0.05, 0.04])
    rough = 2 * less + [0.02, -0.05, 0.03]
    data = of_spacing([3 + scatter, 3 + scatter - less], [9 + scatter - 2 * rough, 9 + scatter])
    every, mild, steep = table(data).lines
    assert table(data).header[5:] == ("next best", "less by [kW]", "realizations")
    half = stats.t.ppf(0.975, 2) * less.std(ddof=1) / np.sqrt(3)
    assert mild[1] == "hinge_spacing 4 (an end)" and float(mild[3]) < 3 - 0.04 < float(mild[4])
    assert mild[5:] == ("hinge_spacing 6", f"0.04 [{0.04 - half:.3g}, {0.04 + half:.3g}]", "3")
    assert (steep[1], steep[5]) == ("hinge_spacing 6 (an end)", "hinge_spacing 4") and "undecided" not in steep[6]
    assert (every[1], every[5]) == ("hinge_spacing 6", "hinge_spacing 4") and every[6].endswith("] undecided")
    assert float(every[6].split()[0]) == approx(0.25 * 2 * rough.mean() - 0.75 * 0.04, abs=1e-4)
    single = table(data.isel(seed=[1]))
    assert single.header[5:] == ("realizations",) and [line[1][-8:] for line in single.lines] == ["(an end)"] * 3


def test_what_records_may_be_off_by_is_undecided():
    """By the root of both errors' squares, relative to the rms, which add up over sea states; no end is told then."""
    data = of_spacing([[3.0, 3.001], [2.9, 2.901]], [[9.0, 9.001], [8.7, 8.701]])
    data = xr.concat([data, 2 * data], "statistic").assign_coords(statistic=["mean", "rms"])
    one = xr.DataArray(np.ones((2, 2)), dims=["sea_state", "seed"])
    for error, told in ((0.016, ""), (0.018, "undecided")):  # differences are 0.017 of both rms so weighed
        known = data.assign(estimated_error=error * one * xr.DataArray([0.6, 0.8], dims="hinge_spacing"))
        for line in table(known).lines:
            assert line[1] == "hinge_spacing 4" + " (an end)" * (not told) and line[2].endswith(" *")
            assert line[6].partition("] ")[2] == told
        single = [line[1] for line in table(known.isel(seed=[0])).lines]
        assert single == ["hinge_spacing 4" + (f" ({told})" if told else " (an end)")] * 3


def test_a_worse_design_whose_records_tell_less_may_be_as_good():
    """Not only the next best is asked; nor does an error that is not known decide anything."""
    data = of_spacing(*2 * [[[5.0, 5.001], [4.0, 4.001], [3.0, 3.001]]])
    data = xr.concat([data, data], "statistic").assign_coords(statistic=["mean", "rms"])
    one = xr.DataArray(np.ones((2, 2)), dims=["sea_state", "seed"])
    for last in (0.9, np.nan):
        known = data.assign(estimated_error=one * xr.DataArray([0.01, 0.01, last], dims="hinge_spacing"))
        single, both = table(known.isel(seed=[0])).lines[0], table(known).lines[0]
        assert single[1].endswith(" (undecided)") and both[6].endswith("] others undecided")


def test_an_end_is_decided_against_the_number_beside_it():
    """Of those that are compared: what is far better than the other end may be no better than what is beside it."""
    scatter = np.array([-0.01, 0.01])
    data = of_spacing(*2 * [[5 + scatter, 5.01 - scatter, 8 + 3 * scatter]]).isel(hinge_spacing=[2, 0, 1])
    assert {line[1] for line in rows(data)} == {"hinge_spacing 8 (an end)"}
    data = data.copy(deep=True).assign_coords(hinge_spacing=[4.0, 8.0, 6.0])
    data.absorbed_power[:, 2] = 7.9e3 - 3e3 * scatter[:, None, None]
    assert {line[1] for line in rows(data)} == {"hinge_spacing 4"}
    data.absorbed_power[:, 2, 0] = np.nan
    assert {line[1] for line in rows(data)} == {"hinge_spacing 4 (an end) (of 2 among 3)"}


def test_a_regular_sea_takes_no_verdict_away():
    """Which has one task, whatever the seed, and no scatter; of one realization of a random sea none is known."""
    data = dataset([4, 4.1, 1], [9, 9, 9.3], occurrence=("sea_state", [4.0, 1e-3])).isel(platform=0, drop=True)
    swap = data.absorbed_power.isel(seed=[1, 0]).values
    data.absorbed_power[:, 1] = swap[:, 1]  # waves that suit the one do not suit the other
    names = np.array([[[f"{sea}{design}{seed}" for seed in range(2)] for design in range(3)] for sea in range(2)])
    names[1] = names[1, :, :1]
    regular = data.assign(task=(("sea_state", "pto_damping", "seed"), names))
    regular.absorbed_power[1, :, 1] = regular.absorbed_power[1, :, 0]
    every, mild, rough = rows(regular)
    assert every[1] == mild[1] == "pto_damping 200000" and every[3] != "-" and "undecided" in every[6]
    assert rough[2] == rough[3] == rough[4] and "undecided" not in rough[6]
    ran = regular.assign(task=(("sea_state", "pto_damping", "seed"), np.arange(12).reshape(2, 3, 2).astype(str)))
    ran.absorbed_power[1, :, 1] = np.nan
    every, _, rough = rows(ran)
    assert every[3] == rough[3] == "-" and "undecided" in every[6] and "undecided" in rough[6]


def test_others_that_take_as_much_are_counted():
    data = dataset([4, 4, 1], [1, 9, 9.5]).isel(platform=0, drop=True)
    assert [line[1] for line in rows(data)] == [
        "pto_damping 100000 (an end) (and 1 alike)",
        "pto_damping 400000 (an end)",
    ]
    assert [line[1] for line in rows(-data)] == [
        "pto_damping 400000 (an end) (all lose)",
        "pto_damping 100000 (an end) (all lose)",
    ]


def test_designs_alike_are_no_next_best():
    """Which is told by the axes along which it differs; where all are alike there is none."""
    data = of_spacing([[3, 5], [4, 6.5]], [[7, 9], [8, 9.5]])
    data = data.assign(absorbed_power=data.absorbed_power * xr.DataArray([1.0, 1 - 1e-9], dims="pto_damping"))
    data = data.assign_coords(pto_damping=[1e5, 2e5])
    assert {line[5] for line in rows(data)} == {"hinge_spacing 4"}
    assert {line[5:7] for line in rows(data.isel(hinge_spacing=[0]))} == {("-", "-")}
    assert {line[1] for line in rows(data.isel(seed=[0]))} == {"hinge_spacing 6 (an end), any pto_damping"}


def test_an_axis_along_which_the_best_does_not_matter_has_any_value():
    """As the damping of a float that a storm lifts out; not where that depends on another axis, which is then told."""
    one = of_spacing([[4.0]], [[9.0]]).isel(hinge_spacing=0, drop=True)
    labels = {name: (name, [1.0, 2.0], {"long_name": f"mass (floats.{name}.mass)"}) for name in ("front", "rear")}
    for power, told in (
        ([[2, 1], [1, 1]], "front 1 (an end), rear 1 (an end)"),
        ([[2, 2], [1, 1]], "front 1 (an end), any rear"),
        ([[2, 2], [2, 1]], "any front, rear 1 (and 1 alike)"),
        ([[2, 2], [2, 2]], "any"),
        ([[2, np.nan], [1, np.nan]], "front 1 (an end), rear 1 (of 2 among 4)"),
    ):
        data = one.assign(absorbed_power=one.absorbed_power * xr.DataArray(power, labels, dims=[*labels]))
        assert {line[1] for line in rows(data)} == {told}


def test_what_records_of_a_storm_are_off_by_is_of_no_design_that_has_the_same_ones():
    """Two designs that differ in the mild sea by more than records there may be off, and meet the rough one alike."""
    often = {"occurrence": ("sea_state", [3.0, 1.0])}
    data = (
        dataset([4.0, 2.0, 1.0], [9.0, 9.0, 9.0], **often)
        .sel(platform="elastic", pto_damping=[1e5, 2e5])
        .isel(seed=[0])
    )
    power = data["absorbed_power"].isel(statistic=0, drop=True)
    rms = power.expand_dims(statistic=["rms"], axis=-1)
    data["absorbed_power"] = (data["absorbed_power"].dims, data["absorbed_power"].values)
    data = xr.concat(
        [data, rms.to_dataset(name="absorbed_power")], dim="statistic", data_vars="minimal", coords="minimal"
    )
    errors = xr.DataArray([0.05, 0.9], dims="sea_state", coords={"sea_state": ["mild", "rough"]})
    data["estimated_error"] = errors * xr.ones_like(power.isel(float=0, drop=True))
    found = {line[0]: line[1] for line in rows(data)}
    assert found["all seas"] == "pto_damping 100000 (an end)"
    assert "undecided" not in found["all seas"] and found["rough"] == "any"
    data["absorbed_power"] = data["absorbed_power"] + 1e-3 * (data["pto_damping"] - 1e5) * (
        data["sea_state"] == "rough"
    )
    assert "undecided" in {line[0]: line[1] for line in rows(data)}["all seas"]


def test_what_one_realization_does_not_tell_is_said_of_random_seas_alone():
    data = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(seed=[0])
    march = data.assign(discretization_error=1e-4)
    for given, said in ((march.assign_coords(Hs=("sea_state", [1.0, 2.0])), True), (march, False), (data, False)):
        assert ("more seeds do" in table(given).note) == said


def test_a_study_may_vary_nothing_but_a_design():
    """No sea states, no seeds, no platforms: the best is one number, beside which each other stands."""
    data = dataset([4, 3.9, 1], [1, 9, 9.5]).isel(sea_state=0, platform=0, seed=0)
    rms = 2 * data.absorbed_power.assign_coords(statistic=["rms"])
    data = xr.concat([data, xr.Dataset({"absorbed_power": rms})], "statistic")
    for error, told in ((1e-3, "pto_damping 100000 (an end)"), (0.1, "pto_damping 100000 (undecided)")):
        given = data.assign(estimated_error=("pto_damping", [error] * 3), status=("pto_damping", ["done"] * 3))
        assert [line[:2] for line in table(given).lines] == [("", told)]
