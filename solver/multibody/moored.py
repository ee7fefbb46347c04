"""Moorings of a point of a float by matrices 6 x 6: what they do along the axes of its joint.

ξ = (x - x₀, θ) is how the point has moved and the float has turned, R = exp[θ], against what carries it, along axes
that turn with that. However many axes turn it, and in whatever order, the lines store

    U = ½ ξᵀKξ - F₀ᵀξ,    and load axis i by -∂U/∂yᵢ = Jᵢᵀ [f, T⁻ᵀm],    (f, m) = F₀ - Kξ,    dφ = T dθ,

with the motions Jᵢ (6,) of the point and the float for one unit of yᵢ; of their rates v = Jẏ they take vᵀCv by -JᵀCv.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import kernel, lean_kernel
from solver.multibody.chain import REVOLUTE, Chain, kinematics, moment, rotation_vector


class MooringRoom(NamedTuple):
    """Scratch of one mooring at an instant: no number of any."""

    position: np.ndarray  # (3,)
    rotation: np.ndarray  # (3, 3)
    jacobian: np.ndarray  # (6, n)
    velocity: np.ndarray  # (6,)
    bias: np.ndarray  # (6,)
    shift: np.ndarray  # (6,) ξ
    load: np.ndarray  # (6,)


class Moorings(NamedTuple):
    """Of m joints of n axes at most, of which some turn."""

    axes: np.ndarray  # (m,) how many
    chain: Chain  # of each: kind (m, n) ...
    point: np.ndarray  # (m, 3) at rest [m]
    stiffness: np.ndarray  # (m, 6, 6) K [N/m, ...]
    damping: np.ndarray  # (m, 6, 6) C [N s/m, ...]
    pull: np.ndarray  # (m, 6) F₀ [N, N m]
    at_rest: np.ndarray  # (m, n, n) JᵀCJ there, for Newton's matrix
    room: MooringRoom


@kernel(inline="always")
def _place(moorings: Moorings, k: int, y: np.ndarray, dy: np.ndarray) -> tuple[float, float, float, float]:
    """Fill the room with kinematics and ξ of mooring k; θ and k of `moment`.

    A single axis that turns may do so more than once, which no rotation tells.
    """
    n, of, room, x = moorings.axes[k], moorings.chain, moorings.room, moorings.point[k]
    chain = Chain(of.kind[k, :n], of.direction[k, :n], of.point[k, :n], of.coordinate[k, :n])
    kinematics(chain, x, y, dy, room.position, room.rotation, room.jacobian, room.velocity, room.bias)
    theta = rotation_vector(room.rotation)
    turning, last = 0, 0
    for i in range(n):
        if chain.kind[i] == REVOLUTE:
            turning, last = turning + 1, i
    if turning == 1:
        d, angle = chain.direction[last], y[chain.coordinate[last]]
        theta = (angle * d[0], angle * d[1], angle * d[2], 0.0)  # along which no moment is another
    for r in range(3):
        room.shift[r] = room.position[r] - x[r]
    room.shift[3], room.shift[4], room.shift[5] = theta[0], theta[1], theta[2]
    return theta


@lean_kernel
def add_moored(
    moorings: Moorings, y: np.ndarray, dy: np.ndarray, share: float, spring: np.ndarray, loss: np.ndarray
) -> None:
    """spring, loss (n,) += a share of what the moorings put against the axes at positions y and rates dy (n,)."""
    room = moorings.room
    load, J = room.load, room.jacobian
    for k in range(moorings.axes.size):
        theta = _place(moorings, k, y, dy)
        for r in range(6):
            load[r] = -moorings.pull[k, r]
            for c in range(6):
                load[r] += moorings.stiffness[k, r, c] * room.shift[c]
        load[3], load[4], load[5] = moment(theta, load[3], load[4], load[5])
        for i in range(moorings.axes[k]):
            for r in range(6):
                spring[moorings.chain.coordinate[k, i]] += share * J[r, i] * load[r]
        _damp(moorings, k)
        for i in range(moorings.axes[k]):
            for r in range(6):
                loss[moorings.chain.coordinate[k, i]] += share * J[r, i] * load[r]


@kernel(inline="always")
def _damp(moorings: Moorings, k: int) -> None:
    """Cv into the room's load."""
    room = moorings.room
    for r in range(6):
        room.load[r] = 0.0
        for c in range(6):
            room.load[r] += moorings.damping[k, r, c] * room.velocity[c]


@lean_kernel
def moored_loss(moorings: Moorings, y: np.ndarray, dy: np.ndarray) -> float:
    """vᵀCv of all moorings at positions y and rates dy (n,) [W]."""
    room, power = moorings.room, 0.0
    for k in range(moorings.axes.size):
        _place(moorings, k, y, dy)
        _damp(moorings, k)
        for r in range(6):
            power += room.velocity[r] * room.load[r]
    return power


@lean_kernel
def moored_energy(moorings: Moorings, y: np.ndarray) -> float:
    """U of all moorings at positions y (n,) [J]."""
    room, energy = moorings.room, 0.0
    for k in range(moorings.axes.size):
        _place(moorings, k, y, y)  # rates are not asked for
        for r in range(6):
            energy -= moorings.pull[k, r] * room.shift[r]
            for c in range(6):
                energy += 0.5 * room.shift[r] * moorings.stiffness[k, r, c] * room.shift[c]
    return energy


@kernel(inline="always")
def add_moored_damping(moorings: Moorings, share: float, matrix: np.ndarray) -> None:
    """matrix (n, n) += a share of the moorings' damping at rest."""
    for k in range(moorings.axes.size):
        at = moorings.chain.coordinate[k]
        for i in range(moorings.axes[k]):
            for j in range(moorings.axes[k]):
                matrix[at[i], at[j]] += share * moorings.at_rest[k, i, j]
