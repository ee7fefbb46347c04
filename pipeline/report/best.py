"""Which of a study's designs takes the most power from each sea state, and from a year."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pipeline.report.energy import OF, powers
from pipeline.report.governing import NOTHING
from pipeline.report.tables import Table, marked, prefix, remarks, texts
from pipeline.report.yearly import BESIDE, LEVEL, OfTasks, by_sea, cells, counted, named, sea_keys, weighed

if TYPE_CHECKING:
    import xarray as xr

POWERS = ("electrical_power", "absorbed_power")  # the first that there is: what a design is for
SAME = 1e-6  # of the best power: by less two do not differ
CHOSEN = ("pto_damping", "hinge_spacing")  # and any axis of the floats' keys
UNCOUNTED = "no part of the estimated error"  # words of warnings
BEYOND = "beyond"  # the variable that tells which tasks have those
WARNED = " (warned)"
OF_WARNED = " Warned: of a task of it `warnings` tell what is no part of its estimated error."
TITLE = "Best in each sea state"
NOTE = (
    f"Of all floats, mean over realizations; low and high: {LEVEL:.0%} by Student's t. All seas: by their occurrence."
    " A number at an end of its axis may be exceeded beyond; any: all have the same; alike: as many more have. Compared"
    " are designs that have all realizations of a sea that any has."
)
PAIRED = (
    f" The next best has less by the mean of the differences in the same waves, in brackets {LEVEL:.0%}; undecided: 0"
    " is among these; others undecided: not of the next best but of one with less."
)
ALONE = (
    " Of one realization in the time domain nothing tells by how much others differ, in which another design may be the"
    " best: more seeds do."
)
OF_ERRORS = (
    " A difference that the records of two designs may be off by, by their estimated_error, is undecided as well. An"
    " end that is not decided against the number beside it is not told."
)


class Compared(NamedTuple):
    """Designs in a sea, or in all, as arrays along their axes."""

    axes: list[xr.DataArray]  # along which designs differ
    whole: np.ndarray  # which are compared
    found: np.ndarray  # power, last along `estimate`
    mean: np.ndarray  # power; NaN of those that are not compared
    at: tuple[int, ...]  # place of the best
    ahead: np.ndarray  # what the best has more than each, in the same realizations, last along `estimate`
    error: np.ndarray  # what that may be off by, as their records are
    off: np.ndarray  # what power may be off by
    several: bool  # whether scatter is known where it is at all: without an interval nothing is decided then

    @property
    def known(self) -> int:
        """How many have a mean."""
        return int((~np.isnan(self.mean)).sum())

    @property
    def least(self) -> float:
        """By what powers differ."""
        return SAME * abs(float(self.mean[self.at]))

    def where(self, at: tuple[int, ...]) -> dict[Hashable, int]:
        """A place by dimensions."""
        return {axis.name: place for axis, place in zip(self.axes, at, strict=True)}

    def along(self, *axes: int) -> np.ndarray:
        """Means along these axes, others as the best."""
        return self.mean[tuple(slice(None) if i in axes else place for i, place in enumerate(self.at))]

    def alike(self, *axes: int) -> bool:
        """Whether several along these do not differ: as where all survive a storm by the same settings."""
        some = self.along(*axes)
        return int((~np.isnan(some)).sum()) > 1 and bool(np.nanmax(some) - np.nanmin(some) <= self.least)

    @property
    def free(self) -> list[int]:
        """Along which the best do not differ, whatever they are along the others of these: as of what is not there."""
        free: list[int] = []
        for i in range(len(self.at)):
            free += [i] * (self.alike(i) and self.alike(*free, i))
        return free

    @property
    def undecided(self) -> np.ndarray:
        """Which others may be as good as the best, by the scatter of realizations or by what records are off by."""
        value, low = self.ahead[..., 0], self.ahead[..., 1]
        differs = self.mean < self.mean[self.at] - self.least
        scattered = ~(low > self.least) if self.several else low <= self.least
        return np.asarray(differs & (scattered | ~(value >= self.error)))

    @property
    def ties(self) -> int:
        """How many more take as much as the best, but for those along what the best do not differ by."""
        least = self.mean[self.at] - self.least
        return int((self.mean >= least).sum() - (self.along(*self.free) >= least).sum())


def table(data: xr.Dataset) -> Table:
    """Of a study with several designs."""
    data, variable = weighed(data), power_in(data)
    if not variable:
        return Table(TITLE, (), [], NOTE)
    unit, scale = prefix(data[variable].sel(statistic="mean"))
    first = ("", "most power with", f"mean {OF[variable]} power [{unit}W]", "low", "high")
    second = ("next best", f"less by [{unit}W]") if _several(data) else ()
    lines = list(rows(data, variable, scale))
    alone = ALONE * ("discretization_error" in data and "Hs" in data.coords)  # of marches in random seas
    note = NOTE + (PAIRED if second else alone) + OF_ERRORS * ("estimated_error" in data) + remarks(lines)
    note += OF_WARNED * any(WARNED in line[1] for line in lines)
    return Table(TITLE, (*first, *second, "realizations"), lines, note)


def power_in(data: xr.Dataset) -> str:
    """The variable by which designs are compared; empty where there is none."""
    return next((name for name in POWERS if name in data), "")


def rows(data: xr.Dataset, variable: str, scale: float = 1e3) -> Iterator[tuple[str, ...]]:
    """Of every platform, of all seas together, if somebody said how often they come, and of each; power over scale [W].

    A design without a number in a sea, or in a realization that another has, is none of those that are compared in it.
    """
    every = list(platforms(data, variable))
    least = NOTHING * max((float(abs(part[variable]).max()) for _, part, _ in every), default=0.0)
    for labels, part, designs in every:
        for sea, some in seas(part, variable):
            each, label = some[variable], ", ".join(filter(None, [*labels, sea]))
            of = compared(each, designs, some)
            if not of.whole.any():
                yield label, f"none (of 0 among {of.mean.size})", *["-"] * (5 if _several(data) else 3), counted(each)
            if not (np.abs(of.mean) > least).any():  # nor is there a best of none that takes power
                continue
            chosen = "any" if of.alike(*range(len(designs))) else ", ".join(_chosen(of))
            if chosen != "any" and (ties := of.ties):
                chosen += f" (and {ties} alike)"
            chosen += warned(some, of, of.at)
            chosen += " (all lose)" * bool(of.mean[of.at] < 0)
            if of.known < of.mean.size:
                chosen += f" (of {of.known} among {of.mean.size})"
            chosen += " (undecided)" * bool(not _several(data) and of.undecided.any())
            second = _next_best(of, scale) if _several(data) else ()
            power = marked(of.found[of.at], of.off[of.at], scale)
            yield label, chosen, *power, *second, counted(each.isel(of.where(of.at)))


def platforms(data: xr.Dataset, variable: str) -> Iterator[tuple[list[str], xr.Dataset, list[Hashable]]]:
    """Labels of every platform and other axis along which nobody chooses, power of all floats there, and the axes
    along which designs differ; none without any."""
    total = powers(data, variable).isel(float=-1, drop=True).compute()
    designs = [dim for dim in total.dims if total.sizes[dim] > 1 and _is_design(data[dim])]
    for labels, place in cells(total, designs) if designs else ():
        part = total.isel(place).to_dataset(name=variable)
        if "warnings" in data:
            told = data["warnings"].isel(place, missing_dims="ignore")
            part[BEYOND] = told.copy(data=np.char.find(told.values.astype(str), UNCOUNTED) >= 0)
        yield labels, part, designs


def seas(part: xr.Dataset, variable: str) -> Iterator[tuple[str, xr.Dataset]]:
    """All sea states together, if somebody said how often they come, and each."""
    for sea, some in by_sea(part, variable):
        if some[variable].sizes.get("sea_state", 1) == 1 or "occurrence" in some.coords:
            yield sea, some


def compared(each: xr.DataArray, designs: Sequence[Hashable], some: xr.Dataset) -> Compared:
    """Designs by their power in each task of some seas; the first stands for the best where no mean is known."""
    tasks = OfTasks.of(each, some, designs)
    found, whole = tasks.ends(), _whole(tasks.numbers)
    mean = np.where(whole, found[..., 0], np.nan)
    at = _most(mean)
    best = tasks.numbers[at]
    ahead = tasks._replace(numbers=best - tasks.numbers).ends()
    # What the difference may be off by, as of independent errors: those of one kind cancel in part, but nothing tells
    # how much of them. Those of a record that is both designs', as in a storm that all survive alike, do.
    differ = tasks.numbers != best
    apart = (tasks._replace(errors=np.where(differ, errors, 0.0)) for errors in (tasks.errors, tasks.errors[at]))
    error = np.hypot(*(of.off() for of in apart))
    return Compared([each[dim] for dim in designs], whole, found, mean, at, ahead, error, tasks.off(), _several(each))


def _most(of: np.ndarray) -> tuple[int, ...]:
    """Place of the largest; the first of all where none is known."""
    return tuple(int(i) for i in np.unravel_index(np.argmax(np.where(np.isnan(of), -np.inf, of)), of.shape))


def _several(data: xr.Dataset | xr.DataArray) -> bool:
    return data.sizes.get("seed", 1) > 1


def _is_design(axis: xr.DataArray) -> bool:
    """Whether along it designs differ, and the waves that they meet do not."""
    return (axis.name in CHOSEN or "floats." in axis.attrs.get("long_name", "")) and not sea_keys(axis)


def _whole(numbers: np.ndarray) -> np.ndarray:
    """Which designs have all realizations that any has: of those that failed in some the others tell too much."""
    has = ~np.isnan(numbers)
    whole = has == has.any(axis=tuple(range(has.ndim - 2)))  # not as many: two that failed in others met other waves
    return np.asarray(whole.all(axis=(-2, -1)))


def warned(some: xr.Dataset, of: Compared, at: tuple[int, ...]) -> str:
    """A mark of a design of which a task warns of what its estimated error does not count."""
    return WARNED * (BEYOND in some and bool(some[BEYOND].isel(of.where(at), missing_dims="ignore").any()))


def _next_best(of: Compared, scale: float) -> tuple[str, str]:
    """The one with the most power of those that differ from the best, by where they do, and by how much, over scale."""
    others = np.where(of.mean < of.mean[of.at] - of.least, of.mean, np.nan)
    if np.isnan(others).all():
        return "-", "-"
    at = _most(others)
    label = ", ".join(one_of(axis, i) for axis, i, best in zip(of.axes, at, of.at, strict=True) if i != best)
    less = by_how_much(of, at, scale)
    if of.undecided.any():
        less += " undecided" if of.undecided[at] else " others undecided"
    return label, less


def by_how_much(of: Compared, at: tuple[int, ...], scale: float) -> str:
    """What a design has less than the best, over scale, with its interval."""
    less, low, high = texts(of.ahead[at] / scale)
    return less + f" [{low}, {high}]" * (low != "-")


def one_of(axis: xr.DataArray, place: int) -> str:
    """One of an axis's values, with those that go along; a variant without a title has its name for one."""
    beside = ((str(name).rpartition("floats.")[2], other.values[place]) for name, other in _along(axis))
    itself = named(axis.name, axis.values[place])
    along = [words for name, value in beside if (words := named(name, value)) != itself]
    return itself + f" ({', '.join(along)})" * bool(along)


