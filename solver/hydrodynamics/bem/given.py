"""Coefficients that others computed, as a file has them."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from solver.hydrodynamics.bem.coefficients import DOFS
from solver.rigid import lever

KEY = "coefficients"  # of study files, under which they are refused
ALONG = 1e-9  # what a turn by half a circle leaves of a motion across


@dataclass(frozen=True, eq=False, kw_only=True)
class Given:
    """Coefficients of nb bodies, n columns, in SI and for Re{X exp(-iωt)}; None is what the file does not say."""

    name: str
    omega: np.ndarray  # (nw,) [rad/s], in any order
    added_mass: np.ndarray  # (nw, n, n)
    radiation_damping: np.ndarray  # (nw, n, n)
    added_mass_inf: np.ndarray | None  # (n, n)
    headings: np.ndarray  # (nh,) [rad] directions that the waves travel to
    excitation: np.ndarray  # (nw, nh, n) complex, of incident and scattered wave [N/m]
    froude_krylov: np.ndarray | None  # (nw, nh, n) complex, of the incident wave
    columns: tuple[tuple[int, str], ...]  # (n,) number of the body, and which motion
    bodies: tuple[str, ...]  # (nb,) their names, empty where they have none; () where only columns tell how many
    points: np.ndarray | None = None  # (nb, 3) [m] of rotations and moments; None and NaN: the floats' own
    stiffness: np.ndarray | None = None  # (n, n) hydrostatic, of which heave's own is used, which is about no point
    depth: float | None = None
    density: float | None = None
    gravity: float | None = None
    time_sign: int = -1  # of iωt in the file's own numbers; these are their conjugates where it is +1


def turned(given: Given, angles: np.ndarray) -> Given:
    """On the sea's axes what is told on each body's (nb,), turned in plan by an angle [rad]: X = T X', A = T A' Tᵀ.

    ValueError where a file has but one of two motions that a turn mixes.
    """
    c, s = np.cos(angles), np.sin(angles)
    own = np.array([6 * b + DOFS.index(dof) for b, dof in given.columns])
    whole = np.eye(6 * len(c))
    for i in (0, 3):
        x, y = (np.arange(i + k, 6 * len(c), 6) for k in (0, 1))
        whole[x, x], whole[x, y], whole[y, x], whole[y, y] = c, -s, s, c
    if np.any(np.abs(np.delete(whole, own, axis=0)[:, own]) > ALONG):
        raise ValueError("axes turned in plan need both of surge and sway, and of roll and pitch, or neither")
    T, incident = whole[np.ix_(own, own)], given.froude_krylov
    return replace(
        given,
        added_mass=T @ given.added_mass @ T.T,
        radiation_damping=T @ given.radiation_damping @ T.T,
        added_mass_inf=None if given.added_mass_inf is None else T @ given.added_mass_inf @ T.T,
        excitation=given.excitation @ T.T,
        froude_krylov=None if incident is None else incident @ T.T,
        stiffness=None if given.stiffness is None else T @ given.stiffness @ T.T,
    )


def about(six: Given, centres: np.ndarray) -> Given:
    """Rotations and moments about `centres` (velocity v): the file's points move at v + ω × (point - centre)."""
    if six.points is None or np.allclose(six.points, centres, rtol=0, atol=1e-9):
        return six
    T = scipy.linalg.block_diag(*map(lever, six.points - centres))
    infinite = six.added_mass_inf
    return replace(
        six,
        added_mass=T.T @ six.added_mass @ T,
        radiation_damping=T.T @ six.radiation_damping @ T,
        added_mass_inf=None if infinite is None else T.T @ infinite @ T,
        excitation=six.excitation @ T,
        froude_krylov=None if six.froude_krylov is None else six.froude_krylov @ T,
        points=centres,
    )
