"""What an arm's exact rotation does, of second order: forces keep their place on a lever that turns.

With the motions J(z)ż of the reference points, loads W on the floats and s = (z, ż, z̈), JᵀW is of second order in waves

    (JᵀW)₂ = ½ Σᵢⱼ sᵢsⱼ ∂ᵢ∂ⱼ(JᵀW in still water) + Σᵢ zᵢ ∂ᵢJᵀ W',

W' what waves and radiation's memory add to the loads in still water. Two waves make a load at the difference of their
frequencies. It drives a shape φ of unit inertia that swings below all waves and is damped by little, B, and whose
spectrum S of φᵀ(JᵀW)₂ is flat there, with the variance

    ⟨y²⟩ = π S(ω₀)/(2Bω₀²).

No line of the linear response has it: `rotation_effect` tells how much it is. What second-order motions add has no
mean, for those are rates of something that stays. By the mean the coordinates shift by C⁻¹⟨(JᵀW)₂⟩, as the march's do
(`python -m studies.validate frequency-domain`), 0.02 rad of Buan's front float.

The record's means are those at rest all the same, and the linear model is about these. In Buan's representative sea,
platform fixed, it would have 2.6 and 1.0 % more power about the shifted ones, and a march that preloads hold at rest on
average has 2.6 and 2.2 % less than the linear model; by itself it has 0.3 and 1.3 % less. What else is of third order,
levers averaged over their turn and motions at sums and differences of two frequencies, takes more than the shift gives;
it is told from these differences and not derived. The shift without it would be worse than neither.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.linear import jacobian
from solver.coupled.support import KNOWN
from solver.coupled.system import Resting
from solver.frequency.case import Case
from solver.frequency.gaussian import covariance
from solver.frequency.response import Response
from solver.lines import lengths
from solver.record.slow import LIGHTLY, below
from solver.statistics import FAINT

NEAR = 1e-3  # [m or rad, in a second and its square] from equilibrium, where slopes and curvatures are taken
REACH = 2.0  # standard deviations of a band of frequencies, each as wide as waves are apart


class _Turning(NamedTuple):
    """How the loads on nz coordinates change with them, to second order."""

    levers: np.ndarray  # ∂ᵢJ (nz, nb, 6, nz)
    curvature: np.ndarray  # ∂ᵢ∂ⱼ(JᵀW)_k in still water (nz, 3nz, 3nz), k first


class _Swinging(NamedTuple):
    """A shape below the waves, and what makes its load; np pairs of waves whose frequencies differ by about its own."""

    omega: float
    shape: np.ndarray  # φ (n,)
    radiated: float  # part of B
    levers: np.ndarray  # ∂ᵢJ φ (6nb, nz)
    still: np.ndarray  # of the loads in still water on these (3, n, nz), by x, ẋ and ẍ
    curvature: np.ndarray  # (3nz, 3nz)
    pairs: np.ndarray  # (2, np)
    band: np.ndarray  # g (np,) [s/rad] of each


def mean_shift(case: Case, response: Response) -> np.ndarray:
    """(n,) of the linear model's coordinates [m, rad, ...], besides the shift by drag in a current."""
    turning, model, z = _turning(case.system.resting), case.model, response.Z
    rate, moving = -1j * response.omega[:, None], response.wrench.copy()
    for k, slope in enumerate(model.wrench):
        moving -= np.einsum("wn,bdn->wbd", rate**k * response.X, slope)
    together = covariance(z, moving.reshape(len(moving), -1)).reshape(turning.levers.shape[:3])
    states = _states(response.omega, z)
    load = np.einsum("ibd,ibdk->k", together, turning.levers)
    load += 0.5 * np.einsum("kij,ij->k", turning.curvature, covariance(states, states))
    return np.linalg.lstsq(model.stiffness, model.shape.T @ load, rcond=None)[0]


def rotation_effect(case: Case, response: Response) -> float:
    """Relative error of any std by what arms' rotation drives below the waves; power, by rates, errs less."""
    slow = slow_motions(case, response)
    if not slow.any():
        return 0.0
    std = lengths(response.X.T) / np.sqrt(2)
    moved = case.model.length * std
    used = moved > FAINT * moved.max()
    return float(np.max(np.hypot(1, slow[used] / std[used]), initial=1.0) - 1)


