"""The tables of floats, their joints, power take-offs and moorings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from pipeline.study.attachments import File
from pipeline.study.hulls import Hull
from pipeline.study.tables import Flag, FoundMass, FoundPlace, Name, Number, Table, Unit, Vector, fields_of
from solver import power_takeoff as takeoff
from solver import scene as physics
from solver.mooring import Line as MooringLine
from solver.mooring import Mooring as Moored

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
        'Mass of the float; "balance": what it displaces, less what the floats that it carries weigh in water, and'
        " other constant loads along heave",
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
        on: str
        pto_damping: float | tuple[float, ...]
