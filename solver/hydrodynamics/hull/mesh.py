"""Panels on hulls below still water, lids inside them, and the mirror planes of a scene."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.edges import jutting, narrowed
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.plates import Plates, Stretch, of_panels, pieces, stretches
from solver.hydrodynamics.hull.revolution import Revolution, polygon_radius
from solver.hydrodynamics.hull.surface import merged, mirrored

Hull = Revolution | PanelHull

PANELS = 432  # a body, of the finest of the boundary elements' meshes, where no more are asked for
ON_PLANE = 1e-9  # of a scene's size
LONGER = 1.2
LEAST_PLATE = 0.05  # of a mesh's wetted surface, from which on its thin parts are plates
# Across a waterplane of several outlines: panels of its bottom, cells of its lid. Those are no smaller than this share
# of the side that the panels ask for: in a narrower waterplane no wave that the panels resolve stands.
ACROSS_BOTTOM, ACROSS_LID, LEAST_CELL = 2.0, 3.0, 0.2
MOVED, INSET, SLIVER = 0.6, 0.1, 0.1  # of a cell's side: how far corners move, and to how near the outline; of its area
IMAGES = np.array([[1, 1, 1], [1, -1, 1], [-1, 1, 1], [-1, -1, 1]], float)  # of a quarter at x > 0, y > 0


def panels(
    hull: Hull, count: int, *, refine: int = 1, quarters: int = 4, narrow: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals on the wetted hull, about `count` on all of it: vertices (nv, 3) [m], faces (nf, 4).

    `refine` divides each panel's sides: meshes that differ in it alone are one family, and may be
    extrapolated. `quarters` from azimuth 0: 1 is x >= 0, y >= 0; 2 is y >= 0; 4 the whole. Normals
    point into the water. `narrow`: whether those of a mesh may be narrower at edges.
    """
    if isinstance(hull, PanelHull):
        return _halved_panels(hull, count, refine, quarters, narrow)
    return _revolved_panels(hull, count, refine, quarters)


def _revolved_panels(hull: Revolution, count: int, refine: int, quarters: int) -> tuple[np.ndarray, np.ndarray]:
    """Panels in rings about the axis, see `panels`.

    Vertices are pushed outwards, horizontally until the waterplane area is exact, then vertically
    until the displaced volume is: coefficients do not inherit an inscribed, too small, body.
    """
    half, along = _lattice(hull, count)
    half *= refine
    arc, azimuth, faces = _quarter(_rings(along, refine), half)
    r, z = _along(hull, arc).T
    z = np.minimum(z, 0.0)  # the waterline may come out above by rounding
    points = np.column_stack([r * np.cos(azimuth), r * np.sin(azimuth), z])
    points[:, :2] *= polygon_radius(8 * half)
    # First triangles, then the others: in another order vertices, and all coefficients, have other last digits.
    points[:, 2] *= hull.volume / (4 * sum(surface.volume(points[faces[:, c]]) for c in ([0, 1, 2, 2], [0, 2, 3, 3])))
    return _copied(points, faces, quarters)


def _halved_panels(
    hull: PanelHull, count: int, refine: int, quarters: int, narrow: bool
) -> tuple[np.ndarray, np.ndarray]:
    """The panels of a mesh, halved until there are about `count`, narrower at edges, then each into refine².

    Of one made coarser with its `finer` ones, these.
    """
    pieces = part_of(hull.wetted if hull.finer is None or refine == 1 else hull.finer, quarters)
    if hull.finer is not None:
        if narrow:
            pieces = narrowed(pieces, *hull.edges if refine == 1 else jutting(hull.finer))
        return indexed(pieces)
    how = halving(hull, count)
    pieces = surface.split(pieces, how.longest)
    if narrow and how.narrow:
        pieces = narrowed(pieces, *hull.edges)
    while refine > 1:
        pieces, refine = surface.quartered(pieces), refine // 2
    return indexed(pieces)


def part_of(pieces: np.ndarray, quarters: int) -> np.ndarray:
    """What of panels (n, 4, 3) lies in so many quarters, see `panels`."""
    for axis in (1, 0)[: {4: 0, 2: 1, 1: 2}[quarters]]:
        pieces = surface.below(pieces, axis, sign=-1)
    return pieces


