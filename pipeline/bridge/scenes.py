"""Parameters of a task -> the solver's frozen inputs.

The only translation, with `hulls` and `platforms`; `objections` translates what the solver says of them back.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

from pipeline.bridge import realizations
from pipeline.bridge.hulls import hull, offset
from pipeline.bridge.objections import renamed, under
from pipeline.bridge.platforms import platform
from pipeline.study import columns
from pipeline.study.attachments import Attachment
from pipeline.study.floats import Float
from pipeline.study.schema import Current, StudyFile, Water
from pipeline.study.seas import SeaState, Waves
from pipeline.study.settings import Recording, Solver
from pipeline.tasks.task import Parameters, wave_seed
from solver.errors import InputError, refuse

if TYPE_CHECKING:
    import numpy as np

    from solver import scene as physics
    from solver.power_takeoff import PtoTable
    from solver.sea.current import Current as Stream
    from solver.sea.realization import Realization

FOUND = "balance"  # in place of a number: found from weight and buoyancy


def scene(parameters: Parameters, waves: Realization | None = None) -> physics.Scene:
    """Everything that one simulation needs; `waves` in place of the task's, if any."""
    from solver import scene as physics

    return physics.Scene(
        water=physics.Water(**dict(parameters.water)),
        sea=waves or sea(parameters),
        current=current(parameters.current),
        floats=floats(parameters),
        platform=platform(parameters),
        settings=settings(parameters),
    )


def settings(made: Parameters | StudyFile) -> physics.Settings:
    """Record and numerics; how series are thinned is decided in `results.records`."""
    return _settings(made.record, made.solver)


@lru_cache(maxsize=64)
def _settings(recording: Recording, solver: Solver) -> physics.Settings:
    from solver import scene as physics

    knobs = {**dict(recording), **dict(solver)}
    kinds = {"fatigue": physics.Fatigue, "utilisation": physics.Utilisation}
    rules = {name: kind(**dict(knobs.pop(name))) for name, kind in kinds.items()}
    try:
        return physics.Settings(keep_series=knobs.pop("series") != "none", **rules, **knobs)
    except InputError as first:
        series = partial(InputError, "record.series", recording.series)
        refuse(series(e.limit) if e.key == "settings.keep_series" else e for e in (first, *first.others))
        raise


def sea(parameters: Parameters) -> Realization:
    """The realization of the sea that belongs to the task's sea state and seed."""
    return _sea(parameters.sea_state, parameters.waves, wave_seed(parameters))


@lru_cache(maxsize=16)
def _sea(sea_state: SeaState, waves: Waves, seed: tuple[int, ...]) -> Realization:
    """Tasks in the same waves share them, and what the solver makes of them."""
    return realizations.realize(sea_state, waves, seed)


@lru_cache(maxsize=1024)
def floating(item: Float) -> physics.Float:
    """The solver's float for a table of [[floats]], with stand-ins for what is found; tasks alike in it share it."""
    from solver import scene as physics
    from solver.mooring import Line, Mooring
    from solver.power_takeoff import PtoEfficiency

    kinds: dict[str, Callable[..., object]] = {
        "end_stops": physics.EndStops,
        "mooring": Mooring,
        "pto_efficiency": PtoEfficiency,
        "pto_table": pto_table,
        "pto_law": pto_law,
    }
    with under(f"floats.{item.name}."):  # a hull does not know whose it is
        parts = {name: of(**dict(table)) for name, of in kinds.items() if (table := getattr(item, name)) is not None}
        parts["hull"] = hull(item.hull)
        parts["lines"] = tuple(Line(**dict(table)) for table in item.lines)
    if law := parts.pop("pto_law", None):
        if item.pto_table:
            raise InputError(f"floats.{item.name}.pto_law", "given", "must be left out beside pto_table")
        parts["pto_table"] = law
    x, y, z = (0.0 if place == FOUND else place for place in item.cog)
    parts |= {"mass": 1.0 if item.mass == FOUND else item.mass, "cog": (x, y, z)}
    given: dict[str, Any] = {name: value for name, value in item if name not in ("pto_law", "hold")}
    given |= parts
    if (away := offset(item.hull)).any():
        given |= _from(away, given)
    # A table is what the solver knows of a law, too.
    with renamed(lambda key: key.replace(".pto_table", ".pto_law") if law else key):
        return physics.Float(**given)


