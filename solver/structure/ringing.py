"""How a frame's modes move under loads that go with time, exactly, and how much of that is their own swinging.

Under Q = a + bt + ct²/2 a mode q̈ + 2ζω q̇ + ω² q = Q goes along Q/ω² - 2ζ Q̇/ω³ + (4ζ² - 1) Q̈/ω⁴ and swings about that
as Re A exp(λt), λ = -ζω + i ω (1 - ζ²)^½. Sizes are roots of the mean of ω²q², of twice the strain energy.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from solver.kernels import whole_kernel
from solver.structure.load_history import LoadHistory

LARGEST = 0.99  # damping ratio: what is damped by more hardly swings


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

    def of_modes(self, applied: np.ndarray) -> "Pieces":
        """Loads of modes that unit loads push by `applied` (n, nm)."""
        return Pieces(self.time, *(np.ascontiguousarray(part @ applied) for part in self[1:]))


def lines(histories: Iterable[LoadHistory], end: float) -> Pieces:
    """The forces that they have until then along their axes, one history after another: straight between samples."""
    histories = tuple(histories)
    inner = [h.time[(h.time > 0) & (h.time < end)] for h in histories]
    time = np.unique(np.concatenate([[0.0, end], *inner]))
    force = _forces(histories, time)
    slope = np.diff(force, axis=0) / np.diff(time)[:, None]
    return Pieces(time, force[:-1], slope, np.zeros(slope.shape))


def parabolas(histories: Iterable[LoadHistory], step: float, end: float) -> Pieces:
    """What a march takes for them, through start, middle and end of each step [s]; the last is whole in no record."""
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


def sizes(loads: Pieces, omega: np.ndarray, ratio: np.ndarray) -> Sizes:
    """Of modes ω, ζ (nm,), mass-normalised, at rest under the loads (k, nm) when these begin."""
    swings, whole, span = np.zeros(omega.size), np.zeros(omega.size), loads.time[-1] - loads.time[0]
    _move(*loads, omega, np.minimum(ratio, LARGEST), swings, whole)
    gaps, (a, b, c) = np.diff(loads.time)[:, None], loads[1:]
    mean = np.sum(gaps * (a + gaps * (b / 2 + gaps * c / 6)), axis=0) / span
    a = a - mean
    squares = a * a + gaps * (a * b + gaps * ((b * b + a * c) / 3 + gaps * (b * c / 4 + gaps * c * c / 20)))
    pushed = np.sqrt(np.sum(gaps * squares, axis=0) / span) / omega
    return Sizes(np.sqrt(swings / span) * omega, pushed, np.sqrt(whole / span) * omega)


@whole_kernel
def _move(
    time: np.ndarray,
    value: np.ndarray,
    slope: np.ndarray,
    curvature: np.ndarray,
    omega: np.ndarray,
    ratio: np.ndarray,
    swings: np.ndarray,
    whole: np.ndarray,
) -> None:
    """Integrals over time (nm,), added to what is there: of the square of Re A exp(λt), and of q² by trapezoids."""
    for m in range(omega.size):
        w, zeta = omega[m], ratio[m]
        fast = w * np.sqrt(1 - zeta * zeta)
        rate = complex(-zeta * w, fast)
        q, dq = value[0, m] / w**2, 0.0
        for k in range(len(value)):
            a, b, c, span = value[k, m] / w**2, slope[k, m] / w**3, curvature[k, m] / w**4, time[k + 1] - time[k]
            bend = (4 * zeta * zeta - 1) * c
            x, v = q - (a - 2 * zeta * b + bend), dq / w - (b - 2 * zeta * c)
            swing = complex(x, -(v + zeta * x) * w / fast)
            later = np.exp(rate * span)
            grown = (abs(later) ** 2 - 1) / (-2 * zeta * w) if zeta * w * span > 1e-8 else span
            swings[m] += 0.5 * (abs(swing) ** 2 * grown + (swing * swing * (later * later - 1) / (2 * rate)).real)
            swing *= later
            t, before = w * span, q
            a, b = a + t * (b + 0.5 * t * c), b + t * c
            q = a - 2 * zeta * b + bend + swing.real
            dq = w * (b - 2 * zeta * c) + (rate * swing).real
            whole[m] += 0.5 * span * (before * before + q * q)
