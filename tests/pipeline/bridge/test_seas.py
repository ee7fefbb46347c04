"""Sea states of every kind from a study file: what they become, what they are called, and what is refused."""

import io
import pickle

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from pipeline.bridge import preflight, realizations, scenes
from pipeline.bridge.engine import Engine
from pipeline.bridge.geometry import bem_arguments, bem_problem, geometry_of
from pipeline.bridge.loading import load
from pipeline.results.netcdf import to_bytes
from pipeline.results.records import made
from pipeline.study.reading import StudyError
from pipeline.tasks.task import expand

HEAD = """
[water]
depth = inf
[waves]
heading = 0.3
{waves}
[[floats]]
name = "only"
hull = {{ shape = "sphere", radius = 5.0, draft = 5.0 }}
mass = 261.8e3
inertia = [2.6e6, 2.6e6, 2.6e6]
hinge = [0.0, 0.0, 0.0]
motion = ["heave"]
[axes]
seed = [0, 1]
[sea_states]
only = {sea}
"""
BAND = "band = [0.2, 3.0]"
CSV = {
    "spectrum.csv": "omega, S\n0.0, 0.0\n0.5, 0.0\n1.0, 2.0\n2.0, 0.0\n",
    "hertz.csv": "# a buoy's\nS [m^2/Hz], frequency [Hz]\n0,0.08\n12.566370614359172, 0.15915494309189535\n0,0.32\n",
    "components.csv": "phase [deg],amplitude,omega,remark\n90,0.2,1.5,first\n0,0.1,0.7,second\n",
    "elevation.csv": "time [s], elevation [m]\n" + "".join(f"{t},{np.cos(np.pi / 4 * t)}\n" for t in range(64)),
}


@pytest.fixture
def study_with(tmp_path):
    """A study with one sea state, as text, and files beside it."""

    def made(sea, waves=BAND, **files):
        for name, text in {**CSV, **{f"{k}.csv": v for k, v in files.items()}}.items():
            (tmp_path / name).write_text(text)
        path = tmp_path / "sea.toml"
        path.write_text(HEAD.format(sea=sea, waves=waves))
        return load(path)

    return made


def first(study):
    return next(iter(expand(study.content))).parameters


def eta(sea, t):
    return (sea.amplitude * np.exp(-1j * np.outer(t, sea.omega))).sum(axis=1).real


def test_still_water_has_no_waves_and_needs_no_band(study_with):
    parameters = first(study_with('{ kind = "still" }', waves=""))
    assert not scenes.sea(parameters).amplitude.any()
    assert scenes.scene(parameters).water.depth == np.inf
    assert '"depth":"inf"' in parameters.canonical()


def test_a_regular_wave(study_with):
    sea = scenes.sea(first(study_with('{ kind = "regular", height = 2.0, period = 8.0, phase = 0.5 }', waves="")))
    assert eta(sea, np.array([1.0])) == approx(np.cos(0.5 - np.pi / 4))
    assert sea.heading == 0.3


def test_white_noise_fills_the_band(study_with):
    sea = scenes.sea(first(study_with('{ kind = "white-noise", Hs = 0.5 }', waves=BAND + '\nintervals = "even"')))
    assert np.ptp(np.abs(sea.amplitude)) < 1e-12
    assert sea.parameters()["Hm0"] == approx(0.5)


@pytest.mark.parametrize("where", ["waves", "row"])
def test_jonswap_for_the_study_or_for_one_row(study_with, where):
    keys = 'spectrum = "jonswap"{} gamma = 5.0'
    if where == "waves":
        study = study_with("{ Hs = 1.0, Tp = 8.0 }", waves=BAND + "\n" + keys.format("\n"))
    else:
        study = study_with("{ Hs = 1.0, Tp = 8.0, " + keys.format(",") + " }")
    from solver.sea.realization import realize
    from solver.sea.spectrum import Jonswap

    parameters = first(study)
    shape = Jonswap(Hs=1.0, Tp=8.0, gamma=5.0)
    from pipeline.tasks.task import wave_seed

    known = realize(shape, components=130, band=(0.2, 3.0), seed=wave_seed(parameters), heading=0.3)
    assert np.array_equal(scenes.sea(parameters).amplitude, known.amplitude)


