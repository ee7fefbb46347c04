"""Capytaine's Green function of a source under waves, and its meshes."""

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np

from solver.hydrodynamics.hull.surface import merged
from solver.hydrodynamics.library import capytaine

# Mean square of what the exponentials in the finite-depth function may miss, the least that they meet: capytaine's
# 1e-4 is noise of 1 % and more in the coefficients of bodies a few radii above the seabed.
FITTED = 1e-8, 1e-6, 1e-4


@cache
def green_function() -> Any:
    """Delhommeau's, with the finite-depth function as close as exponentials get to it."""
    module = capytaine().green_functions.delhommeau
    module.find_best_exponential_decomposition = _exponentials
    return module.Delhommeau()


def _exponentials(
    function: Callable[[np.ndarray], np.ndarray], *, tol: float, **domain: Any
) -> tuple[np.ndarray, np.ndarray]:
    """In place of capytaine's: amplitudes and growth rates for the first of FITTED that is met;
    tol: capytaine's, not used.
    """
    prony = capytaine().tools.prony_decomposition
    for closest in FITTED:
        # It draws the points of its fit at random: the same numbers for each fit, on every machine.
        prony.RNG = np.random.default_rng(0)
        with suppress(prony.PronyDecompositionFailure):
            return prony.find_best_exponential_decomposition(function, tol=closest, **domain)
    raise prony.PronyDecompositionFailure(f"no sum of exponentials within {tol:g} of the finite-depth function")


def joined(pieces: list[tuple[np.ndarray, np.ndarray]]) -> Any:
    """Pieces of vertices and faces as one capytaine mesh."""
    vertices, faces = merged(pieces)
    # Cleaning would take panels away that we count on; nor is there anything to clean.
    mesh = capytaine().Mesh(vertices=vertices, faces=faces, auto_clean=False, auto_check=False)
    mesh.__dict__ |= _cached(vertices[faces])
    return mesh


def _cached(corners: np.ndarray) -> dict[str, np.ndarray]:
    """What capytaine's mesh would find panel by panel of its corners (n, 4, 3), the last two alike in a triangle.

    Centre and area of the two triangles abc and acd, n along the cross of the diagonals, distance of a from the centre.
    """
    a, b, c, d = np.moveaxis(corners, 1, 0)
    halves = [(half, np.linalg.norm(np.cross(half - a, end - a), axis=1) / 2) for half, end in ((b, c), (c, d))]
    normal, area = np.cross(c - a, d - b), halves[0][1] + halves[1][1]
    centre = ((a + b + c) * halves[0][1][:, None] + (a + c + d) * halves[1][1][:, None]) / (3 * area[:, None])
    return {
        "faces_areas": area,
        "faces_centers": centre,
        "faces_normals": normal / np.linalg.norm(normal, axis=1, keepdims=True),
        "faces_radiuses": np.linalg.norm(a - centre, axis=1),
    }
