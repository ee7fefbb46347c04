"""Fast path and reference path side by side: 200 s of the Buan study, both floats on the elastic platform.

Prints for every channel the RMS of the difference of the two histories over the RMS of the history, after
50 s of ramp. The reference is the paper's method throughout: six DOF a body with multipliers, 8,520 panels
with 130 waves each, eq. 14's kernel convolved, all modes.
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.hydrodynamics.radiation import fit
from solver.simulate import simulate
from studies.bench import representative

ALLOWED = 1e-3  # of the RMS
CHANNELS = ("rotation", "hinge_force", "top_displacement", "bottom_stress")
# Both far more exact than what is compared; the memory fitted about as well as the BEM agrees with itself.
SETTINGS = {
    "duration": 150.0, "discard": 50.0, "ramp": 50.0, "time_step": 0.125, "newton_tolerance": 1e-7,
    "memory_tolerance": 1e-3, "keep_series": True,
}  # fmt: skip
TOLERANCES = (3e-2, 1e-2, 5e-3, 3e-3, 1e-3, 5e-4)


def differences() -> Iterator[tuple[str, str, float]]:
    """(quantity, channel, RMS of the difference over RMS) of all that moves."""
    scene, coefficients = representative("elastic")
    settings = replace(scene.settings, **SETTINGS)
    start = time.perf_counter()
    fast = simulate(replace(scene, settings=settings), coefficients)
    middle = time.perf_counter()
    slow = simulate(replace(scene, settings=replace(settings, accuracy="reference")), coefficients)
    print(f"200 s: fast path {middle - start:.1f} s, reference path {time.perf_counter() - middle:.0f} s")
    for name in CHANNELS:
        a, b = (record.series[name][1].reshape(len(record.series["time"][1]), -1) for record in (fast, slow))
        size, apart = (np.sqrt(np.mean(x**2, axis=0)) for x in (b, a - b))
        labels = [", ".join(map(str, label)) for label in np.ndindex(slow.series[name][1].shape[1:])]
        for label, d, rms in zip(labels, apart, size, strict=True):
            if rms > 1e-6 * size.max():  # the planar scene's still directions
                yield name, label, float(d / rms)


def memories() -> Iterator[tuple[float, int, float, float]]:
    """(tolerance, poles, misfit, seconds to fit) of the pair's radiation memory."""
    _, h = representative("elastic")
    for tolerance in TOLERANCES:
        start = time.perf_counter()
        memory = fit(h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf, tolerance)
        yield tolerance, len(memory.beta), memory.error, time.perf_counter() - start


def main() -> int:
    """Print both tables; 1 if a channel differs by more than ALLOWED."""
    for tolerance, poles, error, seconds in memories():
        print(f"memory to {tolerance:g}: {poles} poles, misfit {error:.1e}, {seconds:.2f} s")
    worst = 0.0
    for name, label, difference in differences():
        worst = max(worst, difference)
        print(f"{name:18s}{label:8s}{difference:10.1e}")
    print(f"worst {worst:.1e}, allowed {ALLOWED:g}")
    return int(worst >= ALLOWED)


if __name__ == "__main__":
    sys.exit(main())
