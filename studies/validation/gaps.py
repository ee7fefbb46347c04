"""Water that rings in narrow gaps, with damping lids on it and without: the march beside the frequency domain."""

from collections.abc import Iterator
from math import inf

import numpy as np

from solver.coupled.boundary import coefficients
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.hull.ring import ring
from solver.hydrodynamics.radiation.fitting import USUAL
from solver.run import simulate
from solver.scene import Float, Scene, Settings, Water
from solver.sea.realization import components
from studies.validation.checks import Check
from studies.validation.lines import power
from tests.awkward import prism

CASE = "gaps"
LOSSLESS = "Without loss water rings in a band that no memory fits."
WIDTH = 0.8
WAVES, LOW, HIGH = 0.04, 0.8, 2.2  # waves at multiples of so many rad/s: a record comes back after 157 s
STEEPNESS = 1e-3  # of each, k times amplitude
BOX = prism([(-2, -1.5), (2, -1.5), (2, 1), (-2, 1)], 8.0)
# Hulls, places [m] and power take-offs [N s/m].
SCENES: dict[str, tuple[tuple[Hull, Hull], tuple[float, float], tuple[float, float]]] = {
    "spar of 3 m in a ring of 3.5 to 10 m": (
        (
            Revolution.vertical_cylinder(radius=3.0, draft=10.0, freeboard=3.0),
            ring(((3.5, -3.0), (10.0, -3.0), (10.0, 2.0), (3.5, 2.0))),
        ),
        (0.0, 0.0),
        (2e5, 4e5),
    ),
    "boxes 0.6 m apart": ((BOX, BOX), (0.0, 4.6), (5e4, 1e5)),
}
DAMPING = dict(zip(SCENES, ((0.0, 0.02, 0.1), (0.05,)), strict=True))


def lids() -> list[Check]:
    """Misfit of the memory and mean power, with more and more damping."""
    return [check for name, each in DAMPING.items() for damping in each for check in _with(name, damping)]


def scene(name: str, damping: float, method: str) -> Scene:
    """Two floats in heave, in waves that the water between them rings in."""
    floats = tuple(
        Float(
            name=name, hull=hull, mass=1025 * hull.volume, inertia=(1e7,) * 3, hinge=(x, 0, 0), motion=("heave",),
            pto_damping=load,
        )
        for name, hull, x, load in zip(("first", "second"), *SCENES[name], strict=True)
    )  # fmt: skip
    omega = WAVES * np.arange(round(LOW / WAVES), round(HIGH / WAVES) + 1)
    sea = components(amplitude=STEEPNESS * 9.81 / omega**2, omega=omega, phase=np.arange(omega.size) ** 2 % 7)
    period = 2 * np.pi / WAVES
    settings = Settings(
        duration=2 * period, discard=5 * period, ramp=period, ramp_form="cosine", froude_krylov="linear",
        method=method, gap_damping=damping, gap_width=WIDTH * (damping > 0),
    )  # fmt: skip
    return Scene(water=Water(depth=inf), sea=sea, floats=floats, settings=settings)


def _with(name: str, damping: float) -> Iterator[Check]:
    item = scene(name, damping, "time")
    known = coefficients(item)
    march, lines = simulate(item, known), simulate(scene(name, damping, "frequency"), known)
    told = f"{name}, gap_damping = {damping:g}: "
    note = "" if damping else LOSSLESS
    yield Check(
        case=CASE, quantity=told + "misfit of the memory", ours=float(march.attrs["memory_error"]),
        published=USUAL, side="below", allowed=0.0 if damping else inf, note=note,
    )  # fmt: skip
    yield Check(
        case=CASE, quantity=told + "mean power, march over frequency domain", ours=power(march) / power(lines),
        published=1.0, allowed=0.02 if damping else inf, note=note,
    )  # fmt: skip
