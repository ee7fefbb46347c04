"""Still water."""

from dataclasses import dataclass
from typing import Annotated

from solver.quantities import Quantity, require_ranges

STILL_WATER = 1e-9  # a reference point this near to z = 0 is at still water [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Water:
    """Still water of constant depth (inf allowed)."""

    depth: Annotated[float, Quantity("m", above=0, infinite=True), "Depth of the water; inf for deep water"]
    density: Annotated[float, Quantity("kg/m3", above=0), "Density of the water"] = 1025.0
    gravity: Annotated[float, Quantity("m/s2", above=0), "Acceleration of gravity"] = 9.81

    def __post_init__(self) -> None:
        require_ranges(self, "water")
