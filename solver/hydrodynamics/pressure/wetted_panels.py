"""Body-nonlinear hydrostatic and Froude-Krylov load on hulls that are panel meshes.

F = -∫ p n dS, p = ρg(-z + head), as in `froude_krylov`: the incident field is a series about the
float, summed once an instant. Each triangle is cut at the instantaneous surface and integrated by
the middles of the sides of what is wet: exact for still water and for any plane surface, second
order in the panels' size for waves.
"""

from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.pressure.froude_krylov import Incident, heads, polynomial, stretched, surface_series
from solver.kernels import fast_kernel
from solver.sea.field import WaveField


class WettedPanels(NamedTuple):
    """Triangles of all hulls, one hull after the other; a hull of revolution has none here.

    vertices (nv, 3) [m] in body coordinates; corners (nt, 3) vertex numbers; area (nt, 3) n dS [m²];
    first_vertex, first_triangle (nb + 1,); copies 2 where the mirror half in y = 0 is left out, else 1.
    """

    vertices: np.ndarray
    corners: np.ndarray
    area: np.ndarray
    first_vertex: np.ndarray
    first_triangle: np.ndarray
    copies: float
    surface_terms: int


class PanelsRoom(NamedTuple):
    """Scratch for WettedPanels."""

    nodes: np.ndarray  # (3, nv) s, z and height above the surface
    points: np.ndarray  # (7, 6 nt) body coordinates, s, z, head and its imaginary part
    pieces: np.ndarray  # (2, 2 nt) triangle and share of each wet piece


def panels_room(rule: WettedPanels) -> PanelsRoom:
    """Scratch for these triangles, all of them cut."""
    vertices, triangles = len(rule.vertices), len(rule.corners)
    return PanelsRoom(np.empty((3, vertices)), np.empty((7, 6 * triangles)), np.empty((2, 2 * triangles)))


def longest_side(hull: Hull, share: float, field: WaveField) -> float:
    """Longest side of a mesh's triangles [m]: a share of the hull's size, and of 1/k of the mean wave."""
    return share * min(hull.size, field.mean_length)


def wetted_panels(hulls: list[PanelHull | None], sizes: list[float], *, half: bool, surface_terms: int) -> WettedPanels:
    """Triangles of every hull (None: of revolution), split until no side is longer than its size [m].

    half: only y > 0, for planar scenes.
    """
    none = np.zeros((0, 3)), np.zeros((0, 3), int)
    parts = [_triangles(h, size, half) if h else none for h, size in zip(hulls, sizes, strict=True)]
    first_vertex, first_triangle = (np.cumsum([0] + [len(p[i]) for p in parts]) for i in (0, 1))
    vertices = np.concatenate([np.zeros((0, 3)), *(v for v, _ in parts)])
    corners = np.concatenate([np.zeros((0, 3), int), *(c + n for (_, c), n in zip(parts, first_vertex, strict=False))])
    return WettedPanels(
        vertices=vertices,
        corners=corners,
        area=np.ascontiguousarray(surface.area_vectors(vertices[corners])),
        first_vertex=first_vertex,
        first_triangle=first_triangle,
        copies=2.0 if half else 1.0,
        surface_terms=surface_terms,
    )


def _triangles(hull: PanelHull, size: float, half: bool) -> tuple[np.ndarray, np.ndarray]:
    panels = surface.below(hull.panels, 1, sign=-1) if half else hull.panels
    # Triangles first: halving them leaves no vertex on a neighbour's side, and so no gap at a curved surface.
    corners = surface.triangles(panels)
    corners = surface.split(np.concatenate([corners, corners[:, 2:]], axis=1), size)[:, :3]
    vertices, place = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return vertices, place.reshape(-1, 3)


@fast_kernel
def _levels(
    rule: WettedPanels, b: int, along: np.ndarray, up: np.ndarray, z0: float, series: np.ndarray, room: PanelsRoom
) -> None:
    """Fill room.nodes: s from the reference point, z, and height above the surface, of hull b's vertices."""
    first, last = rule.first_vertex[b], rule.first_vertex[b + 1]
    s, z, height = room.nodes[0], room.nodes[1], room.nodes[2]
    for v in range(first, last):
        x = rule.vertices[v]
        s[v] = along[0] * x[0] + along[1] * x[1] + along[2] * x[2]
        z[v] = z0 + up[0] * x[0] + up[1] * x[1] + up[2] * x[2]
        height[v] = series[series.size - 1]
    for k in range(series.size - 2, -1, -1):
        for v in range(first, last):
            height[v] = height[v] * s[v] + series[k]
    for v in range(first, last):
        height[v] = z[v] - height[v]


@fast_kernel
def _add_piece(
    room: PanelsRoom, count: int, triangle: int, share: float, p: np.ndarray, q: np.ndarray, r: np.ndarray
) -> None:
    """One wet piece with corners p, q, r (5,): body coordinates, s and z."""
    room.pieces[0, count], room.pieces[1, count] = triangle, share
    for k in range(5):
        room.points[k, 3 * count] = (p[k] + q[k]) / 2
        room.points[k, 3 * count + 1] = (q[k] + r[k]) / 2
        room.points[k, 3 * count + 2] = (r[k] + p[k]) / 2


