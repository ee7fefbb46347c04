"""Figures of time series, from records made up here."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

from pipeline.bridge.loading import load
from pipeline.report import figures, series
from pipeline.report.drawing import canvas, plain
from pipeline.results.netcdf import Variable, to_bytes
from pipeline.results.records import decode

TIME = np.arange(100.0, 700.0, 0.1)
PLATFORMS = ("elastic", "fixed", "elastic-no-floats")


def record(platform, *, spike=0.0):
    """Sines; a spike of the hinge force at 400 s."""
    wave = np.sin(1.1 * TIME)
    made = {
        "elapsed_time": Variable(("elapsed_time",), TIME, {}),
        "wave_elevation_series": Variable(("elapsed_time",), wave, {}),
    }
    if platform != "elastic-no-floats":
        force = np.zeros((TIME.size, 1, 3))
        force[:, 0, 0] = 1e3 * wave
        force[np.abs(TIME - 400.0).argmin(), 0, 0] += spike
        made["float"] = Variable(("float",), np.array(["front"]), {})
        made["direction"] = Variable(("direction",), np.array(["x", "y", "z"]), {})
        made["hinge_force_series"] = Variable(("elapsed_time", "float", "direction"), force, {})
        made["rotation_series"] = Variable(("elapsed_time", "float"), 0.1 * wave[:, None], {})
    if platform != "fixed":
        made["leg"] = Variable(("leg",), np.array([1], dtype="i4"), {})
        made["direction"] = Variable(("direction",), np.array(["x", "y", "z"]), {})
        made["top_displacement_series"] = Variable(
            ("elapsed_time", "leg", "direction"), np.repeat(wave[:, None, None], 3, axis=2), {}
        )
        made["bottom_stress_series"] = Variable(("elapsed_time", "leg"), 1e6 * wave[:, None], {})
    return to_bytes(made, {})


@pytest.fixture
def results(small, tmp_path):
    """A collected study whose tasks keep their series."""
    text = small.read_text().replace("[waves]", '[record]\nseries = "full"\n[waves]')
    small.write_text(text.replace('sea_state = ["calm", "rough"]', 'sea_state = ["rough"]'))
    names = np.array([[[f"{platform}-{seed}" for seed in (0, 1)] for platform in PLATFORMS]], dtype=object)
    for platform in PLATFORMS:
        folder = tmp_path / "tasks" / f"{platform}-1"  # seed 0 has left nothing
        folder.mkdir(parents=True)
        (folder / "record.nc").write_bytes(record(platform, spike=5e4))
    dims = ("sea_state", "platform", "seed")
    data = xr.Dataset(
        {
            "task": (dims, names),
            "hinge_force": ((*dims, "float", "direction"), np.broadcast_to([1.0, 0.0, 0.0], (1, 3, 2, 1, 3))),
        },
        coords={"sea_state": ["rough"], "platform": list(PLATFORMS), "seed": [0, 1], "float": ["front"], "leg": [1],
                "direction": ["x", "y", "z"], "Hs": ("sea_state", [2.0]), "Tp": ("sea_state", [7.0])},
    )  # fmt: skip
    return figures.Results(study=load(small), data=data, tasks=tmp_path / "tasks")


def test_every_figure_comes_of_what_is_there(results):
    with plain():
        shown = [title for title, _, make in series.entries(results) if make(results) is not None]
    assert shown == ["Waves", "Response of the platform", "Hinge forces", "Rotation"]  # no power in the records
    without = figures.Results(study=results.study, data=results.data)
    assert series.entries(without) == []


def test_motion_is_drawn_along_each_axis_that_moves_but_a_hinges(results):
    """A power that is zero throughout is not drawn, and what is rounding beside the largest motion is none."""
    for platform in ("elastic", "fixed"):
        file = results.tasks / f"{platform}-1" / "record.nc"
        made = dict(decode(file.read_bytes()))
        moved = np.exp(-TIME / 100)[:, None, None] * [[[1.0, 1e-9, np.nan, 0.1]]]
        made["axis"] = Variable(("axis",), np.array(["heave", "sway", "surge", "hinge"]), {})
        made["motion_series"] = Variable(("elapsed_time", "float", "axis"), moved, {})
        made["absorbed_power_series"] = Variable(("elapsed_time", "float"), np.zeros((TIME.size, 1)), {})
        file.write_bytes(to_bytes(made, {}))
    power = (*results.data["task"].dims, "float", "statistic"), np.zeros((1, 3, 2, 1, 1))
    data = results.data.assign(absorbed_power=power, rotation=power)
    data = data.assign_coords(axis=["heave", "sway", "surge", "hinge"], statistic=["mean"])
    sliding = dataclasses.replace(results, data=data)
    with plain():
        made = {title: make(sliding) for title, _, make in series.entries(sliding)}
    assert made["Absorbed power"] is None
    assert [axes.get_title("left") for axes in made["Motion"].axes[::2]] == ["heave, front [m]"]


def test_a_float_that_is_lifted_out_of_the_sea_that_is_drawn_has_no_line(results):
    """Whatever its place among the dataset's floats."""
    data = results.data.reindex(float=["rear", "front"])
    both = dataclasses.replace(results, data=data)
    with plain():
        shown = [title for title, _, make in series.entries(both) if make(both) is not None]
    assert shown == ["Waves", "Response of the platform", "Hinge forces", "Rotation"]
    lines = [list(series.Series(both).line("", "fixed", "rotation", float=name)) for name in ("rear", "front")]
    assert [len(each) for each in lines] == [0, 1]


