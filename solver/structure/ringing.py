"""How a frame's modes move under loads that go with time, exactly, and how much of that is their own swinging.

Under Q = a + bt + ct²/2 a mode q̈ + 2ζω q̇ + ω² q = Q goes along Q/ω² - 2ζ Q̇/ω³ + (4ζ² - 1) Q̈/ω⁴ and swings about that
as Re A exp(λt), λ = -ζω + i ω (1 - ζ²)^½. Sizes are roots of the mean of ω²q², of twice the strain energy.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from solver.kernels import whole_kernel
from solver.structure.load_history import LoadHistory

TOGETHER = 16  # modes whose loads are known at a time: there may be hundreds of both, and a million pieces
SAME = 1e-10  # of a piece's length
LARGEST = 0.99  # damping ratio: what is damped by more hardly swings
AT_ONCE = 4096  # samples of loads and modes: a record may have millions


class Pieces(NamedTuple):
    """Of n loads, k of them, each a parabola from one time to the next."""

    time: np.ndarray  # (k + 1,) [s]
    value: np.ndarray  # (k, n) at their starts [N]
    slope: np.ndarray  # (k, n) there [N/s]
    curvature: np.ndarray  # (k, n) [N/s²]

    def cut(self, time: np.ndarray) -> "Pieces":
        """At further times, all of its own among them."""
        at = np.searchsorted(self.time[1:-1], time[:-1], side="right")
        since = (time[:-1] - self.time[at])[:, None]
        value, slope, curvature = (part[at] for part in self[1:])
        later = value + since * (slope + 0.5 * since * curvature)
        return Pieces(time, later, slope + since * curvature, curvature)

    def less(self, other: "Pieces") -> "Pieces":
        """What they differ by."""
        time = np.union1d(self.time, other.time)
        ours, theirs = self.cut(time), other.cut(time)
        return Pieces(time, *(a - b for a, b in zip(ours[1:], theirs[1:], strict=True)))


def lines(histories: Iterable[LoadHistory], end: float) -> Pieces:
    """The forces that they have until then along their axes, one history after another: straight between samples."""
    histories = tuple(histories)
    inner = [h.time[(h.time > 0) & (h.time < end)] for h in histories]
    time = np.unique(np.concatenate([[0.0, end], *inner]))
    force = _forces(histories, time)
    slope = np.diff(force, axis=0) / np.diff(time)[:, None]
    return Pieces(time, force[:-1], slope, np.zeros(slope.shape))


def parabolas(histories: Iterable[LoadHistory], step: float, end: float) -> Pieces:
    """What a march takes for them, through start, middle and end of each step [s], the last until the end."""
    histories, count = tuple(histories), max(1, int(np.ceil(end / step - 1e-9)))
    time = step * np.arange(count + 1)
    first, middle, last = (_forces(histories, time[:-1] + share * step) for share in (0.0, 0.5, 1.0))
    time[-1] = end
    return Pieces(time, first, (4 * middle - 3 * first - last) / step, 4 * (first - 2 * middle + last) / step**2)


def _forces(histories: tuple[LoadHistory, ...], t: np.ndarray) -> np.ndarray:
    return np.concatenate([h.at(t)[:, h.axes] for h in histories], axis=1)


class Sizes(NamedTuple):
    """Of modes (nm,)."""

    swings: np.ndarray  # about what slow loads would have them do
    pushed: np.ndarray  # of that, about its mean
    whole: np.ndarray  # by both, at the pieces' ends


def sizes(loads: Pieces, omega: np.ndarray, ratio: np.ndarray, applied: np.ndarray) -> Sizes:
    """Of modes ω, ζ (nm,), mass-normalised, that unit loads push by `applied` (n, nm), at rest when these begin."""
    squares, span = np.zeros((4, omega.size)), loads.time[-1] - loads.time[0]
    for first in range(0, omega.size, TOGETHER):
        some = slice(first, first + TOGETHER)
        value, slope, curvature = (applied[:, some].T @ part.T for part in loads[1:])
        damped = np.minimum(ratio[some], LARGEST)
        _move(loads.time, value, slope, curvature, omega[some], damped, squares[:, some])
    swings, whole, slow, mean = squares / span
    return Sizes(*(np.sqrt(square) * omega for square in (swings, np.maximum(slow - mean**2, 0.0), whole)))


def products(
    histories: Iterable[LoadHistory],
    step: float,
    span: tuple[float, float],
    omega: np.ndarray,
    ratio: np.ndarray,
    applied: np.ndarray,
) -> np.ndarray:
    """R (k, 1 + na + 3 nm), RᵀR the mean products of 1, the loads, q, q̇ and q̈ from one time to another.

    Row 0 has their means, others what goes about these. Loads are straight from step to step [s]: where the slope of
    one grows by b, q̈ swings as b sin(ω't) exp(-ζωt)/ω'.
    """
    from scipy.signal import lfilter  # rarely asked for, and slow to import

    histories, (begin, end) = tuple(histories), np.ceil(np.array(span) / step - SAME).astype(int)
    damped = np.minimum(ratio, LARGEST)
    rate = omega * (1j * np.sqrt(1 - damped**2) - damped)
    R, last = np.zeros((0, 1 + len(applied) + 3 * omega.size)), np.zeros((omega.size, 1), complex)
    for first in range(0, end + 1, AT_ONCE):
        at = np.arange(first, min(first + AT_ONCE, end + 1))
        force = _forces(histories, step * np.clip([first - 1, *at, at[-1] + 1], 0, end))
        load, slope = force @ applied, np.diff(force, axis=0) @ applied / step
        swing = np.empty((at.size, omega.size), complex)
        for m, grown in enumerate(np.diff(slope, axis=0).T):
            swing[:, m], last[m] = lfilter([1.0], [1.0, -np.exp(rate[m] * step)], grown, zi=last[m])
        swing /= 1j * rate.imag
        dq, ddq = slope[1:] / omega**2 + (swing / rate).real, swing.real
        q = (load[1:-1] - 2 * damped * omega * dq - ddq) / omega**2
        samples = np.concatenate([np.ones((at.size, 1)), force[1:-1], q, dq, ddq], axis=1)
        R = np.asarray(np.linalg.qr(np.concatenate([R, samples[at >= begin]]), mode="r"))
    return R / R[0, 0]


@whole_kernel
def _move(
    time: np.ndarray,
    value: np.ndarray,
    slope: np.ndarray,
    curvature: np.ndarray,
    omega: np.ndarray,
    ratio: np.ndarray,
    squares: np.ndarray,
) -> None:
    """Integrals over time (4, nm), added to what is there: of the squares of Re A exp(λt), of q by trapezoids, of Q/ω²,
    and of Q/ω² itself.

    Loads (nm, k).
    """
    for m in range(omega.size):
        w, zeta = omega[m], ratio[m]
        fast = np.sqrt(1 - zeta * zeta)
        rate, first, second, third = complex(-zeta, fast), 1 / w**2, 1 / w**3, 1 / w**4
        q, dq, last, later, grown, turned = value[m, 0] * first, 0.0, 0.0, 0j, 0.0, 0j  # dq over ω
        for k in range(time.size - 1):
            a, b, c, span = value[m, k] * first, slope[m, k] * second, curvature[m, k] * third, time[k + 1] - time[k]
            if abs(span - last) > SAME * span:  # pieces are mostly alike
                last, later = span, np.exp(w * span * rate)
                grown = (abs(later) ** 2 - 1) / (-2 * zeta * w) if zeta * w * span > 1e-8 else span
                turned = (later * later - 1) / (2 * w * rate)
            bend = (4 * zeta * zeta - 1) * c
            x, v = q - (a - 2 * zeta * b + bend), dq - (b - 2 * zeta * c)
            y = -(v + zeta * x) / fast
            squares[0, m] += 0.5 * ((x * x + y * y) * grown + (x * x - y * y) * turned.real - 2 * x * y * turned.imag)
            swing, t, before = complex(x, y) * later, w * span, q
            squares[2, m] += span * (a * a + t * (a * b + t * ((b * b + a * c) / 3 + t * (b * c / 4 + t * c * c / 20))))
            squares[3, m] += span * (a + t * (b / 2 + t * c / 6))
            a, b = a + t * (b + 0.5 * t * c), b + t * c
            q = a - 2 * zeta * b + bend + swing.real
            dq = b - 2 * zeta * c + (rate * swing).real
            squares[1, m] += 0.5 * span * (before * before + q * q)
