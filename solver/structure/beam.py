"""One straight beam element in local axes, the M_s and K_s of the paper's eq. 15: Euler-Bernoulli's or Timoshenko's.

Matrices as in Przemieniecki, Theory of Matrix Structural Analysis (1968): chapters 5 (stiffness), 11 (consistent
mass) and 15 (geometric stiffness); Timoshenko's mass as in Friedman and Kosmatka, Computers & Structures 47 (1993).

A section with a shear factor κ also shears: v' = ψ + V/κGA, with ψ the rotation of the section. Its element has
φ = 12EI/κGAL² in each plane, and shapes that solve the static equations between the nodes, so that static answers are
exact with any mesh. φ = 0 is Euler-Bernoulli's, whose sections stay normal to the axis.

Local x runs along the element; local y and z are the principal axes of the section. The 12
degrees of freedom are (u, v, w, θx, θy, θz) at s = 0 and again at s = 1: displacements [m] and
right-handed rotations [rad] of the section, so that in bending without shear θz = dv/dx and θy = -dw/dx. Rows of the
rotation matrix R are the local axes: local = R global.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from solver.structure.sections import Section

AXIAL, TORSION = [0, 6], [3, 9]
BENDING_XY, BENDING_XZ = [1, 5, 7, 11], [2, 4, 8, 10]
FLIP = np.outer([1, -1, 1, -1], [1, -1, 1, -1])  # θy = -dw/dx
VERTICAL = 1e-4  # sine of the angle to z below which a member counts as vertical
LOOSE = 1e-12  # of a scaled stiffness: nothing holds
GAUSS_2, GAUSS_3 = map(np.polynomial.legendre.leggauss, (2, 3))
Shear = Sequence[float] | np.ndarray  # φ in the planes xy and xz
NO_SHEAR = (0.0, 0.0)


def _from_planes(axial: ArrayLike, torsion: ArrayLike, xy: np.ndarray, xz: np.ndarray) -> np.ndarray:
    """12x12 of the four uncoupled motions; xy and xz are in (deflection, slope) pairs."""
    matrix = np.zeros((12, 12))
    matrix[np.ix_(AXIAL, AXIAL)] = axial
    matrix[np.ix_(TORSION, TORSION)] = torsion
    matrix[np.ix_(BENDING_XY, BENDING_XY)] = xy
    matrix[np.ix_(BENDING_XZ, BENDING_XZ)] = FLIP * xz
    return matrix


def shear_parameters(E: float, G: float, section: Section, L: float) -> tuple[float, float]:
    """φ = 12EI/κGAL² [-] in the planes xy and xz."""
    if section.shear_factor is None:
        return NO_SHEAR
    unit = 12 * E / (section.shear_factor * G * section.area * L**2)
    return unit * section.Iz, unit * section.Iy


def stiffness(E: float, G: float, section: Section, L: float) -> np.ndarray:
    """Element stiffness [N/m, N, N m], (12, 12): EA/L [1 -1; -1 1], GJ/L the same, and in each plane

    EI/L³(1+φ) [12 6L -12 6L; 6L (4+φ)L² -6L (2-φ)L²; -12 -6L 12 -6L; 6L (2-φ)L² -6L (4+φ)L²].
    """

    def bend(inertia: float, phi: float) -> np.ndarray:
        near, far = (4 + phi) * L**2, (2 - phi) * L**2
        rows = [
            [12, 6 * L, -12, 6 * L],
            [6 * L, near, -6 * L, far],
            [-12, -6 * L, 12, -6 * L],
            [6 * L, far, -6 * L, near],
        ]
        return inertia * (E * np.array(rows) / L**3) / (1 + phi)

    rod = np.array([[1, -1], [-1, 1]]) / L
    xy, xz = shear_parameters(E, G, section, L)
    return _from_planes(E * section.area * rod, G * section.J * rod, bend(section.Iz, xy), bend(section.Iy, xz))


def mass(density: float, section: Section, L: float, shear: Shear = NO_SHEAR) -> np.ndarray:
    """Consistent mass [kg, kg m, kg m2], (12, 12): ∫ρA NᵀN dx, and ρIp for torsion. In each plane, with φ = 0,

    ρAL/420 [156 22L 54 -13L; 22L 4L² 13L -3L²; 54 13L 156 -22L; -13L -3L² -22L 4L²].

    A section with a shear factor has rotary inertia ρI ψ̇² across its axis, too; without one it is left out, as
    Euler-Bernoulli theory does.
    """
    rod = np.array([[2, 1], [1, 2]]) * L / 6
    xy, xz = (_transverse_mass(density * section.area, L, phi) for phi in shear)
    if section.shear_factor is not None:
        xy = xy + _rotary_mass(density * section.Iz, L, shear[0])
        xz = xz + _rotary_mass(density * section.Iy, L, shear[1])
    return _from_planes(density * section.area * rod, density * section.Ip * rod, xy, xz)


def _transverse_mass(per_length: float, L: float, phi: float) -> np.ndarray:
    """m ∫ NᵀN dx (4, 4) of the deflection, m [kg/m]."""
    a, b = 156 + 294 * phi + 140 * phi**2, 54 + 126 * phi + 70 * phi**2
    c, d = (22 + 38.5 * phi + 17.5 * phi**2) * L, (13 + 31.5 * phi + 17.5 * phi**2) * L
    e, f = (4 + 7 * phi + 3.5 * phi**2) * L**2, (3 + 7 * phi + 3.5 * phi**2) * L**2
    rows = np.array([[a, c, b, -d], [c, e, d, -f], [b, d, a, -c], [-d, -f, -c, e]])
    return per_length * L / 420 * rows / (1 + phi) ** 2


def _rotary_mass(per_length: float, L: float, phi: float) -> np.ndarray:
    """j ∫ RᵀR dx (4, 4) of the section's rotation, j = ρI [kg m]."""
    a, b = 36.0, (3 - 15 * phi) * L
    c, d = (4 + 5 * phi + 10 * phi**2) * L**2, (1 + 5 * phi - 5 * phi**2) * L**2
    rows = np.array([[a, b, -a, b], [b, c, -b, -d], [-a, -b, a, -b], [b, -d, -b, c]])
    return per_length / (30 * L) * rows / (1 + phi) ** 2


