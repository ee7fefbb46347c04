"""The tables of a study file: names, types, units, ranges. Lengths in m, masses in kg, all SI."""

from __future__ import annotations

from dataclasses import fields
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import Field, create_model

from pipeline.study.attachments import File
from pipeline.study.seas import SeaState, Waves
from pipeline.study.tables import (
    Count,
    Depth,
    Flag,
    Label,
    Name,
    NotNegative,
    Number,
    PerAxis,
    Positive,
    Seed,
    SignedPerAxis,
    Table,
    Title,
    Unit,
    Vector,
)
from solver.scene import Settings


class Water(Table):
    """Still water of constant depth."""

    depth: Annotated[Depth, Unit("m")]  # inf for deep water
    density: Annotated[Positive, Unit("kg/m3")] = 1025.0
    gravity: Annotated[Positive, Unit("m/s2")] = 9.81


class Recording(Table):
    """What of the simulated time is analysed."""

    duration: Annotated[Positive, Unit("s")] = 3600.0
    discard: Annotated[NotNegative, Unit("s")] = 100.0
    ramp: Annotated[NotNegative, Unit("s")] = 50.0
    ramp_form: Literal["paper", "cosine"] = "paper"
    series: Literal["none", "decimated", "full"] = "none"  # of the record; decimated keeps four in the shortest wave
    rao: Flag = False  # motion per wave amplitude, for every wave of the sea


# Beyond these a knob asks for what arithmetic cannot give, or for nothing.
BOUNDS = {
    "newton_tolerance": (1e-14, 1.0),
    "field_tolerance": (1e-14, 1.0),
    "memory_tolerance": (1e-8, 1.0),
    "panel_size": (0.01, 10.0),
}


def _knobs() -> dict[str, Any]:
    """Numerical choices, as the solver names and defaults them; names, types and defaults are its own."""
    strict: dict[Any, Any] = {float: Positive, int: Annotated[Count, Field(le=1000)], bool: Flag}
    units = {"time_step": "s"}
    hints, found = get_type_hints(Settings), {}
    for knob in fields(Settings):
        if knob.name not in (*Recording.model_fields, "keep_series"):
            hint = hints[knob.name]
            if isinstance(hint, UnionType) or get_origin(hint) is Union:
                kind: Any = Union.__getitem__(tuple(strict.get(a, a) for a in get_args(hint)))
            else:
                kind = NotNegative if knob.default == 0.0 and hint is float else strict.get(hint, hint)
            if bounds := BOUNDS.get(knob.name):
                kind = Annotated[kind, Field(ge=bounds[0], le=bounds[1])]
            found[knob.name] = (Annotated[kind, Unit(units.get(knob.name, "-"))], knob.default)
    return found


# An id leaves out what is at its default: whoever changes a default raises tasks.task.MODEL_VERSION.
if TYPE_CHECKING:

    class Solver(Table):
        """The knobs that the pipeline itself looks at."""

        time_step: float = 0.0
        tolerance: float | None = None

else:
    Solver = create_model("Solver", __base__=Table, **_knobs())


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
    """Any closed hull, as panels in a file (STL, GDF, Nemoh's .dat and others); still water at its z = 0."""

    shape: Literal["mesh"]
    file: File


Hull = Annotated[HemisphereCylinder | Sphere | VerticalCylinder | PanelMesh, Field(discriminator="shape")]


Motion = Literal["hinge", "surge", "sway", "heave", "roll", "pitch", "yaw"]


