"""Values of a key as a study gives them: lists, ranges, distributions."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NoReturn

import numpy as np
from pydantic import Discriminator, Field, Tag, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from pipeline.study.tables import Count, Number, Positive, Table, whole_numbers

DIGITS = 12  # of a range's numbers, so that 0.1 + 0.2 is written as 0.3


class Span(Table):
    """Numbers between two, all equally likely, or all ratios."""

    start: Annotated[Number, Field(alias="from"), "The first number"]
    to: Annotated[Number, "The last number"]
    spacing: Annotated[Literal["linear", "log"], "Equal distances, or equal ratios"] = "linear"

    @model_validator(mode="after")
    def _has_ratios(self) -> Span:
        if self.spacing == "log" and not (self.start > 0 and self.to > 0):
            raise PydanticCustomError("ratios", 'spacing "log" needs numbers > 0')
        return self

    def at(self, share: np.ndarray) -> tuple[float, ...]:
        """The numbers at shares (n,) of the way."""
        low, high = self.start, self.to
        return _rounded(low * (high / low) ** share if self.spacing == "log" else low + (high - low) * share)


class Range(Span):
    """Numbers at equal distances, or ratios."""

    count: Annotated[Count, "How many, both ends included"]

    @model_validator(mode="after")
    def _has_both_ends(self) -> Range:
        if self.count == 1 and self.start != self.to:
            raise PydanticCustomError("ends", "count must be >= 2, for both ends of the range")
        return self

    @property
    def values(self) -> tuple[float, ...]:
        """From the first to the last."""
        return self.at(np.linspace(0.0, 1.0, self.count))


class Normal(Table):
    """Numbers of a normal distribution."""

    mean: Annotated[Number, "Mean of the normal distribution"]
    std: Annotated[Positive, "Its standard deviation"]

    def at(self, share: np.ndarray) -> tuple[float, ...]:
        """The numbers below which shares (n,) lie."""
        from scipy.special import ndtri  # rarely needed, and slow to import

        return _rounded(self.mean + self.std * ndtri(share))


def _form(value: Any) -> str:
    return "<normal>" if isinstance(value, dict) and value.keys() & {"mean", "std"} else "<span>"


Sampled = Annotated[
    Annotated[Span, Tag("<span>")] | Annotated[Normal, Tag("<normal>")],
    Discriminator(lambda value: "<normal>" if isinstance(value, Normal) else _form(value)),
]


def _rounded(numbers: np.ndarray) -> tuple[float, ...]:
    return tuple(float(f"{x:.{DIGITS}g}") for x in numbers)


def listed(key: str, value: Any) -> tuple[Any, ...]:
    """The values of a list, or of a range."""
    if isinstance(value, list | tuple):
        return tuple(value)
    if not isinstance(value, dict):
        refuse_key(key, "must be a list of values, or { from, to, count, spacing }")
    if unknown := [name for name in value if name not in ("from", "to", "count", "spacing")]:
        refuse_key(key, f"a range has from, to, count and spacing, and not {unknown[0]}")
    try:
        values = Range.model_validate(value).values
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        message = "is missing" if first["type"] == "missing" else first["msg"]
        refuse_key(key, f"{place}: {message[0].lower()}{message[1:]}" if place else message)
    if key.rpartition(".")[2] not in whole_numbers():
        return values
    if broken := [number for number in values if not number.is_integer()]:
        refuse_key(key, f"must be whole numbers, and this range has {broken[0]}")
    return tuple(map(int, values))


def refuse_key(key: str, limit: str) -> NoReturn:
    """Raise what pydantic makes an error of that key."""
    raise PydanticCustomError("unknown_key", "{limit}", {"key": f'"{key}"' if "." in key else key, "limit": limit})
