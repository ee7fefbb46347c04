"""The error to expect of a record's statistics, from samples of which the error is known."""

import numpy as np
import pytest
from pytest import approx

from solver.record.sampling import Cuts, at_ends, between_samples, expected_error, from_start, of_every_other

NONE = np.zeros(())
RNG = np.random.default_rng(3)
WAVE = RNG.normal(size=(4000, 2)) + 3.0


def error(coarse, fine=WAVE, longer=1.0, least=NONE):
    return expected_error({"x": coarse}, {"x": fine}, {"x": least}, longer)


@pytest.mark.parametrize("longer", [1.0, 10.0, 1e6])
def test_what_stays_is_told_whatever_the_record(longer):
    """A share of each value is that share of the std; a shift, relative to the rms, of the mean."""
    assert error(3.0 + 1.01 * (WAVE - 3.0), longer=longer) == approx(0.01, rel=0.05)
    assert error(WAVE + 0.02, longer=longer) == approx(0.02 / np.sqrt(10), rel=0.05)


def test_chance_averages_out():
    """Noise of no correlation: of m samples' mean s/√m is left, and in a record n times longer √n less."""
    noise = 0.3 * RNG.normal(size=WAVE.shape)
    short, long = error(WAVE + noise), error(WAVE + noise, longer=100.0)
    assert long < short
    # The noise's own variance stays, 0.3²/2 of the std's.
    assert long == approx(np.sqrt(1 + 0.3**2) - 1, rel=0.3)


@pytest.mark.parametrize("longer", [1.0, 4.0])
def test_chance_is_told_by_the_scatter_of_the_parts(longer):
    """Sixteenths shifted up and down in turn: no error of the mean, and a standard error of c (16/15)^½/16^½."""
    c = 0.01
    sign = np.repeat([1.0, -1.0] * 8, 250)[:, None]
    assert error(WAVE + c * sign, longer=longer) == approx(c / np.sqrt(15 * longer) / np.sqrt(10), rel=0.03)


def test_what_is_not_sure_to_stay_counts_as_chance():
    """A shift of 2 or 3 of its standard errors c/15^½, in a record 100 times longer."""
    c = 0.01
    sign = np.repeat([1.0, -1.0] * 8, 250)[:, None]
    doubtful, sure = (error(WAVE + c * (sign + n / np.sqrt(15)), longer=100.0) * np.sqrt(150) / c for n in (2, 3))
    assert doubtful == approx(0.2, rel=0.05) and sure == approx(np.sqrt(8.01), rel=0.05)


def test_the_least_is_what_a_channel_counts_as():
    """One that symmetry keeps at zero, rounding apart, is judged as if it were not zero."""
    quiet = WAVE * np.array([1.0, 1e-9])
    assert error(quiet + 1e-9, quiet) < 1e-5
    assert error(quiet[:, 1:] * 2, quiet[:, 1:]) > 0.5
    assert error(quiet[:, 1:] * 2, quiet[:, 1:], least=np.array([1.0])) < 1e-6


def test_what_is_not_to_be_judged_counts_for_nothing():
    both = WAVE * np.array([1.01, 2.0])
    least = np.array([0.0, np.inf])
    assert error(both, WAVE, least=least) == approx(error(both[:, :1], WAVE[:, :1]), rel=1e-12)
    assert between_samples({"x": 0 * WAVE}, {"x": least}, 1.0) == 0


def test_rounding_of_what_stands_still_is_no_error():
    """A load that weight alone makes, though none of its kind varies more."""
    weight = 1e6 + 1e-9 * RNG.normal(size=(2, *WAVE.shape))
    assert error(*weight) < 1e-6 and between_samples({"x": weight[0]}, {}, 1.0) < 1e-6


def test_rounding_of_squares_that_pieces_know_is_no_error():
    """Of a weight that a joint bears and that does not vary: a piece's squares of it err by its last bits."""
    weight, last = np.full((600, 1), 9810.0) + 1e-11 * RNG.normal(size=(600, 1)), np.finfo(float).eps * 9810.0**2
    cut = {"x": Cuts(np.array([100]), np.zeros((1, 1)), np.array([[last]]))}
    assert expected_error({"x": weight}, {"x": weight}, {"x": np.array(9.81)}, 1.0, (cut, {})) < 1e-6


