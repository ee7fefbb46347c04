"""Radiation memory as a passive state space: K(t) = Re Σ Rₖ exp(βₖt), poles shared by all entries.

With velocity v(t) the memory load is -∫K(t-τ)v(τ)dτ = -Re Σ Rₖ rₖ, ṙₖ = βₖrₖ + v. In harmonic
motion exp(-iωt) its transfer is B(ω) - iω(A(ω) - A∞), so the fit needs no time-domain kernel.
Poles come from vector fitting (Gustavsen and Semlyen 1999), residues from least squares under
the constraint that the fitted damping matrix is positive semidefinite at every frequency.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg
from scipy.optimize import nnls

from solver.errors import SimulationFailed

LARGEST_ORDER = 40  # poles, conjugates not counted
SILENT = 0.02  # share of the largest scale below which a direction counts as silent
ROUNDS = 40  # of cutting planes


@dataclass(frozen=True, eq=False, kw_only=True)
class RadiationMemory:
    """K(t) = Re Σ residue exp(beta t): beta (p,), residue (p, n, n) symmetric, one of each conjugate pair.

    error: largest deviation of the transfer from the data, each entry relative to the geometric
    mean of its two diagonal entries' peaks.
    """

    beta: np.ndarray
    residue: np.ndarray
    added_mass_inf: np.ndarray
    error: float

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """K (…, n, n) [N/m …] at times t ≥ 0 [s]."""
        decay = np.exp(np.multiply.outer(np.asarray(t, float), self.beta))
        return np.tensordot(decay, self.residue, axes=1).real

    def frequency(self, omega: np.ndarray) -> np.ndarray:
        """B - iω(A - A∞), (…, n, n), at ω [rad/s] in the convention exp(-iωt)."""
        return np.tensordot(_kernels(np.asarray(omega, float), self.beta), _halves(self.residue), axes=1).conj()

    def damping(self, omega: np.ndarray) -> np.ndarray:
        """Fitted radiation damping B (…, n, n)."""
        return self.frequency(omega).real


def _kernels(omega: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """1/(iω - β) and 1/(iω - β̄): (…, 2p)."""
    s = 1j * omega[..., None]
    return np.concatenate([1 / (s - beta), 1 / (s - beta.conj())], axis=-1)


def _halves(residue: np.ndarray) -> np.ndarray:
    return np.concatenate([residue, residue.conj()]) / 2


def _basis(omega: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Real unknowns: Re and Im of each residue; columns (nw, 2p) complex of the transfer at iω."""
    plus, minus = np.split(_kernels(omega, beta), 2, axis=-1)
    return np.concatenate([(plus + minus) / 2, 1j * (plus - minus) / 2], axis=-1)


def _stack(x: np.ndarray) -> np.ndarray:
    return np.concatenate([x.real, x.imag])


def fit(
    omega: np.ndarray,
    added_mass: np.ndarray,
    damping: np.ndarray,
    added_mass_inf: np.ndarray,
    tolerance: float,
    band: float = np.inf,
    lever: np.ndarray | None = None,
) -> RadiationMemory:
    """The smallest passive memory whose error meets `tolerance`, from A, B (nw, n, n) at ω (nw,).

    Errors count in full up to `band` [rad/s] and ever less beyond it, (band/ω)⁶: nothing moves
    there, while the slow short waves between two floats would cost most of the poles. lever (n,):
    a length for each rotation, 1 for each translation; by it a direction that makes no waves but
    the panels' noise (pitch of a sphere about its centre) is known and left out.
    """
    whole = damping.shape[1]
    transfer = _semidefinite(damping) + 1j * omega[:, None, None] * (added_mass - added_mass_inf)
    transfer = (transfer + transfer.transpose(0, 2, 1)) / 2
    # No load at zero frequency: anchors what lies below the lowest solved one.
    omega, transfer = np.concatenate([[0.0], omega]), np.concatenate([np.zeros((1, whole, whole)), transfer])
    size = np.sqrt(np.abs(np.einsum("wii->wi", transfer)).max(axis=0, initial=0.0))
    per_length = size / (np.ones(whole) if lever is None else lever)
    heard = np.flatnonzero(per_length > SILENT * per_length.max(initial=0.0))
    n, size = heard.size, size[heard]
    if n == 0:
        nothing = np.zeros((0, whole, whole), complex)
        return RadiationMemory(beta=np.zeros(0, complex), residue=nothing, added_mass_inf=added_mass_inf, error=0.0)
    upper = np.triu_indices(n)
    data = transfer[:, heard[upper[0]], heard[upper[1]]] / (size[upper[0]] * size[upper[1]])
    weight = 1 / (1 + (omega / band) ** 6)
    for order in range(4, LARGEST_ORDER + 1, 2):
        beta = _poles(omega, data, weight, order, min(band, 0.6 * omega[-1]))
        basis = _basis(omega, beta)
        entries = linalg.lstsq(_stack(weight[:, None] * basis), _stack(weight[:, None] * data))[0]
        entries = _made_passive(omega, weight, beta, entries, upper, n)
        error = float(np.abs(weight[:, None] * (basis @ entries - data)).max())
        if error < tolerance:
            residue = np.zeros((beta.size, whole, whole), complex)
            residue[:, heard[:, None], heard] = _matrix(entries, upper, n) * np.outer(size, size)
            return RadiationMemory(
                beta=beta,
                residue=residue,
                added_mass_inf=(added_mass_inf + added_mass_inf.T) / 2,
                error=error,
            )
    raise SimulationFailed(
        f"the radiation memory does not meet memory_tolerance = {tolerance:g} with {LARGEST_ORDER} poles;"
        " refine the frequencies of the BEM or allow a larger error"
    )


