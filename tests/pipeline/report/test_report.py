"""The table beside the published numbers."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

from pipeline.bridge.loading import load
from pipeline.cli import actions
from pipeline.report import published, report, units
from pipeline.report.published import COLUMNS, read_published
from pipeline.report.tables import texts
from pipeline.results.variables import VARIABLES
from pipeline.study.reading import StudyError
from solver.statistics import STATISTICS

EMPTY = SimpleNamespace(floats=[], platform=None)  # a study

HEAD = ",".join(COLUMNS)


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
    return read_published(path)[0]


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


def test_realizations_alone_spread(data, tmp_path):
    """Of what else a study varies the first label is compared, and the first platform that has numbers."""
    theirs = row(tmp_path / "p.csv", "T,power,absorbed_power,float=front,,2.0,kW,")
    thicker = xr.concat([data, 9 * data], "thickness").assign_coords(thickness=[0.012, 0.015])
    none = (np.nan * thicker).assign_coords(platform=["elastic-no-floats"])
    mine = report.ours(xr.concat([none, thicker], "platform"), theirs)
    assert (mine.mean, mine.low, mine.high, mine.count) == (2.0, 1.0, 3.0, 3)
    assert report.ours(none, theirs) is None
    assert report.ours(thicker.isel(thickness=[1, 0]), theirs).mean == 18.0


def test_minus_counts_the_other_way_round_and_prefixes_are_thousands(tmp_path):
    values = np.array([[-3e6, 7e6], [-1e6, 5e6]])
    stress = xr.Dataset(
        {"bottom_stress": (("seed", "statistic"), values)}, coords={"seed": [0, 1], "statistic": ["min", "max"]}
    )
    for statistic, unit, mean in (("-min", "MPa", 2.0), ("max", "MPa", 6.0), ("max", "kPa", 6e3), ("min", "Pa", -2e6)):
        mine = report.ours(stress, row(tmp_path / "p.csv", f"T,stress,bottom_stress,,{statistic},2.0,{unit},"))
        assert mine.mean == pytest.approx(mean) and mine.low <= mine.mean <= mine.high


@pytest.mark.parametrize("selection", ["platform=elastic", "platform=fixed;leg=1", "sea_state=rough"])
def test_what_is_not_there_is_not_invented(data, tmp_path, selection):
    assert report.ours(data, row(tmp_path / "p.csv", f"T,power,absorbed_power,{selection},,2.0,kW,")) is None


def test_a_number_far_off_gets_its_sentence(data, tmp_path):
    rows = [
        row(tmp_path / "a.csv", "T,power,absorbed_power,float=front,,8.0,kW,the paper's spike"),
        row(tmp_path / "b.csv", "T,other,absorbed_power,float=front,,2.1,kW,never said"),
    ]
    console = Console(record=True, width=120)
    report.print_tables(data, rows, console, EMPTY)
    text = console.export_text()
    assert "* power: the paper's spike" in text
    assert "never said" not in text
    assert "0.25 *" in text


def test_the_largest_error_is_told_with_its_task():
    each = xr.DataArray(
        [[1e-3, np.nan], [4e-3, 2e-3]], dims=("sea_state", "seed"), coords={"sea_state": ["mild", "rough"]}
    )
    data = xr.Dataset({"estimated_error": each}).assign_coords(seed=[0, 7])
    assert report.estimated(data) == "1.0e-03 to 4.0e-03, the largest of sea_state=rough, seed=0"
    assert report.estimated(data.isel(sea_state=1, seed=0)) == "4.0e-03"
    steel = dict.fromkeys(("pile_force", "fibre_stress", "bottom_stress"), data.estimated_error)
    assert report.estimated(data.isel(sea_state=1, seed=0).assign(steel)) == "4.0e-03; not of fibre_stress, pile_force"
    assert report.estimated(1.0 + 1e-3 * data) == "1.0e+00"  # as far as it is told
    assert report.estimated(data.where(data.estimated_error == data.estimated_error.max())) == "4.0e-03"
    assert report.estimated(data.isel(sea_state=0, seed=[1])) == report.estimated(xr.Dataset()) == ""


def test_tables_without_a_number_of_ours_are_left_out(data, tmp_path):
    """A study made from another has its published numbers, and other seas."""
    known = row(tmp_path / "a.csv", "Known,power,absorbed_power,float=front,,2.1,kW,")
    other = row(tmp_path / "b.csv", "Other sea,power,absorbed_power,sea_state=rough,,2.1,kW,")
    console = Console(record=True, width=120)
    report.print_tables(data, [known, other], console, EMPTY)
    assert "Known" in (text := console.export_text()) and "Other sea" not in text
    assert [report.speaks(data, rows) for rows in ([], [known], [known, other])] == [False, True, False]


def test_bad_rows_are_named(tmp_path):
    lines = [
        "T,a,absorbed_power,,,many,kW,",
        "T,b,absorbed_power",
        "T,c,absorbed_power,float:duck,,2.0,kW,",
        "T,d,absorbed_power,seed=1;float=duck=2,,2.0,kW,",
        "T,e,absorbed_power,float=;=duck;float=a+,,2.0,kW,",
        "T,f,absorbed_power,float=front;seed=1;float=rear,,2.0,kW,",
        "T,g,absorbed_power,,,2.0,kW,by drag, not by waves, as ours",
    ]
    with pytest.raises(StudyError) as refused:
        row(tmp_path / "p.csv", "\n".join(lines))
    pair = "must be dimension=label, with + between labels and ; before another dimension"
    quotes = "commas in a text need quotes"
    assert [text.partition("p.csv: ")[2] for text in refused.value.problems] == [
        "row 1 = 'a': value = 'many': must be a number",
        "row 2 = 'b': value = '': must be a number",
        f"row 3 = 'c': selection = 'float:duck': {pair}",
        f"row 4 = 'd': selection = 'float=duck=2': {pair}",
        *(f"row 5 = 'e': selection = {each!r}: {pair}" for each in ("float=", "=duck", "float=a+")),
        "row 6 = 'f': selection float = rear: must be named once, with + between labels",
        f"row 7 = 'g': note = 'by drag': must be the last of 8, and {' not by waves, as ours'!r} follows: {quotes}",
    ]
    (tmp_path / "q.csv").write_text("a,b\n1,2\n")
    with pytest.raises(StudyError, match="must be table, label"):
        read_published(tmp_path / "q.csv")
    (tmp_path / "q.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(StudyError, match="is no table of text: 'utf-8' codec can't decode"):
        read_published(tmp_path / "q.csv")


@pytest.mark.parametrize(
    ("unit", "own", "size"),
    [
        ("mm", "m", 1e-3),
        ("m", "m", 1.0),
        ("kg", "kg", 1.0),
        ("t", "kg", 1e3),
        ("kkg", "kg", None),
        ("deg", "rad", np.pi / 180),
        ("deg/s", "rad s-1", np.pi / 180),
        ("min", "s", 60.0),
        ("ms", "s", 1e-3),
        ("year", "s", 31557600.0),
        ("km", "m2", None),
        ("year", "h", 8766.0),
        ("1/year", "h-1", 1 / 8766),
        ("MN m", "N m", 1e6),
        ("MNm", "N m", None),
        ("N", "N m", None),
        ("kN m", "N", None),
        ("kN/m2", "N m-2", 1e3),
        ("mm/s2", "m s-2", 1e-3),
        ("mm2", "m2", 1e-6),
        ("m", "m2", None),
        ("(N m)2", "(N m)2", 1.0),
        ("%", "1", 0.01),
        ("", "1", 1.0),
        ("", "m", None),
        ("kPa", "m", None),
    ],
)
def test_units_are_so_many_of_the_datasets_own(unit, own, size):
    assert units.factor(unit, own) == (size if size is None else pytest.approx(size, rel=1e-14))


def test_ours_is_told_in_the_printed_unit_by_the_variables_own(tmp_path):
    """A mass in kg is no thousand grams' thousandth; millimetres and degrees are not metres and radians."""
    numbers = {"mass": 6955.5, "top_displacement": 0.0077, "rotation": 0.0744, "system_period": 7200.0}
    data = xr.Dataset({name: (("seed",), [number] * 2) for name, number in numbers.items()})
    told = {("mass", "kg"): 6955.5, ("mass", "t"): 6.9555, ("top_displacement", "mm"): 7.7, ("system_period", "h"): 2.0,
            ("rotation", "deg"): np.degrees(0.0744), ("rotation", "mrad"): 74.4}  # fmt: skip
    for (name, unit), mean in told.items():
        theirs = row(tmp_path / "p.csv", f"T,x,{name},,,2.0,{unit},")
        assert report.ours(data, theirs).mean == pytest.approx(mean)
        assert theirs.scale * mean == pytest.approx(numbers[name])


