"""Harmonic analysis against signals whose content is known."""

import numpy as np
from pytest import approx

from solver.record.spectra import (
    BANDS,
    Harmonics,
    bands,
    cross_spectra,
    harmonics,
    lines_of,
    smoothed_density,
    transfer,
)
from solver.sea.realization import realize
from solver.sea.spectrum import PiersonMoskowitz

SEA = realize(PiersonMoskowitz(Hs=2.0, Tp=6.0), components=60, band=(0.5, 3.0), seed=3)
TIME = np.arange(0, 2400, 0.2)
WAVE = (SEA.amplitude * np.exp(-1j * np.outer(TIME, SEA.omega))).sum(axis=1).real


def test_harmonics_are_the_components():
    assert harmonics(TIME, WAVE + 0.7, SEA.omega) == approx(SEA.amplitude, abs=1e-8)


def test_harmonics_of_blocks_are_those_of_the_whole():
    fit = Harmonics(SEA.omega)
    for part in np.array_split(np.arange(TIME.size), 7):
        fit.add(TIME[part], WAVE[part, None])
    assert fit.amplitudes()[:, 0] == approx(SEA.amplitude, abs=1e-8)


def test_transfer_of_a_known_filter():
    H = 1 / (1.2 - SEA.omega**2 - 0.3j * SEA.omega)
    response = (H * SEA.amplitude * np.exp(-1j * np.outer(TIME, SEA.omega))).sum(axis=1).real
    ratio = transfer(TIME, WAVE, np.stack([response, 2 * response], axis=1), SEA.omega)
    assert ratio[:, 0] == approx(H, rel=1e-6) and ratio[:, 1] == approx(2 * H, rel=1e-6)


def test_density_integrates_to_the_variance():
    omega, S = smoothed_density(WAVE, 0.2, 0.05)
    # Smoothing spreads variance, it does not make any: 1e-3 is lost at the ends.
    assert np.trapezoid(S, omega) == approx(WAVE.var(), rel=2e-3)


def test_cross_spectra_of_a_record_in_noise():
    """A known H(ω), and as much noise again as the waves make: H stands, coherence is 1/(1 + noise), S their sum."""
    random, step, n = np.random.default_rng(1), 0.25, 14_400
    omega = np.linspace(0.6, 2.2, 400) + random.uniform(-1e-3, 1e-3, 400)
    a = 0.05 * np.exp(2j * np.pi * random.uniform(size=400))
    H = (1 + 2j * omega) / (1 - (omega / 1.3) ** 2 - 0.4j * omega)
    t, noise = step * np.arange(n), 0.3
    turns = np.exp(-1j * np.outer(t, omega))
    other = 0.05 * np.exp(2j * np.pi * random.uniform(size=400)) * np.sqrt(noise) * np.abs(H)
    wave, response = (turns @ a).real, np.stack([(turns @ (a * H + other)).real, (turns @ (2 * a * H)).real], axis=1)
    at = bands(omega, n * step)
    assert at.omega.size == BANDS and at.width == approx(np.ptp(omega) / BANDS)
    lines, Y = lines_of(np.column_stack([wave, response]) + np.array([0.0, 5.0, -3.0]), step, at)
    assert 0.5 * np.sum(np.abs(Y) ** 2, axis=0) == approx(np.column_stack([wave, response]).var(axis=0), rel=0.06)
    found, exact = cross_spectra(lines, Y[:, 0], Y[:, 1:], at), np.interp(at.omega, omega, H)
    inside = slice(5, -5)
    assert found.transfer[inside, 1] == approx(2 * exact[inside], abs=0.03 * np.abs(2 * exact).max())
    assert np.abs(found.transfer[inside, 0] - exact[inside]).mean() < 0.2 * np.abs(exact).mean()
    assert found.coherence[inside, 1].min() > 0.98
    assert found.coherence[inside, 0].mean() == approx(1 / (1 + noise), abs=0.06)
    power = 0.5 * 0.05**2 / (np.ptp(omega) / 399) * np.abs(exact) ** 2
    assert (found.density[inside, 0] / power[inside]).mean() == approx(1 + noise, rel=0.1)
    assert (found.density[inside, 1] / power[inside]).mean() == approx(4, rel=0.05)


def test_bands_of_a_single_wave():
    at = bands(np.array([1.5, 1.5]), 100.0)
    assert at.omega == approx([1.5]) and at.width == approx(4 * 2 * np.pi / 100)
    one = cross_spectra(np.array([1.5]), np.array([0.5j]), np.array([[1.0 + 0j, 0.0]]), at)
    assert one.transfer[0, 0] == approx(-2j) and one.coherence[0, 0] == approx(1.0)
    assert np.isnan(one.coherence[0, 1]) and one.density[0, 1] == 0
