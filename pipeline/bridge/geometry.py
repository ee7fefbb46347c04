"""What the boundary element method must solve for a task: one solution for each geometry."""

from __future__ import annotations

from typing import Any

from pipeline.bridge.scenes import floating, hull
from pipeline.study import seas
from pipeline.study.schema import Hull, Solver, Water
from pipeline.study.tables import Count, Number, Positive, Table, Vector
from pipeline.tasks.task import Parameters, canonical, digest
from solver.scene import is_planar, panels_for

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


def geometry_of(parameters: Parameters) -> Geometry | None:
    """What the boundary element method must solve for a task; None without floats."""
    if not parameters.floats:
        return None
    floats = [floating(table) for table in parameters.floats]
    centres = [tuple(map(float, item.centre)) for item in floats]
    return Geometry(
        water=parameters.water,
        bodies=tuple(Body(hull=f.hull, centre=at) for f, at in zip(parameters.floats, centres, strict=True)),
        band=seas.band(parameters.sea_state, parameters.waves),
        heading=parameters.waves.heading,
        planar=is_planar(floats, parameters.waves.heading),
        panels=panels_for(parameters.solver.tolerance),
    )


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
