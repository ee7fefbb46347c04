"""Drag of the water at a frame's stations, seen by its shapes."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from solver.coupled import forces, stretching
from solver.coupled.places import Places
from solver.coupled.stretching import Stretched
from solver.coupled.surroundings import drag_size, inertia_size, normal_flow, normal_stream
from solver.scene import Platform, Water
from solver.sea.field import WaveField
from solver.structure import water

SAME = 1e-6  # distance to the plane y = 0 that counts as none [m]


class _Drag(NamedTuple):
    """Of the ns stations that count: normal shapes, velocities, coefficients."""

    shape: np.ndarray  # (ns, nd, nm)
    flow: Callable[[WaveField], np.ndarray]  # rows (ns, nd, n)
    size: np.ndarray  # (ns,) ½ρ C_D D w below still water [kg/m]
    stream: np.ndarray  # (nd, ns) of the current
    stretched: Stretched | None  # where waves load them up to their surface
    borne: Callable[[Places], np.ndarray]  # what their drag does to forces asked for


def station_drag(
    field: WaveField,
    at: water.Stations,
    platform: Platform,
    sea: Water,
    shapes: np.ndarray,
    modes: int,
    *,
    planar: bool,
    reach: float,
) -> _Drag:
    """Of the stations of the drag; the first `modes` of the shapes move; waves reach so high if they reach above z = 0.

    In a planar scene a station and its mirror image in y = 0 are loaded alike: one counts twice.
    """
    normal = water.normal_planes(at)
    shape = normal @ at.project(shapes)
    drag, inertia = drag_size(at, sea), inertia_size(platform, at, sea) * (reach > 0)
    y, under = at.position[:, 1], at.position[:, 2] < 0
    if planar:
        drag, inertia = (size * np.where(np.abs(y) < SAME, 1.0, 2.0) for size in (drag, inertia))
    wet = ((drag > 0) | (inertia > 0)) & ((y > -SAME) | (not planar))
    size = np.abs(shape[..., :modes]).max(axis=(0, 2), initial=0)
    moving = size > 1e-9 * size.max()
    borne = partial(forces.of_drag, at=at, kept=wet, directions=moving, planar=planar)
    stream = np.ascontiguousarray(normal_stream(at, field)[wet][:, moving].T)
    flow = partial(normal_flow, at, kept=wet, directions=moving)
    stretched = None
    if reach > 0:
        direction = field.direction
        place, of_place = np.unique(at.position[wet] @ direction, return_inverse=True)
        stretched = Stretched(
            place=place,
            of_place=of_place,
            height=at.position[wet, 2],
            bounds=stretching.wet_bounds(at)[wet],
            along=np.ascontiguousarray((normal @ direction)[wet][:, moving]),
            up=np.ascontiguousarray(normal[wet][:, moving, 2]),
            drag=drag[wet],
            inertia=inertia[wet],
            stream=stream,
            reach=reach,
            extrapolated=platform.wave_stretching == "extrapolated",
        )
    return _Drag(shape[wet][:, moving], flow, (drag * under)[wet], stream, stretched, borne)
