"""Both collocations, on y' = λy: order, stability, and what is left of modes faster than a step."""

import numpy as np
import pytest
from pytest import approx

from solver.coupled.scheme import LOBATTO, SMOOTHING, C


def kept(scheme, z):
    """R(z): y at the end of a step over that at its start, z = λdt; there y' is λ times it, at every point."""
    stages = np.linalg.solve(np.eye(2) - z * scheme.A, 1 + z * scheme.A0)
    return stages[1]


@pytest.mark.parametrize(("scheme", "order"), [(LOBATTO, 4), (SMOOTHING, 2)])
def test_of_their_order(scheme, order):
    steps = np.array([0.4, 0.2, 0.1])
    error = [abs(kept(scheme, 1j * h) - np.exp(1j * h)) for h in steps]
    assert np.polyfit(np.log(steps), np.log(error), 1)[0] == approx(order + 1, abs=0.1)
    assert scheme.A0 + scheme.A.sum(axis=1) == approx(C)
    assert scheme.work == approx([scheme.A0[1], *scheme.A[1]]) and scheme.work.sum() == approx(1)


def test_lobatto_keeps_all_that_rings_and_smoothing_what_a_piece_follows():
    y = np.array([1e-2, 0.3, 2.0, 5.0, 50.0])
    lobatto, smoothing = (np.array([abs(kept(scheme, 1j * each)) for each in y]) for scheme in (LOBATTO, SMOOTHING))
    assert lobatto == approx(1.0)
    assert smoothing**2 == approx((1 + y**2 / 16) / (1 + y**2 / 16 + y**4 / 16))
    assert abs(kept(SMOOTHING, -1e9)) < 1e-8 and abs(kept(LOBATTO, -1e9)) == approx(1.0)
