"""The report as a page, and the figures in it, of a small made-up dataset."""

import re
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from conftest import SMALL
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.lines import Line2D

from pipeline.bridge.loading import load
from pipeline.cli import cli
from pipeline.report import arrays, envelopes, figures, overview, page, sketch, strips
from pipeline.report.along import along
from pipeline.report.captions import entries
from pipeline.report.drawing import above, canvas, plain, rendered, svg
from pipeline.report.published import COLUMNS, read_published
from pipeline.report.responses import responses
from pipeline.report.tables import SURVIVORS
from pipeline.tasks.study import Study

METHODS = ("frequency", "time")
HEIGHTS = np.array([0.0, 20.0, 52.6])
PUBLISHED = """table,label,variable,selection,statistic,value,unit,note
T1,power & <all>,absorbed_power,sea_state=rough;platform=elastic;float=front,mean,8.0,kW,the paper's spike
"""


def dataset():
    """2 sea states, 3 platforms, 2 seeds; no float numbers without floats, and one failed task."""
    rng = np.random.default_rng(7)
    cells, dims = (2, 3, 2), ("sea_state", "platform", "seed")
    statistics = ["max", "min", "mean", "rms", "std"]

    def values(*sizes):
        numbers = 1 + rng.random((*cells, *sizes))
        numbers[1, 0, 1] = np.nan
        return numbers

    data = xr.Dataset(
        {
            "absorbed_power": ((*dims, "float", "statistic"), 1e3 * values(1, 5)),
            "rotation": ((*dims, "float", "statistic"), values(1, 5)),
            "hinge_force": ((*dims, "float", "direction", "statistic"), values(1, 3, 5)),
            "displacement_envelope": ((*dims, "leg", "height"), values(1, 3)),
            "stress_envelope": ((*dims, "leg", "height"), values(1, 3)),
            "energy_residual": (dims, values() - 1.5),
            "discretization_error": (dims, 0 * values()),
            "wall_time": (dims, values()),
            "status": (dims, np.full(cells, "done", dtype="U8")),
            "task": (dims, np.arange(12).reshape(cells).astype(str)),
        },
        coords={
            "sea_state": ["calm", "rough"],
            "platform": ["elastic", "fixed", "elastic-no-floats"],
            "seed": [0, 1],
            "float": ["front"],
            "leg": [1],
            "height": HEIGHTS,
            "direction": ["x", "y", "z"],
            "statistic": statistics,
            "Hs": ("sea_state", [0.5, 2.0]),
            "Tp": ("sea_state", [5.0, 7.0]),
            "pto_damping": 1e5,
        },
        attrs={"title": "A <small> study", "source": "sources 0123abc", "version_numpy": "2.4"},
    )
    for name in ("absorbed_power", "rotation", "hinge_force"):
        data[name].loc[{"platform": "elastic-no-floats"}] = np.nan
    for name in ("displacement_envelope", "stress_envelope"):
        data[name].loc[{"platform": "fixed"}] = np.nan
    data["hinge_force"].loc[{"direction": "y"}] = 0.0
    data["status"][1, 0, 1] = "failed"
    return data


@pytest.fixture
def results(small):
    return figures.Results(study=load(small), data=dataset())


def titles(results):
    return [figure["title"] for figure in page.drawn(results)]


def test_the_command_writes_the_page_and_the_figure(small, tmp_path, capsys):
    (tmp_path / "small-published.csv").write_text(PUBLISHED)
    root = tmp_path / "results" / "small"
    root.mkdir(parents=True)
    data = dataset()
    data.to_netcdf(root / "statistics.nc")
    picture = tmp_path / "small.png"
    cli.report(small, tmp_path / "results", picture)
    text = (root / "report.html").read_text()
    ours = data.absorbed_power.sel(sea_state="rough", platform="elastic", float="front", statistic="mean", seed=0)
    assert f"<td>{float(ours) / 1e3:.4g}</td>" in text
    for words in ("A &lt;small&gt; study", "0123abc", "numpy 2.4", "power &amp; &lt;all&gt;", "the paper&#39;s spike"):
        assert words in text
    assert "11 done, 1 failed of 12 = sea state (2) × platform (3) × seed (2)" in text
    assert "sea_state rough, platform elastic, seed 1: failed" in text
    assert str(root / "report.html") in capsys.readouterr().out
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert not list(tmp_path.rglob("*.part"))


def test_the_page_needs_nothing_from_elsewhere(results):
    text = page.html(results)
    sources = re.findall(r'(?:src|href)="([^",]*)', text)
    assert sources == ["data:image/svg+xml;base64"] * 5
    assert "http" not in re.sub(r'src="data:[^"]*"', "", text)
    assert "absorbed_power" in text  # nothing was published, so there is the summary
    assert re.findall("<h3>(.*)</h3>", text) == [
        "Scene",
        "Envelopes along the legs",
        "Power and rotation in each sea state",
        "Extremes of the hinge force",
        "What the runs say of themselves",
    ]


def test_missing_variables_are_left_out(results):
    half = results.data.drop_vars(["stress_envelope", "rotation", "hinge_force", "wall_time"])
    assert len(titles(figures.Results(study=results.study, data=half))) == 4
    bare = figures.Results(study=results.study, data=results.data[["status", "task"]])
    assert titles(bare) == ["Scene"]
    with plain():
        assert len(overview.overview(bare).axes) == 1


def test_a_study_that_varies_nothing(results):
    one = results.data.isel(sea_state=1, platform=0, seed=0)
    alone = figures.Results(study=results.study, data=one)
    assert len(titles(alone)) == 5
    assert page.troubles(alone) == []
    failed = one.assign(status="failed", failure="SimulationFailed: it swung through")
    assert page.troubles(figures.Results(study=results.study, data=failed)) == [
        "failed: SimulationFailed: it swung through"
    ]


@pytest.mark.usefixtures("undrawn")
def test_the_page_has_damage_and_life_where_they_are_reckoned(results):
    """Of platforms that have legs; a count that failed leaves its realization out, and is no zero."""
    damage = xr.zeros_like(results.data["energy_residual"]).expand_dims(leg=[1], fibre=[1]) + 1e-6
    damage = damage.where((damage.platform != "fixed") & ~((damage.seed == 1) & (damage.sea_state == "rough")))
    text = page.html(replace(results, data=results.data.assign(damage=damage)))
    assert "<h2>Fatigue</h2>" in text and "elastic-no-floats, all seas" in text and "fixed, all seas" not in text
    row = next(line for line in text.splitlines() if "elastic, all seas" in line)
    assert "<td>0.00877</td><td>-</td><td>-</td><td>114</td>" in row and "<td>1 to 2, 1 failed</td>" in row
    assert "<h2>Fatigue</h2>" not in page.html(results)


@pytest.mark.usefixtures("undrawn")
def test_the_page_names_what_was_asked_and_not_met(results):
    words = results.data["status"].astype(object).copy()
    words[...] = ""
    words[0, 0, 0] = "tolerance 1e-3 asked, 2.1e-3 estimated"
    marked = figures.Results(study=results.study, data=results.data.assign(unmet=words))
    (line,) = page.unmet(marked)
    assert line.endswith("seed 0: tolerance 1e-3 asked, 2.1e-3 estimated")
    bare = figures.Results(study=results.study, data=marked.data[["status", "task", "unmet"]])
    assert f"<h2>Asked and not met</h2>\n<ul>\n<li>{line}</li>" in page.html(bare)
    assert "Asked and not met" not in page.html(
        figures.Results(study=results.study, data=marked.data[["status", "task"]])
    )


@pytest.mark.usefixtures("undrawn")
def test_the_page_tells_warnings_once_and_of_how_many_tasks(results):
    words = results.data["status"].astype(object).copy()
    words[...] = "it buckles at 0.4; it stands here"
    words[0, 0, 0], words[0, 0, 1] = "", "it buckles at 3e-1; it stands here"
    bare = results.data[["status", "task"]].assign(warnings=words)
    marked = figures.Results(study=results.study, data=bare)
    (line,) = page.warnings(marked)
    assert line == f"it buckles at 3e-1; it stands here ({words.size - 1} of {words.size} tasks)"
    assert f"<h2>Warnings</h2>\n<ul>\n<li>{line}</li>" in page.html(marked)
    assert "<h2>Warnings" not in page.html(replace(marked, data=bare.drop_vars("warnings")))


