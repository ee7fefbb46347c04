"""A small study and an engine without physics, quick enough to run hundreds of times."""

import copy
import os
import sys
from dataclasses import dataclass, field
from pathlib import Path

import cloudpickle
import empty
import numpy as np
import pytest

from pipeline.bridge import cache
from pipeline.bridge import engine as physics
from pipeline.cli import actions
from pipeline.study.reading import read
from pipeline.study.schema import StudyFile
from pipeline.tasks.study import Study
from pipeline.tasks.task import wave_seed

# Workers cannot import this file; they get its functions by value.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

BUAN = Path(__file__).parents[2] / "studies" / "buan.toml"

SMALL = """
[water]
depth = 50.0
[waves]
band = [0.7, 3.4]
[[floats]]
name = "front"
hull = { shape = "hemisphere-cylinder", radius = 1.0, height = 0.6 }
mass = 2147.0
inertia = [859.0, 859.0, 859.0]
hinge = [-1.5, 0.0, 2.6]
arm = [-2.36, 0.0, -2.6]
pto_damping = 100e3
[platform]
clamped = ["foot"]
legs = ["leg"]
[platform.nodes]
foot = [-1.5, 0.0, -50.0]
[platform.materials.steel]
E = 2.1e11
G = 8.33e10
density = 8012.0
[platform.sections.tube]
shape = "tube"
diameter = 1.0
thickness = 0.05
[[platform.members]]
name = "leg"
start = "foot"
end = "hinge:front"
elements = 4
section = "tube"
material = "steel"
[axes]
sea_state = ["calm", "rough"]
platform = ["elastic", "fixed", "elastic-no-floats"]
seed = [0, 1]
[sea_states]
calm = { Hs = 0.5, Tp = 5.0 }
rough = { Hs = 2.0, Tp = 7.0 }
"""


@dataclass
class FakeRecord:
    variables: dict
    coords: dict
    attrs: dict
    series: dict = field(default_factory=dict)


def fake_coefficients(geometry):
    return f"coefficients of {geometry.key}".encode()


def fake_require_whole(data, key):
    """These coefficients are no netCDF file."""
    if data != f"coefficients of {key}".encode():
        raise ValueError(key)


def fake_compute(parameters, coefficients):
    """Numbers that depend on the parameters alone; seed 666 fails, seed 667 kills its process."""
    if parameters.seed == 666:
        raise RuntimeError("the platform left")
    if parameters.seed == 667:
        os._exit(1)
    assert (coefficients is None) == (not parameters.floats)
    rng = np.random.default_rng(list(wave_seed(parameters)))
    statistics = ["max", "min", "mean", "rms", "std"]
    variables = {"wave_elevation": (("statistic",), rng.normal(size=5) * parameters.sea_state.Hs)}
    coords = {"statistic": np.array(statistics)}
    if parameters.floats:
        coords["float"] = np.array([f.name for f in parameters.floats])
        variables["rotation"] = (
            ("float", "statistic"),
            rng.normal(size=(len(parameters.floats), 5)),
        )
    if parameters.platform:
        coords["leg"], coords["height"] = np.array([1]), np.array([-50.0, 2.6])
        coords["mode"] = np.array([1, 2])
        variables["displacement_envelope"] = (("leg", "height"), rng.random((1, 2)))
        variables["natural_frequency"] = (("mode",), np.array([0.4, 3.1]))
    attrs = {"energy_residual": 1e-4, "Tp": 5.1, "wall_time": rng.random(), "note": "fake"}
    return FakeRecord(variables, coords, attrs)


@pytest.fixture
def engine(monkeypatch):
    """The engine without physics, also for the command line."""
    fake = empty.without_physics(fake_coefficients, fake_compute)
    monkeypatch.setattr(physics, "Engine", lambda: fake)
    monkeypatch.setattr(cache.Cache.__init__, "__defaults__", (fake_require_whole,))
    monkeypatch.setattr(actions, "REPORTED", 0)  # figures take longer than all the rest
    return fake


@pytest.fixture
def undrawn(monkeypatch):
    """Figures of a page are made and not drawn, which takes longest: for its words, where others draw the same."""
    monkeypatch.setattr("pipeline.report.page.svg", lambda figure: "")


@pytest.fixture
def small(tmp_path):
    """The small study's file."""
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


@pytest.fixture(scope="session")
def _buan_tables():
    return read(BUAN)


@pytest.fixture
def buan_tables(_buan_tables):
    """The Buan study as raw tables, to be changed."""
    return copy.deepcopy(_buan_tables)


@pytest.fixture
def study_of():
    """A study from raw tables."""
    return lambda tables: Study(path=Path("test.toml"), content=StudyFile.model_validate(tables))
