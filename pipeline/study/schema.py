"""The tables of a study file: names, types, units, ranges. Lengths in m, masses in kg, all SI."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

from pydantic import AfterValidator, Discriminator, Field, PrivateAttr, Tag, ValidationInfo, model_validator

from pipeline.study.attachments import CoefficientFile, File
from pipeline.study.axes import Axes, Axis, Samples, Survival, Variant, implied_sea, named, variant_axis
from pipeline.study.seas import SeaState, Waves
from pipeline.study.tables import (
    Count,
    Depth,
    Flag,
    FoundMass,
    FoundPlace,
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
    tables,
    unit_of,
)
from solver import power_takeoff as takeoff
from solver import scene as physics
from solver.mooring import Line as MooringLine
from solver.mooring import Mooring as Moored
from solver.sea.current import Current as Stream
from solver.sea.current import CurrentSpeed
from solver.structure import frame, soil


@fields_of(physics.Water)
class Water(Table):
    """Still water of constant depth."""

    depth: Depth  # inf for deep water
    if TYPE_CHECKING:
        density: float
        gravity: float


@fields_of(CurrentSpeed)
class CurrentLine(Table):
    """Speed of the current at a depth: straight between the lines of the table, level beyond them."""


@fields_of(Stream)
class Current(Table):
    """A steady current, which the drag of the platform's members feels; waves on it are as in still water."""

    profile: Annotated[tuple[CurrentLine, ...], "Speeds by depth, downwards, in place of `speed` and `exponent`"] = ()


DEFAULT = physics.Settings()


# An id leaves out what is at its default: whoever changes a default raises tasks.task.MODEL_VERSION.
@fields_of(physics.Fatigue)
class Fatigue(Table):
    """By which rules damage is reckoned, where `outputs` ask for it."""


@fields_of(physics.Utilisation)
class Utilisation(Table):
    """By which factors tubes are utilised (NORSOK N-004, 6.3), where `outputs` ask for it."""


def _once(outputs: tuple[str, ...]) -> tuple[str, ...]:
    """In one order, each once: one meaning, one identity."""
    return tuple(name for name in physics.OUTPUTS if name in outputs)


@fields_of(physics.Settings, ("duration", "discard", "ramp", "ramp_form", "rao", "spectra", "outputs"))
class Recording(Table):
    """What of the simulated time is analysed."""

    duration: Annotated[Number, Field(ge=1, le=1e6)] = DEFAULT.duration
    discard: Annotated[NotNegative, Field(le=1e5)] = DEFAULT.discard
    series: Annotated[
        Literal["none", "decimated", "full"],
        "Time series that records keep; decimated: four samples in the shortest wave",
    ] = "none"
    outputs: Annotated[
        tuple[physics.Output, ...],
        AfterValidator(_once),
        "What else is put out: of an elastic platform's steel, of power take-offs, and mean and slow drift of floats",
    ] = ()
    fatigue: Annotated[Fatigue, "By which rules damage is reckoned"] = Fatigue()
    utilisation: Annotated[Utilisation, "By which factors tubes are utilised"] = Utilisation()
    if TYPE_CHECKING:
        ramp: float = DEFAULT.ramp
        rao: bool = DEFAULT.rao
        spectra: bool = DEFAULT.spectra


@fields_of(physics.Settings, {f.name for f in fields(physics.Settings)} - {*Recording.model_fields, "keep_series"})
class Solver(Table):
    """Numerical choices, as the solver names and defaults them."""

    if TYPE_CHECKING:
        froude_krylov: str = DEFAULT.froude_krylov
        interaction: bool = DEFAULT.interaction
        gap_damping: float = DEFAULT.gap_damping
        gap_width: float = DEFAULT.gap_width
        method: str = DEFAULT.method
        accuracy: str = DEFAULT.accuracy
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

    shape: Annotated[Literal["hemisphere-cylinder"], "Kind of hull"]
    radius: Annotated[Positive, Unit("m"), "Of hemisphere and cylinder; the draft"]
    height: Annotated[Positive, Unit("m"), "Of the cylinder, above still water"]

    @property
    def draft(self) -> float:
        """Depth of the lowest point [m]."""
        return self.radius


