"""What waves carry, and what they can give at most: the mean power of a body of revolution, in linear theory.

A body that radiates as its motion lets it takes at most G J/k from a wave of power J [W/m] and wavenumber k: G = 1 for
heave, 2 for surge, pitch, sway and roll, and 3 for all of them or for a hinge, whose motion is a mixture (Budal and
Falnes 1975, Newman 1976; Falnes, Ocean Waves and Oscillating Systems, 2002, ch. 6). It holds for one body by itself.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.scene import Float, Scene
from solver.sea.dispersion import group_velocity, wavenumbers
from solver.statistics import STATISTICS

SLIGHT = 1e-9  # of an axis's motion, what counts as none of its kind
ROUNDING = 1e-12  # of what a heaving body could take
MARGIN = 2.0  # of that power's estimated error, which is none of its bounds: tuned cylinders had up to 1.2 of it more


def largest_power(scene: Scene) -> float:
    """Of the only float of a scene, round and on a fixed support [W]; infinite for all others."""
    alone = len(scene.floats) == 1 and scene.platform is None
    if not alone or (isinstance(hull := scene.floats[0].hull, PanelHull) and not hull.revolved):
        return np.inf
    return _gain(scene.floats[0]) * power_per_wavenumber(scene)


def wave_power(scene: Scene) -> float:
    """J of the scene's sea [W/m], which its waves carry through a metre of their crests: Σ ρg|a|²/2 · ∂ω/∂k."""
    return float(_transport(scene)[0].sum())


def power_per_wavenumber(scene: Scene) -> float:
    """Σ J/k over the waves of the scene's sea [W]."""
    power, k = _transport(scene)
    return float(np.sum(power / k))


def _transport(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """J [W/m] and k [rad/m] of each wave."""
    water, sea = scene.water, scene.sea
    k = wavenumbers(sea.omega, water.depth, water.gravity)
    speed = group_velocity(sea.omega, water.depth, water.gravity)
    return 0.5 * water.density * water.gravity * np.abs(sea.amplitude) ** 2 * speed, k


def _gain(item: Float) -> float:
    """G of all axes together. To and fro along any line and about any level axis radiate alike, and count once.

    An axis that turns about a point off the hull's own one moves that, too.
    """
    directions, turns = item.directions, item.turns
    moved = np.where(turns[:, None], np.cross(directions, np.array(item.arm) / item.hull.scale), directions)
    level = np.abs(np.concatenate([moved, directions[turns]])[:, :2]) > SLIGHT
    return 2.0 * bool(level.any()) + 1.0 * bool(np.any(np.abs(moved[:, 2]) > SLIGHT))


def above(scene: Scene, tables: Mapping[str, np.ndarray], error: float, change: float = 0.0) -> Iterator[str]:
    """A sentence where the mean absorbed power of statistics is more than that, and than what was stored at the start.

    error: estimated, of that mean, relative; change: of the stored energy since then [J].
    """
    most = largest_power(scene)
    power = tables["absorbed_power"][:, STATISTICS.index("mean")] if scene.floats else np.zeros(0)
    allowed = (1 + MARGIN * error) * most - min(change, 0.0) / scene.settings.duration
    if power.size and scene.sea.amplitude.any() and power[0] > allowed + ROUNDING * power_per_wavenumber(scene):
        yield (
            f"floats.{scene.floats[0].name} absorbs {power[0]:.4g} W, more than the {most:.4g} W that linear theory"
            " lets a body of revolution take from these waves"
        )
