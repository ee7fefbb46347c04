"""Parts of a study: platform=fixed,sea_state=2018,seed=0; a key given twice means either value."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

from pipeline.study import Study, StudyError
from pipeline.tasks import Label, Task, axes


def select(study: Study, tasks: Iterable[Task], text: str) -> list[Task]:
    """The tasks whose labels are all among those asked for."""
    wanted = _wanted(study, text) if text else {}
    return [t for t in tasks if all(t.labels[axis] in values for axis, values in wanted.items())]


def find(study: Study, tasks: Sequence[Task], words: Iterable[str]) -> list[Task]:
    """Tasks by id, by the beginning of an id, or by labels."""
    found: dict[str, Task] = {}
    for word in words:
        by_id = (task for task in tasks if task.id.startswith(word))
        ids = {task.id: task for task in (select(study, tasks, word) if "=" in word else by_id)}
        if not ids:
            raise StudyError(study.path, [f"task = {word}: no such task; `study plan {study.path}` lists them"])
        if len(ids) > 1 and "=" not in word:
            raise StudyError(study.path, [f"task = {word}: {len(ids)} tasks begin so; give more digits"])
        found |= ids
    return list(found.values())


def _wanted(study: Study, text: str) -> dict[str, set[Label]]:
    table = axes(study.content)
    wanted: dict[str, set[Label]] = {}
    for pair in text.split(","):
        axis, equals, word = (part.strip() for part in pair.partition("="))
        if not equals:
            raise StudyError(study.path, [f"--select = {pair}: must be axis=value,axis=value"])
        if axis not in table:
            raise StudyError(study.path, [f"--select = {axis}: unknown axis; {_suggest(axis, list(table))}"])
        wanted.setdefault(axis, set()).add(_label(study, axis, word, table[axis]))
    return wanted


def _label(study: Study, axis: str, word: str, known: Sequence[Label]) -> Label:
    for label in known:
        if str(label) == word or (not isinstance(label, str) and _number(word) == label):
            return label
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