FOREIGN = r'waves\.gamma = {}: is for spectrum = "jonswap", not "pierson-moskowitz"'
OTHERS = [
    "{ Hs = 1.0, Tp = 8.0 }",
    '{ kind = "regular", height = 1.0, period = 8.0 }',
    '{ Hs = 1.0, Tp = 8.0, spectrum = "pierson-moskowitz" }',
]


@pytest.mark.parametrize("sea", OTHERS)
@pytest.mark.parametrize("gamma", [3.3, 5.0])
def test_a_gamma_that_no_sea_has_is_refused(study_with, sea, gamma):
    """The default's value, too."""
    with pytest.raises(StudyError, match=FOREIGN.format(gamma)):
        study_with(sea, waves=f"{BAND}\ngamma = {gamma}")
    with pytest.raises(StudyError, match=FOREIGN.format(gamma)):
        study_with(f'{sea}\n[[axes.together]]\nname = "peak"\n"waves.gamma" = [{gamma}, 1.0]\nnumber = [1, 2]')


@pytest.mark.parametrize("values", [["jonswap", "jonswap"], ["pierson-moskowitz", "jonswap"]])
@pytest.mark.parametrize("path", ["waves.spectrum", "sea.spectrum"])
def test_a_gamma_of_some_seas_is_let_pass(study_with, path, values):
    """A sea state's own spectrum, or one along an axis."""
    row = "{ Hs = 1.0, Tp = 8.0 }\nother = { Hs = 1.0, Tp = 8.0, spectrum = 'jonswap' }"
    study_with(row, waves=f"{BAND}\ngamma = 2.0")
    along = f"\n[[axes.together]]\nname = 'shape'\n'{path}' = {values}\nnumber = [1, 2]"
    study_with(f"{{ Hs = 1.0, Tp = 8.0 }}{along}", waves=f"{BAND}\ngamma = 2.0")
    later = f"\n[variants.usual]\n[variants.other]\n'{path}' = 'jonswap'"
    study_with(f"{{ Hs = 1.0, Tp = 8.0 }}{later}", waves=f"{BAND}\ngamma = 2.0")


def test_a_spectrum_from_a_file(study_with):
    """A triangle of 1.5 m²: Hm0 = 4 √1.5, the same in rad/s and in Hz but for the feet of the triangle."""
    sea = scenes.sea(first(study_with('{ kind = "spectrum", file = "spectrum.csv" }', waves="components = 400")))
    assert sea.omega[0] > 0.5 and sea.omega[-1] < 2.0  # without a band that of the file
    assert sea.parameters()["Hm0"] == approx(4 * np.sqrt(1.5), rel=2e-3)
    hertz = scenes.sea(first(study_with('{ kind = "spectrum", file = "hertz.csv" }', waves="components = 400")))
    area = (0.32 - 0.08) * 4 * np.pi / 2
    assert hertz.parameters()["Hm0"] == approx(4 * np.sqrt(area), rel=2e-3)


@pytest.mark.parametrize(("kind", "height"), [
    ("spectrum", 4 * np.sqrt(1.5)), ("components", 4 * np.sqrt((0.1**2 + 0.2**2) / 2)), ("elevation", 4 * np.sqrt(0.5)),
])  # fmt: skip
def test_what_holds_in_high_seas_does_in_those_from_files(study_with, kind, height):
    sea, brake = f'{{ kind = "{kind}", file = "{kind}.csv" }}', '"floats.only.coulomb" = 1e9'
    for above, locked in ((0.999 * height, 1e9), (1.001 * height, 0.0)):
        lower = f"low = {{ Hs = 0.1, Tp = 8.0 }}\nhigh = {{ Hs = 9.0, Tp = 8.0 }}\n[survival]\nHs = {above}\n{brake}"
        tasks = {t.labels["sea_state"]: t for t in study_with(f"{sea}\n{lower}").tasks}
        assert [tasks[s].parameters.floats[0].coulomb for s in ("only", "low", "high")] == [locked, 0.0, 1e9]
    with pytest.raises(StudyError, match=f"survival.Hs = 9.0: no sea .* the highest has Hs = {height:g} m"):
        study_with(f"{sea}\n[survival]\nHs = 9.0\n{brake}")
    with pytest.raises(StudyError, match=r"x\.csv.*no such file"):
        study_with(f'{{ kind = "{kind}", file = "x.csv" }}\n[survival]\nHs = 9.0\n{brake}')


