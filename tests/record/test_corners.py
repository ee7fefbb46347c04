"""Electrical power between samples: what its corners do to mean and rms, against integrals."""

import numpy as np
import pytest
from pytest import approx

from solver.power_takeoff import PtoEfficiency
from solver.record.corners import missed
from tests.record.test_pto import OMEGA, ball, coefficients, expected_electrical, reactive, scene, simulate, statistic

LOSSY = PtoEfficiency(generating=0.9, motoring=0.7)
DAMPING, STIFFNESS = np.array([3.0, 1.0]), np.array([-8.0, 5.0])


def power(y, v):
    return (DAMPING * v + STIFFNESS * y) * v


def motion(t):
    """Of two axes, through a period of 2π, with a harmonic of the first one."""
    y = np.stack([np.sin(t) + 0.1 * np.cos(2 * t), 0.7 * np.cos(t + 0.4)], axis=1)
    v = np.stack([np.cos(t) - 0.2 * np.sin(2 * t), -0.7 * np.sin(t + 0.4)], axis=1)
    return y, v


def errors(count, own, start=0.0):
    """Of mean and mean square of electrical power by so many samples a period, relative to both's exact size."""
    fine = LOSSY.electrical(power(*motion(2 * np.pi * np.arange(200_000) / 200_000)) * own).sum(axis=1)
    step = 2 * np.pi / count
    y, v = motion(start + step * np.arange(count + 1))
    _, first, second = missed(y, v, step, power, np.tile(np.array(own, bool), (count, 1)), LOSSY)
    samples = LOSSY.electrical(power(y, v)[1:] * own).sum(axis=1)
    mean, square = (samples.sum() + first.sum()) / count, (np.sum(samples**2) + second.sum()) / count
    return (mean - fine.mean()) / np.sqrt(np.mean(fine**2)), square / np.mean(fine**2) - 1


@pytest.mark.parametrize("own", [(1, 0), (0, 1), (1, 1)])
def test_corners_are_told_wherever_they_lie_between_samples(own):
    """As the scheme is of fourth order, from 18 samples a period on, which the usual step has."""
    for count, most in ((18, (5e-5, 5e-4)), (36, (4e-6, 2e-5))):
        worst = np.max([np.abs(errors(count, own, start)) for start in np.linspace(0, 2 * np.pi / count, 9)], axis=0)
        assert np.all(worst < most)


def test_an_axis_that_is_not_at_work_has_no_corner():
    y, v = motion(np.linspace(0, 2 * np.pi, 19))
    rows, *_ = missed(y, v, 2 * np.pi / 18, power, np.zeros((18, 2), bool), LOSSY)
    assert rows.size == 0


@pytest.mark.parametrize("steps", [9, 12])
def test_electrical_power_in_a_regular_sea_is_its_closed_form_at_the_usual_step(steps):
    """Whose period is so many steps, so that all corners lie alike between samples."""
    period, law = 2 * np.pi / OMEGA, reactive()
    law["pto_stiffness"] *= 0.5
    once = (20 - 0.25 / steps) * period  # the first sample not once more at the end
    item = scene(ball(**law, pto_efficiency=LOSSY), time_step=period / steps, duration=once)
    record = simulate(item, coefficients())
    X = np.sqrt(2) * statistic(record, "motion", "std", 0, 0)
    rms = statistic(record, "electrical_power", "rms", 0)
    exact = expected_electrical(X, law["pto_damping"], law["pto_stiffness"], LOSSY)
    assert statistic(record, "electrical_power", "mean", 0) == approx(exact, abs=3e-4 * rms)
