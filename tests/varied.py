"""Scenes drawn at random: hulls, joints, laws and supports in combinations that nobody chose."""

from dataclasses import replace

import numpy as np

from solver.balance import balanced
from solver.hydrodynamics.hull.duck import duck
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.power_takeoff import PtoTable
from solver.scene import DOFS, EndStops, Float, Platform, Scene, Settings, Water
from solver.sea.realization import Realization
from solver.sea.spectrum import PiersonMoskowitz
from solver.structure.frame import Frame
from solver.structure.members import Member, PointMass
from solver.structure.sections import solid_rectangle, tube
from tests.awkward import RHO, STEEL, prism

PERIOD = 200.0  # of the sea, in which all of its waves come back [s]
FASTER, RATE = 1.2, 0.15  # frequency [rad/s] and rate that the joints' laws are about
LAWS = ("linear",) * 3 + ("quadratic", "friction", "limit", "spring", "negative spring", "inertia", "table")
SWITCHING = ("latch", "declutch", "one way", "soft stops", "hard stops", "friction", "limit")
IN_PLANE = ("surge", "heave", "pitch")


def varied(seed: int, laws: tuple[str, ...] = LAWS) -> tuple[Scene, str]:
    """A scene of linear pressure, and what it is in words; SimulationFailed where nothing balances it."""
    dice = np.random.default_rng(seed)
    heading = float(dice.choice([0.0, 0.0, 0.5, -1.2, 2.4]))
    support = str(dice.choice(["fixed", "elastic", "floating"], p=[0.35, 0.4, 0.25]))
    floats, x, words = [], -6.0, [support]
    if support == "floating":
        half = dice.uniform(3.0, 5.0)
        outline = [(-half, -half / 2), (half, -half / 2), (half, half / 2), (-half, half / 2)]
        hull = prism(outline, half * dice.uniform(1.2, 2.5))
        floats.append(_free("base", hull, half, (0.0, 0.0, 0.0), heading, dice))
        x = half + 10.0
    for i in range(int(dice.integers(1, 4))):
        size = dice.uniform(0.7, 2.5)
        kind, hull = _hull(dice, size)
        place = (x, dice.uniform(-2.0, 2.0) if heading else 0.0, 0.0)
        joint = "hinge" if support == "floating" else str(dice.choice(["hinge", "hinge", "heave", "free"]))
        law = str(dice.choice(laws))
        item = _free(f"f{i}", hull, size, place, heading, dice)
        if joint != "free":
            item = _jointed(item, joint, law, size, dice)
        if support == "floating":
            item = replace(item, on="base")
        elif support == "elastic" and joint != "hinge":  # its node is above the water
            item = replace(item, hinge=(*place[:2], 6.0), arm=(0.0, 0.0, -6.0))
        floats.append(item)
        words.append(f"{kind}, {joint}, {law if joint != 'free' else 'moored'}")
        x += 2 * size + dice.uniform(7.0, 11.0)
    water = Water(depth=float(dice.choice([20.0, 35.0, 60.0])))
    ways = [("mass", "x") if {"hinge", "pitch"} & set(f.motion) else ("mass",) for f in floats]
    floats = balanced(floats, water, ways)
    platform = _platform(dice, water.depth, {f.name: f.hinge for f in floats}) if support == "elastic" else None
    settings = Settings(duration=PERIOD, discard=3 * PERIOD, ramp=50.0, froude_krylov="linear")
    scene = Scene(water=water, sea=_sea(dice, heading), floats=tuple(floats), platform=platform, settings=settings)
    return scene, "; ".join(words)


def _sea(dice: np.random.Generator, heading: float) -> Realization:
    """Of whole multiples of one frequency, so that a record of PERIOD is all of it."""
    Hs, Tp, step = dice.uniform(0.2, 1.0), dice.uniform(4.5, 8.0), 2 * np.pi / PERIOD
    peak = 2 * np.pi / Tp
    omega = step * np.arange(int(0.6 * peak / step) + 1, int(2.4 * peak / step))
    size = np.sqrt(2 * PiersonMoskowitz(Hs=Hs, Tp=Tp).density(omega) * step)
    amplitude = size * np.exp(2j * np.pi * dice.random(omega.size))
    return Realization(
        omega=omega, amplitude=amplitude, heading=heading, peak_frequency=peak, nominal=(Hs, Tp), known=True
    )


def _hull(dice: np.random.Generator, size: float) -> tuple[str, Revolution | PanelHull]:
    kind = str(dice.choice(["sphere", "cylinder", "hemisphere", "profile", "prism", "duck"]))
    if kind == "sphere":
        return kind, Revolution.sphere(radius=size, draft=size * dice.uniform(0.6, 1.4))
    if kind == "cylinder":
        return kind, Revolution.vertical_cylinder(radius=size, draft=size * dice.uniform(0.5, 2.0), freeboard=size)
    if kind == "hemisphere":
        return kind, Revolution.hemisphere_cylinder(radius=size, height=size * dice.uniform(0.4, 1.0))
    if kind == "profile":
        points = [(0.0, -1.6), (0.7, -1.2), (1.0, -0.3), (1.0, 0.2), (0.8, 0.9), (0.0, 0.9)]
        return kind, Revolution.profile([(size * r, size * z) for r, z in points])
    if kind == "prism":
        a, d, f = size * dice.uniform([0.8, 0.5, 0.5], [1.6, 1.2, 1.0])
        outline = [(-a, -0.6 * d), (-0.7 * a, -d), (0.8 * a, -d), (a, -0.3 * d), (1.05 * a, f), (-a, f)]
        return kind, prism(outline, size * dice.uniform(1.0, 3.0))
    elevation, beak, width = dice.uniform([0.1, 1.6, 2.0], [0.6, 2.2, 4.0])
    return kind, duck(
        radius=size, beak=beak * size, elevation=elevation, submergence=0.4 * size, width=width * size
    )  # fmt: skip


