"""Bounded reads of regular files: kind and size are checked before a byte is read, and text that is nested too deeply is refused.

A named pipe or a device in the place of a file would be waited for, or read without end; a file of gigabytes would take the
machine's memory. Every reader of files that come from elsewhere goes through here. Errors name the file as the caller does.
"""

import json
import stat
import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

from avatarsim.errors import InvalidFile

Parsed = TypeVar("Parsed")
MOST = 2**27
"""Bytes that a file may have unless its reader says otherwise. Parsed as text it takes up to ten times its size in memory; the
largest mesh that we know of has a tenth of this."""

DEEPEST = 64
"""Levels to which lists and objects of a file may be nested. Our own files take 8, glTF some more. Less: such a file is refused;
more: what readers do with a value recurses as deep as the value, and Python ends that at 1,000 calls. How deep its parsers go by
themselves differs from version to version."""


def check(path: Path, thing: str, valid: str, most: int = MOST) -> None:
    """Raise InvalidFile unless `path` is a regular file of at most `most` bytes; `thing` is what the error calls it."""
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        # ValueError: a name with a zero byte in it
        raise InvalidFile(thing, _reason(error), valid) from error
    if not stat.S_ISREG(found.st_mode):
        kind = "a folder" if stat.S_ISDIR(found.st_mode) else "a pipe, a socket or a device"
        raise InvalidFile(thing, kind, f"a regular file: {valid}")
    if found.st_size > most:
        raise InvalidFile(f"size of {thing} [bytes]", found.st_size, f"up to {most}")


def read_bytes(path: Path, thing: str, valid: str, most: int = MOST) -> bytes:
    """All bytes of a regular file. Raises InvalidFile."""
    check(path, thing, valid, most)
    try:
        with path.open("rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise InvalidFile(thing, _reason(error), valid) from error
    if len(content) > most:
        # it grew meanwhile, or its system states no size
        raise InvalidFile(f"size of {thing} [bytes]", f"above {most}", f"up to {most}")
    return content


def read_text(path: Path, thing: str, valid: str, most: int = MOST, errors: str = "strict") -> str:
    """A regular file of UTF-8 text, without the byte order mark that some editors put first. Raises InvalidFile."""
    try:
        return read_bytes(path, thing, valid, most).decode("utf-8-sig", errors)
    except UnicodeDecodeError as error:
        raise InvalidFile(thing, f"not UTF-8: {error}", valid) from error


def read_json(path: Path, thing: str, valid: str, most: int = MOST, constant: Callable[[str], object] | None = None) -> object:
    """The value of a JSON file; `constant` is told of NaN and Infinity. Raises InvalidFile."""
    return parsed_json(read_text(path, thing, valid, most), thing, valid, constant)


def parsed_json(content: str, thing: str, valid: str, constant: Callable[[str], object] | None = None) -> Any:
    """The value of JSON that stood in a file, nested no deeper than DEEPEST. Raises InvalidFile."""
    try:
        return _shallow(json.loads(content, parse_constant=constant))
    except (ValueError, RecursionError) as error:
        raise InvalidFile(thing, _unparsed(error, "JSON"), valid) from error


def read_toml(path: Path, thing: str, valid: str, most: int = MOST) -> dict[str, object]:
    """The tables of a TOML file. Raises InvalidFile."""
    content = read_text(path, thing, valid, most)
    try:
        return _shallow(tomllib.loads(content))
    except (ValueError, RecursionError) as error:
        raise InvalidFile(thing, _unparsed(error, "TOML"), valid) from error


def _shallow(value: Parsed) -> Parsed:
    """`value`, level by level found to be nested no deeper than DEEPEST. Raises RecursionError."""
    level: list[object] = [value]
    for _ in range(DEEPEST):
        level = [part for node in level for part in _parts(node) if isinstance(part, list | dict)]
        if not level:
            return value
    raise RecursionError


def _parts(node: object) -> Iterable[object]:
    return node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()


def _unparsed(error: Exception, language: str) -> str:
    if isinstance(error, RecursionError):
        return f"{language} nested too deeply"
    return f"cut off or not {language}: {error}"


def _reason(error: Exception) -> str:
    """What the system says, without the path, which the error names by itself."""
    return getattr(error, "strerror", None) or str(error)