@pytest.mark.parametrize(("phase", "height"), [(0.0, 0.3), (np.pi, 0.1), (np.pi / 2, np.hypot(0.1, 0.2))])
def test_lines_of_one_frequency_are_one_wave_of_a_sea_that_decides(study_with, phase, height):
    sea, brake = '{ kind = "components", file = "x.csv" }', '"floats.only.coulomb" = 1e9'
    rows = f"omega, amplitude, phase\n1.0, 0.1, 0.0\n2.0, 0.05, 0.0\n1.0, 0.2, {phase}\n"
    whole = 4 * np.sqrt((height**2 + 0.05**2) / 2)
    for above, locked in ((0.999 * whole, 1e9), (1.001 * whole, 0.0)):
        higher = f"high = {{ Hs = 9.0, Tp = 8.0 }}\n[survival]\nHs = {above}\n{brake}"
        tasks = {t.labels["sea_state"]: t for t in study_with(f"{sea}\n{higher}", x=rows).tasks}
        assert tasks["only"].parameters.floats[0].coulomb == locked
        assert scenes.sea(tasks["only"].parameters).parameters()["Hm0"] == approx(whole)


@pytest.mark.parametrize("rows", ["2,0\n1,3\n0.5,0\n", "0.5,1\n1,1\n0.2,1\n", "1,2\n1,2\n"])
def test_beside_high_seas_a_spectrum_is_refused_for_its_frequencies(study_with, rows):
    """They must rise; how high a sea that is not one would be, nobody is told."""
    sea, brake = '{ kind = "spectrum", file = "x.csv" }', '"floats.only.coulomb" = 1e9'
    for Hs in (0.01, 9.0):
        with pytest.raises(StudyError) as caught:
            study_with(f"{sea}\n[survival]\nHs = {Hs}\n{brake}", x=f"omega, S\n{rows}")
        (problem,) = caught.value.problems
        assert ", the one before" in problem and "sea_states.only.file = x.csv: line" in problem


def test_components_from_a_file(study_with):
    sea = scenes.sea(first(study_with('{ kind = "components", file = "components.csv" }', waves="")))
    t = np.linspace(0, 9, 10)
    assert eta(sea, t) == approx(0.2 * np.cos(1.5 * t - np.pi / 2) + 0.1 * np.cos(0.7 * t))


def test_an_elevation_record_comes_back(study_with):
    sea = scenes.sea(first(study_with('{ kind = "elevation", file = "elevation.csv" }')))
    assert eta(sea, np.arange(64.0)) == approx(np.cos(np.pi / 4 * np.arange(64)), abs=1e-9)
    assert "repeats after 64 s" in sea.notes[0]


def test_what_a_record_leaves_out_is_told_under_the_seas_own_name(study_with):
    study = study_with('{ kind = "elevation", file = "elevation.csv" }')
    told = preflight.judge(study, expand(study.content), Engine())
    assert any(text.startswith("sea_states.only: elevation record: mean level ") for text in told)


@pytest.mark.parametrize(
    ("sea", "waves", "told"),
    [
        ("{ Hs = 1.0, Tp = 7.0 }", "band = [0.85, 3.0]", "their spectrum has 1 m: 0.882 m without the 22.13%"),
        ("{ Hs = 7.5, Tp = 8.0 }", "", "s have a steepness 2π Hs/(g Tp²) of 0.07"),
        (
            '{ kind = "components", file = "components.csv" }',
            "",
            "components.csv has columns that are not read: remark",
        ),
        ("{ Hs = 1.0, Tp = 7.0 }", "components = 1", "components = 1 have Hm0 = 0.816 m, and their spectrum has 1 m"),
        ('{ kind = "spectrum", file = "spectrum.csv" }', "band = [1.0, 3.0]", "has 4.9 m: 4 m without the 33.33% of"),
    ],
)
def test_a_sea_that_is_not_the_one_asked_for_is_told(study_with, sea, waves, told):
    """As a triangle from 0.5 to 1 and to 2 rad/s: a third of its area lies below its peak."""
    study = study_with(sea, waves=waves)
    (text,) = (t for t in preflight.judge(study, expand(study.content), Engine()) if t.startswith("sea_states.only"))
    assert told in text


