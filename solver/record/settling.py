"""Whether a record of one wave is periodic yet: the std of what moves in whole periods at either end of it.

Motions' means there tell in any sea what drifts.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from solver.record.channels import DIMS, Channels
from solver.scene import Scene, unit_along
from solver.statistics import FAINT, STATISTICS, Statistics

SETTLED = 0.01  # of a std: what the record's first and last periods may differ by
ENDS = 0.5  # and besides, of one over the number of their samples, which do not end where whole periods do
PARTS = 3  # of the record, of which the first and the last are compared
MOTIONS = "rotation", "motion"
# Units, of an axis its own. Stress at legs' feet tells the same, with corners that samples miss by more than SETTLED.
JUDGED = {"rotation": "rad", "motion": "", "top_displacement": "m"}


class Settling:
    """Statistics of the first third of a record and its last, of a single wave as far as they are of whole periods."""

    def __init__(self, scene: Scene):
        s, met = scene.settings, scene.sea.omega[scene.sea.amplitude != 0]
        self.period = 2 * np.pi / met[0] if met.size == 1 else np.inf
        self.mean_period = scene.sea.parameters()["Tz"]
        self.judged = JUDGED.keys() if np.isfinite(self.period) else set(MOTIONS)
        whole = s.duration / PARTS if met.size else 0.0
        if np.isfinite(self.period):
            whole = self.period * (whole // self.period)
        end = s.discard + s.duration
        self.parts = [(s.discard, s.discard + whole), (end - whole, end)] if whole else []
        self.statistics: dict[str, list[Statistics]] = {}  # of channels in each part
        self.shapes: dict[str, tuple[int, ...]] = {}

    def add(self, times: np.ndarray, channels: Mapping[str, np.ndarray]) -> None:
        """Take in channels (m, …) at times (m,) [s]."""
        for n, (begin, end) in enumerate(self.parts):
            inside = (times > begin) & (times <= end)
            for name in self.judged & channels.keys():
                self.shapes[name] = channels[name].shape[1:]
                parts = self.statistics.setdefault(name, [Statistics() for _ in self.parts])
                parts[n].add(channels[name].reshape(len(times), -1)[inside])

    def notes(self, channels: Channels) -> Iterator[str]:
        """A sentence for what is farthest from being periodic, if anything is, of what moves."""
        if not np.isfinite(self.period):
            return
        off, sentence = max(self._apart(channels), default=(0.0, ""))
        if off > SETTLED:
            yield sentence

    @property
    def parts_of_waves(self) -> float:
        """Share of a std by which two thirds' means of a motion may differ for waves that are not whole in them.

        Over n periods the mean of a cosine is |sin πn|/πn at most.
        """
        if np.isfinite(self.period):
            return 0.0
        begin, end = self.parts[0]
        return float(2 * np.sqrt(2) / np.pi * self.mean_period / (end - begin))

    def means(self) -> np.ndarray | None:
        """Of the joints' motions in the record's first and last third (2, nb, axes); None of less than two parts."""
        name = next((name for name in reversed(MOTIONS) if name in self.statistics), "")
        parts = self.statistics.get(name, [])
        if not parts or not all(part.count for part in parts):
            return None
        means = np.array([part.table()[:, STATISTICS.index("mean")] for part in parts])
        return means.reshape(len(parts), self.shapes[name][0], -1)

    def _apart(self, channels: Channels) -> Iterator[tuple[float, str]]:
        """Of each channel by how much the stds of a number of it differ at most, of the larger, beyond what samples at
        their ends may make, and that in words."""
        height = np.abs(channels.scene.sea.amplitude).max(initial=0.0)
        for name, parts in self.statistics.items():
            if not all(part.count for part in parts):
                continue
            first, last = (part.table()[:, STATISTICS.index("std")].reshape(self.shapes[name]) for part in parts)
            largest = np.fmax(first, last)
            least = FAINT * np.nanmax(largest, initial=0.0)
            if name in MOTIONS:
                least = FAINT * height / _reach(channels, name)
            off = np.nan_to_num(np.abs(first - last) / np.maximum(largest, 1e-300) * (largest > least))
            at = np.unravel_index(off.argmax(), off.shape)
            unit = JUDGED[name] or unit_along(channels.axes[at[-1]])
            left = "what is left of the start is in all statistics; a longer discard takes it out"
            grows = "it still grows, and a longer discard tells to what"
            sentence = (
                f"{_of(channels, name, at)} is not periodic yet, its std {first[at]:.3g} {unit} in the record's first"
                f" third and {last[at]:.3g} in its last: {left if first[at] > last[at] else grows}"
            )
            yield float(off[at] - ENDS / min(part.count for part in parts)), sentence


def _reach(channels: Channels, name: str) -> np.ndarray:
    """By how much a float of hinges, or of several axes, moves for their units [m]."""
    sizes = np.array([f.hull.size for f in channels.scene.floats])
    if name == "rotation":
        return sizes
    return np.where([unit_along(axis) == "m" for axis in channels.axes], 1.0, sizes[:, None])


def _of(channels: Channels, name: str, at: tuple[np.intp, ...]) -> str:
    """What a number of a channel is of."""
    if "float" in DIMS[name]:
        axis = "rotation" if name == "rotation" else channels.axes[at[1]]
        return f"floats.{channels.scene.floats[at[0]].name}: {axis}"
    return f"platform: {name} of leg {at[0] + 1}" + (f" along {'xyz'[at[1]]}" if len(at) > 1 else "")
