"""The linear response of a scene in its own sea, drag linearised by the water's own velocity."""

import math
from typing import NamedTuple

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import impedance, linear_model
from solver.coupled.moving import force_of_waves, waves_on_floats
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import absorbing


def absorbs(system: System, law: JointLaw) -> np.ndarray:
    """Of which coordinates (n,) the law takes power: of joints alone."""
    modes, carriers = system.structure.omega.size, system.structure.carrier.shape[0]
    return np.concatenate([np.zeros(modes, bool), absorbing(law)[carriers:]])


class InWaves(NamedTuple):
    """The response, wave by wave."""

    X: np.ndarray  # (nw, n) of the coordinates
    drag: np.ndarray  # (nw, nd ns) the water's at the stations [N]
    mean: np.ndarray  # (nd ns,) of that drag


def in_waves(system: System, h: Hydrodynamics | None) -> InWaves:
    """Of a scene."""
    omega, station, (mean, resistance) = system.scene.sea.omega, system.structure.station, system.drag_of_water
    drag = linear_drag.by_station(resistance, system.water_at_stations)
    flat = drag.reshape(len(drag), math.prod(station.shape[1:]))
    force = force_of_waves(system, h, flat @ station.reshape(len(station), flat.shape[1]).T)
    return InWaves(linear_model(system).response(omega, impedance(system, h, omega), force), flat, mean.T.ravel())


def carried(system: System, h: Hydrodynamics | None, X: np.ndarray) -> np.ndarray:
    """Load (nw, nc) of the floats on the carriers in that response X (nw, n)."""
    model, omega = linear_model(system), system.scene.sea.omega
    none = np.zeros((omega.size, len(model.active)))
    moved = model.carried(omega, X @ model.shape.T, impedance(system, h, omega), none)
    return moved + waves_on_floats(system, h)[:, : moved.shape[1]]


def drag_damping(system: System) -> np.ndarray:
    """Of the modes (nm, nm), by drag linearised so."""
    station = system.structure.station
    return np.asarray(np.einsum("mds,sde,nes->mn", station, system.drag_of_water[1], station, optimize=True))
