"""Means over realizations and sea states, these by their occurrence, each with its interval."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.results.dataset import once

if TYPE_CHECKING:
    import xarray as xr

LEVEL = 0.95  # of the intervals
HOUR, YEAR = 3600.0, 365.25 * 24.0  # [s], [h]
ESTIMATES = ("value", "low", "high")
DAY = 24.0  # the least sum of occurrences that looks like hours [h]
FULL = 8700.0, 8800.0  # between these they are those of a year [h]
# Sums of shares, percent, per mille, and of counts that scatter diagrams have; not 10,000, which hours might be.
WHOLE = 1.0, 1e2, 1e3, 1e5, 1e6
KNOWN = ("Hs", "Tp", "wave_height", "wave_period")  # numbers of sea states, along what changes them
OF_SEAS = re.compile(r"(?<![^ (])(?:sea|sea_states|waves|water)\.([^ ,)]+)")  # in a text with dotted paths
RECORDS = {"base_seed", "components", "intervals"}  # of waves: other realizations of the same seas
DONE = ("done", "stale")  # statuses of tasks that have a record
FAILED = "failed_realizations"
ERROR = "record_error"  # what a task's number may be off by, in its unit
SINGLE = "single_task"  # whether a sea state has one task whatever the seed: a regular or still one
BESIDE = (FAILED, ERROR, SINGLE)  # coordinates that go with tasks' numbers


class OfTasks(NamedTuple):
    """Numbers of tasks, last along realizations and sea states, and what goes with them."""

    numbers: np.ndarray  # (…, seed, sea_state)
    errors: np.ndarray  # what these may be off by (…, seed, sea_state)
    single: np.ndarray  # whether a sea state has one task whatever the seed (…, sea_state)
    share: np.ndarray  # of each sea state (sea_state,)

    @classmethod
    def of(cls, each: xr.DataArray, weights: Any, outer: Sequence[Hashable]) -> OfTasks:
        """weights as `over_seas` takes them; outer: the other dimensions, in order."""
        dims = *outer, "seed", "sea_state"
        shape = [each.sizes.get(dim, 1) for dim in dims]

        def spread(of: Any) -> np.ndarray:
            return np.asarray(of.variable.set_dims(dims, shape))

        beside = (spread(each.coords[name]) if name in each.coords else np.zeros(shape) for name in (ERROR, SINGLE))
        numbers, errors, single = spread(each), *beside
        return cls(numbers, errors, np.all(single, axis=-2), occurrence(weights, shape[-1]))

    def ends(self) -> np.ndarray:
        """Value, low and high of the mean (…, 3): see `over_seas`."""
        from scipy import stats

        known, alike = ~np.isnan(self.numbers), _shares(self.numbers, self.share)
        number = known.sum(axis=-2)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = np.where(known, self.numbers, 0.0).sum(axis=-2) / number
            squares = np.where(known, self.numbers - mean[..., None, :], 0.0) ** 2
            freedom = np.where(number > 1, number - 1.0, np.nan)
            variance = squares.sum(axis=-2) / freedom / number
            variance[self.single & (number == 1)] = 0.0
            # Sums over sea states, of which k alike have Σ w alike = alike² together and not Σ w².
            of_mean = (self.share * alike * variance).sum(axis=-1)
            scattered = np.where(variance != 0, variance**2 / freedom, 0.0)
            freedom = of_mean**2 / (self.share * alike**3 * scattered).sum(axis=-1)
            # Where no realization differs there is no scatter, and no degree of freedom either.
            half = np.where(of_mean != 0, stats.t.ppf((1 + LEVEL) / 2, freedom) * np.sqrt(of_mean), 0.0)
        value = (self.share * mean).sum(axis=-1)
        return np.stack([value, value - half, value + half], axis=-1)

    def off(self) -> np.ndarray:
        """What the mean (…) may be off by: see `off`."""
        known = ~np.isnan(self.errors)
        with np.errstate(invalid="ignore"):
            errors = np.where(known, self.errors, 0.0).sum(axis=-2) / known.sum(axis=-2)
        return np.asarray((self.share * errors).sum(axis=-1))


def over_seas(each: xr.DataArray, weights: Any) -> xr.DataArray:
    """Mean over realizations and sea states of what tasks have; along `estimate`, first, value, low and high at 95 %.

    m = Σ wⱼ m̄ⱼ/Σ wⱼ of the means m̄ⱼ over the nⱼ realizations of each sea state j, by weights w (sea_state,) or a
    dataset's `occurrence`, else equal ones. The interval is m ± t s, s² = Σ (wⱼ/Σw)² sⱼ²/nⱼ of independent
    realizations, with Student's t at the degrees of freedom of Welch and Satterthwaite, (Σ vⱼ)²/Σ vⱼ²/(nⱼ - 1). Sea
    states with the same number in every realization are the same waves and count there as one, by their sum of wⱼ. NaN:
    value where a sea state has no number, interval where one has a single realization of several that it may have.
    """
    one = _by_task(each).isel(seed=0, sea_state=0, drop=True)
    ends = OfTasks.of(each, weights, one.dims).ends()
    return one.expand_dims(estimate=list(ESTIMATES)).copy(data=np.moveaxis(ends, -1, 0))


def realized(data: xr.Dataset, values: xr.DataArray) -> xr.DataArray:
    """Values where a realization has a task of its own: a regular or still sea has one, whatever the seed.

    With them goes, as a coordinate, where such a task has run and left no number that others of its cell have.
    """
    own = _own(data)
    single: Any = False
    if "task" in data and "seed" in data["task"].dims:
        names = data["task"].compute()
        single = (own.sum("seed") == 1) & (names != "").all("seed") & (names.sizes["seed"] > 1)
        single = single.all([dim for dim in single.dims if dim != "sea_state"])
    has = values.notnull()
    lacks = own & ~has & has.any(_tasks(values))
    known = values.where(own).assign_coords({SINGLE: single})
    return known.assign_coords({FAILED: lacks & _failed(data["status"], has) if "status" in data else lacks})


def _own(data: xr.Dataset) -> Any:
    """Where a realization has a task of its own."""
    import xarray as xr

    if "task" not in data or "seed" not in data["task"].dims:
        return True
    along: dict[str, Any] = {"input_core_dims": [["seed"]], "output_core_dims": [["seed"]], "vectorize": True}
    return xr.apply_ufunc(once, data["task"].compute(), **along)


def _failed(status: xr.DataArray, has: xr.DataArray) -> xr.DataArray:
    """Where tasks failed, or have a record without a number that another realization of their sea has.

    No record of a sea has one of a float that is lifted out there: in all of them counts of fibres' damage alone fail.
    """
    lacking = status.isin(DONE)
    if "fibre" not in has.dims:
        lacking = lacking & (has.any("seed") if "seed" in has.dims else False)
    return (status == "failed") | lacking


def lost(data: xr.Dataset, but: str = "") -> Iterator[tuple[str, int]]:
    """Label of every design whose tasks failed and left no record, and how many of them; but of one platform, which
    would have no number either."""
    if "platform" in data.dims:
        data = data.sel(platform=data.platform != but)
    if "status" in data:
        status = data["status"].compute()
        failed = ((status == "failed") & _own(data)).sum(_tasks(status))
        none = (failed > 0) & ~status.isin(DONE).any(_tasks(status))
        for labels, place in cells(failed.where(none), ()):
            yield ", ".join(labels), int(failed.isel(place))


def failures(values: xr.DataArray) -> xr.DataArray:
    """How many realizations of all sea states failed, of values that are `realized`: their means leave them out.

    Of sea states of the same waves one counts.
    """
    failed = values[FAILED]
    if "sea_state" in failed.dims:
        failed = failed & _of_waves(values, _first)
    return failed.astype(int).sum(_tasks(failed)).drop_vars(BESIDE, errors="ignore")


def with_errors(data: xr.Dataset, values: xr.DataArray, size: xr.DataArray) -> xr.DataArray:
    """Values with what their records may be off by, as a coordinate: `estimated_error` of a size."""
    return values.assign_coords({ERROR: data["estimated_error"] * size})


def off(each: xr.DataArray, weights: Any) -> xr.DataArray:
    """What the mean of `over_seas` may be off by as records are, by errors of one kind, which add up; 0 of records that
    tell none, NaN where some do not."""
    one = _by_task(each).isel(seed=0, sea_state=0, drop=True)
    return one.copy(data=OfTasks.of(each, weights, one.dims).off())


def _tasks(values: xr.DataArray) -> list[Hashable]:
    return [dim for dim in values.dims if dim in ("sea_state", "seed")]


def _by_task(each: xr.DataArray) -> xr.DataArray:
    """Numbers alone, with realizations and sea states."""
    each = each.drop_vars(BESIDE, errors="ignore")
    return each.expand_dims([dim for dim in ("seed", "sea_state") if dim not in each.dims])


def _of_waves(each: xr.DataArray, of: Callable[[np.ndarray], np.ndarray]) -> xr.DataArray:
    """What sea states are beside those of the same waves, by numbers (..., seed, sea_state) as `of` takes them."""
    import xarray as xr

    dims: dict[str, Any] = {"input_core_dims": [["seed", "sea_state"]], "output_core_dims": [["sea_state"]]}
    found: xr.DataArray = xr.apply_ufunc(of, _by_task(each).compute(), **dims)
    return found


def _alike(numbers: np.ndarray) -> Iterator[np.ndarray]:
    """Of each sea state those of the same waves (..., sea_state), which are the same tasks; none is like one without
    numbers. Numbers that are the same by chance, as of floats that take nothing in two storms, have no scatter."""
    known = np.where(np.isnan(numbers), np.inf, numbers)  # a number that failed is as another that did
    some = np.isfinite(known).any(axis=-2)
    yield from ((known == known[..., [i]]).all(axis=-2) & some for i in range(known.shape[-1]))


def _shares(numbers: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weight of all sea states of the same waves as each."""
    return np.asarray(sum(weight * alike for weight, alike in zip(weights, _alike(numbers), strict=True)))


