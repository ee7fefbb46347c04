"""Coordinates of the dataset that tell of the sea: each task's own, along no more dimensions than it needs."""

import numpy as np
import pytest
from pytest import approx

from pipeline.bridge.loading import load
from pipeline.bridge.realizations import shape
from pipeline.results import dataset
from pipeline.results.store import Store
from pipeline.study import seas
from pipeline.tasks.task import axes, dimensions

MIXED = (
    "calm = { Hs = 0.5, Tp = 5.0 }\nrough = { Hs = 2.0, Tp = 7.0 }",
    """calm = { Hs = 0.5, Tp = 5.0, occurrence = 5 }
rough = { kind = "regular", height = 0.4, period = 7.0, occurrence = 3 }""",
)
SCALE = """[[axes.together]]
name = "scale"
sea_states.calm.Tp = [5.0, 6.0, 5.0]
sea_states.rough.period = [6.0, 7.0, 8.0]
"""
TWO = "[variants.a]\n[variants.b]\n"
EACH = "[variants.a]\naxes.sea_state = ['calm']\n[variants.b]\naxes.sea_state = ['rough']\n"
OF_SEAS = ("sea_state",)
CASES = {
    "as the study has them": ((), "", {"Hs": OF_SEAS, "Tp": OF_SEAS}),
    "one sea": (('["calm", "rough"]', '["calm"]'), '"sea.Tp" = [5.0, 6.0]', {"Hs": OF_SEAS, "Tp": ("Tp",)}),
    "a path of all": ((), '"sea.Hs" = [0.4, 0.6]', {"Hs": ("Hs",), "Tp": OF_SEAS}),
    "a path of one": ((), '"sea_states.calm.Hs" = [0.4, 0.6]', {"Hs": (*OF_SEAS, "sea_states.calm.Hs"), "Tp": OF_SEAS}),
    "a variant": ((), f"{TWO}sea.Hs = 0.7\n", {"Hs": (*OF_SEAS, "variant"), "Tp": OF_SEAS}),
    "variants of one sea each": (
        (),
        f"{EACH}sea.Hs = 0.7\n",
        {"Hs": OF_SEAS, "Tp": OF_SEAS},
    ),
    "variants of one sea each, and a group": (
        (),
        f"{EACH}sea.Hs = 0.7\n[[axes.together]]\nname = 'scale'\nsea_states.calm.Tp = [5.0, 6.0]\n",
        {"Hs": OF_SEAS, "Tp": (*OF_SEAS, "scale")},
    ),
    "together": (
        MIXED,
        SCALE,
        {"Hs": OF_SEAS, "Tp": (*OF_SEAS, "scale"), "wave_height": OF_SEAS, "wave_period": (*OF_SEAS, "scale"),
         "occurrence": OF_SEAS},
    ),
    "another kind": (
        (MIXED[0], MIXED[1].replace(", occurrence = 5", "").replace(", occurrence = 3", "")),
        f"{TWO}sea_states.rough = {{ kind = 'irregular', Hs = 0.3, Tp = 6.0 }}\n",
        {"Hs": (*OF_SEAS, "variant"), "Tp": (*OF_SEAS, "variant"), "wave_height": (*OF_SEAS, "variant"),
         "wave_period": (*OF_SEAS, "variant")},
    ),
    "a mean period": (('Tp = 5.0 }', 'Tp = 5.0, form = "mean" }'), "", {"Hs": OF_SEAS, "Tp": OF_SEAS}),
    "a mean period beside another shape": (
        (MIXED[0], "calm = { Hs = 0.5, Tp = 5.0 }\nrough = { Hs = 2.0, Tp = 7.0, spectrum = 'jonswap' }"),
        f"{TWO}waves.form = 'mean'\n",
        {"Hs": OF_SEAS, "Tp": (*OF_SEAS, "variant")},
    ),
    "samples": ((), "[samples]\ncount = 3\nsea.Hs = { from = 0.3, to = 0.4 }\n", {"Hs": ("sample",), "Tp": OF_SEAS}),
}  # fmt: skip


def changed(small, change, more):
    """The small study with some text in another's place, and more tables or axes."""
    text = small.read_text()
    text = text.replace(*change, 1) if change else text
    under = "[sea_states" if more.startswith("[") else "seed = "
    small.write_text(text.replace(under, f"{more}\n{under}", 1))
    return load(small)


def coordinates(study):
    """As the dataset has them."""
    table, outer = axes(study.content), dimensions(study.content)
    return dataset._coordinates(study, table, outer, dataset.Arrays((), None))


