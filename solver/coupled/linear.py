"""One linear model of a scene: the assembled system's small motions about its equilibrium.

x = [p, y]: modal amplitudes of the structure and the floats' joints; the floats' coordinates are z = T x. With the
load JᵀW(z, ż, z̈) of the march's own kernel, at the equilibrium that statics finds,

    M = -∂JᵀW/∂z̈ (added mass at infinity included),  D = -∂JᵀW/∂ż,  C = -∂JᵀW/∂z

(C: buoyancy, weight, springs, and the levers of all of them), seen from x, plus 1, 2ζω and ω² of the modes. For
harmonics Re{X exp(-iωt)} of what radiates E x:

    [-ω²M - iω(D + EᵀY(ω)E) + C] X = F(ω),   Y = B - iω(A - A∞),

and all loads on the floats, whose negative their joints bear, are by the same differences

    W = Σ (-iω)ᵏ Wₖ X, k = 0, 1, 2,   plus the excitation, and iω Y E X on what radiates,

and what they put on the structure those rows of JᵀW, clamped carriers' too.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.linalg import block_diag

from solver.coupled.equilibrium import Balance, balance, symmetric_stiffness
from solver.coupled.system import Resting, System, known_differences
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.lines import real_by_complex
from solver.multibody.bodies import Bodies

KNOWN = 8  # models that a process keeps


@dataclass(frozen=True, eq=False, kw_only=True)
class LinearModel:
    """n coordinates x, the modes' nm first; nz of the floats; na motions that radiate."""

    shape: np.ndarray  # T (nz, n)
    active: np.ndarray  # E (na, n)
    along: np.ndarray  # (6nb, na) what radiates, along the axes of space, at rest
    mass: np.ndarray  # M (n, n) [kg, ...]
    damping: np.ndarray  # D (n, n)
    stiffness: np.ndarray  # C (n, n)
    length: np.ndarray  # (n,) [m]: how far the structure or a hull moves, at most, for one unit
    wrench: np.ndarray  # W (3, nb, 6, n): ∂W/∂x, ∂W/∂ẋ, ∂W/∂ẍ [N, N m, ...]
    modes: np.ndarray  # (3, nm) ω², 2ζω, 1
    floats: np.ndarray  # (3, nz, nz): -∂JᵀW/∂z, -∂JᵀW/∂ż, -∂JᵀW/∂z̈
    radiating: np.ndarray  # (na, nz): what radiates, by z

    def dynamic_stiffness(self, omega: np.ndarray, Y: np.ndarray) -> np.ndarray:
        """-ω²M - iω(D + EᵀY(ω)E) + C (nw, n, n) for radiation impedance Y (nw, na, na)."""
        return self.assembled(omega, self.of_floats(omega, Y))

    def assembled(self, omega: np.ndarray, L: np.ndarray) -> np.ndarray:
        """The same by the floats' part L (nw, nz, nz)."""
        (nz, n), nm = self.shape.shape, self.modes.shape[1]
        nw = len(omega)
        half = (L.reshape(nw * nz, nz) @ self.shape).reshape(nw, nz, n).transpose(0, 2, 1)
        Z = (half.reshape(nw * n, nz) @ self.shape).reshape(nw, n, n).transpose(0, 2, 1)
        Z[:, range(nm), range(nm)] += self.of_modes(omega)
        return Z

    def response(self, omega: np.ndarray, Y: np.ndarray, force: np.ndarray) -> np.ndarray:
        """X (nw, n) to wave force F (nw, n).

        Modes with damping of their own are eliminated: with L z the floats' loads, on their carriers S p, and d a
        mode's own dynamic stiffness, p = (F - Sᵀ L z)/d, so that only z is solved for.
        """
        (nz, n), nm = self.shape.shape, self.modes.shape[1]
        if not (nm and np.all(self.modes[1] > 0)):
            return np.linalg.solve(self.dynamic_stiffness(omega, Y), force[..., None])[..., 0]
        nc, d, L = nz - (n - nm), self.of_modes(omega), self.of_floats(omega, Y)
        S, system = self.shape[: nz - (n - nm), :nm], L.copy()
        flexibility = ((1 / d) @ (S[:, None] * S).reshape(nc * nc, nm).T).reshape(len(omega), nc, nc)
        system[:, :nc] = flexibility @ L[:, :nc]
        system[:, range(nc), range(nc)] += 1
        known = np.concatenate([(force[:, :nm] / d) @ S.T, force[:, nm:]], axis=1)
        z = np.linalg.solve(system, known[..., None])
        p = (force[:, :nm] - (L[:, :nc] @ z)[..., 0] @ S) / d
        return np.concatenate([p, z[:, nc:, 0]], axis=1)

    def damped(self, more: np.ndarray) -> "LinearModel":
        """With further dampers (nj,) of the joints."""
        floats, nj = self.floats.copy(), more.size
        joints = slice(len(floats[1]) - nj, None)
        floats[1, joints, joints] += np.diag(more)
        none = np.zeros(len(self.mass) - nj)
        return replace(self, floats=floats, damping=self.damping + np.diag(np.concatenate([none, more])))

    def loads(self, omega: np.ndarray, X: np.ndarray, Y: np.ndarray, pushed: np.ndarray) -> np.ndarray:
        """W (nw, nb, 6) on the floats of response X (nw, n), the waves' force `pushed` (nw, nb, 6) included."""
        (_, nb, _, n), rate = self.wrench.shape, -1j * omega
        parts = real_by_complex(np.concatenate([self.wrench.reshape(18 * nb, n), self.active]), X.T)
        held, damped, pulled = parts[: 18 * nb].reshape(3, nb, 6, omega.size)
        total = held + rate * (damped + rate * pulled)
        radiated = (Y @ (rate * parts[18 * nb :]).T[..., None])[..., 0].T
        total -= real_by_complex(self.along, radiated).reshape(nb, 6, omega.size)
        return pushed + np.moveaxis(total, -1, 0)

    def carried(self, omega: np.ndarray, Z: np.ndarray, Y: np.ndarray, force: np.ndarray) -> np.ndarray:
        """JᵀW (nw, nc) on the carriers where the floats' coordinates are Z (nw, nz), with the waves' force (nw, na) on
        what radiates."""
        (nz, n), rate = self.shape.shape, -1j * omega
        nc = nz - (n - self.modes.shape[1])
        parts = real_by_complex(np.concatenate([*self.floats[:, :nc], self.radiating]), Z.T)
        held, damped, pulled = parts[: 3 * nc].reshape(3, nc, omega.size)
        pushed = force - (Y @ (rate * parts[3 * nc :]).T[..., None])[..., 0]
        return (real_by_complex(self.radiating[:, :nc].T, pushed.T) - held - rate * (damped + rate * pulled)).T

    def pushed(self, force: np.ndarray) -> np.ndarray:
        """(nw, nb, 6) of the waves' forces (nw, na) on what radiates."""
        return real_by_complex(self.along, force.T).T.reshape(len(force), -1, 6)

    def of_modes(self, omega: np.ndarray) -> np.ndarray:
        """ω_m² - 2iζω_mω - ω² (nw, nm)."""
        w = omega[:, None]
        return self.modes[0] - 1j * w * self.modes[1] - w**2 * self.modes[2]

    def of_floats(self, omega: np.ndarray, Y: np.ndarray) -> np.ndarray:
        """Load against z for unit z (nw, nz, nz)."""
        w, (K, D, M) = omega[:, None, None], self.floats
        return K - w**2 * M - 1j * w * (D + self.radiating.T @ Y @ self.radiating)


