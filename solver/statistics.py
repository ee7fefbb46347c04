"""Running statistics of a record that is never held whole."""

import numpy as np

from solver.kernels import lean_kernel

STATISTICS = ("max", "min", "mean", "rms", "std")


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


@lean_kernel(inline="always")
def vertex(older, old, new):
    """Extreme of the parabola through three samples where it lies nearest to the middle one, else that sample.

    It does not pass zero where the middle sample does not, so that power stays positive; no channel misses much.
    """
    slope, bend = (new - older) / 2, older - 2 * old + new
    if not 2 * abs(slope) < abs(bend):
        return old
    top = old - slope * slope / (2 * bend)
    return top if top * old > 0 else 0.0


@lean_kernel
def _extremes(block, last, high, low):
    """Update high and low (n,) with the next samples; `last` (2, n) holds the two before them."""
    for i in range(block.shape[0]):
        for c in range(block.shape[1]):
            new = block[i, c]
            middle = vertex(last[0, c], last[1, c], new)
            last[0, c], last[1, c] = last[1, c], new
            for value in (middle, new):
                high[c] = max(high[c], value)
                low[c] = min(low[c], value)
