"""Kinematics of a rigid body that hangs on its support by a chain of axes.

Each axis is prismatic or revolute, fixed in the frame that the axes before it have moved. A
hinge is one revolute axis; heave alone one prismatic; a free body three of each. The motion
of a support's node comes first: three prismatic and three revolute axes (x, z and pitch in a
planar scene). Positions, Jacobian and bias are exact for any angle.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

PRISMATIC, REVOLUTE = 0, 1


class Chain(NamedTuple):
    """kind (n,), direction (n, 3) and point (n, 3) [m] at rest, coordinate (n,) index into z."""

    kind: np.ndarray
    direction: np.ndarray
    point: np.ndarray
    coordinate: np.ndarray


@njit(cache=True, inline="always")
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def _turn(axis, angle, R):
    """R <- exp(angle [axis]×) R, by Rodrigues' formula."""
    s, c = np.sin(angle), np.cos(angle)
    x, y, z = axis[0], axis[1], axis[2]
    for j in range(3):
        a, b, d = R[0, j], R[1, j], R[2, j]
        along = (x * a + y * b + z * d) * (1 - c)
        R[0, j] = a * c + (y * d - z * b) * s + x * along
        R[1, j] = b * c + (z * a - x * d) * s + y * along
        R[2, j] = d * c + (x * b - y * a) * s + z * along


@njit(cache=True)
def kinematics(chain, reference, y, dy, position, R, J, velocity, bias):
    """Fill position (3,), R (3, 3), J (6, n), velocity (6,) and bias J̇ẏ (6,) of a body.

    reference (3,): the body's reference point at rest; y, dy (n,) coordinates and rates of its
    axes in order. Velocity and acceleration of the reference point: v = Jẏ, a = Jÿ + J̇ẏ.
    """
    n = chain.kind.size
    R[:] = 0.0
    R[0, 0] = R[1, 1] = R[2, 2] = 1.0
    shift = np.zeros(3)  # a rest point X is now at R X + shift
    axes, origins = np.empty((n, 3)), np.empty((n, 3))
    for i in range(n):
        for r in range(3):
            axes[i, r] = (
                R[r, 0] * chain.direction[i, 0] + R[r, 1] * chain.direction[i, 1] + R[r, 2] * chain.direction[i, 2]
            )
            origins[i, r] = (
                R[r, 0] * chain.point[i, 0] + R[r, 1] * chain.point[i, 1] + R[r, 2] * chain.point[i, 2] + shift[r]
            )
        if chain.kind[i] == PRISMATIC:
            shift += axes[i] * y[i]
        else:
            _turn(axes[i], y[i], R)
            for r in range(3):
                moved = R[r, 0] * chain.point[i, 0] + R[r, 1] * chain.point[i, 1] + R[r, 2] * chain.point[i, 2]
                shift[r] = origins[i, r] - moved
    for r in range(3):
        position[r] = R[r, 0] * reference[0] + R[r, 1] * reference[1] + R[r, 2] * reference[2] + shift[r]
    arm, lever, rate, at_origin = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(n):
        if chain.kind[i] == PRISMATIC:
            J[:3, i], J[3:, i] = axes[i], 0.0
        else:
            for r in range(3):
                arm[r] = position[r] - origins[i, r]
            _cross(axes[i], arm, lever)
            J[:3, i], J[3:, i] = lever, axes[i]
    velocity[:] = 0.0
    for i in range(n):
        for r in range(6):
            velocity[r] += J[r, i] * dy[i]
    # Bias: each column's rate times its coordinate's rate. spin, slide: velocity field
    # slide + spin × x of the frame that carries axis i.
    bias[:] = 0.0
    spin, slide = np.zeros(3), np.zeros(3)
    for i in range(n):
        _cross(spin, axes[i], rate)
        if chain.kind[i] == PRISMATIC:
            for r in range(3):
                bias[r] += dy[i] * rate[r]
                slide[r] += dy[i] * axes[i, r]
            continue
        for r in range(3):
            arm[r] = position[r] - origins[i, r]
            bias[3 + r] += dy[i] * rate[r]
        _cross(rate, arm, lever)
        bias[0] += dy[i] * lever[0]
        bias[1] += dy[i] * lever[1]
        bias[2] += dy[i] * lever[2]
        _cross(spin, origins[i], at_origin)
        for r in range(3):
            rate[r] = velocity[r] - slide[r] - at_origin[r]
        _cross(axes[i], rate, lever)
        for r in range(3):
            bias[r] += dy[i] * lever[r]
        _cross(axes[i], origins[i], lever)
        for r in range(3):
            slide[r] -= dy[i] * lever[r]
            spin[r] += dy[i] * axes[i, r]