def slow_motions(case: Case, response: Response) -> np.ndarray:
    """Their std (n,) of the linear model's coordinates [m, rad, ...]."""
    damping, waves = case.model.damping + response.damping, case.waves.size
    variance = np.zeros(len(damping))
    for swinging in _swinging(case):
        shape, own = swinging.shape, swinging.omega
        B = shape @ damping @ shape + swinging.radiated
        if 0 < B < 2 * LIGHTLY * own:
            S = _spectrum(swinging, case.waves, response.X[:waves], response.Z[:waves], response.wrench[:waves])
            variance += np.pi * S / (2 * B * own**2) * shape**2
    return np.sqrt(variance)


def _spectrum(of: _Swinging, omega: np.ndarray, X: np.ndarray, z: np.ndarray, wrench: np.ndarray) -> float:
    """S of its load at its own frequency, one-sided: ½ Σ |f|² g over the pairs of waves omega (nw,),

    f = ½ (z⋆b + b⋆z + s⋆Hs) of two waves' z, s and b = W' on levers, the second ones conjugate.
    """
    rate = -1j * omega[:, None]
    borne = wrench.reshape(len(z), -1) @ of.levers - sum(rate**k * (X @ still) for k, still in enumerate(of.still))
    states = _states(omega, z)
    first = np.concatenate([z, borne, states @ of.curvature], axis=1)[of.pairs[0]]
    second = np.concatenate([borne, z, states], axis=1)[of.pairs[1]]
    f = 0.5 * np.einsum("pi,pi->p", first, second.conj())
    return float(0.5 * np.abs(f) ** 2 @ of.band)


def _states(omega: np.ndarray, z: np.ndarray) -> np.ndarray:
    """s (nl, 3nz) of lines z (nl, nz)."""
    rate = -1j * omega[:, None]
    return np.concatenate([z, rate * z, rate**2 * z], axis=1)


@lru_cache(maxsize=KNOWN)
def _swinging(case: Case) -> tuple[_Swinging, ...]:
    """The shapes below the waves; none of a single wave, nor without floats."""
    model, omega, shapes = case.model, case.waves, below(case.system, case.hydrodynamics)
    if not (shapes.omega.size and case.system.scene.floats):
        return ()
    turning, width, found = _turning(case.system.resting), np.ptp(omega) / (omega.size - 1), []
    order = np.argsort(omega)
    for own, shape, radiated in zip(shapes.omega, shapes.shapes, shapes.radiated, strict=True):
        along = model.shape @ shape
        levers = (turning.levers @ along).reshape(along.size, -1).T
        still = np.moveaxis(model.wrench.reshape(3, len(levers), -1), 1, 2) @ levers
        begin, end = np.searchsorted(omega[order], [omega + own - REACH * width, omega + own + REACH * width])
        higher = order[np.concatenate([np.arange(*ends) for ends in zip(begin, end, strict=True)])]
        pairs = np.stack([higher, np.repeat(np.arange(omega.size), end - begin)])
        off = (np.subtract(*omega[pairs]) - own) / width
        band = np.exp(-0.5 * off**2) / (width * np.sqrt(2 * np.pi))
        curvature = np.tensordot(along, turning.curvature, 1)
        found.append(_Swinging(own, shape, radiated, levers, still, curvature, pairs, band))
    return tuple(found)


@lru_cache(maxsize=KNOWN)
def _turning(resting: Resting) -> _Turning:
    """Scenes that differ in their seas and dampers alone share it."""
    body, _, z = resting.value
    steps, ways = NEAR * np.eye(z.size), NEAR * np.eye(3 * z.size)
    levers = np.array([jacobian(body, z + h) - jacobian(body, z - h) for h in steps]) / (2 * NEAR)
    i, j = np.triu_indices(3 * z.size)
    states = np.stack([ways[i] + ways[j], -ways[i] - ways[j], ways[i] - ways[j], ways[j] - ways[i]])
    at, rate, acceleration = np.split(states, 3, axis=-1)
    load = balance(body, z + at, rate, acceleration)[0]
    curvature = np.empty((z.size, 3 * z.size, 3 * z.size))
    curvature[:, i, j] = curvature[:, j, i] = (load[0] + load[1] - load[2] - load[3]).T / (2 * NEAR) ** 2
    return _Turning(levers, curvature)
