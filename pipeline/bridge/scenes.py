"""Parameters of a task -> the solver's frozen inputs. The only translation between the two."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, assert_never

from pipeline.bridge import realizations
from pipeline.study.attachments import Attachment
from pipeline.study.layout import HINGE
from pipeline.study.schema import (
    Float,
    HemisphereCylinder,
    PanelMesh,
    Platform,
    Section,
    Sphere,
    Tube,
    VerticalCylinder,
)
from pipeline.tasks.task import Parameters, wave_seed
from solver.errors import InputError

if TYPE_CHECKING:
    from solver import scene as physics
    from solver.hydrodynamics.hull.panel_hull import PanelHull
    from solver.hydrodynamics.hull.revolution import Revolution
    from solver.sea.realization import Realization
    from solver.structure import beam
    from solver.structure.frame import Member


def scene(parameters: Parameters) -> physics.Scene:
    """Everything that one simulation needs."""
    from solver import scene as physics

    return physics.Scene(
        water=physics.Water(**dict(parameters.water)),
        sea=sea(parameters),
        floats=tuple(_float(f) for f in parameters.floats),
        platform=_platform(parameters) if parameters.platform else None,
        settings=settings(parameters),
    )


def settings(parameters: Parameters) -> physics.Settings:
    """Record and numerics; how the series is thinned is the pipeline's own business."""
    from solver import scene as physics

    given = {**dict(parameters.record), **dict(parameters.solver)}
    return physics.Settings(keep_series=given.pop("series") != "none", **given)


def sea(parameters: Parameters) -> Realization:
    """The realization of the sea that belongs to the task's sea state and seed."""
    return realizations.realize(parameters.sea_state, parameters.waves, wave_seed(parameters))


def hull(shape: HemisphereCylinder | Sphere | VerticalCylinder | PanelMesh) -> Revolution | PanelHull:
    """The solver's hull for a hull table."""
    from solver.hydrodynamics.hull.revolution import Revolution

    match shape:
        case HemisphereCylinder():
            return Revolution.hemisphere_cylinder(radius=shape.radius, height=shape.height)
        case Sphere():
            return Revolution.sphere(radius=shape.radius, draft=shape.draft)
        case VerticalCylinder():
            return Revolution.vertical_cylinder(radius=shape.radius, draft=shape.draft, freeboard=shape.freeboard)
        case PanelMesh():
            return _panel_hull(shape.file)
        case _:
            assert_never(shape)


@lru_cache(maxsize=16)
def _panel_hull(file: Attachment) -> PanelHull:
    """The hull in a mesh file; what was mended is in its notes, which the solver tells with all else that is odd."""
    from solver.hydrodynamics.hull import meshfile
    from solver.hydrodynamics.hull.panel_hull import PanelHull

    return PanelHull.of(*meshfile.read(file.name, file.data), name=file.name)


def outline(shape: HemisphereCylinder | Sphere | VerticalCylinder | PanelMesh) -> list[tuple[float, float]]:
    """A hull at rest seen along y, x and z from its reference point [m]."""
    import numpy as np

    from solver.hydrodynamics.hull.revolution import Revolution

    seen = hull(shape)
    if not isinstance(seen, Revolution):
        return [(float(r), float(h)) for r, h in seen.silhouette]
    points = np.concatenate([s.at(np.linspace(0, 1, 33)) for s in seen.meridian])
    right = [(float(r), float(h)) for r, h in points]
    return right + [(-r, h) for r, h in reversed(right)]


def _float(item: Float) -> physics.Float:
    from solver import scene as physics

    try:
        return physics.Float(**{**dict(item), "hull": hull(item.hull)})
    except InputError as error:
        # A mesh does not know whose hull it is.
        named = error.key.startswith("hull.")
        raise InputError(f"floats.{item.name}.{error.key}" if named else error.key, error.value, error.limit) from None


def _platform(parameters: Parameters) -> physics.Platform:
    from solver import scene as physics
    from solver.structure.frame import Frame, PointLoad, PointMass

    table = parameters.platform
    assert table is not None
    return physics.Platform(
        frame=Frame(
            nodes=table.nodes,
            members=_members(table),
            clamped=table.clamped,
            masses=tuple(PointMass(**dict(m)) for m in table.masses),
            loads=tuple(PointLoad(**dict(p)) for p in table.loads),
        ),
        legs=table.legs,
        damping_ratio=table.damping_ratio,
        hinge_nodes={f.name: HINGE + f.name for f in parameters.floats},
        geometric_stiffness=table.geometric_stiffness,
        wave_inertia=table.wave_inertia,
    )


def _members(table: Platform) -> tuple[Member, ...]:
    from solver.structure.frame import Material, Member

    sections = {name: _section(section) for name, section in table.sections.items()}
    materials = {name: Material(**dict(material)) for name, material in table.materials.items()}
    return tuple(
        Member(**{**dict(m), "section": sections[m.section], "material": materials[m.material]}) for m in table.members
    )


def _section(section: Section) -> beam.Section:
    from solver.structure import beam

    if isinstance(section, Tube):
        return beam.tube(section.diameter, section.thickness)
    return beam.solid_rectangle(section.width, section.height)