@lru_cache(maxsize=KNOWN)
def linear_model(system: System) -> LinearModel:
    """The model of a scene; all its loads are those that the march evaluates."""
    return _linear_model(system.resting, tuple(f.hull.size for f in system.scene.floats))


@lru_cache(maxsize=KNOWN)
def _linear_model(scene: Resting, sizes: tuple[float, ...]) -> LinearModel:
    """Scenes that differ in their seas alone share it."""
    bodies, frame, z = scene.value
    (nc, nm), nz = frame.carrier.shape, z.size
    T = np.zeros((nz, nm + nz - nc))
    T[:nc, :nm], T[nc:, nm:] = frame.carrier, np.eye(nz - nc)
    loads = known_differences(scene)
    floats = np.stack([symmetric_stiffness(loads.residual[0]), *(-loads.residual[1:])])
    modal = np.zeros((3, nm + nz - nc))
    modal[:, :nm] = frame.omega**2, 2 * frame.damping * frame.omega, np.ones(nm)
    parts = zip(floats, modal, strict=True)
    stiffness, damping, mass = (T.T @ of_floats @ T + np.diag(of_modes) for of_floats, of_modes in parts)
    J, along = jacobian(bodies, z), _along(bodies, z)
    radiating = along.T @ J.reshape(len(along), nz)
    reach = np.linalg.norm(J[:, :3], axis=1) + np.reshape(sizes, (-1, 1)) * np.linalg.norm(J[:, 3:], axis=1)
    return LinearModel(
        shape=T,
        active=radiating @ T,
        along=along,
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        length=np.concatenate([frame.scale, reach.max(axis=0, initial=0.0)[nc:]]),
        wrench=loads.wrench @ T,
        modes=modal[:, :nm],
        floats=floats,
        radiating=radiating,
    )


