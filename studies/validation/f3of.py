"""F3OF (OES Task 10), a floating base with two hinged flaps, beside three codes: first extrema of the decays."""

import csv
from pathlib import Path

import numpy as np

from pipeline.bridge import engine, scenes
from pipeline.bridge.geometry import geometry_of
from pipeline.bridge.loading import load
from pipeline.tasks.task import Parameters, expand
from solver.run import simulate
from studies.validation import drawing
from studies.validation.checks import REFERENCE, Check
from studies.validation.decay import extrema
from studies.validation.drawing import BLUE, MARK, ORANGE

FIRST = 6  # extrema that are judged
TIME, VALUE = 0.02, 0.03  # by which the codes' spread is widened
FLOAT = {"surge": "base", "pitch": "base", "flap1": "fore", "flap2": "aft"}
DECAYS = ("DT1", "DT2", "DT3")


def decays() -> list[Check]:
    """Each of the first extrema within the spread of the three codes, widened by 2 % in time and 3 % in value."""
    tasks = {
        str(task.labels["variant"]): task.parameters
        for task in expand(load(Path(__file__).parents[1] / "f3of.toml").content)
    }
    geometry = geometry_of(tasks[DECAYS[0]])
    assert geometry is not None, "it floats"
    known = engine.hydrodynamics(geometry)
    paths = {name: _path(tasks[name], known) for name in DECAYS}
    published = _published()
    checks = []
    for (test, quantity), spread in published.items():
        t, z = paths[test][quantity]
        for number, (when, value) in enumerate(extrema(t, z)[:FIRST], 1):
            times, values = spread[number].T
            unit = "m" if quantity == "surge" else "deg"
            for what, mine, theirs, more in (
                ("time [s]", when, times, TIME),
                (f"value [{unit}]", value, values, VALUE),
            ):
                middle, half = (theirs.max() + theirs.min()) / 2, (theirs.max() - theirs.min()) / 2
                name = f"{quantity}, extremum {number}, {what}"
                allowed = half + more * abs(middle)
                checks.append(Check(case=f"F3OF {test}", quantity=name, ours=mine, published=middle, allowed=allowed))
    _draw(paths, published)
    return checks


def _path(parameters: Parameters, known: object) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """t [s] and motion [m or °] by the published names of the quantities, of the bodies that move."""
    scene = scenes.scene(parameters)
    record = simulate(scene, known)
    _, motion = record.series["motion" if "motion" in record.series else "rotation"]
    t = np.concatenate([[0.0], record.series["time"][1]])
    paths = {}
    for b, item in enumerate(scene.floats):
        for quantity in (name for name, float_ in FLOAT.items() if float_ == item.name):
            axis = "hinge" if quantity.startswith("flap") else quantity
            if axis in item.motion:
                n, unit = item.motion.index(axis), 1.0 if axis == "surge" else 180 / np.pi
                values = motion[:, b, n] if motion.ndim == 3 else motion[:, b]
                paths[quantity] = t, np.concatenate([item.per_axis("offset")[[n]], values]) * unit
    return paths


def _published() -> dict[tuple[str, str], dict[int, np.ndarray]]:
    """(test, quantity) -> number of the extremum -> time [s] and value (codes, 2)."""
    lines = [x for x in (REFERENCE / "f3of-decay-extrema.csv").read_text().splitlines() if not x.startswith("#")]
    found: dict[tuple[str, str], dict[int, list[list[float]]]] = {}
    for row in csv.DictReader(lines):
        place = found.setdefault((row["test"], row["quantity"]), {}).setdefault(int(row["number"]), [])
        place.append([float(row["time_s"]), float(row["value"])])
    return {key: {number: np.array(rows) for number, rows in each.items()} for key, each in found.items()}


def _draw(paths: dict[str, dict[str, tuple[np.ndarray, np.ndarray]]], published: dict[tuple[str, str], dict]) -> None:
    """Ours as lines, the codes' extrema as markers."""
    figure, axes = drawing.axes(len(published))
    for each, ((test, quantity), spread) in zip(axes, published.items(), strict=True):
        t, value = paths[test][quantity]
        each.plot(t, value, color=BLUE, lw=1.2, label="ours")
        theirs = np.concatenate(list(spread.values()))
        each.plot(*theirs.T, **MARK, marker="o", color=ORANGE, label="InWave, ProteusDS, WaveDyn")
        each.set(title=f"{test}: {quantity}", xlabel="t [s]", xlim=(0, 1.1 * theirs[:, 0].max()))
    axes[0].set_ylabel("m or °")
    drawing.save(figure, "f3of", legend=axes[0])
