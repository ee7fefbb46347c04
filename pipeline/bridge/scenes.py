"""Parameters of a task -> the solver's frozen inputs, and its objections to them -> keys of the study file.

The only translation between the two.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, assert_never

from pipeline.bridge import realizations
from pipeline.study import columns
from pipeline.study.attachments import Attachment
from pipeline.study.floats import Float
from pipeline.study.hulls import (
    BoxHull,
    Duck,
    HemisphereCylinder,
    Hull,
    PanelMesh,
    Profile,
    Ring,
    Sphere,
    VerticalCylinder,
)
from pipeline.study.layout import HINGE
from pipeline.study.platform import LoadHistory, Member, Platform, Section, Tube
from pipeline.study.schema import Current, Water
from pipeline.study.seas import SeaState, Waves
from pipeline.study.settings import Recording, Solver
from pipeline.study.tables import Same, Vector
from pipeline.tasks.task import Parameters, wave_seed
from solver.errors import InputError, refuse

if TYPE_CHECKING:
    import numpy as np

    from solver import scene as physics
    from solver.hydrodynamics.hull.panel_hull import PanelHull
    from solver.hydrodynamics.hull.revolution import Revolution
    from solver.power_takeoff import PtoTable
    from solver.sea.current import Current as Stream
    from solver.sea.realization import Realization
    from solver.structure import beam, members
    from solver.structure.load_history import LoadHistory as History


FORCES = ("Fx", "Fy", "Fz")
FOUND = "balance"  # in place of a number: found from weight and buoyancy
CENTRED = 1e-4  # of a hull's size: as near its reference point its centre of buoyancy counts as above each other
# First word of a key of the solver's -> where a study file has it.
PLACES = {"band": "waves.band", "components": "waves.components"}


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


def objections(build: Callable[[], object]) -> Iterator[InputError]:
    """What the solver has against that which `build` makes of a study, under the study file's key."""
    try:
        build()
    except InputError as first:
        for error in (first, *first.others):
            yield InputError(_key(error.key), _as_written(error.value), error.limit)


def _as_written(value: object) -> object:
    """Lists as a study file has them."""
    return [_as_written(item) for item in value] if isinstance(value, tuple) else value


def _key(theirs: str) -> str:
    """settings.time_step -> solver.time_step; band -> waves.band."""
    first, dot, rest = theirs.partition(".")
    if first == "settings":
        table = "record" if rest.partition(".")[0] in Recording.model_fields else "solver"
        return f"{table}.{rest}"
    return PLACES.get(first, first) + dot + rest


@contextmanager
def _renamed(name: Callable[[str], str]) -> Iterator[None]:
    """Pass on objections to the solver's keys under the study file's."""
    try:
        yield
    except InputError as first:
        refuse(InputError(name(e.key), e.value, e.limit) for e in (first, *first.others))


def _part(place: str, word: str = "") -> AbstractContextManager[None]:
    """Pass on objections to a part, with `place` before the key and without the word that the solver has there."""
    return _renamed(lambda key: place + key.removeprefix(word))


def settings(parameters: Parameters) -> physics.Settings:
    """Record and numerics; how series are thinned is decided in `results.records`."""
    return _settings(parameters.record, parameters.solver)


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


@lru_cache(maxsize=64)
def hull(shape: Hull) -> Revolution | PanelHull:
    """The solver's hull for a hull table, about its own reference point: see `offset`."""
    from solver.hydrodynamics.hull.panel_hull import PanelHull

    made, away = _as_described(shape), offset(shape)
    return made.moved(-away) if isinstance(made, PanelHull) and away.any() else made


@lru_cache(maxsize=64)
def offset(shape: Hull) -> np.ndarray:
    """From the reference point of a hull table to the solver's (3,) [m], at still water above the centre of buoyancy.

    Diffraction, radiation and linear buoyancy are loads there, which keep their directions as a float turns: at the
    table's, answers of large motions would go with where a file of the same hull has its origin.
    """
    import numpy as np

    from solver.hydrodynamics.hull.panel_hull import PanelHull
    from solver.keys import shared

    made, at = _as_described(shape), np.zeros(3)
    if isinstance(made, PanelHull):
        at[:2] = made.buoyancy_point[:2]
        at[np.abs(at) < CENTRED * np.ptp(made.vertices, axis=0).max()] = 0.0
    return shared(at)


