"""What causality says of added mass and damping: added mass at infinite frequency, and whether both are of one body.

A(ω) - A∞ = 2/π ⨍ B(s)/(s² - ω²) ds over s > 0 (Kramers and Kronig; Ogilvie 1964), a principal value. Of its part within
the band of frequencies a file tells; what lies beyond is, seen from within, a + bω² + ..., however B goes on there.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from solver.errors import InputError

NODES = 801  # of B within the band, straight between them
TAIL = 201  # beyond it, up to FARTHEST times its end
FARTHEST = 300.0
FALL = 2.0, 12.0  # least and largest power of ω with which B falls beyond the band
LIKELY = 2.0  # the power of what there is more of it, and
EXTREMES = 0.0, 8.0  # those by which that is doubted
SPREAD, FREE = 0.5, 3.0  # see _likely
FARTHER = 25.0  # times the doubt where there is more of that than any damping told, at most: a hump six bands away
WITHIN = 0.8  # share of the band up to which A is asked for: what lies beyond bends most at its end
ABOVE = 0.25  # and from which for A∞: what lies below bends most at its beginning


class Infinite(NamedTuple):
    """Added mass at infinite frequency, and what speaks against it, each (n, n)."""

    value: np.ndarray
    scatter: np.ndarray  # standard deviation over the band of what is left of A, 0 where A and B go together
    beyond: np.ndarray  # how far B beyond the band may put it off


class Share(NamedTuple):
    """How many times its damping told a motion's added mass asks for, and what speaks against it, n motions."""

    value: np.ndarray  # (n,)
    doubt: np.ndarray  # (n,) ∞ where the damping is none
    left: np.ndarray  # (nw, n) what of ωA no such share explains, as large as what of damping may be wrong there


class _Band(NamedTuple):
    """A at some frequencies, and its parts by B, each (na, m)."""

    at: np.ndarray  # (na, 1) shares of the band
    A: np.ndarray
    inner: np.ndarray  # of B within the band
    falling: np.ndarray  # of B that goes on beyond it as its last quarter falls
    tails: np.ndarray  # (na, ne) of 1 at the band's end that falls by each of the powers


def infinite_added_mass(omega: np.ndarray, added_mass: np.ndarray, damping: np.ndarray) -> Infinite:
    """A∞ of A, B (nw, n, n) at increasing ω (nw,) [rad/s].

    B goes on beyond the band as its last quarter falls, and with more or less of a tail by how A bends within; as which
    shape is what A∞ is doubted by. A tail that would begin above all damping told is a hump farther away, of which less
    is known.
    """
    B = damping.reshape(len(omega), -1)
    band = _band(omega, added_mass.reshape(B.shape), B, ABOVE, (LIKELY, *EXTREMES))
    rest = band.A - band.inner - band.falling
    more, left = _likely(band.tails[:, 0], rest, np.abs(B[-1]))
    plain, value = rest.mean(axis=0), (rest - np.multiply.outer(band.tails[:, 0], more)).mean(axis=0)
    other = [np.polyfit(tail, rest, 1)[1] for tail in band.tails.T]
    largest, begins = (
        np.maximum(np.abs(B).max(axis=0), 1e-300),
        np.abs(B[-1] + np.polyfit(band.tails[:, 0], rest, 1)[0]),
    )
    beyond = np.max([np.abs(each - value) for each in (plain, *other)], axis=0)
    beyond *= np.clip(begins / largest, 1.0, FARTHER)
    value, left, beyond = (x.reshape(added_mass.shape[1:]) for x in (value, left, beyond))
    own = np.sqrt(np.diagonal(beyond))  # what is not known of two motions is not of what one does to the other
    return Infinite(value, left, np.maximum(beyond, np.multiply.outer(own, own)))


