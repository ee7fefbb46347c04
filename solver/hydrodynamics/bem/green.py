"""Capytaine's Green function of a source under waves, and its meshes; imported when first used, being slow to."""

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np

from solver.hydrodynamics.hull.surface import merged

# Mean square of what the exponentials in the finite-depth function may miss, the least that they meet: capytaine's
# 1e-4 is noise of 1 % and more in the coefficients of bodies a few radii above the seabed.
FITTED = 1e-8, 1e-6, 1e-4


@cache
def _capytaine() -> Any:
    import capytaine

    capytaine.set_logging("ERROR")  # panels of a sphere are not plane: nothing to warn of
    return capytaine


@cache
def green_function() -> Any:
    """Delhommeau's, with the finite-depth function as close as exponentials get to it."""
    module = _capytaine().green_functions.delhommeau
    module.find_best_exponential_decomposition = _exponentials
    return module.Delhommeau()


def _exponentials(
    function: Callable[[np.ndarray], np.ndarray], *, tol: float, **domain: Any
) -> tuple[np.ndarray, np.ndarray]:
    """In place of capytaine's: amplitudes and growth rates for the first of FITTED that is met;
    tol: capytaine's, not used.
    """
    prony = _capytaine().tools.prony_decomposition
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
    return _capytaine().Mesh(vertices=vertices, faces=faces, auto_clean=False, auto_check=False)


def own_influence(panels: Any, k: float, depth: float) -> np.ndarray:
    """∫ G dS (n,) of each of a mesh's panels in still water on its own middle, which capytaine has wrong.

    The wave part of G there goes as ln r and J₀(kr), and is taken at r → 0 where a table ends, with the sign of its
    imaginary part turned. The mean of ln r over a disc as large as the panel, of radius a, is ln(a/√e): the wave part
    is that at r = a/√e. Without waves, k = 0, G is -1/(2πr), which capytaine integrates.
    """
    from_middle = np.sqrt(panels.faces_areas / (np.pi * np.e))[:, None] * [1.0, 0.0, 0.0]

    def influence(points: np.ndarray, **water: float) -> np.ndarray:
        how = {"adjoint_double_layer": False, "diagonal_term_in_double_layer": False}
        return np.diag(green_function().evaluate(points, panels, **water, **how)[0])

    middles, near = panels.faces_centers, panels.faces_centers + from_middle
    waves = influence(near, wavenumber=k, water_depth=depth) - influence(near, wavenumber=0.0)
    return influence(middles, wavenumber=0.0) + waves
