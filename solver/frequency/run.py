"""One scene in, one record out, without a march."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from solver.coupled.assembly import joint_law
from solver.frequency import drift, gaussian
from solver.frequency.bent import absorbed_table, borne_table, pto_load, rate_load
from solver.frequency.case import Case, case_of
from solver.frequency.drag_effect import drag_effect
from solver.frequency.response import Response, respond, respond_in
from solver.frequency.shape import beyond_rayleigh
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, coarser, coefficient_errors
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import bent, drag, friction
from solver.oddities import beyond_tables, drag_driven, met, not_gaussian, stopped, swung
from solver.power_takeoff import PtoTable
from solver.record.audit import doubts, unmet
from solver.record.bound import above
from solver.record.channels import ELEVATION, Labelled, Record, bound
from solver.record.effects import left_out_effect, response_error, together
from solver.record.elements import elements_effect
from solver.record.probe import UNTOLD, knows_finer, with_tables
from solver.record.spectra import bands, cross_spectra, crossings, moments
from solver.scene import DOFS, Scene, require_waves
from solver.statistics import STATISTICS

NEAR = 1e-4  # [m or rad] from equilibrium, where slopes are taken
Output = tuple[str, np.ndarray, np.ndarray]  # name, mean (…), lines (nw, …)
LEFT_OUT = "displacement_envelope, stress_envelope"  # how the nodes' motions go together in time


class Forces(NamedTuple):
    """Of an elastic platform's frame, ny of them."""

    level: np.ndarray  # (1, ny) mean
    lines: np.ndarray  # (nw, ny)


