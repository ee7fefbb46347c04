"""Moorings: catenary lines; or linear ones, of lines about a float's place at rest, F = F₀ - K x - C ẋ."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from solver.errors import InputError, refuse
from solver.quantities import Quantity, of_no_unit, out_of_range, require_ranges, take_tuples

if TYPE_CHECKING:  # with the compiler, which takes 0.3 s to import: the command line needs scenes but rarely lines
    from solver.catenary import Lines

Matrix = tuple[tuple[float, ...], ...]
STEP, TURN = 1e-5, 1e-4  # of a line's length [m], and angle [rad], of the differences that tell its stiffness
SIX = 6  # rows of matrices of a point's motion
SYMMETRIC = 1e-6  # relative difference of two entries that count as one,
ROUNDING = 1e-12  # and how far apart they may be besides, relative to what is on the diagonal
PASSIVE = 1e-9  # of a damping matrix scaled to a diagonal of 1: a lower eigenvalue than minus this is not rounding
STRAINED = 0.05  # of a line at rest: chain and wire break before, and fibre is moored with less


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A catenary line, quasi-static and elastic, which lies on the seabed where it does not hang."""

    anchor: Annotated[tuple[float, float, float], Quantity("m"), "Where it is held, at the height of the seabed there"]
    fairlead: Annotated[tuple[float, float, float], Quantity("m"), "On the float, from its reference point at rest"]
    length: Annotated[float, Quantity("m", above=0), "Without tension"]
    weight: Annotated[float, Quantity("N/m", above=0), "Per length, in water"]
    EA: Annotated[float, Quantity("N", above=0), "Stiffness: tension over strain"]

    def __post_init__(self) -> None:
        take_tuples(self)
        require_ranges(self, "lines")


def lines_of(each: Sequence[Sequence[Line]]) -> "Lines":
    """The lines of floats as arrays."""
    from solver.catenary import Lines

    every = [line for lines in each for line in lines]
    points = (
        np.array([getattr(line, name) for line in every], float).reshape(-1, 3) for name in ("anchor", "fairlead")
    )
    numbers = (np.array([getattr(line, name) for line in every], float) for name in ("length", "weight", "EA"))
    return Lines(np.cumsum([0, *map(len, each)]), *points, *numbers)


def line_loads(lines: Sequence[Line], centre: np.ndarray) -> np.ndarray:
    """Load (6,) [N, N m] at rest of a float's lines about its reference point, at `centre` (3,) [m]."""
    return _loads(lines_of([lines]), np.asarray(centre, float), np.eye(3))


def line_pulls(lines: Sequence[Line], centre: np.ndarray) -> np.ndarray:
    """Pull (n, 3) [N] at rest of each of these lines."""
    return np.array([line_loads((line,), centre)[:3] for line in lines]).reshape(-1, 3)


def odd_lines(lines: Sequence[Line], centre: np.ndarray) -> Iterator[str]:
    """A sentence for each of a float's lines that is strained by STRAINED or more at rest, T/EA at its fairlead, or
    that is slack, and pulls by the weight of what hangs straight down alone."""
    for number, (line, pull) in enumerate(zip(lines, line_pulls(lines, centre), strict=True), 1):
        tension, apart = np.linalg.norm(pull), np.linalg.norm(np.subtract(line.anchor, centre + line.fairlead))
        if tension >= STRAINED * line.EA:
            yield (
                f"line {number} is strained by {tension / line.EA:.2g} at rest, {tension:.4g} N: {line.length:g} m long"
                f" without tension, it spans {apart:.4g} m from anchor to fairlead"
            )
        elif not pull[:2].any() and -pull[2] < line.weight * line.length:  # as no taut tether straight down is
            yield (
                f"line {number} is slack at rest: {line.length:g} m long, {apart:.4g} m from anchor to fairlead, it"
                " hangs straight down, the rest lies on the seabed, and it holds nothing along the horizontal"
            )


