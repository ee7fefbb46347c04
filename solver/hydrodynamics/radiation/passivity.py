"""Least squares under passivity: the real part of a transfer matrix positive semidefinite at every frequency.

Cutting planes: solve, find the frequencies and directions v in which vᵀ Re H(iω) v is negative, forbid
them, solve again. Each of these problems is a least-distance one (Lawson and Hanson, chapter 23).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from solver.hydrodynamics.radiation.rational import basis, derivative_at_start

GRID = 1500  # points of the search in the mapped frequency, before refinement
ROUNDS = 40
CAUTION = 2.0  # factor on how far the least eigenvalue may fall between two points, from second differences
HALVINGS = 12  # of an interval in the search for that
CLOSE = 1e-7  # points of the grid this close to each other are one
LARGE = 300_000  # entries of a problem of least distance that is worth reducing first
MARGIN = 1e-7  # of the scaled transfer: cuts ask for so much more than zero, so that rounds end


SILENT = 1e-3  # a motion whose transfer over its squared length is less, of the largest's, radiates mesh error only
UNPASSIVE = 0.5  # of the added mass: where B/ω takes as much power from the waves it radiates, the data are an error


def least_damping(impedance: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Least eigenvalue (nw,) of B/ω, motions scaled so that none has more than 1 of A + iB/ω = impedance (nw, n, n).

    lengths: (n,) [m], as of `memory.fit`; motions that have next to nothing of it are left out.
    """
    size = np.abs(np.einsum("wii->wi", impedance)).max(axis=0)
    heard = np.flatnonzero(size / lengths**2 >= SILENT * (size / lengths**2).max())
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


def enforce(columns: np.ndarray, target: np.ndarray, constraint: Constraint) -> np.ndarray | None:
    """Solution (free + others, m) of least squares columns x = target with G(ω) >= 0 at all ω, else None.

    The first columns of `columns` are the constraint's free residues; those after are not constrained.
    """
    free = constraint.span.shape[1]
    others = columns.shape[1] - free
    # Free columns last: their block of R alone then carries distances with the others at their best.
    q, r = np.linalg.qr(np.column_stack([columns[:, free:], columns[:, :free]]))
    goal, block = q.T @ target, r[others:, others:]
    nearest = z = goal[others:]
    theta, cuts = constraint.grid(), np.zeros((0, nearest.size))
    rows = constraint.rows(theta)
    for attempt in range(ROUNDS):
        x = np.linalg.solve(block, z)
        where, direction = _negative(constraint.matrix(rows @ x))
        if where.size == 0:
            theta = np.sort(np.concatenate([theta, np.setdiff1d(_negative_between(constraint, x, theta, rows), theta)]))
            rows = constraint.rows(theta)
            where, direction = _negative(constraint.matrix(rows @ x))
        if where.size == 0:
            rest = np.linalg.solve(r[:others, :others], goal[:others] - r[:others, others:] @ x)
            return np.vstack([x, rest])
        cuts = np.vstack([cuts, _cuts(block, rows[where], direction)])
        step = _least_distance(cuts, MARGIN * 1.5**attempt - cuts @ nearest.ravel())
        if step is None:
            return None
        z = nearest + step.reshape(nearest.shape)
    return None


def _negative(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where along the grid an eigenvalue has a local minimum below zero, (nv,), and in which direction (nv, n)."""
    values, vectors = np.linalg.eigh(matrices)
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


def _cuts(block: np.ndarray, rows: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Rows c with c · z = vᵀ G v, z = block x, (nv, free m)."""
    rows = np.linalg.solve(block.T, rows.T).T
    i, j = np.triu_indices(direction.shape[1])
    pairs = direction[:, i] * direction[:, j] * np.where(i == j, 1.0, 2.0)
    return np.einsum("vf,vm->vfm", rows, pairs).reshape(len(rows), -1)


def _least_distance(c: np.ndarray, d: np.ndarray) -> np.ndarray | None:
    """The shortest z with c z >= d, by non-negative least squares on the dual; None if that does not end."""
    size = np.linalg.norm(c, axis=1)
    c, d = c / size[:, None], d / size
    unit = max(np.abs(d).max(), 1e-300)
    matrix = np.vstack([c.T, d / unit])
    goal = np.append(np.zeros(c.shape[1]), 1.0)
    # The same least squares in as many rows as there are cuts, where the residues are far more.
    tall, target = matrix, goal
    if matrix.size > LARGE and len(matrix) > 2 * len(c):
        q, tall = np.linalg.qr(matrix)
        target = q.T @ goal
    try:
        dual, _ = nnls(tall, target, maxiter=20 * len(c))
    except RuntimeError:
        return None
    residual = goal - matrix @ dual
    return -unit * residual[:-1] / residual[-1]
