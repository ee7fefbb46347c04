"""Responses of the linear model wave by wave, its drag linearised by what moves against it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import LinearModel
from solver.errors import SimulationFailed
from solver.frequency import gaussian, left, overtones, shape, yielding
from solver.frequency.bent import pto_load, rate_load
from solver.frequency.case import Case, Pushed, case_of
from solver.frequency.condensed import Condensed
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.lines import lengths, real_by_complex
from solver.multibody import linearised, of_axes
from solver.multibody.joint_law import JointLaw
from solver.record.effects import cancelled, force_error, response_error
from solver.scene import Scene

AGREED = 1e-5  # error of any coordinate's std, relative to itself, at which the drag is that of its own result
HELD = 1e-6  # of the waves' amplitudes: an axis that moves less is held
LEAST = 1e-12  # of them in a second: the rate that friction is linearised by where it holds an axis
FARTHEST = 0.98  # slope of a secant
ROUNDING = 1e-12  # change of a std that tells no more of how the next will be
ROUNDS = 300
SHAPED, ALIKE = 6, 2e-3  # times that dampers are taken again for rates of the shape they have, and change of a kurtosis
UNBOUNDED = 1e6  # times the sum of the waves' amplitudes: no damping holds what moves as far


class Mean(NamedTuple):
    """What waves change of the means at rest: drag in a current, by the velocity's square, and arms that turn."""

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
    """x = x₀ + mean + Re Σ X exp(-iωt) over the lines of a case; nm modes, nb floats."""

    omega: np.ndarray  # (nl,) [rad/s]
    X: np.ndarray  # (nl, n) of the model's coordinates
    Z: np.ndarray  # (nl, nz) of the floats' coordinates
    wrench: np.ndarray  # (nl, nb, 6) all loads on the floats
    carried: np.ndarray  # (nl, nc) load of the floats on the support's nodes, along their carriers
    drag: Drag
    damping: np.ndarray  # (n, n) of drag and dampers, besides the model's
    pto: np.ndarray  # (nj,) damping of the power take-offs, linearised: power over the rate's mean square
    rounds: int  # until the drag agreed with its own result
    mean: Mean
    mesh_effect: float  # see effects.coefficient_effects
    linearisation_effect: float  # see _linearisation_effect
    bends: np.ndarray  # (nj,) which axes' law has several zones
    excess: np.ndarray  # (2, nj) kurtosis of the joints' rates and motions beyond a Gaussian's: see shape
    stuck: np.ndarray  # (nj,) which axes friction holds


