"""One linear model of a scene: the assembled system's small motions about its equilibrium.

x = [p, y]: modal amplitudes of the structure and the floats' joints; the floats' coordinates are z = T x. With the
load JᵀW(z, ż, z̈) of the march's own kernel, at the equilibrium that statics finds,

    M = -∂JᵀW/∂z̈ (added mass at infinity included),  D = -∂JᵀW/∂ż,  C = -∂JᵀW/∂z

(C: buoyancy, weight, springs, and the levers of all of them), seen from x, plus 1, 2ζω and ω² of the modes. For
harmonics Re{X exp(-iωt)} of what radiates E x:

    [-ω²M - iω(D + EᵀY(ω)E) + C] X = F(ω),   Y = B - iω(A - A∞).
"""

from dataclasses import dataclass

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.system import System
from solver.multibody.minimal import move, new_motion

SLOW = 1e-6  # of differences by rates [m/s or rad/s]: quadratic damping is nothing there, rounding 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class LinearModel:
    """n coordinates x, the modes' nm first; nz of the floats; na motions that radiate."""

    shape: np.ndarray  # T (nz, n)
    active: np.ndarray  # E (na, n)
    mass: np.ndarray  # M (n, n) [kg, ...]
    damping: np.ndarray  # D (n, n)
    stiffness: np.ndarray  # C (n, n)
    length: np.ndarray  # (n,) [m]: how far the structure or a hull moves, at most, for one unit

    def response(self, omega: np.ndarray, Y: np.ndarray, force: np.ndarray) -> np.ndarray:
        """X (nw, n) for radiation impedance Y (nw, na, na) and wave force F (nw, n)."""
        w = omega[:, None, None]
        radiated = np.swapaxes(self.active[None], 1, 2) @ Y @ self.active
        Z = -(w**2) * self.mass - 1j * w * (self.damping + radiated) + self.stiffness
        return np.linalg.solve(Z, force[..., None])[..., 0]


def linear_model(system: System) -> LinearModel:
    """The model of a scene; all its loads are those that the march evaluates."""
    frame, (z, _) = system.structure, system.equilibrium
    (nc, nm), nz = frame.carrier.shape, z.size
    T = np.zeros((nz, nm + nz - nc))
    T[:nc, :nm], T[nc:, nm:] = frame.carrier, np.eye(nz - nc)
    still, at_rest = np.zeros(nz), balance(system.bodies, z)[0]
    # Linear in accelerations, so that any will do; rates to either side, for there is no other damping at rest.
    M = np.array([at_rest - balance(system.bodies, z, still, one)[0] for one in np.eye(nz)]).reshape(nz, nz).T
    sides = [[balance(system.bodies, z, sign * SLOW * one)[0] for one in np.eye(nz)] for sign in (-1, 1)]
    D = np.subtract(*sides).reshape(nz, nz).T / (2 * SLOW)
    modal = np.zeros((3, nm + nz - nc))
    modal[:, :nm] = np.ones(nm), 2 * frame.damping * frame.omega, frame.omega**2
    parts = zip((M, D, system.stiffness), modal, strict=True)
    mass, damping, stiffness = (T.T @ of_floats @ T + np.diag(of_modes) for of_floats, of_modes in parts)
    J = _jacobian(system, z)
    reach = np.linalg.norm(J[:, :3], axis=1) + _sizes(system)[:, None] * np.linalg.norm(J[:, 3:], axis=1)
    return LinearModel(
        shape=T,
        active=J[:, system.bodies.active].reshape(-1, nz) @ T,
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        length=np.concatenate([frame.scale, reach.max(axis=0, initial=0.0)[nc:]]),
    )


def _sizes(system: System) -> np.ndarray:
    return np.array([f.hull.size for f in system.scene.floats])


def _jacobian(system: System, z: np.ndarray) -> np.ndarray:
    """Motion (nb, 6, nz) of the reference points for unit coordinates."""
    body, motion = system.bodies, new_motion(system.bodies)
    move(body, z, np.zeros(z.size), motion)
    J = np.zeros((body.axes.size, 6, z.size))
    for b, n in enumerate(body.axes):
        J[b][:, body.coordinate[b, :n]] = motion.jacobian[b, :, :n]
    return J


def wave_force(system: System, model: LinearModel, excitation: np.ndarray) -> np.ndarray:
    """F (nw, n) of the scene's own sea, for the floats' excitation per wave amplitude (nw, na)."""
    force = (excitation * system.scene.sea.amplitude[:, None]) @ model.active
    force[:, : system.structure.omega.size] += system.rows[system.layout.modal].T
    return force
