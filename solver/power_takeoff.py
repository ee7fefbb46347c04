"""Power take-offs by more than a few numbers: a table of their load by rate, and their efficiency."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, out_of_range, take_tuples

MOST_POINTS = 500  # each of which may cut a step in two
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

    @property
    def uneven(self) -> bool:
        """Whether electrical power has a corner where the mechanical one changes its sign."""
        return self.generating * self.motoring != 1

    def electrical(self, power: np.ndarray) -> np.ndarray:
        """Electrical power of mechanical power P [W]: η P where P > 0, P/η_m where it flows back."""
        return np.where(power > 0, self.generating * power, power / self.motoring)


@dataclass(frozen=True, slots=True, kw_only=True)
class PtoTable:
    """Load of a power take-off by the rate of its axis, which it is against: straight lines, level beyond their ends.

    From rate 0 on it is for both senses alike. With positions it is bilinear between them, and level beyond, too; it
    may then give power and, where rates begin below 0, have a load at rest.
    """

    velocity: Annotated[tuple[float, ...], Quantity("rad/s or m/s"), "Rates of the axis, increasing"]
    force: Annotated[
        tuple[float, ...],
        Quantity("N m or N"),
        "Load against the motion at these, as a positive power; with positions at all rates of the first, of the next",
    ]
    position: Annotated[tuple[float, ...], Quantity("rad or m"), "Positions of the axis from rest, increasing"] = ()
    axis: Annotated[str, "The axis of `motion` that it acts on; the only one where it is left out"] = ""
    finer: Annotated["PtoTable | None", "The law that it stands for, by more points"] = None

    def __post_init__(self) -> None:
        take_tuples(self)
        refuse(out_of_range(self, "pto_table"))
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        v, y = np.array(self.velocity), np.array(self.position)
        if y.size and not 2 <= y.size <= MOST_POINTS:
            yield InputError("pto_table.position", y.size, f"must be 2 to {MOST_POINTS} positions")
        elif len(self.force) != v.size * max(y.size, 1) or not 2 <= v.size <= MOST_POINTS:
            each = "and a load for each" if not y.size else f"and loads for each at each of {y.size} positions"
            limit = f"must be 2 to {MOST_POINTS} rates, {each}; there are {len(self.force)} loads"
            yield InputError("pto_table.velocity", v.size, limit)
        elif falling := [(name, x) for name, x in (("velocity", v), ("position", y)) if np.any(np.diff(x) <= 0)]:
            name, x = falling[0]
            falls = np.diff(x) <= 0
            limit = f"must increase; it follows {x[:-1][falls][0]:g}"
            yield InputError(f"pto_table.{name}", x[1:][falls][0].item(), limit)
        elif not v[0] <= 0 < v[-1]:
            limit = "must begin at 0, for both senses alike, or below, and end above 0"
            yield InputError("pto_table.velocity", tuple(v[[0, -1]].tolist()), limit)
        elif v[0] == 0 or not y.size:
            yield from self._at_rest()

    def _at_rest(self) -> Iterator[InputError]:
        """A load by rate alone takes power; one for both senses alike is none at rest."""
        v, f = np.array(self.velocity), np.array(self.force).reshape(-1, len(self.velocity))
        if not self.position and np.any(gives := f[0] * v < 0):
            limit = f"must take power: no load along the motion, here at {v[gives][0]:g}"
            yield InputError("pto_table.force", f[0][gives][0], limit)
        else:
            at_rest = max((float(np.interp(0.0, v, line)) for line in f), key=abs)
            if abs(at_rest) > ROUNDING * np.abs(f).max():
                limit = "must be 0 at rate 0; `coulomb` is a load that jumps there"
                yield InputError("pto_table.force", at_rest, limit)

    def by_finer(self) -> "PtoTable":
        """The finer one, itself without one."""
        return self.finer or self

    def by_judged(self) -> "PtoTable":
        """The finer one if there is another behind it that tells of its error, else itself."""
        return self.finer if self.finer is not None and self.finer.finer is not None else self

    def on_finer_lines(self) -> "PtoTable":
        """This load at the points of the finer one, which has all lines of this one."""
        if self.finer is None:
            return self
        y, v = self.finer.position, self.finer.velocity
        f = np.array(self.force).reshape(-1, len(self.velocity))
        f = np.stack([np.interp(v, self.velocity, line) for line in f])
        if y:
            f = np.stack([np.interp(y, self.position, line) for line in f.T], axis=1)
        return replace(self, position=y, velocity=v, force=tuple(f.ravel().tolist()), finer=None)

    @property
    def alike(self) -> bool:
        """Whether it goes by rate alone, and is as large in both senses."""
        _, v, f = self.points
        return not self.position and np.allclose(np.interp(-v, v, f[0]), -f[0], rtol=0, atol=ROUNDING * np.abs(f).max())

    @property
    def points(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions (p,), rates of both senses (t,), and loads (max(p, 1), t)."""
        y, v = np.array(self.position, float), np.array(self.velocity, float)
        f = np.array(self.force, float).reshape(-1, v.size)
        if v[0] < 0:
            return y, v, f
        return y, np.concatenate([-v[:0:-1], v]), np.concatenate([-f[:, :0:-1], f], axis=1)
