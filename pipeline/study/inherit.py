"""A study that stands on another: base = "buan.toml", and below it only what differs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

Tables = dict[str, Any]
BASE = "base"
FILES = ("file", "coefficients")  # keys that name files
KINDS = ("shape", "kind")  # keys that decide which others a table has
FORMS = ({"from", "to"}, {"mean", "std"})  # of ranges, which their keys tell apart


def merged(base: Any, upper: Any) -> Any:
    """Tables key by key, lists of named tables name by name; all else, and a table of another kind, is replaced."""
    if isinstance(base, dict) and isinstance(upper, dict) and not _replaces(base, upper):
        return base | {key: merged(base[key], value) if key in base else value for key, value in upper.items()}
    if _named(base) and _named(upper):
        mine = {item["name"]: item for item in upper}
        twice = [item for item in upper if mine[item["name"]] is not item]  # kept, so that the schema refuses them
        both = [merged(item, mine.pop(item["name"], {})) for item in base]
        return both + list(mine.values()) + twice
    return upper


def _replaces(base: Mapping[str, Any], upper: Mapping[str, Any]) -> bool:
    """Whether a table is of another kind, or form, than one of a file, where a sea with an Hs may not say its kind."""
    said = {"kind": "irregular"} | dict(base) if "Hs" in base else base
    one, other = FORMS
    mixed = any(base.keys() & a and upper.keys() & b for a, b in ((one, other), (other, one)))
    return mixed or of_another_kind(said, upper)


def of_another_kind(base: Mapping[str, Any], upper: Mapping[str, Any]) -> bool:
    """Whether both say in a word what they are, and not the same: a cone has no use for a sphere's draft."""
    return any(isinstance(upper.get(key), str) and upper[key] != base.get(key, upper[key]) for key in KINDS)


def _named(value: Any) -> bool:
    return (
        isinstance(value, list)
        and bool(value)
        and all(isinstance(v, dict) and isinstance(v.get("name"), str) for v in value)
    )


def rooted(value: Any, folder: Path) -> Any:
    """Tables in which the paths of files, relative to `folder`, are absolute."""
    if isinstance(value, dict):
        return {
            k: _rooted_path(v, folder) if k.rpartition(".")[2] in FILES else rooted(v, folder) for k, v in value.items()
        }
    return [rooted(item, folder) for item in value] if isinstance(value, list) else value


def _rooted_path(value: Any, folder: Path) -> Any:
    """Of a file, or of several along an axis."""
    if isinstance(value, list):
        return [_rooted_path(item, folder) for item in value]
    return str((folder / value).absolute()) if isinstance(value, str) and value else value