def _along(body: Bodies, z: np.ndarray) -> np.ndarray:
    """(6nb, na) unit motions that radiate, along the axes of space."""
    axes = balance(body, z).rotation if body.turning else [np.eye(3)] * body.axes.size
    each = [block_diag(R, R)[:, body.active] for R in axes]
    return np.asarray(block_diag(*each) if each else np.zeros((0, 0)))


def jacobian(body: Bodies, z: np.ndarray) -> np.ndarray:
    """Motion (..., nb, 6, nz) of the reference points for unit coordinates, at z (..., nz)."""
    return balance(body, z).jacobian


def of_waves(body: Bodies, at: Balance, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Levers of loads by waves, along axes as at rest (nz,), on the coordinates: (m, nb, 6, nz); and what makes of
    these loads those along the axes of space, (m, nb, 6, 6).

    They turn with the bodies or, left to keep their directions, are on the reference points' motions.
    """
    J, R = at.jacobian, at.rotation
    if not body.turning:
        return J, np.broadcast_to(np.eye(6), (*R.shape[:2], 6, 6))
    turned = np.kron(np.eye(2), R @ balance(body, rest).rotation.swapaxes(-1, -2))
    return turned.swapaxes(-1, -2) @ J, turned


def wave_force(model: LinearModel, excitation: np.ndarray, modal: np.ndarray) -> np.ndarray:
    """F (nw, n) of the floats' excitation (nw, na) and the modes' wave load (nm, nw)."""
    force = excitation @ model.active
    force[:, : len(modal)] += modal.T
    return force


def impedance(system: System, h: Hydrodynamics | None, omega: np.ndarray) -> np.ndarray:
    """Y = B - iω(A - A∞) (nw, na, na), A∞ the system's; zero where the scene leaves radiation out."""
    if h is None or not system.scene.settings.radiation:
        na = len(linear_model(system).active)
        return np.zeros((omega.size, na, na), complex)
    return h.impedance(omega) + 1j * omega[:, None, None] * system.bodies.added_mass


def impedance_anywhere(system: System, h: Hydrodynamics, omega: np.ndarray) -> np.ndarray:
    """Y at ω from 0 on: below the lowest one solved added mass is as there, and damping goes with the square; above the
    highest one damping and A - A∞ fall with that."""
    low, high = h.omega[[0, -1]]
    Y = impedance(system, h, omega.clip(low, high))
    under, over = np.minimum(omega / low, 1.0)[:, None, None], np.minimum(high / omega.clip(low), 1.0)[:, None, None]
    return (over * under) ** 2 * Y.real + 1j * over * under * Y.imag  # -ω(A - A∞)
