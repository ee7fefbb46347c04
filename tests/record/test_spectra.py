"""Harmonic analysis against signals whose content is known."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from solver.coupled.preparation import prepare
from solver.errors import InputError
from solver.record.channels import DIMS, Channels
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
from solver.run import simulate
from solver.scene import Settings
from solver.sea.dispersion import wavenumber
from solver.sea.realization import components, realize
from solver.sea.spectrum import PiersonMoskowitz
from tests.awkward import bare_legs, unequal_legs

LINEAR = {"method": "frequency", "froude_krylov": "linear"}
OUTPUTS = "reactions", "section_forces", "fibre_stress", "member_stress"

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


@pytest.mark.parametrize("method", ["frequency", "time"])
def test_a_band_without_waves_has_no_response(method):
    """Three waves, and lines of rounding or leakage far from them: quotients that look as sure as any."""
    waves = components(amplitude=[0.01, 0.004, 0.006, 0.0], omega=[1.0, 1.33, 2.2, 1.7], phase=[0.0, 1.0, 2.0, 0.0])
    settings = Settings(**LINEAR | {"method": method}, duration=600.0, discard=60.0, spectra=True)
    found = simulate(replace(bare_legs()[0], sea=waves, settings=settings)).variables
    at = bands(waves.omega, 600.0)
    near = np.abs(at.omega[:, None] - waves.omega[waves.amplitude != 0]).min(axis=1) <= 3 * at.width
    assert 20 < near.sum() < 40
    for part in ("response", "response_phase", "coherence"):
        assert np.array_equal(np.isfinite(found[f"top_displacement_{part}"][1][0, 0]), near)
    assert np.isfinite(found["top_displacement_spectrum"][1]).all()


def test_the_waves_way_to_what_is_far_is_in_no_band():
    """A frame 200 m down the waves, at 30 degrees, answers as it does at the origin, only later."""
    here = replace(bare_legs()[0], settings=Settings(**LINEAR, duration=900.0, spectra=True, outputs=OUTPUTS))
    frame = here.platform.frame
    shift = 200.0 * np.array([np.cos(here.sea.heading), np.sin(here.sea.heading), 0.0])
    nodes = {name: tuple(np.add(place, shift)) for name, place in frame.nodes.items()}
    there = replace(here, platform=replace(here.platform, frame=replace(frame, nodes=nodes)))
    near, far = (simulate(item).variables for item in (here, there))
    names = [name for name in near if name.endswith("_coherence")]
    assert len(names) > 6
    for name in names:
        response = [v[name.replace("coherence", "response")][1] for v in (near, far)]
        some = response[0] > 1e-3 * np.nanmax(response[0])
        assert far[name][1][some] == approx(near[name][1][some], abs=2e-3)
        assert response[1][some] == approx(response[0][some], rel=5e-3)
    k = wavenumber(near["band_frequency"][1], here.water.depth, here.water.gravity)
    turn = np.subtract(*(v["top_displacement_response_phase"][1][0, 0] for v in (far, near)))
    assert np.exp(1j * turn) == approx(np.exp(200j * k), abs=5e-3)


def test_everything_has_its_place_along_the_waves():
    """Floats and their lines, legs, members, feet and nodes, and of the whole the middle of its feet."""
    whole = unequal_legs()[0]
    asked = replace(whole.settings, outputs=(*OUTPUTS, "accelerations"))
    item = replace(whole, settings=asked)
    channels = Channels(item, prepare(item, unequal_legs()[1]).support)
    assert all(channels.ahead(name).ndim == 1 for name in DIMS)
    waves = np.array([np.cos(np.pi / 6), 0.5])
    assert channels.ahead("motion") == approx([whole.floats[0].centre[:2] @ waves])
    assert channels.ahead("bottom_stress")[0] == approx(np.array([-2.0, -1.35]) @ waves)  # from (-4, -3) to (0, 0.3)
    assert channels.ahead("base_shear") == approx([np.array([-2 / 3, 1 / 3]) @ waves])
    assert channels.ahead("wave_elevation") == approx([0.0])


def test_waves_that_a_record_cannot_tell_apart_are_refused():
    """Before a march whose lines no least squares would find; the frequency domain needs no record."""
    item = replace(bare_legs()[0], sea=components(amplitude=[0.1, 0.1], omega=[1.0, 1.05], phase=[0.0, 0.0]))
    with pytest.raises(InputError, match=r"settings.duration = 120.0: must be >= 125.7 s for rao"):
        replace(item, settings=Settings(rao=True, duration=120.0))
    assert replace(item, settings=Settings(rao=True, duration=126.0))
    assert replace(item, settings=Settings(**LINEAR, rao=True, duration=120.0))
