"""Under which convention a file's wave force would be that on the hulls, in words."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from solver.hydrodynamics.bem.coefficients import DOFS
from solver.hydrodynamics.bem.exerted import FELT, Floats, Long, arrival, felt, in_long_waves, passing
from solver.hydrodynamics.bem.given import Given, turned

IN_PHASE = 0.5  # cosine of the phase, force-weighted: of less some convention is another
BETTER = 0.85  # of another convention that explains the difference
DEPTHS = 24  # that are tried
TURNS = 6  # rounds until angles agree with the added mass that they turn
FEW = 4  # bodies whose orders are tried
LEAST = 5.0  # degrees: of less a turn changes no force by more than it may be off
CROSSED = (1, 0, 2, 4, 3, 5)  # motions along x and y, one for the other


def misfit(six: Given, floats: Floats, expected: np.ndarray) -> str:
    """Of a force that is not that of long waves, expected (nw, 6 nb) the Froude-Krylov force on the hulls."""
    long = in_long_waves(six, floats, expected)
    other = _cosine(long.told, long.fits, felt(long.fits)) < IN_PHASE
    text = (
        (_convention(six, floats, expected, long) if other else "")
        or _slip(six, floats, expected)
        or _turn(six, floats, expected, long)
        or _heavier(six, floats, expected, long)
    )
    if text:
        return f"wave force {text}"
    return _out_of_phase(long, floats) if other else _unlike(six, long, floats)


def _convention(six: Given, floats: Floats, expected: np.ndarray, long: Long) -> str:
    """Of time, sign, phase or order of bodies, by the phases of the force; empty where by none."""
    told, fits, rows = long.told, long.fits, long.rows
    columns = felt(fits)
    tries = [
        (_cosine(told.conj(), fits, columns), _backwards(six)),
        (_cosine(-told, fits, columns), "has the opposite sign"),
        (_cosine(1j * told, fits, columns), "is a quarter of a period off: phases refer to a crest at x = y = 0"),
        (_cosine(-1j * told, fits, columns), "is a quarter of a period off: phases refer to a crest at x = y = 0"),
    ]
    for other, text in _orders(six, floats.names):
        fit = (expected + passing(other, floats))[rows]
        tries.append((_cosine(other.excitation[rows, 0], fit, felt(fit)), text))
    best, text = max(tries, key=lambda scored: scored[0])
    return text if best >= BETTER else ""


def _backwards(six: Given) -> str:
    """Of time or waves, in the sign of the file's own numbers.

    Turning the waves round turns the Froude-Krylov force into its conjugate, so that the two cannot be told apart.
    """
    needed, other = (f"Re{{X exp({sign}iωt)}}" for sign in ("+-" if six.time_sign > 0 else "-+"))
    text = f"is of the other sign of time, {other}, or of waves from the other side; {needed} is needed"
    return f"{text}, and headings are directions that waves travel to"


def _slip(six: Given, floats: Floats, expected: np.ndarray) -> str:
    """Of the simple ones that which fits best; empty where none does."""
    found = []
    for other, seen, text in _slips(six, floats):
        same = seen is floats and other.omega is six.omega  # waves, whose force on the hulls takes most of the time
        found.append((in_long_waves(other, seen, expected if same else None), text))
    fit = [(long.off, text) for long, text in found if long.rows.any() and long.off <= 1]
    return min(fit)[1] if fit else ""


def _slips(six: Given, floats: Floats) -> Iterator[tuple[Given, Floats, str]]:
    """What a file may have meant, and of which waves."""
    rho, heading = floats.sea.density, floats.sea.heading
    yield replace(six, omega=2 * np.pi * six.omega), floats, "is as of frequencies in Hz: rad/s are needed"
    yield _inverted(six), floats, "is as of frequencies where periods are needed"
    over = replace(six, added_mass=six.added_mass / rho, radiation_damping=six.radiation_damping / rho)
    yield over, floats, "is as of added mass and damping that were to be divided by density"
    still = replace(six, added_mass=0 * six.added_mass, radiation_damping=0 * six.radiation_damping)
    yield still, floats, "is the Froude-Krylov force alone: what is diffracted is missing"
    scaled = replace(over, radiation_damping=over.radiation_damping / six.omega[:, None, None])
    scaled = replace(scaled, excitation=six.excitation / (rho * floats.sea.gravity))
    yield scaled, floats, "is as of numbers in SI units where a file's are over density and gravity"
    for depth in _depths(six, floats):
        elsewhere = floats._replace(sea=replace(floats.sea, depth=depth))
        of = f"some {depth:.2g} m deep" if np.isfinite(depth) else "without a bottom"
        yield six, elsewhere, f"is as of water {of}"
    own = replace(six, excitation=six.excitation * arrival(six, floats))
    yield own, floats, "is as of phases that refer to a crest at each float's own place: at x = y = 0 is needed"
    clockwise = floats._replace(sea=replace(floats.sea, heading=-heading))
    towards = f"{np.degrees(-heading):.4g} degrees"
    yield six, clockwise, f"is of waves towards {towards}: headings are from x towards y, seen from above"
    crossed = np.add.outer(6 * np.arange(len(floats.names)), CROSSED).ravel()
    yield _permuted(six, crossed), floats, "is as of surge and sway, one in the other's column: are roll and pitch too?"
    for other, text in _orders(six, floats.names):
        yield other, floats, text


def _depths(six: Given, floats: Floats) -> list[float]:
    """Of water that a file's may have been where it tells none."""
    if six.depth is not None:
        return []
    deepest = 4 / floats.sea.wavenumbers(six.omega).min()
    lowest = max(-float(h.surface_points()[0][:, 2].min()) for h in floats.hulls)
    return [np.inf, *np.geomspace(1.1 * lowest, max(deepest, 2 * lowest), DEPTHS).tolist()]