def test_a_unit_goes_by_the_axis_where_some_slide_and_some_turn(tmp_path):
    """The first, where the selection names none."""
    data = xr.Dataset({"motion": (("axis", "seed"), [[0.5], [0.1]])}, coords={"axis": ["surge", "yaw"], "seed": [0]})
    for selection, unit, mean in (("axis=yaw", "deg", np.degrees(0.1)), ("axis=surge", "mm", 500.0), ("", "m", 0.5)):
        theirs = row(tmp_path / "p.csv", f"T,x,motion,{selection},,2.0,{unit},")
        assert report.ours(data, theirs).mean == pytest.approx(mean) and not report.strange(data, [theirs], EMPTY)
    turned = row(tmp_path / "p.csv", "T,x,motion,,,2.0,deg,")
    assert report.ours(data, turned) is None
    assert report.strange(data, [turned], EMPTY) == [
        "p.csv: row 1 = 'x': unit = 'deg': must be that of the axis that the selection names, of m, rad"
    ]
    with pytest.raises(StudyError, match=r"unit = 'm': must be that of motion: rad, with k, M, G, m before rad, deg"):
        row(tmp_path / "p.csv", "T,x,motion,axis=yaw,,2.0,m,")


def test_words_that_no_dataset_has_are_refused_all_at_once(tmp_path):
    lines = [
        "T,a,absorbedpower,,mean,2.0,kW,",
        "T,b,absorbed_power,,average,2.0,kW,",
        "T,c,mass,,,2.0,lb,",
        "T,d,status,,,2.0,,",
        "T,e,rotation,platform=floating,-min,2.0,rad,",
        "T,f,mass_found,,,2.0,kg,",
        "T,g,rotation_response_phase,,,2.0,deg,",
    ]
    with pytest.raises(StudyError) as refused:
        row(tmp_path / "p.csv", "\n".join(lines))
    assert [text.partition("p.csv: ")[2] for text in refused.value.problems] == [
        "row 1 = 'a': variable = 'absorbedpower': must be an output with numbers: absorbed_power?",
        "row 2 = 'b': statistic = 'average': must be max, min, mean, rms, std, or one with - before it",
        "row 3 = 'c': unit = 'lb': must be that of mass: kg, with t or g for kg",
        "row 4 = 'd': variable = 'status': must be an output with numbers",
        "row 5 = 'e': selection platform = 'floating': must be elastic, fixed, elastic-no-floats",
    ]
    assert published.STATISTICS == STATISTICS