@lru_cache(maxsize=64)
def _as_described(shape: Hull) -> Revolution | PanelHull:
    """About the reference point of its table."""
    from solver.hydrodynamics.hull.box import box
    from solver.hydrodynamics.hull.duck import duck
    from solver.hydrodynamics.hull.revolution import Revolution
    from solver.hydrodynamics.hull.ring import ring

    match shape:
        case HemisphereCylinder():
            return Revolution.hemisphere_cylinder(radius=shape.radius, height=shape.height)
        case Sphere():
            return Revolution.sphere(radius=shape.radius, draft=shape.draft)
        case VerticalCylinder():
            return Revolution.vertical_cylinder(radius=shape.radius, draft=shape.draft, freeboard=shape.freeboard)
        case Profile():
            return Revolution.profile(shape.points)
        case Ring():
            return ring(shape.points)
        case BoxHull():
            return box(**shape.model_dump(exclude={"shape"}))
        case Duck():
            return duck(**shape.model_dump(exclude={"shape"}))
        case PanelMesh():
            return _panel_hull(shape.file, shape.origin, shape.rotation, shape.scale)
        case _:
            assert_never(shape)


@lru_cache(maxsize=16)
def _panel_hull(file: Attachment, origin: Vector, rotation: Vector, scale: float) -> PanelHull:
    """The hull in a mesh file; what was mended is in its notes, which the solver tells with all else that is odd."""
    from solver.hydrodynamics.hull import meshfile, surface
    from solver.hydrodynamics.hull.panel_hull import PanelHull

    vertices, faces = meshfile.read(file.name, file.data)
    if any((*origin, *rotation)) or scale != 1:
        vertices = surface.placed(vertices, origin, rotation, scale)
    return PanelHull.of(vertices, faces, name=file.name)


def outline(shape: Hull) -> list[tuple[float, float]]:
    """A hull at rest seen along y, x and z from its reference point [m]."""
    import numpy as np

    from solver.hydrodynamics.hull.revolution import Revolution

    seen = hull(shape)
    if not isinstance(seen, Revolution):
        return [(float(r), float(h)) for r, h in seen.silhouette]
    points = np.concatenate([s.at(np.linspace(0, 1, 33)) for s in seen.meridian])
    right = [(float(r), float(h)) for r, h in points]
    return right + [(-r, h) for r, h in reversed(right)]


def plan(shape: Hull) -> tuple[np.ndarray, np.ndarray]:
    """A hull at rest seen from above: panels below still water (n, k, 2), segments (ns, 2, 2) where it meets that.

    From its reference point [m].
    """
    import numpy as np

    from solver.hydrodynamics.hull.revolution import Revolution

    seen = hull(shape)
    if not isinstance(seen, Revolution):
        return seen.wetted[:, :, :2], seen.waterline
    angle = np.linspace(0, 2 * np.pi, 65)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    water = np.sqrt(max(seen.waterplane[0], 0.0) / np.pi) * circle
    return seen.largest_radius * circle[None], np.stack([water[:-1], water[1:]], axis=1)


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
    with _part(f"floats.{item.name}."):  # a hull does not know whose it is
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
    with _renamed(lambda key: key.replace(".pto_table", ".pto_law") if law else key):
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

    with _part("pto_table.", "pto_table."):
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

    with _part("pto_law.", "pto_table."):
        return table(file, velocity, position, error, parameters, axis)


@lru_cache(maxsize=64)
def current(table: Current | None) -> Stream | None:
    """The solver's current for the table [current]."""
    from solver.sea.current import Current as Stream
    from solver.sea.current import CurrentSpeed

    if table is None:
        return None
    return Stream(**{**dict(table), "profile": tuple(CurrentSpeed(**dict(line)) for line in table.profile)})


@lru_cache(maxsize=64)
def load_history(table: LoadHistory) -> History:
    """The solver's load for a table of [[platform.load_histories]]."""
    import numpy as np

    from solver.structure.load_history import LoadHistory as History

    with _part(f"platform.load_histories.{table.node}.", f"load_histories.{table.node}."):
        there = [name for name in columns.among(table.file, ("time", *FORCES)) if name in FORCES]
        if not there:
            raise InputError("file", table.file, f"needs a column of {', '.join(FORCES)} in its header")
        read = columns.read(table.file, ("time", *dict.fromkeys(there)))
        time = read["time"]
        columns.require_rising(table.file, "time", time)
        force = np.stack([read.get(name, np.zeros(time.size)) for name in FORCES], axis=-1)
        return History(node=table.node, time=time, force=force)


