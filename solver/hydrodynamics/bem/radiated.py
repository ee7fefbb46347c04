"""Whether damping goes with what else a file says of the same bodies: with added mass, by causality, and with the force
of waves, by the energy that they carry away (Haskind); and added mass at infinite frequency, which follows.

A body alone that sends waves as a source or a dipole does radiates in heave B = k|X|²/(4ρgv), and half of that along
the waves, v their group velocity: a body of revolution in all waves, any other in long ones.
"""

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple, SupportsIndex

import numpy as np
from scipy.special import j0

from solver.errors import InputError
from solver.hydrodynamics.bem.coefficients import DOFS, symmetric
from solver.hydrodynamics.bem.exerted import Floats, long_waves
from solver.hydrodynamics.bem.given import KEY, Given
from solver.hydrodynamics.bem.mean_hull import motion_lengths
from solver.hydrodynamics.hull.revolution import Revolution
from solver.hydrodynamics.radiation.infinite import Share, damping_share, infinite_added_mass
from solver.sea.dispersion import group_velocity

LEANS = 0.1  # of what a motion sends out: more of the other kind makes it none of one kind
ENERGY = 1.3  # times the power radiated may be, or may be less, than what the force tells
DAMPED = 0.1  # of the largest damping: of less energy is not judged,
COUNTED = 0.1  # and of less than as much of so much of ω(M + A): it changes no answer, and meshes miss it
ALIKE_FAR = 1.0  # kd of two bodies up to which both send out rings of one shape,
COUPLED = 2.0  # and times the damping between them may be, or may be less, than these tell
ALONG = 1e-6  # of a wave's direction: along an axis that has less of it is no force
SAME = 1e-9  # A∞ that equals the highest frequency's by so much is that
TOGETHER = 0.2  # of an added mass: what it may scatter at infinite frequency where A and B are of one body
CONTRARY = 0.15  # of an added mass: what A∞ told may be from that of the rest, beyond doubt
UNKNOWN = 0.5  # of an added mass: what A∞ of the rest may be off; a memory is fitted beside an A∞ of its own
ALIKE = 0.1  # damping off by less may be, with a told error,
SURE = 2.0  # and by less than so many times what causality leaves in doubt
ROUNDED = 1e-11  # of a file's largest damping: so little is none, as what moving a point leaves of a turn about an axis
CERTAIN = 0.15  # of damping times another power of ω: what causality may doubt where it is the right one,
CLEARER = 3.0  # and how many times less than that of the damping told
POWERS = {-1: "multiplied", 1: "divided"}  # of ω that would set damping right, and how it was told


