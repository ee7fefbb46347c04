"""The first ten of many designs, and the lines with which they run again."""

import tomllib

import numpy as np
import pytest
import xarray as xr
from conftest import SMALL

from pipeline.bridge.loading import load
from pipeline.cli import cli
from pipeline.report import figures, page
from pipeline.report.best import OF_WARNED, UNCOUNTED
from pipeline.report.ranking import block, table, toml
from pipeline.report.tables import MANY
from pipeline.tasks.task import cell, first_labels

COUNT = MANY + 2
SAMPLES = f"""[samples]
count = {COUNT}
"floats.*.mass" = {{ from = 2e3, to = 3e3 }}
"floats.front.pto_damping" = {{ from = 1e4, to = 1e6, spacing = "log" }}
"""


def dataset(power, scatter=0.0, **coords):
    """Mean power [kW] of one float in two seas, the rough one's the other way round, by sample; two realizations."""
    power = np.asarray(power, float)
    each = 1e3 * np.stack([power, power[::-1]])[..., None] + 1e3 * np.multiply.outer(
        np.broadcast_to(scatter, power.shape), [-1.0, 1.0]
    )
    values = ("sea_state", "sample", "seed", "float", "statistic"), each[..., None, None]
    known = {"sample": np.arange(len(power)), "sea_state": ["mild", "rough"], "float": ["front"], "statistic": ["mean"]}
    data = xr.Dataset({"absorbed_power": values}, coords=known | coords)
    data["sample"].attrs["long_name"] = "Values of floats.*.mass, floats.front.pto_damping"
    return data


OFTEN = {"occurrence": ("sea_state", [3.0, 1.0])}


def test_ten_of_many_designs_are_ranked_with_their_keys_and_what_they_lack():
    """Of all seas by occurrence; those whose difference has 0 in its interval are undecided."""
    power, scatter = np.arange(COUNT), np.zeros(COUNT)
    scatter[-3] = 2.0
    data = dataset(power, scatter, **OFTEN).assign_coords({"floats.*.mass": ("sample", 100.0 + power)})
    told = table(data)
    assert [line[1] for line in told.lines] == [f"sample {n} (*.mass {100 + n})" for n in range(COUNT - 1, 1, -1)]
    assert [line[0] for line in told.lines] == [f"all seas, number {rank}" for rank in range(1, MANY + 1)]
    assert [float(line[2]) for line in told.lines] == pytest.approx(0.75 * power[:1:-1] + 0.25 * power[:MANY], rel=5e-3)
    assert [line[3].split(" ")[0] for line in told.lines[:3]] == ["-", "0.5", "1"]
    assert [line[3].endswith("undecided") for line in told.lines] == [False, False, True, *[False] * 7]
    assert told.header[1:3] == ("design", "mean absorbed power [kW]") and told.lines[0][-1] == "2"


def test_designs_that_are_warned_of_are_marked():
    data = dataset(np.arange(COUNT), **OFTEN)
    words = np.full((2, COUNT, 2), "", object)
    words[0, COUNT - 2, 1] = UNCOUNTED
    told = table(data.assign(warnings=(("sea_state", "sample", "seed"), words)))
    assert [line[1].endswith("(warned)") for line in told.lines] == [n == 1 for n in range(MANY)]
    assert told.note.endswith(OF_WARNED)


def test_without_occurrence_each_sea_has_its_ten():
    lines = table(dataset(np.arange(COUNT))).lines
    assert [line[0] for line in lines[:: MANY - 1]] == ["mild, number 1", "mild, number 10", "rough, number 9"]
    assert (lines[0][1], lines[MANY][1]) == (f"sample {COUNT - 1}", "sample 0")


def test_few_designs_and_those_that_take_nothing_are_not_ranked():
    for data in (dataset(np.arange(MANY), **OFTEN), dataset(np.zeros(COUNT), **OFTEN), xr.Dataset()):
        assert table(data).lines == []


def test_designs_that_are_not_compared_have_no_rank():
    data = dataset(np.arange(COUNT), **OFTEN)
    data.absorbed_power[0, -1, 0] = np.nan
    lines = table(data).lines
    assert lines[0][:2] == (f"all seas (of {COUNT - 1} among {COUNT}), number 1", f"sample {COUNT - 2}")
    data.absorbed_power[0, 3:, 0] = np.nan
    assert [line[1] for line in table(data).lines] == ["sample 2", "sample 1", "sample 0"]


def parameters(study, **labels):
    """Of a task with these labels, in the mild sea."""
    return cell(study.content, first_labels(study.content) | labels, ()).parameters