def condensation(K: np.ndarray, released: ArrayLike, springs: np.ndarray) -> np.ndarray:
    """C (12, 12): end displacements d = C dₙ of those of the nodes, released ones (12,) following on springs (12,).

    (K_rr + k) d_r = k d_rn - K_rm d_m (static condensation, Guyan 1965), k = 0 of those that nothing ties to their
    node: CᵀMC and Cᵀf are what the nodes see, and CᵀKC with what the springs add, see condensed_stiffness. Raises
    LinAlgError where what is left does not hold the released ones.
    """
    r, m = np.flatnonzero(released), np.flatnonzero(~np.asarray(released))
    C = np.diag(np.where(released, 0.0, 1.0))
    held = K[np.ix_(r, r)] + np.diag(springs[r])
    size = 1 / np.sqrt(np.diag(held))
    scaled = size[:, None] * held * size
    if r.size and np.linalg.eigvalsh(scaled)[0] < LOOSE:
        raise np.linalg.LinAlgError
    C[np.ix_(r, m)] = -size[:, None] * np.linalg.solve(scaled, size[:, None] * K[np.ix_(r, m)])
    C[np.ix_(r, r)] = size[:, None] * np.linalg.solve(scaled, size[:, None] * np.diag(springs[r]))
    return C


def condensed_stiffness(K: np.ndarray, C: np.ndarray, springs: np.ndarray) -> np.ndarray:
    """CᵀKC + (1 - C)ᵀ k (1 - C) (12, 12) of an element and its springs k (12,), seen from its nodes."""
    apart = np.eye(12) - C
    return C.T @ K @ C + apart.T @ (springs[:, None] * apart)


def geometric_stiffness(N: Sequence[float], L: float, shear: Shear = NO_SHEAR) -> np.ndarray:
    """Consistent geometric stiffness [N/m, N, N m], (12, 12): twice the work ½∫N v'² dx, tension N > 0, as N (2,) goes
    evenly from one end to the other. Of one all along and φ = 0 it is

    N/30L [36 3L -36 3L; 3L 4L² -3L -L²; -36 -3L 36 -3L; 3L -L² -3L 4L²] in each plane.

    Bending only: the twist of a compressed bar (N Ip/A) does not govern tubes and solid sections.
    """
    stations, weights = (GAUSS_3[0] + 1) / 2, GAUSS_3[1] / 2

    def bend(phi: float) -> np.ndarray:
        slopes = np.array([_slope(s, L, phi) for s in stations])
        return L * (slopes.T * weights * (N[0] + (N[1] - N[0]) * stations)) @ slopes

    return _from_planes(0, 0, bend(shear[0]), bend(shear[1]))


