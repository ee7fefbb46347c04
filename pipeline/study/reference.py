"""What a study file may say: its keys as a table, and a JSON Schema for editors; both from the tables themselves."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any, NamedTuple

from pipeline.study.axes import UNDOTTED
from pipeline.study.inherit import BASE
from pipeline.study.paths import FIXED
from pipeline.study.ranges import Range
from pipeline.study.schema import StudyFile
from pipeline.study.tables import LARGEST

Node = dict[str, Any]  # a piece of JSON Schema
DRAFT = "http://json-schema.org/draft-04/schema#"  # which editors of TOML know
ANY = "PATH"  # stands for the dotted path of any key
STANDS_ON = {"type": "string", "description": "A study file, relative to this one, of which this one says what differs"}
PATHS = rf"\.|^({'|'.join(UNDOTTED)})$"  # of keys that are varied
KEPT = ("type", "description", "pattern", "enum", "x-unit", "format", "maxLength", "minLength", "maxItems", "minItems")


class Key(NamedTuple):
    """A key of study files."""

    path: str
    unit: str
    default: str
    values: str
    meaning: str
    of: tuple[str, ...] = ()  # the kinds of table that have it, where there are several


@cache
def described() -> Node:
    """JSON Schema as pydantic writes it, with meanings and units; its definitions are in $defs."""
    schema = StudyFile.model_json_schema()
    schema["properties"] = {BASE: STANDS_ON, **schema["properties"]}
    schema["$defs"]["Range"] = Range.model_json_schema()
    return schema


def find(word: str = "") -> list[Key]:
    """All keys in the order of the tables, or those with a word in path, values or meaning."""
    found: dict[tuple[str, str], Key] = {}
    for key in _below(described(), "", ""):
        place = key.path, key.meaning
        found[place] = _both(found[place], key) if place in found else key
    return [key for key in found.values() if word.casefold() in f"{key.path} {key.values} {key.meaning}".casefold()]


def _both(one: Key, other: Key) -> Key:
    """A key that two kinds of table have."""
    either = dict.fromkeys((one.values, other.values))
    default = other.default if one.default == "required" else one.default
    return one._replace(of=(*one.of, *other.of), values=", ".join(either), default=default)


def tables() -> dict[str, tuple[str, list[Key]]]:
    """What stands in brackets, [waves], in the order of study files: what it is, and its keys."""
    grouped: dict[str, list[Key]] = {}
    for key in find():
        first, dot, _ = key.path.partition(".")
        grouped.setdefault(first if dot else "", []).append(key)
    return {name: (_about(name), members) for name, members in grouped.items()}


def _about(name: str) -> str:
    """What a table is, or each of its kinds."""
    kinds, _ = _tables(described()["properties"][name], name) if name else ([], "")
    said = {_kind(each): " ".join(str(each.get("description", "")).split()) for each in kinds}
    return " ".join(f"`{kind}`: {words}" if len(said) > 1 else words for kind, words in said.items())


def json_schema() -> Node:
    """For editors: draft 4; nothing is required below the top, for a study that stands on another may leave it out."""
    raw = described()
    schema = _draft4(raw) | {"definitions": {name: _draft4(node) for name, node in raw["$defs"].items()}}
    for name in ("Axes", "Together", "Samples", "Variant", "Survival"):
        tables = [
            "sea",
            *(key for key, node in raw["properties"].items() if key not in FIXED and _tables(node, key)[0]),
        ]
        _open_to_paths(schema["definitions"][name], tables)
    schema["definitions"]["Variant"]["properties"]["axes"]["additionalProperties"] = {"type": ["array", "object"]}
    axes = schema["definitions"]["Axes"]["properties"]
    for name in axes.keys() - {"together"}:
        listed = {key: axes[name].pop(key) for key in ("type", "items") if key in axes[name]}
        axes[name]["anyOf"] = [listed, {"$ref": "#/definitions/Range"}]
    return {"$schema": DRAFT, "title": "A study", **schema, "anyOf": [{"required": [BASE]}, {"required": ["water"]}]}


def table_of(node: Node) -> Node:
    """What a node refers to, if it does."""
    return described()["$defs"][node["$ref"].rpartition("/")[2]] if "$ref" in node else node


def _below(table: Node, above: str, kind: str) -> Iterator[Key]:
    """The keys of a table and of those in it."""
    for name, node in table["properties"].items():
        if name == "beside":
            continue  # has no key of its own: any word without a dot will do
        path = f'{above}"{ANY}"' if name == "keys" else f"{above}{name}"
        inner, deeper = _tables(node, path)
        if not inner or name == "keys":
            yield _key(path, node, name, table, kind)
        for each in inner if name != "keys" else ():
            yield from _below(each, f"{deeper}.", _kind(each) if len(inner) > 1 else kind)


def _tables(node: Node, path: str) -> tuple[list[Node], str]:
    """The tables that a node holds, of which it may be one of several kinds, and their path."""
    if "properties" not in node and (named := _named(node)):
        node, path = named, f"{path}.*"
    elif isinstance(node.get("items"), dict):
        node, path = node["items"], path if path == "axes.together" else f"{path}.*"
    found = [table_of(choice) for choice in _choices(node) or [node]]
    return [each for each in found if "properties" in each], path


def _named(node: Node) -> Node:
    """What a table has under each of the names that its writer gives; nothing if that is anything."""
    named = [*node.get("patternProperties", {}).values(), node.get("additionalProperties")]
    return next((each for each in named if isinstance(each, dict)), {})


def _choices(node: Node) -> list[Node]:
    """The kinds of value that a node may be, if there are several; a key that may be left out is never null."""
    every: list[Node] = node.get("oneOf") or node.get("anyOf") or []
    return [one for one in every if one.get("type") != "null"]


def _kind(table: Node) -> str:
    """Its shape, or kind."""
    marks = (table["properties"].get(key, {}) for key in ("shape", "kind"))
    return next((str(mark["const"]) for mark in marks if "const" in mark), "")


def _key(path: str, node: Node, name: str, table: Node, kind: str) -> Key:
    default = "" if node.get("default") in (None, {}, []) else json.dumps(node["default"]).replace("Infinity", "inf")
    return Key(
        path=path,
        unit=node.get("x-unit", "-"),
        default="required" if name in table.get("required", ()) else default,
        values=values(_named(node) if name == "keys" else node),
        meaning=node.get("description", ""),
        of=(kind,) if kind else (),
    )


def values(node: Node) -> str:
    """What a key may be, in words: > 0; "a" or "b"; 3 numbers."""
    node = table_of(node)
    if "enum" in node or "const" in node:
        return ", ".join(map(json.dumps, node.get("enum", [node.get("const")])))
    if words := list(dict.fromkeys(map(values, _choices(node)))):
        many = len(words) == 2 and words[1] == f"list of: {words[0]}"
        return f"{words[0]}, or a list" if many else " or ".join(words)
    match node.get("type"):
        case "boolean":
            return "true, false"
        case "number" | "integer":
            return _numbers(node)
        case "array":
            return _list(node)
        case "object":
            return _table(node)
        case "string" | ["string", "integer"]:
            return "file" if node.get("format") == "path" else "name" if "pattern" in node else "text"
    return "any value"


def _numbers(node: Node) -> str:
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    usual = (-LARGEST, LARGEST, 2**63)
    bounds = [f"{sign} {node[key]:g}" for key, sign in signs.items() if key in node and node[key] not in usual]
    whole = "whole number" if node["type"] == "integer" else "number"
    return " ".join([whole, ", ".join(bounds)]).strip()


def _list(node: Node) -> str:
    if "prefixItems" in node:
        return f"{len(node['prefixItems'])} of: {values(node['prefixItems'][0])}"
    return f"list of: {values(node.get('items', {}))}"


def _table(node: Node) -> str:
    if "properties" in node:
        return "{ " + ", ".join(node["properties"]) + " }"
    return f"by name: {values(_named(node))}"


def _draft4(node: Node) -> Node:
    """A piece of JSON Schema in the words of draft 4."""
    if "$ref" in node:
        link: Node = {"$ref": node["$ref"].replace("$defs", "definitions")}
        about: Node = {key: node[key] for key in ("description", "x-unit") if key in node}
        return {"allOf": [link], **about} if about else link
    plain: Node = {key: node[key] for key in KEPT if key in node}
    if node.get("default") not in (None, math.inf):  # which JSON does not have
        plain["default"] = node["default"]
    if "const" in node:
        plain["enum"] = [node["const"]]
    for end in ("minimum", "maximum"):
        strict = f"exclusive{end.capitalize()}"
        if end in node or strict in node:
            plain |= {end: node[strict], strict: True} if strict in node else {end: node[end]}
    return plain | _draft4_parts(node)


def _draft4_parts(node: Node) -> Node:
    """Of a list, a table, or a choice, what is in it."""
    plain: Node = {}
    choices = [_draft4(one) for one in _choices(node)]
    if len(choices) == 1:
        plain |= {"allOf": choices} if "$ref" in choices[0] else choices[0]
    elif choices:
        plain["anyOf"] = choices
    if "prefixItems" in node:
        plain["items"] = _draft4(node["prefixItems"][0])  # all are alike
    elif "items" in node:
        plain["items"] = _draft4(node["items"])
    if "properties" in node:
        plain["properties"] = {name: _draft4(each) for name, each in node["properties"].items()}
        plain["additionalProperties"] = False
    elif "patternProperties" in node:
        named = {name: _draft4(each) for name, each in node["patternProperties"].items()}
        plain |= {"patternProperties": named, "additionalProperties": False}
    elif of_any := _named(node):
        plain["additionalProperties"] = _draft4(of_any)
    return plain


def _open_to_paths(table: Node, tables: Iterable[str]) -> None:
    """Let a table have dotted paths, or tables in tables, for keys."""
    table["properties"] |= {name: {"type": "object"} for name in tables if name not in table["properties"]}
    paths = table["properties"].pop("keys")
    of_path = paths.get("additionalProperties", {})  # of a variant anything
    if table["properties"].pop("beside", None) is not None:
        table["additionalProperties"] = {"anyOf": [of_path, {"$ref": "#/definitions/Range"}]}
    elif not of_path:
        table["additionalProperties"] = of_path
    else:
        listed = of_path.get("type") == "array"
        either = {"anyOf": [of_path, {"$ref": "#/definitions/Range"}]} if listed else of_path
        table["patternProperties"] = {PATHS: either | {"description": paths["description"]}}
