"""Boxes: barges, pontoons, caissons, flaps."""

from functools import lru_cache

import numpy as np

from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.quantities import require_positive

CORNERS = np.array([(x, y, z) for z in (0, 1) for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))])
FACES = np.array([(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])


@lru_cache(maxsize=64)
def box(*, length: float, width: float, height: float, draft: float) -> PanelHull:
    """The box of `length` along x, `width` along y and `height` [m] about the z axis, its bottom at z = -draft."""
    for name, size in (("length", length), ("width", width), ("height", height), ("draft", draft)):
        require_positive(f"hull.{name}", size, "m")
    return PanelHull.of(CORNERS * (length, width, height) - (0, 0, draft), FACES, name="box")
