"""Power take-offs by more than a few numbers: a table of their load by rate, and their efficiency."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, out_of_range

MOST_POINTS = 100  # each of which may cut a step in two
ROUNDING = 1e-9  # of the largest load


@dataclass(frozen=True, slots=True, kw_only=True)
class PtoEfficiency:
    """Of a power take-off in each direction; what it does to the water is told by its forces, not by these."""

    generating: Annotated[
        float, Quantity("-", above=0, most=1), "Electrical power over mechanical, while it is absorbed"
    ] = 1.0
    motoring: Annotated[
        float, Quantity("-", above=0, most=1), "Mechanical power over electrical, while it is given back"
    ] = 1.0

    def electrical(self, power: np.ndarray) -> np.ndarray:
        """Electrical power of mechanical power P [W]: η P where P > 0, P/η_m where it flows back."""
        return np.where(power > 0, self.generating * power, power / self.motoring)


@dataclass(frozen=True, slots=True, kw_only=True)
class PtoTable:
    """Load of a power take-off by the rate of its axis, which it is against: straight lines, level beyond their ends.

    From rate 0 on it is for both senses alike.
    """

    velocity: Annotated[tuple[float, ...], Quantity("rad/s or m/s"), "Rates of the axis, increasing"]
    force: Annotated[tuple[float, ...], Quantity("N m or N"), "Load against the motion at these, as a positive power"]
    axis: Annotated[str, "The axis of `motion` that it acts on; the only one where it is left out"] = ""

    def __post_init__(self) -> None:
        refuse(out_of_range(self, "pto_table"))
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        v, f = np.array(self.velocity), np.array(self.force)
        if v.size != f.size or not 2 <= v.size <= MOST_POINTS:
            limit = f"must be 2 to {MOST_POINTS} rates, and a load for each; there are {f.size} loads"
            yield InputError("pto_table.velocity", v.size, limit)
        elif np.any(falls := np.diff(v) <= 0):
            yield InputError("pto_table.velocity", v[1:][falls][0], f"must increase; it follows {v[:-1][falls][0]:g}")
        elif not v[0] <= 0 < v[-1]:
            limit = "must begin at 0, for both senses alike, or below, and end above 0"
            yield InputError("pto_table.velocity", (v[0], v[-1]), limit)
        elif np.any(gives := f * v < 0):
            limit = f"must take power: no load along the motion, here at {v[gives][0]:g}"
            yield InputError("pto_table.force", f[gives][0], limit)
        elif abs(at_rest := float(np.interp(0.0, v, f))) > ROUNDING * np.abs(f).max():
            yield InputError("pto_table.force", at_rest, "must be 0 at rate 0; `coulomb` is a load that jumps there")

    @property
    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """Rates and loads of both senses."""
        v, f = np.array(self.velocity, float), np.array(self.force, float)
        if v[0] < 0:
            return v, f
        return np.concatenate([-v[:0:-1], v]), np.concatenate([-f[:0:-1], f])
