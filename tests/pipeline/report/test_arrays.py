"""Figures of several floats together: from above, by period, and what they gain over one alone."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from conftest import SMALL

from pipeline.bridge.loading import load
from pipeline.report import arrays, figures
from pipeline.report.captions import entries
from pipeline.report.drawing import plain

PAIR = """
[[floats]]
name = "side"
hull = { shape = "duck", radius = 1.0, beak = 2.2, elevation = 0.3, submergence = 0.5, width = 5.0 }
mass = "balance"
cog = ["balance", 0.0, -0.5]
inertia = [859.0, 859.0, 859.0]
hinge = [6.0, 9.0, -0.5]
arm = [0.0, 0.0, 0.5]
pto_damping = 3e5
"""
VARIANTS = """
[variants.both]
[variants.one]
left_out = ["side"]
"""
HEADINGS, SEAS = "[axes]\n'waves.heading' = [0.0, 0.5]\n", SMALL[SMALL.index("[axes]") :]
FRONT = SMALL[SMALL.index("[[floats]]") : SMALL.index("[platform]")]
TWIN = FRONT.replace('"front"', '"side"').replace("[-1.5, 0.0, 2.6]", "[7.5, 9.0, 2.6]")
OMEGA = np.array([0.5, 2.0, 1.0])


def of_two(small, first, second):
    """A study of the array of two floats and of the first by itself."""
    water, seas = SMALL[: SMALL.index("[[floats]]")], SEAS[SEAS.index("[sea_states") :]
    small.write_text(water + first + second + VARIANTS + HEADINGS + seas)
    return load(small)


@pytest.fixture
def study(small):
    return of_two(small, FRONT, PAIR)


def dataset():
    """Powers and motions of two floats, twice as large in the rough sea, and of the first by itself."""
    power = np.zeros((2, 2, 2, 2, 5))  # variant, heading, sea, float, statistic
    power[0, :, :, 0], power[0, :, :, 1], power[1, :, :, 0], power[1, :, :, 1] = 4.0, 8.0, 5.0, np.nan
    power[:, 1] *= 0.5
    power[:, :, 1] *= 2
    power[0, 1] *= 1.5
    rao = np.full((2, 2, 2, 2, 1, 3), np.nan)
    rao[0, :, :, 0, 0], rao[0, :, :, 1, 0], rao[1, :, :, 0, 0] = [1, 2, 3], [1, 1, 2], [2, 2, 1]
    dims = ("variant", "heading", "sea_state", "float")
    return xr.Dataset(
        {
            "absorbed_power": ((*dims, "statistic"), power),
            "rao": ((*dims, "axis", "component"), rao),
            "wave_frequency": (("sea_state", "component"), np.stack([OMEGA, OMEGA])),
        },
        coords={
            "variant": ["both", "one"], "heading": [0.0, 0.5], "sea_state": ["calm", "rough"],
            "float": ["front", "side"], "statistic": ["max", "min", "mean", "rms", "std"], "axis": ["hinge"],
            "axis_unit": ("axis", ["rad"]), "component": [1, 2, 3], "Hs": ("sea_state", [0.5, 2.0]),
        },
    )  # fmt: skip


@pytest.fixture
def results(small):
    return figures.Results(study=of_two(small, FRONT, TWIN), data=dataset())


def test_floats_are_where_they_are(study):
    """Each hull about its reference point, the axis of its hinge across it, and the waves' way in the corner."""
    with plain():
        (axes,) = arrays.from_above(study.content).axes
    wet = [c.get_paths() for c in axes.collections[::2]]
    ball = np.concatenate([p.vertices for p in wet[0]])
    assert np.ptp(ball, axis=0) == pytest.approx(2.0, rel=1e-3)
    duck = np.concatenate([p.vertices for p in wet[1]])
    assert duck[:, 1].min() == pytest.approx(6.5) and duck[:, 1].max() == pytest.approx(11.5)
    assert duck[:, 0].min() < 4.5 and duck[:, 0].max() > 6.5
    dashed = [line.get_xydata() for line in axes.lines if line.get_linestyle() == "--"]
    assert dashed[1] == pytest.approx(np.array([[6.0, 6.5], [6.0, 11.5]]))
    assert [t.get_text() for t in axes.texts if t.get_text()] == ["front", "side", "waves"]
    assert arrays.from_above(study.content.model_copy(update={"left_out": ("side",)})) is None


def test_every_float_has_its_motion_by_period(results):
    with plain():
        (axes,) = arrays.by_period(results).axes
    assert [line.get_label() for line in axes.lines] == ["front", "side"]
    for line, values in zip(axes.lines, ([2, 3, 1], [1, 2, 1]), strict=True):
        np.testing.assert_allclose(line.get_xydata(), np.column_stack([2 * np.pi / np.array([2.0, 1.0, 0.5]), values]))
    assert axes.get_ylabel() == "hinge [rad/m]"
    alone = figures.Results(study=results.study, data=results.data.isel(float=[0]))
    assert arrays.by_period(alone) is None


def test_waves_that_say_nothing_do_not_cut_a_line(results):
    data = results.data.copy(deep=True)
    data["rao"].loc[{"component": data.component.values[2]}] = np.nan  # of the period between the others
    with plain():
        (axes,) = arrays.by_period(replace(results, data=data)).axes
    assert [len(line.get_xdata()) for line in axes.lines] == [2, 2]


