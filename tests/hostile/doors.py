"""Doors: ways in for values or files from elsewhere, the cases of each, and the answers that count."""

import math
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from pathlib import Path

import numpy as np

Damage = Callable[[bytes, random.Random], bytes]


class Unsound(Exception):
    """An answer that was given and is none: a number that is not finite, a value of another type than is declared. The part of
    the message before a colon is the same for equal findings."""


@dataclass(frozen=True)
class Case:
    """One input: a `text` that describes it, and the call that uses it."""

    text: str
    ask: Callable[[], object]


def nothing() -> None:
    """Prepare a door before its first case: most need nothing."""


@dataclass(frozen=True)
class Door:
    """A way in.

    weight    its share of all cases, relative to the others'
    cases     the first so many cases of a seed, each made when it is its turn, in a folder of its own
    slow      one case takes milliseconds, so batches are shorter
    warm      the steps that take long once and belong to no case: compiling
    reserves  its libraries reserve far more memory than they use, so that only resident memory can be limited
    files     where its cases are damaged files: the files before that
    """

    name: str
    weight: float
    cases: Callable[[int, int, Path], Iterator[Case]]
    slow: bool = False
    warm: Callable[[], None] = nothing
    reserves: bool = False
    files: "FileDoor | None" = None


@dataclass(frozen=True)
class FileDoor:
    """Cases of a reader: one of its valid `files` (path below the folder -> content) is damaged and `ask` reads it.

    `ask` gets the folder and the path that was damaged. `also` are files next to it that stay whole."""

    files: Callable[[], Mapping[str, bytes]]
    damage: Damage
    ask: Callable[[Path, Path], object]
    also: Callable[[], Mapping[str, bytes]] = dict

    def cases(self, seed: int, count: int, folder: Path) -> Iterator[Case]:
        """Yield damaged files, written one after the other over the valid ones."""
        files = dict(self.files())
        for name, content in {**files, **self.also()}.items():
            place(folder, name, content)
        for k in range(count):
            rng = random.Random(f"{seed}/{k}")
            name = rng.choice(sorted(files))
            content = self.damage(files[name], rng)
            path = place(folder, name, content)
            yield Case(f"{name}, {len(content)} bytes: {content[:60]!r}", lambda path=path: self.ask(folder, path))  # type: ignore[misc]
            place(folder, name, files[name])


def of_files(name: str, weight: float, files: FileDoor, slow: bool = False, reserves: bool = False) -> Door:
    """Return the door of a reader."""
    return Door(name, weight, files.cases, slow, reserves=reserves, files=files)


def place(folder: Path, name: str, content: bytes) -> Path:
    """Write a file below a folder."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return path


def sound(value: object, name: str = "answer", deep: int = 6) -> object:
    """Return `value`, if no number in it is nan. Raises Unsound with where one is."""
    if isinstance(value, float) and math.isnan(value):
        raise Unsound(f"{name} is nan")
    if isinstance(value, np.ndarray) and value.dtype.kind == "f" and np.isnan(value).any():
        raise Unsound(f"{name} holds nan")
    if deep and is_dataclass(value) and not isinstance(value, type):
        for entry in fields(value):
            sound(getattr(value, entry.name), f"{name}.{entry.name}", deep - 1)
    elif deep and isinstance(value, list | tuple):
        for k, part in enumerate(value):
            sound(part, f"{name}[{k}]", deep - 1)
    elif deep and isinstance(value, Mapping):
        for key, part in value.items():
            sound(part, f"{name}[{key!r}]", deep - 1)
    return value


def finite(value: object, name: str = "answer") -> object:
    """Return `value`, if each array and number in it is finite."""
    sound(value, name)
    for entry in fields(value) if is_dataclass(value) else ():
        part = getattr(value, entry.name)
        if isinstance(part, float | np.ndarray) and not np.isfinite(part).all():
            raise Unsound(f"{name}.{entry.name} is not finite")
    return value


def kept_to_one_of(code: object, codes: frozenset[int]) -> object:
    """Return an exit code, if it is one of those that a command has."""
    if code not in codes or isinstance(code, bool | Enum):
        raise Unsound(f"exit code {code!r}, none of {sorted(codes)}")
    return code
