"""Names of dimensions that a study gives: each is refused before anything runs, or goes through all that is told."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from pipeline import report, results
from pipeline.bridge.loading import load
from pipeline.report import page
from pipeline.report.figures import Results
from pipeline.report.yearly import BESIDE
from pipeline.results import dataset
from pipeline.results.store import Store
from pipeline.study.axes import TAKEN
from pipeline.study.reading import StudyError
from pipeline.study.tables import NAME

ROOMS = [Path(room.__path__[0]) for room in (report, results)]
OWN = ("estimate", "life", *BESIDE)  # what tables add to numbers
FREE = ("name", "self")


def numbers(dim):
    """Of one float and leg on fixed ground: two sea states and realizations, two labels along `dim`."""
    rng, dims = np.random.default_rng(7), (dim, "sea_state", "seed")
    inner = {
        "absorbed_power": ("float", "statistic"),
        "rotation": ("float", "statistic"),
        "rotation_response": ("float", "frequency_band"),
        "rotation_coherence": ("float", "frequency_band"),
        "hinge_force": ("float", "direction", "statistic"),
        "damage": ("leg", "fibre"),
        "displacement_envelope": ("leg", "height"),
        "stress_envelope": ("leg", "height"),
        "utilisation": ("tube", "statistic"),
        "natural_frequency": ("mode",),
        "wave_elevation_spectrum": ("frequency_band",),
        "estimated_error": (),
        "wall_time": (),
    }
    labels = {
        "float": ["front"], "statistic": ["max", "min", "mean", "rms"], "direction": ["x"], "leg": [1], "fibre": [1],
        "height": [-50.0, 2.6], "tube": ["leg"], "mode": [1, 2], "frequency_band": [1, 2, 3],
    }  # fmt: skip
    own = {"sea_state": ["calm", "rough"], "seed": [0, 1], dim: [1, 2]}
    each = {name: (*dims, *more) for name, more in inner.items()}
    sizes = {name: len(values) for name, values in {**own, **labels}.items()}
    data = {name: (of, 1 + rng.random([sizes[d] for d in of])) for name, of in each.items()}
    data["status"] = (dims, np.full((2, 2, 2), "done"))
    data["task"] = (dims, np.arange(8).reshape(2, 2, 2).astype(str))
    data["band_frequency"] = ("frequency_band", np.array([0.5, 1.0, 2.0]))
    beside = {
        "platform": "fixed", "Hs": ("sea_state", [0.5, 2.0]), "Tp": ("sea_state", [5.0, 7.0]), "pto_damping": 1e5,
        "occurrence": ("sea_state", [3.0, 1.0]),
    }  # fmt: skip
    found = xr.Dataset(data, coords={**beside, **own, **labels})
    found[dim].attrs["long_name"] = "Values of floats.front.mass"
    return found


def told(small, word):
    """The page of a study with a dimension of this name; what is wrong with it if it is refused."""
    text = small.read_text().replace('["elastic", "fixed", "elastic-no-floats"]', '["fixed"]')
    group = f'[[axes.together]]\nname = "{word}"\n"floats.front.mass" = [2147.0, 2148.0]\n'
    path = small.with_name("named.toml")
    path.write_text(text.replace("[sea_states]", f"{group}[sea_states]"))
    try:
        study = load(path)
    except StudyError as error:
        return str(error)
    dataset.collect(study, Store(small.parent, "named"))
    return page.html(Results(study=study, data=numbers(word)))


def refused(word):
    return f"named.toml: axes.together.name = {word}: is the name of another dimension, coordinate or output"


def words():
    """Strings and parameters of the code that collects and reports."""
    trees = (ast.parse(path.read_text()) for room in ROOMS for path in room.glob("*.py"))
    nodes = [node for tree in trees for node in ast.walk(tree)]
    texts = {getattr(node, key, None) for node in nodes for key in ("value", "arg")}
    return sorted(text for text in texts if isinstance(text, str) and re.match(NAME, text) and len(text) <= 100)


@pytest.mark.parametrize("word", OWN)
def test_what_tables_add_to_numbers_names_no_dimension(small, word):
    assert word in TAKEN and told(small, word).endswith(refused(word))


@pytest.mark.parametrize("word", ["rotation_response", "wave_elevation_spectrum", "mass_found"])
def test_what_goes_with_an_output_names_no_dimension(small, word):
    assert told(small, word).endswith(refused(word))


@pytest.mark.parametrize("word", FREE)
def test_parameters_of_functions_may_be_dimensions(small, undrawn, word):
    page = told(small, word)
    assert f"{word} 1" in page and f"{word} (2)" in page


@pytest.mark.slow
def test_any_word_of_the_code_is_refused_or_goes_through(small, undrawn):
    pages = ((word, told(small, word)) for word in words())
    assert [w for w, page in pages if not (page.endswith(refused(w)) or f"{w.replace('_', ' ')} (2)" in page)] == []
