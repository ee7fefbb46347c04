"""Statics: the floats' loads anywhere, where a scene rests in still water, and how stiffly it is held there."""

from typing import TYPE_CHECKING

import numpy as np

from solver.errors import SimulationFailed
from solver.multibody.minimal import loads, move, new_motion, pressures

if TYPE_CHECKING:
    from solver.system import System

STEP = 1e-5  # of differences [m or rad]: what curvature and rounding leave is below 1e-8
SETTLED = 1e-12  # last change of a coordinate [m or rad]
STRIDES = 500  # of the search for the floats' rest, in the water or out of it
ROUNDS = 100  # of floats and structure in turn; a float on a platform as soft as itself needs some twenty


def balance(system: "System", z, dz=None, ddz=None, field=None, excitation=None) -> tuple[np.ndarray, np.ndarray]:
    """JᵀW (nz,) of the floats and W (nb, 6), all loads on each, at z, ż, z̈ (nz,), rest and still water if not given."""
    body = system.bodies
    nz, nb, na = body.damping.size, body.axes.size, body.axes.size * body.active.size
    still, motion = np.zeros(nz), new_motion(body)
    dz, ddz = (still if x is None else x for x in (dz, ddz))
    field = np.zeros((nb, 2, 1)) if field is None else field
    excitation = np.zeros((nb, 6)) if excitation is None else excitation
    move(body, z, dz, motion)
    pressure, out, (wrench, external) = np.empty((nb, 6)), np.empty(nz), np.empty((2, nb, 6))
    pressures(body, motion, field, pressure)
    loads(body, z, dz, ddz, motion, pressure, still, excitation, np.zeros(na), out, wrench, external)
    return out, wrench


def tangent(system: "System", z: np.ndarray) -> np.ndarray:
    """-∂JᵀW/∂z (nz, nz) at z, at rest in still water."""
    K = np.empty((z.size, z.size))
    for j, step in enumerate(STEP * np.eye(z.size)):
        K[:, j] = (balance(system, z - step)[0] - balance(system, z + step)[0]) / (2 * STEP)
    # Weight, buoyancy and springs have a potential: what is not symmetric is the differences' rounding.
    return (K + K.T) / 2


def equilibrium(system: "System") -> tuple[np.ndarray, np.ndarray]:
    """Coordinates z (nz,) of the floats and amplitudes p (nm,) of the modes at rest in still water.

    The structure bends under what the floats put on it, p = Sᵀ JᵀW/ω² with carriers S p, and the floats
    follow it, in turn until nothing moves.
    """
    frame = system.structure
    nc, nm = frame.carrier.shape
    z, p = np.zeros(system.bodies.damping.size), np.zeros(nm)
    for _ in range(ROUNDS):
        before = z.copy()
        _settle_joints(system, z)
        p = frame.carrier.T @ balance(system, z)[0][:nc] / frame.omega**2
        z[:nc] = frame.carrier @ p
        if np.abs(z - before).max(initial=0.0) < SETTLED:
            return z, p
    raise SimulationFailed(f"no static equilibrium of floats and structure after {ROUNDS} rounds: it is too soft")


def _settle_joints(system: "System", z: np.ndarray) -> None:
    """Bring the joints z[nc:] to rest, the carriers held.

    Newton's method on the potential energy, always downhill, so that what it finds is stable; in
    strides that a float follows in the water, halved where it oversteps.
    """
    nc = system.structure.carrier.shape[0]
    if z.size == nc:
        return
    before, stride = np.zeros(z.size - nc), 0.1 * min(1.0, *(f.hull.size for f in system.scene.floats))
    for _ in range(STRIDES):
        update, r = _downhill(system, z)
        size = np.abs(update).max()
        if min(size, stride) < SETTLED:
            break
        if update @ before < 0:
            stride /= 2
        before = update * min(1.0, stride / size)
        z[nc:] += before
    if not np.abs(r).max() <= 1e-6 * system.weights:
        where = ", ".join(f"{value:.3g}" for value in z[nc:])
        raise SimulationFailed(f"no static equilibrium in still water near rest: joints at {where} after {STRIDES} steps")


def _downhill(system: "System", z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Newton's step of the joints (nj,) with all curvatures taken as positive, and the load there (nj,)."""
    nc = system.structure.carrier.shape[0]
    r = balance(system, z)[0][nc:]
    value, vector = np.linalg.eigh(tangent(system, z)[nc:, nc:])
    # Nothing holds a free float in surge or yaw, and nothing pushes it; rounding is 1e-7 of the rest.
    held = np.abs(value) > 1e-6 * np.abs(value).max()
    return vector[:, held] @ (vector[:, held].T @ r / np.abs(value[held])), r