class Sphere(Table):
    """A sphere whose lowest point is `draft` below still water."""

    shape: Annotated[Literal["sphere"], "Kind of hull"]
    radius: Annotated[Positive, Unit("m"), "Of the sphere"]
    draft: Annotated[Positive, Unit("m"), "Depth of the lowest point"]


class VerticalCylinder(Table):
    """A cylinder on end, `draft` below and `freeboard` above still water."""

    shape: Annotated[Literal["vertical-cylinder"], "Kind of hull"]
    radius: Annotated[Positive, Unit("m"), "Of the cylinder"]
    draft: Annotated[Positive, Unit("m"), "Depth of the bottom"]
    freeboard: Annotated[Positive, Unit("m"), "Height of the top above still water"]


class Profile(Table):
    """Any body of revolution about a vertical axis, by its meridian: a cone, a spar with a heave plate."""

    shape: Annotated[Literal["profile"], "Kind of hull"]
    points: Annotated[
        tuple[tuple[Number, Number], ...],
        Field(min_length=2, max_length=100),
        Unit("m"),
        "[r, z] along the outside, upwards; straight between them, flat to the axis at both ends",
    ]


class Ring(Table):
    """A ring round a well, as the float of a two-body point absorber, by the closed outline of its section."""

    shape: Annotated[Literal["ring"], "Kind of hull"]
    points: Annotated[
        tuple[tuple[Number, Number], ...],
        Field(min_length=3, max_length=100),
        Unit("m"),
        "[r, z] of the outline's corners, in order; the last is joined to the first",
    ]


class BoxHull(Table):
    """A box: a barge, a pontoon, a caisson, a flap; under water as a whole where its draft exceeds its height."""

    shape: Annotated[Literal["box"], "Kind of hull"]
    length: Annotated[Positive, Unit("m"), "Along x"]
    width: Annotated[Positive, Unit("m"), "Along y"]
    height: Annotated[Positive, Unit("m"), "Along z"]
    draft: Annotated[Positive, Unit("m"), "Depth of the bottom"]


class Duck(Table):
    """A Salter's duck: a stern that is round about the axis of rotation, and a beak of two flat sides, tangents to it.

    The axis lies along y below the reference point; a hinge there is at z = -submergence.
    """

    shape: Annotated[Literal["duck"], "Kind of hull"]
    radius: Annotated[Positive, Unit("m"), "Of the round stern"]
    beak: Annotated[Positive, Unit("m"), "From the axis to the beak's tip"]
    elevation: Annotated[
        Number,
        Field(ge=-2 * math.pi, le=2 * math.pi),
        Unit("rad"),
        "Of the tip as seen from the axis, from -x upwards; pi less it is the mirror image, towards +x",
    ]
    submergence: Annotated[Number, Unit("m"), "Depth of the axis below still water"]
    width: Annotated[Positive, Unit("m"), "Along the axis"]


class PanelMesh(Table):
    """Any closed hull, as panels in a file (STL, GDF, Nemoh's .dat and others), shifted, turned, scaled.

    A point of the file comes to scale · Rz Ry Rx (point - origin) in the float's coordinates; still water at z = 0.
    """

    shape: Annotated[Literal["mesh"], "Kind of hull"]
    file: Annotated[File, "Panels, in a file beside the study; z = 0 is still water"]
    origin: Annotated[Vector, Unit("m"), "Point of the file, in its units, that is the float's reference point"] = (
        0.0, 0.0, 0.0,
    )  # fmt: skip
    rotation: Annotated[Vector, Unit("rad"), "Turns about x, then y, then z, through that point"] = (0.0, 0.0, 0.0)
    scale: Annotated[Positive, Field(ge=1e-6, le=1e6), Unit("-"), "Metres in the file's unit, 0.001 for mm"] = 1.0


