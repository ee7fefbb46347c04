"""A radiation memory fitted again to what the scene's motions ask of it.

The usual fit's misfit is a share of each motion's largest radiation, whatever floats it is for. What hardly radiates
where it resonates, and is damped by little else, would swing by it. There the fit counts misfits by the motions: with
Z the linear model's dynamic stiffness and E x what radiates, a change δY of the impedance changes them by

    δX_k = Σ_ij (Z⁻¹Eᵀ)_ki iω δY_ij (E X)_j.
"""

import numpy as np

from solver import motions
from solver.coupled.linear import impedance, linear_model
from solver.coupled.preparation import prepare, remembered
from solver.coupled.system import System
from solver.errors import SimulationFailed
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.radiation.memory import USUAL
from solver.keys import Bits
from solver.record.accuracy import MARGIN, SHARE
from solver.record.decay import spectrum
from solver.record.effects import coefficient_effects
from solver.record.response import excitation
from solver.scene import Scene
from solver.statistics import FAINT

SWAYED = 3e-3  # what the fit may change a motion's RAO, its std or its power by, relative, where no tolerance is given
TIMES = (2, 4, 8, 16)  # that what misfits do to the motions counts, one after another until it is little enough
FEW = 12  # motions that there are: their fits take seconds
MANY = 24  # whose fits take ten, where one has met its tolerance; else they end as it did, after a minute
LEAST = 0.1  # of a motion's largest response: changes of less are relative to that


def prepared(scene: Scene, h: Hydrodynamics | None) -> System:
    """The scene as arrays; its memory is fitted to the motions where the usual fit sways them more than it may."""
    best, asked = prepare(scene, h), scene.settings
    if h is None or best.fit is None or asked.memory == "convolution" or asked.memory_tolerance is not None:
        return best
    hulls, ways = tuple(f.hull for f in scene.floats), motions.of_scene(scene)
    if h.moved(ways).sum() > (MANY if best.fit.error <= USUAL else FEW):
        return best
    allowed = SWAYED if asked.tolerance is None else SHARE["memory_effect"] ** 0.5 * asked.tolerance / MARGIN
    effect = _swayed(best, h)
    counts = importance(best, h) if effect > allowed else np.zeros(0)
    for times in TIMES:
        if effect <= allowed:
            break
        try:
            fitted = prepare(scene, h, remembered(h, hulls, USUAL, ways, Bits(times * counts)))
        except SimulationFailed:  # nothing comes as close as that; `memory_effect` says what is left
            continue
        less = _swayed(fitted, h)
        if less < effect:
            best, effect = fitted, less
    return best


def _swayed(system: System, h: Hydrodynamics) -> float:
    """What the fit changes of the motions at the frequencies solved, over the largest of each, and of their means."""
    inside, exact = _motions(system, h, impedance(system, h, h.omega))
    assert system.fit is not None, "asked of a scene that has one"
    change = np.abs(_motions(system, h, system.fit.frequency(h.omega))[1] - exact)[inside].max(axis=0)
    used, largest = _used(system, exact[inside])
    return max(coefficient_effects(system, h)[0], float(np.max(change[used] / largest[used], initial=0.0)))


def _motions(system: System, h: Hydrodynamics, Y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of the frequencies solved (nw,) the scene's waves have, and X (nw, n) in waves of one height at all of
    them; in still water what follows from the offsets.
    """
    model, omega, sea = linear_model(system), h.omega, system.scene.sea
    if not sea.amplitude.any():
        return np.ones(omega.size, bool), spectrum(system, omega, Y)
    low, high = np.interp([sea.omega.min(), sea.omega.max()], omega, np.arange(omega.size))
    inside = (np.arange(omega.size) >= np.floor(low)) & (np.arange(omega.size) <= np.ceil(high))
    return inside, model.response(omega, Y, excitation(system, h, omega) @ model.active)


def _used(system: System, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which motions (n,) there are, and the largest X (nw, n) of each."""
    model, largest = linear_model(system), np.abs(X).max(axis=0)
    return model.length * largest > FAINT * np.max(model.length * largest, initial=0.0), largest


def importance(system: System, h: Hydrodynamics) -> np.ndarray:
    """max_k ω |(Z⁻¹Eᵀ)_ki| |(E X)_j| / |X_k| (nw, na, na) at the frequencies solved, zero beyond the scene's waves."""
    model, omega, Y = linear_model(system), h.omega, impedance(system, h, h.omega)
    inside, X = _motions(system, h, Y)
    size, (used, largest) = np.abs(X), _used(system, X[inside])
    receptance = np.linalg.solve(
        model.dynamic_stiffness(omega, Y), np.broadcast_to(model.active.T, (omega.size, *model.active.T.shape))
    )
    change = np.abs(receptance[:, used]) / np.maximum(size, LEAST * largest)[:, used, None]
    moved = np.abs(X @ model.active.T)
    return np.asarray((inside * omega)[:, None, None] * change.max(axis=1)[:, :, None] * moved[:, None, :])
