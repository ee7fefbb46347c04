"""One scene in, one record out: prepare, march block by block, and read the record."""

import time

import numpy as np

from solver.accuracy import settled
from solver.audit import Probe, audit, energy_residual
from solver.balance import warnings
from solver.boundary import coefficients, needed
from solver.hydrodynamics.bem import Hydrodynamics
from solver.march import WORKS, energy
from solver.record import Record, Recorder
from solver.scene import Scene
from solver.system import blocks, prepare

# What the record says of how it was computed.
KNOBS = (
    "time_step", "modes", "azimuths", "arc_points", "line_points", "field_tolerance", "memory_tolerance",
    "stations_per_element", "newton_tolerance",
)  # fmt: skip


def simulate(scene: Scene, hydrodynamics: Hydrodynamics | None = None) -> Record:
    """Run `scene` to its end; raises SimulationFailed with time, quantity and advice.

    hydrodynamics: coefficients of the scene's floats at rest; without them the boundary elements come first.
    """
    clock, asked = time.perf_counter(), scene.settings.tolerance
    if hydrodynamics is None and needed(scene):
        hydrodynamics = coefficients(scene)
    if asked is not None:
        scene = settled(scene, lambda pilot: simulate(pilot, hydrodynamics).attrs)
    system = prepare(scene, hydrodynamics)
    prepared = time.perf_counter()
    settings = scene.settings
    steps = int(np.ceil((settings.discard + settings.duration) / system.dt - 1e-9))
    recorder, probe = Recorder(scene, system.support, layout=system.layout), Probe(system)
    state = system.start()
    before = energy(system.bodies, system.structure, state)
    for samples, output, times in blocks(system, state, steps):
        recorder.add(times, output, samples)
        probe.add(samples, output)
    after = energy(system.bodies, system.structure, state)
    marched = time.perf_counter()
    work = dict(zip(WORKS, state.work, strict=True))
    attrs = {
        "energy_residual": energy_residual(work, after - before),
        **{f"work_{name}": float(value) for name, value in work.items()},
        "stored_energy_change": float(after - before),
        **audit(system, hydrodynamics, probe, state),
        **({} if asked is None else {"tolerance": asked}),
        **{name: getattr(settings, name) for name in KNOBS},
        "buckling_factor": system.support.buckling_factor if system.support else np.inf,
        "prepare_time": prepared - clock,
        "march_time": marched - prepared,
        **scene.sea.parameters(),
    }
    if odd := warnings(scene):
        attrs["warnings"] = "; ".join(odd)
    attrs["wall_time"] = time.perf_counter() - clock
    return recorder.record(attrs)
