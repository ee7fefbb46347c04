"""Whether motions in one wave are periodic yet: their std in whole periods at either end of the record."""

from collections.abc import Iterator

import numpy as np

from solver.record.channels import Channels
from solver.scene import Scene, unit_along
from solver.statistics import FAINT

SETTLED = 0.02  # of a std: what the record's first and last periods may differ by
PARTS = 3  # of the record, of which the first and the last are compared


class Settling:
    """Sums over the first third of a record and its last, as far as they are of whole periods of a single wave."""

    def __init__(self, scene: Scene, axes: int):
        s, sea = scene.settings, scene.sea
        self.period = 2 * np.pi / sea.omega[0] if sea.omega.size == 1 and sea.amplitude.any() else np.inf
        whole = self.period * (s.duration // (PARTS * self.period)) if np.isfinite(self.period) else 0.0
        end = s.discard + s.duration
        self.parts = np.array([(s.discard, s.discard + whole), (end - whole, end)]) if whole else np.zeros((0, 2))
        self.sums = np.zeros((len(self.parts), 3, axes))  # of ones, of positions, of their squares

    def add(self, times: np.ndarray, joints: np.ndarray) -> None:
        """Take in positions (m, nj) of the joints' axes at times (m,) [s]."""
        for n, (begin, end) in enumerate(self.parts):
            inside = joints[(times > begin) & (times <= end)]
            self.sums[n] += [np.ones(inside.shape).sum(axis=0), inside.sum(axis=0), (inside**2).sum(axis=0)]

    def notes(self, channels: Channels) -> Iterator[str]:
        """A sentence for the axis that is farthest from being periodic, if one is, of those that move."""
        if not len(self.parts) or not self.sums[:, 0].all():
            return
        count, total, squares = np.moveaxis(self.sums, 1, 0)
        first, last = np.sqrt(np.maximum(squares / count - (total / count) ** 2, 0.0))
        floats = [channels.scene.floats[b] for b in channels.owner]
        reach = [1.0 if unit_along(n) == "m" else f.hull.size for f, n in zip(floats, channels.names, strict=True)]
        largest = np.maximum(first, last)
        moves = largest * reach > FAINT * np.abs(channels.scene.sea.amplitude).max()
        off = np.where(moves, np.abs(first - last) / np.maximum(largest, 1e-300), 0.0)
        j = int(off.argmax()) if off.size else 0
        if off.size and off[j] > SETTLED:
            yield (
                f"floats.{floats[j].name}: {channels.names[j]} is not periodic yet, its std {first[j]:.3g}"
                f" {unit_along(channels.names[j])} in the record's first third and {last[j]:.3g} in its last: what is"
                " left of the start is in all statistics; a longer discard takes it out"
            )
