"""Mean drift of all bodies together, from the waves far off; mean offset and slow drift of a moored support.

The mean force is of second order, the sum over the waves of a sea of Fᵢ = Tᵢ|aᵢ|². About the mean it varies slowly: two
waves make a force at the difference of their frequencies, by Newman's approximation (1974) with T = ½(Tᵢ + Tⱼ): in all

    S_F(μ) = 8 ∫ S(ω)S(ω + μ) ¼(T(ω) + T(ω + μ))² dω.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.interpolate import make_interp_spline
from scipy.linalg import eigh

from solver.coupled.linear import LinearModel, impedance_anywhere, linear_model
from solver.coupled.system import System
from solver.errors import InputError
from solver.frequency.case import Case
from solver.frequency.response import Response
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.hydrodynamics.bem.far_field import Waves
from solver.record.channels import Channels, Labelled
from solver.record.spectra import bands
from solver.scene import Scene

NODES, DENSE = 400, 10.0  # about a resonance, and to how many times sinh of half its width
ROUNDING = 1e-9  # of the largest coefficient, beside which less is none
REACHED = 1e-4  # of the largest load: a mesh that is not as round as its body turns it by less
SLOWEST = 1e-6  # [rad/s] at which added mass is that of no frequency
HORIZONTAL = ("surge", "sway", "yaw")  # axes that the far field's force and moment act along
SHARED = 16  # points in a band's width that waves are shared between: 1e-3 of the largest by that
GUIDED = (
    "drift_offset, slow_drift: not of yaw, whose moment is in part the joint's own reaction where it guides the support"
    " along one of surge and sway, or about one of roll and pitch, alone"
)
FEW = 16  # waves whose differences are told one by one: of more a record shows the spectrum

Impedance = Callable[[np.ndarray], np.ndarray]  # of frequencies μ (m,): B - iμ(A - A∞) (m, n, n)


class SlowLoad(NamedTuple):
    """What varies slowly of a load."""

    mu: np.ndarray  # (m,) [rad/s]
    power: np.ndarray  # (m, n, n) variance at each, or one-sided spectrum
    lines: bool  # which


def waves_of(case: Case, response: Response) -> Waves:
    """Far off, of the scene's response to its sea."""
    h = require_far_field(case.hydrodynamics)
    return h.waves(case.waves, case.system.scene.sea.amplitude[case.met], _velocity(case, response))


def _velocity(case: Case, response: Response) -> np.ndarray:
    """Of all that radiates by the waves (nw, na)."""
    return -1j * case.waves[:, None] * (response.X[: case.waves.size] @ case.model.active.T)


def energy_residual(case: Case, response: Response, waves: Waves) -> float:
    """Power that the far field says is absorbed, less what pressure does on the bodies, whichever is more in a wave,
    over what is sent out."""
    h, a = require_far_field(case.hydrodynamics), case.system.scene.sea.amplitude[case.met, None]
    V = _velocity(case, response)
    force = h.excitation(case.waves) * a - (h.impedance(case.waves) @ V[..., None])[..., 0]
    work = 0.5 * np.sum(force * V.conj(), axis=1).real
    return float(np.sum(np.abs(waves.absorbed_power - work)) / np.sum(waves.outgoing_power))


def variables(case: Case, response: Response) -> tuple[dict[str, Labelled], dict[str, Any]]:
    """Variables of the record, and figures: force, moment and, of a moored support, offset and slow drift."""
    h, scene, channels, waves = (
        require_far_field(case.hydrodynamics),
        case.system.scene,
        case.channels,
        waves_of(case, response),
    )
    force = np.concatenate([waves.drift_force, np.full((len(waves.omega), 1), np.nan)], axis=1)
    point, carried = _point(scene), waves.drift_moment
    assert h.far_field is not None, "required above"
    x, y = np.subtract(point[:2], h.far_field.origin)
    moment = carried - x * force[:, 1] + y * force[:, 0]
    found: dict[str, Labelled] = {"drift_force": (("direction",), force.sum(axis=0))}
    if scene.settings.rao:
        per_wave = np.full((scene.sea.omega.size, 3), np.nan)
        per_wave[case.met] = force / np.abs(scene.sea.amplitude[case.met, None]) ** 2
        found["drift_force_per_wave"] = ("direction", "component"), per_wave.T
    figures: dict[str, Any] = {
        "drift_moment": float(moment.sum()),
        "energy_residual": energy_residual(case, response, waves),
    }
    axes, held = _axes(scene, channels), ""
    if axes.size:
        loads = np.stack([force[:, 0], force[:, 1], moment], axis=1)
        each = loads[:, [HORIZONTAL.index(channels.names[i]) for i in axes]]
        if _guided(scene) and _turned(each, case.model.length[axes]):
            axes, each, held = axes[:-1], each[:, :-1], GUIDED
        slow = slow_load(waves.omega, waves.amplitude, each, scene.settings.duration)
        damped = replace(
            case.model, damping=case.model.damping + response.damping
        )  # quadratic ones' by the waves alone
        means, stds, unmet = np.zeros(0), np.zeros(0), ""
        if axes.size:
            means, stds, unmet = moved(damped, axes, radiated(case.system, h), each.sum(axis=0), slow)
        for name, values in (("drift_offset", means), ("slow_drift", stds)):
            joints = np.full(channels.owner.size, np.nan)
            joints[axes] = values
            found[name] = channels.at_axes(joints)
        figures["unmet"] = "; ".join(filter(None, [unmet, held]))
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
    """The joint axes along which the far field's loads move the support, in the order of HORIZONTAL."""
    own = {name: i for i, name in enumerate(channels.names) if channels.owner[i] == _support(scene)}
    return np.array([own[name] for name in HORIZONTAL if name in own], int)


