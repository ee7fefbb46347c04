"""Running statistics of a record that is never held whole."""

from collections.abc import Mapping

import numpy as np

from solver.kernels import lean_kernel, whole_lean_kernel

STATISTICS = ("max", "min", "mean", "rms", "std")
FAINT = 1e-3  # share of the largest of its kind below which a channel counts as zero


def of_joints(tables: Mapping[str, np.ndarray]) -> np.ndarray:
    """Statistics of the joints' motions (nb, axes, 5), of hinges alone those of their rotation."""
    return tables["motion"] if "motion" in tables else tables["rotation"][:, None]


class Statistics:
    """max, min, mean, rms and std (ddof 0) of channels (n,) from blocks (m, n) in time order.

    An extreme lies between samples as a rule: it is that of the parabola through a sample and its neighbours.
    """

    def __init__(self) -> None:
        self.count = 0

    def add(self, block: np.ndarray, smooth: np.ndarray | None = None) -> None:
        """Take in the next samples; moments are merged as in Chan, Golub and LeVeque (1979).

        smooth (m,): whether a parabola through a sample and the two before it is one through what lies between; where
        something jumps there it is not. Everywhere, if not given.
        """
        if len(block) == 0:
            return
        block = np.ascontiguousarray(block, float)
        smooth = np.ones(len(block), bool) if smooth is None else smooth
        if self.count == 0:
            self.high, self.low, self.last = block[0].copy(), block[0].copy(), np.full((2, block.shape[1]), np.nan)
            self.mean, self.spread, self.room = np.zeros((3, block.shape[1]))
        _take_in(block, smooth, self.count, self.room, self.last, self.high, self.low, self.mean, self.spread)
        self.count += len(block)

    def amend(self, values: np.ndarray, weight: np.ndarray) -> None:
        """Take in values (k, n) with weights (k,), in samples, of which the negative ones take samples back: Σ is 0."""
        values = np.ascontiguousarray(values, float)
        _weigh_in(values, weight, self.count, self.room, self.high, self.low, self.mean, self.spread)

    def add_to_sums(self, first: np.ndarray, second: np.ndarray) -> None:
        """Add to the sums of all values and of their squares (n,): to what these lack of what lies between samples."""
        shift = first / self.count
        self.spread += second - first * (2 * self.mean + shift)
        self.mean += shift

    def table(self) -> np.ndarray:
        """(n, 5) in the order of STATISTICS."""
        variance, known = self.spread / self.count, np.where(np.isnan(self.mean), np.nan, 1.0)
        rms = np.sqrt(self.mean**2 + variance)
        return np.stack([known * self.high, known * self.low, self.mean, rms, np.sqrt(variance)], axis=-1)


def moments(samples: np.ndarray) -> np.ndarray:
    """(n, 5) in the order of STATISTICS of samples (m, n), extremes as sampled."""
    mean, std = samples.mean(axis=0), samples.std(axis=0)
    return np.stack([samples.max(axis=0), samples.min(axis=0), mean, np.hypot(mean, std), std], axis=-1)


def apart(table: np.ndarray, exact: np.ndarray, least: float | np.ndarray = 0.0) -> float:
    """Largest error of any mean, rms and std of channels of one kind, tables (…, 5) in the order of STATISTICS.

    Of mean and rms relative to the rms, of std to the std; a channel that is FAINT beside the largest, or below
    `least`, as zero ones by symmetry are, is judged as if it were not.
    """
    (mean, *spread), (mean_, *spread_) = (np.moveaxis(t, -1, 0)[2:] for t in (table, exact))
    scale = [np.maximum(s, np.maximum(FAINT * np.nanmax(s, initial=0.0), least)) for s in spread_]
    differences = [(mean - mean_, scale[0]), *((a - b, c) for a, b, c in zip(spread, spread_, scale, strict=True))]
    return float(max(np.nanmax(np.abs(d)[s > 0] / s[s > 0], initial=0.0) for d, s in differences))


@lean_kernel(inline="always")
def vertex(older: float, old: float, new: float) -> float:
    """Extreme of the parabola through three samples where it lies nearest to the middle one, else that sample.

    It does not pass zero where the middle sample does not, so that power stays positive; no channel misses much.
    """
    slope, bend = (new - older) / 2, older - 2 * old + new
    if not 2 * abs(slope) < abs(bend):
        return old
    top = old - slope * slope / (2 * bend)
    return top if top * old > 0 else 0.0


@whole_lean_kernel
def _take_in(
    block: np.ndarray,
    smooth: np.ndarray,
    count: int,
    average: np.ndarray,
    last: np.ndarray,
    high: np.ndarray,
    low: np.ndarray,
    mean: np.ndarray,
    spread: np.ndarray,
) -> None:
    """Update extremes, mean and spread (n,) after `count` samples with the next; `last` (2, n) holds the two before.

    average (n,): that of the block.
    """
    m, n = block.shape
    average[:] = 0.0
    for i in range(m):
        for c in range(n):
            average[c] += block[i, c]
    for c in range(n):
        average[c] /= m
        gap = average[c] - mean[c]
        mean[c] += gap * (m / (count + m))
        spread[c] += gap**2 * (count * m / (count + m))
    for i in range(m):
        older, old = (block[i - 2], block[i - 1]) if i > 1 else (last[i], block[0] if i else last[1])
        for c in range(n):
            new = block[i, c]
            spread[c] += (new - average[c]) ** 2
            high[c], low[c] = max(high[c], new), min(low[c], new)
            if smooth[i] and (old[c] - older[c]) * (old[c] - new) > 0:
                middle = vertex(older[c], old[c], new)
                high[c], low[c] = max(high[c], middle), min(low[c], middle)
    for c in range(n):
        last[0, c], last[1, c] = block[m - 2, c] if m > 1 else last[1, c], block[m - 1, c]


@whole_lean_kernel
def _weigh_in(
    values: np.ndarray,
    weight: np.ndarray,
    count: int,
    shift: np.ndarray,
    high: np.ndarray,
    low: np.ndarray,
    mean: np.ndarray,
    spread: np.ndarray,
) -> None:
    """Update extremes, mean and spread (n,) of `count` samples with weighted ones (k, n); shift (n,): of the mean."""
    shift[:] = 0.0
    for i in range(values.shape[0]):
        for c in range(values.shape[1]):
            apart = values[i, c] - mean[c]
            shift[c] += weight[i] * apart
            spread[c] += weight[i] * apart**2
            high[c], low[c] = max(high[c], values[i, c]), min(low[c], values[i, c])
    for c in range(mean.size):
        shift[c] /= count
        spread[c] -= count * shift[c] ** 2
        mean[c] += shift[c]