class Halving(NamedTuple):
    """How the panels of a mesh are made of it."""

    longest: float  # side [m]
    narrow: bool  # at edges


@lru_cache(maxsize=64)  # each frequency's mesh is the same
def halving(hull: PanelHull, count: int) -> Halving:
    """So that it leaves as near to `count` panels as it can, and narrower ones at edges besides.

    Unless that made more than a mesh of half their sides is meant to have.
    """
    # Triangles are cut across their longest sides, which makes up to four times as many as their area asks for.
    sizes = panel_side(hull, count) * LONGER ** np.arange(8)
    sizes = np.minimum(sizes, max(sizes[0], hull.waterplane_width / ACROSS_BOTTOM))
    made = [surface.split(hull.wetted, size) for size in sizes]
    best = np.argmin(np.abs(np.log(np.divide([len(panels) for panels in made], count))))
    most, even = 4 * count, made[best]
    return Halving(float(sizes[best]), len(even) <= most and len(narrowed(even, *hull.edges)) <= most)


@lru_cache(maxsize=64)
def halved_count(hull: Hull, count: int, *, narrow: bool = True) -> int:
    """How many panels `panels` makes of a hull, not divided further: of one with a thin plate several times `count`."""
    return len(panels(hull, count, narrow=narrow)[1])


def at_least(hull: Hull, least: int) -> int:
    """What to ask `panels` for to have so many of a body of revolution, whose rings make that more or less."""
    asked = least
    while isinstance(hull, Revolution) and halved_count(hull, asked) < least:
        asked += 1
    return asked


