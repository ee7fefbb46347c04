"""The table [platform] -> the solver's frame."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from pipeline.bridge.objections import under
from pipeline.study import columns
from pipeline.study.layout import HINGE
from pipeline.study.platform import LoadHistory, Member, Platform, Section, Tube
from pipeline.study.tables import Same
from pipeline.tasks.task import Parameters
from solver.errors import InputError

if TYPE_CHECKING:
    from solver import scene as physics
    from solver.structure import members, sections
    from solver.structure.load_history import LoadHistory as History

FORCES = ("Fx", "Fy", "Fz")


@lru_cache(maxsize=64)
def load_history(table: LoadHistory) -> History:
    """The solver's load for a table of [[platform.load_histories]]."""
    import numpy as np

    from solver.structure.load_history import LoadHistory as History

    with under(f"platform.load_histories.{table.node}.", f"load_histories.{table.node}."):
        there = [name for name in columns.among(table.file, ("time", *FORCES)) if name in FORCES]
        if not there:
            raise InputError("file", table.file, f"needs a column of {', '.join(FORCES)} in its header")
        read = columns.read(table.file, ("time", *dict.fromkeys(there)))
        time = read["time"]
        columns.require_rising(table.file, "time", time)
        force = np.stack([read.get(name, np.zeros(time.size)) for name in FORCES], axis=-1)
        return History(node=table.node, time=time, force=force)


def platform(parameters: Parameters) -> physics.Platform | None:
    """The solver's platform for the table [platform], whose nodes include the hinges of the floats."""
    if (table := parameters.platform) is None:
        return None
    from solver import scene as physics

    sea = physics.Water(**dict(parameters.water))
    return _platform(Same(table), tuple(f.name for f in parameters.floats), sea)


@lru_cache(maxsize=16)
def _platform(same: Same[Platform], floats: tuple[str, ...], sea: physics.Water) -> physics.Platform:
    from solver import scene as physics
    from solver.structure.fineness import divided
    from solver.structure.frame import Frame
    from solver.structure.members import MarineGrowth, PointLoad, PointMass
    from solver.structure.soil import Soil, SoilSpring

    table = same.table
    members = tuple(member(m, table) for m in table.members)
    undivided = {m.name for m in table.members if m.elements is None}
    with under("platform."):
        springs = tuple(SoilSpring(**dict(line)) for line in table.soil)
        frame = Frame(
            nodes=table.nodes,
            members=members,
            clamped=table.clamped,
            masses=tuple(PointMass(**dict(m)) for m in table.masses),
            loads=tuple(PointLoad(**dict(p)) for p in table.loads),
            growth=tuple(MarineGrowth(**dict(line)) for line in table.marine_growth),
            foundation=table.foundation,
            soil=Soil(seabed=-sea.depth, springs=springs) if springs else None,
        )
        frame = divided(frame, undivided, density=sea.density, gravity=sea.gravity)
    return physics.Platform(
        frame=frame,
        legs=table.legs,
        damping_ratio=table.damping_ratio,
        damping_of=table.damping_of,
        rayleigh_mass=table.rayleigh_mass,
        rayleigh_stiffness=table.rayleigh_stiffness,
        hinge_nodes={name: HINGE + name for name in floats},
        load_histories=tuple(map(load_history, table.load_histories)),
        geometric_stiffness=table.geometric_stiffness,
        wave_inertia=table.wave_inertia,
        wave_stretching=table.wave_stretching,
    )


def member(item: Member, table: Platform) -> members.Member:
    """The solver's member for a table of [[platform.members]], in one piece where it does not say."""
    from solver.structure import members

    key = f"platform.members.{item.name}"
    material = members.Material(**dict(table.materials[_known(f"{key}.material", item.material, table.materials)]))
    parts: dict[str, Any] = {"material": material, "elements": item.elements or 1}
    for name, given in (("section", item.section), ("end_section", item.end_section)):
        if given is not None:
            shape = table.sections[_known(f"{key}.{name}", given, table.sections)]
            parts[name] = replace(section(given, table), shear_factor=_shear_factor(shape, material))
    with under("platform."):
        return members.Member(**{**dict(item), **parts})


def _known(key: str, name: str, table: Collection[str]) -> str:
    if name not in table:
        raise InputError(key, name, f"must be one of {', '.join(table)}")
    return name


def _shear_factor(shape: Section, material: members.Material) -> float | None:
    """Timoshenko's κ of a section's table; Cowper's goes by the material's Poisson's ratio."""
    from solver.structure import sections

    if shape.shear_factor != "cowper":
        return shape.shear_factor
    if isinstance(shape, Tube):
        return sections.tube_shear_factor(shape.diameter, shape.thickness, material.poisson)
    return sections.rectangle_shear_factor(material.poisson)


def section(name: str, table: Platform) -> sections.Section:
    """The solver's cross section for a table of [platform.sections], which shears by its member's material."""
    from solver.structure import sections

    numbers = {key: value for key, value in table.sections[name] if key not in ("shape", "shear_factor")}
    with under(f"platform.sections.{name}.", "section."):
        return sections.MAKERS[table.sections[name].shape](**numbers)
