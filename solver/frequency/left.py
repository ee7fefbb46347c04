"""What linear damping leaves of loads by rate in a sea: its spectrum, and what that moves below the waves.

Of Gaussian rates v with correlations ρ(τ), f = Σ cₖ Heₖ(v/σ)/√k!, what is left is k ≥ 3:

    R(τ) = Σ cₖcₖ' ρ(τ)ᵏ = JJ' (2/π) (asin ρ - ρ) + Σ (cₖcₖ' - JJ'sₖsₖ') ρᵏ,

with J sgn(v) the part of f that jumps, of which sₖ are the terms: its own series would end too late. By ρ³ three waves
make a load at ω₁ + ω₂ - ω₃, too, which is little, but is all there is where a soft mooring resonates below the waves.
"""

from functools import lru_cache

import numpy as np
from numpy.polynomial.hermite_e import hermevander
from scipy.fft import next_fast_len, rfft
from scipy.linalg import eigh
from scipy.special import factorial

from solver.frequency import gaussian
from solver.frequency.bent import Load
from solver.frequency.case import NARROW, Case
from solver.keys import shared
from solver.record.beside import radiating

ORDERS = 99  # of terms without a jump: those of a kink fall with k**-3.5
GRID = (np.arange(8000) + 0.5) * 1e-3  # rates over their std
OFTEN, SELDOM = 16, 4  # samples of the fastest wave's period; of the fastest line's above the waves
FASTEST = 40.0  # times the fastest wave's frequency, up to which lines and modes are looked at
PERIODS = 20.0  # of the slowest wave, in which R is looked at, less and less
# Frequencies below the waves, and from there to above them, by their logarithms, and more of them about any resonance.
EVEN, ABOVE, EACH = 60, 120, 24
PAIRS = 64  # of loads that are looked at together