def _first(numbers: np.ndarray) -> np.ndarray:
    """Which sea states are the first of those of the same waves."""
    return ~np.stack([alike[..., :i].any(axis=-1) for i, alike in enumerate(_alike(numbers))], axis=-1)


def occurrence(weights: Any, seas: int) -> np.ndarray:
    """Shares of so many sea states that add up to one, from a dataset's `occurrence` or numbers."""
    import xarray as xr

    known = weights.coords.get("occurrence") if isinstance(weights, xr.Dataset) else weights
    w = np.broadcast_to(np.asarray(1.0 if known is None else known, float), seas)
    return np.asarray(w / w.sum())


def weighed(data: xr.Dataset) -> xr.Dataset:
    """Without `occurrence` where an axis makes other seas of the sea states: how often those come nobody said."""
    other = any(name in data.coords and set(data[name].dims) - {"sea_state"} for name in KNOWN)
    other |= any(size > 1 and sea_keys(data[dim]) - RECORDS for dim, size in data.sizes.items())
    return data.drop_vars("occurrence", errors="ignore") if other else data


def sea_keys(axis: xr.DataArray) -> set[str]:
    """Keys of seas, waves and water that go along a dimension, as its attributes name their paths."""
    return {key for name in ("long_name", "comment") for key in OF_SEAS.findall(axis.attrs.get(name, ""))}


