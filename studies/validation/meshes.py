"""Published coefficients against hulls that are panel meshes: error against the number of panels.

Errors are shares of each curve's largest value. `published` are columns of the files in tests/reference.
"""

from collections.abc import Mapping

import numpy as np

from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.revolution import Revolution
from solver.reference.panels import revolution_mesh

G, RHO = 9.81, 1000.0
Columns = Mapping[str, np.ndarray]


def meshed(hull: Revolution, along: int) -> PanelHull:
    """A mesh of along x 2 along quadrilaterals over the whole hull, as a user might bring."""
    mesh = revolution_mesh(hull, along=along, around=2 * along)
    return PanelHull.of(mesh.vertices, mesh.faces)


def _normalised(hull: PanelHull, omega: np.ndarray, depth: float, mass: float) -> tuple[np.ndarray, np.ndarray]:
    """A / mass and B / (mass ω), (nw, 3) each of surge, heave, pitch."""
    h = bem.solve((hull,), np.zeros((1, 3)), depth=depth, density=RHO, gravity=G, omega=omega)
    A, B = (np.diagonal(x, axis1=1, axis2=2) / mass for x in (h.added_mass, h.radiation_damping))
    return A, B / omega[:, None]


def hemisphere_errors(published: Columns, along: tuple[int, ...] = (12, 16, 24)) -> dict[int, dict[str, float]]:
    """Hulme's curves up to Ka = 3: worst error of each, by panels below water."""
    used = published["Ka"] <= 3
    omega, errors = np.sqrt(G * published["Ka"][used]), {}
    for n in along:
        hull = meshed(Revolution.sphere(radius=1.0, draft=1.0), n)
        A, B = _normalised(hull, omega, np.inf, RHO * 2 / 3 * np.pi)
        ours = {"surge_A": A[:, 0], "surge_B": B[:, 0], "heave_A": A[:, 1], "heave_B": B[:, 1]}
        errors[len(hull.wetted)] = {name: _worst(values, published[name][used]) for name, values in ours.items()}
    return errors


def cylinder_errors(published: Columns, along: tuple[int, ...] = (12, 16, 24)) -> dict[int, dict[str, float]]:
    """Truncated cylinder, radius 1 m, draft 0.5 m, depth 10 m, heave: worst errors by panels below water."""
    omega, errors = np.sqrt(G * published["K"]), {}
    for n in along:
        hull = meshed(Revolution.vertical_cylinder(radius=1.0, draft=0.5, freeboard=0.5), n)
        A, B = _normalised(hull, omega, 10.0, RHO * np.pi * 0.5)
        errors[len(hull.wetted)] = {"A33": _worst(A[:, 1], published["A33"]), "B33": _worst(B[:, 1], published["B33"])}
    return errors


def _worst(values: np.ndarray, exact: np.ndarray) -> float:
    return float(np.abs(values - exact).max() / exact.max())
