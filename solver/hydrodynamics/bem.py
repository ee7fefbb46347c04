"""Linear potential flow about hulls of revolution: the only place that knows capytaine.

Capytaine evaluates the Green function; the mirror planes, the systems and the forces are ours, so
that every right-hand side of a frequency shares one factorization, and parts that a symmetry
makes zero are never solved. Harmonics are Re{X exp(-iωt)}; the incident wave of unit amplitude is
η = Re exp(i(k(x cosβ + y sinβ) - ωt)), phase zero at x = y = 0.
"""

from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import block_diag, lu_factor, lu_solve
from scipy.optimize import brentq

from solver.errors import InputError
from solver.hydrodynamics import hull as shapes
from solver.hydrodynamics.hull import Revolution

DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
PLANAR = ("surge", "heave", "pitch")
DEEP = 6.0  # kh beyond which the seabed's wave terms, exp(-2kh) = 6e-6, are dropped


@dataclass(frozen=True, eq=False, kw_only=True)
class Hydrodynamics:
    """Coefficients of nb bodies, n = nb len(dofs) degrees of freedom ordered body by body.

    Rotations and moments are about each body's centre (x, y, 0), at rest in the still-water plane.
    """

    omega: np.ndarray  # (nw,) [rad/s], increasing
    added_mass: np.ndarray  # (nw, n, n) [kg, kg m, kg m²]
    radiation_damping: np.ndarray  # (nw, n, n) [N s/m, ...]
    added_mass_inf: np.ndarray  # (n, n), at infinite frequency
    diffraction: np.ndarray  # (nw, n) complex force of the scattered wave per wave amplitude [N/m]
    froude_krylov: np.ndarray  # (nw, n) complex force of the incident wave at the mean position [N/m]
    hydrostatic_stiffness: np.ndarray  # (n, n) of buoyancy alone: ρgS, ρg(I + V z_b); weight is the scene's
    displaced_mass: np.ndarray  # (nb,) [kg], exact hull
    buoyancy_centre: np.ndarray  # (nb,) z of the displaced volume's centroid [m]
    centres: np.ndarray  # (nb, 3) [m]
    depth: float  # [m], may be inf
    density: float  # [kg/m³]
    gravity: float  # [m/s²]
    heading: float  # direction the waves travel to, from +x towards +y [rad]
    dofs: tuple[str, ...]  # of one body
    settings: MappingProxyType = field(default_factory=lambda: MappingProxyType({}))
    mesh_error: float = 0.0  # largest share by which the finer mesh differs from the extrapolation

    def excitation(self, omega: np.ndarray, kind: str = "total") -> np.ndarray:
        """Force per wave amplitude (nw', n) at any ω in the grid's range; kind: total, diffraction, froude_krylov.

        Cubic splines of X exp(-ik·x_b): without the phase of the wave's arrival the curves are smooth.
        """
        omega = np.atleast_1d(np.asarray(omega, float))
        if omega.min() < self.omega[0] or omega.max() > self.omega[-1]:
            low, high = self.omega[[0, -1]]
            raise InputError("omega", omega, f"must be within the solved range, {low:.4g} to {high:.4g} rad/s")
        parts = {"diffraction": self.diffraction, "froude_krylov": self.froude_krylov}
        force = parts[kind] if kind in parts else self.diffraction + self.froude_krylov
        smooth = CubicSpline(self.omega, force * self._arrival(self.omega).conj())
        return smooth(omega) * self._arrival(omega)

    def _arrival(self, omega: np.ndarray) -> np.ndarray:
        """exp(ik(x_b cosβ + y_b sinβ)) for each degree of freedom, (nw, n)."""
        k = np.array([wavenumber(w, self.depth, self.gravity) for w in omega])
        along = self.centres[:, 0] * np.cos(self.heading) + self.centres[:, 1] * np.sin(self.heading)
        return np.exp(1j * k[:, None] * np.repeat(along, len(self.dofs)))


def wavenumber(omega: float, depth: float, gravity: float) -> float:
    """k [1/m] with ω² = gk tanh(kh)."""
    deep = omega**2 / gravity
    if np.isinf(deep) or deep * depth > 20:
        return deep
    root = brentq(lambda x: x * np.tanh(x) - deep * depth, 0.0, 1 + deep * depth, xtol=1e-14)
    return root / depth


def frequency_grid(
    hulls: tuple[Revolution, ...], centres: np.ndarray, *, depth: float, gravity: float = 9.81, count: int = 40
) -> np.ndarray:
    """`count` frequencies [rad/s] from Ka = 0.02 (kh > 0.15) to Ka = 10, a the largest and the smallest radius."""
    radii = [h.largest_radius for h in hulls]
    low = max(np.sqrt(0.02 * gravity / max(radii)), 0.15 * np.sqrt(gravity / depth))
    high = np.sqrt(10.0 * gravity / min(radii))
    return np.linspace(low, high, count)


def solve(
    hulls: tuple[Revolution, ...],
    centres: np.ndarray,
    *,
    depth: float,
    density: float = 1025.0,
    gravity: float = 9.81,
    heading: float = 0.0,
    omega: np.ndarray | None = None,
    planar: bool = True,
    panels: int = 432,
) -> Hydrodynamics:
    """Coefficients of `hulls` at `centres` (nb, 3) [m].

    Each is the h² extrapolation from a mesh of `panels` a body and one of 4/9 as many: measured on
    Hulme's hemisphere, ten times nearer than the finer mesh alone.
    """
    centres = np.asarray(centres, float).reshape(-1, 3)
    dofs = PLANAR if planar else DOFS
    omega = frequency_grid(hulls, centres, depth=depth, gravity=gravity) if omega is None else np.asarray(omega, float)
    _check(hulls, centres, depth, omega, gravity, panels)
    sea = _Sea(depth=depth, density=density, gravity=gravity, heading=heading)
    meshes = [_Mesh.build(hulls, centres, dofs, count) for count in (panels, round(panels * 4 / 9))]
    fine, coarse = (_coefficients(mesh, sea, omega) for mesh in meshes)
    ratio = (meshes[0].half / meshes[1].half) ** 2
    best = [f + (f - c) / (ratio - 1) for f, c in zip(fine, coarse, strict=True)]
    error = max(np.max(np.abs(b - f)) / np.max(np.abs(b)) for b, f in zip(best, fine, strict=True))
    impedance, impedance_inf, diffraction = best
    froude_krylov = np.array([_froude_krylov(hulls, centres, dofs, sea, w) for w in omega])
    return Hydrodynamics(
        omega=omega,
        added_mass=impedance.real,
        radiation_damping=impedance.imag * omega[:, None, None],
        added_mass_inf=impedance_inf,
        diffraction=diffraction,
        froude_krylov=froude_krylov,
        hydrostatic_stiffness=_hydrostatic(hulls, dofs, sea),
        displaced_mass=np.array([density * h.volume for h in hulls]),
        buoyancy_centre=np.array([h.centre_of_buoyancy for h in hulls]),
        centres=centres,
        depth=depth,
        density=density,
        gravity=gravity,
        heading=heading,
        dofs=dofs,
        settings=_settings(meshes),
        mesh_error=float(error),
    )
