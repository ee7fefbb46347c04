"""From a TOML file to tables of the right types and ranges, or to one clear message."""

from __future__ import annotations

import difflib
import os
import re
import stat
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from pipeline.study.inherit import BASE, merged, rooted
from pipeline.study.schema import StudyFile, shapes, units
from solver.errors import InputError

LIMITS = {
    "greater_than": "must be > {gt}{unit}",
    "greater_than_equal": "must be >= {ge}{unit}",
    "less_than": "must be < {lt}{unit}",
    "less_than_equal": "must be <= {le}{unit}",
    "float_type": "must be a number{of_unit}",
    "too_many_digits": "has too many digits for a number{of_unit}",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be a string",
    "finite_number": "must be a finite number{of_unit}",
    "too_small": "must be >= {least}{unit}",
    "too_large": "must be <= {most}{unit}, or inf",
    "model_type": "must be a table",
    "dict_type": "must be a table",
    "tuple_type": "must be a list",
    "too_short": "must have {min_length} at least",
    "too_long": "must have {max_length} at most",
    "control_character": "must be one line, without control characters",
    "string_too_long": "must have at most {max_length} characters",
    "literal_error": "must be one of {expected}",
    "no_such_word": "must be a number{of_unit}, or {expected}",
    "union_tag_invalid": "must be one of {expected_tags}",
    "unknown_key": "{limit}",
    "string_pattern_mismatch": "must be ASCII letters, digits, '_', '-', '.' or ':', not starting with a sign",
}


COEFFICIENTS = "hydrodynamics"  # the folder beside those of the studies, which share it
MOST_BYTES = 255 - len("-published.csv")  # of a study's name: file systems take 255
LARGEST = 10e6  # bytes of a study file
DEEPEST = 20  # levels of tables in tables
MOST_BASES = 20  # that stand on each other
NEIGHBOURS = 3  # of a file that is none, that are named


class StudyError(Exception):
    """A study that cannot run; every line names file, key, value and limit."""

    def __init__(self, file: Path, problems: Iterable[str]):
        self.problems = [_spelled(f"{file}: {problem}") for problem in problems]
        super().__init__("\n".join(self.problems))


