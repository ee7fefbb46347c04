"""Streaming statistics against numpy on the whole record."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from solver.statistics import Statistics


@given(seed=st.integers(0, 1000), cuts=st.lists(st.integers(0, 200), max_size=5), offset=st.floats(-1e3, 1e3))
def test_blocks_give_what_the_whole_gives(seed, cuts, offset):
    x = offset + np.random.default_rng(seed).normal(size=(200, 3))
    statistics = Statistics()
    for block in np.split(x, sorted(cuts)):
        statistics.add(block)
    expected = [x.max(0), x.min(0), x.mean(0), np.sqrt((x**2).mean(0)), x.std(0)]
    assert approx(np.array(expected), rel=1e-9, abs=1e-9) == statistics.table().T