def test_seeds_and_component_counts_decide_nothing_where_nothing_is_random(study_with):
    sea = '{ kind = "components", file = "components.csv" }'
    assert len({task.id for task in expand(study_with(sea).content)}) == 1
    fine, coarse = (first(study_with(sea, waves=f"{BAND}\ncomponents = {n}")).canonical() for n in (10, 20))
    assert fine == coarse
    assert len({task.id for task in expand(study_with("{ Hs = 1.0, Tp = 8.0 }").content)}) == 2


def test_a_file_is_known_by_its_content(study_with):
    sea = '{ kind = "components", file = "components.csv" }'
    before = first(study_with(sea))
    assert first(study_with(sea.replace("components.csv", "other.csv"), other=CSV["components.csv"])) == before
    changed = first(study_with(sea, components=CSV["components.csv"].replace("0.2", "0.3")))
    assert changed.canonical() != before.canonical()
    assert scenes.sea(pickle.loads(pickle.dumps(before))).amplitude.tolist() == scenes.sea(before).amplitude.tolist()


def test_regular_waves_of_about_the_same_period_share_their_coefficients(study_with):
    def key(period, waves=""):
        sea = f'{{ kind = "regular", height = 0.1, period = {period} }}'
        return geometry_of(next(iter(expand(study_with(sea, waves).content))).parameters)

    assert key(8.0) == key(8.4) != key(9.5)
    assert key(4.0, BAND) == key(8.0, BAND)
    low, high = key(8.0).band
    assert low <= 2 * np.pi / 8 <= high


