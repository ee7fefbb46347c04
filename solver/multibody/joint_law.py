"""The one law of the joints: what power take-off, damping and springs do at an axis's position y and rate ẏ.

    f_pto = c_pto ẏ,    f_loss = (c + d|ẏ|) ẏ,    f_spring = k y    against the axis [N or N m]

Powers f_pto ẏ (absorbed) and f_loss ẏ leave the scene, that of f_spring is stored. Motion, powers, record, both
formulations and the linear model ask here. A further kind of law (end stops, Coulomb friction, a limited force,
control) is its numbers in JointLaw and its terms in `axis_load` and `axis_energy`.
"""

from typing import NamedTuple

import numpy as np

from solver.kernels import kernel


class JointLaw(NamedTuple):
    """Coefficients of n axes: [N s/m], [N s²/m²] and [N/m] of those that slide, [N m s/rad] ... of those that turn."""

    pto: np.ndarray  # (n,) linear damping that is absorbed power
    damping: np.ndarray  # (n,) other linear damping
    quadratic: np.ndarray  # (n,) quadratic damping
    spring: np.ndarray  # (n,) linear spring about y = 0


class AxisLoad(NamedTuple):
    """Against the axis's positive sense [N or N m], by where its power goes: absorbed, lost, stored."""

    pto: float
    loss: float
    spring: float


class JointLoads(NamedTuple):
    """AxisLoad of n axes at m samples, each part (m, n)."""

    pto: np.ndarray
    loss: np.ndarray
    spring: np.ndarray


@kernel(inline="always")
def axis_load(law: JointLaw, i: int, y: float, dy: float) -> AxisLoad:
    """AxisLoad of axis i at position y and rate dy."""
    loss = (law.damping[i] + law.quadratic[i] * abs(dy)) * dy
    return AxisLoad(law.pto[i] * dy, loss, law.spring[i] * y)


@kernel(inline="always")
def axis_energy(law: JointLaw, i: int, y: float) -> float:
    """Energy stored in axis i at position y [J]."""
    return 0.5 * law.spring[i] * y * y


@kernel(inline="always")
def axis_damping(law: JointLaw, i: int) -> float:
    """∂f/∂ẏ of axis i at rest, for Newton's matrix."""
    return law.pto[i] + law.damping[i]


@kernel
def joint_loads(law: JointLaw, y: np.ndarray, dy: np.ndarray) -> JointLoads:
    """Loads of all axes from positions and rates (m, n)."""
    pto, loss, spring = np.empty(y.shape), np.empty(y.shape), np.empty(y.shape)
    for s in range(y.shape[0]):
        for i in range(y.shape[1]):
            load = axis_load(law, i, y[s, i], dy[s, i])
            pto[s, i], loss[s, i], spring[s, i] = load.pto, load.loss, load.spring
    return JointLoads(pto, loss, spring)


@kernel
def joint_energy(law: JointLaw, y: np.ndarray) -> float:
    """Energy stored in all axes at positions y (n,) [J]."""
    energy = 0.0
    for i in range(y.size):
        energy += axis_energy(law, i, y[i])
    return energy


def absorption(law: JointLaw) -> np.ndarray:
    """Of a linear model (n,): the mean power absorbed by an axis is this times its rate's mean square."""
    return law.pto


def drag(law: JointLaw) -> np.ndarray:
    """Of a linear model (n,): what times |ẏ|ẏ is to be linearised."""
    return law.quadratic


def absorbing(law: JointLaw) -> np.ndarray:
    """Which axes absorb power (n,)."""
    return law.pto > 0
