"""Statistics of what a linear model does in a sea: max, min, mean, rms and std as the time domain's tables have them.

Lines X (nl, n) stand for x = μ + Re Σ X exp(-iωt). Several are a Gaussian process of variance m₀ = ½Σ|X|², and its
extremes those that a narrow band is expected to have in a time T (Cartwright and Longuet-Higgins 1956):
μ ± (u + γ/u) √m₀, u² = 2 ln N, N = T √(m₂/m₀)/2π cycles; never more than Σ|X|. One line is a harmonic, and lines of
waves whose phases are known are the sum that they make in the record.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from solver.kernels import kernel, whole_kernel
from solver.keys import shared
from solver.lines import squares
from solver.power_takeoff import PtoEfficiency
from solver.statistics import FAINT, Statistics

EULER = 0.5772156649015329
PHASES = 360  # at which a harmonic is looked at, and directions of an integral all round
PHASE = 2 * np.pi * np.arange(PHASES) / PHASES
FIBRES = 36  # whose extremes are looked at
OFTEN, BLOCK = 16, 1024  # samples in the fastest wave where phases are known, and how many are summed at a time
POINTS = 2**14  # of a normal distribution of several variables, and as many opposite ones
GAUSS = np.polynomial.legendre.leggauss(200)
SIZES = 5 * (1 + GAUSS[0])  # of a rate over its std, up to 10
WEIGHTS = 5 * GAUSS[1] * np.sqrt(2 / np.pi) * np.exp(-0.5 * SIZES**2)
PRIMES = np.array([2, 3, 5, 7, 11])
FAR = 8.0  # times its std: how far from zero a mean must be for the length of its vector to be nearly linear


@dataclass(frozen=True, eq=False)
class Process:
    """What lines are of, and for how long."""

    omega: np.ndarray  # (nl,) [rad/s], of waves first
    duration: float  # [s]
    others: int = 0  # lines at its end, that no wave makes
    begin: float | None = None  # [s] where phases are known

    def sampled(self, X: np.ndarray) -> np.ndarray | None:
        """Values (m, n) of lines (nl, n): of one harmonic over its period, else over the record; None if random."""
        return np.concatenate([*self.blocks(X)]) if self.known else None

    @property
    def known(self) -> bool:
        """Whether there is one harmonic, or all phases are known."""
        return self.omega.size == 1 or self.begin is not None

    def blocks(self, X: np.ndarray) -> Iterator[np.ndarray]:
        """Those values, some after others. Lines that no wave makes widen the others' sum."""
        if self.omega.size == 1:
            yield one_period(X)
            return
        assert self.begin is not None, "of known phases"
        waves = len(X) - self.others
        omega, of_waves = self.omega[:waves], X[:waves]
        size = spread(of_waves)
        of_waves = of_waves * np.divide(spread(X), size, out=np.ones(size.shape), where=size > 0)
        count = int(np.ceil(OFTEN * omega.max() * self.duration / (2 * np.pi)))
        yield from sums(omega, of_waves, self.begin, self.duration / count, count)

    def unwaved(self, X: np.ndarray) -> np.ndarray:
        """Which lines (nl, n) have next to nothing of the waves: no sum of those has the others' shape."""
        return spread(X[: len(X) - self.others]) < FAINT * spread(X)


def met(X: np.ndarray) -> np.ndarray:
    """Values (m, n) of a few lines (nl, n) in all phases to each other."""
    each = np.arange(1, POINTS + 1)[:, None] * np.sqrt(PRIMES[: len(X)])  # Richtmyer's sequence fills evenly
    return np.asarray((np.exp(2j * np.pi * each) @ X).real)


def sums(omega: np.ndarray, X: np.ndarray, begin: float, step: float, count: int) -> Iterator[np.ndarray]:
    """Values (m, n) of lines (nl, n) at times a step apart, some after others, `count` in all."""
    turn = np.exp(1j * np.outer(step * np.arange(BLOCK), omega)).view(float)  # cosines and sines by turns
    for first in range(0, count, BLOCK):
        Y = np.exp(-1j * omega * (begin + step * first))[:, None] * X
        yield turn[: count - first] @ np.stack([Y.real, Y.imag], axis=1).reshape(2 * omega.size, -1)


