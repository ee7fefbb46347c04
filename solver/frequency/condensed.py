"""The linear model's equation in the joints and the modes that waves and drag excite; the others only follow."""

from copy import copy

import numpy as np

from solver.coupled.linear import LinearModel
from solver.kernels import FAST, kernel, whole_kernel
from solver.lines import real_by_complex

STIFF = 2.0  # times the fastest wave's frequency: modes above may follow
WEAK = 0.05  # share that drag has, at most, in what holds all of them together
LANES = 32  # waves side by side, so that loops over them are SIMD's; of few coordinates, no loop over these is


class Condensed:
    """Modes t that follow, dynamic stiffness d, shapes S, forces f; kept coordinates x, shapes T; floats' loads L z.

    From p_t = (f_t - Sᵀ L z)/d_t and z = T x + S p_t, with Λ = (1 + L S d_t⁻¹ Sᵀ)⁻¹ L and g = S f_t/d_t,

        [d + Tᵀ Λ T - iω D] x = f - Tᵀ Λ g,   L z = Λ (T x + g).

    Stiff modes follow: drag on them, and by them, is that of the last known rates, weak beside d_t. Without it all do.
    """

    def __init__(self, model: LinearModel, omega: np.ndarray, Y: np.ndarray, drag: np.ndarray):
        """Y (nw, na, na): radiation impedance; drag (nm, nm): damping of the modes."""
        nm, d = model.modes.shape[1], model.of_modes(omega)
        stiff = _stiff(model.modes[0], omega.max(), drag)
        self.model, self.omega = model, omega
        self.stiff = np.flatnonzero(stiff)
        self.kept = np.setdiff1d(np.arange(len(model.mass)), self.stiff)
        self.S, self.T = (model.shape.take(which, axis=1) for which in (self.stiff, self.kept))
        flexibility, self.soft = 1 / d[:, stiff], d[:, ~stiff]
        carriers = self.S[: len(self.S) - (len(model.mass) - nm)]  # which alone the modes move
        nc = len(carriers)
        pairs = (carriers[:, None] * carriers).reshape(nc * nc, self.S.shape[1])
        self.followed = (flexibility @ pairs.T).reshape(len(omega), nc, nc)
        self.flexibility = np.ascontiguousarray(flexibility.T)
        self.rates = np.take(omega, _lanes(omega.size))
        self._among = np.ix_(self.kept, self.kept)
        self._radiate(Y)

    def _radiate(self, Y: np.ndarray) -> None:
        L, T, nc = self.model.of_floats(self.omega, Y), self.T, self.followed.shape[1]
        given, load = L[:, :, :nc] @ self.followed, L.copy()
        load[:, :nc] = np.linalg.solve(np.eye(nc) + given[:, :nc], L[:, :nc])
        load[:, nc:] -= given[:, nc:] @ load[:, :nc]
        Z = T.T @ (load.reshape(len(L) * len(T), len(T)) @ T).reshape(len(L), *T.shape)
        soft = range(self.soft.shape[1])
        Z[:, soft, soft] += self.soft
        self.Z, self.load = _side_by_side(Z), _side_by_side(load)

    def radiating(self, Y: np.ndarray) -> "Condensed":
        """With another radiation impedance."""
        other = copy(self)
        other._radiate(Y)
        return other

    def apart(self, damping: np.ndarray) -> np.ndarray:
        """A damping (n, n) without what of it is among the kept coordinates."""
        rest = damping.copy()
        rest[self._among] = 0.0
        return rest

    def response(self, force: np.ndarray, damping: np.ndarray) -> np.ndarray:
        """X (n, nw) to forces (n, nw) with further damping (n, n) among the kept coordinates.

        Of what is apart from those the last known rates make forces. Not a number where the equation is singular.
        """
        X, follow = np.empty(force.shape, complex), force.take(self.stiff, axis=0) * self.flexibility
        x, load = force.take(self.kept, axis=0), real_by_complex(self.S, follow)
        _solve(self.rates, self.Z, damping[self._among], self.load, self.T, x, load)
        X[self.kept] = x
        follow -= real_by_complex(self.S.T, load) * self.flexibility
        X[self.stiff] = follow
        return X


def _lanes(waves: int) -> np.ndarray:
    """Which wave each lane is of (blocks, LANES): the last of all, where there are no more."""
    return np.arange(waves + -waves % LANES).clip(max=waves - 1).reshape(-1, LANES)


def _side_by_side(matrices: np.ndarray) -> np.ndarray:
    """(blocks, n, m, 2, LANES) real and imaginary parts of complex ones (nw, n, m)."""
    parts = np.stack([matrices.real, matrices.imag], axis=-1)[_lanes(len(matrices))]
    return np.ascontiguousarray(np.moveaxis(parts, 1, -1))


