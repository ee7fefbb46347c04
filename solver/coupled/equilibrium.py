"""Statics: the floats' loads anywhere, where a scene rests in still water, and how stiffly it is held there."""

import math
from typing import NamedTuple

import numpy as np

from solver.errors import SimulationFailed
from solver.kernels import whole_lean_kernel
from solver.multibody.bodies import (
    Bodies,
    Coordinates,
    Loads,
    PressureRoom,
    WaterLoads,
    new_motion,
    pressure_room,
)
from solver.multibody.minimal import loads, mass_matrix, move, pressures
from solver.multibody.zones import zones_at_rest

STEP = 1e-5  # of differences [m or rad]: what curvature and rounding leave is below 1e-8
SLOW = 1e-6  # of differences by rates [m/s or rad/s]: quadratic damping is nothing there, rounding 1e-9
SETTLED = 1e-12  # last change of a coordinate [m or rad]
WANDERS, IDLE = 1e-9, 10  # of a stride, and rounds in which it does not halve: on a soft structure rounding leaves that
UNHELD = 1e-6  # of the weights, that may be left out of balance
ANGLES = 100  # at which it is looked whether a joint is pushed back to its rest
ROUNDING = 2e-12  # of the weights, in loads that cancel
SOFT = 1e-10  # of the largest stiffness over inertia: what less of it tells is rounding
FALLS = -1e-4  # of the largest stiffness over inertia: below it a joint is pushed away
STRIDES = 500  # of the search for the floats' rest, in the water or out of it
ROUNDS = 100  # of floats and structure in turn; a float on a platform as soft as itself needs some twenty


class Balance(NamedTuple):
    """Of the floats at many states (...)."""

    load: np.ndarray  # JᵀW (..., nz)
    wrench: np.ndarray  # W (..., nb, 6), all loads on each
    jacobian: np.ndarray  # J (..., nb, 6, nz) motion of the reference points for unit coordinates
    rotation: np.ndarray  # (..., nb, 3, 3)


def balance(
    body: Bodies,
    z: np.ndarray,
    dz: np.ndarray | None = None,
    ddz: np.ndarray | None = None,
    field: np.ndarray | None = None,
    excitation: np.ndarray | None = None,
) -> Balance:
    """At z, ż, z̈ (..., nz), rest by default.

    field (see minimal.pressures) and excitation (nb, 6) of the waves, still water by default.
    """
    nz, nb, na = body.mechanism.size, body.axes.size, body.axes.size * body.active.size
    many = math.prod(z.shape[:-1])
    states = (np.zeros(z.shape) if x is None else x for x in (z, dz, ddz))
    z_, dz_, ddz_ = (np.ascontiguousarray(x).reshape(many, nz) for x in states)
    at = Coordinates(z_, dz_, ddz_, np.empty((2, nz), np.int64))
    if field is None:
        none = np.zeros(nb + 1, np.int64)
        body, field = body._replace(first_term=np.arange(nb + 1), first_along=none), np.zeros(2 * nb)
    excitation = np.zeros((nb, 6)) if excitation is None else excitation
    water = WaterLoads(pressure=np.empty((nb, 6)), since=np.zeros(nz), excitation=excitation, memory=np.zeros(na))
    out = Loads(np.empty(at.z.shape), *np.empty((2, many, nb, 6)))
    J, R = np.zeros((many, nb, 6, nz)), np.empty((many, nb, 3, 3))
    _balances(body, at, field, pressure_room(body), water, out, J, R)
    return Balance(*(part.reshape(*z.shape[:-1], *part.shape[1:]) for part in (out.residual, out.wrench, J, R)))


@whole_lean_kernel
def _balances(
    body: Bodies,
    states: Coordinates,
    field: np.ndarray,
    room: PressureRoom,
    water: WaterLoads,
    out: Loads,
    J: np.ndarray,
    R: np.ndarray,
) -> None:
    """Fill `out`, J and R (m, ...) at states (m, nz); room, water.pressure and the states' zones are scratch."""
    motion = new_motion(body)
    for i in range(len(states.z)):
        move(body, states.z[i], states.dz[i], motion)
        pressures(body, motion, field, room, water.pressure)
        zones_at_rest(body.law, states.z[i], states.zone)
        at = Coordinates(states.z[i], states.dz[i], states.ddz[i], states.zone)
        loads(body, at, motion, water, Loads(out.residual[i], out.wrench[i], out.external[i]))
        for b in range(body.axes.size):
            for r in range(3):
                for s in range(3):
                    R[i, b, r, s] = motion.rotation[b, r, s]
            for k in range(body.axes[b]):
                for r in range(6):
                    J[i, b, r, body.coordinate[b, k]] = motion.jacobian[b, r, k]


class Differences(NamedTuple):
    """Of the loads on the floats, by coordinates, rates and accelerations."""

    residual: np.ndarray  # (3, nz, nz) ∂JᵀW/∂(z, ż, z̈)
    wrench: np.ndarray  # (3, nb, 6, nz) ∂W/∂(z, ż, z̈)


def differences(body: Bodies, z: np.ndarray) -> Differences:
    """To either side of z, at rest in still water."""
    nz, sizes = z.size, np.array([STEP, SLOW, 1.0])  # linear in accelerations: any will do
    sides = np.zeros((3, 2, 3, nz, nz))  # z, ż, z̈; below and above; of which of the three; of which coordinate
    for k, size in enumerate(sizes):
        sides[k, :, k] = -size * np.eye(nz), size * np.eye(nz)
    found = balance(body, z + sides[0], sides[1], sides[2])
    residual, wrench = ((high - low).T / (2 * sizes) for low, high in (found.load, found.wrench))
    return Differences(
        *(np.ascontiguousarray(part) for part in (residual.transpose(2, 0, 1), wrench.transpose(3, 1, 0, 2)))
    )