def of_part(data: xr.Dataset) -> str:
    """A sentence where occurrences, hours or shares, do not fill a year, or more than fill it."""
    total = float(data["occurrence"].sum()) if "occurrence" in data.coords else 1.0
    if FULL[0] <= total <= FULL[1] or np.isclose(total, WHOLE, rtol=1e-2).any():
        return ""
    kind, part = ("hours", total / YEAR) if total > DAY else ("shares", total)
    percent = f" ({total:.0f}% if percent)" if DAY < total < WHOLE[1] else ""
    told = f" The occurrences add up to {total:g}: if these are {kind}, they are {part:.0%} of a year{percent}, and"
    if part > 1:
        return f"{told} were scaled down to one."
    return f"{told} the rest counts as if the same seas went on; with nothing in the rest a year has that share of it."


def cells(values: xr.DataArray, inner: Collection[Hashable]) -> Iterator[tuple[list[str], dict[Hashable, int]]]:
    """Labels along all dimensions but the inner ones, realizations and sea states, and places, where there are numbers.

    What is reckoned for all of them at once is cut there.
    """
    outer = [dim for dim in values.dims if dim not in ("seed", "sea_state", *inner)]
    known = values.notnull().any([dim for dim in values.dims if dim not in outer])
    labels = [[named(dim, label) for label in values[dim].values] for dim in outer]
    for place in np.argwhere(known.values).tolist():
        yield [words[i] for words, i in zip(labels, place, strict=True)], dict(zip(outer, place, strict=True))


