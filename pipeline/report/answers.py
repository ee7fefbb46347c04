"""What a study is for as a dataset: quantities over all sea states with their intervals, and how two designs differ.

A difference is taken in each realization first, whose waves both designs meet: its interval is far narrower than that
of either.
"""

from __future__ import annotations

import contextlib
from collections.abc import Hashable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.report.best import power_in
from pipeline.report.energy import powers
from pipeline.report.life import AT, lives
from pipeline.report.tables import Table, texts
from pipeline.report.yearly import (
    ESTIMATES,
    FAILED,
    HOUR,
    LEVEL,
    YEAR,
    cells,
    failures,
    over_seas,
    realized,
    sea_keys,
    weighed,
)
from pipeline.results.dataset import once, with_coordinates
from pipeline.results.netcdf import Variable

if TYPE_CHECKING:
    import xarray as xr

TITLE = "Differences in the same waves"
NOTE = f"{{}}; low and high: {LEVEL:.0%} by Student's t of realizations' differences."
DIFFERENCE = "_difference"
ESTIMATE = f"Mean, and the ends of its interval ({LEVEL:.0%}), which are missing where nothing tells it"
TASKS = ("sea_state", "seed")
KEPT = ("Conventions", "title", "source", "study")  # attributes of the collected dataset


class _Quantity(NamedTuple):
    """Of which answers are means over realizations and sea states."""

    each: xr.DataArray  # of the tasks
    units: str
    long_name: str


class Pair(NamedTuple):
    """Two labels along an axis, of which differences are the first less the second."""

    axis: Hashable
    labels: tuple[Hashable, Hashable]


def answers(data: xr.Dataset, pair: Pair | None) -> xr.Dataset:
    """Along `estimate`: `mean_power`, `annual_energy`, `capture_width` (float), `life` and `damage` (leg, fibre), as
    far as a collected dataset has them, and `<quantity>_difference` of a pair."""
    import xarray as xr

    known, data, found = "occurrence" in data.coords, weighed(data), dict[str, xr.DataArray]()
    unknown = known and "occurrence" not in data.coords  # how often what an axis makes of the sea states comes
    comment = _averaged(data)
    for name, (each, units, long_name) in _quantities(data):
        if unknown and name == "annual_energy":
            continue
        attrs = {"units": units, "long_name": long_name, "comment": comment}
        left_out = {"units": "1", "long_name": "Number of realizations that failed, which are in no mean"}
        failed = failures(each).assign_attrs(left_out)
        found.setdefault(FAILED, failed)
        if name in AT:
            found[f"{name}_{FAILED}"] = failed  # a count may fail in a record that has power
            steel = lives(data, name)  # with the interval of the logarithm: damage is skewed
            found[name] = steel["damage"].assign_attrs(attrs)
            words = f"Life of the steel by fatigue, 1/{name}, at the {AT[name]} of a leg"
            life = {"units": "s", "long_name": words, "comment": f"Of damage's {comment.lower()}"}
            found[name.replace("damage", "life")] = steel["life"].assign_attrs(life)
        else:
            found[name] = over_seas(each, data).assign_attrs(attrs)
        if pair and pair.axis in each.dims:
            one, other = (each.sel({pair.axis: label}, drop=True) for label in pair.labels)
            named = _words(data[pair.axis])
            first, second = (f"{pair.axis}={named[label]}" for label in pair.labels)
            told = {"first": first, "second": second, "long_name": f"{long_name}: first less second, in the same waves"}
            found[f"{name}{DIFFERENCE}"] = over_seas(one - other, data).assign_attrs(attrs | told)
    kept = {name: data.attrs[name] for name in KEPT if name in data.attrs} | {"tasks": states(data)}
    return xr.Dataset(found, {"estimate": list(ESTIMATES)}, kept)


def _averaged(data: xr.Dataset) -> str:
    seas = "by their occurrence" if "occurrence" in data.coords else "which all count alike"
    return f"Mean over realizations and sea states, {seas}"


def states(data: xr.Dataset) -> str:
    """How many tasks of a collected dataset are in which state."""
    words, counts = np.unique(data["status"].values[once(data["task"].values)], return_counts=True)
    return ", ".join(f"{n} {word}" for word, n in zip(words, counts, strict=True))


