"""Body-nonlinear hydrostatic and Froude-Krylov load on hulls that are panel meshes.

F = -∫ p n dS, p = ρg(-z + head), as in `froude_krylov`: the incident field is a series about the
float, summed once an instant. Each triangle is cut at the instantaneous surface and integrated by
the middles of the sides of what is wet: exact for still water and for any plane surface, second
order in the panels' size for waves.
"""

from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.hull import surface
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.pressure.froude_krylov import heads, surface_series
from solver.kernels import fast_kernel
from solver.sea.field import WaveField


class WettedPanels(NamedTuple):
    """Triangles of all hulls, one hull after the other; a hull of revolution has none here.

    vertices (nv, 3) [m] in body coordinates; corners (nt, 3) vertex numbers; area (nt, 3) n dS [m²];
    first_vertex, first_triangle (nb + 1,); copies 2 where the mirror half in y = 0 is left out, else 1.
    nodes (3, nv): s, z and height above the surface; points (7, 6 nt): body coordinates, s, z, head
    and scratch; pieces (2, 2 nt): triangle and share of each wet piece.
    """

    vertices: np.ndarray
    corners: np.ndarray
    area: np.ndarray
    first_vertex: np.ndarray
    first_triangle: np.ndarray
    copies: float
    surface_terms: int
    nodes: np.ndarray
    points: np.ndarray
    pieces: np.ndarray


def longest_side(hull, share: float, field: WaveField) -> float:
    """Longest side of a mesh's triangles [m]: a share of the hull's size, and of 1/k of the mean wave."""
    return share * min(hull.size, 1 / max(field.mean_wavenumber, 1e-9))


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
        nodes=np.empty((3, len(vertices))),
        points=np.empty((7, 6 * len(corners))),
        pieces=np.empty((2, 2 * len(corners))),
    )


def _triangles(hull: PanelHull, size: float, half: bool) -> tuple[np.ndarray, np.ndarray]:
    panels = surface.below(hull.panels, 1, sign=-1) if half else hull.panels
    # Triangles first: halving them leaves no vertex on a neighbour's side, and so no gap at a curved surface.
    corners = surface.triangles(panels)
    corners = surface.split(np.concatenate([corners, corners[:, 2:]], axis=1), size)[:, :3]
    vertices, place = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return vertices, place.reshape(-1, 3)


@fast_kernel
def _levels(rule, first, last, along, up, z0, series):
    """Fill rule.nodes: s from the reference point, z, and height above the surface, of vertices first to last."""
    s, z, height = rule.nodes[0], rule.nodes[1], rule.nodes[2]
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
def _add_piece(rule, count, triangle, share, p, q, r):
    """One wet piece with corners p, q, r (5,): body coordinates, s and z."""
    rule.pieces[0, count], rule.pieces[1, count] = triangle, share
    for k in range(5):
        rule.points[k, 3 * count] = (p[k] + q[k]) / 2
        rule.points[k, 3 * count + 1] = (q[k] + r[k]) / 2
        rule.points[k, 3 * count + 2] = (r[k] + p[k]) / 2


@fast_kernel
def _between(p, hp, q, hq, out):
    """Where the side from p to q meets the surface, heights of either sign; its share of the side."""
    share = hp / (hp - hq)
    for k in range(5):
        out[k] = p[k] + share * (q[k] - p[k])
    return share


@fast_kernel
def _wet_pieces(rule, first, last):
    """Fill rule.points and rule.pieces with the wet parts of triangles first to last; their number."""
    height = rule.nodes[2]
    corner, cut = np.empty((3, 5)), np.empty((2, 5))
    count = 0
    for t in range(first, last):
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
            for r in range(3):
                corner[n, r] = rule.vertices[v, r]
            corner[n, 3], corner[n, 4] = rule.nodes[0, v], rule.nodes[1, v]
        a, b, c = corner[0], corner[1], corner[2]
        if wet == 3:
            _add_piece(rule, count, t, 1.0, a, b, c)
            count += 1
        elif wet == 1:
            share = _between(a, height[i], b, height[j], cut[0]) * _between(a, height[i], c, height[k], cut[1])
            _add_piece(rule, count, t, share, a, cut[0], cut[1])
            count += 1
        else:  # a is dry
            on_b, on_c = _between(b, height[j], a, height[i], cut[0]), _between(c, height[k], a, height[i], cut[1])
            _add_piece(rule, count, t, on_c, b, c, cut[1])
            _add_piece(rule, count + 1, t, on_b * (1.0 - on_c), b, cut[1], cut[0])
            count += 2
    return count


@fast_kernel
def _summed(rule, count, total):
    """Force and moment (6,) per ρg in body coordinates: pressure heads at the points times n dS / 3."""
    x, y, z = rule.points[0], rule.points[1], rule.points[2]
    height, head = rule.points[4], rule.points[5]
    for n in range(count):
        q = mx = my = mz = 0.0
        for i in range(3 * n, 3 * n + 3):
            p = height[i] - head[i]  # minus the pressure
            q += p
            mx += p * x[i]
            my += p * y[i]
            mz += p * z[i]
        area, third = rule.area[int(rule.pieces[0, n])], rule.pieces[1, n] / 3
        ax, ay, az = area[0] * third, area[1] * third, area[2] * third
        total[0] += q * ax
        total[1] += q * ay
        total[2] += q * az
        total[3] += my * az - mz * ay
        total[4] += mz * ax - mx * az
        total[5] += mx * ay - my * ax


@fast_kernel
def panels_pressure(b, position, rotation, rule, c, centre, direction, rho_g, wheeler, depth, load):
    """Load (6,) [N, N m] about the reference point of hull b, added to `load`; see froude_krylov.pressure_load."""
    s0 = (position[0] - centre[0]) * direction[0] + (position[1] - centre[1]) * direction[1]
    series = surface_series(c, s0, rule.surface_terms, np.empty(c.shape[1]))
    along, up = np.empty(3), np.empty(3)
    for r in range(3):
        along[r] = rotation[0, r] * direction[0] + rotation[1, r] * direction[1]
        up[r] = rotation[2, r]
    _levels(rule, rule.first_vertex[b], rule.first_vertex[b + 1], along, up, position[2], series)
    pieces = _wet_pieces(rule, rule.first_triangle[b], rule.first_triangle[b + 1])
    count = 3 * pieces
    s, z, head, imag = rule.points[3], rule.points[4], rule.points[5], rule.points[6]
    level = z[:count].copy()
    if wheeler:
        for i in range(count):
            eta = series[series.size - 1]
            for k in range(series.size - 2, -1, -1):
                eta = eta * s[i] + series[k]
            level[i] = (z[i] - eta) / (1.0 + eta / depth)
    for i in range(count):
        s[i] += s0
    heads(c, s[:count], level, head[:count], imag[:count])
    total = np.zeros(6)
    _summed(rule, pieces, total)
    scale = rho_g * rule.copies
    for r in range(3):
        if r == 1 and rule.copies == 2.0:
            continue  # the mirror half cancels sway
        for k in range(3):
            load[r] += scale * rotation[r, k] * total[k]
    for r in range(3):
        if r != 1 and rule.copies == 2.0:
            continue  # and roll and yaw
        for k in range(3):
            load[3 + r] += scale * rotation[r, k] * total[3 + k]
