"""Parts of a study: platform=fixed,seed=0..3; what is named twice may have either value, two dots mean all between."""

from __future__ import annotations

import difflib
import math
import shlex
from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal

import numpy as np

from pipeline.study import seas
from pipeline.study.paths import PathError, keys_at
from pipeline.study.reading import StudyError
from pipeline.study.schema import StudyFile
from pipeline.tasks.study import Study
from pipeline.tasks.task import Coordinate, Label, coordinates
from pipeline.tasks.tasklist import Tasks

FEWEST_DIGITS = 3  # of a number that stands for a longer one
MOST_LISTED = 20  # values in a message


def select(study: Study, text: str) -> Tasks:
    """The tasks, each once, that have one of the values asked for of each coordinate that is named."""
    if not text:
        return study.tasks.unique
    tasks = Tasks.unnamed(study.content)
    chosen: dict[str, np.ndarray] = {}
    for name, word in _asked(study, text):
        key, values, places = _coordinate(study, tasks, name)
        wanted = _values(study, name, word, [value for value in values if value is not None])
        having = np.isin(places, [place for place, value in enumerate(values) if value in wanted])
        chosen[key] = chosen[key] | having if key in chosen else having
    kept = np.logical_and.reduce([*chosen.values()])
    if not kept.any():
        raise StudyError(study.path, [f"--select = {text}: no task has all of that; `study plan` lists them all"])
    return tasks.part(kept).named.unique


def find(study: Study, words: Iterable[str]) -> set[str]:
    """Ids of tasks, from ids, beginnings of ids, or labels."""
    chosen: set[str] = set()
    for word in words:
        if "=" in word:
            ids = {task.id for task in select(study, word)}
        else:
            ids = {task.id for task in study.tasks.passing() if task.id.startswith(word)}
        if not ids:
            plan = shlex.join(["study", "plan", str(study.path)])
            raise StudyError(study.path, [f"task = {word}: no such task; `{plan}` lists them"])
        if len(ids) > 1 and "=" not in word:
            raise StudyError(study.path, [f"task = {word}: {len(ids)} tasks begin so; give more digits"])
        chosen |= ids
    return chosen


def _asked(study: Study, text: str) -> Iterator[tuple[str, str]]:
    for pair in _pairs(text):
        name, equals, word = (part.strip() for part in pair.partition("="))
        if not equals:
            raise StudyError(
                study.path, [f"--select = {pair}: must be axis=value,axis=value, an axis again for each value"]
            )
        yield name, word


def _coordinate(study: Study, tasks: Tasks, name: str) -> tuple[str, Sequence[Label | None], np.ndarray]:
    """What has this name: the name it goes by, its values, and which of them each task (n,) has."""
    known = coordinates(study.content)
    found = {known[name]} if name in known else _of_keys(study.content, name, known)
    if len(found) == 1:
        ((key, along, values),) = found
        return key, values, tasks.places(along)
    if found:
        which = " or ".join(sorted(one.key for one in found))
        raise StudyError(study.path, [f"--select = {name}: goes along several axes; name one: {which}"])
    met = [seas.labels(*sea) for sea in tasks.seas.each]
    if not any(name in numbers for numbers in met):
        others = list(dict.fromkeys([*known, *(key for numbers in met for key in numbers)]))
        raise StudyError(study.path, [f"--select = {name}: unknown axis; {_suggest(name, others)}"])
    return name, [numbers.get(name) for numbers in met], tasks.seas.places


def _of_keys(content: StudyFile, path: str, known: Mapping[str, Coordinate]) -> set[Coordinate]:
    """Coordinates of keys that a path stands for, too, however it is written."""
    reached = _reached(content, path)
    return {one for other, one in known.items() if reached & _reached(content, other)}


def _reached(content: StudyFile, path: str) -> set[tuple[str, ...]]:
    try:
        return set(keys_at(content, path)) if "." in path else set()
    except PathError:
        return set()


def _pairs(text: str) -> Iterator[str]:
    """What commas part, but for those of lists in brackets."""
    depth = start = 0
    for at, letter in enumerate(text):
        depth += (letter == "[") - (letter == "]")
        if letter == "," and depth <= 0:
            yield text[start:at]
            start = at + 1
    yield text[start:]


def _values(study: Study, name: str, word: str, known: Sequence[Label]) -> Collection[Label]:
    numbers = {x for x in known if not isinstance(x, str)}
    typed = _number(word)
    least, dots, most = word.partition("..")
    low, high = _number(least or "-inf"), _number(most or "inf")
    found: Collection[Label] = {x for x in known if str(x) == word} or {x for x in numbers if x == typed}
    if not found and dots and low is not None and high is not None:
        found = {x for x in numbers if low <= x <= high}
    elif not found and typed is not None and math.isfinite(typed):
        found = alike if len(alike := {x for x in numbers if _agree(word, x)}) == 1 else ()
    if not found:
        raise StudyError(study.path, [f"--select = {name}={word}: no such value; {_offer(word, known)}"])
    return found


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _agree(word: str, number: float) -> bool:
    """Whether a number, rounded or cut to the digits that were typed, three or more, is what was typed."""
    typed, whole = Decimal(word), Decimal(str(number))
    _, digits, exponent = typed.as_tuple()
    last = Decimal((0, (1,), int(exponent)))
    beyond = whole.copy_abs() - typed.copy_abs()
    return len(digits) >= FEWEST_DIGITS and typed * whole > 0 and -last / 2 <= beyond < last


def _offer(word: str, known: Sequence[Label]) -> str:
    """The values as they must be typed; of many numbers those about the one that was."""
    numbers = sorted({x for x in known if not isinstance(x, str)})
    if not numbers:
        return _suggest(word, [str(x) for x in known])
    typed = _number(word.partition("..")[0]) or 0.0
    first = bisect_left(numbers, typed) - MOST_LISTED // 2
    listed = numbers[max(0, min(first, len(numbers) - MOST_LISTED)) :][:MOST_LISTED]
    return f"known{' about there' if len(listed) < len(numbers) else ''}: {', '.join(map(str, listed))}"


def _suggest(word: str, known: Sequence[str]) -> str:
    close = [name for name in known if name.endswith(f".{word}")] or difflib.get_close_matches(word, known, n=1)
    return f"did you mean {' or '.join(close)}?" if close else f"known: {', '.join(known)}"
