"""Harmonic analysis against signals whose content is known."""

import numpy as np
from pytest import approx

from solver.record.spectra import Harmonics, harmonics, smoothed_density, transfer
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