def _quantities(data: xr.Dataset) -> Iterator[tuple[str, _Quantity]]:
    if variable := power_in(data):
        each = powers(data, variable).compute()
        word = variable.replace("_", " ")
        yield "mean_power", _Quantity(each, "W", f"Mean {word}")
        yield "annual_energy", _Quantity(each * YEAR * HOUR, "J", f"Energy of a year, of {word}")
    if "absorbed_power" in data and "wave_power" in data:
        each = powers(data, "absorbed_power").compute()
        carried = over_seas(realized(data, data["wave_power"]), data).sel(estimate="value", drop=True)
        words = "Width of the waves' crests whose mean wave power is the mean absorbed power"
        yield "capture_width", _Quantity(each / carried, "m", words)
    for variable, end in AT.items():
        if variable in data:
            words = f"Fatigue damage at the {end} of a leg"
            yield variable, _Quantity(realized(data, data[variable]).compute(), "h-1", words)


def pair_of(data: xr.Dataset, words: str) -> Pair | None:
    """Of "axis=first,second"; of no words the only axis of two labels, in which the last is the first, if there is one.

    Raises ValueError with what is wrong.
    """
    axes = {str(dim): data[dim] for dim in data["status"].dims if dim not in TASKS}
    if not words:
        two = [name for name, axis in axes.items() if axis.size == 2 and not sea_keys(axis)]
        return Pair(two[0], tuple(axes[two[0]].values[::-1].tolist())) if len(two) == 1 else None
    name, _, labels = words.partition("=")
    if name not in axes:
        raise ValueError(f"must begin with an axis: {', '.join(axes) or 'there is none'}")
    known = {word: label for label, word in _words(axes[name]).items()}
    chosen = [_known(word.strip(), known) for word in labels.split(",")]
    if len(chosen) != 2 or not {*chosen} <= known.keys() or chosen[0] == chosen[1]:
        raise ValueError(f"must be {name}=FIRST,SECOND, two of {', '.join(known)}")
    if keys := sea_keys(axes[name]):
        raise ValueError(f"along {name} waves differ in {', '.join(sorted(keys))}: designs must meet the same ones")
    return Pair(name, (known[chosen[0]], known[chosen[1]]))


def _words(axis: xr.DataArray) -> dict[Any, str]:
    """Of each label: six digits of numbers, or all where those do not tell them apart."""
    labels = axis.values.tolist()
    short = [f"{label:g}" if isinstance(label, float) else str(label) for label in labels]
    return dict(zip(labels, short if len({*short}) == len(labels) else map(str, labels), strict=True))


def _known(word: str, known: Mapping[str, Any]) -> str:
    """A number as the axis writes it: 2e5 is 200000, with as many digits as it may have."""
    with contextlib.suppress(ValueError):
        return next((one for one, label in known.items() if float(word) in (label, float(one))), word)
    return word


def table(found: xr.Dataset) -> Table:
    """Of the differences."""
    lines: list[tuple[str, ...]] = []
    title, comment = TITLE, ""
    for name, of in found.data_vars.items():
        if "second" in of.attrs:
            title = f"{TITLE}: {of.attrs['first']} less {of.attrs['second']}"
            for labels, place in cells(of, ["estimate"]):
                quantity = f"{str(name).removesuffix(DIFFERENCE)} [{of.attrs['units']}]"
                lines.append((", ".join(labels), quantity, *texts(of.isel(place).values)))
                comment = of.attrs["comment"]
    return Table(title, ("", "difference of", *ESTIMATES), lines, NOTE.format(comment))


def variables(found: xr.Dataset) -> dict[str, Variable]:
    """As files have them."""
    every = {str(name): Variable(tuple(map(str, of.dims)), of.values, of.attrs) for name, of in found.variables.items()}
    coordinates = {name: of for name, of in every.items() if name in found.coords}
    coordinates["estimate"] = coordinates["estimate"]._replace(attrs={"long_name": ESTIMATE})
    return coordinates | with_coordinates({n: of for n, of in every.items() if n not in coordinates}, coordinates)