BAD = [
    ('{ kind = "regluar", height = 1 }', {}, "sea_states.only.kind = 'regluar': must be one of 'irregular', 'white-"),
    ('{ kind = "regular", height = 1.0 }', {}, "sea_states.only.period: is missing [s]"),
    ('{ kind = "regular", height = 9.0, period = 4.0 }', {}, "sea_states.only.height = 9.0: must be <= 3.55 m, where"),
    ('{ kind = "regular", height = 1.0, period = 70.0 }', {}, "sea_states.only.period = 70.0: must be <= 60 s"),
    ('{ kind = "regular", height = 0.1, period = 1.0 }', {}, "must put its frequency, 6.28 rad/s, inside waves.band"),
    ('{ kind = "white-noise", Hs = 9.0 }', {}, "sea_states.only.Hs = 9.0: must be <= "),
    ('{ kind = "still", Hs = 1.0 }', {}, "sea_states.only.Hs = 1.0: unknown key; known: occurrence, kind"),
    ("{ Hs = 1.0, Tp = 8.0, gamma = 2.0 }", {}, 'sea_states.only.gamma = 2.0: is for spectrum = "jonswap"'),
    ("{ Hs = 1.0, Tp = 8.0, gamma = 9.0 }", {}, "sea_states.only.gamma = 9.0: must be <= 7"),
    (
        '{ Hs = 1.0, Tp = 8.0, spectrum = "jonswap", form = "mean" }',
        {},
        'sea_states.only.form = mean: is for spectrum = "pierson',
    ),
    ('{ kind = "spectrum", file = "no.csv" }', {}, "sea_states.only.file = 'no.csv': no such file"),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "omega\n1"},
        "file = x.csv: line 1: needs a column S in its header",
    ),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "\n\nf,S\n1,1"}, "line 3: needs a column omega or frequency"),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "frequency,S\n1,1"},
        "line 1, column frequency: needs its unit, [Hz]",
    ),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "frequency [Hz],S\n1,1"},
        "line 1, column S: needs its unit, [m2 s",
    ),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "omega,S\n1,2\n2,1e"},
        "line 3, column S: '1e' must be a finite number",
    ),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n1,2\n2,-1"}, "line 3, column S: '-1' must be >= 0"),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n1,2\n2"}, "line 3, column S: '' must be a finite number"),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n2,1\n1,1"}, "line 3, column omega: 1 must be > 2, the"),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "# Hz\nS [m2/Hz], frequency [Hz]\n1, 0.2\n\n2, 0.10\n3, 0.3"},
        "line 5, column frequency: 0.10 must be > 0.2, the one before",
    ),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n2,1"}, "needs at least two increasing frequencies"),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "# a buoy's\nomega;S\n0,5;1,0\n1,0;2,0"},
        "file = x.csv: line 2: commas must part columns, not semicolons, and numbers have decimal points",
    ),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega\tS\n1\t1"}, "commas must part columns, not tabs"),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n9,1\n10,1"}, "file = x.csv: has no waves in waves.band"),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n"}, "file = x.csv: has a header and no numbers"),
    ('{ kind = "spectrum", file = "x.csv" }', {"x": "omega,S\n1,90\n2,90"}, "sea_states.only.file: Hm0 = 3"),
    (
        '{ kind = "spectrum", file = "x.csv" }',
        {"x": "omega,S,Direction [deg]\n1,1,30\n2,1,30"},
        "file = x.csv: line 1: column Direction must not be there: waves are long-crested",
    ),
    ('{ kind = "spectrum", file = "sea.toml" }', {}, "file = sea.toml: line 2: needs a column omega"),
    (
        '{ kind = "components", file = "x.csv" }',
        {"x": "amplitude,omega,phase\n1,0,0"},
        "frequencies must be >= 1e-06 rad/s",
    ),
    (
        '{ kind = "components", file = "x.csv" }',
        {"x": "amplitude,omega,phase\n.001,9,0"},
        "file = x.csv: must put all waves, 9 rad/s, inside",
    ),
    (
        '{ kind = "elevation", file = "x.csv" }',
        {"x": "time,elevation\n0,1\n1,0\n2,1\n4,0"},
        "sample 3 must lie at even",
    ),
    ('{ kind = "elevation", file = "x.csv" }', {"x": "time,elevation\n0,1\n1,0"}, "needs at least 4"),
]


@pytest.mark.parametrize(("sea", "files", "message"), BAD, ids=[row[2][-40:] for row in BAD])
def test_bad_seas_are_refused_in_one_line(study_with, tmp_path, sea, files, message):
    with pytest.raises(StudyError) as caught:
        study_with(sea, **files)
    assert any(line.startswith(f"{tmp_path / 'sea.toml'}: ") and message in line for line in caught.value.problems)


@pytest.mark.parametrize(
    "sea", ['{ kind = "white-noise", Hs = 1.0 }', '{ kind = "elevation", file = "elevation.csv" }']
)
def test_a_sea_that_needs_a_band_says_so(study_with, sea):
    with pytest.raises(StudyError, match=r"waves.band = nothing: is missing \[rad/s\], and sea_states.only is a sea"):
        study_with(sea, waves="")


@pytest.mark.parametrize(
    ("band", "told"),
    [("", "sea_states.only.period = 50.0: must be <= 47.12 s: it needs coefficients from 0.1257 rad/s on, which must"),
     ("band = [0.1, 3.0]", "waves.band = [0.1, 3.0]: must start where kh > 0.1 in 5.5 m, above 0.1333 rad/s")],
)  # fmt: skip
def test_waves_too_long_for_the_depth_are_named_as_they_were_given(study_with, monkeypatch, band, told):
    monkeypatch.setitem(globals(), "HEAD", HEAD.replace("depth = inf", "depth = 5.5"))
    with pytest.raises(StudyError) as caught:
        study_with('{ kind = "regular", height = 0.1, period = 50.0 }', waves=band)
    assert told in str(caught.value)