def _spelled(text: str) -> str:
    """With escapes for what would break the line or steer the terminal, as keys and names of files may."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def parsed(path: Path) -> tuple[StudyFile, tuple[Path, ...]]:
    """The content of a study file, and the files that it stands on, nearest first; raise StudyError."""
    tables, bases = stacked(path)
    check_name(path)
    try:
        return StudyFile.model_validate(tables, context={"folder": path.parent}), bases
    except ValidationError as error:
        raise StudyError(path, [describe(e) for e in _apart(error.errors(include_url=False))]) from None


def _apart(errors: list[ErrorDetails]) -> list[ErrorDetails]:
    """Without lists that are too short because none of their items is right, and words that a number might be, too,
    where it is a number out of its range."""
    wrong = {error["loc"][:-1] for error in errors if error["loc"]}
    ranged = {dotted(e["loc"]) for e in errors if not e["type"].endswith(("_type", "_parsing", "_error"))}
    return [
        error
        for error in errors
        if not (error["type"] == "too_short" and error["loc"] in wrong)
        and not (error["type"] == "literal_error" and dotted(error["loc"]) in ranged)
    ]


def check_name(path: Path) -> None:
    """results/<name> must be a folder inside results, and no command may take the name for an option."""
    name = path.stem
    if not (re.match(r"\w", name) and name.isprintable() and "\\" not in name):
        limit = "must start with a letter, a digit or _, and go on without control characters or backslashes"
        raise StudyError(path, [f"name = {name!r}: {limit}, for results are in a folder of that name"])
    if len(os.fsencode(name)) > MOST_BYTES:
        raise StudyError(path, [f"name: must have at most {MOST_BYTES} bytes, for other files are named after it"])
    if name.casefold() == COEFFICIENTS:
        raise StudyError(path, [f"name = {name!r}: is the folder of all studies' coefficients; rename the file"])


def stacked(path: Path, above: tuple[Path, ...] = ()) -> tuple[dict[str, Any], tuple[Path, ...]]:
    """The tables of a file laid over those of its base, and the bases, nearest first."""
    tables = read(path)
    if BASE not in tables:
        return tables, ()
    relative = tables.pop(BASE)
    if not isinstance(relative, str) or not relative:
        raise StudyError(path, [f"{BASE} = {_short(relative)}: must be the path of a study file, relative to this one"])
    base = path.parent / relative
    try:
        if not base.is_file():
            raise StudyError(path, [f"{BASE} = {_short(relative)}: {missing_file(base)}"])
    except OSError as error:
        raise StudyError(path, [f"{BASE} = {_short(relative)}: cannot be read: {error.strerror}"]) from None
    if base.resolve() in (path.resolve(), *above):
        raise StudyError(path, [f"{BASE} = {relative!r}: must be another study file, which does not stand on this one"])
    if len(above) >= MOST_BASES:
        raise StudyError(path, [f"{BASE} = {relative!r}: at most {MOST_BASES} files may stand on each other"])
    below, bases = stacked(base, (*above, path.resolve()))
    return merged(rooted(below, base.parent), tables), (base, *bases)


def read(path: Path) -> dict[str, Any]:
    """The raw tables of one TOML file."""
    try:
        tables = tomllib.loads(_content(path).decode("utf-8-sig"))
    except FileNotFoundError:
        raise StudyError(path, [missing_file(path)]) from None
    except OSError as error:
        raise StudyError(path, [f"cannot be read: {error.strerror}"]) from None
    except UnicodeDecodeError as error:
        raise StudyError(path, [f"is not UTF-8 text (byte {error.start})"]) from None
    except tomllib.TOMLDecodeError as error:
        raise StudyError(path, [f"is not valid TOML: {error}"]) from None
    except RecursionError:
        raise StudyError(path, ["is not valid TOML: nested too deeply"]) from None
    except ValueError as error:  # a number of thousands of digits
        raise StudyError(path, [f"is not valid TOML: {str(error).partition(':')[0]}"]) from None
    if _depth(tables) > DEEPEST:
        raise StudyError(path, [f"is not a study: tables are nested more than {DEEPEST} deep"])
    return tables


def _content(path: Path) -> bytes:
    """The bytes of a file that is one, and no device or pipe without an end."""
    info = path.stat()
    if not stat.S_ISREG(info.st_mode):
        raise StudyError(path, ["cannot be read: is no regular file"])
    if info.st_size > LARGEST:
        raise StudyError(path, [f"cannot be read: has {info.st_size / 1e6:.0f} MB, {LARGEST / 1e6:g} MB at most"])
    return path.read_bytes()


def _depth(tables: Any) -> int:
    """How many tables and lists are in each other; not by recursion, which has its own limit."""
    depth, layer = 0, [tables]
    while layer:
        depth += 1
        inner = (v.values() if isinstance(v, dict) else v if isinstance(v, list) else () for v in layer)
        layer = [item for items in inner for item in items]
    return depth


def missing_file(path: Path) -> str:
    """A folder; or no such file, and those that there are with the nearest names."""
    if path.is_dir():
        return "is a folder"
    folder = path.parent
    there = sorted(p.name for p in folder.glob("*.toml")) if folder.is_dir() else []
    near = difflib.get_close_matches(path.name, there, n=NEIGHBOURS, cutoff=0.0)
    more = f" and {len(there) - len(near)} others" if len(there) > len(near) else ""
    return "no such file" + (f"; {folder} has {', '.join(near)}{more}" if near else "")


def describe(error: ErrorDetails) -> str:
    """One line for a pydantic error: key = value: limit."""
    context = error.get("ctx", {})
    parts = list(error["loc"])
    value: Any = error["input"]
    if error["type"] == "unknown_key" and context["key"]:
        parts, value = [*parts, context["key"]], value.get(context["key"].strip('"'))
    if error["type"].startswith("union_tag"):
        tag = context["discriminator"].strip("_'()")
        parts, value = [*parts, tag], value.get(tag) if isinstance(value, dict) else value
    key = dotted(parts)
    if error["type"] in ("missing", "union_tag_not_found"):
        return f"{key}: is missing{_unit(parts, ' [{}]')}"
    return str(InputError(key, _short(value), limit_of(error)))


def limit_of(error: ErrorDetails) -> str:
    """What a pydantic error says of the value, without key and value."""
    details: dict[str, Any] = error.get("ctx", {})
    context = {k: f"{v:g}" if isinstance(v, float) else v for k, v in details.items()}
    parts = error["loc"]
    if error["type"] in ("missing", "union_tag_not_found"):
        return f"needs {dotted(parts)}"
    unit, of_unit = _unit(parts, " {}"), _unit(parts, " [{}]")
    kind = "no_such_word" if error["type"] == "literal_error" and "<word>" in parts else error["type"]
    kind = "too_many_digits" if kind == "float_type" and type(error["input"]) is int else kind
    limit = LIMITS.get(kind, "{msg}").format(msg=error["msg"], unit=unit, of_unit=of_unit, **context)
    return limit.replace("<", "").replace(">", "") if error["type"] == "union_tag_invalid" else limit


def dotted(parts: Iterable[int | str]) -> str:
    """floats[0].hull.radius; the tag of a union (the hull's shape, or in angle brackets) is no key and left out."""
    tags = {*shapes(), "keys", "[key]"}
    text = ""
    for part in parts:
        if isinstance(part, int):
            text += f"[{part}]"
        elif part not in tags and not part.startswith(("<", "constrained-", "literal[")):
            quoted = f'"{part}"' if "." in part and not part.startswith('"') else part
            text += f".{quoted}" if text else quoted
    return text


def _unit(parts: Iterable[int | str], pattern: str) -> str:
    """The unit of the last named key, if it has one."""
    named = [p for p in parts if isinstance(p, str) and not p.startswith("<")]
    symbol = units().get(named[-1] if named else "", "-")
    return "" if symbol == "-" else pattern.format(symbol)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
