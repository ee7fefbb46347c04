"""The error of a record's statistics, from samples of a part of it at two steps."""

from collections.abc import Mapping

import numpy as np

from solver.scene import Scene
from solver.statistics import FAINT

PARTS = 8  # of the samples, whose scatter tells chance from what stays


def least_force(scene: Scene) -> np.ndarray:
    """(nb, 1) [N]: joint forces below it count as zero, as those along an axis that is free are."""
    return FAINT * scene.water.gravity * np.array([[f.mass] for f in scene.floats])


def expected_error(
    coarse: Mapping[str, np.ndarray], fine: Mapping[str, np.ndarray], least: Mapping[str, np.ndarray], longer: float
) -> float:
    """Largest error of any mean, rms and std that samples (m, …) lead to expect in a record `longer` times theirs."""
    return max(_of_kind(coarse[name], fine[name], least.get(name, np.zeros(())), longer) for name in fine)


def _of_kind(x: np.ndarray, y: np.ndarray, least: np.ndarray, longer: float) -> float:
    """Of channels of one kind, scaled as solver.statistics.apart does.

    Each statistic's error is the mean of one of d = x - y, (x² - y²)/2r, ((x - ȳ)² - (y - ȳ)²)/2σ. With E over all
    samples and s its standard error by the scatter of their PARTS, what stays is (E² - s²)^½, and chance averages
    out: (max(E² - s², 0) + s²/longer)^½.
    """
    least = np.broadcast_to(least, y.shape[1:]).ravel()
    x, y = x.reshape(len(x), -1), y.reshape(len(y), -1)
    mean, rms = y.mean(axis=0), np.sqrt(np.mean(y**2, axis=0))
    spread = [rms, np.sqrt(np.mean((x - mean) ** 2, axis=0)) + y.std(axis=0)]
    scale = [np.maximum(s, np.maximum(FAINT * np.nanmax(s, initial=0.0), least)) for s in (rms, y.std(axis=0))]
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = (
            (x - y) / scale[0],
            (x**2 - y**2) / (2 * spread[0] * scale[0]),
            ((x - mean) ** 2 - (y - mean) ** 2) / (spread[1] * scale[1]),
        )
    count = min(PARTS, len(x))
    parts = np.array([[part.mean(axis=0) for part in np.array_split(e, count)] for e in errors])
    whole, chance = parts.mean(axis=1) ** 2, parts.var(axis=1, ddof=1) / count
    stays = np.maximum(whole - chance, 0.0) + chance / longer
    return float(np.sqrt(np.max(stays, where=np.isfinite(stays), initial=0.0)))
