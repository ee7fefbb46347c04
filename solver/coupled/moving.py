"""A scene in its own sea to first order: what pushes it, and how its joints' laws damp what moves."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import LinearModel, impedance, jacobian, linear_model
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import DOFS, Hydrodynamics
from solver.hydrodynamics.bem.incident import Sea
from solver.hydrodynamics.bem.mean_hull import froude_krylov
from solver.keys import shared
from solver.lines import lengths, squares
from solver.multibody.linearised import beyond_rest, damping_at_rest, damping_of_lines
from solver.multibody.of_axes import bent, drag, latch_loads, room
from solver.sea.field import wave_field

KNOWN = 8  # models that a process keeps
AGREED = 1e-2  # of a damping that errors are estimated with
ROUNDS = 40  # an axis that friction just stops is nearly held by then
HELD = 1e-4  # of the largest rate that an axis had: friction does not let it move
BRAKE = 1e4  # times what its mass bears: damping that holds an axis
TIGHT, TINY = 1e-2, 1e-30  # of how far waves move an axis: what one that rests on its stop has
SOFT = 1e-2  # and what that of end stops begins with


@lru_cache(maxsize=KNOWN)
def moving_model(system: System, h: Hydrodynamics | None) -> LinearModel:
    """The linear model, its joints damped by what quadratic damping and bent laws take from the rates that it has in
    the scene's sea: friction may hold an axis that the tangent at rest leaves free, and a limit let one go. An axis is
    held that waves do not tear off its latch, and damped until √2 std is within its end stops."""
    model, law, sea = linear_model(system), system.bodies.law, system.scene.sea
    quadratic = drag(law)
    if not (bent(law) | (quadratic > 0)).any() or not sea.amplitude.any():
        return model
    nm, nc = system.structure.omega.size, system.structure.carrier.shape[0]
    met = np.abs(sea.amplitude) > 0
    omega, force, rest = sea.omega[met], force_of_waves(system, h)[met], damping_at_rest(law)
    Y, inertia = impedance(system, h, omega), omega.max() * np.diag(model.mass)[nm:]
    latch = lengths(force[:, nm:].T) < latch_loads(law)[nc:]  # 0 where there is none
    free, stops, first = room(law, system.equilibrium[0])[nc:], np.zeros(len(inertia)), SOFT * inertia
    moving, more, size, least = model, *np.zeros((3, nc + len(model.mass) - nm))
    against = size  # of the rates that quadratic damping is taken for
    for _ in range(ROUNDS):
        X = moving.response(omega, Y, force)[:, nm:]
        rates, reach = omega[:, None] * X, lengths(X.T)
        size = np.concatenate([np.zeros(nc), lengths(rates.T)])
        least = np.maximum(least, HELD * size)
        # At a resonance rates go as one over their damping: from one round to the next they would turn over and over.
        against = np.sqrt(against * size) if against.any() else size
        before, more = more, beyond_rest(law, damping_of_lines(law, np.maximum(size, least), single=omega.size == 1))
        rates *= np.divide(against, size, out=np.ones(size.size), where=size > 0)[nc:]
        more[nc:] += quadratic[nc:] * linear_drag.of_lines(rates[:, None])[:, 0, 0]
        stops = np.maximum((stops + first) * reach / np.maximum(free, TIGHT * reach + TINY) - first, 0.0)
        more[nc:] += stops + BRAKE * inertia * latch
        if np.all(np.abs(more - before) <= AGREED * np.abs(rest + more)):
            break
        moving = model.damped(more[nc:])
    return moving


def along_waves(system: System, h: Hydrodynamics) -> np.ndarray:
    """How each wave swings each float's reference point along the waves [m], rows (nb, nw)."""
    omega, bodies = system.scene.sea.omega, system.bodies
    model = moving_model(system, h)
    X = model.response(omega, impedance(system, h, omega), force_of_waves(system, h))
    J = jacobian(bodies, system.equilibrium[0])[:, :2]
    way: np.ndarray = np.einsum("d,bdz->bz", bodies.wave_direction, J) @ model.shape @ X.T
    return way


