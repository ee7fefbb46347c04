"""What the memory's misfit does to motions that resonate below the waves, where what is not linear drives them.

No linear wave moves them, but body-nonlinear pressure, drag and bent laws do, at differences of frequencies. With
B = φᵀ(D + Eᵀ Re Y E)φ a shape φ of unit inertia that rests at t = 0 is swung by a drive f that is flat across its
resonance with the envelope and, over a record, on average the square

    y(t) = ∫₀ᵗ exp(-½B(t - s)) f(s) ds,    V = ∫⟨|y|²⟩dt = ∫ (1 - exp(-Bt))/B dt.

Of a misfit δY the real part of m = φᵀEᵀ δY Eφ adds to B and changes the std by Re m V'/2V: by -Re m/2B in a long
record, by -Re m T/6 in one of duration T << 1/B, where damping does not bound the resonance. The imaginary part shifts
that by δ = ½ Im m, which leaves V on average alone; but f and so V are random, and δ ∂V/∂δ has the variance

    ⟨(δ ∂V/∂δ)²⟩ = δ² ∫∫ (s - s')² E² ds ds',    E(s, s') = ∫ exp(-Bt + ½B(s + s')) dt over what of the record is later,

which changes the std by ½ Im m (TB)^-½/B, and by Im m T/360^½ (rms).
"""

from typing import NamedTuple

import numpy as np
from scipy.special import gammainc

from solver.coupled.linear import impedance_anywhere, linear_model
from solver.coupled.moving import moving_model
from solver.coupled.natural import system_modes
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody import of_axes
from solver.record.decay import Transfer
from solver.record.response import drag_damping
from solver.record.spectra import all_lines
from solver.statistics import FAINT

LIGHTLY = 0.3  # of critical: what is damped by more has no resonance
INSTANTS = 500  # of a record, over which is summed


class Below(NamedTuple):
    """m shapes of the system whose natural frequency is below all waves, of several."""

    omega: np.ndarray  # (m,) [rad/s]
    shapes: np.ndarray  # φ (m, n)
    moved: np.ndarray  # (m, na) what of each radiates, Eφ
    radiated: np.ndarray  # (m,) of B


class Slow(NamedTuple):
    """m shapes of the system that swing below the waves."""

    omega: np.ndarray  # (m,) [rad/s]
    moved: np.ndarray  # (m, na) what of each radiates, Eφ
    damping: np.ndarray  # (m,) B


def slow(system: System, h: Hydrodynamics) -> Slow:
    """The shapes that are damped lightly and that something drives there: none of a single wave, or in still water."""
    none = np.zeros(0)
    if not _driven(system):
        return Slow(none, np.zeros((0, len(linear_model(system).active))), none)
    own, shapes, moved, radiated = below(system, h)
    # What resonates below the waves follows them by its inertia: its drag hardly changes their rates, by which it is.
    damping = unradiated(system, h, shapes) + radiated
    lightly = (damping > 0) & (damping < 2 * LIGHTLY * own)
    return Slow(own[lightly], moved[lightly], damping[lightly])


def below(system: System, h: Hydrodynamics | None) -> Below:
    """Those shapes; none of a single wave, or in still water."""
    omega, modes = system.scene.sea.omega[system.scene.sea.amplitude != 0], system_modes(system, h)
    least = omega.min() if omega.size > 1 else 0.0
    some = (modes.omega > 0) & (modes.omega < least)
    own, shapes = modes.omega[some], modes.shapes[:, some].T
    return Below(own, shapes, *radiating(system, h, own, shapes))


def radiating(system: System, h: Hydrodynamics | None, own: np.ndarray, shapes: np.ndarray) -> tuple[np.ndarray, ...]:
    """Of shapes φ (m, n) at their frequencies (m,): what of each radiates, Eφ (m, na), and by that its part of B."""
    moved = shapes @ linear_model(system).active.T
    if h is None or not own.size:
        return moved, np.zeros(own.size)
    return moved, _of(impedance_anywhere(system, h, own).real, moved)


def unradiated(system: System, h: Hydrodynamics | None, shapes: np.ndarray) -> np.ndarray:
    """The rest of B (m,), dampers and drag, of shapes (m, n)."""
    model, nm = moving_model(system, h), system.structure.omega.size
    D = model.damping.copy()
    D[:nm, :nm] += drag_damping(system)
    return np.asarray(np.einsum("mi,ij,mj->m", shapes, D, shapes))