@fast_kernel
def _between(p: np.ndarray, hp: float, q: np.ndarray, hq: float, out: np.ndarray) -> float:
    """Where the side from p to q meets the surface, heights of either sign; its share of the side."""
    share = hp / (hp - hq)
    for k in range(5):
        out[k] = p[k] + share * (q[k] - p[k])
    return share


@fast_kernel
def _wet_pieces(rule: WettedPanels, b: int, room: PanelsRoom) -> int:
    """Fill room.points and room.pieces with the wet parts of hull b's triangles; their number."""
    height = room.nodes[2]
    corner, cut = np.empty((3, 5)), np.empty((2, 5))
    count = 0
    for t in range(rule.first_triangle[b], rule.first_triangle[b + 1]):
        i, j, k = rule.corners[t, 0], rule.corners[t, 1], rule.corners[t, 2]
        wet = int(height[i] < 0) + int(height[j] < 0) + int(height[k] < 0)
        if wet == 0:
            continue
        # The one that differs from the other two first.
        if wet in (1, 2):
            alone = wet == 1
            while (height[i] < 0) != alone:
                i, j, k = j, k, i
        for n, v in enumerate((i, j, k)):
            for d in range(3):
                corner[n, d] = rule.vertices[v, d]
            corner[n, 3], corner[n, 4] = room.nodes[0, v], room.nodes[1, v]
        p, q, r = corner[0], corner[1], corner[2]
        if wet == 3:
            _add_piece(room, count, t, 1.0, p, q, r)
            count += 1
        elif wet == 1:
            share = _between(p, height[i], q, height[j], cut[0]) * _between(p, height[i], r, height[k], cut[1])
            _add_piece(room, count, t, share, p, cut[0], cut[1])
            count += 1
        else:  # p is dry
            on_q, on_r = _between(q, height[j], p, height[i], cut[0]), _between(r, height[k], p, height[i], cut[1])
            _add_piece(room, count, t, on_r, q, r, cut[1])
            _add_piece(room, count + 1, t, on_q * (1.0 - on_r), q, cut[1], cut[0])
            count += 2
    return count


@fast_kernel
def _summed(rule: WettedPanels, count: int, room: PanelsRoom, total: np.ndarray) -> None:
    """Force and moment (6,) per ρg in body coordinates: pressure heads at the points times n dS / 3."""
    x, y, z = room.points[0], room.points[1], room.points[2]
    height, head = room.points[4], room.points[5]
    for n in range(count):
        q = mx = my = mz = 0.0
        for i in range(3 * n, 3 * n + 3):
            p = height[i] - head[i]  # minus the pressure
            q += p
            mx += p * x[i]
            my += p * y[i]
            mz += p * z[i]
        area, third = rule.area[int(room.pieces[0, n])], room.pieces[1, n] / 3
        ax, ay, az = area[0] * third, area[1] * third, area[2] * third
        total[0] += q * ax
        total[1] += q * ay
        total[2] += q * az
        total[3] += my * az - mz * ay
        total[4] += mz * ax - mx * az
        total[5] += mx * ay - my * ax


@fast_kernel
def panels_pressure(
    b: int,
    position: np.ndarray,
    rotation: np.ndarray,
    rule: WettedPanels,
    waves: Incident,
    room: PanelsRoom,
    load: np.ndarray,
) -> None:
    """Load (6,) [N, N m] about the reference point of hull b, added to `load`; see froude_krylov.pressure_load."""
    direction, c = waves.direction, waves.c
    s0 = (position[0] - waves.centre[0]) * direction[0] + (position[1] - waves.centre[1]) * direction[1]
    series = surface_series(c, s0, rule.surface_terms, np.empty(c.shape[1]))
    along, up = np.empty(3), np.empty(3)
    for r in range(3):
        along[r] = rotation[0, r] * direction[0] + rotation[1, r] * direction[1]
        up[r] = rotation[2, r]
    _levels(rule, b, along, up, position[2], series, room)
    pieces = _wet_pieces(rule, b, room)
    count = 3 * pieces
    s, z, head, imag = room.points[3], room.points[4], room.points[5], room.points[6]
    level = z[:count].copy()
    if waves.wheeler:
        for i in range(count):
            level[i] = stretched(z[i], polynomial(series, s[i]), waves.depth)
    for i in range(count):
        s[i] += s0
    heads(c, s[:count], level, head[:count], imag[:count])
    total = np.zeros(6)
    _summed(rule, pieces, room, total)
    _add_turned(rotation, waves.rho_g * rule.copies, total, rule.copies == 2.0, load)


@fast_kernel(inline="always")
def _add_turned(rotation: np.ndarray, scale: float, total: np.ndarray, half: bool, load: np.ndarray) -> None:
    """load += scale times `total` (6,) from body to space; the mirror half cancels sway, roll and yaw."""
    for r in range(3):
        if r == 1 and half:
            continue
        for k in range(3):
            load[r] += scale * rotation[r, k] * total[k]
    for r in range(3):
        if r != 1 and half:
            continue
        for k in range(3):
            load[3 + r] += scale * rotation[r, k] * total[3 + k]
