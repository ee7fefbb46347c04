"""Asymmetric rotors, Salter's ducks: a stern that is round about the axis of rotation, and a beak of two flat sides.

The profile is the outline of a circle and the beak's tip: an arc and the two tangents from the tip.
"""

from functools import lru_cache

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.quantities import require_positive

SIDES = 32  # of a polygon round the whole circle


@lru_cache(maxsize=64)
def duck(
    *, radius: float, beak: float, elevation: float, submergence: float, width: float, sides: int = SIDES
) -> PanelHull:
    """The duck whose axis lies along y, `submergence` below still water and below the reference point [m].

    radius: of the stern; beak: from the axis to the tip [m]; elevation: of the tip as seen from the axis, above
    horizontal and from -x towards +x [rad], so that π - elevation is the mirror image; width: along the axis [m].
    """
    for name, length in (("radius", radius), ("beak", beak), ("width", width)):
        require_positive(f"hull.{name}", length, "m")
    _require_possible(radius, beak, elevation, submergence)
    outline = profile(radius=radius, beak=beak, elevation=elevation, submergence=submergence, sides=sides)
    n = len(outline)
    ring = np.concatenate([np.insert(outline, 1, y, axis=1) for y in (-width / 2, width / 2)])
    ahead = np.roll(np.arange(n), -1)
    shell = np.column_stack([np.arange(n), ahead, n + ahead, n + np.arange(n)])
    # Seen along the axis: strips across the beak's direction; at the tip and at the stern's end triangles.
    left, right = np.arange(1, n // 2 + 1), np.arange(n - 1, n // 2 - 1, -1)
    strips = np.column_stack([left[:-1], left[1:], right[1:], right[:-1]])
    end = np.concatenate([[[0, left[0], right[0], right[0]]], strips])
    return PanelHull.of(ring, np.concatenate([shell, end[:, ::-1], n + end]), name="duck")


def profile(*, radius: float, beak: float, elevation: float, submergence: float, sides: int = SIDES) -> np.ndarray:
    """Corners (n, 2) of x and z [m] of the polygon as large as the outline, the tip first and up over the top.

    With the angle half = arccos(radius/beak) between tip and tangents, m sides of θ round the stern whose corners are
    at a distance r from the axis enclose m r² sin θ/2 + r beak sin half; the outline encloses
    (π - half) radius² + radius beak sin half.
    """
    half = np.arccos(radius / beak)
    arc = 2 * (np.pi - half)
    m = 2 * int(np.ceil(arc / (2 * np.pi) * sides / 2))  # even: the stern's end is a corner
    a, b = m / 2 * np.sin(arc / m), beak * np.sin(half)
    distance = (np.sqrt(b**2 + 4 * a * radius * (arc / 2 * radius + b)) - b) / (2 * a)
    angle = np.pi - elevation - np.append(0.0, half + arc * np.arange(m + 1) / m)
    from_axis = np.append(beak, np.full(m + 1, distance))
    return np.column_stack([from_axis * np.cos(angle), from_axis * np.sin(angle) - submergence])


def _require_possible(radius: float, beak: float, elevation: float, submergence: float) -> None:
    if not beak > radius:
        raise InputError("hull.beak", beak, f"must be > radius, {radius:g} m: the tip must lie outside the stern")
    if not abs(elevation) <= 2 * np.pi:
        raise InputError("hull.elevation", elevation, "must be between -6.28319 and 6.28319 rad")
    rise = beak * np.sin(elevation)
    low, high = min(-radius, rise), max(radius, rise)
    if not low < submergence < high:
        limit = f"must be between {low:g} and {high:g} m, or the hull does not pierce still water"
        raise InputError("hull.submergence", submergence, limit)
    half = np.arccos(radius / beak)
    foot = radius * min(np.sin(elevation + half), np.sin(elevation - half))  # of the lower tangent
    if not min(foot, rise) < submergence:
        reach = f"it reaches from z = {min(foot, rise) - submergence:.4g} to {rise - submergence:.4g} m"
        limit = f"must leave some of the beak in the water at rest: {reach}; no wave turns a round stern about its axis"
        raise InputError("hull.elevation", elevation, limit)
