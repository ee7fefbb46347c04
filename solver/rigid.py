"""Moments and products of inertia of rigid bodies."""

from collections.abc import Sequence

import numpy as np

ROUNDING = 1e-9  # of the tensor's trace, by which a body's may miss what it must be


def inertia_tensor(moments: Sequence[float], products: Sequence[float]) -> np.ndarray:
    """About the c.o.g. (3, 3) [kg m2]; products: ∫ xy, xz, yz dm."""
    xy, xz, yz = products
    return np.diag(moments) - np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])


def is_of_a_body(tensor: np.ndarray) -> bool:
    """Whether ∫ r rᵀ dm, of which no direction can have less than none, gives it: triangle inequality."""
    spread = np.trace(tensor) / 2 * np.eye(3) - tensor
    return bool(np.linalg.eigvalsh(spread)[0] >= -ROUNDING * np.trace(tensor))
