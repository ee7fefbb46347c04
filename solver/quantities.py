"""Units, ranges and meanings of inputs: they stand once, beside the field; study files' tables take them from there.

depth: Annotated[float, Quantity("m", above=0), "Depth of the water"]
"""

import math
import operator
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from solver.errors import InputError, refuse

BOUNDS = (
    ("above", ">", operator.gt), ("least", ">=", operator.ge),
    ("below", "<", operator.lt), ("most", "<=", operator.le),
)  # fmt: skip
Mark = TypeVar("Mark")
PerAxis = float | tuple[float, ...]  # of a joint: a number for its only axis, or one for each


@dataclass(frozen=True, slots=True)
class Quantity:
    """Unit and range of an input, a number or several: metadata of its annotation."""

    unit: str = "-"
    above: float | None = None  # must be >
    least: float | None = None  # must be >=
    below: float | None = None  # must be <
    most: float | None = None  # must be <=
    infinite: bool = False  # may be

    def limit(self, values: Any) -> str:
        """The limit that numbers outside the range break, as text; empty if all are inside."""
        for name, sign, holds in BOUNDS:
            bound = getattr(self, name)
            if bound is not None and not _all(holds(values, bound)):
                return f"must be {sign} {bound:g} {self.unit}".removesuffix(" -")
        finite = np.isfinite(values).all() if isinstance(values, np.ndarray) else math.isfinite(values)
        if not (finite or (self.infinite and not np.any(np.isnan(values)))):
            return f"must be finite {self.unit}".removesuffix(" -")
        return ""


def _all(holds: Any) -> bool:
    """Of a truth or an array of them; np.all takes ten times as long for one."""
    return bool(holds.all()) if isinstance(holds, np.ndarray) else bool(holds)


@lru_cache
def quantities(inputs: type) -> dict[str, Quantity]:
    """Unit and range of each field of a class of inputs that has them."""
    return _marks(inputs, Quantity)


@lru_cache
def meanings(inputs: type) -> dict[str, str]:
    """What each field of a class of inputs is, in words, where it says so."""
    return _marks(inputs, str)


def _marks(inputs: type, kind: type[Mark]) -> dict[str, Mark]:
    """Of a kind, in the annotations of each field that has one."""
    hints = get_type_hints(inputs, include_extras=True)
    marks = {name: getattr(hint, "__metadata__", ()) for name, hint in hints.items()}
    return {name: mark for name, of in marks.items() for mark in of if isinstance(mark, kind)}


@lru_cache
def _judged(inputs: type) -> list[tuple[str, Quantity, Any]]:
    """Name, range and default of each field of a class of inputs that has a range."""
    usual = {f.name: f.default for f in fields(inputs)}
    return [(name, quantity, usual[name]) for name, quantity in quantities(inputs).items()]


@lru_cache
def _worded(inputs: type) -> list[tuple[str, tuple[str, ...], bool, Any]]:
    """Name, words, whether a number will do, and default of each field of a class of inputs that is one of some words,
    or several of them."""
    usual, hints = {f.name: f.default for f in fields(inputs)}, get_type_hints(inputs)
    words = {name: tuple(_words(hints[name])) for name in usual}
    return [(name, words[name], int in get_args(hints[name]), usual[name]) for name in usual if words[name]]


def _words(hint: Any) -> Iterator[str]:
    if get_origin(hint) is Literal:
        yield from get_args(hint)
    else:
        for part in get_args(hint):
            yield from _words(part)


def out_of_range(inputs: Any, key: str) -> Iterator[InputError]:
    """An error for every field of inputs that is outside its range, or none of its words; None is skipped."""
    for name, quantity, usual in _judged(type(inputs)):  # type: ignore[arg-type]  # mypy: its instances' __hash__
        value = getattr(inputs, name)
        if value is usual or value is None or isinstance(value, str):  # most are the default, which is in range
            continue
        if limit := quantity.limit(value if isinstance(value, (float, int)) else np.asarray(value, float)):
            yield InputError(f"{key}.{name}", value, limit)
    for name, words, or_number, usual in _worded(type(inputs)):  # type: ignore[arg-type]
        value = getattr(inputs, name)
        if value is usual or (or_number and not isinstance(value, str)):
            continue
        for one in value if isinstance(value, tuple) else (value,):
            if one not in words:
                limit = f"must be one of {', '.join(words)}" + ", or a number" * or_number
                yield InputError(f"{key}.{name}", one, limit)


def take_tuples(inputs: Any) -> None:
    """Tuples in place of lists and arrays among inputs, by which scenes are told apart."""
    for name in _names(type(inputs)):  # type: ignore[arg-type]  # mypy: its instances' __hash__
        if isinstance(value := getattr(inputs, name), (list, np.ndarray)):
            object.__setattr__(inputs, name, _tuple(value))


def _tuple(value: Any) -> Any:
    """Of a list or an array, and of those in it."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    return tuple(map(_tuple, value)) if isinstance(value, (list, tuple)) else value


@lru_cache
def _names(inputs: type) -> list[str]:
    return [f.name for f in fields(inputs)]


def require_ranges(inputs: Any, key: str) -> None:
    """Refuse inputs of which a field is outside its range."""
    refuse(out_of_range(inputs, key))


def require_positive(key: str, value: float, unit: str = "-") -> None:
    """Refuse a number that is not finite and > 0."""
    if limit := Quantity(unit, above=0).limit(value):
        raise InputError(key, value, limit)


def of_no_unit(matrix: np.ndarray) -> np.ndarray:
    """A matrix (n, n) scaled to a diagonal of ±1 where it is not zero; its rows may be of different units and sizes."""
    size = np.sqrt(np.abs(np.diag(matrix)))
    size[size == 0] = 1.0
    return matrix / np.outer(size, size)
