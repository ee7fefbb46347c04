"""The linear response of a scene in its own sea, drag linearised by the water's own velocity."""

import math

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import impedance, linear_model
from solver.coupled.modal import Structure
from solver.coupled.moving import force_of_waves
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.lines import real_by_complex
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import absorbing


def absorbs(system: System, law: JointLaw) -> np.ndarray:
    """Of which coordinates (n,) the law takes power: of joints alone."""
    modes, carriers = system.structure.omega.size, system.structure.carrier.shape[0]
    return np.concatenate([np.zeros(modes, bool), absorbing(law)[carriers:]])


def in_waves(system: System, h: Hydrodynamics | None) -> tuple[np.ndarray, np.ndarray]:
    """X (nw, n) of its coordinates, and the water's drag (nw, nd ns) at the stations [N]."""
    support, omega = system.support, system.scene.sea.omega
    station, water = system.structure.station, _beside(system)
    drag = np.zeros(water.shape, complex)
    if support is not None and drag.size:
        drag = system.structure.drag * linear_drag.by_station(_equivalent(support.stream, water), water)
    flat = drag.reshape(len(drag), math.prod(station.shape[1:]))
    Y = impedance(system, h, omega) if h is not None else np.zeros((omega.size, 0, 0))
    force = force_of_waves(system, h, flat @ station.reshape(len(station), flat.shape[1]).T)
    return linear_model(system).response(omega, Y, force), flat


def drag_damping(system: System) -> np.ndarray:
    """Of the modes (nm, nm), by drag linearised so."""
    frame, support, nm = system.structure, system.support, system.structure.omega.size
    if support is None or not frame.drag.any():
        return np.zeros((nm, nm))
    K = frame.drag[:, None, None] * _equivalent(support.stream, _beside(system))
    return np.asarray(np.einsum("mds,sde,nes->mn", frame.station, K, frame.station, optimize=True))


def _beside(system: System) -> np.ndarray:
    """Velocity (nw, nd, ns) of the waves' water at the stations."""
    station = system.structure.station
    return np.asarray(system.rows[system.layout.station].T.reshape(system.scene.sea.omega.size, *station.shape[1:]))


def carried(frame: Structure, to_carriers: np.ndarray, w: np.ndarray, P: np.ndarray, load: np.ndarray) -> np.ndarray:
    """What the modes' equation leaves to the floats, Sᵀ h = (-ω² - 2iζω_mω + ω_m²) P - load: h (nw, nc).

    At frequencies w (nw,), of P and load (nm, nw); to_carriers (nm, nc): from loads on the modes to those behind them.
    """
    own, slope = frame.omega[:, None], frame.damping[:, None]
    force = (own**2 - w**2 - 2j * slope * own * w) * P - load
    return real_by_complex(to_carriers.T, force).T


def _equivalent(stream: np.ndarray, water: np.ndarray) -> np.ndarray:
    """K (ns, nd, nd) [m/s] of the waves' own velocity (nw, nd, ns) in a current; those without height are none."""
    water = water[np.any(water, axis=(1, 2))]
    if not stream.any():
        return linear_drag.of_lines(water)
    return linear_drag.of_parts_in(stream, linear_drag.parts(water))[1]
