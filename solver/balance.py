"""Warnings about a scene: floats out of equilibrium, mended hulls, records cut short."""

from collections.abc import Iterator

import numpy as np

from solver.hydrodynamics.hull.clearance import openings
from solver.scene import DOFS, Float, Scene, Water

ALLOWED = 0.01  # share of the weight or its moment that may be out of balance


def warnings(scene: Scene) -> tuple[str, ...]:
    """Sentences for the user, the key first."""
    sentences = [text for f in scene.floats for text in imbalance(f, scene.water, scene.floats)]
    sentences += [f"floats.{f.name}.hull: {note}" for f in scene.floats for note in getattr(f.hull, "notes", ())]
    for group in scene.sharing:
        if len(edges := openings([f.hull for f in group], [f.centre for f in group])):
            sentences.append(f"floats: meshes leave {len(edges)} edges open below still water, a slip that is let pass")
    return (*sentences, *(f"sea: {note}" for note in scene.sea.notes))


def imbalance(item: Float, water: Water, floats: tuple[Float, ...] = ()) -> list[str]:
    """Axes of the joint along which weight and buoyancy at rest, with those of what it carries, differ by over ALLOWED.

    A float so held moves to its equilibrium before the run; that is rarely what was meant.
    """
    displaced = water.density * item.hull.volume
    told = f"mass {item.mass:g} kg, displaced {displaced:g} kg ({item.mass / displaced - 1:+.2%})"
    sentences = []
    for name, pull in zip(item.motion, item.moored.pretension, strict=True):
        weight, buoyancy = (_work(item, name, *load) for load in _loads(item, displaced, water.gravity))
        carried = [f for f in floats if f.on == item.name]
        weight += sum(_work(item, name, np.array(f.hinge), _lift(f, water, floats)) for f in carried)
        excess = abs(weight + buoyancy + pull)
        if excess > ALLOWED * max(abs(weight), abs(buoyancy), _least(item, name, displaced * water.gravity)):
            moments = f"; {name}: moment of weight {weight:.4g} N m, of buoyancy {buoyancy:.4g} N m"
            sentences.append(
                f"floats.{item.name} is out of equilibrium: {told}{'' if name == 'heave' else moments}."
                " It settles before the run begins"
            )
    return sentences


def _loads(item: Float, displaced: float, gravity: float) -> Iterator[tuple[np.ndarray, float]]:
    """Point and vertical force of weight and of buoyancy, at rest."""
    yield item.centre + item.cog, -item.mass * gravity
    yield item.centre + item.hull.buoyancy_point, displaced * gravity


def _lift(item: Float, water: Water, floats: tuple[Float, ...]) -> float:
    """Buoyancy less weight of a float and of all that it carries [N]."""
    excess = (water.density * item.hull.volume - item.mass) * water.gravity
    return excess + sum(_lift(f, water, floats) for f in floats if f.on == item.name)


def _work(item: Float, name: str, point: np.ndarray, force: float) -> float:
    """Work of a vertical force at a point for a unit of the axis [N or N m]."""
    if name in DOFS[:3]:
        return force if name == "heave" else 0.0
    return float(force * np.cross(item.direction(name), point - item.hinge)[2])


def _least(item: Float, name: str, buoyancy: float) -> float:
    """Moments are small where both forces pass by the axis: then the hull's size is the lever."""
    return 0.0 if name in DOFS[:3] else buoyancy * item.hull.scale
