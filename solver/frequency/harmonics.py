"""What one wave moves where arms turn exactly, by harmonic balance: to tell how much the linear response errs.

x = X₀ + Re Σ Xₖ exp(-ikωt), k < HARMONICS. With the loads JᵀW of the march's own kernel at some instants of a period,
the waves' and the radiated ones W' on levers J(z) that turn, and N what all of it has beyond the linear model's loads,

    Z(kω) Xₖ = Fₖ + Nₖ(X)

again until it agrees with its own result. Drag, dampers and bent laws stay as they were linearised.
"""

from typing import NamedTuple

import numpy as np

from solver.coupled.equilibrium import balance
from solver.coupled.linear import impedance_anywhere, jacobian
from solver.frequency.case import Case
from solver.frequency.outputs import Forces
from solver.frequency.response import Response
from solver.multibody.joint_law import JointLaw
from solver.record.effects import force_error, response_error
from solver.record.probe import UNTOLD
from solver.statistics import FAINT

HARMONICS, INSTANTS = 6, 24  # ten change what is told by less than 1e-4 of it, up to 0.3 rad
ROUNDS = 20  # of which awkward scenes need 2 to 8 up to 0.3 rad
AGREED = 0.02  # last change of the harmonics, of what turning changes of them
PHASES = np.exp(-2j * np.pi * np.outer(np.arange(INSTANTS), np.arange(HARMONICS)) / INSTANTS)


class _Wave(NamedTuple):
    """What stays from round to round; all by harmonics."""

    omega: np.ndarray  # kω (nk,)
    Y: np.ndarray  # (nk, na, na)
    excitation: np.ndarray  # (nk, nb, 6)


def turning_effect(case: Case, law: JointLaw, response: Response, frame: Forces) -> float:
    """Relative error of any std, mean power or force of a response to one wave; UNTOLD where no round agrees."""
    wave, linear = _wave(case), np.zeros((HARMONICS, response.X.shape[1]), complex)
    linear[1] = response.X[0]
    Z = case.model.dynamic_stiffness(wave.omega, wave.Y) - 1j * wave.omega[:, None, None] * response.damping
    X, length = linear, case.model.length
    for _ in range(ROUNDS):
        more, wrench = _beyond(case, wave, X)
        before, X = X, linear.copy()
        X[0] += case.shift(more[0].real)
        X[1:] += np.linalg.solve(Z[1:], more[1:, :, None])[..., 0]
        change, whole = (np.abs(x * length).max() for x in (X - before, X - linear))
        if not np.isfinite(change):
            break
        if change <= AGREED * whole:
            force = case.channels.hinge_force
            motions = response_error(case.system, law, wave.omega[1:], linear[1:], X[1:])
            forces = force_error(case.system, force(_first(response.wrench)), force(wrench[1:]))
            return max(motions, forces, _of_frame(case, wave.omega[1:], frame, (X - linear)[1:]))
    return UNTOLD


def _of_frame(case: Case, omega: np.ndarray, frame: Forces, more: np.ndarray) -> float:
    """Largest relative change of the std of what the frame's steel bears, by further motions (nk, n)."""
    support, steel, P = case.system.support, case.channels.steel, more[:, : case.system.structure.omega.size]
    if support is None or support.forces is None or steel is None:
        return 0.0
    rate, borne = -1j * omega[:, None], case.carried(omega, P.T, np.zeros((P.shape[1], 1)))
    added = support.forces.whole(support.forces.of_motion(rate * P, rate**2 * P, borne))
    usual, exact = (
        frame.level + _at_instants(np.concatenate([np.zeros_like(lines[:1]), lines]))
        for lines in (_first(frame.lines), _first(frame.lines) + added)
    )
    pairs = [values for _, values in steel.channels(usual)], [values for _, values in steel.channels(exact)]
    for outputs, y in zip(pairs, (usual, exact), strict=True):
        axial, *bending = np.moveaxis(steel.compression(y), -1, 0)
        outputs.append(axial - np.hypot(*bending))
    return max(_changed(*pair) for pair in zip(*pairs, strict=True))


def _changed(usual: np.ndarray, exact: np.ndarray) -> float:
    """Largest relative change of a std of samples (m, …), but for those that are FAINT beside the largest."""
    std, true = usual.std(axis=0), exact.std(axis=0)
    return float(np.max(np.abs(true - std) / np.maximum(std, FAINT * std.max(initial=0.0)), initial=0.0))


def _first(lines: np.ndarray) -> np.ndarray:
    """Of one wave (1, …), as harmonics (HARMONICS - 1, …)."""
    return np.concatenate([lines, np.zeros((HARMONICS - 2, *lines.shape[1:]), complex)])


def _wave(case: Case) -> _Wave:
    omega, h = case.waves[0] * np.arange(HARMONICS), case.hydrodynamics
    Y = np.zeros((HARMONICS, *case.impedance.shape[1:]), complex)
    if h is not None:
        Y[1:] = impedance_anywhere(case.system, h, omega[1:])
    excitation = np.zeros((HARMONICS, *case.excitation.shape[1:]), complex)
    excitation[1] = case.excitation[0]
    return _Wave(omega, Y, excitation)


def _beyond(case: Case, wave: _Wave, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """N (nk, n), and all loads W on the floats (nk, nb, 6)."""
    body, _, rest = case.system.resting.value
    active, model = body.active, case.model
    states = [(-1j * wave.omega[:, None]) ** k * (X @ model.shape.T) for k in range(3)]
    z, dz, ddz = (_at_instants(x) for x in states)
    levers, at_rest = np.array([jacobian(body, rest + at) for at in z]), jacobian(body, rest)
    velocity = np.einsum("tbiz,tz->tbi", levers[:, :, active], dz)
    moved = _harmonics(velocity), np.einsum("biz,kz->kbi", at_rest[:, active], states[1])
    exact, usual = (_radiated(wave, V, active) for V in moved)
    still, wrench = balance(body, rest + z, dz, ddz)
    water = _at_instants(exact)
    load = still + np.einsum("tbiz,tbi->tz", levers, water)
    linear = sum(x @ slope.T for x, slope in zip((z, dz, ddz), -model.floats, strict=True))
    linear = linear + np.einsum("biz,tbi->tz", at_rest, _at_instants(usual))
    more = _harmonics(load - linear)
    more[0] -= case.loads_at_rest[0]
    return more @ model.shape, _harmonics(wrench + water)


def _radiated(wave: _Wave, V: np.ndarray, active: np.ndarray) -> np.ndarray:
    """Loads (nk, nb, 6) of the waves, and by what velocities V (nk, nb, na) radiate."""
    load = wave.excitation.copy()
    load[:, :, active] -= (wave.Y @ V.reshape(len(V), -1, 1)).reshape(V.shape)
    return load


def _at_instants(lines: np.ndarray) -> np.ndarray:
    """(INSTANTS, …) of harmonics (HARMONICS, …)."""
    return np.tensordot(PHASES, lines, 1).real


def _harmonics(x: np.ndarray) -> np.ndarray:
    """(HARMONICS, …) of what is so at the instants (INSTANTS, …)."""
    lines = np.tensordot(PHASES.conj().T, x, 1) * (2 / INSTANTS)
    lines[0] /= 2
    return lines
