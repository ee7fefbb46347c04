"""Points on the wetted part of a hull of revolution: where pressure is summed."""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.hull.revolution import Revolution
from solver.kernels import kernel
from solver.sea.field import MOST_TERMS

LINE, ARC = 2.0, 4.0  # of 1/k of the mean wave: no line or arc that a rule's points are put on is longer
RADIUS = 2.0  # so many 1/k: of wider hulls more azimuths are summed, as many times as they are wider


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


def quadrature(
    hull: Revolution, *, azimuths: int, arc_points: int, line_points: int, half: bool, mean_length: float
) -> WettedQuadrature:
    """Rule with `azimuths` on the full circle; half = ψ in (0, π), rounded up, for a hull that stays in its plane.

    mean_length: 1/k of the mean wave [m]; `arc_points` and `line_points` are those of pieces that are short beside it.
    """
    rows = []
    for segment in hull.meridian:
        longest = mean_length * (LINE if segment.centre is None else ARC)
        pieces = max(1, int(np.ceil(segment.length / longest - 1e-9)))
        if segment.centre is None:
            for (r0, z0), (r1, z1) in pairwise(np.linspace(segment.start, segment.end, pieces + 1)):
                rd, zd = (r1 - r0) / 2, (z1 - z0) / 2
                n_r, n_z = np.array([zd, -rd]) / np.hypot(rd, zd)
                rows.append((0, (r0 + r1) / 2, rd, (z0 + z1) / 2, zd, n_r, n_z))
            continue
        start, end = segment.angles
        # u -> φ by t = tan is nearly linear only for short arcs: at most a right angle each.
        pieces = max(pieces, int(np.ceil((end - start) / (np.pi / 2) - 1e-9)))
        cuts = np.linspace(start, end, pieces + 1)
        for a, b in zip(cuts[:-1], cuts[1:], strict=True):
            mid = (a + b) / 2
            rows.append((1, segment.centre, segment.radius, np.sin(mid), np.cos(mid), np.tan((b - a) / 4), 0))
    span = np.pi if half else 2 * np.pi
    count = -(-azimuths // 2) if half else azimuths
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


def azimuths_for(hulls: Iterable[Revolution], usual: int, mean_length: float) -> int:
    """Azimuths (full circle) that all hulls have, `usual` of those that are narrow beside 1/k of the mean wave [m]."""
    widest = max((hull.largest_radius for hull in hulls), default=0.0)
    return math.ceil(usual * max(1.0, widest / (RADIUS * mean_length)) - 1e-9)


def _whole(
    patch: np.ndarray, arc: tuple[np.ndarray, np.ndarray], line: tuple[np.ndarray, np.ndarray], dpsi: float
) -> np.ndarray:
    table = np.zeros((len(patch), max(len(arc[0]), len(line[0])), 5))
    for row, points in zip(patch, table, strict=True):
        for point, u, w in zip(points, *(line if row[0] == 0 else arc), strict=False):
            r, z, n_r, n_z, speed = meridian_at(row, u)
            point[:] = r, z, n_r, n_z, w * speed * r * dpsi
    return table


@kernel(inline="always")
def meridian_at(patch: np.ndarray, u: float) -> tuple[float, float, float, float, float]:
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
