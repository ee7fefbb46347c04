"""A radiation memory fitted again to what the scene's motions ask of it.

The usual fit's misfit is a share of each motion's largest radiation, whatever floats it is for. What hardly radiates
where it resonates, and is damped by little else, would swing by it. There the fit counts misfits by the motions: with
Z the linear model's dynamic stiffness and E x what radiates, a change δY of the impedance changes them by

    δX_k = Σ_ij (Z⁻¹Eᵀ)_ki iω δY_ij (E X)_j.

What resonates beside the waves and is driven there counts by what a misfit does to its resonance, and an axis with end
stops by what it does to its bounces, see `beside`.
Poles are the coefficients' and not the sea's: those of the usual fit stay, or somewhat more are sought as it sought
them, once for all seas. What they weigh is found again, which is soon done.

Water that rings in a band narrower than the frequencies are apart may take the fit's A∞ so far from the boundary
elements' that M + A∞ is not positive, and nothing stable. There A∞ is held nearer to theirs, no more than it must:
the rest fits the worse for it, which `memory_effect` tells.
"""

from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np

from solver import motions
from solver.coupled.linear import impedance, linear_model
from solver.coupled.moving import excitation, moving_model
from solver.coupled.preparation import prepare, remembered
from solver.coupled.system import KNOWN, System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.bem.mean_hull import motion_lengths
from solver.hydrodynamics.hull.mesh import Hull
from solver.hydrodynamics.radiation.fitting import HOPELESS, LOOSE, USUAL, Samples, samples
from solver.hydrodynamics.radiation.memory import RadiationMemory
from solver.keys import Bits, shared
from solver.record.accuracy import MARGIN, SHARE
from solver.record.beside import bounced, importance_beside
from solver.record.decay import spectrum
from solver.record.effects import memory_effect
from solver.scene import Scene, Settings
from solver.statistics import FAINT

SWAYED = 3e-3  # what the fit may change a motion's RAO, its std or its power by, relative, where no tolerance is given
TIMES = (2, 4, 8, 16)  # that what misfits do to the motions counts, one after another until it is little enough
MORE = (1.25, 1.5)  # times as many poles as the usual fit has, one after another, where with those it is not
FEW = 12  # motions that there are and are fitted again, wherever the usual fit ended
SEVERAL, MANY = 21, 24  # and where it met its tolerance, with more poles or, twice, its own: passive residues take long
HOLDS = tuple(LOOSE * 10.0**n for n in range(1, 5))  # on A∞, one after another until all that moves has mass
LEAST = 0.1  # of a motion's largest response: changes of less are relative to that

Ways = tuple[tuple[str, ...], ...]  # motions that each float can have


def prepared(scene: Scene, h: Hydrodynamics | None) -> System:
    """The scene as arrays; its memory is fitted to the motions where the usual fit sways them more than it may."""
    (usual, _), asked = _usual(scene, h), scene.settings
    if h is None or usual.fit is None or asked.memory == "convolution" or asked.memory_tolerance is not None:
        return usual
    hulls, ways = tuple(f.hull for f in scene.floats), motions.of_scene(scene)
    if h.moved(ways).sum() > (MANY if usual.fit.error <= USUAL else FEW):
        return usual
    stepless = replace(asked, time_step=None, newton_tolerance=Settings().newton_tolerance)
    fit = _suited(replace(scene, settings=stepless), h, hulls, ways)
    return usual if fit is usual.fit else prepare(scene, h, fit)


def _usual(scene: Scene, h: Hydrodynamics | None) -> tuple[System, float]:
    """With the memory as any scene has it, and how hard its A∞ is held: where it must be for M + A∞ > 0."""
    usual = prepare(scene, h)
    if h is None or usual.fit is None or _has_mass(usual, usual.fit) or not _has_mass(usual, h):
        return usual, LOOSE
    hulls, ways = tuple(f.hull for f in scene.floats), motions.of_scene(scene)
    for hold in HOLDS:
        fit = remembered(h, hulls, scene.settings.memory_tolerance or USUAL, ways, hold)
        if _has_mass(usual, fit):
            break
    return prepare(scene, h, fit), hold


def _has_mass(system: System, known: Hydrodynamics | RadiationMemory) -> bool:
    """Whether all that moves has mass above zero, with this added mass at infinite frequency."""
    model = linear_model(system)
    change = model.active.T @ (known.added_mass_inf - system.bodies.added_mass) @ model.active
    mass = (model.mass + change) / np.outer(model.length, model.length)
    return bool(np.linalg.eigvalsh(mass).min(initial=np.inf) > 0)


