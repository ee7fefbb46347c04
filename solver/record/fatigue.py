"""Fatigue of signed stress: rainflow of samples (ASTM E1049), Dirlik's ranges of a Gaussian process, Miner's sum."""

from typing import NamedTuple

import numpy as np
import rainflow
from scipy.special import gamma, gammainc, gammaincc

from solver.record.sn_curves import MPA, SNCurve, curve
from solver.scene import Fatigue

HOUR = 3600.0  # [s]
COMPRESSION = {"base-material": 0.6, "stress-relieved": 0.8}  # what it counts for: DNVGL-RP-C203, 2.5
FEW = 0.02  # of turning points: fewer cycles are not worth a look at all of them
NARROW = 1e-6  # of one: a process whose zero crossings and peaks are that nearly as many has Rayleigh's ranges


class Damage(NamedTuple):
    """Of each hot spot; NaN where the count failed: of which leg and fibre, and why."""

    per_hour: np.ndarray  # Miner's sum
    equivalent: np.ndarray  # hot-spot range [Pa] that does as much in `cycles` an hour, by Σ S^exponent
    failed: tuple[tuple[int, int, str], ...] = ()


def turning_points(x: np.ndarray) -> np.ndarray:
    """First, last and all extremes of samples (m,), those by the parabola through a sample and its neighbours."""
    step = np.diff(x)
    if not step.all():  # of equal ones in a row, the first
        x, step = x[np.append(True, step != 0)], step[step != 0]
    falls = step < 0
    turn = 1 + np.flatnonzero(falls[1:] != falls[:-1])
    older, old, new = x[turn - 1], x[turn], x[turn + 1]
    slope, bend = (new - older) / 2, older - 2 * old + new
    return np.concatenate([x[:1], old - slope**2 / (2 * bend), x[-1:]])


class Cycles(NamedTuple):
    """Of n, by rainflow."""

    size: np.ndarray  # (n,) range
    mean: np.ndarray  # (n,)
    share: np.ndarray  # (n,) a half of one, or a whole one

    def reduced(self, felt: float) -> np.ndarray:
        """f_m S (n,) with f_m = (σ_t + felt |σ_c|)/(σ_t + |σ_c|) of the most tension and compression, or 0."""
        tension, compression = (np.maximum(self.size / 2 + way * self.mean, 0.0) for way in (1, -1))
        whole = tension + compression
        return self.size * np.divide(tension + felt * compression, whole, out=np.ones(whole.shape), where=whole > 0)


def cycles(x: np.ndarray) -> Cycles:
    """Of samples (m,)."""
    left, inner = _without_inner(turning_points(x))
    points = left.tolist()  # Python's numbers: the library reckons faster with them than with numpy's
    found = [cycle[:3] for cycle in rainflow.extract_cycles(points)]
    if len(points) == 2:  # of which the library says nothing
        found = [(abs(points[1] - points[0]), 0.5 * (points[0] + points[1]), 0.5)]
    return Cycles(*np.concatenate([inner, np.array(found).reshape(-1, 3)]).T)


