"""Seas of every kind against closed forms and against themselves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from solver.errors import InputError
from solver.sea.realization import components, measured, realize, regular
from solver.sea.spectrum import Jonswap, PiersonMoskowitz, Tabulated, WhiteNoise


def elevation(sea, t):
    """η at the origin."""
    return (sea.amplitude * np.exp(-1j * np.outer(t, sea.omega))).sum(axis=1).real


@pytest.mark.parametrize("gamma", [1.0, 2.0, 3.3, 7.0])
def test_jonswap_keeps_its_height(gamma):
    omega = np.geomspace(0.2, 200, 400_000)
    S = Jonswap(Hs=3.0, Tp=8.0, gamma=gamma).density(omega)
    # Beyond 200 rad/s lies less than 1e-8 of the variance; the rest is the trapezoidal rule.
    assert 4 * np.sqrt(np.trapezoid(S, omega)) == approx(3.0, rel=1e-6)
    assert omega[S.argmax()] == approx(2 * np.pi / 8, rel=1e-4)


def test_jonswap_is_pierson_moskowitz_at_gamma_one_and_gamma_times_it_at_the_peak():
    omega = np.linspace(0.3, 4, 50)
    base = PiersonMoskowitz(Hs=2.0, Tp=7.0)
    assert Jonswap(Hs=2.0, Tp=7.0, gamma=1.0).density(omega) == approx(base.density(omega), rel=1e-6)
    # Goda's constant for γ = 3.3: C = 0.0624 / (0.230 + 0.0336 γ - 0.185 / (1.9 + γ)) × 16/5, good to 1 %.
    peak, gamma = np.array([2 * np.pi / 7]), 3.3
    goda = 3.2 * 0.0624 / (0.230 + 0.0336 * gamma - 0.185 / (1.9 + gamma))
    ratio = Jonswap(Hs=2.0, Tp=7.0).density(peak) / base.density(peak)
    assert ratio[0] == approx(gamma * goda, rel=0.01)


def test_jonswap_is_narrower_below_its_peak_than_above():
    """One σ from the peak, 0.07 below and 0.09 above, γ^r has fallen from γ to γ^(e^-½)."""
    wp, gamma = 2 * np.pi / 7, 3.3
    omega = wp * np.array([0.93, 1.0, 1.09])
    enhanced = Jonswap(Hs=2.0, Tp=7.0, gamma=gamma).density(omega) / PiersonMoskowitz(Hs=2.0, Tp=7.0).density(omega)
    assert enhanced / enhanced[1] == approx([gamma ** (np.exp(-0.5) - 1), 1.0, gamma ** (np.exp(-0.5) - 1)], rel=1e-12)


def test_a_tabulated_spectrum_is_the_one_it_was_made_from():
    omega = np.linspace(0.3, 4, 2000)
    known = PiersonMoskowitz(Hs=2.0, Tp=7.0)
    table = Tabulated(omega=omega, S=known.density(omega))
    args = {"components": 60, "band": (0.5, 2.0), "seed": 1}
    # Linear interpolation between points 0.002 rad/s apart.
    assert realize(table, **args).amplitude == approx(realize(known, **args).amplitude, rel=1e-3)
    assert table.density(np.array([0.1, 5.0])).tolist() == [0, 0]


@given(height=st.floats(0.01, 20), period=st.floats(1, 30), phase=st.floats(-3, 3))
def test_a_regular_wave_has_its_height_period_and_phase(height, period, phase):
    sea = regular(height=height, period=period, phase=phase)
    t = np.linspace(0, period, 7)
    assert elevation(sea, t) == approx(height / 2 * np.cos(phase - 2 * np.pi * t / period), abs=1e-9 * height)
    assert sea.parameters()["Hm0"] == approx(height * np.sqrt(2))  # 4 σ, σ = H/2/√2
    assert sea.parameters()["Tp"] == approx(period)


def test_periods_are_those_of_the_moments():
    """Te = 2π m₋₁/m₀ and Tz = 2π (m₀/m₂)^½ of two waves, by hand; of one wave both are its period."""
    figures = components(amplitude=[3.0, 1.0], omega=[0.5, 2.0], phase=[0.1, 0.2]).parameters()
    m = {n: (9 * 0.5**n + 2.0**n) / 2 for n in (-1, 0, 2)}
    assert figures["Te"] == approx(2 * np.pi * m[-1] / m[0], rel=1e-12)
    assert figures["Tz"] == approx(2 * np.pi * np.sqrt(m[0] / m[2]), rel=1e-12)
    one = regular(height=1.0, period=7.0).parameters()
    assert (one["Te"], one["Tz"]) == approx((7.0, 7.0))


def test_components_come_in_any_order():
    a = components(amplitude=[1.0, 0.5], omega=[2.0, 1.0], phase=[0.3, 0.1])
    b = components(amplitude=[0.5, 1.0], omega=[1.0, 2.0], phase=[0.1, 0.3])
    assert np.array_equal(a.omega, b.omega) and np.array_equal(a.amplitude, b.amplitude)
    assert a.peak_frequency == 2.0


def test_components_of_one_frequency_are_one_wave():
    """Squares of a wave's parts are not its own: its power would be half."""
    whole = components(amplitude=[0.1], omega=[1.2], phase=[0.0])
    parts = components(amplitude=[0.05, 0.3, 0.05, 0.3], omega=[1.2, 2.0, 1.2, 2.0], phase=[0.0, 0.0, 0.0, np.pi])
    assert parts.omega == approx([1.2, 2.0]) and parts.amplitude == approx([0.1, 0.0]) and parts.amplitude[1] == 0
    assert parts.peak_frequency == 1.2 and parts.parameters()["Hm0"] == approx(whole.parameters()["Hm0"])


