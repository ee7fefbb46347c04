"""The linear model's equation in the joints and the modes that waves and drag excite; the others only follow."""

import numpy as np

from solver.coupled.linear import LinearModel
from solver.coupled.support import real_by_complex

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
        nm, d, L = model.modes.shape[1], model.of_modes(omega), model.of_floats(omega, Y)
        stiff = _stiff(model.modes[0], omega.max(), drag)
        self.omega = omega
        self.stiff = np.concatenate([stiff, np.zeros(len(model.mass) - nm, bool)])
        self.kept = np.ix_(~self.stiff, ~self.stiff)
        self.S, self.T = model.shape[:, self.stiff], model.shape[:, ~self.stiff]
        flexibility = 1 / d[:, stiff]
        (ns, nz), nw = (int(stiff.sum()), len(self.S)), len(omega)
        carriers = self.S[: nz - (len(model.mass) - nm)]  # which alone the modes move
        nc = len(carriers)
        followed = (flexibility @ (carriers[:, None] * carriers).reshape(nc * nc, ns).T).reshape(nw, nc, nc)
        given, self.load = L[:, :, :nc] @ followed, L.copy()
        self.load[:, :nc] = np.linalg.solve(np.eye(nc) + given[:, :nc], L[:, :nc])
        self.load[:, nc:] -= given[:, nc:] @ self.load[:, :nc]
        self.Z = self.T.T @ (self.load.reshape(nw * nz, nz) @ self.T).reshape(nw, nz, self.T.shape[1])
        soft = range(nm - ns)
        self.Z[:, soft, soft] += d[:, ~stiff]
        self.flexibility = np.ascontiguousarray(flexibility.T)

    def response(self, force: np.ndarray, damping: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """X (n, nw) to forces (n, nw) with further damping (n, n), at the last known rates (n, nw).

        Not a number where the equation is singular.
        """
        Z, stiff = self.Z, self.stiff
        if damping.any():
            Z = Z - 1j * self.omega[:, None, None] * damping[self.kept]
            apart = damping.copy()
            apart[self.kept] = 0.0
            if apart.any():
                force = force - real_by_complex(apart, rate)
        X, follow = np.empty(force.shape, complex), force[stiff] * self.flexibility
        of_follow = self._loads(real_by_complex(self.S, follow))
        x = X[~stiff] = _solved(Z, force[~stiff] - real_by_complex(self.T.T, of_follow))
        load = of_follow + self._loads(real_by_complex(self.T, x))
        X[stiff] = follow - real_by_complex(self.S.T, load) * self.flexibility
        return X

    def _loads(self, z: np.ndarray) -> np.ndarray:
        """Λ z (nz, nw) of z (nz, nw)."""
        return (self.load @ z.T[..., None])[..., 0].T


def _stiff(squares: np.ndarray, fastest: float, drag: np.ndarray) -> np.ndarray:
    """Which modes of ω² (nm,) follow in waves up to that frequency: all above STIFF of it, unless drag is strong there.

    In turn with the rest their drag settles by ω tr(d⁻¹D) a round, at most.
    """
    stiff = squares > (STIFF * fastest) ** 2
    share = fastest * np.sum(np.diag(drag)[stiff] / (squares[stiff] - fastest**2))
    return stiff & bool(share <= WEAK)


def _solved(Z: np.ndarray, force: np.ndarray) -> np.ndarray:
    """X (n, nw) to forces (n, nw); not a number where Z (nw, n, n) is singular."""
    try:
        return np.linalg.solve(Z, force.T[..., None])[..., 0].T
    except np.linalg.LinAlgError:  # which does not say where
        return np.full(force.shape, np.nan, complex)
