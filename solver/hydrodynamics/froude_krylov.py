"""Body-nonlinear hydrostatic and Froude-Krylov load on a hull of revolution.

F = -∫ p n dS over the instantaneous wetted surface, p = ρg(-z + head), head = Re Σ Cₙ ζⁿ the
incident field around the float (solver.sea.field). At each azimuth the meridian is cut where
it meets the instantaneous surface and Gauss points are put on its wetted parts alone.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from solver.hydrodynamics.hull import Revolution

# Reassociating a sum of ~100 terms moves the last bits only; it lets the compiler use SIMD.
FAST = {"contract", "reassoc", "nsz"}


class WettedQuadrature(NamedTuple):
    """Patches of the meridian and the rule that integrates over them.

    patch (np, 7): lines (0, rm, rd, zm, zd, 0, 0): r = rm + u rd, z = zm + u zd, u in [-1, 1];
    arcs (1, zc, R, sin φm, cos φm, tm, 0): φ = φm + 2 atan(tm u), r = R sin φ, z = zc - R cos φ.
    azimuth (na, 2): cos ψ, sin ψ; weight dψ. Points and weights of Gauss rules for arc and line.
    """

    patch: np.ndarray
    azimuth: np.ndarray
    dpsi: float
    arc_u: np.ndarray
    arc_w: np.ndarray
    line_u: np.ndarray
    line_w: np.ndarray
    half: bool
    surface_terms: int


def quadrature(
    hull: Revolution, *, azimuths: int, arc_points: int, line_points: int, half: bool, surface_terms: int = 99
) -> WettedQuadrature:
    """Rule with `azimuths` on the full circle; half = only ψ in (0, π), for planar scenes.

    surface_terms: of the elevation across the hull, a shorter series than that of the whole field.
    """
    rows = []
    for kind, r0, z0, r1, z1, zc, radius, _ in hull.segments():
        if kind == 0:
            rows.append((0, (r0 + r1) / 2, (r1 - r0) / 2, (z0 + z1) / 2, (z1 - z0) / 2, 0, 0))
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
    return WettedQuadrature(
        patch=np.array(rows, float),
        azimuth=np.stack([np.cos(psi), np.sin(psi)], axis=1),
        dpsi=2 * np.pi / count,
        arc_u=arc[0],
        arc_w=arc[1],
        line_u=line[0],
        line_w=line[1],
        half=half,
        surface_terms=surface_terms,
    )


@njit(cache=True, inline="always")
def _meridian(patch, u):
    """(r, z, n_r, n_z, ds/du) of a patch at u."""
    if patch[0] == 0:
        rd, zd = patch[2], patch[4]
        length = np.sqrt(rd * rd + zd * zd)
        return patch[1] + u * rd, patch[3] + u * zd, zd / length, -rd / length, length
    t = patch[5] * u
    q = 1.0 / (1.0 + t * t)
    c, s = (1.0 - t * t) * q, 2.0 * t * q
    sin_phi = patch[3] * c + patch[4] * s
    cos_phi = patch[4] * c - patch[3] * s
    R = patch[2]
    return R * sin_phi, patch[1] - R * cos_phi, sin_phi, -cos_phi, R * 2.0 * patch[5] * q


@njit(cache=True, inline="always")
def _polynomial(coefficient, x):
    y = 0.0
    for n in range(coefficient.size - 1, -1, -1):
        y = y * x + coefficient[n]
    return y


@njit(cache=True)
def _height(patch, u, slope_r, slope_z, along_r, along_z, z0, surface):
    """Height of a meridian point above the instantaneous surface."""
    r, z, _, _, _ = _meridian(patch, u)
    return z0 + slope_r * r + slope_z * z - _polynomial(surface, along_r * r + along_z * z)


@njit(cache=True)
def _crossing(patch, a, fa, b, fb, slope_r, slope_z, along_r, along_z, z0, surface):
    """u in [a, b] where the meridian meets the surface: Illinois variant of false position."""
    for _ in range(50):
        u = (a * fb - b * fa) / (fb - fa)
        f = _height(patch, u, slope_r, slope_z, along_r, along_z, z0, surface)
        if abs(f) < 1e-10 or abs(b - a) < 1e-12:
            return u
        if (f > 0) == (fb > 0):
            b, fb = u, f
            fa *= 0.5
        else:
            a, fa = b, fb
            b, fb = u, f
    return u


@njit(cache=True, fastmath=FAST)
def _surface(c, s0, terms):
    """Coefficients of η about s0, from η(s) = Re Σ Cₙ (is)ⁿ: a Taylor shift, `terms` kept."""
    n = c.shape[1]
    eta = np.empty(n)
    for i in range(n):
        k = i % 4
        eta[i] = c[0, i] if k == 0 else -c[1, i] if k == 1 else -c[0, i] if k == 2 else c[1, i]
    kept = min(n, terms)
    for i in range(kept):
        for k in range(n - 2, i - 1, -1):
            eta[k] += s0 * eta[k + 1]
    return eta[:kept]


@njit(cache=True, fastmath=FAST)
def _head(c, s, z, head):
    """head = Re Σ Cₙ (z + is)ⁿ at all points, Horner with the points innermost (SIMD)."""
    n, count = c.shape[1], s.size
    imag = np.empty(count)
    for i in range(count):
        head[i], imag[i] = c[0, n - 1], c[1, n - 1]
    for k in range(n - 2, -1, -1):
        a, b = c[0, k], c[1, k]
        for i in range(count):
            re = head[i] * z[i] - imag[i] * s[i] + a
            imag[i] = head[i] * s[i] + imag[i] * z[i] + b
            head[i] = re


@njit(cache=True, fastmath=FAST)
def pressure_load(position, rotation, rule, c, centre, direction, rho_g, wheeler, depth, load):
    """Load (6,) [N, N m] about the hull's reference point, added to `load`.

    position (3,), rotation (3, 3) of the hull; c (2, terms) local field [m^(1-n)] about
    `centre` (at z = 0); direction (2,) of the waves; wheeler: pressure at the stretched height
    (z - η)/(1 + η/h) in place of z.
    """
    s0 = (position[0] - centre[0]) * direction[0] + (position[1] - centre[1]) * direction[1]
    surface = _surface(c, s0, rule.surface_terms)
    capacity = rule.azimuth.shape[0] * rule.patch.shape[0] * 2 * max(rule.arc_u.size, rule.line_u.size)
    s, z, head = np.empty(capacity), np.empty(capacity), np.empty(capacity)
    lever, normal = np.empty((3, capacity)), np.empty((3, capacity))
    axis_s = rotation[0, 2] * direction[0] + rotation[1, 2] * direction[1]
    count = 0
    for j in range(rule.azimuth.shape[0]):
        e0 = rule.azimuth[j, 0] * rotation[0, 0] + rule.azimuth[j, 1] * rotation[0, 1]
        e1 = rule.azimuth[j, 0] * rotation[1, 0] + rule.azimuth[j, 1] * rotation[1, 1]
        e2 = rule.azimuth[j, 0] * rotation[2, 0] + rule.azimuth[j, 1] * rotation[2, 1]
        e_s = e0 * direction[0] + e1 * direction[1]
        end = _height(rule.patch[0], -1.0, e2, rotation[2, 2], e_s, axis_s, position[2], surface)
        for i in range(rule.patch.shape[0]):
            patch = rule.patch[i]
            points, weights = (rule.line_u, rule.line_w) if patch[0] == 0 else (rule.arc_u, rule.arc_w)
            start = end  # patches join
            middle = _height(patch, 0.0, e2, rotation[2, 2], e_s, axis_s, position[2], surface)
            end = _height(patch, 1.0, e2, rotation[2, 2], e_s, axis_s, position[2], surface)
            if start >= 0 and middle >= 0 and end >= 0:
                continue
            low = high = 0.0
            if (start < 0) != (middle < 0):
                low = _crossing(
                    patch, -1.0, start, 0.0, middle, e2, rotation[2, 2], e_s, axis_s, position[2], surface
                )
            if (middle < 0) != (end < 0):
                high = _crossing(patch, 0.0, middle, 1.0, end, e2, rotation[2, 2], e_s, axis_s, position[2], surface)
            # One wet interval about the middle, or one at each end where the middle is dry.
            for side in range(1 if middle < 0 else 2):
                if middle < 0:
                    a, b = -1.0 if start < 0 else low, 1.0 if end < 0 else high
                elif side == 0:
                    a, b = -1.0, low if start < 0 else -1.0
                else:
                    a, b = high if end < 0 else 1.0, 1.0
                half, centre_u = (b - a) / 2, (a + b) / 2
                if half <= 0:
                    continue
                for g in range(points.size):
                    r, zb, n_r, n_z, speed = _meridian(patch, centre_u + half * points[g])
                    area = weights[g] * half * speed * r * rule.dpsi
                    lever[0, count] = r * e0 + zb * rotation[0, 2]
                    lever[1, count] = r * e1 + zb * rotation[1, 2]
                    lever[2, count] = r * e2 + zb * rotation[2, 2]
                    normal[0, count] = area * (n_r * e0 + n_z * rotation[0, 2])
                    normal[1, count] = area * (n_r * e1 + n_z * rotation[1, 2])
                    normal[2, count] = area * (n_r * e2 + n_z * rotation[2, 2])
                    s[count] = s0 + r * e_s + zb * axis_s
                    z[count] = position[2] + lever[2, count]
                    count += 1
    if count == 0:
        return
    level = z[:count].copy()
    if wheeler:
        for i in range(count):
            eta = _polynomial(surface, s[i] - s0)
            level[i] = (z[i] - eta) / (1.0 + eta / depth)
    _head(c, s[:count], level, head)
    total = np.zeros(6)
    for i in range(count):
        p = rho_g * (z[i] - head[i])  # minus the pressure
        fx, fy, fz = p * normal[0, i], p * normal[1, i], p * normal[2, i]
        total[0] += fx
        total[1] += fy
        total[2] += fz
        total[3] += lever[1, i] * fz - lever[2, i] * fy
        total[4] += lever[2, i] * fx - lever[0, i] * fz
        total[5] += lever[0, i] * fy - lever[1, i] * fx
    if rule.half:  # what the mirror half cancels
        total[1] = total[3] = total[5] = 0.0
    load += total