def _along(axis: xr.DataArray) -> list[tuple[Hashable, xr.DataArray]]:
    others = ((name, other) for name, other in axis.coords.items() if name not in (axis.name, *BESIDE))
    return [(name, other) for name, other in others if other.dims == axis.dims]


def _chosen(of: Compared) -> Iterator[str]:
    """The best along each axis."""
    free = of.free
    for i, (axis, place) in enumerate(zip(of.axes, of.at, strict=True)):
        yield f"any {axis.name}" if i in free else one_of(axis, place) + " (an end)" * _at_end(of, i)


def _at_end(of: Compared, i: int) -> bool:
    """Whether the best is the last of an axis's numbers to either side, and decided against the one beside it.

    Where no interval or error tells that, it is if the axis matters. Numbers of samples have no end.
    """
    axis, place = of.axes[i], of.at[i]
    numbers = axis.values
    if _along(axis) or not np.issubdtype(axis.dtype, np.number) or numbers[place] not in (numbers.min(), numbers.max()):
        return False
    mean = of.along(i)
    order = [int(j) for j in np.argsort(numbers) if not np.isnan(mean[j])]
    beside = order[:2][-1] if order[0] == place else order[-2]
    matters = bool(np.nanmax(mean) - np.nanmin(mean) > of.least)
    return matters and not of.undecided[(*of.at[:i], beside, *of.at[i + 1 :])]
