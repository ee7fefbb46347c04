"""What workers run: coefficients of a geometry, and tasks. Workers compute and return bytes."""

from __future__ import annotations

import pickle
import time
import traceback
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline import environment, interrupt
from pipeline.bridge.geometry import Geometry, bem_problem, geometry_of, given_hydrodynamics, require_solvable, waves_to
from pipeline.bridge.hulls import hull, offset
from pipeline.results.packs import Made, Row, packed
from pipeline.tasks.task import Parameters
from solver.errors import InputError, SimulationFailed

if TYPE_CHECKING:
    from pipeline.results.records import Record
    from solver.hydrodynamics.bem.coefficients import Hydrodynamics
    from solver.record import channels
    from solver.scene import Scene

Share = Any  # of what boundary elements solve, see solver.hydrodynamics.bem.bem.part; None for coefficients from a file


@dataclass(frozen=True, kw_only=True)
class Failure:
    """Why a task has no record."""

    kind: str
    message: str
    traceback: str

    @classmethod
    def of(cls, error: BaseException) -> Failure:
        """From an exception, with its traceback."""
        text = "".join(traceback.format_exception(error))
        return cls(kind=type(error).__name__, message=str(error), traceback=text)


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What comes back from a worker: bytes of a file, or a failure; and how it came about."""

    result: bytes | Row | Failure
    content: str = ""  # digest of the record's values
    unmet: str = ""  # what was asked of the record and not met
    warnings: str = ""  # what is odd about it
    wall_time: float = 0.0  # [s]
    log: tuple[str, ...] = ()  # warnings on the way
    provenance: dict[str, str]


def hydrodynamics(geometry: Geometry) -> Hydrodynamics:
    """Coefficients of the floats of one geometry, with their memory."""
    return _known([geometry], [share([geometry])])[0]


def share(geometries: Sequence[Geometry], first: int = 0, step: int = 1) -> Share:
    """What boundary elements solve for geometries that radiate alike, at every `step`-th frequency."""
    from solver.hydrodynamics.bem import bem

    return None if geometries[0].coefficients else bem.part(bem_problem(geometries), first, step)


def _known(geometries: Sequence[Geometry], shares: Sequence[Share]) -> list[Hydrodynamics]:
    """Coefficients by boundary elements or from a file, and their memory as scenes use it.

    That, and what rings between the floats, is found here, once, and not by each task: fitting amplifies rounding, and
    other machines round otherwise.
    """
    from solver.coupled.preparation import remembering
    from solver.hydrodynamics.bem import bem

    first, whole = geometries[0], []
    if first.coefficients:
        found = [given_hydrodynamics(geometry) for geometry in geometries]
    else:
        problem = bem_problem(geometries)
        each = dict(zip(problem.headings, bem.united(problem, shares), strict=True))
        found = [replace(each[geometry.heading], waves_to=waves_to(geometry)) for geometry in geometries]
    hulls = tuple(hull(body.hull) for body in first.bodies)
    alike: dict[Any, Hydrodynamics] = {}
    for one, geometry in zip(found, geometries, strict=True):
        key = one.waves_to, geometry.needed  # headings share what radiates
        if key not in alike:
            try:
                alike[key] = remembering(one, hulls, geometry.needed) if first.memory else one
            except SimulationFailed:  # said by the task that needs it
                alike[key] = one
        radiating = alike[key]
        memory = {name: getattr(radiating, name) for name in ("memory", "memory_tolerance", "memory_motions")}
        own = one.first(radiating.omega.size)
        # Rings are each heading's own, which its forces judge.
        whole.append(replace(own, rings=(own.ringing, own.shifted.ringing), **memory))
    return whole


def simulate(scene: Scene, hydrodynamics: Hydrodynamics | None) -> channels.Record:
    """Statistics of one simulation."""
    from solver.run import simulate

    return simulate(scene, hydrodynamics)


def coefficients(geometries: Sequence[Geometry], shares: Sequence[Share]) -> list[bytes]:
    """The files of coefficients of geometries that radiate alike, from all shares of what was solved."""
    from pipeline.bridge import cache

    known = _known(geometries, shares)
    return [cache.encode(one, geometry.key) for one, geometry in zip(known, geometries, strict=True)]


@cache
def import_solver() -> None:
    """What a task needs, all at once and once a process."""
    with environment.importing():
        for name in ("solver.run", "pipeline.bridge.cache", "pipeline.bridge.scenes", "pipeline.results.records"):
            import_module(name)


def compute(parameters: Parameters, coefficients: bytes | None) -> Record:
    """One task, from its parameters and its geometry's file."""
    import_solver()
    from pipeline.bridge import cache, scenes

    known, scene = cache.decode(coefficients) if coefficients else None, scenes.scene(parameters)
    record = simulate(scene, known)
    sought = {name for item in parameters.floats for name in scenes.found(item)}
    if sought - {"hold"}:
        mass, cog = (np.array([getattr(f, name) for f in scene.floats]) for name in ("mass", "cog"))
        cog = cog + [offset(item.hull) for item in parameters.floats]  # from the study's reference points
        told = {"mass": (("float",), mass), "cog": (("float", "direction"), cog)}
        record = replace(record, variables={**record.variables, **told})
    if "hold" in sought and any(f.motion for f in scene.floats):
        from solver.record.channels import Channels

        channels, preload = Channels(scene, None), np.concatenate([f.per_axis("preload") for f in scene.floats])
        told = {"preload": (("float", "axis"), channels.by_axis(preload[None])[0])}
        coords = {**record.coords, "axis": np.array(channels.axes)}
        record = replace(record, variables={**record.variables, **told}, coords=coords)
    return record


