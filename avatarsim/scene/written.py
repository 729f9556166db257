"""Scenes as plain JSON values and back: algebraic data types with their names as tags, driven by the types' own fields and hints.

The type of a field is given in one place, its dataclass. Names in a file are looked up only in the list of types below, and all
values go through the types' own checks.
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from math import inf
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from avatarsim.errors import InvalidFile
from avatarsim.scene.avatar import Avatar, Drive, Link
from avatarsim.scene.body import Body, ContactLaw, Mass, PairTable
from avatarsim.scene.joint import Ball, Coupling, Free, Hinge, Hinges, ReachCone, Rigid, Slide, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample

TYPES: Mapping[str, type[Any]] = {
    kind.__name__: kind for kind in (
        Scene, Body, Avatar, Drive, Link, Mass, Piece, Sphere, Capsule, Box, Ellipsoid, ConvexHull, Rigid, Hinges, Hinge, Slide,
        Coupling, Ball, Free, SwingTwist, ReachCone, PairTable, ContactLaw, TrackerSample,
    )
}
"""The types that a scene is made of, by the names that files call them."""

UNBOUNDED = "unbounded"
"""Text for an infinite number, since JSON has none."""

LATER = frozenset({"at_rest", "attached", "couplings", "drive", "moves", "surface_velocity"})
"""Fields that files of earlier versions lack; they get their defaults."""

TAG = "is"
"""Name of the entry that gives the type of an object."""

ROUNDING = 4.0 * float(np.finfo(np.float64).eps)
"""By how much a number of a unit vector moves when it is made one again: a few units in the last place."""

LARGEST = 1e100
"""Largest magnitude of a number of a file, in any unit: products of three stay finite, so that all checks of the types end in an
answer. Larger: squares overflow within them, and values are refused for infinities that are in no file."""


def written(value: object) -> Any:
    """Return a scene, or a part of one, as JSON values; numbers keep all their bits."""
    if is_dataclass(value) and not isinstance(value, type):
        return {TAG: type(value).__name__} | {field.name: written(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return [[written(key), written(held)] for key, held in value.items()]
    if isinstance(value, tuple):
        return [written(one) for one in value]
    if isinstance(value, np.generic):
        return value.item()
    return UNBOUNDED if value == inf else value


def scene_from(data: object, thing: str) -> Scene:
    """Return the scene that `written` made the data of; `thing` is the name of the file in errors.

    Raises InvalidFile for data of another form, with its place in the file, and InvalidInput for values that no scene has."""
    scene = _object(data, Scene, thing, "scene")
    assert isinstance(scene, Scene)
    return scene


def _read(data: object, hint: Any, thing: str, place: str) -> Any:
    """Return the value of a type at a place of the file."""
    origin = get_origin(hint)
    if hint in TYPES.values():
        return _object(data, hint, thing, place)
    if origin in (Union, UnionType):
        return _one_of(data, get_args(hint), thing, place)
    if origin is np.ndarray:
        return _array(data, thing, place)
    if origin is tuple:
        return _row(data, get_args(hint), thing, place)
    if origin is not None and issubclass(origin, Mapping):
        key, held = get_args(hint)
        pairs = (_row(one, (key, held), thing, f"{place}[{k}]") for k, one in enumerate(_list(data, thing, place)))
        return dict(pairs)
    if isinstance(hint, type) and issubclass(hint, Enum):
        if not isinstance(data, str) or data not in hint.__members__:
            raise _wrong(thing, place, data, "one of " + ", ".join(hint.__members__))
        return hint[data]
    if hint is float and data == UNBOUNDED:
        return inf
    if hint is float and isinstance(data, int | float) and not isinstance(data, bool):
        if not abs(data) <= LARGEST:
            raise _wrong(thing, place, data, f"a number from {-LARGEST:g} to {LARGEST:g}")
        return float(data)
    if isinstance(data, hint) and not (hint is int and isinstance(data, bool)):
        return data
    raise _wrong(thing, place, data, {str: "a text", float: "a number", NoneType: "null"}.get(hint, hint.__name__))


def _object(data: object, kind: type[Any], thing: str, place: str) -> Any:
    """Return a dataclass, all fields of which are there but those in LATER, and no others."""
    if not isinstance(data, dict) or data.get(TAG) != kind.__name__:
        raise _wrong(thing, place, data, f'an object with "{TAG}": "{kind.__name__}"')
    hints = _hints(kind.__name__)
    names = set(data) - {TAG}
    if names - set(hints) or set(hints) - names - LATER:
        raise _wrong(thing, place, sorted(names), "the entries " + ", ".join(hints))
    read = {name: _read(data[name], hint, thing, f"{place}.{name}") for name, hint in hints.items() if name in names}
    made = kind(**read)
    for name, value in read.items():
        # to divide a unit vector by its length again moves its last bit, and with it all that follows
        if isinstance(value, tuple | np.ndarray) and _is_rounding(value, getattr(made, name)):
            object.__setattr__(made, name, value)
    return made


def _is_rounding(value: tuple[Any, ...] | np.ndarray, other: Any) -> bool:
    """Return True if unit vectors or quaternions differ by no more than a division by a length near 1."""
    if isinstance(value, tuple) and not all(isinstance(one, float) for one in (*value, *other)):
        return False
    one, two = np.asarray(value), np.asarray(other)
    return one.shape == two.shape and not np.array_equal(one, two) and bool((np.abs(one - two) <= ROUNDING).all())


def _one_of(data: object, kinds: tuple[Any, ...], thing: str, place: str) -> Any:
    """Return a value of one of several types: nothing, or the one that the tag names."""
    if data is None and NoneType in kinds:
        return None
    tag = data.get(TAG) if isinstance(data, dict) else None
    named = {kind.__name__: kind for kind in kinds if kind in TYPES.values()}
    if isinstance(tag, str) and tag in named:
        return _read(data, named[tag], thing, place)
    plain = [kind for kind in kinds if kind is not NoneType and kind not in TYPES.values()]
    if len(plain) == 1 and tag is None:
        return _read(data, plain[0], thing, place)
    raise _wrong(thing, place, data, "one of " + ", ".join(named))


def _array(data: object, thing: str, place: str) -> np.ndarray:
    """Return numbers, in rows of one length."""
    try:
        array = np.array(_list(data, thing, place), dtype=object)
        if not all(type(one) in (int, float) and abs(one) <= LARGEST for one in array.ravel()):
            raise ValueError
    except ValueError as error:
        raise _wrong(thing, place, data, f"numbers from {-LARGEST:g} to {LARGEST:g} in rows of one length") from error
    found = array.astype(np.float64)
    # as the types make theirs
    found.flags.writeable = False
    return found


def _row(data: object, kinds: tuple[Any, ...], thing: str, place: str) -> tuple[Any, ...]:
    """Return a tuple: of any length of one type, or of so many types."""
    found = _list(data, thing, place)
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        kinds = (kinds[0],) * len(found)
    if len(found) != len(kinds):
        raise _wrong(thing, place, found, f"a list of {len(kinds)}")
    return tuple(_read(one, kind, thing, f"{place}[{k}]") for k, (one, kind) in enumerate(zip(found, kinds, strict=True)))


def _list(data: object, thing: str, place: str) -> list[Any]:
    if not isinstance(data, list):
        raise _wrong(thing, place, data, "a list")
    return data


def _wrong(thing: str, place: str, value: object, valid: str) -> InvalidFile:
    return InvalidFile(f"{place} of {thing}", value, valid)


@cache
def _hints(name: str) -> Mapping[str, Any]:
    """Return the types of a dataclass's fields, in their order."""
    kind = TYPES[name]
    hints = get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind)}
