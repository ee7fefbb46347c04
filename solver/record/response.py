"""The linear response of a scene in its own sea, drag linearised by the water's own velocity."""

from functools import lru_cache

import numpy as np

from solver.coupled import linear_drag
from solver.coupled.linear import LinearModel, impedance, linear_model, wave_force
from solver.coupled.modal import Structure
from solver.coupled.system import System
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.lines import lengths, real_by_complex
from solver.multibody.joint_law import JointLaw
from solver.multibody.linearised import beyond_rest, damping_at_rest, damping_of_lines
from solver.multibody.of_axes import absorbing, bent, drag

KNOWN = 8  # models that a process keeps
AGREED = 1e-2  # of a damping that errors are estimated with
ROUNDS = 40  # an axis that friction just stops is nearly held by then
HELD = 1e-4  # of the largest rate that an axis had: friction does not let it move


def absorbs(system: System, law: JointLaw) -> np.ndarray:
    """Of which coordinates (n,) the law takes power: of joints alone."""
    modes, carriers = system.structure.omega.size, system.structure.carrier.shape[0]
    return np.concatenate([np.zeros(modes, bool), absorbing(law)[carriers:]])


@lru_cache(maxsize=KNOWN)
def moving_model(system: System, h: Hydrodynamics) -> LinearModel:
    """The linear model, its joints damped by what quadratic damping and bent laws take from the rates that it has in
    the scene's sea: friction may hold an axis that the tangent at rest leaves free, and a limit let one go."""
    model, law, sea = linear_model(system), system.bodies.law, system.scene.sea
    quadratic = drag(law)
    if not (bent(law) | (quadratic > 0)).any() or not sea.amplitude.any():
        return model
    nm, nc = system.structure.omega.size, system.structure.carrier.shape[0]
    one = np.count_nonzero(sea.amplitude) == 1
    Y, force, rest = impedance(system, h, sea.omega), force_of_waves(system, h), damping_at_rest(law)
    moving, more, size, least = model, *np.zeros((3, nc + len(model.mass) - nm))
    against = size  # of the rates that quadratic damping is taken for
    for _ in range(ROUNDS):
        rates = sea.omega[:, None] * moving.response(sea.omega, Y, force)[:, nm:]
        size = np.concatenate([np.zeros(nc), lengths(rates.T)])
        least = np.maximum(least, HELD * size)
        # At a resonance rates go as one over their damping: from one round to the next they would turn over and over.
        against = np.sqrt(against * size) if against.any() else size
        before, more = more, beyond_rest(law, damping_of_lines(law, np.maximum(size, least), single=one))
        rates *= np.divide(against, size, out=np.ones(size.size), where=size > 0)[nc:]
        more[nc:] += quadratic[nc:] * linear_drag.of_lines(rates[:, None])[:, 0, 0]
        if np.all(np.abs(more - before) <= AGREED * np.abs(rest + more)):
            break
        moving = model.damped(more[nc:])
    return moving


def in_waves(system: System, h: Hydrodynamics | None) -> tuple[np.ndarray, np.ndarray]:
    """X (nw, n) of its coordinates, and the water's drag (nw, nd ns) at the stations [N]."""
    support, omega = system.support, system.scene.sea.omega
    station, water = system.structure.station, _beside(system)
    drag = np.zeros(water.shape, complex)
    if support is not None and drag.size:
        drag = system.structure.drag * linear_drag.by_station(_equivalent(support.stream, water), water)
    flat = drag.reshape(len(drag), station[0].size)
    Y = impedance(system, h, omega) if h is not None else np.zeros((omega.size, 0, 0))
    force = force_of_waves(system, h, flat @ station.reshape(len(station), station[0].size).T)
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


def force_of_waves(system: System, h: Hydrodynamics | None, drag: np.ndarray | float = 0.0) -> np.ndarray:
    """F (nw, n) of the scene's sea, with linear pressure, and drag (nw, nm) on the modes."""
    sea = system.scene.sea
    modal = system.rows[system.layout.modal] + np.transpose(drag)
    return wave_force(linear_model(system), excitation(system, h, sea.omega) * sea.amplitude[:, None], modal)


def excitation(system: System, h: Hydrodynamics | None, omega: np.ndarray) -> np.ndarray:
    """Linear force of waves per amplitude (nw, na) on what radiates, but for what the scene leaves out."""
    s = system.scene.settings
    kinds = ["diffraction"] * s.diffraction + ["froude_krylov"] * (s.froude_krylov != "none")
    force = np.zeros((omega.size, len(linear_model(system).active)), complex)
    if h is not None:
        for kind in kinds:
            force += h.excitation(omega, kind)
    return force


def _equivalent(stream: np.ndarray, water: np.ndarray) -> np.ndarray:
    """K (ns, nd, nd) [m/s] of the waves' own velocity (nw, nd, ns) in a current."""
    if not stream.any():
        return linear_drag.of_lines(water)
    return linear_drag.of_parts_in(stream, linear_drag.parts(water))[1]
