"""Least squares under passivity: the real part of a transfer matrix positive semidefinite at every frequency.

Cutting planes: solve, find the frequencies and directions v in which vᵀ Re H(iω) v is negative, forbid
them, solve again. Each of these problems is a least-distance one (Lawson and Hanson, chapter 23).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar, nnls

from solver.errors import SimulationFailed
from solver.hydrodynamics.rational import basis, derivative_at_start

GRID = 1500  # points of the search in the mapped frequency, before refinement
ROUNDS = 60
MARGIN = 1e-7  # of the scaled transfer: cuts ask for so much more than zero, so that rounds end


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

    def matrix(self, solution: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """G (nθ, n, n) of a solution (free, m)."""
        entries = self.rows(theta) @ solution
        full = np.empty((theta.size, self.n, self.n))
        i, j = np.triu_indices(self.n)
        full[:, i, j] = entries
        full[:, j, i] = entries
        return full

    def violations(self, solution: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Local minima of the eigenvalues of G below zero: θ (nv,), value (nv,), direction (nv, n)."""
        peaks = np.pi - 2 * np.arctan2(self.middle, np.maximum(np.abs(self.poles.imag), 1e-9))
        width = np.abs(self.poles.real) / np.abs(self.poles)
        near = (peaks + np.multiply.outer(np.linspace(-2, 2, 9), width)).ravel()
        theta = np.unique(np.clip(np.concatenate([np.linspace(0, np.pi, GRID), near]), 0, np.pi))
        values = np.linalg.eigvalsh(self.matrix(solution, theta))
        found = []
        for k in range(self.n):
            line = np.concatenate([[np.inf], values[:, k], [np.inf]])
            low = np.flatnonzero((line[1:-1] <= line[:-2]) & (line[1:-1] <= line[2:]) & (line[1:-1] < self.depth_seen))
            found += [self._lowest(solution, theta, i, k) for i in low]
        found = [f for f in found if f[1] < 0]
        if not found:
            return np.zeros(0), np.zeros(0), np.zeros((0, self.n))
        return tuple(np.array(x) for x in zip(*found, strict=True))

    depth_seen = 1e-3  # grid minima so near zero are refined: the true minimum may lie below

    def _lowest(self, solution, theta, i: int, k: int):
        """The minimum of eigenvalue k about grid point i, with its direction."""
        low, high = theta[max(i - 1, 0)], theta[min(i + 1, theta.size - 1)]
        at = lambda x: np.linalg.eigvalsh(self.matrix(solution, np.array([x]))[0])[k]  # noqa: E731
        best = minimize_scalar(at, bounds=(low, high), method="bounded", options={"xatol": 1e-9}).x
        best = min((best, theta[i]), key=at)
        values, vectors = np.linalg.eigh(self.matrix(solution, np.array([best]))[0])
        return best, values[k], vectors[:, k]


def enforce(columns: np.ndarray, target: np.ndarray, constraint: Constraint) -> np.ndarray:
    """Solution (free + others, m) of least squares columns x = target with G(ω) >= 0 at all ω.

    The first columns of `columns` are the constraint's free residues; those after are not constrained.
    """
    free = constraint.span.shape[1]
    # Free columns last: their block of R alone then carries distances with the others at their best.
    order = np.r_[np.arange(free, columns.shape[1]), np.arange(free)]
    q, r = np.linalg.qr(columns[:, order])
    others = columns.shape[1] - free
    goal, block = q.T @ target, r[others:, others:]
    nearest = goal[others:]
    cuts, z = np.zeros((0, nearest.size)), nearest
    for round_ in range(ROUNDS):
        x = np.linalg.solve(block, z)
        theta, _, direction = constraint.violations(x)
        if theta.size == 0:
            rest = np.linalg.solve(r[:others, :others], goal[:others] - r[:others, others:] @ x)
            return np.vstack([x, rest])
        cuts = np.vstack([cuts, _cuts(constraint, block, theta, direction)])
        z = nearest + _least_distance(cuts, MARGIN * 1.5**round_ - cuts @ nearest.ravel()).reshape(nearest.shape)
    raise SimulationFailed(f"radiation memory of {len(constraint.poles)} poles: not passive after {ROUNDS} rounds")


def _cuts(constraint: Constraint, block, theta, direction) -> np.ndarray:
    """Rows c with c · z = vᵀ G(θ) v, z = block x, (nv, free m)."""
    rows = np.linalg.solve(block.T, constraint.rows(theta).T).T
    i, j = np.triu_indices(constraint.n)
    pairs = direction[:, i] * direction[:, j] * np.where(i == j, 1.0, 2.0)
    return np.einsum("vf,vm->vfm", rows, pairs).reshape(len(theta), -1)


def _least_distance(c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """The shortest z with c z >= d, by non-negative least squares on the dual."""
    size = np.linalg.norm(c, axis=1)
    c, d = c / size[:, None], d / size
    unit = max(np.abs(d).max(), 1e-300)
    matrix = np.vstack([c.T, d / unit])
    goal = np.zeros(len(matrix))
    goal[-1] = 1.0
    dual, _ = nnls(matrix, goal)
    residual = goal - matrix @ dual
    return -unit * residual[:-1] / residual[-1]
