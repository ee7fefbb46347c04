"""What errors of coefficients, and shapes that are left out, do to the response of the scene's linear model."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np

from solver.coupled.driving import driven
from solver.coupled.histories import unswung
from solver.coupled.linear import LinearModel, impedance, linear_model
from solver.coupled.moving import excitation, force_of_waves, moving_model
from solver.coupled.support import KNOWN, Support
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.keys import shared
from solver.lines import lengths, real_by_complex, real_parts
from solver.multibody.joint_law import JointLaw
from solver.record import beside, decay
from solver.record.channels import Channels
from solver.record.response import absorbs, drag_damping, in_waves
from solver.record.sampling import least_force, least_motion
from solver.statistics import FAINT

UNSURE = 0.4  # of what the error of forces alone would do, that may be left where others cancel it


def together(errors: Iterable[float]) -> float:
    """Error to expect of independent ones: the root of the sum of their squares."""
    return float(np.sqrt(sum(error**2 for error in errors)))


def coefficient_effects(
    system: System, h: Hydrodynamics | None, transfer: decay.Transfer | None = None
) -> tuple[float, float]:
    """What the memory's misfit and the boundary elements' mesh do to the linear response's std and mean power.

    And to the joints' forces. In this sea, or let go from the scene's offsets: with the fit's B - iω(A - A∞) in place
    of the coefficients'; and with coefficients off by their estimated error, see `cancelled`. The memory's counts what
    its misfit does beside the waves, too, see `beside`. transfer: Y of a memory that is not the system's fit, about the
    same added mass.
    """
    return (0.0, 0.0) if h is None else (memory_effect(system, h, transfer=transfer), _mesh_effect(system, h))


def memory_effect(
    system: System, h: Hydrodynamics, shares: np.ndarray | float = 1.0, transfer: decay.Transfer | None = None
) -> float:
    """The first of `coefficient_effects`; shares (m,): of an output's variance, the shapes' beside the waves."""
    if transfer is None:
        if system.fit is None:
            return 0.0
        transfer = system.fit.frequency
    if not system.scene.sea.amplitude.any():
        return decay.by_memory(system, h, transfer)
    misfit = _exact(system, h).change(h, transfer(system.scene.sea.omega))
    return max(misfit, float(np.max(shares * beside.effects(system, h, transfer), initial=0.0)))


def _mesh_effect(system: System, h: Hydrodynamics) -> float:
    if not system.scene.sea.amplitude.any():
        return decay.by_mesh(system, h)
    exact, omega = _exact(system, h), system.scene.sea.omega
    net = exact.change(h.shifted, impedance(system, h.shifted, omega))
    off = unlike(exact.force.T, force_of_waves(system, h.shifted).T)
    return cancelled(net, off, *(partial(exact.change, by, exact.impedance) for by in (h.shifted, h.forced)))


@dataclass(frozen=True, eq=False)
class _Exact:
    """The linear response to the scene's waves by its coefficients, and by others."""

    system: System
    model: LinearModel
    impedance: np.ndarray  # (nw, na, na)
    force: np.ndarray  # of the waves, (nw, n)
    motions: np.ndarray  # (nw, n)
    borne: np.ndarray  # by the joints, (nw, nb, 3)

    @classmethod
    def of(cls, system: System, model: LinearModel, h: Hydrodynamics, Y: np.ndarray) -> "_Exact":
        """By coefficients whose impedance is Y."""
        omega, amplitude = system.scene.sea.omega, system.scene.sea.amplitude
        force = force_of_waves(system, h)
        X = model.response(omega, Y, force)
        pushed = excitation(system, h, omega) * amplitude[:, None]
        return cls(system, model, Y, force, X, joint_forces(system, omega, X, Y, pushed))

    def change(self, known: Hydrodynamics, Y: np.ndarray) -> float:
        """By the forces of these coefficients, and another impedance."""
        other, omega = self.of(self.system, self.model, known, Y), self.system.scene.sea.omega
        motions = response_error(self.system, self.system.bodies.law, omega, other.motions, self.motions)
        return max(motions, force_error(self.system, other.borne, self.borne))


@lru_cache(maxsize=1)
def _exact(system: System, h: Hydrodynamics) -> _Exact:
    return _Exact.of(system, moving_model(system, h), h, impedance(system, h, system.scene.sea.omega))


def motions(system: System, h: Hydrodynamics) -> np.ndarray:
    """Lines (nw, nz) of the floats' coordinates in the linear response to the scene's waves."""
    exact = _exact(system, h)
    return np.asarray(exact.motions @ exact.model.shape.T)


def cancelled(effect: float, unlike_forces: float, pushed: Callable[[], float], apart: Callable[[], float]) -> float:
    """What a mesh does, of its net effect, how much forces are off, what those alone do, and what of that is not the
    radiation's error as well: see `Hydrodynamics.forced`.

    Errors of forces and of added mass may cancel each other in a response, and each is known within a factor alone; but
    where they are one, they cancel by more than chance. Power goes by the square of forces: what could do no more is
    not asked for.
    """
    if effect >= UNSURE * 2 * unlike_forces or (left := UNSURE * pushed()) <= effect:
        return effect
    return min(left, together([effect, apart()]))


def unlike(force: np.ndarray, other: np.ndarray) -> float:
    """By how much forces (n, nw) differ, of that on the coordinate where it is most."""
    size, off = (np.linalg.norm(x, axis=1) for x in (force, other - force))
    return float(np.divide(off, size, out=np.zeros(size.shape), where=size > 0).max(initial=0.0))


