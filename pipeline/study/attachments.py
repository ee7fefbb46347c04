"""Files that a study file names: read once, known by their content, carried along with the parameters.

Workers share no disk with the client, so a task has its files in it, packed. Its identity holds the
SHA-256 of the content and not the path: a file may move, and may not change unnoticed.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, InstanceOf, PlainSerializer, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

LARGEST = 100e6  # bytes; a larger file would clog the way to the workers
WAMIT = (".1", ".2", ".3", ".3fk", ".hst")  # files of one run of WAMIT, which differ in this alone
# Files of one run of Nemoh; the last lies in the folder above.
NEMOH = ("RadiationCoefficients.tec", "ExcitationForce.tec", "FKForce.tec", "Nemoh.cal")


@dataclass(frozen=True, kw_only=True)
class Attachment:
    """A file's content; two are equal if their contents are."""

    name: str = field(compare=False)  # as the study file gives it, relative to the study file
    digest: str  # SHA-256 of the content
    packed: bytes = field(compare=False, repr=False)

    @classmethod
    def of(cls, name: str, data: bytes) -> Attachment:
        """From content in memory."""
        return cls(name=name, digest=hashlib.sha256(data).hexdigest(), packed=zlib.compress(data))

    @property
    def data(self) -> bytes:
        """The content."""
        return zlib.decompress(self.packed)

    @property
    def identity(self) -> str:
        """What stands for the file in a task's identity."""
        return f"sha256:{self.digest}"

    def __str__(self) -> str:
        return self.name


def _attach(value: Any, info: ValidationInfo) -> Any:
    """Read the file of a path, relative to the folder in the context of the validation."""
    if isinstance(value, Attachment):
        return value
    if not isinstance(value, str) or not value:
        raise PydanticCustomError("file", "must be the path of a file, relative to the study file")
    path = (info.context or {}).get("folder", Path()) / value
    try:
        if not path.is_file():
            limit = "is a folder" if path.is_dir() else "no such file"
            raise PydanticCustomError("file", "{limit}", {"limit": f"{limit}: {path}"})
        if (size := path.stat().st_size) > LARGEST:
            limit = f"must be at most {LARGEST / 1e6:g} MB, is {size / 1e6:.0f} MB"
            raise PydanticCustomError("file", "{limit}", {"limit": limit})
        return Attachment.of(value, path.read_bytes())
    except OSError as error:
        raise PydanticCustomError("file", "{limit}", {"limit": f"cannot be read: {error.strerror}"}) from None


def _attach_with_others(value: Any, info: ValidationInfo) -> Any:
    """The file of a path, and where its name is one of WAMIT's or Nemoh's the others of the same run, as one text."""
    named = _attach(value, info)
    if isinstance(value, Attachment) or not (others := _of_one_run(value)):
        return named
    folder = (info.context or {}).get("folder", Path())
    there = {part: str(path) for part, path in others.items() if (folder / path).is_file()}
    texts = {part: _attach(path, info) if path != value else named for part, path in there.items()}
    whole = json.dumps({part: texts[part].data.decode("latin-1") for part in sorted(texts)})
    return Attachment.of(value, whole.encode())


def _of_one_run(value: str) -> dict[str, Path]:
    """Where the files of a run lie by what they are, this one among them; none where one file says all."""
    path = Path(value)
    if (kind := path.suffix.lower()) in WAMIT:
        return {part: path.with_suffix(part) for part in WAMIT} | {kind: path}
    if path.name in NEMOH:
        *tables, case = NEMOH
        return {name: path.with_name(name) for name in tables} | {case: path.parent / ".." / case}
    return {}


# The type of a key that names a file.
AS_PATH = WithJsonSchema({"type": "string", "format": "path", "minLength": 1})
File = Annotated[
    InstanceOf[Attachment],
    BeforeValidator(_attach),
    PlainSerializer(lambda attachment: attachment.identity, return_type=str),
    AS_PATH,
]
# The same for coefficients, which some programs spread over several files.
CoefficientFile = Annotated[
    InstanceOf[Attachment],
    BeforeValidator(_attach_with_others),
    PlainSerializer(lambda attachment: attachment.identity, return_type=str),
    AS_PATH,
]
