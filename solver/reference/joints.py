"""Holonomic constraints between frames, their Jacobian C_u and Q_d: eqs. 4-7 of Heo et al. (2022).

A frame is a rigid body, or a support that moves in a prescribed way. Every joint is made of three kinds
of equations; with s = R u the lever of a point and a, b directions fixed in frames i, j:
    POINT  x_i + s_i - x_j - s_j = 0          (3 rows: two points coincide)
    SQUARE a·b = 0                            (1 row: two directions stay perpendicular)
    PLANE  a·(x_j + s_j - x_i - s_i) = 0      (1 row: point j stays in a plane of frame i)
The hinge of the paper is one POINT and two SQUAREs. Rows are differentiated with respect to
velocity and angular velocity (world axes), not to Euler angles: C_u is then short and never singular.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from solver.errors import InputError
from solver.kernels import kernel

POINT, SQUARE, PLANE = 0, 1, 2
GROUND = -1  # frames are numbered: bodies, supports, and the ground as the last


class Frames(NamedTuple):
    """Positions (nf, 3) [m], rotations (nf, 3, 3), velocities and accelerations (nf, 6) of all frames."""

    position: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


class Equations(NamedTuple):
    """All constraint rows: kind (ne,), frames (ne, 2), first row (ne,), points (ne, 2, 3), directions (ne, 2, 3)."""

    kind: np.ndarray
    frame: np.ndarray
    row: np.ndarray
    point: np.ndarray
    direction: np.ndarray
    joint: np.ndarray  # (ne,) number of the joint that the equation belongs to
    second: np.ndarray  # (ne,) which of the two frames, 0 or 1, is the joint's second


@dataclass(frozen=True, slots=True, kw_only=True)
class Ball:
    """Frames share a point; its place in space at the start."""

    first: int
    second: int
    point: tuple[float, float, float]  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hinge:
    """Frames share a point and an axis, in space at the start: five constraints."""

    first: int
    second: int
    point: tuple[float, float, float]  # [m]
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Guide:
    """The second frame slides along a direction fixed in the first and does not turn: five constraints."""

    first: int
    second: int
    point: tuple[float, float, float]  # [m]
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class AxesJoint:
    """The second frame slides along `slides` and turns about `turns`, in that order, through a shared point.

    Directions in space at the start; slides are fixed in the first frame, or move with the second one
    (`inner`); of two turns the first is fixed in the first and the other, at right angles, in the second frame.
    """

    first: int
    second: int
    point: tuple[float, float, float]  # [m]
    slides: tuple[tuple[float, float, float], ...] = ()
    turns: tuple[tuple[float, float, float], ...] = ()
    inner: bool = False


Part = tuple[int, np.ndarray, np.ndarray, bool]  # see _parts
Joint = Ball | Hinge | Guide | AxesJoint


def equations(joints: tuple[Joint, ...], frames: Frames) -> Equations:
    """Rows of all joints from the frames' poses at the start."""
    table, row = [], 0
    for number, joint in enumerate(joints):
        for kind, a, b, inner in _parts(joint):
            pair = [joint.first % len(frames.position), joint.second % len(frames.position)]
            pair = pair[::-1] if inner else pair
            R = frames.rotation[pair]
            points = np.einsum("nji,nj->ni", R, np.asarray(joint.point, float) - frames.position[pair])
            directions = np.einsum("nji,nj->ni", R, np.array([a, b], float))
            table.append((kind, pair, row, points, directions, number, 0 if inner else 1))
            row += 3 if kind == POINT else 1
    kinds, pairs, rows, points, directions, owners, seconds = zip(*table, strict=True) if table else [()] * 7
    n = len(table)
    return Equations(
        kind=np.array(kinds, np.int64),
        frame=np.array(pairs, np.int64).reshape(n, 2),
        row=np.array(rows, np.int64),
        point=np.array(points, float).reshape(n, 2, 3),
        direction=np.array(directions, float).reshape(n, 2, 3),
        joint=np.array(owners, np.int64),
        second=np.array(seconds, np.int64),
    )


def row_count(e: Equations) -> int:
    """Number of scalar constraints."""
    return int(np.sum(np.where(e.kind == POINT, 3, 1)))


def _parts(joint: Joint) -> list[Part]:
    """(kind, direction in the first, direction in the second frame, frames swapped) of a joint's equations."""
    if isinstance(joint, Ball):
        return [(POINT, np.zeros(3), np.zeros(3), False)]
    if isinstance(joint, Hinge):
        return _held_points((), False) + _held_turns((_unit(joint.axis),))
    if isinstance(joint, Guide):
        return _held_points((_unit(joint.axis),), False) + _held_turns(())
    slides, turns = (tuple(_unit(a) for a in axes) for axes in (joint.slides, joint.turns))
    return _held_points(slides, joint.inner) + _held_turns(turns)


def _unit(axis: ArrayLike) -> np.ndarray:
    length = np.linalg.norm(axis)
    if not length > 0:
        raise InputError("joint.axis", axis, "must not have zero length")
    return np.divide(axis, length)


