"""Least squares under passivity: the real part of a transfer matrix positive semidefinite at every frequency.

Cutting planes: solve, find the frequencies and directions v in which vᵀ Re H(iω) v is negative, forbid
them, solve again. Each of these problems is a least-distance one (Lawson and Hanson, chapter 23). What is still
negative when that has all but ended is lifted above zero by a little damping of all motions alike.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import nnls

from solver.hydrodynamics.radiation.rational import basis, derivative_at_start

GRID = 400  # points of the search in the mapped frequency, before refinement
ROUNDS = 40  # of cuts, at most
RISE = 1.01  # of the misfit, at most, by a lift that ends the rounds
SPARE = 1.1  # times what lacks to zero is lifted
LIFTS = 10  # each of what the last one left between points
CAUTION = 2.0  # factor on how far the least eigenvalue may fall between two points, from second differences
HALVINGS = 12  # of an interval in the search for that
CLOSE = 1e-7  # points of the grid this close to each other are one
MARGIN = 1e-7  # of the scaled transfer: cuts ask for so much more than zero, so that rounds end
RIDGE = 1e-10  # of a cut: how far it gives way, so that those that say the same need not be told apart
EXCHANGES = 500  # of active cuts, at most
CHANCES = 3  # exchanges of all cuts at once that may fail to bring the number of wrong ones down


SILENT = 1e-3  # a motion whose transfer over its squared length is less, of the largest, radiates mesh error only
UNPASSIVE = 0.5  # of the added mass: where B/ω takes as much power from the waves it radiates, the data are an error


def own_transfers(omega: np.ndarray, added_mass: np.ndarray, damping: np.ndarray, infinite: np.ndarray) -> np.ndarray:
    """|B_ii - iω(A_ii - A∞_ii)| (nw, n)."""
    B, A, A_inf = (np.diagonal(part, axis1=-2, axis2=-1) for part in (damping, added_mass, infinite))
    size: np.ndarray = np.abs(B + 1j * omega[:, None] * (A - A_inf))
    return size


def radiates(
    size: np.ndarray,
    lengths: np.ndarray,
    body: np.ndarray,
    among: np.ndarray | slice = slice(None),
    least: float = SILENT,
) -> np.ndarray:
    """Which motions (n,) have more than mesh error of a size (n,) that goes with their lengths (n,) squared.

    body: (n,) whose motions they are, from 0. Each is judged beside its own, for a large one has a thousand times as
    much, or, where that is less, beside the largest of some `among` all.
    """
    each, most = size / lengths**2, np.zeros(body.max(initial=-1) + 1)
    np.maximum.at(most, body, each)
    return np.asarray((each > 0) & (each >= least * np.minimum(most[body], each[among].max(initial=0.0))))


def least_damping(impedance: np.ndarray, lengths: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Least eigenvalue (nw,) of B/ω, motions scaled so that none has more than 1 of A + iB/ω = impedance (nw, n, n).

    lengths, body: (n,), as of `radiates`; motions that have next to nothing of it are left out.
    """
    size = np.abs(np.einsum("wii->wi", impedance)).max(axis=0)
    heard = np.flatnonzero(radiates(size, lengths, body))
    scale = np.sqrt(size[heard])
    both = impedance[:, heard[:, None], heard] / np.multiply.outer(scale, scale)
    return np.asarray(np.linalg.eigvalsh((both + np.swapaxes(both, 1, 2)).imag / 2)[:, 0])


