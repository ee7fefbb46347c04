"""What a study varies: the five named axes, and any other key by its dotted path."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from pipeline.study.ranges import Sampled, listed, refuse_key
from pipeline.study.tables import (
    Count,
    Label,
    Name,
    NotNegative,
    Positive,
    Seed,
    Table,
    Title,
    Unit,
)
from pipeline.study.words import by_path, labels, last

Support = Literal["elastic", "fixed", "elastic-no-floats"]

# Dimensions, coordinates and outputs of datasets that are some key's last word, which no axis over it may take; the
# last five are what the report's tables add to numbers.
TAKEN = frozenset((
    "sea_state", "platform", "seed", "float", "axis", "line", "leg", "direction", "height", "statistic", "mode",
    "system_mode", "component", "variant", "variant_title", "sample", "status", "task", "failure", "unmet", "axis_unit",
    "elapsed_time", "wall_time", "foot", "node", "member", "tube", "end", "force", "moment", "fibre", "member_fibre",
    "motion", "rotation", "rao", "utilisation", "warnings",
    "estimate", "life", "failed_realizations", "record_error", "single_task",
))  # fmt: skip
UNCHANGED = object()
WORD = re.compile(r"([A-Za-z_]\w*)(?: \[([^\[\]]+)\])?")  # length [m]
OTHERWISE = {"pto_damping": '"floats.*.pto_damping"', "hinge_spacing": '"floats.NAME.hinge.0", a float\'s x,'}
UNDOTTED = ("coefficients", "left_out")  # keys of a study itself, in no table: their paths have no dot


class Axis(NamedTuple):
    """One dimension over keys: with each label each key has its value."""

    name: str
    labels: tuple[str | float | int, ...]
    keys: Mapping[str, tuple[Any, ...]]  # by dotted path; UNCHANGED where the study's own value stands
    beside: Mapping[str, tuple[Any, ...]] = MappingProxyType({})  # other numbers or words that go with the labels
    own: bool = False  # whether the labels are the values of the only key
    partial: Collection[str] = ()  # keys that are UNCHANGED with some of the labels, and no coordinates
    names: Mapping[str, str] = MappingProxyType({})  # what datasets call the others, by dotted path

    def at(self, place: int) -> dict[str, Any]:
        """What keys have with one of the labels, where that is another value than the study's own."""
        return {path: values[place] for path, values in self.keys.items() if values[place] is not UNCHANGED}

    @property
    def coordinates(self) -> dict[str, tuple[str | float | int, ...]]:
        """What goes with the labels: values of keys, by their paths, and others, by their words."""
        keys = {path: labels(values) for path, values in self.keys.items() if path not in self.partial}
        return keys | {words.partition(" ")[0]: labels(values) for words, values in self.beside.items()}


class Together(Table):
    """Keys that change together, along one dimension; a word that is no key only goes with the labels: length [m]."""

    name: Annotated[Name, "Name of the dimension, which is numbered from 1"]
    keys: Annotated[dict[str, tuple[Any, ...]], "A list of values for each dotted path, all of one length"]
    beside: Annotated[dict[str, tuple[Any, ...]], "A list of labels that go with them"] = Field(default={})

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        lists = {key: listed(key, value) for key, value in _flat(cls, data).items() if key != "name"}
        if len({len(values) for values in lists.values()}) > 1:
            lengths = ", ".join(f"{key} {len(values)}" for key, values in lists.items())
            refuse_key(next(iter(lists)), f"lists of one dimension must be of one length: {lengths}")
        beside, keys = _by_dots(lists)
        _require_paths(beside)
        if strange := [key for key in beside if not WORD.fullmatch(key)]:
            refuse_key(strange[0], 'must be a dotted path, or a word with its unit in brackets: "length [m]"')
        if not keys:
            refuse_key("name", "needs lists of keys by their dotted paths beside it")
        named = {"name": data["name"]} if "name" in data else {}
        return {**named, "keys": keys, "beside": beside}


