"""Running statistics of a record that is never held whole."""

import numpy as np

STATISTICS = ("max", "min", "mean", "rms", "std")


class Statistics:
    """max, min, mean, rms and std (ddof 0) of channels (…,) from blocks (m, …) in time order."""

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
            self.high, self.low, self.mean, self.spread = block.max(axis=0), block.min(axis=0), mean, spread
        else:
            n = self.count
            gap = mean - self.mean
            self.high, self.low = np.maximum(self.high, block.max(axis=0)), np.minimum(self.low, block.min(axis=0))
            self.mean = self.mean + gap * (m / (n + m))
            self.spread = self.spread + spread + gap**2 * (n * m / (n + m))
        self.count += m

    def table(self) -> np.ndarray:
        """(…, 5) in the order of STATISTICS."""
        variance = self.spread / self.count
        return np.stack([self.high, self.low, self.mean, np.sqrt(self.mean**2 + variance), np.sqrt(variance)], axis=-1)
