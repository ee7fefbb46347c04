"""Linear moorings: what lines about a float's place at rest do to it, F = F₀ - K x - C ẋ."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, of_no_unit, out_of_range

Matrix = tuple[tuple[float, ...], ...]
SIX = 6  # rows of matrices of the reference point's motion
SYMMETRIC = 1e-6  # relative difference of two entries that count as one
PASSIVE = 1e-9  # of a damping matrix scaled to a diagonal of 1: a lower eigenvalue than minus this is not rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class Mooring:
    """Lines between a float and what carries its joint; nothing else of their own, and no power but what C takes.

    x are the n positions of the joint's axes; or, in matrices 6 x 6, the motion of the float's reference point, surge
    to yaw, as these axes move it at rest: x = J y, and the lines' load on the axes is Jᵀ F.
    """

    stiffness: Annotated[
        Matrix, Quantity("N m/rad or N/m"), "K, symmetric, of the joint's axes; or 6 x 6, of the reference point"
    ]
    damping: Annotated[Matrix | None, Quantity("N m s/rad or N s/m"), "C, symmetric and passive, as large as K"] = None
    pretension: Annotated[
        tuple[float, ...] | None, Quantity("N m or N"), "F₀, load of the lines on the float at rest, as long as K"
    ] = None

    def __post_init__(self) -> None:
        refuse(self._shapes())
        refuse(out_of_range(self, "mooring"))
        refuse(self._meaning())

    def _shapes(self) -> Iterator[InputError]:
        size = len(self.stiffness)
        for name, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            if matrix is not None and (len(matrix) != size or any(len(row) != size for row in matrix)):
                yield InputError(f"mooring.{name}", matrix, f"must be square, with {size} rows as `stiffness` has")
        if self.pretension is not None and len(self.pretension) != size:
            limit = f"must have {size} numbers, as `stiffness` has rows"
            yield InputError("mooring.pretension", self.pretension, limit)

    def _meaning(self) -> Iterator[InputError]:
        for name, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            if matrix is not None and (limit := _unsymmetric(np.array(matrix, float))):
                yield InputError(f"mooring.{name}", matrix, limit)
        if self.damping is not None and _drives(np.array(self.damping, float)):
            yield InputError("mooring.damping", self.damping, "must be passive: without a negative eigenvalue")

    def on_axes(self, J: np.ndarray) -> "AxisMooring":
        """As the axes of a joint feel it, which move the reference point by J (6, n)."""
        K = np.array(self.stiffness, float)
        C = np.zeros(K.shape) if self.damping is None else np.array(self.damping, float)
        F = np.zeros(len(K)) if self.pretension is None else np.array(self.pretension, float)
        T = J if len(K) == SIX else np.eye(len(K))
        return AxisMooring(T.T @ ((K + K.T) / 2) @ T, T.T @ ((C + C.T) / 2) @ T, T.T @ F)


class AxisMooring(NamedTuple):
    """A mooring along the n axes of a joint."""

    stiffness: np.ndarray  # (n, n)
    damping: np.ndarray  # (n, n)
    pretension: np.ndarray  # (n,)


def none(axes: int) -> AxisMooring:
    """No mooring, of so many axes."""
    return AxisMooring(np.zeros((axes, axes)), np.zeros((axes, axes)), np.zeros(axes))


def _unsymmetric(matrix: np.ndarray) -> str:
    """Which pair of entries of a square matrix differs, as a limit; empty if none does."""
    off = np.abs(matrix - matrix.T) > SYMMETRIC * (np.abs(matrix) + np.abs(matrix.T))
    if not off.any():
        return ""
    i, j = (int(k) for k in np.argwhere(off)[0])
    return f"must be symmetric; row {i + 1}, column {j + 1} has {matrix[i, j]:g}, the reverse {matrix[j, i]:g}"


def _drives(damping: np.ndarray) -> bool:
    """Whether a symmetric matrix brings power to some motion; axes may be of different kinds and sizes."""
    return bool(np.linalg.eigvalsh(of_no_unit(damping))[0] < -PASSIVE)
