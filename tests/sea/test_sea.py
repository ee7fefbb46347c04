"""The sea against closed forms: dispersion, spectra, realizations, local field, ramp."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx
from scipy.special import gammaln

from solver.errors import InputError
from solver.sea.dispersion import frequency, wavenumber
from solver.sea.field import WaveField
from solver.sea.realization import components, ramp, realize
from solver.sea.series import WaveSeries, factored
from solver.sea.spectrum import PiersonMoskowitz, WhiteNoise

BUAN = PiersonMoskowitz(Hs=1.28, Tp=5.46)


def buan(seed=0, **changes):
    return realize(BUAN, **({"components": 130, "band": (0.7, 3.4), "seed": seed} | changes))


@given(omega=st.floats(0.05, 20), depth=st.floats(0.5, 500))
def test_dispersion_relation_holds(omega, depth):
    k = wavenumber(omega, depth)
    assert 9.81 * k * np.tanh(k * depth) == approx(omega**2, rel=1e-12)


@given(scale=st.floats(0.1, 50))
def test_dispersion_obeys_froude_scaling(scale):
    k = wavenumber(0.8, 30)
    assert k == approx(scale * wavenumber(0.8 / scale**0.5, 30 * scale), rel=1e-9)


def test_deep_and_shallow_limits():
    assert wavenumber(1.0, np.inf) == approx(1 / 9.81)
    assert wavenumber(1e-3, 10.0) == approx(1e-3 / np.sqrt(98.1), rel=1e-6)
    assert wavenumber(0.0, 10.0) == 0 == frequency(0.0, np.inf, 9.81)
    assert np.isnan(wavenumber(np.nan, 10.0))


@pytest.mark.parametrize("form, peak", [("peak", 2 * np.pi / 5.46), ("mean", (692 * 0.8) ** 0.25 / 5.46)])
def test_pierson_moskowitz_peak_and_variance(form, peak):
    """The peak form peaks at 1.15 rad/s; the printed one, fed with T_p, at 0.89 rad/s (a trap of the paper)."""
    omega = np.linspace(0.2, 40, 400_000)
    S = PiersonMoskowitz(Hs=1.28, Tp=5.46, form=form).density(omega)
    assert omega[S.argmax()] == approx(peak, abs=2e-4)
    # 173/692 is 1/4 to three digits only.
    assert 4 * np.sqrt(np.trapezoid(S, omega)) == approx(1.28, rel=2e-3 if form == "mean" else 1e-4)


def test_realized_height_is_that_of_the_band():
    omega = np.linspace(0.7, 3.4, 20_000)
    exact = 4 * np.sqrt(np.trapezoid(BUAN.density(omega), omega))
    assert buan().parameters()["Hm0"] == approx(exact, rel=2e-3)  # midpoint rule, 130 uneven intervals


def test_seed_gives_the_same_sea_and_another_seed_another():
    assert np.array_equal(buan(3).amplitude, buan(3).amplitude)
    assert not np.array_equal(buan(3).amplitude, buan(4).amplitude)


@pytest.mark.parametrize("intervals", ["random", "even"])
def test_heading_turns_the_same_waves(intervals):
    """The same sea at the origin: seeds say what it is, not where it goes."""
    along, across = (buan(3, heading=heading, intervals=intervals) for heading in (0.0, 0.7))
    assert np.array_equal(along.omega, across.omega) and np.array_equal(along.amplitude, across.amplitude)
    assert across.heading == 0.7


def test_even_intervals_repeat_and_random_ones_do_not():
    even, uneven = buan(intervals="even"), buan()
    t, period = np.linspace(0, 60, 200), 2 * np.pi / (even.omega[1] - even.omega[0])
    assert period == approx(303, abs=1)
    for sea, repeats in ((even, True), (uneven, False)):
        now, later = (
            np.abs(np.exp(-1j * np.outer(t + shift, sea.omega - sea.omega[0])) @ sea.amplitude) for shift in (0, period)
        )
        assert (np.abs(now - later).max() < 1e-9) == repeats


@pytest.mark.parametrize("bad", [{"band": (3.4, 0.7)}, {"band": (0, 1)}, {"components": 0}])
def test_bad_realization_is_refused(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        buan(**bad)


@pytest.mark.parametrize("depth", [50.0, 8.0, np.inf])
def test_local_pressure_is_the_whole_field(depth):
    sea = buan(1, heading=0.4)
    field = WaveField(sea, depth, 9.81)
    centre = np.array([-3.86, 0.7, 0.0])
    terms = field.terms_for(3.0, 1e-13)
    c = (field.local_pressure(centre, terms) * np.exp(-1j * sea.omega * 41.3)).sum(axis=-1).real
    points = centre + np.random.default_rng(0).uniform(-1.7, 1.7, (50, 3))
    ds, z = (points - centre) @ field.direction, points[:, 2]
    local = np.polynomial.polynomial.polyval(z + 1j * ds, c[0] + 1j * c[1]).real
    profile = np.exp(np.outer(z, field.k))
    if np.isfinite(depth):
        profile = np.cosh(np.outer(z + depth, np.ones_like(field.k)) * field.k) / np.cosh(field.k * depth)
    exact = (field.elevation(points * [1, 1, 0]) * profile * np.exp(-1j * sea.omega * 41.3)).sum(axis=-1).real
    assert np.abs(local - exact).max() < 1e-11


@pytest.mark.parametrize("depth", [20.0, np.inf])
def test_velocity_follows_from_the_pressure(depth):
    """∂u/∂t = -∇p/ρ, and nothing flows through the seabed."""
    sea = buan(2)
    field = WaveField(sea, depth, 9.81)
    point, h = np.array([1.3, 0.0, -2.0]), 1e-4
    terms = field.terms_for(1.0, 1e-14)

    def p(dx, dz):
        c = (field.local_pressure(point, terms) * np.exp(-1j * sea.omega * 7.0)).sum(axis=-1).real
        return np.polynomial.polynomial.polyval(dz + 1j * dx, c[0] + 1j * c[1]).real

    slope = np.array([p(h, 0) - p(-h, 0), p(0, h) - p(0, -h)]) / (2 * h)
    du = (field.acceleration(point) * np.exp(-1j * sea.omega * 7.0)).sum(axis=-1).real[[0, 2]]
    assert du == approx(-9.81 * slope, rel=1e-6)
    if np.isfinite(depth):
        assert np.abs(field.velocity(np.array([0, 0, -depth]))[2]).max() < 1e-12


@pytest.mark.parametrize("kr, n", [(0.5, 6), (3.0, 8), (20.0, 10)])
def test_what_the_series_leaves_out_is_the_rest_of_the_exponential(kr, n):
    """Near the float, so far from it that terms still grow, and further than numbers reach."""
    sea = components(amplitude=[1.0, 0.0], omega=np.sqrt([9.81, 20.0]), phase=[0.0, 0.0])
    field = WaveField(sea, np.inf, 9.81)  # k = 1 /m, and a wave that is not there
    m = np.arange(n, 200.0)
    assert field.left_out(n, kr) == approx(np.exp(m * np.log(kr) - gammaln(m + 1)).sum(), rel=1e-9)
    assert 1e300 < field.left_out(n, 1e4) < np.inf


def test_series_is_the_sum_of_components_even_after_a_day():
    sea = buan(5)
    rows = WaveField(sea, 50.0, 9.81).elevation(np.zeros((1, 3)))
    series = WaveSeries(factored(rows, np.linalg.norm(rows, axis=1)), sea.omega, 0.1, 64, np.ones_like)
    first = 24 * 36_000
    t = (first + np.arange(64)) * 0.1
    exact = (rows[0] * np.exp(-1j * np.outer(t, sea.omega))).sum(axis=1).real
    for count in (64, 33, 1):
        assert np.abs(series.block(first, count)[:, 0] - exact[:count]).max() < 1e-9


def test_frequencies_may_be_whole_numbers():
    rows, t = factored(np.array([[1.0 + 0j]]), np.ones(1)), 0.1 * np.arange(8)
    series = WaveSeries(rows, np.array([1]), 0.1, 8, np.ones_like)
    assert series.block(0, 8)[:, 0] == approx(np.cos(t), abs=1e-12)


def test_rows_that_are_rounding_of_others_cost_nothing():
    """Three motions at twenty points, and twenty rows that symmetry makes zero: rank three, all to rounding."""
    rng = np.random.default_rng(2)
    motions = rng.normal(size=(3, 60)) + 1j * rng.normal(size=(3, 60))
    rows = np.concatenate([rng.normal(size=(20, 3)) @ motions, 1e-15 * rng.normal(size=(20, 60))])
    own = np.linalg.norm(rows, axis=1)
    few, many = factored(rows, np.full(40, own.max())), factored(rows, own)
    assert few.spread.shape == (40, 3) and many.spread.shape[1] > 20
    assert np.abs(few.spread @ few.basis - rows).max() < 1e-13 * own.max()
    none = np.concatenate([rows[:3], np.zeros((1, 60))])
    assert not factored(none, np.linalg.norm(none, axis=1)).spread[3].any()  # nothing is nothing, not rounding


def test_of_many_rows_the_only_one_of_its_kind_is_kept():
    """By orthonormal ones, of which some rows tell first: it is not among those."""
    rng = np.random.default_rng(2)
    rows = rng.normal(size=(2000, 3)) @ (rng.normal(size=(3, 40)) + 1j * rng.normal(size=(3, 40)))
    rows[7] = rng.normal(size=40)
    few = factored(rows, np.linalg.norm(rows, axis=1))
    assert (few.basis @ few.basis.conj().T).real == approx(np.eye(4), abs=1e-14)
    assert np.abs(few.spread @ few.basis - rows).max() < 1e-13 * np.abs(rows).max()


def test_white_noise_is_flat_and_has_its_height():
    sea = realize(WhiteNoise(Hs=2.0, band=(0.1, 4.0)), components=196, band=(0.1, 4.0), intervals="even", seed=0)
    assert np.ptp(np.abs(sea.amplitude)) < 1e-12
    assert sea.parameters()["Hm0"] == approx(2.0)


def test_ramps_end_at_one():
    t = np.array([0.0, 25.0, 50.0, 80.0])
    assert ramp(t, 50.0, "paper") == approx([0, 1 - np.sqrt(0.5), 1, 1])
    assert ramp(t, 50.0, "cosine") == approx([0, 0.5, 1, 1])
    assert ramp(t, 0.0) == approx(1)
