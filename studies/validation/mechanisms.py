"""Mechanisms of the IFToMM benchmark library on the augmented formulation: pendulum (A01), N-four-bar (A02)."""

import numpy as np

from solver.reference.augmented import Body
from solver.reference.joints import GROUND, Hinge
from solver.reference.twoloop import Trajectory, mechanical_energy, simulate_mechanism
from studies.validation import drawing
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, MARK, ORANGE, RED

DOWN = (0.0, -9.81, 0.0)  # the benchmarks' plane is x, y
LIGHT = (1e-12,) * 3  # inertia of a point mass; not zero, or nothing would fix its mass matrix's scale
THRESHOLD = 1e-3  # the library's, high precision [m]
PENDULUM = {5.0: (-0.9423054350, -0.3347543), 10.0: (-0.2750874626, -0.9614192)}  # t [s]: x, y [m]
STUCK = 1e-5  # last change of a step near the flat position of the bars, which rounding leaves undecided [m]
FOUR_BAR = (0.3284581115, 0.9445185382)  # N = 2, t = 10 s: point B0 [m]


def pendulum(t_end: float, dt: float, **options) -> tuple[tuple[Body, ...], Trajectory]:
    """A point mass of 1 kg on 1 m, let go level."""
    body = (Body(mass=1.0, inertia=LIGHT, position=(-1.0, 0.0, 0.0)),)
    joint = (Hinge(first=GROUND, second=0, point=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0)),)
    return body, simulate_mechanism(body, joint, None, t_end, dt, gravity=DOWN, **options)


def four_bars(count: int, t_end: float, dt: float, **options) -> tuple[tuple[Body, ...], Trajectory]:
    """Uniform links of 1 m and 1 kg, `count` + 1 uprights, then the bars between their tops, at 1 m/s."""
    link, z = {"mass": 1.0, "inertia": (1 / 12,) * 3}, (0.0, 0.0, 1.0)
    upright = [Body(**link, position=(i, 0.5, 0), velocity=(0.5, 0, 0, 0, 0, -1)) for i in range(count + 1)]
    bars = [Body(**link, position=(i + 0.5, 1, 0), velocity=(1, 0, 0, 0, 0, 0)) for i in range(count)]
    feet = [Hinge(first=GROUND, second=i, point=(i, 0, 0), axis=z) for i in range(count + 1)]
    tops = [Hinge(first=i + e, second=count + 1 + i, point=(i + e, 1, 0), axis=z) for i in range(count) for e in (0, 1)]
    bodies, options = (*upright, *bars), {"stuck": STUCK, **options}
    return bodies, simulate_mechanism(bodies, (*feet, *tops), None, t_end, dt, gravity=DOWN, **options)


def tip(run: Trajectory) -> np.ndarray:
    """Upper end (nt, 3) of the first link [m]."""
    return run.position[:, 0] + run.rotation[:, 0] @ [0, 0.5, 0]


def benchmarks() -> list[Check]:
    """Positions within the library's high-precision threshold; constraints and energy held."""
    bodies, swing = pendulum(10.0, 0.02)
    bars, run = four_bars(2, 10.0, 0.01)
    at = {t: swing.position[np.searchsorted(swing.time, t - 1e-9), 0] for t in PENDULUM}
    marks = [("pendulum, A01", t, xy, at[t]) for t, xy in PENDULUM.items()]
    marks.append(("four-bar, A02, N = 2", 10.0, FOUR_BAR, tip(run)[-1]))
    checks = [
        Check(
            case=case, quantity=f"{axis}({t:g} s) [m]", ours=float(ours[i]), published=published[i], allowed=THRESHOLD
        )
        for case, t, published, ours in marks
        for i, axis in enumerate("xy")
    ]  # fmt: skip
    for case, parts, path in (("pendulum, A01", bodies, swing), ("four-bar, A02, N = 2", bars, run)):
        drift = float(np.ptp(mechanical_energy(parts, path, DOWN)))
        # 1e-3 of the energy of one link raised by its length.
        quantity = "energy gained or lost [J]"
        checks.append(Check(case=case, quantity=quantity, ours=drift, published=0.0, allowed=9.81e-3))
    figure, (left, right) = drawing.axes(2, width=5)
    for axes, (t, x, y), printed in (
        (left, (swing.time, *swing.position[:, 0, :2].T), [(t, *xy) for t, xy in PENDULUM.items()]),
        (right, (run.time, *tip(run)[:, :2].T), [(10.0, *FOUR_BAR)]),
    ):
        axes.plot(t, x, color=BLUE, lw=1.2, label="ours, x")
        axes.plot(t, y, color=ORANGE, lw=1.2, label="ours, y")
        when, ex, why = np.array(printed).T
        axes.plot(when, ex, "o", color=RED, label="library", **MARK)
        axes.plot(when, why, "o", color=RED, **MARK)
        axes.set(xlabel="time [s]", ylim=(-1.15, 1.4))
        axes.legend(frameon=False, fontsize=7.5, ncols=3, loc="upper center")
    left.set(ylabel="position [m]", title="Pendulum, A01")
    right.set(title="N-four-bar, A02, N = 2: top of the first link")
    drawing.save(figure, "mechanisms", legend=())
    return checks