class Axes(Table):
    """What is varied; the study is the product of the axes."""

    sea_state: Annotated[tuple[Label, ...] | None, "Labels of [sea_states]; left out, all of them"] = None
    platform: Annotated[tuple[Support, ...] | None, "What carries the floats, and whether there are any"] = None
    pto_damping: Annotated[
        tuple[NotNegative, ...] | None, Unit("N m s/rad or N s/m"), "Damping of every power take-off"
    ] = None
    hinge_spacing: Annotated[
        tuple[Positive, ...] | None, Unit("m"), "Distance of the two hinges along x, about the same middle"
    ] = None
    seed: Annotated[tuple[Seed, ...] | None, "Numbers of the realizations of random seas"] = None
    together: Annotated[tuple[Together, ...], "Keys that change together, along one dimension"] = ()
    keys: Annotated[dict[str, tuple[Any, ...]], "Values of any key, or a range { from, to, count, spacing }"] = Field(
        default={}
    )

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, data: Any) -> Any:
        """Keys with a dot, and tables in tables, are paths; the five axes may be given as ranges, too."""
        if not isinstance(data, dict):
            return data
        if isinstance(data.get("together"), dict):
            refuse_key("together", "must be a list of tables: each is [[axes.together]], in two brackets")
        named, paths = _by_dots(_flat(cls, data))
        named = {key: listed(key, value) if isinstance(value, dict) else value for key, value in named.items()}
        return named | {"keys": {path: listed(path, value) for path, value in paths.items()}}

    @cached_property
    def over_keys(self) -> tuple[Axis, ...]:
        """One for each path and each group, in the order of the file."""
        single = (Axis(path, labels(values), {path: values}, own=True) for path, values in self.keys.items())
        groups = (Axis(g.name, tuple(range(1, _length(g) + 1)), g.keys, g.beside) for g in self.together)
        return (*single, *groups)


class Samples(Table):
    """Points of a design space along one dimension, `sample`; more of them leave the first ones where they are."""

    count: Annotated[Count, "How many; more leave the first ones where they are"]
    method: Annotated[Literal["sobol", "halton", "random"], "Low-discrepancy sequence, or independent points"] = "sobol"
    seed: Annotated[Seed, "Of the points"] = 0
    keys: Annotated[dict[str, Sampled], "What is sampled: { from, to, spacing } or { mean, std } of any key"]

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        named, paths = _by_dots(_flat(cls, data))
        _require_paths(named)
        if not paths:
            refuse_key("", "needs ranges of keys by their dotted paths: { from, to } or { mean, std }")
        return named | {"keys": paths}

    @cached_property
    def axis(self) -> Axis:
        """Numbers 0 to count - 1, and each key's values."""
        points = _unit_cube(self.method, len(self.keys), self.count, self.seed)
        keys = {path: span.at(column) for (path, span), column in zip(self.keys.items(), points.T, strict=True)}
        return Axis("sample", tuple(range(self.count)), keys)


def _unit_cube(method: str, dimensions: int, count: int, seed: int) -> np.ndarray:
    """Points (count, dimensions) between 0 and 1, the first of them the same for any count."""
    from scipy.stats import qmc  # rarely needed, and slow to import

    if method == "random":
        return np.random.default_rng(seed).random((count, dimensions))
    if method == "halton":
        return np.asarray(qmc.Halton(dimensions, rng=seed).random(count))
    whole = 2 ** int(np.ceil(np.log2(count)))  # of which Sobol's points are balanced
    return np.asarray(qmc.Sobol(dimensions, rng=seed).random(whole))[:count]


class Variant(Table):
    """A named set of values, by dotted paths or in tables; what it does not name stays as the study has it."""

    title: Annotated[Title, "What it is, in a line"] = ""
    axes: Annotated[dict[str, tuple[Any, ...]], "By name or path, the part of an axis that it goes along"] = Field(
        default={}
    )
    keys: Annotated[dict[str, Any], "Another value of any key"] = Field(default={})

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        return _apart(data, ("title", "axes"))

    @field_validator("axes", mode="before")
    @classmethod
    def _list(cls, table: Any) -> Any:
        if not isinstance(table, dict):
            return table
        return {key: listed(key, value) for key, value in _once(by_path(table, ranges=True)).items()}


