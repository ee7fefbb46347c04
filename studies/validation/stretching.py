"""Morison load up to the waves' surface: a fixed pile in closed form, and what each way of it does to Buan's sway."""

from dataclasses import replace

import numpy as np

from solver.run import simulate
from solver.scene import Scene, Settings
from solver.sea.field import WaveField
from solver.sea.realization import regular
from solver.statistics import STATISTICS
from studies.validation import drawing
from studies.validation.cases import buan
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, GREY, ORANGE
from studies.validation.pile import CD, CM, DIAMETER, HEIGHT, OCEAN, PERIOD, G, pile

KINDS = {"none": GREY, "wheeler": BLUE, "extrapolated": ORANGE}
AIR = 6.0  # of the pile above still water [m]
MAX, STD = STATISTICS.index("max"), STATISTICS.index("std")


def loads() -> list[Check]:
    """Largest force and moment on the ground in a steep wave; std and largest displacement of Buan's deck."""
    figure, (forces, sways) = drawing.axes(2)
    checks = []
    for kind, colour in KINDS.items():
        series = _reactions(kind)
        t = series["time"][1]
        told = {"force [N]": series["base_shear"][1][:, 0], "moment [N m]": series["overturning_moment"][1][:, 1]}
        exact = dict(zip(told, _integrals(kind, t), strict=True))
        for name, ours in told.items():
            largest = float(np.abs(exact[name]).max())
            checks.append(
                Check(
                    case=f"pile of {DIAMETER:g} m, {kind}", quantity=f"largest {name}", ours=float(np.abs(ours).max()),
                    published=largest, allowed=2e-3 * largest,
                )
            )  # fmt: skip
        forces.plot(t % PERIOD, told["force [N]"] / 1e6, ".", color=colour, ms=3, label=kind)
        order = np.argsort(t % PERIOD)
        forces.plot((t % PERIOD)[order], exact["force [N]"][order] / 1e6, color=colour, lw=1)
    forces.set(xlabel="time after a crest [s]", ylabel="force on the ground [MN]", title="Fixed pile, lines: integrals")
    still = None
    for kind, colour in KINDS.items():
        top = _sway(kind)
        still = top if still is None else still
        for name, size, before in zip(("std", "max"), top, still, strict=True):
            checks.append(
                Check(
                    case="Buan without floats", quantity=f"{name} of the deck's sway over that to still water, {kind}",
                    ours=size / before, published=1.0, allowed=np.inf, note="a slow platform is pushed by the crests",
                )
            )  # fmt: skip
        sways.bar(kind, top[0], color=colour)
    sways.set(ylabel="std of the deck's sway [m]", title="Buan without floats, Hs 1.28 m")
    drawing.save(figure, "stretching")
    return checks


def _loaded(kind: str) -> Scene:
    """The pile and its steep wave."""
    platform = pile()
    nodes = {**platform.frame.nodes, "top": (0.0, 0.0, AIR)}
    settings = Settings(
        duration=2 * PERIOD, discard=2 * PERIOD, ramp=PERIOD, time_step=0.05, outputs=("reactions",), keep_series=True
    )
    platform = replace(platform, frame=replace(platform.frame, nodes=nodes), wave_stretching=kind)
    return Scene(water=OCEAN, sea=regular(height=HEIGHT, period=PERIOD), platform=platform, settings=settings)


def _reactions(kind: str) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    return dict(simulate(_loaded(kind)).series)


def _integrals(kind: str, times: np.ndarray) -> np.ndarray:
    """Force [N] and moment about the seabed [N m] (2, m), by 200 points from there to the surface."""
    sea, d = regular(height=HEIGHT, period=PERIOD), OCEAN.depth
    omega, k = sea.omega[0], WaveField(sea, d, G).k[0]
    phase, (x, w) = omega * times, np.polynomial.legendre.leggauss(200)
    eta = HEIGHT / 2 * np.cos(phase)
    top = 0 * eta if kind == "none" else eta
    z = -d + (top + d)[:, None] * (x + 1) / 2
    level = (z - eta[:, None]) / (1 + eta[:, None] / d) if kind == "wheeler" else z
    speed = HEIGHT / 2 * omega * np.cosh(k * (level + d)) / np.sinh(k * d)
    u, du = speed * np.cos(phase)[:, None], -omega * speed * np.sin(phase)[:, None]
    load = 0.5 * OCEAN.density * CD * DIAMETER * np.abs(u) * u + CM * OCEAN.density * np.pi / 4 * DIAMETER**2 * du
    weight = (top + d)[:, None] / 2 * w
    return np.array([(load * weight).sum(axis=1), (load * (z + d) * weight).sum(axis=1)])


def _sway(kind: str) -> tuple[float, float]:
    """Std and largest displacement of a leg's top [m]."""
    scene = buan("elastic-no-floats")
    assert scene.platform is not None, "it has one"
    platform = replace(scene.platform, wave_stretching=kind)
    top = simulate(replace(scene, platform=platform)).variables["top_displacement"][1][0, 0]
    return float(top[STD]), float(top[MAX])
