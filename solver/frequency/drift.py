"""Mean drift of all bodies together, from the waves far off; mean offset and slow drift of a moored support.

The mean force is of second order, its sum over the waves of a sea, Fᵢ of wave i. About the mean it varies slowly, by
Newman's approximation (1974) with the spectrum 8 ∫ S(ω)S(ω + μ) T(ω)T(ω + μ) dω, F = T|a|². As the support answers
near its own slow period alone, that is taken at μ = 0, as white noise (Pinkster 1980).
"""

from typing import Any

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from solver.coupled.linear import LinearModel, linear_model
from solver.coupled.system import System
from solver.errors import InputError
from solver.frequency.response import Response
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.bem.far_field import Waves
from solver.record.recorder import Channels, Labelled
from solver.record.spectra import bands
from solver.scene import Scene

HORIZONTAL = ("surge", "sway", "yaw")  # axes that the far field's force and moment act along


def waves_of(system: System, response: Response, h: Hydrodynamics) -> Waves:
    """Far off, of the scene's response to its sea."""
    amplitude = system.scene.sea.amplitude
    return h.waves(response.omega, amplitude[np.abs(amplitude) > 0], _velocity(system, response))


def _velocity(system: System, response: Response) -> np.ndarray:
    """Of all that radiates (nw, na)."""
    return -1j * response.omega[:, None] * (response.X @ linear_model(system).active.T)


def energy_residual(system: System, response: Response, h: Hydrodynamics, waves: Waves) -> float:
    """Power that the far field says is absorbed, less what pressure does on the bodies, over what is sent out."""
    V, a = _velocity(system, response), system.scene.sea.amplitude
    a = a[np.abs(a) > 0, None]
    force = h.excitation(response.omega) * a - (h.impedance(response.omega) @ V[..., None])[..., 0]
    work = 0.5 * np.sum(force * V.conj(), axis=1).real
    return float(abs(np.sum(waves.absorbed_power - work)) / np.sum(waves.outgoing_power))


def variables(
    system: System, response: Response, h: Hydrodynamics, channels: Channels
) -> tuple[dict[str, Labelled], dict[str, Any]]:
    """Variables of the record, and figures: force, moment and, of a moored support, offset and slow drift."""
    scene, waves = system.scene, waves_of(system, response, h)
    force = np.concatenate([waves.drift_force, np.full((len(waves.omega), 1), np.nan)], axis=1)
    point, carried = _point(scene), waves.drift_moment
    assert h.far_field is not None, "asked of coefficients that have one"
    x, y = np.subtract(point[:2], h.far_field.origin)
    moment = carried - x * force[:, 1] + y * force[:, 0]
    found: dict[str, Labelled] = {"drift_force": (("direction",), force.sum(axis=0))}
    if scene.settings.rao:
        squares = np.full(scene.sea.omega.shape, np.nan)
        met = np.abs(scene.sea.amplitude) > 0
        squares[met] = np.abs(scene.sea.amplitude[met]) ** 2
        per_wave = np.full((scene.sea.omega.size, 3), np.nan)
        per_wave[met] = force / squares[met, None]
        found["drift_force_per_wave"] = ("direction", "component"), per_wave.T
    figures: dict[str, Any] = {
        "drift_moment": float(moment.sum()),
        "energy_residual": energy_residual(system, response, h, waves),
    }
    axes = _axes(scene, channels)
    if axes.size:
        loads = np.stack([force[:, 0], force[:, 1], moment], axis=1)
        each = loads[:, [HORIZONTAL.index(channels.names[i]) for i in axes]]
        means, stds, unmet = moved(linear_model(system), axes, added_mass(system, h), each, noise(scene, waves))
        for name, values in (("drift_offset", means), ("slow_drift", stds)):
            joints = np.full((1, channels.owner.size), np.nan)
            joints[0, axes] = values
            found[name] = ("float", "axis"), channels.by_axis(joints)[0]
        figures["unmet"] = unmet
    return found, figures


def _support(scene: Scene) -> int:
    """Number of the float that carries all others; -1 where none does."""
    alone = [b for b, carrier in enumerate(scene.carriers) if carrier < 0]
    return alone[0] if len(alone) == 1 and scene.platform is None else -1


def _point(scene: Scene) -> np.ndarray:
    """That the moment is about: where the support's motions are told, or the origin."""
    b = _support(scene)
    return np.array(scene.floats[b].hinge) if b >= 0 else np.zeros(3)


def _axes(scene: Scene, channels: Channels) -> np.ndarray:
    """The joint axes along which the far field's loads move the support."""
    b = _support(scene)
    return np.array([i for i, name in enumerate(channels.names) if channels.owner[i] == b and name in HORIZONTAL], int)


def added_mass(system: System, h: Hydrodynamics) -> np.ndarray:
    """A - A∞ (n, n) of the linear model's coordinates, at the lowest frequency that is known."""
    E = linear_model(system).active
    return E.T @ (h.added_mass[0] - system.bodies.added_mass) @ E


def noise(scene: Scene, waves: Waves) -> np.ndarray:
    """g (nw, nw) of S_F(0) = 2 Σᵢⱼ Fᵢ gᵢⱼ Fⱼ: which waves are so near each other that their product is slow [s/rad].

    One wave alone is as large at all times.
    """
    if len(waves.omega) == 1:
        return np.zeros((1, 1))
    width = bands(waves.omega, scene.settings.duration).width
    apart = (waves.omega[:, None] - waves.omega) / width
    return np.exp(-0.5 * apart**2) / (width * np.sqrt(2 * np.pi))


def moved(
    model: LinearModel, axes: np.ndarray, added: np.ndarray, loads: np.ndarray, near: np.ndarray
) -> tuple[np.ndarray, np.ndarray, str]:
    """Mean and std (n,) along the axes by loads of each wave (nw, n), and what has none.

    C x̄ = Σ F;   (M + A(0)) ẍ + D ẋ + C x = F(t), of white noise. All else rides along.
    """
    at = np.ix_(axes, axes)
    C, D, M = model.stiffness[at], model.damping[at], model.mass[at] + added[at]
    n, none = len(axes), np.full(len(axes), np.nan)
    if np.linalg.eigvalsh((C + C.T) / 2)[0] <= 0:
        return none, none, "drift_offset: nothing holds the support against drift"
    mean = np.linalg.solve(C, loads.sum(axis=0))
    if np.linalg.eigvalsh((D + D.T) / 2)[0] <= 0:
        return mean, none, "slow_drift: nothing damps the support's slow drift"
    spectrum = 2 * loads.T @ near @ loads  # one-sided, of angular frequency
    inverse = np.linalg.inv(M)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ C, -inverse @ D]])
    driven = np.zeros((2 * n, 2 * n))
    driven[n:, n:] = np.pi * inverse @ spectrum @ inverse.T
    covariance = solve_continuous_lyapunov(state, -driven)
    return mean, np.sqrt(np.diag(covariance)[:n].clip(min=0.0)), ""


def require_far_field(h: Hydrodynamics | None) -> Hydrodynamics:
    """Refuse coefficients that do not know it."""
    if h is None or h.far_field is None:
        raise InputError("settings.outputs", "drift", "needs coefficients with a far field, by boundary elements")
    return h