@pytest.mark.parametrize("case", CASES)
def test_numbers_of_seas_are_those_of_each_task(small, case):
    """Read off at each task's labels they are its parameters', and NaN where its sea has no such number.

    The peak period is that of the solver's spectrum, also where the study gives a mean period.
    """
    change, more, dims = CASES[case]
    study = changed(small, change, more)
    table, found = axes(study.content), coordinates(study)
    numbers = {name: found[name] for name in ("Hs", "Tp", "wave_height", "wave_period", "occurrence") if name in found}
    assert {name: v.dims for name, v in numbers.items()} == dims
    for task in study.tasks:
        sea, waves = task.parameters.sea_state, task.parameters.waves
        own = seas.labels(sea, waves)
        if isinstance(sea, seas.Irregular):
            own["Tp"] = 2 * np.pi / shape(sea, waves).peak_frequency
        often = study.content.sea_states[task.labels["sea_state"]].occurrence
        own |= {} if often is None else {"occurrence": often}
        at = {name: table[name].index(label) for name, label in task.labels.items()}
        read = {name: float(v.values[tuple(at[dim] for dim in v.dims)]) for name, v in numbers.items()}
        assert {name: number for name, number in read.items() if np.isfinite(number)} == approx(own, rel=1e-14)


@pytest.mark.parametrize(("form", "words"), [("peak", "Nominal peak period"), ("mean", "Tp (sea.Tp)")])
def test_an_axis_of_mean_periods_is_not_called_one_of_peaks(small, form, words):
    """Its labels are the key's values, whatever that holds."""
    study = changed(small, ("[waves]", f"[waves]\nform = '{form}'"), '"sea.Tp" = [5.0, 6.0]')
    axis = coordinates(study)["Tp"]
    assert axis.values.tolist() == [5.0, 6.0] and axis.attrs["units"] == "s"
    assert axis.attrs["long_name"] == words and ("standard_name" in axis.attrs) is (form == "peak")


@pytest.mark.parametrize("change", [("4, 5", "6, 7"), ("[s]", "[h]"), ("period", "time")])
def test_words_beside_an_axis_make_a_dataset_anew(small, tmp_path, change):
    group = "[[axes.together]]\nname = 'scale'\n'waves.heading' = [0.0, 0.1]\n'period [s]' = [4, 5]\n"
    store = Store(tmp_path / "results", "small")
    before = dataset._fingerprint(changed(small, (), group), store)
    small.write_text(small.read_text().replace(group, group.replace(*change)))
    assert dataset._fingerprint(load(small), store) != before


def test_another_range_of_samples_makes_a_dataset_anew(small, tmp_path):
    """Also of a key that no task depends on, as of a platform in studies without one: labels alone are others."""
    store, ends = Store(tmp_path / "results", "small"), "[samples]\ncount = 2\nplatform.damping_ratio"
    before = changed(
        small, ('["elastic", "fixed", "elastic-no-floats"]', '["fixed"]'), ends + " = { from = 0.01, to = 0.02 }"
    )
    small.write_text(small.read_text().replace("to = 0.02", "to = 0.03"))
    after = load(small)
    assert [task.id for task in before.tasks] == [task.id for task in after.tasks]
    assert dataset._fingerprint(after, store) != dataset._fingerprint(before, store)


@pytest.mark.parametrize(
    ("motion", "unit"),
    [("hinge", "N m s rad-1"), ("heave", "N s m-1"), ("heave hinge", None), ("heave fixed", "N s m-1")],
)
def test_damping_of_all_has_the_unit_of_their_axes(small, motion, unit):
    """And none where some turn and some slide."""
    text = small.read_text()
    first, second = (motion.split() * 2)[:2]
    front = text[text.index("[[floats]]") : text.index("[platform]")] + f"motion = ['{first}']\n"
    other = front.replace('"front"', '"other"').replace("-1.5, 0.0", "9.5, 0.0").replace(first, second)
    if second == "fixed":
        other = other.replace("['fixed']", "[]").replace("pto_damping = 100e3\n", "")
    floats = front + other
    text = (
        text[: text.index("[[floats]]")] + floats + "[axes]\npto_damping = [1e4, 2e4]\n" + text[text.index("[sea_st") :]
    )
    small.write_text(text)
    assert coordinates(load(small))["pto_damping"].attrs.get("units") == unit


def test_a_study_of_one_sea_has_scalars(small):
    text = (
        small.read_text().replace('sea_state = ["calm", "rough"]\n', "").replace("rough = { Hs = 2.0, Tp = 7.0 }", "")
    )
    small.write_text(text)
    found = coordinates(changed(small, (), f"{TWO}sea.Tp = 6.0\n"))
    assert (found["Hs"].dims, found["Hs"].values, found["Tp"].dims) == ((), 0.5, ("variant",))
    assert found["Tp"].values.tolist() == [5.0, 6.0]
