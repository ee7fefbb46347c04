"""Body-nonlinear hydrostatic and Froude-Krylov load on a hull of revolution.

F = -∫ p n dS over the instantaneous wetted surface, p = ρg(-z + head), head = Re Σ Cₙ ζⁿ the
incident field around the float (solver.sea.field). At each azimuth the meridian is cut where
it meets the instantaneous surface and Gauss points are put on its wetted parts alone.
"""

from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.hull.revolution import Revolution
from solver.kernels import fast_kernel, kernel
from solver.sea.field import MOST_TERMS

# The pressure vanishes at the surface, so a cut that misses it by so much [m] costs the square of that.
NEAR = 1e-6


class WettedQuadrature(NamedTuple):
    """Patches of the meridian and the rule that integrates over them.

    patch (np, 7): lines (0, rm, rd, zm, zd, n_r, n_z): r = rm + u rd, z = zm + u zd, u in [-1, 1];
    arcs (1, zc, R, sin φm, cos φm, tm, 0): φ = φm + 2 atan(tm u), r = R sin φ, z = zc - R cos φ.
    whole (np, g, 5): r, z, n_r, n_z and area at the Gauss points of a patch that is wet from end to end.
    azimuth (na, 2): cos ψ, sin ψ; weight dψ. Points and weights of Gauss rules for arc and line.
    """

    patch: np.ndarray
    whole: np.ndarray
    azimuth: np.ndarray
    dpsi: float
    arc_u: np.ndarray
    arc_w: np.ndarray
    line_u: np.ndarray
    line_w: np.ndarray
    half: bool


class QuadratureRoom(NamedTuple):
    """Scratch: one row of n Gauss points, or na azimuths, for each quantity; all wet points at once are SIMD."""

    series: np.ndarray  # (MOST_TERMS,) of the elevation
    rays: np.ndarray  # (4, na) radial directions, and their part along the waves
    height: np.ndarray  # (2 np + 1, na)
    along: np.ndarray  # (2, na) way along the waves and elevation
    lever: np.ndarray  # (3, n) from the reference point
    normal: np.ndarray  # (3, n) n dS
    s: np.ndarray  # (n,) way along the waves
    z: np.ndarray  # (n,)
    level: np.ndarray  # (n,) height at which the pressure is taken
    head: np.ndarray  # (2, n) dynamic head, and its imaginary part


def quadrature_room(rule: WettedQuadrature) -> QuadratureRoom:
    """For a rule, or for several of one size stacked."""
    azimuths, patches = len(rule.azimuth), rule.patch.shape[-2]
    n = azimuths * patches * 2 * max(rule.arc_u.size, rule.line_u.size)
    return QuadratureRoom(
        series=np.empty(MOST_TERMS),
        rays=np.empty((4, azimuths)),
        height=np.empty((2 * patches + 1, azimuths)),
        along=np.empty((2, azimuths)),
        lever=np.empty((3, n)),
        normal=np.empty((3, n)),
        s=np.empty(n),
        z=np.empty(n),
        level=np.empty(n),
        head=np.empty((2, n)),
    )


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


class Direction(NamedTuple):
    """A unit vector, and its part along the waves."""

    x: float
    y: float
    z: float
    s: float


class Meridian(NamedTuple):
    """How the meridian of one azimuth stands in the waves: point (r, z) is at reference point + r out + z axis."""

    out: Direction
    axis: Direction
    s0: float  # of the reference point, from where the field is expanded
    z0: float


def quadrature(hull: Revolution, *, azimuths: int, arc_points: int, line_points: int, half: bool) -> WettedQuadrature:
    """Rule with `azimuths` on the full circle; half = only ψ in (0, π), for a hull that does not leave its plane."""
    rows = []
    for kind, r0, z0, r1, z1, zc, radius, _ in hull.segments():
        if kind == 0:
            rd, zd = (r1 - r0) / 2, (z1 - z0) / 2
            n_r, n_z = np.array([zd, -rd]) / np.hypot(rd, zd)
            rows.append((0, (r0 + r1) / 2, rd, (z0 + z1) / 2, zd, n_r, n_z))
            continue
        start, end = np.arctan2(r0, zc - z0), np.arctan2(r1, zc - z1)
        # u -> φ by t = tan is nearly linear only for short arcs: at most a right angle each.
        pieces = int(np.ceil((end - start) / (np.pi / 2) - 1e-9))
        cuts = np.linspace(start, end, pieces + 1)
        for a, b in zip(cuts[:-1], cuts[1:], strict=True):
            mid = (a + b) / 2
            rows.append((1, zc, radius, np.sin(mid), np.cos(mid), np.tan((b - a) / 4), 0))
    span = np.pi if half else 2 * np.pi
    count = azimuths // 2 if half else azimuths
    psi = (np.arange(count) + 0.5) * span / count
    arc, line = np.polynomial.legendre.leggauss(arc_points), np.polynomial.legendre.leggauss(line_points)
    patch, dpsi = np.array(rows, float), 2 * np.pi / count
    return WettedQuadrature(
        patch=patch,
        whole=_whole(patch, arc, line, dpsi),
        azimuth=np.stack([np.cos(psi), np.sin(psi)], axis=1),
        dpsi=dpsi,
        arc_u=arc[0],
        arc_w=arc[1],
        line_u=line[0],
        line_w=line[1],
        half=half,
    )


def _whole(
    patch: np.ndarray, arc: tuple[np.ndarray, np.ndarray], line: tuple[np.ndarray, np.ndarray], dpsi: float
) -> np.ndarray:
    table = np.zeros((len(patch), max(len(arc[0]), len(line[0])), 5))
    for row, points in zip(patch, table, strict=True):
        for point, u, w in zip(points, *(line if row[0] == 0 else arc), strict=False):
            r, z, n_r, n_z, speed = _meridian(row, u)
            point[:] = r, z, n_r, n_z, w * speed * r * dpsi
    return table


@kernel(inline="always")
def _meridian(patch: np.ndarray, u: float) -> tuple[float, float, float, float, float]:
    """(r, z, n_r, n_z, ds/du) of a patch at u."""
    if patch[0] == 0:
        rd, zd = patch[2], patch[4]
        return patch[1] + u * rd, patch[3] + u * zd, patch[5], patch[6], np.sqrt(rd * rd + zd * zd)
    t = patch[5] * u
    q = 1.0 / (1.0 + t * t)
    c, s = (1.0 - t * t) * q, 2.0 * t * q
    sin_phi = patch[3] * c + patch[4] * s
    cos_phi = patch[4] * c - patch[3] * s
    R = patch[2]
    return R * sin_phi, patch[1] - R * cos_phi, sin_phi, -cos_phi, R * 2.0 * patch[5] * q


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
    r, z, _, _, _ = _meridian(patch, u)
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
        r, z, _, _, _ = _meridian(rule.patch[patches - 1 if last else i // 2], 1.0 if last else i % 2 - 1.0)
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
            r, zb, n_r, n_z, speed = _meridian(patch, centre + half * points[g])
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
