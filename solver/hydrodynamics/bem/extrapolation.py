"""Limits of zero panel size from solutions of up to three meshes, and what is left of the error."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # ndimage is slow to import, and a run with known coefficients needs none

from solver.hydrodynamics.hull import mesh as meshes
from solver.hydrodynamics.hull.edges import order
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.plates import Plates
from solver.hydrodynamics.radiation.passivity import UNPASSIVE, least_damping
from solver.lines import real_parts

NEXT = 3  # power of h that is left without the h² error: of edges, and of spheres, which have one in the waterplane
MOST = 3.0  # times the step from the finest mesh to its limit, that limits differ by where waves are resolved
LEAST = 0.25  # over the panels: of a coefficient, that three meshes may leave where their limits happen to agree
TWO_MESHES = 0.5  # of the h² error, that is left of it at least: measured on a sphere of 216 and 864 triangles
IRREGULAR = 1.5  # times what even panels leave, that a dense mesh made coarser does: 1.4 to 3.2 in A of five hulls
NARROWED = 0.5  # of what even panels leave at edges, that narrower ones do: 0.2 to 0.5 of boxes 0.5 to 3 m deep
ONE_MESH, COARSE = 0.045, 180  # error of one mesh of so many panels a body: from there it falls as edges let it
# Where limits make damping negative: frequencies to either side, times what those take of it, and of the added mass.
NEARBY, FAR_MORE, UNHEARD = 3, 3.0, 0.01
# Parts thinner than panels are wide: times that error, where panels of the two faces are each other's images; where
# they are not, of the coefficient, for each time that a panel is as wide as the part is thick. Measured on heave plates
# of 1/20 to 1/150 of their radius, from the finest to the coarsest meshes.
ALIKE_PLATES, UNLIKE_PLATES = 4.0, 0.02


class Solution(NamedTuple):
    """Of one mesh at nw frequencies, for nh headings."""

    impedance: np.ndarray  # (nw, n, n) A + iB/ω
    infinite: np.ndarray  # (n, n) A∞
    diffraction: np.ndarray  # (nw, nh, n) force
    far: np.ndarray  # (nw, n + nh, 2M + 1) modes of H, of each motion and heading; empty where not asked for
    lid: float  # area of damping lids [m²]
    panels: int  # on hulls


def extrapolated(
    solutions: list[Solution],
    divisions: tuple[int, ...],
    motions: tuple[np.ndarray, np.ndarray],
    share: float = TWO_MESHES,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Limits of zero panel size, error ~ h² ~ 1/divisions², and what is left of the error, with its sign.

    From three meshes: as h^NEXT, by how much the limits of the finer and of the coarser two differ, LEAST at least and
    MOST times a step nearby from the finest to its limit at most: the coarsest may not resolve the fastest waves. One
    solution counts as its limit, and is off by this `share` of it, see `of_one_mesh`. Where water between bodies
    resonates at a frequency that goes with the mesh, or at an irregular one of the coarser, there is no such limit, and
    the finest mesh stands; with damping lids at all frequencies, for what is lost there is felt at others. What is left
    is then the step from it to the limit of two, elsewhere this `share` of it. motions: lengths and bodies, as of
    `least_damping`.
    """
    *finest, lid, count = solutions[0]
    if len(solutions) == 1:
        return finest, [share * x for x in finest]
    best = _limits(solutions[:2], divisions[:2])
    step = [b - f for b, f in zip(best, finest, strict=True)]
    if lid > 0:
        return finest, step
    of_limit, of_finest = (least_damping(each[0], *motions) for each in (best, finest))
    lost = (of_limit < 2 * np.minimum(of_finest, 0)) & ((of_limit < -UNPASSIVE) | _stands_out(of_finest - of_limit))
    rest = [share * s for s in step]
    for k in (0, 2, 3):  # what has a frequency
        best[k][lost], rest[k][lost] = finest[k][lost], step[k][lost]
    if len(solutions) == 2:
        return best, rest
    left = (divisions[1] / divisions[0]) ** NEXT
    coarser = _limits(solutions[1:], divisions[1:])
    differ = [left / (1 - left) * (b - c) for b, c in zip(best, coarser, strict=True)]
    # Added mass and damping by themselves; parts of what waves do go with the phase in which they arrive.
    step[0], differ[0], limits = real_parts(step[0]), real_parts(differ[0]), [real_parts(best[0]), *best[1:]]
    for k in [k for k in (0, 2, 3) if step[k].size]:
        differ[k] = _at_most(MOST, step[k], differ[k])
    impedance, *others = (_at_least(LEAST / count, b, off) for b, off in zip(limits, differ, strict=True))
    return best, [impedance.view(complex), *others]


