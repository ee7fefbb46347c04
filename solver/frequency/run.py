"""One scene in, one record out, without a march."""

from collections.abc import Iterator

import numpy as np

from solver.balance import warnings
from solver.coupled.equilibrium import balance
from solver.coupled.forces import Forces
from solver.coupled.natural import require_stable, system_modes
from solver.coupled.system import System, prepare
from solver.errors import InputError
from solver.frequency import gaussian
from solver.frequency.response import Response, respond
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, seabed_error
from solver.record.audit import coefficient_effects
from solver.record.bound import above
from solver.record.recorder import Channels, Record
from solver.scene import Scene
from solver.statistics import STATISTICS

LEFT_OUT = "displacement_envelope, stress_envelope"  # how the nodes' motions go together in time


def simulate_frequency(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Record:
    """Statistics of the linear model's stationary response over `duration`; series and envelopes it does not have."""
    if not scene.sea.amplitude.any():
        raise InputError("settings.method", "frequency", "needs waves: a decay is a matter of the time domain")
    system = prepare(scene, hydrodynamics)
    require_stable(system)
    response, channels = respond(system, hydrodynamics), Channels(scene, system.support)
    tables = dict(_tables(system, response, channels))
    _, effect = coefficient_effects(system, hydrodynamics)
    attrs: dict[str, float | str] = {
        "estimated_error": effect,
        "mesh_effect": effect,
        "seabed_error": seabed_error(hydrodynamics),
        "drag_rounds": response.rounds,
        "buckling_factor": system.support.buckling_factor if system.support else np.inf,
        "unmet": "",
        "skipped": f"time: a linear model in the frequency domain has no {LEFT_OUT}",
        **scene.sea.parameters(),
    }
    power = tables["absorbed_power"][:, STATISTICS.index("mean")] if scene.floats else np.zeros(0)
    if notes := (*warnings(scene), *above(scene, power)):
        attrs["warnings"] = "; ".join(notes)
    rao = None
    if scene.settings.rao and scene.floats:
        rao = np.full((scene.sea.omega.size, channels.owner.size), np.nan, complex)
        rao[np.abs(scene.sea.amplitude) > 0] = _joints(system, response)
    modes = system_modes(system, hydrodynamics)
    counted = None
    if channels.steel is not None and channels.steel.counts:
        counted = channels.steel.expected(_forces(system, response, channels.steel.forces)[1], response.omega)
    return channels.record(tables, attrs, modes=modes, rao=rao, counted=counted or ({}, ()))


def _joints(system: System, response: Response) -> np.ndarray:
    """Lines of the joints' axes (nw, nj)."""
    return response.Z[:, system.structure.carrier.shape[0] :]


def _tables(system: System, response: Response, channels: Channels) -> Iterator[tuple[str, np.ndarray]]:
    scene, omega, duration = system.scene, response.omega, system.scene.settings.duration
    (z, p), amplitude = system.equilibrium, scene.sea.amplitude

    def table(mean: np.ndarray, lines: np.ndarray) -> np.ndarray:
        return gaussian.table(mean, lines, omega, duration)

    yield "wave_elevation", table(np.zeros(()), amplitude[np.abs(amplitude) > 0])
    if scene.floats:
        nc, joints = system.structure.carrier.shape[0], _joints(system, response)
        means = dict(channels.motions(z[None, nc:]))
        for name, lines in channels.motions(joints):
            yield name, table(means[name][0], lines)
        pto, rates = response.pto, -1j * omega[:, None] * joints
        owned = [channels.owner == b for b in range(len(scene.floats))]
        yield "absorbed_power", np.array([gaussian.power_table(pto[i], rates[:, i], omega, duration) for i in owned])
        if "pto_stroke" in scene.settings.outputs:
            yield "pto_rate", table(np.zeros(()), channels.by_axis(rates))
        if "pto_force" in scene.settings.outputs:
            k = np.concatenate([f.per_axis("pto_stiffness") for f in scene.floats])
            mean, lines = channels.by_axis(-(k * z[nc:])[None])[0], channels.by_axis(-(pto * rates + k * joints))
            yield "pto_force", table(mean, lines)
        at_rest = channels.hinge_force(balance(system.bodies, z)[1][None])[0]
        yield "hinge_force", table(at_rest, channels.hinge_force(response.wrench))
    if channels.legs is not None:
        tops, X = channels.legs.tops, response.X[:, : p.size]
        yield "top_displacement", table(np.tensordot(p, tops, axes=1), np.tensordot(X, tops, axes=1))
    if channels.steel is None:
        return
    level, lines = _forces(system, response, channels.steel.forces)
    if channels.legs is not None:
        means, feet = channels.steel.compression(level)[0], channels.steel.compression(lines)
        tables = [gaussian.compression_table(means[i], feet[:, i], omega, duration) for i in range(len(means))]
        yield "bottom_stress", np.array(tables)
    means = dict(channels.steel.channels(level))
    for name, values in channels.steel.channels(lines):
        yield name, table(means[name][0], values)


def _forces(system: System, response: Response, forces: Forces) -> tuple[np.ndarray, np.ndarray]:
    """The frame's forces at rest (1, ny), and lines (nw, ny) of them."""
    (z, p), waves = system.equilibrium, np.abs(system.scene.sea.amplitude) > 0
    still = balance(system.bodies, z)[0][: system.structure.carrier.shape[0]]
    dp = -1j * response.omega[:, None] * response.X[:, : p.size]
    ddp = -1j * response.omega[:, None] * dp
    rows = system.rows[system.layout.forces][:, waves].T
    return (still @ forces.carried + forces.at_rest)[None], forces.of(rows, dp, ddp, response.carried, response.drag)
