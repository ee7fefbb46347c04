"""What means by samples miss: at the ends of what pieces of cut steps leave, and at corners between samples.

Electrical power has corners where an axis's power P changes its sign: η P one side, P/η_m the other.

With x from 0 to 1 between two samples and a jump of fₙ in the n-th derivative at x = θ, ∫ f dx is more than trapezoids
make of it by Σₙ (-1)ⁿ⁺¹ fₙ Bₙ₊₁(θ)/(n+1)!, Bernoulli's polynomials (Euler and Maclaurin). In waves whose period is a
whole number of samples all corners are alike, and no mean forgets that.
"""

from collections.abc import Callable

import numpy as np

from solver.power_takeoff import PtoEfficiency

PLACES = np.arange(4) / 3  # between two samples
CUBIC = np.linalg.inv(PLACES[:, None] ** np.arange(4))  # coefficients by what a cubic is there
END = 1 / 12, 1 / 24  # of first and second differences, see ends_of
ROUNDS = 4  # of Newton's method, from the chord's zero

Power = Callable[[np.ndarray, np.ndarray], np.ndarray]  # (m, nj) of axes at positions and rates (m, nj)


def ends_of(cut: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Samples (k,) at and near the ends of what is left uncut of `count` where steps up to samples `cut` are, and their
    weights.

    A mean by samples is that by trapezoids, whose errors cancel between neighbours. Where pieces take the place of
    some, what is left errs at its ends by h²/12 of the slopes there, and more: Gregory's rule takes parts of the first
    difference there back, and of the second one where the run is that long.
    """
    is_cut = np.ones(count + 2, bool)  # up to each sample, and beyond
    is_cut[1:count] = False
    is_cut[cut] = True
    end, way = np.concatenate([cut - 1, cut]), np.repeat([-1, 1], cut.size)
    step = end + (way > 0)  # the first of the run that ends there
    some = np.flatnonzero(~is_cut[step])
    end, way, longer = end[some], way[some], ~is_cut[step + way][some]
    samples = np.stack([end, end + way, np.where(longer, end + 2 * way, end)])
    weights = -END[0] * np.array([[1], [-1], [0]]) - END[1] * np.outer([1, -2, 1], longer)
    return samples.ravel(), weights.ravel()


def missed(
    y: np.ndarray, v: np.ndarray, step: float, power: Power, works: np.ndarray, efficiency: PtoEfficiency
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples before which corners lie (k,), and what the sums of electrical power and of its square lack by each.

    y, v (m, nj): of all axes at samples `step` apart; works (m - 1, nj): which of them are the float's, and at work
    between two samples without a break.
    """
    P = power(y, v)
    rows, axes = np.nonzero((P[:-1] * P[1:] < 0) & works)
    ends = np.stack([rows, rows + 1])
    within = power(*(x.reshape(-1, y.shape[1]) for x in course(y[ends], v[ends], step)))
    at, slopes = _zero(within.reshape(4, rows.size, y.shape[1])[:, np.arange(rows.size), axes])
    others = P[ends] * works[rows]
    others[:, np.arange(rows.size), axes] = 0.0
    rest = efficiency.electrical(others).sum(axis=2)
    return rows + 1, *_corner(at, slopes, P[rows, axes] < 0, rest, efficiency)


def course(y: np.ndarray, v: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions and rates (4, k, n) at PLACES of the cubics through those (2, k, n) at two samples."""
    x, (first, last), rise = PLACES[:, None, None], step * v, y[1] - y[0]
    bend, twist = 3 * rise - 2 * first - last, first + last - 2 * rise
    return y[0] + x * (first + x * (bend + x * twist)), (first + x * (2 * bend + x * 3 * twist)) / step


def _zero(power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the cubics through powers (4, k) at PLACES change their sign (k,), and their derivatives (3, k) there."""
    c = CUBIC @ power
    at, slopes = power[0] / (power[0] - power[3]), np.empty((3, power.shape[1]))
    for _ in range(ROUNDS):
        value, slope = c[0] + at * (c[1] + at * (c[2] + at * c[3])), c[1] + at * (2 * c[2] + at * 3 * c[3])
        at = np.clip(at - np.divide(value, slope, out=np.zeros(at.size), where=slope != 0), 0.0, 1.0)
    slopes[:] = c[1] + at * (2 * c[2] + at * 3 * c[3]), 2 * c[2] + 6 * at * c[3], 6 * c[3]
    return at, slopes


def _corner(
    at: np.ndarray, slopes: np.ndarray, rises: np.ndarray, rest: np.ndarray, efficiency: PtoEfficiency
) -> tuple[np.ndarray, np.ndarray]:
    """What both sums lack by corners at (k,), where derivatives of power are `slopes` (3, k).

    rest (2, k): electrical power of the float's other axes at both samples.
    """
    gives, takes = 1 / efficiency.motoring, efficiency.generating
    before, after = np.where(rises, gives, takes), np.where(rises, takes, gives)
    jump, (level, slope) = (after - before) * slopes, (rest[0] + at * (rest[1] - rest[0]), rest[1] - rest[0])
    of_square = 2 * level * jump[1] + 2 * (slope + after * slopes[0]) ** 2 - 2 * (slope + before * slopes[0]) ** 2
    B = at * (at - 1) + 1 / 6, at * (at - 1 / 2) * (at - 1), (at * (at - 1)) ** 2 - 1 / 30
    mean = jump[0] * B[0] / 2 - jump[1] * B[1] / 6 + jump[2] * B[2] / 24
    return mean, level * jump[0] * B[0] - of_square * B[1] / 6
