"""The solver's objections to its inputs -> keys of the study file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from pipeline.study.settings import Recording
from solver.errors import InputError, refuse

# First word of a key of the solver's -> where a study file has it.
PLACES = {"band": "waves.band", "components": "waves.components"}


def objections(build: Callable[[], object]) -> Iterator[InputError]:
    """What the solver has against that which `build` makes of a study, under the study file's key."""
    try:
        build()
    except InputError as first:
        for error in (first, *first.others):
            yield InputError(_key(error.key), _as_written(error.value), error.limit)


def _as_written(value: object) -> object:
    """Lists as a study file has them."""
    return [_as_written(item) for item in value] if isinstance(value, tuple) else value


def _key(theirs: str) -> str:
    """settings.time_step -> solver.time_step; band -> waves.band."""
    first, dot, rest = theirs.partition(".")
    if first == "settings":
        table = "record" if rest.partition(".")[0] in Recording.model_fields else "solver"
        return f"{table}.{rest}"
    return PLACES.get(first, first) + dot + rest


@contextmanager
def renamed(name: Callable[[str], str]) -> Iterator[None]:
    """Pass on objections to the solver's keys under the study file's."""
    try:
        yield
    except InputError as first:
        refuse(InputError(name(e.key), e.value, e.limit) for e in (first, *first.others))


def under(place: str, word: str = "") -> AbstractContextManager[None]:
    """Pass on objections to a part, with `place` before the key and without the word that the solver has there."""
    return renamed(lambda key: place + key.removeprefix(word))