def judge(parameters: Parameters) -> Sequence[str]:
    """Build a task's scene, and the frequencies of its coefficients; what is odd about it. Raises InputError."""
    from pipeline.bridge import scenes
    from solver.oddities import warnings
    from solver.scene import require_waves

    scene = scenes.scene(parameters)
    require_waves(scene)
    geometry = geometry_of(parameters)
    if geometry and geometry.coefficients:
        if "drift" in scene.settings.outputs:
            raise InputError("settings.outputs", "drift", "needs boundary elements: no file knows the waves far off")
        omega = scene.sea.omega
        given_hydrodynamics(geometry, (omega.min(), omega.max()) if scene.sea.amplitude.any() else None)
    elif geometry:
        require_solvable(geometry)
    return warnings(scene)


def reduce(parameters: Parameters) -> None:
    """Reduce a task's platform as the solver will, but for its floats, which need coefficients; raises InputError."""
    from pipeline.bridge import scenes
    from solver.coupled.preparation import prepare

    if parameters.platform:
        scene = scenes.scene(parameters)
        prepare(replace(scene, floats=(), settings=scene.settings.paths), None)


def statics(parameters: Parameters) -> str:
    """Why a task will end where it begins, for its floats do not rest in still water; empty where they do."""
    from pipeline.bridge import scenes
    from solver.coupled.statics import statics

    scene = scenes.scene(parameters)
    known = None
    if parameters.coefficients and (geometry := geometry_of(parameters)):
        known = given_hydrodynamics(geometry)
    return statics(scene, known)


@dataclass(frozen=True, kw_only=True)
class Engine:
    """The physics as a few functions, so that the pipeline can be tested and timed without it."""

    share: Callable[[Sequence[Geometry], int, int], Share] = share
    coefficients: Callable[[Sequence[Geometry], Sequence[Share]], list[bytes]] = coefficients
    compute: Callable[[Parameters, bytes | None], Record] = compute
    judge: Callable[[Parameters], Sequence[str] | None] = judge
    reduce: Callable[[Parameters], None] = reduce
    statics: Callable[[Parameters], str | None] = statics


class _Made(NamedTuple):
    """What a piece of work returns: a file, the digest of its content, what was asked and not met, what is odd."""

    result: bytes | Row | Failure
    content: str = ""
    unmet: str = ""
    warnings: str = ""


def attempt_share(engine: Engine, geometries: Sequence[Geometry], first: int, step: int) -> list[Outcome]:
    """A share of what is solved for coefficients, pickled, or why there is none."""
    environment.prepare()
    return [_attempt(lambda: _Made(pickle.dumps(engine.share(geometries, first, step))))]


def attempt_coefficients(engine: Engine, geometries: Sequence[Geometry], shares: Sequence[bytes]) -> list[Outcome]:
    """Coefficients of each geometry, or why there are none."""
    environment.prepare()
    made: list[bytes] = []

    def first() -> _Made:
        made.extend(engine.coefficients(geometries, [pickle.loads(share) for share in shares]))
        return _Made(made[0])

    outcome = _attempt(first)
    return [replace(outcome, result=made[n]) if made else outcome for n in range(len(geometries))]


def attempt_statics(engine: Engine, tasks: Sequence[Parameters]) -> list[Outcome]:
    """For each task as a warning why it will end where it begins, if it will."""
    environment.prepare()
    return [_attempt(partial(_statics, engine, task)) for task in tasks]


def _statics(engine: Engine, parameters: Parameters) -> _Made:
    return _Made(b"", warnings=engine.statics(parameters) or "")


def attempt_tasks(engine: Engine, tasks: Sequence[tuple[str, Parameters]], coefficients: bytes | None) -> list[Outcome]:
    """For each task a record's file, or its row in a pack with others of them, or why there is none."""
    environment.prepare()
    together: list[Made] | None = [] if len(tasks) > 1 else None
    outcomes = [_attempt(partial(_record, engine, coefficients, *task, together)) for task in tasks]
    rows = packed(together or ())
    return [replace(o, result=rows[o.result.number]) if isinstance(o.result, Row) else o for o in outcomes]


def _record(
    engine: Engine, coefficients: bytes | None, task_id: str, parameters: Parameters, together: list[Made] | None
) -> _Made:
    """A record's file; or its number among those that go together, if any do and it takes milliseconds."""
    from pipeline.results import records
    from pipeline.results.netcdf import to_bytes

    provenance = environment.provenance() | {"task": task_id}
    record = engine.compute(parameters, coefficients)
    made, content = records.made(record, parameters, provenance)
    notes = [str(record.attrs.get(name, "")) for name in ("unmet", "warnings")]
    if together is None or parameters.solver.method != "frequency":
        return _Made(to_bytes(*made), content, *notes)
    together.append(made)
    return _Made(Row("", len(together) - 1, b""), content, *notes)


def _attempt(work: Callable[[], _Made]) -> Outcome:
    """A failure is a result like any other: it must not stop the tasks beside it."""
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        try:
            made = work()
        except Exception as error:
            interrupt.check()  # of which it may have come
            made = _Made(Failure.of(error))
    seconds = time.perf_counter() - start
    log = tuple(f"{w.category.__name__}: {w.message}" for w in caught)
    return Outcome(**made._asdict(), wall_time=seconds, log=log, provenance=environment.provenance())
