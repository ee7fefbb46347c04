"""Hydrodynamic coefficients of a scene: the boundary element method with the arguments that the scene implies."""

from typing import Any

import numpy as np

from solver.hydrodynamics.bem import bem
from solver.scene import Scene, needs_coefficients, panels_for


def needed(scene: Scene) -> bool:
    """Whether anything in a scene depends on coefficients."""
    return needs_coefficients(scene.settings, [f.hull for f in scene.floats], scene.water.depth)


def coefficients(scene: Scene, band: tuple[float, float] | None = None) -> bem.Hydrodynamics | None:
    """Coefficients of the floats at rest, good for other waves in `band` [rad/s] too; None without floats.

    The frequencies cover the scene's waves and what the radiation memory needs; a planar scene
    is solved for surge, heave and pitch alone.
    """
    if not scene.floats:
        return None
    hulls, water = tuple(f.hull for f in scene.floats), scene.water
    centres = np.array([f.centre for f in scene.floats])
    bands = [band] if band else []
    if scene.sea.amplitude.any():
        bands.append((scene.sea.omega.min(), scene.sea.omega.max()))
    whole = (float(np.min(bands)), float(np.max(bands))) if bands else None
    s, depth, gravity = scene.settings, water.depth, water.gravity
    panels = panels_for(s.tolerance, hulls)
    how: Any = {"depth": depth, "gravity": gravity, "panels": panels, "interaction": s.interaction}
    return bem.solve(
        hulls,
        centres,
        density=water.density,
        heading=scene.sea.heading,
        omega=bem.frequency_grid(hulls, centres, band=whole, **how),
        waves_to=whole[1] if whole else np.inf,
        flow=s.radiation or s.diffraction,
        planar=scene.planar,
        far_field="drift" in s.outputs,
        gap_damping=s.gap_damping,
        gap_width=s.gap_width,
        **how,
    )
