"""Whether a wave's force is that on the hulls it is said to act on: in long waves another sign of time, reference for
the phase, heading, order of bodies, place or unit shows at once, and about which point moments are.
"""

from dataclasses import replace

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.bem.coefficients import DOFS, UNJUDGED
from solver.hydrodynamics.bem.exerted import Floats, Long, arrival_at, felt, in_long_waves, long_waves, passing
from solver.hydrodynamics.bem.given import KEY, Given, about
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.misfit import misfit

PLACED = 0.045  # of the hull's size: how far off the point of moments may seem to be,
BENT = 0.15  # and that of the largest's times (ka)², and √n of both, of n bodies
PANELLED = 0.025, 0.05  # of its size and BM: the same by a Froude-Krylov force, of a hull in four panels across
PLAIN = 0.17  # of that: as far off it may seem to be of right coefficients
THIN = 0.05  # of the largest force: along less nothing is told of the point
NOT_LONG = "no waves long against the hulls are among the frequencies: forces were not judged"
SAME_HULL = 0.1  # relative: heave stiffness, and the Froude-Krylov force where it is told


def agreed(six: Given, floats: Floats, expected: np.ndarray) -> tuple[Given, dict[str, str]]:
    """The coefficients about the floats' centres, one body's moved to where it fits better, and what to note of that;
    InputError on a misfit.

    expected (nw, 6 nb): Froude-Krylov force on the hulls.
    """
    _require_stiffness(six, floats)
    tries = [(about(six, floats.centres), "")]
    if len(floats.hulls) == 1:
        for x, y, _ in dict.fromkeys((tuple(floats.points[0]), tuple(floats.centres[0]))):
            moved = about(_moved(six, floats.sea, x, y), floats.centres)
            tries.append((moved, f"computed at x = y = 0, moved to ({x:g}, {y:g}) m"))
    each = [(in_long_waves(one, floats, expected), one, note) for one, note in tries]
    if not each[0][0].rows.any():
        return tries[0][0], {UNJUDGED: NOT_LONG}
    if bodies := _partly_told(six, expected):
        names = ", ".join(floats.names[b] for b in bodies)
        text = f"the file lacks motions of {names}, and with them what waves scatter there"
        return tries[0][0], {UNJUDGED: f"{text}: forces were not judged"}
    long, found, note = min(each, key=lambda of: _misplaced(of[0], of[1], floats, expected))
    if long.off > 1:
        raise InputError(KEY, six.name, misfit(tries[0][0], floats, expected))
    return found, {"note": note} if note else {}


def _partly_told(six: Given, expected: np.ndarray) -> list[int]:
    """Bodies without motions that a file has of others and waves push, or without any: (B - iωA)u lacks their part.

    A near one's may be as large as all of a force, far beyond what long waves leave open. Of bodies that all have heave
    alone the waves' push on a waterplane is much more than it.
    """
    there = six.added_mass.any(axis=(0, 1)).reshape(-1, 6)
    pushed = np.zeros(there.shape, bool)
    pushed.flat[felt(expected)] = True
    lacks = (pushed & ~there & there.any(axis=0)).any(axis=1) | ~there.any(axis=1)
    return [int(b) for b in np.flatnonzero(lacks)]


def _misplaced(long: Long, six: Given, floats: Floats, expected: np.ndarray) -> tuple[bool, float]:
    """Whether forces in long waves are others, and from how far off [m] they are, by the phase and by moments about
    points that a file tells."""
    k, both = floats.sea.wavenumbers(six.omega[long.rows]), (long.told * long.fits.conj())[:, felt(long.fits)]
    size = float(np.sum(k[:, None] * np.abs(both)))
    away = float(np.sum(np.abs(both.imag))) / size if size else 0.0
    if six.points is not None:
        away += max(float(np.linalg.norm(d)) for d, _ in _places(six, floats, expected))
    return long.off > 1, away