def in_place(item: Float, water: Water) -> None:
    """Refuse a float that reaches the seabed or is not at still water."""
    from solver import scene as physics

    refuse(physics.out_of_place(floating(item), physics.Water(**dict(water))))


def platform(parameters: Parameters) -> physics.Platform | None:
    """The solver's platform for the table [platform], whose nodes include the hinges of the floats."""
    if (table := parameters.platform) is None:
        return None
    from solver import scene as physics

    sea = physics.Water(**dict(parameters.water))
    return _platform(Same(table), tuple(f.name for f in parameters.floats), sea)


@lru_cache(maxsize=16)
def _platform(same: Same[Platform], floats: tuple[str, ...], sea: physics.Water) -> physics.Platform:
    from solver import scene as physics
    from solver.structure.fineness import divided
    from solver.structure.frame import Frame
    from solver.structure.members import MarineGrowth, PointLoad, PointMass
    from solver.structure.soil import Soil, SoilSpring

    table = same.table
    members = tuple(member(m, table) for m in table.members)
    undivided = {m.name for m in table.members if m.elements is None}
    with _part("platform."):
        springs = tuple(SoilSpring(**dict(line)) for line in table.soil)
        frame = Frame(
            nodes=table.nodes,
            members=members,
            clamped=table.clamped,
            masses=tuple(PointMass(**dict(m)) for m in table.masses),
            loads=tuple(PointLoad(**dict(p)) for p in table.loads),
            growth=tuple(MarineGrowth(**dict(line)) for line in table.marine_growth),
            foundation=table.foundation,
            soil=Soil(seabed=-sea.depth, springs=springs) if springs else None,
        )
        frame = divided(frame, undivided, density=sea.density, gravity=sea.gravity)
    return physics.Platform(
        frame=frame,
        legs=table.legs,
        damping_ratio=table.damping_ratio,
        damping_of=table.damping_of,
        rayleigh_mass=table.rayleigh_mass,
        rayleigh_stiffness=table.rayleigh_stiffness,
        hinge_nodes={name: HINGE + name for name in floats},
        load_histories=tuple(map(load_history, table.load_histories)),
        geometric_stiffness=table.geometric_stiffness,
        wave_inertia=table.wave_inertia,
        wave_stretching=table.wave_stretching,
    )


def member(item: Member, table: Platform) -> members.Member:
    """The solver's member for a table of [[platform.members]], in one piece where it does not say."""
    from solver.structure import members

    key = f"platform.members.{item.name}"
    material = members.Material(**dict(table.materials[_known(f"{key}.material", item.material, table.materials)]))
    parts: dict[str, Any] = {"material": material, "elements": item.elements or 1}
    for name, given in (("section", item.section), ("end_section", item.end_section)):
        if given is not None:
            shape = table.sections[_known(f"{key}.{name}", given, table.sections)]
            parts[name] = replace(section(given, table), shear_factor=_shear_factor(shape, material))
    with _part("platform."):
        return members.Member(**{**dict(item), **parts})


def _known(key: str, name: str, table: Collection[str]) -> str:
    if name not in table:
        raise InputError(key, name, f"must be one of {', '.join(table)}")
    return name


def _shear_factor(shape: Section, material: members.Material) -> float | None:
    """Timoshenko's κ of a section's table; Cowper's goes by the material's Poisson's ratio."""
    from solver.structure import beam

    if shape.shear_factor != "cowper":
        return shape.shear_factor
    if isinstance(shape, Tube):
        return beam.tube_shear_factor(shape.diameter, shape.thickness, material.poisson)
    return beam.rectangle_shear_factor(material.poisson)


def section(name: str, table: Platform) -> beam.Section:
    """The solver's cross section for a table of [platform.sections], which shears by its member's material."""
    from solver.structure import beam

    numbers = {key: value for key, value in table.sections[name] if key not in ("shape", "shear_factor")}
    with _part(f"platform.sections.{name}.", "section."):
        return beam.MAKERS[table.sections[name].shape](**numbers)