@dataclass(frozen=True, eq=False, kw_only=True)
class Constraint:
    """G(ω) = (ω/ω0 + ω0/ω)² Re H(iω), finite and not zero at both ends when H(0) = 0.

    ω = ω0 tan(θ/2), θ in [0, π], ω0 the poles' geometric mean. `span` are the residues left free.
    """

    poles: np.ndarray
    span: np.ndarray  # (columns of the basis, free)
    n: int

    @property
    def middle(self) -> float:
        """ω0 [rad/s]."""
        return float(np.exp(np.mean(np.log(np.abs(self.poles)))))

    def rows(self, theta: np.ndarray) -> np.ndarray:
        """G of each free column, (nθ, free)."""
        # Next to the ends rounding would win; there G equals its limits to 1e-8.
        theta = np.clip(theta, 1e-4, np.pi)
        tangent = np.tan(theta / 2)
        inner = theta < np.pi - 1e-4
        columns = np.empty((theta.size, self.span.shape[0]))
        t = tangent[inner]
        columns[inner] = ((t + 1 / t) ** 2)[:, None] * basis(self.poles, self.middle * t).real
        columns[~inner] = -derivative_at_start(self.poles) / self.middle**2
        return columns @ self.span

    def matrix(self, entries: np.ndarray) -> np.ndarray:
        """Symmetric (nθ, n, n) from the entries (nθ, m) of upper triangles."""
        full = np.empty((len(entries), self.n, self.n))
        i, j = np.triu_indices(self.n)
        full[:, i, j] = entries
        full[:, j, i] = entries
        return full

    @property
    def diagonal(self) -> np.ndarray:
        """Entries (m,) of the identity."""
        return np.eye(self.n)[np.triu_indices(self.n)]

    def grid(self) -> np.ndarray:
        """θ for the search: even, and denser about each pole by its width."""
        peaks = np.pi - 2 * np.arctan2(self.middle, np.abs(self.poles.imag))
        width = np.abs(self.poles.real) / np.abs(self.poles)
        near = (peaks + np.multiply.outer(np.linspace(-2, 2, 9), width)).ravel()
        every = np.sort(np.clip(np.concatenate([np.linspace(0, np.pi, GRID), near]), 0, np.pi))
        return every[np.diff(every, prepend=-1.0) > CLOSE]

    def lowest(self, solution: np.ndarray, low: float, high: float) -> tuple[float, float]:
        """θ and value of the least eigenvalue's minimum between two angles, by three nested grids."""
        # Eigenvalues cross, so the least one has kinks and several minima: no golden section here.
        for _ in range(3):
            theta = np.linspace(low, high, 33)
            least = np.linalg.eigvalsh(self.matrix(self.rows(theta) @ solution))[:, 0]
            i = int(least.argmin())
            low, high = theta[max(i - 1, 0)], theta[min(i + 1, 32)]
        return float(theta[i]), float(least[i])


def enforce(
    columns: np.ndarray,
    target: np.ndarray,
    constraint: Constraint,
    misfit: Callable[[np.ndarray], float],
    tolerance: float = np.inf,
) -> np.ndarray | None:
    """Solution (free + others, m) of least squares columns x = target with G(ω) >= 0 at all ω.

    The first columns of `columns` are the constraint's free residues; those after are not constrained. `misfit` is that
    of a solution: None as soon as one without all cuts, nearer to the target, has more of it than the tolerance. The
    search ends with a lift by which it hardly rises.
    """
    free = constraint.span.shape[1]
    others = columns.shape[1] - free
    # Free columns last: their block of R alone then carries distances with the others at their best.
    q, r = np.linalg.qr(np.column_stack([columns[:, free:], columns[:, :free]]))
    goal, block = q.T @ target, r[others:, others:]

    def whole(x: np.ndarray) -> np.ndarray:
        return np.vstack([x, np.linalg.solve(r[:others, :others], goal[:others] - r[:others, others:] @ x)])

    nearest = z = goal[others:]
    theta, diagonal = constraint.grid(), constraint.diagonal
    rows, cuts = constraint.rows(theta), _Cuts.none(free, constraint.n)
    for _ in range(ROUNDS):
        x = np.linalg.solve(block, z)
        near = misfit(whole(x))
        if near > tolerance:
            return None
        values, vectors = np.linalg.eigh(constraint.matrix(rows @ x))
        lift = _lift(block, rows, values[:, 0])
        if lift is not None and misfit(whole(x + np.multiply.outer(lift, diagonal))) <= min(RISE * near, tolerance):
            break
        where, direction = _negative(values, vectors)
        cuts = cuts.more(np.linalg.solve(block.T, rows[where].T).T, direction).active(nearest)
        z = nearest + cuts.step
    lifted = _lifted(constraint, block, theta, x)
    return None if lifted is None else whole(lifted)


