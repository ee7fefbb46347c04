"""One case: through the study's door, the boundary elements, the solver; and what came of it."""

import contextlib
import hashlib
import io
import time
import traceback
from dataclasses import replace
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from pipeline.bridge import cache, checks, scenes
from pipeline.bridge.geometry import Geometry, bem_arguments, geometry_of
from pipeline.study.reading import describe
from pipeline.study.schema import StudyFile
from pipeline.tasks.task import expand
from solver.coupled.blocks import blocks
from solver.coupled.preparation import prepare
from solver.coupled.stages import State
from solver.coupled.system import BLOCK_STEPS
from solver.errors import InputError, SimulationFailed
from solver.hydrodynamics.bem import bem
from solver.hydrodynamics.bem.coefficients import Hydrodynamics
from solver.reference.run import simulate_reference
from solver.run import simulate
from solver.scene import Scene
from studies.stress.matrix import Case, matrix, tables

COEFFICIENTS = cache.Cache(Path("results/stress"))
# Stability is asked for, not the last per cent: a coarse mesh, and frequencies that do for all seas.
PANELS, LOWEST = 243, [0.13, 0.2, 0.3]
FIGURES = (
    "energy_residual", "discretization_error", "estimated_error", "constraint_drift", "work_wave", "time_step",
)  # fmt: skip


def coefficients(geometry: Geometry) -> Hydrodynamics:
    """Of the floats of a geometry; kept in a file, whatever its band."""
    plain = geometry.model_copy(update={"band": (0.7, 3.4)})
    known = COEFFICIENTS.get(plain.key)
    if known is None:
        arguments = bem_arguments(plain)
        arguments |= {"omega": np.concatenate([LOWEST, arguments["omega"]]), "waves_to": np.inf, "panels": PANELS}
        known = cache.encode(bem.solve(**arguments), plain.key)
        COEFFICIENTS.put(plain.key, known)
    return cache.decode(known)


def warm(case_number: int) -> bool:
    """Compute a case's coefficients, so that they are there for all."""
    with contextlib.suppress(InputError):
        built(matrix()[case_number])
    return True


def attempt(case: Case) -> dict[str, object]:
    """Outcome, message and figures of a case; never an exception."""
    start = time.perf_counter()
    row: dict[str, object] = {"family": case.family, "x": case.x, "y": case.y, "outcome": "ok", "message": ""}
    try:
        way = restarted if case.restarts is not None else reference if case.scheme else production
        row |= way(case)
    except InputError as error:
        row |= {"outcome": "refused", "message": str(error)}
    except ValidationError as error:
        row |= {"outcome": "refused", "message": describe(error.errors(include_url=False)[0])}
    except SimulationFailed as error:
        row |= {"outcome": "failed", "message": str(error)}
    except Exception:
        row |= {"outcome": "BROKEN", "message": traceback.format_exc()}
    return row | {"wall_time": time.perf_counter() - start}


def built(case: Case) -> tuple[Scene, Hydrodynamics | None]:
    """Scene and coefficients, through all checks of a study file."""
    content = StudyFile.model_validate(tables(case))
    for problem in checks.problems(content):
        raise problem
    (task,) = expand(content)
    scene, geometry = scenes.scene(task.parameters), geometry_of(task.parameters)
    return case.change(scene) if case.change else scene, coefficients(geometry) if geometry else None


def production(case: Case) -> dict[str, object]:
    """Figures of the record of the production path."""
    result = simulate(*built(case))
    attrs, rotation = result.attrs, result.variables["rotation"][1]
    # Axes that a float does not have are NaN, periods of what nothing holds, as a hinge at a ball's centre, infinite.
    other = ("motion", "system_period")
    finite = all(np.all(np.isfinite(v)) for name, (_, v) in result.variables.items() if name not in other)
    return {
        "outcome": "BROKEN" if not finite else "repeated" if attrs["repeated"] else "ok",
        "message": attrs["repeated"],
        **{name: attrs[name] for name in FIGURES},
        "largest_rotation": float(np.abs(rotation[:, :2]).max()),
        "moved": float(np.max(rotation[:, 0] - rotation[:, 1])),
        "rms_of_rotation": float(rotation[0, 3]),
        "digest": hashlib.sha256(b"".join(v.tobytes() for _, v in result.variables.values())).hexdigest()[:16],
    }


def reference(case: Case) -> dict[str, object]:
    """The reference path against the production path at a step 16 times smaller, same memory and pressure."""
    scene, known = built(case)
    settings = replace(scene.settings, newton_tolerance=1e-12, keep_series=True)
    fine = replace(settings, time_step=settings.time_step / 16)
    exact = simulate(replace(scene, settings=fine), known).series["rotation"][1][15::16]
    kernel = prepare(scene, known).fit
    record = simulate_reference(
        replace(scene, settings=settings), known, kernel=kernel, surface="quadrature", stages=case.scheme
    )
    rotation = record.series["rotation"][1]
    # Three stages leave samples half a step apart, two a whole one.
    every = 2 if case.scheme == 2 else 1
    n = min(len(rotation), len(exact[every - 1 :: every]))
    error = rotation[:n] - exact[every - 1 :: every][:n]
    return {
        "discretization_error": float(np.sqrt(np.mean(error**2) / np.mean(exact**2))),
        "constraint_drift": record.attrs["constraint_drift"], "time_step": settings.time_step,
        "largest_rotation": float(np.abs(rotation).max()),
    }  # fmt: skip


def restarted(case: Case) -> dict[str, object]:
    """Digest of a whole history that stopped `restarts` times and went on from a file."""
    scene, known = built(case)
    system, digest = prepare(scene, known), hashlib.sha256()
    steps = round((scene.settings.discard + scene.settings.duration) / system.dt)
    stops = [steps * n // (case.restarts + 1) // BLOCK_STEPS * BLOCK_STEPS for n in range(1, case.restarts + 1)]
    state, largest = system.start(), 0.0
    for done, until in zip([0, *stops], [*stops, steps], strict=True):
        for _, output, _ in blocks(system, state, until, done):
            for values in output[:-1]:  # the last, of steps that are cut, has room to spare
                digest.update(values.tobytes())
            largest = max(largest, float(np.abs(output.z).max()))
        file = io.BytesIO()
        np.savez(file, **state._asdict())
        file.seek(0)
        with np.load(file) as saved:
            state = State(**saved)
    return {"digest": digest.hexdigest()[:16], "largest_rotation": largest, "time_step": system.dt}
