"""Streaming statistics against numpy on the whole record."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from solver.statistics import Statistics, apart


@given(seed=st.integers(0, 1000), cuts=st.lists(st.integers(0, 200), max_size=5), offset=st.floats(-1e3, 1e3))
def test_blocks_give_what_the_whole_gives(seed, cuts, offset):
    x = offset + np.random.default_rng(seed).normal(size=(200, 3))
    statistics = Statistics()
    for block in np.split(x, sorted(cuts)):
        statistics.add(block)
    table = statistics.table().T
    expected = [x.mean(0), np.sqrt((x**2).mean(0)), x.std(0)]
    assert approx(np.array(expected), rel=1e-9, abs=1e-9) == table[2:]
    assert np.array_equal(table[:2], whole(x)[:2])
    if abs(offset) > 10:  # nearer to zero a parabola may be cut off there
        assert table[0] == approx([parabolas(c) for c in x.T]) and table[1] == approx([-parabolas(-c) for c in x.T])


@given(seed=st.integers(0, 1000))
def test_what_takes_the_place_of_samples_counts_in_theirs(seed):
    """Half of two neighbours is taken back for values in between, with weights that make one sample."""
    dice = np.random.default_rng(seed)
    x, new, share = dice.normal(size=(50, 3)), dice.normal(2.0, 3.0, size=(4, 3)), dice.dirichlet(np.ones(4))
    statistics = Statistics()
    statistics.add(x)
    statistics.amend(np.concatenate([new, x[[20, 21]]]), np.concatenate([share, [-0.5, -0.5]]))
    weight = np.ones(50)
    weight[[20, 21]] -= 0.5
    every, weights = np.concatenate([x, new]), np.concatenate([weight, share])
    mean = np.average(every, axis=0, weights=weights)
    std = np.sqrt(np.average((every - mean) ** 2, axis=0, weights=weights))
    table = statistics.table().T
    assert approx(np.array([mean, np.hypot(mean, std), std])) == table[2:]
    assert np.all(table[0] >= every.max(axis=0)) and np.all(table[1] <= every.min(axis=0))


def parabolas(x):
    """Largest value of all parabolas through three samples that have their crest nearest to the middle one."""
    middle = x[1:-1]
    a, b, c = np.polyfit([-1, 0, 1], np.stack([x[:-2], middle, x[2:]]) - middle, 2)
    near = (a < 0) & (np.abs(b) < np.abs(a))
    return max(x.max(), *(middle + c)[near] - (b[near] ** 2 / (4 * a[near])))


def whole(x):
    statistics = Statistics()
    statistics.add(x)
    return statistics.table().T


@given(phase=st.floats(0, 2 * np.pi), offset=st.floats(-0.9, 0.9))
def test_extremes_lie_between_samples(phase, offset):
    """Sixteen samples a period miss a crest by up to 2 %; the parabola through three by 3(ωh)⁴/128."""
    step = 2 * np.pi / 16
    x = offset + np.cos(phase + step * np.arange(100))
    high, low = whole(x[:, None])[:2, 0]
    assert [high, low] == approx([1 + offset, -1 + offset], abs=3.3 * step**4 / 128)


def test_ends_count_and_what_stays_positive_does_not_cross_zero():
    t = np.arange(30.0)
    assert whole(t[:, None])[:2, 0].tolist() == [29.0, 0.0]
    power = np.sin(0.7 * t + 0.1) ** 2
    high, low = whole(power[:, None])[:2, 0]
    assert high >= power.max() and 0 <= low <= power.min()
    power[7] = np.nan
    assert np.isnan(whole(power[:, None])).all()


def test_tables_are_apart_by_their_largest_error_of_either_sign():
    """Of mean by the rms, of rms and std by themselves; what is faint beside the others counts as zero."""
    exact = np.array([[3.0, -3.0, 0.6, 1.0, 0.8], [1e-9, -1e-9, 0.0, 1e-9, 1e-9]])
    for off, error in (([0, 0, -0.05, 0, 0], 0.05), ([0, 0, 0.02, 0, 0.016], 0.02), ([0, 0, 0, 0, -0.08], 0.1)):
        assert apart(exact + np.array([off, [0.0] * 5]), exact) == approx(error)
    assert apart(exact + np.array([[0.0] * 5, [0, 0, 0, 1e-9, 0]]), exact) < 1e-5