def _held_points(slides: Sequence[np.ndarray], inner: bool) -> list[Part]:
    """Equations that keep the points together, except along the slides."""
    if not slides:
        return [(POINT, np.zeros(3), np.zeros(3), False)]
    normals = {1: across(slides[0]), 2: [_unit(np.cross(slides[0], slides[-1]))] if len(slides) == 2 else (), 3: ()}
    return [(PLANE, normal, normal, inner) for normal in normals[len(slides)]]


def _held_turns(turns: Sequence[np.ndarray]) -> list[Part]:
    """Equations that keep the directions, except about the turns."""
    if len(turns) == 0:
        x, y, z = np.eye(3)
        return [(SQUARE, x, y, False), (SQUARE, x, z, False), (SQUARE, y, z, False)]
    if len(turns) == 1:
        return [(SQUARE, turns[0], normal, False) for normal in across(turns[0])]
    if len(turns) == 2:
        if abs(turns[0] @ turns[1]) > 1e-9:
            raise InputError("joint.turns", [list(t) for t in turns], "must be at right angles")
        return [(SQUARE, turns[0], turns[1], False)]
    return []


def across(axis: np.ndarray) -> np.ndarray:
    """Two unit vectors (2, 3) perpendicular to a unit axis and to each other."""
    start = np.eye(3)[np.argmin(np.abs(axis))]
    one = np.cross(axis, start)
    one /= np.linalg.norm(one)
    return np.array([one, np.cross(axis, one)])


@kernel(inline="always")
def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@kernel(inline="always")
def _dot(a: np.ndarray, b: np.ndarray) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def _point_rows(J: np.ndarray, row: int, column: int, sign: float, lever: np.ndarray) -> None:
    """± [I, -s̃] of x + s."""
    x, y, z = sign * lever[0], sign * lever[1], sign * lever[2]
    for r in range(3):
        J[row + r, column + r] += sign
    J[row, column + 4] += z
    J[row, column + 5] -= y
    J[row + 1, column + 3] -= z
    J[row + 1, column + 5] += x
    J[row + 2, column + 3] += y
    J[row + 2, column + 4] -= x


@kernel
def constraints(e: Equations, frames: Frames, C: np.ndarray, J: np.ndarray, bias: np.ndarray) -> None:
    """Fill C (m,), its Jacobian J (m, 6 nf) over all frames, and bias (m,) = J̇ v.

    Then Ċ = J v and C̈ = J a + bias; for the bodies' columns C_u, and the supports' part J_s:
    Q_d = -bias - J_s a_s, C_u u̇ = -J_s v_s.
    """
    C[:] = 0.0
    J[:] = 0.0
    for n in range(e.kind.size):
        i, j, row = e.frame[n, 0], e.frame[n, 1], e.row[n]
        Ri, Rj = frames.rotation[i], frames.rotation[j]
        si, sj = Ri @ e.point[n, 0], Rj @ e.point[n, 1]
        vi, vj = frames.velocity[i, :3], frames.velocity[j, :3]
        wi, wj = frames.velocity[i, 3:], frames.velocity[j, 3:]
        gap = frames.position[j] + sj - frames.position[i] - si
        pull = _cross(wj, _cross(wj, sj)) - _cross(wi, _cross(wi, si))
        if e.kind[n] == POINT:
            C[row : row + 3] = -gap
            bias[row : row + 3] = -pull
            _point_rows(J, row, 6 * i, 1.0, si)
            _point_rows(J, row, 6 * j, -1.0, sj)
            continue
        a = Ri @ e.direction[n, 0]
        da = _cross(wi, a)
        if e.kind[n] == SQUARE:
            b = Rj @ e.direction[n, 1]
            turn, db = _cross(a, b), _cross(wj, b)
            C[row] = _dot(a, b)
            bias[row] = _dot(_cross(wi, da), b) + 2 * _dot(da, db) + _dot(a, _cross(wj, db))
            J[row, 6 * i + 3 : 6 * i + 6] += turn
            J[row, 6 * j + 3 : 6 * j + 6] -= turn
            continue
        speed = vj + _cross(wj, sj) - vi - _cross(wi, si)
        C[row] = _dot(a, gap)
        bias[row] = _dot(_cross(wi, da), gap) + 2 * _dot(da, speed) + _dot(a, pull)
        J[row, 6 * j : 6 * j + 3] += a
        J[row, 6 * j + 3 : 6 * j + 6] += _cross(sj, a)
        J[row, 6 * i : 6 * i + 3] -= a
        J[row, 6 * i + 3 : 6 * i + 6] += _cross(a, gap) - _cross(si, a)


@kernel
def constraint_loads(e: Equations, frames: Frames, J: np.ndarray, multiplier: np.ndarray, load: np.ndarray) -> None:
    """Fill load (nj, 6) of each joint on its second frame, moment about the joint's point there: eq. 3."""
    load[:] = 0.0
    for n in range(e.kind.size):
        side, first, out = e.second[n], e.row[n], load[e.joint[n]]
        j = e.frame[n, side]
        for row in range(first, first + (3 if e.kind[n] == POINT else 1)):
            at_origin = -multiplier[row] * J[row, 6 * j : 6 * j + 6]
            moved = _cross(frames.rotation[j] @ e.point[n, side], at_origin[:3])
            out[:3] += at_origin[:3]
            out[3:] += at_origin[3:] - moved
