"""Rigid bodies: moments and products of inertia, and how a point of one moves with another."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

ROUNDING = 1e-9  # of the tensor's trace, by which a body's may miss what it must be


def lever(arm: ArrayLike) -> np.ndarray:
    """X (6, 6): displacement u + θ × r and rotation θ at the end of a rigid arm r (3,) [m], of its start's."""
    x, y, z = np.asarray(arm)
    X = np.eye(6)
    X[:3, 3:] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
    return X


def inertia_tensor(moments: Sequence[float], products: Sequence[float]) -> np.ndarray:
    """About the c.o.g. (3, 3) [kg m2]; products: ∫ xy, xz, yz dm."""
    xy, xz, yz = products
    return np.diag(moments) - np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])


def is_of_a_body(tensor: np.ndarray) -> bool:
    """Whether ∫ r rᵀ dm, of which no direction can have less than none, gives it: triangle inequality."""
    spread = np.trace(tensor) / 2 * np.eye(3) - tensor
    return bool(np.linalg.eigvalsh(spread)[0] >= -ROUNDING * np.trace(tensor))
