"""Froude-Krylov force and hydrostatic stiffness of the exact hull at its mean position: no potential is solved for."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from solver.hydrodynamics.bem.coefficients import DOFS
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.hull.panel_hull import PanelHull
from solver.hydrodynamics.hull.standing import stands, wetted


def unit_motions(
    points: np.ndarray, normals: np.ndarray, body: np.ndarray, centres: np.ndarray, dofs: Sequence[str]
) -> np.ndarray:
    """n · e and n · (e × r) of each body's unit motions, (np, n), r from the body's centre."""
    turning = np.cross(points - centres[body], normals)
    six = np.concatenate([normals, turning], axis=1)[:, [DOFS.index(d) for d in dofs]]
    each = np.zeros((len(points), len(centres), len(dofs)))
    each[np.arange(len(points)), body] = six
    return each.reshape(len(points), -1)


def motion_lengths(hulls: Sequence[Hull], dofs: Sequence[str]) -> np.ndarray:
    """By which motions are told apart from those that radiate nothing (n,) [m]: 1, or how far from the axis that it
    turns about the body has water, if not beyond its largest radius: deep down little goes to waves."""
    far = np.array([np.append(np.ones(3), np.minimum(hull.levers, hull.largest_radius)) for hull in hulls])
    return far[:, [DOFS.index(d) for d in dofs]].ravel()


def body_name(hulls: Sequence[Hull], b: int) -> str:
    """Of a body in messages: its number, from 1, and its mesh."""
    hull = hulls[b]
    return f"body {b + 1}, " + (hull.name if isinstance(hull, PanelHull) else "of revolution")


def froude_krylov(
    hulls: Sequence[Hull], centres: np.ndarray, dofs: Sequence[str], sea: Sea, omega: np.ndarray
) -> np.ndarray:
    """-∫ p n dS over the exact mean wetted surface, of the unit incident wave at omega (nw,): (nw, n) [N/m, N].

    Under the foot of a hull that stands on the seabed no wave is felt.
    """
    force = []
    for hull, centre in zip(hulls, centres, strict=True):
        points, areas = hull.surface_points()
        if stands(hull, sea.depth):
            points, areas = (x[wetted(points, areas, sea.depth)] for x in (points, areas))
        motions = unit_motions(points, areas, np.zeros(len(points), int), np.zeros((1, 3)), dofs)
        force.append([-sea.pressure(points + centre, w) @ motions for w in omega])
    return np.concatenate(force, axis=1)


def at_rest(hulls: Sequence[Hull], centres: np.ndarray, dofs: Sequence[str], sea: Sea) -> dict[str, Any]:
    """What `Hydrodynamics` says of the hulls, the water and the waves' heading, whoever solved for its coefficients."""
    return {
        "hydrostatic_stiffness": hydrostatic_stiffness(hulls, dofs, sea.density, sea.gravity),
        "displaced_mass": np.array([sea.density * h.volume for h in hulls]),
        "buoyancy_centre": np.array([h.centre_of_buoyancy for h in hulls]),
        "centres": centres,
        "depth": sea.depth,
        "density": sea.density,
        "gravity": sea.gravity,
        "heading": sea.heading,
        "dofs": dofs,
    }


def hydrostatic_stiffness(hulls: Sequence[Hull], dofs: Sequence[str], density: float, gravity: float) -> np.ndarray:
    """Stiffness (n, n) of buoyancy about each centre, moments of the waterplane S, displaced V at (xb, yb, zb):

    heave ρgS; heave-roll ρgS_y, heave-pitch -ρgS_x; roll ρg(S_yy + V zb), pitch ρg(S_xx + V zb), roll-pitch
    -ρgS_xy; and, as buoyancy stays where it is in the body, yaw on roll -ρgV xb and on pitch -ρgV yb.
    """
    blocks = []
    for hull in hulls:
        S, Sx, Sy, Sxx, Sxy, Syy = hull.waterplane
        xb, yb, zb = hull.volume * hull.buoyancy_point
        six = np.zeros((6, 6))
        six[2:5, 2:] = [[S, Sy, -Sx, 0], [Sy, Syy + zb, -Sxy, -xb], [-Sx, -Sxy, Sxx + zb, -yb]]
        index = [DOFS.index(d) for d in dofs]
        blocks.append(density * gravity * six[np.ix_(index, index)])
    return block_diag(*blocks)