def _loads(rows: "Lines", position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    from solver.catenary import line_pull

    load = np.zeros(6)
    for i in range(len(rows.length)):
        x, y, z, *force = line_pull(rows, i, position, rotation)
        load += (*force, *np.cross((x, y, z), force))
    return load


def line_stiffness(lines: Sequence[Line], centre: np.ndarray) -> np.ndarray:
    """K (6, 6) [N/m, ...] of a float's lines at rest about its reference point, at `centre` (3,) [m].

    By central differences, each line's by its own length; turning carries the fairleads, and their pulls with them.
    """
    return sum((_stiffness(line, centre) for line in lines), np.zeros((6, 6)))


def _stiffness(line: Line, centre: np.ndarray) -> np.ndarray:
    rows, K, step = lines_of([(line,)]), np.zeros((6, 6)), STEP * line.length
    for column in range(6):
        for sign in (-1.0, 1.0):
            x, R = np.array(centre, float), np.eye(3)
            if column < 3:
                x[column] += sign * step
            else:
                i, j = (column - 2) % 3, (column - 1) % 3
                R[j, i], R[i, j] = sign * TURN, -sign * TURN
            K[:, column] -= sign * _loads(rows, x, R) / (2 * (step if column < 3 else TURN))
    return K


@dataclass(frozen=True, slots=True, kw_only=True)
class Mooring:
    """Lines between a float and what carries its joint; nothing else of their own, and no power but what C takes.

    x are the n positions of the joint's axes; or, in matrices 6 x 6, how far a point of the float has moved against
    what carries it, and the vector of the rotation by which the float has turned, in whatever order its axes turn it:
    see solver.multibody.moored. As the joint carries the point round, along y H y/2 about rest, pretension keeps its
    direction: -F₀·H more of stiffness.
    """

    stiffness: Annotated[Matrix, Quantity("N m/rad or N/m"), "K, symmetric, of the joint's axes; or 6 x 6, of `point`"]
    damping: Annotated[Matrix | None, Quantity("N m s/rad or N s/m"), "C, symmetric and passive, as large as K"] = None
    pretension: Annotated[
        tuple[float, ...] | None, Quantity("N m or N"), "F₀, load of the lines on the float at rest, as long as K"
    ] = None
    point: Annotated[
        tuple[float, float, float], Quantity("m"), "That matrices 6 x 6 are of, from the float's reference point"
    ] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        take_tuples(self)
        refuse(self._shapes())
        refuse(out_of_range(self, "mooring"))
        refuse(self._meaning())

    def _shapes(self) -> Iterator[InputError]:
        size = len(self.stiffness)
        if not size:
            yield InputError("mooring.stiffness", self.stiffness, "must have rows: one for each axis, or six")
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

    @property
    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """K, C and F₀; zero where nothing is given."""
        K = np.array(self.stiffness, float)
        C = np.zeros(K.shape) if self.damping is None else np.array(self.damping, float)
        F = np.zeros(len(K)) if self.pretension is None else np.array(self.pretension, float)
        return (K + K.T) / 2, (C + C.T) / 2, F

    def on_axes(self, J: np.ndarray, H: np.ndarray) -> "AxisMooring":
        """As the axes of a joint feel it near rest, which move the point by J (6, n), and by H (n, n, 6) of y²/2."""
        K, C, F = self.matrices
        if len(K) != SIX:
            return AxisMooring(K, C, F)
        return AxisMooring(J.T @ K @ J - H @ F, J.T @ C @ J, J.T @ F)


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
    own = np.sqrt(np.abs(np.diagonal(matrix)))
    rounding = ROUNDING * np.multiply.outer(own, own)
    off = np.abs(matrix - matrix.T) > SYMMETRIC * (np.abs(matrix) + np.abs(matrix.T)) + rounding
    if not off.any():
        return ""
    i, j = (int(k) for k in np.argwhere(off)[0])
    return f"must be symmetric; row {i + 1}, column {j + 1} has {matrix[i, j]:g}, the reverse {matrix[j, i]:g}"


def _drives(damping: np.ndarray) -> bool:
    """Whether a symmetric matrix brings power to some motion; axes may be of different kinds and sizes."""
    return bool(np.linalg.eigvalsh(of_no_unit(damping))[0] < -PASSIVE)
