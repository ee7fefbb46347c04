"""Supports of the augmented floats: fixed, or the modes of an elastic frame by the same collocation.

Each mode is p̈ + 2ζωṗ + ω²p = f with f from waves, drag and the joints; its stage values follow from
the stage loads in closed form, so that no frequency limits the step. Loads are iterated with the
floats until nothing changes. A node turns by its three rotations in turn about moved axes x, y, z.
"""

import numpy as np

from solver.coupled.driving import Driven
from solver.coupled.support import Support
from solver.reference.augmented import NO_SUPPORTS
from solver.reference.joints import GROUND, Frames


class FixedSupport:
    """A support without coordinates."""

    work = np.zeros(3)
    energy = 0.0

    def sample(self, _stage: int) -> tuple[np.ndarray, ...]:
        """No modes, and no loads on a frame."""
        return np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((1, 0))

    def frame_number(self, _b: int) -> int:
        """The ground carries every float."""
        return GROUND

    def begin(self, _times: np.ndarray, _turn: np.ndarray) -> None:
        """Nothing to prepare."""

    def iterate(self) -> float:
        """0: nothing moves."""
        return 0.0

    def frames(self, _stage: int) -> Frames:
        """None besides the ground."""
        return NO_SUPPORTS

    def carried(self, _stage: int, _load: np.ndarray, _reaction: np.ndarray) -> None:
        """The ground takes every load."""

    def finish(self) -> None:
        """Nothing to carry on."""


