"""The scenes of `make stress`: the Buan study, one or two things at a time driven to their ends.

A case is the study file's tables with some keys changed, and, for what a file cannot say, a change
of the scene built from them. So every case passes the door that a user's file passes.
"""

import copy
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.study.reading import read
from solver.scene import Scene
from solver.sea.realization import Realization, realize
from solver.sea.spectrum import WhiteNoise

STUDY = Path("studies/buan.toml")
RECORD = {"duration": 60.0, "discard": 20.0, "ramp": 20.0}
SHORTEST = 2 * np.pi / 3.4  # period of the shortest wave of the study [s]
E, G = 2.1e11, 8.33e10
DISPLACED = 2147.0
ARM, HEIGHT = 2.36, 2.6
CENTRE = 1.5 + ARM
OPTIMUM = 1e5

STIFFNESS = (1e-2, 1e-1, 1.0, 1e1, 1e2, 1e4, 1e6)
STEPS = (200, 100, 50, 24, 12, 8, 6, 5, 4)
MASS = (0.05, 0.1, 0.3, 1.0, 1.5, 2.0, 3.0, 5.0)
PTO = (0.0, 0.1, 1.0, 10.0, 1000.0)
HEIGHTS = (0.01, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0)
STOPS = {"lower": -0.9, "upper": 0.9, "stiffness": 2e7, "damping": 2e5}  # rad, N m/rad, N m s/rad
PERIODS = (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 14.0, 18.0, 25.0)

Change = Callable[[Scene], Scene]


@dataclass(frozen=True, kw_only=True)
class Case:
    """One scene: place on the map (family, x, y), changed keys of the study file, change of the scene."""

    family: str
    x: str
    y: str = ""
    keys: Mapping[str, Any] = field(default_factory=dict)
    change: Change | None = None
    platform: str = "elastic"
    scheme: int = 0  # stages of the reference path's collocation; 0: the production path
    restarts: int | None = None  # times that the run stops and goes on from a file, where that is what is tried
    limit: float = 60.0  # of its wall time [s]

    @property
    def name(self) -> str:
        return f"{self.family}: {self.x}" + (f", {self.y}" if self.y else "")


def tables(case: Case) -> dict[str, Any]:
    """The study file's tables with the case's keys set; 'floats.*.mass' stands for all floats."""
    content = copy.deepcopy(read(STUDY))
    content["axes"] = {"sea_state": ["representative"], "platform": [case.platform], "seed": [0]}
    content["record"] |= RECORD
    for key, value in case.keys.items():
        _set(content, key.split("."), value)
    return content


def _set(table: Any, path: list[str], value: Any) -> None:
    head, *rest = path
    if head == "*":
        for item in table:
            _set(item, rest, value)
    elif not rest:
        table[int(head) if isinstance(table, list) else head] = value
    else:
        _set(table[int(head)] if isinstance(table, list) else table.setdefault(head, {}), rest, value)


def sea_state(Hs: float, Tp: float) -> dict[str, Any]:
    """A sea in the band from 0.6 to 3 times the peak frequency."""
    peak = 2 * np.pi / Tp
    return {"waves.band": [0.6 * peak, 3 * peak], "sea_states": {"representative": {"Hs": Hs, "Tp": Tp}}}


def stiffer(factor: float) -> dict[str, Any]:
    return {"platform.materials.steel.E": E * factor, "platform.materials.steel.G": G * factor}


def heavier(ratio: float) -> dict[str, Any]:
    return {"floats.*.mass": DISPLACED * ratio, "floats.*.inertia": [859.0 * ratio] * 3}


def regular(amplitude: float, omega: float) -> Change:
    """One wave."""
    sea = Realization(omega=np.array([omega]), amplitude=np.array([amplitude + 0j]), peak_frequency=omega)
    return lambda scene: replace(scene, sea=sea)


def calm(scene: Scene) -> Scene:
    return replace(scene, sea=replace(scene.sea, amplitude=np.zeros_like(scene.sea.amplitude)))


def dropped(angle: float) -> Change:
    """Floats let go turned by `angle`; + is out of the water for the front float, so - for the rear one."""

    def change(scene: Scene) -> Scene:
        front, rear = scene.floats
        floats = (replace(front, offset=angle), replace(rear, offset=-angle))
        return replace(calm(scene), floats=floats)

    return change


def white(Hs: float) -> Change:
    band = (0.5, 4.0)
    sea = realize(WhiteNoise(Hs=Hs, band=band), components=200, band=band, seed=1)
    return lambda scene: replace(scene, sea=sea, settings=replace(scene.settings, time_step=0.13))


def numerics(**settings: Any) -> Change:
    return lambda scene: replace(scene, settings=replace(scene.settings, **settings))


def joints(**changes: Any) -> Change:
    return lambda scene: replace(scene, floats=tuple(replace(f, **changes) for f in scene.floats))


def place(hinge: float, height: float, arm: float) -> dict[str, Any]:
    """Hinges at x = -hinge and +hinge at `height`; arms reach `arm` outwards and down to still water."""
    return {
        "floats.0.hinge": [-hinge, 0.0, height], "floats.0.arm": [-arm, 0.0, -height],
        "floats.1.hinge": [hinge, 0.0, height], "floats.1.arm": [arm, 0.0, -height],
    }  # fmt: skip


def matrix() -> list[Case]:
    """All cases, the longest first so that two workers end together."""
    return [*_long(), *_maps(), *_strips()]


