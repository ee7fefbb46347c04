"""The finest of three meshes at every other frequency: it takes three quarters of the time, and little is new in it.

Between, it is what an error ~ h² lets expect of it by the other two, which are solved at all frequencies, and a spline
of what it differs by from that: a difference as small as the meshes' own error, and smooth. Where it is not, as the
spline tells by how much it errs at a frequency left out, more are solved.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

FEWEST = 32  # frequencies of which some are left out: fewer are far apart already
# Of the error of a spline without a frequency, to be expected between those that there are: where curves are smooth a
# sixteenth, where waves between bodies turn their phase by more than 1 rad up to all of it.
LEFT_OUT = 0.25
ENOUGH = 1e-3  # of a curve's largest value: a memory that fits to 5e-3 does not notice such errors
FAINT = 0.1  # of the largest motion's: size of the impedance below which it counts as that, per length


class Solution(NamedTuple):
    """Of one mesh at nw frequencies, for nh headings."""

    impedance: np.ndarray  # (nw, n, n) A + iB/ω
    infinite: np.ndarray  # (n, n) A∞
    diffraction: np.ndarray  # (nw, nh, n) force
    far: np.ndarray  # (nw, n + nh, 2M + 1) modes of H, of each motion and heading; empty where not asked for
    lid: float  # area of damping lids [m²]
    panels: int  # on hulls


class Turns(NamedTuple):
    """Phases that waves have on their way, without which curves are smooth."""

    impedance: np.ndarray  # (nw, n, n) from body to body
    diffraction: np.ndarray  # (nw, nh, n) to each body


def left_out(count: int) -> np.ndarray:
    """Which of so many frequencies the finest mesh has: every other one, and the last."""
    return np.arange(count) if count < FEWEST else np.union1d(np.arange(0, count, 2), [count - 1])


def completed(
    solutions: Sequence[Solution],
    divisions: tuple[int, ...],
    known: np.ndarray,
    omega: np.ndarray,
    turns: Turns,
    lengths: np.ndarray,
    solve: Callable[[np.ndarray], Solution],
) -> tuple[Solution, list[np.ndarray]]:
    """The finest of three solutions at all frequencies (nw,), from `known` ones and what `solve` adds to them.

    And what its impedance and diffraction may err by between (nw, ...). lengths: of the motions.
    """
    finest, middle, coarse = solutions
    fine, mid, base = (1 / n**2 for n in divisions)
    step = (mid - fine) / (base - mid)
    expected: list[Any] = [m + step * (m - c) for m, c in ((middle[k], coarse[k]) for k in (0, 2))]
    scales = _scales(middle, lengths)
    while True:
        found: list[np.ndarray] = []
        doubts: list[np.ndarray] = []
        for kind, turn, law in zip((finest.impedance, finest.diffraction), turns, expected, strict=True):
            rest = (kind - law[known]) * turn[known].conj()
            found.append(law + CubicSpline(omega[known], rest)(omega) * turn)
            found[-1][known] = kind
            doubts.append(_doubt(omega, known, rest))
        doubtful = _largest(doubts, scales) > ENOUGH
        if not doubtful.any():
            whole = finest._replace(impedance=found[0], diffraction=found[1], far=middle.far)
            return whole, doubts
        finest, known = _joined(finest, known, solve(np.flatnonzero(doubtful)), np.flatnonzero(doubtful))


def _doubt(omega: np.ndarray, known: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """What a spline of `rest` at known frequencies may err by at all (nw, ...): by the larger of two neighbours'."""
    missed = np.zeros((len(known), *rest.shape[1:]))
    for j in range(1, len(known) - 1):
        others = np.delete(np.arange(len(known)), j)
        missed[j] = np.abs(CubicSpline(omega[known[others]], rest[others])(omega[known[j]]) - rest[j])
    after = np.searchsorted(known, np.arange(len(omega))).clip(1)
    doubt = LEFT_OUT * np.maximum(missed[after - 1], missed[after])
    doubt[known] = 0.0
    return doubt


def _scales(solution: Solution, lengths: np.ndarray) -> list[np.ndarray]:
    """Largest values of impedance (n, n) and diffraction (n,), of motions that hardly radiate as if they did."""
    size = np.sqrt(np.abs(np.einsum("wii->wi", solution.impedance)).max(axis=0)) / lengths
    force = np.abs(solution.diffraction).max(axis=(0, 1)) / lengths
    size, force = (lengths * np.maximum(x, FAINT * x.max()) for x in (size, force))
    return [np.outer(size, size), force]


def _largest(errors: Sequence[np.ndarray], scales: Sequence[np.ndarray]) -> np.ndarray:
    """Of their scales, at each frequency (nw,)."""
    return np.max([np.abs(e / s).reshape(len(e), -1).max(axis=1) for e, s in zip(errors, scales, strict=True)], axis=0)


def _joined(one: Solution, at: np.ndarray, other: Solution, there: np.ndarray) -> tuple[Solution, np.ndarray]:
    """Solutions at different frequencies as one, and its frequencies' numbers in order."""
    whole = np.concatenate([at, there])
    order = np.argsort(whole)
    pairs = ((one.impedance, other.impedance), (one.diffraction, other.diffraction))
    impedance, diffraction = (np.concatenate(pair)[order] for pair in pairs)
    return one._replace(impedance=impedance, diffraction=diffraction), whole[order]
