"""A hull's table -> the solver's hull, and how it looks."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, assert_never

from pipeline.study.attachments import Attachment
from pipeline.study.hulls import (
    BoxHull,
    Duck,
    HemisphereCylinder,
    Hull,
    PanelMesh,
    Profile,
    Ring,
    Sphere,
    VerticalCylinder,
)
from pipeline.study.tables import Vector

if TYPE_CHECKING:
    import numpy as np

    from solver.hydrodynamics.hull.panel_hull import PanelHull
    from solver.hydrodynamics.hull.revolution import Revolution

CENTRED = 1e-4  # of a hull's size: as near its reference point its centre of buoyancy counts as above each other
UPRIGHT = 1e-9  # of a unit axis: a hull that turns by less out of the plane is in it


@lru_cache(maxsize=64)
def hull(shape: Hull) -> Revolution | PanelHull:
    """The solver's hull for a hull table, about its own reference point: see `offset`."""
    from solver.hydrodynamics.hull.panel_hull import PanelHull

    made, away = _as_described(shape), offset(shape)
    return made.moved(-away) if isinstance(made, PanelHull) and away.any() else made


@lru_cache(maxsize=64)
def offset(shape: Hull) -> np.ndarray:
    """From the reference point of a hull table to the solver's (3,) [m], at still water above the centre of buoyancy.

    Diffraction, radiation and linear buoyancy are loads there, which keep their directions as a float turns: at the
    table's, answers of large motions would go with where a file of the same hull has its origin.
    """
    import numpy as np

    from solver.hydrodynamics.hull.panel_hull import PanelHull
    from solver.keys import shared

    made, at = _as_described(shape), np.zeros(3)
    if isinstance(made, PanelHull):
        at[:2] = made.buoyancy_point[:2]
        at[np.abs(at) < CENTRED * np.ptp(made.vertices, axis=0).max()] = 0.0
    return shared(at)


@lru_cache(maxsize=64)
def _as_described(shape: Hull) -> Revolution | PanelHull:
    """About the reference point of its table."""
    from solver.hydrodynamics.hull.box import box
    from solver.hydrodynamics.hull.duck import duck
    from solver.hydrodynamics.hull.revolution import Revolution
    from solver.hydrodynamics.hull.ring import ring

    match shape:
        case HemisphereCylinder():
            return Revolution.hemisphere_cylinder(radius=shape.radius, height=shape.height)
        case Sphere():
            return Revolution.sphere(radius=shape.radius, draft=shape.draft)
        case VerticalCylinder():
            return Revolution.vertical_cylinder(radius=shape.radius, draft=shape.draft, freeboard=shape.freeboard)
        case Profile():
            return Revolution.profile(shape.points)
        case Ring():
            return ring(shape.points)
        case BoxHull():
            return box(**shape.model_dump(exclude={"shape"}))
        case Duck():
            return duck(**shape.model_dump(exclude={"shape"}))
        case PanelMesh():
            return _panel_hull(shape.file, shape.origin, shape.rotation, shape.scale)
        case _:
            assert_never(shape)


@lru_cache(maxsize=16)
def _panel_hull(file: Attachment, origin: Vector, rotation: Vector, scale: float) -> PanelHull:
    """The hull in a mesh file; what was mended is in its notes, which the solver tells with all else that is odd."""
    from solver.hydrodynamics.hull import meshfile, surface
    from solver.hydrodynamics.hull.panel_hull import PanelHull

    vertices, faces = meshfile.read(file.name, file.data)
    if any((*origin, *rotation)) or scale != 1:
        vertices = surface.placed(vertices, origin, rotation, scale)
    return PanelHull.of(vertices, faces, name=file.name)


def outline(shape: Hull) -> list[tuple[float, float]]:
    """A hull at rest seen along y, x and z from its reference point [m]."""
    import numpy as np

    from solver.hydrodynamics.hull.revolution import Revolution

    seen = hull(shape)
    if not isinstance(seen, Revolution):
        return [(float(r), float(h)) for r, h in seen.silhouette]
    points = np.concatenate([s.at(np.linspace(0, 1, 33)) for s in seen.meridian])
    right = [(float(r), float(h)) for r, h in points]
    return right + [(-r, h) for r, h in reversed(right)]


def silhouette(shape: Hull, R: np.ndarray) -> np.ndarray:
    """A hull turned by a rotation (3, 3), seen along y from its reference point (k, 2) [m].

    Of one of revolution that leaves the plane, and of meshes, the convex outline.
    """
    import numpy as np
    import scipy

    from solver.hydrodynamics.hull.revolution import Revolution

    if np.abs(R[1] - [0.0, 1.0, 0.0]).max() < UPRIGHT:
        return np.asarray(outline(shape) @ R[::2, ::2].T)
    seen = hull(shape)
    if isinstance(seen, Revolution):
        r, z = np.concatenate([s.at(np.linspace(0, 1, 9)) for s in seen.meridian]).T[..., None]
        angle = np.linspace(0, 2 * np.pi, 33)
        points = np.stack([r * np.cos(angle), r * np.sin(angle), z + 0 * angle], axis=-1).reshape(-1, 3)
    else:
        points = seen.vertices
    flat = points @ R[::2].T
    return np.asarray(flat[scipy.spatial.ConvexHull(flat).vertices])


def plan(shape: Hull) -> tuple[np.ndarray, np.ndarray]:
    """A hull at rest seen from above: panels below still water (n, k, 2), segments (ns, 2, 2) where it meets that.

    From its reference point [m].
    """
    import numpy as np

    from solver.hydrodynamics.hull.revolution import Revolution

    seen = hull(shape)
    if not isinstance(seen, Revolution):
        return seen.wetted[:, :, :2], seen.waterline
    angle = np.linspace(0, 2 * np.pi, 65)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    water = np.sqrt(max(seen.waterplane[0], 0.0) / np.pi) * circle
    return seen.largest_radius * circle[None], np.stack([water[:-1], water[1:]], axis=1)