def _moved(six: Given, sea: Sea, x: float, y: float) -> Given:
    """Coefficients of one body computed at x = y = 0, elsewhere: the wave comes later, and nothing else changes."""
    incident, points, later = six.froude_krylov, six.points, arrival_at(six, sea, np.array([[x, y, 0.0]]))
    return replace(
        six,
        excitation=six.excitation * later,
        froude_krylov=None if incident is None else incident * later,
        points=None if points is None else np.add(points, (x, y, 0.0)),
    )


def require_moments(six: Given, floats: Floats, expected: np.ndarray) -> np.ndarray:
    """How far each point of moments (nb, 3) [m] may be from the one told; refused where right files show no such place.

    Long waves show it, of a file with the motions of all bodies, and a Froude-Krylov force, where it is told, better:
    that is held against the hull's, too.
    """
    doubt, told = np.zeros((len(floats.names), 3)), [_places(six, floats, expected)]
    if six.froude_krylov is not None:
        _require_incident(six, floats, expected)
        incident = six.froude_krylov[:, 0]
        told.append([_incident_place(incident, floats, expected, six.omega, b) for b in range(len(doubt))])
    for places in told:
        _require_near(six, floats, places)
    for b, (away, may) in enumerate(told[-1]):
        off = np.linalg.norm(away)
        doubt[b] = away * max(0.0, 1 - PLAIN * may / off) if off else 0.0
    return doubt


def _require_near(six: Given, floats: Floats, places: list[tuple[np.ndarray, float]]) -> None:
    """Refuse moments about points that are not the ones told."""
    for name, (away, may) in zip(floats.names, places, strict=True):
        if (off := float(np.linalg.norm(away))) > may:
            text = f"wave moments on {name} are as about a point {off:.2g} m or more from the one told"
            raise InputError(KEY, six.name, f"{text}; do moments refer to another point, or lengths have another unit?")


def _require_incident(six: Given, floats: Floats, expected: np.ndarray) -> None:
    """Refuse a Froude-Krylov force or moment that is not that on the hull, in long waves or else the longest."""
    assert six.froude_krylov is not None
    hulls, names, sea = floats.hulls, floats.names, floats.sea
    radius = np.array([h.largest_radius for h in hulls])
    long = long_waves(sea.wavenumbers(six.omega) * radius.max())
    long[0] |= not long.any()
    unit = np.where(np.arange(6) < 3, 1.0, radius[:, None])
    told, ours = (f[long].reshape(-1, len(hulls), 6) / unit for f in (six.froude_krylov[:, 0], expected))
    there = np.abs(told).max(axis=0) > 0  # a file may lack motions
    off = np.abs(told - ours).max(axis=0) / np.abs(ours).max(axis=(0, 2))[:, None] * there
    b, d = np.unravel_index(off.argmax(), off.shape)
    if off[b, d] > SAME_HULL:
        i, at = int(np.abs(told - ours)[:, b, d].argmax()), six.omega[long]
        text = f"Froude-Krylov {'force' if d < 3 else 'moment'} on {names[b]} in {DOFS[d]} at {at[i]:.4g} rad/s is"
        text += f" {abs(told[i, b, d] * unit[b, d]):.4g}, on its hull {abs(ours[i, b, d] * unit[b, d]):.4g}"
        asked = "another hull, or other units?"
        if d >= 3:
            asked = "do moments refer to another point, or is the body elsewhere in it?"
        raise InputError(KEY, six.name, f"{text}; {asked}")


