"""Fast path and reference path side by side: 200 s of the Buan study, both floats on the elastic platform.

Prints for every float and leg the RMS of the difference of the two histories over the RMS of the history, after
50 s of ramp; of forces and displacements as vectors, and, not judged, of their components. The reference is the
paper's method throughout: six DOF a body with multipliers, 8,520 panels with 130 waves each, eq. 14's kernel
convolved, all modes. That kernel has all frequencies of the boundary elements; the fast path's memory seeks no poles
where these are too far apart for what the floats reflect to each other, which is most of what differs in the forces.
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.hydrodynamics.radiation.fitting import fit
from solver.reference.run import simulate_reference
from solver.run import simulate
from studies.benchmark.case import coefficients, scene

ALLOWED = 2e-3  # of the RMS
CHANNELS = ("rotation", "hinge_force", "top_displacement", "bottom_stress")
# Both far more exact than what is compared; the memory fitted about as well as the BEM agrees with itself.
SETTINGS = {
    "duration": 150.0, "discard": 50.0, "ramp": 50.0, "time_step": 0.125, "newton_tolerance": 1e-7, "azimuths": 24,
    "arc_points": 12, "line_points": 6, "field_tolerance": 1e-6, "memory_tolerance": 5e-4, "keep_series": True,
}  # fmt: skip
TOLERANCES = (3e-2, 1e-2, 5e-3, 3e-3, 1e-3, 5e-4)


def differences() -> Iterator[tuple[str, str, float, bool]]:
    """(quantity, float or leg, RMS of the difference over RMS, whether it is judged) of all that moves."""
    case, (known, _) = scene("elastic"), coefficients()
    settings = replace(case.settings, **SETTINGS)
    start = time.perf_counter()
    fast = simulate(replace(case, settings=settings), known)
    middle = time.perf_counter()
    slow = simulate_reference(replace(case, settings=replace(settings, accuracy="reference")), known, progress=show)
    print(f"200 s: fast path {middle - start:.1f} s, reference path {time.perf_counter() - middle:.0f} s")
    for name in CHANNELS:
        a, b = (record.series[name][1] for record in (fast, slow))
        size, apart = (np.mean(x**2, axis=0) for x in (b, a - b))
        vector = size.ndim > 1
        whole = (size.sum(axis=-1), apart.sum(axis=-1)) if vector else (size, apart)
        for i, (rms, d) in enumerate(zip(*whole, strict=True)):
            yield name, str(i + 1), float(np.sqrt(d / rms)), True
        if vector:
            for i, axis in np.ndindex(size.shape):
                if size[i, axis] > 1e-12 * size.max():  # the planar scene's still directions
                    yield name, f"{i + 1} {'xyz'[axis]}", float(np.sqrt(apart[i, axis] / size[i, axis])), False


def show(share: float) -> None:
    """Tell someone who waits at a terminal."""
    if sys.stderr.isatty():
        print(f"\rreference path: {share:.0%}, then its error estimate", end="\n" * (share >= 1), file=sys.stderr)


def memories() -> Iterator[tuple[float, int, float, float]]:
    """(tolerance, poles, misfit, seconds to fit) of the pair's radiation memory."""
    h, _ = coefficients()
    for tolerance in TOLERANCES:
        start = time.perf_counter()
        memory = fit(h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf, tolerance)
        yield tolerance, len(memory.beta), memory.error, time.perf_counter() - start


def main() -> int:
    """Print both tables; 1 if a channel differs by more than ALLOWED."""
    for tolerance, poles, error, seconds in memories():
        print(f"memory to {tolerance:g}: {poles} poles, misfit {error:.1e}, {seconds:.2f} s")
    worst = 0.0
    for name, label, difference, judged in differences():
        worst = max(worst, difference) if judged else worst
        print(f"{name:18s}{label:8s}{difference:10.1e}{'' if judged else '  component'}")
    print(f"worst {worst:.1e}, allowed {ALLOWED:g}")
    return int(worst >= ALLOWED)


if __name__ == "__main__":
    sys.exit(main())
