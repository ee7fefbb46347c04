"""The first ten of a study's many designs, and lines of a study file with which they run again."""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pipeline.report.best import (
    ALONE,
    OF_WARNED,
    Compared,
    by_how_much,
    compared,
    one_of,
    platforms,
    power_in,
    seas,
    warned,
)
from pipeline.report.energy import OF
from pipeline.report.tables import MANY, Table, marked, prefix, remarks
from pipeline.report.yearly import LEVEL, counted, weighed
from pipeline.study.layout import spaced

if TYPE_CHECKING:
    import xarray as xr

    from pipeline.study.schema import StudyFile

TITLE = "Designs with the most power"
NOTE = (
    "Of all floats, mean over realizations and, by their occurrence, over sea states, else in each. Less: than the"
    f" first by the mean of the differences in the same waves, with several realizations in brackets {LEVEL:.0%};"
    " undecided: 0 is among these, or records may be off by as much."
)
INSTEAD = (
    "# Instead of [variants], [samples] and [axes] over these keys;"
    ' [solver] method = "time" runs them in the time domain.'
)


class _Design(NamedTuple):
    """One of those that are compared in some seas."""

    words: str  # platform, seas and rank
    at: tuple[int, ...]  # its place
    of: Compared
    each: xr.DataArray  # its power in every task
    warned: str  # a mark

    @property
    def many(self) -> bool:
        """Whether it is among many."""
        return self.of.mean.size > MANY


def table(data: xr.Dataset) -> Table:
    """Of a study with many designs."""
    data, variable = weighed(data), power_in(data)
    many = [design for design in first(data) if design.many]
    if not many:
        return Table(TITLE, (), [], NOTE)
    unit, scale = prefix(data[variable].sel(statistic="mean"))
    lines = [_line(design, scale) for design in many]
    header = "", "design", f"mean {OF[variable]} power [{unit}W]", f"less by [{unit}W]", "realizations"
    alone = ALONE * ("discretization_error" in data and "Hs" in data.coords and data.sizes.get("seed", 1) == 1)
    note = NOTE + alone + remarks(lines) + OF_WARNED * any(design.warned for design in many)
    return Table(TITLE, header, lines, note)


def first(data: xr.Dataset, count: int = MANY) -> Iterator[_Design]:
    """So many of every platform, the one with the most power first, of all seas if somebody said how often they come,
    else of each."""
    variable = power_in(data)
    for labels, part, designs in platforms(data, variable) if variable else ():
        every = [*seas(part, variable)]
        for sea, some in every[:1] if "occurrence" in part.coords else every:
            of = compared(some[variable], designs, some)
            if not np.nan_to_num(of.mean).any():
                continue
            among = f" (of {of.known} among {of.mean.size})" * (of.known < of.mean.size)
            order = np.argsort(-of.mean, axis=None, kind="stable")  # what is not known comes last
            for rank, place in enumerate(order[: min(count, of.known)], start=1):
                at = tuple(int(i) for i in np.unravel_index(place, of.mean.shape))
                words = ", ".join(filter(None, [*labels, f"{sea}{among}", f"number {rank}"]))
                yield _Design(words, at, of, some[variable].isel(of.where(at)), warned(some, of, at))


def _line(design: _Design, scale: float) -> tuple[str, ...]:
    of, at = design.of, design.at
    words = ", ".join(one_of(axis, place) for axis, place in zip(of.axes, at, strict=True))
    power, *_ = marked(of.found[at], of.off[at], scale)
    less = "-" if at == of.at else by_how_much(of, at, scale) + " undecided" * bool(of.undecided[at])
    return design.words, words + design.warned, power, less, counted(design.each)


def block(study: StudyFile, data: xr.Dataset, count: int = MANY) -> str:
    """Lines of a study file that go along so many of the best designs, each once; empty where none are compared.

    Designs of several variants need not have the same keys: each is a variant then.
    """
    return _block(study, first(weighed(data), count))


def again(study: StudyFile, data: xr.Dataset) -> str:
    """Those lines of a study whose designs are many."""
    found = list(first(weighed(data)))
    return _block(study, found) if any(design.many for design in found) else ""


def _block(study: StudyFile, designs: Iterable[_Design]) -> str:
    found = [
        {axis.name: axis.values[place].item() for axis, place in zip(design.of.axes, design.at, strict=True)}
        for design in designs
    ]
    keys = [_keys(study, labels) for i, labels in enumerate(found) if labels not in found[:i]]
    if not keys:
        return ""
    if all(values.keys() == keys[0].keys() != set() for values in keys):
        lists = {path: [values[path] for values in keys] for path in keys[0]}
        return "\n".join([INSTEAD, "[[axes.together]]", 'name = "best"', *_assignments(lists)])
    tables = ("\n".join([f"[variants.best-{rank}]", *_assignments(of)]) for rank, of in enumerate(keys, start=1))
    return "\n".join([INSTEAD, *tables])


def _assignments(values: Mapping[str, Any]) -> Iterator[str]:
    yield from (f"{json.dumps(path)} = {toml(value)}" for path, value in values.items())


def _keys(study: StudyFile, labels: Mapping[Hashable, Any]) -> dict[str, Any]:
    """What a design has of the keys that the study varies, by their paths."""
    keys: dict[str, Any] = {}
    varied = {axis.name: axis for axis in study.varied}
    for dim, label in labels.items():
        if dim in varied:
            keys |= varied[dim].at(varied[dim].labels.index(label))
        elif dim == "hinge_spacing":
            keys |= {f"floats.{item.name}.hinge.0": item.hinge[0] for item in spaced(study.floats, label)}
        else:
            keys["floats.*.pto_damping"] = label
    return keys


def toml(value: Any) -> str:
    """A value as a study file has it."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {toml(of)}" for key, of in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)
