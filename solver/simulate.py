"""One scene in, one record out: prepare, march block by block, and read the record."""

import time
from dataclasses import replace

import numpy as np

from solver.accuracy import settled
from solver.audit import Probe, audit
from solver.balance import warnings
from solver.boundary import coefficients, needed
from solver.errors import SimulationFailed, StepTooLong
from solver.hydrodynamics.bem import Hydrodynamics
from solver.march import WORKS, energy
from solver.record import Record, Recorder
from solver.reference import simulate_reference
from solver.scene import Scene
from solver.system import BALANCE, blocks, energy_residual, prepare, unbalanced

# What the record says of how it was computed.
KNOBS = (
    "time_step", "modes", "azimuths", "arc_points", "line_points", "panel_size", "field_tolerance", "memory_tolerance",
    "stations_per_element", "newton_tolerance",
)  # fmt: skip


def simulate(scene: Scene, hydrodynamics: Hydrodynamics | None = None) -> Record:
    """Run `scene` to its end; raises SimulationFailed with time, quantity and advice.

    hydrodynamics: coefficients of the scene's floats at rest; without them the boundary elements come
    first. Where a smaller step may help the run is repeated once with a quarter of it; `repeated` says why.
    """
    clock, asked = time.perf_counter(), scene.settings.tolerance
    if hydrodynamics is None and needed(scene):
        hydrodynamics = coefficients(scene)
    if asked is not None:
        scene = settled(scene, lambda pilot: simulate(pilot, hydrodynamics).attrs)
    try:
        record, repeated = _run(scene, hydrodynamics), ""
    except StepTooLong as error:
        repeated = str(error)
        record = _again(scene, hydrodynamics, repeated)
    attrs = {**record.attrs, "repeated": repeated, **({} if asked is None else {"tolerance": asked})}
    return replace(record, attrs={**attrs, "wall_time": time.perf_counter() - clock})


def _again(scene: Scene, hydrodynamics: Hydrodynamics | None, first: str) -> Record:
    """With a quarter of the step: 4⁴ times less error, so Newton's tolerance falls as much, 4² of it with the step."""
    s = scene.settings
    finer = replace(s, time_step=s.time_step / 4, newton_tolerance=s.newton_tolerance / 4**2)
    try:
        return _run(replace(scene, settings=finer), hydrodynamics)
    except SimulationFailed as second:
        raise SimulationFailed(f"{second} (second attempt; the first: {first})") from None


def _run(scene: Scene, hydrodynamics: Hydrodynamics | None) -> Record:
    if scene.settings.paths.formulation == "augmented":
        return simulate_reference(scene, hydrodynamics)
    clock = time.perf_counter()
    system = prepare(scene, hydrodynamics)
    prepared = time.perf_counter()
    settings = scene.settings
    steps = int(np.ceil((settings.discard + settings.duration) / system.dt - 1e-9))
    recorder, probe = Recorder(scene, system.support, layout=system.layout), Probe(system)
    state = system.start()
    for samples, output, times in blocks(system, state, steps):
        recorder.add(times, output, samples)
        probe.add(samples, output)
    stored = energy(system.bodies, system.structure, state)
    residual = energy_residual(state.work, stored, state.energy)
    if not residual <= BALANCE:
        raise unbalanced(residual, BALANCE, times[-1], system)
    marched = time.perf_counter()
    attrs = {
        "energy_residual": residual,
        **{f"work_{name}": float(value) for name, value in zip(WORKS, state.work, strict=True)},
        "stored_energy_change": float(stored - state.energy[0]),
        **audit(system, hydrodynamics, probe, state),
        **{name: getattr(settings, name) for name in KNOBS},
        "buckling_factor": system.support.buckling_factor if system.support else np.inf,
        "prepare_time": prepared - clock,
        "march_time": marched - prepared,
        **scene.sea.parameters(),
    }
    if odd := warnings(scene):
        attrs["warnings"] = "; ".join(odd)
    return recorder.record(attrs)
