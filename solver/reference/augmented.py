"""The paper's multibody formulation, section 2.1: 6 DOF a body, Lagrange multipliers, two loops.

[M C_uᵀ; C_u 0] {u̇; λ} = {Q; Q_d} (eq. 1), u the velocities and angular velocities in world axes.
Orientations are unit quaternions: unlike Euler angles they have no singular attitude, and the
angular velocity need not be made from them. Time integration is the two-loop procedure on
Lobatto IIIA collocation (Shabana and Hussein 2009; Zhang and Zhang 2016, both cited there): the
outer loop finds the accelerations of all stages, inner loops hold the constraints of position,
velocity and acceleration at each stage. The independent twin of `minimal`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from solver.errors import InputError
from solver.kernels import kernel
from solver.reference.joints import Equations, Frames, Joint, constraints, equations, row_count
from solver.rigid import inertia_tensor

SPARSE = 250  # unknowns from which a sparse factorization is faster
INNER = 20  # iterations of an inner loop; two or three suffice
# Multipliers of redundant constraints are not unique, and in singular positions C_u loses rank: a
# small -ε in place of the zero block picks one, and refinement takes its error away again.
EPSILON = 1e-9
ROUNDING = 1e-13  # of the largest load, in which the balance of loads may be off


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A rigid body at the start; velocity is that of its origin, then the angular velocity."""

    mass: float  # [kg]
    inertia: tuple[float, float, float]  # about the c.o.g., body axes [kg m2]
    position: tuple[float, float, float]  # of the origin [m]
    rotation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)  # unit quaternion
    cog: tuple[float, float, float] = (0.0, 0.0, 0.0)  # from the origin, body axes [m]
    products_of_inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)  # as of floats
    velocity: tuple[float, float, float, float, float, float] = (0.0,) * 6

    def __post_init__(self) -> None:
        if not self.mass > 0:
            raise InputError("body.mass", self.mass, "must be > 0 kg")

    @property
    def inertia_tensor(self) -> np.ndarray:
        """About the c.o.g., along the body's axes (3, 3) [kg m2]."""
        return inertia_tensor(self.inertia, self.products_of_inertia)


class Mechanism(NamedTuple):
    """Bodies and joints as arrays; added_mass (6 nb, 6 nb) in world axes at the origins."""

    mass: np.ndarray
    cog: np.ndarray
    inertia: np.ndarray
    gravity: np.ndarray
    equations: Equations
    added_mass: np.ndarray


class MechanismState(NamedTuple):
    """position (nb, 3), quaternion (nb, 4), velocity and acceleration (nb, 6), multiplier (m,)."""

    position: np.ndarray
    quaternion: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    multiplier: np.ndarray


class Surroundings(Protocol):
    """What moves and loads the bodies; stage 0 is the step's start.

    A step is begin, then iterations of iterate and, for each stage, supports, mechanism_inertia, loads and
    carried, then finish. Before the first step stage 0 alone is iterated.
    """

    def begin(self, t: float, dt: float, state: MechanismState) -> None:
        """Prepare the step from t to t + dt [s], which starts from `state`."""

    def iterate(self) -> float:
        """Move the supports under the loads known so far; their largest change since the last call [m]."""

    def supports(self, stage: int, t: float) -> Frames:
        """Poses and motions of the supports."""

    def mechanism_inertia(self, stage: int, frames: Frames) -> np.ndarray | None:
        """Inertia (6 nb, 6 nb) besides the bodies', None if there is none."""

    def loads(self, stage: int, t: float, frames: Frames) -> np.ndarray:
        """Loads (nb, 6) about the bodies' origins, world axes, besides gravity [N, N m]."""

    def carried(self, stage: int, frames: Frames, held: np.ndarray, load: np.ndarray) -> None:
        """Take in the constraints' loads on bodies, held (nb, 6), and on supports, load (ns, 6) [N, N m]."""

    def finish(self) -> None:
        """Make the step's end the next one's start."""


class Errors(NamedTuple):
    """Largest constraint errors met: position [m], velocity [m/s], acceleration [m/s2]."""

    position: float
    velocity: float
    acceleration: float


def lobatto(stages: int) -> tuple[np.ndarray, np.ndarray]:
    """Points c (s,) and weights A (s, s) of Lobatto IIIA: trapezoidal rule for 2, order 4 for 3."""
    if stages not in (2, 3):
        raise InputError("stages", stages, "must be 2 (second order) or 3 (fourth order)")
    c = np.linspace(0, 1, stages)
    power = np.arange(stages)
    integral = c[:, None] ** (power + 1) / (power + 1)
    return c, integral @ np.linalg.inv(np.vander(c, increasing=True))


def mechanism(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    supports: Frames,
    *,
    gravity: Sequence[float],
    added_mass: np.ndarray | None = None,
) -> tuple[Mechanism, MechanismState]:
    """Arrays and initial state; supports are further frames, joints[...].first or second = nb, nb + 1, …"""
    nb = len(bodies)
    start = MechanismState(
        position=np.array([b.position for b in bodies], float).reshape(nb, 3),
        quaternion=np.array([np.divide(b.rotation, np.linalg.norm(b.rotation)) for b in bodies], float).reshape(nb, 4),
        velocity=np.array([b.velocity for b in bodies], float).reshape(nb, 6),
        acceleration=np.zeros((nb, 6)),
        multiplier=np.zeros(0),
    )
    rows = equations(tuple(joints), all_frames(start, supports))
    system = Mechanism(
        mass=np.array([b.mass for b in bodies], float),
        cog=np.array([b.cog for b in bodies], float).reshape(nb, 3),
        inertia=np.array([b.inertia_tensor for b in bodies], float).reshape(nb, 3, 3),
        gravity=np.array(gravity, float),
        equations=rows,
        added_mass=np.zeros((6 * nb, 6 * nb)) if added_mass is None else np.asarray(added_mass, float),
    )
    return system, start._replace(multiplier=np.zeros(row_count(rows)))