def pasted(small, lines):
    """The study with these lines at its end."""
    small.write_text(SMALL + lines + "\n")
    return load(small)


def test_the_best_run_again_as_the_same_tasks(small):
    study, order = pasted(small, SAMPLES), [3, 0, 7]
    power = np.zeros(COUNT)
    power[order] = [9.0, 8.0, 7.0]
    again = pasted(small, block(study.content, dataset(power, **OFTEN), 3))
    assert again.content.axes.together[0].name == "best" and len(again.content.varied[0].labels) == 3
    for number, sample in enumerate(order, start=1):
        assert parameters(again, best=number) == parameters(study, sample=sample)


def test_designs_of_variants_with_keys_of_their_own_run_again_as_variants(small):
    """Where one leaves a key as the study has it, or brings a table, there is no list for all."""
    own = """
[variants.usual]
[variants.raised]
"floats.front.cog" = [0.0, 0.0, 0.1]
[variants.stopped]
"floats.front.end_stops" = { lower = -0.9, upper = 0.9, stiffness = 2e7, damping = 2e5 }
"""
    study = pasted(small, SAMPLES + own)
    order = [("usual", 3), ("stopped", 3), ("raised", 0)]
    power = xr.concat([dataset(np.zeros(COUNT), **OFTEN)] * 3, "variant").assign_coords(
        variant=[*study.content.variants]
    )
    power["variant"].attrs["long_name"] = "Values of floats.front.cog, floats.front.end_stops"
    for worth, (variant, sample) in zip((9e3, 8e3, 7e3), order, strict=True):
        power.absorbed_power.loc[{"variant": variant, "sample": sample}] = worth
    lines = block(study.content, power, 3)
    assert "[[axes.together]]" not in lines
    again = pasted(small, lines)
    assert list(again.content.variants) == ["best-1", "best-2", "best-3"]
    for number, (variant, sample) in enumerate(order, start=1):
        assert parameters(again, variant=f"best-{number}") == parameters(study, variant=variant, sample=sample)
    alone = block(study.content, power.isel(sample=[3]).squeeze("sample", drop=True), 1)
    assert tomllib.loads(alone) == {"variants": {"best-1": {}}}


def test_named_axes_of_floats_are_written_as_their_keys(study_of, buan_tables):
    buan_tables["axes"] |= {"pto_damping": [1e5, 2e5], "hinge_spacing": [5.0, 8.0]}
    study = study_of(buan_tables)
    power = dataset([1.0, 4.0, 3.0, 2.0], **OFTEN).absorbed_power.drop_vars("sample")
    power = power.assign_coords(pto_damping=("sample", [1e5, 1e5, 2e5, 2e5]), hinge_spacing=("sample", [5.0, 8.0] * 2))
    data = power.set_index(sample=["pto_damping", "hinge_spacing"]).unstack("sample").to_dataset()
    del buan_tables["axes"]["pto_damping"], buan_tables["axes"]["hinge_spacing"]
    lines = block(study.content, data, 1)
    assert '"floats.*.pto_damping" = [100000.0]' in lines and '"floats.front.hinge.0" = [-4.0]' in lines
    buan_tables["axes"]["together"] = [
        {"name": "best", "floats.*.pto_damping": [1e5], "floats.front.hinge.0": [-4.0], "floats.rear.hinge.0": [4.0]}
    ]
    again = study_of(buan_tables)
    assert parameters(again, best=1) == parameters(study, pto_damping=1e5, hinge_spacing=8.0)


def test_values_of_every_kind_are_written_as_a_file_has_them():
    for value in (1e-7, 2, np.inf, True, 'a "word"', [1.0, ["pitch"]], {"shape": "sphere", "radius": 1.0}):
        assert tomllib.loads(f"value = {toml(value)}") == {"value": value}


@pytest.mark.usefixtures("undrawn")
def test_the_page_and_the_command_have_the_lines(small, tmp_path, capsys):
    study, data = pasted(small, SAMPLES), dataset(np.arange(COUNT), **OFTEN)
    text = page.html(figures.Results(study=study, data=data.assign_coords(seed=[0, 1])))
    assert "<pre># Instead of [variants], [samples]" in text and "[[axes.together]]" in text
    few = figures.Results(study=study, data=data.isel(sample=slice(MANY)).assign_coords(seed=[0, 1]))
    assert "[[axes.together]]" not in page.html(few)
    root = tmp_path / "results" / "small"
    root.mkdir(parents=True)
    data.to_netcdf(root / "statistics.nc")
    cli.report(small, tmp_path / "results", best=2)
    assert block(study.content, data, 2) in capsys.readouterr().out