@whole_kernel(fastmath=FAST)
def _solve(
    omega: np.ndarray,
    Z: np.ndarray,
    damping: np.ndarray,
    Lambda: np.ndarray,
    T: np.ndarray,
    x: np.ndarray,
    z: np.ndarray,
) -> None:
    """From forces f and g, x (nk, nw) of (Z - iω damping) x = f - Tᵀ Λ g and Λ (T x + g) (nz, nw), in their place.

    ω (blocks, LANES); Z and Λ as `_side_by_side` has them. Not a number where the equation is singular.
    """
    (nz, nk), waves = T.shape, x.shape[1]
    K, g = np.empty((nk, nk + 1, 2, LANES)), np.zeros((nz, 2, LANES))
    load, inverse = np.empty((nz, 2, LANES)), np.empty((2, LANES))
    for block in range(len(Z)):
        first = block * LANES
        count = min(LANES, waves - first)
        for i in range(nz):
            _take(z[i], first, count, g[i])
        _times(Lambda[block], g, load)
        for a in range(nk):
            for b in range(nk):
                K[a, b] = Z[block, a, b]
                for w in range(LANES):
                    K[a, b, 1, w] -= omega[block, w] * damping[a, b]
            K[a, nk] = 0.0
            _take(x[a], first, count, K[a, nk])
            for i in range(nz):
                _add(-T[i, a], load[i], K[a, nk])
        _eliminate(K, inverse)
        for k in range(nk - 1, -1, -1):
            for j in range(k + 1, nk):
                _subtract(K[k, j], K[j, nk], K[k, nk])
            _put(K[k, nk], first, count, x[k])
            for i in range(nz):
                _add(T[i, k], K[k, nk], g[i])
        _times(Lambda[block], g, load)
        for i in range(nz):
            _put(load[i], first, count, z[i])


@kernel(inline="always")
def _take(lines: np.ndarray, first: int, count: int, out: np.ndarray) -> None:
    for w in range(count):
        out[0, w], out[1, w] = lines[first + w].real, lines[first + w].imag


@kernel(inline="always")
def _put(lanes: np.ndarray, first: int, count: int, out: np.ndarray) -> None:
    for w in range(count):
        out[first + w] = lanes[0, w] + 1j * lanes[1, w]


@kernel(inline="always")
def _add(factor: float, lanes: np.ndarray, out: np.ndarray) -> None:
    for part in range(2):
        for w in range(LANES):
            out[part, w] += factor * lanes[part, w]


@kernel(inline="always")
def _subtract(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """Their product, from what is there."""
    for w in range(LANES):
        out[0, w] -= a[0, w] * b[0, w] - a[1, w] * b[1, w]
        out[1, w] -= a[0, w] * b[1, w] + a[1, w] * b[0, w]


@kernel(inline="always")
def _times(matrix: np.ndarray, x: np.ndarray, out: np.ndarray) -> None:
    out[:] = 0.0
    for i in range(len(out)):
        for j in range(len(out)):
            for w in range(LANES):
                out[i, 0, w] += matrix[i, j, 0, w] * x[j, 0, w] - matrix[i, j, 1, w] * x[j, 1, w]
                out[i, 1, w] += matrix[i, j, 0, w] * x[j, 1, w] + matrix[i, j, 1, w] * x[j, 0, w]


@kernel(inline="always")
def _eliminate(K: np.ndarray, inverse: np.ndarray) -> None:
    """Gauss's, with ones left on the diagonal, of K (n, n + 1, 2, LANES), the last column the right side.

    Waves side by side are alike, and have one pivot: the largest in that wave which has the least of it.
    """
    n = K.shape[0]
    for k in range(n):
        best, most = k, 0.0
        for i in range(k, n):
            least = np.inf
            for w in range(LANES):
                least = min(least, abs(K[i, k, 0, w]) + abs(K[i, k, 1, w]))
            if least > most:
                best, most = i, least
        if best != k:
            for j in range(k, n + 1):
                for part in range(2):
                    for w in range(LANES):
                        K[k, j, part, w], K[best, j, part, w] = K[best, j, part, w], K[k, j, part, w]
        for w in range(LANES):
            a, b = K[k, k, 0, w], K[k, k, 1, w]
            size = 1.0 / (a * a + b * b)
            inverse[0, w], inverse[1, w] = a * size, -b * size
        for j in range(k + 1, n + 1):
            for w in range(LANES):
                a, b = K[k, j, 0, w], K[k, j, 1, w]
                K[k, j, 0, w] = a * inverse[0, w] - b * inverse[1, w]
                K[k, j, 1, w] = a * inverse[1, w] + b * inverse[0, w]
        for i in range(k + 1, n):
            for j in range(k + 1, n + 1):
                _subtract(K[i, k], K[k, j], K[i, j])


def _stiff(squares: np.ndarray, fastest: float, drag: np.ndarray) -> np.ndarray:
    """Which modes of ω² (nm,) follow in waves up to that frequency: all above STIFF of it, unless drag is strong there.

    In turn with the rest their drag settles by ω tr(d⁻¹D) a round, at most.
    """
    stiff = squares > (STIFF * fastest) ** 2
    share = fastest * np.sum(np.diag(drag)[stiff] / (squares[stiff] - fastest**2))
    return stiff & bool(share <= WEAK)