def test_the_longest_waves_that_hold_are_let_run(study_with, monkeypatch):
    """Whose octave begins in longer ones, for which there are no coefficients."""
    monkeypatch.setitem(globals(), "HEAD", HEAD.replace("depth = inf", "depth = 5.5"))
    parameters = first(study_with('{ kind = "regular", height = 0.1, period = 47.12 }', waves=""))
    assert bem_arguments(geometry_of(parameters))["omega"][0] * np.sqrt(5.5 / 9.81) > np.sqrt(0.1 * np.tanh(0.1))
    with pytest.raises(StudyError, match=r"Tp = 25.0: must be <= 23.56 s: it needs .* from 0.1257 rad/s"):
        study_with("{ Hs = 0.1, Tp = 25.0 }", waves="")


@pytest.mark.parametrize("Tp", [3.7, 4.6, 4.8, 9.0])
def test_coefficients_reach_a_little_further_than_the_waves_and_a_models_are_its_originals(study_with, monkeypatch, Tp):
    """Of a float long for the waves panels cost with the eighth power of the highest frequency."""
    made = []
    for scale in (1.0, 1 / 20):
        head = HEAD.replace("radius = 5.0, draft = 5.0", f"radius = {5 * scale}, draft = {5 * scale}")
        head = head.replace("261.8e3", f"{261.8e3 * scale**3}").replace("2.6e6", f"{2.6e6 * scale**5}")
        monkeypatch.setitem(globals(), "HEAD", head)
        parameters = first(study_with(f"{{ Hs = {0.1 * scale}, Tp = {Tp * scale**0.5} }}", waves=""))
        high, geometry = 6 * np.pi / (Tp * scale**0.5), geometry_of(parameters)
        assert high <= geometry.band[1] <= 2**0.25 * high
        made.append((np.array(geometry.band) * scale**0.5, bem_problem([geometry])))
    (band, whole), (model_band, model) = made
    assert model_band == approx(band) and model.counts == whole.counts
    assert model.omega * (1 / 20) ** 0.5 == approx(whole.omega)


SHAPES = [
    ("{ Hs = 1.0, Tp = 8.0 }", 2 * np.pi / 8),
    ('{ Hs = 1.0, Tp = 8.0, spectrum = "jonswap" }', 2 * np.pi / 8),
    ('{ Hs = 1.0, Tp = 8.0, form = "mean" }', (0.8 * 692) ** 0.25 / 8),
]


@pytest.mark.parametrize(("sea", "peak"), SHAPES, ids=["peak", "jonswap", "mean"])
def test_without_a_band_an_irregular_sea_has_half_to_three_times_its_peaks_frequency(study_with, sea, peak):
    """And so 1 % of its height less at most: of Pierson-Moskowitz's variance 1.5 % lie above three times the peak."""
    parameters = first(study_with(sea, waves=""))
    made = scenes.sea(parameters)
    assert 0.5 * peak < made.omega.min() < 0.6 * peak and 2.9 * peak < made.omega.max() < 3 * peak
    assert 0.985 < made.parameters()["Hm0"] < 1.0
    assert realizations.shape(parameters.sea_state, parameters.waves).peak_frequency == approx(peak)
    given = first(study_with(sea, waves=f"band = [{0.5 * peak!r}, {3 * peak!r}]"))
    assert scenes.sea(given).omega[[0, -1]] == approx([0.5 * peak, 3 * peak], rel=0.1)


def test_without_a_band_seas_of_about_the_same_period_share_coefficients(study_with):
    one, other = (geometry_of(first(study_with(f"{{ Hs = 1.0, Tp = {T} }}", waves=""))) for T in (8.0, 7.5))
    assert one == other and one.band[0] < np.pi / 8 and one.band[1] > 6 * np.pi / 7.5


def test_a_record_says_which_band_was_chosen(study_with):
    class Bare:
        variables, coords, attrs, series = {}, {}, {}, {}

    def said(parameters):
        record, _ = made(Bare(), parameters, {"task": "t"})
        return xr.open_dataset(io.BytesIO(to_bytes(*record))).attrs.get("waves_band")

    assert said(first(study_with("{ Hs = 1.0, Tp = 8.0 }", waves=""))).startswith("0.3927 to 2.356 rad/s")
    assert said(first(study_with("{ Hs = 1.0, Tp = 8.0 }"))) is None
    assert said(first(study_with('{ kind = "still" }', waves=""))) is None