def _semidefinite(damping: np.ndarray) -> np.ndarray:
    """Nearest positive semidefinite matrices: what panels leave negative is not physics."""
    value, vector = np.linalg.eigh((damping + damping.transpose(0, 2, 1)) / 2)
    return np.einsum("wij,wj,wkj->wik", vector, np.maximum(value, 0), vector)


def _matrix(entries: np.ndarray, upper, n: int) -> np.ndarray:
    """Residues (p, n, n) complex from real unknowns (2p, entries)."""
    p = len(entries) // 2
    residue = np.zeros((p, n, n), complex)
    residue[:, upper[0], upper[1]] = entries[:p] + 1j * entries[p:]
    residue[:, upper[1], upper[0]] = residue[:, upper[0], upper[1]]
    return residue


def _poles(omega: np.ndarray, data: np.ndarray, weight: np.ndarray, order: int, top: float) -> np.ndarray:
    """Shared poles (p,), Im > 0 or real, of data (nw, entries) by weighted vector fitting."""
    imag = np.linspace(omega[1], top, order)
    beta = -0.3 * imag + 1j * imag
    kept = np.abs(data).max(axis=0) > 1e-3 * np.abs(data).max()
    for _ in range(12):
        columns = weight[:, None] * _basis(omega, beta)
        blocks, sides = [], []
        for f in data[:, kept].T:
            q, r = linalg.qr(np.concatenate([_stack(columns), -_stack(f[:, None] * columns)], axis=1), mode="economic")
            m = columns.shape[1]
            blocks.append(r[m:, m:])
            sides.append(q[:, m:].T @ _stack(weight * f))
        sigma = linalg.lstsq(np.concatenate(blocks), np.concatenate(sides))[0]
        zeros = linalg.eigvals(_inverse_state(beta, sigma))
        zeros = -np.abs(zeros.real) + 1j * zeros.imag
        beta = _one_of_each(zeros)
    return beta