def force_of_waves(system: System, h: Hydrodynamics | None, drag: np.ndarray | float = 0.0) -> np.ndarray:
    """F (nw, n) of the scene's sea, with linear pressure, and drag (nw, nm) on the modes."""
    force: np.ndarray = waves_on_floats(system, h) @ linear_model(system).shape
    modal = system.rows[system.layout.modal]
    force[:, : len(modal)] += modal.T + drag
    return force


def waves_on_floats(system: System, h: Hydrodynamics | None) -> np.ndarray:
    """The part of it on the floats, along their coordinates z (nw, nz)."""
    if h is None:
        return _of_incident_waves(system)
    pushed = excitation(system, h, system.scene.sea.omega) * system.scene.sea.amplitude[:, None]
    return np.asarray(pushed @ linear_model(system).radiating)


@lru_cache(maxsize=KNOWN)
def _of_incident_waves(system: System) -> np.ndarray:
    """The same of a scene without coefficients: pressure is integrated over the hulls, here as they rest."""
    scene, (water, sea) = system.scene, (system.scene.water, system.scene.sea)
    still = Sea(depth=water.depth, density=water.density, gravity=water.gravity, heading=sea.heading)
    met = (sea.amplitude != 0) & (scene.settings.froude_krylov != "none")
    six = np.zeros((met.size, len(scene.floats), 6), complex)
    if met.any() and scene.floats:
        hulls, centres = [f.hull for f in scene.floats], np.array([f.centre for f in scene.floats])
        per_amplitude = froude_krylov(hulls, centres, DOFS, still, sea.omega[met])
        six[met] = (per_amplitude * sea.amplitude[met, None]).reshape(-1, len(hulls), 6)
    return shared(np.tensordot(six, jacobian(system.bodies, system.equilibrium[0]), axes=2))


def excitation(system: System, h: Hydrodynamics, omega: np.ndarray) -> np.ndarray:
    """Linear force of waves per amplitude (nw, na) on what radiates, but for what the scene leaves out."""
    s = system.scene.settings
    kinds = ["diffraction"] * s.diffraction + ["froude_krylov"] * (s.froude_krylov != "none")
    force = np.zeros((omega.size, len(linear_model(system).active)), complex)
    for kind in kinds:
        force += h.excitation(omega, kind)
    return force


class _Waterplane(NamedTuple):
    """Places of the floats at still water, five of each: its middle, and its sides along x and y."""

    lift: np.ndarray  # (5nb, nz) upwards by unit coordinates
    surface: np.ndarray  # (nw, 5nb) of the scene's waves


@lru_cache(maxsize=KNOWN)
def _waterplane(system: System) -> _Waterplane:
    """The sides of the rectangle with the waterplane's area and second moments; of a hull under water its middle."""
    scene, (body, _, rest) = system.scene, system.resting.value
    field = wave_field(scene.sea, scene.water.depth, scene.water.gravity, scene.current)
    planes = np.array([f.hull.waterplane for f in scene.floats])
    area, moments, second = planes[:, :1], planes[:, 1:3], planes[:, [3, 5]]
    middle, square = (np.divide(m, area, out=np.zeros(m.shape), where=area > 0) for m in (moments, second))
    half = np.sqrt(3 * (square - middle**2).clip(min=0.0))
    aside = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    places = middle[:, None] + aside * half[:, None]  # (nb, 5, 2)
    J = jacobian(body, rest)[:, None]
    lift = J[:, :, 2] + J[:, :, 3] * places[..., 1:] - J[:, :, 4] * places[..., :1]
    centres = np.array([f.centre for f in scene.floats])[:, None] + np.pad(places, ((0, 0), (0, 0), (0, 1)))
    return _Waterplane(lift.reshape(5 * len(planes), rest.size), field.elevation(centres.reshape(-1, 3)).T)


def surface_past(system: System, met: np.ndarray, Z: np.ndarray) -> np.ndarray:
    """By how much the surface moves past each float's middle or one of its sides (nb,) [m] in a third of waves, or in
    the one: of those `met` (nw,), which move the floats' coordinates by lines Z (nw, nz)."""
    if not system.scene.floats:
        return np.zeros(0)
    at = _waterplane(system)
    past = squares(Z @ at.lift.T - at.surface[met]).sum(axis=0).reshape(-1, 5)
    return np.sqrt(past.max(axis=1) * (1 if len(Z) == 1 else 2))
