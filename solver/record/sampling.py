"""The error of a record's statistics, from samples of a part of it at two steps."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from solver.scene import Scene
from solver.statistics import FAINT

NEAR = 20  # gaps between samples: what a hit does to one of them it may take from the next
PARTS = 16  # of the samples, whose scatter tells chance from what stays
SURE = 6.0  # times the square of chance: of dozens of channels one reaches that by chance alone


class Cuts(NamedTuple):
    """What pieces of cut steps make of a channel's mean over the time before k of its samples, and of its square's,
    less what the two samples at its ends do."""

    row: np.ndarray  # (k,) of the samples
    value: np.ndarray  # (k, n)
    square: np.ndarray  # (k, n)


Cut = Mapping[str, Cuts]
ROUNDING = 1e-12  # of the waves' heights
LAST = 0.25  # share of samples, by the last of which goes on what decays or comes in


def least_force(scene: Scene) -> np.ndarray:
    """(nb, 1) [N]: joint forces below it count as zero, as those along an axis that is free are."""
    return FAINT * scene.water.gravity * np.array([[f.mass] for f in scene.floats])


def least_motion(scene: Scene) -> float:
    """√Σ|X|² [m] of what waves move by rounding alone."""
    return ROUNDING * float(np.linalg.norm(scene.sea.amplitude))


def expected_error(
    coarse: Mapping[str, np.ndarray],
    fine: Mapping[str, np.ndarray],
    least: Mapping[str, np.ndarray],
    longer: float,
    cut: tuple[Cut, Cut] = ({}, {}),
) -> float:
    """Largest error of any mean, rms and std that samples (m, …) lead to expect in a record `longer` times theirs.

    cut: what pieces know of the one and the other beside their samples.
    """
    return max(
        _of_kind(coarse[name], y, cut[0].get(name), cut[1].get(name), least.get(name, np.zeros(())), longer)
        for name, y in fine.items()
    )


def between_samples(
    samples: Mapping[str, np.ndarray], least: Mapping[str, np.ndarray], longer: float, cut: Cut | None = None
) -> float:
    """The same of a record that has every other one of these samples, by its trapezoids: what jumps lies between.

    samples: an even number. Each gap errs by half of what its middle is off the mean of its ends. What jumps does so
    anywhere in a gap: those of m gaps that are near each other have a sum e, and the mean errs by (Σ e²)^½/m.
    """
    known = cut or {}
    return max(_between(x, known.get(name), least.get(name, np.zeros(())), longer) for name, x in samples.items())


def from_start(samples: Mapping[str, np.ndarray], least: Mapping[str, np.ndarray], longer: float) -> float:
    """The same of a record that begins at rest or as it is let go, half a step before the first of these samples."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return max(_from_start(x, least.get(name, np.zeros(())), longer) for name, x in samples.items())


def at_ends(
    samples: Mapping[str, np.ndarray],
    least: Mapping[str, np.ndarray],
    longer: float,
    *,
    begins: bool = False,
    last: float = LAST,
) -> float:
    """The same of a record whose first and last sample count in full, and might anywhere lie.

    Means of v over a time T by samples h apart err by h/2 (v(0) + v(T) - 2v̄)/T, as a rule by h/T ⟨|v - v̄|⟩/2^½.
    begins: the record does so with these samples, which tell v(0); v(T), and all that follows, by the last share of
    them: see `_of_record`.
    """
    return max(_at_ends(x, least.get(name, np.zeros(())), longer, begins, last) for name, x in samples.items())


def of_every_other(samples: Mapping[str, np.ndarray], cut: Cut, coarse: Cut) -> dict[str, Cuts]:
    """What pieces make of the means over the time before every other sample, the second on, which is a step.

    Where no step is cut, neither this nor that of a `coarse` run, samples between count for nothing; where only that
    one is, as by Simpson's rule.
    """
    none = {name: Cuts(np.zeros(0, int), *np.zeros((2, 0, 1))) for name in {*cut, *coarse}}
    cut, coarse = {**none, **cut}, {**none, **coarse}
    flat = {name: samples[name].reshape(len(samples[name]), -1) for name in none}
    return {name: _of_pairs(x, cut[name], coarse[name].row) for name, x in flat.items()}


