"""Kinematics of a rigid body that hangs on its support by a chain of axes.

Each axis is prismatic or revolute, fixed in the frame that the axes before it have moved. A
hinge is one revolute axis; heave alone one prismatic; a free body three of each. The motion
of a support's node comes first: three prismatic and three revolute axes (x, z and pitch in a
planar scene). Positions, Jacobian and bias are exact for any angle.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import kernel

PRISMATIC, REVOLUTE = 0, 1
SMALL = 0.03  # angles [rad] of which a series knows more than what trigonometry leaves


class Chain(NamedTuple):
    """kind (n,), direction (n, 3) and point (n, 3) [m] at rest, coordinate (n,) index into z."""

    kind: np.ndarray
    direction: np.ndarray
    point: np.ndarray
    coordinate: np.ndarray


@kernel(inline="always")
def cross(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> tuple[float, float, float]:
    """a × b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@kernel(inline="always")
def rotated(R: np.ndarray, v: np.ndarray | tuple[float, float, float]) -> tuple[float, float, float]:
    """R v."""
    return (
        R[0, 0] * v[0] + R[0, 1] * v[1] + R[0, 2] * v[2],
        R[1, 0] * v[0] + R[1, 1] * v[1] + R[1, 2] * v[2],
        R[2, 0] * v[0] + R[2, 1] * v[1] + R[2, 2] * v[2],
    )


