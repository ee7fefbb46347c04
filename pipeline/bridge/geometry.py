"""What the boundary element method must solve for a task: one solution for each geometry."""

from __future__ import annotations

import math
from typing import Any

from pipeline.bridge.scenes import hull
from pipeline.study import seas
from pipeline.study.schema import Float, Hull, PanelMesh, Solver, Water
from pipeline.study.tables import Count, Number, Positive, Table, Vector
from pipeline.tasks.task import Parameters, canonical, digest
from solver.scene import panels_for

BEM_VERSION = 3  # of coefficients, and of the form of their file: raise it when either changes


class Body(Table):
    """A hull and where its reference point is at rest."""

    hull: Hull
    centre: Vector


class Geometry(Table):
    """All that decides the coefficients of the floats: one BEM solution for each."""

    water: Water
    bodies: tuple[Body, ...]
    band: tuple[Positive, Positive] | None = None
    heading: Number = 0.0
    planar: bool = True  # nothing leaves the plane y = 0
    panels: Count = panels_for(Solver().tolerance)

    @property
    def key(self) -> str:
        """Name of the file that keeps the coefficients."""
        return digest(canonical(self.model_dump(mode="json", exclude_defaults=True)), BEM_VERSION)


def geometry_of(given: Parameters) -> Geometry | None:
    """What the boundary element method must solve for a task; None without floats."""
    if not given.floats:
        return None
    return Geometry(
        water=given.water,
        bodies=tuple(Body(hull=f.hull, centre=_centre(f)) for f in given.floats),
        band=seas.band(given.sea_state, given.waves),
        heading=given.waves.heading,
        planar=_is_planar(given),
        panels=panels_for(given.solver.tolerance),
    )


def _centre(item: Float) -> tuple[float, float, float]:
    x, y, z = (h + a for h, a in zip(item.hinge, item.arm, strict=True))
    return x, y, z


def _is_planar(given: Parameters) -> bool:
    """Whether sea and floats are mirror images of themselves in y = 0."""
    return given.waves.heading % math.pi == 0 and all(
        f.hinge[1] == f.arm[1] == f.cog[1] == 0
        and not {"sway", "roll", "yaw"} & set(f.motion)
        and ("hinge" not in f.motion or f.axis[0] == f.axis[2] == 0)
        and _is_symmetric(f.hull)
        for f in given.floats
    )


def _is_symmetric(shape: Hull) -> bool:
    """Whether a hull is its own mirror image in y = 0."""
    if not isinstance(shape, PanelMesh):
        return True
    return hull(shape).symmetry[1]


def bem_arguments(geometry: Geometry) -> dict[str, Any]:
    """Arguments of solver.hydrodynamics.bem.bem.solve."""
    import numpy as np

    from solver.hydrodynamics.bem.bem import frequency_grid

    water = geometry.water
    hulls = tuple(hull(body.hull) for body in geometry.bodies)
    centres = np.array([body.centre for body in geometry.bodies])
    omega = frequency_grid(hulls, centres, depth=water.depth, gravity=water.gravity, band=geometry.band)
    return {
        "hulls": hulls,
        "centres": centres,
        "depth": water.depth,
        "density": water.density,
        "gravity": water.gravity,
        "heading": geometry.heading,
        "omega": omega,
        "planar": geometry.planar,
        "panels": geometry.panels,
    }