def _inverse_state(beta: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """State matrix of 1/(1 + Σ σ·basis): a 2x2 block for each pair, one state for a real pole."""
    p = beta.size
    state = linalg.block_diag(*([[b.real, b.imag], [-b.imag, b.real]] for b in beta))
    drive, read = np.tile([1.0, 0.0], p), np.stack([sigma[:p], sigma[p:]], axis=1).ravel()
    real = np.repeat(beta.imag == 0, 2) & (np.arange(2 * p) % 2 == 1)
    return (state - np.outer(drive, read))[np.ix_(~real, ~real)]


def _one_of_each(zeros: np.ndarray) -> np.ndarray:
    """Upper-half-plane poles and real ones, in a fixed order."""
    scale = np.abs(zeros).max()
    kept = zeros[zeros.imag > -1e-9 * scale]
    kept = np.where(np.abs(kept.imag) < 1e-9 * scale, kept.real, kept)
    return kept[np.lexsort((kept.real, kept.imag))].astype(complex)


def _made_passive(omega, weight, beta, entries, upper, n):
    """Residues (2p, entries) with B(ω) ⪰ 0 for all ω, changed on the diagonal as little as need be.

    Cutting planes: wherever uᵀBu < 0, the change Δ of the diagonal must restore uᵀ(B + Δ)u ≥ 0.
    The least such change in weighted least squares is Lawson and Hanson's least-distance problem.
    """
    basis = _basis(omega, beta)
    columns = _stack(weight[:, None] * basis)
    # Real poles leave their imaginary unknown without effect: the ridge keeps it at zero.
    gram = columns.T @ columns
    factor = linalg.cholesky(gram + 1e-10 * np.trace(gram) * np.eye(len(gram)), lower=True)
    grid = _certificate_grid(omega[-1], beta)
    rows = np.concatenate([_basis(grid, beta).real * (1 + grid[:, None] ** 2), _tail(beta)[None]])
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    diagonal = np.flatnonzero(upper[0] == upper[1])
    wide = linalg.solve_triangular(factor, rows.T, lower=True).T
    cuts, sides, result = [], [], entries
    for _ in range(ROUNDS):
        fitted = np.zeros((len(rows), n, n))
        fitted[:, upper[0], upper[1]] = fitted[:, upper[1], upper[0]] = rows @ result
        value, vector = np.linalg.eigh(fitted)
        low = value[:, 0]
        if low.min() >= 0:
            break
        dips = (low < 0) & (low <= np.append(low[1:], 0)) & (low <= np.append(0, low[:-1]))
        for w in np.flatnonzero(dips):
            u = vector[w, :, 0]
            form = np.where(upper[0] == upper[1], 1.0, 2.0) * u[upper[0]] * u[upper[1]]
            cuts.append(np.outer(u**2, wide[w]).ravel())
            sides.append(1e-6 - rows[w] @ entries @ form)
        change = _least_distance(np.array(cuts), np.array(sides)).reshape(n, -1)
        result = entries.copy()
        result[:, diagonal] += linalg.solve_triangular(factor, change.T, lower=True, trans="T")
    return result


def _least_distance(cuts: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Smallest y with cuts @ y >= sides."""
    system = np.concatenate([cuts.T, sides[None]])
    target = np.zeros(len(system))
    target[-1] = 1.0
    dual, _ = nnls(system, target, maxiter=100 * len(sides))
    rest = system @ dual - target
    return -rest[:-1] / rest[-1]


def _certificate_grid(top: float, beta: np.ndarray) -> np.ndarray:
    """Frequencies at which passivity is checked: dense around the poles, out to where the tail rules."""
    near = np.concatenate([np.abs(b.imag) + np.abs(b.real) * np.linspace(-3, 3, 25) for b in beta])
    wide = np.concatenate([np.linspace(0, 1.5 * top, 600), top * np.geomspace(1.5, 1e3, 150)])
    return np.unique(np.abs(np.concatenate([near, wide])))


def _tail(beta: np.ndarray) -> np.ndarray:
    """Row of lim ω²B(ω) = -Re Σ Rβ in the real unknowns."""
    return np.concatenate([-beta.real, beta.imag])


def retardation(omega: np.ndarray, damping: np.ndarray, t: np.ndarray) -> np.ndarray:
    """K(t) = 2/π ∫ B cos ωt dω (nt, …) by Filon's rule on the given grid, B falling to zero below it.

    Above the last frequency B is continued as ω⁻⁴ B_last, whose cosine integral is taken numerically.
    """
    top = omega[-1]
    tail = top * np.geomspace(1, 60, 4000)[1:]
    w = np.concatenate([[0.0], omega, tail])
    B = np.concatenate([np.zeros((1, *damping.shape[1:])), damping, damping[-1] * (top / tail[:, None, None]) ** 4])
    slope = np.diff(B, axis=0) / np.diff(w)[:, None, None]
    kernel = np.empty((len(t), *damping.shape[1:]))
    for i, time in enumerate(t):
        if time == 0:
            kernel[i] = np.trapezoid(B, w, axis=0)
            continue
        # ∫ (a + b ω) cos ωt dω of each linear piece; the ends telescope to zero.
        kernel[i] = np.tensordot(np.diff(np.cos(w * time)), slope, axes=1) / time**2
        kernel[i] += (B[-1] * np.sin(w[-1] * time) - B[0] * np.sin(w[0] * time)) / time
    return 2 / np.pi * kernel