@kernel(inline="always")
def into(R: np.ndarray, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Rᵀ (x, y, z)."""
    return (
        R[0, 0] * x + R[1, 0] * y + R[2, 0] * z,
        R[0, 1] * x + R[1, 1] * y + R[2, 1] * z,
        R[0, 2] * x + R[1, 2] * y + R[2, 2] * z,
    )


@kernel(inline="always")
def rotation_vector(R: np.ndarray) -> tuple[float, float, float, float]:
    """θ of the rotation R = exp[θ], |θ| < π, and k = (1 - ½|θ| cot ½|θ|)/θ² of `moment`."""
    p, q, r = (R[2, 1] - R[1, 2]) / 2, (R[0, 2] - R[2, 0]) / 2, (R[1, 0] - R[0, 1]) / 2
    sine, cosine = np.sqrt(p * p + q * q + r * r), (R[0, 0] + R[1, 1] + R[2, 2] - 1) / 2
    angle = np.arctan2(sine, cosine)
    long = angle / sine if sine > 0 else 1.0
    k = (1 - angle * sine / (2 * (1 - cosine))) / angle**2 if angle > SMALL else 1 / 12 + angle**2 / 720
    return long * p, long * q, long * r, k


@kernel(inline="always")
def moment(theta: tuple[float, float, float, float], mx: float, my: float, mz: float) -> tuple[float, float, float]:
    """J⁻ᵀ m = m + θ × m/2 + k θ × (θ × m) about the axes of space, of m = -∂U/∂θ; rotations are dφ = J dθ."""
    u, v, w, k = theta
    tx, ty, tz = cross(u, v, w, mx, my, mz)
    sx, sy, sz = cross(u, v, w, tx, ty, tz)
    return mx + tx / 2 + k * sx, my + ty / 2 + k * sy, mz + tz / 2 + k * sz


@kernel(inline="always")
def _turn(x: float, y: float, z: float, angle: float, R: np.ndarray) -> None:
    """R <- exp(angle [axis]×) R, by Rodrigues' formula."""
    s, c = np.sin(angle), np.cos(angle)
    for j in range(3):
        a, b, d = R[0, j], R[1, j], R[2, j]
        along = (x * a + y * b + z * d) * (1 - c)
        R[0, j] = a * c + (y * d - z * b) * s + x * along
        R[1, j] = b * c + (z * a - x * d) * s + y * along
        R[2, j] = d * c + (x * b - y * a) * s + z * along


@kernel(inline="always")
def kinematics(
    chain: Chain,
    reference: np.ndarray,
    y: np.ndarray,
    dy: np.ndarray,
    position: np.ndarray,
    R: np.ndarray,
    J: np.ndarray,
    velocity: np.ndarray,
    bias: np.ndarray,
) -> None:
    """Fill position (3,), R (3, 3), J (6, n), velocity (6,) and bias J̇ẏ (6,) of a body.

    reference (3,): the body's reference point at rest; y, dy: coordinates and rates, of which the chain
    says which are its axes'. Velocity and acceleration of the reference point: v = Jẏ, a = Jÿ + J̇ẏ.
    Each axis is a velocity field v(x) = l + e × x, so (l, e) are summed at the origin and taken to the
    reference point at the end; the frame (v, w) that carries an axis turns it at (w × l + v × e, w × e).
    """
    n = chain.kind.size
    R[:] = 0.0
    R[0, 0] = R[1, 1] = R[2, 2] = 1.0
    sx = sy = sz = 0.0  # a rest point X is now at R X + s
    wx = wy = wz = vx = vy = vz = 0.0  # spin, and velocity at the origin, of the frame so far
    bx = by = bz = cx = cy = cz = 0.0  # acceleration field at ÿ = 0: at the origin, and of the spin
    for i in range(n):
        moved, rate = y[chain.coordinate[i]], dy[chain.coordinate[i]]
        ex, ey, ez = rotated(R, chain.direction[i])
        if chain.kind[i] == PRISMATIC:
            J[0, i], J[1, i], J[2, i], J[3, i], J[4, i], J[5, i] = ex, ey, ez, 0.0, 0.0, 0.0
            sx, sy, sz = sx + ex * moved, sy + ey * moved, sz + ez * moved
        else:
            px, py, pz = rotated(R, chain.point[i])
            ox, oy, oz = px + sx, py + sy, pz + sz
            J[0, i], J[1, i], J[2, i] = cross(ox, oy, oz, ex, ey, ez)
            J[3, i], J[4, i], J[5, i] = ex, ey, ez
            _turn(ex, ey, ez, moved, R)
            px, py, pz = rotated(R, chain.point[i])
            sx, sy, sz = ox - px, oy - py, oz - pz
        lx, ly, lz, ax, ay, az = J[0, i], J[1, i], J[2, i], J[3, i], J[4, i], J[5, i]
        dx, dy_, dz = cross(wx, wy, wz, lx, ly, lz)
        gx, gy, gz = cross(vx, vy, vz, ax, ay, az)
        hx, hy, hz = cross(wx, wy, wz, ax, ay, az)
        bx, by, bz = bx + rate * (dx + gx), by + rate * (dy_ + gy), bz + rate * (dz + gz)
        cx, cy, cz = cx + rate * hx, cy + rate * hy, cz + rate * hz
        vx, vy, vz = vx + rate * lx, vy + rate * ly, vz + rate * lz
        wx, wy, wz = wx + rate * ax, wy + rate * ay, wz + rate * az
    px, py, pz = rotated(R, reference)
    x, y_, z = px + sx, py + sy, pz + sz
    position[0], position[1], position[2] = x, y_, z
    for i in range(n):
        dx, dy_, dz = cross(J[3, i], J[4, i], J[5, i], x, y_, z)
        J[0, i], J[1, i], J[2, i] = J[0, i] + dx, J[1, i] + dy_, J[2, i] + dz
    dx, dy_, dz = cross(wx, wy, wz, x, y_, z)
    vx, vy, vz = vx + dx, vy + dy_, vz + dz
    velocity[0], velocity[1], velocity[2], velocity[3], velocity[4], velocity[5] = vx, vy, vz, wx, wy, wz
    # The field's rate at a fixed point, and that the point moves through the field.
    dx, dy_, dz = cross(cx, cy, cz, x, y_, z)
    gx, gy, gz = cross(wx, wy, wz, vx, vy, vz)
    bias[0], bias[1], bias[2] = bx + dx + gx, by + dy_ + gy, bz + dz + gz
    bias[3], bias[4], bias[5] = cx, cy, cz