def respond(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Response:
    """To the scene's sea, the sum of its waves."""
    case = case_of(scene, hydrodynamics)
    return respond_in(case, case.law(scene.floats))


def respond_in(case: Case, law: JointLaw) -> Response:
    """To a case's sea, with the law of its joints."""
    model, omega = case.model, case.omega
    last, excess, h = _shaped(case, law)
    nm = model.modes.shape[1]
    X, drag = last.X.T, _borne(case, last) if case.stations.size else _no_drag(case)
    wrench = model.loads(omega, X, case.impedance, case.excitation)
    Z = real_by_complex(model.shape, last.X).T
    return Response(
        omega=omega,
        X=X,
        Z=Z,
        wrench=wrench,
        carried=model.carried(omega, Z, case.impedance, case.radiating),
        drag=drag,
        damping=last.damping,
        pto=last.pto,
        rounds=last.rounds,
        mean=_mean(case, last.rate[:nm]),
        mesh_effect=_mesh_effect(case, law, last, wrench),
        linearisation_effect=_linearisation_effect(case, law, last, (excess[0], h), wrench),
        bends=last.bends,
        excess=excess,
        stuck=last.stuck,
    )


def _mean(case: Case, rate: np.ndarray) -> Mean:
    """At modal rates (nm, nw); the shift from rest is by what the mean drag is more than the current's alone."""
    model, stations, frame = case.model, case.stations, case.system.structure
    (nc, nm), n, nb = frame.carrier.shape, len(model.stiffness), len(case.system.scene.floats)
    if stations.stream is None:
        return Mean(np.zeros(n), np.zeros((nb, 6)), np.zeros(nc), np.zeros(frame.station.shape[1:]))
    drag, load = stations.mean(rate), np.zeros(n)
    more = drag - frame.drag * np.linalg.norm(stations.stream, axis=0) * stations.stream
    load[:nm] = np.tensordot(frame.station, more, axes=2)
    x = case.shift(load)
    return Mean(x=x, wrench=model.wrench[0] @ x, carried=case.carried_by(x), drag=drag)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Round:
    """What moves with a damping, and what the water's drag pushes, both linearised by what moved before."""

    X: np.ndarray  # (n, nl)
    rate: np.ndarray  # (n, nl)
    push: np.ndarray  # (n, nl) waves' force and what drag adds to it
    damping: np.ndarray  # (n, n) of drag and dampers
    K: np.ndarray  # (ns, nd, nd) of the drag: see Stations
    of_water: np.ndarray  # (nm, nl) what it does to the modes where they do not move
    pto: np.ndarray  # (nj,) damping of the power take-offs
    bends: np.ndarray  # (nj,) which axes' law has several zones
    stuck: np.ndarray  # (nj,) which axes friction holds
    rounds: int


def _shaped(case: Case, law: JointLaw) -> tuple[_Round, np.ndarray, np.ndarray]:
    """The round whose dampers are by rates as these are distributed; their excess (2, nj), and h (nj,): see shape."""
    nm, nc = case.model.modes.shape[1], case.system.structure.carrier.shape[0]
    last = _agreed(case, law, np.zeros((2, nc + len(case.model.mass) - nm)))
    excess, h = _excess(case, law, last)
    for _ in range(SHAPED if excess.any() else 0):
        sigma, kappa = (np.concatenate([np.zeros(nc), x]) for x in (gaussian.spread(last.rate[nm:].T), excess[0]))
        last, before = _agreed(case, law, shape.more_damping(law, sigma, kappa)), excess
        excess, h = _excess(case, law, last)
        if np.all(np.abs(excess - before) <= ALIKE):
            break
    return last, excess, h


def _agreed(case: Case, law: JointLaw, more: np.ndarray) -> _Round:
    """The round that agrees with the one before it; more (2, nc + nj): see shape.more_damping."""
    model, omega, stations = case.model, case.omega, case.stations
    nm, nc = model.modes.shape[1], case.system.structure.carrier.shape[0]
    height = float(np.abs(case.system.scene.sea.amplitude).sum())
    quadratic, bends = of_axes.drag(law), of_axes.bent(law)[nc:]
    bent = bends.any()
    linear, joints = case.linear_damping(law), np.arange(nm, len(model.mass))
    at_rest = pto = linearised.damping_at_rest(law)[nc:]
    rate, turning = np.zeros((len(model.mass), omega.size), complex), -1j * omega
    std, change, damping = np.zeros(len(model.mass)), np.inf, np.zeros(model.damping.shape)
    before = _Sizes(*np.zeros((2, len(joints))))
    taken, held, least = before.taken, np.zeros(len(model.mass), bool), LEAST * height / model.length[nm:]
    for rounds in range(1, ROUNDS + 1):
        K, damping[:nm, :nm], of_water = case.drag(rate[:nm]) if rounds > 1 else case.drag_at_rest
        push = _pushed(case.force, case.equation, damping, of_water, rate) if rounds > 1 else case.force_at_rest
        dampers = linear
        if quadratic.any() or bent:
            now = _Sizes(taken, lengths(rate[nm:]))
            taken, before = np.where(held[nm:], least, np.maximum(_next(now, before), least)), now
            rates = rate[nm:] * np.divide(taken, now.given, out=np.ones(taken.size), where=now.given > 0)[:, None]
            dampers = dampers + (1 + more[1, nc:]) * quadratic[nc:] * linear_drag.of_lines(rates.T[:, None])[:, 0, 0]
        if bent:
            length = np.concatenate([np.zeros(nc), lengths(rates)])
            pto = (1 + more[0, nc:]) * linearised.damping_of_lines(law, length, single=omega.size == 1)[nc:]
            dampers = dampers + (pto - at_rest)
        damping[joints, joints] = dampers
        X = case.equation.response(push, damping)
        rate, last_std, std = turning * X, std, lengths(X)
        if not np.max(std * model.length, initial=0.0) < UNBOUNDED * height:  # each wave's part is less
            _require_bounded(model, omega, X, height)
        was, held = held, np.maximum(last_std, std) * model.length < HELD * height
        held[:nm] = False  # no brake holds a mode
        held[nm:] &= pto * lengths(rate[nm:]) <= of_axes.limits(law)[nc:]  # and none that lets go
        alike = rounds > 1 and np.array_equal(was, held)
        last, change = change, _change(last_std[~held], std[~held]) if alike else np.inf
        if not (stations.size or quadratic.any() or bent) or _ahead(last, change) <= AGREED:
            found = {"X": X, "rate": rate, "push": push, "damping": damping, "K": K, "of_water": of_water}
            return _Round(**found, pto=pto, bends=bends, stuck=held[nm:] & of_axes.holds(law)[nc:], rounds=rounds)
    what = "drag or power take-off" if bent else "drag"
    raise SimulationFailed(f"linearised {what} does not agree with its own result after {ROUNDS} rounds")


def _pushed(
    force: np.ndarray, equation: Condensed, damping: np.ndarray, of_water: np.ndarray, rate: np.ndarray
) -> np.ndarray:
    """Forces (n, nw) with those of drag: of water on the modes (nm, nw), and by their rates, see Condensed.apart."""
    push, nm = force.copy(), len(of_water)
    push[:nm] += of_water
    push[:nm] -= real_by_complex(equation.apart(damping)[:nm, :nm], rate[:nm])
    return push


def _mesh_effect(case: Case, law: JointLaw, last: _Round, wrench: np.ndarray) -> float:
    """What coefficients off by their estimated error do: see effects.coefficient_effects. Drag and dampers stay.

    wrench (nw, nb, 6): all loads on the floats without them.
    """
    h, other, model = case.hydrodynamics, case.shifted, case.model
    if h is None or other is None:
        return 0.0
    borne = case.channels.hinge_force(wrench)

    def change(equation: Condensed, Y: np.ndarray, by: Pushed) -> float:
        X = equation.response(last.push + by.more, last.damping).T
        forces = case.channels.hinge_force(model.loads(case.omega, X, Y, by.excitation))
        motions = response_error(case.system, law, case.omega, X, last.X.T)
        return max(motions, force_error(case.system, forces, borne))

    return cancelled(
        change(other.equation, other.impedance, other.pushed),
        other.unlike,
        lambda: change(case.equation, case.impedance, other.pushed),
        lambda: change(case.equation, case.impedance, case.pushed_by(h.forced)),
    )


def _excess(case: Case, law: JointLaw, last: _Round) -> tuple[np.ndarray, np.ndarray]:
    """Kurtosis of the joints' rates and motions (2, nj) beyond a Gaussian's, and h (nj,); of one wave, and of axes that
    are held, none."""
    nm, nc = case.model.modes.shape[1], case.system.structure.carrier.shape[0]
    rate, joints = last.rate[nm:], ((of_axes.drag(law)[nc:] > 0) | last.bends) & ~last.stuck
    mobility = np.zeros(rate.shape, complex)
    if rate.shape[1] == 1 or not joints.any():
        return np.zeros((2, len(rate))), np.zeros(len(rate))
    for j in np.flatnonzero(joints):
        force = np.zeros(last.X.shape, complex)
        force[nm + j] = 1.0
        mobility[j] = -1j * case.omega * case.equation.response(force, last.damping)[nm + j]
    lines = np.zeros((nc, rate.shape[1]))
    excess, h = shape.excess(law, case.omega, *(np.concatenate([lines, x]) for x in (rate, mobility)))
    return excess[:, nc:], h[nc:]


def _linearisation_effect(
    case: Case, law: JointLaw, last: _Round, of_rates: tuple[np.ndarray, np.ndarray], wrench: np.ndarray
) -> float:
    """Relative error of the response's std and power by what linear damping leaves of the joints' loads by rate.

    That goes with no rate in the mean, moves the axis as a force of the rate's spectrum about that and of its own below
    the waves, and adds to the variance of the motions: so marches tell, and they agree within a factor of 3. See
    response_error. Besides, what it is beyond the third order gives the rate a shape that no kurtosis tells; where all
    orders matter, yielding is more. of_rates: kurtosis and h (nj,) of the joints' rates, see shape.
    """
    nm, nc = case.model.modes.shape[1], case.system.structure.carrier.shape[0]
    if not (of_axes.drag(law).any() or last.bends.any()):
        return 0.0
    if case.omega.size == 1:
        return _by_overtones(case, law, last, wrench)
    rate = last.rate[nm:]
    rms = np.concatenate([np.zeros(nc), lengths(rate) / np.sqrt(2)])
    kappa, h = (np.concatenate([np.zeros(nc), x]) for x in of_rates)
    rest = linearised.rest(law, rms, shape.warped(linearised.GAUSSIAN[:, None], kappa))
    share = np.divide(rest, rms, out=np.zeros(rms.size), where=rms > 0)[nc:]
    force = np.zeros(last.X.shape, complex)
    force[nm:] = np.where(last.stuck, 0.0, share)[:, None] * rate
    size, more = (lengths(X)[:, None] for X in (last.X, case.equation.response(force, last.damping)))
    grown = np.hypot(1, np.divide(more, size, out=np.zeros(size.shape), where=size > 0))
    which = np.flatnonzero((rms[nc:] > 0) & (rest[nc:] > 0) & ~last.stuck)
    slowly, slow = left.slow_motions(case, rate_load(law, nc + which), nm + which, rate[which].T, last.damping)
    waves, both = np.pad(last.X, ((0, 0), (0, slowly.size))), np.concatenate([grown * last.X, slow], axis=1)
    moved = response_error(case.system, law, np.append(case.omega, slowly), both.T, waves.T)
    told = moved + shape.power_error(law, rms, kappa)
    yields = np.concatenate([np.zeros(nc, bool), last.bends & ~last.stuck])
    return max(told, yielding.power_error(law, rms * yields, kappa, h)) if yields.any() else told


def _by_overtones(case: Case, law: JointLaw, last: _Round, wrench: np.ndarray) -> float:
    """The same of one wave: see overtones."""
    nm, nc = case.model.modes.shape[1], case.system.structure.carrier.shape[0]
    free = np.flatnonzero(~last.stuck)
    axes, load = nm + free, rate_load(law, nc + free)
    high = overtones.overtones(case, last.damping, load, last.rate[axes].T, axes)
    force = np.zeros(last.X.shape, complex)
    force[axes, 0] = -high.force
    more = case.equation.response(force, last.damping)
    before, after = (gaussian.one_period(x[axes].T) for x in (last.rate, last.rate - 1j * case.omega * more))
    moves = response_error(case.system, law, case.omega, (last.X + more).T, last.X.T)
    exact = case.model.loads(case.omega, (last.X + more).T, case.impedance, case.excitation)
    borne = force_error(case.system, *map(case.channels.hinge_force, (wrench, exact)))
    return max(moves, borne, overtones.power_error(pto_load(law, nc + free), before, after + high.rates))


def _no_drag(case: Case) -> Drag:
    return _parts(
        case, np.zeros((case.omega.size, case.model.modes.shape[1])), np.zeros((case.omega.size, len(case.of_drag)))
    )


def _borne(case: Case, last: _Round) -> Drag:
    nm = len(last.of_water)
    against, pushed = case.pushed(last.K, case.of_drag)
    both = np.concatenate([last.damping[:nm, :nm], against])
    drag = np.concatenate([last.of_water, pushed]) - real_by_complex(both, last.rate[:nm])
    return _parts(case, drag[:nm].T, drag[nm:].T)


def _parts(case: Case, modes: np.ndarray, others: np.ndarray) -> Drag:
    """Of what drag does to the modes (nw, nm), and by the case's maps (nw, r + nt)."""
    support = case.system.support
    r = support.forces.drag.shape[1] if support and support.forces is not None else 0
    return Drag(modes, others[:, :r], others[:, r:])


def _change(before: np.ndarray, std: np.ndarray) -> float:
    """The largest, relative to the smaller; infinite from nothing, and to it."""
    new, least = np.abs(std - before), np.minimum(std, before)
    if not least.all():
        new[new > 0], least = np.where(least[new > 0] > 0, new[new > 0], np.inf), np.where(least > 0, least, 1.0)
    return float((new / least).max(initial=0.0))


def _ahead(last: float, change: float) -> float:
    """All changes to come, where each is the same share of the one before as this one is of the last, a small one."""
    if change <= ROUNDING:
        return change
    return change**2 / (last - change) if change < last < 1.0 else np.inf


class _Sizes(NamedTuple):
    """Of the joints' rates (nj,): those that dampers were linearised by, and those that they gave."""

    taken: np.ndarray
    given: np.ndarray


def _next(now: _Sizes, before: _Sizes) -> np.ndarray:
    """Sizes (nj,) to linearise by next: those given, and ahead of or behind them by the secant of their logarithms.

    A damper that is all that holds an axis lets it move as 1/B. Where B goes with that, it goes to and fro; where it is
    friction, whose B goes as 1/v, each round leaves nearly the same.
    """
    known = np.all([*now, *before], axis=0) & (now.taken != before.taken)
    away, rise, step = (
        np.log(np.divide(a, b, out=np.ones(known.size), where=known))
        for a, b in ((now.given, now.taken), (now.given, before.given), (now.taken, before.taken))
    )
    slope = np.clip(np.divide(rise, step, out=np.zeros(known.size), where=known), -1.0, FARTHEST)
    return np.where(known, now.taken * np.exp(away / (1 - slope)), now.given)


def _require_bounded(model: LinearModel, omega: np.ndarray, X: np.ndarray, height: float) -> None:
    """Raise SimulationFailed with the wave at which nothing holds or damps the scene."""
    reach = (np.abs(X) * model.length[:, None]).max(axis=0, initial=0.0)
    if np.all(reach < UNBOUNDED * height):
        return
    worst = omega[np.argmax(np.nan_to_num(reach, nan=np.inf))]
    raise SimulationFailed(f"the linear model is singular at a wave of {worst:.4g} rad/s: nothing damps or holds it")
