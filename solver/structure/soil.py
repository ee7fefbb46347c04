"""Soil round the members below the seabed: springs along and across them, p-y and t-z curves as lines through zero.

On a length of a member moved by (u, v, w) along its own axes and twisted by θ the soil bears, per length,
-(k_a u, k_l v, k_l w) and -k_t θ: ∫ NᵀkN dx of its element, with the shape functions that its mass has, is of fourth
order in the element's length (Hetényi, Beams on Elastic Foundation, 1946).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, out_of_range
from solver.structure import beam

POINTS = 4  # of Gauss: exact for two cubics times a straight line


@dataclass(frozen=True, slots=True, kw_only=True)
class SoilSpring:
    """Stiffness of the soil at one depth: a line of a table."""

    depth: Annotated[float, Quantity("m", least=0), "Below the seabed"]
    lateral: Annotated[float, Quantity("N/m2", least=0), "Across a member, per length: the slope of its p-y curve"]
    axial: Annotated[float, Quantity("N/m2", least=0), "Along it, per length: the slope of its t-z curve"] = 0.0
    torsional: Annotated[float, Quantity("N", least=0), "About it: moment per angle and length"] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Soil:
    """Below the seabed, straight between its lines, downwards, and level beyond them; two at one depth are a step."""

    seabed: float  # z [m]
    springs: tuple[SoilSpring, ...]

    def __post_init__(self) -> None:
        refuse(self._problems())

    def _problems(self) -> Iterator[InputError]:
        if not np.isfinite(self.seabed):
            yield InputError("soil", f"at z = {self.seabed:g} m", "needs water of a finite depth")
        for i, line in enumerate(self.springs):
            yield from out_of_range(line, f"soil[{i}]")
        yield from falling([line.depth for line in self.springs], "soil")

    def stiffness(self, z: np.ndarray) -> np.ndarray:
        """(n, 3) at heights z (n,), which are not above the seabed: along, across [N/m2] and about a member [N]."""
        depth = [line.depth for line in self.springs]
        rows = [[line.axial, line.lateral, line.torsional] for line in self.springs]
        return np.stack([np.interp(self.seabed - z, depth, column) for column in np.transpose(rows)], axis=-1)

    def points(self, ends: np.ndarray) -> Iterator[tuple[float, float, np.ndarray]]:
        """Of a straight piece between two places (2, 3): s in [0, 1], its weight in s, and stiffness (3,) there."""
        node, weight = np.polynomial.legendre.leggauss(POINTS)
        z0, z1 = ends[:, 2]
        levels = self.seabed - np.array([0.0, *(line.depth for line in self.springs)])
        at = np.clip((levels - z0) / (z1 - z0), 0, 1) if z0 != z1 else np.zeros(0)
        for a, b in pairwise(np.unique([0.0, *at, 1.0])):
            s = a + (b - a) * (node + 1) / 2
            if z0 + (a + b) / 2 * (z1 - z0) < self.seabed:
                yield from zip(s, (b - a) * weight / 2, self.stiffness(z0 + s * (z1 - z0)), strict=True)

    def element(self, ends: np.ndarray, shear: beam.Shear) -> np.ndarray:
        """∫ NᵀkN dx (12, 12) of an element between two places (2, 3), local axes [N/m, N, N m]."""
        L, K = float(np.linalg.norm(ends[1] - ends[0])), np.zeros((12, 12))
        for s, weight, (along, across, about) in self.points(ends):
            N, twist = beam.displacement_shape(s, L, shear), beam.rotation_shape(s, L, shear)[:1]
            K += weight * L * (N.T @ (np.array([[along], [across], [across]]) * N) + about * twist.T @ twist)
        return K


def falling(depths: list[float], key: str) -> Iterator[InputError]:
    """Depths of a table's lines that do not go downwards, or that are given more than twice."""
    for i in range(1, len(depths)):
        if depths[i] < depths[i - 1]:
            limit = f"must be >= {depths[i - 1]:g} m, the depth of the line before"
            yield InputError(f"{key}[{i}].depth", depths[i], limit)
        elif depths[i] == depths[max(i - 2, 0)] and i > 1:
            yield InputError(f"{key}[{i}].depth", depths[i], "is given three times: two lines make a step")