def simulate_frequency(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Record:
    """Statistics of the linear model's stationary response over `duration`; series and envelopes it does not have."""
    require_waves(scene)
    case = case_of(scene, hydrodynamics)
    law, joints = case.law(scene.floats), joint_law(scene.floats)
    channels, support = case.channels, case.system.support
    response = respond_in(case, law)
    frame = _forces(case, response)
    linear, waves, omega = list(_outputs(case, response, frame)), case.waves.size, case.omega
    tables = _tables(case, linear) | dict(_of_squares(case, response, frame, joints))
    beyond: Iterable[str] = ()
    if scene.floats:
        _bend(case, response, joints, linear, tables)
    if bent(law).any():
        fastest = gaussian.fastest(_rates(case, response), omega, case.duration)
        bound(tables, scene, channels, joints, fastest)
        ways = np.stack([0 * fastest, fastest])  # tables are by rate alone
        beyond = beyond_tables(scene.floats, -ways, ways)
    mesh, shapes = response.mesh_effect, left_out_effect(case.system, response.X[:waves], response.drag.tops[:waves])
    elements = elements_effect(scene, hydrodynamics, support)
    of_drag = drag_effect(case, response, *frame, tables)
    slipping = _stopped(case, law, response) if response.stuck.any() else []
    errors = {
        "mesh_effect": mesh,
        "shapes_effect": shapes,
        "elements_effect": elements,
        "law_effect": _law_effect(case, response, scene),
        "drag_effect": of_drag.error,
        "linearisation_effect": UNTOLD if slipping else response.linearisation_effect,
    }
    errors["estimated_error"] = together(errors.values())
    attrs: dict[str, float | str] = {
        **errors,
        **coefficient_errors(hydrodynamics),
        "drag_rounds": response.rounds,
        "buckling_factor": support.buckling_factor if support else np.inf,
        "unmet": "; ".join(unmet(scene.settings, None, errors, hydrodynamics)),
        "skipped": "; ".join(
            [
                f"time: a linear model in the frequency domain has no {LEFT_OUT}",
                *_unused(scene),
                *coarser(hydrodynamics),
            ]
        ),
        **case.sea_parameters,
    }
    power = tables["absorbed_power"][:, STATISTICS.index("mean")] if scene.floats else np.zeros(0)
    doubted = () if slipping else doubts(scene.settings, errors)  # which says why by itself
    if notes := (
        *case.warnings,
        *met(scene, tables),
        *swung(scene, channels.axes, tables),
        *beyond,
        *not_gaussian(scene.floats, _beyond_rayleigh(case, response)),
        *drag_driven(of_drag.extremes),
        *slipping,
        *above(scene, power),
        *doubted,
    ):
        attrs["warnings"] = "; ".join(notes)
    rao = None
    if scene.settings.rao and channels.axes:
        rao = np.full((scene.sea.omega.size, channels.owner.size), np.nan, complex)
        rao[case.met] = _joints(case, response)[:waves]
    spectra = None
    if scene.settings.spectra:
        at = bands(scene.sea.omega, scene.settings.duration)
        wave = scene.sea.amplitude[case.met]
        parts = {name: (lines[:waves].reshape(waves, -1), lines.shape[1:]) for name, _, lines in linear}
        of = {name: (cross_spectra(case.waves, wave, lines, at), shape) for name, (lines, shape) in parts.items()}
        spectra = channels.spectra(at, of)
    drifting: dict[str, Labelled] = {}
    if "drift" in scene.settings.outputs:
        drifting, figures = drift.variables(case, response, law)
        said = (str(of.get("unmet", "")) for of in (attrs, figures))
        attrs |= figures | {"unmet": "; ".join(note for note in said if note)}
    counted = None
    if channels.steel is not None and channels.steel.counts:
        counted = channels.steel.expected(frame.lines, omega)
    further = drifting | dict(_strokes(case, response))
    if "moments" in scene.settings.outputs:
        of_order = {name: moments(omega, lines) for name, _, lines in linear}
        further |= channels.moments({name: (crossings(m), m) for name, m in of_order.items()})
    return channels.record(
        tables, attrs, modes=case.modes, rao=rao, counted=counted or ({}, ()), spectra=spectra, further=further
    )


def _law_effect(case: Case, response: Response, scene: Scene) -> float:
    """Relative error of the response's std and power by tables of laws that are known by finer ones."""
    if not knows_finer(scene):
        return 0.0
    waves = case.waves.size
    exact = respond(with_tables(scene, PtoTable.by_finer), case.hydrodynamics).X[:waves]
    return response_error(case.system, case.law(scene.floats), case.waves, response.X[:waves], exact)


def _beyond_rayleigh(case: Case, response: Response) -> np.ndarray:
    """Extremes of the joints' motions (nj,) over those of Gaussian ones."""
    if not response.excess.any():
        return np.ones(response.excess.size)
    rates = _rates(case, response)
    table = gaussian.table(np.zeros(rates.shape[1]), rates, response.omega, case.duration)
    return beyond_rayleigh(
        response.excess, np.divide(table[:, 0], table[:, 4], where=table[:, 4] > 0, out=0 * table[:, 0])
    )


def _stopped(case: Case, law: JointLaw, response: Response) -> list[str]:
    """See oddities.stopped."""
    borne, joints = response.pto * _rates(case, response), slice(case.system.structure.carrier.shape[0], None)
    table = gaussian.table(np.zeros(borne.shape[1]), borne, response.omega, case.duration)
    holding = np.where(response.stuck, friction(law)[joints], np.inf)
    return list(stopped(case.system.scene.floats, holding, table))


def _strokes(case: Case, response: Response) -> Iterator[tuple[str, Labelled]]:
    """Of power take-offs, if asked for: from one end to the other, and the way in an hour, 3600 ⟨|v|⟩."""
    if "pto_stroke" not in case.system.scene.settings.outputs or not case.system.scene.floats:
        return
    joints, rates = _joints(case, response), _rates(case, response)
    ends = gaussian.table(np.zeros(joints.shape[1]), joints, response.omega, case.duration)
    std = np.sqrt(0.5 * np.sum(np.abs(rates) ** 2, axis=0))
    mean_size = np.sqrt(8) / np.pi if len(rates) == 1 else np.sqrt(2 / np.pi)  # over the std: harmonic, or Gaussian
    for name, values in (("pto_stroke", ends[:, 0] - ends[:, 1]), ("pto_travel", 3600 * mean_size * std)):
        yield name, (("float", "axis"), case.channels.by_axis(values[None])[0])


def _unused(scene: Scene) -> Iterator[str]:
    """What is given and has no part in a stationary response of first order."""
    for f in scene.floats:
        if f.per_axis("offset").any():
            yield f"floats.{f.name}.offset: the response to waves is stationary, nothing is let go in it"
    if scene.settings.time_step is not None:
        yield "time_step: there are no steps"
    if scene.platform is not None and scene.platform.wave_stretching != "none":
        yield "wave_stretching: of second order; members are loaded to still water"


def _joints(case: Case, response: Response) -> np.ndarray:
    """Lines of the joints' axes (nw, nj)."""
    return response.Z[:, case.system.structure.carrier.shape[0] :]


def _rates(case: Case, response: Response) -> np.ndarray:
    """Lines of their rates (nw, nj)."""
    return -1j * response.omega[:, None] * _joints(case, response)


def _tables(case: Case, outputs: list[Output]) -> dict[str, np.ndarray]:
    """Statistics of outputs, all at once."""
    ends = np.cumsum([lines[0].size for _, _, lines in outputs])
    every = np.concatenate([lines.reshape(len(lines), -1) for _, _, lines in outputs], axis=1)
    mean = np.empty(every.shape[1])
    for end, (_, level, lines) in zip(ends, outputs, strict=True):
        mean[end - lines[0].size : end] = np.ravel(level)
    table = gaussian.table(mean, every, case.omega, case.duration)
    return {
        name: table[end - lines[0].size : end].reshape(*lines.shape[1:], -1)
        for end, (name, _, lines) in zip(ends, outputs, strict=True)
    }


def _bend(case: Case, response: Response, law: JointLaw, linear: list[Output], tables: dict[str, np.ndarray]) -> None:
    """By the whole law what axes bear that it bends, in place: `pto_force`, and along those of a float on fixed ground
    its `hinge_force`, in one wave with all that goes by rate: a Gaussian rate would give quadratic damping too much.

    Axes that friction holds bear what the linear model says.
    """
    scene, channels, rates = case.system.scene, case.channels, _rates(case, response)
    owner, of_lines, one = channels.owner, {name: lines for name, _, lines in linear}, len(rates) == 1
    fixed = np.array([scene.platform is None and scene.carriers[b] < 0 for b in owner], bool)
    slides, moved = np.array([name in DOFS[:3] for name in channels.names], bool), ~response.stuck
    along = moved & fixed & slides & (bent(law) | (one & (drag(law) > 0)))
    for name, which, of, order in (
        ("pto_force", moved & bent(law), pto_load, channels.axes),
        ("hinge_force", along, rate_load if one else pto_load, DOFS),
    ):
        axes = np.flatnonzero(which)
        if name in tables and axes.size:
            at = owner[axes], [order.index(channels.names[j]) for j in axes]
            usual, lines = tables[name][at], of_lines[name][:, *at]
            tables[name][at] = borne_table(of(law, axes), rates[:, axes], usual, lines, case.omega, case.duration)


def _of_squares(case: Case, response: Response, frame: Forces, law: JointLaw) -> Iterator[tuple[str, np.ndarray]]:
    """Name and statistics of what no line makes."""
    scene, channels, omega = case.system.scene, case.channels, case.omega
    if scene.floats:
        pto, rates = response.pto, _rates(case, response)
        owned = [channels.owner == b for b in range(len(scene.floats))]
        powers = [
            absorbed_table(pto_load(law, np.flatnonzero(i)), rates[:, i], omega, case.duration)
            if np.any(bent(law) & i & ~response.stuck)
            else gaussian.power_table(pto[i], rates[:, i], omega, case.duration)
            for i in owned
        ]
        yield "absorbed_power", np.array(powers)
        if any(f.pto_efficiency for f in scene.floats):
            yield "electrical_power", np.array(list(_electrical(case, response, law, owned, powers)))
    if channels.steel is not None and channels.legs is not None:
        level, lines = (channels.steel.compression(y)[:, channels.legs.first] for y in frame)
        of_legs = gaussian.compression_table(level[0], lines, omega, case.duration)
        yield "bottom_stress", of_legs[channels.legs.twin]


def _electrical(
    case: Case, response: Response, law: JointLaw, owned: list[np.ndarray], absorbed: list[np.ndarray]
) -> Iterator[np.ndarray]:
    """Statistics of each float's electrical power, by that absorbed; NaN of those without an efficiency."""
    scene, joints = case.system.scene, _joints(case, response)
    level = (case.system.equilibrium[0] + case.model.shape @ response.mean.x)[-joints.shape[1] :]
    rates = _rates(case, response)
    for f, i, power in zip(scene.floats, owned, absorbed, strict=True):
        if f.pto_efficiency is None:
            yield np.full(len(STATISTICS), np.nan)
            continue
        load = pto_load(law, np.flatnonzero(i)), response.pto[i], f.per_axis("pto_stiffness")
        axes = gaussian.Axes(*load, level[i], joints[:, i], rates[:, i])
        yield gaussian.electrical_table(f.pto_efficiency, axes, power, response.omega, case.duration)


def _outputs(case: Case, response: Response, frame: Forces) -> Iterator[Output]:
    """Of all that goes with the waves."""
    system, channels, omega, mean = case.system, case.channels, response.omega, response.mean
    scene, (z, p) = system.scene, system.equilibrium
    p, still = p + mean.x[: p.size], case.loads_at_rest[1] + mean.wrench
    z = z + case.model.shape @ mean.x
    yield ELEVATION, np.zeros(()), case.amplitude
    if scene.floats:
        nc, joints = system.structure.carrier.shape[0], _joints(case, response)
        means = dict(channels.motions(z[None, nc:]))
        for name, lines in channels.motions(joints):
            yield name, means[name][0], lines
        pto, rates = response.pto, _rates(case, response)
        if "pto_stroke" in scene.settings.outputs:
            yield "pto_rate", np.zeros(()), channels.by_axis(rates)
        if "pto_force" in scene.settings.outputs:
            k = np.concatenate([f.per_axis("pto_stiffness") for f in scene.floats])
            level, lines = channels.by_axis(-(k * z[nc:])[None])[0], channels.by_axis(-(pto * rates + k * joints))
            yield "pto_force", level, lines
        yield "hinge_force", channels.hinge_force(still[None])[0], channels.hinge_force(response.wrench)
        if channels.lines:
            either = (channels.line_tension(system.bodies, z + way * NEAR * np.eye(z.size)) for way in (1, -1))
            slope = np.subtract(*either) / (2 * NEAR)
            yield "line_tension", channels.line_tension(system.bodies, z[None])[0], response.Z @ slope
    if channels.legs is not None:
        tops = channels.legs.tops.reshape(p.size, -1)
        means, lines = (x @ tops for x in (p, response.X[:, : p.size]))
        on = channels.legs.tops.shape[1:]
        yield "top_displacement", means.reshape(on), lines.reshape(-1, *on)
    if channels.nodes:
        for name, lines in channels.accelerations(-(omega[:, None] ** 2) * response.X[:, : p.size]):
            yield name, np.zeros(()), lines
    if channels.steel is not None:
        means = dict(channels.steel.channels(frame.level))
        for name, values in channels.steel.channels(frame.lines):
            yield name, means[name][0], values


def _forces(case: Case, response: Response) -> Forces:
    """Of the frame, that are asked for."""
    if case.system.support is None or case.system.support.forces is None:
        return Forces(np.zeros((1, 0)), np.zeros((response.omega.size, 0)))
    forces = case.system.support.forces
    nc, nm = case.system.structure.carrier.shape
    still = case.loads_at_rest[0][:nc] + response.mean.carried
    dp = -1j * response.omega[:, None] * response.X[:, :nm]
    ddp = -1j * response.omega[:, None] * dp
    level = (still @ forces.carried + response.mean.drag.ravel() @ forces.drag)[None]
    lines = case.padded(case.rows[case.system.layout.forces]).T
    lines += forces.of_motion(dp, ddp, response.carried) + response.drag.forces
    return Forces(forces.whole(level) + forces.at_rest, forces.whole(lines))
