"""What the boundary element method must solve for a task: one solution for each geometry."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.bridge import platforms, scenes
from pipeline.bridge.hulls import hull, offset
from pipeline.study import seas
from pipeline.study.attachments import CoefficientFile
from pipeline.study.hulls import Hull
from pipeline.study.schema import StudyFile, Water
from pipeline.study.settings import Solver
from pipeline.study.tables import Count, Flag, Number, Positive, Table, Vector
from pipeline.study.words import last
from pipeline.tasks.task import Parameters, canonical, digest
from solver import scene as physics
from solver.hydrodynamics.hull.mesh import plates
from solver.motions import PLANAR, possible
from solver.scene import DOFS, STARTS, is_planar, needs_coefficients, panels_for, stays_in_plane
from solver.sea.dispersion import first_solved

if TYPE_CHECKING:
    from solver.hydrodynamics.bem.coefficients import Hydrodynamics
    from solver.hydrodynamics.bem.problem import Problem

# What a joint's loads are where nothing is said: coefficients do not depend on them.
UNLOADED = {name: value for name, value in STARTS.items() if "." not in name}
MANY = 24  # motions that there are, beyond which the memory's fit takes longer than the boundary elements
BEM_VERSION = 32  # of coefficients, and of the form of their file: raise it when either changes


def of_joints(study: StudyFile) -> set[str]:
    """The axes along which joints' loads alone change: tasks side by side along them share sea and platform."""
    held = (axis.name for axis in study.varied if all(map(_of_joint, axis.keys)))
    return {"pto_damping", *held}


def _of_joint(path: str) -> bool:
    return path.startswith("floats.") and last(path).partition(".")[0] in UNLOADED


class Body(Table):
    """A hull and where its reference point is at rest."""

    hull: Hull
    centre: Vector


class Geometry(Table):
    """All that decides the coefficients of the floats: one BEM solution for each."""

    water: Water
    bodies: tuple[Body, ...]
    band: tuple[Positive, Positive] | None = None
    heading: Number = 0.0
    planar: bool = True  # nothing leaves the plane y = 0
    panels: Count = panels_for(Solver().tolerance)
    interaction: Flag = True  # of several bodies
    gap_damping: Number = 0.0
    gap_width: Number = 0.0
    coefficients: CoefficientFile | None = (
        None  # from a file, whose bodies have these names and must have these motions
    )
    names: tuple[str, ...] = ()
    needed: tuple[tuple[str, ...], ...] = ()  # motions that each body may have; all that are solved for where empty
    memory: bool = True  # whether the radiation memory, of these motions, is fitted along
    far_field: bool = False  # whether the waves far off are known
    plates: bool = False  # a hull is in part thinner than panels: their panels, and what is said of them, are others
    flow: bool = True  # bodies radiate or diffract; without nothing is solved
    outlines: bool = False  # a waterplane has several outlines, round wells or apart: its lid and panels are others

    @property
    def key(self) -> str:
        """Name of the file that keeps the coefficients."""
        return digest(canonical(self.model_dump(mode="json", exclude_defaults=True)), BEM_VERSION)

    @property
    def radiating(self) -> Geometry:
        """The same for waves along +x, all motions and, if that is solved at the same frequencies, waves of any period:
        geometries that share it share all that radiates."""
        if self.coefficients:
            return self
        alike = self.model_copy(update={"heading": 0.0, "needed": ()})
        usual = alike.model_copy(update={"band": None})
        return usual if np.array_equal(_grid(alike), _grid(usual)) else alike


