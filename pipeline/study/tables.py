"""What the tables of a study file are made of: numbers with ranges and units, names, and the table itself."""

from __future__ import annotations

import dataclasses
import difflib
import math
import unicodedata
from collections.abc import Callable, Collection, Iterator
from copy import copy
from types import UnionType
from typing import Annotated, Any, Generic, Literal, NamedTuple, TypeVar, Union, get_args, get_origin, get_type_hints

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    PlainSerializer,
    StringConstraints,
    Tag,
    WithJsonSchema,
    create_model,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError

from solver.quantities import PerAxis, Quantity, meanings, quantities


class Unit(NamedTuple):
    """The unit of a number, for the docs and for messages."""

    symbol: str


# Numbers whose squares and cubes are numbers, too; what somebody divides by is not next to nothing.
SMALLEST, LARGEST = 1e-20, 1e20
DEEPEST = 1e5  # [m]; deeper water is infinitely deep


def divisible(value: float) -> float:
    """A number that is not next to nothing."""
    if value < SMALLEST:
        raise PydanticCustomError("too_small", "{least}", {"least": SMALLEST})
    return value


def _up_to(most: float) -> AfterValidator:
    """Of a number that is no more than that, or infinite."""

    def judged(value: float) -> float:
        if most < value < math.inf:
            raise PydanticCustomError("too_large", "{most}", {"most": most})
        return value

    return AfterValidator(judged)


Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST, le=LARGEST)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=LARGEST)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0, le=LARGEST), AfterValidator(divisible)]
# TOML has inf, JSON has not.
Infinite = PlainSerializer(lambda v: "inf" if math.isinf(v) else v, when_used="json")
Depth = Annotated[float, Field(strict=True, gt=0), AfterValidator(divisible), _up_to(DEEPEST), Infinite]
MOST = 10_000  # of anything that is counted
Count = Annotated[int, Field(strict=True, ge=1, le=MOST)]
Flag = Annotated[bool, Field(strict=True)]
Vector = tuple[Number, Number, Number]


def word_or_number(value: Any) -> str:
    """The tag of a number, or of a word in its place."""
    return "<word>" if isinstance(value, str) else "<number>"


# Numbers, or the word for one that is found from weight and buoyancy.
Balance = Annotated[Literal["balance"], Tag("<word>")]
FoundMass = Annotated[Annotated[Positive, Tag("<number>")] | Balance, Discriminator(word_or_number)]
FoundPlace = Annotated[Annotated[Number, Tag("<number>")] | Balance, Discriminator(word_or_number)]


def _one_line(text: str) -> str:
    if any(unicodedata.category(letter) == "Cc" for letter in text):
        raise PydanticCustomError("control_character", "in a line")
    return text


Title = Annotated[str, StringConstraints(strict=True, max_length=200), AfterValidator(_one_line)]
NAME = r"^[A-Za-z0-9_][A-Za-z0-9_.:-]*$"
Name = Annotated[str, StringConstraints(strict=True, max_length=100, pattern=NAME)]
# A year is a fine label, and TOML reads it as a number.
Label = Annotated[
    Name,
    BeforeValidator(lambda v: str(v) if type(v) is int else v),
    WithJsonSchema({"type": ["string", "integer"], "pattern": NAME, "maxLength": 100}),
]
Seed = Annotated[int, Field(strict=True, ge=0, lt=2**63)]


def _shortest(value: float | tuple[float, ...]) -> float | tuple[float, ...]:
    """A list of one is that number, a list of zeros is zero: one meaning, one identity."""
    if isinstance(value, tuple) and (len(value) == 1 or not any(value)):
        return value[0]
    return value


def _one_or_many(value: Any) -> str:
    return "<many>" if isinstance(value, list | tuple) else "<one>"


def unit_of(field: FieldInfo) -> str:
    """The symbol beside a key's type; "-" for what has none."""
    return next((mark.symbol for mark in field.metadata if isinstance(mark, Unit)), "-")


def meaning_of(field: FieldInfo) -> str:
    """The words beside a key's type."""
    return next((mark for mark in field.metadata if isinstance(mark, str)), "")


ANSWERS = {  # to keys with these parts, which no table has though people look for them
    "spread": 'waves are long-crested, and a sea has one heading: several are an axis, "waves.heading" = [...]',
}


def answer(key: str) -> str:
    """What to say of a key that people look for; nothing of others."""
    return next((words for part, words in ANSWERS.items() if part in key), "")