def test_motion_by_period_is_at_the_periods_of_its_own_waves(results):
    """Not of those with another heading, which may be another sea, nor of another variant's."""
    data = results.data.copy(deep=True)
    data["wave_frequency"] = data.wave_frequency * xr.DataArray([1.0, 1.7], dims="heading")
    own = figures.Results(study=results.study, data=data)
    with plain():
        (axes,) = arrays.by_period(own).axes
    assert axes.lines[0].get_xdata() == pytest.approx(2 * np.pi / np.array([2.0, 1.0, 0.5]))
    assert arrays.q_by_period(own, "one", "both")[0] == pytest.approx(2 * np.pi / np.array([2.0, 1.0, 0.5]))
    data["wave_frequency"] = data.wave_frequency * xr.DataArray([1.0, 1.1], dims="variant")
    assert arrays.q_by_period(own, "one", "both") is None


def test_captions_name_the_sea_of_what_goes_by_period(results):
    """That with the most waves that say something, not the highest."""
    data = results.data.copy(deep=True)
    data.rao.loc[{"sea_state": "rough", "component": 3}] = np.nan
    captions = {title: words for title, words, _ in entries(figures.Results(study=results.study, data=data))}
    assert "sea state calm," in captions["Motion of each float by period"]
    assert "by period from the RAO in calm, by heading in rough." in captions["Gain of the array"]


def test_motion_by_period_is_that_of_the_first_realization_that_did_not_fail(results):
    data = results.data.expand_dims(seed=[0, 1]).copy(deep=True)
    data.rao[0], data.wave_frequency[0] = np.nan, np.nan
    with plain():
        (axes,) = arrays.by_period(figures.Results(study=results.study, data=data)).axes
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), [2, 3, 1])


def test_floats_that_move_alike_have_one_name_in_the_key(results):
    """Where one lies over the other along every period, else each has its own."""
    for other, names in ((1.0, ["front, side"]), (1.1, ["front", "side"])):
        data = results.data.copy(deep=True)
        data.rao[0, ..., 1, 0, :] = other * data.rao[0, ..., 0, 0, :]
        with plain():
            (axes,) = arrays.by_period(figures.Results(study=results.study, data=data)).axes
        assert [text.get_text() for text in axes.get_legend().get_texts()] == names


def test_the_gain_is_over_as_many_floats_alone(results):
    """12 W over twice 5 W; half as much more from the other heading; by period c|rao|² of each."""
    assert arrays.alone(results) == ("one", ["both"])
    with plain():
        by_period, by_heading, by_sea = arrays.gain(results).axes
    exact = [(4 + 1) / (2 * 4), (9 + 4) / (2 * 1), (1 + 1) / (2 * 4)]
    assert by_period.lines[0].get_ydata() == pytest.approx(exact)
    np.testing.assert_allclose(by_heading.lines[0].get_xydata(), [[0, 1.2], [np.degrees(0.5), 1.8]])
    assert by_sea.lines[0].get_ydata() == pytest.approx([1.2, 1.2])
    titles = [title for title, _, _ in entries(results)]
    assert {"From above", "Motion of each float by period", "Gain of the array"} <= set(titles)


MOORED = (
    "[[floats.lines]]\nanchor = [{}, {}, -50.0]\nfairlead = [0.0, 0.0, -0.5]\nlength = 80.0\nweight = 9.0\nEA = 1e7\n"
)


@pytest.mark.parametrize(
    ("old", "new", "alike"),
    [
        ("100e3", "50e3", False),
        ("radius = 1.0", "radius = 1.1", False),
        ("2147.0", '"balance"', False),
        ("2.6]\narm = [-2.36, 0.0, -2.6]", "1.6]\narm = [-2.36, 0.0, -1.6]", False),
        ("[7.5, 9.0", "[-80.0, -7.7", True),
        ("100e3", "100e3\noffset = 0.1", True),
    ],
)
def test_the_gain_is_of_floats_alike_in_all_but_place(small, old, new, alike):
    """One alone is not what another would take: q would not be 1 of floats that know nothing of each other."""
    assert TWIN.count(old) == 1
    study = of_two(small, FRONT, TWIN.replace(old, new))
    found = arrays.alone(figures.Results(study=study, data=dataset()))
    assert found == (("one", ["both"]) if alike else None)


@pytest.mark.parametrize(("anchor", "alike"), [((67.5, 9.0), True), ((58.5, 0.0), False)])
def test_moored_floats_are_alike_with_their_anchors_alike_about_them(small, anchor, alike):
    study = of_two(small, FRONT + MOORED.format(58.5, 0.0), TWIN + MOORED.format(*anchor))
    assert (arrays.alone(figures.Results(study=study, data=dataset())) is not None) == alike


def test_each_axis_counts_by_its_own_damping(small):
    """Two of a float move twice and thrice as far as the wave."""
    several = FRONT.replace("pto_damping = 100e3", "motion = ['surge', 'heave']\npto_damping = [3e3, 7e3]")
    (item, _) = of_two(small, several, TWIN).content.floats
    rao = xr.DataArray([[[2.0], [3.0]]], dims=("float", "axis", "component"))
    power = arrays._linear(item, rao.assign_coords({"float": ["front"], "axis": ["surge", "heave"]}))
    assert power == pytest.approx([3e3 * 4 + 7e3 * 9])


def test_there_is_no_gain_without_one_alone(results):
    data = results.data.isel(variant=[0])
    assert arrays.gain(figures.Results(study=results.study, data=data)) is None
    assert arrays.gain(figures.Results(study=results.study, data=data.isel(variant=0))) is None


@pytest.mark.parametrize("law", ["coulomb = 100.0", "force_limit = 9e3", "declutch_load = 9e3", "latch_load = 9e3"])
def test_power_take_offs_that_are_not_linear_have_no_gain_by_period(results, small, law):
    small.write_text(small.read_text().replace("pto_damping = 100e3", f"pto_damping = 100e3\n{law}"))
    bent = figures.Results(study=load(small), data=results.data)
    with plain():
        names = [axes.get_xlabel() for axes in arrays.gain(bent).axes]
    assert names == ["heading [°]", "sea state"]
