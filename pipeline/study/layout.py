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
    """Two floats whose hinges are so far apart along x [m], about the same middle; arms are kept."""
    a, b = (f.hinge[0] for f in floats)
    middle, way = (a + b) / 2, math.copysign(spacing / 2, a - b)
    places = (middle + way, middle - way)
    return tuple(f.model_copy(update={"hinge": (x, *f.hinge[1:])}) for f, x in zip(floats, places, strict=True))
