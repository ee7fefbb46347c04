"""The tables of the elastic platform: its frame, what stands on it, and the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag

from pipeline.study.attachments import File
from pipeline.study.tables import (
    Count,
    Name,
    NotNegative,
    Number,
    Positive,
    Table,
    Unit,
    Vector,
    fields_of,
    word_or_number,
)
from solver import scene as physics
from solver.structure import members, soil


@fields_of(members.Material)
class Material(Table):
    """Linear elastic."""


ShearFactor = Annotated[
    Annotated[
        Annotated[Literal["cowper"], Tag("<word>")] | Annotated[Positive, Tag("<number>")],
        Discriminator(word_or_number),
    ]
    | None,
    "Timoshenko's, shear area over area; cowper: Cowper's (1966); left out, the beam is Euler-Bernoulli's",
]


class Tube(Table):
    """A circular hollow section."""

    shape: Annotated[Literal["tube"], "Kind of section"]
    diameter: Annotated[Positive, Unit("m"), "Outer diameter"]
    thickness: Annotated[Positive, Unit("m"), "Thickness of the wall"]
    shear_factor: ShearFactor = None


class SolidRectangle(Table):
    """A solid rectangular section."""

    shape: Annotated[Literal["solid-rectangle"], "Kind of section"]
    width: Annotated[Positive, Unit("m"), "Across the beam, horizontally"]
    height: Annotated[Positive, Unit("m"), "Across the beam, the other way"]
    shear_factor: ShearFactor = None


ShearNumber = Annotated[Positive | None, "Timoshenko's, shear area over area; left out, the beam is Euler-Bernoulli's"]


class Box(Table):
    """A rectangular hollow section."""

    shape: Annotated[Literal["box"], "Kind of section"]
    width: Annotated[Positive, Unit("m"), "Across the beam, horizontally"]
    height: Annotated[Positive, Unit("m"), "Across the beam, the other way"]
    thickness: Annotated[Positive, Unit("m"), "Thickness of the walls"]
    shear_factor: ShearNumber = None


class IBeam(Table):
    """Two flanges on a web."""

    shape: Annotated[Literal["i-beam"], "Kind of section"]
    width: Annotated[Positive, Unit("m"), "Of the flanges, across the beam, horizontally"]
    height: Annotated[Positive, Unit("m"), "From flange to flange, both included"]
    flange: Annotated[Positive, Unit("m"), "Thickness of each flange"]
    web: Annotated[Positive, Unit("m"), "Thickness of the web"]
    shear_factor: ShearNumber = None


class General(Table):
    """Any section about its principal axes, y level in a member that is not vertical."""

    shape: Annotated[Literal["general"], "Kind of section"]
    area: Annotated[Positive, Unit("m2"), "Of the cross section"]
    Iy: Annotated[Positive, Unit("m4"), "Second moment of area about the axis y: bending up and down"]
    Iz: Annotated[Positive, Unit("m4"), "About the axis z: bending sideways"]
    J: Annotated[Positive, Unit("m4"), "Torsion constant"]
    fibres: Annotated[
        tuple[tuple[Number, Number], ...], Field(min_length=1), Unit("m"), "Places y, z at which stress is put out"
    ]
    wall: Annotated[Positive, Unit("m"), "Thickness of its plates, by which fatigue goes"]
    diameter: Annotated[NotNegative, Unit("m"), "Of the tube that the water sees; 0 for no wave loads"] = 0.0
    shear_factor: ShearNumber = None


Section = Annotated[Tube | SolidRectangle | Box | IBeam | General, Field(discriminator="shape")]


def _in_order(forces: tuple[members.Force, ...]) -> tuple[members.Force, ...]:
    """As the table of forces has them: one meaning, one identity."""
    return tuple(sorted(forces, key=members.FORCES.index))


@fields_of(members.Member)
class Member(Table):
    """A straight beam between two nodes, cut into equal elements; it takes wave loads if C_D > 0 or C_M > 1."""

    name: Annotated[Name, "Name of the member, in paths and legs"]
    start: Annotated[Name, "Node at its foot"]
    end: Annotated[Name, "Node at its other end"]
    elements: Annotated[
        Count | None,
        Field(le=1000),
        "Number of equal elements; left out, as many as the shortest waves that load it, soil and taper ask for",
    ] = None
    section: Annotated[Name, "One of [platform.sections]"]
    end_section: Annotated[
        Name | None, "Section at its end, of the same shape, to which its sides go straight; left out, the same"
    ] = None
    material: Annotated[Name, "One of [platform.materials]"]
    start_release: Annotated[tuple[members.Force, ...], AfterValidator(_in_order)] = ()
    end_release: Annotated[tuple[members.Force, ...], AfterValidator(_in_order)] = ()
    if TYPE_CHECKING:
        start_offset: Vector
        end_offset: Vector


@fields_of(members.PointMass)
class PointMass(Table):
    """A mass on a node: without extent, or a rigid body with a lever and moments of inertia."""

    node: Annotated[Name, "Node that carries it"]


@fields_of(members.PointLoad)
class PointLoad(Table):
    """A constant force on a node."""

    node: Annotated[Name, "Node that it acts on"]


def _six_or_rows(value: Any) -> str:
    return "<rows>" if isinstance(value, list | tuple) and any(isinstance(v, list | tuple) for v in value) else "<six>"


Six = tuple[Number, Number, Number, Number, Number, Number]
Foundation = Annotated[
    Annotated[Six, Tag("<six>")] | Annotated[tuple[Six, Six, Six, Six, Six, Six], Tag("<rows>")],
    Discriminator(_six_or_rows),
]


@fields_of(members.MarineGrowth)
class MarineGrowth(Table):
    """Marine growth at a depth; straight between the lines of the table, level beyond. Two at one depth are a step."""


@fields_of(soil.SoilSpring)
class SoilSpring(Table):
    """Soil round members at a depth; straight between the lines of the table, level beyond. Two at once are a step."""


class LoadHistory(Table):
    """A force on a node that goes with time, straight between the lines of a file."""

    node: Annotated[Name, "Node that it acts on"]
    file: Annotated[File, "CSV file beside the study: time [s] of the run, and Fx, Fy, Fz [N], or some of them"]


@fields_of(
    physics.Platform,
    (
        "legs",
        "damping_ratio",
        "damping_of",
        "rayleigh_mass",
        "rayleigh_stiffness",
        "geometric_stiffness",
        "wave_inertia",
        "wave_stretching",
    ),
)
class Platform(Table):
    """A beam frame. Nodes named hinge:<float> come with the floats; the others stand here."""

    nodes: Annotated[dict[Name, Vector], Unit("m"), "Places of the nodes, by name"]
    materials: Annotated[dict[Name, Material], "Materials, by name"]
    sections: Annotated[dict[Name, Section], "Sections, by name"]
    members: Annotated[tuple[Member, ...], "Beams between nodes"]
    clamped: Annotated[tuple[Name, ...], "Nodes that do not move"] = ()
    foundation: Annotated[
        dict[Name, Foundation],
        Unit("N/m, N, N m"),
        "Springs under nodes that are not clamped: along x, y, z and about them, or six rows of six",
    ] = Field(default={})
    legs: tuple[Name, ...] = ()
    masses: Annotated[tuple[PointMass, ...], "Lumped masses"] = ()
    loads: Annotated[tuple[PointLoad, ...], "Static loads"] = ()
    load_histories: Annotated[tuple[LoadHistory, ...], "Loads that go with time, in the time domain"] = ()
    marine_growth: Annotated[
        tuple[MarineGrowth, ...], "What grows on members with a diameter below still water, by depth, downwards"
    ] = ()
    soil: Annotated[
        tuple[SoilSpring, ...], "Springs of the soil round what is below the seabed, by depth, downwards"
    ] = ()
    if TYPE_CHECKING:
        damping_ratio: float
        damping_of: Literal["water", "dry"]
        rayleigh_mass: float
        rayleigh_stiffness: float
        geometric_stiffness: bool
        wave_inertia: Literal["standard", "relative"]
        wave_stretching: Literal["none", "wheeler", "extrapolated"]