def test_an_axis_of_numbers_has_its_own_figure(results):
    data = xr.concat([dataset().assign_coords(pto_damping=b) for b in (1e5, 2e5, 4e5)], "pto_damping")
    data["pto_damping"].attrs["units"] = "N m s rad-1"
    varied = figures.Results(study=results.study, data=data)
    assert "Along pto damping" in titles(varied)
    with plain():
        axes = along(varied, "pto_damping").axes[0]
    assert axes.get_xlabel() == "pto damping [N m s rad-1]"
    for line, (sea, platform) in zip(
        axes.lines, [(sea, p) for sea in ("calm", "rough") for p in ("elastic", "fixed")], strict=True
    ):
        mean = data.absorbed_power.sel(sea_state=sea, platform=platform, statistic="mean", float="front").mean("seed")
        np.testing.assert_allclose(line.get_xydata(), np.column_stack([data.pto_damping, mean / 1e3]))
        assert line.get_marker() == {"calm": "o", "rough": "s"}[sea]


@pytest.mark.parametrize(("count", "told"), [(1, "Sea state sea-1"), (6, "Each sea state"), (7, "Sea state sea-2")])
def test_few_sea_states_have_a_line_each_along_an_axis(results, count, told):
    """More than there are markers leave the highest, the third here; the key names those that have one."""
    one = dataset()[["absorbed_power", "rotation"]].isel(sea_state=[1])
    seas = [f"sea-{i}" for i in range(count)] if count > 1 else ["sea-1"]
    data = xr.concat([i * one.assign_coords(sea_state=[sea]) for i, sea in enumerate(seas, 1)], "sea_state")
    data = data.assign_coords(Hs=("sea_state", np.where(np.array(seas) == "sea-2", 3.0, 1.0)))
    data = xr.concat([data.assign_coords(pto_damping=b) for b in (1e5, 2e5)], "pto_damping")
    varied = figures.Results(study=results.study, data=data)
    with plain():
        figure = along(varied, "pto_damping")
    (key,) = figure.legends
    names = [text.get_text() for text in key.get_texts()]
    shown = seas if 1 < count < 7 else []
    assert names == ["front, elastic", "front, fixed", *shown]
    assert len(figure.axes[0].lines) == 2 * max(1, len(shown))
    power = 3 if count == 7 else 1
    mean = one.absorbed_power.sel(platform="elastic", float="front", statistic="mean").mean("seed").item() / 1e3
    assert figure.axes[0].lines[0].get_ydata() == pytest.approx(power * mean)
    (caption,) = (caption for title, caption, _ in entries(varied) if title == "Along pto damping")
    assert caption.startswith(f"{told}, mean over realizations; bars: least and largest.")
    for floats, lines in ((2, len(shown)), (3, 0)):
        fleet = xr.concat([data.assign_coords(float=[f"float-{i}"]) for i in range(floats)], "float")
        assert len(replace(varied, data=fleet).marked) == max(1, lines)


def test_floats_beyond_the_colours_have_other_marks_and_those_that_hide_one_another_one_name(results):
    """Eight floats: the first two and the last move alike, all others each by itself."""
    one = dataset()[["absorbed_power", "rotation"]].isel(sea_state=[1], platform=[0])
    one = one.where(one.seed == 0)
    size = dict(zip([f"f{i}" for i in range(8)], [1.0, 1.001, 2.0, 3.0, 4.0, 5.0, 6.0, 1.0], strict=True))
    data = xr.concat([share * one.assign_coords(float=[name]) for name, share in size.items()], "float")
    data = xr.concat([data.assign_coords(pto_damping=b) for b in (1e5, 2e5)], "pto_damping")
    fleet = figures.Results(study=results.study, data=data)
    looks = [(look["color"], look["marker"]) for _, _, look in figures.series(fleet, "absorbed_power")]
    assert len(set(looks)) == 8 and [mark for _, mark in looks] == ["o"] * 6 + ["s"] * 2
    with plain():
        figure = along(fleet, "pto_damping")
        by_sea = figures.sea_states(fleet)
    (key,), (apart,) = figure.legends, by_sea.legends
    assert [text.get_text() for text in key.get_texts()] == ["f0, f1, f7", *(f"f{i}" for i in range(2, 7))]
    assert key.legend_handles[0].get_marker() == "s"  # of the one on top
    assert [text.get_text() for text in apart.get_texts()] == [*size]


def test_files_of_figures_tell_minus(results, tmp_path, monkeypatch):
    data = xr.concat([dataset().assign_coords(stiffness=k) for k in (-5e3, 5e3)], "stiffness")
    made = [("Along damping at stiffness -5000", "", canvas(1.0, 1.0))]
    monkeypatch.setattr(page, "results_of", lambda *_: replace(results, data=data))
    monkeypatch.setattr(page, "_made", lambda _: iter(made))
    (file,) = page.write_figures(results.study, tmp_path / "statistics.nc", "svg")
    assert file.name == "along-damping-at-stiffness-minus-5000.svg"


@pytest.mark.parametrize(("form", "begins"), [("svg", b"<?xml"), ("png", b"\x89PNG"), ("pdf", b"%PDF")])
def test_every_figure_is_a_file_of_its_own(results, tmp_path, monkeypatch, form, begins):
    """As the page has them; a second time they are the same to the last bit."""
    monkeypatch.setattr(page, "results_of", lambda *_: results)
    path = tmp_path / "statistics.nc"
    first, second = ({file: file.read_bytes() for file in page.write_figures(results.study, path, form)} for _ in "12")
    assert len(first) == len(list(page.drawn(results))) and first == second
    assert tmp_path / "figures" / f"extremes-of-the-hinge-force.{form}" in first
    assert all(data.startswith(begins) for data in first.values())


@pytest.mark.parametrize(("letters", "columns"), [(2, 6), (15, 3), (60, 1), (200, 1)])
def test_a_key_is_no_wider_than_its_figure(letters, columns):
    """Where words are short six stand in a row; longer than the figure nothing can be."""
    figure = canvas(9.0, 3.0)
    with plain():
        above(figure, [Line2D([], [], marker="o", label=i * "-" + letters * "m") for i in range(7)])
    (key,) = figure.legends
    assert key._ncols == columns
    assert (key.get_window_extent().width <= figure.bbox.width) == (letters < 200)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ((2e4, 1e5, 5e5), ["20000", "100000", "500000"]),
        (tuple(np.geomspace(3.0, 40.0, 9)), ["5", "10", "20"]),
        (tuple(np.geomspace(1.0, 1e6, 9)), ["1", "10", "100", "1000", "10000", "100000", "1000000"]),
    ],
)
def test_numbers_of_a_logarithmic_axis_have_room(results, values, told):
    """Its own if they are few; none between decades."""
    data = xr.concat([dataset().assign_coords(pto_damping=b) for b in values], "pto_damping")
    with plain():
        figure = along(figures.Results(study=results.study, data=data), "pto_damping")
        rendered(figure, "png")
        for axes in figure.axes:
            low, high = axes.get_xlim()
            texts = axes.xaxis.get_ticklabels(which="both")
            marks = [(text.get_position()[0], text) for text in texts if text.get_text()]
            seen = [(place, text) for place, text in marks if 0.999 * low <= place <= 1.001 * high]
            assert {f"{place:.0f}" for place, _ in seen} <= {*told}
            boxes = sorted((text.get_window_extent() for _, text in seen), key=lambda box: box.x0)
            assert len(boxes) > 2 and all(one.x1 < other.x0 for one, other in pairwise(boxes))


def test_means_along_an_axis_have_their_range_and_a_ring_where_realizations_are_missing(small):
    """Both of numbers and of words; rows that have none say so, and of seas without marks the key says nothing."""
    varied = along_of(small, "pto_damping", "", pto_damping=[1e5, 2e5])
    data = varied.data.sel(platform=["elastic"]).copy(deep=True)
    data["absorbed_power"].loc[{"sea_state": "calm"}] = np.nan
    data["absorbed_power"].loc[{"sea_state": "rough", "seed": 1, "pto_damping": 2e5}] = 7e3
    part = replace(varied, data=data)
    known = data.absorbed_power.sel(sea_state="rough", pto_damping=2e5, statistic="mean").values.ravel() / 1e3
    with plain():
        numbers, seas = along(part, "pto_damping"), figures.sea_states(part)
        words = along(replace(part, data=data.assign_coords(pto_damping=["a", "b"])), "pto_damping")
    bars = [bar.get_segments()[0][:, 1] for bar in numbers.axes[0].collections if isinstance(bar, LineCollection)]
    assert sorted(bars[-1]) == pytest.approx(sorted(known))
    rings = [
        [of for of in axes.collections if isinstance(of, PathCollection)] for axes in (numbers.axes[0], words.axes[0])
    ]
    ((x, y),) = rings[0][0].get_offsets()
    assert x == 1e5 and y == pytest.approx(
        data.absorbed_power.sel(sea_state="rough", pto_damping=1e5, statistic="mean", seed=0).item() / 1e3
    )
    assert len(rings[0]) == len(rings[1]) == 1
    assert [text.get_text() for text in numbers.legends[0].get_texts()] == ["front"]
    assert [text.get_position()[1] for text in seas.axes[0].texts if text.get_text() == "no numbers"] == [0]
    captions = {title.partition(" at ")[0]: caption for title, caption, _ in entries(part)}
    assert figures.RINGED in captions["Along pto damping"] and figures.RINGED in captions["Power in each sea state"]