def test_damaged_records_are_passed_over(results):
    for platform in PLATFORMS:
        folder = results.tasks / f"{platform}-0"  # comes before the whole one
        folder.mkdir()
        (folder / "record.nc").write_bytes(record(platform)[:100])
    (results.tasks / "fixed-1" / "record.nc").unlink()
    (results.tasks / "fixed-1" / "record.nc").mkdir()
    assert list(series.Series(results).records) == ["elastic", "elastic-no-floats"]


VARIED = {
    "an axis": ("seed = ", "'record.series' = ['none', 'full']\nseed = ", "series"),
    "variants": ("[sea_states]", "[variants.none]\n[variants.full]\n'record.series' = 'full'\n[sea_states]", "variant"),
}


@pytest.mark.parametrize("case", VARIED)
def test_series_that_some_labels_keep_are_drawn(small, results, case):
    old, new, dim = VARIED[case]
    small.write_text(small.read_text().replace('series = "full"\n', "").replace(old, new, 1))
    data = results.data.expand_dims({dim: ["none", "full"]}).copy()
    data["task"] = data.task.where(data[dim] == "full", "")
    kept = figures.Results(study=load(small), data=data, tasks=results.tasks)
    assert list(series.Series(kept).records) == list(PLATFORMS)


def test_series_of_labels_that_failed_are_passed_over(small, results):
    """The first label's tasks have left nothing, nor has the highest sea; captions say which are shown."""
    text = small.read_text().replace('sea_state = ["rough"]', 'sea_state = ["calm", "rough"]')
    small.write_text(text.replace("seed = ", "pto_damping = [1e5, 2e5]\nseed = ", 1))
    calm = results.data.assign_coords(sea_state=["calm"], Hs=("sea_state", [0.5]))
    data = xr.concat([calm, results.data.assign(task=calm.task.astype(str) + "-none")], "sea_state", join="outer")
    data = data.expand_dims(pto_damping=[1e5, 2e5]).copy(deep=True)
    done = (data.sea_state == "calm") & (data.pto_damping == 2e5)
    task = data.task.where(done, "none")
    data = data.assign(task=task, wall_time=xr.ones_like(task, float).where(done))
    kept = figures.Results(study=load(small), data=data, tasks=results.tasks)
    assert list(series.Series(kept).records) == list(PLATFORMS)
    assert {words.partition("Sea state ")[2] for _, words, _ in series.entries(kept)} == {
        "calm. Shown at pto damping 200000."
    }


def test_lines_are_the_series_in_the_units_shown(results):
    (top, stress) = series.response(series.Series(results))
    assert [line.name for line in top.lines] == ["with floats", "no floats"]
    np.testing.assert_allclose(stress.lines[0].values, np.sin(1.1 * TIME), rtol=1e-12)
    bare = dataclasses.replace(results, data=results.data.drop_vars(["hinge_force", "float"]))
    assert [line.name for line in series.response(series.Series(bare))[0].lines] == ["", ""]
    (x,) = series.forces(series.Series(results))  # y and z are zero
    assert x.words == "x force on the float [N]"  # as the statistics are
    assert x.lines[0].values.max() == pytest.approx(50e3, abs=1e3)  # the spike on a wave of 1 kN
    large = dataclasses.replace(results, data=1e3 * results.data[["hinge_force"]])
    assert large.force == ("kN", 1e3)


def test_the_close_up_is_about_the_largest_value(results):
    lines = series.forces(series.Series(results))[0].lines
    assert series.window(lines) == pytest.approx(400.0 - series.CLOSE / 2, abs=0.1)
    early = series.Line("", TIME, np.where(TIME < 101.0, 9.0, 0.0))
    assert series.window([early]) == TIME[0]
    late = series.Line("", TIME, np.where(TIME[-1] - 1.0 < TIME, 9.0, 0.0))
    assert series.window([late]) == pytest.approx(TIME[-1] - series.CLOSE)


def test_no_extreme_is_lost_in_the_band():
    """Least and largest of all pieces are those of the record, and neighbours touch."""
    values = np.random.default_rng(1).normal(size=4321)
    at, low, high = series.extremes(values, 500)
    assert (low.min(), high.max()) == (values.min(), values.max())
    assert len(at) == 500
    assert (low[1:] <= high[:-1]).all()
    assert (high[1:] >= low[:-1]).all()


def test_the_spectrum_stands_beside_the_theory_it_was_drawn_from(results):
    with plain():
        _, axes = series.waves(series.Series(results)).axes
    theory = axes.lines[1]
    assert theory.get_xdata()[[0, -1]] == pytest.approx([0.7, 3.4])
    # Pierson-Moskowitz in the peak form, at its peak: S = 5/16 Hs² exp(-5/4) / ωp.
    peak = 5 / 16 * 4.0 * np.exp(-1.25) * 7.0 / (2 * np.pi)
    assert theory.get_ydata().max() == pytest.approx(peak, rel=1e-4)


def test_theory_is_of_the_sea_that_an_axis_makes(small, results):
    """Half as high: a quarter of the density."""
    small.write_text(small.read_text().replace("seed = ", "'sea.Hs' = [1.0, 2.0]\nseed = ", 1))
    record = series.Series(results).records["elastic"]
    line = series.Line("", record["elapsed_time"].values, record["wave_elevation_series"].values)
    peaks = []
    for study in (results.study, load(small)):
        axes = canvas(4.0, 3.0).subplots()
        series._spectrum(axes, series.Series(figures.Results(study=study, data=results.data)), line)
        peaks.append(axes.lines[1].get_ydata().max())
    assert peaks[1] == pytest.approx(peaks[0] / 4)


def test_lines_beyond_the_colours_look_otherwise():
    assert len({(series.look(n)["color"], series.look(n)["linestyle"]) for n in range(12)}) == 12
