"""Resonances that a sea's waves are too far apart for: how far they move depends on where its lines fall.

A shape φ of unit inertia, of natural frequency ω₀ and damped by B, resonates over B about that, its half-power width.
Waves whose load φᵀF has the one-sided spectrum S there move it with the variance πS/(2Bω₀²), of lines however dense.
"""

from collections.abc import Iterator

import numpy as np

from solver.frequency.case import NARROW, Case
from solver.frequency.response import Response
from solver.lines import lengths
from solver.record.beside import radiating
from solver.statistics import FAINT

ASIDE = 4  # lines to each side of a resonance, by which the sea is known there
WITHIN = 2.0  # spacings of lines in a resonance's width, of which the variance hardly goes by where they fall
COUNTS = 0.05  # of a coordinate's variance: a resonance of less changes no std by more than a fortieth


def unresolved(case: Case, response: Response) -> Iterator[str]:
    """A sentence for each shape that resonates between lines of random phases, and has a part in what moves."""
    omega, modes, damping = case.waves, case.modes, case.model.damping + response.damping
    if case.system.scene.sea.known or omega.size <= 2 * ASIDE:
        return
    among = np.flatnonzero((modes.omega > omega[ASIDE]) & (modes.omega < omega[-ASIDE]))
    every, shapes = modes.omega[among], modes.shapes[:, among].T
    radiated = radiating(case.system, case.hydrodynamics, every, shapes)[1]
    widths = np.maximum(np.einsum("mi,mi->m", shapes @ damping, shapes) + radiated, 2 * NARROW * every)
    after = np.searchsorted(omega, every)
    spaces = (omega[after + ASIDE - 1] - omega[after - ASIDE]) / (2 * ASIDE - 1)
    if not (narrow := np.flatnonzero(widths < WITHIN * spaces)).size:
        return
    moved = _squares(case, lengths(np.ascontiguousarray(response.X[: omega.size].T)) ** 2 / 2)
    for k in narrow:
        own, shape, width, apart = every[k], shapes[k], widths[k], spaces[k]
        near = slice(after[k] - ASIDE, after[k] + ASIDE)
        spectrum = np.mean(np.abs(shape @ case.force_at_rest[:, near]) ** 2) / (2 * apart)
        most = _squares(case, np.pi * spectrum / (2 * width * own**2) * shape**2)
        if np.any((most > COUNTS * moved) & (np.maximum(most, moved) > FAINT**2 * moved.max())):
            needed = _rounded_up(omega.size * WITHIN * apart / width)
            yield (
                f"components: waves are {apart:.2g} rad/s apart where {modes.names[among[k]]} of period"
                f" {2 * np.pi / own:.3g} s resonates over {width:.2g} rad/s: {needed} components would resolve it"
            )


def _squares(case: Case, variance: np.ndarray) -> np.ndarray:
    """Of the frame's modes together and of each joint (1 + nj,) [m2], how far they move, by coordinates (n,)."""
    squares, nm = case.model.length**2 * variance, case.model.modes.shape[1]
    return np.append(squares[:nm].sum(), squares[nm:])


def _rounded_up(count: float) -> int:
    """To two digits."""
    digit = 10 ** max(int(np.log10(count)) - 1, 0)
    return int(np.ceil(count / digit)) * digit