def _without_inner(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Turning points (n,) without cycles within a larger range before and one as large after, and those (k, 3).

    Rainflow counts such a cycle whole, whatever else there is, and goes on as if it had not been: many are taken out
    at once, as long as that is quicker than the library is one by one.
    """
    taken = [np.zeros((0, 3))]
    while True:
        size = np.abs(np.diff(points))
        inner = 1 + np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]))
        if inner.size <= FEW * points.size:
            return points, np.concatenate(taken)
        mean = 0.5 * (points[inner] + points[inner + 1])
        taken.append(np.stack([size[inner], mean, np.ones(inner.size)], axis=1))
        kept = np.ones(points.size, bool)
        kept[inner] = kept[inner + 1] = False
        points = points[kept]


def _curve(thickness: np.ndarray, how: Fatigue) -> tuple[SNCurve, np.ndarray]:
    """That of the steel, and how many times larger stress counts (nl,) at plates as thick, or as the study says."""
    line = curve(how.curve, how.environment)
    return line, line.thicker(thickness if how.thickness is None else np.full(thickness.shape, how.thickness))


def of_samples(stress: np.ndarray, seconds: float, thickness: np.ndarray, how: Fatigue) -> Damage:
    """Of stress (m, nl, nf) [Pa] in a time [s] at plates of some thickness (nl,) [m]; NaN where there is no fibre."""
    (line, larger), shape = _curve(thickness, how), stress.shape[1:]
    per_hour, equivalent, failed = np.full(shape, np.nan), np.full(shape, np.nan), []
    for leg, fibre in np.ndindex(*shape):
        x = stress[:, leg, fibre]
        if np.isnan(x).all() and len(x):
            continue
        try:
            if not (np.isfinite(x).all() and seconds > 0):
                raise ValueError(f"{np.sum(~np.isfinite(x))} of {len(x)} samples are not finite, in {seconds:g} s")
            found = cycles(x)
        except Exception as error:  # whatever the library meets: no damage is not what that means
            failed.append((leg, fibre, str(error)))
            continue
        size = found.size if how.mean_stress == "none" else found.reduced(COMPRESSION[how.mean_stress])
        hot = how.scf * size
        hours = seconds / HOUR
        per_hour[leg, fibre] = found.share @ line.damage(hot * larger[leg]) / hours
        equivalent[leg, fibre] = (found.share @ hot**how.exponent / (how.cycles * hours)) ** (1 / how.exponent)
    return Damage(per_hour, equivalent, tuple(failed))


def of_lines(X: np.ndarray, omega: np.ndarray, thickness: np.ndarray, how: Fatigue) -> Damage:
    """Of a Gaussian process by its lines X (nw, nl, nf), Re Σ X exp(-iωt) [Pa]; a single line is a harmonic."""
    (line, thicker), shape = _curve(thickness, how), X.shape[1:]
    per_hour, equivalent = np.full(shape, np.nan), np.full(shape, np.nan)
    for leg, fibre in np.ndindex(*shape):
        x = how.scf * X[:, leg, fibre]
        if np.isnan(x).all():
            continue
        larger, spread = float(thicker[leg]), RangeSpread.of(x, omega)
        (m1, m2), (a1, a2), knee = line.slope, 10.0 ** np.array(line.log_a), line.knee / larger
        high, low = spread.moment(m1, knee, np.inf), spread.moment(m2, 0.0, knee)
        per_hour[leg, fibre] = HOUR * (high * (larger / MPA) ** m1 / a1 + low * (larger / MPA) ** m2 / a2)
        whole = HOUR * spread.moment(how.exponent, 0.0, np.inf) / how.cycles
        equivalent[leg, fibre] = whole ** (1 / how.exponent)
    return Damage(per_hour, equivalent)


class RangeSpread(NamedTuple):
    """How often ranges S = 2σZ come: ν p, p(Z) = D₁/Q e^(-Z/Q) + D₂ Z/R² e^(-Z²/2R²) + D₃ Z e^(-Z²/2) (Dirlik 1985)."""

    rate: float  # ν, peaks a second [Hz]; of a harmonic its frequency
    std: float  # σ
    share: tuple[float, float, float]  # D₁, D₂, D₃
    width: tuple[float, float]  # Q, R
    fixed: float = 0.0  # the harmonic's range, in place of p

    @classmethod
    def of(cls, X: np.ndarray, omega: np.ndarray) -> "RangeSpread":
        """Of lines X (nw,), by the moments of their variance over frequency [Hz]."""
        f, power = omega / (2 * np.pi), 0.5 * np.abs(X) ** 2
        m0, m1, m2, m4 = (float(np.sum(power * f**n)) for n in (0, 1, 2, 4))
        if np.count_nonzero(power) <= 1:
            return cls(float(f[np.argmax(power)]), m0**0.5, (0, 0, 0), (1, 1), 2 * float(np.abs(X).max(initial=0.0)))
        irregular = m2 / np.sqrt(m0 * m4)
        if irregular > 1 - NARROW:
            return cls(np.sqrt(m4 / m2), m0**0.5, (0.0, 0.0, 1.0), (1.0, 1.0))
        mean = m1 / m0 * np.sqrt(m2 / m4)
        D1 = 2 * (mean - irregular**2) / (1 + irregular**2)
        R = (irregular - mean - D1**2) / (1 - irregular - D1 + D1**2)
        D2 = (1 - irregular - D1 + D1**2) / (1 - R)
        D3 = 1 - D1 - D2
        Q = 1.25 * (irregular - D3 - D2 * R) / D1
        return cls(np.sqrt(m4 / m2), m0**0.5, (D1, D2, D3), (Q, R))

    def moment(self, m: float, above: float, below: float) -> float:
        """ν ∫ Sᵐ p dS between two ranges, by incomplete gamma functions."""
        if self.fixed or self.std == 0:
            return self.rate * self.fixed**m * (above <= self.fixed < below)
        low, high = above / (2 * self.std), below / (2 * self.std)
        (D1, D2, D3), (Q, R) = self.share, self.width
        total = D1 * Q**m * gamma(m + 1) * _between(m + 1, low / Q, high / Q) if D1 else 0.0
        for D, width in ((D2, R), (D3, 1.0)):
            half = 1 + m / 2
            part = _between(half, (low / width) ** 2 / 2, (high / width) ** 2 / 2) if D else 0.0
            total += D * (np.sqrt(2) * abs(width)) ** m * gamma(half) * part  # p has R² alone
        return float(self.rate * (2 * self.std) ** m * total)


def _between(a: float, low: float, high: float) -> float:
    """Share of Γ(a) between two limits."""
    return float(gammainc(a, high) - gammainc(a, low) if low < a else gammaincc(a, low) - gammaincc(a, high))


def crossing_rate(x: np.ndarray, seconds: float) -> np.ndarray:
    """Upcrossings of the mean a second (…) [Hz] of samples (m, …); NaN where there are none."""
    mean = x.mean(axis=0)
    above = mean.ravel()[:, None] <= x.reshape(len(x), -1).T
    count = np.array([np.count_nonzero(each[1:] > each[:-1]) for each in above], float).reshape(mean.shape)
    return np.where(np.isnan(mean), np.nan, count / seconds)
