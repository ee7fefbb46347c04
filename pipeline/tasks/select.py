"""Parts of a study: platform=fixed,seed=0..3; an axis named twice means either value, two dots all numbers between."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence

from pipeline.study.reading import StudyError
from pipeline.tasks.study import Study
from pipeline.tasks.task import Label, axes, dimension
from pipeline.tasks.tasklist import Tasks


def select(study: Study, text: str) -> Tasks:
    """The tasks, each once, whose labels are all among those asked for."""
    if not text:
        return study.tasks.unique
    chosen = Tasks.of(study.content, _wanted(study, text)).unique
    if not len(chosen):
        raise StudyError(study.path, [f"--select = {text}: the variants have no such task; their axes say which"])
    return chosen


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


def _wanted(study: Study, text: str) -> dict[str, set[Label]]:
    table = axes(study.content)
    wanted: dict[str, set[Label]] = {}
    for pair in _pairs(text):
        axis, equals, word = (part.strip() for part in pair.partition("="))
        if not equals:
            raise StudyError(
                study.path, [f"--select = {pair}: must be axis=value,axis=value, an axis again for each value"]
            )
        axis = dimension(study.content, axis)
        if axis not in table:
            raise StudyError(study.path, [f"--select = {axis}: unknown axis; {_suggest(axis, list(table))}"])
        wanted.setdefault(axis, set()).update(_labels(study, axis, word, table[axis]))
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


def _labels(study: Study, axis: str, word: str, known: Sequence[Label]) -> list[Label]:
    named = [x for x in known if str(x) == word or (not isinstance(x, str) and _number(word) == x)]
    least, dots, most = word.partition("..")
    low, high = _number(least or "-inf"), _number(most or "inf")
    if dots and not named and low is not None and high is not None:
        named = [x for x in known if not isinstance(x, str) and low <= x <= high]
    if named:
        return named
    raise StudyError(
        study.path,
        [f"--select = {axis}={word}: no such value; {_suggest(word, [str(v) for v in known])}"],
    )


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _suggest(word: str, known: list[str]) -> str:
    close = difflib.get_close_matches(word, known, n=1)
    return f"did you mean {close[0]}?" if close else f"known: {', '.join(known)}"