def _places(six: Given, floats: Floats, expected: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """Of each body, see `_place`; none is off where what is scattered is not known."""
    if _partly_told(six, expected):
        return [(np.zeros(3), 0.0)] * len(floats.names)
    exerted = expected + passing(six, floats)
    return [_place(six, floats, expected, exerted, b) for b in range(len(floats.names))]


def _place(six: Given, floats: Floats, expected: np.ndarray, exerted: np.ndarray, b: int) -> tuple[np.ndarray, float]:
    """From where a body's wave moments are about to the point told (3,) [m], and how far that may be of right ones.

    With M̂ of what long waves exert, by A and B of the file, M - M̂ = d × F of the incident wave alone: another point
    shows in what the water passing exerts, too. Judged is the longest wave that pushes along enough to tell a height,
    of a body all of whose translations that waves push are told: what passes along these has moments as well.
    """
    six_of, k = slice(6 * b, 6 * b + 6), floats.sea.wavenumbers(six.omega)
    force, told = expected[:, six_of][:, :3], six.excitation[:, 0, six_of]
    rows = np.flatnonzero(long_waves(k * max(h.largest_radius for h in floats.hulls)))
    along = np.linalg.norm(force[:, :2], axis=1) > THIN * np.linalg.norm(force, axis=1)
    row = next((i for i in rows if along[i]), rows[-1] if len(rows) else 0)
    there = np.abs(told).max(axis=0) > 0  # a file may lack motions
    known = there[3:] & there[felt(expected[:, six_of])].all()
    place = _lever((told - exerted[:, six_of])[row, 3:], force[row], known, THIN)
    largest = max(h.size for h in floats.hulls)
    may = PLACED * floats.hulls[b].size + BENT * (k[row] * largest) ** 2 * largest
    return place, float(np.sqrt(len(floats.hulls)) * may)


def _incident_place(
    incident: np.ndarray, floats: Floats, expected: np.ndarray, omega: np.ndarray, b: int
) -> tuple[np.ndarray, float]:
    """The same by Froude-Krylov forces told (nw, 6 nb), which are the hull's but for the file's panels.

    Those have moments off by the hull's size and BM, I/V of its waterplane, and as much more as forces: BM by twice
    their share, for I goes with the square of the waterplane. Judged is the long wave that pushes along most.
    """
    hull, told, fits = floats.hulls[b], incident[:, 6 * b :][:, :6], expected[:, 6 * b :][:, :6]
    rows = np.flatnonzero(long_waves(floats.sea.wavenumbers(omega) * hull.largest_radius))
    row, there = rows[-1] if len(rows) else 0, np.abs(told).max(axis=0) > 0
    force, away = fits[row, :3], there * (told - fits)[row]
    S, Sx, Sy, Sxx, _, Syy = hull.waterplane
    metacentric = max(Sxx - Sx**2 / S, Syy - Sy**2 / S) / hull.volume if S > 0 else 0.0
    off = np.linalg.norm(away[:3]) / np.linalg.norm(force)
    may = (PANELLED[0] + off) * hull.size + (PANELLED[1] + 2 * off) * metacentric
    return _lever(away[3:], force, there[3:], THIN**2), float(may)


def _lever(moment: np.ndarray, force: np.ndarray, there: np.ndarray, thin: float) -> np.ndarray:
    """d (3,) [m] of a moment d × F (3,) in least squares of those that are `there`; none along forces that are thin."""
    cross = np.cross(np.eye(3), force).T[there]  # d × F = (e_i × F) d_i
    matrix, sides = (np.concatenate([part.real, part.imag]) for part in (cross, moment[there]))
    return np.linalg.lstsq(matrix, sides, rcond=thin)[0] if there.any() else np.zeros(3)


def _require_stiffness(six: Given, floats: Floats) -> None:
    """Refuse a heave stiffness that is another hull's."""
    if six.stiffness is None:
        return
    for b, (hull, name) in enumerate(zip(floats.hulls, floats.names, strict=True)):
        told = six.stiffness[6 * b + 2, 6 * b + 2]
        ours = floats.sea.density * floats.sea.gravity * hull.waterplane[0]
        if told and abs(told - ours) > SAME_HULL * max(abs(ours), abs(told)):
            text = f"heave stiffness of {name} is {told:.4g} N/m, that of its hull {ours:.4g} N/m"
            raise InputError(KEY, six.name, f"{text}: another hull, another order of bodies, or other units?")
