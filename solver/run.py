"""One scene in, one record out: prepare, march block by block, and read the record."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from solver.coupled.blocks import blocks, energy_residual, unbalanced
from solver.coupled.boundary import coefficients, needed
from solver.coupled.energy import AT_START, WORKS, energy
from solver.coupled.moving import surface_past
from solver.coupled.natural import require_stable, require_upright, system_modes, with_critical_damping, with_usual_step
from solver.coupled.preparation import remembering
from solver.coupled.problem import Output
from solver.coupled.stages import copied
from solver.coupled.system import BALANCE, System
from solver.errors import SimulationFailed, StepTooLong
from solver.hydrodynamics.bem.coefficients import Hydrodynamics, cautions, coefficient_errors
from solver.hydrodynamics.radiation.fitting import USUAL
from solver.limits import BeyondSeries
from solver.motions import of_scene
from solver.oddities import overdamped, warnings
from solver.record.accuracy import ATTEMPTS, first_guess, improved, overruled
from solver.record.audit import audit, doubts
from solver.record.bound import above
from solver.record.channels import Record
from solver.record.decay import died
from solver.record.effects import motions
from solver.record.probe import Probe, sharpest_bend
from solver.record.recorder import Recorder
from solver.record.refit import prepared
from solver.record.shares import Shares
from solver.record.starting import drifting, from_rest, left_over
from solver.record.turning import turning
from solver.record.unknown import without_unknown
from solver.remarks import bared, beyond_tables, left_series, of_motions
from solver.scene import Scene

# What the record says of how it was computed.
KNOBS = (
    "time_step", "modes", "azimuths", "arc_points", "line_points", "panel_size", "field_tolerance",
    "stations_per_element", "newton_tolerance",
)  # fmt: skip

REPEATS = "second", "third", "fourth"  # attempts with shorter steps, each of a quarter of the last
HELPED = 0.5  # of a gap in the energy balance, which a shorter step leaves at most

Better = Callable[[Scene, Mapping[str, float]], Scene | None]  # a finer one for a run that tells its errors
Watch = Callable[[System, np.ndarray, Output], None]  # is shown the system, times and output of every block


def _blind(_system: System, _times: np.ndarray, _output: Output) -> None:
    """Looks at nothing."""


def simulate(scene: Scene, hydrodynamics: Hydrodynamics | None = None, watch: Watch = _blind) -> Record:
    """Run `scene` to its end; raises SimulationFailed with time, quantity and advice.

    hydrodynamics: coefficients of the scene's floats at rest; without them the boundary elements come
    first. Where a smaller step may help the run is repeated with a quarter of it, and of that; `repeated` says why.
    watch: of a march in minimal coordinates; one that is repeated begins again at t = 0, with another system.
    """
    clock = time.perf_counter()
    if hydrodynamics is None and needed(scene):
        hydrodynamics, s = coefficients(scene), scene.settings
        if hydrodynamics is not None and s.radiation and (s.method, s.memory) == ("time", "state-space"):
            hydrodynamics = remembering(hydrodynamics, tuple(f.hull for f in scene.floats), of_scene(scene))
    odd = [*overdamped(scene)]
    scene = with_critical_damping(scene, hydrodynamics)
    given = scene.settings
    finer: Better = _content
    if scene.settings.tolerance is not None and scene.settings.method == "time":
        scene, finer = replace(scene, settings=first_guess(scene)), improved
    elif scene.settings.time_step is None:
        finer = improved
    repeated = ""
    for attempt in range(ATTEMPTS):
        better = finer if attempt + 1 < ATTEMPTS else _content
        try:
            record = _run(scene, hydrodynamics, better, watch)
        except StepTooLong as error:
            repeated = str(error)
            record = _again(scene, hydrodynamics, error, better, watch)
        if isinstance(record, Record):
            break
        scene = record
    assert isinstance(record, Record)  # the last attempt is content with whatever a run tells
    asked: dict[str, Any] = {}
    if given.tolerance is not None:
        notes = (record.attrs["unmet"], *(overruled(given, record.attrs) if given.method == "time" else ()))
        asked = {"tolerance": given.tolerance, "unmet": "; ".join(note for note in notes if note)}
    record, unknown = without_unknown(record, scene, hydrodynamics)
    if odd := odd + unknown:
        asked["warnings"] = "; ".join(filter(None, (*odd, str(record.attrs.get("warnings", "")))))
    attrs = {**record.attrs, **asked, "repeated": repeated, "wall_time": time.perf_counter() - clock}
    return replace(record, attrs=attrs)


def _content(_scene: Scene, _told: Mapping[str, float]) -> None:
    """No other scene, whatever the estimated errors are."""


def _again(
    scene: Scene, hydrodynamics: Hydrodynamics | None, first: StepTooLong, better: Better, watch: Watch
) -> Record | Scene:
    """As `_run` with a quarter of the step, and Newton's tolerance to match: 4⁴ less, 4² of it by the step alone.

    And so on as long as that closes the energy balance, or a run gets further: waves that begin at once set all of a
    frame's modes swinging, taut lines that go slack a float.
    """
    s, system = scene.settings, prepared(scene, hydrodynamics)
    dt, last = with_usual_step(system, system_modes(system, hydrodynamics)).dt, first
    told = ""
    for n, attempt in enumerate(REPEATS, 1):
        finer = replace(s, time_step=dt / 4**n, newton_tolerance=s.newton_tolerance / 4 ** (2 * n))
        try:
            return _run(replace(scene, settings=finer), hydrodynamics, better, watch)
        except SimulationFailed as error:
            told = f"{error} ({attempt} attempt; the first: {first})"
            if not (isinstance(error, StepTooLong) and _nearer(error, last)):
                break
            last = error
    raise SimulationFailed(told) from None


def _nearer(error: StepTooLong, last: StepTooLong) -> bool:
    """Whether an attempt came nearer to a balance than the last one, or further."""
    return error.gap < HELPED * last.gap or 0.0 < last.t < error.t


def _run(
    scene: Scene, hydrodynamics: Hydrodynamics | None, better: Better = _content, watch: Watch = _blind
) -> Record | Scene:
    """The record; or another scene, where `better` chooses one by the errors estimated from the run's start."""
    if scene.settings.method == "frequency":
        from solver.frequency.run import simulate_frequency

        return simulate_frequency(scene, hydrodynamics)
    if scene.settings.paths.formulation == "augmented":
        from solver.reference.run import simulate_reference  # rarely asked for, and 40 ms to import

        return simulate_reference(scene, hydrodynamics)
    clock = time.perf_counter()
    system = prepared(scene, hydrodynamics)
    require_stable(system)
    require_upright(system)
    modes = system_modes(system, hydrodynamics)
    system = with_usual_step(system, modes)
    scene = system.scene
    ready = time.perf_counter()
    s = scene.settings
    steps = int(np.ceil((s.discard + s.duration) / system.dt - 1e-9))
    recorder, probe = Recorder(scene, system.support, layout=system.layout, bodies=system.bodies), Probe(system)
    state, shares = system.start(), Shares(system, hydrodynamics)
    before, done, bend = copied(state), 0, sharpest_bend(scene)
    left = BeyondSeries(scene, system.near, system.terms)
    low = high = np.stack([state.z, state.dz])  # of positions and rates, where loads are given in a range of them
    ranged = any(points is not None for f in scene.floats for points in f.pto_points)
    left.add(system.bodies, np.append(np.zeros(system.bodies.mechanism.size - state.z.size), state.z)[None])
    for samples, output, times in blocks(system, state, steps):
        watch(system, times, output)
        recorder.add(times, output, samples)
        shares.add(times, output.p, output.z)
        if ranged:
            joints = np.stack([output.z, output.dz])[..., output.z.shape[1] - state.z.size :]
            low, high = np.minimum(low, joints.min(axis=1)), np.maximum(high, joints.max(axis=1))
        left.add(system.bodies, output.z)
        probe.add(times, output, samples)
        if probe.unaware(output) or probe.before(bend, times):
            probe = probe.again(done, before)
            probe.add(times, output, samples)
        done += len(times) // 2
        if output.contact.size or bend < np.inf:  # what may be judged again
            before = copied(state)
        if probe.fresh and (other := better(scene, probe.errors(hydrodynamics))) is not None:
            return other
    stored = energy(system.bodies, system.structure, state)
    residual = energy_residual(state.work, stored, state.energy)
    if not residual <= BALANCE:
        raise unbalanced(residual, BALANCE, times[-1], system)
    marched = time.perf_counter() - probe.seconds  # so far: the rest of the audit comes below
    tables, channels = recorder.tables(), recorder.channels
    probe.know(shares.of(tables), recorder, hydrodynamics)
    attrs: dict[str, Any] = {
        "energy_residual": residual,
        **{f"work_{name}": float(value) for name, value in zip(WORKS, state.work, strict=True)},
        "stored_energy_change": float(stored - state.energy[AT_START]),
        **audit(probe, hydrodynamics, state),
        "field_error": left.largest,
        **coefficient_errors(hydrodynamics),
        **{name: getattr(s, name) for name in KNOBS},
        "memory_tolerance": s.memory_tolerance or USUAL,
        "buckling_factor": system.support.buckling_factor if system.support else np.inf,
        "prepare_time": ready - clock,
        "march_time": marched - ready,
        **scene.sea.parameters(),
    }
    told = warnings(scene, system.joints_at_rest)
    beyond = beyond_tables(scene.floats, low, high)
    late, doubted = died(channels, tables), doubts(s, probe.errors(hydrodynamics))
    if odd := (
        *told,
        *of_motions(scene, channels.axes, tables, system.joints_at_rest),
        *turning(system, channels, tables),
        *beyond,
        *left_series(scene, left),
        *late,
        *(settling := list(recorder.settling.notes(channels))),
        *(() if settling else left_over(system, hydrodynamics)),
        *drifting(system, hydrodynamics, recorder.settling, channels, tables),
        *from_rest(system, hydrodynamics),
        *_washed(system, hydrodynamics),
        *probe.notes(recorder),
        *above(scene, tables, attrs["estimated_error"], attrs["stored_energy_change"]),
        *cautions(hydrodynamics),
        *doubted,
    ):
        attrs["warnings"] = "; ".join(odd)
    return recorder.record(tables, attrs, modes)


def _washed(system: System, h: Hydrodynamics | None) -> Iterator[str]:
    """Sentences for hulls past whose ends waves move the surface, by the linear model, where pressure is linear."""
    scene, met = system.scene, np.abs(system.scene.sea.amplitude) > 0
    if h is not None and scene.floats and met.any() and scene.settings.froude_krylov == "linear":
        yield from bared(scene.floats, surface_past(system, met, motions(system, h)[met]), int(met.sum()))