def test_of_one_realization_there_is_no_spread(results, study_of):
    """Nor of several of a regular sea; and the frequency domain tells what is to be expected of a record."""
    one = replace(results, data=results.data.isel(seed=[0]))
    for of, several in ((results, True), (one, False)):
        told = " ".join(caption for title, caption, _ in entries(of))
        assert ("least and largest." in told) == several and ("mean of the real" in told) == several
    forces = {title: caption for title, caption, _ in entries(one)}["Extremes of the hinge force"]
    assert forces.startswith("Least and largest force in each realization")
    content = results.study.content
    theory = content.model_copy(update={"solver": content.solver.model_copy(update={"method": "frequency"})})
    expected = replace(results, study=replace(results.study, content=theory))
    forces = {title: caption for title, caption, _ in entries(expected)}["Extremes of the hinge force"]
    assert forces.startswith("Least and largest force that are to be expected of a record")


def test_where_extremes_have_failed_realizations_it_is_said(results):
    forces = {title: caption for title, caption, _ in entries(results)}["Extremes of the hinge force"]
    assert "failed, as a rule the roughest, have no dots." in forces


@pytest.mark.parametrize("kind", ["still", "regular"])
def test_still_water_has_no_waves_that_go_anywhere(study_of, buan_tables, kind):
    more = {} if kind == "still" else {"period": 5.0, "height": 1.0}
    buan_tables["sea_states"] = {"one": {"kind": kind, **more}}
    buan_tables["axes"]["sea_state"] = ["one"]
    content = study_of(buan_tables).content
    with plain():
        views = [sketch.side_view(content).axes[1], arrays.from_above(content).axes[0]]
    assert ["waves" in [text.get_text() for text in axes.texts] for axes in views] == [kind != "still"] * 2


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ((5e4, 7.937e4, 1.26e5, 2e5, 3.175e5, 5.04e5, 8e5), "log"),
        ((8e5, 5e4, 2e5), "log"),
        ((1.0, 2.0, 5.0, 10.0, 20.0), "log"),
        ((0.1, 0.316, 1.0), "log"),
        ((1e5, 3e5, 9e5), "linear"),  # a decade is not reached
        ((1.0, 6.0, 11.0), "linear"),
        ((1.0, 2.0, 30.0), "linear"),
        ((1.0, 100.0), "linear"),
        ((0.0, 1.0, 10.0, 100.0), "linear"),
        ((-100.0, -10.0, -1.0), "linear"),
        ((1.0, 10.0, 100.0, np.inf), "linear"),
        ((1.1, 1.2, 1.9, 2.8, 3.0, 6.0, 8.0, 20.0), "log"),  # drawn by their logarithm
        ((1.1, 2.9, 4.0, 9.0, 11.0, 12.0, 17.0, 20.0), "linear"),
    ],
)
def test_numbers_in_equal_ratios_stand_on_a_logarithmic_scale(results, values, scale):
    data = xr.concat([dataset().assign_coords(pto_damping=b) for b in values], "pto_damping")
    with plain():
        panels = along(figures.Results(study=results.study, data=data), "pto_damping").axes
    assert {axes.get_xscale() for axes in panels} == {scale} and {axes.get_yscale() for axes in panels} == {"linear"}


def test_a_task_of_several_cells_is_counted_named_and_drawn_once(results):
    """The calm sea is a regular one: both seeds have its one task; one platform has none for it."""
    data = results.data.copy(deep=True)
    data["task"][0, :, 1] = data["task"][0, :, 0]
    data["task"][0, 2], data["status"][0, 2], data["status"][0, 0] = "", "no task", "failed"
    data["wall_time"][0, 2] = np.nan
    data["failure"] = xr.full_like(data["status"], "", object)
    data["failure"][0, 0] = "SimulationFailed: too steep"
    shared = replace(results, data=data)
    assert dict(page.facts(shared))["Tasks"] == "6 done, 2 failed of 8"
    assert page.troubles(shared) == [
        "sea_state calm, platform elastic, seed 0: failed: SimulationFailed: too steep",
        "sea_state rough, platform elastic, seed 1: failed",
    ]
    data["failure"] = data["failure"].where(data["status"] != "failed", "SimulationFailed: too steep by 1.5")
    data["failure"][0, 0] = "SimulationFailed: too steep by 2"
    (line,) = page.troubles(shared)
    assert line.startswith("sea_state calm, platform elastic, seed 0; sea_state rough, platform elastic, seed 1: fail")
    assert line.endswith("SimulationFailed: too steep by 2")
    with plain():
        axes = strips.audit(shared).axes[-1]
    assert [line.get_xdata().size for line in axes.lines if line.get_marker() == "o"] == [2, 3, 2]


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("[record]\nduration = 600.0\ndiscard = 60.0", "600 s analysed after 60 s, every task"),
        ("[axes.record]\nduration = [90, 60.0, 75.0]", "60 to 90 s analysed after 100 s"),
        ("[variants.usual]\n[variants.long]\nrecord.duration = 1e4", "3600 to 10000 s analysed after 100 s"),
        ("[axes.record]\nduration = [60.0]\ndiscard = [70.0]", "60 s analysed after 70 s, every task"),
        (
            "[[axes.together]]\nname = 'n'\nrecord.duration = [60.0, 90.0]\nrecord.discard = [70.0, 80.0]",
            "60 to 90 s analysed after 70 to 80 s",
        ),
    ],
)
def test_the_length_of_records_is_what_tasks_have(small, lines, words):
    small.write_text(small.read_text().replace("[sea_states", f"{lines}\n[sea_states", 1))
    assert dict(page.facts(figures.Results(study=load(small), data=dataset())))["Record"] == words


def along_of(small, axis, lines, **coordinates):
    """Results of a study that varies something more, three times as large at each label."""
    small.write_text(small.read_text().replace("[sea_states", f"{lines}\n[sea_states", 1))
    labels = coordinates.pop(axis)
    data = xr.concat([3.0**i * dataset()[["absorbed_power"]] for i in range(len(labels))], axis)
    return figures.Results(study=load(small), data=data.assign_coords({axis: labels, **coordinates}))


def test_seas_are_called_by_the_numbers_of_those_that_are_drawn(small):
    """Those of the labels that figures hold, also where that makes another sea the highest."""
    lines = "[variants.low]\nsea_states.calm.Hs = 3.0\n[variants.usual]"
    varied = along_of(small, "variant", lines, variant=["low", "usual"])
    data = varied.data.assign_coords(Hs=(("sea_state", "variant"), [[3.0, 0.5], [2.0, 2.0]]))
    of_variants = replace(varied, data=data)
    assert of_variants.sea_names == ["calm\n3.00 m, 5.00 s", "rough\n2.00 m, 7.00 s"]
    assert of_variants.sea == "calm"


def test_numbers_of_a_sea_that_keys_give_have_one_row_of_panels(small):
    lines = "[[axes.together]]\nname = 'scale'\nsea.Tp = [5.0, 6.0]\n'length [m]' = [1.0, 2.0]"
    beside = {"Tp": ("scale", [5.0, 6.0]), "length": ("scale", [1.0, 2.0]), "wave_period": ("scale", [5.0, 6.0])}
    varied = along_of(small, "scale", lines, scale=[1, 2], **beside)
    with plain():
        assert [axes.get_xlabel() for axes in along(varied, "scale").axes] == ["Tp", "length"]


def test_legs_are_drawn_with_the_first_labels_that_have_envelopes(small):
    """The frequency domain has none: those of marches are drawn, and said to be; none are where none has any."""
    lines = "[axes.solver]\nmethod = ['frequency', 'time']\nradiation = [true, false]"
    small.write_text(small.read_text().replace("[axes]", f"{lines}\n[axes]", 1))
    one = dataset()[["displacement_envelope", "stress_envelope", "rotation"]]
    parts = [[i * one.assign_coords(method=m, radiation=r) for i, r in ((1, "true"), (2, "false"))] for m in METHODS]
    data = xr.concat([xr.concat(row, "radiation") for row in parts], "method")
    names = ["displacement_envelope", "stress_envelope"]
    for name in names:
        data[name].loc[{"method": "frequency"}] = np.nan
        data[name].loc[{"method": "time", "radiation": "true", "sea_state": "rough"}] = np.nan
    both = figures.Results(study=load(small), data=data)
    assert both.first == {"method": "frequency", "radiation": "true", "pto_damping": 1e5} == both.first_of("rotation")
    with plain():
        lines = [line for line in envelopes.envelopes(both).axes[0].lines if len(line.get_xdata())]  # but the key's
    legs = one.displacement_envelope.sel(sea_state="rough", leg=1)
    for line, platform in zip(lines, ("elastic", "elastic-no-floats"), strict=True):
        assert line.get_xdata() == pytest.approx(2 * legs.sel(platform=platform).mean("seed").values)
    (caption,) = (words for title, words, _ in entries(both) if title == "Envelopes along the legs")
    assert caption.endswith("Shown at pto damping 100000; method time; radiation false.")
    # Each label has some, and the first ones have none together.
    data["rotation"].loc[{"method": "frequency", "radiation": "true"}] = np.nan
    data["rotation"].loc[{"method": "time", "radiation": "false"}] = np.nan
    assert both.first_of("rotation") == {**both.first, "radiation": "false"}
    for name in names:
        data[name].loc[{"sea_state": "rough"}] = np.nan
    assert "Envelopes along the legs" not in titles(replace(both, data=data))


