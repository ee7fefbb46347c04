"""What the memory's misfit does to motions that resonate below the waves, where what is not linear drives them.

No linear wave moves them, but body-nonlinear pressure, drag and bent laws do, at differences of frequencies. A drive
whose spectrum S is flat across the resonance of a shape φ of unit inertia leaves x = φy a variance of

    ⟨y²⟩ = πS/(BC),   B = φᵀ(D + Eᵀ Re Y E)φ,   C = φᵀCφ.

With a + ib = φᵀEᵀ δY Eφ/B of a misfit δY its std changes by -a/2. The shift of the resonance by b leaves it on average
alone; but in a record of duration T waves' differences are lines 2π/T apart, of random size, on whose sum
w(u) = 1/(1 + u²), u the distance from the resonance over B/2, changes by 2bu w² du: the std, by b/2 (2/(TB))^½ (rms).
"""

from typing import NamedTuple

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import LinearModel, impedance
from solver.coupled.natural import system_modes
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody import of_axes
from solver.record.decay import extended
from solver.record.response import drag_damping, force_of_waves, moving_model

LIGHTLY = 0.3  # of critical: what is damped by more has no resonance


class Slow(NamedTuple):
    """m shapes of the system that swing below the waves."""

    omega: np.ndarray  # (m,) [rad/s]
    moved: np.ndarray  # (m, na) what of each radiates, Eφ
    damping: np.ndarray  # (m,) B


def slow(system: System, h: Hydrodynamics) -> Slow:
    """The shapes that are damped lightly and that something drives there: none of a single wave, or in still water."""
    omega, model, none = system.scene.sea.omega[system.scene.sea.amplitude != 0], moving_model(system, h), np.zeros(0)
    if omega.size < 2 or not _driven(system):
        return Slow(none, np.zeros((0, len(model.active))), none)
    modes = system_modes(system, h)
    below = modes.omega < omega.min()
    own, shapes = modes.omega[below], modes.shapes[:, below].T
    moved = shapes @ model.active.T
    radiated = _of(extended(system, h, own).real, moved)
    damping = np.einsum("mi,ij,mj->m", shapes, _damping(system, h, model), shapes) + radiated
    lightly = (damping > 0) & (damping < 2 * LIGHTLY * own)
    return Slow(own[lightly], moved[lightly], damping[lightly])


def slow_effect(system: System, h: Hydrodynamics) -> float:
    """The largest relative change of such a shape's std by the memory's misfit, ½ (a² + b² min(1, 2/(TB)))^½."""
    shapes = slow(system, h)
    if system.fit is None or not shapes.omega.size:
        return 0.0
    misfit = system.fit.frequency(shapes.omega) - extended(system, h, shapes.omega)
    off = _of(misfit, shapes.moved) / shapes.damping
    few = np.minimum(1.0, 2 / (system.scene.settings.duration * shapes.damping))
    return float(np.max(np.sqrt(off.real**2 + off.imag**2 * few))) / 2


def slow_importance(system: System, h: Hydrodynamics) -> np.ndarray:
    """½ |Eφ|_i |Eφ|_j / B (nw, na, na), the largest of all shapes, at the frequencies solved to either side of each."""
    shapes = slow(system, h)
    counts = np.zeros((h.omega.size, *h.added_mass_inf.shape))
    for own, moved, damping in zip(*shapes, strict=True):
        after = int(np.searchsorted(h.omega, own))
        beside = counts[max(after - 1, 0) : after + 1]
        np.maximum(beside, np.abs(np.outer(moved, moved)) / (2 * damping), out=beside)
    return counts


def _of(Y: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """φᵀEᵀ Y Eφ (m,) of Y (m, na, na)."""
    return np.asarray(np.einsum("mi,mij,mj->m", moved, Y, moved))


def _driven(system: System) -> bool:
    """Whether something has forces at differences of the waves' frequencies."""
    law = system.bodies.law
    joints = of_axes.bent(law).any() or of_axes.drag(law).any() or any(f.lines for f in system.scene.floats)
    return bool(joints or system.bodies.nonlinear.any() or system.structure.drag.any())


def _damping(system: System, h: Hydrodynamics, model: LinearModel) -> np.ndarray:
    """D (n, n) with the drag of the frame and of the joints, linearised by rates in the waves.

    What resonates below them follows them by its inertia: its drag hardly changes those.
    """
    nc, nm = system.structure.carrier.shape
    damping, quadratic = model.damping.copy(), of_axes.drag(system.bodies.law)[nc:]
    damping[:nm, :nm] += drag_damping(system)
    if quadratic.any():
        omega = system.scene.sea.omega
        rates = omega[:, None] * model.response(omega, impedance(system, h, omega), force_of_waves(system, h))[:, nm:]
        joints = np.arange(nm, len(damping))
        damping[joints, joints] += quadratic * linear_drag.of_lines(rates[:, None])[:, 0, 0]
    return damping
