"""The tables of hulls, told apart by their shape."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from pipeline.study.attachments import File
from pipeline.study.tables import Number, Positive, Table, Unit, Vector


class HemisphereCylinder(Table):
    """A hemisphere under a cylinder of the same radius; still water at the junction."""

    shape: Annotated[Literal["hemisphere-cylinder"], "Kind of hull"]
    radius: Annotated[Positive, Unit("m"), "Of hemisphere and cylinder; the draft"]
    height: Annotated[Positive, Unit("m"), "Of the cylinder, above still water"]


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
    origin: Annotated[
        Vector,
        Unit("m"),
        "Point of the file, in its units, that is the float's reference point; its z must be that of still water",
    ] = (0.0, 0.0, 0.0)
    rotation: Annotated[Vector, Unit("rad"), "Turns about x, then y, then z, through that point"] = (0.0, 0.0, 0.0)
    scale: Annotated[Positive, Field(ge=1e-6, le=1e6), Unit("-"), "Metres in the file's unit, 0.001 for mm"] = 1.0


Hull = Annotated[
    HemisphereCylinder | Sphere | VerticalCylinder | Profile | Ring | BoxHull | Duck | PanelMesh,
    Field(discriminator="shape"),
]
