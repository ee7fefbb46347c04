"""Morison load on a fixed vertical pile: at the program's stations, integrated, and from a run."""

from dataclasses import replace

import numpy as np

from solver.run import simulate
from solver.scene import Platform, Scene, Settings, Water
from solver.sea.field import WaveField
from solver.sea.realization import regular
from solver.structure import water
from solver.structure.frame import Frame
from solver.structure.frame_model import assemble
from solver.structure.members import Material, Member
from solver.structure.sections import tube
from studies.validation import drawing
from studies.validation.checks import Check
from studies.validation.drawing import BLUE, GREY, ORANGE

G = 9.81
OCEAN = Water(depth=30.0)
DIAMETER, HEIGHT, PERIOD, CD, CM = 6.0, 6.0, 12.0, 1.0, 2.0  # m, m, s; integrated to still water
# Published for this pile: drag at the crest, inertia amplitude [N], largest mudline moment [N m].
DRAG, INERTIA, MOMENT = 205_475.0, 1_343_264.0, 2.18588e7


def pile(elements: int = 40) -> Platform:
    """D = 6 m in 30 m of water; a thousand times as stiff as steel, for the published pile is fixed."""
    rigid = Material(E=2.1e14, G=8e13, density=7850.0)
    leg = Member(
        name="pile", start="foot", end="top", elements=elements, section=tube(DIAMETER, 0.1), material=rigid,
        drag_coefficient=CD, inertia_coefficient=CM,
    )  # fmt: skip
    frame = Frame(nodes={"foot": (0, 0, -30), "top": (0, 0, 0)}, members=(leg,), clamped=("foot",))
    return Platform(frame=frame, legs=("pile",))


def morison() -> list[Check]:
    """Loads at the program's stations, Morison's formula integrated numerically, and the foot moment of a run."""
    sea = regular(height=HEIGHT, period=PERIOD)
    omega, k = sea.omega[0], WaveField(sea, OCEAN.depth, G).k[0]
    z, weight = _gauss(200)
    speed = HEIGHT / 2 * omega * np.cosh(k * (z + 30)) / np.sinh(k * 30)
    per_drag = 0.5 * OCEAN.density * CD * DIAMETER * speed**2 * weight
    per_mass = CM * OCEAN.density * np.pi / 4 * DIAMETER**2 * omega * speed * weight
    phase = np.linspace(0, 2 * np.pi, 3601)
    formula = _moment(per_drag @ (z + 30), per_mass @ (z + 30), phase)
    stations = water.stations(assemble(pile().frame), 2)
    field = WaveField(sea, OCEAN.depth, G)
    u = field.velocity(stations.position)[:, 0, 0].real
    a = np.abs(field.acceleration(stations.position)[:, 0, 0])
    drag = 0.5 * OCEAN.density * stations.drag * stations.diameter * u**2 * stations.weight
    mass = stations.inertia * OCEAN.density * np.pi / 4 * stations.diameter**2 * a * stations.weight
    ours = _moment(drag @ (stations.position[:, 2] + 30), mass @ (stations.position[:, 2] + 30), phase)
    time, moment = _foot_moment()
    at = {"case": "Morison on a pile"}
    checks = [
        Check(quantity="drag at the crest [N]", ours=drag.sum(), published=DRAG, allowed=1e-5 * DRAG, **at),
        Check(quantity="inertia amplitude [N]", ours=mass.sum(), published=INERTIA, allowed=1e-5 * INERTIA, **at),
        Check(quantity="largest mudline moment [N m]", ours=ours.max(), published=MOMENT, allowed=1e-5 * MOMENT, **at),
        Check(
            quantity="the same by 200-point integral [N m]", ours=formula.max(), published=MOMENT,
            allowed=1e-5 * MOMENT, **at,
        ),
        # The record has the step's samples only: (ω dt/2)²/8 of a crest is missed, and the pile still gives by 1e-3.
        Check(
            quantity="the same from a run's foot stress [N m]", ours=moment.max(), published=MOMENT,
            allowed=1e-3 * MOMENT, **at,
        ),
        # Loads and inertia within the elements are in it: the mesh does not matter.
        *(
            Check(
                quantity=f"the same from the reactions, {n} elements [N m]", ours=_overturning(n), published=MOMENT,
                allowed=1e-4 * MOMENT, **at,
            )
            for n in (1, 2, 10)
        ),
    ]  # fmt: skip
    figure, (axes,) = drawing.axes(1, width=7)
    some = slice(None, None, 6)
    axes.plot((time % PERIOD)[some], moment[some] / 1e6, "x", color=BLUE, ms=4, label="ours, foot stress of a run")
    axes.plot(phase / omega, np.abs(formula) / 1e6, color=GREY, lw=1.2, label="Morison's formula, integrated")
    axes.axhline(MOMENT / 1e6, color=ORANGE, ls="--", lw=1, label="published maximum")
    axes.set(xlabel="time after a crest [s]", ylabel="|mudline moment| [MN m]", ylim=(0, 27))
    axes.set(title="Fixed pile, D = 6 m")
    drawing.save(figure, "pile")
    return checks


def _gauss(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Heights from the seabed to still water [m] and their weights [m]."""
    x, w = np.polynomial.legendre.leggauss(points)
    return 15 * (x - 1), 15 * w


def _moment(drag: float, inertia: float, phase: np.ndarray) -> np.ndarray:
    """M(ωt) of a crest at ωt = 0: drag cos|cos| + inertia sin (acceleration leads by a quarter)."""
    return drag * np.cos(phase) * np.abs(np.cos(phase)) - inertia * np.sin(phase)


def _overturning(elements: int) -> float:
    """Largest moment on the ground [N m] of a run."""
    settings = Settings(
        duration=2 * PERIOD, discard=2 * PERIOD, ramp=PERIOD, time_step=0.05, outputs=("reactions",),
        stations_per_element=max(2, 8 // elements),
    )  # fmt: skip
    sea = regular(height=HEIGHT, period=PERIOD)
    record = simulate(Scene(water=OCEAN, sea=sea, platform=pile(elements), settings=settings))
    return float(np.abs(record.variables["overturning_moment"][1][1, :2]).max())


def _foot_moment() -> tuple[np.ndarray, np.ndarray]:
    """t [s] and |M| [N m] at the foot: what the fibre stress has beyond that of the weight, times I/c."""
    settings = Settings(duration=2 * PERIOD, discard=2 * PERIOD, ramp=PERIOD, time_step=0.05, keep_series=True)
    scene = Scene(water=OCEAN, sea=regular(height=HEIGHT, period=PERIOD), platform=pile(), settings=settings)
    record = simulate(scene)
    calm = simulate(replace(scene, sea=regular(height=1e-9, period=PERIOD)))
    stress = record.series["bottom_stress"][1][:, 0] - calm.series["bottom_stress"][1][:, 0]
    section = tube(DIAMETER, 0.1)
    return record.series["time"][1], np.abs(stress) * section.Iy / section.fibre