def _guided(scene: Scene) -> bool:
    """Whether the support's joint bears a part of the moment about the vertical that yaw does not feel.

    Where it holds one of surge and sway, or of roll and pitch, and guides the other, its load acts where the waves have
    taken the support, or as they have tilted it.
    """
    free = {*scene.floats[_support(scene)].motion}
    return "yaw" in free and any(len(pair & free) == 1 for pair in ({"surge", "sway"}, {"roll", "pitch"}))


def _turned(each: np.ndarray, length: np.ndarray) -> bool:
    """Whether the last of loads (nw, n) is a moment that counts beside the others."""
    size = np.abs(each).sum(axis=0) / length
    return bool(size[-1] > REACHED * size.max())


def radiated(system: System, h: Hydrodynamics) -> Impedance:
    """Y(μ) of the linear model's coordinates."""
    E = linear_model(system).active
    return lambda mu: np.asarray(E.T @ impedance_anywhere(system, h, mu) @ E)


def slow_load(omega: np.ndarray, amplitude: np.ndarray, loads: np.ndarray, duration: float) -> SlowLoad:
    """Of waves a (nw,) with loads F (nw, n) each: Σ 2|aᵢaⱼ|² ¼(Tᵢ + Tⱼ)(Tᵢ + Tⱼ)ᵀ over their pairs, at |ωᵢ - ωⱼ|;

    of many, with each beside itself, spread by g(|ωᵢ - ωⱼ| - μ), g a band as spectra have them, as wide as waves are
    apart at least: they stand for a spectrum, in which each has others as near.
    """
    n, squares = loads.shape[1], np.abs(amplitude) ** 2
    if len(omega) <= FEW:
        i, j = np.triu_indices(len(omega), 1)
        each = np.sqrt(squares[j] / squares[i])[:, None]
        both = loads[i] * each + loads[j] / each
        return SlowLoad(np.abs(omega[i] - omega[j]), 0.5 * both[:, :, None] * both[:, None], lines=True)
    width = max(bands(omega, duration).width, float(np.ptp(omega)) / (len(omega) - 1))
    mu, step = np.arange(0, np.ptp(omega) + width, width), width / SHARED
    # Sums over pairs by their distance: waves are shared between the points of a grid, which correlate by FFT.
    place = (omega - omega.min()) / step
    count = int(place.max()) + 2
    size = next_fast_len(2 * count, real=True)

    def on_grid(each: np.ndarray) -> np.ndarray:
        points, low, flat = np.zeros((size, each[0].size)), place.astype(int), each.reshape(len(each), -1)
        np.add.at(points, low, (1 + low - place)[:, None] * flat)
        np.add.at(points, low + 1, (place - low)[:, None] * flat)
        return np.asarray(rfft(points, axis=0))

    own = on_grid(loads[:, :, None] * loads[:, None] / squares[:, None, None]) * on_grid(squares).conj()
    of_loads = on_grid(loads)
    between = (of_loads[:, :, None] * of_loads[:, None].conj()).reshape(own.shape)
    lags = irfft((own + between).real + 0j, size, axis=0)[:count]
    lags[1:] *= 2  # either way
    apart = step * np.arange(count)
    g = sum(np.exp(-0.5 * ((apart + way * mu[:, None]) / width) ** 2) for way in (1, -1)) / (width * np.sqrt(2 * np.pi))
    return SlowLoad(mu, (0.5 * g @ lags).reshape(len(mu), n, n), lines=False)


