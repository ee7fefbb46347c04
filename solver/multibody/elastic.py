"""Supports of the augmented floats: fixed, or the modes of an elastic frame by the same collocation.

Each mode is p̈ + 2ζωṗ + ω²p = f with f from waves, drag and the joints; its stage values follow from
the stage loads in closed form, so that no frequency limits the step. Loads are iterated with the
floats until nothing changes. A node turns by its three rotations in turn about moved axes x, y, z.
"""

import numpy as np

from solver.multibody.augmented import NO_SUPPORTS
from solver.multibody.joints import GROUND, Frames
from solver.structure.support import Support


class FixedSupport:
    """Nothing moves."""

    history = ()

    def number(self, _b):
        return GROUND

    def begin(self, _times, _turn):
        pass

    def iterate(self):
        pass

    def frames(self, _stage):
        return NO_SUPPORTS

    def carried(self, _stage, _frames, _load, _reaction):
        pass

    def finish(self):
        pass


class ElasticSupport:
    """Modes of a frame that carries one float at each of `nodes` (nb, 3) [m]."""

    def __init__(self, support: Support, damping_ratio: float, nodes: np.ndarray, c, A, dt: float):
        self.support, self.nodes, self.dt, self.A = support, nodes, dt, A
        nm, s = support.omega.size, len(c)
        self.omega, self.damping = support.omega, 2 * damping_ratio * support.omega
        D = np.eye(s) + dt * self.damping[:, None, None] * A + (dt * self.omega[:, None, None]) ** 2 * (A @ A)
        self.inverse = np.linalg.inv(D[:, 1:, 1:])
        self.axes = np.arange(6) if len(support.carrier) == 6 * len(nodes) else np.array([0, 2, 4])
        self.station = support.station_shape.reshape(-1, nm)
        self.station_rows = support.station_rows.reshape(-1, support.station_rows.shape[-1])
        # Stage values, [0] the step's start.
        self.p, self.dp, self.ddp = np.zeros((3, s, nm))
        self.joint = np.zeros((s, nm))  # modal loads of the joints
        self.fresh = True  # no step is finished yet
        self.history = []  # modal amplitudes at all samples

    def start(self, carried: np.ndarray) -> None:
        """At rest under the static loads (nc,) of the floats on their nodes."""
        self.joint[:] = self.support.carrier.T @ carried
        self.p[:] = self.joint / self.omega**2

    def number(self, b):
        return len(self.nodes) + b

    def begin(self, _times, turn):
        """turn (n, s): exp(-iωt) times the ramp at the stages."""
        self.wave = (self.support.wave_rows @ turn).real.T
        self.flow = (self.station_rows @ turn).real.T
        self.joint[1:] = self.joint[0]

    def iterate(self):
        """Stage values of all modes from the loads known so far."""
        A, dt = self.A, self.dt
        f = self.wave + self.joint + self._drag()
        if self.fresh:  # the very first instant: accelerations from the loads, at rest
            self.ddp[0] = f[0] - self.damping * self.dp[0] - self.omega**2 * self.p[0]
        v0 = self.dp[0] + dt * A[1:, :1] * self.ddp[0]
        way = dt * A[1:].sum(axis=1)[:, None] * self.dp[0] + dt * dt * (A @ A)[1:, :1] * self.ddp[0]
        known = f[1:] - self.damping * v0 - self.omega**2 * (self.p[0] + way)
        self.ddp[1:] = np.einsum("msl,lm->sm", self.inverse, known)
        self.dp[1:] = v0 + dt * A[1:, 1:] @ self.ddp[1:]
        self.p[1:] = self.p[0] + way + dt * dt * (A @ A)[1:, 1:] @ self.ddp[1:]

    def _drag(self):
        """Modal drag (s, nm), ½ρC_D D|u - v|(u - v) at every station."""
        shape = (len(self.dp), *self.support.station_shape.shape[:2])
        relative = (self.flow - self.dp @ self.station.T).reshape(shape)
        size = np.sqrt(np.sum(relative**2, axis=2, keepdims=True))
        load = self.support.drag[:, None] * size * relative
        return load.reshape(len(self.dp), -1) @ self.station

    def frames(self, stage):
        """Pose, velocity and acceleration of every node."""
        carrier, nb = self.support.carrier, len(self.nodes)
        six = np.zeros((3, nb, 6))
        for level, x in enumerate((self.p, self.dp, self.ddp)):
            six[level][:, self.axes] = (carrier @ x[stage]).reshape(nb, -1)
        rotation, velocity, acceleration = np.empty((nb, 3, 3)), six[1].copy(), six[2].copy()
        for b in range(nb):
            rotation[b], axes = _turned(six[0, b, 3:])
            rate, twice = six[1, b, 3:], six[2, b, 3:]
            w, dw = np.zeros(3), axes @ twice
            for i in range(3):  # each axis is carried round by the rotations before it
                dw += np.cross(w, axes[:, i]) * rate[i]
                w = w + axes[:, i] * rate[i]
            velocity[b, 3:], acceleration[b, 3:] = w, dw
        return Frames(self.nodes + six[0, :, :3], rotation, velocity, acceleration)

    def carried(self, stage, _frames, load, reaction):
        """Take in the joints' loads (nb, 6) and the PTO's reaction on the nodes."""
        nb, total = len(self.nodes), load + reaction
        coordinates = np.zeros((nb, 6))
        angles = np.zeros((nb, 6))
        angles[:, self.axes] = (self.support.carrier @ self.p[stage]).reshape(nb, -1)
        for b in range(nb):
            _, axes = _turned(angles[b, 3:])
            coordinates[b] = [*total[b, :3], *(axes.T @ total[b, 3:])]
        self.joint[stage] = self.support.carrier.T @ coordinates[:, self.axes].ravel()
        if stage == 0:
            self.joint[1:] = self.joint[0]

    def finish(self):
        """Keep the stages' amplitudes, and begin the next step where this one ended."""
        self.history.extend(self.p[int(not self.fresh) :].copy())
        self.fresh = False
        for x in (self.p, self.dp, self.ddp, self.joint):
            x[0] = x[-1]


def _turned(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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
