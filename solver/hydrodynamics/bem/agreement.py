"""Whether a wave's force is that on the hulls it is said to act on, and if not, under which convention it would be.

In waves long against a hull the scattered wave's force is that of the water passing it as if the hull moved the other
way, (B - iωA)u with the file's own A and B: much more than the Froude-Krylov force on a heave plate, and against it.
The force told is therefore the sum of both, but for what goes with the square of hull over wavelength; another sign of
time, reference for the phase, heading, order of bodies, place or unit shows at once.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, permutations
from typing import NamedTuple

import numpy as np

from solver.errors import InputError
from solver.hydrodynamics.bem.coefficients import DOFS
from solver.hydrodynamics.bem.given import KEY, Given, turned
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import froude_krylov, unit_motions
from solver.hydrodynamics.hull.mesh import Hull

LONG = 0.5  # ka of waves that are long; up to twice that where there are no longer ones
FELT = 0.02  # of the largest force on a body: of less the phase is not judged
IN_PHASE = 0.5  # cosine of the phase, force-weighted: of less some convention is another
BETTER = 0.85  # of another convention that explains the difference
# Turning the waves round turns the Froude-Krylov force into its conjugate, so that the two cannot be told apart.
TIME = "is of the other sign of time, Re{X exp(+iωt)}, or of waves from the other side"
PLACED = 0.045  # of the hull's size: how far off the point of moments may seem to be,
BENT = 0.15  # and that of the largest's times (ka)², and √n of both, of n bodies
PANELLED = 0.025, 0.05  # of its size and BM: the same by a Froude-Krylov force, of a hull in four panels across
PLAIN = 0.17  # of that: as far off it may seem to be of right coefficients
NEAR = 0.1  # of the force of long waves: how far off that told may be,
BESIDE = 0.5  # see _near
NEARLY = 0.5  # and √n of it times (ka)², of n bodies
TURNS = 6  # rounds until angles agree with the added mass that they turn
THIN = 0.05  # of the largest force: along less nothing is told of the point
STILL = 1e-6  # of the largest motion through the hull's surface: less is none
SAME_HULL = 0.1  # relative: heave stiffness, and the Froude-Krylov force where it is told


class Floats(NamedTuple):
    """What the coefficients are said to be of."""

    hulls: tuple[Hull, ...]
    centres: np.ndarray  # (nb, 3) [m]
    names: tuple[str, ...]
    sea: Sea


def agreed(six: Given, floats: Floats, expected: np.ndarray) -> tuple[Given, str]:
    """The coefficients, moved to the float where they are one body's alone, and a note of it; InputError on a misfit.

    expected (nw, 6 nb): Froude-Krylov force on the hulls.
    """
    _require_stiffness(six, floats)
    exerted = expected + _passing(six, floats)
    k = floats.sea.wavenumbers(six.omega)
    long = long_waves(k * max(h.largest_radius for h in floats.hulls))
    if not long.any():
        return six, "no waves long against the hulls are among the frequencies: phases were not judged"
    told, fits = six.excitation[long, 0], exerted[long]
    columns = _felt(fits)
    off, where = _off(told, fits, k[long], floats)
    if off > 1:
        moved = _moved(six, floats, k)
        if len(floats.hulls) > 1 or _off(moved.excitation[long, 0], fits, k[long], floats)[0] > 1:
            other = _cosine(told, fits, columns) < IN_PHASE
            text = _misfit(six, floats, expected, long) if other else _turn(six, floats, expected, long)
            raise InputError(KEY, six.name, text or _unlike(six, told, fits, where, long, floats))
        x, y, _ = floats.centres[0]
        return moved, f"computed at x = y = 0, moved to ({x:g}, {y:g}) m"
    return six, ""


def _passing(six: Given, floats: Floats) -> np.ndarray:
    """(B - iωA)u (nw, 6 nb), u the hulls' motions that go through their wetted surfaces most as the water does."""
    u = np.zeros((len(six.omega), 6 * len(floats.hulls)), complex)
    for b, (hull, centre) in enumerate(zip(floats.hulls, floats.centres, strict=True)):
        points, areas = hull.surface_points()
        normals = areas / np.sqrt(np.linalg.norm(areas, axis=1, keepdims=True))  # n √dS
        motions = unit_motions(points, normals, np.zeros(len(points), int), np.zeros((1, 3)), DOFS)
        flow = [np.sum(normals * floats.sea.wave(points + centre, w)[1], axis=1) for w in six.omega]
        u[:, 6 * b : 6 * b + 6] = flow @ np.linalg.pinv(motions, rcond=STILL).T
    Z = six.radiation_damping - 1j * six.omega[:, None, None] * six.added_mass
    return np.einsum("wij,wj->wi", Z, u)


