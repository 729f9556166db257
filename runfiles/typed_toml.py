"""TOML files as dataclasses: each value is checked against the annotation of its field."""

import re
from collections.abc import Collection, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import EnumType
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from avatarsim.errors import InvalidFile
from avatarsim.files import read_toml

T = TypeVar("T")
VALID: Mapping[object, str] = {
    str: "a text", bool: "true or false", int: "a whole number", tuple: "a list", Mapping: "a table",
}
"""Valid values by annotation, or by its origin."""


NOT_IN_FILE: Mapping[str, bool] = {"is_in_file": False}
"""Metadata of a field that a file does not have."""


def read(path: Path, kind: type[T]) -> T:
    """Return a file as a dataclass. Raises InvalidFile, which names the file, the key, the value and the valid range.

    Annotations are those of TOML's values: str, bool, int, tuple[X, ...] of a list, Mapping[str, X] and dataclasses of a table,
    enumerations by value, X | Y, and object of anything, a list as a tuple. Literal names all values; Annotated[X, valid] adds
    a pattern of a text, or a collection of values. A field made with NOT_IN_FILE is no key."""
    value: T = _value(path, kind, read_toml(path, str(path), "a readable TOML file"), "")
    return value


def _value(path: Path, kind: Any, value: object, key: str) -> Any:
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        checked, valid = _value(path, inner[0], value, key), inner[1]
        if re.fullmatch(valid, checked) if isinstance(valid, str) else checked in valid:
            return checked
        raise _invalid(path, key, value, _valid(kind))
    if origin is UnionType:
        fitting = [one for one in inner if isinstance(value, get_origin(one) or one)]
        if fitting:
            return _value(path, fitting[0], value, key)
    elif origin is tuple and isinstance(value, list):
        return tuple(_value(path, inner[0], one, f"{key}[{k}]") for k, one in enumerate(value))
    elif origin is Mapping and isinstance(value, dict):
        return {name: _value(path, inner[1], one, f"{key}.{name}") for name, one in value.items()}
    elif isinstance(kind, EnumType) or origin is Literal:
        members: Mapping[str, Any] = getattr(kind, "__members__", {})
        known = {one.value: one for one in members.values()} or {one: one for one in inner}
        if isinstance(value, str) and value in known:
            return known[value]
        raise _invalid(path, key, value, _listed(known))
    elif is_dataclass(kind) and isinstance(value, dict):
        return _record(path, kind, value, f"{key}." if key else "")
    elif kind is object:
        return tuple(value) if isinstance(value, list) else value
    elif type(value) is kind:
        return value
    raise _invalid(path, key, value, _valid(kind))


def _record(path: Path, kind: Any, table: Mapping[str, object], place: str) -> Any:
    annotations, keys = get_type_hints(kind, include_extras=True), [one for one in fields(kind) if one.metadata != NOT_IN_FILE]
    hints = {one.name: annotations[one.name] for one in keys}
    for name, value in table.items():
        if name not in hints:
            raise _invalid(path, f"{place}{name}", value, f"one of the keys {', '.join(hints)}")
    for one in keys:
        if one.name not in table and one.default is MISSING and one.default_factory is MISSING:
            raise _invalid(path, f"{place}{one.name}", "missing", _valid(hints[one.name]))
    return kind(**{name: _value(path, hints[name], value, f"{place}{name}") for name, value in table.items()})


def _valid(kind: Any) -> str:
    """Return the valid values of an annotation in words."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return f"a text like {inner[1]}" if isinstance(inner[1], str) else _listed(inner[1])
    return _listed(inner) if origin is Literal else VALID.get(origin or kind, "a table")


def _listed(known: Collection[object]) -> str:
    return f"{known.start} to {known[-1]}" if isinstance(known, range) else f"one of {', '.join(map(str, known))}"


def _invalid(path: Path, key: str, value: object, valid: str) -> InvalidFile:
    return InvalidFile(f"{key} in {path}", value, valid)