Hull = Annotated[
    HemisphereCylinder | Sphere | VerticalCylinder | Profile | Ring | BoxHull | Duck | PanelMesh,
    Field(discriminator="shape"),
]


Motion = Literal["hinge", "surge", "sway", "heave", "roll", "pitch", "yaw"]


@fields_of(physics.EndStops)
class EndStops(Table):
    """Springs and dampers at the ends of a joint's stroke; they push and do not pull."""

    if TYPE_CHECKING:
        lower: float | tuple[float, ...]
        upper: float | tuple[float, ...]


@fields_of(takeoff.PtoEfficiency)
class PtoEfficiency(Table):
    """Of a power take-off in each direction; it does nothing to the motion."""


@fields_of(takeoff.PtoTable, ("axis",))
class PtoTable(Table):
    """Load of a power take-off from a file: velocity [m/s] (or [rad/s]), force [N] (or [N m]), and, where it goes by
    that, too, position [m] (or [rad]): a line for each rate at each position.
    """

    file: Annotated[File, "CSV file beside the study: velocity [m/s], force [N], or in rad/s and N m; position [m]"]
    axis: Annotated[Motion | Literal[""], "The axis of `motion` that it acts on; left out, the only one"] = ""


class PtoLaw(Table):
    """Load of a power take-off by a function of your own; the solver follows a table of it, level beyond its ends."""

    file: Annotated[File, "Python file beside the study: def load(y, dy), against the motion [N] or [N m]"]
    velocity: Annotated[tuple[Number, Number], Unit("m/s or rad/s"), "Least and largest rate at which it is followed"]
    position: Annotated[
        tuple[Number, Number] | None,
        Unit("m or rad"),
        "Least and largest position, from rest; left out, the load goes by rate alone, load(0, dy)",
    ] = None
    error: Annotated[
        Number, Field(ge=1e-4, le=0.1), Unit("-"), "Share of the largest load by which the table may miss it"
    ] = 0.01
    parameters: Annotated[tuple[Number, ...], "More arguments of load, after y and dy"] = ()
    axis: Annotated[Motion | Literal[""], "The axis of `motion` that it acts on; left out, the only one"] = ""


@fields_of(Moored)
class Mooring(Table):
    """Lines about a float's place at rest, linear: stiffness, damping and pretension that couple its axes."""


@fields_of(MooringLine)
class Line(Table):
    """A catenary line, quasi-static and elastic: it lies on the seabed, at the height of its anchor, or hangs."""


@fields_of(physics.Float)
class Float(Table):
    """A rigid float on a massless arm, joined to the platform, to fixed ground or to another float.

    `motion` lists what the joint leaves free, in order from the support: "hinge", about `axis`, or motions
    of the joint's point; `[]` fixes the body. What belongs to the joint is a number for its only axis, or a list with
    one for each.
    """

    name: Annotated[Name, "Name of the float, in paths, outputs and the node hinge:<name>"]
    hull: Annotated[Hull, "Shape of the float"]
    mass: Annotated[
        FoundMass,
        'Mass of the float; "balance": what it displaces, less what the floats that it carries weigh in water',
    ]
    cog: Annotated[
        tuple[FoundPlace, FoundPlace, Number],
        'Centre of gravity, from the reference point at still water; "balance" for x or y: so that nothing turns it',
    ] = (0.0, 0.0, 0.0)
    motion: tuple[Motion, ...]
    hold: Annotated[
        Flag, "A preload that keeps it at rest where it is, its weight and buoyancy being out of balance or not"
    ] = False
    end_stops: EndStops | None = None
    lines: tuple[Line, ...] = ()
    mooring: Mooring | None = None
    pto_efficiency: PtoEfficiency | None = None
    pto_table: PtoTable | None = None
    pto_law: Annotated[PtoLaw | None, "Load of the power take-off by a function of your own"] = None
    if TYPE_CHECKING:
        hinge: Vector
        pto_damping: float | tuple[float, ...]


@fields_of(frame.Material)
class Material(Table):
    """Linear elastic."""


