"""A force on a node that goes with time: wind, a crane, a ship; straight between the samples that are given."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from solver.errors import InputError, refuse


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadHistory:
    """Force (n, 3) [N], global axes, on a node at times (n,) [s] from the start of the run.

    A step with a bend of it in the middle is exact to second order, all others to fourth.
    """

    node: str
    time: np.ndarray
    force: np.ndarray

    def __post_init__(self) -> None:
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        key = f"load_histories.{self.node}"
        if self.time.size < 2:
            yield InputError(f"{key}.time", f"{self.time.size} times", "needs at least two")
        elif not np.all(rises := np.diff(self.time) > 0):
            at = int(np.argmin(rises)) + 1
            yield InputError(f"{key}.time", f"{self.time[at]:g}", f"must be > {self.time[at - 1]:g} s, the one before")
        if self.force.shape != (self.time.size, 3):
            limit = f"must have three components at each of {self.time.size} times"
            yield InputError(f"{key}.force", f"of shape {self.force.shape}", limit)
        for name, values in (("time", self.time), ("force", self.force)):
            if not np.all(np.isfinite(values)):
                yield InputError(f"{key}.{name}", "a gap", "every number must be finite")

    def at(self, t: np.ndarray) -> np.ndarray:
        """Force (m, 3) [N] at times (m,) [s]; level beyond its ends."""
        return np.stack([np.interp(t, self.time, along) for along in self.force.T], axis=-1)

    def bend(self, end: float) -> tuple[float, float]:
        """Largest change of its slope after the start and before an end [N/s], and when that is [s]: never, if there is
        none."""
        slope = np.diff(self.force, axis=0) / np.diff(self.time)[:, None]
        change = np.linalg.norm(np.diff(slope, axis=0, prepend=0.0, append=0.0), axis=1)
        change *= (self.time > 0) & (self.time < end)
        at = int(np.argmax(change))
        return float(change[at]), float(self.time[at]) if change[at] > 0 else np.inf

    @property
    def axes(self) -> np.ndarray:
        """Numbers of the global axes along which it is not always zero."""
        return np.flatnonzero(self.force.any(axis=0))


def in_plane(histories: Iterable[LoadHistory], nodes: Mapping[str, tuple[float, float, float]]) -> bool:
    """Whether loads on nodes of these places are mirror images of themselves in y = 0."""
    return not any(history.force[:, 1].any() or nodes[history.node][1] for history in histories)
