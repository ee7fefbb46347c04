"""Responses of the linear model wave by wave, its drag linearised by what moves against it."""

from dataclasses import dataclass

import numpy as np

from solver.coupled.linear import LinearModel, impedance, linear_model, wave_force
from solver.coupled.modal import Structure
from solver.coupled.system import System
from solver.errors import SimulationFailed
from solver.frequency import drag
from solver.frequency.gaussian import covariance
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody import joint_law

AGREED = 1e-4  # change of any coordinate's std, relative to itself, at which the drag is that of its own result
ROUNDS = 100
UNBOUNDED = 1e6  # times the sum of the waves' amplitudes: no damping holds what moves as far


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """x = x₀ + Re Σ X exp(-iωt) over the sea's waves; nm modes, nb floats."""

    omega: np.ndarray  # (nw,) [rad/s]
    X: np.ndarray  # (nw, n) of the model's coordinates
    Z: np.ndarray  # (nw, nz) of the floats' coordinates
    wrench: np.ndarray  # (nw, nb, 6) all loads on the floats
    carried: np.ndarray  # (nw, nc) load of the floats on the support's nodes, along their carriers
    drag: np.ndarray  # (nw, nd, ns) of the water on the frame at its stations
    pto: np.ndarray  # (nj,) damping of the power take-offs, linearised: power over the rate's mean square
    rounds: int  # until the drag agreed with its own result


def respond(system: System, h: Hydrodynamics | None) -> Response:
    """To the scene's sea, the sum of its waves."""
    sea, model = system.scene.sea, linear_model(system)
    # A wave of no height has no response, and coefficients may not reach to its frequency.
    waves = np.abs(sea.amplitude) > 0
    omega, rows = sea.omega[waves], system.rows[:, waves]
    Y = impedance(system, h, omega) if h is not None else np.zeros((omega.size, *2 * (len(model.active),)))
    excitation = rows[system.layout.excitation].T.reshape(omega.size, len(system.scene.floats), 6).copy()
    radiating = excitation[..., system.bodies.active]
    force = wave_force(model, radiating.reshape(omega.size, len(model.active)), rows[system.layout.modal])
    X, drag_load, pto, rounds = _agreed(system, model, omega, Y, force, rows[system.layout.station].T)
    w = omega[:, None]
    radiated = np.einsum("kij,kj->ki", Y, -1j * w * (X @ model.active.T))
    excitation[..., system.bodies.active] -= radiated.reshape(radiating.shape)
    by_motion = sum(np.tensordot((-1j * w) ** k * X, part, axes=(1, 2)) for k, part in enumerate(model.wrench))
    waves = rows[system.layout.modal].T
    return Response(
        omega=omega,
        X=X,
        Z=X @ model.shape.T,
        wrench=excitation + by_motion,
        carried=_carried(system.structure, w, X[:, : waves.shape[1]], waves, drag_load),
        drag=drag_load,
        pto=pto,
        rounds=rounds,
    )


def _carried(frame: Structure, w: np.ndarray, P: np.ndarray, waves: np.ndarray, drag_load: np.ndarray) -> np.ndarray:
    """What the modes' equation leaves to the floats, Sᵀ h = (-ω² - 2iζω_mω + ω_m²) P - waves - drag: h (nw, nc)."""
    if not frame.carrier.size:
        return np.zeros((len(P), frame.carrier.shape[0]), complex)
    force = (-(w**2) - 2j * frame.damping * frame.omega * w + frame.omega**2) * P - waves
    force -= np.tensordot(drag_load, frame.station, axes=([1, 2], [1, 2]))
    return np.linalg.lstsq(frame.carrier.T, force.T, rcond=None)[0].T