def geometry_of(parameters: Parameters) -> Geometry | None:
    """What the boundary element method must solve for a task, or a file tells; None where nothing depends on it."""
    hulls = [hull(item.hull) for item in parameters.floats]
    given = parameters.coefficients is not None and bool(hulls)  # whether they fit is then judged
    settings = scenes.settings(parameters)
    if not given and not needs_coefficients(settings, hulls, parameters.water.depth):
        return None
    # Tasks that differ in their power take-offs alone share these floats.
    bare = tuple(f.model_copy(update=UNLOADED) for f in parameters.floats)
    floats = scenes.floats(parameters.model_copy(update={"floats": bare}))
    centres = [tuple(map(float, item.centre)) for item in floats]
    flat = is_planar(floats, parameters.waves.heading, scenes.current(parameters.current))
    platform = platforms.platform(parameters) if flat else None
    planar = flat and stays_in_plane(platform, floats, physics.Water(**dict(parameters.water)))
    ways = possible(floats, planar=planar, elastic=parameters.platform is not None)
    place = {
        "water": parameters.water,
        "bodies": tuple(Body(hull=f.hull, centre=at) for f, at in zip(parameters.floats, centres, strict=True)),
        "heading": parameters.waves.heading,
        "planar": planar,
    }
    memory = parameters.solver.method == "time"
    if given:  # a memory asks more of a file
        names, needed = tuple(f.name for f in floats), tuple(tuple(sorted(each)) for each in ways)
        return Geometry(**place, coefficients=parameters.coefficients, names=names, needed=needed, memory=memory)
    panels = panels_for(parameters.solver.tolerance, hulls)
    flow = settings.radiation or settings.diffraction
    all_motions = len(PLANAR if planar else DOFS)
    # One file serves both methods, but for large arrays: the frequency domain has no use for a memory.
    memory = (memory or sum(map(len, ways)) <= MANY) and flow
    some = memory and any(len(each) < all_motions for each in ways)
    least = first_solved(parameters.water.depth, parameters.water.gravity)
    unit = np.sqrt(parameters.water.gravity / max(h.largest_radius for h in hulls))
    return Geometry(
        **place,
        band=seas.band(parameters.sea_state, parameters.waves, least, float(unit)),
        panels=panels,
        interaction=parameters.solver.interaction or len(floats) == 1,
        gap_damping=parameters.solver.gap_damping,
        gap_width=parameters.solver.gap_width,
        needed=ways if some else (),
        memory=memory,
        flow=flow,
        far_field="drift" in parameters.record.outputs,
        plates=any(plates(f.hull, panels) for f in floats),
        outlines=any(f.hull.waterplane_width < np.inf for f in floats),
    )


def given_hydrodynamics(geometry: Geometry, waves: tuple[float, float] | None = None) -> Hydrodynamics:
    """Coefficients from the geometry's file; InputError where they do not fit its floats, or reach waves [rad/s]."""
    from pipeline.bridge.given import reading
    from solver.hydrodynamics.bem.adopted import adopted

    file, water = geometry.coefficients, geometry.water
    assert file is not None, "asked of a geometry that names a file"
    return adopted(
        reading.read(file, water.density, water.gravity),
        tuple(hull(body.hull) for body in geometry.bodies),
        np.array([body.centre for body in geometry.bodies]),
        geometry.names,
        points=np.array([np.subtract(body.centre, offset(body.hull)) for body in geometry.bodies]),
        depth=water.depth,
        density=water.density,
        gravity=water.gravity,
        heading=geometry.heading,
        planar=geometry.planar,
        needed=geometry.needed,
        waves=waves,
        memory=geometry.memory,
    )


def bem_arguments(geometry: Geometry) -> dict[str, Any]:
    """Arguments of solver.hydrodynamics.bem.bem.solve."""
    return {
        **_solved(geometry),
        "density": geometry.water.density,
        "heading": geometry.heading,
        "omega": _grid(geometry),
        "waves_to": waves_to(geometry),
        "planar": geometry.planar,
        "far_field": geometry.far_field,
        "gap_damping": geometry.gap_damping,
        "gap_width": geometry.gap_width,
        "flow": geometry.flow,
    }


def waves_to(geometry: Geometry) -> float:
    """The highest frequency of the waves that its coefficients are for [rad/s]."""
    return geometry.band[1] if geometry.band else np.inf


def _grid(geometry: Geometry) -> np.ndarray:
    """Frequencies that are solved [rad/s]."""
    from solver.hydrodynamics.bem.grid import frequency_grid

    return frequency_grid(**_solved(geometry), band=geometry.band)


def _solved(geometry: Geometry) -> dict[str, Any]:
    """What both ask for."""
    return {
        "hulls": tuple(hull(body.hull) for body in geometry.bodies),
        "centres": np.array([body.centre for body in geometry.bodies]),
        "depth": geometry.water.depth,
        "gravity": geometry.water.gravity,
        "panels": geometry.panels,
        "interaction": geometry.interaction,
    }


def bem_pace() -> float:
    """Time that boundary elements take on this machine over what `bem_time` says."""
    from solver.hydrodynamics.bem import cost

    return cost.pace()


def bem_time(geometry: Geometry) -> float:
    """Processor time [s] that boundary elements will take, to a factor of 3."""
    from solver.hydrodynamics.bem import cost

    return cost.seconds(bem_problem([geometry]))


@lru_cache(maxsize=64)
def require_solvable(geometry: Geometry) -> None:
    """Refuse, with InputError, what boundary elements do not solve."""
    bem_problem([geometry])


def bem_problem(geometries: Sequence[Geometry]) -> Problem:
    """That of geometries that radiate alike; raises InputError."""
    from solver.hydrodynamics.bem.problem import Problem

    arguments = bem_arguments(geometries[0])
    del arguments["heading"]
    return Problem.of(**arguments, headings=tuple(dict.fromkeys(g.heading for g in geometries)))