def partly(small):
    """Of the first label every task has failed, of the highest sea the first realization of the other."""
    numbers = dataset()[["absorbed_power", "hinge_force", "stress_envelope", "wall_time"]]
    data = xr.concat([numbers.assign_coords(pto_damping=b) for b in (1e5, 2e5)], "pto_damping").copy(deep=True)
    for values in data.data_vars.values():
        values.loc[{"sea_state": "rough", "seed": 1}] = values.sel(sea_state="rough", seed=0)
        values.loc[{"sea_state": "rough", "seed": 0}] = np.nan
        values.loc[{"pto_damping": 1e5}] = np.nan
    small.write_text(small.read_text().replace("seed", "pto_damping = [1e5, 2e5]\nseed", 1))
    return figures.Results(study=load(small), data=data.assign(task=data.wall_time.astype(str)))


def test_figures_are_of_labels_that_have_numbers(small):
    """Where the first label's tasks failed they hold the next, and say so; a figure of nothing is none."""
    there = partly(small)
    captions = {figure["title"]: figure["caption"] for figure in page.drawn(there)}
    shown = [title for title in captions if title not in ("Scene", "What the runs say of themselves")]
    assert shown == [
        "Envelopes along the legs",
        "Power in each sea state at pto damping 200000",
        "Along pto damping",
        "Extremes of the hinge force",
    ]
    assert sum("Shown at pto damping 200000." in caption for caption in captions.values()) == 3
    with plain():
        dots = [line for line in strips.hinge_forces(there).axes[0].lines if line.get_marker() == "o"]
    assert sum(line.get_xdata().size for line in dots) == 12  # three realizations on two platforms, least and largest
    elsewhere = there.data.absorbed_power.sel(pto_damping=[2e5]).assign_coords(pto_damping=[1e5])
    turned = replace(there, data=there.data.assign(rotation=elsewhere.reindex(pto_damping=[1e5, 2e5])))
    with plain():
        assert len(figures.sea_states(turned).axes) == 1 and len(along(turned, "pto_damping").axes) == 2
    assert "Power in each sea state at pto damping 200000" in titles(turned)
    nothing = replace(there, data=there.data.where(there.data.pto_damping == 0.0))
    with plain():
        assert [draw(nothing) for draw in (figures.sea_states, strips.hinge_forces)] == [None, None]
        assert along(nothing, "pto_damping") is None


def test_the_sea_shown_is_the_highest_with_numbers(small, tmp_path):
    """Not one that was not run or failed throughout, even if published numbers are for it."""
    there = partly(small)
    assert there.sea == "rough"
    calm = replace(there, data=there.data.where(there.data.sea_state == "calm"))
    assert calm.sea == "calm" and calm.first == {"pto_damping": 2e5}
    (tmp_path / "p.csv").write_text(PUBLISHED)
    assert replace(calm, published=read_published(tmp_path / "p.csv")).sea == "calm"
    none = replace(there, data=there.data.where(there.data.pto_damping == 0.0))
    assert (none.sea, none.first) == ("rough", {"pto_damping": 1e5})
    assert none.first_of("hinge_force", pto_damping=2e5) == {"pto_damping": 2e5}


def test_labels_follow_the_sea_that_is_shown(small):
    """A label that came to numbers in another sea alone is passed over."""
    there = partly(small)
    for values in there.data.drop_vars("task").data_vars.values():
        values.loc[{"pto_damping": 1e5, "sea_state": "calm"}] = values.sel(pto_damping=2e5, sea_state="calm")
    assert there.first == {"pto_damping": 2e5} == there.first_of("hinge_force")
    assert there.first_of("hinge_force", sea_state="calm") == {"pto_damping": 1e5}
    assert there.first_of("hinge_force", sea_state="calm", pto_damping=2e5) == {"pto_damping": 2e5}


def test_words_that_have_no_room_are_counted(small):
    """Beyond those a figure has room for, of rows alone."""
    words = [f"v{i}" for i in range(30)]
    variants = "".join(f"[variants.{word}]\n" for word in words)
    many = along_of(small, "variant", variants, variant=words)
    captions = {title: caption for title, caption, _ in entries(many)}
    assert captions["Along variant"].endswith(" The first 24 of 30.")
    with plain():
        assert len(along(many, "variant").axes[0].get_yticks()) == figures.ROOM
    few = replace(many, data=many.data.isel(variant=slice(24)))
    assert not any("The first" in caption for _, caption, _ in entries(few))
    beyond = replace(many, data=many.data.where(many.data.variant == "v29"))
    assert along(beyond, "variant") is None


def test_an_axis_of_words_has_its_own_figure(small, tmp_path):
    """A row for each variant, and in it the mean over the realizations there are; none where there are none."""
    lines = "[variants.usual]\n[variants.deep]\nwater.depth = 60.0\n[variants.deeper]\nwater.depth = 70.0"
    varied = along_of(small, "variant", lines, variant=["usual", "deep", "deeper"])
    varied.data.absorbed_power.loc[{"variant": "deeper", "platform": "fixed"}] = np.nan
    assert "Along variant" in titles(varied)
    with plain():
        (axes,) = along(varied, "variant").axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["usual", "deep", "deeper"]
    dots = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "o"]
    assert [round(y) for _, y in dots] == [0, 1, 2, 0, 1]
    usual = varied.data.absorbed_power.sel(sea_state="rough", statistic="mean", float="front", platform="elastic")
    assert [x for x, _ in dots[:3]] == pytest.approx(usual.mean("seed") / 1e3)
    (tmp_path / "p.csv").write_text(PUBLISHED)
    known = figures.Results(study=varied.study, data=varied.data, published=read_published(tmp_path / "p.csv"))
    with plain():
        (axes,) = along(known, "variant").axes
    ((cross,),) = (line.get_xydata() for line in axes.lines if line.get_marker() == "x")
    assert cross[0] == 8.0 and round(cross[1]) == 0


@pytest.mark.parametrize("labels", [["US$ % a", "AU$ % b"], [1.0, 1e2, 1e4]])
@pytest.mark.parametrize("draw", [svg, partial(rendered, form="png")])
def test_texts_of_users_are_drawn_as_they_are(results, labels, draw):
    """Two $ hold no formula, which might be none; powers of ten along an axis are one."""
    name = "US$ % of AU$"
    labels = [f"{label} $ {label}" for label in labels] if isinstance(labels[0], str) else labels
    data = xr.concat([dataset().assign_coords({name: label}) for label in labels], name)
    varied = figures.Results(study=results.study, data=data)
    with plain():
        figure = along(varied, name)
        draw(figure)
    axes = figure.axes[0]
    powers = [text.get_parse_math() for text in axes.get_xticklabels()]
    assert set(powers) == {axes.get_xscale() == "log"}
    assert not any(text.get_parse_math() for text in (axes.xaxis.label, *axes.get_yticklabels()))


def test_numbers_that_go_with_an_axis_stand_along_it(small):
    """Paired values are drawn over their own numbers, in order; samples over each key's, without a line."""
    lines = "[[axes.together]]\nname = 'arm'\nlength = [3.0, 2.0]\nwater.depth = [50.0, 60.0]"
    paired = along_of(small, "arm", lines, arm=[1, 2], length=("arm", [3.0, 2.0]), words=("arm", ["a", "b"]))
    with plain():
        (axes,) = along(paired, "arm").axes
    assert axes.get_xlabel() == "length" and axes.lines[0].get_xdata().tolist() == [2.0, 3.0]
    assert axes.lines[0].get_linestyle() == "-"
    sampled = xr.concat([paired.data.isel(arm=0, drop=True)] * 2, "sample").drop_vars(
        ["length", "words"], errors="ignore"
    )
    sampled = sampled.assign_coords(sample=[0, 1], mass=("sample", [5.0, 4.0]), depth=("sample", [7.0, 8.0]))
    sampled.mass.attrs["units"] = "kg"
    small.write_text(SMALL + "[samples]\ncount = 2\nfloats.front.mass = { from = 2000.0, to = 2200.0 }\n")
    with plain():
        every = along(figures.Results(study=load(small), data=sampled), "sample").axes
    assert [axes.get_xlabel() for axes in every] == ["mass [kg]", "depth"]
    assert {line.get_linestyle() for axes in every for line in axes.lines} == {"None"}


