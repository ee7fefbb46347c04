"""What the tables of a study file are made of: numbers with ranges and units, names, and the table itself."""

from __future__ import annotations

import difflib
import math
import unicodedata
from typing import Annotated, Any, NamedTuple

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainSerializer,
    StringConstraints,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError


class Unit(NamedTuple):
    """The unit of a number, for the docs and for messages."""

    symbol: str


# Numbers whose squares and cubes are numbers, too; what somebody divides by is not next to nothing.
SMALLEST, LARGEST = 1e-20, 1e20
DEEPEST = 1e5  # [m]; deeper water is infinitely deep


def _divisible(value: float) -> float:
    if value < SMALLEST:
        raise PydanticCustomError("too_small", "{least}", {"least": SMALLEST})
    return value


def _fathomable(value: float) -> float:
    if DEEPEST < value < math.inf:
        raise PydanticCustomError("too_deep", "{deepest}", {"deepest": DEEPEST})
    return value


Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST, le=LARGEST)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=LARGEST)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0, le=LARGEST), AfterValidator(_divisible)]
# TOML has inf, JSON has not.
Depth = Annotated[
    float,
    Field(strict=True, gt=0),
    AfterValidator(_divisible),
    AfterValidator(_fathomable),
    PlainSerializer(lambda v: "inf" if math.isinf(v) else v, when_used="json"),
]
Count = Annotated[int, Field(strict=True, ge=1, le=10_000)]
Flag = Annotated[bool, Field(strict=True)]
Vector = tuple[Number, Number, Number]


def _one_line(text: str) -> str:
    if any(unicodedata.category(letter) == "Cc" for letter in text):
        raise PydanticCustomError("control_character", "in a line")
    return text


Title = Annotated[str, StringConstraints(strict=True, max_length=200), AfterValidator(_one_line)]
Name = Annotated[str, StringConstraints(strict=True, max_length=100, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.:-]*$")]
# A year is a fine label, and TOML reads it as a number.
Label = Annotated[Name, BeforeValidator(lambda v: str(v) if type(v) is int else v)]
Seed = Annotated[int, Field(strict=True, ge=0, lt=2**63)]


def _shortest(given: float | tuple[float, ...]) -> float | tuple[float, ...]:
    """One spelling for one meaning: a list of one is its number, a list of zeros is zero."""
    if isinstance(given, tuple) and (len(given) == 1 or not any(given)):
        return given[0]
    return given


def _one_or_many(given: Any) -> str:
    return "<many>" if isinstance(given, list | tuple) else "<one>"


# A number for a joint's only axis, or a list with one for each.
PerAxis = Annotated[
    Annotated[NotNegative, Tag("<one>")]
    | Annotated[tuple[NotNegative, ...], Field(min_length=1, max_length=7), Tag("<many>")],
    Discriminator(_one_or_many),
    AfterValidator(_shortest),
]
SignedPerAxis = Annotated[
    Annotated[Number, Tag("<one>")] | Annotated[tuple[Number, ...], Field(min_length=1, max_length=7), Tag("<many>")],
    Discriminator(_one_or_many),
    AfterValidator(_shortest),
]


class Table(BaseModel):
    """One table of a study file: immutable, and an unknown key is an error with a suggestion."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: Any) -> Any:
        for key in data if isinstance(data, dict) else ():
            if key not in cls.model_fields:
                close = difflib.get_close_matches(str(key), cls.model_fields, n=1)
                known = f"did you mean {close[0]}?" if close else f"known: {', '.join(cls.model_fields)}"
                raise PydanticCustomError("unknown_key", "{limit}", {"key": key, "limit": f"unknown key; {known}"})
        return data