def _moved(six: Given, floats: Floats, k: np.ndarray) -> Given:
    """Coefficients of one body computed at x = y = 0, where it is: the wave comes later, and nothing else changes."""
    x, y, _ = floats.centres[0]
    arrival = np.exp(1j * k * (x * np.cos(floats.sea.heading) + y * np.sin(floats.sea.heading)))[:, None, None]
    incident, points = six.froude_krylov, six.points
    return replace(
        six,
        excitation=six.excitation * arrival,
        froude_krylov=None if incident is None else incident * arrival,
        points=None if points is None else np.add(points, (x, y, 0.0)),
    )


def long_waves(ka: np.ndarray) -> np.ndarray:
    """Which frequencies are judged: the three longest waves at most in number beyond LONG."""
    some = ka <= LONG
    if some.sum() < 3:
        some = ka <= min(2 * LONG, np.sort(ka)[min(2, len(ka) - 1)])
    return some


def _felt(expected: np.ndarray) -> np.ndarray:
    """Translations (nc,) whose Froude-Krylov force counts on their body."""
    size = np.abs(expected).max(axis=0).reshape(-1, 6)[:, :3]
    b, d = np.nonzero(size > FELT * size.max(axis=1, keepdims=True))
    return 6 * b + d


def _off(told: np.ndarray, fits: np.ndarray, k: np.ndarray, floats: Floats) -> tuple[float, tuple[int, int]]:
    """How far a force (nw, 6 nb) is from that of long waves, over how far it may be, and where most: row, column.

    The largest body counts, and how many there are: what they scatter reaches the others, and of two that are near each
    other each takes of the other's share. Forces that are small on their body are judged beside the others in plan, or
    all: a turn makes one of another.
    """
    hulls, centres, _, _ = floats
    ka = k * max(h.size for h in hulls)
    away, size = (np.abs(x).reshape(len(k), -1, 6)[..., :3] for x in (told - fits, fits))
    largest, level = size.max(axis=2, keepdims=True), np.linalg.norm(size[..., :2], axis=2, keepdims=True)
    size = np.where(size > FELT * largest, size, np.concatenate([level, level, largest], axis=2))
    judged = (size > FELT * largest) & (np.abs(told).max(axis=0).reshape(1, -1, 6)[..., :3] > 0)
    may = (1 + _near(hulls, centres)) * (NEAR + NEARLY * np.sqrt(len(hulls)) * ka**2)
    off = np.where(judged, away / np.where(judged, size, 1.0), 0.0) / may[:, None, None]
    row, b, d = np.unravel_index(off.argmax(), off.shape)
    return float(off[row, b, d]), (int(row), int(6 * b + d))


def _near(hulls: tuple[Hull, ...], centres: np.ndarray) -> bool:
    """Whether circles about two bodies, in plan, are nearer than BESIDE of the smaller one's radius, or cross."""
    pairs = combinations(zip(hulls, centres, strict=True), 2)
    apart = [np.linalg.norm((at - to)[:2]) - a.largest_radius - b.largest_radius for (a, at), (b, to) in pairs]
    radii = [min(a.largest_radius, b.largest_radius) for a, b in combinations(hulls, 2)]
    return any(gap < BESIDE * radius for gap, radius in zip(apart, radii, strict=True))


