"""Whether a record of one wave is periodic yet: the std of what moves in whole periods at either end of it."""

from collections.abc import Iterator, Mapping

import numpy as np

from solver.record.channels import DIMS, Channels
from solver.scene import Scene, unit_along
from solver.statistics import FAINT, STATISTICS, Statistics

SETTLED = 0.01  # of a std: what the record's first and last periods may differ by
PARTS = 3  # of the record, of which the first and the last are compared
JUDGED = {"rotation": "rad", "motion": "", "top_displacement": "m", "bottom_stress": "Pa"}  # units, of an axis its own


class Settling:
    """Statistics of the first third of a record and its last, as far as they are of whole periods of a single wave."""

    def __init__(self, scene: Scene):
        s, met = scene.settings, scene.sea.omega[scene.sea.amplitude != 0]
        self.period = 2 * np.pi / met[0] if met.size == 1 else np.inf
        whole = self.period * (s.duration // (PARTS * self.period)) if np.isfinite(self.period) else 0.0
        end = s.discard + s.duration
        self.parts = [(s.discard, s.discard + whole), (end - whole, end)] if whole else []
        self.statistics: dict[str, list[Statistics]] = {}  # of channels in each part
        self.shapes: dict[str, tuple[int, ...]] = {}

    def add(self, times: np.ndarray, channels: Mapping[str, np.ndarray]) -> None:
        """Take in channels (m, …) at times (m,) [s]."""
        for n, (begin, end) in enumerate(self.parts):
            inside = (times > begin) & (times <= end)
            for name in JUDGED.keys() & channels.keys():
                self.shapes[name] = channels[name].shape[1:]
                parts = self.statistics.setdefault(name, [Statistics() for _ in self.parts])
                parts[n].add(channels[name].reshape(len(times), -1)[inside])

    def notes(self, channels: Channels) -> Iterator[str]:
        """A sentence for what is farthest from being periodic, if anything is, of what moves."""
        off, sentence = max(self._apart(channels), default=(0.0, ""))
        if off > SETTLED:
            yield sentence

    def _apart(self, channels: Channels) -> Iterator[tuple[float, str]]:
        """Of each channel by how much the stds of a number of it differ at most, of the larger, and that in words."""
        height = np.abs(channels.scene.sea.amplitude).max(initial=0.0)
        for name, parts in self.statistics.items():
            if not all(part.count for part in parts):
                continue
            first, last = (part.table()[:, STATISTICS.index("std")].reshape(self.shapes[name]) for part in parts)
            largest = np.fmax(first, last)
            least = FAINT * np.nanmax(largest, initial=0.0)
            if name in ("rotation", "motion"):
                least = FAINT * height / _reach(channels, name)
            off = np.nan_to_num(np.abs(first - last) / np.maximum(largest, 1e-300) * (largest > least))
            at = np.unravel_index(off.argmax(), off.shape)
            unit = JUDGED[name] or unit_along(channels.axes[at[-1]])
            sentence = (
                f"{_of(channels, name, at)} is not periodic yet, its std {first[at]:.3g} {unit} in the record's first"
                f" third and {last[at]:.3g} in its last: what is left of the start is in all statistics; a longer"
                " discard takes it out"
            )
            yield float(off[at]), sentence


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
