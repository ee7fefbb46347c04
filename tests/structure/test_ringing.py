"""Modes under loads that go with time, against another integration of the same."""

import numpy as np
import pytest
from pytest import approx
from scipy import signal

from solver.errors import InputError
from solver.structure import ringing
from solver.structure.load_history import LoadHistory
from solver.structure.ringing import Pieces, lines, parabolas, products, sizes

END = 10.0
OMEGA, RATIO = np.array([3.0, 40.0]), np.array([0.02, 0.1])
APPLIED = np.array([[1.0, 2.0]])
BLOW = LoadHistory(
    node="top",
    time=np.array([-1.0, 0.0, 1.03, 1.28, 1.53, 20.0]),
    force=np.outer([3.0, 0.2, 0.2, 1.2, 0.2, 0.4], [0, 1.0, 0]),
)


def moved(load, mode, fine=200001):
    """q, fine in time, of a load as a function of it, from rest under its first value."""
    t = np.linspace(0, END, fine)
    w, zeta = OMEGA[mode], RATIO[mode]
    system = signal.StateSpace([[0, 1], [-(w**2), -2 * zeta * w]], [[0], [1]], [[1, 0]], [[0]])
    Q = APPLIED[0, mode] * load(t)
    return t, Q, signal.lsim(system, Q - Q[0], t)[1].ravel() + Q[0] / w**2


def rms(x):
    return np.sqrt(np.mean(x**2))


@pytest.mark.parametrize("mode", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_sizes_are_those_of_another_integration(mode):
    t, Q, q = moved(lambda t: np.interp(t, BLOW.time, BLOW.force[:, 1]), mode)
    w, slow = OMEGA[mode], Q / OMEGA[mode] ** 2
    slow -= 2 * RATIO[mode] * np.gradient(Q, t) / w**3
    pieces = lines([BLOW], END)
    fine = pieces.cut(np.union1d(pieces.time, np.arange(0, END, 0.002)))
    for each in (pieces, fine):
        told = sizes(each, OMEGA, RATIO, APPLIED)
        assert told.swings[mode] == approx(w * rms(q - slow), rel=1e-3)
        assert told.pushed[mode] == approx(Q.std() / w, rel=1e-3)
    assert told.whole[mode] == approx(w * rms(q), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.4, 0.1])
def test_what_a_march_makes_of_a_blow_differs_by_what_is_told(step):
    """Through start, middle and end of each step."""

    def taken(t):
        start = step * np.floor(t / step + 1e-9)
        u = (t - start) / step
        first, middle, last = (
            np.interp(start + share * step, BLOW.time, BLOW.force[:, 1]) for share in (0.0, 0.5, 1.0)
        )
        return first * (1 - u) * (1 - 2 * u) + 4 * middle * u * (1 - u) + last * u * (2 * u - 1)

    exact = moved(lambda t: np.interp(t, BLOW.time, BLOW.force[:, 1]), 0)[2]
    off = lines([BLOW], END).less(parabolas([BLOW], step, END))
    told = sizes(off, OMEGA, RATIO, APPLIED).whole[0]
    assert told == approx(OMEGA[0] * rms(moved(taken, 0)[2] - exact), rel=0.02)


def test_lines_that_fall_on_steps_are_a_march_s_own():
    on_steps = LoadHistory(node="top", time=np.array([0.0, 1.2, 1.6, 2.4, END]), force=BLOW.force[1:])
    off = lines([on_steps], END).less(parabolas([on_steps], 0.4, END))
    assert sizes(off, OMEGA, RATIO, APPLIED).whole == approx(0.0, abs=1e-12)


def test_what_is_damped_by_more_than_critical_is_known_too():
    told = sizes(lines([BLOW], END), OMEGA, np.array([1.0, 3.0]), APPLIED)
    assert np.all(np.isfinite(told.swings)) and np.all(told.whole > 0)


def test_a_parabola_pushes_slowly_as_far_as_it_varies():
    t = np.linspace(0.0, 2.0, 100001)
    bent = Pieces(np.array([0.0, 2.0]), np.array([[1.0, 1.0]]), np.array([[0.5, -2.0]]), np.array([[3.0, 1.0]]))
    for pieces in (bent, bent.cut(np.array([0.0, 0.3, 1.7, 2.0]))):
        for mode, load in enumerate((1 + 0.5 * t + 1.5 * t**2, 1 - 2 * t + 0.5 * t**2)):
            assert sizes(pieces, OMEGA, RATIO, np.eye(2)).pushed[mode] == approx(load.std() / OMEGA[mode], rel=1e-4)


@pytest.mark.parametrize("at_once", [ringing.AT_ONCE, 37])
def test_products_are_those_of_another_integration(monkeypatch, at_once):
    """Of loads whose bends fall on steps, over the last 7 s, however many samples are known at a time."""
    monkeypatch.setattr(ringing, "AT_ONCE", at_once)
    load = LoadHistory(node="top", time=np.array([-1.0, 0.0, 1.0, 3.2, 3.6, 20.0]), force=BLOW.force)
    R = products([load], 0.01, (3.0, END), OMEGA, RATIO, APPLIED)
    columns = [np.ones(701), np.interp(np.linspace(3, END, 701), load.time, load.force[:, 1])]
    for mode in (0, 1):
        t, Q, q = moved(lambda t: np.interp(t, load.time, load.force[:, 1]), mode)
        dq = np.gradient(q, t)
        ddq = Q - 2 * RATIO[mode] * OMEGA[mode] * dq - OMEGA[mode] ** 2 * q
        columns += [x[60000::200] for x in (q, dq, ddq)]
    samples = np.stack(columns)[[0, 1, 2, 5, 3, 6, 4, 7]]
    size = np.sqrt(np.mean(samples**2, axis=1))
    assert R.T @ R / np.outer(size, size) == approx(samples @ samples.T / 701 / np.outer(size, size), abs=1e-3)
    assert R[0] == approx(samples.mean(axis=1), rel=1e-3, abs=1e-4 * size.max())


def test_a_history_bends_most_within_the_run():
    """A file may go on; what it does after the run's end pushes nothing."""
    time, force = np.array([0.0, 10.0, 11.0, 12.0, 30.0, 31.0, 32.0]), np.zeros((7, 3))
    force[[2, 5], 0] = 1e3, 1e6
    history = LoadHistory(node="top", time=time, force=force)
    assert history.bend(20.0) == (2e3, 11.0) and history.bend(40.0) == (2e6, 31.0) and history.bend(5.0)[1] == np.inf


@pytest.mark.parametrize(
    ("time", "force", "told"),
    [
        ([0.0, 1.0], np.ones((3, 3)), r"force = of shape \(3, 3\): must have three components at each of 2 times"),
        ([0.0, 1.0], np.full((2, 3), np.nan), "force = a gap: every number must be finite"),
        ([0.0, np.inf], np.ones((2, 3)), "time = a gap: every number must be finite"),
    ],
)
def test_what_is_no_history_is_refused(time, force, told):
    with pytest.raises(InputError, match=rf"load_histories\.top\.{told}"):
        LoadHistory(node="top", time=np.array(time), force=force)