def _unlike(
    six: Given, told: np.ndarray, fits: np.ndarray, where: tuple[int, int], long: np.ndarray, floats: Floats
) -> str:
    """What a force is that no other convention explains."""
    column, largest = where[1], np.abs(fits[where[0], where[1] // 6 * 6 :][:3]).max()
    text = f"{DOFS[column % 6]} force on {floats.names[column // 6]} at {six.omega[long][where[0]]:.4g} rad/s"
    if abs(fits[where]) > FELT * largest:
        ratio = told[where] / fits[where]
        phase = abs(np.degrees(np.angle(ratio)))
        text += f" is {abs(ratio):.3g} times what long waves exert on its hull, {phase:.0f} degrees of phase from it"
    else:
        text += f" is {abs(told[where]):.3g} N/m, of long waves on its hull {abs(fits[where]):.3g}"
    asked = "other units of force, added mass or damping, a length scale other than 1 m"
    return f"{text}: {asked}, another place or axes, or one wave's force alone?"


def _turn(six: Given, floats: Floats, expected: np.ndarray, long: np.ndarray) -> str:
    """By which turns of each body's axes in plan a force would fit, in words; empty where by none.

    The angle of least squares is that of Σ X' × X over Σ X' · X, of forces X' told; X goes by turned A and B.
    """
    angles, k = np.zeros(len(floats.names)), floats.sea.wavenumbers(six.omega)[long]
    for _ in range(TURNS):
        told, fits = _on_axes(six, floats, expected, angles)
        x, y = (told[long, i::6].conj() for i in (0, 1))
        across = x * fits[long, 1::6] - y * fits[long, ::6]
        along = x * fits[long, ::6] + y * fits[long, 1::6]
        angles += np.arctan2(across.sum(axis=0).real, along.sum(axis=0).real)
    told, fits = _on_axes(six, floats, expected, angles)
    if _off(told[long], fits[long], k, floats)[0] > 1:
        return ""
    whole = (np.degrees(angles) + 180) % 360 - 180  # sums of several turns
    each = ", ".join(f"{round(angle)} of {name}" for angle, name in zip(whole, floats.names, strict=True))
    return f"wave force is on axes turned in plan, by degrees {each}: WAMIT's .out tells of them as PHIBODY"


def _on_axes(six: Given, floats: Floats, expected: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The force and that of long waves (nw, 6 nb), were a file's axes turned by these angles."""
    other = turned(six, angles)
    return other.excitation[:, 0], expected + _passing(other, floats)


def _cosine(told: np.ndarray, expected: np.ndarray, columns: np.ndarray) -> float:
    """Least over the columns of Re <expected, told>, of forces of length 1; 0 where nothing is told."""
    a, b = told[:, columns], expected[:, columns]
    inner = np.sum(b.conj() * a, axis=0).real
    size = np.linalg.norm(a, axis=0) * np.linalg.norm(b, axis=0)
    there = np.linalg.norm(a, axis=0) > 0
    return float(np.min(inner[there] / size[there], initial=1.0)) if there.any() else 0.0


def _misfit(six: Given, floats: Floats, expected: np.ndarray, long: np.ndarray) -> str:
    """Under which convention the force would fit."""
    told, fits = six.excitation[long, 0], (expected + _passing(six, floats))[long]
    names, columns = floats.names, _felt(fits)
    tries = [
        (
            _cosine(told.conj(), fits, columns),
            f"{TIME}; Re{{X exp(-iωt)}} is needed, and headings are directions that waves travel to",
        ),
        (_cosine(-told, fits, columns), "has the opposite sign"),
        (_cosine(1j * told, fits, columns), "is a quarter of a period off: phases refer to a crest at x = y = 0"),
        (_cosine(-1j * told, fits, columns), "is a quarter of a period off: phases refer to a crest at x = y = 0"),
    ]
    for order, text in _orders(names):
        other = _permuted(six, order)
        fit = (expected + _passing(other, floats))[long]
        tries.append((_cosine(other.excitation[long, 0], fit, _felt(fit)), text))
    best, text = max(tries, key=lambda scored: scored[0])
    if best >= BETTER:
        return f"wave force {text}"
    if text := _turn(six, floats, expected, long):
        return text
    if text := _units(six, floats):
        return text
    each = [_cosine(told, fits, np.array([c])) for c in columns]
    worst = int(columns[int(np.argmin(each))])
    text = f"wave force on {names[worst // 6]} in {DOFS[worst % 6]} is out of phase with what long waves exert on"
    return f"{text} its hull (cosine {min(each):.2f}); is it this hull, and where it was computed?"


def _units(six: Given, floats: Floats) -> str:
    """In which other units a file's numbers would fit, in words; empty where in none."""
    rho = floats.sea.density
    over = replace(six, added_mass=six.added_mass / rho, radiation_damping=six.radiation_damping / rho)
    tries = [
        (replace(six, omega=2 * np.pi * six.omega), "frequencies in Hz: rad/s are needed"),
        (over, "added mass and damping that were to be divided by density"),
    ]
    for other, text in tries:
        k = floats.sea.wavenumbers(other.omega)
        long = long_waves(k * max(h.largest_radius for h in floats.hulls))
        fits = froude_krylov(floats.hulls, floats.centres, DOFS, floats.sea, other.omega) + _passing(other, floats)
        if long.any() and _off(other.excitation[long, 0], fits[long], k[long], floats)[0] <= 1:
            return f"wave force is as of {text}"
    return ""


def _orders(names: Sequence[str]) -> Iterator[tuple[tuple[int, ...], str]]:
    """Other orders of few bodies, and how to say so."""
    if len(names) > 5:
        return
    for order in permutations(range(len(names))):
        if order != tuple(range(len(names))):
            yield order, f"is of the bodies in another order: {', '.join(names[b] for b in np.argsort(order))}"


def _permuted(six: Given, order: tuple[int, ...]) -> Given:
    """The force, added mass and damping with the bodies in this order."""
    columns = (6 * np.array(order)[:, None] + np.arange(6)).ravel()
    both = (slice(None), columns[:, None], columns)
    return replace(
        six,
        added_mass=six.added_mass[both],
        radiation_damping=six.radiation_damping[both],
        excitation=six.excitation[..., columns],
    )


def require_moments(six: Given, floats: Floats, expected: np.ndarray) -> np.ndarray:
    """How far each point of moments (nb, 3) [m] may be from the one told; refused where right files show no such place.

    A Froude-Krylov force, where it is told, is held against that on the hull and shows the point, else long waves do.
    """
    doubt = np.zeros((len(floats.names), 3))
    if six.froude_krylov is None:
        exerted = expected + _passing(six, floats)
        places = [_place(six, floats, expected, exerted, b) for b in range(len(doubt))]
    else:
        _require_incident(six, floats, expected)
        places = [_incident_place(six.froude_krylov[:, 0], floats, expected, six.omega, b) for b in range(len(doubt))]
    for b, (away, may) in enumerate(places):
        if (off := float(np.linalg.norm(away))) > may:
            text = f"wave moments on {floats.names[b]} are as about a point {off:.2g} m or more from the one told"
            raise InputError(KEY, six.name, f"{text}; do moments refer to another point, or lengths have another unit?")
        doubt[b] = away * max(0.0, 1 - PLAIN * may / off) if off else 0.0
    return doubt


def _require_incident(six: Given, floats: Floats, expected: np.ndarray) -> None:
    """Refuse a Froude-Krylov force or moment that is not that on the hull."""
    assert six.froude_krylov is not None
    hulls, _, names, sea = floats
    radius = np.array([h.largest_radius for h in hulls])
    long = long_waves(sea.wavenumbers(six.omega) * radius.max())
    unit = np.where(np.arange(6) < 3, 1.0, radius[:, None])
    told, ours = (f[long].reshape(-1, len(hulls), 6) / unit for f in (six.froude_krylov[:, 0], expected))
    there = np.abs(told).max(axis=0) > 0  # a file may lack motions
    off = np.abs(told - ours).max(axis=0) / np.abs(ours).max(axis=(0, 2))[:, None] * there
    b, d = np.unravel_index(off.argmax(), off.shape)
    if off[b, d] > SAME_HULL:
        i, at = int(np.abs(told - ours)[:, b, d].argmax()), six.omega[long]
        text = f"Froude-Krylov {'force' if d < 3 else 'moment'} on {names[b]} in {DOFS[d]} at {at[i]:.4g} rad/s is"
        text += f" {abs(told[i, b, d] * unit[b, d]):.4g}, on its hull {abs(ours[i, b, d] * unit[b, d]):.4g}"
        point = "; do moments refer to another point?" if d >= 3 else "; another hull, or other units?"
        raise InputError(KEY, six.name, text + point)


def _place(six: Given, floats: Floats, expected: np.ndarray, exerted: np.ndarray, b: int) -> tuple[np.ndarray, float]:
    """From where a body's wave moments are about to the point told (3,) [m], and how far that may be of right ones.

    With M̂ of what long waves exert, by A and B of the file, M - M̂ = d × F of the incident wave alone: another point
    shows in what the water passing exerts, too. Judged is the longest wave that pushes along enough to tell a height.
    """
    six_of, k = slice(6 * b, 6 * b + 6), floats.sea.wavenumbers(six.omega)
    force, told = expected[:, six_of][:, :3], six.excitation[:, 0, six_of]
    rows = np.flatnonzero(long_waves(k * max(h.largest_radius for h in floats.hulls)))
    along = np.linalg.norm(force[:, :2], axis=1) > THIN * np.linalg.norm(force, axis=1)
    row = next((i for i in rows if along[i]), rows[-1] if len(rows) else 0)
    there = np.abs(told).max(axis=0)[3:] > 0  # a file may lack motions
    place = _lever((told - exerted[:, six_of])[row, 3:], force[row], there, THIN)
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
