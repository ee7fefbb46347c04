"""The force that waves long against hulls exert on them.

The scattered wave's force is then that of the water passing a hull as if this moved the other way, (B - iωA)u with a
file's own A and B: much more than the Froude-Krylov force on a heave plate, and against it. The whole is the sum of
both, but for what goes with the square of hull over wavelength; what one body scatters to another, which takes of its
waves as of water passing evenly, but for what goes with hull over wavelength.
"""

from typing import NamedTuple

import numpy as np

from solver.hydrodynamics.bem import incident
from solver.hydrodynamics.bem.coefficients import DOFS
from solver.hydrodynamics.bem.given import Given
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import froude_krylov, unit_motions
from solver.hydrodynamics.hull.mesh import Hull

LONG = 0.5  # ka of waves that are long; up to twice that where there are no longer ones
FELT = 0.02  # of the largest force on a body: of less the phase is not judged
NEAR = 0.1  # of the force of long waves: how far off that told may be,
NEARLY = 0.5  # and √n of it times (ka)² of it or of its parts, of n bodies; ka besides of what others scatter
PISTON = 0.7  # of the frequency of water in a well, (g/draft)^½: slower waves do not make it swing
STILL = 1e-6  # of the largest motion through the hull's surface: less is none


class Floats(NamedTuple):
    """What the coefficients are said to be of."""

    hulls: tuple[Hull, ...]
    centres: np.ndarray  # (nb, 3) [m] where diffraction and radiation are loads
    points: np.ndarray  # (nb, 3) [m] the floats' own reference points
    names: tuple[str, ...]
    sea: Sea


class Long(NamedTuple):
    """What a file tells in long waves, beside what these exert on the hulls."""

    rows: np.ndarray  # (nw,) of which frequencies
    told: np.ndarray  # (nr, 6 nb) force [N/m]
    fits: np.ndarray  # the same as it should be
    off: float  # how far it is from that, over how far it may be; 0 where no waves are long
    where: tuple[int, int]  # and where most: row, column


def in_long_waves(six: Given, floats: Floats, expected: np.ndarray | None = None) -> Long:
    """Of six columns for each float, and one heading; expected (nw, 6 nb): Froude-Krylov force on the hulls."""
    k = floats.sea.wavenumbers(six.omega)
    rows = long_waves(k * max(h.largest_radius for h in floats.hulls))
    if expected is None:
        expected = froude_krylov(floats.hulls, floats.centres, DOFS, floats.sea, six.omega)
    each = _scattered(six, floats)[rows]
    told, fits = six.excitation[rows, 0], expected[rows] + each.sum(axis=2)
    swinging = _swinging(six.omega[rows], floats)
    off, where = _off(told, fits, each, k[rows], swinging, floats) if rows.any() else (0.0, (0, 0))
    return Long(rows, told, fits, off, where)


def passing(six: Given, floats: Floats) -> np.ndarray:
    """(B - iωA)u (nw, 6 nb), u the hulls' motions that go through their wetted surfaces most as the water does."""
    return _scattered(six, floats).sum(axis=2)


def arrival(six: Given, floats: Floats) -> np.ndarray:
    """The wave at the place of each column's float (nw, 1, 6 nb), over that at x = y = 0: it comes later there."""
    return arrival_at(six, floats.sea, floats.points)


def arrival_at(six: Given, sea: Sea, places: np.ndarray) -> np.ndarray:
    """The same at places (nb, 3) [m] of bodies."""
    return incident.arrival(sea.wavenumbers(six.omega), sea.heading, places, 6)[:, None]


def _scattered(six: Given, floats: Floats) -> np.ndarray:
    """The same by the body that the water passes (nw, 6 nb, nb)."""
    u = np.zeros((len(six.omega), 6 * len(floats.hulls)), complex)
    for b, (hull, centre) in enumerate(zip(floats.hulls, floats.centres, strict=True)):
        points, areas = hull.surface_points()
        normals = areas / np.sqrt(np.linalg.norm(areas, axis=1, keepdims=True))  # n √dS
        motions = unit_motions(points, normals, np.zeros(len(points), int), np.zeros((1, 3)), DOFS)
        flow = [np.sum(normals * floats.sea.wave(points + centre, w)[1], axis=1) for w in six.omega]
        u[:, 6 * b : 6 * b + 6] = flow @ np.linalg.pinv(motions, rcond=STILL).T
    Z = six.radiation_damping - 1j * six.omega[:, None, None] * six.added_mass
    return (Z * u[:, None]).reshape(*u.shape, -1, 6).sum(axis=3)


def _swinging(omega: np.ndarray, floats: Floats) -> np.ndarray:
    """Where water in a body's well may swing, and do to its heave what long waves do not tell (nw, nb)."""
    piston = [np.sqrt(floats.sea.gravity / h.draft) if h.waterplane_width < np.inf else np.inf for h in floats.hulls]
    return omega[:, None] > PISTON * np.array(piston)


def long_waves(ka: np.ndarray) -> np.ndarray:
    """Which frequencies are judged: the three longest waves at most in number beyond LONG."""
    some = ka <= LONG
    if some.sum() < 3:
        some = ka <= min(2 * LONG, np.sort(ka)[min(2, len(ka) - 1)])
    return some


def felt(expected: np.ndarray) -> np.ndarray:
    """Translations (nc,) whose Froude-Krylov force counts on their body."""
    size = np.abs(expected).max(axis=0).reshape(-1, 6)[:, :3]
    b, d = np.nonzero(size > FELT * size.max(axis=1, keepdims=True))
    return 6 * b + d


def _off(
    told: np.ndarray, fits: np.ndarray, each: np.ndarray, k: np.ndarray, swinging: np.ndarray, floats: Floats
) -> tuple[float, tuple[int, int]]:
    """How far a force (nw, 6 nb) is from that of long waves, over how far it may be, and where most: row, column.

    The largest body counts, how many there are, and what the others scatter, of each (nw, 6 nb, nb). Forces that are
    small on their body are judged beside the others in plan, or all: a turn makes one of another. Where a force is
    small because its parts cancel, as the heave on a spar with a plate at some frequency, what goes with (ka)² is of
    these. swinging (nw, nb): where heave is not judged.
    """
    nb = len(floats.hulls)
    ka = k[:, None, None] * max(h.size for h in floats.hulls)
    incident = fits - each.sum(axis=2)
    away, size, part = (np.abs(x).reshape(len(k), nb, 6)[..., :3] for x in (told - fits, fits, incident))
    others = np.einsum("wbij,bj->wbi", np.abs(each).reshape(len(k), nb, 6, nb), 1 - np.eye(nb))[..., :3]
    largest, level = size.max(axis=2, keepdims=True), np.linalg.norm(size[..., :2], axis=2, keepdims=True)
    size = np.where(size > FELT * largest, size, np.concatenate([level, level, largest], axis=2))
    judged = (size > FELT * largest) & (np.abs(told).max(axis=0).reshape(1, -1, 6)[..., :3] > 0)
    may = NEAR * size + NEARLY * np.sqrt(nb) * ka**2 * np.maximum(size, part) + ka * others
    judged[..., 2] &= ~swinging
    off = np.where(judged, away / np.where(judged, may, 1.0), 0.0)
    row, b, d = np.unravel_index(off.argmax(), off.shape)
    return float(off[row, b, d]), (int(row), int(6 * b + d))