def _word_or_number(value: Any) -> str:
    return "<word>" if isinstance(value, str) else "<number>"


ShearFactor = Annotated[
    Annotated[
        Annotated[Literal["cowper"], Tag("<word>")] | Annotated[Positive, Tag("<number>")],
        Discriminator(_word_or_number),
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


def _in_order(forces: tuple[frame.Force, ...]) -> tuple[frame.Force, ...]:
    """Each once: one meaning, one identity."""
    return tuple(name for name in frame.FORCES if name in forces)


@fields_of(frame.Member)
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
    start_release: Annotated[tuple[frame.Force, ...], AfterValidator(_in_order)] = ()
    end_release: Annotated[tuple[frame.Force, ...], AfterValidator(_in_order)] = ()
    if TYPE_CHECKING:
        start_offset: Vector
        end_offset: Vector


@fields_of(frame.PointMass)
class PointMass(Table):
    """A mass on a node: without extent, or a rigid body with a lever and moments of inertia."""

    node: Annotated[Name, "Node that carries it"]


@fields_of(frame.PointLoad)
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


@fields_of(frame.MarineGrowth)
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


class StudyFile(Table):
    """A whole study file."""

    title: Annotated[Title, "What the study is, in a line"] = ""
    coefficients: Annotated[
        CoefficientFile | None,
        "From others' boundary elements: capytaine's .nc, BEMIO's .h5, WAMIT's .1 (.3, .hst) or .out, Nemoh's .tec; "
        "bodies without the floats' names are the floats in order",
    ] = None
    water: Annotated[Water, "The water"]
    current: Annotated[Current | None, "A steady current"] = None
    waves: Annotated[Waves, "What sea states have in common"] = Waves()
    record: Annotated[Recording, "What is analysed and kept"] = Recording()
    solver: Annotated[Solver, "Numerical choices"] = Solver()
    floats: Annotated[tuple[Float, ...], "The floats, each on its joint"] = ()
    left_out: Annotated[
        tuple[Name, ...],
        AfterValidator(lambda names: tuple(sorted(set(names)))),
        "Floats that are not there, as in a variant with one alone",
    ] = ()
    platform: Annotated[Platform | None, "The elastic platform that carries them"] = None
    axes: Annotated[Axes, "What is varied"] = Axes()
    variants: Annotated[dict[Label, Variant], "Named sets of values, along the dimension variant"] = Field(default={})
    survival: Annotated[Survival | None, "Other values in the sea states above a significant wave height"] = None
    samples: Annotated[Samples | None, "Points of a design space, along the dimension sample"] = None
    sea_states: Annotated[dict[Label, SeaState], "The seas, by label"]
    _folder: Path = PrivateAttr(default=Path())  # of the study file, which files at paths are relative to

    @property
    def context(self) -> dict[str, Path]:
        """That files of other values are to be read in."""
        return {"folder": self._folder}

    @property
    def varied(self) -> tuple[Axis, ...]:
        """The axes over keys: paths and groups, variants, samples."""
        variants = (variant_axis(self.variants),) if self.variants else ()
        samples = (self.samples.axis,) if self.samples else ()
        others = [name for name in ("pto_damping", "hinge_spacing") if getattr(self.axes, name)]
        return named((*variants, *self.axes.over_keys, *samples), others)

    @property
    def seas(self) -> dict[str, SeaState]:
        """The sea states that there are tasks in; `base` may bring others."""
        labels = self.axes.sea_state or tuple(self.sea_states)
        return {label: self.sea_states[label] for label in labels if label in self.sea_states}

    @model_validator(mode="after")
    def _keep_folder(self, info: ValidationInfo) -> StudyFile:
        self._folder = (info.context or {}).get("folder", Path())
        return self

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
            if (symbol := unit_of(field)) != "-":
                symbols[key] = symbol
    return symbols


def shapes() -> frozenset[str]:
    """Of hulls and sections: what tells their tables apart."""
    fields = (table.model_fields.get("shape") for table in tables())
    return frozenset(word for field in fields if field for word in get_args(field.annotation))
