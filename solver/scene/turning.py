"""How far a float may turn on its joint before what is known of it at rest says nothing of it any more."""

from collections.abc import Iterator, Sequence

import numpy as np

from solver.errors import InputError
from solver.scene.floats import DOFS, Float

FALLEN_OVER = np.pi / 2  # about a level axis: what is known of a float at rest says nothing of one on its side [rad]
HANGING = np.pi / 6  # an arm at rest so near to the vertical swings beneath its hinge by nature [rad]


def turning_bounds(item: Float, name: str) -> tuple[float, float]:
    """Least and largest angle [rad] of an axis that turns."""
    high = falls_at(item.direction(name))
    low, down = -high, straight_down(item) if name == "hinge" and np.isfinite(high) else 0.0
    # Past straight down buoyancy carries the float on, to rest as far on the hinge's other side:
    # half way there it will not come back.
    if down < -HANGING:
        low = max(low, 1.5 * down)
    elif down > HANGING:
        high = min(high, 1.5 * down)
    return low, high


def falls_at(axis: np.ndarray) -> float:
    """Angle [rad] about an axis n (3,) of length one, alone, at which a float's own vertical z lies level.

    By Rodrigues' formula z·Rz = n_z² + (1 - n_z²) cos θ; about an axis nearer to the vertical than 45° it never does.
    """
    square = axis[2] ** 2
    return float(np.arccos(-square / (1 - square))) if square < 0.5 else np.inf


def poses(floats: Sequence[Float], carriers: Sequence[int], joints: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rotation (3, 3) and place of the reference point (3,) [m] of each float, joints (nj,) from rest [m or rad].

    What an elastic platform moves by is left out.
    """
    found: list[tuple[np.ndarray, np.ndarray]] = []
    first = 0
    for item, carrier in zip(floats, carriers, strict=True):
        R, place = found[carrier] if carrier >= 0 else (np.eye(3), np.zeros(3))
        place = place + R @ (item.hinge - (floats[carrier].centre if carrier >= 0 else np.zeros(3)))
        for axis, turns, way in zip(item.directions, item.turns, joints[first:], strict=False):
            if turns:
                across = np.cross(np.eye(3), axis)
                R = R @ (np.eye(3) + np.sin(way) * across + (1 - np.cos(way)) * across @ across)
            else:
                place = place + R @ axis * way
        first += len(item.motion)
        found.append((R, place + R @ item.arm))
    return found


def uprights(floats: Sequence[Float], carriers: Sequence[int], joints: np.ndarray) -> np.ndarray:
    """z·Rz (nb,) of each float's own vertical z, all joints (nj,) [m or rad] from rest: below 0 it is turned over."""
    return np.array([R[2, 2] for R, _ in poses(floats, carriers, joints)])


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
