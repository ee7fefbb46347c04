"""Responses of the linear model wave by wave, its drag linearised by what moves against it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import LinearModel, impedance, linear_model, wave_force
from solver.coupled.modal import Structure
from solver.coupled.system import System
from solver.errors import SimulationFailed
from solver.frequency.condensed import Condensed
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody import joint_law

AGREED = 1e-5  # error of any coordinate's std, relative to itself, at which the drag is that of its own result
ROUNDING = 1e-12  # change of a std that tells no more of how the next will be
ROUNDS = 300
UNBOUNDED = 1e6  # times the sum of the waves' amplitudes: no damping holds what moves as far


class Mean(NamedTuple):
    """What waves in a current change of the means at rest: drag goes by the square of the velocity."""

    x: np.ndarray  # (n,) of the model's coordinates
    wrench: np.ndarray  # (nb, 6)
    carried: np.ndarray  # (nc,)
    drag: np.ndarray  # (nd, ns) the whole mean drag [N]


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """x = x₀ + mean + Re Σ X exp(-iωt) over the sea's waves; nm modes, nb floats."""

    omega: np.ndarray  # (nw,) [rad/s]
    X: np.ndarray  # (nw, n) of the model's coordinates
    Z: np.ndarray  # (nw, nz) of the floats' coordinates
    wrench: np.ndarray  # (nw, nb, 6) all loads on the floats
    carried: np.ndarray  # (nw, nc) load of the floats on the support's nodes, along their carriers
    drag: np.ndarray  # (nw, nd, ns) of the water on the frame at its stations
    pto: np.ndarray  # (nj,) damping of the power take-offs, linearised: power over the rate's mean square
    rounds: int  # until the drag agreed with its own result
    mean: Mean


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
    stations = _Stations(system, rows[system.layout.station].T)
    w = omega[:, None]
    radiated = Y @ (-1j * w * (X @ model.active.T))[..., None]
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
        mean=_mean(system, model, stations.mean(-1j * w * X[:, : waves.shape[1]])),
    )


def _mean(system: System, model: LinearModel, drag: np.ndarray) -> Mean:
    """Of the mean drag (nd, ns) [N]; the shift from rest is by what it is more than the current's alone."""
    frame, nm = system.structure, system.structure.omega.size
    x, more = np.zeros(len(model.stiffness)), np.zeros(drag.shape)
    if system.support and drag.any():
        stream, load = system.support.stream, np.zeros(x.size)
        more = drag - frame.drag * np.linalg.norm(stream, axis=0) * stream
        load[:nm] = np.tensordot(frame.station, more, axes=2)
        x = np.linalg.lstsq(model.stiffness, load, rcond=None)[0]
    carried = _carried(frame, np.zeros((1, 1)), x[None, :nm], np.zeros((1, nm)), more[None])[0].real
    return Mean(x=x, wrench=model.wrench[0] @ x, carried=carried, drag=drag)


def _carried(frame: Structure, w: np.ndarray, P: np.ndarray, waves: np.ndarray, drag_load: np.ndarray) -> np.ndarray:
    """What the modes' equation leaves to the floats, Sᵀ h = (-ω² - 2iζω_mω + ω_m²) P - waves - drag: h (nw, nc)."""
    if not frame.carrier.size:
        return np.zeros((len(P), frame.carrier.shape[0]), complex)
    force = (-(w**2) - 2j * frame.damping * frame.omega * w + frame.omega**2) * P - waves
    at_stations = drag_load[0].size
    force -= drag_load.reshape(len(P), at_stations) @ frame.station.reshape(len(frame.station), at_stations).T
    return np.linalg.lstsq(frame.carrier.T, force.T, rcond=None)[0].T


