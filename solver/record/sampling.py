"""The error of a record's statistics, from samples of a part of it at two steps."""

from collections.abc import Mapping

import numpy as np

from solver.scene import Scene
from solver.statistics import FAINT

NEAR = 20  # gaps between samples: what a hit does to one of them it may take from the next
PARTS = 16  # of the samples, whose scatter tells chance from what stays
SURE = 6.0  # times the square of chance: of dozens of channels one reaches that by chance alone


def least_force(scene: Scene) -> np.ndarray:
    """(nb, 1) [N]: joint forces below it count as zero, as those along an axis that is free are."""
    return FAINT * scene.water.gravity * np.array([[f.mass] for f in scene.floats])


def expected_error(
    coarse: Mapping[str, np.ndarray], fine: Mapping[str, np.ndarray], least: Mapping[str, np.ndarray], longer: float
) -> float:
    """Largest error of any mean, rms and std that samples (m, …) lead to expect in a record `longer` times theirs."""
    return max(_of_kind(coarse[name], fine[name], least.get(name, np.zeros(())), longer) for name in fine)


def between_samples(samples: Mapping[str, np.ndarray], least: Mapping[str, np.ndarray], longer: float) -> float:
    """The same of a record that has every other one of these samples, by its trapezoids: what jumps lies between.

    Each gap errs by half of what its middle is off the mean of its ends. What jumps does so anywhere in a gap: those of
    m gaps that are near each other have a sum e, and the mean errs by (Σ e²)^½/m.
    """
    return max(_between(x, least.get(name, np.zeros(())), longer) for name, x in samples.items())


def _of_kind(x: np.ndarray, y: np.ndarray, least: np.ndarray, longer: float) -> float:
    least = np.broadcast_to(least, y.shape[1:]).ravel()
    x, y = x.reshape(len(x), -1), y.reshape(len(y), -1)
    return _expected([a - b for a, b in zip(_shares(x, x, y, least), _shares(y, x, y, least), strict=True)], longer)


def _between(x: np.ndarray, least: np.ndarray, longer: float) -> float:
    least, x = np.broadcast_to(least, x.shape[1:]).ravel(), x[: len(x) // 2 * 2].reshape(len(x) // 2 * 2, -1)
    kept = x[1::2]
    gaps = np.array([((s[1:-2:2] + s[3::2]) / 2 - s[2::2]) / 2 for s in _shares(x, kept, kept, least)])
    near = np.add.reduceat(gaps, np.arange(0, gaps.shape[1], NEAR), axis=1)
    errors = np.sqrt(np.sum(near**2, axis=1) / longer) / gaps.shape[1]
    return float(np.max(errors, where=np.isfinite(errors), initial=0.0))


def _shares(v: np.ndarray, x: np.ndarray, y: np.ndarray, least: np.ndarray) -> list[np.ndarray]:
    """Of samples v (m, n) in the mean, rms and std of channels, scaled as solver.statistics.apart does.

    v, v²/2r and (v - ȳ)²/2σ, with r of y and σ the mean of x's and y's: their means over x less those over y are the
    differences of these statistics.
    """
    mean, rms, std = y.mean(axis=0), np.sqrt(np.mean(y**2, axis=0)), y.std(axis=0)
    scale = [np.maximum(s, np.maximum(FAINT * np.nanmax(s, initial=0.0), least)) for s in (rms, std)]
    spread = np.sqrt(np.mean((x - mean) ** 2, axis=0)) + std
    with np.errstate(divide="ignore", invalid="ignore"):
        return [v / scale[0], v**2 / (2 * rms * scale[0]), (v - mean) ** 2 / (spread * scale[1])]


def _expected(errors: list[np.ndarray], longer: float) -> float:
    """Largest mean of errors (m, n) in a record `longer` times theirs.

    With E over all samples and s its standard error by the scatter of their PARTS, what stays is (E² - s²)^½ where it
    is SURE, and chance averages out: (E² - s² + s²/longer)^½; else (max(E², s²)/longer)^½.
    """
    count = min(PARTS, len(errors[0]))
    parts = np.array([[part.mean(axis=0) for part in np.array_split(e, count)] for e in errors])
    whole, chance = parts.mean(axis=1) ** 2, parts.var(axis=1, ddof=1) / count
    stays = np.where(whole > SURE * chance, whole - chance, 0.0)
    left = stays + np.maximum(whole - stays, chance) / longer
    return float(np.sqrt(np.max(left, where=np.isfinite(left), initial=0.0)))
