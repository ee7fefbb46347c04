"""The spline through coefficients beside scipy's, and what it is for."""

import subprocess
import sys

import numpy as np
import pytest
import scipy.interpolate

from solver.spline import CubicSpline
from tests import awkward


@pytest.mark.parametrize("count", [4, 5, 23])
def test_it_is_scipys_to_the_bit(count):
    """Knots lie unevenly; on them, between them, and beyond both ends."""
    rng = np.random.default_rng(count)
    x = np.cumsum(rng.uniform(0.1, 2.0, count))
    y = rng.normal(size=(count, 3, 2)) + 1j * rng.normal(size=(count, 3, 2))
    at = np.concatenate([x, rng.uniform(x[0] - 1, x[-1] + 1, 50)])
    for values in (y, y.real.copy(), y[:, 0, 0].copy()):
        theirs = scipy.interpolate.CubicSpline(x, values)
        np.testing.assert_array_equal(CubicSpline(x, values)(at), theirs(at))
        np.testing.assert_array_equal(CubicSpline(x, values)(at[3]), theirs(at[3]))


@pytest.mark.parametrize("count", [2, 3])
def test_of_few_points_it_is_a_line_or_parabola(count):
    x, at = np.array([0.5, 0.8, 2.0])[:count], np.linspace(0.0, 3.0, 7)
    y = np.array([[1.0, 2j], [3.0, -1.0], [0.0, 4.0]])[:count]
    np.testing.assert_allclose(CubicSpline(x, y)(at), scipy.interpolate.CubicSpline(x, y)(at), rtol=0, atol=1e-13)


def test_curves_of_awkward_coefficients_are_scipys():
    _, h = awkward.big_beside_small()
    at = np.linspace(h.omega[0], h.omega[-1], 401)
    theirs = scipy.interpolate.CubicSpline(h.omega, h.diffraction)
    np.testing.assert_array_equal(CubicSpline(h.omega, h.diffraction)(at), theirs(at))


def test_a_task_needs_none_of_what_scipy_is_slow_to_import():
    """Each of them brings others: together a seventh of the time from the command to the first step."""
    program = (
        "import sys; from pipeline.bridge import engine; engine.import_solver()\n"
        "slow = {f'scipy.{name}' for name in ('interpolate', 'optimize', 'spatial', 'special', 'fft', 'stats')}\n"
        "print(sorted(slow & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert done.stdout == "[]\n"
