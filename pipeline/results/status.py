"""status.json of a task, read strictly: a file of another shape counts as absent."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import from_json

NUMBER = re.compile(r"(?<![\w.])[+-]?\d+(\.\d+)?([eE][+-]?\d+)?(?!\w)")  # and no part of a name
MANY, FEW = 20, 3  # reasons that are told, and tasks of each that are named
# A simulated or measured time [s].
Seconds = Annotated[float, Field(ge=0.0)]


class _Shape(BaseModel):
    """A key that is known must have its type; others are ignored, for they come and go with the versions."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore", allow_inf_nan=False)


class Error(_Shape):
    """Why a task failed."""

    kind: str
    message: str
    traceback: str


class Length(_Shape):
    """Lengths of the simulated time [s]; the defaults are those of a study file."""

    duration: Annotated[float, Field(gt=0.0)] = 3600.0
    discard: Seconds = 100.0

    @property
    def total(self) -> float:
        """From start to end [s]."""
        return self.duration + self.discard


class Method(_Shape):
    """How a task is solved."""

    method: str = "time"


class KeptParameters(_Shape):
    """Those of a task's parameters that estimates of time need."""

    record: Length = Length()
    solver: Method = Method()


class Status(_Shape):
    """What is kept of a task beside its record; the defaults describe a task that is missing."""

    id: str = ""
    state: Literal["done", "failed", "missing"] = "missing"
    bytes: int = -1
    sha256: str = ""
    content: str = ""
    finished: str = ""
    wall_time: Seconds = 0.0
    labels: dict[str, str | int | float] = {}
    provenance: dict[str, str] = {}
    command: str = ""
    log: tuple[str, ...] = ()
    unmet: str = ""  # what was asked for and not met, in a sentence
    warnings: str = ""  # what is odd about it, in sentences
    parameters: KeptParameters = KeptParameters()
    error: Error | None = None

    @model_validator(mode="after")
    def _failed_for_a_reason(self) -> Self:
        if self.state == "failed" and self.error is None:
            raise ValueError("failed without an error")
        return self


MISSING = Status()


def without_numbers(words: str) -> str:
    """Words of which those of other tasks may differ in numbers alone."""
    return NUMBER.sub("", words)


def read_status(path: Path) -> Status:
    """The content of a status.json; that of a missing task if it is absent, damaged or of another shape."""
    try:
        return parsed(path.read_bytes())
    except OSError:
        return MISSING


def parsed(text: bytes) -> Status:
    """What a status.json or a line of a pack says; that of a missing task if it is of another shape."""
    try:
        return Status.model_validate_json(text)
    except ValueError:
        return MISSING


def read_json(path: Path) -> dict[str, Any] | None:
    """The content of a JSON file, None if it is not there or not whole."""
    try:
        data = from_json(path.read_bytes(), allow_inf_nan=False)
    except (OSError, ValueError):
        return None
    return data if isinstance(data, dict) else None
