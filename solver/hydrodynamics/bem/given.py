"""Coefficients that others computed, as a file has them."""

from dataclasses import dataclass

import numpy as np

KEY = "coefficients"  # of study files, under which they are refused


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
    bodies: tuple[str, ...]  # (nb,) their names; empty where they have none
    points: np.ndarray | None = None  # (nb, 3) [m] of rotations and moments; None: the floats' own
    stiffness: np.ndarray | None = None  # (n, n) hydrostatic, of which heave's own is compared
    depth: float | None = None
    density: float | None = None
    gravity: float | None = None