def _free(name, hull, size, place, heading, dice) -> Float:
    """Moored softly, in the plane of waves from ahead or in all motions."""
    mass, motion = RHO * hull.volume, DOFS if heading else IN_PLANE
    lever = np.array([size**2 if axis in DOFS[3:] else 1.0 for axis in motion])
    held = np.array([axis in ("surge", "sway", "yaw") for axis in motion])
    inertia = 0.4 * mass * size**2
    return Float(
        name=name, hull=hull, mass=mass, inertia=(inertia, 0.9 * inertia, 1.1 * inertia), hinge=place, motion=motion,
        cog=(0.1 * size * dice.uniform(-1.0, 1.0), 0.0, -size * dice.uniform(0.25, 0.5)),
        stiffness=tuple((mass * 0.3**2 * held * lever).tolist()), damping=tuple((0.3 * mass * lever).tolist()),
    )  # fmt: skip


def _jointed(item: Float, joint: str, law: str, size: float, dice: np.random.Generator) -> Float:
    item, mass = replace(item, stiffness=0.0, damping=0.0), item.mass
    if joint == "heave":
        return replace(item, motion=("heave",), **_law(law, mass, dice))
    arm = (-max(2.2 * size, dice.uniform(2.0, 5.0)), 0.0, -dice.uniform(1.5, 3.0))
    hinge = tuple(np.subtract(item.hinge, arm).tolist())
    inertia = item.inertia[1] + mass * float(np.dot(arm, arm))
    return replace(item, motion=("hinge",), hinge=hinge, arm=arm, **_law(law, inertia, dice))


def _law(law: str, inertia: float, dice: np.random.Generator) -> dict[str, object]:
    B = inertia * FASTER * float(10 ** dice.uniform(-1.2, 0.3))
    if law == "table":
        rates = RATE * np.array([-3.0, -1.0, -0.4, 0.0, 0.4, 1.0, 3.0])
        force = B * RATE * np.tanh(rates / RATE)
        return {"pto_table": PtoTable(velocity=tuple(rates.tolist()), force=tuple(force.tolist()))}
    further = {
        "quadratic": {"quadratic_damping": B / RATE},
        "friction": {"coulomb": 0.5 * B * RATE},
        "limit": {"force_limit": 0.7 * B * RATE},
        "spring": {"stiffness": 0.3 * inertia * FASTER**2},
        "negative spring": {"pto_stiffness": -0.1 * inertia * FASTER**2},
        "inertia": {"mechanism_inertia": 0.5 * inertia},
        "latch": {"latch_load": 2 * B * RATE},
        "declutch": {"declutch_load": 0.4 * B * RATE},
        "one way": {"one_way": 1.0},
        "soft stops": {"end_stops": _stops(inertia, 4.0, 1.0)},
        "hard stops": {"end_stops": _stops(inertia, 15.0, 0.0)},
    }
    return {"pto_damping": B} | further.get(law, {})


def _stops(inertia: float, times: float, damping: float) -> EndStops:
    stiffness = inertia * (times * FASTER) ** 2
    return EndStops(lower=-0.06, upper=0.1, stiffness=stiffness, damping=damping * inertia * FASTER)


def _platform(dice: np.random.Generator, depth: float, hinges: dict[str, tuple[float, float, float]]) -> Platform:
    """Three or four legs that differ, and arms to all hinges."""
    nodes, members, legs, span = {"deck": (0.0, 0.0, 5.0)}, [], int(dice.integers(3, 5)), dice.uniform(4.0, 9.0)
    for i in range(legs):
        angle = 2 * np.pi * i / legs + dice.uniform(-0.3, 0.3)
        nodes[f"foot{i}"] = (span * np.cos(angle), span * np.sin(angle), -depth * float(dice.choice([1.0, 1.0, 0.7])))
        members.append(
            Member(
                name=f"leg{i}", start=f"foot{i}", end="deck", elements=int(dice.integers(2, 6)), material=STEEL,
                section=tube(dice.uniform(0.4, 1.0), 0.02), drag_coefficient=float(dice.choice([0.7, 1.0, 2.0])),
                inertia_coefficient=2.0,
            )
        )  # fmt: skip
    for name, place in hinges.items():
        nodes[name] = place
        members.append(
            Member(
                name=f"to {name}", start="deck", end=name, elements=1, section=solid_rectangle(0.7, 0.7), material=STEEL
            )
        )
    frame = Frame(
        nodes=nodes, members=tuple(members), clamped=tuple(f"foot{i}" for i in range(legs)),
        masses=(PointMass(node="deck", mass=float(dice.uniform(1e4, 8e4))),),
    )  # fmt: skip
    return Platform(
        frame=frame, legs=tuple(f"leg{i}" for i in range(legs)), hinge_nodes={name: name for name in hinges}
    )