class ElasticSupport:
    """Modes of a frame that carries one float at each of `nodes` (nb, 3) [m]."""

    def __init__(
        self,
        support: Support,
        rows: Driven,
        nodes: np.ndarray,
        c: np.ndarray,
        A: np.ndarray,
        dt: float,
    ) -> None:
        self.support, self.rows, self.nodes, self.dt, self.A = support, rows, nodes, dt, A
        nm, s = support.omega.size, len(c)
        self.omega, self.damping = support.omega, 2 * support.damping * support.omega
        D = np.eye(s) + dt * self.damping[:, None, None] * A + (dt * self.omega[:, None, None]) ** 2 * (A @ A)
        self.inverse = np.linalg.inv(D[:, 1:, 1:])
        self.axes = np.arange(6) if len(support.carrier) == 6 * len(nodes) else np.array([0, 2, 4])
        self.station = support.station_shape.reshape(-1, nm)
        self.station_rows = rows.stations.reshape(-1, rows.stations.shape[-1])
        # Stage values, [0] the step's start.
        self.p, self.dp, self.ddp = np.zeros((3, s, nm))
        self.node = np.zeros((s, len(support.carrier)))  # loads of the joints on the nodes
        # The floats' loads for those assumed, and all of this step with what they were off.
        self.answer: np.ndarray | None = None
        self.tried: list[tuple[np.ndarray, np.ndarray]] = []
        self.scale = np.abs(support.shapes.reshape(-1, 6, nm)[:, :3]).max(axis=(0, 1))  # [m] a mode moves at most
        # Works of the wave's inertia load, of structural damping and of drag: audit figures.
        self.work, self.power = np.zeros(3), np.zeros((s, 3))

    def start(self, p: np.ndarray, ddp: np.ndarray) -> None:
        """At rest with amplitudes p (nm,), let go with accelerations ddp."""
        self.p[:], self.ddp[:] = p, ddp
        self.node[:] = np.linalg.lstsq(self.support.carrier.T, self.omega**2 * p, rcond=None)[0]

    def frame_number(self, b: int) -> int:
        """Number among the frames of the node that carries float b."""
        return len(self.nodes) + b

    def begin(self, _times: np.ndarray, turn: np.ndarray) -> None:
        """Waves of the step's stages; turn (n, s): exp(-iωt) times the ramp there."""
        self.wave = (self.rows.modes @ turn).real.T
        self.flow = (self.station_rows @ turn).real.T
        self.node[1:] = self.node[0]
        self.answer, self.tried = None, []

    def _couple(self) -> None:
        """The next loads of the joints to try, by Anderson's extrapolation from all tried in this step.

        A heavy float on a light node answers each acceleration with a larger one: taking the answer as the
        next try would diverge. Loads are few, so that their linear dependence is soon known.
        """
        if self.answer is None:
            return
        x, r = self.node.ravel(), (self.answer - self.node).ravel()
        self.tried.append((x.copy(), r))
        new = x + r
        if len(self.tried) > 1:
            X, R = (np.array(part).T for part in zip(*self.tried, strict=True))
            dX, dR = np.diff(X), np.diff(R)
            new = new - (dX + dR) @ np.linalg.lstsq(dR, r, rcond=1e-9)[0]
        self.node[:] = new.reshape(self.node.shape)

    def iterate(self) -> float:
        """Stage values of all modes from the loads known so far."""
        A, dt = self.A, self.dt
        self._couple()
        drag, before = self._drag(), self.p.copy()
        f = self.wave + self.node @ self.support.carrier + drag
        v0 = self.dp[0] + dt * A[1:, :1] * self.ddp[0]
        way = dt * A[1:].sum(axis=1)[:, None] * self.dp[0] + dt * dt * (A @ A)[1:, :1] * self.ddp[0]
        known = f[1:] - self.damping * v0 - self.omega**2 * (self.p[0] + way)
        self.ddp[1:] = np.einsum("msl,lm->sm", self.inverse, known)
        self.dp[1:] = v0 + dt * A[1:, 1:] @ self.ddp[1:]
        self.p[1:] = self.p[0] + way + dt * dt * (A @ A)[1:, 1:] @ self.ddp[1:]
        dissipated = np.sum(self.damping * self.dp**2, axis=1)
        self.power[:] = np.stack([np.sum(self.wave * self.dp, axis=1), dissipated, np.sum(drag * self.dp, axis=1)], 1)
        return float((np.abs(self.p - before) * self.scale).max())

    def _drag(self) -> np.ndarray:
        """Modal drag (s, nm)."""
        return self._drag_loads().reshape(len(self.dp), -1) @ self.station

    def _drag_loads(self) -> np.ndarray:
        """½ρC_D D|u - v|(u - v) at every station, (s, ns, nd)."""
        shape = (len(self.dp), *self.support.station_shape.shape[:2])
        relative = (self.flow - self.dp @ self.station.T).reshape(shape)
        size = np.sqrt(np.sum(relative**2, axis=2, keepdims=True))
        return self.support.drag[:, None] * size * relative

    def frames(self, stage: int) -> Frames:
        """Pose, velocity and acceleration of every node."""
        carrier, nb = self.support.carrier, len(self.nodes)
        if not nb:
            return NO_SUPPORTS
        six = np.zeros((3, nb, 6))
        for level, x in enumerate((self.p, self.dp, self.ddp)):
            six[level][:, self.axes] = (carrier @ x[stage]).reshape(nb, -1)
        rotation, velocity, acceleration = np.empty((nb, 3, 3)), six[1].copy(), six[2].copy()
        for b in range(nb):
            rotation[b], axes = _rotations(six[0, b, 3:])
            rate, twice = six[1, b, 3:], six[2, b, 3:]
            w, dw = np.zeros(3), axes @ twice
            for i in range(3):  # each axis is carried round by the rotations before it
                dw += np.cross(w, axes[:, i]) * rate[i]
                w = w + axes[:, i] * rate[i]
            velocity[b, 3:], acceleration[b, 3:] = w, dw
        return Frames(self.nodes + six[0, :, :3], rotation, velocity, acceleration)

    def carried(self, stage: int, load: np.ndarray, reaction: np.ndarray) -> None:
        """Take in the constraints' loads (nb, 6) on the nodes and the reaction (nb, 6) of springs and dampers."""
        nb, total = len(self.nodes), load + reaction
        coordinates = np.zeros((nb, 6))
        angles = np.zeros((nb, 6))
        angles[:, self.axes] = (self.support.carrier @ self.p[stage]).reshape(nb, -1)
        for b in range(nb):
            _, axes = _rotations(angles[b, 3:])
            coordinates[b] = [*total[b, :3], *(axes.T @ total[b, 3:])]
        if self.answer is None:
            self.answer = self.node.copy()
        self.answer[stage] = coordinates[:, self.axes].ravel()

    def sample(self, stage: int) -> tuple[np.ndarray, ...]:
        """Modal amplitudes (nm,), rates and accelerations, the joints' loads on the nodes (nc,), drag (nd, ns)."""
        motion = (x[stage].copy() for x in (self.p, self.dp, self.ddp))
        return *motion, self.node[stage].copy(), self._drag_loads()[stage].T

    @property
    def energy(self) -> float:
        """Stored in the modes at the step's start [J]."""
        return float(np.sum(self.dp[0] ** 2 + (self.omega * self.p[0]) ** 2) / 2)

    def finish(self) -> None:
        """Begin the next step where this one ended."""
        self.work += self.dt * self.A[-1] @ self.power
        for x in (self.p, self.dp, self.ddp, self.node, self.power):
            x[0] = x[-1]


def _rotations(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation Rx Ry Rz (3, 3) by angles about moved axes, and those axes as columns (3, 3)."""
    R, axes = np.eye(3), np.empty((3, 3))
    for i, angle in enumerate(angles):
        axes[:, i] = R[:, i]
        j, k = (i + 1) % 3, (i + 2) % 3
        turn = np.eye(3)
        turn[j, j] = turn[k, k] = np.cos(angle)
        turn[k, j], turn[j, k] = np.sin(angle), -np.sin(angle)
        R = R @ turn
    return R, axes