def nodes(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Of a normal number, and their weights: a mean of what is smooth is a sum over them."""
    x, weight = np.polynomial.hermite_e.hermegauss(count)
    return x, weight / weight.sum()


def covariance(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """½ Re Σ X Y* (…, n, m) of lines X (…, nl, n), Y (…, nl, m)."""
    X, Y = (np.concatenate([Z.real, Z.imag], axis=-2) for Z in (X, Y))
    return 0.5 * np.swapaxes(X, -1, -2) @ Y


@kernel
def _cycles(m0: float, m2: float, duration: float) -> float:
    """Number of zero-upcrossings in the time [s], e at least, of a process with moments m₀ and m₂."""
    rate = np.sqrt(m2 / m0) / (2 * np.pi) if m0 > 0 else 0.0
    return max(rate * duration, np.e)


def table(mean: np.ndarray, X: np.ndarray, of: Process) -> np.ndarray:
    """(…, 5) in the order of STATISTICS for means (…) and lines (nl, …)."""
    flat, level = np.ascontiguousarray(X, complex).reshape(len(X), -1), np.broadcast_to(mean, X.shape[1:]).ravel()
    out = np.empty((flat.shape[1], 5))
    _tabulate(level, flat, of.omega**2, of.duration, out)
    if of.begin is not None and len(X) > 1:
        summed = ~of.unwaved(flat)
        out[summed] = tabulated(level[summed] + block for block in of.blocks(flat[:, summed]))
    return out.reshape(*X.shape[1:], 5)


def tabulated(blocks: Iterable[np.ndarray]) -> np.ndarray:
    """The same (n, 5) of samples (m, n), block by block."""
    of = Statistics()
    for block in blocks:
        of.add(block)
    return of.table()


@whole_kernel
def _tabulate(mean: np.ndarray, X: np.ndarray, squared: np.ndarray, duration: float, out: np.ndarray) -> None:
    """The same of lines (nl, n), ω² (nl,), in one pass over them: as arrays their sums take several times as long."""
    n = len(out)
    m0, m2, most = np.zeros(n), np.zeros(n), np.zeros(n)
    _sum(X, squared, m0, m2, most)
    for i in range(n):
        std, top = np.sqrt(0.5 * m0[i]), _largest(m0[i], m2[i], most[i], duration)
        out[i, 0], out[i, 1], out[i, 2] = mean[i] + top, mean[i] - top, mean[i]
        out[i, 3], out[i, 4] = np.hypot(mean[i], std), std


@kernel
def _sum(X: np.ndarray, squared: np.ndarray, m0: np.ndarray, m2: np.ndarray, most: np.ndarray) -> None:
    """See _sums; added to what is there."""
    for w in range(squared.size):
        for i in range(m0.size):
            power = X[w, i].real ** 2 + X[w, i].imag ** 2
            m0[i] += power
            m2[i] += squared[w] * power
            most[i] += np.sqrt(power)


@kernel(inline="always")
def _largest(m0: float, m2: float, most: float, duration: float) -> float:
    """Expected above the mean, of Σ|X|², Σω²|X|² and Σ|X|."""
    u = np.sqrt(2 * np.log(_cycles(m0, m2, duration)))
    return min((u + EULER / u) * np.sqrt(0.5 * m0), most)


def power_table(c: np.ndarray, V: np.ndarray, of: Process) -> np.ndarray:
    """(5,) of P = Σ cᵢ vᵢ² for dampings c (n,) and rates of lines V (nl, n).

    Mean Σ cᵢσᵢ², variance 2 tr (CS)² of a Gaussian process, see `of_lines`; the largest is that of the strongest
    principal rate, whose square has 2N peaks of exponential distribution, and the others' mean.
    """
    if (rates := of.sampled(V)) is not None:
        return tabulated([rates**2 @ c[:, None]])[0]
    if c.size > 1:  # how often an axis moves that absorbs nothing says nothing of the largest
        V, c = V[:, c > 0], c[c > 0]
    m0, m2, most = _sums(V, of.omega)
    principal = np.linalg.eigvals(c[:, None] * covariance(V, V)).real if c.size > 1 else 0.5 * c * m0
    mean, std = principal.sum(), np.sqrt(2 * np.sum(principal**2)) * of_lines(np.diag(c), V)
    strongest = principal.max(initial=0.0)
    largest = min(mean + strongest * _beyond(m0, m2, of.duration), float(c @ most**2))
    return np.array([largest, 0.0, mean, np.hypot(mean, std), std])


def of_lines(A: np.ndarray, X: np.ndarray) -> float:
    """Std of xᵀAx of lines X (nl, n) over that of a Gaussian process, (1 - Σ (¼(X*AX)² + ⅛|XᵀAX|²)/2 tr (AS)²)^½.

    For a line's amplitude does not vary; no two pairs of lines have the same sum or difference of frequencies. Of one
    rate's square 0.79 of two equal lines, 0.995 of 130 of a sea. A (n, n) is symmetric.
    """
    AS, AX = A @ covariance(X, X), X @ A
    whole = 2 * np.sum(AS * AS.T)
    steady = np.sum(np.vecdot(X, AX).real ** 2 / 4 + squares(np.vecdot(X.conj(), AX)) / 8)
    return float(np.sqrt(1 - steady / whole)) if whole > 0 else 1.0


def _sums(X: np.ndarray, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Σ|X|², Σω²|X|² and Σ|X| (n,) of lines (nl, n)."""
    m0, m2, most = np.zeros((3, X.shape[1]))
    _sum(np.ascontiguousarray(X), omega**2, m0, m2, most)
    return m0, m2, most


def _beyond(m0: np.ndarray, m2: np.ndarray, duration: float) -> float:
    """Of the strongest part of rates with moments m₀, m₂ (n,), its square's largest over a time, less its mean."""
    most = max((_cycles(*pair, duration) for pair in zip(m0, m2, strict=True)), default=np.e)
    return float(2 * (np.log(2 * most) + EULER) - 1)


def spread(X: np.ndarray) -> np.ndarray:
    """std (n,) of lines (nl, n)."""
    return np.sqrt(0.5 * squares(X).sum(axis=0))


def share(X: np.ndarray, some: slice) -> float:
    """Largest share of a variance by some of lines (nl, n), of those that are not faint beside others."""
    part, whole = (spread(lines) for lines in (X[some], X))
    felt = whole > FAINT * whole.max(initial=0.0)
    return float(np.max((part[felt] / whole[felt]) ** 2, initial=0.0))


def peak(X: np.ndarray, of: Process) -> np.ndarray:
    """Expected largest (n,) of lines (nl, n) over their std; 0 of what does not move."""
    told = table(np.zeros(X.shape[1]), X, of)
    return np.divide(told[:, 0], told[:, 4], out=np.zeros(len(told)), where=told[:, 4] > 0)


def fastest(V: np.ndarray, of: Process) -> np.ndarray:
    """The largest sizes (n,), in either sense, of rates of lines (nl, n): those that there are, or are expected."""
    m0, m2, most = _sums(V, of.omega)
    if len(V) == 1:
        return most
    if (rates := of.sampled(V)) is not None:
        return np.abs(rates).max(axis=0)
    beyond = np.array([_beyond(m0[i : i + 1], m2[i : i + 1], of.duration) for i in range(m0.size)])
    return np.minimum(np.sqrt(0.5 * m0 * (1 + beyond)), most)


class Axes(NamedTuple):
    """Of n axes, whose power take-offs bear f(v) + k y at rates v and positions y."""

    load: Callable[[np.ndarray], np.ndarray]  # f, of (m, n)
    damping: np.ndarray  # c (n,): ⟨fv⟩/⟨v²⟩
    stiffness: np.ndarray  # k (n,)
    level: np.ndarray  # ⟨y⟩ (n,)
    position: np.ndarray  # (nl, n) lines of y - ⟨y⟩
    rate: np.ndarray  # (nl, n)

    def power(self, y: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Mechanical power (m, n) at samples y, v (m, n)."""
        return (self.load(v) + self.stiffness * (self.level + y)) * v


def electrical_table(efficiency: PtoEfficiency, axes: Axes, absorbed: np.ndarray, of: Process) -> np.ndarray:
    """(5,) of Σ g(Pᵢ), Pᵢ = (fᵢ + kᵢyᵢ) vᵢ and g the efficiency of each axis, see PtoEfficiency.

    Of one harmonic, or of known phases, that of samples. Without stiffness that of what is absorbed, statistics
    (5,). Else the mean is that of each axis, see `_absorbed`, and the std that of POINTS of all positions and
    rates, by as much less as lines leave of that of Σ Pᵢ, see `of_lines`. Largest and least are those of Σ Pᵢ with
    loads cᵢvᵢ, by its strongest principal part of either sign as in `power_table`, positions from their means, with
    the loss that the sum would have.
    """
    c, k, V = axes.damping, axes.stiffness, axes.rate
    if (rates := of.sampled(V)) is not None and (positions := of.sampled(axes.position)) is not None:
        return tabulated([efficiency.electrical(axes.power(positions, rates)).sum(axis=1)[:, None]])[0]
    if not k.any():
        return efficiency.generating * absorbed
    both = np.concatenate([axes.position, V], axis=1)
    S, n = covariance(both, both), c.size
    y, v = np.split(_normal(S), 2, axis=1)
    A = np.block([[np.zeros((n, n)), np.diag(k / 2)], [np.diag(k / 2), np.diag(c)]])
    # Of Σ Pᵢ, the part by the positions' means is linear: lines leave all of it.
    square, line = 2 * np.trace(A @ S @ A @ S), (k * axes.level) @ S[n:, n:] @ (k * axes.level)
    left = (of_lines(A, both) ** 2 * square + line) / (square + line) if square + line > 0 else 1.0
    std = float(efficiency.electrical(axes.power(y, v)).sum(axis=1).std() * np.sqrt(left))
    sigma = np.sqrt(np.diag(S))
    load = axes.load(SIZES[:, None] * sigma[n:])
    taken, given = (_absorbed(s * load, np.abs(k) * sigma[:n], s * k * axes.level, sigma[n:]) for s in (1, -1))
    mean = efficiency.generating * taken.sum() - given.sum() / efficiency.motoring
    parts = np.linalg.eigvals(A @ S).real
    ends = np.array([parts.max(), parts.min()])  # where one is at its largest, the other is next to nothing
    largest = ends * (1 + _beyond(*_sums(V, of.omega)[:2], of.duration))
    high, low = efficiency.electrical(parts.sum() - ends.sum() + largest)
    return np.array([high, min(low, 0.0), mean, np.hypot(mean, std), std])


def _absorbed(load: np.ndarray, s: np.ndarray, m: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """⟨P⁺⟩ (n,) of P = (f(σx) + s ξ ± m) σx: loads f at SIZES of a rate's std σ, of a position's std s and mean m (n,).

    Given |x|, with either sign of x, the load along it is Gaussian of mean w = f(σ|x|) ± m and std s, and what it is
    above zero is w Φ(w/s) + s φ(w/s) in the mean; x and ξ are independent, as a position and its rate are. Without m:
    ½(E|P| + E P), E|P| = (2/π) σ_f σ ((1 - ρ²)^½ + ρ asin ρ).
    """
    x = SIZES[:, None]
    total = np.zeros(m.size)
    for w in (load + m, load - m):
        ratio = np.divide(w, s, out=np.copysign(np.inf, w), where=s > 0)
        above = w * ndtr(ratio) + s * np.exp(-0.5 * ratio**2) / np.sqrt(2 * np.pi)
        total += 0.5 * rate * (WEIGHTS @ (x * above))
    return total


def _normal(S: np.ndarray) -> np.ndarray:
    """(2 POINTS, n) of covariance S (n, n): an additive recurrence (Roberts 2018), and its opposite."""
    n = len(S)
    root = np.roots([1, *np.zeros(n - 1), -1, -1]).real.max()  # of x**(n + 1) = x + 1
    even = np.modf(0.5 + np.outer(np.arange(1, POINTS + 1), root ** -np.arange(1.0, n + 1)))[0]
    size, axes = np.linalg.eigh(S)
    points = ndtri(even) @ (axes * np.sqrt(size.clip(min=0.0))).T
    return np.concatenate([points, -points])


def compression_table(mean: np.ndarray, X: np.ndarray, of: Process) -> np.ndarray:
    """(n, 5) of σ = a - |v|, v = (b, c), the most compressive fibre, for means (n, 3) and lines (nl, n, 3) of a, b, c.

    σ is the least of all fibres a - v·e(φ): the least σ is the least that any of them is expected to see, and
    the largest is not above any one's largest, nor above a's.
    """
    if of.known:
        parts = (np.moveaxis(mean + x.reshape(-1, *mean.shape), -1, 0) for x in of.blocks(X.reshape(len(X), -1)))
        return tabulated(a - np.hypot(b, c) for a, b, c in parts)
    out = np.empty((len(mean), 5))
    _compressed(mean, X, of.omega**2, of.duration, _directions(PHASES)[: PHASES // 2], _fibres(), out)
    return out


@whole_kernel
def _compressed(
    mean: np.ndarray,
    X: np.ndarray,
    squared: np.ndarray,
    duration: float,
    half: np.ndarray,
    fibres: np.ndarray,
    out: np.ndarray,
) -> None:
    """The same, ω² (nl,); half and fibres: unit vectors (…, 2) of half a circle, and what v·e is of.

    Where v is far from zero, |v| = |m| + v∥ + v⊥²/2|m|. Elsewhere cov(a, |v|) = cov(a, v)·⟨v/|v|⟩ (Stein's lemma), and
    |v| = ¼∮|v·e| dφ, so that the means are those of folded normal distributions, alike in opposite directions.
    """
    for i in range(len(mean)):
        aa, ab, ac, bb, bc, cc = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # covariances
        for w in range(squared.size):
            x, y, z = X[w, i, 0], X[w, i, 1], X[w, i, 2]
            aa += 0.5 * (x.real * x.real + x.imag * x.imag)
            ab += 0.5 * (x.real * y.real + x.imag * y.imag)
            ac += 0.5 * (x.real * z.real + x.imag * z.imag)
            bb += 0.5 * (y.real * y.real + y.imag * y.imag)
            bc += 0.5 * (y.real * z.real + y.imag * z.imag)
            cc += 0.5 * (z.real * z.real + z.imag * z.imag)
        a, b, c = mean[i, 0], mean[i, 1], mean[i, 2]
        size, along, across, step = 0.0, 0.0, 0.0, 0.5 * np.pi / len(half)
        for k in range(len(half)):
            p, q = half[k, 0], half[k, 1]
            m, s = b * p + c * q, np.sqrt(max(bb * p * p + 2 * bc * p * q + cc * q * q, 0.0))
            ratio = m / s if s > 0 else np.copysign(np.inf, m)
            sign = math.erf(ratio / np.sqrt(2))
            size += step * (m * sign + np.sqrt(2 / np.pi) * s * np.exp(-0.5 * ratio**2))
            along += step * sign * p
            across += step * sign * q
        level, variance = a - size, aa + b * b + c * c + bb + cc - size * size - 2 * (ab * along + ac * across)
        far, first, count = np.hypot(b, c), fibres, len(fibres)
        if far > FAR * np.sqrt(bb + cc):
            p, q = b / far, c / far
            level = a - far - (bb * q * q - 2 * bc * p * q + cc * p * p) / (2 * far)
            variance = aa - 2 * (ab * p + ac * q) + bb * p * p + 2 * bc * p * q + cc * q * q
            first, count = np.array([[p, q]]), 1
        std, high, low = np.sqrt(max(variance, 0.0)), np.inf, np.inf
        for k in range(count):
            p, q = first[k, 0], first[k, 1]
            m0, m2, most = 0.0, 0.0, 0.0
            for w in range(squared.size):
                line = X[w, i, 0] - p * X[w, i, 1] - q * X[w, i, 2]
                power = line.real**2 + line.imag**2
                m0 += power
                m2 += squared[w] * power
                most += np.sqrt(power)
            top, stress = _largest(m0, m2, most, duration), level if count == 1 else a - b * p - c * q
            high, low = min(high, stress + top), min(low, stress - top)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = high, low, level, np.hypot(level, std), std


@lru_cache
def _fibres() -> np.ndarray:
    """(FIBRES + 1, 2), all round, and the axis."""
    return shared(np.append(_directions(FIBRES), np.zeros((1, 2)), axis=0))


@lru_cache
def _directions(count: int) -> np.ndarray:
    """(count, 2), all round."""
    angle = 2 * np.pi * np.arange(count) / count
    return shared(np.stack([np.cos(angle), np.sin(angle)], axis=-1))


def one_period(X: np.ndarray) -> np.ndarray:
    """One harmonic's values (PHASES, n) over its period, from lines (1, n)."""
    return (X * np.exp(-1j * PHASE)[:, None]).real