@kernel
def rotation_of(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4)."""
    R = np.empty((len(q), 3, 3))
    for n in range(len(q)):
        w, x, y, z = q[n]
        R[n, 0] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
        R[n, 1] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
        R[n, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


@kernel
def spin(w: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternion product (0, w) q (n, 4) of vectors (n, 3) in world axes; half of it is q̇."""
    out = np.empty_like(q)
    for n in range(len(q)):
        x, y, z = w[n]
        a, b, c, d = q[n]
        out[n] = -x * b - y * c - z * d, x * a + y * d - z * c, y * a + z * b - x * d, z * a + x * c - y * b
    return out


def all_frames(state: MechanismState, supports: Frames) -> Frames:
    """Bodies, supports, ground."""
    ground = (np.zeros((1, 3)), np.eye(3)[None], np.zeros((1, 6)), np.zeros((1, 6)))
    of_bodies = (state.position, rotation_of(state.quaternion), state.velocity, state.acceleration)
    return Frames(*(np.concatenate(parts) for parts in zip(of_bodies, supports, ground, strict=True)))


NO_SUPPORTS = Frames(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 6)), np.zeros((0, 6)))


@kernel
def inertia_and_bias(system: Mechanism, frames: Frames, M: np.ndarray, Q: np.ndarray) -> None:
    """M (6 nb, 6 nb) about the origins in world axes, and gravity less gyroscopic load Q (6 nb,)."""
    M[:] = system.added_mass
    for b in range(system.mass.size):
        R, m, w, o = frames.rotation[b], system.mass[b], frames.velocity[b, 3:], 6 * b
        s = R @ system.cog[b]
        cross = np.array([[0.0, -s[2], s[1]], [s[2], 0.0, -s[0]], [-s[1], s[0], 0.0]])
        inertia = R @ system.inertia[b] @ R.T - m * cross @ cross
        for r in range(3):
            M[o + r, o + r] += m
        M[o : o + 3, o + 3 : o + 6] -= m * cross
        M[o + 3 : o + 6, o : o + 3] += m * cross
        M[o + 3 : o + 6, o + 3 : o + 6] += inertia
        Q[o : o + 3] = m * system.gravity - m * np.cross(w, np.cross(w, s))
        Q[o + 3 : o + 6] = m * np.cross(s, system.gravity) - np.cross(w, inertia @ w)


class Augmented:
    """The matrix of eq. 1 at one pose, factored once and used for all three constraint levels."""

    def __init__(self, system: Mechanism, frames: Frames) -> None:
        self.system, self.n, self.m = system, 6 * system.mass.size, row_count(system.equations)
        self.M, self.Q = np.empty((self.n, self.n)), np.empty(self.n)
        self.C, self.J = np.empty(self.m), np.empty((self.m, 6 * len(frames.position)))
        self.bias = np.empty(self.m)
        self.evaluate(frames)
        K = np.zeros((self.n + self.m,) * 2)
        K[: self.n, : self.n], K[: self.n, self.n :], K[self.n :, : self.n] = self.M, self.Cu.T, self.Cu
        size = np.mean(np.sum(self.Cu**2, axis=1)) / np.mean(np.diag(self.M)) if self.m else 0.0
        K[self.n :, self.n :] -= EPSILON * size * np.eye(self.m)
        self._solve = splu(csc_matrix(K)).solve if len(K) > SPARSE else _dense(K)

    @property
    def Cu(self) -> np.ndarray:
        """The bodies' part (m, 6 nb) of the constraints' Jacobian."""
        return self.J[:, : self.n]

    def evaluate(self, frames: Frames) -> None:
        """Evaluate mass, constraints and their derivatives at frames."""
        inertia_and_bias(self.system, frames, self.M, self.Q)
        constraints(self.system.equations, frames, self.C, self.J, self.bias)

    def correction(self, gap: np.ndarray) -> np.ndarray:
        """Least motion (nb, 6), in the norm of M, that takes away `gap` (m,) of the constraints."""
        return self._solve(np.concatenate([np.zeros(self.n), -gap]))[: self.n].reshape(-1, 6)

    def accelerations(self, load: np.ndarray, Qd: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray, float]:
        """u̇ (nb, 6), λ (m,) and the constraint error, by refinement on the pose evaluated last."""
        x, top = np.zeros(self.n + self.m), self.Q + load
        for _ in range(INNER):
            u, multiplier = x[: self.n], x[self.n :]
            force = self.Cu.T @ multiplier
            rest = np.concatenate([top - self.M @ u - force, Qd - self.Cu @ u])
            error = np.abs(rest[self.n :]).max(initial=0.0)
            scale = max(np.abs(top).max(), np.abs(force).max())
            if error <= tolerance and np.abs(rest[: self.n]).max() <= ROUNDING * scale:
                break
            x = x + self._solve(rest)
        return x[: self.n].reshape(-1, 6), x[self.n :], error


def _dense(K: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    factors = lu_factor(K, check_finite=False)
    return lambda b: lu_solve(factors, b, check_finite=False)
