"""Free decay of the OES Task 10 sphere in heave: linear against exact, and longer from larger offsets."""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import find_peaks

from solver.run import simulate
from solver.scene import Scene
from solver.sea.realization import CALM
from studies.validation import drawing, response
from studies.validation.checks import Check, columns
from studies.validation.drawing import BLUE, GREEN, GREY, MARK, ORANGE, RED
from studies.validation.sphere import DEEP, RADIUS, RHO, G, coefficients, sphere

MASS = RHO * 2 / 3 * np.pi * RADIUS**3  # [kg], the displacement exactly
AT_ZERO, AT_INFINITY = 0.8310, 0.5  # A' in heave, Hulme 1982
# Exact linear solution from 1 m by multipoles: (t [s], z [m]).
EXTREMA = [(2.2125, -0.86713), (4.4179, 0.63502), (6.5972, -0.46497), (8.7702, 0.34671)]
RIPPLE = 1e-3
OFFSETS = (1.0, 3.0, 5.0)  # [m], those of the set; the last one lifts the sphere out of the water


def run(offset: float, froude_krylov: str) -> tuple[np.ndarray, np.ndarray]:
    """t [s] and heave [m] of 16 s."""
    settings = response.settings(duration=16.0, discard=0.0, ramp=0.0, time_step=0.1, froude_krylov=froude_krylov)
    scene = Scene(water=DEEP, sea=CALM, floats=(sphere(MASS, offset=offset),), settings=settings)
    record = simulate(scene, coefficients())
    t, z = record.series["time"][1], record.series["motion"][1][:, 0, 0]
    return np.concatenate([[0.0], t]), np.concatenate([[offset], z])


def extrema(t: np.ndarray, z: np.ndarray) -> list[tuple[float, float]]:
    """(t, z) where the velocity is zero after the release; there and back by less than RIPPLE of it all is no turn."""
    path = CubicSpline(t, z)
    turns = path.derivative().roots(extrapolate=False)
    whole = np.concatenate([[z[0]], path(turns), [z[-1]]])
    far = RIPPLE * np.ptp(z)
    kept = sorted(i - 1 for side in (whole, -whole) for i in find_peaks(side, prominence=far)[0])
    return [(float(x), float(path(x))) for x in turns[kept] if x > 1.0]


def exact(t: np.ndarray) -> np.ndarray:
    """z/z₀ (nt,) of the linear decay, from Hulme's published coefficients of the hemisphere, not from ours.

    The one-sided transform of the velocity is V = -C/(C - ω²(m + A) - iωB), and
    z/z₀ = 1 + (2/π) ∫ Re V sin(ωt)/ω dω. Beyond Ka = 10 A' - A'(∞) falls as ω⁻², and B is nil.
    """
    published = columns("hulme-1982-hemisphere.csv")
    grid = np.sqrt(np.concatenate([[0.0], published["Ka"]]) * G / RADIUS)
    omega = (np.arange(60_000) + 0.5) * 1e-3
    inside = np.minimum(omega, grid[-1])
    A = CubicSpline(grid, np.concatenate([[AT_ZERO], published["heave_A"]]))(inside)
    B = CubicSpline(grid, np.concatenate([[0.0], published["heave_B"]]))(inside) * (omega == inside)
    A = AT_INFINITY + (A - AT_INFINITY) * (inside / omega) ** 2
    C = RHO * G * np.pi * RADIUS**2
    V = -C / (C - omega**2 * MASS * (1 + A + 1j * B))
    return 1 + 2e-3 / np.pi * np.array([V.real / omega @ np.sin(omega * each) for each in t])


def decays() -> list[Check]:
    """The first five extrema within 0.2 % in time and 0.2 % of the offset in value."""
    fine = np.arange(0, 14, 0.02)
    theory = np.column_stack([fine, exact(fine)])
    peaks = extrema(*theory.T)[:5]
    t, z = run(1.0, "linear")
    checks = []
    for i, ((when, value), (at, height)) in enumerate(zip(extrema(t, z)[:5], peaks, strict=True), 1):
        reference = EXTREMA[i - 1] if i <= len(EXTREMA) else (at, height)
        known = "multipoles" if i <= len(EXTREMA) else "Hulme's A, B"
        for quantity, mine, other, allowed in (
            (f"extremum {i}, time [s]", when, reference[0], 2e-3 * reference[0]),
            (f"extremum {i}, heave [m]", value, reference[1], 2e-3),
        ):
            checks.append(
                Check(
                    case="sphere, decay, linear", quantity=f"{quantity}, {known}", ours=mine, published=other,
                    allowed=allowed,
                )
            )  # fmt: skip
    # What makes Hulme's four digits fit to stand in for the fifth: a tenth of what is allowed there.
    last = f"Hulme's A, B themselves: extremum {len(EXTREMA)}, heave [m]"
    checks.append(
        Check(case="sphere, decay, linear", quantity=last, ours=peaks[3][1], published=EXTREMA[3][1], allowed=2e-4)
    )
    return checks + _large(t, z)


def _large(t: np.ndarray, z: np.ndarray) -> list[Check]:
    """From larger offsets the waterplane is smaller on average, and the first cycle longer."""
    paths = {offset: run(offset, "body-nonlinear") for offset in OFFSETS}
    before, checks = extrema(t, z)[1][0], []
    for offset, path in paths.items():
        cycle = extrema(*path)[1][0]
        quantity = f"first cycle from {offset:g} m [s] (longer than the last)"
        checks.append(
            Check(
                case="sphere, decay, body-nonlinear", quantity=quantity, ours=cycle, published=before, allowed=0.0,
                side="above",
            )
        )  # fmt: skip
        before = cycle
    figure, (axes,) = drawing.axes(1, width=7)
    axes.plot(t, z, color=GREY, lw=1.6, label="ours, linear, from any offset")
    for (offset, (when, heave)), colour in zip(paths.items(), (BLUE, GREEN, RED), strict=True):
        axes.plot(when, heave / offset, color=colour, lw=1, ls="--", label=f"ours, body-nonlinear, from {offset:g} m")
    axes.plot(*np.array(EXTREMA).T, "o", color=ORANGE, label="exact linear extrema", **MARK)
    axes.set(xlabel="time [s]", ylabel="heave over offset [-]", title="OES Task 10 sphere let go in still water")
    drawing.save(figure, "decay")
    return checks