class Float(Table):
    """A rigid float on a massless arm, joined to the platform, to fixed ground or to another float.

    `motion` lists what the joint leaves free, in order from the support: "hinge", about `axis`, or motions
    of the joint's point. What belongs to the joint is a number for its only axis, or a list with one for each.
    """

    name: Name
    hull: Hull
    mass: Annotated[Positive, Unit("kg")]
    inertia: Annotated[tuple[Positive, Positive, Positive], Unit("kg m2")]  # about the c.o.g.
    cog: Annotated[Vector, Unit("m")] = (0.0, 0.0, 0.0)  # from the reference point
    hinge: Annotated[Vector, Unit("m")]  # the joint's point, at rest
    arm: Annotated[Vector, Unit("m")] = (0.0, 0.0, 0.0)  # from there to the reference point
    axis: Annotated[Vector, Unit("-")] = (0.0, 1.0, 0.0)  # of the hinge
    motion: Annotated[tuple[Motion, ...], Field(min_length=1)] = ("hinge",)
    on: str = ""  # the float listed before that carries it, such as a floating platform; else the support
    pto_damping: Annotated[PerAxis, Unit("N m s/rad or N s/m")] = 0.0
    damping: Annotated[PerAxis, Unit("N m s/rad or N s/m")] = 0.0  # besides the PTO
    quadratic_damping: Annotated[PerAxis, Unit("N m s2/rad2 or N s2/m2")] = 0.0
    stiffness: Annotated[PerAxis, Unit("N m/rad or N/m")] = 0.0  # of a spring, at ease at rest
    mechanism_inertia: Annotated[PerAxis, Unit("kg m2 or kg")] = 0.0  # of what moves with the axis, besides the float
    offset: Annotated[SignedPerAxis, Unit("rad or m")] = 0.0  # from equilibrium, where it is let go


class Material(Table):
    """Linear elastic."""

    E: Annotated[Positive, Unit("Pa")]
    G: Annotated[Positive, Unit("Pa")]
    density: Annotated[Positive, Unit("kg/m3")]


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


class Member(Table):
    """A straight beam between two nodes, cut into equal elements."""

    name: Name
    start: Name
    end: Name
    elements: Count = 1
    section: Name
    material: Name
    drag_coefficient: Annotated[NotNegative, Unit("-")] = 0.0  # C_D; 0 and C_M = 1: no wave load
    inertia_coefficient: Annotated[Number, Field(ge=1), Unit("-")] = 1.0  # C_M = 1 + C_a


class PointMass(Table):
    """A mass without extent on a node."""

    node: Name
    mass: Annotated[Positive, Unit("kg")]


class PointLoad(Table):
    """A constant force on a node."""

    node: Name
    force: Annotated[Vector, Unit("N")]


class Platform(Table):
    """A beam frame. Nodes named hinge:<float> come with the floats; the rest are given here."""

    nodes: dict[Name, Vector]
    materials: dict[Name, Material]
    sections: dict[Name, Section]
    members: tuple[Member, ...]
    clamped: tuple[Name, ...]
    legs: tuple[Name, ...] = ()
    masses: tuple[PointMass, ...] = ()
    loads: tuple[PointLoad, ...] = ()
    damping_ratio: Annotated[
        NotNegative,
        Field(lt=1, description="Of every mode in water: with the wetted members' added mass, without the floats"),
        Unit("-"),
    ] = 0.01
    geometric_stiffness: Flag = False
    wave_inertia: Literal["standard", "relative"] = "standard"  # of Morison's equation


Support = Literal["elastic", "fixed", "elastic-no-floats"]


class Axes(Table):
    """What is varied; the study is the product of the axes."""

    sea_state: tuple[Label, ...] | None = None
    platform: tuple[Support, ...] | None = None
    pto_damping: Annotated[tuple[NotNegative, ...], Unit("N m s/rad")] | None = None
    hinge_spacing: Annotated[tuple[Positive, ...], Unit("m")] | None = None
    seed: tuple[Seed, ...] | None = None


class StudyFile(Table):
    """A whole study file."""

    title: Title = ""
    water: Water
    waves: Waves = Waves()
    record: Recording = Recording()
    solver: Solver = Solver()
    floats: tuple[Float, ...] = ()
    platform: Platform | None = None
    axes: Axes = Axes()
    sea_states: dict[Label, SeaState]


def units() -> dict[str, str]:
    """Unit of every key that has one; a key means the same in every table."""
    found: dict[str, str] = {}
    for table in Table.__subclasses__():
        for key, field in table.model_fields.items():
            # In a union with None the unit sits one level down.
            inner = [m for a in getattr(field.annotation, "__args__", ()) for m in getattr(a, "__metadata__", ())]
            for mark in (*field.metadata, *inner):
                if isinstance(mark, Unit):
                    found[key] = mark.symbol
    return found