def rotation(start: ArrayLike, end: ArrayLike) -> np.ndarray:
    """R (3, 3) of a member from `start` to `end` (3,) [m], rows = local axes: x along it, y horizontal, z upwards.

    A vertical member keeps y along global y, or rounding would choose which way a rectangle's width points.
    """
    x = np.subtract(end, start)
    x = x / np.linalg.norm(x)
    y = np.cross([0.0, 0.0, 1.0], x)
    if np.linalg.norm(y) < VERTICAL:
        y = np.array([0.0, 1.0, 0.0]) - x[1] * x
    y /= np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


def to_global(R: np.ndarray) -> np.ndarray:
    """T (12, 12): local degrees of freedom = T global ones."""
    return np.kron(np.eye(4), R)


def _deflection(s: float, L: float, phi: float) -> np.ndarray:
    """Shape functions of (v1, ψ1, v2, ψ2) at station s: Hermite's cubics where φ = 0."""
    first = [1 - 3 * s**2 + 2 * s**3 + phi * (1 - s), L * (s - 2 * s**2 + s**3 + phi / 2 * (s - s**2))]
    second = [3 * s**2 - 2 * s**3 + phi * s, L * (s**3 - s**2 - phi / 2 * (s - s**2))]
    return np.array(first + second) / (1 + phi)


def _slope(s: float, L: float, phi: float) -> np.ndarray:
    """Its derivative along x (4,) [1/m, -]."""
    first = [(6 * (s**2 - s) - phi) / L, 1 - 4 * s + 3 * s**2 + phi * (0.5 - s)]
    second = [-first[0], 3 * s**2 - 2 * s - phi * (0.5 - s)]
    return np.array(first + second) / (1 + phi)


def _turn(s: float, L: float, phi: float) -> np.ndarray:
    """Rotation ψ of the section (4,) [1/m, -]; where φ = 0 the deflection's derivative along x."""
    first = [6 * (s**2 - s) / L, 1 - 4 * s + 3 * s**2 + phi * (1 - s)]
    second = [6 * (s - s**2) / L, 3 * s**2 - 2 * s + phi * s]
    return np.array(first + second) / (1 + phi)


def displacement_shape(s: float, L: float, shear: Shear = NO_SHEAR) -> np.ndarray:
    """N (3, 12): local displacement (u, v, w) at station s in [0, 1]; u linear, v and w cubic."""
    N = np.zeros((3, 12))
    N[0, AXIAL] = 1 - s, s
    N[1, BENDING_XY] = _deflection(s, L, shear[0])
    N[2, BENDING_XZ] = FLIP[0] * _deflection(s, L, shear[1])
    return N


def rotation_shape(s: float, L: float, shear: Shear = NO_SHEAR) -> np.ndarray:
    """(3, 12): local rotation of the section at s in [0, 1]; θx linear; without shear θy = -dw/dx, θz = dv/dx."""
    N = np.zeros((3, 12))
    N[0, TORSION] = 1 - s, s
    N[1, BENDING_XZ] = -FLIP[0] * _turn(s, L, shear[1])
    N[2, BENDING_XY] = _turn(s, L, shear[0])
    return N


def in_global(shape: np.ndarray, T: np.ndarray) -> np.ndarray:
    """A (3, 12) shape matrix turned to global axes on both sides: Rᵀ N T, of an element's T (12, 12)."""
    return T[:3, :3].T @ shape @ T


def distributed_load(
    q: np.ndarray, L: float, span: tuple[float, float] = (0.0, 1.0), shear: Shear = NO_SHEAR
) -> np.ndarray:
    """Consistent nodal load [N, N m], (12,), of a uniform q (3,) [N/m], local axes, over a span.

    f = ∫ Nᵀ q L ds: two Gauss points integrate the cubics exactly.
    """
    s0, s1 = span
    stations = s0 + (s1 - s0) * (GAUSS_2[0] + 1) / 2
    weights = GAUSS_2[1] * (s1 - s0) * L / 2
    return sum(weight * displacement_shape(s, L, shear).T @ q for s, weight in zip(stations, weights, strict=True))
