"""Rings round a well, by the outline of their section: the float of a two-body point absorber, a moonpool's hull."""

from functools import lru_cache

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import cross, polygon_radius

SIDES = 32  # of the polygon that stands for each circle


@lru_cache(maxsize=64)
def ring(points: tuple[tuple[float, float], ...]) -> PanelHull:
    """The section with corners (r, z) [m], r > 0, in order either way round, turned about the z axis.

    Corners are pushed outwards by √((2π/n)/sin(2π/n)), so that polygons of n sides are as large as their circles:
    volume and waterplane are exact.
    """
    section = np.array(points, float)
    if not np.all(section[:, 0] > 0):
        near = tuple(section[section[:, 0].argmin()].tolist())
        raise InputError("hull.points", near, "must be off the axis, r > 0 m; a hull without a well is a profile")
    after = np.roll(section, -1, axis=0)
    if np.any(np.all(section == after, axis=1)):
        raise InputError("hull.points", points, "must each be unlike the one before; the outline closes by itself")
    outline = list(zip(map(tuple, section.tolist()), map(tuple, after.tolist()), strict=True))
    for n, side in enumerate(outline):
        if any(cross(side, other) for other in outline[n + 2 : len(outline) - (n == 0)]):
            raise InputError("hull.points", side, "must not cross or touch another side of the outline")
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    section[:, 0] *= polygon_radius(SIDES)
    r, z = section[:, :1], np.broadcast_to(section[:, 1:], (len(section), SIDES))
    vertices = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1).reshape(-1, 3)
    here = np.arange(len(vertices)).reshape(len(section), SIDES)
    above, beside = np.roll(here, -1, axis=0), np.roll(here, -1, axis=1)
    faces = np.stack([here, beside, np.roll(above, -1, axis=1), above], axis=-1).reshape(-1, 4)
    return PanelHull.of(vertices, faces, name="ring")
