"""Parts of a study: platform=fixed,seed=0..3; what is named twice may have either value, two dots mean all between."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

import numpy as np

from pipeline.study.reading import StudyError
from pipeline.tasks.study import Study
from pipeline.tasks.task import Coordinate, Label, coordinates
from pipeline.tasks.tasklist import Tasks


def select(study: Study, text: str) -> Tasks:
    """The tasks, each once, that have one of the values asked for along each coordinate that is named."""
    if not text:
        return study.tasks.unique
    tasks = Tasks.unnamed(study.content)
    kept = np.ones(len(tasks), bool)
    for (_, along, values), wanted in _wanted(study, text).items():
        kept &= np.isin(tasks.places(along), [place for place, value in enumerate(values) if value in wanted])
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
            raise StudyError(study.path, [f"task = {word}: no such task; `study plan {study.path}` lists them"])
        if len(ids) > 1 and "=" not in word:
            raise StudyError(study.path, [f"task = {word}: {len(ids)} tasks begin so; give more digits"])
        chosen |= ids
    return chosen


def _wanted(study: Study, text: str) -> Mapping[Coordinate, Set[Label]]:
    known = coordinates(study.content)
    wanted: dict[Coordinate, set[Label]] = {}
    for pair in _pairs(text):
        name, equals, word = (part.strip() for part in pair.partition("="))
        if not equals:
            raise StudyError(
                study.path, [f"--select = {pair}: must be axis=value,axis=value, an axis again for each value"]
            )
        if name not in known:
            raise StudyError(study.path, [f"--select = {name}: unknown axis; {_suggest(name, list(known))}"])
        wanted.setdefault(known[name], set()).update(_values(study, name, word, known[name].values))
    return wanted


def _pairs(text: str) -> Iterator[str]:
    """What commas part, but for those of lists in brackets."""
    depth = start = 0
    for at, letter in enumerate(text):
        depth += (letter == "[") - (letter == "]")
        if letter == "," and depth <= 0:
            yield text[start:at]
            start = at + 1
    yield text[start:]


def _values(study: Study, name: str, word: str, known: Sequence[Label]) -> list[Label]:
    named = [x for x in known if str(x) == word or (not isinstance(x, str) and _number(word) == x)]
    least, dots, most = word.partition("..")
    low, high = _number(least or "-inf"), _number(most or "inf")
    if dots and not named and low is not None and high is not None:
        named = [x for x in known if not isinstance(x, str) and low <= x <= high]
    if named:
        return named
    raise StudyError(
        study.path,
        [f"--select = {name}={word}: no such value; {_suggest(word, [str(v) for v in known])}"],
    )


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _suggest(word: str, known: list[str]) -> str:
    close = difflib.get_close_matches(word, known, n=1)
    return f"did you mean {close[0]}?" if close else f"known: {', '.join(known)}"