def geometries() -> list[int]:
    """Numbers of cases that have every geometry of the floats among them, that of the study once."""
    cases = matrix()
    first = next(i for i, case in enumerate(cases) if case.name == "record: 80 s, fixed")
    return [first, *(i for i, case in enumerate(cases) if case.family in ("gap", "geometry"))]


def _long() -> Iterator[Case]:
    for stages in (2, 3):
        for n in (50, 24, 12, 8, 6):
            # Low waves keep the surface off the hull's edges: smooth loads, on which an order can be seen.
            keys = {"solver.time_step": SHORTEST / n, "sea_states": {"representative": {"Hs": 0.3, "Tp": 5.46}}}
            short = {f"record.{k}": v for k, v in {"duration": 12.0, "discard": 0.0, "ramp": 0.0}.items()}
            yield Case(
                family="reference path", x={2: "trapezoidal", 3: "Lobatto IIIA"}[stages], y=f"1/{n}",
                keys=keys | short, change=numerics(ramp=6.0, ramp_form="cosine"), platform="fixed", scheme=stages,
                limit=300.0,
            )  # fmt: skip
    for platform in ("elastic", "fixed"):
        for hours in (24, 3):
            keys = {"record.duration": hours * 3600.0, "record.discard": 100.0, "record.ramp": 50.0}
            yield Case(family="record", x=f"{hours} h", y=platform, keys=keys, platform=platform, limit=900.0)
        yield Case(family="record", x="80 s, again", y=platform, platform=platform)
        for restarts in (0, 1, 2):
            keys = {"record.duration": 3 * 3600.0}
            yield Case(family="restart", x=f"{restarts} times in 3 h", y=platform, keys=keys, platform=platform,
                       restarts=restarts)  # fmt: skip


def _maps() -> Iterator[Case]:
    for platform in ("elastic", "fixed"):
        yield Case(family="record", x="80 s", y=platform, platform=platform)
    for factor in STIFFNESS:
        for n in STEPS:
            keys = stiffer(factor) | {"solver.time_step": SHORTEST / n}
            yield Case(family="step x stiffness", x=f"{factor:g}", y=f"1/{n}", keys=keys)
        for ratio in MASS:
            yield Case(
                family="mass x stiffness", x=f"{factor:g}", y=f"{ratio:g}", keys=stiffer(factor) | heavier(ratio)
            )
    for Tp in PERIODS:
        for Hs in HEIGHTS:
            yield Case(family="Hs x Tp", x=f"{Tp:g}", y=f"{Hs:g}", keys=sea_state(Hs, Tp))
            keys = sea_state(Hs, Tp) | {"floats.*.end_stops": STOPS}
            yield Case(family="Hs x Tp, stops", x=f"{Tp:g}", y=f"{Hs:g}", keys=keys)
    for ratio in MASS:
        for damping in PTO:
            keys = heavier(ratio) | {"floats.*.pto_damping": OPTIMUM * damping}
            yield Case(family="mass x PTO", x=f"{damping:g}", y=f"{ratio:g}", keys=keys, platform="fixed")
    for modes in (2, 6, 30, "all"):
        for zeta in (0.0, 0.001, 0.01, 0.05):
            keys = {"solver.modes": modes, "platform.damping_ratio": zeta}
            yield Case(family="modes x damping", x=f"{100 * zeta:g} %", y=str(modes), keys=keys)
    for n in STEPS:
        for Hs in (0.5, 1.28, 2.0, 3.0, 4.0):
            keys = {"sea_states": {"representative": {"Hs": Hs, "Tp": 7.0}}, "solver.time_step": SHORTEST / n}
            yield Case(family="step x Hs", x=f"{Hs:g}", y=f"1/{n}", keys=keys, platform="fixed")


def _strips() -> Iterator[Case]:
    for platform in ("elastic", "fixed"):
        yield Case(family="no wave", x=platform, change=calm, platform=platform)
        yield Case(family="white noise", x=platform, change=white(1.0), platform=platform)
        for angle in (0.1, 0.5, 0.9, 1.2, -0.3, -0.6, -0.75):
            yield Case(family="let go at", x=f"{angle:+g} rad", y=platform, change=dropped(angle), platform=platform)
    yield Case(family="PTO", x="-1", keys={"floats.*.pto_damping": -OPTIMUM})
    for omega, name in ((0.40, "sway"), (1.9, "float"), (3.11, "twist"), (6.3, "bending")):
        for amplitude in (0.02, 0.3):
            yield Case(family="resonance", x=name, y=f"{amplitude:g} m", change=regular(amplitude, omega),
                       keys={"platform.damping_ratio": 0.0})  # fmt: skip
    for gap in (1.0, 0.1, 0.01, -0.1):
        yield Case(family="gap", x=f"{gap:g} m", keys=place(1 + gap / 2 + ARM, HEIGHT, -ARM))
    yield Case(family="geometry", x="arm horizontal", keys=place(1.5, 0.0, ARM))
    for name, height, arm in (("arm vertical", HEIGHT, 0.0), ("hinge at the centre", 0.0, 0.0)):
        yield Case(family="geometry", x=name, keys=place(CENTRE - arm, height, arm))
    for arm in (1e-3, 1e-2, 1e-1):
        yield Case(family="geometry", x=f"arm {arm:g} m", keys=place(CENTRE - arm, 0.0, arm))
    yield Case(family="geometry", x="arm 20 m", keys=place(1.5, HEIGHT, 20.0))
