"""Values and keys in words: labels of axes, what a file has of a value, dotted paths."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

LAST = re.compile(r"[^.]*(\.\d+)*$")


def labels(values: tuple[Any, ...]) -> tuple[str | float | int, ...]:
    """Numbers as they are; where one is none, words for all of them."""
    return values if all(map(_is_number, values)) else tuple(map(word, values))


def told(value: Any) -> str | float | int:
    """A value by itself, as a file has it: a number, or a word."""
    return value if _is_number(value) else word(value)


def word(value: Any) -> str:
    """Of anything: true, 0.5, [1.0, 2.0]."""
    return json.dumps(value, default=str) if isinstance(value, bool | list | tuple | dict) else str(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def last(path: str) -> str:
    """The key at the end of a path, with the place in its list: Hs, hinge.0."""
    found = LAST.search(path)
    return found[0] if found else path


def by_path(table: Mapping[str, Any], above: str = "", *, ranges: bool = False) -> Iterator[tuple[str, Any]]:
    """Tables in tables as dotted paths; or all but those that are ranges. A path may come twice, written both ways."""
    for key, value in table.items():
        if isinstance(value, dict) and not (ranges and value.keys() & {"from", "mean"}):
            yield from by_path(value, f"{above}{key}.", ranges=ranges)
        else:
            yield f"{above}{key}", value
