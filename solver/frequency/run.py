"""One scene in, one record out, without a march."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.coupled.assembly import joint_law
from solver.coupled.moving import surface_past
from solver.frequency import drift, gaussian, ringing
from solver.frequency.bent import fastest
from solver.frequency.case import Case, case_of
from solver.frequency.catenaries import lines_effect
from solver.frequency.drag_effect import drag_effect
from solver.frequency.outputs import (
    Forces,
    Output,
    Rung,
    bend,
    frame_forces,
    joint_lines,
    of_squares,
    outputs,
    platform_outputs,
    rate_lines,
    strokes,
    tables_of,
)
from solver.frequency.resonance import unresolved
from solver.frequency.response import Response, respond, respond_in
from solver.frequency.rotation import rotation_effect, turned
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, cautions, coarser, coefficient_errors
from solver.multibody.joint_law import JointLaw
from solver.multibody.of_axes import friction
from solver.oddities import idle
from solver.power_takeoff import PtoTable
from solver.record.audit import doubts, unmet
from solver.record.bound import above
from solver.record.channels import Labelled, Record, bound
from solver.record.effects import left_out_effect, response_error, together
from solver.record.elements import elements_effect
from solver.record.fatigue import crossing_rate
from solver.record.probe import UNTOLD, knows_finer, with_tables
from solver.record.spectra import bands, crossings, moments
from solver.record.steel import Steel
from solver.remarks import bared, beyond_tables, drag_driven, of_motions, pulled, skewed, stopped
from solver.scene import Scene, require_waves
from solver.statistics import FAINT

CYCLES = 50  # of which rainflow leaves half a cycle
AT_ONCE = 200  # outputs whose sums over a record are held together
# These are how nodes' motions go together in time.
NO_TIME = "time: a linear model in the frequency domain has no displacement_envelope, stress_envelope"


def simulate_frequency(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Record:
    """Statistics of the linear model's stationary response over `duration`; series and envelopes it does not have."""
    require_waves(scene)
    of = _Solved.of(scene, case_of(scene, hydrodynamics))
    case, response, channels = of.case, of.response, of.case.channels
    tables = of.tables()
    errors, notes = _judged(of, tables)
    drifting, figures = drift.variables(case, response) if "drift" in scene.settings.outputs else ({}, {})
    missed = [*unmet(scene, None, errors, hydrodynamics), str(figures.get("unmet", ""))]
    attrs: dict[str, float | str] = {
        **errors,
        **coefficient_errors(hydrodynamics),
        **figures,
        "drag_rounds": response.rounds,
        "buckling_factor": case.system.support.buckling_factor if case.system.support else np.inf,
        "unmet": "; ".join(filter(None, missed)),
        "skipped": "; ".join([NO_TIME, *_unused(scene), *coarser(hydrodynamics)]),
        **case.sea_parameters,
    }
    if notes:
        attrs["warnings"] = "; ".join(notes)
    steel = channels.steel
    return channels.record(
        tables,
        attrs,
        modes=case.modes,
        rao=of.rao() if scene.settings.rao and channels.axes else None,
        counted=_counted(steel, of.rung, case.waves.size) if steel is not None and steel.counts else ({}, ()),
        spectra=of.spectra() if scene.settings.spectra else None,
        further=drifting | dict(strokes(case, response)) | of.moments(),
    )


@dataclass(frozen=True, eq=False)
class _Solved:
    """A scene, its case, which scenes share that differ in their laws alone, and the lines of all its outputs."""

    scene: Scene
    case: Case
    law: JointLaw
    response: Response
    frame: Forces
    rung: Rung
    linear: list[Output]
    of_platform: list[Output]

    @classmethod
    def of(cls, scene: Scene, case: Case) -> "_Solved":
        law = case.law(scene.floats)
        response = turned(case, respond_in(case, law))
        frame = frame_forces(case, response)
        rung = ringing.rung(case, law, response, frame)
        parts = list(outputs(case, response)), list(platform_outputs(case, response, rung))
        return cls(scene, case, law, response, frame, rung, *parts)

    @cached_property
    def fastest(self) -> np.ndarray:
        """Rates (nj,) that the joints are to be expected to reach."""
        return fastest(rate_lines(self.case, self.response), self.case.process, self.response.excess[0])

    def tables(self) -> dict[str, np.ndarray]:
        """Of all outputs, in the order of STATISTICS."""
        case, response, law, scene = self.case, self.response, self.law, self.scene
        tables = tables_of(case.process, self.linear) | tables_of(self.rung.process, self.of_platform)
        tables |= dict(of_squares(case, response, self.rung, law))
        if scene.floats:
            if self.rung.joints is not None:
                tables["hinge_force"] = self.rung.joints
            bend(case, response, law, self.linear, tables)
        if response.bends.any():
            bound(tables, scene, case.channels, joint_law(scene.floats), self.fastest)
        return tables

    def rao(self) -> np.ndarray:
        """Of the joints (nw, nj), in the scene's waves; nan of those of zero height."""
        case = self.case
        rao = np.full((self.scene.sea.omega.size, case.channels.owner.size), np.nan, complex)
        rao[case.met] = joint_lines(case, self.response)[: case.waves.size]
        return rao

    def spectra(self) -> dict[str, Labelled]:
        """Of all linear outputs, in bands that `duration` resolves."""
        case, scene = self.case, self.scene
        at = bands(scene.sea.omega, scene.settings.duration)
        parts = ((name, lines[: case.waves.size]) for name, _, lines in self.linear + self.of_platform)
        return case.channels.spectra(at, case.waves, scene.sea.amplitude[case.met], parts)

    def moments(self) -> dict[str, Labelled]:
        """Spectral moments and rates of upcrossings, where they are asked for."""
        case, waves = self.case, self.case.waves.size
        if "moments" not in self.scene.settings.outputs:
            return {}
        processes = (case.process, self.linear), (self.rung.process, self.of_platform)
        return case.channels.moments(
            {name: _crossed(of, lines, waves) for of, parts in processes for name, _, lines in parts}
        )