class Survival(Table):
    """Other values of any keys in seas above a significant wave height, 4√m₀ of those from files: paths or tables."""

    Hs: Annotated[Positive, Unit("m"), "Significant wave height above which they hold"]
    keys: Annotated[dict[str, Any], "Another value of any key of floats, left_out, platform or solver"] = Field(
        default={}
    )

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "keys" in data:
            return data
        return _apart(data, ("Hs",))


def _apart(data: Mapping[str, Any], fields: Collection[str]) -> dict[str, Any]:
    """A table's own fields, and other keys by their paths."""
    own = {key: data[key] for key in fields if key in data}
    return own | {"keys": _once(by_path({key: value for key, value in data.items() if key not in own}))}


def variant_axis(variants: Mapping[str, Variant]) -> Axis:
    """The dimension `variant`."""
    paths = dict.fromkeys(path for variant in variants.values() for path in variant.keys)
    keys = {path: tuple(variant.keys.get(path, UNCHANGED) for variant in variants.values()) for path in paths}
    return Axis("variant", tuple(variants), keys, partial=[path for path in paths if UNCHANGED in keys[path]])


def named(axes: Sequence[Axis], others: Collection[str]) -> tuple[Axis, ...]:
    """With the name of each key: its last word, or its whole path where two would clash; others: further dimensions.

    `survival.Hs` is no sea's.
    """
    lasts = {path: last(path) for axis in axes for path in axis.keys if path not in axis.partial}
    dimensions = (axis.name for axis in axes if not axis.own)
    beside = (words.partition(" ")[0] for axis in axes for words in axis.beside)
    several = (last for last, count in Counter(lasts.values()).items() if count > 1)
    taken = TAKEN.union(others, dimensions, beside, several)
    names = {path: path if last in taken or path == "survival.Hs" else last for path, last in lasts.items()}
    return tuple(axis._replace(name=names[axis.name] if axis.own else axis.name, names=names) for axis in axes)


def implied_sea(axes: Any) -> dict[str, Any] | None:
    """The first values of all keys of the sea, of raw tables that vary some: a sea state without a table of its own."""
    if not isinstance(axes, dict):
        return None
    groups = axes.get("together")
    tables = [axes, *(g for g in (groups if isinstance(groups, list) else ()) if isinstance(g, dict))]
    paths = {path: value for table in tables for path, value in by_path(table, ranges=True)}
    found = {path: _values(path, value) for path, value in paths.items() if path.startswith("sea.")}
    return {path.removeprefix("sea."): values[0] for path, values in found.items() if values} or None


def _values(path: str, value: Any) -> tuple[Any, ...]:
    """Of an axis; what is no list and no range stands for itself, for the axis to refuse."""
    try:
        return listed(path, value)
    except PydanticCustomError:
        return (value,)


def _flat(table: type[Table], data: Mapping[str, Any]) -> dict[str, Any]:
    """Keys, of which those that are no field of the table's may be tables in tables: a path without quotes."""
    if "keys" in data:
        refuse_key('"keys"', 'unknown key; a key is varied by its dotted path in quotes, "platform.damping_ratio"')
    own = {key: value for key, value in data.items() if key in table.model_fields}
    return own | _once(by_path({key: value for key, value in data.items() if key not in own}, ranges=True))


def _once(paths: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Of which none comes twice."""
    flat: dict[str, Any] = {}
    for path, value in paths:
        if path in flat:
            refuse_key(path, "is given twice, in quotes and in a table")
        flat[path] = value
    return flat


def _by_dots(table: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Keys of the table itself, and paths."""
    paths = {key: value for key, value in table.items() if "." in key or key in UNDOTTED}
    return {key: value for key, value in table.items() if key not in paths}, paths


def _require_paths(words: Iterable[str]) -> None:
    for word in words:
        if path := OTHERWISE.get(word.partition(" ")[0]):
            refuse_key(word, f"is an axis by itself; here {path} is varied instead")


def _length(group: Together) -> int:
    return len(next(iter(group.keys.values())))