@pytest.mark.parametrize("n", [400, 401])
def test_a_measured_record_comes_back_at_its_samples(n):
    """Mean apart, whatever the numbers: the band holds every line, the highest included."""
    t = 7.0 + 0.25 * np.arange(n)
    eta = np.random.default_rng(n).normal(size=n)
    sea = measured(time=t, elevation=eta, band=(1e-6, 100.0))
    assert elevation(sea, t) == approx(eta - eta.mean(), abs=1e-9)
    assert elevation(sea, t + 0.25 * n) == approx(eta - eta.mean(), abs=1e-9)


def test_a_measured_record_says_what_it_leaves_out():
    """Two waves that fit the record's length: one line each, so the shares are exact."""
    t = 0.1 * np.arange(2000)
    eta = 0.5 + 3.0 * np.cos(2 * np.pi * 20 / 200 * t) + 1.0 * np.cos(2 * np.pi * 200 / 200 * t)
    sea = measured(time=t, elevation=eta, band=(0.1, 3.0))
    (note,) = sea.notes
    assert "mean level 0.5 m" in note and "10.00% of the variance" in note and "repeats after 200 s" in note
    assert sea.parameters()["Hm0"] == approx(4 * 3 / np.sqrt(2))
    assert sea.parameters()["Tp"] == approx(10.0)


TWO_METRES = PiersonMoskowitz(Hs=2.0, Tp=7.0)
PEAK = 2 * np.pi / 7


@pytest.mark.parametrize("spectrum", [TWO_METRES, PiersonMoskowitz(Hs=2.0, Tp=5.4, form="mean"), "table"])
def test_what_a_band_leaves_out_of_a_spectrum_is_told(spectrum):
    """Of Pierson-Moskowitz's variance exp(-5/4 (ωp/ω)⁴) lies below ω: at 1.2 ωp just over half."""
    omega = np.linspace(0.3, 30, 20_000)  # beyond lies less than a millionth
    whole = Tabulated(omega=omega, S=TWO_METRES.density(omega)) if spectrum == "table" else spectrum
    peak = PEAK if spectrum == "table" else spectrum.peak_frequency
    assert whole.Hs == approx(2.0, rel=1e-4)
    above = 1 - np.exp(-1.25 / 1.2**4)
    (note,) = realize(whole, components=300, band=(0.4 * peak, 1.2 * peak), seed=0).notes
    assert f"Hm0 = {2 * np.sqrt(1 - above):.3g} m, and their spectrum has 2 m" in note and f"{above:.2%}"[:3] in note
    assert f" {0.4 * peak:.4g} to {1.2 * peak:.4g} rad/s" in note


