"""The sea of a record: its spectrum regenerated, beside the theory behind it (Heo, Koo and Kim 2022, Fig. 11)."""

from dataclasses import replace

import numpy as np

from solver.record.spectra import smoothed_density
from solver.run import simulate
from solver.sea.spectrum import PiersonMoskowitz
from studies.validation import drawing
from studies.validation.cases import buan
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, ORANGE


def spectrum() -> list[Check]:
    """Fig. 11: the record's elevation, and its spectrum beside the theory that it was drawn from."""
    base = buan("elastic-no-floats")
    record = simulate(replace(base, settings=replace(base.settings, keep_series=True)))
    time, elevation = record.series["time"][1], record.series["wave_elevation"][1]
    step = time[1] - time[0]
    theory = PiersonMoskowitz(Hs=1.28, Tp=5.46)
    omega, density = smoothed_density(elevation, step, 0.05)
    inside = (omega > 0.8) & (omega < 3.3)
    exact = theory.density(omega[inside])
    apart = np.sqrt(np.mean((density[inside] - exact) ** 2) / np.mean(exact**2))
    grid = np.linspace(0.7, 3.4, 20_001)
    in_band = 4 * np.sqrt(np.trapezoid(theory.density(grid), grid))
    peak = omega[inside][np.argmax(density[inside])]
    at = {"case": "spectrum of the record, Fig. 11"}
    checks = [
        # Lines are 0.02 rad/s apart: the midpoint rule is right to 1e-3, the rest is what 3,600 s resolve.
        Check(quantity="4 std of η, band 0.7-3.4 rad/s [m]", ours=4 * elevation.std(), published=in_band,
              allowed=0.01 * in_band, **at),
        # Lines at random distances, ± 40 % of 0.02 rad/s, within a window of 0.05: some 5 % of scatter.
        Check(quantity="smoothed density less theory: rms over rms", ours=float(apart), published=0.0,
              allowed=0.1, **at),
        # The width of the smoothing.
        Check(quantity="peak frequency [rad/s]", ours=float(peak), published=2 * np.pi / 5.46, allowed=0.05, **at),
    ]  # fmt: skip
    figure, (left, right) = drawing.axes(2)
    first = time < time[0] + 300
    left.plot(time[first], elevation[first], color=BLUE, lw=0.8)
    left.set(xlabel="time [s]", ylabel="elevation [m]", title="First 300 s of the record")
    shown = omega < 4
    right.plot(omega[shown], density[shown], color=BLUE, lw=1.3, label="ours, from the record, smoothed")
    some = np.linspace(0.7, 3.4, 28)
    right.plot(some, theory.density(some), "o", color=ORANGE, label="Pierson-Moskowitz, theory", **drawing.MARK)
    right.set(xlabel="ω [rad/s]", ylabel="S(ω) [m² s/rad]", title="Hs 1.28 m, Tp 5.46 s")
    drawing.save(figure, "spectrum")
    return checks
