"""How floats are arranged: on each other, in the water, and whether they are their own image in y = 0."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.standing import ON_SEABED, stands
from solver.scene.floats import Float
from solver.scene.water import STILL_WATER, Water
from solver.sea.current import Current

DIGITS = 9  # of lines' places over the farthest: angles of 120 degrees are mirrored but for rounding


def unlisted(floats: Sequence[Float]) -> Iterator[InputError]:
    """Of floats that are on one that is not listed before them."""
    names = [f.name for f in floats]
    for i, f in enumerate(floats):
        if f.on and f.on not in names[:i]:
            yield InputError(f"floats.{f.name}.on", f.on, "must name a float that is listed before")


def on_others(carriers: Iterable[tuple[str, str]]) -> Iterator[InputError]:
    """Of names of floats, and of what they are on, in a scene with a platform."""
    for name, on in carriers:
        if on:
            yield InputError(f"floats.{name}.on", on, "must be empty: the platform carries every float")


def is_planar(floats: Iterable[Float], heading: float, current: Current | None = None) -> bool:
    """Whether floats, waves of that heading [rad] and current are mirror images of themselves in y = 0."""
    if current is not None and current.direction % np.pi != 0:
        return False
    return heading % np.pi == 0 and all(
        f.hinge[1] == f.arm[1] == f.cog[1] == f.products_of_inertia[0] == f.products_of_inertia[2] == 0
        and f.hull.symmetry[1]
        and not set(f.motion) & {"sway", "roll", "yaw"}
        and ("hinge" not in f.motion or f.axis[0] == f.axis[2] == 0)
        for f in floats
    )


def lines_mirrored(floats: Iterable[Float]) -> bool:
    """Whether each float's catenary lines are their own image in y = 0: others pull a platform out of the plane."""
    flip = np.array([1, -1, 1, 1, -1, 1, 1, 1, 1])
    for lines in (f.lines for f in floats if f.lines):
        rows = np.array([(*line.anchor, *line.fairlead, line.length, line.weight, line.EA) for line in lines])
        rows[:, :6] /= np.abs(rows[:, :6]).max()
        rows = np.round(rows, DIGITS)
        if sorted(map(tuple, rows.tolist())) != sorted(map(tuple, (flip * rows).tolist())):
            return False
    return True


def out_of_place(item: Float, water: Water) -> Iterator[InputError]:
    """A float that at rest reaches the seabed and does not stand on it, or whose reference point is not at z = 0."""
    key, z = f"floats.{item.name}.arm", item.centre[2]
    if not (z - item.hull.draft > -water.depth or (stands(item.hull, water.depth) and not item.motion)):
        if item.hull.draft < water.depth:
            lowest = f"lowest point at z = {z - item.hull.draft:g} m, depth {water.depth:g} m"
            limit = f"must stay above the seabed, or with motion = [] stand on it with a flat foot: {lowest}"
            yield InputError(key, item.arm, limit)
        else:  # wherever its arm brings it
            limit = f"must stay above the seabed, {water.depth:g} m, or with motion = [] stand on it with a flat foot"
            if item.hull.draft > (1 + ON_SEABED) * water.depth:
                limit += item.in_millimetres
            elif isinstance(item.hull, PanelHull):
                limit += ", which its mesh must have"
            yield InputError(f"floats.{item.name}.hull", f"a draft of {item.hull.draft:g} m", limit)
    elif abs(z) > STILL_WATER:
        limit = f"must bring the reference point to still water, z = 0; hinge + arm gives z = {z:g} m"
        yield InputError(key, item.arm, limit)
