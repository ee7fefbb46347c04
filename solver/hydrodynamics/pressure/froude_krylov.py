"""Body-nonlinear hydrostatic and Froude-Krylov load on a hull of revolution.

F = -∫ p n dS over the instantaneous wetted surface, p = ρg(-z + head), head = Re Σ Cₙ ζⁿ the
incident field around the float (solver.sea.field). At each azimuth the meridian is cut where
it meets the instantaneous surface and Gauss points are put on its wetted parts alone.
"""

from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.pressure.quadrature import Direction, Meridian, QuadratureRoom, WettedQuadrature, meridian_at
from solver.kernels import fast_kernel, kernel

# The pressure vanishes at the surface, so a cut that misses it by so much [m] costs the square of that.
NEAR = 1e-6


class Incident(NamedTuple):
    """The incident wave around a hull, and how its pressure is made of it."""

    real: np.ndarray  # (terms,) of the local field Cₙ [m^(1-n)] about `centre` (at z = 0)
    imag: np.ndarray  # (terms,)
    surface_terms: int  # of the elevation across the hull, a shorter series than that of the whole field
    centre: np.ndarray  # (3,)
    direction: np.ndarray  # (2,) of the waves
    rho_g: float
    wheeler: bool  # pressure at the stretched height (z - η)/(1 + η/h) in place of z
    depth: float


@kernel(inline="always")
def polynomial(coefficient: np.ndarray, x: float) -> float:
    """Σ cₙ xⁿ."""
    y = 0.0
    for n in range(coefficient.size - 1, -1, -1):
        y = y * x + coefficient[n]
    return y


@kernel(inline="always")
def _height(patch: np.ndarray, u: float, meridian: Meridian, surface: np.ndarray) -> float:
    """Height of a meridian point above the instantaneous surface."""
    r, z, _, _, _ = meridian_at(patch, u)
    out, axis = meridian.out, meridian.axis
    return meridian.z0 + out.z * r + axis.z * z - polynomial(surface, out.s * r + axis.s * z)


@kernel(inline="always")
def _crossing(
    patch: np.ndarray, a: float, fa: float, b: float, fb: float, meridian: Meridian, surface: np.ndarray
) -> float:
    """u in [a, b] where the meridian meets the surface: false position as Anderson and Björck weigh it."""
    for _ in range(50):
        u = (a * fb - b * fa) / (fb - fa)
        f = _height(patch, u, meridian, surface)
        if abs(f) < NEAR or abs(b - a) < 1e-12:
            return u
        if (f > 0) == (fb > 0):
            slower = 1.0 - f / fb
            fa *= slower if slower > 0 else 0.5
        else:
            a, fa = b, fb
        b, fb = u, f
    return u


@fast_kernel(inline="always")
def _rays(rule: WettedQuadrature, rotation: np.ndarray, direction: np.ndarray, rays: np.ndarray) -> None:
    """Of each azimuth: the radial direction's x, y, z and its part along the waves, rays (4, na)."""
    for j in range(rule.azimuth.shape[0]):
        for r in range(3):
            rays[r, j] = rule.azimuth[j, 0] * rotation[r, 0] + rule.azimuth[j, 1] * rotation[r, 1]
        rays[3, j] = rays[0, j] * direction[0] + rays[1, j] * direction[1]


