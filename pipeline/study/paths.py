"""A study with another value at a dotted path: floats.rear.hull.radius, floats.*.hinge.0, sea.Hs."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from fnmatch import fnmatchcase
from types import MappingProxyType
from typing import Any, NamedTuple, NoReturn, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from pipeline.study.inherit import KINDS, of_another_kind
from pipeline.study.reading import describe, dotted, limit_of
from pipeline.study.schema import StudyFile, units
from pipeline.study.tables import Table, answer
from pipeline.study.words import last

ALL = "*"
LISTS = ("nodes", "foundation")  # of which each is a list, by name
SEA = "sea"  # stands for every sea state that the study has tasks in
PATHS = "keys"  # field of a table that has values of other keys, by their paths
FIXED = ("axes", "title", "variants", "samples")  # what no axis varies
OWN = ("platform", "survival")  # tables by which a study has the tasks that it has: no value brings them in
CONSTANT = {  # keys of tables that no value takes the place of, and why
    "name": "is what others know the part by, and cannot vary",
    "occurrence": "weighs means over sea states, is no part of a task, and cannot vary: give other weights in another"
    " study file, with this one as its base",
}
NONE: Mapping[str, Any] = MappingProxyType({})


class PathError(Exception):
    """A path that leads nowhere, or a value that may not stand there: the limit, and the path where it is another."""

    def __init__(self, limit: str, path: str = ""):
        super().__init__(limit)
        self.path = path


class Put(NamedTuple):
    """What is put at a path: a value, its path as it was written, and the values that come with it, by theirs."""

    value: Any
    path: str
    beside: Mapping[str, Any]
    context: Mapping[str, Any]  # that files are to be read in

    def table(self, rest: str) -> tuple[str, dict[str, Any]]:
        """The table that this key, the rest of its path, is in: its path, and all its keys that are given."""
        above = self.path.removesuffix(rest)
        keys = {path.removeprefix(above): value for path, value in self.beside.items() if path.startswith(above)}
        return above, {**keys, rest: self.value}


def with_values(study: StudyFile, values: Mapping[str, Any]) -> StudyFile:
    """The study with values at paths, that come together."""
    for path, value in values.items():
        study = with_value(study, path, value, values)
    return study


def with_value(study: StudyFile, path: str, value: Any, beside: Mapping[str, Any] = NONE) -> StudyFile:
    """The study with a value at a path; names stand for floats, members, nodes and others.

    `*` stands for all of them, `rotor-*` for those whose names begin so. A table that the study lacks is made of the
    value and those beside it; so is one of another shape or kind, which takes the place of the study's.
    """
    put = Put(value, path, beside, study.context)
    for whole in _in_seas(study, path):
        study = _changed(study, whole, put, "")
    return study


def keys_at(study: StudyFile, path: str) -> Iterator[tuple[str, ...]]:
    """The keys that a path stands for, each as the names on its way; the path leads somewhere."""
    for whole in _in_seas(study, path):
        yield from _below_names(study, whole, ())


def unit(path: str) -> str:
    """Of the key at the end of a path, or in whose list that is; empty for words."""
    key, *places = last(path).split(".")
    above = path.removesuffix(last(path)).rstrip(".").rpartition(".")[2]
    return units().get(above if places and above in LISTS else key, "")


def _in_seas(study: StudyFile, path: str) -> list[str]:
    """The path, or one for every sea state that it stands for."""
    head, dot, rest = path.partition(".")
    return [f"sea_states.{name}.{rest}" for name in study.seas or (ALL,)] if head == SEA and dot else [path]


def _below_names(node: Any, path: str, above: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    if not (path and _is_container(node)):  # the key, or a table that the study lacks
        yield *above, *filter(None, path.split("."))
        return
    if isinstance(node, Table):
        items = {name: getattr(node, name) for name in _own(node)}
        if PATHS in type(node).model_fields and path.partition(".")[0] not in items:
            yield *above, path
            return
    else:
        items = dict(node) if isinstance(node, Mapping) else {_name(item): item for item in node}
    chosen, rest = _named(list(items), path, ".".join(above))
    for name in chosen:
        yield from _below_names(items[name], rest, (*above, name))


def _changed(node: Any, path: str, put: Put, above: str) -> Any:
    """A table, or tables by name, with the value at the path below."""
    if isinstance(node, Table):
        _, keys = put.table(path)
        if of_another_kind(vars(node), keys):
            return keys if path in KINDS else node  # the others come with the one that says of which
        return _table(node, path, put, above)
    if isinstance(node, Mapping):
        chosen, rest = _named(list(node), path, above)
        return {
            name: _below(item, rest, put, f"{above}{name}.") if name in chosen else item for name, item in node.items()
        }
    names = [_name(item) for item in node]
    chosen, rest = _named(names, path, above)
    return tuple(
        _below(item, rest, put, f"{above}{name or ALL}.") if name in chosen else item
        for name, item in zip(names, node, strict=True)
    )


def _below(item: Any, rest: str, put: Put, above: str) -> Any:
    if isinstance(item, Table):
        if not rest:
            raise PathError(_inside(item, above[:-1]))
        return _changed(item, rest, put, above)
    return _in_list(item, rest, put, above[:-1]) if rest else put.value


def _in_list(values: Any, rest: str, put: Put, name: str) -> tuple[Any, ...]:
    """A list with the value at one of its places, or in the list that is there."""
    head, _, deeper = rest.partition(".")
    if not isinstance(values, tuple):
        raise PathError(f"leads nowhere: {name} is no table; give its whole value")
    if not (head.isdecimal() and int(head) < len(values)):
        raise PathError(f"leads nowhere: {name} is a list of {len(values)}, the first of which is {name}.0")
    place = int(head)
    new = _in_list(values[place], deeper, put, f"{name}.{head}") if deeper else put.value
    return (*values[:place], new, *values[place + 1 :])


def _table(node: Table, path: str, put: Put, above: str) -> Table:
    key, _, rest = path.partition(".")
    known = [name for name in _own(node) if above or name not in FIXED]
    if key not in known and PATHS in type(node).model_fields:
        return _with(node, PATHS, {**getattr(node, PATHS), path: put.value}, put)
    if key not in known:
        raise PathError(_nowhere(key, rest, known, above))
    if key in CONSTANT:
        raise PathError(CONSTANT[key])
    child = getattr(node, key)
    if rest and child is None:
        kind = _kind(node, key) if above or key not in OWN else None
        if kind is None:
            raise PathError(f"leads nowhere: the study has no [{above}{key}]")
        return _with(node, key, _made(kind, rest, put, f"{above}{key}"), put)
    if not rest and _is_container(child):
        raise PathError(_inside(child, f"{above}{key}"))
    new: Any
    if rest and isinstance(child, Mapping) and not child:  # names that the study lacks, with what is given of each
        _, new = put.table(rest)
    elif rest and not _is_container(child):
        new = _in_list(child, rest, put, f"{above}{key}")
    else:
        new = _changed(child, rest, put, f"{above}{key}.") if rest else put.value
    return _with(node, key, new, put)


def _own(node: Table) -> list[str]:
    """A table's own keys: what holds values by their paths is none."""
    return [name for name in type(node).model_fields if name != PATHS]


