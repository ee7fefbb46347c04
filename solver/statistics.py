"""Running statistics of a record that is never held whole."""

import numpy as np

from solver.kernels import lean_kernel, whole_lean_kernel

STATISTICS = ("max", "min", "mean", "rms", "std")
FAINT = 1e-3  # share of the largest of its kind below which a channel counts as zero


class Statistics:
    """max, min, mean, rms and std (ddof 0) of channels (n,) from blocks (m, n) in time order.

    An extreme lies between samples as a rule: it is that of the parabola through a sample and its neighbours.
    """

    def __init__(self) -> None:
        self.count = 0

    def add(self, block: np.ndarray) -> None:
        """Take in the next samples; moments are merged as in Chan, Golub and LeVeque (1979)."""
        m = len(block)
        if m == 0:
            return
        mean = block.mean(axis=0)
        spread = ((block - mean) ** 2).sum(axis=0)
        if self.count == 0:
            self.high, self.low, self.mean, self.spread = block[0].copy(), block[0].copy(), mean, spread
            self.last = np.full((2, block.shape[1]), np.nan)
        else:
            n = self.count
            gap = mean - self.mean
            self.mean = self.mean + gap * (m / (n + m))
            self.spread = self.spread + spread + gap**2 * (n * m / (n + m))
        _extremes(block, self.last, self.high, self.low)
        self.count += m

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
def _extremes(block: np.ndarray, last: np.ndarray, high: np.ndarray, low: np.ndarray) -> None:
    """Update high and low (n,) with the next samples; `last` (2, n) holds the two before them."""
    for i in range(block.shape[0]):
        for c in range(block.shape[1]):
            new = block[i, c]
            middle = vertex(last[0, c], last[1, c], new)
            last[0, c], last[1, c] = last[1, c], new
            for value in (middle, new):
                high[c] = max(high[c], value)
                low[c] = min(low[c], value)