@pytest.mark.usefixtures("undrawn")
def test_it_is_said_at_what_the_other_axes_are_held(small, tmp_path):
    """In captions of figures along one of them, and at the published table unless it names them."""
    lines = "[axes.water]\ndepth = [inf, 60.0]\n[variants.usual]\n[variants.deep]\nwater.density = 1000.0"
    varied = along_of(small, "depth", lines, depth=[np.inf, 60.0])
    data = xr.concat([varied.data] * 2, "variant").assign_coords(variant=["usual", "deep"], pto_damping=1e5)
    both = replace(varied, data=data)
    captions = {title: caption.partition("Shown at ")[2] for title, caption, _ in entries(both)}
    assert "Power in each sea state at variant usual, depth inf" in captions
    assert captions["Along depth at variant usual"] == "pto damping 100000; variant usual."
    assert captions["Along variant at depth inf"] == "pto damping 100000; depth inf."
    (tmp_path / "p.csv").write_text(PUBLISHED.replace(",sea_state", ",depth=60.0;sea_state"))
    whole = {title: caption for title, caption, _ in entries(both)}
    assert whole["Along depth at variant usual"].startswith("Each sea state, mean")
    assert whole["Along variant at depth inf"].startswith("Sea state rough, mean")
    text = page.html(replace(both, published=read_published(tmp_path / "p.csv")))
    assert "below each table. Shown at pto damping 100000; variant usual.</p>" in text


@pytest.mark.parametrize(
    ("kept", "title"),
    [
        (["absorbed_power"], "Power in each sea state"),
        (["rotation"], "Rotation in each sea state"),
        (["absorbed_power", "rotation"], "Power and rotation in each sea state"),
    ],
)
def test_titles_name_what_is_drawn(results, kept, title):
    assert title in titles(replace(results, data=results.data[kept]))


def test_infinity_has_its_place_along_an_axis(small):
    """Beside the largest number, with its tick: a scale would leave it out."""
    varied = along_of(small, "depth", "[axes.water]\ndepth = [inf, 60.0, 50.0]", depth=[np.inf, 60.0, 50.0])
    varied = replace(varied, data=varied.data.sel(sea_state=["rough"]))
    with plain():
        (axes,) = along(varied, "depth").axes
    mean = varied.data.absorbed_power.sel(sea_state="rough", platform="elastic", statistic="mean", float="front")
    means = mean.mean("seed").values / 1e3
    np.testing.assert_allclose(axes.lines[0].get_xydata(), np.column_stack([[0, 1, 2], means[::-1]]))
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["50", "60", "inf"]
    assert axes.get_xlabel() == "depth"


def test_envelopes_average_what_is_there(results):
    heights, rows = envelopes.profile(results, "stress_envelope", "elastic", [1])
    expected = results.data.stress_envelope.sel(sea_state="rough", platform="elastic", seed=0, leg=1)
    np.testing.assert_array_equal(heights, HEIGHTS)
    np.testing.assert_array_equal(rows, expected.values[:, None])


def test_of_legs_drawn_as_one_the_largest_counts(results):
    """Wherever it is: their mean would say less than one of them bears."""
    one = results.data[["stress_envelope"]]
    other = one.assign_coords(leg=[2]) * xr.DataArray([0.5, 2.0, 0.5], dims="height")
    both = figures.Results(study=results.study, data=xr.concat([one, other], "leg"))
    _, rows = envelopes.profile(both, "stress_envelope", "elastic", [1, 2])
    _, alone = envelopes.profile(both, "stress_envelope", "elastic", [1])
    np.testing.assert_allclose(rows, alone * np.array([[1.0], [2.0], [1.0]]))


def test_a_platform_without_floats_is_not_said_to_have_some(small):
    """Alone there is nothing to tell it from; beside one with floats it has its name."""
    bare = dataset().drop_vars(["absorbed_power", "rotation", "hinge_force"])
    told = [
        names_of_lines(envelopes.envelopes(figures.Results(study=load(small), data=data)).axes[0])
        for data in (bare.drop_vars("float").sel(platform=["elastic"]), bare.drop_vars("float"), bare)
    ]
    assert told == [["legs"], ["legs"], ["legs", "with floats", "no floats"]]