def _inverted(six: Given) -> Given:
    """Of ω where a period was read: at 2π/ω, and damping, which was multiplied by ω, by that."""
    return replace(
        six,
        omega=2 * np.pi / six.omega[::-1],
        added_mass=six.added_mass[::-1],
        radiation_damping=(2 * np.pi * six.radiation_damping / six.omega[:, None, None] ** 2)[::-1],
        excitation=six.excitation[::-1],
    )


def _turn(six: Given, floats: Floats, expected: np.ndarray, long: Long) -> str:
    """By which turns of each body's axes in plan a force would fit, in words; empty where by none.

    The angle of least squares is that of Σ X' × X over Σ X' · X, of forces X' told; X goes by turned A and B.
    """
    angles, rows = np.zeros(len(floats.names)), long.rows
    for _ in range(TURNS):
        told, fits = _on_axes(six, floats, expected, angles)
        x, y = (told[rows, i::6].conj() for i in (0, 1))
        across = x * fits[rows, 1::6] - y * fits[rows, ::6]
        along = x * fits[rows, ::6] + y * fits[rows, 1::6]
        angles += np.arctan2(across.sum(axis=0).real, along.sum(axis=0).real)
    whole = (np.degrees(angles) + 180) % 360 - 180  # sums of several turns
    if np.abs(whole).max() < LEAST or in_long_waves(turned(six, angles), floats, expected).off > 1:
        return ""
    each = ", ".join(f"{round(angle)} of {name}" for angle, name in zip(whole, floats.names, strict=True))
    return f"is on axes turned in plan, by degrees {each}: WAMIT's .out tells of them as PHIBODY"


def _on_axes(six: Given, floats: Floats, expected: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The force and that of long waves (nw, 6 nb), were a file's axes turned by these angles."""
    other = turned(six, angles)
    return other.excitation[:, 0], expected + passing(other, floats)


def _heavier(six: Given, floats: Floats, expected: np.ndarray, long: Long) -> str:
    """How many times its added mass would make the force fit, in words; empty where no number does.

    In least squares X - X_FK - Bu = -s iωAu, s times the added mass told.
    """
    damped = passing(replace(six, added_mass=0 * six.added_mass), floats)[long.rows]
    heavy, rest = long.fits - expected[long.rows] - damped, long.told - expected[long.rows] - damped
    columns = felt(long.fits)
    share = np.vdot(heavy[:, columns], rest[:, columns]).real / np.linalg.norm(heavy[:, columns]) ** 2
    fits = share > 0 and in_long_waves(replace(six, added_mass=share * six.added_mass), floats, expected).off <= 1
    return f"goes with {share:.3g} times the added mass that is told: have both the same units?" if fits else ""


def _cosine(told: np.ndarray, expected: np.ndarray, columns: np.ndarray) -> float:
    """Least over the columns of Re <expected, told>, of forces of length 1; 0 where nothing is told."""
    a, b = told[:, columns], expected[:, columns]
    inner = np.sum(b.conj() * a, axis=0).real
    size = np.linalg.norm(a, axis=0) * np.linalg.norm(b, axis=0)
    there = np.linalg.norm(a, axis=0) > 0
    return float(np.min(inner[there] / size[there], initial=1.0)) if there.any() else 0.0


def _orders(six: Given, names: Sequence[str]) -> Iterator[tuple[Given, str]]:
    """With few bodies in other orders, and how to say so."""
    for order in list(permutations(range(len(names))))[1:] if len(names) <= FEW else []:
        columns = np.add.outer(6 * np.array(order), np.arange(6)).ravel()
        named = ", ".join(names[b] for b in np.argsort(order))
        yield _permuted(six, columns), f"is of the bodies in another order: {named}"


def _permuted(six: Given, columns: np.ndarray) -> Given:
    """The force, added mass and damping with the columns in this order."""
    both = (slice(None), columns[:, None], columns)
    return replace(
        six,
        added_mass=six.added_mass[both],
        radiation_damping=six.radiation_damping[both],
        excitation=six.excitation[..., columns],
    )


def _out_of_phase(long: Long, floats: Floats) -> str:
    columns = felt(long.fits)
    each = [_cosine(long.told, long.fits, np.array([c])) for c in columns]
    worst = int(columns[int(np.argmin(each))])
    text = f"wave force on {floats.names[worst // 6]} in {DOFS[worst % 6]}, heading {floats.sea.heading:.4g} rad, is"
    text += f" out of phase with what long waves exert on its hull (cosine {min(each):.2f})"
    return f"{text}; is it this hull, and where it was computed?"


def _unlike(six: Given, long: Long, floats: Floats) -> str:
    """What a force is that no other convention explains."""
    _, told, fits, _, where = long
    column, largest = where[1], np.abs(fits[where[0], where[1] // 6 * 6 :][:3]).max()
    text = f"{DOFS[column % 6]} force on {floats.names[column // 6]} at {six.omega[long.rows][where[0]]:.4g} rad/s,"
    text += f" heading {floats.sea.heading:.4g} rad,"
    if abs(fits[where]) > FELT * largest:
        ratio = told[where] / fits[where]
        phase = abs(np.degrees(np.angle(ratio)))
        text += f" is {abs(ratio):.3g} times what long waves exert on its hull, {phase:.0f} degrees of phase from it"
    else:
        text += f" is {abs(told[where]):.3g} N/m, of long waves on its hull {abs(fits[where]):.3g}"
    asked = "other units of force, added mass or damping, a length scale other than 1 m"
    return f"{text}: {asked}, another place or axes, or one wave's force alone?"
