"""A radiation memory fitted again to what the scene's motions ask of it.

The usual fit's misfit is a share of each motion's largest radiation, whatever floats it is for. What hardly radiates
where it resonates, and is damped by little else, would swing by it. There the fit counts misfits by the motions: with
Z the linear model's dynamic stiffness and E x what radiates, a change δY of the impedance changes them by

    δX_k = Σ_ij (Z⁻¹Eᵀ)_ki iω δY_ij (E X)_j.
"""

import numpy as np

from solver import motions
from solver.coupled.linear import impedance, linear_model
from solver.coupled.system import System, prepare, remembered
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.radiation.memory import USUAL
from solver.keys import Bits
from solver.record.accuracy import MARGIN, SHARE
from solver.record.audit import coefficient_effects, decay, excitation
from solver.scene import Scene
from solver.statistics import FAINT

SWAYED = 3e-3  # what the fit may change a motion's std or its power by, relative, where no tolerance is given
TOLERANCES = (USUAL, 2e-3, 1e-3, 3e-4)  # of the fit that counts by the motions, one after another until it does
FEW = 12  # motions that radiate: their fits take seconds, those of many more minutes
LEAST = 0.1  # of a motion's largest response: changes of less are relative to that


def prepared(scene: Scene, h: Hydrodynamics | None) -> System:
    """The scene as arrays; its memory is fitted to the motions where the usual fit sways them more than it may."""
    best, asked = prepare(scene, h), scene.settings
    if h is None or best.fit is None or asked.memory == "convolution" or asked.memory_tolerance is not None:
        return best
    if np.any(best.fit.residue, axis=(0, 1)).sum() > FEW:
        return best
    allowed = SWAYED if asked.tolerance is None else SHARE["memory_effect"] ** 0.5 * asked.tolerance / MARGIN
    effect = coefficient_effects(best, h)[0]
    if effect > allowed:
        counts = Bits(importance(best, h))
        hulls, ways = tuple(f.hull for f in scene.floats), motions.of_scene(scene)
        for tolerance in TOLERANCES:
            fit = remembered(h, hulls, tolerance, ways, counts)
            fitted = prepare(scene, h, fit)
            less = coefficient_effects(fitted, h)[0]
            if less < effect:
                best, effect = fitted, less
            if effect <= allowed or fit.error > tolerance:  # what is not met finer ones will not meet
                break
    return best


def importance(system: System, h: Hydrodynamics) -> np.ndarray:
    """max_k ω |(Z⁻¹Eᵀ)_ki| |(E X)_j| / |X_k| (nw, na, na) at the frequencies solved, zero beyond the scene's waves.

    X: in waves of one height at all frequencies; in still water what follows from the offsets.
    """
    model, omega, sea = linear_model(system), h.omega, system.scene.sea
    Y = impedance(system, h, omega)
    if sea.amplitude.any():
        X = model.response(omega, Y, excitation(system, h, omega) @ model.active)
        low, high = np.interp([sea.omega.min(), sea.omega.max()], omega, np.arange(omega.size))
        inside = (np.arange(omega.size) >= np.floor(low)) & (np.arange(omega.size) <= np.ceil(high))
    else:
        X, inside = decay(system, model, omega, Y), np.ones(omega.size, bool)
    size, largest = np.abs(X), np.abs(X)[inside].max(axis=0)
    used = model.length * largest > FAINT * np.max(model.length * largest, initial=0.0)
    receptance = np.linalg.solve(
        model.dynamic_stiffness(omega, Y), np.broadcast_to(model.active.T, (omega.size, *model.active.T.shape))
    )
    change = np.abs(receptance[:, used]) / np.maximum(size, LEAST * largest)[:, used, None]
    moved = np.abs(X @ model.active.T)
    return np.asarray((inside * omega)[:, None, None] * change.max(axis=1)[:, :, None] * moved[:, None, :])