def test_a_bad_unit_is_refused_before_anything_runs(small, tmp_path):
    study = load(small)
    (tmp_path / "small-published.csv").write_text(f"{HEAD}\nT,deep,hinge_force,,max,2.0,tf,\n")
    with pytest.raises(
        StudyError, match="row 1 = 'deep': unit = 'tf': must be that of hinge_force: N, with k, M, G, m"
    ):
        actions.preflight(study, study.tasks)


def test_labels_that_the_study_lacks_are_named(data, tmp_path):
    """But for seas and platforms of another study, and what nobody knows before all tasks have run."""
    data = data.assign(status=(("platform", "seed"), [["done"] * 3]), task=(("platform", "seed"), [[*"abc"]]))
    said = {
        "float=fornt": "selection float = fornt: must be front, rear",
        "float=front+raer": "selection float = raer: must be front, rear",
        "leg=1": "selection leg = 1: must be left out: absorbed_power has platform, float, seed",
        "seed=7": "selection seed = 7: must be 0, 1, 2",
        "sea_state=rough;float=fornt": "",
        "platform=elastic;float=fornt": "",
        "float=rear": "",
    }
    for selection, words in said.items():
        theirs = row(tmp_path / "p.csv", f"T,power,absorbed_power,{selection},,2.0,kW,")
        assert report.strange(data, [theirs], EMPTY) == ([f"p.csv: row 1 = 'power': {words}"] if words else [])
        begun = data.assign(status=data.status.where(data.seed < 2, "missing"))
        inner = words if "seed" in words or "left out" in words else ""
        assert [text[24:] for text in report.strange(begun, [theirs], EMPTY)] == ([inner] if inner else [])
    study = SimpleNamespace(floats=[SimpleNamespace(name=name) for name in ("front", "rear", "aft")], platform=None)
    for name, words in (("fornt", "selection float = fornt: must be front, rear, aft"), ("aft", "")):
        theirs = row(tmp_path / "p.csv", f"T,power,absorbed_power,float=front+{name},,2.0,kW,")
        assert [text[24:] for text in report.strange(begun, [theirs], study)] == ([words] if words else [])
    other = row(tmp_path / "p.csv", "T,top,top_displacement,,,2.0,mm,")
    assert report.strange(data, [other], EMPTY) == [
        "p.csv: row 1 = 'top': variable = top_displacement: is no output of this study"
    ]
    assert not report.strange(begun, [other], EMPTY)
    console = Console(record=True, width=80)
    report.print_tables(data, [other], console, EMPTY)
    assert "is no output of this study" in console.export_text()