def _judged(of: _Solved, tables: dict[str, np.ndarray]) -> tuple[dict[str, float], list[str]]:
    """Estimated errors of the tables, and what is to be warned of."""
    scene, case, law, response = of.scene, of.case, of.law, of.response
    h, waves = case.hydrodynamics, case.waves.size
    drag = response.drag.tops[:waves], response.mean.drag.ravel()
    of_drag = drag_effect(case, response, of.rung, tables)
    turning = rotation_effect(case, law, response, of.frame, tables)
    slipping = _stopped(case, law, response) if response.stuck.any() else []
    of_lines = lines_effect(case, law, response, tables["line_tension"]) if case.channels.lines else 0.0
    errors = {
        "mesh_effect": response.mesh_effect,
        "shapes_effect": left_out_effect(case.system, response.X[:waves], *drag),
        "elements_effect": elements_effect(scene, h, case.system.support),
        "law_effect": _law_effect(case, response, scene),
        "drag_effect": of_drag.error,
        "linearisation_effect": UNTOLD if slipping else max(response.linearisation_effect, of_lines),
        "rotation_effect": turning.error,
    }
    errors["estimated_error"] = together(errors.values())
    notes = [
        *case.warnings,
        *idle(scene),
        *of_motions(scene, case.channels.axes, tables, case.system.joints_at_rest),
        *bared(scene.floats, surface_past(case.system, case.met, response.Z[: case.waves.size]), case.waves.size),
        *_beyond_tables(of),
        *drag_driven(of_drag.extremes, of_drag.shaken, of_drag.wear),
        *skewed(turning.extremes),
        *pulled(of.rung.extremes, of.rung.rings),
        *filter(None, [turning.note]),
        *unresolved(case, response),
        *slipping,
        *above(scene, tables, errors["estimated_error"]),
        *cautions(h),
        *(() if slipping else doubts(scene.settings, errors)),  # that something slips says why by itself
    ]
    return errors, notes


def _beyond_tables(of: _Solved) -> tuple[str, ...]:
    """Rates beyond those that laws are given for: tables are by rate alone."""
    if not of.response.bends.any():
        return ()
    ways = np.stack([0 * of.fastest, of.fastest])
    return tuple(beyond_tables(of.scene.floats, -ways, ways))


def _counted(steel: Steel, rung: Rung, waves: int) -> tuple[dict[str, Labelled], tuple[str, ...]]:
    """Of a random sea's lines, of what rings, or of one harmonic; else by rainflow of their sum, where one wave is all
    of many periods."""
    of, (level, lines) = rung.process, rung.frame
    if of.omega.size == 1 or not of.known or (waves > 1 and rung.rings > FAINT):
        return steel.expected(lines, of.omega)
    parts, again = [steel.ends(level + block) for block in of.blocks(lines)], CYCLES if waves == 1 else 1
    bent = {at: np.tile(np.concatenate([part[at] for part in parts]), (again, 1, 1)) for at in parts[0]}
    return steel.counted(bent, again * of.duration)


def _crossed(of: gaussian.Process, lines: np.ndarray, waves: int) -> tuple[np.ndarray, np.ndarray]:
    """Rate of upcrossings (…) and moments of lines (nl, …): of known phases those of their sum, as a march counts."""
    of_order, flat = moments(of.omega, lines), lines.reshape(len(lines), -1)
    rate = crossings(of_order)
    if of.begin is None or of.omega.size == 1:
        return rate, of_order
    again = CYCLES if waves == 1 else 1
    parts = np.array_split(flat, flat.shape[1] // AT_ONCE + 1, axis=1)
    sums = (np.tile(np.concatenate([*of.blocks(part)]), (again, 1)) for part in parts)
    counted = np.concatenate([crossing_rate(x, again * of.duration) for x in sums])
    return np.where(of.unwaved(flat), rate.ravel(), counted).reshape(rate.shape), of_order


def _law_effect(case: Case, response: Response, scene: Scene) -> float:
    """Relative error of the response's std and power by tables of laws that are known by finer ones."""
    if not knows_finer(scene):
        return 0.0
    waves = case.waves.size
    exact = respond(with_tables(scene, PtoTable.by_finer), case.hydrodynamics).X[:waves]
    return response_error(case.system, case.law(scene.floats), case.waves, response.X[:waves], exact)


def _stopped(case: Case, law: JointLaw, response: Response) -> list[str]:
    """See remarks.stopped."""
    borne, joints = response.pto * rate_lines(case, response), slice(case.system.structure.carrier.shape[0], None)
    table = gaussian.table(np.zeros(borne.shape[1]), borne, case.process)
    holding = np.where(response.stuck, friction(law)[joints], np.inf)
    return list(stopped(case.system.scene.floats, holding, table))


def _unused(scene: Scene) -> Iterator[str]:
    """What is given and has no part in a stationary response of first order."""
    for f in scene.floats:
        if f.per_axis("offset").any():
            yield f"floats.{f.name}.offset: the response to waves is stationary, nothing is let go in it"
    if scene.settings.time_step is not None:
        yield "time_step: there are no steps"
    if scene.platform is not None and scene.platform.wave_stretching != "none":
        yield "wave_stretching: of second order; members are loaded to still water"