def slow_motions(
    case: Case, load: Load, axes: np.ndarray, rates: np.ndarray, damping: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """ω (ne,) and lines X (n, ne), but for their phases, of what is left of loads along axes (nj,) at rates (nl, nj).

    With further damping (n, n). None unless a shape swings below the waves or nothing holds it, which drifts by as
    much as it does in a record: the slowest goes half a turn in that.
    """
    model, n, modes, least = case.model, len(case.model.mass), case.modes, np.pi / case.process.duration
    highest = case.waves.min(initial=np.inf)
    slow = modes.omega < highest
    if not (slow.any() and axes.size and least < highest):
        return np.zeros(0), np.zeros((n, 0), complex)
    own, shapes = modes.omega[slow], modes.shapes[:, slow].T
    radiated = radiating(case.system, case.hydrodynamics, own, shapes)[1]
    B = np.einsum("mi,ij,mj->m", shapes, model.damping + damping, shapes) + radiated
    at, width = parts(least, highest, EVEN, own, np.maximum(B / 2, NARROW * own))
    moved = case.driven(at, np.broadcast_to(np.eye(n)[axes], (at.size, axes.size, n)), damping)[0].swapaxes(1, 2)
    S = spectrum(load, rates, case.omega, at, highest, OFTEN * case.waves.max())
    power = np.sum((moved @ S) * moved.conj(), axis=2)
    return at, np.sqrt(2 * width * power.real.T.clip(min=0.0)).astype(complex)


def parts(low: float, high: float, even: int, own: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (ne,) from `low` to `high`, and what each stands for: even in their logarithms, and dense about
    resonances (m,) by half of their widths.
    """
    order = np.lexsort((half, own))
    own, half = own[order], half[order]
    some = np.diff(own, prepend=-np.inf) > half / EACH  # many alike resonate at next to one
    near = own[some, None] + half[some, None] * np.tan(np.linspace(-1.5, 1.5, EACH))
    edges = np.union1d(np.geomspace(low, high, even), near[(near > low) & (near < high)])
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)


def lines(case: Case, load: Load, rates: np.ndarray, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ω (ne,), and at each nj lines of what is left of loads at rates (nl, nj) of a sea, (ne, nj, nj), loads last.

    They go together as the loads do, if a platform or a float bears several of these. From below the waves to FASTEST
    times theirs, dense about resonances, with further damping (n, n).
    """
    model, scene, (slowest, highest) = case.model, case.system.scene, (case.waves.min(), FASTEST * case.waves.max())
    square, shapes = eigh(model.stiffness, model.mass)
    own = np.sqrt(square.clip(min=0.0))
    half = np.maximum(np.sum(shapes * ((model.damping + damping) @ shapes), axis=0) / 2, NARROW * own)
    at, width = parts(slowest / 4, highest, ABOVE, own, half)
    apart = case.system.support is None and max(scene.carriers) < 0
    square, pattern = np.linalg.eigh(spectrum(load, rates, case.omega, at, slowest, SELDOM * highest, apart=apart))
    return at, (pattern * np.sqrt(2 * width[:, None] * square.clip(min=0.0))[:, None]).swapaxes(1, 2)


def spectrum(
    load: Load,
    rates: np.ndarray,
    omega: np.ndarray,
    at: np.ndarray,
    slowest: float,
    sampled: float,
    *,
    apart: bool = False,
) -> np.ndarray:
    """One-sided, at frequencies (ne,), of what is left of loads (ne, nj, nj) at rates (nl, nj) of lines omega (nl,).

    By R at delays of 2π/`sampled`, to PERIODS of the slowest wave. apart: each load's own alone.
    """
    last, nj = PERIODS * 2 * np.pi / slowest, rates.shape[1]
    count = int(np.ceil(sampled * last / (2 * np.pi)))
    step = last / count
    size = next_fast_len(2 * count, real=True)
    place = at * size * step / (2 * np.pi)
    low, half = place.astype(int), np.zeros((at.size, nj, nj), complex)
    window = (0.5 * step / np.pi * (1 + np.cos(np.pi * np.arange(count) / count)))[:, None]
    window[0] /= 2
    i, j = np.nonzero(np.eye(nj) if apart else np.ones((nj, nj)))
    V, terms = rates / gaussian.spread(rates), _terms(load, gaussian.spread(rates))
    for some in np.array_split(np.arange(i.size), -(-i.size // PAIRS)):
        a, b = i[some], j[some]
        rho = np.concatenate([*gaussian.sums(omega, 0.5 * V[:, a] * V[:, b].conj(), 0.0, step, count)])
        seen = rfft(_correlations(rho.clip(-1.0, 1.0), terms, a, b) * window, size, axis=0).conj()
        half[:, a, b] = seen[low] + (place - low)[:, None] * (seen[low + 1] - seen[low])
    return np.asarray(half + half.conj().swapaxes(1, 2))


def _correlations(
    rho: np.ndarray, terms: tuple[np.ndarray, np.ndarray, np.ndarray], a: np.ndarray, b: np.ndarray
) -> np.ndarray:
    """R (m, np) of pairs (np,) of loads whose rates have correlations ρ (m, np)."""
    J, c, s = terms
    jumps = J[a] * J[b]
    square, total = rho**2, np.zeros(rho.shape)
    for term in (c[:, a] * c[:, b] - s[:, None] ** 2 * jumps)[::-1]:
        total += term
        total *= square
    return np.asarray(total * rho + jumps * (2 / np.pi) * (np.arcsin(rho) - rho))


def _terms(load: Load, sigma: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """J (nj,), cₖ (nk, nj) and sₖ (nk,) of the third order and all odd ones above."""
    f, each = load(GRID[:, None] * sigma), _polynomials()
    return 1.5 * f[0] - 0.5 * f[1], each @ f, each.sum(axis=1)


@lru_cache
def _polynomials() -> np.ndarray:
    """Those Heₖ/√k! on the grid, with the weights of a mean (nk, ng)."""
    orders = np.arange(3, ORDERS + 1, 2)
    weight = np.sqrt(2 / np.pi) * (GRID[1] - GRID[0]) * np.exp(-0.5 * GRID**2)
    each = hermevander(GRID, ORDERS)[:, orders] / np.sqrt(factorial(orders))
    return shared((each * weight[:, None]).T)
