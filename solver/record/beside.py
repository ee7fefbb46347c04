"""What the memory's misfit does to motions that resonate beside the waves, where what is not linear drives them.

No linear wave moves them, but body-nonlinear pressure, drag and bent laws do: below the waves at differences of their
frequencies, above them at sums. With
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

LIGHTLY = 0.3  # of critical: what is damped by more has no resonance
INSTANTS = 500  # of a record, over which is summed


class Shapes(NamedTuple):
    """m shapes of the system, of unit inertia."""

    omega: np.ndarray  # (m,) [rad/s]
    shapes: np.ndarray  # φ (m, n)
    moved: np.ndarray  # (m, na) what of each radiates, Eφ
    radiated: np.ndarray  # (m,) of B
    damping: np.ndarray  # (m,) B, zero where it is not asked for


def beside(system: System, h: Hydrodynamics) -> Shapes:
    """Those beside the waves that are damped lightly and that something drives there: none of a single wave, or in
    still water; nor above the frequencies solved for, where boundary elements say nothing."""
    omega, (slowest, fastest) = system_modes(system, h).omega, waves(system)
    above = (omega > fastest) & (omega <= h.omega[-1])
    of = _shapes(system, h, ((omega > 0) & (omega < slowest) | above) & _driven(system))
    # What resonates below the waves follows them by its inertia, what does above hardly moves: its drag hardly changes
    # its rates in the water, by which it is.
    damping = (unradiated(system, h, of.shapes) if of.omega.size else 0.0) + of.radiated
    lightly = (damping > 0) & (damping < 2 * LIGHTLY * of.omega)
    return Shapes(*(x[lightly] for x in of._replace(damping=damping)))


def below(system: System, h: Hydrodynamics | None) -> Shapes:
    """Those whose natural frequency is below all waves, of several; none of a single wave, or in still water."""
    omega = system_modes(system, h).omega
    return _shapes(system, h, (omega > 0) & (omega < waves(system)[0]))


def waves(system: System) -> tuple[float, float]:
    """Of the waves' frequencies, of several; all of a single wave, or in still water."""
    omega = system.scene.sea.omega[system.scene.sea.amplitude != 0]
    return (omega.min(), omega.max()) if omega.size > 1 else (0.0, np.inf)


def _shapes(system: System, h: Hydrodynamics | None, some: np.ndarray) -> Shapes:
    modes = system_modes(system, h)
    own, shapes = modes.omega[some], modes.shapes[:, some].T
    moved, radiated = radiating(system, h, own, shapes)
    return Shapes(own, shapes, moved, radiated, np.zeros(own.size))


def radiating(
    system: System, h: Hydrodynamics | None, own: np.ndarray, shapes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
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


def effects(system: System, h: Hydrodynamics, transfer: Transfer) -> np.ndarray:
    """Relative change of each such shape's std (m,) by the misfit of a memory's Y."""
    shapes = beside(system, h)
    if not shapes.omega.size:
        return np.zeros(0)
    misfit = _of(transfer(shapes.omega) - impedance_anywhere(system, h, shapes.omega), shapes.moved)
    damped, shifted = _in_record(system, shapes)
    return np.hypot(damped * misfit.real, shifted * misfit.imag)


class Bounces(NamedTuple):
    """Of axes on their end stops, of all that may be bent (nb,)."""

    at: np.ndarray  # (nb,) frequency at which they swing there [rad/s], the last one solved for at most
    moved: np.ndarray  # (nb, na) what of that radiates
    felt: np.ndarray  # (nb,) change of the rate that a bounce leaves, by δY of what moves [s/kg, ...]


def bounces(system: System, h: Hydrodynamics) -> Bounces:
    """On a stop of stiffness k an axis of inertia m swings half a period of ω = √(k/m), as a rule above the waves, and
    leaves it with exp(-πB/2mω) of its rate; δY changes that by π|φᵀEᵀ δY Eφ|/2mω of it, φ what moves with the axis
    where that is pushed. Above the frequencies solved for the misfit counts as at the last.
    """
    law, model, (nc, nm) = system.bodies.law, linear_model(system), system.structure.carrier.shape
    axes = np.flatnonzero(of_axes.bent(law))
    stiffness, damping = of_axes.stop_stiffness(law)[axes], of_axes.stop_damping(law)[axes]
    pushed = np.linalg.inv(model.mass)[nm - nc + axes]
    mass = 1 / pushed[range(axes.size), nm - nc + axes]
    shapes, own = mass[:, None] * pushed, np.sqrt(stiffness / mass)
    at = own.clip(h.omega[0], h.omega[-1])
    moved, radiated = radiating(system, h, at, shapes)
    damping = damping + radiated + np.einsum("mi,ij,mj->m", shapes, model.damping, shapes)
    quarter = np.divide(np.pi / 2, mass * own, out=np.zeros(axes.size), where=own > 0)
    return Bounces(at, moved, quarter * np.exp(-quarter * damping))


def bounced(system: System, h: Hydrodynamics, transfer: Transfer, share: np.ndarray | float = 1.0) -> float:
    """Relative change of motions between end stops by that of bounces, which are felt in shares (nb,) of the time."""
    if not of_axes.stopped(system.bodies.law).any():
        return 0.0
    of = bounces(system, h)
    misfit = np.abs(_of(transfer(of.at) - impedance_anywhere(system, h, of.at), of.moved))
    return float(np.max(share * of.felt * misfit, initial=0.0))


def importance_beside(system: System, h: Hydrodynamics) -> np.ndarray:
    """|Eφ|_i |Eφ|_j |V'/2V| (nw, na, na), the largest of all shapes and of `bounces`, at the frequencies solved to
    either side of each: nothing that shifts a resonance counts more than what damps it."""
    shapes, struck = beside(system, h), bounces(system, h)
    counts = np.zeros((h.omega.size, *h.added_mass_inf.shape))
    for own, moved, damped in (
        *zip(shapes.omega, shapes.moved, _in_record(system, shapes)[0], strict=True),
        *zip(*struck, strict=True),
    ):
        after = int(np.searchsorted(h.omega, own))
        near = counts[max(after - 1, 0) : after + 1]
        np.maximum(near, damped * np.abs(np.outer(moved, moved)), out=near)
    return counts


def _in_record(system: System, shapes: Shapes) -> tuple[np.ndarray, np.ndarray]:
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
    """Whether something has forces at differences and sums of the waves' frequencies."""
    law = system.bodies.law
    joints = of_axes.bent(law).any() or of_axes.drag(law).any() or any(f.lines for f in system.scene.floats)
    return bool(joints or system.bodies.nonlinear.any() or system.structure.drag.any())
