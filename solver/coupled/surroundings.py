"""Where the water moves about a frame's stations, and what that loads it with there."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.lines import real_by_complex
from solver.scene import Platform, Water
from solver.sea.field import WaveField
from solver.structure import water
from solver.structure.frame_model import FrameModel, sparse_sum

EVERY = slice(None)
KNOWN = 8  # frames' stations that a process keeps


def normal_flow(
    at: water.Stations, field: WaveField, kept: np.ndarray | slice = EVERY, directions: np.ndarray | slice = EVERY
) -> np.ndarray:
    """Particle velocity normal to the member at each station (ns, 3, n), or at some along some axes."""
    around = surroundings(at, field.sea.heading)
    swing = [lines[around.place[kept], None] for lines in field.swing(around.places)]
    along, up = (part[kept][:, directions, None] for part in (around.along, around.up))
    velocity: np.ndarray = along * swing[0] + up * swing[1]
    return velocity


class Surroundings(NamedTuple):
    """Where the water moves in its own way about ns stations: velocity normal to the members by that of np places."""

    places: np.ndarray  # (np, 3)
    place: np.ndarray  # (ns,) which of them is each station's
    along: np.ndarray  # (ns, 3) normal velocity for unit velocity along the waves' heading
    up: np.ndarray  # (ns, 3) and for unit velocity upward
    normal: sparse.csr_array  # (3 ns, 2 np) of all of them, by those along the heading and upward at all places

    def by_swing(self, size: np.ndarray) -> sparse.csr_array:
        """`size` (ns,) times the normal velocity, (3 ns, 2 np)."""
        scaled = self.normal.copy()
        scaled.data *= np.repeat(np.repeat(size, 3), np.diff(scaled.indptr))
        return scaled

    def std(self, swing: np.ndarray) -> np.ndarray:
        """Of the normal velocity (ns,), of lines (2 np, n) of that along the heading and upward, in quadrature."""
        along, up = np.split(np.sum(swing.real**2 + swing.imag**2, axis=1), 2)
        parts = np.sum(self.along**2, axis=1) * along[self.place], np.sum(self.up**2, axis=1) * up[self.place]
        return np.sqrt(0.5 * sum(parts))


@lru_cache(maxsize=KNOWN)
def surroundings(at: water.Stations, heading: float) -> Surroundings:
    """Legs side by side, and stations above each other in the same wave, share places; none is above still water."""
    direction, normal = np.array([np.cos(heading), np.sin(heading), 0.0]), water.normal_planes(at)
    seen = np.stack([at.position @ direction, np.minimum(at.position[:, 2], 0.0)], axis=1)
    _, first, place = np.unique(seen, axis=0, return_index=True, return_inverse=True)
    along, up, place = normal @ direction, normal[:, :, 2], place.ravel()
    columns = place[:, None, None] + np.array([[0], [len(first)]])
    rows, columns = np.broadcast_arrays(np.arange(along.size).reshape(-1, 1, 3), columns)
    parts = np.stack([along, up], axis=1)
    spread = sparse.csr_array((parts.ravel(), (rows.ravel(), columns.ravel())), (along.size, 2 * len(first)))
    spread.eliminate_zeros()
    return Surroundings(np.minimum(at.position[first], [np.inf, np.inf, 0.0]), place, along, up, spread)


def inertia_size(platform: Platform, at: water.Stations, sea: Water) -> np.ndarray:
    """Wave inertia load on each station over du/dt normal to it [kg]: C_M ρ πD²/4 w, or C_M - 1 of it, (ns,)."""
    coefficient = at.inertia - (1 if platform.wave_inertia == "relative" else 0)
    return coefficient * sea.density * np.pi / 4 * at.diameter**2 * at.weight


def drag_size(at: water.Stations, sea: Water) -> np.ndarray:
    """½ρ C_D D w of each station [kg/m]."""
    return 0.5 * sea.density * at.drag * at.diameter * at.weight


def normal_stream(at: water.Stations, field: WaveField) -> np.ndarray:
    """Velocity of the current normal to the member at each station (ns, 3)."""
    return (water.normal_planes(at) @ field.stream(at.position)[..., None])[..., 0]


def load_of_stream(model: FrameModel, field: WaveField, at: water.Stations, sea: Water) -> np.ndarray:
    """Nodal loads (6n, 1) of the current's drag on the frame at rest, by stations of the drag."""
    flow = normal_stream(at, field)
    load = drag_size(at, sea) * np.linalg.norm(flow, axis=1)
    return onto_nodes(model, at) @ (load[:, None] * flow).reshape(-1, 1)


def nodal_loads(model: FrameModel, at: water.Stations, by_swing: sparse.csr_array, swing: np.ndarray) -> np.ndarray:
    """Nodal loads (6n, n) of point loads at the stations, which are by_swing (3 ns, m) of lines swing (m, n)."""
    return real_by_complex(onto_nodes(model, at) @ by_swing, swing)


@lru_cache(maxsize=KNOWN)
def onto_nodes(model: FrameModel, at: water.Stations) -> sparse.csr_array:
    """Nodal loads of unit point loads at the stations, sparse (6n, 3 ns)."""
    columns = np.arange(3 * len(at.dofs)).reshape(-1, 3)
    spread = sparse_sum(at.shape.transpose(0, 2, 1), at.dofs, columns, (6 * len(model.xyz), columns.size))
    spread.eliminate_zeros()
    return spread