def test_channels_that_a_float_does_not_have_count_for_nothing():
    gone = np.column_stack([WAVE, np.full(len(WAVE), np.nan)])
    assert error(1.01 * gone, gone) == approx(error(1.01 * WAVE), rel=1e-12)


def hits(length, every=0.01, record=40_000.0):
    """Samples of square pulses of that length, of half sines three times as long, and of a wave."""
    t, starts = np.arange(0, record, every), np.zeros(round(record / every))
    starts[RNG.integers(0, starts.size, 2000)] = 1.0
    n = round(length / every)
    square, sine = (
        np.convolve(starts, shape)[: t.size] for shape in (np.ones(n), np.sin(np.arange(3 * n) * np.pi / 3 / n))
    )
    return np.column_stack([square, sine, np.sin(0.7 * t)])


@pytest.mark.slow
def test_what_jumps_between_samples_is_told_as_chance():
    """Against the spread of records that begin elsewhere between two samples; of a wave that they follow nothing."""
    apart, ratios = 50, []
    for _ in range(6):
        fine = hits(0.33)
        square = np.mean(fine**2, axis=0)
        errors = [np.sqrt(np.mean(fine[first::apart] ** 2, axis=0) / square) - 1 for first in range(apart)]
        told = [between_samples({"x": fine[:: apart // 2, [i]]}, {}, 1.0) for i in range(3)]
        ratios.append(np.sqrt(np.mean(np.square(errors), axis=0)) / told)
    of_square, of_sine, _ = np.mean(ratios, axis=0)
    assert 0.7 < of_square < 1.4 and 1 / 3 < of_sine < 3, (of_square, of_sine)
    assert told[2] < told[0] / 20
    assert between_samples({"x": fine[:: apart // 2]}, {}, 4.0) == approx(told[0] / 2)


@pytest.mark.parametrize("apart", [0.05, 0.2])
def test_a_record_s_first_and_last_sample_count_in_full(apart):
    """By the trapezoids they count half: so waves cut out anywhere differ, in the mean, as is told."""
    rng, differ, told = np.random.default_rng(5), [], []
    for _ in range(200):
        t, (a, b) = np.arange(rng.integers(900, 1100)) * apart, rng.uniform(0, 2 * np.pi, 2)
        x = np.sin(1.3 * t + a) + np.sin(0.9 * t + b)
        mean = np.trapezoid(x) / (t.size - 1)
        std = np.sqrt(np.trapezoid((x - mean) ** 2) / (t.size - 1))
        differ.append([(x.mean() - mean) / std, x.std() / std - 1])
        told.append(at_ends({"x": x[: t.size // 2, None]}, {}, 2.0))
    true = np.abs(differ).mean(axis=0).max()
    assert true > 1e-4 and 0.8 < true / np.median(told) < 1.25, (true, np.median(told))


@pytest.mark.parametrize("damping", [0.02, 0.1])
def test_what_is_let_go_before_the_first_sample_is_missed_by_half_a_gap(damping):
    """x = 1 + exp(-δt) cos t has half a gap's too little of it; of a part of it, as of all that dies away."""
    apart = 0.1
    t = np.arange(apart, 200 + apart / 2, apart)
    few, fine = ((1 + np.exp(-damping * t) * np.cos(t))[:, None] for t in (t, np.arange(1e-4, 200, 1e-4)))
    true = 1 - few.std() / fine.std()
    told = [from_start({"x": few[: len(few) // n]}, {}, n) for n in (1, 2)]
    assert true > 1e-3 and np.all(np.abs(true / told - 1) < 0.3), (true, told)


@pytest.mark.parametrize("damping", [0.02, 0.1])
def test_a_record_that_begins_with_more_than_comes_has_half_a_gap_too_much_of_it(damping):
    """x = 1 + exp(-δt) cos t from its first sample on, which a usual one does not tell."""
    t, fine = np.arange(0, 200, 0.1), np.arange(0, 200, 1e-4)
    few, many = ((1 + np.exp(-damping * t) * np.cos(t))[:, None] for t in (t, fine))
    true = few.std() / many.std() - 1
    told = [at_ends({"x": few[: len(few) // n]}, {}, n, begins=True) for n in (1, 2)]
    assert true > 1e-3 and np.all(np.abs(true / told - 1) < 0.3), (true, told)
    assert at_ends({"x": few}, {}, 1.0) < true / 3


def test_a_sea_s_ends_are_judged_beside_all_of_its_start():
    """Of groups of waves, whose lull at the end of what is judged is not what goes on, squared as power is."""
    rng, differ, told = np.random.default_rng(8), [], []
    for _ in range(200):
        t, omega = np.arange(0, 800, 0.2), rng.uniform(0.9, 1.1, 20)
        x = (np.cos(np.outer(t, omega) + rng.uniform(0, 2 * np.pi, 20)).sum(axis=1) ** 2)[:, None]
        mean = np.trapezoid(x[:, 0]) / (t.size - 1)
        std = np.sqrt(np.trapezoid((x[:, 0] - mean) ** 2) / (t.size - 1))
        differ.append([(x.mean() - mean) / np.hypot(mean, std), x.std() / std - 1])
        start = {"x": x[: t.size // 8]}
        told.append([at_ends(start, {}, 8.0, begins=True, last=last) for last in (1.0, 0.25)])
    true, (told, by_lulls) = np.abs(differ).mean(axis=0).max(), np.transpose(told)
    assert 1 / 3 < true / np.median(told) < 3, (true, np.median(told))
    assert told.max() < 0.5 * by_lulls.max(), (told.max(), by_lulls.max())


def test_a_start_is_forgotten_in_a_record_of_waves():
    """Let go from five times the waves' height: the less the longer the record; of the waves alone there is next to
    none."""
    t = np.arange(0.1, 400, 0.1)
    waves = np.sin(1.3 * t) + np.sin(0.9 * t)
    both = (waves + 5 * np.exp(-0.1 * t) * np.cos(t))[:, None]
    short, long = (from_start({"x": both}, {}, longer) for longer in (1.0, 100.0))
    assert long < short / 50 and from_start({"x": waves[:, None]}, {}, 1.0) < 2e-4 < short / 3
    assert from_start({"x": both}, {"x": np.array(np.inf)}, 1.0) == 0


def pulses(spacing, record=400.0, every=0.01):
    """Samples of short hits, and what pieces as fine as `every` know of the time before those that hits lie in."""
    starts, n = np.zeros(round(record / every)), round(spacing / every)
    starts[np.random.default_rng(7).integers(100, starts.size - 100, 100)] = 1.0
    fine = np.convolve(starts, np.sin(np.arange(9) * np.pi / 8))[: starts.size, None]
    x, rows = fine[n - 1 :: n], []
    for r in range(1, len(x)):
        within = fine[n * r - 1 : n * (r + 1)]
        if within.any():
            own = [(np.sum(v, axis=0) - (v[0] + v[-1]) / 2) / n - (v[0] + v[-1]) / 2 for v in (within, within**2)]
            rows.append((r, *own))
    return x, Cuts(*map(np.array, zip(*rows, strict=True)))


def test_what_pieces_know_is_no_error_of_samples():
    """Of a run and one of half the step, whose hits both cut: the same means; samples alone see few of the hits."""
    coarse, cut = pulses(0.4)
    fine, finer = pulses(0.2)
    known = of_every_other({"x": fine}, {"x": finer}, {"x": cut})
    every = {"x": fine[1::2]}
    assert expected_error({"x": coarse}, every, {}, 1.0, ({"x": cut}, known)) < 1e-10
    assert expected_error({"x": coarse}, every, {}, 1.0, ({"x": cut}, {})) > 1e-2
    assert between_samples({"x": fine}, {}, 1.0) > 1e-2
    assert between_samples({"x": fine}, {}, 1.0, known) < 1e-10


def test_a_step_that_the_other_run_alone_cuts_is_as_long_as_its_points_tell():
    """A parabola's mean by Simpson's rule over both halves, where a coarse run has that of its pieces."""
    t = 0.2 * np.arange(1, 9)
    parabola, row = (t**2)[:, None], np.array([2])
    a, b = t[3], t[5]
    exact = Cuts(row, np.array([[(a * a + a * b + b * b) / 3 - (a**2 + b**2) / 2]]), np.zeros((1, 1)))
    told = of_every_other({"x": parabola}, {}, {"x": exact})["x"]
    assert told.row.tolist() == [2] and told.value == approx(exact.value)