def _agreed(
    system: System, model: LinearModel, omega: np.ndarray, Y: np.ndarray, force: np.ndarray, water: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """X (nw, n), the drag (nw, nd, ns) in it, the power take-offs' damping (nj,), and the rounds until both were of X.

    force (nw, n): the waves', without drag; water (nw, nd ns): velocity at the drag stations.
    """
    frame, law = system.structure, system.bodies.law
    nm, nc = frame.omega.size, frame.carrier.shape[0]
    stations, height = _Stations(system, water), float(np.abs(system.scene.sea.amplitude).sum())
    quadratic, bent = joint_law.drag(law)[nc:], joint_law.bent(law).any()
    at_rest = pto = joint_law.damping_of_gaussian(law, np.zeros(system.bodies.mechanism.size))[nc:]
    equation: Condensed | None = None
    rate = np.zeros((omega.size, len(model.mass)), complex)
    std, change = np.zeros(len(model.mass)), np.inf
    for rounds in range(1, ROUNDS + 1):
        damping, push = np.zeros(model.damping.shape), force  # damping by drag
        if stations.size:
            K = stations.equivalent(rate[:, :nm])
            damping[:nm, :nm], of_water = stations.on_modes(K)
            push = force.copy()
            push[:, :nm] += of_water
        if quadratic.any():
            damping[nm:, nm:] += np.diag(quadratic * linear_drag.of_lines(rate[:, None, nm:])[:, 0, 0])
        if bent:
            pto = _taking(system, rate[:, nm:])
            damping[nm:, nm:] += np.diag(pto - at_rest)
        equation = equation or Condensed(model, omega, Y, damping[:nm, :nm])
        X = equation.response(push, damping, rate)
        _require_bounded(model, omega, X, height)
        rate, before, std = -1j * omega[:, None] * X, std, np.linalg.norm(X, axis=0)
        last, change = change, _change(before, std)
        if not (stations.size or quadratic.any() or bent) or _ahead(last, change) <= AGREED:
            return X, stations.load(K, rate[:, :nm]) if stations.size else stations.none, pto, rounds
    what = "drag or power take-off" if bent else "drag"
    raise SimulationFailed(f"linearised {what} does not agree with its own result after {ROUNDS} rounds")


def _change(before: np.ndarray, std: np.ndarray) -> float:
    """The largest, relative to itself; infinite from nothing."""
    new = np.full(std.shape, np.inf)
    new[std == before] = 0.0
    return float(np.divide(np.abs(std - before), std, out=new, where=(std != before) & (before > 0)).max(initial=0.0))


def _ahead(last: float, change: float) -> float:
    """All changes to come, where each is the same share of the one before as this one is of the last."""
    if change <= ROUNDING:
        return change
    return change**2 / (last - change) if change < last < np.inf else np.inf


class _Stations:
    """The frame's drag at its ns stations, in nd directions, in water of velocity (nw, nd ns) and a current.

    Lines are taken as twice as many real ones, for products with real shapes.
    """

    def __init__(self, system: System, water: np.ndarray):
        self.frame = frame = system.structure
        self.size = frame.drag.size
        self.stream = system.support.stream if system.support and system.support.stream.any() else None
        nm, nd, ns = frame.station.shape
        self.shape = frame.station.reshape(nm, nd * ns)
        self.water = np.concatenate([water.real, water.imag])
        self.none = water.reshape(len(water), *frame.station.shape[1:])

    def _flow(self, rate: np.ndarray) -> np.ndarray:
        """Of the water past the frame (2 nw, nd, ns) at modal rates (nw, nm)."""
        flow = self.water - np.concatenate([rate.real, rate.imag]) @ self.shape
        return flow.reshape(len(flow), *self.frame.station.shape[1:])

    def equivalent(self, rate: np.ndarray) -> np.ndarray:
        """K (ns, nd, nd) [N s/m] at modal rates (nw, nm)."""
        flow = self._flow(rate)
        K = linear_drag.of_parts(flow) if self.stream is None else linear_drag.of_parts_in(self.stream, flow)[1]
        return K * self.frame.drag[:, None, None]

    def mean(self, rate: np.ndarray) -> np.ndarray:
        """Mean drag (nd, ns) [N] at modal rates (nw, nm): none without a current."""
        if self.stream is None:
            return np.zeros(self.frame.station.shape[1:])
        return self.frame.drag * linear_drag.of_parts_in(self.stream, self._flow(rate))[0].T

    def on_modes(self, K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Damping (nm, nm) of the modes, and the water's force on them (nw, nm)."""
        carried = linear_drag.by_station(K, self.frame.station).reshape(self.shape.shape)
        force = self.water @ carried.T
        half = len(force) // 2
        return carried @ self.shape.T, force[:half] + 1j * force[half:]

    def load(self, K: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """On the frame (nw, nd, ns) [N]."""
        load = linear_drag.by_station(K, self._flow(rate))
        half = len(load) // 2
        return load[:half] + 1j * load[half:]


def _taking(system: System, rate: np.ndarray) -> np.ndarray:
    """Damping (nj,) of the power take-offs at rates (nw, nj): of one harmonic, or of a Gaussian process."""
    law, nc = system.bodies.law, system.structure.carrier.shape[0]
    size = np.zeros(system.bodies.mechanism.size)
    if len(rate) == 1:
        size[nc:] = np.abs(rate[0])
        return joint_law.damping_of_harmonic(law, size)[nc:]
    size[nc:] = np.sqrt(0.5 * np.sum(np.abs(rate) ** 2, axis=0))
    return joint_law.damping_of_gaussian(law, size)[nc:]


def _require_bounded(model: LinearModel, omega: np.ndarray, X: np.ndarray, height: float) -> None:
    """Raise SimulationFailed with the wave at which nothing holds or damps the scene."""
    reach = (np.abs(X) * model.length).max(axis=1, initial=0.0)
    if np.all(reach < UNBOUNDED * height):
        return
    worst = omega[np.argmax(np.nan_to_num(reach, nan=np.inf))]
    raise SimulationFailed(f"the linear model is singular at a wave of {worst:.4g} rad/s: nothing damps or holds it")