def _negative(values: np.ndarray, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where along the grid an eigenvalue has a local minimum below zero, (nv,), and in which direction (nv, n)."""
    edged = np.pad(values, ((1, 1), (0, 0)), constant_values=np.inf)
    at, k = np.nonzero((values <= edged[:-2]) & (values <= edged[2:]) & (values < 0))
    return at, vectors[at, :, k]


def _negative_between(constraint: Constraint, x: np.ndarray, theta: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Angles between grid points at which the least eigenvalue is negative: the certificate, empty when passive.

    λ_min is concave in the matrix, so that between two points G falls below both by h²/8 |G''| at most: intervals
    that may so reach zero are halved until none may, or one is negative.
    """
    G = constraint.matrix(rows @ x)
    least, h = np.linalg.eigvalsh(G)[:, 0], np.diff(theta)
    slope = np.diff(G, axis=0) / h[:, None, None]
    bend = np.linalg.norm(np.diff(slope, axis=0), axis=(1, 2)) / ((h[1:] + h[:-1]) / 2)
    bend = np.pad(bend, 1, mode="edge")
    fall = CAUTION / 8 * h**2 * np.maximum(bend[1:], bend[:-1])
    low, high, lower = theta[:-1], theta[1:], np.minimum(least[1:], least[:-1])
    negative = []
    for _ in range(HALVINGS):
        open_ = (lower < fall) & (fall > MARGIN / 10)
        if not open_.any():
            break
        low, high, lower, fall = low[open_], high[open_], lower[open_], fall[open_]
        middle = (low + high) / 2
        value = np.linalg.eigvalsh(constraint.matrix(constraint.rows(middle) @ x))[:, 0]
        below = value < 0
        negative += [constraint.lowest(x, *ends)[0] for ends in zip(low[below], high[below], strict=True)]
        low, middle, high, lower, fall, value = (v[~below] for v in (low, middle, high, lower, fall, value))
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        lower, fall = np.tile(np.minimum(lower, value), 2), np.tile(fall / 4, 2)
    return np.array(negative)


def _lift(block: np.ndarray, rows: np.ndarray, least: np.ndarray) -> np.ndarray | None:
    """The least y (free,), by |block y|, whose rows y are more than the least eigenvalues (nθ,) lack to zero.

    Added to the diagonal of all motions it leaves no eigenvalue negative on the grid.
    """
    lack = np.maximum(-least, 0.0)
    if not lack.any():
        return np.zeros(rows.shape[1])
    # Between two points as much as the more lacking of both.
    lack[1:-1] = np.maximum(lack[1:-1], np.maximum(lack[2:], lack[:-2]))
    step = _least_distance(np.linalg.solve(block.T, rows.T).T, SPARE * lack + MARGIN)
    return None if step is None else np.linalg.solve(block, step)


def _lifted(constraint: Constraint, block: np.ndarray, theta: np.ndarray, x: np.ndarray) -> np.ndarray | None:
    """x lifted until no eigenvalue is negative, between points of the grid neither; None if that does not end."""
    for _ in range(LIFTS):
        rows = constraint.rows(theta)
        least = np.linalg.eigvalsh(constraint.matrix(rows @ x))[:, 0]
        if least.min() >= 0:
            between = np.setdiff1d(_negative_between(constraint, x, theta, rows), theta)
            if between.size == 0:
                return x
            theta = np.sort(np.concatenate([theta, between]))
            rows = constraint.rows(theta)
            least = np.linalg.eigvalsh(constraint.matrix(rows @ x))[:, 0]
        lift = _lift(block, rows, least)
        if lift is None:
            return None
        x = x + np.multiply.outer(lift, constraint.diagonal)
    return None


@dataclass(frozen=True, eq=False, kw_only=True)
class _Cuts:
    """Half-spaces rowᵀ Z (v vᵀ) >= MARGIN, Z = block x, and how hard each one pushes."""

    row: np.ndarray  # (nc, free)
    direction: np.ndarray  # (nc, n) v
    push: np.ndarray  # (nc,) multipliers

    @classmethod
    def none(cls, free: int, n: int) -> "_Cuts":
        return cls(row=np.zeros((0, free)), direction=np.zeros((0, n)), push=np.zeros(0))

    @property
    def products(self) -> np.ndarray:
        """v vᵀ as entries of the upper triangle (nc, m) of which those off the diagonal count twice."""
        i, j = np.triu_indices(self.direction.shape[1])
        return self.direction[:, i] * self.direction[:, j] * np.where(i == j, 1.0, 2.0)

    @property
    def step(self) -> np.ndarray:
        """From the nearest Z to that which no cut forbids (free, m)."""
        return self.row.T @ (self.push[:, None] * self.products)

    def more(self, row: np.ndarray, direction: np.ndarray) -> "_Cuts":
        """With others beside them, each scaled to length 1."""
        length = np.linalg.norm(row, axis=1) * np.sqrt(2 - np.sum(direction**4, axis=1))
        row, push = row / length[:, None], np.ones(len(row))
        pairs = (self.row, row), (self.direction, direction), (self.push, push)
        return _Cuts(**dict(zip(("row", "direction", "push"), map(np.concatenate, pairs), strict=True)))

    def active(self, nearest: np.ndarray) -> "_Cuts":
        """Those that push, and how hard, where Z is as near to `nearest` (free, m) as all of them allow."""
        v = self.direction
        gram = (self.row @ self.row.T) * (2 * (v @ v.T) ** 2 - v**2 @ (v**2).T)
        lack = MARGIN - np.einsum("cf,cf->c", self.row, self.products @ nearest.T)
        push = _complementary(gram, lack, self.push > 0)
        keep = push > 0
        return _Cuts(row=self.row[keep], direction=v[keep], push=push[keep])


def _complementary(matrix: np.ndarray, lack: np.ndarray, active: np.ndarray) -> np.ndarray:
    """x >= 0 with y = matrix x - lack >= 0 and x · y = 0, beginning with the `active` ones (n,) above zero.

    Block principal pivoting (Portugal, Judice and Vicente 1994): all that is wrong changes sides at once; where
    that goes round, the last one alone (Murty 1974).
    """
    fewest, chances = lack.size + 1, CHANCES
    matrix = matrix + RIDGE * np.eye(lack.size)
    for _ in range(EXCHANGES):
        x = np.zeros(lack.size)
        x[active] = cho_solve(cho_factor(matrix[np.ix_(active, active)]), lack[active])
        wrong = np.where(active, x < 0, matrix @ x < lack)
        count = int(wrong.sum())
        if count == 0:
            break
        fewest, chances = (count, CHANCES) if count < fewest else (fewest, chances - 1)
        active = active ^ (wrong if chances >= 0 else np.arange(lack.size) == np.flatnonzero(wrong)[-1])
    return np.maximum(x, 0.0)


def _least_distance(c: np.ndarray, d: np.ndarray) -> np.ndarray | None:
    """The shortest z with c z >= d, by non-negative least squares on the dual; None if that ends not, or no z is."""
    size = np.linalg.norm(c, axis=1)
    c, d = c / size[:, None], d / size
    unit = max(np.abs(d).max(), 1e-300)
    matrix = np.vstack([c.T, d / unit])
    goal = np.append(np.zeros(c.shape[1]), 1.0)
    try:
        dual, _ = nnls(matrix, goal, maxiter=20 * len(c))
    except RuntimeError:
        return None
    residual = goal - matrix @ dual
    return -unit * residual[:-1] / residual[-1] if residual[-1] > 0 else None
