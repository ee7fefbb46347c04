"""Hulls of any shape as closed panel meshes, and their hydrostatics, exact on the polyhedron.

Body coordinates: z = 0 the still-water plane at rest, x and y from the reference point.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256

import numpy as np
import scipy  # spatial is slow to import, and the command line needs scenes but rarely meshes

from solver.errors import InputError
from solver.hydrodynamics.hull import mending, meshfile, shells, surface
from solver.hydrodynamics.hull.edges import jutting

ALIKE = 1e-5  # of the hull's size, within which a mirror image coincides with the hull, and one that is turned
ROUND = 16  # corners on a circle of what counts as round

FARTHEST = 1e5  # [m]
LEAST = 1e-8  # of the extent cubed: volume that upright walls alone may seem to have by rounding


@dataclass(frozen=True, eq=False, kw_only=True)
class PanelHull:
    """A surface of triangles and quadrilaterals about a body, normals into the water."""

    vertices: np.ndarray  # (nv, 3) [m]
    faces: np.ndarray  # (nf, 4), a triangle gives its last vertex twice
    closed: bool = True  # False: good for linear forces alone
    holes: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 3)))  # (n, 2, 3) open edges below still water [m]
    notes: tuple[str, ...] = ()  # what was mended
    name: str = "mesh"  # of its file
    finer: np.ndarray | None = None  # (n, 4, 3) [m] wetted panels with sides half as long; None: by halving them

    @classmethod
    def of(cls, vertices: np.ndarray, faces: np.ndarray, *, name: str = "mesh") -> "PanelHull":
        """The hull of a mesh (nv, 3), (nf, 4): welded, wound outwards, and refused where it is no hull."""
        key = meshfile.KEY
        vertices, faces = np.asarray(vertices, float), np.asarray(faces)
        if (far := float(np.abs(vertices).max(initial=0.0))) > FARTHEST:
            raise InputError(key, name, f"has a corner at {far:.3g} m, must be within {FARTHEST:g} m; see hull.scale")
        vertices, faces, copies, against = mending.once(vertices, faces)
        # Whether the hull is symmetric or not: what is cut there has no slivers then, what is mirrored no slits.
        vertices, faces, cleaned = mending.welded(vertices, faces, [0, 1, 2])
        cleaned += copies
        if not len(faces):
            raise InputError(key, name, "has no panel with an area")
        lowest = vertices[faces.ravel(), 2].min()
        if not lowest < 0:
            limit = "must reach below still water, z = 0 m: hull.origin is the file's point that comes to lie there"
            raise InputError(key, f"{name}, lowest point at z = {lowest:g} m", limit)
        told = ", ".join([name, *cleaned])
        mending.require_joined(vertices, faces, key, told)
        given, (faces, rim, part, turned) = faces, mending.oriented(vertices, faces, key, told)
        inner = shells.within(vertices[faces], part, not len(rim), key, name)
        if inner.any():
            cleaned += [f"left out: {inner.sum()} panels of surfaces within another, where no water is"]
            faces, rim, _, turned = mending.oriented(vertices, given[~inner], key, name)
        turned += shells.walls(vertices[faces])
        holes = vertices[rim[vertices[rim, 2].min(axis=1) < 0]]
        near = surface.point_text(holes[0].mean(axis=0)) if len(holes) else ""
        if against and near:
            raise InputError(key, told, f"is open below still water near {near}: plates need a thickness")
        for array in (vertices, faces, holes):
            array.setflags(write=False)
        hull = cls(
            vertices=vertices, faces=faces, closed=not len(rim), holes=holes,
            notes=tuple(cleaned + turned), name=name,
        )  # fmt: skip
        if not hull.volume > LEAST * np.ptp(vertices, axis=0).max() ** 3:
            limit = "must be > 0"
            if near:
                limit += f": it is open below still water, at {len(holes)} edges, the first near {near}"
            raise InputError(key, f"{name}, displaced volume {hull.volume:g} m3", limit)
        return hull

    def moved(self, by: np.ndarray) -> "PanelHull":
        """Shifted by (3,) [m]."""
        finer = None if self.finer is None else self.finer + by
        return replace(self, vertices=self.vertices + by, holes=self.holes + by, finer=finer)

    def __eq__(self, other: object) -> bool:
        return type(other) is PanelHull and self._digest == other._digest

    def __hash__(self) -> int:
        return hash(self._digest)

    @cached_property
    def _digest(self) -> bytes:
        """Of what tells hulls apart, the same in every process; -0.0 is 0.0."""
        parts = [self.vertices, self.faces] + ([] if self.finer is None else [self.finer])
        return sha256(b"".join((part + 0.0).tobytes() for part in parts)).digest()

    @cached_property
    def panels(self) -> np.ndarray:
        """All panels (n, 4, 3) [m], four corners each."""
        return self.vertices[self.faces]

    @cached_property
    def wetted(self) -> np.ndarray:
        """The panels below still water (n, 4, 3) [m], cut there."""
        return surface.below(self.panels)

    def surface_points(self) -> tuple[np.ndarray, np.ndarray]:
        """Quadrature of the wetted surface at rest: points (np, 3) [m] and outward areas n dS (np, 3) [m²].

        The middles of all triangles' sides: exact for polynomials of the second degree. Sides of
        panels are a tenth of the wetted part's extent at most.
        """
        pieces = surface.split(self.wetted, np.ptp(self.wetted.reshape(-1, 3), axis=0).max() / 10)
        return _midpoints(pieces)

    @cached_property
    def _moments(self) -> dict[str, float]:
        """∫ f n_z dS over the wetted surface for f = 1, x, y, z, x², ... ; all exact."""
        points, areas = _midpoints(self.wetted)
        x, y, z = points.T
        terms = {"1": 1 + 0 * x, "x": x, "y": y, "z": z, "xx": x * x, "xy": x * y, "yy": y * y}
        terms |= {"xz": x * z, "yz": y * z, "zz": z * z / 2}
        return {name: float(f @ areas[:, 2]) for name, f in terms.items()}

    @property
    def volume(self) -> float:
        """Displaced volume at rest [m³], ∫ z n_z dS: the waterplane gives nothing."""
        return self._moments["z"]

    @property
    def buoyancy_point(self) -> np.ndarray:
        """Centroid of the displaced volume (3,) [m]."""
        m = self._moments
        return np.array([m["xz"], m["yz"], m["zz"]]) / self.volume

    @property
    def centre_of_buoyancy(self) -> float:
        """z of the displaced volume's centroid [m]."""
        return float(self.buoyancy_point[2])

    @property
    def waterplane(self) -> np.ndarray:
        """∫ of 1, x, y, x², xy, y² over the waterplane (6,) [m² to m⁴]: less those of n_z over the wetted surface."""
        return -np.array([self._moments[name] for name in ("1", "x", "y", "xx", "xy", "yy")])

    @property
    def draft(self) -> float:
        """Depth of the lowest point [m]."""
        return float(-self.panels[..., 2].min())

    @property
    def freeboard(self) -> float:
        """Height of the highest point [m], below zero of a hull under water."""
        return float(self.panels[..., 2].max())

    @property
    def largest_radius(self) -> float:
        """Largest distance from the vertical through the reference point, below still water [m]."""
        return float(np.hypot(*self.wetted.reshape(-1, 3).T[:2]).max())

    @property
    def levers(self) -> np.ndarray:
        """Largest distances from the axes x, y, z through the reference point, below still water (3,) [m]."""
        squares = self.wetted.reshape(-1, 3) ** 2
        return np.asarray(np.sqrt((squares.sum(axis=1)[:, None] - squares).max(axis=0)))

    @property
    def scale(self) -> float:
        """Radius of the circle as large as the waterplane, the largest radius where that is smaller [m]."""
        radius = np.sqrt(max(self.waterplane[0], 0.0) / np.pi)
        return float(radius if 0.02 * self.largest_radius < radius < self.largest_radius else self.largest_radius)

    @property
    def size(self) -> float:
        """Distance from the reference point within which the whole hull lies [m]."""
        return float(np.linalg.norm(self.panels, axis=-1).max())

    @property
    def profile_size(self) -> float:
        """The same as seen along y [m]."""
        return float(np.linalg.norm(self.panels[..., ::2], axis=-1).max())

    @property
    def wetted_area(self) -> float:
        """Surface below still water [m²]."""
        return float(np.linalg.norm(surface.area_vectors(surface.triangles(self.wetted)), axis=1).sum())

    @property
    def box(self) -> np.ndarray:
        """Corners (2, 2) [m] of the rectangle about the wetted part, (x, y) least and largest."""
        flat = self.wetted.reshape(-1, 3)[:, :2]
        return np.array([flat.min(axis=0), flat.max(axis=0)])

    @property
    def silhouette(self) -> np.ndarray:
        """The convex outline seen along y, (n, 2) of x and z [m]."""
        flat = self.vertices[:, [0, 2]]
        return flat[scipy.spatial.ConvexHull(flat).vertices]

    @cached_property
    def waterline(self) -> np.ndarray:
        """Segments (ns, 2, 2) [m] in which the hull meets still water."""
        start, end = self.wetted, np.roll(self.wetted, -1, axis=1)
        at = np.abs(np.stack([start[..., 2], end[..., 2]], axis=-1)).max(axis=-1) < surface.WELD * self.size
        return np.stack([start[at], end[at]], axis=1)[..., :2]

    @cached_property
    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Where the wetted surface juts out, and by how much: see `jutting`."""
        return jutting(self.wetted)

    @property
    def sharpest(self) -> float:
        """Largest angle by which the wetted surface turns where two panels meet at an edge that juts out [rad]."""
        return float(self.edges[1].max(initial=0.0))

    @cached_property
    def waterplane_width(self) -> float:
        """Of a waterplane with several outlines, round wells or apart: twice area over outline [m]; else infinite.

        It is R - r of a ring, 2ab/(a + b) of rectangles.
        """
        level = np.pad(self.waterline, ((0, 0), (0, 0), (0, 1)))
        if surface.outlines(level)[0] < 2:
            return np.inf
        return float(2 * self.waterplane[0] / np.linalg.norm(level[:, 1] - level[:, 0], axis=1).sum())

    @cached_property
    def symmetry(self) -> tuple[bool, bool]:
        """Whether the hull is symmetric in x = 0, and in y = 0."""
        return self._mirrored(0), self._mirrored(1)

    @cached_property
    def revolved(self) -> bool:
        """Whether its corners lie as many on each circle, ROUND at least, and a turn by one brings each to another."""
        radius, angle = np.hypot(*self.vertices[:, :2].T), np.arctan2(*self.vertices[:, 1::-1].T)
        grid = ALIKE * self.size
        places = np.round(np.stack([radius, self.vertices[:, 2]], axis=1) / grid)
        same = np.unique(places, axis=0, return_inverse=True)[1]
        count = np.bincount(same)
        if not (radius.min() > grid and count.min() == count.max() >= ROUND):
            return False
        angle = angle + 2 * np.pi / count[0]
        turned = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), self.vertices[:, 2]])
        return surface.alike(self.panels, turned[self.faces], grid)

    def _mirrored(self, axis: int) -> bool:
        """Whether the hull is its own image; panels may be cut otherwise there, along the other diagonal say."""
        image = surface.mirrored((self.vertices, self.faces), np.where(np.arange(3) == axis, -1.0, 1.0))
        return surface.alike(self.panels, image[0][image[1]], ALIKE * self.size)


def _midpoints(panels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middles of the sides of all triangles (3n, 3), and a third of n dS (3n, 3) at each."""
    corners = surface.triangles(panels)
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    return middles.reshape(-1, 3), np.repeat(surface.area_vectors(corners) / 3, 3, axis=0)
