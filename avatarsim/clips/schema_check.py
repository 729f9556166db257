"""Validation of JSON by a schema: the part of JSON Schema 2020-12 that the schema of certificates uses, without a package for it.

A batch is continued by its certificates also in an install without extras, which has no `jsonschema`; tests compare the two.
https://json-schema.org/draft/2020-12. An unknown keyword is an error of the schema, so that none is ignored.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from operator import ge, gt, le
from typing import Any

TYPES: Mapping[str, tuple[type, ...]] = {
    "object": (dict,), "array": (list,), "string": (str,), "boolean": (bool,), "null": (type(None),), "integer": (int,),
    "number": (int, float),
}
SILENT = ("$schema", "$defs", "title", "description")
"""Keywords without a condition."""
BOUNDS: Mapping[str, Callable[[Any, Any], bool]] = {
    "minimum": ge, "exclusiveMinimum": gt, "maximum": le, "minItems": ge, "maxItems": le,
}
"""Comparison of a number, or of a length, with the value of the keyword."""


def fault(value: object, schema: Mapping[str, Any], root: Mapping[str, Any], place: str = "") -> str:
    """Return the first place where a value from `json.loads` violates the schema, a part of `root`: "" if it is valid.

    Raises ValueError for a schema with an unknown keyword."""
    return next(filter(None, (_against(word, value, schema, root, place) for word in schema if word not in SILENT)), "")


def _first(parts: Iterable[tuple[str, object, Any]], root: Mapping[str, Any]) -> str:
    """Return the first fault of (place, value, schema)."""
    return next(filter(None, (fault(value, schema, root, place) for place, value, schema in parts)), "")


def _against(word: str, value: object, schema: Mapping[str, Any], root: Mapping[str, Any], place: str) -> str:
    """Return where a value is against one keyword of a schema."""
    rule = schema[word]
    members: dict[str, Any] = value if isinstance(value, dict) else {}
    match word:
        case "$ref":
            part: Any = root
            for name in str(rule).removeprefix("#/").split("/"):
                part = part[name]
            return fault(value, part, root, place)
        case "anyOf":
            found = [fault(value, one, root, place) for one in rule]
            return "" if "" in found else found[0]
        case "type":
            # to Python a bool is a number
            right = isinstance(value, TYPES[rule]) and (rule == "boolean" or not isinstance(value, bool))
            return "" if right else f"{place or 'the whole'} is no {rule}"
        case "enum":
            return "" if any(_same(value, one) for one in rule) else f"{place} is none of {', '.join(map(str, rule))}"
        case "const":
            return "" if _same(value, rule) else f"{place} is not {rule}"
        case "pattern":
            return "" if not isinstance(value, str) or re.search(rule, value) else f"{place} is not as {rule}"
        case "required":
            missing = [name for name in rule if name not in members] if isinstance(value, dict) else []
            return f"{place}.{missing[0]} is missing" if missing else ""
        case "properties":
            return _first(((f"{place}.{name}", members[name], rule[name]) for name in rule if name in members), root)
        case "additionalProperties":
            more = [name for name in members if name not in schema.get("properties", {})]
            if rule is False:
                return f"{place}.{more[0]} is not known" if more else ""
            return _first(((f"{place}.{name}", members[name], rule) for name in more), root)
        case "items":
            rows = value if isinstance(value, list) else []
            return _first(((f"{place}[{k}]", one, rule) for k, one in enumerate(rows)), root)
        case "minItems" | "maxItems":
            return f"{place} has {len(value)} parts" if isinstance(value, list) and not BOUNDS[word](len(value), rule) else ""
        case "minimum" | "exclusiveMinimum" | "maximum":
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            return f"{place} is beyond {rule}" if is_number and not BOUNDS[word](value, rule) else ""
    raise ValueError(f"keyword {word} of a schema")


def _same(value: object, rule: object) -> bool:
    return value == rule and isinstance(value, bool) == isinstance(rule, bool)