def indexed(pieces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    faces = np.arange(4 * len(pieces)).reshape(-1, 4)
    faces[np.all(pieces[:, 2] == pieces[:, 3], axis=1), 3] -= 1
    return pieces.reshape(-1, 3), faces


@lru_cache(maxsize=64)
def plates(hull: Hull, count: int) -> Plates | None:
    """What of a hull is thinner than about `count` panels are wide; None if that is next to nothing."""
    if not isinstance(hull, PanelHull):
        faced = sum(piece.segment.area for piece in pieces(hull) if piece.twin >= 0)
        return Plates(faced / hull.wetted_area, 0.0) if faced else None
    vertices, faces = panels(hull, count, refine=1 if hull.finer is None else 2)
    found = of_panels(vertices[faces])
    return found if found.share > LEAST_PLATE else None


def lid(hull: Hull, count: int, *, quarters: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals on the waterplane inside the hull, as large as those of `panels`; normals point down."""
    if isinstance(hull, PanelHull):
        return _lattice_lid(hull, count, quarters)
    return _disc_lid(hull, count, quarters)


def _disc_lid(hull: Revolution, count: int, quarters: int) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals in rings on the waterplane's disc."""
    half = _lattice(hull, count)[0]
    radius = hull.waterplane_radius
    arc, azimuth, faces = _quarter(np.linspace(radius / 2, radius, 1 + (half + 1) // 2), half)
    points = np.column_stack([arc * np.cos(azimuth), arc * np.sin(azimuth), 0 * arc])
    return _copied(points * polygon_radius(8 * half), faces, quarters)


def _lattice_lid(hull: PanelHull, count: int, quarters: int) -> tuple[np.ndarray, np.ndarray]:
    """Rectangles of a lattice over the waterplane, those that lie inside it; between several outlines see `_fitted`.

    What is left free along the waterline is narrower than a panel: its eigenfrequencies are beyond
    those that the panels resolve.
    """
    low, high = hull.box
    size = panel_side(hull, count)
    across = hull.waterplane_width / ACROSS_LID
    fitted = LEAST_CELL * size < across < np.inf
    if fitted:
        size = min(size, across)
    # Even numbers: planes of symmetry run between cells. Four at least, or a slender body has no lid.
    nx, ny = (2 * max(2, round(extent / size / 2)) for extent in high - low)
    x, y = np.linspace(low[0], high[0], nx + 1), np.linspace(low[1], high[1], ny + 1)
    if quarters < 4:
        y = y[ny // 2 :]
    if quarters < 2:
        x = x[nx // 2 :]
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), -1)
    corners = np.stack([nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1]], axis=2).reshape(-1, 4, 2)
    if fitted:
        cells = _fitted(corners, hull.waterline, (corners == 0.0) & np.array([quarters < 2, quarters < 4]))
    else:
        cells = _within(corners, hull.waterline)
    return indexed(np.concatenate([cells, np.zeros((*cells.shape[:2], 1))], axis=2))


def _within(corners: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Those of a lattice's cells (n, 4, 2) that lie within an outline (ns, 2, 2)."""
    shrunk = corners + 1e-3 * (corners.mean(axis=1, keepdims=True) - corners)
    return corners[inside(shrunk.reshape(-1, 2), outline).reshape(-1, 4).all(axis=1)]


def _fitted(corners: np.ndarray, outline: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """A lattice's cells (n, 4, 2) that lie within an outline (ns, 2, 2), corners near it moved to just within it.

    Coordinates `kept` (n, 4, 2), on planes of symmetry, stay. Cells of which one corner stays outside become
    triangles; no side cuts across a well.
    """
    side = np.abs(corners[:, 2] - corners[:, 0]).min()
    place, gap = nearest(corners.reshape(-1, 2), outline)
    within = inside(corners.reshape(-1, 2), outline)
    near = gap < MOVED * side
    away = (corners.reshape(-1, 2) - place) / np.maximum(gap, 1e-12 * side)[:, None] * np.where(within, 1, -1)[:, None]
    moved = np.where(near[:, None], place + INSET * side * away, corners.reshape(-1, 2)).reshape(corners.shape)
    moved[kept] = corners[kept]
    held = (within | near).reshape(-1, 4)
    three = held.sum(axis=1) == 3
    turn = (np.argmin(held[three], axis=1)[:, None] + np.array([1, 2, 3, 3])) % 4
    cells = np.concatenate([moved[held.all(axis=1)], moved[three][np.arange(three.sum())[:, None], turn]])
    (x, y), (u, v) = (cells[:, 2] - cells[:, 0]).T, (cells[:, 1] - cells[:, 3]).T
    cells = cells[(x * v - y * u) / 2 > SLIVER * side**2]
    centre, middles = cells.mean(axis=1, keepdims=True), (cells + np.roll(cells, 1, axis=1)) / 2
    points = np.concatenate([centre, middles + INSET * (centre - middles)], axis=1)
    return cells[inside(points.reshape(-1, 2), outline).reshape(-1, 5).all(axis=1)]


def nearest(points: np.ndarray, outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The point (n, 2) of an outline (ns, 2, 2) nearest to each of points (n, 2), and how far it is (n,)."""
    start, along = outline[:, 0], outline[:, 1] - outline[:, 0]
    length = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)  # a mesh may give a point twice
    way = np.einsum("nsi,si->ns", points[:, None] - start, along) / length
    feet = start + np.clip(way, 0, 1)[..., None] * along
    gaps = np.linalg.norm(points[:, None] - feet, axis=2)
    first = gaps.argmin(axis=1), np.arange(len(points))
    return feet[first[1], first[0]], gaps[first[1], first[0]]


def inside(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Which points (n, 2) a ray along x leaves across an odd number of an outline's segments (ns, 2, 2)."""
    (x0, y0), (x1, y1) = segments[:, 0].T, segments[:, 1].T
    x, y = points.T[:, :, None]
    spans = (y0 > y) != (y1 > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        meets = x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
    return np.sum(spans & meets, axis=1) % 2 == 1


def _lattice(hull: Revolution, count: int) -> tuple[int, list[Stretch]]:
    """Panels in an eighth of the circumference, and along the meridian, see `stretches`."""
    if count < 12:
        raise InputError("panels", count, "must be at least 12")
    size = np.sqrt(hull.wetted_area / count) * 1.08  # those at edges and at the pole are smaller
    return max(1, round(np.pi / 4 * hull.largest_radius / size)), stretches(hull, size)


def _rings(along: list[Stretch], refine: int) -> np.ndarray:
    """Arc lengths of the rings of vertices [m], finer towards edges and waterline, from mid first stretch."""
    first, *others = along
    rings = [first.length / 2 * (1 + _cluster(refine * first.panels, start=0.0))]
    for length, count in others:
        rings.append(rings[-1][-1] + length * _cluster(refine * count, start=1.0)[1:])
    return np.concatenate(rings)


def _cluster(n: int, *, start: float) -> np.ndarray:
    """n + 1 fractions from 0 to 1, a quarter of the way from cosine to even spacing; start = 0: even at the start."""
    even = np.linspace(0, 1, n + 1)
    both, end = (1 - np.cos(np.pi * even)) / 2, np.sin(np.pi / 2 * even)
    return even / 4 + (start * both + (1 - start) * end) * 3 / 4


def _along(hull: Revolution, arc: np.ndarray) -> np.ndarray:
    """Points (r, z) of the wetted meridian at arc lengths from the pole, (n, 2) [m]."""
    along = [segment for segment, _ in pieces(hull)]
    ends = np.cumsum([s.length for s in along])
    index = np.minimum(np.searchsorted(ends, arc - 1e-9 * ends[-1]), len(along) - 1)
    points = np.empty((arc.size, 2))
    for i, segment in enumerate(along):
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


def _copied(points: np.ndarray, faces: np.ndarray, quarters: int) -> tuple[np.ndarray, np.ndarray]:
    """The first quarter and its mirror images: for 2 in the plane x = 0, for 4 in y = 0 too."""
    copies = [mirrored((points, faces), sign) for sign in IMAGES[[0, 2, 1, 3][:quarters]]]
    return merged(copies)


def panel_side(hull: Hull, count: int) -> float:
    """Of right-angled triangles [m], as many of which are as large as the wetted surface."""
    return float(np.sqrt(2 * hull.wetted_area / count))


def mirror_planes(hulls: tuple[Hull, ...], centres: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a scene's planes of symmetry cross (3,) [m], and the images (1, 2 or 4, 3) of signs they make."""
    origin = np.array([*(centres[:, :2].min(axis=0) + centres[:, :2].max(axis=0)) / 2, 0.0])
    at = on_planes(hulls, centres - origin)
    across, along = (_is_mirrored(hulls, at, axis) for axis in (1, 0))
    if not across:
        return origin, IMAGES[:1]
    # Bodies on the plane x = 0 beside y = 0 would have to be halved the other way.
    halves = np.any((at[:, 0] == 0) & (at[:, 1] != 0))
    return origin, IMAGES if along and not halves else IMAGES[:2]


def on_planes(hulls: tuple[Hull, ...], at: np.ndarray) -> np.ndarray:
    """Places (nb, 3) about where the planes cross, with 0 in that of one a hair off."""
    return np.where(np.abs(at) < _hair(hulls, at), 0.0, at)


def _hair(hulls: tuple[Hull, ...], at: np.ndarray) -> float:
    """Distance [m] within which places are taken for the same."""
    return ON_PLANE * float(max(h.largest_radius for h in hulls) + np.abs(at).max())


def _is_mirrored(hulls: tuple[Hull, ...], at: np.ndarray, axis: int) -> bool:
    """Whether every hull is its own mirror image, and an equal one is where that is."""
    if not all(h.symmetry[axis] for h in hulls):
        return False
    return bool(np.all(partner(hulls, at, np.where(np.arange(3) == axis, -1.0, 1.0)) >= 0))


def partner(hulls: tuple[Hull, ...], at: np.ndarray, mirror: np.ndarray) -> np.ndarray:
    """Number of the equal body that lies where each body's mirror image does, (nb,), itself if it may; -1: none."""
    gap = np.linalg.norm((at * mirror)[:, None] - at[None], axis=-1)
    close, found = gap < _hair(hulls, at), np.full(len(at), -1)
    for b in range(len(at)):
        equal = [int(o) for o in np.flatnonzero(close[b]) if hulls[o] == hulls[b]]
        found[b] = b if b in equal else equal[0] if equal else -1
    return found


def quarters(at: np.ndarray, images: int) -> int:
    """Quarters of a body at `at` to be meshed: of bodies that are each other's image only one, at x > 0 and y > 0."""
    x, y = at[:2]
    if images == 1:
        return 4
    if y < 0 or (images == 4 and x < 0):
        return 0
    return 4 // ((2 if y == 0 else 1) * (2 if images == 4 and x == 0 else 1))


def symmetry_classes(mirrors: np.ndarray) -> np.ndarray:
    """Signs (nc, ng) by which an even or odd motion about each plane goes over to each image."""
    x, y = mirrors[:, 0], mirrors[:, 1]
    return np.array([np.ones(len(x)), y, x, x * y][: len(x)])