def _from(away: np.ndarray, parts: dict[str, Any]) -> dict[str, Any]:
    """Those parts of a float that say where something is, of a reference point that is so far `away` (3,) [m]."""
    moved = {
        "arm": tuple((parts["arm"] + away).tolist()),
        "cog": tuple((parts["cog"] - away).tolist()),
        "lines": tuple(replace(line, fairlead=tuple((line.fairlead - away).tolist())) for line in parts["lines"]),
    }
    if mooring := parts["mooring"]:
        moved["mooring"] = replace(mooring, point=tuple((mooring.point - away).tolist()))
    return moved


def bent(item: Float) -> bool:
    """Whether power take-off or end stops of a float have more than one zone, so that its motion is not linear."""
    from solver.coupled.assembly import joint_law
    from solver.multibody import of_axes

    return bool(of_axes.bent(joint_law((floating(item),))).any())


def floats(parameters: Parameters) -> tuple[physics.Float, ...]:
    """The solver's floats of a task, with what is found from weight and buoyancy."""
    given, sought = tuple(map(floating, parameters.floats)), tuple(map(found, parameters.floats))
    if not any(sought):
        return given
    from solver import scene as physics
    from solver.balance import balanced

    return balanced(given, physics.Water(**dict(parameters.water)), sought)


def found(item: Float) -> tuple[str, ...]:
    """Of mass, place of the c.o.g. and preloads ("hold"), what is found from weight and buoyancy."""
    balanced = ("mass", item.mass), *zip("xy", item.cog[:2], strict=True)
    return (*(name for name, value in balanced if value == FOUND), *(["hold"] if item.hold else ()))


def pto_table(file: Attachment, axis: str) -> PtoTable:
    """The solver's table for a file of rates and loads, or of positions, rates and loads in any order."""
    import numpy as np

    from solver.power_takeoff import PtoTable

    with under("pto_table.", "pto_table."):
        if "position" not in columns.among(file, ("position", "velocity", "force")):
            v, f = columns.read(file, ("velocity", "force")).values()
            return PtoTable(velocity=tuple(v.tolist()), force=tuple(f.tolist()), axis=axis)
        y, v, f = columns.read(file, ("position", "velocity", "force")).values()
        places, rates = np.unique(y), np.unique(v)
        order = np.lexsort((v, y))
        whole = np.array([(a, b) for a in places for b in rates]) if f.size == places.size * rates.size else None
        if whole is None or not np.array_equal(whole, np.stack([y, v], axis=1)[order]):
            limit = f"needs one load for each of {rates.size} velocities at each of {places.size} positions"
            raise InputError("file", file, f"{limit}; has {f.size} lines")
        force = tuple(f[order].tolist())
        return PtoTable(position=tuple(places.tolist()), velocity=tuple(rates.tolist()), force=force, axis=axis)


def pto_law(
    file: Attachment,
    velocity: tuple[float, float],
    position: tuple[float, float] | None,
    error: float,
    parameters: tuple[float, ...],
    axis: str,
) -> PtoTable:
    """The solver's table for a user's function."""
    from pipeline.bridge.pto_law import table

    with under("pto_law.", "pto_table."):
        return table(file, velocity, position, error, parameters, axis)


@lru_cache(maxsize=64)
def current(table: Current | None) -> Stream | None:
    """The solver's current for the table [current]."""
    from solver.sea.current import Current as Stream
    from solver.sea.current import CurrentSpeed

    if table is None:
        return None
    return Stream(**{**dict(table), "profile": tuple(CurrentSpeed(**dict(line)) for line in table.profile)})


def in_place(item: Float, water: Water) -> None:
    """Refuse a float that reaches the seabed or is not at still water."""
    from solver import scene as physics

    refuse(physics.out_of_place(floating(item), physics.Water(**dict(water))))
