"""Which of a study's designs takes the most power from each sea state, and from a year."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pipeline.report.energy import OF, powers
from pipeline.report.yearly import (
    BESIDE,
    ERROR,
    LEVEL,
    Table,
    by_sea,
    cells,
    counted,
    marked,
    named,
    off,
    over_seas,
    prefix,
    remarks,
    sea_keys,
    texts,
    weighed,
)

if TYPE_CHECKING:
    import xarray as xr

POWERS = ("electrical_power", "absorbed_power")  # the first that there is: what a design is for
SAME = 1e-6  # of the best power: by less two do not differ
CHOSEN = ("pto_damping", "hinge_spacing")  # and any axis of the floats' keys
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
    """Designs in a sea, or in all."""

    found: xr.DataArray  # power, along `estimate`
    mean: xr.DataArray  # power; NaN of those that are not compared
    at: dict[Hashable, int]  # place of the best
    ahead: xr.DataArray  # what the best has more than each, in the same realizations, along `estimate`
    error: xr.DataArray  # what that may be off by, as their records are
    off: xr.DataArray  # what power may be off by
    several: bool  # whether scatter is known where it is at all: without an interval nothing is decided then

    @property
    def least(self) -> float:
        """By what powers differ."""
        return SAME * abs(float(self.mean.isel(self.at)))

    def alike(self, dims: Sequence[Hashable]) -> bool:
        """Whether several along these do not, others as the best: as where all survive a storm by the same settings."""
        some = self.mean.isel({dim: place for dim, place in self.at.items() if dim not in dims})
        return int(some.notnull().sum()) > 1 and float(some.max() - some.min()) <= self.least

    @property
    def free(self) -> list[Hashable]:
        """Along which the best do not differ, whatever they are along the others of these: as of what is not there."""
        free: list[Hashable] = []
        for dim in self.at:
            free += [dim] * (self.alike([dim]) and self.alike([*free, dim]))
        return free

    @property
    def undecided(self) -> xr.DataArray:
        """Which others may be as good as the best, by the scatter of realizations or by what records are off by."""
        value, low = (self.ahead.sel(estimate=name, drop=True) for name in ("value", "low"))
        differs = self.mean < self.mean.isel(self.at, drop=True) - self.least
        scattered = ~(low > self.least) if self.several else low <= self.least
        return differs & (scattered | ~(value >= self.error))

    @property
    def ties(self) -> int:
        """How many more take as much as the best, but for those along what the best do not differ by."""
        best, free = self.mean >= self.mean.isel(self.at, drop=True) - self.least, self.free
        same = best.isel({dim: place for dim, place in self.at.items() if dim not in free})
        return int(best.sum()) - int(same.sum())


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
    return Table(TITLE, (*first, *second, "realizations"), lines, note)


def power_in(data: xr.Dataset) -> str:
    """The variable by which designs are compared; empty where there is none."""
    return next((name for name in POWERS if name in data), "")


def rows(data: xr.Dataset, variable: str, scale: float = 1e3) -> Iterator[tuple[str, ...]]:
    """Of every platform, of all seas together, if somebody said how often they come, and of each; power over scale [W].

    A design without a number in a sea, or in a realization that another has, is none of those that are compared in it.
    """
    for labels, part, designs in platforms(data, variable):
        for sea, some in seas(part, variable):
            each, label = some[variable], ", ".join(filter(None, [*labels, sea]))
            of = compared(each, designs, some)
            if not _whole(each, designs).any():
                yield label, f"none (of 0 among {of.mean.size})", *["-"] * (5 if _several(data) else 3), counted(each)
            if not of.mean.fillna(0.0).any():  # nor is there a best of none that takes power
                continue
            chosen = "any" if of.alike(designs) else ", ".join(_chosen(of))
            if chosen != "any" and (ties := of.ties):
                chosen += f" (and {ties} alike)"
            chosen += " (all lose)" * bool(of.mean.max() < 0)
            if (known := int(of.mean.notnull().sum())) < of.mean.size:
                chosen += f" (of {known} among {of.mean.size})"
            chosen += " (undecided)" * bool(not _several(data) and of.undecided.any())
            second = _next_best(of, scale) if _several(data) else ()
            power = marked(of.found.isel(of.at).values, of.off.isel(of.at), scale)
            yield label, chosen, *power, *second, counted(each.isel(of.at))


def platforms(data: xr.Dataset, variable: str) -> Iterator[tuple[list[str], xr.Dataset, list[Hashable]]]:
    """Labels of every platform and other axis along which nobody chooses, power of all floats there, and the axes
    along which designs differ; none without any."""
    total = powers(data, variable).isel(float=-1, drop=True).compute()
    designs = [dim for dim in total.dims if total.sizes[dim] > 1 and _is_design(data[dim])]
    for labels, place in cells(total, designs) if designs else ():
        yield labels, total.isel(place).to_dataset(name=variable), designs


def seas(part: xr.Dataset, variable: str) -> Iterator[tuple[str, xr.Dataset]]:
    """All sea states together, if somebody said how often they come, and each."""
    for sea, some in by_sea(part, variable):
        if some[variable].sizes.get("sea_state", 1) == 1 or "occurrence" in some.coords:
            yield sea, some


def compared(each: xr.DataArray, designs: Sequence[Hashable], some: xr.Dataset) -> Compared:
    """Designs by their power in each task of some seas; the first stands for the best where no mean is known."""
    found = over_seas(each, some)
    mean = found.sel(estimate="value", drop=True).where(_whole(each, designs))
    at = {dim: int(place) for dim, place in mean.fillna(-np.inf).argmax(designs).items()}
    ahead = over_seas(each.isel(at, drop=True) - each, some)
    return Compared(found, mean, at, ahead, _both(each, at, some), off(each, some), _several(each))


def _both(each: xr.DataArray, at: Mapping[Hashable, int], some: xr.Dataset) -> xr.DataArray:
    """What the difference from the best may be off by, as of independent errors: those of one kind cancel in part, but
    nothing tells how much of them. Those of a record that is both designs', as in a storm that all survive alike, do.
    """
    if ERROR not in each.coords:
        return off(each, some)
    differ, error = each != each.isel(at, drop=True), each[ERROR]
    apart = (each.assign_coords({ERROR: of.where(differ, 0.0)}) for of in (error, error.isel(at, drop=True)))
    return sum(off(one, some) ** 2 for one in apart) ** 0.5


def _several(data: xr.Dataset | xr.DataArray) -> bool:
    return data.sizes.get("seed", 1) > 1


def _is_design(axis: xr.DataArray) -> bool:
    """Whether along it designs differ, and the waves that they meet do not."""
    return (axis.name in CHOSEN or "floats." in axis.attrs.get("long_name", "")) and not sea_keys(axis)


def _whole(each: xr.DataArray, designs: Sequence[Hashable]) -> xr.DataArray:
    """Which designs have all realizations that any has: of those that failed in some the others tell too much."""
    has = each.notnull()
    whole = has == has.any(designs)  # not as many: two that failed in different ones have met other waves
    return whole.all([dim for dim in ("sea_state", "seed") if dim in whole.dims])


def _next_best(of: Compared, scale: float) -> tuple[str, str]:
    """The one with the most power of those that differ from the best, by where they do, and by how much, over scale."""
    others = of.mean.where(of.mean < of.mean.isel(of.at) - of.least)
    if others.isnull().all():
        return "-", "-"
    at = {dim: int(place) for dim, place in others.argmax([*of.at]).items()}
    label = ", ".join(one_of(of.mean[dim], place) for dim, place in at.items() if place != of.at[dim])
    less = by_how_much(of, at, scale)
    if of.undecided.any():
        less += " undecided" if of.undecided.isel(at) else " others undecided"
    return label, less


def by_how_much(of: Compared, at: Mapping[Hashable, int], scale: float) -> str:
    """What a design has less than the best, over scale, with its interval."""
    less, low, high = texts(of.ahead.isel(at).values / scale)
    return less + f" [{low}, {high}]" * (low != "-")


def one_of(axis: xr.DataArray, place: int) -> str:
    """One of an axis's values, with those that go along."""
    along = [named(str(name).rpartition("floats.")[2], other.values[place]) for name, other in _along(axis)]
    return named(axis.name, axis.values[place]) + f" ({', '.join(along)})" * bool(along)


