"""The axes that a joint leaves free, seen from the poses and motions of its two frames.

A float has six coordinates in the augmented path; what springs, dampers and inertia of the
mechanism act on are the joint's ways y along or about its axes. Each axis is fixed in the frame that the
axes before it have moved, and all pass through the hinge point.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import kernel

ITERATIONS = 50  # of Newton's method for the ways; two or three suffice from those of the last stage


class Axes(NamedTuple):
    """turns (n,) bool, directions at rest (n, 3), and the arm (3,) from the hinge to the body's origin [m]."""

    turns: np.ndarray
    direction: np.ndarray
    arm: np.ndarray


class Node(NamedTuple):
    """The frame that carries a hinge, at the hinge: position (3,), rotation (3, 3), velocity and acceleration (6,)."""

    position: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def on_body(
    arm: np.ndarray, position: np.ndarray, rotation: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> Node:
    """A point of a rigid body at `arm` (3,) from its origin, in body axes."""
    r, w, dw = rotation @ arm, velocity[3:], acceleration[3:]
    moved = velocity[:3] + np.cross(w, r)
    pushed = acceleration[:3] + np.cross(dw, r) + np.cross(w, np.cross(w, r))
    return Node(position + r, rotation, np.concatenate([moved, w]), np.concatenate([pushed, dw]))


@kernel
def _rotation_about(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation by an angle about a unit axis: Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * (K @ K)


@kernel
def body_at(
    axes: Axes, node: Node, y: np.ndarray, dy: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Position (3,) and rotation (3, 3) of the body at ways y (n,) and rates dy, its motion (6, n) for
    unit rates, and its acceleration (6,) for steady ones: a = J ÿ + c.
    """
    n = len(y)
    J, R, origin = np.zeros((6, n)), node.rotation.copy(), np.empty((n, 3))
    at, a = node.position.copy(), node.acceleration[:3].copy()
    w, dw = node.velocity[3:].copy(), node.acceleration[3:].copy()
    for i in range(n):
        d = R @ axes.direction[i]
        origin[i] = at
        if axes.turns[i]:
            J[3:, i] = d
            dw += np.cross(w, d) * dy[i]
            w += d * dy[i]
            R = R @ _rotation_about(axes.direction[i], y[i])
        else:
            J[:3, i] = d
            step = d * y[i]
            a += np.cross(dw, step) + np.cross(w, np.cross(w, step)) + 2 * dy[i] * np.cross(w, d)
            at += step
    arm = R @ axes.arm
    for i in range(n):
        if axes.turns[i]:
            J[:3, i] = np.cross(J[3:, i], at + arm - origin[i])
    c = np.concatenate((a + np.cross(dw, arm) + np.cross(w, np.cross(w, arm)), dw))
    return at + arm, R, J, c


@kernel
def ways(axes: Axes, node: Node, position: np.ndarray, rotation: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Ways y (n,) at which the body stands at `position` and `rotation`, from a guess nearby."""
    y, zero = start.copy(), np.zeros(len(start))
    for _ in range(ITERATIONS):
        x, R, J, _c = body_at(axes, node, y, zero)
        E = rotation @ R.T
        gap = np.empty(6)
        gap[:3] = position - x
        gap[3], gap[4], gap[5] = (E[2, 1] - E[1, 2]) / 2, (E[0, 2] - E[2, 0]) / 2, (E[1, 0] - E[0, 1]) / 2
        step = np.linalg.solve(J.T @ J, J.T @ gap)
        y += step
        if np.abs(step).max() < 1e-14 + 1e-13 * np.abs(y).max():
            break
    return y


@kernel
def support_velocity(node: Node, position: np.ndarray) -> np.ndarray:
    """Velocity (6,) of a point that moves with the support."""
    w = node.velocity[3:]
    return np.concatenate((node.velocity[:3] + np.cross(w, position - node.position), w))


@kernel
def joint_motion(
    axes: Axes, node: Node, position: np.ndarray, rotation: np.ndarray, velocity: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Ways and rates (n,), P (n, 6) = (JᵀJ)⁻¹Jᵀ and c (6,).

    Then ÿ = P (a - c), and a load Q on the axes is PᵀQ on the body.
    """
    y = ways(axes, node, position, rotation, start)
    _x, _R, J, _c = body_at(axes, node, y, np.zeros(len(y)))
    P = np.linalg.solve(J.T @ J, np.ascontiguousarray(J.T))
    rate = P @ (velocity - support_velocity(node, position))
    _x, _R, _J, c = body_at(axes, node, y, rate)
    return y, rate, P, c
