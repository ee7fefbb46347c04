"""Closed hulls of revolution: meridian, hydrostatics in closed form, panels below still water.

Body coordinates: axis z upwards, z = 0 the still-water plane when the body is at rest, r the
distance from the axis. Angles on an arc are measured from the downward axis:
r = R sin(phi), z = zc - R cos(phi).
"""

from dataclasses import dataclass

import numpy as np

from solver.errors import InputError

LINE, ARC = 0.0, 1.0


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
        z0, z1 = self.start[1], self.end[1]
        if z0 == z1:
            return 0.0
        z = np.polynomial.Polynomial([0.0, 1.0])
        primitive = (np.pi * self.squared_radius * z**order).integ()
        return float(primitive(z1) - primitive(z0))

    def at(self, fraction: np.ndarray) -> np.ndarray:
        """Points (r, z) at fractions of the length, (..., 2) [m]."""
        t = np.asarray(fraction)[..., None]
        if self.centre is None:
            return (1 - t) * np.array(self.start) + t * np.array(self.end)
        phi0, phi1 = self.angles
        phi = phi0 + t * (phi1 - phi0)
        return np.concatenate([np.sin(phi) * self.radius, self.centre - np.cos(phi) * self.radius], axis=-1)

    def below_water(self) -> "Segment | None":
        """The part with z <= 0 of a segment that crosses z = 0 once, upwards."""
        (r0, z0), (r1, z1) = self.start, self.end
        if z0 >= 0:
            return None
        if z1 <= 0:
            return self
        r = np.sqrt(self.squared_radius(0.0))
        return Segment(start=self.start, end=(float(r), 0.0), centre=self.centre)


@dataclass(frozen=True, slots=True, kw_only=True)
class Revolution:
    """A closed hull of revolution; `meridian` runs from the bottom pole to the top pole."""

    meridian: tuple[Segment, ...]

    def __post_init__(self):
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
        _positive("hull.radius", radius)
        if not 0 < draft < 2 * radius:
            raise InputError("hull.draft", draft, f"must be between 0 and the diameter, {2 * radius} m")
        centre = radius - draft
        return cls(meridian=(Segment(start=(0.0, -draft), end=(0.0, centre + radius), centre=centre),))

    @classmethod
    def hemisphere_cylinder(cls, *, radius: float, height: float) -> "Revolution":
        """A hemisphere under a cylinder of `height` with a flat top; still water at the junction."""
        _positive("hull.radius", radius)
        _positive("hull.height", height)
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
        _positive("hull.radius", radius)
        _positive("hull.draft", draft)
        _positive("hull.freeboard", freeboard)
        return cls(
            meridian=(
                Segment(start=(0.0, -draft), end=(radius, -draft)),
                Segment(start=(radius, -draft), end=(radius, freeboard)),
                Segment(start=(radius, freeboard), end=(0.0, freeboard)),
            )
        )

    def segments(self) -> np.ndarray:
        """Meridian for kernels, (ns, 8): kind (0 line, 1 arc), r0, z0, r1, z1, zc, R, 0.

        Arc angles: phi0 = arctan2(r0, zc - z0), phi1 = arctan2(r1, zc - z1). Lines have zc = R = 0.
        """
        return np.array(
            [
                (LINE, *s.start, *s.end, 0.0, 0.0, 0.0)
                if s.centre is None
                else (ARC, *s.start, *s.end, s.centre, s.radius, 0.0)
                for s in self.meridian
            ]
        )

    def wetted(self) -> tuple[Segment, ...]:
        """The meridian below still water, bottom pole to waterline."""
        cut = (s.below_water() for s in self.meridian)
        return tuple(s for s in cut if s is not None)

    @property
    def draft(self) -> float:
        """Depth of the lowest point [m]."""
        return -min(s.start[1] for s in self.meridian)

    @property
    def largest_radius(self) -> float:
        """Largest radius below still water [m]."""
        return float(max(s.at(np.linspace(0, 1, 65))[:, 0].max() for s in self.wetted()))

    @property
    def waterplane_radius(self) -> float:
        """Radius of the waterplane [m]."""
        return self.wetted()[-1].end[0]

    @property
    def volume(self) -> float:
        """Displaced volume at rest [m³], ∫ π r² dz."""
        return sum(s.moment(0) for s in self.wetted())

    @property
    def centre_of_buoyancy(self) -> float:
        """z of the displaced volume's centroid [m]."""
        return sum(s.moment(1) for s in self.wetted()) / self.volume

    @property
    def area(self) -> float:
        """Surface of the whole hull [m²]."""
        return sum(s.area for s in self.meridian)

    @property
    def wetted_area(self) -> float:
        """Surface below still water [m²]."""
        return sum(s.area for s in self.wetted())


def _positive(key: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0):
        raise InputError(key, value, "must be finite and > 0 m")