def require_damping(six: Given, needed: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Damping (nw, n, n) as the added mass would have it, that told where nothing says otherwise, and what of each
    motion's neither explains; InputError where it is surely another one. Judged are motions `needed`, each by itself.
    """
    A, B = (np.einsum("wii->wi", m)[:, needed] for m in (six.added_mass, six.radiation_damping))
    share = damping_share(six.omega, A, B)
    _require_power(six, A, B, share, [word(names, column) for column in needed])
    off = np.abs(share.value - 1)
    some = np.abs(B).max(axis=0) > ROUNDED * np.abs(B).max(initial=0.0)
    wrong = np.flatnonzero(some & (off > ALIKE) & (off > SURE * share.doubt))
    if len(wrong):
        i = wrong[np.argmax(off[wrong] / share.doubt[wrong])]
        text = f"damping of {word(names, needed[i])} is {_times(share.value[i])} what its added mass tells by causality"
        if (more := len(wrong) - 1) and np.ptp(share.value[wrong]) < ALIKE * abs(share.value[i]):
            text += f", as that of {more} other motion{'s' * (more > 1)}"
        raise InputError(KEY, six.name, f"{text}: have both the same units, and are they of one run?")
    due = np.ones(len(six.added_mass[0]))
    due[needed] = np.sqrt(np.where(off > share.doubt, np.maximum(share.value, 0.0), 1.0))
    damping = six.radiation_damping * np.multiply.outer(due, due)
    damping[:, needed, needed] += share.left
    return damping


def _times(share: float) -> str:
    return f"{1 / share:.3g} times" if share > 0 else "of the opposite sign of"


def _require_power(six: Given, A: np.ndarray, B: np.ndarray, share: Share, words: Sequence[str]) -> None:
    """Refuse damping that is told times ω or over it, as which it goes with no added mass, and without with its own.

    A, B (nw, nm) and words of single motions.
    """
    for power, how in POWERS.items():
        other = damping_share(six.omega, A, B * six.omega[:, None] ** power)
        clear = other.doubt < CERTAIN * other.value
        clear &= CLEARER * other.doubt * np.abs(share.value) < share.doubt * other.value
        if clear.any():
            i = int(np.flatnonzero(clear)[np.argmin((other.doubt / other.value)[clear])])
            text = f"damping of {words[i]} goes with its added mass, by causality, as B {how} by ω"
            if abs(other.value[i] - 1) > ALIKE:
                text += f" and {1 / other.value[i]:.3g} times that"
            raise InputError(KEY, six.name, f"{text}; needed is B itself, of WAMIT B/(ρω)")


def resistance(six: Given, floats: Floats) -> np.ndarray:
    """ω(M + A) of each motion (nw, 6 nb), beside which damping changes its answers; M of what the hulls displace."""
    lengths = motion_lengths(floats.hulls, DOFS)
    mass = np.repeat([floats.sea.density * hull.volume for hull in floats.hulls], 6) * lengths**2
    A = np.einsum("wii->wi", six.added_mass)
    return np.asarray(six.omega[:, None] * (mass + np.maximum(A, 0.0)))


class _Way(NamedTuple):
    """A motion of a body that sends out waves of one kind."""

    name: str
    columns: np.ndarray  # (nc,) of which it has
    axis: np.ndarray  # (nc,) so much
    pushed: np.ndarray  # (nw, ...) the force on it
    share: int  # k|X|²/(ρgv) over the damping that radiates it
    heavy: np.ndarray  # (nw,) M + A
    alone: np.ndarray  # (nw,) where it sends out little of the other kind


def require_energy(six: Given, floats: Floats, needed: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Refuse a damping of motions `needed` that does not go with the wave force; of several bodies, in long waves.

    Of motions that hardly radiate: in words what does not, and the damping (nw, 6 nb, 6 nb) that lacks to what would.
    """
    sea, hulls = floats.sea, floats.hulls
    k, notes, lacks = sea.wavenumbers(six.omega), [], np.zeros(six.radiation_damping.shape)
    round_one = len(hulls) == 1 and isinstance(hulls[0], Revolution)
    some = np.ones(len(k), bool) if round_one else long_waves(k * max(h.largest_radius for h in hulls))
    each = k / (sea.density * sea.gravity * group_velocity(six.omega, sea.depth, sea.gravity))
    for way in (way for b in range(len(hulls)) for way in _ways(six, floats, b)):
        block = (slice(None), way.columns[:, None], way.columns)
        damping = way.axis @ six.radiation_damping[block] @ way.axis
        told = each * np.sum(np.abs(way.pushed) ** 2, axis=1) / way.share
        beside = six.omega * way.heavy
        judged = some & way.alone & (damping > DAMPED * np.max(damping[some], initial=0.0))
        radiating = judged & (np.maximum(damping, told) > DAMPED * COUNTED * beside)
        rows = radiating if radiating.any() else judged
        if not np.isin(way.columns, needed).all() or not rows.any():
            continue
        ratio = float(np.median(damping[rows] / np.maximum(told, 1e-300)[rows]))
        if 1 / ENERGY < ratio < ENERGY:
            continue
        text = f"damping {way.name} is {ratio:.3g} times what the wave force tells of the power radiated"
        if radiating.any():
            raise InputError(KEY, six.name, f"{text}: one of both has other units, or is not of this body")
        missed = np.where(some & way.alone, told - damping, 0.0)
        w = int(np.argmax(np.abs(missed) / beside))
        notes.append(f"{text}, by {abs(missed[w]) / beside[w]:.1g} of its ω(M + A) at {six.omega[w]:.4g} rad/s")
        lacks[block] += np.multiply.outer(missed, np.outer(way.axis, way.axis))
    return notes, lacks


def _ways(six: Given, floats: Floats, b: int) -> tuple[_Way, _Way]:
    """Heave and the motion along the waves of a body.

    Not where heave sends out much as a dipole and motions along the waves as a source, as of a plate that leans.
    Dipoles D of motions along x and y, symmetric, make X = De along e, and B of D² whatever the hull's own axes are.
    """
    sea, hull, name, x = floats.sea, floats.hulls[b], floats.names[b], 6 * b
    k, X = sea.wavenumbers(six.omega), six.excitation[:, 0]
    e = np.array([np.cos(sea.heading), np.sin(sea.heading)])
    A, displaced = six.added_mass[:, x : x + 3, x : x + 3], sea.density * hull.volume
    across, along, heave = np.linalg.norm(A[:, 2, :2], axis=1), displaced + e @ A[:, :2, :2] @ e, displaced + A[:, 2, 2]
    source = np.abs(sea.density * hull.waterplane[0] - k * heave)
    level = np.flatnonzero(np.abs(e) > ALONG)
    return (
        _Way(
            f"in heave of {name}",
            np.array([x + 2]),
            np.ones(1),
            X[:, x + 2 : x + 3],
            4,
            heave,
            k * across < LEANS * source,
        ),
        _Way(f"along the waves of {name}", x + level, e[level], X[:, x : x + 2], 8, along, across < LEANS * along),
    )


def require_together(six: Given, floats: Floats, needed: np.ndarray) -> None:
    """Refuse a damping between the heaves of two bodies, both `needed`, that is not of the waves which both send out.

    Of bodies d apart on plan these are rings in waves long beside d and the bodies: B₁₂ = ±√(B₁₁B₂₂) J₀(kd) (Haskind),
    of the sign of X₁X₂* with the waves' phase from one body to the other taken off.
    """
    k, B, X = floats.sea.wavenumbers(six.omega), six.radiation_damping, six.excitation[:, 0]
    e = np.array([np.cos(floats.sea.heading), np.sin(floats.sea.heading)])
    radiating = np.einsum("wii->wi", B) > DAMPED * COUNTED * resistance(six, floats)
    heaving = [b for b in range(len(floats.hulls)) if 6 * b + 2 in needed]
    for a, b in combinations(heaving, 2):
        i, j, way = 6 * a + 2, 6 * b + 2, (floats.centres[a] - floats.centres[b])[:2]
        reach = max(np.linalg.norm(way), *(floats.hulls[n].largest_radius for n in (a, b)))
        size = np.sqrt(np.maximum(B[:, i, i] * B[:, j, j], 0.0)) * j0(k * np.linalg.norm(way))
        judged = (k * reach < ALIKE_FAR) & radiating[:, i] & radiating[:, j]
        if not judged.any():
            continue
        sense = np.sign((X[:, i] * X[:, j].conj() * np.exp(-1j * k * (way @ e))).real)
        ratio = float(np.median((sense * (B[:, i, j] + B[:, j, i]) / 2)[judged] / size[judged]))
        if not 1 / COUPLED < ratio < COUPLED:
            text = (
                f"damping between {word(floats.names, i)} and {word(floats.names, j)} is {ratio:.3g} times what waves"
            )
            text += " that both send far off make of their own, in long waves"
            raise InputError(KEY, six.name, f"{text}: have blocks between bodies another sign, unit or order?")


def infinite(
    six: Given, size: np.ndarray, needed: np.ndarray, names: Sequence[str], *, memory: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """A∞ (n, n), the file's where it goes with A and B, else what follows from them; and how far it may be off.

    size (n,): of a column's share of A. Judged are entries of motions `needed`. Without a memory no response depends on
    A∞, and one that follows counts as exact however little is known of it.
    """
    follows = infinite_added_mass(six.omega, symmetric(six.added_mass), symmetric(six.radiation_damping))
    both = np.zeros(follows.value.shape)
    both[needed[:, None], needed] = 1 / np.multiply.outer(size[needed], size[needed])
    scatter, doubt = follows.scatter * both, (follows.scatter + follows.beyond) * both
    scatter = np.where(follows.scatter > follows.beyond, scatter, 0.0)
    i, j = _worst(scatter)
    if scatter[i, j] > TOGETHER:
        text = f"added mass and damping of {word(names, i)} on {word(names, j)} do not go together (off causality by"
        raise InputError(
            KEY,
            six.name,
            f"{text} {scatter[i, j]:.0%}); do their units agree, or are frequencies too far apart,"
            " as where water rings in a gap or well?",
        )
    told = six.added_mass_inf
    # Some programs put the highest frequency's in its place.
    if told is None or np.abs(told - six.added_mass[-1]).max() <= SAME * np.abs(told).max():
        i, j = _worst(doubt)
        if memory and doubt[i, j] > UNKNOWN:
            text = "has no added mass at infinite frequency, and what follows from frequencies up to"
            text += f" {six.omega[-1]:.4g} rad/s may be {doubt[i, j]:.0%} off for {word(names, i)} on {word(names, j)}"
            raise InputError(KEY, six.name, f"{text}; the frequency domain does without")
        return follows.value, memory * np.diag(np.diagonal(doubt) * size**2)
    even = symmetric(told)
    off = np.abs(even - follows.value) * both - doubt
    i, j = _worst(off)
    if off[i, j] > CONTRARY:
        text = f"added mass of {word(names, i)} on {word(names, j)} at infinite frequency is {even[i, j]:.4g},"
        text += f" the rest up to {six.omega[-1]:.4g} rad/s implies {follows.value[i, j]:.4g}"
        if np.any(six.radiation_damping[:, [i, j], [i, j]].argmax(axis=0) == len(six.omega) - 1):
            text += "; damping still grows there, higher frequencies may tell otherwise"
        raise InputError(KEY, six.name, text)
    return even, told - even


def _worst(values: np.ndarray) -> tuple[int, int]:
    i, j = np.unravel_index(values.argmax(), values.shape)
    return int(i), int(j)


def word(names: Sequence[str], column: SupportsIndex) -> str:
    """A motion of a body."""
    column = int(column)
    return f"{names[column // 6]} {DOFS[column % 6]}"
