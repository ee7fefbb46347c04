"""Where the floats' hinges are, and the frame nodes that come with them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from pipeline.study.floats import Float

HINGE = "hinge:"


def hinge_nodes(floats: Iterable[Float]) -> dict[str, tuple[float, float, float]]:
    """The nodes that come with the floats: hinge:<name> -> hinge point [m]."""
    return {HINGE + f.name: f.hinge for f in floats}


def spaced(floats: tuple[Float, ...], spacing: float) -> tuple[Float, ...]:
    """Two floats with their hinges at x = ±spacing/2 [m], each on the side where it is; arms are kept."""
    a, b = floats
    side = math.copysign(0.5, a.hinge[0] - b.hinge[0])
    places = (side * spacing, -side * spacing)
    return tuple(f.model_copy(update={"hinge": (x, *f.hinge[1:])}) for f, x in zip(floats, places, strict=True))
