"""What an arm's exact rotation does to means, of second order: forces keep their place on a lever that turns.

With the motions J(z)ż of the reference points, loads W on the floats and s = (z, ż, z̈), JᵀW is of second order in waves

    ⟨JᵀW⟩₂ = ½ Σᵢⱼ ⟨sᵢsⱼ⟩ ∂ᵢ∂ⱼ(JᵀW in still water) + Σᵢ ⟨zᵢ ∂ᵢJᵀ W'⟩,

W' what waves and radiation's memory add to the loads in still water; what they add by second-order motions has no mean,
for those are rates of something that stays. The coordinates shift by C⁻¹⟨JᵀW⟩₂, as the march's do (`python -m
studies.validate frequency-domain`), 0.02 rad of Buan's front float.

The record's means are those at rest all the same, and the linear model is about these. In Buan's representative sea,
platform fixed, it would have 2.6 and 1.0 % more power about the shifted ones, and a march that preloads hold at rest on
average has 2.6 and 2.2 % less than the linear model; by itself it has 0.3 and 1.3 % less. What else is of third order,
levers averaged over their turn and motions at sums and differences of two frequencies, takes more than the shift gives;
it is told from these differences and not derived. The shift without it would be worse than neither.
"""

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.linear import jacobian
from solver.frequency.case import Case
from solver.frequency.gaussian import covariance
from solver.frequency.response import Response

NEAR = 1e-3  # [m or rad] from equilibrium, where slopes are taken
SHARE = 1e-2  # of a std, where curvatures are


def mean_shift(case: Case, response: Response) -> np.ndarray:
    """(n,) of the linear model's coordinates [m, rad, ...], besides the shift by drag in a current."""
    body, model, z = case.system.bodies, case.model, case.system.equilibrium[0]
    rate, X = -1j * response.omega[:, None], response.X
    moving = response.wrench.copy()
    for k, slope in enumerate(model.wrench):
        moving -= np.einsum("wn,bdn->wbd", rate**k * X, slope)
    step = NEAR * np.eye(z.size)
    levers = np.array([jacobian(body, z + h) - jacobian(body, z - h) for h in step]) / (2 * NEAR)
    turned = covariance(response.Z, moving.reshape(len(moving), -1)).reshape(z.size, *moving.shape[1:])
    load = np.einsum("ibd,ibdk->k", turned, levers)
    states = np.concatenate([response.Z, rate * response.Z, rate**2 * response.Z], axis=1)
    size, axes = np.linalg.eigh(covariance(states, states))
    still = balance(body, z)[0]
    for way in (SHARE * np.sqrt(size.clip(min=0.0)) * axes).T.reshape(-1, 3, z.size):
        both = sum(balance(body, z + sign * way[0], sign * way[1], sign * way[2])[0] for sign in (1, -1))
        load += 0.5 * (both - 2 * still) / SHARE**2
    return np.linalg.lstsq(model.stiffness, model.shape.T @ load, rcond=None)[0]
