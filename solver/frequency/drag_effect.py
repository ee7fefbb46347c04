"""What the members' linearised drag leaves out of a frame's statistics, by how far from Gaussian drag is.

Drag is |z|z of a normal number z, which has 3π/8 of the variance of its linear part and is far from Gaussian: ⟨z⁸⟩ is
35/3 of ⟨z⁴⟩². Where it makes a part S of a stress by bending, and all else a Gaussian rest s, that stress is

    S |z|z/√3 + s ξ,   of one wave S (3π/8) |cos|cos and what else there is;

of a frame that swings among the waves S is what is as far from Gaussian, and belongs to the rest else: see `_kept`.

Its higher orders are lines of the case below the fastest wave (see beyond). Of those above it no line tells: a quarter
of the third order, at sums of three frequencies, and of one wave all that is at three times its frequency.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from solver.frequency import gaussian
from solver.frequency.case import Case
from solver.frequency.response import Response
from solver.lines import real_by_complex
from solver.statistics import FAINT, STATISTICS

WHOLE = 3 * np.pi / 8  # variance of |z|z over that of its linear part; over |cos|cos the size of its linear part
BINS = 512  # of frequencies up to the fastest wave's
LITTLE = 2e-2  # share of the variance of the legs' tops below which no statistic of their stress is off by 1e-3


def _normal(count: int) -> tuple[np.ndarray, np.ndarray]:
    x, weight = np.polynomial.hermite_e.hermegauss(count)
    return x, weight / weight.sum()


Z, OF_Z = _normal(40)
XI = np.linspace(-5.0, 5.0, 61)  # evenly, for what is smooth but for a corner
OF_XI = np.exp(-0.5 * XI**2) / np.exp(-0.5 * XI**2).sum()
WEIGHT = np.outer(OF_Z, OF_XI).ravel()


class Effect(NamedTuple):
    """Of what a linear response leaves out."""

    error: float  # of any mean, rms or std, relative
    extremes: float  # factor by which the largest are to be expected beyond those told


def drag_effect(
    case: Case, response: Response, level: np.ndarray, lines: np.ndarray, told: Mapping[str, np.ndarray]
) -> Effect:
    """level (1, ny) and lines (nl, ny): of the frame's forces; told: statistics of tops and feet."""
    channels, waves = case.channels, case.waves.size
    if channels.legs is None or not case.stations.size:
        return Effect(0.0, 1.0)
    push, nm = response.drag.modes[:waves], len(channels.legs.tops)
    tops, std = channels.legs.tops.reshape(nm, -1), told["top_displacement"][..., STATISTICS.index("std")].ravel()
    p = (case.gains * push).reshape(2 * waves, nm)
    size = np.abs(real_by_complex(tops.T, p.T)).reshape(-1, 2, waves)
    driven, missing = np.sqrt(0.5 * np.sum(size**2, axis=2)).T
    moved = std > FAINT * std.max()
    std, driven, missing = std[moved], driven[moved], missing[moved]
    error = float(np.max(np.hypot(1, missing / std) - 1, initial=0.0))
    if not np.any(driven**2 > LITTLE * std**2):
        return Effect(error, 1.0)
    extremes, kept = 1.0, 1.0
    if waves > 1:
        kept = _kept(case, tops[:, moved][:, np.argmax(driven)], p[:waves], push)
        driven *= kept
        peak = gaussian.peak(response.X[:, :nm] @ tops[:, moved], case.process)
        extremes = _beyond_rayleigh(driven, std, peak)
    if channels.steel is not None:
        first = channels.legs.first
        mean, whole = (channels.steel.compression(y)[:, first] for y in (level, lines))
        part = kept * channels.steel.compression(_forces_by_drag(case, response, p[:waves]))[:, first]
        changes = _of_one(mean[0], whole[0], part[0]) if waves == 1 else _of_sea(mean[0], whole, part)
        error = max(error, _apart(told["bottom_stress"][first], *changes))
    return Effect(error, extremes)


def _kept(case: Case, top: np.ndarray, p: np.ndarray, push: np.ndarray) -> float:
    """Share of what drag moves, of its foremost mode, that is as far from Gaussian as the drag: all where it follows.

    A mode that swings adds up many of its forces q, unit normal ones of std σ: with R the covariance of its part D of
    a top's motion, std S, and q before, and a third of q³ - 3q beside each 2q of |q|q, ⟨D³D₃⟩ = σ ∫ h(τ) R(τ)³ dτ, h
    from force to motion; where it follows S⁴. top (nm,), modes p and drag's forces on them (nw, nm).
    """
    m, (w, structure) = int(np.argmax(np.abs(top) * np.linalg.norm(p, axis=0))), (case.waves, case.system.structure)
    D, Q, step = top[m] * p[:, m], push[:, m], w.max() / BINS
    S, sigma = gaussian.spread(np.stack([D, Q], axis=1))
    power, place = D * Q.conj() / sigma, np.rint(w / step).astype(int)
    c = np.bincount(place, power.real, 4 * BINS + 1) - 1j * np.bincount(place, power.imag, 4 * BINS + 1)
    three = np.fft.rfft((2 * BINS * np.fft.irfft(c)) ** 3) / (8 * BINS)
    at = step * np.arange(three.size)
    three[1:] *= 2
    own, h = structure.omega[m], structure.damping[m]
    gain = top[m] / (own * (own - 2j * h * at) - at**2)
    return float(np.clip(sigma * np.sum(three * gain).real / S**4, 0.0, 1.0) ** 0.25)


