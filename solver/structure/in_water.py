"""A frame at rest in still water: what moves along with it, where it stands, and whether it mirrors itself."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from solver.errors import InputError
from solver.structure import modes, statics, water
from solver.structure.frame import Frame
from solver.structure.frame_model import FrameModel, assemble

KNOWN = 8  # frames that a process keeps
BENT = 0.03  # share of its size by which a frame at rest may be off the drawing, of which stiffness and loads are


@lru_cache(maxsize=KNOWN)
def dynamic_model(
    frame: Frame, density: float, gravity: float, *, softened: bool
) -> tuple[FrameModel, np.ndarray, float]:
    """Frame with what moves along, softened by gravity if asked; its static displacement, and the buckling factor."""
    model = assemble(frame)
    model = replace(model, M=model.M + water.inner_mass(model, density) + water.growth_mass(model))
    load = water.static_load(model, density, gravity)
    at_rest = statics.static(model, load)
    N = statics.axial_force(model, at_rest, water.spread_load(model, density, gravity))
    finer = _divided(frame)
    factor = (
        statics.buckling_factor(model, N, gravity)
        if finer is frame
        else dynamic_model(finer, density, gravity, softened=False)[2]
    )
    if softened:
        if factor <= 1:
            raise InputError("platform.geometric_stiffness", True, f"gravity is {1 / factor:.2f} times the Euler load")
        model = statics.with_geometric_stiffness(model, N, gravity)
        at_rest = statics.static(model, load)
    return model, at_rest, factor


def _divided(frame: Frame) -> Frame:
    """A frame whose members of one element have two: between its pins one has no shape to buckle in."""
    if all(m.elements != 1 for m in frame.members):
        return frame
    return replace(frame, members=tuple(replace(m, elements=2) if m.elements == 1 else m for m in frame.members))


@lru_cache(maxsize=KNOWN)
def symmetric(frame: Frame, density: float, gravity: float, *, softened: bool) -> bool:
    """Whether a frame and what water does to it are mirror images of themselves in y = 0.

    So is, as long as nobody reduces it, one that cannot be: whoever does says why.
    """
    try:
        model = dynamic_model(frame, density, gravity, softened=softened)[0]
    except InputError:
        return True
    return modes.mirror(model, water.added_mass(model, density), water.drag_matrix(model)) is not None


def too_soft(model: FrameModel, at_rest: np.ndarray, factor: float) -> Iterator[str]:
    """Sentences for a frame that buckles, or is bent too far, by what it bears at rest; as `dynamic_model` tells."""
    if factor <= 1:
        yield (
            f"platform: its buckling_factor is {factor:.3g}, so {factor:.3g} times its weight and constant loads buckle"
            " it; it stands here because without geometric_stiffness they do not soften it"
        )
    moved = np.linalg.norm(at_rest.reshape(-1, 6)[:, :3], axis=1)
    worst, size = int(moved.argmax()), model.size
    if moved[worst] > BENT * size:
        x, y, z = model.xyz[worst]
        yield (
            f"platform: weight, buoyancy and constant loads move it by {moved[worst]:.3g} m at ({x:g}, {y:g}, {z:g}),"
            f" {moved[worst] / size:.2g} of its size, {size:.3g} m, where displacements are taken for small: most"
            " likely a slip of units in stiffness, mass or load"
        )


def _first(names: list[str]) -> str:
    """The first one, and how many more there are."""
    return names[0] + (f" and {len(names) - 1} more" if len(names) > 1 else "")


def unloaded(frame: Frame, *, waves: bool, current: bool) -> Iterator[str]:
    """Sentences for members below still water that neither waves nor a current load."""
    tubes = ((m, frame.ends(m)[:, 2]) for m in frame.members if m.section.diameter > 0)
    wet = [m for m, z in tubes if z.min() < 0 and z.max() > frame.seabed]
    spared = [m.name for m in wet if not m.in_water]
    if (waves or current) and spared:
        which = "all that is in water is" if len(spared) == len(wet) else "in water"
        what = " and ".join(name for name, given in (("waves", waves), ("the current", current)) if given)
        yield (
            f"platform.members.{_first(spared)}: {which} without drag_coefficient and inertia_coefficient, so that"
            f" {what} pass through it: are they left out?"
        )
    elif current and wet and not any(m.drag_coefficient > 0 for m in wet):
        yield "current: no member in water has a drag_coefficient, so that it loads nothing: is it left out?"


def left_dry(frame: Frame) -> Iterator[str]:
    """A sentence for members whose axis lies in still water's surface, which wets what is below it alone."""
    names = [m.name for m in frame.members if m.in_water and not frame.ends(m)[:, 2].any()]
    if names:
        yield (
            f"platform.members.{_first(names)}: its axis lies at z = 0, where it is wholly dry, without load of waves,"
            " added mass and buoyancy; below that it is wholly wet, and wave_stretching loads it as waves rise"
        )