def test_means_say_where_realizations_failed(data, tmp_path):
    """A regular sea has one, whatever the seed; what has not run has not failed."""
    power = data.absorbed_power.where(data.seed < 2)
    status = xr.DataArray([["done", "done", "failed"]], dims=("platform", "seed"))
    failed = data.assign(absorbed_power=power, status=status, task=(("platform", "seed"), [[*"abc"]]))
    theirs = row(tmp_path / "p.csv", "T,power,absorbed_power,float=front+rear,,2.0,kW,")
    for changed, words, mean in (
        (failed, "2, 1 failed", 3.0),
        (failed.assign(status=status.where(status == "done", "missing")), "2", 3.0),
        (failed.assign(task=(("platform", "seed"), [[*"aaa"]])), "1", 2.5),
        (data, "3", 3.5),
    ):
        mine = report.ours(changed, theirs)
        assert (mine.realizations, mine.mean) == (words, mean)
        assert report.line(theirs, mine)[-1] == words
    both = xr.concat([failed, data.assign(failed[["status", "task"]])], "thickness").assign_coords(thickness=[1, 2])
    theirs = row(tmp_path / "p.csv", "T,power,absorbed_power,float=front;thickness=1+2,,2.0,kW,")
    assert report.ours(both, theirs).realizations == "3, 1 failed"
    console = Console(record=True, width=40)
    report.print_tables(both, [theirs], console, EMPTY)
    assert "3, 1 failed" in console.export_text()


def test_published_numbers_of_the_project_name_known_variables():
    for path in (Path(__file__).parents[3] / "studies").glob("*-published.csv"):
        rows = read_published(path)
        assert rows
        assert {r.variable for r in rows} <= VARIABLES.keys()
        with path.open(newline="") as file:
            assert all(None not in r for r in csv.DictReader(line for line in file if not line.startswith("#")))


@pytest.mark.parametrize(
    ("value", "count", "verdict"),
    [
        ("2.5", 20, "inside"),
        ("3.04", 20, "outside"),
        ("3.0", 20, "inside"),
        ("3", 20, "inside"),  # rounded from as little as 2.5
        ("0.94", 20, "outside"),
        ("4e0", 20, "outside"),
        ("0.03e2", 20, "inside"),  # rounded from as little as 2.5
        ("9.9", 19, ""),  # too few to tell
    ],
)
def test_a_published_number_is_inside_if_its_rounding_reaches_our_range(tmp_path, value, count, verdict):
    numbers = 1e3 * np.linspace(1.0, 2.99, count)
    data = xr.Dataset({"absorbed_power": (("seed",), numbers)})
    theirs = row(tmp_path / "p.csv", f"T,power,absorbed_power,,,{value},kW,why")
    mine = report.ours(data, theirs)
    assert mine.verdict(theirs) == verdict
    assert (report.verdicts(data, [theirs]) == "") == (verdict == "")
    assert bool(list(report.sentences([(theirs, mine)]))) == (verdict == "outside" or not verdict)


def test_a_number_is_far_off_a_published_nothing(data, tmp_path):
    nothing = row(tmp_path / "p.csv", "T,power,absorbed_power,float=front,,0,kW,")
    assert report.cells(nothing, report.ours(data, nothing))[2] == " *"
    assert report.cells(nothing, report.ours(0 * data, nothing))[2] == ""


def test_the_range_of_39_holds_one_more_with_95_percent(tmp_path):
    """Whatever the distribution: counted here for an extreme-value one, 4,000 times; 3 standard errors are 1 %."""
    draws = np.random.default_rng(3).gumbel(size=(4000, 40))
    held = (draws[:, 0] > draws[:, 1:].min(axis=1)) & (draws[:, 0] < draws[:, 1:].max(axis=1))
    assert held.mean() == pytest.approx(38 / 40, abs=0.0104)
    data = xr.Dataset({"rotation": (("seed",), draws[0, 1:])})
    theirs = row(tmp_path / "p.csv", "T,r,rotation,,,99,rad,")
    assert "0 of 1 published" in report.verdicts(data, [theirs])
    assert "95.0% of 39" in report.verdicts(data, [theirs])