def moved(
    model: LinearModel, axes: np.ndarray, Y: Impedance, mean: np.ndarray, slow: SlowLoad
) -> tuple[np.ndarray, np.ndarray, str]:
    """Mean and std (n,) along the axes by a mean load (n,) and a slow one, and what has none.

    C x̄ = F;   cov x = ∫ H S_F Hᴴ dμ,  H = (C - μ²M - iμ(D + Y(μ)))⁻¹, of all coordinates: others follow without a
    load of their own, as a hull held below its centre of gravity pitches. Axes that no load reaches stay.
    """
    driven = _driven(model, axes, mean, slow)
    if not driven.all():
        each = np.zeros((2, len(axes)))
        power = slow.power[:, driven][:, :, driven]
        *each[:, driven], unmet = moved(model, axes[driven], Y, mean[driven], slow._replace(power=power))
        return *each, unmet
    C, D, others = model.stiffness, model.damping, np.setdiff1d(np.arange(len(model.mass)), axes)
    none, own = np.full(len(axes), np.nan), np.ix_(axes, axes)
    follow = np.linalg.pinv(C[np.ix_(others, others)]) @ C[np.ix_(others, axes)]
    steady = C[own] - C[np.ix_(axes, others)] @ follow
    if np.linalg.eigvalsh((steady + steady.T) / 2)[0] <= 0:
        return none, none, "drift_offset: nothing holds the support against drift"
    offset = np.linalg.solve(steady, mean)
    if not slow.power.any():  # as of a single wave
        return offset, np.zeros(len(axes)), ""
    if np.linalg.eigvalsh((D[own] + D[own].T) / 2)[0] <= 0:
        return offset, none, "slow_drift: nothing damps the support's slow drift"
    added = -Y(np.array([SLOWEST]))[0].imag / SLOWEST
    mu = slow.mu if slow.lines else _resolving(slow.mu, C, D, model.mass + added)
    H, swings, w = np.empty((len(mu), *steady.shape), complex), mu > 0, mu[mu > 0][:, None, None]
    H[~swings] = np.linalg.inv(steady)
    whole = C - w**2 * model.mass - 1j * w * (D + Y(mu[swings]))
    H[swings] = np.linalg.inv(whole)[:, axes[:, None], axes]
    S = slow.power if slow.lines else make_interp_spline(slow.mu, slow.power, k=1)(mu)
    variance = np.einsum("kij,kjl,kil->ki", H, S, H.conj()).real
    return offset, np.sqrt(variance.sum(axis=0) if slow.lines else np.trapezoid(variance, mu, axis=0)), ""


def _driven(model: LinearModel, axes: np.ndarray, mean: np.ndarray, slow: SlowLoad) -> np.ndarray:
    """Which of the axes loads reach, their own or through others: yaw of a round buoy in waves along its plane is not
    one, and need be neither held nor damped."""
    size = np.hypot(mean, np.sqrt(np.einsum("kii->i", slow.power))) / model.length[axes]
    reached = np.zeros(len(model.mass), bool)
    reached[axes] = size > REACHED * size.max(initial=0.0)
    each = (np.abs(A) / np.outer(model.length, model.length) for A in (model.stiffness, model.damping, model.mass))
    coupled = sum(ROUNDING * A.max(initial=0.0) < A for A in each)
    for _ in reached:
        reached |= (coupled @ reached) > 0
    return reached[axes]


def _resolving(mu: np.ndarray, C: np.ndarray, D: np.ndarray, M: np.ndarray) -> np.ndarray:
    """Frequencies from the first to the last of mu, dense about the resonances of C, D and M."""
    squares, shapes = eigh((C + C.T) / 2, (M + M.T) / 2)
    half = np.einsum("im,ij,jm->m", shapes, D, shapes) / 2  # of a resonance's width
    near = np.sqrt(np.maximum(squares, 0.0))[:, None] + half[:, None] * np.sinh(np.linspace(-DENSE, DENSE, NODES))
    return np.unique(np.concatenate([mu, np.clip(near.ravel(), mu[0], mu[-1])]))


def require_far_field(h: Hydrodynamics | None) -> Hydrodynamics:
    """Refuse coefficients that do not know it."""
    if h is None or h.far_field is None:
        raise InputError("settings.outputs", "drift", "needs coefficients with a far field, by boundary elements")
    return h