def panels(hull: Revolution, count: int, *, quarters: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals on the wetted hull, about `count` on all of it: vertices (nv, 3) [m], faces (nf, 4).

    `quarters` from azimuth 0: 1 is x >= 0, y >= 0; 2 is y >= 0; 4 the whole. Normals point into
    the water. Vertices are pushed outwards, horizontally until the waterplane area is exact, then
    vertically until the displaced volume is: coefficients do not inherit an inscribed, too small, body.
    """
    half = _half(hull, count)
    arc, azimuth, faces = _quarter(_rings(hull, np.sqrt(hull.wetted_area / count)), half)
    r, z = _along(hull, arc).T
    points = np.column_stack([r * np.cos(azimuth), r * np.sin(azimuth), z])
    points[:, :2] *= _polygon_scale(half)
    points[:, 2] *= hull.volume / (4 * _volume(points, faces))
    return _turned(points, faces, quarters)


def lid(hull: Revolution, count: int, *, quarters: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals on the waterplane inside the hull, matched to `panels`; normals point down."""
    half, radius = _half(hull, count), hull.waterplane_radius
    arc, azimuth, faces = _quarter(np.linspace(radius / 2, radius, 1 + (half + 1) // 2), half)
    points = np.column_stack([arc * np.cos(azimuth), arc * np.sin(azimuth), 0 * arc])
    return _turned(points * _polygon_scale(half), faces, quarters)


def _half(hull: Revolution, count: int) -> int:
    """Panels in an eighth of the circumference, for square panels of wetted area / count."""
    if count < 12:
        raise InputError("panels", count, "must be at least 12")
    return max(1, round(np.pi / 4 * hull.largest_radius / np.sqrt(hull.wetted_area / count)))


def _polygon_scale(half: int) -> float:
    """Circumscribing factor that gives a polygon of 8 half sides the area of its circle."""
    step = np.pi / (4 * half)
    return float(np.sqrt(step / np.sin(step)))


def _rings(hull: Revolution, size: float) -> np.ndarray:
    """Arc lengths of the rings of vertices [m], finer towards edges and waterline, from mid first segment."""
    first, *others = hull.wetted()
    n = max(1, round(first.length / 2 / size))
    rings = [first.length / 2 * (1 + _cluster(n, start=0.0))]
    for segment in others:
        n = max(2, round(segment.length / size))
        rings.append(rings[-1][-1] + segment.length * _cluster(n, start=1.0)[1:])
    return np.concatenate(rings)


def _cluster(n: int, *, start: float) -> np.ndarray:
    """n + 1 fractions from 0 to 1, half way between even and cosine spacing; start = 0: even at the start."""
    even = np.linspace(0, 1, n + 1)
    both, end = (1 - np.cos(np.pi * even)) / 2, np.sin(np.pi / 2 * even)
    return even / 2 + (start * both + (1 - start) * end) / 2


def _along(hull: Revolution, arc: np.ndarray) -> np.ndarray:
    """Points (r, z) of the wetted meridian at arc lengths from the pole, (n, 2) [m]."""
    wetted = hull.wetted()
    ends = np.cumsum([s.length for s in wetted])
    index = np.minimum(np.searchsorted(ends, arc - 1e-9 * ends[-1]), len(wetted) - 1)
    points = np.empty((arc.size, 2))
    for i, segment in enumerate(wetted):
        mine = index == i
        points[mine] = segment.at(np.clip(1 - (ends[i] - arc[mine]) / segment.length, 0, 1))
    return points


def _quarter(rings: np.ndarray, half: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A disc's quarter in polar coordinates: a half x half block about the pole, then rings of 2 half panels.

    The block is a square half bent into a circle, so that no panel degenerates at the pole.
    """
    u, v = (x.ravel() / half for x in np.mgrid[: half + 1, : half + 1])
    outer = np.maximum(np.maximum(u, v), 1e-30)
    angle = np.where(u >= v, np.pi / 4 * v / outer, np.pi / 2 - np.pi / 4 * u / outer)
    block = rings[0] * (0.5 * outer * np.exp(1j * angle) + 0.4 * (u + 1j * v))
    azimuth = np.linspace(0, np.pi / 2, 2 * half + 1)
    points = np.concatenate([block, (rings[1:, None] * np.exp(1j * azimuth)).ravel()])
    grid = np.arange((half + 1) ** 2).reshape(half + 1, half + 1)
    rim = np.concatenate([grid[half], grid[:half, half][::-1]])
    shells = np.concatenate([rim, grid.size + np.arange((rings.size - 1) * azimuth.size)]).reshape(-1, azimuth.size)
    # Walked outwards along the meridian and then towards growing azimuth, the left hand is the water side.
    return np.abs(points), np.angle(points), np.concatenate([_cells(grid), _cells(shells)])


def _cells(grid: np.ndarray) -> np.ndarray:
    """Quadrilaterals of a lattice of vertex numbers, wound so that hull normals point out."""
    return np.column_stack([g.ravel() for g in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1])])


def _volume(points: np.ndarray, faces: np.ndarray) -> float:
    """Volume below z = 0 over a quarter's panels [m³], ∮ z n_z dS on the two triangles of each."""
    total = 0.0
    for corners in ([0, 1, 2], [0, 2, 3]):
        a, b, c = np.moveaxis(points[faces[:, corners]], 1, 0)
        normal = np.cross(b - a, c - a) / 2
        total += float(np.sum((a + b + c)[:, 2] / 3 * normal[:, 2]))
    return total


def _turned(points: np.ndarray, faces: np.ndarray, quarters: int) -> tuple[np.ndarray, np.ndarray]:
    """The first quarter and its copies turned by 90 degrees about the axis."""
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    copies = [points @ np.linalg.matrix_power(turn, i).T for i in range(quarters)]
    return np.concatenate(copies), np.concatenate([faces + i * len(points) for i in range(quarters)])
