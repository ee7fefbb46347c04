"""One scene in, one record out, without a march."""

from collections.abc import Iterator

import numpy as np

from solver.balance import warnings
from solver.coupled.equilibrium import balance
from solver.coupled.forces import Forces
from solver.coupled.linear import linear_model
from solver.coupled.natural import require_stable, system_modes
from solver.coupled.system import System, prepare
from solver.errors import InputError
from solver.frequency import drift, gaussian
from solver.frequency.response import Response, respond
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, seabed_error
from solver.record.audit import coefficient_effects, left_out_effect, together
from solver.record.bound import above
from solver.record.recorder import ELEVATION, Channels, Labelled, Record
from solver.record.spectra import bands, cross_spectra
from solver.scene import Scene
from solver.statistics import STATISTICS

NEAR = 1e-4  # [m or rad] from equilibrium, where slopes are taken
LEFT_OUT = "displacement_envelope, stress_envelope"  # how the nodes' motions go together in time


def simulate_frequency(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Record:
    """Statistics of the linear model's stationary response over `duration`; series and envelopes it does not have."""
    if not scene.sea.amplitude.any():
        raise InputError("settings.method", "frequency", "needs waves: a decay is a matter of the time domain")
    system = prepare(scene, hydrodynamics)
    require_stable(system)
    response, channels = respond(system, hydrodynamics), Channels(scene, system.support)
    found = list(_tables(system, response, channels))
    tables = {name: table for name, table, _ in found}
    _, mesh = coefficient_effects(system, hydrodynamics)
    shapes = left_out_effect(system, response.X, response.drag)
    attrs: dict[str, float | str] = {
        "estimated_error": together((mesh, shapes)),
        "mesh_effect": mesh,
        "shapes_effect": shapes,
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
    spectra = None
    if scene.settings.spectra:
        at = bands(scene.sea.omega, scene.settings.duration)
        linear = {name: lines for name, _, lines in found if lines is not None}
        wave = linear[ELEVATION]
        parts = {name: lines.reshape(len(wave), -1) for name, lines in linear.items()}
        responses = {name: cross_spectra(response.omega, wave, lines, at) for name, lines in parts.items()}
        spectra = channels.spectra(at, {name: (r, linear[name].shape[1:]) for name, r in responses.items()})
    drifting: dict[str, Labelled] = {}
    if "drift" in scene.settings.outputs:
        drifting, figures = drift.variables(system, response, drift.require_far_field(hydrodynamics), channels)
        attrs |= figures
    modes = system_modes(system, hydrodynamics)
    counted = None
    if channels.steel is not None and channels.steel.counts:
        counted = channels.steel.expected(_forces(system, response, channels.steel.forces)[1], response.omega)
    return channels.record(
        tables, attrs, modes=modes, rao=rao, counted=counted or ({}, ()), spectra=spectra, further=drifting
    )


def _joints(system: System, response: Response) -> np.ndarray:
    """Lines of the joints' axes (nw, nj)."""
    return response.Z[:, system.structure.carrier.shape[0] :]


def _tables(
    system: System, response: Response, channels: Channels
) -> Iterator[tuple[str, np.ndarray, np.ndarray | None]]:
    """Name, statistics and lines of each output; those that no line makes have none."""
    scene, omega, duration = system.scene, response.omega, system.scene.settings.duration
    (z, p), amplitude, mean = system.equilibrium, scene.sea.amplitude, response.mean
    p, still = p + mean.x[: p.size], balance(system.bodies, z)[1] + mean.wrench
    z = z + linear_model(system).shape @ mean.x

    def table(name: str, mean: np.ndarray, lines: np.ndarray) -> tuple[str, np.ndarray, np.ndarray | None]:
        return name, gaussian.table(mean, lines, omega, duration), lines

    yield table(ELEVATION, np.zeros(()), amplitude[np.abs(amplitude) > 0])
    if scene.floats:
        nc, joints = system.structure.carrier.shape[0], _joints(system, response)
        means = dict(channels.motions(z[None, nc:]))
        for name, lines in channels.motions(joints):
            yield table(name, means[name][0], lines)
        pto, rates = response.pto, -1j * omega[:, None] * joints
        owned = [channels.owner == b for b in range(len(scene.floats))]
        powers = [gaussian.power_table(pto[i], rates[:, i], omega, duration) for i in owned]
        yield "absorbed_power", np.array(powers), None
        if "pto_stroke" in scene.settings.outputs:
            yield table("pto_rate", np.zeros(()), channels.by_axis(rates))
        if "pto_force" in scene.settings.outputs:
            k = np.concatenate([f.per_axis("pto_stiffness") for f in scene.floats])
            mean, lines = channels.by_axis(-(k * z[nc:])[None])[0], channels.by_axis(-(pto * rates + k * joints))
            yield table("pto_force", mean, lines)
        at_rest = channels.hinge_force(still[None])[0]
        yield table("hinge_force", at_rest, channels.hinge_force(response.wrench))
        if channels.lines:
            at_rest = channels.line_tension(system.bodies, z[None])[0]
            either = (channels.line_tension(system.bodies, z + way * NEAR * np.eye(z.size)) for way in (1, -1))
            slope = np.subtract(*either) / (2 * NEAR)
            yield table("line_tension", at_rest, response.Z @ slope)
    if channels.legs is not None:
        tops, X = channels.legs.tops, response.X[:, : p.size]
        yield table("top_displacement", np.tensordot(p, tops, axes=1), np.tensordot(X, tops, axes=1))
    if channels.steel is None:
        return
    level, lines = _forces(system, response, channels.steel.forces)
    if channels.legs is not None:
        means, feet = channels.steel.compression(level)[0], channels.steel.compression(lines)
        tables = [gaussian.compression_table(means[i], feet[:, i], omega, duration) for i in range(len(means))]
        yield "bottom_stress", np.array(tables), None
    means = dict(channels.steel.channels(level))
    for name, values in channels.steel.channels(lines):
        yield table(name, means[name][0], values)


def _forces(system: System, response: Response, forces: Forces) -> tuple[np.ndarray, np.ndarray]:
    """The frame's forces at rest (1, ny), and lines (nw, ny) of them."""
    (z, p), waves = system.equilibrium, np.abs(system.scene.sea.amplitude) > 0
    mean = response.mean
    still = balance(system.bodies, z)[0][: system.structure.carrier.shape[0]] + mean.carried
    dp = -1j * response.omega[:, None] * response.X[:, : p.size]
    ddp = -1j * response.omega[:, None] * dp
    rows = system.rows[system.layout.forces][:, waves].T
    level = (still @ forces.carried + mean.drag.ravel() @ forces.drag) @ forces.spread + forces.at_rest
    return level[None], forces.of(rows, dp, ddp, response.carried, response.drag)
