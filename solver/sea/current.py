"""A steady current: its velocity at any depth. Waves that ride on it are as in still water, without Doppler's shift."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, out_of_range, take_tuples


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentSpeed:
    """A line of a current's table."""

    depth: Annotated[float, Quantity("m", least=0), "Below still water"]
    speed: Annotated[float, Quantity("m/s", least=0), "Of the current there"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Current:
    """U(z): a power law of the depth d, speed (1 + z/d)^exponent, or a table, straight between and level beyond."""

    speed: Annotated[
        float | None, Quantity("m/s", least=0), "At still water; at all depths where there is no exponent"
    ] = None
    exponent: Annotated[
        float, Quantity("-", least=0, most=10), "Of a power law, as a share of the height above the seabed: 1/7"
    ] = 0.0
    profile: Annotated[tuple[CurrentSpeed, ...], "Speeds by depth, downwards, in place of speed and exponent"] = ()
    direction: Annotated[
        float, Quantity("rad", least=-2 * np.pi, most=2 * np.pi), "Towards which it flows, from x to y"
    ] = 0.0

    def __post_init__(self) -> None:
        take_tuples(self)
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        yield from out_of_range(self, "current")
        if self.speed is None and not self.profile:
            yield InputError("current.speed", "nothing", "is missing, or a profile in its place [m/s]")
        if self.profile and (self.speed is not None or self.exponent):
            key = "exponent" if self.speed is None else "speed"
            yield InputError(f"current.{key}", getattr(self, key), "must be left out beside profile")
        for i, line in enumerate(self.profile):
            yield from out_of_range(line, f"current.profile[{i}]")
            if i and not line.depth > (above := self.profile[i - 1].depth):
                limit = f"must be > {above:g} m, the depth of the line before"
                yield InputError(f"current.profile[{i}].depth", line.depth, limit)

    @property
    def bends(self) -> tuple[float, ...]:
        """Heights [m] between which the speed is a power of the height above something."""
        return tuple(-line.depth for line in self.profile)

    @property
    def points(self) -> int:
        """Gauss points between those that integrate its drag on a member at rest: U² times a cubic shape."""
        return 2 + int(np.ceil(self.exponent if not self.profile else len(self.profile) > 1))

    def velocity(self, z: np.ndarray, depth: float) -> np.ndarray:
        """At heights z (n,) in water of a depth [m], (n, 3) [m/s]."""
        if self.profile:
            lines = np.array([(line.depth, line.speed) for line in self.profile]).T
            size = np.interp(-z, *lines)
        else:
            size = np.full(z.shape, self.speed or 0.0)
            if self.exponent:
                size = size * np.clip(1 + z / depth, 0.0, None) ** self.exponent
        return size[:, None] * np.array([np.cos(self.direction), np.sin(self.direction), 0.0])
