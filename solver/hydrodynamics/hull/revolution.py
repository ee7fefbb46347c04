"""Closed hulls of revolution: the meridian, and hydrostatics in closed form.

Body coordinates: axis z upwards, z = 0 the still-water plane when the body is at rest, r the
distance from the axis. Angles on an arc are measured from the downward axis:
r = R sin(phi), z = zc - R cos(phi).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from solver.errors import InputError
from solver.hydrodynamics.hull.surface import ON, SAME
from solver.quantities import require_positive

ALONG, AROUND = 24, 64  # points at which the wetted surface is summed


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """A straight line from `start` to `end`, or, with `centre`, an arc about the axis point (0, centre)."""

    start: tuple[float, float]  # (r, z) [m]
    end: tuple[float, float]  # (r, z) [m]
    centre: float | None = None  # z of the arc's centre [m]; None for a line

    @property
    def radius(self) -> float:
        """Radius of the arc [m], 0 for a line."""
        return 0.0 if self.centre is None else float(np.hypot(self.start[0], self.start[1] - self.centre))

    @property
    def angles(self) -> tuple[float, float]:
        """Polar angles (phi0, phi1) [rad] of the ends of an arc."""
        assert self.centre is not None  # lines have none
        (r0, z0), (r1, z1) = self.start, self.end
        return float(np.arctan2(r0, self.centre - z0)), float(np.arctan2(r1, self.centre - z1))

    @property
    def length(self) -> float:
        """Length of the segment [m]."""
        if self.centre is None:
            return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))
        phi0, phi1 = self.angles
        return self.radius * abs(phi1 - phi0)

    @property
    def area(self) -> float:
        """Area swept about the axis [m²]: π(r0 + r1)L for a cone, 2πR|z1 - z0| for a zone."""
        if self.centre is None:
            return np.pi * (self.start[0] + self.end[0]) * self.length
        return 2 * np.pi * self.radius * abs(self.end[1] - self.start[1])

    @property
    def squared_radius(self) -> np.polynomial.Polynomial:
        """r² as a polynomial of z [m²], exact for cones and for spheres."""
        z = np.polynomial.Polynomial([0.0, 1.0])
        if self.centre is not None:
            return self.radius**2 - (z - self.centre) ** 2
        (r0, z0), (r1, z1) = self.start, self.end
        return (r0 + (r1 - r0) / (z1 - z0) * (z - z0)) ** 2

    def moment(self, order: int) -> float:
        """∫ π r² z^order dz from start to end [m^(3 + order)]."""
        return _moment(self, order)

    @property
    def widest(self) -> float:
        """Largest radius [m]."""
        return _extent(self)[0]

    @property
    def furthest(self) -> float:
        """Largest distance from the reference point [m]."""
        return _extent(self)[1]

    def at(self, fraction: ArrayLike) -> np.ndarray:
        """Points (r, z) at fractions of the length, (..., 2) [m]."""
        t = np.asarray(fraction)[..., None]
        if self.centre is None:
            return (1 - t) * np.array(self.start) + t * np.array(self.end)
        phi0, phi1 = self.angles
        phi = phi0 + t * (phi1 - phi0)
        return np.concatenate([np.sin(phi) * self.radius, self.centre - np.cos(phi) * self.radius], axis=-1)

    def normal(self, fraction: ArrayLike) -> np.ndarray:
        """Outward unit normals (n_r, n_z) at fractions of the length, (..., 2)."""
        if self.centre is not None:
            return (self.at(fraction) - np.array([0.0, self.centre])) / self.radius
        tangent = (np.array(self.end) - np.array(self.start)) / self.length
        return np.broadcast_to([tangent[1], -tangent[0]], (*np.shape(fraction), 2))

    def below_water(self) -> "Segment | None":
        """The part with z <= 0 of a segment that crosses z = 0 once, upwards."""
        (_, z0), (_, z1) = self.start, self.end
        if z0 >= 0:
            return None
        if z1 <= 0:
            return self
        r = np.sqrt(self.squared_radius(0.0))
        return Segment(start=self.start, end=(float(r), 0.0), centre=self.centre)


@lru_cache(maxsize=256)  # a scene asks for those of its few segments again and again
def _moment(segment: Segment, order: int) -> float:
    z0, z1 = segment.start[1], segment.end[1]
    if z0 == z1:
        return 0.0
    z = np.polynomial.Polynomial([0.0, 1.0])
    primitive = (np.pi * segment.squared_radius * z**order).integ()
    return float(primitive(z1) - primitive(z0))


@lru_cache(maxsize=256)
def _extent(segment: Segment) -> tuple[float, float]:
    """Largest radius, and largest distance from the reference point [m]."""
    points = segment.at(np.linspace(0, 1, 65))
    return float(points[:, 0].max()), float(np.hypot(*points.T).max())


Line = tuple[tuple[float, float], tuple[float, float]]


def cross(one: Line, other: Line) -> bool:
    """Whether two lines of a meridian, which share no end, have a point in common."""

    def side(line: Line, point: tuple[float, float]) -> float:
        (r0, z0), (r1, z1) = line
        return (r1 - r0) * (point[1] - z0) - (z1 - z0) * (point[0] - r0)

    apart = any(min(one[0][k], one[1][k]) > max(other[0][k], other[1][k]) for k in (0, 1))
    apart = apart or any(max(one[0][k], one[1][k]) < min(other[0][k], other[1][k]) for k in (0, 1))
    across = (side(a, b[0]) * side(a, b[1]) <= 0 for a, b in ((one, other), (other, one)))
    return not apart and all(across)


@dataclass(frozen=True, slots=True, kw_only=True)
class Revolution:
    """A closed hull of revolution; `meridian` runs from the bottom pole to the top pole."""

    meridian: tuple[Segment, ...]

    def __post_init__(self) -> None:
        for before, after in zip(self.meridian[:-1], self.meridian[1:], strict=True):
            if before.end != after.start:
                raise InputError("hull.meridian", after.start, f"must start where the last ended, {before.end} m")
        if self.meridian[0].start[0] != 0 or self.meridian[-1].end[0] != 0:
            raise InputError("hull.meridian", self.meridian[-1].end, "must run from pole to pole, r = 0 m at both")
        if not self.meridian[0].start[1] < 0 < self.meridian[-1].end[1]:
            raise InputError("hull.meridian", self.meridian[0].start[1], "the poles must lie below and above z = 0 m")

    @classmethod
    def sphere(cls, *, radius: float, draft: float) -> "Revolution":
        """A sphere whose lowest point is `draft` below still water."""
        require_positive("hull.radius", radius, "m")
        if not 0 < draft < 2 * radius:
            raise InputError("hull.draft", draft, f"must be between 0 and the diameter, {2 * radius:g} m")
        centre = radius - draft
        return cls(meridian=(Segment(start=(0.0, -draft), end=(0.0, centre + radius), centre=centre),))

    @classmethod
    def hemisphere_cylinder(cls, *, radius: float, height: float) -> "Revolution":
        """A hemisphere under a cylinder of `height` with a flat top; still water at the junction."""
        require_positive("hull.radius", radius, "m")
        require_positive("hull.height", height, "m")
        return cls(
            meridian=(
                Segment(start=(0.0, -radius), end=(radius, 0.0), centre=0.0),
                Segment(start=(radius, 0.0), end=(radius, height)),
                Segment(start=(radius, height), end=(0.0, height)),
            )
        )

    @classmethod
    def vertical_cylinder(cls, *, radius: float, draft: float, freeboard: float) -> "Revolution":
        """A circular cylinder, flat at both ends."""
        require_positive("hull.radius", radius, "m")
        require_positive("hull.draft", draft, "m")
        require_positive("hull.freeboard", freeboard, "m")
        return cls(
            meridian=(
                Segment(start=(0.0, -draft), end=(radius, -draft)),
                Segment(start=(radius, -draft), end=(radius, freeboard)),
                Segment(start=(radius, freeboard), end=(0.0, freeboard)),
            )
        )

    @classmethod
    def profile(cls, points: Sequence[tuple[float, float]]) -> "Revolution":
        """Straight lines through points (r, z) [m], upwards along the outside; flat to the axis at both ends.

        Points closer to still water than ON of the extent lie on it, and those that come to coincide there are one.
        """
        given = [(float(r), float(z)) for r, z in points]
        if not given:
            raise InputError("hull.points", "[]", "must be two points at least")
        extent = max(2 * max(r for r, _ in given), float(np.ptp([z for _, z in given])))
        line = [(r, 0.0 if abs(z) < ON * extent else z) for r, z in given]
        line = [point for n, point in enumerate(line) if not n or point[1] or point != line[n - 1]]
        ends = ([(0.0, line[0][1])] if line[0][0] else []), ([(0.0, line[-1][1])] if line[-1][0] else [])
        line = ends[0] + line + ends[1]
        for (r, z), after in zip(line[1:-1], line[2:], strict=True):
            if not r > 0 or np.hypot(r - after[0], z - after[1]) <= SAME * extent:
                raise InputError("hull.points", (r, z), "must be off the axis, r > 0 m, and unlike the one after")
        if not line[0][1] < 0 < line[-1][1]:
            raise InputError(
                "hull.points", f"z from {line[0][1]:g} to {line[-1][1]:g}", "must begin below and end above z = 0 m"
            )
        pieces = list(zip(line[:-1], line[1:], strict=True))
        for n, piece in enumerate(pieces):
            if any(cross(piece, other) for other in pieces[n + 2 :]):
                raise InputError("hull.points", piece, "must not cross or touch another part of the line")
        through = [piece for piece in pieces if (piece[0][1] < 0) != (piece[1][1] < 0)]
        if len(through) > 1:
            raise InputError("hull.points", through[1], "must not pass through still water, z = 0 m, a second time")
        return cls(meridian=tuple(Segment(start=a, end=b) for a, b in pieces))

    def wetted(self) -> tuple[Segment, ...]:
        """The meridian below still water, bottom pole to waterline."""
        cut = (s.below_water() for s in self.meridian)
        return tuple(s for s in cut if s is not None)

    def surface_points(self) -> tuple[np.ndarray, np.ndarray]:
        """Quadrature of the wetted surface at rest: points (np, 3) [m] and outward areas n dS (np, 3) [m²].

        ALONG Gauss points a segment and AROUND even azimuths: exact to rounding for smooth fields.
        """
        t, w = np.polynomial.legendre.leggauss(ALONG)
        azimuth = 2 * np.pi * (np.arange(AROUND) + 0.5) / AROUND
        c, s = np.cos(azimuth), np.sin(azimuth)
        points, areas = [], []
        for segment in self.wetted():
            (r, z), (nr, nz) = segment.at((t + 1) / 2).T[:, :, None], segment.normal((t + 1) / 2).T[:, :, None]
            area = r * w[:, None] / 2 * segment.length * 2 * np.pi / AROUND
            points.append(np.stack([r * c, r * s, z + 0 * c], axis=-1).reshape(-1, 3))
            areas.append(np.stack([area * nr * c, area * nr * s, area * nz + 0 * c], axis=-1).reshape(-1, 3))
        return np.concatenate(points), np.concatenate(areas)

    @property
    def draft(self) -> float:
        """Depth of the lowest point [m]."""
        return -min(s.start[1] for s in self.meridian)

    @property
    def freeboard(self) -> float:
        """Height of the highest point [m]."""
        return max(s.end[1] for s in self.meridian)

    @property
    def largest_radius(self) -> float:
        """Largest radius below still water [m]."""
        return max(s.widest for s in self.wetted())

    @property
    def levers(self) -> np.ndarray:
        """Largest distances from the axes x, y, z through the reference point, below still water (3,) [m]."""
        far = max(s.furthest for s in self.wetted())
        return np.array([far, far, self.largest_radius])

    @property
    def size(self) -> float:
        """Distance from the reference point within which the whole hull lies [m]."""
        return max(s.furthest for s in self.meridian)

    @property
    def profile_size(self) -> float:
        """The same as seen along y [m]."""
        return self.size

    @property
    def waterplane_radius(self) -> float:
        """Radius of the waterplane [m]."""
        return self.wetted()[-1].end[0]

    @property
    def scale(self) -> float:
        """Length that sets the shortest wave worth solving for [m]."""
        return self.largest_radius

    @property
    def symmetry(self) -> tuple[bool, bool]:
        """Whether the hull is symmetric in x = 0, and in y = 0."""
        return True, True

    @property
    def closed(self) -> bool:
        """Whether the surface encloses the body above still water too."""
        return True

    @property
    def box(self) -> np.ndarray:
        """Corners (2, 2) [m] of the square about the wetted part."""
        return np.array([[-1.0, -1.0], [1.0, 1.0]]) * self.largest_radius

    @property
    def waterplane(self) -> np.ndarray:
        """∫ of 1, x, y, x², xy, y² over the waterplane (6,) [m² to m⁴]."""
        area, second = np.pi * self.waterplane_radius**2, np.pi * self.waterplane_radius**4 / 4
        return np.array([area, 0.0, 0.0, second, 0.0, second])

    @property
    def waterplane_width(self) -> float:
        """Infinite: the waterplane has one outline, see PanelHull."""
        return np.inf

    @property
    def buoyancy_point(self) -> np.ndarray:
        """Centroid of the displaced volume (3,) [m]."""
        return np.array([0.0, 0.0, self.centre_of_buoyancy])

    @property
    def volume(self) -> float:
        """Displaced volume at rest [m³], ∫ π r² dz."""
        return sum(s.moment(0) for s in self.wetted())

    @property
    def centre_of_buoyancy(self) -> float:
        """z of the displaced volume's centroid [m]."""
        return sum(s.moment(1) for s in self.wetted()) / self.volume

    @property
    def wetted_area(self) -> float:
        """Surface below still water [m²]."""
        return sum(s.area for s in self.wetted())


def polygon_radius(sides: int) -> float:
    """Distance of an even polygon's corners from its middle over the radius of the circle that is as large."""
    return float(np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides)))