def slow_effect(system: System, h: Hydrodynamics, transfer: Transfer) -> float:
    """The largest relative change of such a shape's std by the misfit of a memory's Y."""
    shapes = slow(system, h)
    if not shapes.omega.size:
        return 0.0
    misfit = _of(transfer(shapes.omega) - impedance_anywhere(system, h, shapes.omega), shapes.moved)
    damped, shifted = _in_record(system, shapes)
    return float(np.max(np.hypot(damped * misfit.real, shifted * misfit.imag)))


class SlowShare:
    """How much of a record's motions is slower than its waves."""

    def __init__(self, system: System, h: Hydrodynamics | None):
        """Nothing is taken in where the memory knows of no such motion, and nothing told: 1."""
        s, sea = system.scene.settings, system.scene.sea
        self.inside, self.step = (s.discard, s.discard + s.duration), system.dt / 2
        self.modes, self.length = system.structure.omega.size, linear_model(system).length
        own = slow(system, h).omega if h is not None and system.fit is not None else np.zeros(0)
        self.least = sea.omega[sea.amplitude != 0].min() if own.size else 0.0
        self.motions: list[np.ndarray] = []

    def add(self, times: np.ndarray, p: np.ndarray, z: np.ndarray) -> None:
        """Take in a block of modes p (m, nm) and of carriers and joints z (m, nz)."""
        if self.least > 0:
            kept, joints = (times > self.inside[0]) & (times <= self.inside[1]), len(self.length) - self.modes
            self.motions.append(np.concatenate([p[:, : self.modes], z[:, z.shape[1] - joints :]], axis=1)[kept])

    @property
    def value(self) -> float:
        """Of the variance of the coordinate in which it is most."""
        if not self.motions:
            return 1.0
        omega, lines = all_lines(np.concatenate(self.motions), self.step)
        power = np.abs(lines) ** 2
        whole, part = power.sum(axis=0), power[omega < self.least].sum(axis=0)
        used = self.length**2 * whole > FAINT**2 * np.max(self.length**2 * whole)
        return float(np.max(part[used] / whole[used], initial=0.0))


def slow_importance(system: System, h: Hydrodynamics) -> np.ndarray:
    """|Eφ|_i |Eφ|_j |V'/2V| (nw, na, na), the largest of all shapes, at the frequencies solved to either side of each:
    nothing that shifts a resonance counts more than what damps it."""
    shapes = slow(system, h)
    counts = np.zeros((h.omega.size, *h.added_mass_inf.shape))
    for own, moved, damped in zip(shapes.omega, shapes.moved, _in_record(system, shapes)[0], strict=True):
        after = int(np.searchsorted(h.omega, own))
        beside = counts[max(after - 1, 0) : after + 1]
        np.maximum(beside, damped * np.abs(np.outer(moved, moved)), out=beside)
    return counts


def _in_record(system: System, shapes: Slow) -> tuple[np.ndarray, np.ndarray]:
    s = system.scene.settings
    return changes(shapes.damping, s.discard, s.discard + s.duration)


def changes(damping: np.ndarray, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Relative changes of the std of shapes damped by B (m,) for a small real and imaginary part of m [s]: -V'/2V and
    ¼ (∫∫ (s - s')² E²)^½/V of a record from `start` to `end`."""
    B, share = damping[:, None], (np.arange(INSTANTS) + 0.5) / INSTANTS
    told, every = start + (end - start) * share, end * share
    V, slope = (np.mean(gammainc(n, B * told) / B**n, axis=1) * (end - start) for n in (1, 2))
    later = np.maximum(every, start)
    E = -np.exp(-B * (later - every)) * np.expm1(-B * (end - later)) / B  # of s' = s, and falls by exp(-½B(s - s'))
    square = 2 * end * np.mean(E**2 * 2 * gammainc(3, B * every) / B**3, axis=1)
    return slope / (2 * V), np.sqrt(square) / (4 * V)


def _of(Y: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """φᵀEᵀ Y Eφ (m,) of Y (m, na, na)."""
    return np.asarray(np.einsum("mi,mij,mj->m", moved, Y, moved))


def _driven(system: System) -> bool:
    """Whether something has forces at differences of the waves' frequencies."""
    law = system.bodies.law
    joints = of_axes.bent(law).any() or of_axes.drag(law).any() or any(f.lines for f in system.scene.floats)
    return bool(joints or system.bodies.nonlinear.any() or system.structure.drag.any())
