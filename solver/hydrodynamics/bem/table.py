"""Frequencies at which the table of the Green function tells the faces of a heave plate apart.

Capytaine interpolates the wave part in cells of -k(z + z'), on a grid of even ratios. What a thin level plate radiates
is the small difference of that part between its faces: where these lie in two cells, what both miss takes its place.
The heave damping of a plate of 1/150 of its radius is then 0.4 to 1.9 times what it should be, at 7 of 100 frequencies.
"""

from collections.abc import Sequence

import numpy as np

from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.plates import THIN
from solver.sea.dispersion import wavenumber

FIRST, RATIO = 1e-10, (251.0 / 1e-10) ** (1 / 372)  # of the grid, FIRST RATIOⁿ; the nearest point's is the cell
LEVEL = 0.999  # cosine of a level face's normal to the vertical
MOVES = np.array(sorted(np.linspace(-3e-3, 3e-3, 61), key=abs))  # relative, of a frequency, the least first


def clear(omega: np.ndarray, hulls: Sequence[Hull], depth: float, gravity: float) -> np.ndarray:
    """Frequencies (nw,) [rad/s], all but the ends moved by as little as it takes for plates' faces to share cells."""
    plates = [plate for hull in hulls for plate in level_plates(hull)]
    if not plates:
        return omega
    tries = omega[1:-1, None] * (1 + MOVES)
    above = np.array([span for plate in plates for span in _sums(*plate, depth)])
    alone = np.array([span for plate in plates for span in _sums(*plate, np.inf)])  # for `seabed.added`
    waves = wavenumber(tries, depth, gravity), tries**2 / gravity
    arguments = [k[..., None, None] * spans for k, spans in zip(waves, (above, alone), strict=True)]
    cells = np.rint(np.log(np.concatenate(arguments, axis=-2) / FIRST) / np.log(RATIO))
    shared = np.all(cells[..., 0] == cells[..., 1], axis=-1)
    least = shared.argmax(axis=1)  # no move where none is enough: of plates as thick as a cell is wide
    return np.concatenate([omega[:1], tries[np.arange(len(tries)), least], omega[-1:]])


def level_plates(hull: Hull) -> list[tuple[float, float]]:
    """Depths [m] of the upper and lower faces of level plates below still water."""
    points, areas = hull.surface_points()
    level = np.abs(areas[:, 2]) > LEVEL * np.linalg.norm(areas, axis=1)
    depths, facing = -points[level, 2].round(9), areas[level, 2]
    upper, lower = (
        [(z, np.sum(facing[up & (depths == z)])) for z in np.unique(depths[up])] for up in (facing > 0, facing < 0)
    )
    return [
        (float(above), float(below))
        for above, size in upper
        for below, other in lower
        if 0 < below - above < THIN * 2 * np.sqrt(min(size, -other) / np.pi)
    ]


def _sums(above: float, below: float, depth: float) -> list[tuple[float, float]]:
    """Least and largest -(z + z') [m] between faces at these depths, and with their images in the seabed."""
    sums = [(2 * above, 2 * below)]
    if np.isfinite(depth):
        sums += [(2 * depth + above - below, 2 * depth + below - above), (4 * depth - 2 * below, 4 * depth - 2 * above)]
    return sums
