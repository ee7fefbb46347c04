"""Which of the six motions each float of a scene can have: the others radiate nothing, and need no memory."""

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from solver.scene import DOFS, Float, Scene

PLANAR = DOFS[::2]  # what stays in the plane y = 0
NOTHING = 1e-9  # of a unit axis, and of the places' coordinates: a motion of less is rounding
KNOWN = 256  # chains that a process keeps
# At which a Jacobian is looked at: its entries are analytic, so those that vanish at random vanish throughout.
PLACES = 2

Axis = tuple[bool, tuple[float, ...], tuple[float, ...]]  # whether it turns, its direction, a point of it at rest [m]


def of_scene(scene: Scene) -> tuple[tuple[str, ...], ...]:
    """For each float of a scene, see `possible`."""
    return possible(scene.floats, planar=scene.planar, elastic=scene.platform is not None)


def in_plane(scene: Scene) -> tuple[bool, ...]:
    """Which floats of a scene do not leave the plane y = const that they are in, where waves run along x."""
    along = scene.sea.heading % np.pi == 0
    ways = possible(scene.floats, planar=scene.planar, elastic=scene.platform is not None)
    return tuple(along and set(way) <= set(PLANAR) for way in ways)


def possible(floats: Iterable[Float], *, planar: bool, elastic: bool) -> tuple[tuple[str, ...], ...]:
    """For each float the motions of its reference point that its joint and whatever carries it leave it, anywhere.

    Linear scenes turn by any angle, too. An elastic platform moves what it carries in every way.
    """
    dofs, motions = PLANAR if planar else DOFS, []
    chains: dict[str, tuple[Axis, ...]] = {"": ()}
    for f in floats:
        joint = tuple((name not in DOFS[:3], tuple(f.direction(name).tolist()), tuple(f.hinge)) for name in f.motion)
        chains[f.name] = (*chains[f.on], *joint)
        moved = _moved(chains[f.name], tuple(f.centre.tolist()))
        motions.append(tuple(d for d in dofs if elastic or moved[DOFS.index(d)]))
    return tuple(motions)


@lru_cache(maxsize=KNOWN)
def _moved(chain: tuple[Axis, ...], reference: tuple[float, ...]) -> tuple[bool, ...]:
    """Which rows of the Jacobian of a body at the end of a chain of axes are not zero at every position, (6,)."""
    random, extent = np.random.default_rng(0), 1 + np.abs([reference, *(point for *_, point in chain)]).max()
    rows = [_jacobian(chain, reference, random.uniform(-1, 1, len(chain))) for _ in range(PLACES)]
    return tuple(np.any(np.abs(rows) > NOTHING * extent, axis=(0, 2)).tolist())


def _jacobian(chain: tuple[Axis, ...], reference: tuple[float, ...], at: np.ndarray) -> np.ndarray:
    """Velocity and spin (6, n) of the reference point for unit rates of n axes, at these coordinates."""
    R, s, axes = np.eye(3), np.zeros(3), []  # what was at X at rest is at R X + s
    for (turns, direction, point), moved in zip(chain, at, strict=True):
        e, p = R @ direction, R @ point + s
        axes.append((turns, e, p))
        if turns:
            K = np.cross(e, np.eye(3)).T
            R = R + np.sin(moved) * K @ R + (1 - np.cos(moved)) * K @ K @ R  # Rodrigues
            s = p - R @ point
        else:
            s = s + moved * e
    x = R @ reference + s
    columns = [(*np.cross(e, x - p), *e) if turns else (*e, 0.0, 0.0, 0.0) for turns, e, p in axes]
    return np.reshape(columns, (-1, 6)).T
