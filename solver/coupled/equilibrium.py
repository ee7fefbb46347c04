"""Statics: the floats' loads anywhere, where a scene rests in still water, and how stiffly it is held there."""

from typing import NamedTuple

import numpy as np

from solver.coupled.modal import Structure
from solver.errors import SimulationFailed
from solver.multibody.minimal import (
    Bodies,
    Coordinates,
    Loads,
    WaterLoads,
    loads,
    move,
    new_motion,
    pressure_room,
    pressures,
)

STEP = 1e-5  # of differences [m or rad]: what curvature and rounding leave is below 1e-8
SLOW = 1e-6  # of differences by rates [m/s or rad/s]: quadratic damping is nothing there, rounding 1e-9
SETTLED = 1e-12  # last change of a coordinate [m or rad]
UNHELD = 1e-6  # of the weights [N m], that may be left out of balance
STRIDES = 500  # of the search for the floats' rest, in the water or out of it
ROUNDS = 100  # of floats and structure in turn; a float on a platform as soft as itself needs some twenty


def balance(
    body: Bodies,
    z: np.ndarray,
    dz: np.ndarray | None = None,
    ddz: np.ndarray | None = None,
    field: np.ndarray | None = None,
    excitation: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """JᵀW (nz,) of the floats and W (nb, 6), all loads on each, at z, ż, z̈ (nz,), rest and still water by default."""
    nz, nb, na = body.mechanism.size, body.axes.size, body.axes.size * body.active.size
    still, motion = np.zeros(nz), new_motion(body)
    dz, ddz = (still if x is None else x for x in (dz, ddz))
    field = np.zeros((nb, 2, 1)) if field is None else field
    excitation = np.zeros((nb, 6)) if excitation is None else excitation
    move(body, z, dz, motion)
    water = WaterLoads(pressure=np.empty((nb, 6)), since=still, excitation=excitation, memory=np.zeros(na))
    out = Loads(np.empty(nz), *np.empty((2, nb, 6)))
    pressures(body, motion, field, pressure_room(body), water.pressure)
    loads(body, Coordinates(z, dz, ddz), motion, water, out)
    return out.residual, out.wrench


class Differences(NamedTuple):
    """Of the loads on the floats, by coordinates, rates and accelerations."""

    residual: np.ndarray  # (3, nz, nz) ∂JᵀW/∂(z, ż, z̈)
    wrench: np.ndarray  # (3, nb, 6, nz) ∂W/∂(z, ż, z̈)


def differences(body: Bodies, z: np.ndarray) -> Differences:
    """To either side of z, at rest in still water."""
    nz, nb = z.size, body.axes.size
    out = Differences(np.empty((3, nz, nz)), np.empty((3, nb, 6, nz)))
    for k, size in enumerate((STEP, SLOW, 1.0)):  # linear in accelerations: any will do
        for j in range(nz):
            sides = []
            for sign in (-1, 1):
                at = np.zeros((3, nz))
                at[k, j] = sign * size
                sides.append(balance(body, z + at[0], at[1], at[2]))
            for part, low, high in zip(out, *sides, strict=True):
                part[k, ..., j] = (high - low) / (2 * size)
    return out


def symmetric_stiffness(residual: np.ndarray) -> np.ndarray:
    """-∂JᵀW/∂z (nz, nz). Weight, buoyancy and springs have a potential: what is not symmetric is rounding."""
    return -(residual + residual.T) / 2


def tangent(body: Bodies, z: np.ndarray) -> np.ndarray:
    """Stiffness (nz, nz) at z, at rest in still water."""
    sides = [[balance(body, z + sign * step)[0] for step in STEP * np.eye(z.size)] for sign in (-1, 1)]
    low, high = (np.reshape(side, (z.size, z.size)) for side in sides)
    return symmetric_stiffness((high - low) / (2 * STEP))


def weights(body: Bodies) -> float:
    """Of all floats on a metre, on their arms and on the way to their centres of gravity [N m]."""
    hinge = body.point[:, :1].sum(axis=1)  # the first axis's; without floats there is none
    lever = np.linalg.norm(body.reference - hinge, axis=1) + np.linalg.norm(body.cog, axis=1)
    return float(body.gravity * np.sum(body.mass * (1 + lever)))


def equilibrium(body: Bodies, frame: Structure, stride: float) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates z (nz,) of the floats and amplitudes p (nm,) of the modes at rest in still water.

    The structure bends under what the floats put on it, p = Sᵀ JᵀW/ω² with carriers S p, and the floats
    follow it by at most `stride` [m or rad] at a time, in turn until nothing moves.
    """
    nc, nm = frame.carrier.shape
    z, p = np.zeros(body.mechanism.size), np.zeros(nm)
    for _ in range(ROUNDS):
        before = z.copy()
        if z.size > nc:
            _settle_joints(body, z, nc, stride)
        p = frame.carrier.T @ balance(body, z)[0][:nc] / frame.omega**2
        z[:nc] = frame.carrier @ p
        if np.abs(z - before).max(initial=0.0) < SETTLED:
            return z, p
    raise SimulationFailed(f"no static equilibrium of floats and structure after {ROUNDS} rounds: it is too soft")


def _settle_joints(body: Bodies, z: np.ndarray, nc: int, stride: float) -> None:
    """Bring the joints z[nc:] to rest, the carriers held.

    Newton's method on the potential energy, always downhill, so that what it finds is stable; in
    strides that a float follows in the water, halved where it oversteps.
    """
    before = np.zeros(z.size - nc)
    for _ in range(STRIDES):
        update, r = _downhill(body, z, nc)
        size = np.abs(update).max()
        if min(size, stride) < SETTLED:
            break
        if update @ before < 0:
            stride /= 2
        before = update * min(1.0, stride / size)
        z[nc:] += before
    if not np.abs(r).max() <= UNHELD * weights(body):
        where = ", ".join(f"{value:.3g}" for value in z[nc:])
        raise SimulationFailed(
            f"no static equilibrium in still water near rest: joints at {where} after {STRIDES} steps"
        )


def _downhill(body: Bodies, z: np.ndarray, nc: int) -> tuple[np.ndarray, np.ndarray]:
    """Newton's step of the joints (nj,) with all curvatures taken as positive, and the load there (nj,)."""
    r = balance(body, z)[0][nc:]
    value, vector = np.linalg.eigh(tangent(body, z)[nc:, nc:])
    # Nothing holds a free float in surge or yaw, and nothing pushes it; rounding is 1e-7 of the rest.
    held = np.abs(value) > 1e-6 * np.abs(value).max()
    return vector[:, held] @ (vector[:, held].T @ r / np.abs(value[held])), r