def _of_pairs(x: np.ndarray, cuts: Cuts, others: np.ndarray) -> Cuts:
    pairs = np.union1d(cuts.row // 2, others)
    pairs = pairs[(pairs > 0) & (2 * pairs + 1 < len(x))]
    known, own = np.isin(cuts.row // 2, pairs), np.isin(pairs, cuts.row // 2)[:, None]
    into, sums = np.searchsorted(pairs, cuts.row[known] // 2), []
    for v, part in ((x, cuts.value), (x**2, cuts.square)):
        bend = 2 * v[2 * pairs] - v[2 * pairs - 1] - v[2 * pairs + 1]
        total = np.where(own, bend / 4, bend / 3)
        np.add.at(total, into, part[known] / 2)
        sums.append(total)
    return Cuts(pairs, *sums)


def _of_kind(
    x: np.ndarray, y: np.ndarray, of_x: Cuts | None, of_y: Cuts | None, least: np.ndarray, longer: float
) -> float:
    with np.errstate(divide="ignore", invalid="ignore"):
        mean, sizes = _sizes(x, y, least)
        pairs = zip(_powers(x, mean, of_x), _powers(y, mean, of_y), sizes, strict=True)
        return _expected([(a - b) / size for a, b, size in pairs], longer)


def _between(x: np.ndarray, cuts: Cuts | None, least: np.ndarray, longer: float) -> float:
    with np.errstate(invalid="ignore"):
        mean, sizes = _sizes(x[1::2], x[1::2], least)
    gaps = np.array([((v[1:-2:2] + v[3::2]) / 2 - v[2:-1:2]) / 2 for v in _powers(x, mean)])
    if cuts is not None:  # nothing lies between there that pieces do not tell
        gaps[:, cuts.row - 1] = 0.0
    near = np.add.reduceat(gaps, np.arange(0, gaps.shape[1], NEAR), axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.sqrt(np.sum(near**2, axis=1) / longer) / gaps.shape[1] / sizes
    return _largest(errors)


def _from_start(x: np.ndarray, least: np.ndarray, longer: float) -> float:
    """Means of v over a time T by samples h apart, none at its start, err by h/2 (v(T) - v(0))/T.

    v(0): by the line through the first two; v(T), and all that follows these samples: see `_of_record`.
    """
    mean, powers, _, sizes = _in_record(x, least, longer, LAST)
    first = _powers(2 * x[:1] - x[1:2] if len(x) > 1 else x, mean)
    errors = np.array([np.abs(_end(v, LAST) - v0[0]) for v, v0 in zip(powers, first, strict=True)])
    return _largest(errors / sizes / (2 * longer * len(x)))


def _at_ends(x: np.ndarray, least: np.ndarray, longer: float, begins: bool, last: float) -> float:
    with np.errstate(divide="ignore", invalid="ignore"):
        mean, sizes = _sizes(x, x, least)
        usual = np.array([np.abs(v - v.mean(axis=0)).mean(axis=0) for v in _powers(x, mean)])
        largest = _largest(usual / sizes / (np.sqrt(2) * longer * len(x)))
        if begins:
            _, powers, means, sizes = _in_record(x, least, longer, last)
            errors = np.array([np.abs(v[0] + _end(v, last) - 2 * m) for v, m in zip(powers, means, strict=True)])
            largest = max(largest, _largest(errors / sizes / (2 * longer * len(x))))
    return largest


def _end(v: np.ndarray, last: float) -> np.ndarray:
    """v(T) (n,) of samples (m, n), and of all that follows them: the mean of the last share of them."""
    return np.asarray(v[int(len(v) * (1 - last)) :].mean(axis=0))


def _of_record(v: np.ndarray, longer: float, last: float) -> np.ndarray:
    """Means (n,) over a record `longer` times as long as samples (m, n) at its start."""
    return np.asarray((v.mean(axis=0) + (longer - 1) * _end(v, last)) / longer)


def _in_record(
    x: np.ndarray, least: np.ndarray, longer: float, last: float
) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray], np.ndarray]:
    """Mean (n,) of a record that begins with these samples, their `_powers` about it, means of these there, and what
    differences of them are to be divided by, as `_sizes` has it."""
    mean = _of_record(x.reshape(len(x), -1), longer, last)
    powers = _powers(x, mean)
    means = [_of_record(v, longer, last) for v in powers]
    rms, std = np.sqrt(means[1]), np.sqrt(means[2])
    of_rms, of_std = _scales(rms, std, np.broadcast_to(least, x.shape[1:]).ravel())
    return mean, powers, means, np.array([of_rms, 2 * rms * of_rms, np.maximum(2 * std, FAINT * of_std) * of_std])


def _largest(errors: np.ndarray) -> float:
    """Of those that are known."""
    return float(np.max(errors, where=np.isfinite(errors), initial=0.0))


def _powers(x: np.ndarray, mean: np.ndarray, cuts: Cuts | None = None) -> list[np.ndarray]:
    """Of samples (m, …) of channels what the mean and the squares of rms and std are the means of, (m, n)."""
    x = x.reshape(len(x), -1)
    powers = [x, x**2, (x - mean) ** 2]
    if cuts is not None:
        changes = (cuts.value, cuts.square, cuts.square - 2 * mean * cuts.value)
        for i, change in enumerate(changes):
            powers[i] = powers[i].copy()
            powers[i][cuts.row] += change
    return powers


def _sizes(x: np.ndarray, y: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ȳ (n,) and what differences of the means of `_powers` of x and y are to be divided by (3, n).

    They are then those of mean, rms and std, scaled as solver.statistics.apart does: 1, 2r and 2σ times the scale,
    with r of y and σ the mean of x's and y's; of what hardly varies beside that, whose squares' differences are
    rounding, FAINT of it.
    """
    least = np.broadcast_to(least, y.shape[1:]).ravel()
    x, y = x.reshape(len(x), -1), y.reshape(len(y), -1)
    mean, rms, std = y.mean(axis=0), np.sqrt(np.mean(y**2, axis=0)), y.std(axis=0)
    of_rms, of_std = _scales(rms, std, least)
    both = np.sqrt(np.mean((x - mean) ** 2, axis=0)) + std
    return mean, np.array([of_rms, 2 * rms * of_rms, np.maximum(both, FAINT * of_std) * of_std])


def _scales(rms: np.ndarray, std: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What rms and std (n,) count as. least (n,): sizes that count as zero, infinite of what is not to be judged;
    what varies by FAINT² of itself, as a stress does under weight alone, does so by rounding.
    """
    of_rms, of_std = (np.maximum(s, np.maximum(FAINT * np.nanmax(s, initial=0.0), least)) for s in (rms, std))
    return of_rms, np.maximum(of_std, FAINT**2 * of_rms)


def _expected(errors: list[np.ndarray], longer: float) -> float:
    """Largest mean of errors (m, n) in a record `longer` times theirs.

    With E over all samples and s its standard error by the scatter of their PARTS, what stays is (E² - s²)^½ where it
    is SURE, and chance averages out: (E² - s² + s²/longer)^½; else (max(E², s²)/longer)^½.
    """
    count = min(PARTS, len(errors[0]))
    parts = np.array([[part.mean(axis=0) for part in np.array_split(e, count)] for e in errors])
    whole, chance = parts.mean(axis=1) ** 2, parts.var(axis=1, ddof=1) / count
    stays = np.where(whole > SURE * chance, whole - chance, 0.0)
    left = stays + np.maximum(whole - stays, chance) / longer
    return float(np.sqrt(np.max(left, where=np.isfinite(left), initial=0.0)))
