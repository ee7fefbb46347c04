"""The tables of a study file: names, types, units, ranges. Lengths in m, masses in kg, all SI."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from pipeline.study.attachments import CoefficientFile, File
from pipeline.study.axes import Axes, Axis, Samples, Variant, implied_sea, variant_axis
from pipeline.study.seas import SeaState, Waves
from pipeline.study.tables import (
    Count,
    Depth,
    Label,
    Name,
    NotNegative,
    Number,
    Positive,
    Table,
    Title,
    Unit,
    Vector,
    fields_of,
)
from solver import scene as physics
from solver.structure import frame


@fields_of(physics.Water)
class Water(Table):
    """Still water of constant depth."""

    depth: Depth  # inf for deep water
    if TYPE_CHECKING:
        density: float
        gravity: float


DEFAULT = physics.Settings()


# An id leaves out what is at its default: whoever changes a default raises tasks.task.MODEL_VERSION.
@fields_of(physics.Settings, ("duration", "discard", "ramp", "ramp_form", "rao"))
class Recording(Table):
    """What of the simulated time is analysed."""

    duration: Annotated[Number, Field(ge=1, le=1e6)] = DEFAULT.duration
    discard: Annotated[NotNegative, Field(le=1e5)] = DEFAULT.discard
    series: Literal["none", "decimated", "full"] = "none"  # of the record; decimated keeps four in the shortest wave
    if TYPE_CHECKING:
        ramp: float = DEFAULT.ramp
        rao: bool = DEFAULT.rao


@fields_of(physics.Settings, {f.name for f in fields(physics.Settings)} - {*Recording.model_fields, "keep_series"})
class Solver(Table):
    """Numerical choices, as the solver names and defaults them."""

    if TYPE_CHECKING:
        froude_krylov: str = DEFAULT.froude_krylov
        method: str = DEFAULT.method
        tolerance: float | None = DEFAULT.tolerance
        time_step: float | None = DEFAULT.time_step

    @model_validator(mode="after")
    def _linear_where_nothing_else_is(self) -> Solver:
        """Left to default, Froude-Krylov forces are linear in the frequency domain; not a key that was set, though."""
        if self.method == "frequency" and "froude_krylov" not in self.model_fields_set:
            self.__dict__["froude_krylov"] = "linear"
        return self


class HemisphereCylinder(Table):
    """A hemisphere under a cylinder of the same radius; still water at the junction."""

    shape: Literal["hemisphere-cylinder"]
    radius: Annotated[Positive, Unit("m")]
    height: Annotated[Positive, Unit("m")]

    @property
    def draft(self) -> float:
        """Depth of the lowest point [m]."""
        return self.radius


class Sphere(Table):
    """A sphere whose lowest point is `draft` below still water."""

    shape: Literal["sphere"]
    radius: Annotated[Positive, Unit("m")]
    draft: Annotated[Positive, Unit("m")]


class VerticalCylinder(Table):
    """A cylinder on end, `draft` below and `freeboard` above still water."""

    shape: Literal["vertical-cylinder"]
    radius: Annotated[Positive, Unit("m")]
    draft: Annotated[Positive, Unit("m")]
    freeboard: Annotated[Positive, Unit("m")]


class PanelMesh(Table):
    """Any closed hull, as panels in a file (STL, GDF, Nemoh's .dat and others), shifted, turned, scaled.

    A point of the file comes to scale · Rz Ry Rx (point - origin) in the float's coordinates; still water at z = 0.
    """

    shape: Literal["mesh"]
    file: File
    origin: Annotated[Vector, Unit("m")] = (0.0, 0.0, 0.0)  # of the file, in its units: the float's reference point
    rotation: Annotated[Vector, Unit("rad")] = (0.0, 0.0, 0.0)  # about x, then y, then z, through that point
    scale: Annotated[Positive, Field(ge=1e-6, le=1e6), Unit("-")] = 1.0  # such as 0.001 for a file in mm


Hull = Annotated[HemisphereCylinder | Sphere | VerticalCylinder | PanelMesh, Field(discriminator="shape")]


Motion = Literal["hinge", "surge", "sway", "heave", "roll", "pitch", "yaw"]


@fields_of(physics.Float)
class Float(Table):
    """A rigid float on a massless arm, joined to the platform, to fixed ground or to another float.

    `motion` lists what the joint leaves free, in order from the support: "hinge", about `axis`, or motions
    of the joint's point; `[]` fixes the body. What belongs to the joint is a number for its only axis, or a list with
    one for each.
    """

    name: Name
    hull: Hull
    motion: tuple[Motion, ...]
    if TYPE_CHECKING:
        hinge: Vector
        pto_damping: float | tuple[float, ...]


@fields_of(frame.Material)
class Material(Table):
    """Linear elastic."""


class Tube(Table):
    """A circular hollow section."""

    shape: Literal["tube"]
    diameter: Annotated[Positive, Unit("m")]
    thickness: Annotated[Positive, Unit("m")]


class SolidRectangle(Table):
    """A solid rectangular section."""

    shape: Literal["solid-rectangle"]
    width: Annotated[Positive, Unit("m")]
    height: Annotated[Positive, Unit("m")]


Section = Annotated[Tube | SolidRectangle, Field(discriminator="shape")]


@fields_of(frame.Member)
class Member(Table):
    """A straight beam between two nodes, cut into equal elements; it takes wave loads if C_D > 0 or C_M > 1."""

    name: Name
    start: Name
    end: Name
    elements: Annotated[Count, Field(le=1000)] = 1
    section: Name
    material: Name


@fields_of(frame.PointMass)
class PointMass(Table):
    """A mass without extent on a node."""

    node: Name


@fields_of(frame.PointLoad)
class PointLoad(Table):
    """A constant force on a node."""

    node: Name


@fields_of(physics.Platform, ("legs", "damping_ratio", "geometric_stiffness", "wave_inertia"))
class Platform(Table):
    """A beam frame. Nodes named hinge:<float> come with the floats; the others stand here."""

    nodes: dict[Name, Vector]
    materials: dict[Name, Material]
    sections: dict[Name, Section]
    members: tuple[Member, ...]
    clamped: tuple[Name, ...]
    legs: tuple[Name, ...] = ()
    masses: tuple[PointMass, ...] = ()
    loads: tuple[PointLoad, ...] = ()
    if TYPE_CHECKING:
        damping_ratio: float
        geometric_stiffness: bool
        wave_inertia: Literal["standard", "relative"]


class StudyFile(Table):
    """A whole study file."""

    title: Title = ""
    # Of the floats, from others' boundary elements: capytaine's .nc, BEMIO's .h5, WAMIT's .1 beside .3 and .hst, .out.
    coefficients: CoefficientFile | None = None
    water: Water
    waves: Waves = Waves()
    record: Recording = Recording()
    solver: Solver = Solver()
    floats: tuple[Float, ...] = ()
    platform: Platform | None = None
    axes: Axes = Axes()
    variants: dict[Label, Variant] = Field(default={})
    samples: Samples | None = None
    sea_states: dict[Label, SeaState]

    @property
    def varied(self) -> tuple[Axis, ...]:
        """The axes over keys: paths and groups, variants, samples."""
        variants = (variant_axis(self.variants),) if self.variants else ()
        return (*variants, *self.axes.over_keys, *((self.samples.axis,) if self.samples else ()))

    @model_validator(mode="before")
    @classmethod
    def _imply_a_sea(cls, data: Any) -> Any:
        """Axes over keys of the sea need no sea state to start from."""
        if isinstance(data, dict) and "sea_states" not in data and (sea := implied_sea(data.get("axes"))):
            return {**data, "sea_states": {"sea": sea}}
        return data


def units() -> dict[str, str]:
    """Unit of every key that has one; a key means the same in every table."""
    symbols: dict[str, str] = {}
    for table in tables():
        for key, field in table.model_fields.items():
            # In a union with None the unit sits one level down.
            inner = [m for a in getattr(field.annotation, "__args__", ()) for m in getattr(a, "__metadata__", ())]
            for mark in (*field.metadata, *inner):
                if isinstance(mark, Unit):
                    symbols[key] = mark.symbol
    return symbols


def tables(above: type[Table] = Table) -> Iterator[type[Table]]:
    """All tables of study files."""
    for table in above.__subclasses__():
        yield table
        yield from tables(table)
