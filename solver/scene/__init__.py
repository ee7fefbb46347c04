"""A scene: everything that one simulation needs, as frozen, validated inputs.

Frame: x along the waves for heading 0, z upwards from still water, rotations right-handed.
"""

from solver.hydrodynamics.hull.mesh import PANELS
from solver.scene.arrangement import is_planar, on_others, out_of_place, unlisted
from solver.scene.floats import (
    DOFS,
    LEVEL,
    PER_AXIS,
    STARTS,
    EndStops,
    Float,
    load_unit_along,
    unit_along,
)
from solver.scene.platform import Platform, StructuralDamping
from solver.scene.scene import MOST_STEPS, STEPS, Scene, require_waves, stays_in_plane, two_digits
from solver.scene.settings import (
    MOST_PANELS,
    OF_FLOATS,
    OF_STEEL,
    OUTPUTS,
    Fatigue,
    Output,
    Settings,
    Utilisation,
    needs_coefficients,
    panels_for,
)
from solver.scene.turning import FALLEN_OVER, falls_at, poses, straight_down, turning_bounds, uprights
from solver.scene.water import Water

__all__ = [
    "DOFS",
    "FALLEN_OVER",
    "LEVEL",
    "MOST_PANELS",
    "MOST_STEPS",
    "OF_FLOATS",
    "OF_STEEL",
    "OUTPUTS",
    "PANELS",
    "PER_AXIS",
    "STARTS",
    "STEPS",
    "EndStops",
    "Fatigue",
    "Float",
    "Output",
    "Platform",
    "Scene",
    "Settings",
    "StructuralDamping",
    "Utilisation",
    "Water",
    "falls_at",
    "is_planar",
    "load_unit_along",
    "needs_coefficients",
    "on_others",
    "out_of_place",
    "panels_for",
    "poses",
    "require_waves",
    "stays_in_plane",
    "straight_down",
    "turning_bounds",
    "two_digits",
    "unit_along",
    "unlisted",
    "uprights",
]
