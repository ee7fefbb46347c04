"""The table of `make validate`, its judgements, and the cheap subjects themselves."""

import csv
import importlib
from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.errors import SimulationFailed
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.revolution import Revolution
from solver.scene import Float
from studies import validate
from studies.validation import checks, decay, drawing, response, sphere
from studies.validation.checks import Check

NUMBER = Check(case="case", quantity="a", ours=1.02, published=1.0, allowed=0.05)


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Figures and tables go to a folder of the test."""
    for module in (checks, drawing, validate):
        monkeypatch.setattr(module, "OUT", tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "changes, verdict",
    [
        ({}, "ok"),
        ({"allowed": 0.01}, "OUTSIDE"),
        ({"allowed": np.inf}, "shown"),
        ({"ours": np.nan}, "OUTSIDE"),
        ({"ours": np.nan, "allowed": np.inf}, "OUTSIDE"),
        ({"side": "above", "allowed": 0.0}, "ok"),
        ({"side": "below", "allowed": 0.0}, "OUTSIDE"),
        ({"side": "below", "allowed": 0.03}, "ok"),
        ({"side": "above", "allowed": 0.0, "ours": 0.9}, "OUTSIDE"),
    ],
)
def test_verdict(changes, verdict):
    assert replace(NUMBER, **changes).verdict == verdict


def test_one_number_outside_or_a_failed_subject_fails_the_run(capsys, elsewhere):
    assert validate.report([NUMBER], {}) == 0
    assert validate.report([NUMBER], {"decay": SimulationFailed("not finite")}) == 1
    assert "decay FAILED: SimulationFailed: not finite" in capsys.readouterr().out
    assert validate.report([NUMBER, replace(NUMBER, quantity="b", allowed=1e-3, note="why")], {}) == 1
    out = capsys.readouterr().out
    assert "OUTSIDE [1]" in out and "[1] why" in out and "2 numbers, 1 outside" in out
    with (elsewhere / "validate.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows] == ["ok", "OUTSIDE"]
    assert [float(row["difference"]) for row in rows] == approx([0.02, 0.02])


def test_an_unknown_subject_is_named(capsys):
    assert validate.main(["decai"]) == 2
    assert "decai: no such subject; there are hemisphere" in capsys.readouterr().err


def test_every_subject_is_a_function():
    for place in validate.SUBJECTS.values():
        module, function = place.split(".")
        assert callable(getattr(importlib.import_module(f"studies.validation.{module}"), function))
    assert set(validate.DEAREST) <= set(validate.SUBJECTS)


@pytest.mark.parametrize("subject", ["beams", "buan-modes", "pile"])
def test_cheap_subjects_pass_and_leave_their_figures(subject, elsewhere):
    checks, _ = validate.compare(subject)
    assert checks and all(c.passed for c in checks)
    # Closed forms of beams share the figure of the platform's modes.
    assert subject == "beams" or list(elsewhere.glob("*.png"))


def test_decay_from_published_coefficients_meets_the_published_extrema():
    """Hulme's four digits and a spline between 28 rows leave 1e-4 of the offset and 2e-4 s."""
    t = np.arange(0, 10, 0.02)
    extrema = np.array(decay.extrema(t, decay.exact(t))[:4])
    assert extrema == approx(np.array(decay.EXTREMA), abs=2e-4)


@pytest.fixture(scope="module")
def coarse():
    """The OES sphere on few panels: enough for what holds whatever the coefficients are."""
    hull = Revolution.sphere(radius=5.0, draft=5.0)
    omega = np.linspace(0.1, 3.0, 30)
    return bem.solve((hull,), np.zeros((1, 3)), depth=np.inf, density=1000.0, omega=omega, panels=108)


def test_long_waves_lift_a_float_by_their_amplitude(coarse):
    """Heave follows the surface; on an arm the angle is that over the horizontal arm. (ka)² = 2.5e-5 remains."""
    heave = response.frequency_domain((sphere.sphere(),), coarse, np.array([0.1]))[0, 0]
    ball = Float(
        name="ball", hull=sphere.sphere().hull, mass=sphere.MASS, inertia=(2.6e6,) * 3, hinge=(8.0, 0.0, 0.0),
        arm=(-8.0, 0.0, 0.0),
    )  # fmt: skip
    pitch = response.frequency_domain((ball,), coarse, np.array([0.1]))[0, 0]
    assert abs(heave) == approx(1, abs=5e-3)
    assert abs(pitch) == approx(1 / 8, abs=2e-3)


def test_a_hinge_far_away_is_a_guide(coarse):
    """An arm of L = 1 km turns by heave over L, and the inertia and surge of its float are of order 1/L."""
    far = 1000.0
    omega = np.array([0.5, 1.0, 1.4])
    item = sphere.sphere()
    ball = Float(
        name="ball", hull=item.hull, mass=item.mass, inertia=item.inertia, cog=item.cog, hinge=(far, 0.0, 0.0),
        arm=(-far, 0.0, 0.0),
    )  # fmt: skip
    heave, pitch = (response.frequency_domain((f,), coarse, omega)[:, 0] for f in (item, ball))
    assert pitch * far == approx(heave, rel=2e-2)


def test_smoothing_keeps_the_mean_of_a_line():
    omega = np.linspace(0, 1, 101)
    assert response.smooth(omega, 2 * np.exp(7j * omega))[50] == approx(2)
    inner = (omega > 0.06) & (omega < 0.94)  # where a window of 11 lines is whole
    assert response.smooth(omega, omega, 0.105)[inner] == approx(omega[inner])
