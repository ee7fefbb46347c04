"""How far a float may turn on its joint before what is known of it at rest says nothing of it any more."""

from collections.abc import Iterator

import numpy as np

from solver.errors import InputError
from solver.scene.floats import DOFS, Float

FALLEN_OVER = np.pi / 2  # diffraction and radiation at rest say nothing of a float that has turned so far [rad]
HANGING = np.pi / 6  # an arm at rest so near to the vertical swings beneath its hinge by nature [rad]


def turning_bounds(item: Float, name: str) -> tuple[float, float]:
    """Least and largest angle [rad] of an axis that turns."""
    low, high = -FALLEN_OVER, FALLEN_OVER
    down = straight_down(item) if name == "hinge" else 0.0
    # Past straight down buoyancy carries the float on, to rest as far on the hinge's other side:
    # half way there it will not come back.
    if down < -HANGING:
        low = max(low, 1.5 * down)
    elif down > HANGING:
        high = min(high, 1.5 * down)
    return low, high


def straight_down(item: Float) -> float:
    """Angle about the hinge's axis that brings the arm from rest to straight beneath the hinge [rad]."""
    axis = np.divide(item.axis, np.linalg.norm(item.axis))
    arm, plumb = (np.asarray(v, float) - np.dot(v, axis) * axis for v in (item.arm, (0.0, 0.0, -1.0)))
    if not (np.linalg.norm(arm) > 0 and np.linalg.norm(plumb) > 0):
        return 0.0
    return float(np.arctan2(np.dot(axis, np.cross(arm, plumb)), np.dot(arm, plumb)))


def turned_over(item: Float) -> Iterator[InputError]:
    """Offsets from which a run would end where it begins."""
    for name, offset in zip(item.motion, item.per_axis("offset"), strict=True):
        if name not in DOFS[:3] and offset:
            low, high = turning_bounds(item, name)
            if not low < offset < high:
                limit = f"must be within {low:+.3g} to {high:+.3g} rad of {name}, or the float is let go turned over"
                yield InputError(f"floats.{item.name}.offset", f"{offset:g} rad", limit)