@lru_cache(maxsize=KNOWN)
def _suited(scene: Scene, h: Hydrodynamics, hulls: tuple[Hull, ...], ways: Ways) -> RadiationMemory | None:
    """The memory that does, or the best that there is: the same whatever the step, which runs are repeated with."""
    asked, (best, hold) = scene.settings.tolerance, _usual(scene, h)
    allowed = SWAYED if asked is None else SHARE["memory_effect"] ** 0.5 * asked / MARGIN
    usual, effect, moving = best.fit, _swayed(best, h), (h, hulls, ways, hold)
    if usual is None or effect <= allowed or (sampled := _sampled(*moving)) is None:
        return usual
    counts = np.maximum(importance(best, h), importance_beside(best, h))
    several = h.moved(ways).sum() > SEVERAL
    for pairs, times in product([0] if several else _numbers(usual, sampled), TIMES[:2] if several else TIMES):
        poles = _poles(*moving, pairs) if pairs else usual.beta
        fit = _weighed(*moving, Bits(poles), Bits(times * counts))
        if fit is None:  # `memory_effect` says what is left
            continue
        fitted = prepare(scene, h, fit)
        less = _swayed(fitted, h)
        if less < effect and _has_mass(fitted, fit):
            best, effect = fitted, less
        if effect <= allowed:
            break
    return best.fit


def _numbers(usual: RadiationMemory, sampled: Samples) -> list[int]:
    """Of pairs of poles, one after another; 0 for those of the usual fit.

    Where it ended too far away with as many as there may be, a few more than it has come no nearer.
    """
    shares = MORE if usual.error <= HOPELESS * USUAL else ()
    more = [min(int(np.ceil(share * usual.beta.size)), sampled.most) for share in shares]
    return sorted({0, *more})


@lru_cache(maxsize=KNOWN)
def _sampled(h: Hydrodynamics, hulls: tuple[Hull, ...], ways: Ways, hold: float) -> Samples | None:
    """What memories of these coefficients are fitted to."""
    known = h.omega, h.added_mass, h.radiation_damping, h.added_mass_inf
    return samples(*known, motion_lengths(hulls, h.dofs), h.body, h.moved(ways), h.resolved, hold, h.certain)


@lru_cache(maxsize=KNOWN)
def _poles(h: Hydrodynamics, hulls: tuple[Hull, ...], ways: Ways, hold: float, pairs: int) -> np.ndarray:
    """So many pairs, as the usual fit seeks them: whatever the sea."""
    sampled = _sampled(h, hulls, ways, hold)
    assert sampled is not None, "asked where something radiates"
    return shared(sampled.unconstrained(pairs, USUAL).poles)


@lru_cache(maxsize=KNOWN)
def _weighed(
    h: Hydrodynamics,
    hulls: tuple[Hull, ...],
    ways: Ways,
    hold: float,
    poles: Bits[np.ndarray],
    counts: Bits[np.ndarray],
) -> RadiationMemory | None:
    """The memory with these poles, by what misfits count."""
    sampled = _sampled(h, hulls, ways, hold)
    assert sampled is not None, "asked where something radiates"
    return sampled.counting(counts.value).with_poles(poles.value)


def _swayed(system: System, h: Hydrodynamics) -> float:
    """What the fit changes of the motions at the frequencies solved, over the largest of each, and of their means."""
    inside, exact = _motions(system, h, impedance(system, h, h.omega))
    assert system.fit is not None, "asked of a scene that has one"
    change = np.abs(_motions(system, h, system.fit.frequency(h.omega))[1] - exact)[inside].max(axis=0)
    used, largest = _used(system, exact[inside])
    if not used.any():
        return 0.0
    moved = float(np.max(change[used] / largest[used]))
    return max(memory_effect(system, h), bounced(system, h, system.fit.frequency), moved)


def _motions(system: System, h: Hydrodynamics, Y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of the frequencies solved (nw,) the scene's waves have, and X (nw, n) in waves of one height at all of
    them; in still water what follows from the offsets.
    """
    model, omega, sea = moving_model(system, h), h.omega, system.scene.sea
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
    model, omega, Y = moving_model(system, h), h.omega, impedance(system, h, h.omega)
    inside, X = _motions(system, h, Y)
    size, (used, largest) = np.abs(X), _used(system, X[inside])
    receptance = np.linalg.solve(
        model.dynamic_stiffness(omega, Y), np.broadcast_to(model.active.T, (omega.size, *model.active.T.shape))
    )
    change = np.abs(receptance[:, used]) / np.maximum(size, LEAST * largest)[:, used, None]
    moved = np.abs(X @ model.active.T)
    return np.asarray((inside * omega)[:, None, None] * change.max(axis=1)[:, :, None] * moved[:, None, :])