def _with(node: Table, key: str, new: Any, put: Put) -> Table:
    given = {name: getattr(node, name) for name in node.model_fields_set}
    try:
        return type(node).model_validate(given | {key: new}, context=put.context)
    except ValidationError as error:
        raise PathError(_within(error.errors(include_url=False)[0], put)) from None


def _within(error: ErrorDetails, put: Put) -> str:
    """The limit, with the key of a table that is given as a whole, or with its kind."""
    if put.path.rpartition(".")[2] in KINDS and not error["type"].startswith("union_tag"):
        return describe(error)
    inner = dotted(error["loc"][1:]) if isinstance(put.value, dict) and error["type"] != "missing" else ""
    return f"{inner}: {limit_of(error)}" if inner else limit_of(error)


def _kind(node: Table, key: str) -> type[Table] | None:
    """Of the table that a key may have, or nothing."""
    kinds = get_args(type(node).model_fields[key].annotation)
    return next((kind for kind in kinds if isinstance(kind, type) and issubclass(kind, Table)), None)


def _made(kind: type[Table], rest: str, put: Put, name: str) -> Table:
    """A table that the study lacks, of all its keys that are given together."""
    above, keys = put.table(rest)
    try:
        return kind.model_validate(keys, context=put.context)
    except ValidationError as error:
        _blame(error.errors(include_url=False)[0], above, keys, name)


def _blame(error: ErrorDetails, above: str, keys: Mapping[str, Any], name: str) -> NoReturn:
    """The key that is wrong; the first where one is missing."""
    key = str((*error["loc"], error.get("ctx", {}).get("key"))[0])
    limit = limit_of(error)
    if key not in keys:
        key, limit = next(iter(keys)), f"leads nowhere: the study has no [{name}], and one brought in {limit}"
    raise PathError(limit, above + key) from None


def _is_container(value: Any) -> bool:
    """A table, or tables by name; a list of numbers or names is a value."""
    if isinstance(value, tuple):
        return any(isinstance(item, Table) for item in value)
    return isinstance(value, Table | Mapping)


def _inside(node: Any, path: str) -> str:
    """What goes on from a path that ends at a table, or at several."""
    if isinstance(node, Table):
        return f"leads to a table; go on with one of its keys: {', '.join(_own(node))}"
    if isinstance(node, Mapping):
        return f"leads to several; go on with one of the names or {ALL} for all: {', '.join(node)}"
    first, names = node[0], list(filter(None, map(_name, node)))
    if names:
        return f"leads to tables; go on with one of their names or {ALL} for all, and a key: {', '.join(names)}"
    keys = ", ".join(f"{path}.{ALL}.{key}" for key in type(first).model_fields)
    return f"leads to tables without names; go on with {ALL} for all of them, and a key: {keys}"


def _named(names: list[str], path: str, above: str) -> tuple[list[str], str]:
    """The names that a path begins with, and its rest; names may have dots in them."""
    head, _, rest = path.partition(".")
    if ALL in head and (head == ALL or any(fnmatchcase(name, head) for name in names)):
        return [name for name in names if fnmatchcase(name, head)], rest
    fitting = [name for name in names if path == name or path.startswith(f"{name}.")]
    if not fitting and names and not any(names):
        raise PathError(f"leads nowhere: {above[:-1]} are tables without names; {ALL} stands for all of them")
    if not fitting:
        raise PathError(_nowhere(head, rest, names, above))
    longest = max(fitting, key=len)
    return [longest], path[len(longest) + 1 :]


def _name(item: Any) -> str:
    return str(getattr(item, "name", None) or getattr(item, "node", ""))


def _nowhere(key: str, rest: str, known: Iterable[str], above: str) -> str:
    if words := answer(key):
        return f"leads nowhere; {words}"
    written = {name.casefold(): name for name in known}
    close = difflib.get_close_matches(key.casefold(), written, n=1)
    if close and (above or key not in FIXED):
        return f"leads nowhere; did you mean {above}{written[close[0]]}{f'.{rest}' if rest else ''}?"
    return f"leads nowhere: {above[:-1] or 'a study'} has {', '.join(written.values()) or 'nothing'}"