def joint_forces(system: System, omega: np.ndarray, X: np.ndarray, Y: np.ndarray, pushed: np.ndarray) -> np.ndarray:
    """Of response X (nw, n), radiation impedance Y and the waves' force (nw, na): (nw, nb, 3) [N]."""
    model = linear_model(system)
    return Channels(system.scene, None).hinge_force(model.loads(omega, X, Y, model.pushed(pushed)))


def force_error(system: System, forces: np.ndarray, exact: np.ndarray) -> float:
    """Largest relative change of the std of a joint's force (nw, nb, 3), but for those that count as zero beside the
    joint's others: a small float bears little beside a large one.
    """
    std, true = (lengths(F.reshape(len(F), -1).T).reshape(F.shape[1:]) for F in (forces, exact))
    least = np.maximum(np.sqrt(2) * least_force(system.scene), FAINT * true.max(axis=1, keepdims=True))
    return float(np.max(np.abs(std - true) / np.maximum(true, least), initial=0.0))


def step_effect(system: System, h: Hydrodynamics | None) -> float:
    """What the step changes of the linear response's std and mean power: a shape that is damped by little resonates at
    the period that steps give it, and a run's start, shorter than 1/ζω, does not know by how much.

    Steps of h take what swings on by exp(-iωh) that by itself has ω' with R(-iω'h) = exp(-iωh), R(x) =
    (1 + x/2 + x²/12)/(1 - x/2 + x²/12) of the scheme: tan ½ωh = ½ω'h/(1 - (ω'h)²/12), ω' = ω (1 + (ωh)⁴/720) nearly.
    Besides, forces of frequency ω count as (ωh)⁴/576 larger at a step's end, and by (ωh)⁴/384 less than that in its
    middle. What swings up until the end T of a record does so as if ω were ω + i/T.
    """
    s, sea = system.scene.settings, system.scene.sea
    met = np.abs(sea.amplitude) > 0
    if not met.any():
        return 0.0
    omega, model = sea.omega[met], moving_model(system, h)
    modes = model.modes + [[0.0], [1.0], [0.0]] * np.diag(drag_damping(system))
    model, Y, force = replace(model, modes=modes), impedance(system, h, omega), force_of_waves(system, h)[met]
    turn = np.tan(omega * system.dt / 2)
    seen = 4 * turn / (1 + np.sqrt(1 + 4 * turn**2 / 3)) / system.dt
    exact, X = (model.response(w + 1j / (s.discard + s.duration), Y, force) for w in (omega, seen))
    X *= 1 + (omega[:, None] * system.dt) ** 4 / 2304
    return response_error(system, system.bodies.law, omega, X, exact, seen)


def shapes_effect(system: System, h: Hydrodynamics | None) -> float:
    """What the shapes left out of a frame's motion change of the std and mean of its legs' tops in the linear response.

    In this sea, with drag linearised by the water's own velocity; and of what load histories move, if that is more.
    """
    support, sea = system.support, system.scene.sea
    if support is None:
        return 0.0
    by_histories = unswung(system)
    if not sea.amplitude.any():
        return by_histories
    X, drag, mean = in_waves(system, h)
    waves = np.abs(sea.amplitude) > 0
    return max(by_histories, left_out_effect(system, X[waves], drag[waves] @ support.left_out.drag, mean))


def left_out_effect(system: System, X: np.ndarray, drag: np.ndarray, mean: np.ndarray) -> float:
    """The same of the response X (nw, n) to the waves that are not of zero height, of drag on the rest (nw, nt), and of
    the mean drag (nd ns,).

    Static shapes hold that of the current alone: waves beside it change its profile over the depth.
    """
    support, sea = system.support, system.scene.sea
    if support is None or not support.left_out.tops.size:
        return 0.0
    waves = np.abs(sea.amplitude) > 0
    of_waves, p = driven(support, system.waves).left_out[:, waves], X.T[: len(support.omega)]
    usual, inertia = real_by_complex(_tops_and_inertia(support), p).reshape(2, -1, p.shape[1])
    exact = usual + of_waves + drag.T + sea.omega[waves] ** 2 * inertia
    std, true = lengths(usual), lengths(exact)
    used = std > FAINT * std.max()
    off = float(np.abs(true[used] / std[used] - 1).max(initial=0.0))
    mean_top = support.shapes[support.left_out.tops] @ system.equilibrium[1]
    rms = np.hypot(mean_top, std / np.sqrt(2))
    shift = np.abs(mean @ support.left_out.drag)
    used = rms > FAINT * rms.max()
    return max(off, float((shift[used] / rms[used]).max(initial=0.0)))


@lru_cache(maxsize=KNOWN)
def _tops_and_inertia(support: Support) -> np.ndarray:
    """(2 nt, nm) of the modes' amplitudes: their motion of the legs' tops, and what their inertia leaves out of it."""
    rest = support.left_out
    return shared(np.concatenate([support.shapes[rest.tops], rest.inertia.T]))


def response_error(
    system: System,
    law: JointLaw,
    omega: np.ndarray,
    X: np.ndarray,
    exact: np.ndarray,
    seen: np.ndarray | None = None,
) -> float:
    """Largest relative change of a coordinate's std, or of its rate's square where that is power absorbed by a law.

    seen (nw,): the frequencies of X, if others.
    """
    size, true_size = lengths(X.T), lengths(exact.T)
    largest = linear_model(system).length * true_size
    used = largest > max(FAINT * largest.max(initial=0.0), least_motion(system.scene))
    takes, each = used & absorbs(system, law), ((X, omega if seen is None else seen), (exact, omega))
    rate, true_rate = (real_parts(x.T)[takes] ** 2 @ np.repeat(w**2, 2) for x, w in each)
    changes = np.concatenate([size[used] / true_size[used], rate / true_rate])
    return float(np.abs(changes - 1).max(initial=0.0))