def _beyond_rayleigh(driven: np.ndarray, std: np.ndarray, peak: np.ndarray) -> float:
    """Factor for the largest S z²/√3 + s ξ where z² + ξ² = u², reached as often as u by a Gaussian."""
    part = np.minimum(np.sqrt(WHOLE) * driven, std)
    turn = np.linspace(0.0, np.pi / 2, 40)[:, None]
    size = part * peak**2 * np.cos(turn) ** 2 / np.sqrt(3) + np.sqrt(std**2 - part**2) * peak * np.sin(turn)
    return float(np.max(size.max(axis=0) / (std * peak), initial=1.0))


def _apart(told: np.ndarray, mean: np.ndarray, variance: np.ndarray) -> float:
    """Largest relative error of mean, rms or std (n, 5) by what their mean and variance lack (n,)."""
    level, rms, std = told[:, 2:].T
    spread = np.abs(np.sqrt((std**2 + variance).clip(min=0.0)) / std - 1)
    size = np.abs(np.sqrt(((level + mean) ** 2 + std**2 + variance).clip(min=0.0)) / rms - 1)
    return float(np.max([np.abs(mean) / rms, size, spread]))


def _forces_by_drag(case: Case, response: Response, p: np.ndarray) -> np.ndarray:
    """Of the frame (nw, ny), by its drag and modes p (nw, nm) that this alone moves."""
    support, rate = case.system.support, -1j * case.waves[:, None]
    if support is None or support.forces is None:
        return np.zeros((len(p), 0))
    forces, none = support.forces, np.zeros((len(p), case.system.structure.carrier.shape[0]))
    return forces.whole(forces.of_motion(rate * p, rate**2 * p, none) + response.drag.forces[: len(p)])


def _of_one(mean: np.ndarray, whole: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What mean and variance of one wave's compression lack, of means and lines (n, 3): |cos|cos of the drag's part."""
    cos, size = gaussian.one_period(np.exp(1j * np.angle(part)).reshape(1, -1)), np.abs(part).ravel()
    usual = mean.ravel() + gaussian.one_period(whole.reshape(1, -1))
    both = (usual, usual + size * (WHOLE * np.abs(cos) - 1) * cos)
    before, after = (x[:, :, 0] - np.hypot(x[:, :, 1], x[:, :, 2]) for x in (y.reshape(-1, *mean.shape) for y in both))
    return after.mean(axis=0) - before.mean(axis=0), after.var(axis=0) - before.var(axis=0)


def _of_sea(mean: np.ndarray, whole: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same of means (n, 3) and lines (nw, n, 3), by bending along the line in which drag bends a leg most.

    What lies across it is as large as it is in the mean square.
    """
    of_whole, of_part = _second(whole), _second(part)
    angle = 0.5 * np.arctan2(2 * of_part[2], of_part[0] - of_part[1])
    cos, sin = np.cos(angle), np.sin(angle)

    def along(moments: np.ndarray) -> np.ndarray:
        return cos**2 * moments[0] + sin**2 * moments[1] + 2 * sin * cos * moments[2]

    mean = np.array([cos * mean[:, 1] + sin * mean[:, 2], cos * mean[:, 2] - sin * mean[:, 1]])
    variance = along(of_whole)
    std, other = np.sqrt(variance), np.sqrt(mean[1] ** 2 + (of_whole[0] + of_whole[1] - variance).clip(min=0.0))
    driven = np.minimum(np.sqrt(WHOLE * along(of_part)), std)
    z, rest = Z[:, None, None], np.sqrt(std**2 - driven**2) * XI[:, None]
    before, after = (
        np.hypot(mean[0] + driven * x + rest, other).reshape(-1, std.size) for x in (z, np.abs(z) * z / np.sqrt(3))
    )
    less = WEIGHT @ (after - before)
    return -less, WEIGHT @ (after**2 - before**2) - (WEIGHT @ after) ** 2 + (WEIGHT @ before) ** 2


def _second(lines: np.ndarray) -> np.ndarray:
    """Variances about both axes and covariance (3, n) of bending, lines (nw, n, 3)."""
    b, c = lines[..., 1], lines[..., 2]
    return 0.5 * np.sum([np.abs(b) ** 2, np.abs(c) ** 2, (b * c.conj()).real], axis=1)
