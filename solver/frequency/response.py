"""Responses of the linear model wave by wave, its drag linearised by what moves against it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import LinearModel
from solver.errors import SimulationFailed
from solver.frequency.case import Case, case_of
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody import joint_law
from solver.multibody.joint_law import JointLaw
from solver.scene import Scene

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


class Drag(NamedTuple):
    """Of the water on the frame, as others feel it."""

    modes: np.ndarray  # (nw, nm)
    forces: np.ndarray  # (nw, r) of the frame: see coupled.forces
    tops: np.ndarray  # (nw, nt) of the legs, by the shapes that are left out


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """x = x₀ + mean + Re Σ X exp(-iωt) over the sea's waves; nm modes, nb floats."""

    omega: np.ndarray  # (nw,) [rad/s]
    X: np.ndarray  # (nw, n) of the model's coordinates
    Z: np.ndarray  # (nw, nz) of the floats' coordinates
    wrench: np.ndarray  # (nw, nb, 6) all loads on the floats
    carried: np.ndarray  # (nw, nc) load of the floats on the support's nodes, along their carriers
    drag: Drag
    pto: np.ndarray  # (nj,) damping of the power take-offs, linearised: power over the rate's mean square
    rounds: int  # until the drag agreed with its own result
    mean: Mean


def respond(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Response:
    """To the scene's sea, the sum of its waves."""
    case = case_of(scene, hydrodynamics)
    return respond_in(case, case.law(scene.floats))


def respond_in(case: Case, law: JointLaw) -> Response:
    """To a case's sea, with the law of its joints."""
    model, omega, frame = case.model, case.omega, case.system.structure
    X, drag, pto, rounds = _agreed(case, law)
    w, nm = omega[:, None], frame.omega.size
    return Response(
        omega=omega,
        X=X,
        Z=X @ model.shape.T,
        wrench=model.loads(omega, X, case.impedance, case.excitation, case.system.bodies.active),
        carried=_carried(case, w, X[:, :nm], case.rows[case.system.layout.modal].T + drag.modes),
        drag=drag,
        pto=pto,
        rounds=rounds,
        mean=_mean(case, -1j * w * X[:, :nm]),
    )


def _mean(case: Case, rate: np.ndarray) -> Mean:
    """At modal rates (nw, nm); the shift from rest is by what the mean drag is more than the current's alone."""
    model, stations, frame = case.model, case.stations, case.system.structure
    (nc, nm), n, nb = frame.carrier.shape, len(model.stiffness), len(case.system.scene.floats)
    if stations.stream is None:
        return Mean(np.zeros(n), np.zeros((nb, 6)), np.zeros(nc), np.zeros(frame.station.shape[1:]))
    drag, load = stations.mean(rate), np.zeros(n)
    more = drag - frame.drag * np.linalg.norm(stations.stream, axis=0) * stations.stream
    load[:nm] = np.tensordot(frame.station, more, axes=2)
    x = np.linalg.lstsq(model.stiffness, load, rcond=None)[0]
    carried = _carried(case, np.zeros((1, 1)), x[None, :nm], load[None, :nm])[0].real
    return Mean(x=x, wrench=model.wrench[0] @ x, carried=carried, drag=drag)


def _carried(case: Case, w: np.ndarray, P: np.ndarray, load: np.ndarray) -> np.ndarray:
    """What the modes' equation leaves to the floats, Sᵀ h = (-ω² - 2iζω_mω + ω_m²) P - load: h (nw, nc)."""
    frame = case.system.structure
    force = (-(w**2) - 2j * frame.damping * frame.omega * w + frame.omega**2) * P - load
    return force @ case.to_carriers


def _agreed(case: Case, law: JointLaw) -> tuple[np.ndarray, Drag, np.ndarray, int]:
    """X (nw, n), the drag in it, the power take-offs' damping (nj,), and the rounds until both were of X."""
    model, omega, stations = case.model, case.omega, case.stations
    nm, nc = model.modes.shape[1], case.system.structure.carrier.shape[0]
    height = float(np.abs(case.system.scene.sea.amplitude).sum())
    quadratic, bent = joint_law.drag(law), joint_law.bent(law).any()
    linear = case.linear_damping(law)
    at_rest = pto = joint_law.damping_of_gaussian(law, np.zeros(quadratic.size))[nc:]
    rate = np.zeros((omega.size, len(model.mass)), complex)
    std, change = np.zeros(len(model.mass)), np.inf
    for rounds in range(1, ROUNDS + 1):
        damping, push = np.zeros(model.damping.shape), case.force
        if stations.size:
            K, damping[:nm, :nm], of_water = _drag(case, rate[:, :nm]) if rounds > 1 else case.drag_at_rest
            push = push.copy()
            push[:, :nm] += of_water
        dampers = linear
        if quadratic.any():
            dampers = dampers + quadratic[nc:] * linear_drag.of_lines(rate[:, None, nm:])[:, 0, 0]
        if bent:
            pto = _taking(law, nc, rate[:, nm:])
            dampers = dampers + (pto - at_rest)
        damping[nm:, nm:] = np.diag(dampers)
        X = case.equation.response(push, damping, rate)
        rate, before, std = -1j * omega[:, None] * X, std, np.linalg.norm(X, axis=0)
        if not np.all(std * model.length < UNBOUNDED * height):  # each wave's part is less
            _require_bounded(model, omega, X, height)
        last, change = change, _change(before, std)
        if not (stations.size or quadratic.any() or bent) or _ahead(last, change) <= AGREED:
            drag = _borne(case, K, damping[:nm, :nm], of_water, rate[:, :nm]) if stations.size else _no_drag(case)
            return X, drag, pto, rounds
    what = "drag or power take-off" if bent else "drag"
    raise SimulationFailed(f"linearised {what} does not agree with its own result after {ROUNDS} rounds")


def _no_drag(case: Case) -> Drag:
    return _parts(
        case, np.zeros((case.omega.size, case.model.modes.shape[1])), np.zeros((case.omega.size, len(case.of_drag)))
    )


def _borne(case: Case, K: np.ndarray, damping: np.ndarray, of_water: np.ndarray, rate: np.ndarray) -> Drag:
    """At modal rates (nw, nm), of K and what it does to the modes (see Stations)."""
    against, pushed = case.stations.acting(K, case.of_drag)
    return _parts(case, of_water - rate @ damping.T, pushed - rate @ against.T)


def _parts(case: Case, modes: np.ndarray, others: np.ndarray) -> Drag:
    """Of what drag does to the modes (nw, nm), and by the case's maps (nw, r + nt)."""
    support = case.system.support
    r = support.forces.drag.shape[1] if support and support.forces is not None else 0
    return Drag(modes, others[:, :r], others[:, r:])


def _drag(case: Case, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """K, and what it does to the modes (see Stations), where they move at rates (nw, nm)."""
    K = case.stations.equivalent(rate)
    return K, *case.stations.acting(K, case.system.structure.station)


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


def _taking(law: JointLaw, nc: int, rate: np.ndarray) -> np.ndarray:
    """Damping (nj,) of the power take-offs at rates (nw, nj): of one harmonic, or of a Gaussian process.

    nc: coordinates before the joints'.
    """
    size = np.zeros(len(joint_law.dampers(law)))
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
