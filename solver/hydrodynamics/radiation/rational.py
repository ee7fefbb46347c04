"""Rational functions with common poles and real impulse responses: basis, and relaxed vector fitting.

Poles are stored once a conjugate pair, the one with positive imaginary part, or real. Gustavsen
and Semlyen (1999) and Gustavsen (2006); the per-entry elimination is Deschrijver et al. (2008).
"""

from collections.abc import Iterator

import numpy as np

FASTEST = 10  # largest modulus of a pole, in units of the highest frequency
FEWEST = 2  # pairs of poles that are tried
SMOOTH = 8  # pairs up to which a curve may be smooth that has turned more often
RELOCATED = 8  # times
FELT = 1e-2  # of a misfit
ALIKE = 1e-13  # of the largest mixture: what columns that are the others' mixtures leave by rounding


def starting_poles(omega: np.ndarray, pairs: int) -> np.ndarray:
    """Weakly damped pairs spread evenly over the band, (pairs,) complex [rad/s]."""
    at = np.linspace(omega[0], omega[-1], pairs + 1)[:-1] + (omega[-1] - omega[0]) / (2 * pairs)
    return -0.05 * at + 1j * at


def basis(poles: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Columns at s = iω, real coefficients: a pair gives 1/(s-a) + 1/(s-a*) and i/(s-a) - i/(s-a*)."""
    s = 1j * np.asarray(omega, float)
    columns = []
    for a in poles:
        if a.imag == 0:
            columns.append(1 / (s - a.real))
        else:
            one, other = 1 / (s - a), 1 / (s - a.conjugate())
            columns += [one + other, 1j * (one - other)]
    return np.array(columns).T


def complex_residues(poles: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """r (p, m) with response Re Σ r exp(at), from coefficients (columns of the basis, m)."""
    rows, residues = iter(coefficients), []
    for a in poles:
        residues.append(next(rows) + 0j if a.imag == 0 else 2 * (next(rows) + 1j * next(rows)))
    return np.array(residues)


def derivative_at_start(poles: np.ndarray) -> np.ndarray:
    """K'(0+) of each basis column: -ω² Re tends to it as ω grows."""
    columns = []
    for a in poles:
        columns += [a.real] if a.imag == 0 else [2 * a.real, -2 * a.imag]
    return np.array(columns)


def mixed(samples: np.ndarray, goal: float) -> np.ndarray:
    """As few columns (nw, at most 2 nw) as vector fitting to a misfit cannot tell from `samples` (nw, m).

    It sees sums of squares over the columns, which a real orthogonal mixture of them leaves as they are. Of mixtures
    those are left out that are nothing, as of pairs of bodies alike, and where there are more columns than that those
    that cannot make FELT of the misfit.
    """
    parts = _stacked(samples)
    u, size, _ = np.linalg.svd(parts, full_matrices=False)
    least = ALIKE * size.max(initial=0.0)
    heard = size > (max(least, FELT * goal * np.sqrt(len(samples))) if parts.shape[1] > parts.shape[0] else least)
    real, imag = np.split(u[:, heard] * size[heard], 2)
    return real + 1j * imag


def relocated(poles: np.ndarray, omega: np.ndarray, samples: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """One step of relaxed vector fitting: the zeros of σ, where (σ samples) and σ share `poles`.

    samples: (nw, m) complex at s = iω, weight (nw,). Unstable zeros are mirrored into the left half plane.
    """
    columns = basis(poles, omega)
    # What multiplies (σ samples) is alike for all samples, and eliminated once: what is at right angles to it is left,
    # of each column a triangle.
    along = np.linalg.qr(_stacked(weight[:, None] * np.column_stack([columns, 1j * omega])))[0]
    right = np.column_stack([columns, np.ones(omega.size)])
    rows = (weight[:, None] * samples).T[:, :, None] * right
    rows = np.concatenate([rows.real, rows.imag], axis=1)
    reduced = np.asarray(np.linalg.qr(rows - along @ (along.T @ rows), mode="r"))
    # σ = 1 on average: keeps the trivial solution away without fixing σ at infinity.
    size = np.linalg.norm(weight[:, None] * samples) / omega.size
    matrix = np.vstack([reduced.reshape(-1, right.shape[1]), size * right.real.sum(axis=0)])
    target = np.zeros(len(matrix))
    target[-1] = size * omega.size
    norm = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / norm, target, rcond=None)[0] / norm
    constant = solution[-1]
    if abs(constant) < 1e-8:
        constant = np.copysign(1e-8, constant)
    return _stable(_zeros(poles, solution[:-1], constant), omega)


def fitted(omega: np.ndarray, samples: np.ndarray, pairs: int) -> np.ndarray:
    """Poles of so many pairs, of which a real one is half, that meet samples (nw, m) at s = iω."""
    poles = starting_poles(omega, pairs)
    for _ in range(RELOCATED):
        poles = relocated(poles, omega, samples, np.ones(omega.size))
    return poles


def ever_more_poles(
    omega: np.ndarray, samples: np.ndarray, goal: float, most: int, turns: float = 0.0
) -> Iterator[np.ndarray]:
    """None, and then poles by steps of a quarter more, `most` pairs at most: until samples (nw, m) at s = iω are met
    within the goal, but for a share of iω.

    What turns so often from the first frequency to the last takes a pole for each turn; fewer are tried, up to SMOOTH,
    for it may be too small to count.
    """
    yield np.zeros(0, complex)
    fewer, target, misfit, pairs = mixed(samples, goal), _stacked(samples), np.inf, FEWEST
    while pairs <= most and misfit > goal:
        poles = fitted(omega, fewer, pairs)
        columns = _stacked(np.column_stack([basis(poles, omega), 1j * omega]))
        misfit = float(np.abs(columns @ np.linalg.lstsq(columns, target, rcond=None)[0] - target).max())
        yield poles
        pairs += max(1, pairs // 4)
        while SMOOTH < pairs < turns:
            pairs += pairs // 4


def _stacked(rows: np.ndarray) -> np.ndarray:
    return np.vstack([rows.real, rows.imag])


def _zeros(poles: np.ndarray, residue: np.ndarray, constant: float) -> np.ndarray:
    """Eigenvalues of A - b c/d of the real realization of σ."""
    size = len(residue)
    a, b, i = np.zeros((size, size)), np.zeros(size), 0
    for pole in poles:
        if pole.imag == 0:
            a[i, i], b[i] = pole.real, 1.0
            i += 1
        else:
            a[i : i + 2, i : i + 2] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
            b[i] = 2.0
            i += 2
    return np.linalg.eigvals(a - np.outer(b, residue) / constant)


def _stable(zeros: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """One zero of each pair, mirrored to Re < 0, with least damping and largest modulus that the data resolve."""
    zeros = zeros[zeros.imag >= 0]
    zeros = zeros * np.minimum(1.0, FASTEST * omega[-1] / np.maximum(np.abs(zeros), 1e-300))
    damping = np.maximum(np.abs(zeros.real), 1e-3 * omega[-1] / omega.size)
    return -damping + 1j * np.where(zeros.imag > 1e-9 * omega[0], zeros.imag, 0.0)