class Table(BaseModel):
    """One table of a study file: immutable, and an unknown key is an error with a suggestion."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: Any) -> Any:
        names = [field.alias or name for name, field in cls.model_fields.items()]
        for key in data if isinstance(data, dict) else ():
            if key not in names:
                there = [name for name in names if name != "keys"]  # which holds paths, and is none itself
                close = difflib.get_close_matches(str(key), there, n=1)
                others = ', and any other by its dotted path in quotes, "solver.method"' if "keys" in names else ""
                known = f"did you mean {close[0]}?" if close else f"known: {', '.join(there)}{others}"
                limit = f"unknown key; {answer(str(key)) or known}"
                raise PydanticCustomError("unknown_key", "{limit}", {"key": key, "limit": limit})
        return data

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """With the meaning and the unit of each key: what stands beside its type, as text and as Unit."""
        reference = handler(core_schema)
        properties = handler.resolve_ref_schema(reference).get("properties", {})
        for name, field in cls.model_fields.items():
            told = {"description": meaning_of(field), "x-unit": unit_of(field)}
            shown = field.alias or name
            properties[shown] = properties[shown] | {key: text for key, text in told.items() if text}
        return reference


def tables(above: type[Table] = Table) -> Iterator[type[Table]]:
    """All tables of study files."""
    for table in above.__subclasses__():
        yield table
        yield from tables(table)


def whole_numbers() -> frozenset[str]:
    """Keys that are whole numbers; a key means the same in every table."""
    fields = (pair for table in tables() for pair in table.model_fields.items())
    return frozenset(key for key, field in fields if _is_whole(field.annotation))


def _is_whole(kind: Any) -> bool:
    return kind is int or any(map(_is_whole, get_args(kind)))


T = TypeVar("T", bound=Table)


class Same(Generic[T]):
    """A table that equals itself alone, as the key of a cache: to compare two of them whole would cost too much."""

    def __init__(self, table: T):
        self.table = table

    def __hash__(self) -> int:
        return id(self.table)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and self.table is other.table


def fields_of(inputs: type, names: Collection[str] = ()) -> Callable[[type[T]], type[T]]:
    """Complete a table with the fields of the solver's inputs, all or those named.

    Name, default, unit, range and meaning are the solver's. A field that the table declares keeps its type; one
    under TYPE_CHECKING is there for the pipeline's eyes alone.
    """

    def complete(table: type[T]) -> type[T]:
        hints = get_type_hints(inputs)
        made: dict[str, Any] = {}
        for field in dataclasses.fields(inputs):
            if not names or field.name in names:
                quantity = quantities(inputs).get(field.name, Quantity())
                declared = table.model_fields.get(field.name)
                info = copy(declared) if declared else FieldInfo.from_annotation(_strict(hints[field.name], quantity))
                said = [meanings(inputs)[field.name]] if field.name in meanings(inputs) else []
                info.metadata = [*info.metadata, *said, Unit(quantity.unit)]
                made[field.name] = (info.annotation, FieldInfo.merge_field_infos(info, **_default(field)))
        return create_model(table.__name__, __base__=table, __doc__=table.__doc__, __module__=table.__module__, **made)

    return complete


def _default(field: dataclasses.Field[Any]) -> dict[str, Any]:
    return {} if field.default is dataclasses.MISSING else {"default": field.default}


def _strict(hint: Any, quantity: Quantity) -> Any:
    """A type of the solver's as a file must give it: no word and no flag is taken for a number."""
    if hint is float and quantity.infinite:
        bounds = {name: bound for name, bound in _bounds(quantity, real=True).items() if name in ("gt", "ge")}
        return Annotated[float, Field(strict=True, **bounds), AfterValidator(divisible), _up_to(LARGEST), Infinite]
    if hint in (float, int):
        number = Annotated[hint, Field(strict=True, **_bounds(quantity, real=hint is float))]
        return Annotated[number, AfterValidator(divisible)] if hint is float and quantity.above == 0 else number
    if hint is bool:
        return Flag
    if hint == PerAxis:
        return _per_axis(_strict(float, quantity))
    if get_origin(hint) in (None, Literal):
        return hint
    inner = tuple(_strict(each, quantity) for each in get_args(hint))
    return Union.__getitem__(inner) if get_origin(hint) in (Union, UnionType) else get_origin(hint)[inner]


def _bounds(quantity: Quantity, *, real: bool) -> dict[str, Any]:
    """Bounds of the quantity; where it has none, those of all numbers."""
    bounds = {"gt": quantity.above, "ge": quantity.least, "lt": quantity.below, "le": quantity.most}
    limits = {name: bound for name, bound in bounds.items() if bound is not None}
    low = {} if limits.keys() & {"gt", "ge"} or not real else {"ge": -LARGEST}
    high = {} if limits.keys() & {"lt", "le"} else {"le": LARGEST if real else MOST}
    return limits | low | high | ({"allow_inf_nan": False} if real else {})


def _per_axis(number: Any) -> Any:
    """A number, or a list with one for each axis."""
    one = Annotated[number, Tag("<one>")]
    many = Annotated[tuple[number, ...], Field(min_length=1, max_length=7), Tag("<many>")]
    return Annotated[one | many, Discriminator(_one_or_many), AfterValidator(_shortest)]
