"""What of JSON Schema, draft 4, the schema of study files uses: whether a document is valid."""

import re

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}
# Annotations, which say nothing about a document, and the types that the meta-schema wants of keywords.
SAID = {"description": str, "title": str, "x-unit": str, "format": str, "default": object, "$schema": str}
KEYWORDS = {
    "type": (str, list), "enum": list, "minimum": (int, float), "maximum": (int, float), "exclusiveMinimum": bool,
    "exclusiveMaximum": bool, "pattern": str, "minLength": int, "maxLength": int, "items": dict, "minItems": int,
    "maxItems": int, "properties": dict, "patternProperties": dict, "additionalProperties": (bool, dict),
    "required": list, "anyOf": list, "allOf": list, "$ref": str, "definitions": dict,
}  # fmt: skip


def malformed(node):
    """Keywords of a schema that draft 4 does not have, or not so."""
    known = SAID | KEYWORDS
    yield from (key for key, value in node.items() if key not in known or not isinstance(value, known[key]))
    if "$ref" in node and len(node) > 1:
        yield "beside $ref"
    yield from (
        f"exclusive{end}" for end in ("Minimum", "Maximum") if f"exclusive{end}" in node and end.lower() not in node
    )
    for name in ("properties", "patternProperties", "definitions"):
        for inner in node.get(name, {}).values():
            yield from malformed(inner)
    for inner in (*node.get("anyOf", ()), *node.get("allOf", ()), node.get("items"), node.get("additionalProperties")):
        if isinstance(inner, dict):
            yield from malformed(inner)


def faults(node, value, root, place="study"):
    """What is wrong with a value."""
    if "$ref" in node:
        yield from faults(root["definitions"][node["$ref"].removeprefix("#/definitions/")], value, root, place)
        return
    kinds = node.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(isinstance(value, TYPES[k]) and (k == "boolean" or value is not True) for k in kinds):
        yield f"{place}: no {kinds}"
        return
    if "enum" in node and value not in node["enum"]:
        yield f"{place}: not one of {node['enum']}"
    yield from _bounds(node, value, place)
    if isinstance(value, dict):
        yield from _table(node, value, root, place)
    if isinstance(value, list) and "items" in node:
        for item in value:
            yield from faults(node["items"], item, root, f"{place}[]")
    for one in node.get("allOf", ()):
        yield from faults(one, value, root, place)
    if "anyOf" in node and not any(not list(faults(one, value, root, place)) for one in node["anyOf"]):
        yield f"{place}: fits none of {len(node['anyOf'])}"


def _bounds(node, value, place):
    if isinstance(value, int | float) and "minimum" in node:
        low = node["minimum"]
        if value < low or (value == low and node.get("exclusiveMinimum")):
            yield f"{place}: too small"
    if isinstance(value, int | float) and "maximum" in node:
        high = node["maximum"]
        if (value > high and value != float("inf")) or (value == high and node.get("exclusiveMaximum")):
            yield f"{place}: too large"
    if isinstance(value, str) and not re.search(node.get("pattern", ""), value):
        yield f"{place}: not {node['pattern']}"
    if isinstance(value, str | list):
        least, most = (node.get(f"{end}{'Length' if isinstance(value, str) else 'Items'}") for end in ("min", "max"))
        if (least is not None and len(value) < least) or (most is not None and len(value) > most):
            yield f"{place}: too short or long"


def _table(node, value, root, place):
    for key in node.get("required", ()):
        if key not in value:
            yield f"{place}: no {key}"
    for key, inner in value.items():
        known = [node["properties"][key]] if key in node.get("properties", {}) else []
        known += [one for pattern, one in node.get("patternProperties", {}).items() if re.search(pattern, key)]
        more = node.get("additionalProperties", True)
        if not known and more is False:
            yield f"{place}.{key}: unknown"
        for one in known or ([more] if isinstance(more, dict) else []):
            yield from faults(one, inner, root, f"{place}.{key}")