def names_of_lines(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_envelopes_are_of_a_label_at_which_most_platforms_have_numbers(small):
    """Where the first one's runs with floats failed in the sea that is shown, those without would stand alone."""
    small.write_text(small.read_text().replace("seed", "pto_damping = [1e5, 2e5]\nseed", 1))
    one = dataset()[["displacement_envelope", "stress_envelope", "wall_time"]]
    data = xr.concat([one.assign_coords(pto_damping=b) for b in (1e5, 2e5)], "pto_damping").copy(deep=True)
    for name in ("displacement_envelope", "stress_envelope"):
        data[name].loc[{"pto_damping": 1e5, "sea_state": "rough", "platform": "elastic"}] = np.nan
    some = figures.Results(study=load(small), data=data)
    assert some.first_of("stress_envelope") == {"pto_damping": 2e5} and some.first == {"pto_damping": 1e5}
    with plain():
        panel = envelopes.envelopes(some).axes[0]
    assert [line.get_linestyle() for line in panel.lines] == ["-", "--"]


def test_a_leg_is_drawn_at_its_own_heights(results):
    """Another leg has its nodes at other heights, and no numbers at these."""
    other = results.data[["stress_envelope"]].assign_coords(leg=[2], height=[0.0, 16.3, 32.6])
    both = xr.merge([results.data, other], join="outer", compat="no_conflicts")
    uneven = figures.Results(study=results.study, data=both)
    assert both.height.size == 5
    for leg, expected in ((1, HEIGHTS), (2, [0.0, 16.3, 32.6])):
        heights, rows = envelopes.profile(uneven, "stress_envelope", "elastic", [leg])
        assert heights.tolist() == list(expected) and np.isfinite(rows).all() and rows.shape == (3, 1)
    assert "Envelopes along the legs" in titles(uneven)


@pytest.mark.parametrize(
    ("failed", "seas", "axis", "words", "legs"),
    [
        ({}, False, False, False, False),
        ({"sea_state": "rough", "pto_damping": 1e5, "seed": 1}, True, True, True, True),
        ({"sea_state": "rough", "pto_damping": 1e5}, False, False, False, False),  # there is no mean of any
        ({"sea_state": "rough", "pto_damping": 2e5, "seed": 0}, False, True, True, False),
        ({"sea_state": "calm", "pto_damping": 1e5, "seed": 1}, True, True, False, False),
    ],
)
def test_captions_say_where_a_mean_that_is_drawn_is_of_survivors(results, failed, seas, axis, words, legs):
    """Of numbers both sea states are drawn along an axis, of words the high one alone."""
    one = dataset()
    one = one.where(one.status != "failed", one.sel(seed=0)).assign(task=one.task)
    data = xr.concat([one.assign_coords(pto_damping=b) for b in (1e5, 2e5)], "pto_damping")
    data = data.assign(task=(data.status.dims, np.arange(data.status.size).reshape(data.status.shape).astype(str)))
    if failed:
        data["status"].loc[failed | {"platform": "elastic"}] = "failed"
        ran = data.status != "failed"
        data = data.assign({name: of.where(ran) for name, of in data.data_vars.items() if of.dtype.kind == "f"})
    varied = replace(results, data=data)
    told = {title.partition(" at ")[0]: SURVIVORS in caption for title, caption, _ in entries(varied)}
    titles = "Power and rotation in each sea state", "Along pto damping", "Envelopes along the legs"
    assert [told.pop(title) for title in titles] == [seas, axis, legs] and not any(told.values())
    named = replace(varied, data=data.assign_coords(pto_damping=["a", "b"]))
    (caption,) = (words for title, words, _ in entries(named) if title == "Along pto damping")
    assert (SURVIVORS in caption) == words


def test_dots_stand_at_the_numbers(results):
    """Shown in kW: the mean of the calm sea's two realizations."""
    with plain():
        axes = figures.sea_states(results).axes[0]
    shown = [line.get_xdata()[0] for line in axes.lines if line.get_marker() == "o"]
    calm = results.data.absorbed_power.sel(sea_state="calm", platform="elastic", statistic="mean").mean() / 1e3
    assert np.isclose(shown, float(calm), rtol=1e-12).any()


def test_a_force_that_is_zero_is_not_shown(results):
    assert strips.directions(results) == ["x", "z"]
    still = results.data.assign(hinge_force=0.0 * results.data.hinge_force)
    assert strips.hinge_forces(figures.Results(study=results.study, data=still)) is None


def test_a_force_that_is_rounding_beside_the_floats_weight_is_not_shown(results):
    still = results.data.assign(hinge_force=1e-6 * results.data.hinge_force)
    assert strips.hinge_forces(replace(results, data=still)) is None


def test_what_slides_is_measured_and_power_that_is_zero_throughout_is_not(results):
    """Along axes that most floats have first, in as many panels as there is room for; not what rounding alone moves."""
    axes = ["surge", "hinge", "heave", "sway", "pitch", "roll"]
    motion = results.data.rotation.expand_dims({"axis": axes}) * xr.DataArray([1, 1, 2, 1e-9, 1, 1], dims="axis")
    motion = xr.concat([motion, motion.where(motion.axis == "heave").assign_coords(float=["rear"])], "float")
    data = results.data.assign(absorbed_power=0.0 * results.data.absorbed_power).reindex(float=["front", "rear"])
    sliding = replace(results, data=data.assign(motion=motion))
    names = ["rotation", "heave", "surge", "pitch", "roll"]
    assert [quantity.name for quantity in sliding.measures] == names
    with plain():
        panels = figures.sea_states(sliding).axes
        assert along(replace(sliding, data=xr.concat([sliding.data] * 2, "size").assign_coords(size=[1, 2])), "size")
    units = ["[rad]", "[m]", "[m]", "[rad]"]
    assert [axes.get_xlabel() for axes in panels] == [f"RMS {n} {u}" for n, u in zip(names, units, strict=False)]
    dot = next(line for line in panels[1].lines if line.get_marker() == "o")
    calm = motion.sel(sea_state="calm", platform="elastic", float="front", axis="heave", statistic="rms")
    assert dot.get_xdata() == pytest.approx(calm.mean("seed").item())
    captions = {title: caption for title, caption, _ in entries(sliding)}
    assert "The first 4 of 5 quantities." in captions["Rotation, heave, surge and pitch in each sea state"]


def test_a_force_that_others_than_the_shown_tasks_have_is_not_shown(small):
    """Their rounding would fill a panel."""
    lines = "[variants.ahead]\n[variants.across]\nwaves.heading = 1.0"
    varied = along_of(small, "variant", lines, variant=["ahead", "across"])
    force = dataset().hinge_force
    data = varied.data.assign(hinge_force=xr.concat([force, force], varied.data.variant))
    data["hinge_force"].loc[{"variant": "across", "direction": "y"}] = 1.0
    assert strips.directions(replace(varied, data=data)) == ["x", "z"]


def test_published_numbers_choose_the_sea_state(results, tmp_path):
    path = tmp_path / "p.csv"
    path.write_text(f"{','.join(COLUMNS)}\nT,p,absorbed_power,sea_state=calm;platform=fixed;float=front,mean,2,kW,\n")
    known = figures.Results(study=results.study, data=results.data, published=read_published(path))
    assert (results.sea, known.sea) == ("rough", "calm")
    assert known.theirs("absorbed_power", "mean", sea_state="calm", platform="fixed", float="front") == 2e3
    assert known.theirs("absorbed_power", "mean", sea_state="rough", platform="fixed", float="front") is None


def test_published_numbers_are_spoken_of_where_they_are_drawn(results, tmp_path):
    """A study that stands on another has its published numbers and, maybe, none of their labels."""
    path = tmp_path / "p.csv"
    for sea in ("rough", "another"):
        path.write_text(PUBLISHED.replace("rough", sea))
        known = replace(results, published=read_published(path))
        captions = {figure["title"]: figure["caption"] for figure in page.drawn(known)}
        assert [title for title, words in captions.items() if words.endswith(" Crosses: published.")] == (
            ["Power and rotation in each sea state"] if sea == "rough" else []
        )
        for make in (figures.sea_states, overview.overview):
            with plain():
                (legend,) = make(known).legends
            assert ("published" in [text.get_text() for text in legend.get_texts()]) == (sea == "rough")


def test_legs_are_grouped_from_the_weather_side(study_of, buan_tables):
    data = xr.Dataset(coords={"leg": [1, 2, 3, 4]})
    buan = figures.Results(study=study_of(buan_tables), data=data)
    assert envelopes.leg_groups(buan) == {"front legs": [1, 2], "rear legs": [3, 4]}


def test_legs_of_unlike_height_are_not_averaged(study_of, buan_tables):
    """Feet of the second and fourth leg 20 m higher: at each x a long and a short one."""
    for foot in ("foot2", "foot4"):
        buan_tables["platform"]["nodes"][foot][2] += 20.0
    buan = figures.Results(study=study_of(buan_tables), data=xr.Dataset(coords={"leg": [1, 2, 3, 4]}))
    assert list(envelopes.leg_groups(buan).values()) == [[2], [1], [4], [3]]
    assert next(iter(envelopes.leg_groups(buan))) == "leg 2 (foot at x = -1.5 m), 32.6 m high"


def test_legs_are_called_by_their_feet(study_of, buan_tables):
    """Battered ones have another x at each height."""
    buan_tables["platform"]["nodes"]["foot3"][0] = 8.0
    buan = figures.Results(study=study_of(buan_tables), data=xr.Dataset(coords={"leg": [1, 2, 3, 4]}))
    assert list(envelopes.leg_groups(buan)) == [
        "legs 1, 2 (feet at x = -1.5 m)",
        "leg 4 (foot at x = 1.5 m)",
        "leg 3 (foot at x = 8 m)",
    ]


def test_the_scene_is_to_scale(results):
    """A hemisphere of radius 1 m at (-3.86, 0) m, and a leg of 1 m diameter from the seabed to its hinge."""
    study = results.study.content
    x, z = np.array(sketch.float_outline(study.floats[0])).T
    assert (x.min(), x.max()) == pytest.approx((-4.86, -2.86), abs=1e-12)
    assert (z.min(), z.max()) == pytest.approx((-1.0, 0.6), abs=1e-12)
    (leg,) = sketch.members(sketch.first_scene(study))
    x, z = np.array(leg).T
    assert (x.min(), x.max(), z.min(), z.max()) == pytest.approx((-2.0, -1.0, -50.0, 2.6), abs=1e-12)
    with plain():
        figure = sketch.side_view(study)
    assert {axes.get_aspect() for axes in figure.axes} == {1.0}


def test_the_scene_of_a_model_is_that_of_full_scale(study_of, buan_tables):
    tables = {key: buan_tables[key] for key in ("water", "waves", "sea_states")}
    limits = []
    for scale in (1.0, 0.05):
        tables["water"] = {"depth": 30.0 * scale}
        first = buan_tables["floats"][0]
        hull = {name: size if name == "shape" else scale * size for name, size in first["hull"].items()}
        sizes = {name: [scale * x for x in first[name]] for name in ("hinge", "arm")}
        tables["floats"] = [{**first, "hull": hull, **sizes}]
        with plain():
            (axes,) = sketch.side_view(study_of(tables).content).axes
        limits.append(np.array([axes.get_xlim(), axes.get_ylim()]) / scale)
    np.testing.assert_allclose(*limits, rtol=1e-9)


def test_the_scene_is_the_first_tasks_and_both_of_platform_and_floats(study_of, buan_tables):
    """At its distance of the hinges, without what is left out."""
    buan_tables["left_out"] = ["rear"]
    buan_tables["axes"] |= {"platform": ["fixed", "elastic"], "hinge_spacing": [8.0, 5.0]}
    content = study_of(buan_tables).content
    with plain():
        close = sketch.side_view(content).axes[1]
        data = xr.Dataset(coords={"sea_state": ["2017"], "Hs": ("sea_state", [1.39])})
        whole = overview.overview(figures.Results(study=study_of(buan_tables), data=data)).axes[0]
    for axes in (close, whole):
        assert [line.get_xdata().item() for line in axes.lines if line.get_marker() == "o"] == [-4.0]
        assert {"front", "rear"} & {text.get_text() for text in axes.texts} == {"front"}


@pytest.mark.filterwarnings("error")
def test_a_platform_that_hangs_far_above_the_seabed_has_room(results):
    """Where the seabed is written far below the axes, they have none left."""
    study = results.study.content
    deep = study.model_copy(update={"water": study.water.model_copy(update={"depth": 500.0})})
    with plain():
        figure = sketch.side_view(deep)
        assert svg(figure)
    assert all(axes.get_position().height > 0.5 for axes in figure.axes)


@pytest.mark.parametrize("hull", ["sphere", "vertical-cylinder"])
@pytest.mark.parametrize("heading", [0.0, 1.5707963, 3.14])
def test_floats_without_a_platform(study_of, buan_tables, hull, heading):
    sizes = {"draft": 0.8} | ({"freeboard": 0.4} if hull == "vertical-cylinder" else {})
    tables = {key: buan_tables[key] for key in ("water", "waves", "sea_states")}
    tables["waves"]["heading"] = heading
    tables["floats"] = [buan_tables["floats"][0] | {"hull": {"shape": hull, "radius": 1.0} | sizes}]
    study = study_of(tables).content
    with plain():
        (axes,) = sketch.side_view(study).axes
    assert ("waves" in [text.get_text() for text in axes.texts]) == (heading != 1.5707963)


@pytest.mark.parametrize("heading", [0.0, 0.5236])
def test_floats_behind_one_another_share_their_names_place_and_a_heading_is_told(study_of, buan_tables, heading):
    front, rear = buan_tables["floats"]
    x, y, z = front["hinge"]
    buan_tables["floats"] = [front, front | {"name": "behind", "hinge": [x, y + 4.0, z]}, rear]
    buan_tables["waves"]["heading"] = heading
    tables = {key: buan_tables[key] for key in ("water", "waves", "sea_states", "floats")}
    with plain():
        (axes,) = sketch.side_view(study_of(tables).content).axes
    words = [text.get_text() for text in axes.texts]
    assert {"front, behind", "rear", "waves"} < {*words} and not {"front", "behind"} & {*words}
    assert [text for text in words if "heading" in text] == ["heading 0.5236 rad"] * bool(heading)


@pytest.mark.usefixtures("undrawn")
def test_a_scene_of_nothing_is_not_drawn(results):
    nothing = results.study.content.model_copy(update={"floats": (), "platform": None})
    assert sketch.side_view(nothing) is None
    assert (
        titles(figures.Results(study=Study(path=results.study.path, content=nothing), data=results.data))[0] != "Scene"
    )


def test_the_same_figure_has_the_same_bytes(results):
    with plain():
        assert svg(strips.audit(results)) == svg(strips.audit(results))


@pytest.mark.parametrize(
    ("heights", "periods", "told"),
    [
        ({"Hs": [0.5, 2.0]}, {"Tp": [5.0, 7.0]}, " Sea states with Hs, Tp."),
        ({"wave_height": [0.5, 1.0]}, {"wave_period": [5.0, 7.0]}, " Regular waves with height, period."),
        ({"Hs": [0.5, np.nan], "wave_height": [np.nan, 1.0]}, {"Tp": [5.0, np.nan], "wave_period": [np.nan, 7.0]},
         " Sea states with Hs, Tp. Regular waves with height, period."),
        ({"Hs": [0.5, 2.0]}, {}, ""),  # white noise
    ],
)  # fmt: skip
def test_a_caption_says_what_the_numbers_beside_sea_states_are(results, heights, periods, told):
    numbers = {name: ("sea_state", values) for name, values in (heights | periods).items()}
    data = results.data.drop_vars(["Hs", "Tp"]).assign_coords(numbers)
    (caption,) = (words for title, words, _ in entries(replace(results, data=data)) if "in each sea state" in title)
    assert (
        caption == "Dots: mean over realizations; bars: least and largest. Filled: elastic platform; open: fixed."
        f"{figures.RINGED}{SURVIVORS}{told}"
    )


def test_a_caption_tells_of_platforms_that_are_drawn(results):
    """Without floats there is neither power nor rotation, and of one platform all marks are filled."""
    for platforms, told in ((["elastic", "fixed"], True), (["fixed", "elastic-no-floats"], False)):
        some = replace(results, data=results.data.sel(platform=platforms))
        captions = {title: caption for title, caption, _ in entries(some)}
        assert ("Filled: elastic" in captions["Power and rotation in each sea state"]) == told


def test_words_that_go_with_numbers_stand_in_rows(results):
    """As of a method and a pressure that are changed together: labels count them. With numbers beside it is these."""
    data = xr.concat([dataset().assign_coords(together=b) for b in (1, 2)], "together")
    data = data.assign_coords({"solver.method": ("together", ["time", "frequency"])})
    with plain():
        axes = along(replace(results, data=data), "together").axes[0]
        assert [text.get_text() for text in axes.get_yticklabels()] == ["time", "frequency"]
        data = data.assign_coords(draft=("together", [1.0, 2.0]))
        assert along(replace(results, data=data), "together").axes[0].get_xlabel() == "draft"
        named = data.drop_vars(["solver.method", "draft"]).rename(together="variant")
        named = named.assign_coords(variant=["a", "b"], variant_title=("variant", ["Light", "Heavy"]))
        axes = along(replace(results, data=named), "variant").axes[0]
        assert [text.get_text() for text in axes.get_yticklabels()] == ["a", "b"]


def test_a_long_scatter_table_is_cut(results):
    many = xr.concat([results.data.isel(sea_state=0)] * 30, "sea_state").assign_coords(
        sea_state=[f"s{i}" for i in range(30)], Hs=("sea_state", np.ones(30)), Tp=("sea_state", np.full(30, 5.0))
    )
    long = figures.Results(study=results.study, data=many)
    with plain():
        assert len(figures.sea_states(long).axes[0].get_yticks()) == figures.ROOM


def test_responses_stand_beside_the_frequency_domains(results):
    """Lines of the record, dashed ones of theory over them; a component that hardly responds is left out."""
    assert responses(results) is None
    omega, bands = np.linspace(0.5, 2.0, 6), ("frequency_band",)
    size = np.array([1.0, 0.5, 0.01])[:, None] * np.linspace(2.0, 1.0, 6)
    cells = np.ones((2, 3, 2, 2))
    dims = ("sea_state", "platform", "seed", "method", "float", "direction", *bands)
    waves = cells[..., None] * np.array([1e-9, 1.0, 2.0, 1.0, 0.5, 1e-9])
    added = {
        "hinge_force_response": (dims, cells[..., None, None, None] * size[None], {"units": "N m-1"}),
        "hinge_force_coherence": (dims, cells[..., None, None, None] * np.ones((1, 3, 6))),
        "wave_elevation_spectrum": ((*dims[:4], *bands), waves),
        "band_frequency": ((*dims[:4], *bands), cells[..., None] * omega),
    }
    data = results.data.expand_dims(method=["time", "frequency"]).assign(added)
    both = replace(results, data=data)
    figure = responses(both)
    upper, lower = figure.axes
    assert [line.get_label() for line in upper.lines[:2]] == ["front, x", "front, y"]
    assert [line.get_linestyle() for line in upper.lines] == ["-", "-", "--", "--"]
    rendered(figure, "png")
    names = upper.get_legend().get_window_extent()
    assert names.y0 > max(upper.transData.transform(line.get_xydata())[:, 1].max() for line in upper.lines)
    assert upper.lines[0].get_xdata() == pytest.approx(omega[1:5]) and upper.get_title() == "hinge force [N m-1]"
    assert upper.lines[1].get_ydata() == pytest.approx(size[1, 1:5]) and lower.get_ylabel() == "coherence"
    none = data.hinge_force_response.where(data.method == "time")
    for of, told in ((both, True), (replace(both, data=data.isel(method=[0])), False), (results, False),
                     (replace(both, data=data.assign(hinge_force_response=none)), False)):  # fmt: skip
        captions = {title: caption for title, caption, _ in entries(of)}
        assert ("Dashed: the frequency domain." in captions["Response to the waves"]) == told
    alone = data.hinge_force_response.where(data.method == "frequency")
    upper, _ = responses(replace(both, data=data.assign(hinge_force_response=alone))).axes
    assert [(line.get_label(), line.get_linestyle()) for line in upper.lines] == [("front, x", "-"), ("front, y", "-")]


def test_responses_are_shown_where_records_have_them(results, small):
    """Not at the first label, where of two methods the frequency domain alone has numbers."""
    small.write_text(
        small.read_text().replace("seed", "pto_damping = [1e5, 2e5]\n'solver.method' = ['time', 'frequency']\nseed", 1)
    )
    dims, size = ("pto_damping", "method", "sea_state", "seed", "float", "frequency_band"), np.ones((2, 2, 2, 2, 1, 4))
    size[0, 0] = np.nan
    added = {
        "rotation_response": (dims, size),
        "rotation_coherence": (dims, size),
        "wave_elevation_spectrum": ((*dims[:4], "frequency_band"), size[..., 0, :]),
        "band_frequency": ((*dims[:4], "frequency_band"), np.arange(1.0, 5.0) * size[..., 0, :]),
    }
    data = results.data[["status"]].drop_vars("pto_damping")
    labels = {"float": ["front"], "pto_damping": [1e5, 2e5], "method": ["time", "frequency"]}
    failed = figures.Results(study=load(small), data=data.assign_coords(labels).assign(added))
    upper, _ = responses(failed).axes
    assert [line.get_linestyle() for line in upper.lines] == ["-", "--"]
    (caption,) = (words for title, words, _ in entries(failed) if title == "Response to the waves")
    assert caption.endswith("Dashed: the frequency domain. Shown at pto damping 200000.")
    together = "[[axes.together]]\nname = 'method'\n'solver.method' = ['time', 'frequency']\n"
    together += "'solver.radiation' = [true, false]\n"
    text = small.read_text().replace("'solver.method' = ['time', 'frequency']\n", "")
    small.write_text(text.replace("[sea_states", together + "[sea_states", 1))
    every = failed.data.assign({name: failed.data[name].fillna(1.0) for name in added}).assign_coords(method=[1, 2])
    counted = figures.Results(study=load(small), data=every)
    assert len(responses(counted).axes[0].lines) == 1


def test_a_float_without_numbers_leaves_the_others_their_lines(results):
    """A carrier has no rotation; of what has no number at the labels shown there is no panel, and no figure."""
    dims, size = ("sea_state", "platform", "seed", "float", "frequency_band"), np.ones((2, 3, 2, 2, 4))
    size[..., 0, :] = np.nan
    added = {
        "rotation_response": (dims, size),
        "rotation_coherence": (dims, size),
        "motion_response": (dims, np.where(np.arange(2)[:, None, None, None, None] == 0, size, np.nan)),
        "wave_elevation_spectrum": (("sea_state", "frequency_band"), np.ones((2, 4))),
        "band_frequency": (("frequency_band",), np.linspace(0.5, 2.0, 4)),
    }
    bare = results.data[["status"]].assign_coords(float=["carrier", "front"])
    figure = responses(replace(results, data=bare.assign(added)))
    upper, _ = figure.axes
    assert [line.get_label() for line in upper.lines] == ["front"]
    assert responses(replace(results, data=bare.assign(added).drop_vars("rotation_response"))) is None


def test_what_slides_and_what_turns_have_panels_of_their_own(results):
    """However small a rotation's number is beside a translation's."""
    dims, size = ("sea_state", "float", "axis", "frequency_band"), np.ones((2, 2, 3, 4))
    size[:, :, 1] = 0.02
    added = {
        "motion_response": (dims, size),
        "motion_coherence": (dims, np.ones(size.shape)),
        "wave_elevation_spectrum": (("sea_state", "frequency_band"), np.ones((2, 4))),
        "band_frequency": (("frequency_band",), np.linspace(0.5, 2.0, 4)),
    }
    bare = results.data[["status"]].assign_coords(float=["front", "rear"], axis=["surge", "pitch", "heave"])
    figure = responses(replace(results, data=bare.assign(added)))
    titles = {axes.get_title(): [line.get_label() for line in axes.lines] for axes in figure.axes[:2]}
    assert titles == {
        "motion [m m-1]": [f"{name}, {axis}" for name in ("front", "rear") for axis in ("surge", "heave")],
        "motion [rad m-1]": ["front, pitch", "rear, pitch"],
    }


def of_bands(results, regular, **more):
    """Responses of two seas; the regular ones have waves in one band alone."""
    dims, size = ("sea_state", "seed", "float", "frequency_band"), np.ones((2, 2, 1, 4))
    bands = np.array([[0.0, 1.0, 0.0, 0.0] if sea in regular else [1.0] * 4 for sea in ("calm", "rough")])
    size[:, 0] = np.nan  # it failed
    added = {
        "rotation_response": (dims, size),
        "rotation_coherence": (dims, size),
        "wave_elevation_spectrum": (("sea_state", "seed", "frequency_band"), bands[:, None] * size[:, :, 0]),
        "band_frequency": (("sea_state", "seed", "frequency_band"), np.arange(1.0, 5.0) * size[:, :, 0]),
    }
    return replace(results, data=results.data[["status"]].assign_coords(float=["front"]).assign(added | more))


@pytest.mark.parametrize(
    ("regular", "shown", "points", "mark"),
    [
        ((), "rough", 4, "None"),
        (("rough",), "calm", 4, "None"),
        (("calm",), "rough", 4, "None"),
        (("calm", "rough"), "rough", 1, "o"),
    ],
)
def test_responses_are_of_a_sea_with_several_bands(results, regular, shown, points, mark):
    """Where none has several there is a dot; of the realization that has numbers."""
    waves = of_bands(results, regular)
    with plain():
        upper, _ = responses(waves).axes
    (line,) = upper.lines
    assert line.get_xdata().size == points and line.get_marker() == mark and np.isfinite(line.get_xydata()).all()
    assert upper.get_ylim()[1] == pytest.approx(1.15)
    (caption,) = (words for title, words, _ in entries(waves) if title == "Response to the waves")
    assert f"sea state {shown}, first realization there is." in caption


def test_what_turns_about_a_hinge_is_drawn_once(results):
    """A motion along the hinge's axis is the rotation: forces that were asked for have the room."""
    dims = ("sea_state", "seed", "float", "axis", "frequency_band")
    names = [f"{name}_{kind}" for name in ("motion", "pto_force") for kind in ("response", "coherence")]
    turning = of_bands(results, (), **{name: (dims, np.ones((2, 2, 1, 1, 4))) for name in names})
    figure = responses(replace(turning, data=turning.data.assign_coords(axis=["hinge"])))
    assert [axes.get_title() for axes in figure.axes[:2]] == ["motion [rad m-1]", "pto force [N m m-1]"]


def test_responses_that_hide_one_another_have_one_name(results):
    waves = of_bands(results, ())
    both = xr.concat([waves.data, waves.data.assign_coords(float=["rear"])], "float", data_vars="minimal")
    upper, _ = responses(replace(waves, data=both)).axes
    assert names_of_lines(upper) == ["front, rear"]


def test_figures_of_one_sea_are_of_one_that_designs_work_in(small, results):
    """Not of a storm with other settings, unless every sea is one."""
    assert results.sea == "rough"
    text = small.read_text()
    for Hs, sea in ((1.5, "calm"), (0.1, "rough")):
        small.write_text(text + f'\n[survival]\nHs = {Hs}\n"floats.*.coulomb" = 1e9\n')
        assert figures.Results(study=load(small), data=results.data).sea == sea


def test_words_and_dots_of_the_audit_have_room(results):
    """With all that runs say of themselves words stay below their own axes, and dots at powers of ten are whole."""
    data = results.data.assign(estimated_error=0 * results.data.wall_time + 10.0 ** (results.data.seed - 3.0))
    with plain():
        figure = strips.audit(replace(results, data=data))
        rendered(figure, "png")
    words = [axes.xaxis.label.get_window_extent() for axes in figure.axes]
    assert len(words) == 3 and all(one.x1 < other.x0 for one, other in pairwise(words))
    assert words[0].x0 >= 0 and words[-1].x1 <= figure.bbox.x1 and min(box.y0 for box in words) >= 0
    for axes in figure.axes:
        dots = np.concatenate([axes.transData.transform(line.get_xydata()) for line in axes.lines[-3:]])
        radius = axes.lines[-1].get_markersize() / 2 * figure.dpi / 72
        assert dots[:, 0].min() - radius >= axes.bbox.x0 and dots[:, 0].max() + radius <= axes.bbox.x1


def test_the_audit_shows_nothing_of_what_is_exactly_zero(results):
    data = results.data.assign(energy_residual=0 * results.data.wall_time)
    with plain():
        (axes,) = strips.audit(replace(results, data=data)).axes
    assert axes.get_xlabel().startswith("wall time")


def test_numbers_have_the_unit_of_what_is_shown(small):
    """Not of what another sample has: 6 W are not 0.006 kW."""
    lines = "[[axes.together]]\nname = 'size'\nwater.depth = [50.0, 60.0]"
    data = along_of(small, "size", lines, size=[1, 2])
    powers = data.data.absorbed_power * xr.DataArray([1e-3, 1e3], dims="size")
    forces = dataset().hinge_force * xr.DataArray([1.0, 1e5], dims="size")
    some = replace(data, data=data.data.assign(absorbed_power=powers, hinge_force=forces))
    with plain():
        by_sea, along_it, hinge = figures.sea_states(some), along(some, "size"), strips.hinge_forces(some)
    assert by_sea.axes[0].get_xlabel() == "mean absorbed power [W]"
    assert along_it.axes[0].get_ylabel() == "mean absorbed power [kW]" and hinge.axes[-1].get_xlabel().endswith("[N]")
    calm = powers.sel(sea_state="calm", platform="elastic", statistic="mean").isel(size=0).mean().item()
    assert any(line.get_xdata()[0] == pytest.approx(calm) for line in by_sea.axes[0].lines if line.get_marker() == "o")


def test_a_guide_is_no_arm(study_of, buan_tables):
    """From its rest point to a floating body a bar would look like one."""
    tables = {key: buan_tables[key] for key in ("water", "waves", "sea_states")}
    front, rear = buan_tables["floats"]
    tables["floats"] = [front, {k: v for k, v in rear.items() if k not in ("axis", "arm")} | {"motion": ["heave"]}]
    scene = sketch.first_scene(study_of(tables).content)
    with plain():
        _, (view,) = sketch.views(scene, sketch.about_water(scene))
    assert [arm.get_visible() for arm in view.arms] == [True, False]
