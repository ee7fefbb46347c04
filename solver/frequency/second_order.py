"""What loads of second order are made of: levers that turn, and curvatures of those in still water; see rotation."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.linear import KNOWN as MODELS
from solver.coupled.linear import jacobian, of_waves
from solver.coupled.system import Resting
from solver.frequency.case import Case

NEAR = 1e-3  # [m or rad, in a second and its square] from equilibrium, where slopes and curvatures are taken


class Turning(NamedTuple):
    """How the levers of W' change with nz coordinates."""

    levers: np.ndarray  # ∂ᵢJ (nz, nb, 6, nz), of `of_waves`: they may turn with the bodies
    directions: np.ndarray  # (nz, nb, 6, 6) of W'
    angles: np.ndarray  # (nz,) which of them turn a float: loads on its lever, or those of its centre of gravity


class Along(NamedTuple):
    """What makes loads along a shape φ, of which z has so much: f = ½ (z⋆b + b⋆z + s⋆Hs) of two lines' z, s and
    b = W' on levers, those of the second conjugate."""

    levers: np.ndarray  # ∂ᵢJ φ (6nb, nz)
    curvature: np.ndarray  # H (3nz, 3nz)

    @classmethod
    def of(cls, resting: Resting, along: np.ndarray) -> "Along":
        """along (nz,): z for a unit of φ."""
        levers = (turning(resting).levers @ along).reshape(along.size, -1).T
        return cls(levers, np.tensordot(along, curvature(resting), 1))

    def first(self, z: np.ndarray, s: np.ndarray, added: np.ndarray) -> np.ndarray:
        """(nl, 5nz) of lines z (nl, nz), s (nl, 3nz) and W' (nl, 6nb)."""
        return np.concatenate([z, added @ self.levers, s @ self.curvature], axis=1)

    def second(self, z: np.ndarray, s: np.ndarray, added: np.ndarray) -> np.ndarray:
        """The same of those that are conjugate."""
        return np.concatenate([added @ self.levers, z, s], axis=1)


def load(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """f (nl,) of two lines each (nl, 5nz)."""
    return np.asarray(0.5 * np.vecdot(second, first))


def added(case: Case, omega: np.ndarray, X: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    """W' (nl, 6nb): loads (nl, nb, 6) at lines omega (nl,) less those in still water by motions X (nl, n)."""
    rate = -1j * omega[:, None]
    still = sum(rate**k * (X @ W.reshape(-1, X.shape[1]).T) for k, W in enumerate(case.model.wrench))
    return np.asarray(wrench.reshape(len(X), -1) - still)


def states(omega: np.ndarray, z: np.ndarray) -> np.ndarray:
    """s (nl, 3nz) of lines z (nl, nz)."""
    rate = -1j * omega[:, None]
    return np.concatenate([z, rate * z, rate**2 * z], axis=1)


@lru_cache(maxsize=MODELS)
def turning(resting: Resting) -> Turning:
    """Scenes that differ in their seas and dampers alone share it."""
    body, _, z = resting.value
    steps = NEAR * np.eye(z.size)
    sides = (of_waves(body, balance(body, z + way * steps), z) for way in (1, -1))
    levers, directions = ((up - down) / (2 * NEAR) for up, down in zip(*sides, strict=True))
    angles = np.any(jacobian(body, z)[:, 3:], axis=(0, 1))
    return Turning(levers, directions, angles)


@lru_cache(maxsize=MODELS)
def curvature(resting: Resting) -> np.ndarray:
    """∂ᵢ∂ⱼ(JᵀW)_k in still water (nz, 3nz, 3nz), k first."""
    body, _, z = resting.value
    ways = NEAR * np.eye(3 * z.size)
    i, j = np.triu_indices(3 * z.size)
    states = np.stack([ways[i] + ways[j], -ways[i] - ways[j], ways[i] - ways[j], ways[j] - ways[i]])
    at, rate, acceleration = np.split(states, 3, axis=-1)
    load = balance(body, z + at, rate, acceleration)[0]
    curves = np.empty((z.size, 3 * z.size, 3 * z.size))
    curves[:, i, j] = curves[:, j, i] = (load[0] + load[1] - load[2] - load[3]).T / (2 * NEAR) ** 2
    return curves


@lru_cache(maxsize=MODELS)
def both(resting: Resting) -> np.ndarray:
    """Maps (nz, 6nb + 3nz, 3nz) of s to b and ½Hs of each load, which go with another wave's W' and s."""
    levers = turning(resting).levers
    nz = len(levers)
    of_levers = np.pad(levers.reshape(nz, -1, nz).T, ((0, 0), (0, 0), (0, 2 * nz)))
    return np.concatenate([of_levers, curvature(resting) / 2], axis=1)
