"""Capytaine's Green function of a source under waves, and meshes for it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from solver.hydrodynamics.hull.surface import merged
from solver.hydrodynamics.library import capytaine
from solver.kernels import one_at_a_time

# Growth of the exponentials whose sum is the finite-depth function, over all that bodies and images have to do with:
# amplitudes alone are fitted, which leaves 1e-5 of it from kh = 0.1 on.
GROWTH = -np.geomspace(0.08, 40.0, 12)
POINTS = ((1 - np.cos(np.pi * (np.arange(600) + 0.5) / 600)) / 2) ** 1.5  # 0 to 1, denser towards both, more at 0
FAINT = 1e-11  # of the largest singular value, below which amplitudes would only cancel


@cache
def green_function() -> Any:
    """Delhommeau's, with the finite-depth function as close as exponentials get to it.

    The first on a machine makes its table, a quarter of a minute; who comes meanwhile waits and reads it.
    """
    module = capytaine().green_functions.delhommeau
    module.find_best_exponential_decomposition = _exponentials
    with one_at_a_time(module.cache_directory(), "table"):
        return module.Delhommeau()


def _exponentials(
    function: Callable[[np.ndarray], np.ndarray], *, x_max: float, **_others: Any
) -> tuple[np.ndarray, np.ndarray]:
    """In place of capytaine's, by Prony: amplitudes and growth rates for a function on 0 to x_max.

    Of kh < 0.2 capytaine's leave a potential of 2 % of the largest all about a source, of added mass 1 %; it fits
    below 0, too, where nothing is asked for and the function has a pole at -kh.
    """
    x = x_max * POINTS
    weight = np.sqrt(np.gradient(x))
    terms = np.exp(np.multiply.outer(x, GROWTH))
    amplitudes, *_ = np.linalg.lstsq(terms * weight[:, None], function(x) * weight, rcond=FAINT)
    return amplitudes, GROWTH


@dataclass(frozen=True, eq=False, kw_only=True)
class Panels:
    """A mesh as capytaine's Green function asks for it: its own would be checked and measured panel by panel."""

    vertices: np.ndarray  # (nv, 3) [m]
    faces: np.ndarray  # (n, 4)
    faces_areas: np.ndarray  # (n,) [m²]
    faces_centers: np.ndarray  # (n, 3) [m]
    faces_normals: np.ndarray  # (n, 3)
    faces_radiuses: np.ndarray  # (n,) [m]

    @property
    def nb_faces(self) -> int:
        """Number of panels."""
        return len(self.faces)

    @property
    def quadrature_points(self) -> tuple[np.ndarray, np.ndarray]:
        """Where what is smooth is taken (n, 1, 3) [m], and its weights (n, 1)."""
        return self.faces_centers[:, None], self.faces_areas[:, None]

    def of(self, some: np.ndarray) -> "Panels":
        """Some of them, by number."""
        return joined([(self.vertices, self.faces[some])])


def joined(pieces: list[tuple[np.ndarray, np.ndarray]]) -> Panels:
    """Pieces of vertices and faces as one mesh."""
    vertices, faces = merged(pieces)
    return Panels(vertices=vertices, faces=faces, **_measured(vertices[faces]))


def _measured(corners: np.ndarray) -> dict[str, np.ndarray]:
    """What capytaine finds of panels' corners (n, 4, 3), the last two alike in a triangle.

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