def _likely(tail: np.ndarray, rest: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How much of a tail (na,) is likely in the rest (na, m), about SPREAD of `size` (m,), and what it leaves (m,).

    What is left is as of FREE values that have nothing to do with each other, and outweighs a tail no larger than that.
    """
    bend = tail - tail.mean()
    slope = bend @ rest / (bend @ bend)
    left = (rest - np.multiply.outer(tail, slope)).std(axis=0)
    tells, unsure = FREE * bend.var() * (SPREAD * size) ** 2, left**2
    return slope * tells / np.maximum(tells + unsure, 1e-300), left


def damping_share(omega: np.ndarray, added_mass: np.ndarray, damping: np.ndarray) -> Share:
    """c of A = A∞ + c K(B) + what lies beyond the band, in least squares, of A, B (nw, n) of single motions.

    Doubted by other forms of what lies beyond and below the band, and as if all that is left of A were by c.
    """
    band = _band(omega, added_mass, damping)
    one, x = np.ones(len(band.at)), band.at[:, 0] ** 2
    value, doubt, left = np.ones(damping.shape[1]), np.full(damping.shape[1], np.inf), np.zeros(damping.shape)
    for i in np.flatnonzero(damping.any(axis=0)):
        A, inner, whole = band.A[:, i], band.inner[:, i], (band.inner + band.falling)[:, i]
        value[i], rest, by = _fitted(A, whole, one, x)
        forms = ((whole, one), (inner, one, x), (inner, one, x, x**2), (whole, one, x, 1 / x))
        doubt[i] = by + max(abs(_fitted(A, *form)[0] - value[i]) for form in forms)
        left[:, i] = omega * np.interp(omega / omega[-1], band.at[:, 0], np.abs(rest))
    return Share(value, doubt, left)


def _fitted(A: np.ndarray, by: np.ndarray, *others: np.ndarray) -> tuple[float, np.ndarray, float]:
    """How many times `by` is in A beside the others, in least squares; what is left of A, and how many that may be."""
    rest = np.stack(others, axis=1)
    rest /= np.linalg.norm(rest, axis=0)
    alone, A = (y - rest @ np.linalg.lstsq(rest, y, rcond=None)[0] for y in (by, A))
    size = max(float(np.linalg.norm(alone)), 1e-300)
    share = float(alone @ A) / size**2
    left = A - share * alone
    return share, left, float(np.linalg.norm(left)) / size


def _band(omega: np.ndarray, A: np.ndarray, B: np.ndarray, above: float = 0.0, powers: tuple[float, ...] = ()) -> _Band:
    """Of A, B (nw, m)."""
    s, whole = continued(omega, B, nodes=NODES, tail=TAIL, farthest=FARTHEST)
    inner, outer = s[:NODES], s[NODES:]
    # Half-way between nodes, where the principal value of a straight piece is its logarithms.
    at = (inner[1:] + inner[:-1]) / 2
    low, high = omega[0] + np.multiply((above, WITHIN), omega[-1] - omega[0])
    at = at[(at >= low) & (at <= high)]
    weights = 2 / np.pi * principal(s, at)
    near, far = weights[:, :NODES], weights[:, NODES:]
    return _Band(
        at[:, None] / omega[-1],
        CubicSpline(omega, A)(at),
        near @ whole[:NODES],
        far @ whole[NODES:],
        far @ (omega[-1] / outer[:, None]) ** np.array(powers),
    )


def continued(
    omega: np.ndarray, B: np.ndarray, *, nodes: int, tail: int, farthest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points s (m,), `nodes` of them within the band, and B (nw, n) there (m, n).

    It is a spline from B(0) = 0 through the samples, and goes on as a power of ω up to `farthest` times the band's end,
    as its last quarter falls off, within FALL.
    """
    if len(omega) < 2:
        raise InputError("omega", list(omega), "must be two frequencies at least")
    inner = np.linspace(0, omega[-1], nodes)
    outer = omega[-1] * np.geomspace(1, farthest, tail)[1:]
    quarter = min(len(omega) * 3 // 4, len(omega) - 2)
    fall = np.log(np.maximum(np.abs(B[quarter]), 1e-300) / np.maximum(np.abs(B[-1]), 1e-300))
    fall = np.clip(fall / np.log(omega[-1] / omega[quarter]), *FALL)
    within = CubicSpline(np.concatenate([[0.0], omega]), np.vstack([0 * B[:1], B]))(inner)
    return np.concatenate([inner, outer]), np.vstack([within, B[-1] * (omega[-1] / outer[:, None]) ** fall])


def principal(s: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights (len(at), len(s)) of nodal values in ⨍ f(s)/(s² - ω²) ds, f straight between nodes s, ω = at."""
    w = at[:, None]
    plain = np.diff(np.log(np.abs((s - w) / (s + w))), axis=1) / (2 * w)  # ∫ ds/(s² - ω²) over each piece
    first = np.diff(np.log(np.abs(s**2 - w**2)), axis=1) / 2  # ∫ s ds/(s² - ω²)
    step = np.diff(s)
    weights = np.zeros((len(at), len(s)))
    weights[:, :-1] += (s[1:] * plain - first) / step
    weights[:, 1:] += (first - s[:-1] * plain) / step
    return weights