def test_no_table_says_minus_nothing(data, tmp_path):
    """What is small is told as small as it is, and a range that begins at minus nothing begins at nothing."""
    theirs = row(tmp_path / "p.csv", "T,power,absorbed_power,float=front,,2.0,kW,")
    for factor, told in ((-0.0, ["0", "", "0.00 *"]), (-1e-9, ["-2e-09", "[-3e-09, -1e-09]", "0.00 *"])):
        assert report.cells(theirs, report.ours(factor * data, theirs))[:3] == told
    for factors, told in (((-0.0, -1.0, -2.0), "[-6, 0]"), ((-0.0, 1.0, 1.0), "[0, 3]")):
        mine = report.ours(xr.DataArray([*factors], dims="seed") * data, theirs)
        assert report.cells(theirs, mine)[1] == told
    (line,) = report.summary_rows((-0.0 * data).expand_dims(statistic=["min"]))
    assert line[2:5] == ("0", "0", "0")
    assert texts(np.array([-0.0, np.nan, -2e-5])) == ["0", "-", "-2e-05"]


def test_drift_is_in_the_table():
    """One number each for a record, of a direction, of none and of an axis."""
    of = xr.Dataset(
        {
            "drift_force": (("seed", "direction"), [[2.0, -1.0], [4.0, -1.0]]),
            "drift_moment": ("seed", [5.0, 7.0]),
            "slow_drift": (("seed", "float", "axis"), [[[0.5]], [[0.5]]]),
        },
        coords={"direction": ["x", "y"], "float": ["barge"], "axis": ["surge"]},
    )
    assert [line[:5] for line in report.summary_rows(of)] == [
        ("drift_force x", "", "3", "2", "4"),
        ("drift_force y", "", "-1", "-1", "-1"),
        ("drift_moment", "", "6", "5", "7"),
        ("slow_drift surge", "", "0.5", "0.5", "0.5"),
    ]


def test_rounding_beside_a_variables_largest_is_told_as_none():
    """As of a hinge's free axis; what is small, or beside nothing larger, as small as it is, and NaN not at all."""
    values = np.array([[[3e2, -2e2], [4e-13, -4e-13]], [[2e2, -1e2], [2e-6, np.nan]]])
    force = xr.DataArray(values, dims=("seed", "leg", "statistic"), coords={"statistic": ["max", "min"]})
    assert [line[1:5] for line in report.summary_rows(force.to_dataset(name="hinge_force"))] == [
        ("max", "125", "0", "300"),
        ("min", "-100", "-200", "0"),
    ]
    small = force.isel(leg=[1])
    alone = small.isel(seed=[0]).to_dataset(name="hinge_force")
    assert [line[2] for line in report.summary_rows(alone)] == ["4e-13", "-4e-13"]
    faint = (1e-6 * force).isel(leg=[0]).to_dataset(name="hinge_force")
    assert [line[4] for line in report.summary_rows(faint)] == ["0.0003", "-0.0001"]


def test_components_have_lines_of_their_own_and_those_that_there_are_none_of_have_none():
    values = np.array([[[3e2, -2e2], [4e-13, -4e-13], [7.0, 5.0]], [[2e2, -1e2], [2e-13, np.nan], [np.nan, np.nan]]])
    force = xr.DataArray(
        values, dims=("seed", "direction", "statistic"), coords={"statistic": ["max", "min"], "direction": [*"xyz"]}
    )
    assert [line[:5] for line in report.summary_rows(force.to_dataset(name="base_shear"))] == [
        ("base_shear x", "max", "250", "200", "300"),
        ("base_shear x", "min", "-150", "-200", "-100"),
        ("base_shear z", "max", "7", "7", "7"),
        ("base_shear z", "min", "5", "5", "5"),
    ]
    none = (0.0 * force).fillna(0.0)
    assert len(list(report.summary_rows(none.to_dataset(name="base_shear")))) == 6


def test_a_narrow_terminal_cuts_no_number_of_the_summary():
    large = xr.DataArray([1.234567e8], dims=["statistic"], coords={"statistic": ["max"]})
    console = Console(record=True, width=40)
    report.print_summary(large.to_dataset(name="absorbed_power"), console)
    assert console.export_text().split("\n")[1].split() == ["absorbed_power", "max", *3 * ["1.235e+08"], "W"]


def test_electrical_power_is_of_the_floats_that_absorb(data):
    """Of one without an efficiency what it absorbs; a mean over the others alone might exceed the absorbed one."""
    power = data.absorbed_power.expand_dims(statistic=["mean"])
    share = xr.DataArray([np.nan, 0.8], dims="float")
    lines = report.summary_rows(xr.Dataset({"absorbed_power": power, "electrical_power": share * power}))
    assert [line[:5] for line in lines] == [
        ("absorbed_power", "mean", "3500", "1000", "6000"),
        ("electrical_power", "mean", "3000", "1000", "4800"),
    ]
