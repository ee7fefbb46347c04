"""What a record says of its error beside the true one, on Buan and on scenes unlike it.

True: against the same coefficients with every knob refined, at the same instants. The coefficients' B - iωA are those
of a memory close to the boundary elements', so that one fits them exactly and the share of the usual fit is in the true
error, too. The share of the boundary elements, which needs other coefficients, is told by `make validate` and
tests/coupled/test_linear.py.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.coupled.preparation import prepare
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.motions import of_scene
from solver.record.channels import Record
from solver.record.effects import together
from solver.run import simulate
from solver.scene import Scene
from solver.statistics import moments
from studies.benchmark.case import coefficients, scene, timed, with_settings, worst
from tests.awkward import SCENES

SECONDS = 900.0  # analysed, of Buan; the other scenes are as they are
PARTS = (
    "discretization_error", "quadrature_error", "memory_effect", "shapes_effect", "elements_effect", "stations_effect",
)  # fmt: skip
OF_STEPS = ("discretization_error", "sampling_error")
LOW = 0.3  # of the waves' heights, so that nothing swings through with less to hold it
TYPICAL = 0.03  # rate [rad/s] at which a linear power take-off bears what one bears that bends
TOLERANCES = [3e-2, 1e-2, 3e-3, 1e-3]
FINER = 8  # times shorter steps
CUT = 4  # times as many elements
FINE = {
    "modes": 40, "stations_per_element": 6, "azimuths": 48, "arc_points": 16, "line_points": 10, "panel_size": 0.12,
    "field_tolerance": 1e-9, "newton_tolerance": 1e-9, "memory_tolerance": 3e-4,
}  # fmt: skip
HEADER = f"{'scene':24s}{'true':>10s}{'estimated':>11s}{'true over it':>14s}  worst"


def cases() -> Iterator[tuple[str, Scene, Hydrodynamics | None]]:
    """Name, scene and coefficients."""
    buan = {f"buan, {platform}": with_settings(scene(platform), duration=SECONDS) for platform in ("fixed", "elastic")}
    each = {name: (item, coefficients()[0]) for name, item in buan.items()}
    for name, (item, known) in {**each, **{name.replace("_", " "): make() for name, make in SCENES.items()}}.items():
        yield name, item, known and remembered(item, known)


def remembered(item: Scene, known: Hydrodynamics) -> Hydrodynamics:
    """Coefficients that a memory fits exactly, and which `FINE` has: that of a fit to the boundary elements'."""
    memory = prepare(with_settings(item, memory_tolerance=FINE["memory_tolerance"]), known).fit
    assert memory is not None, "of floats that radiate"
    Y, infinite, fitted = memory.frequency(known.omega), memory.added_mass_inf, memory.residue.any(axis=0)
    exact = replace(
        known,
        radiation_damping=np.where(fitted, Y.real, known.radiation_damping),
        added_mass=np.where(fitted, infinite - Y.imag / known.omega[:, None, None], known.added_mass),
        added_mass_inf=infinite,
    )
    return replace(exact, memory=memory, memory_tolerance=FINE["memory_tolerance"], memory_motions=of_scene(item))


def table() -> list[float]:
    """Print a row a scene; true errors over estimates."""
    print(HEADER)
    ratios = []
    for name, item, known in cases():
        record, true, what = beside_exact(item, known, item)
        ratios.append(_row(name, true, told(record), what))
    return ratios


def _row(name: str, true: float, estimate: float, what: str) -> float:
    """Print it; the true error over the estimate."""
    print(f"{name:24s}{true:10.1e}{estimate:11.1e}{true / estimate:14.2f}  {what}", flush=True)
    return true / estimate


def beside_exact(item: Scene, known: Hydrodynamics | None, asked: Scene) -> tuple[Record, float, str]:
    """The record of a scene as `asked`, the worst error of any of its means, rms and std, and of what that is."""
    record = simulate(with_settings(asked, keep_series=True), known)
    step = float(record.attrs["time_step"])
    fine = with_settings(item, keep_series=True, time_step=step / FINER, **FINE)
    exact = simulate(replace(fine, platform=fine.platform and fine.platform.cut(CUT)), known)
    same = np.isin(*(np.rint(r.series["time"][1] * 2 * FINER / step) for r in (exact, record)))
    tables = {
        name: (dims, moments(exact.series[name][1][same].reshape(same.sum(), -1)).reshape(values.shape))
        for name, (dims, values) in exact.variables.items()
        if name in exact.series
    }
    true, what = worst(item, record, replace(exact, variables=tables))
    return record, true, what


def bent() -> list[float]:
    """The same where a joint's load jumps or bends, beside the same scene with a shorter step alone."""
    scenes = {"buan, fixed": (scene("fixed"), coefficients()[0]), **{name: SCENES[name]() for name in ("duck", "flap")}}
    print(HEADER)
    ratios = []
    for name, (whole, known) in scenes.items():
        for law in ("coulomb", "latch_load", "force_limit", "one_way"):
            loads = ({law: 1.0 if law == "one_way" else TYPICAL * max(f.per_axis("pto_damping"))} for f in whole.floats)
            floats = tuple(replace(f, **load) for f, load in zip(whole.floats, loads, strict=True))
            low = replace(whole.sea, amplitude=LOW * whole.sea.amplitude)
            item = with_settings(replace(whole, floats=floats, sea=low), duration=SECONDS)
            record = simulate(item, known)
            exact = simulate(with_settings(item, time_step=float(record.attrs["time_step"]) / FINER), known)
            true, what = worst(item, record, exact)
            estimate = together(float(record.attrs[part]) for part in OF_STEPS)
            ratios.append(_row(f"{name}, {law}", true, estimate, what))
    return ratios


def told(record: Record) -> float:
    """The record's estimate of all that `FINE` makes better: without the shares of boundary elements and of samples."""
    return together(float(record.attrs[name]) for name in PARTS)


def tolerances() -> None:
    """Print a row for each scene and error asked for: the true error, the estimate, and the run time."""
    print(f"{'scene':20s}{'asked':>10s}{'true':>10s}{'estimated':>11s}{'step':>9s}{'run time':>12s}  not met")
    for name, item, known in cases():
        for tolerance in TOLERANCES:
            asked = with_settings(item, tolerance=tolerance)
            _, seconds = timed(asked, known)
            record, true, _ = beside_exact(item, known, asked)
            step = record.attrs["time_step"]
            numbers = f"{tolerance:10.0e}{true:10.1e}{told(record):11.1e}{step:9.3g}{seconds:10.2f} s"
            print(f"{name:20s}{numbers}  {record.attrs['unmet']}", flush=True)


if __name__ == "__main__":
    table()
    bent()
    tolerances()