def shared(data: xr.Dataset, outer: Collection[Hashable]) -> dict[Hashable, xr.DataArray]:
    """Where labels of each of these axes have the same tasks, as of a platform without floats whatever those do."""
    if "task" not in data:
        return {}
    tasks = data["task"]
    return {
        dim: (tasks == tasks.isel({dim: 0}, drop=True)).all([d for d in tasks.dims if d == dim or d not in outer])
        for dim in outer
        if tasks.sizes.get(dim, 1) > 1
    }


def once_told(words: Sequence[str], place: dict[Hashable, int], same: dict[Hashable, xr.DataArray]) -> list[str] | None:
    """Words of a place without those of axes whose labels have the same tasks; None but at the first of these."""
    alike = [dim for dim, of in same.items() if of.isel({d: i for d, i in place.items() if d in of.dims}).item()]
    if any(place[dim] for dim in alike):
        return None
    return [word for word, dim in zip(words, place, strict=False) if dim not in alike]


def by_sea(part: xr.Dataset, name: str) -> Iterator[tuple[str, xr.Dataset]]:
    """All sea states of a part together, and each of several by itself; one that is no dimension has no name.

    A single one has its own.
    """
    seas = np.atleast_1d(part["sea_state"].values).tolist() if "sea_state" in part[name].dims else []
    yield "all seas" if len(seas) > 1 else "".join(map(str, seas)), part
    if len(seas) > 1:
        yield from ((str(sea), part.sel(sea_state=[sea])) for sea in seas)


def named(dim: Hashable, label: Any) -> str:
    """A word speaks for itself, a number is of something."""
    return f"{dim} {label:g}" if np.issubdtype(type(label), np.number) else str(label)


class Counts(NamedTuple):
    """Numbers of realizations: of the sea states where there are fewest and most, and of those that failed in all."""

    least: Any
    most: Any
    failed: Any

    def __str__(self) -> str:
        least, most, failed = (int(number) for number in self)
        return f"{least}" + f" to {most}" * (least < most) + f", {failed} failed" * (failed > 0)


def counts(values: xr.DataArray) -> Counts:
    """Numbers of realizations of each place."""
    number = _by_task(values).notnull().sum("seed")
    return Counts(number.min("sea_state"), number.max("sea_state"), failures(values))


def counted(values: xr.DataArray) -> str:
    """Numbers of realizations of all places together."""
    of = counts(values)
    return str(Counts(of.least.min(), of.most.max(), of.failed.sum()))
