"""Body-nonlinear hydrostatic and Froude-Krylov load on a panel mesh: the paper's way, eqs. 9-11.

Any closed hull, cut panel by panel at the instantaneous waterline. The hydrostatic part is exact
on the polyhedron, the wave's pressure is that of all components summed at the centroid of each
panel's wetted part: second order in the panel size. The slow twin of `froude_krylov`.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from solver.errors import InputError
from solver.hydrodynamics.hull.revolution import Revolution, polygon_radius
from solver.kernels import fast_kernel, kernel


class Mesh(NamedTuple):
    """vertices (nv, 3) [m] from the reference point at rest; faces (nf, 4), counter-clockwise from the water.

    A triangle repeats its last vertex.
    """

    vertices: np.ndarray
    faces: np.ndarray


class Waves(NamedTuple):
    """Components at one instant: η(x, y) = Re Σ aᵢ exp(i kᵢ s), s along `direction` (2,).

    k (n,) [1/m]; a (2, n) real and imaginary parts [m], the turning exp(-iωt) and any ramp included;
    share (2, n) of e^(kz) and e^(-kz) in cosh k(z+h)/cosh kh; depth [m].
    """

    k: np.ndarray
    a: np.ndarray
    share: np.ndarray
    direction: np.ndarray
    depth: float


def waves_at(
    k: ArrayLike, omega: ArrayLike, amplitude: ArrayLike, *, depth: float, heading: float, t: float, factor: float = 1.0
) -> Waves:
    """Components of complex amplitude (n,) [m] at time t [s], times a ramp's factor."""
    direction, k = np.array([np.cos(heading), np.sin(heading)]), np.array(k, float)
    turned = np.asarray(amplitude, complex) * np.exp(-1j * np.asarray(omega) * t) * factor
    image = np.exp(-2 * k * depth)
    share = np.stack([1 / (1 + image), image / (1 + image)])
    return Waves(k, np.stack([turned.real, turned.imag]), share, direction, float(depth))


def calm(direction: ArrayLike = (1.0, 0.0), depth: float = np.inf) -> Waves:
    """Still water."""
    return Waves(np.zeros(0), np.zeros((2, 0)), np.zeros((2, 0)), np.array(direction, float), float(depth))


@lru_cache(maxsize=8)
def revolution_mesh(hull: Revolution, *, along: int, around: int) -> Mesh:
    """`along` x `around` panels on the whole hull, above water too; the Buan float has 71 x 120 = 8,520.

    Each segment of the meridian gets its share by length. Vertices are pushed outwards, horizontally
    until the waterplane's area is exact, then vertically until the volumes below and above still
    water are: a mesh inscribed in the hull would float too deep.
    """
    lengths = np.array([s.length for s in hull.meridian])
    if along < len(lengths) or around < 3:
        raise InputError("panels", f"{along} x {around}", f"needs at least {len(lengths)} x 3 on this hull")
    counts = np.maximum(1, np.floor(along * lengths / lengths.sum())).astype(int)
    while counts.sum() != along:
        step = 1 if counts.sum() < along else -1
        size = np.where(counts + step > 0, lengths / (counts + (step > 0)), np.inf)
        counts[np.argmax(size) if step > 0 else np.argmin(size)] += step
    parts = [s.at(np.arange(n) / n) for s, n in zip(hull.meridian, counts, strict=True)]
    r, z = np.concatenate([*parts, [hull.meridian[-1].end]]).T
    psi = 2 * np.pi * np.arange(around) / around
    r = r * polygon_radius(around)
    vertices = np.stack([np.outer(r, np.cos(psi)), np.outer(r, np.sin(psi)), np.outer(z, np.ones(around))], -1)
    low = np.arange(along * around).reshape(along, around)
    high = low + around
    faces = np.stack([low, np.roll(low, -1, axis=1), np.roll(high, -1, axis=1), high], axis=-1)
    return _stretched(_merged(Mesh(vertices.reshape(-1, 3), faces.reshape(-1, 4))), hull)


