"""Body-nonlinear hydrostatic and Froude-Krylov load on hulls that are panel meshes.

F = -∫ p n dS, p = ρg(-z + head), as in `froude_krylov`: the incident field is a series about the
float, summed once an instant. Each triangle is cut at the instantaneous surface and integrated by
the middles of the sides of what is wet: exact for still water and for any plane surface, second
order in the panels' size for waves.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.pressure.froude_krylov import Incident, heads, stretched, surface_series
from solver.kernels import fast_kernel
from solver.sea.field import WaveField

BLOCK = 256  # points, five numbers of each
KNOWN = 32  # hulls' triangles that a process keeps


class WettedPanels(NamedTuple):
    """Triangles of all hulls, one hull after the other; a hull of revolution has none here.

    vertices (nv, 3) [m] in body coordinates; corners (nt, 3) vertex numbers; area (nt, 3) n dS [m²]; sides (ns, 4)
    vertices at the ends of a side, and across it in its two triangles, the same twice where there is but one;
    load (3 ns, 6) of a pressure of one against the share of its middle in both [m², m³], in the first and the second;
    first_vertex, first_triangle, first_side (nb + 1,); copies (nb,) 2 where the mirror half in y = 0 is left out,
    else 1.
    """

    vertices: np.ndarray
    corners: np.ndarray
    area: np.ndarray
    sides: np.ndarray
    load: np.ndarray
    first_vertex: np.ndarray
    first_triangle: np.ndarray
    first_side: np.ndarray
    copies: np.ndarray


class PanelsRoom(NamedTuple):
    """Scratch for WettedPanels."""

    nodes: np.ndarray  # (3, nv) s, z and height above the surface
    pieces: np.ndarray  # (2, 2 nt) triangle and share of each wet piece of a triangle that is cut
    points: np.ndarray  # (3, 6 nt) body coordinates of the middles of their sides
    row: np.ndarray  # (ns,) of the loads, of each side of a triangle that is wholly wet
    water: np.ndarray  # (5, 6 nt + ns) s, z, level, head and its imaginary part at those points and the sides' middles


def panels_room(rule: WettedPanels) -> PanelsRoom:
    """Scratch for these triangles, all of them cut."""
    vertices, triangles, sides = len(rule.vertices), len(rule.corners), len(rule.sides)
    return PanelsRoom(
        nodes=np.empty((3, vertices)),
        pieces=np.empty((2, 2 * triangles)),
        points=np.empty((3, 6 * triangles)),
        row=np.empty(sides, np.int64),
        water=np.empty((5, 6 * triangles + sides)),
    )


def longest_side(hull: Hull, share: float, field: WaveField) -> float:
    """Longest side of a mesh's triangles [m]: a share of the hull's size, and of 1/k of the mean wave."""
    return share * min(hull.size, field.mean_length)


def wetted_panels(hulls: list[PanelHull | None], sizes: list[float], halves: list[bool]) -> WettedPanels:
    """Triangles of every hull (None: of revolution), split until no side is longer than its size [m].

    halves: of which hulls y > 0 alone, which must be symmetric and not leave their plane.
    """
    none = np.zeros((0, 3)), np.zeros((0, 3), int)
    given = zip(hulls, sizes, halves, strict=True)
    meshes = [_triangles(hull, size, half) if hull else none for hull, size, half in given]
    first_vertex, first_triangle = (np.cumsum([0] + [len(m[i]) for m in meshes]) for i in (0, 1))
    vertices = np.concatenate([np.zeros((0, 3)), *(v for v, _ in meshes)])
    corners = np.concatenate([np.zeros((0, 3), int), *(c + n for (_, c), n in zip(meshes, first_vertex, strict=False))])
    area = np.ascontiguousarray(surface.area_vectors(vertices[corners]))
    sides, load = _sides(vertices, corners, area)
    return WettedPanels(
        vertices=vertices,
        corners=corners,
        area=area,
        sides=sides,
        load=load,
        first_vertex=first_vertex,
        first_triangle=first_triangle,
        first_side=np.searchsorted(sides[:, 0], first_vertex),
        copies=np.where(halves, 2.0, 1.0),
    )


def _sides(vertices: np.ndarray, corners: np.ndarray, area: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of all triangles, in the order of their first vertices: sides (ns, 4) and load (3 ns, 6), see WettedPanels.

    No side has more than two: PanelHull.of refuses hulls with panels that meet so.
    """
    ends = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    order = np.lexsort(ends.T[::-1])
    ends, across = ends[order], corners[:, [2, 0, 1]].ravel()[order]
    middle, third = vertices[ends].mean(axis=1), area[order // 3] / 3
    single = np.concatenate([third, np.cross(middle, third)], axis=1)
    second = np.zeros(len(ends), bool)
    second[1:] = np.all(ends[1:] == ends[:-1], axis=1)
    side = np.cumsum(~second) - 1
    sides = np.column_stack([ends, across, across])[~second]
    sides[side[second], 3] = across[second]
    load = np.zeros((len(sides), 3, 6))
    load[:, 1] = single[~second]
    load[side[second], 2] = single[second]
    load[:, 0] = load[:, 1] + load[:, 2]
    return sides, load.reshape(-1, 6)


@lru_cache(maxsize=KNOWN)
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
        out = room.points[k] if k < 3 else room.water[k - 3]
        out[3 * count] = (p[k] + q[k]) / 2
        out[3 * count + 1] = (q[k] + r[k]) / 2
        out[3 * count + 2] = (r[k] + p[k]) / 2


@fast_kernel
def _between(p: np.ndarray, hp: float, q: np.ndarray, hq: float, out: np.ndarray) -> float:
    """Where the side from p to q meets the surface, heights of either sign; its share of the side."""
    share = hp / (hp - hq)
    for k in range(5):
        out[k] = p[k] + share * (q[k] - p[k])
    return share


@fast_kernel
def _cut_pieces(rule: WettedPanels, b: int, room: PanelsRoom) -> int:
    """Fill room with the wet parts of those of hull b's triangles that are cut; their number."""
    height = room.nodes[2]
    corner, cut = np.empty((3, 5)), np.empty((2, 5))
    count = 0
    for t in range(rule.first_triangle[b], rule.first_triangle[b + 1]):
        i, j, k = rule.corners[t, 0], rule.corners[t, 1], rule.corners[t, 2]
        wet = int(height[i] < 0) + int(height[j] < 0) + int(height[k] < 0)
        if wet in (0, 3):
            continue
        # The one that differs from the other two first.
        alone = wet == 1
        while (height[i] < 0) != alone:
            i, j, k = j, k, i
        for n, v in enumerate((i, j, k)):
            for d in range(3):
                corner[n, d] = rule.vertices[v, d]
            corner[n, 3], corner[n, 4] = room.nodes[0, v], room.nodes[1, v]
        p, q, r = corner[0], corner[1], corner[2]
        if wet == 1:
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
def _whole_sides(rule: WettedPanels, b: int, first: int, room: PanelsRoom) -> int:
    """Fill room, the water from point `first` on, with the sides of hull b's wholly wet triangles; their number.

    Two triangles meet in most sides, and have the pressure at the middle in common.
    """
    s, z, height = room.nodes[0], room.nodes[1], room.nodes[2]
    middle_s, middle_z = room.water[0, first:], room.water[1, first:]
    count = 0
    for e in range(rule.first_side[b], rule.first_side[b + 1]):
        i, j, k, l = rule.sides[e, 0], rule.sides[e, 1], rule.sides[e, 2], rule.sides[e, 3]
        one, other = height[k] < 0, height[l] < 0
        middle_s[count], middle_z[count] = (s[i] + s[j]) / 2, (z[i] + z[j]) / 2
        room.row[count] = 3 * e + ((0 if other else 1) if one else 2)
        # Not counted, the next one is put in its place: a branch here is mispredicted at every waterline.
        count += int((height[i] < 0) & (height[j] < 0) & (one | other))
    return count


@fast_kernel
def _evaluate_heads(waves: Incident, series: np.ndarray, s0: float, count: int, room: PanelsRoom) -> None:
    """Dynamic heads at the first `count` points; block by block, which stays in the processor's first cache."""
    for first in range(0, count, BLOCK):
        last = min(first + BLOCK, count)
        s, z, level = room.water[0, first:last], room.water[1, first:last], room.water[2, first:last]
        head, imag = room.water[3, first:last], room.water[4, first:last]
        for i in range(s.size):
            level[i], head[i] = z[i], series[series.size - 1]
        if waves.wheeler:
            for k in range(series.size - 2, -1, -1):
                for i in range(s.size):
                    head[i] = head[i] * s[i] + series[k]
            for i in range(s.size):
                level[i] = stretched(z[i], head[i], waves.depth)
        for i in range(s.size):
            s[i] += s0
        heads(waves, s, level, head, imag)


@fast_kernel
def _add_pieces(rule: WettedPanels, count: int, room: PanelsRoom, total: np.ndarray) -> None:
    """total += force and moment (6,) per ρg in body coordinates: pressure heads at the points times n dS / 3."""
    x, y, z = room.points[0], room.points[1], room.points[2]
    height, head = room.water[1], room.water[3]
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
def _add_sides(rule: WettedPanels, first: int, count: int, room: PanelsRoom, total: np.ndarray) -> None:
    """The same of `count` sides, the water at point `first` on."""
    height, head = room.water[1, first:], room.water[3, first:]
    fx = fy = fz = mx = my = mz = 0.0
    for n in range(count):
        p = height[n] - head[n]  # minus the pressure
        of = rule.load[room.row[n]]
        fx += p * of[0]
        fy += p * of[1]
        fz += p * of[2]
        mx += p * of[3]
        my += p * of[4]
        mz += p * of[5]
    total[0] += fx
    total[1] += fy
    total[2] += fz
    total[3] += mx
    total[4] += my
    total[5] += mz


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
    direction = waves.direction
    s0 = (position[0] - waves.centre[0]) * direction[0] + (position[1] - waves.centre[1]) * direction[1]
    series = surface_series(waves, s0, np.empty(waves.real.size))
    along, up = np.empty(3), np.empty(3)
    for r in range(3):
        along[r] = rotation[0, r] * direction[0] + rotation[1, r] * direction[1]
        up[r] = rotation[2, r]
    _levels(rule, b, along, up, position[2], series, room)
    pieces = _cut_pieces(rule, b, room)
    sides = _whole_sides(rule, b, 3 * pieces, room)
    _evaluate_heads(waves, series, s0, 3 * pieces + sides, room)
    total = np.zeros(6)
    _add_pieces(rule, pieces, room, total)
    _add_sides(rule, 3 * pieces, sides, room, total)
    _add_turned(rotation, waves.rho_g * rule.copies[b], total, rule.copies[b] == 2.0, load)


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