@fast_kernel(inline="always")
def _heights(rule: WettedQuadrature, axis: Direction, z0: float, surface: np.ndarray, room: QuadratureRoom) -> None:
    """Heights above the surface where patches begin, at their middles and at the end, room.height.

    All azimuths of a point innermost (SIMD). axis: the hull's.
    """
    patches, na = rule.patch.shape[0], rule.azimuth.shape[0]
    rays, height, s, eta = room.rays, room.height, room.along[0], room.along[1]
    for i in range(2 * patches + 1):
        last = i == 2 * patches
        r, z, _, _, _ = meridian_at(rule.patch[patches - 1 if last else i // 2], 1.0 if last else i % 2 - 1.0)
        for j in range(na):
            s[j] = r * rays[3, j] + z * axis.s
            height[i, j] = z0 + r * rays[2, j] + z * axis.z
            eta[j] = surface[surface.size - 1]
        for k in range(surface.size - 2, -1, -1):
            for j in range(na):
                eta[j] = eta[j] * s[j] + surface[k]
        for j in range(na):
            height[i, j] -= eta[j]


@fast_kernel(inline="always")
def surface_series(waves: Incident, s0: float, eta: np.ndarray) -> np.ndarray:
    """Coefficients of η about s0, from η(s) = Re Σ Cₙ (is)ⁿ: a Taylor shift in eta, of which surface_terms are kept."""
    a, b = waves.real, waves.imag
    n = a.size
    for i in range(n):
        k = i % 4
        eta[i] = a[i] if k == 0 else -b[i] if k == 1 else -a[i] if k == 2 else b[i]
    kept = min(n, waves.surface_terms)
    for i in range(kept):
        carried = eta[n - 1]
        for k in range(n - 2, i - 1, -1):
            carried = eta[k] + s0 * carried
            eta[k] = carried
    return eta[:kept]


@fast_kernel(inline="always")
def heads(waves: Incident, s: np.ndarray, z: np.ndarray, head: np.ndarray, imag: np.ndarray) -> None:
    """head = Re Σ Cₙ (z + is)ⁿ at all points, Horner with the points innermost (SIMD); imag is scratch."""
    n, count = waves.real.size, s.size
    for i in range(count):
        head[i], imag[i] = waves.real[n - 1], waves.imag[n - 1]
    for k in range(n - 2, -1, -1):
        a, b = waves.real[k], waves.imag[k]
        for i in range(count):
            re = head[i] * z[i] - imag[i] * s[i] + a
            imag[i] = head[i] * s[i] + imag[i] * z[i] + b
            head[i] = re


@fast_kernel(inline="always")
def stretched(z: float, eta: float, depth: float) -> float:
    """Wheeler's height: the surface at 0, the seabed where it is."""
    return (z - eta) / (1.0 + eta / depth)


@fast_kernel(inline="always")
def pressure_load(
    position: np.ndarray,
    rotation: np.ndarray,
    rule: WettedQuadrature,
    waves: Incident,
    room: QuadratureRoom,
    load: np.ndarray,
) -> None:
    """Load (6,) [N, N m] about the hull's reference point, added to `load`.

    position (3,), rotation (3, 3) of the hull; waves: Incident; room: see quadrature_room.
    """
    direction, rays = waves.direction, room.rays
    s0 = (position[0] - waves.centre[0]) * direction[0] + (position[1] - waves.centre[1]) * direction[1]
    surface = surface_series(waves, s0, room.series)
    axis_s = rotation[0, 2] * direction[0] + rotation[1, 2] * direction[1]
    axis = Direction(rotation[0, 2], rotation[1, 2], rotation[2, 2], axis_s)
    _rays(rule, rotation, direction, rays)
    _heights(rule, axis, position[2], surface, room)
    count = 0
    for j in range(rule.azimuth.shape[0]):
        out = Direction(rays[0, j], rays[1, j], rays[2, j], rays[3, j])
        meridian = Meridian(out, axis, s0, position[2])
        for i in range(rule.patch.shape[0]):
            start, middle, end = room.height[2 * i, j], room.height[2 * i + 1, j], room.height[2 * i + 2, j]
            at = 0.0
            if rule.patch[i, 0] != 0 and (start < 0) == (middle < 0) and (middle < 0) == (end < 0):
                at = _extreme(rule.patch[i], start, middle, end)
                if at != 0:
                    middle = _height(rule.patch[i], at, meridian, surface)
            if start < 0 or middle < 0 or end < 0:
                count = _wet_points(rule, i, at, (start, middle, end), meridian, surface, room, count)
    if count > 0:
        _evaluate_heads(waves, s0, surface, room, count)
        _add_load(rule, waves.rho_g, room, count, load)


@kernel(inline="always")
def _extreme(patch: np.ndarray, start: float, middle: float, end: float) -> float:
    """u where an arc, dry or wet at its ends and middle, is the other in between; else 0.

    By these three heights above a plane surface, A + B cos φ + C sin φ from the arc's middle: its lowest or highest
    point.
    """
    t = patch[5]
    cosine, sine = (1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)
    C = (end - start) / (2.0 * sine)
    B = (middle - 0.5 * (start + end)) / (1.0 - cosine)
    A, square = middle - B, B * B + C * C
    if square <= A * A:
        return 0.0
    side = np.sqrt(square) if start < 0 else -np.sqrt(square)
    if B / side <= cosine:
        return 0.0
    return C / side / (1.0 + B / side) / t


@fast_kernel(inline="always")
def _wet_points(
    rule: WettedQuadrature,
    i: int,
    at: float,
    heights: tuple[float, float, float],
    meridian: Meridian,
    surface: np.ndarray,
    room: QuadratureRoom,
    count: int,
) -> int:
    """Put Gauss points on what is wet of a patch, after `count` others; their number with these.

    heights: at its start, at u = `at`, at its end. One wet interval about `at`, or one at each end where that is dry.
    """
    start, middle, end = heights
    patch = rule.patch[i]
    low = high = 0.0
    if (start < 0) != (middle < 0):
        low = _crossing(patch, -1.0, start, at, middle, meridian, surface)
    if (middle < 0) != (end < 0):
        high = _crossing(patch, at, middle, 1.0, end, meridian, surface)
    for side in range(1 if middle < 0 else 2):
        if middle < 0:
            a, b = -1.0 if start < 0 else low, 1.0 if end < 0 else high
        elif side == 0:
            a, b = -1.0, low if start < 0 else -1.0
        else:
            a, b = high if end < 0 else 1.0, 1.0
        if b > a:
            count = _gauss_points(rule, i, a, b, meridian, room, count)
    return count


@fast_kernel(inline="always")
def _gauss_points(
    rule: WettedQuadrature, i: int, a: float, b: float, meridian: Meridian, room: QuadratureRoom, count: int
) -> int:
    """Put a Gauss rule on a patch between u = a and b, after `count` points; their number with these."""
    patch, out, axis = rule.patch[i], meridian.out, meridian.axis
    points, weights = (rule.line_u, rule.line_w) if patch[0] == 0 else (rule.arc_u, rule.arc_w)
    half, centre = (b - a) / 2, (a + b) / 2
    lever, normal = room.lever, room.normal
    for g in range(points.size):
        if half == 1.0:
            at = rule.whole[i, g]
            r, zb, n_r, n_z, area = at[0], at[1], at[2], at[3], at[4]
        else:
            r, zb, n_r, n_z, speed = meridian_at(patch, centre + half * points[g])
            area = weights[g] * half * speed * r * rule.dpsi
        lever[0, count] = r * out.x + zb * axis.x
        lever[1, count] = r * out.y + zb * axis.y
        lever[2, count] = r * out.z + zb * axis.z
        normal[0, count] = area * (n_r * out.x + n_z * axis.x)
        normal[1, count] = area * (n_r * out.y + n_z * axis.y)
        normal[2, count] = area * (n_r * out.z + n_z * axis.z)
        room.s[count] = meridian.s0 + r * out.s + zb * axis.s
        room.z[count] = meridian.z0 + lever[2, count]
        count += 1
    return count


@fast_kernel(inline="always")
def _evaluate_heads(waves: Incident, s0: float, surface: np.ndarray, room: QuadratureRoom, count: int) -> None:
    """Dynamic heads at the first `count` points, room.head."""
    s, z, level = room.s[:count], room.z, room.level[:count]
    for i in range(count):
        level[i] = z[i]
    if waves.wheeler:
        for i in range(count):
            level[i] = stretched(z[i], polynomial(surface, s[i] - s0), waves.depth)
    heads(waves, s, level, room.head[0, :count], room.head[1, :count])


@fast_kernel(inline="always")
def _add_load(rule: WettedQuadrature, rho_g: float, room: QuadratureRoom, count: int, load: np.ndarray) -> None:
    """load += Σ pressure times n dS and its moment about the reference point."""
    z, head, lever, normal = room.z, room.head[0], room.lever, room.normal
    fx_ = fy_ = fz_ = mx_ = my_ = mz_ = 0.0
    for i in range(count):
        p = rho_g * (z[i] - head[i])  # minus the pressure
        fx, fy, fz = p * normal[0, i], p * normal[1, i], p * normal[2, i]
        fx_ += fx
        fy_ += fy
        fz_ += fz
        mx_ += lever[1, i] * fz - lever[2, i] * fy
        my_ += lever[2, i] * fx - lever[0, i] * fz
        mz_ += lever[0, i] * fy - lever[1, i] * fx
    load[0] += fx_
    load[2] += fz_
    load[4] += my_
    if not rule.half:  # else the mirror half cancels them
        load[1] += fy_
        load[3] += mx_
        load[5] += mz_