@pytest.mark.parametrize("count", [1, 2, 5])
def test_components_too_few_for_a_spectrum_are_told(count):
    """One has √(S Δω) of the middle, 1.75 ωp."""
    sea = realize(TWO_METRES, components=count, band=(0.5 * PEAK, 3 * PEAK), seed=0, intervals="even")
    if count == 1:
        variance = TWO_METRES.density(np.array([1.75 * PEAK]))[0] * 2.5 * PEAK
        assert sea.parameters()["Hm0"] == approx(4 * np.sqrt(variance))
    (note,) = sea.notes
    assert note.startswith(f"components = {count} have Hm0 = {sea.parameters()['Hm0']:.3g} m")
    assert ": 1.98 m without the 1.53% of its variance" in note


@pytest.mark.parametrize("seed", range(20))
def test_usual_seas_are_as_high_as_asked_and_say_nothing(seed):
    """By default, and by 50 components of the narrowest spectrum."""
    usual = {"band": (0.5 * PEAK, 3 * PEAK), "seed": seed}
    for spectrum in (TWO_METRES, Jonswap(Hs=2.0, Tp=7.0, gamma=7.0)):
        assert not realize(spectrum, components=130, **usual).notes
        assert not realize(spectrum, components=50, **usual).notes
    assert not realize(WhiteNoise(Hs=2.0, band=(0.3, 3.0)), components=1, band=(0.3, 3.0), seed=seed).notes


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: Jonswap(Hs=1, Tp=5, gamma=0.5), "gamma"),
        (lambda: Jonswap(Hs=0, Tp=5), "Hs"),
        (lambda: Tabulated(omega=np.array([1.0, 1.0]), S=np.ones(2)), "omega"),
        (lambda: Tabulated(omega=np.array([1.0, 2.0]), S=np.zeros(2)), "S"),
        (lambda: regular(height=-1, period=5), "height"),
        (lambda: regular(height=1, period=np.inf), "period"),
        (lambda: components(amplitude=[], omega=[], phase=[]), "amplitude"),
        (lambda: components(amplitude=[1], omega=[0], phase=[0]), "omega"),
        (lambda: components(amplitude=[np.inf], omega=[1], phase=[0]), "amplitude"),
        (lambda: components(amplitude=[1], omega=[np.nan], phase=[0]), "omega"),
        (lambda: components(amplitude=[1], omega=[1], phase=[np.nan]), "phase"),
        (lambda: measured(time=[0, 1, 2], elevation=[0, 1, 0], band=(0.1, 9)), "time"),
        (lambda: measured(time=[0, 1, 2, 4], elevation=[0, 1, 0, 1], band=(0.1, 9)), "time"),
        (lambda: measured(time=[0, 1, 2, 3], elevation=[0, 1, np.nan, 1], band=(0.1, 9)), "elevation"),
        (lambda: measured(time=[0, 1, 2, 3], elevation=[0, 1, 0, 1], band=(8, 9)), "band"),
    ],
)
def test_nonsense_is_refused(make, key):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.key == key


@pytest.mark.parametrize("count", [4, 5, 7, 8])
def test_a_record_of_few_samples_comes_back(count):
    """Shorter than the window that its spectrum is smoothed by."""
    t = np.arange(count)
    eta = np.cos(2.0 * t) + 0.3 * t
    wave = measured(time=t, elevation=eta, band=(1e-6, 100.0))
    back = np.sum(wave.amplitude * np.exp(-1j * np.outer(t, wave.omega)), axis=1).real
    assert back == approx(eta - eta.mean(), abs=1e-12) and wave.peak_frequency in wave.omega