def test_still_water_in_a_band_shares_coefficients_with_its_waves(study_with):
    still = geometry_of(next(iter(expand(study_with('{ kind = "still" }').content))).parameters)
    assert still == geometry_of(next(iter(expand(study_with("{ Hs = 1.0, Tp = 8.0 }").content))).parameters)


def test_still_water_alone_has_no_waves_to_tell_apart(study_with):
    still, rao = '{ kind = "still" }', "[record]\nrao = true\nduration = 40.0"
    for waves in (rao, f"{BAND}\n{rao}"):
        assert len(study_with(still, waves=waves).tasks.unique) == 1


def test_waves_too_close_for_the_record_cannot_have_an_rao(study_with, tmp_path):
    """Random intervals of 2.8/130 rad/s come as close as 0.6 of that: 2π over it are 486 s."""
    study_with("{ Hs = 1.0, Tp = 8.0 }", waves=f"{BAND}\n[record]\nrao = true\nduration = 487.0")
    with pytest.raises(StudyError, match=r"record.duration = 485.0: must be >= 486.2 s for record.rao"):
        study_with("{ Hs = 1.0, Tp = 8.0 }", waves=f"{BAND}\n[record]\nrao = true\nduration = 485.0")
    study_with("{ Hs = 1.0, Tp = 8.0 }", waves=f'{BAND}\nintervals = "even"\n[record]\nrao = true\nduration = 292.0')
    # Of few waves the first may be nearer to a mean than to the next: 0.3, or half if even, of 1.94/5 rad/s above 0.06.
    for more, least in (("", 35.62), ('intervals = "even"\n', 24.74)):
        few = f"band = [0.06, 2.0]\ncomponents = 5\n{more}[record]\nrao = true\nduration = 24.0"
        with pytest.raises(StudyError, match=f"record.duration = 24.0: must be >= {least} s for record.rao"):
            study_with("{ Hs = 1.0, Tp = 8.0 }", waves=few)
    regular = '{ kind = "regular", height = 1.0, period = 8.0 }'
    study_with(regular, waves="[record]\nrao = true\nduration = 8.0")
    with pytest.raises(StudyError, match=r"record.duration = 7.9: must be >= 8 s for record.rao"):
        study_with(regular, waves="[record]\nrao = true\nduration = 7.9")


def test_an_rao_of_the_frequency_domain_needs_no_record_of_any_length(study_with):
    """Where an axis has the time domain too, a record is analysed, which another axis may shorten."""
    sea = "{ Hs = 1.0, Tp = 8.0 }"
    waves = f'{BAND}\n[record]\nrao = true\nduration = 20.0\n[solver]\nmethod = "frequency"'
    study_with(sea, waves=waves)
    for name, keys in {
        "method": {"solver.method": ["frequency", "time"], "solver.froude_krylov": ["linear", "linear"]},
        "length": {"record.duration": [487.0, 485.0], "number": [1, 2]},
    }.items():
        sea += f"\n[[axes.together]]\nname = '{name}'\n" + "\n".join(f"'{k}' = {v}" for k, v in keys.items())
    with pytest.raises(StudyError, match=r"record.duration = 485.0: must be >= 486.2 s for record.rao"):
        study_with(sea, waves=waves)
    study_with(sea.replace("485.0", "488.0"), waves=waves)


def test_all_sea_states_have_an_occurrence_or_none(study_with):
    """A mean that left one out would be of other seas."""
    sea = "{{ Hs = 1.0, Tp = 8.0{} }}\n{} = {{ Hs = 1.5, Tp = 8.0 }}"
    assert len(study_with(sea.format("", "rare")).content.sea_states) == 2
    with pytest.raises(
        StudyError, match=r"sea_states\.rare\.occurrence = nothing: is missing: all sea states have one"
    ):
        study_with(sea.format(", occurrence = 300.0", "rare"))
    with pytest.raises(StudyError, match=r"sea_states\.only\.occurrence = -1\.0: must be > 0"):
        study_with("{ Hs = 1.0, Tp = 8.0, occurrence = -1.0 }")