def _at_most(times: float, step: np.ndarray, off: np.ndarray) -> np.ndarray:
    """`off` (nw, …), but no larger than some times the largest step nearby."""
    most = times * scipy.ndimage.maximum_filter1d(np.abs(step), 2 * NEARBY + 1, axis=0, mode="nearest")
    return np.where(np.abs(off) > most, most * np.sign(off), off)


def _stands_out(taken: np.ndarray) -> np.ndarray:
    """Where limits take far more of the least damping (nw,) than at frequencies nearby, as irregular ones make them."""
    nearby = scipy.ndimage.median_filter(np.abs(taken), 2 * NEARBY + 1, mode="nearest")
    return np.asarray(taken > np.maximum(FAR_MORE * nearby, UNHEARD))


def _at_least(share: float, x: np.ndarray, off: np.ndarray) -> np.ndarray:
    """What x is off by, and no less than its share."""
    return np.where(np.abs(off) < share * np.abs(x), share * x, off)


def of_edges(hulls: tuple[Hull, ...], counts: tuple[int, ...], *, narrow: bool) -> float:
    """What two meshes, the coarser of these counts, leave of the error, over the step from the finer to their limit.

    At an edge that turns by α the error of even panels goes as h^p, see `edges`; of three parts the limit for an
    error ~ h² takes 2^p - 1. Of panels as wide as ours p is 1.0 to 1.2 of boxes, 1.3 to 1.5 where α is 50 degrees. To
    take the limit by that order is no way out: added mass and damping would not be of one cause, nor damping of the
    waves far off. Panels narrower at edges leave NARROWED as much; those of a dense mesh made coarser IRREGULAR.
    """
    shares = [TWO_MESHES]
    for hull, count in zip(hulls, counts, strict=True):
        if isinstance(hull, PanelHull):
            left = 3 / (2 ** order(hull.sharpest) - 1) - 1
            share = max(TWO_MESHES, NARROWED * left if narrow and _narrower(hull, count) else left)
            shares.append(share if hull.finer is None else IRREGULAR * share)
    return max(shares)


def of_one_mesh(hulls: tuple[Hull, ...], counts: tuple[int, ...], *, narrow: bool) -> float:
    """Error of one mesh, of bodies with these counts, over the coefficient: that of the body with the largest.

    It goes as h^p, p that of `edges` where panels are even there and 2 where none is sharp or they are narrower; 1 of
    thin plates. Of spheres, cones, cylinders, boxes and flaps of 120 to 4,000 panels it is 0.4 to 1.9 of the true one.
    """
    shares = []
    for hull, count in zip(hulls, counts, strict=True):
        p = 1.0 if meshes.plates(hull, count) else 2.0
        if isinstance(hull, PanelHull) and not (narrow and _narrower(hull, count)):
            p = min(p, order(hull.sharpest))
        shares.append(ONE_MESH * (COARSE / meshes.halved_count(hull, count, narrow=narrow)) ** (p / 2))
    return float(max(shares))


def _narrower(hull: PanelHull, count: int) -> bool:
    """Whether its panels are so at edges, if any may."""
    return hull.finer is not None or meshes.halving(hull, count).narrow


def of_plates(plates: list[Plates], left: list[np.ndarray], best: Sequence[np.ndarray]) -> list[np.ndarray]:
    """What is left of the error of meshes of two sizes or one, of hulls with plates."""
    unlike = max(found.unlike for found in plates)
    if unlike > 0:
        return [error + UNLIKE_PLATES * unlike * x for error, x in zip(left, best, strict=True)]
    return [ALIKE_PLATES * error for error in left]


def _limits(pair: Sequence[Solution], divisions: tuple[int, ...]) -> list[np.ndarray]:
    fine, coarse = (n**2 for n in divisions)
    return [f + (f - c) * (coarse / (fine - coarse)) for f, c in zip(*(s[:-2] for s in pair), strict=True)]
