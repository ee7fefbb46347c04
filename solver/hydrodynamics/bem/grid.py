"""Frequencies at which coefficients are solved."""

import numpy as np

from solver.hydrodynamics.bem.table import clear
from solver.hydrodynamics.hull.mesh import PANELS, Hull
from solver.sea.dispersion import first_solved, group_velocity

# Of the wavenumber times a panel's side: up to here coefficients err by 2 % of the added mass at most, at 2.5 by 80 %
# (heave and surge of a hemisphere and of a cylinder, against eight times the panels).
RESOLVED = 2.0


def frequency_grid(
    hulls: tuple[Hull, ...],
    centres: np.ndarray,
    *,
    depth: float,
    gravity: float = 9.81,
    count: int = 40,
    band: tuple[float, float] | None = None,
    panels: int = PANELS,
    interaction: bool = True,
) -> np.ndarray:
    """Frequencies [rad/s] from Ka = 0.02 (or kh = SHALLOWEST) to Ka = 10, K = ω²/g, a a radius; and all of `band`.

    None above that, not of the band, which meshes of about `panels` a body do not resolve: RESOLVED.
    `count` even ones for a body alone: with half as many above Ka = 2 the memory of two flaps on a base has its effect
    from 2e-3 to 8e-3. A wave reflected between bodies L apart turns the phase of a force by 2kL: the spacing is then
    at most c/(2L), c the group's velocity, 1 rad, up to Ka = 2 and through the band. Without interaction none is. Hulls
    with heave plates have some moved by 0.3 % at most: see `clear`.
    """
    radii = [h.largest_radius for h in hulls]
    low = max(np.sqrt(0.02 * gravity / max(radii)), first_solved(depth, gravity))
    high, resolved = np.sqrt(np.array([10, 2]) * gravity / min(h.scale for h in hulls))
    high = min(high, np.sqrt(RESOLVED * gravity / max(np.sqrt(h.wetted_area / panels) for h in hulls)))
    if band is not None:
        low, high, resolved = min(low, band[0]), max(high, band[1]), max(resolved, band[1])
    at = np.asarray(centres, float).reshape(-1, 3)
    apart = np.linalg.norm(at[:, None] - at, axis=-1).max() if interaction else 0.0
    # Grid points divide the integral of their density evenly, so that the spacing varies smoothly.
    omega = np.linspace(low, high, 4001)
    density = np.full_like(omega, (count - 1) / (high - low))
    turning = 2 * apart / group_velocity(omega, depth, gravity)  # of the phase, ∂(2kL)/∂ω
    density = np.maximum(density, turning / (1 + (omega / resolved) ** 16))
    index = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(omega))])
    grid = np.interp(np.linspace(0, index[-1], int(np.ceil(index[-1] - 1e-6)) + 1), index, omega)
    return clear(grid, hulls, depth, gravity)