def symmetric_stiffness(residual: np.ndarray) -> np.ndarray:
    """-∂JᵀW/∂z (nz, nz). Weight, buoyancy and springs have a potential: what is not symmetric is rounding."""
    return -(residual + residual.T) / 2


def weights(body: Bodies) -> float:
    """Of all floats on their radii of gyration, their arms and the way to their centres of gravity [N m]."""
    hinge = body.point[:, :1].sum(axis=1)  # the first axis's; without floats there is none
    lever = np.linalg.norm(body.reference - hinge, axis=1) + np.linalg.norm(body.cog, axis=1)
    gyration = np.sqrt(np.trace(body.inertia, axis1=1, axis2=2) / body.mass)
    return float(body.gravity * np.sum(body.mass * (gyration + lever)))


def equilibrium(
    body: Bodies, omega: np.ndarray, carrier: np.ndarray, steady: np.ndarray, stride: float
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates z (nz,) of the floats and amplitudes p (nm,) of modes of frequencies omega (nm,) at rest.

    Without waves. The structure bends under steady loads f (nm,) of its modes and what the floats put on it,
    p = (f + Sᵀ JᵀW)/ω² with carriers S p, and the floats follow it by at most `stride` [m or rad] at a time, in turn
    until nothing moves.
    """
    nc, nm = carrier.shape
    z, p = np.zeros(body.mechanism.size), np.zeros(nm)
    least, idle = np.inf, 0
    for _ in range(ROUNDS):
        before = z.copy()
        if z.size > nc:
            _settle_joints(body, z, nc, stride)
        p = (carrier.T @ balance(body, z)[0][:nc] + steady) / omega**2
        z[:nc] = carrier @ p
        moved = np.abs(z - before).max(initial=0.0)
        least, idle = (moved, 0) if moved < least / 2 else (least, idle + 1)
        if moved < SETTLED or (idle >= IDLE and moved < WANDERS * stride):
            return z, p
    raise SimulationFailed(
        f"no static equilibrium of floats and structure: they still move by {moved:.2g} m or rad after {ROUNDS} rounds;"
        " the structure is too soft for its loads, or for how stiffly floats are held beside it, as by too taut a line"
    )


def righting(body: Bodies, z: np.ndarray, i: int, most: float) -> tuple[float, float]:
    """How far the joint i may leave rest z (nz,) to either side, `most` at most, and is still pushed back to it.

    By weight, buoyancy in still water and springs, all other joints held: to where JᵀW changes its sign.
    """
    way = most * np.linspace(0, 1, ANGLES + 1)[1:]
    ends = []
    for side in (-1, 1):
        states = np.tile(z, (ANGLES, 1))
        states[:, i] += side * way
        lost = side * balance(body, states)[0][:, i] >= 0
        ends.append(float(way[lost.argmax()] if lost.any() else most))
    return -ends[0], ends[1]


def _settle_joints(body: Bodies, z: np.ndarray, nc: int, stride: float) -> None:
    """Bring the joints z[nc:] to rest, the carriers held.

    Newton's method on the potential energy, always downhill, so that what it finds is stable; in
    strides that a float follows in the water, halved where it oversteps. Given within one of an equilibrium from which
    they fall they stay, for that to be said: see natural.require_stable.
    """
    before = np.zeros(z.size - nc)
    for k in range(STRIDES):
        update, r, stiffness, weight = _downhill(body, z, nc)
        size = np.abs(update).max()
        if k == 0 and size < stride and stiffness.min() < FALLS * np.abs(stiffness).max():
            return
        if min(size, stride) < SETTLED:
            break
        if update @ before < 0:
            stride /= 2
        before = update * min(1.0, stride / size)
        z[nc:] += before
    if not np.all(np.abs(r) <= UNHELD * weight):
        where, left = (", ".join(f"{value:.3g}" for value in values) for values in (z[nc:], r))
        raise SimulationFailed(
            f"no static equilibrium in still water near rest: joints at {where} after {k + 1} steps, and nothing holds"
            f" their loads of {left}"
        )


def _downhill(body: Bodies, z: np.ndarray, nc: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Newton's step of the joints (nj,) with all curvatures taken as positive, the load there (nj,), these over
    inertia (nj,), by which metres and radians compare, and what all floats weigh on each axis (nj,) [N or N m].
    """
    n, steps = z.size, STEP * np.eye(z.size)
    load = balance(body, np.concatenate([z - steps, z + steps, z[None]]))[0]
    r, tangent = load[-1, nc:], symmetric_stiffness((load[n : 2 * n] - load[:n]) / (2 * STEP))
    motion, M = new_motion(body), np.zeros((n, n))
    move(body, z, np.zeros(n), motion)
    mass_matrix(body._replace(added_mass=np.zeros_like(body.added_mass)), motion, M)
    size = np.sqrt(np.diag(M)[nc:])
    value, vector = np.linalg.eigh(tangent[nc:, nc:] / np.outer(size, size))
    # Nothing holds a free float in surge or yaw, and nothing pushes it; else rounding is what is left of weights that
    # buoyancy cancels, whatever springs others have: what is slower than an hour is not told from it.
    weight = body.gravity * np.sqrt(body.mass.sum()) * size
    held = np.abs(value) > ROUNDING / STEP * (weight / size**2 @ vector**2) + SOFT * np.abs(value).max()
    update = vector[:, held] @ (vector[:, held].T @ (r / size) / np.abs(value[held])) / size
    return update, r, value, weight
