"""Validation of JSON by a schema: the part of JSON Schema 2020-12 that the schema of certificates uses, and no package for it.

A folder is gone on with by what its certificates say, also by an install without extras, which has no `jsonschema`; tests hold
the two against each other. https://json-schema.org/draft/2020-12. A keyword that is not known here is an error of the schema, so
that none is passed over.
"""

import re
from collections.abc import Mapping
from typing import Any

TYPES: Mapping[str, tuple[type, ...]] = {
    "object": (dict,), "array": (list,), "string": (str,), "boolean": (bool,), "null": (type(None),), "integer": (int,),
    "number": (int, float),
}
SILENT = ("$schema", "$defs", "title", "description")
"""Keywords that ask nothing."""


def fault(value: object, schema: Mapping[str, Any], root: Mapping[str, Any], place: str = "") -> str:
    """Where a value, of those that `json.loads` gives, is against the schema, a part of `root`: "" if nowhere.

    Raises ValueError for a schema with a keyword that is not known here."""
    for word, asked in schema.items():
        if word in SILENT:
            continue
        if word not in CHECKS:
            raise ValueError(f"keyword {word} of a schema")
        found = CHECKS[word](value, asked, schema, root, place)
        if found:
            return str(found)
    return ""


def _type(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    # to Python a truth is a number
    right = isinstance(value, TYPES[asked]) and (asked == "boolean" or not isinstance(value, bool))
    return "" if right else f"{place or 'the whole'} is no {asked}"


def _properties(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    if not isinstance(value, dict):
        return ""
    return next(filter(None, (fault(value[name], asked[name], root, f"{place}.{name}") for name in asked if name in value)), "")


def _required(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    missing = [name for name in asked if name not in value] if isinstance(value, dict) else []
    return f"{place}.{missing[0]} is missing" if missing else ""


def _additional(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    more = [name for name in value if name not in schema.get("properties", {})] if isinstance(value, dict) else []
    if asked is False:
        return f"{place}.{more[0]} is not known" if more else ""
    parts = {name: value[name] for name in more} if isinstance(value, dict) else {}
    return next(filter(None, (fault(one, asked, root, f"{place}.{name}") for name, one in parts.items())), "")


def _items(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    if not isinstance(value, list):
        return ""
    return next(filter(None, (fault(one, asked, root, f"{place}[{k}]") for k, one in enumerate(value))), "")


def _any_of(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    found = [fault(value, one, root, place) for one in asked]
    return "" if "" in found else found[0]


def _ref(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    part: Any = root
    for name in str(asked).removeprefix("#/").split("/"):
        part = part[name]
    return fault(value, part, root, place)


def _enum(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    return "" if any(_same(value, one) for one in asked) else f"{place} is none of {', '.join(map(str, asked))}"


def _const(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    return "" if _same(value, asked) else f"{place} is not {asked}"


def _same(value: object, asked: object) -> bool:
    return value == asked and isinstance(value, bool) == isinstance(asked, bool)


def _within(word: str) -> Any:
    def check(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
        if not isinstance(value, int | float) or isinstance(value, bool):
            return ""
        right = {"minimum": value >= asked, "exclusiveMinimum": value > asked, "maximum": value <= asked}[word]
        return "" if right else f"{place} is beyond {asked}"

    return check


def _length(least: bool) -> Any:
    def check(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
        if not isinstance(value, list):
            return ""
        right = len(value) >= asked if least else len(value) <= asked
        return "" if right else f"{place} has {len(value)} parts"

    return check


def _pattern(value: object, asked: Any, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    return "" if not isinstance(value, str) or re.search(asked, value) else f"{place} is not as {asked}"


CHECKS: Mapping[str, Any] = {
    "$ref": _ref, "type": _type, "const": _const, "enum": _enum, "anyOf": _any_of, "required": _required,
    "properties": _properties, "additionalProperties": _additional, "items": _items, "minimum": _within("minimum"),
    "exclusiveMinimum": _within("exclusiveMinimum"), "maximum": _within("maximum"), "minItems": _length(True),
    "maxItems": _length(False), "pattern": _pattern,
}
"""What each keyword asks: (value, what the keyword says, schema, root, place) -> where the value is against it."""