def _stretched(mesh: Mesh, hull: Revolution) -> Mesh:
    """The mesh with heights scaled, apart below and above z = 0, to the hull's volumes."""
    volume(mesh)  # closed?
    whole = sum(s.moment(0) for s in hull.meridian)
    for _ in range(4):  # once is exact where a ring of vertices lies at z = 0
        load = np.zeros(6)
        panel_load(np.zeros(3), np.eye(3), mesh, calm(), 1.0, False, load)
        scale = np.where(
            mesh.vertices[:, 2] < 0, hull.volume / load[2], (whole - hull.volume) / (_enclosed(mesh) - load[2])
        )
        mesh = Mesh(mesh.vertices * np.column_stack([scale**0, scale**0, scale]), mesh.faces)
    return mesh


def _merged(mesh: Mesh) -> Mesh:
    """The same surface with the coinciding vertices of the poles made one, and triangles there."""
    keys = np.round(mesh.vertices / (1e-9 * np.abs(mesh.vertices).max())).astype(np.int64)
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = place.reshape(-1)[mesh.faces]
    for i, face in enumerate(faces):
        corners = [v for n, v in enumerate(face) if v != face[n - 1]]
        faces[i] = corners + corners[-1:] * (4 - len(corners))
    return Mesh(mesh.vertices[first], faces)


def volume(mesh: Mesh) -> float:
    """Volume inside [m³]; raises InputError for a mesh that is open or inside out."""
    edges = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = edges[edges[:, 0] != edges[:, 1]]
    once, back = (set(map(tuple, e)) for e in (edges, edges[:, ::-1]))
    if len(once) < len(edges) or once != back:
        raise InputError("mesh", f"{len(once ^ back)} open or doubled edges", "must be closed and of one winding")
    total = _enclosed(mesh)
    if not total > 0:
        raise InputError("mesh", f"volume {total:g} m3", "must be > 0: normals point out of the body")
    return total


def _enclosed(mesh: Mesh) -> float:
    a, b, c, d = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float(np.sum(a * np.cross(b, c)) + np.sum(a * np.cross(c, d))) / 6


def half(mesh: Mesh) -> Mesh | None:
    """The faces on the side y > 0 of a mesh that no face of which crosses y = 0; None if one does.

    Of a hull and waves symmetric in y = 0 it bears half of surge, heave and pitch.
    """
    y = mesh.vertices[mesh.faces, 1]
    near = 1e-9 * np.abs(mesh.vertices).max()
    if np.any((y.min(axis=1) < -near) & (y.max(axis=1) > near)):
        return None
    used, faces = np.unique(mesh.faces[y.max(axis=1) > near], return_inverse=True)
    return Mesh(mesh.vertices[used], np.ascontiguousarray(faces.reshape(-1, 4)))


# Sines and exponentials without branches or calls, so that the sum over components runs four wide: as
# accurate as the library's to 1e-14 of the sum of amplitudes, and several times faster.
@fast_kernel
def _cosine_sine(x: float) -> tuple[float, float]:
    """cos x, sin x: a quarter of x mod 2π by Taylor's series, its angle doubled twice."""
    r = (x - 2 * np.pi * np.floor(x * (0.5 / np.pi) + 0.5)) / 4
    q = r * r
    s = 1 - q / 110 * (1 - q / 156 * (1 - q / 210))
    s = r * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * s))))
    c = 1 - q / 132 * (1 - q / 182 * (1 - q / 240))
    c = 1 - q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90 * c))))
    s, c = 2 * s * c, c * c - s * s
    return c * c - s * s, 2 * s * c


@fast_kernel
def _exponential(x: float) -> float:
    """exp x for x < 64, and at least e^-64: a 64th of x by Taylor's series, squared six times."""
    x = max(x, -64.0) / 64
    p = 1 + x / 8 * (1 + x / 9 * (1 + x / 10 * (1 + x / 11 * (1 + x / 12))))
    p = 1 + x * (1 + x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7 * p))))))
    p *= p
    p *= p
    p *= p
    p *= p
    p *= p
    return p * p


@fast_kernel
def _elevation(waves: Waves, s: float) -> float:
    total, k, real, imag = 0.0, waves.k, waves.a[0], waves.a[1]
    for i in range(k.size):
        c, d = _cosine_sine(k[i] * s)
        total += real[i] * c - imag[i] * d
    return total