def _agreed(
    system: System, model: LinearModel, omega: np.ndarray, Y: np.ndarray, force: np.ndarray, water: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """X (nw, n), the drag (nw, nd, ns) in it, the power take-offs' damping (nj,), and the rounds until both were of X.

    force (nw, n): the waves', without drag; water (nw, nd ns): velocity at the drag stations.
    """
    frame = system.structure
    nm, (_, nd, ns), nc = frame.omega.size, frame.station.shape, frame.carrier.shape[0]
    water = water.reshape(omega.size, nd, ns)
    law, height = system.bodies.law, float(np.abs(system.scene.sea.amplitude).sum())
    quadratic, bent = joint_law.drag(law)[nc:], joint_law.bent(law).any()
    at_rest = pto = joint_law.damping_of_gaussian(law, np.zeros(system.bodies.mechanism.size))[nc:]
    Z, w = model.dynamic_stiffness(omega, Y), omega[:, None, None]
    rate = np.zeros((omega.size, len(model.mass)), complex)
    std, K = np.zeros(len(model.mass)), np.zeros((ns, nd, nd))
    for rounds in range(1, ROUNDS + 1):
        damping, push = np.zeros(model.damping.shape), force  # damping by drag
        if ns:
            flow = water - np.tensordot(rate[:, :nm], frame.station, axes=1)
            K = _equivalent(np.moveaxis(flow, -1, 1)) * frame.drag[:, None, None]
            carried = np.einsum("mds,sde->mes", frame.station, K)
            damping[:nm, :nm] += np.tensordot(carried, frame.station, axes=([1, 2], [1, 2]))
            push = force.copy()
            push[:, :nm] += np.tensordot(water, carried, axes=([1, 2], [1, 2]))
        if quadratic.any():
            damping[nm:, nm:] += np.diag(quadratic * _equivalent(rate[:, nm:, None])[:, 0, 0])
        if bent:
            pto = _taking(system, rate[:, nm:])
            damping[nm:, nm:] += np.diag(pto - at_rest)
        X = _solved(Z - 1j * w * damping if damping.any() else Z, push)
        _require_bounded(model, omega, X, height)
        rate, before, std = -1j * omega[:, None] * X, std, np.sqrt(np.sum(np.abs(X) ** 2, axis=0))
        if not (ns or quadratic.any() or bent) or np.all(np.abs(std - before) <= AGREED * std):
            past = water - np.tensordot(rate[:, :nm], frame.station, axes=1)
            return X, np.einsum("sde,kes->kds", K, past), pto, rounds
    what = "drag or power take-off" if bent else "drag"
    raise SimulationFailed(f"linearised {what} does not agree with its own result after {ROUNDS} rounds")


def _taking(system: System, rate: np.ndarray) -> np.ndarray:
    """Damping (nj,) of the power take-offs at rates (nw, nj): of one harmonic, or of a Gaussian process."""
    law, nc = system.bodies.law, system.structure.carrier.shape[0]
    size = np.zeros(system.bodies.mechanism.size)
    if len(rate) == 1:
        size[nc:] = np.abs(rate[0])
        return joint_law.damping_of_harmonic(law, size)[nc:]
    size[nc:] = np.sqrt(0.5 * np.sum(np.abs(rate) ** 2, axis=0))
    return joint_law.damping_of_gaussian(law, size)[nc:]


def _equivalent(u: np.ndarray) -> np.ndarray:
    """K (n, d, d) of velocities (nw, n, d): of one harmonic, or of a Gaussian process."""
    return drag.of_harmonic(u[0]) if len(u) == 1 else drag.of_gaussian(covariance(u, u))


def _solved(Z: np.ndarray, force: np.ndarray) -> np.ndarray:
    """X (nw, n); not a number where Z is singular."""
    try:
        return np.linalg.solve(Z, force[..., None])[..., 0]
    except np.linalg.LinAlgError:  # which does not say where
        return np.full(force.shape, np.nan, complex)


def _require_bounded(model: LinearModel, omega: np.ndarray, X: np.ndarray, height: float) -> None:
    """Raise SimulationFailed with the wave at which nothing holds or damps the scene."""
    reach = (np.abs(X) * model.length).max(axis=1, initial=0.0)
    if np.all(reach < UNBOUNDED * height):
        return
    worst = omega[np.argmax(np.nan_to_num(reach, nan=np.inf))]
    raise SimulationFailed(f"the linear model is singular at a wave of {worst:.4g} rad/s: nothing damps or holds it")