def _along(axis: xr.DataArray) -> list[tuple[Hashable, xr.DataArray]]:
    others = ((name, other) for name, other in axis.coords.items() if name not in (axis.name, *BESIDE))
    return [(name, other) for name, other in others if other.dims == axis.dims]


def _chosen(of: Compared) -> Iterator[str]:
    """The best along each axis."""
    free = of.free
    for dim, place in of.at.items():
        yield f"any {dim}" if dim in free else one_of(of.mean[dim], place) + " (an end)" * _at_end(of, dim)


def _at_end(of: Compared, dim: Hashable) -> bool:
    """Whether the best is the last of an axis's numbers to either side, and decided against the one beside it.

    Where no interval or error tells that, it is if the axis matters. Numbers of samples have no end.
    """
    axis, place = of.mean[dim], of.at[dim]
    numbers = axis.values
    if _along(axis) or not np.issubdtype(axis.dtype, np.number) or numbers[place] not in (numbers.min(), numbers.max()):
        return False
    at = {other: number for other, number in of.at.items() if other != dim}
    mean = of.mean.isel(at).values
    order = [int(i) for i in np.argsort(numbers) if not np.isnan(mean[i])]
    beside = order[:2][-1] if order[0] == place else order[-2]
    return bool(np.nanmax(mean) - np.nanmin(mean) > of.least) and not of.undecided.isel({**at, dim: beside})