@fast_kernel
def _head(waves: Waves, s: float, z: float) -> float:
    """Dynamic head p/ρg [m] of all components: Re Σ a cosh k(z+h)/cosh kh exp(iks), eq. 11."""
    total, k, real, imag, share, image = 0.0, waves.k, waves.a[0], waves.a[1], waves.share[0], waves.share[1]
    for i in range(k.size):
        c, d = _cosine_sine(k[i] * s)
        rise = _exponential(k[i] * z)
        total += (share[i] * rise + image[i] / rise) * (real[i] * c - imag[i] * d)
    return total


@kernel
def _clip(corners: np.ndarray, height: np.ndarray, polygon: np.ndarray) -> int:
    """The part of a face (4, 3) whose heights (4,) above the surface are below 0; number of its corners."""
    count = 0
    for i in range(4):
        j = (i + 1) % 4
        if height[i] < 0:
            polygon[count] = corners[i]
            count += 1
        if (height[i] < 0) != (height[j] < 0):
            share = height[i] / (height[i] - height[j])
            polygon[count] = corners[i] + share * (corners[j] - corners[i])
            count += 1
    return count


@kernel
def _add_force(point: np.ndarray, origin: np.ndarray, fx: float, fy: float, fz: float, load: np.ndarray) -> None:
    x, y, z = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    load[0] += fx
    load[1] += fy
    load[2] += fz
    load[3] += y * fz - z * fy
    load[4] += z * fx - x * fz
    load[5] += x * fy - y * fx


@kernel
def _hydrostatic(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, origin: np.ndarray, rho_g: float, area: np.ndarray, load: np.ndarray
) -> None:
    """-∫ p n dS, p = -ρgz, on a triangle of outward area (3,): edge midpoints are exact for z times lever."""
    middle = np.empty(3)
    for e in range(3):
        p, q = (a, b) if e == 0 else (b, c) if e == 1 else (c, a)
        for r in range(3):
            middle[r] = (p[r] + q[r]) / 2
        f = rho_g * middle[2] / 3
        _add_force(middle, origin, f * area[0], f * area[1], f * area[2], load)


@kernel
def _panel(
    polygon: np.ndarray, count: int, origin: np.ndarray, rho_g: float, waves: Waves, wheeler: bool, load: np.ndarray
) -> None:
    """Load of one wetted polygon: hydrostatic by triangles, the wave's head at the centroid."""
    total, centroid, size = np.zeros(3), np.zeros(3), 0.0
    area = np.empty(3)
    a = polygon[0]
    for n in range(1, count - 1):
        b, c = polygon[n], polygon[n + 1]
        for r in range(3):
            i, j = (r + 1) % 3, (r + 2) % 3
            area[r] = ((b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i])) / 2
        weight = np.sqrt(area[0] ** 2 + area[1] ** 2 + area[2] ** 2)
        if weight == 0:
            continue
        _hydrostatic(a, b, c, origin, rho_g, area, load)
        size += weight
        for r in range(3):
            total[r] += area[r]
            centroid[r] += weight * (a[r] + b[r] + c[r]) / 3
    if size == 0 or waves.k.size == 0:
        return
    centroid /= size
    s, z = centroid[0] * waves.direction[0] + centroid[1] * waves.direction[1], centroid[2]
    if wheeler:
        eta = _elevation(waves, s)
        z = (z - eta) / (1 + eta / waves.depth)
    p = rho_g * _head(waves, s, z)
    _add_force(centroid, origin, -p * total[0], -p * total[1], -p * total[2], load)


@kernel
def panel_load(
    position: np.ndarray, rotation: np.ndarray, mesh: Mesh, waves: Waves, rho_g: float, wheeler: bool, load: np.ndarray
) -> None:
    """Load (6,) [N, N m] about the reference point at `position` (3,), added to `load`.

    rotation (3, 3) of the body; pressure above still water as Airy's formula goes on, or wheeler:
    at the stretched height (z - η)/(1 + η/h).
    """
    points = mesh.vertices @ rotation.T + position
    height = np.empty(len(points))
    for v in range(len(points)):
        s = points[v, 0] * waves.direction[0] + points[v, 1] * waves.direction[1]
        height[v] = points[v, 2] - _elevation(waves, s)
    corners, level, polygon = np.empty((4, 3)), np.empty(4), np.empty((8, 3))
    for face in mesh.faces:
        for i in range(4):
            corners[i], level[i] = points[face[i]], height[face[i]]
        count = _clip(corners, level, polygon)
        if count > 2:
            _panel(polygon, count, position, rho_g, waves, wheeler, load)
