"""The linear model's equation in the joints and the modes that waves and drag excite; the others only follow."""

from copy import copy

import numpy as np

from solver.coupled.linear import LinearModel
from solver.coupled.support import real_by_complex
from solver.kernels import kernel, whole_kernel

STIFF = 2.0  # times the fastest wave's frequency: modes above may follow
WEAK = 0.05  # share that drag has, at most, in what holds all of them together


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
        self._among = np.ix_(self.kept, self.kept)
        self._radiate(Y)

    def _radiate(self, Y: np.ndarray) -> None:
        L, T, nc = self.model.of_floats(self.omega, Y), self.T, self.followed.shape[1]
        given, self.load = L[:, :, :nc] @ self.followed, L.copy()
        self.load[:, :nc] = np.linalg.solve(np.eye(nc) + given[:, :nc], L[:, :nc])
        self.load[:, nc:] -= given[:, nc:] @ self.load[:, :nc]
        self.Z = T.T @ (self.load.reshape(len(L) * len(T), len(T)) @ T).reshape(len(L), *T.shape)
        soft = range(self.soft.shape[1])
        self.Z[:, soft, soft] += self.soft

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
        _solve(self.omega, self.Z, damping[self._among], self.load, self.T, x, load)
        X[self.kept] = x
        follow -= real_by_complex(self.S.T, load) * self.flexibility
        X[self.stiff] = follow
        return X


@whole_kernel
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

    Z (nw, nk, nk), Λ (nw, nz, nz). Not a number where the equation is singular. Wave by wave: of few coordinates,
    arrays of matrices take longer to begin with than to solve.
    """
    (nz, nk), load = T.shape, np.empty(len(z), np.complex128)
    K = np.empty((nk, nk + 1), np.complex128)
    for w in range(omega.size):
        _times(Lambda[w], z, w, load)
        for a in range(nk):
            for b in range(nk):
                K[a, b] = Z[w, a, b] - 1j * (omega[w] * damping[a, b])
            side = x[a, w]
            for i in range(nz):
                side -= T[i, a] * load[i]
            K[a, nk] = side
        _eliminate(K)
        for k in range(nk - 1, -1, -1):
            x[k, w] = K[k, nk]
            for j in range(k + 1, nk):
                x[k, w] -= K[k, j] * x[j, w]
        for i in range(nz):
            for a in range(nk):
                z[i, w] += T[i, a] * x[a, w]
        _times(Lambda[w], z, w, load)
        for i in range(nz):
            z[i, w] = load[i]


@kernel(inline="always")
def _times(matrix: np.ndarray, x: np.ndarray, w: int, out: np.ndarray) -> None:
    for i in range(out.size):
        total = 0j
        for j in range(out.size):
            total += matrix[i, j] * x[j, w]
        out[i] = total


@kernel(inline="always")
def _eliminate(K: np.ndarray) -> None:
    """Gauss's, with ones left on the diagonal, of K (n, n + 1), the last column the right side.

    `newton.factorize` would take magnitudes and quotients of complex numbers, which are dearer than all the rest.
    """
    n = K.shape[0]
    for k in range(n):
        best, most = k, 0.0
        for i in range(k, n):
            size = abs(K[i, k].real) + abs(K[i, k].imag)
            if size > most:
                best, most = i, size
        if best != k:
            for j in range(k, n + 1):
                K[k, j], K[best, j] = K[best, j], K[k, j]
        pivot = K[k, k]
        inverse = pivot.conjugate() * (1.0 / (pivot.real**2 + pivot.imag**2))  # numba's own raises where it is zero
        for j in range(k + 1, n + 1):
            K[k, j] *= inverse
        for i in range(k + 1, n):
            factor = K[i, k]
            for j in range(k + 1, n + 1):
                K[i, j] -= factor * K[k, j]


def _stiff(squares: np.ndarray, fastest: float, drag: np.ndarray) -> np.ndarray:
    """Which modes of ω² (nm,) follow in waves up to that frequency: all above STIFF of it, unless drag is strong there.

    In turn with the rest their drag settles by ω tr(d⁻¹D) a round, at most.
    """
    stiff = squares > (STIFF * fastest) ** 2
    share = fastest * np.sum(np.diag(drag)[stiff] / (squares[stiff] - fastest**2))
    return stiff & bool(share <= WEAK)
