"""Numbers and texts of untrusted files: conversion of words to valid numbers."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.errors import InvalidFile
from avatarsim.files import read_bytes

Array = NDArray[np.float64]

MARK = "\xef\xbb\xbf"
"""The byte order mark of UTF-8, byte by byte."""

SHOWN = 80
"""Characters of a line that a sentence quotes."""


def quoted(text: str) -> str:
    """Return the beginning of a text, as far as a sentence quotes it."""
    return text[:SHOWN]


def lines_of(path: Path, kind: str) -> tuple[list[str], str]:
    """Return the lines of a file, `kind` in words, and their ending.
    A character is one byte, so that `in_bytes` restores any encoding. Raises InvalidFile for no file, too many bytes or lines."""
    content = read_bytes(path, path.name, kind, caps.BYTES)
    count = content.count(b"\n") + content.count(b"\r")
    if count > caps.LINES:
        raise InvalidFile(f"lines of {path.name}", count, f"up to {caps.LINES}")
    newline = "\r\n" if b"\r\n" in content else "\n"
    return content.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n").split("\n"), newline


def in_bytes(text: str) -> bytes:
    """Return the bytes that `lines_of` read a text from."""
    return text.encode("latin-1")


def readable(text: str) -> str:
    """Return a name decoded as UTF-8 where its bytes are."""
    try:
        return in_bytes(text).decode("utf-8")
    except UnicodeDecodeError:
        return text


def numbered(name: str, lines: Sequence[str], first: int = 0) -> Iterator[tuple[int, str]]:
    """Yield (number, text) of lines that are not blank, after the `first` ones; numbers count from 1.
    The byte order mark of some editors is left out. Raises InvalidFile for a line that is too long."""
    for line, text in enumerate(lines[first:], first + 1):
        if len(text) > caps.LINE:
            raise InvalidFile(f"length of line {line} of {name}", len(text), f"up to {caps.LINE} characters")
        text = text.removeprefix(MARK) if line == 1 else text
        if text and not text.isspace():
            yield line, text


def number(at: str, word: str) -> float:
    """Return the number in a word; InvalidFile if it is none, or too large to mean anything."""
    try:
        found = float(word) if "_" not in word else np.nan
    except ValueError:
        found = np.nan
    if not abs(found) <= caps.NUMBER:
        raise InvalidFile(f"number in {at}", quoted(word), f"a finite number from {-caps.NUMBER:g} to {caps.NUMBER:g}")
    return found


def numbers_in(at: str, words: Sequence[str], count: int, valid: str, of: str = "numbers") -> Array:
    """Return the numbers (count,) of a line; InvalidFile for another count of them, and as `number`."""
    if len(words) != count:
        raise InvalidFile(f"{of} in {at}", len(words), valid)
    try:
        found = np.array(words, dtype=np.float64)
    except ValueError:
        found = np.full(count, np.nan)
    if not (np.abs(found) <= caps.NUMBER).all() or any("_" in word for word in words):
        for word in words:
            number(at, word)
    return found


def vector(array: Array) -> tuple[float, float, float]:
    """Return an array (3,) as three numbers."""
    x, y, z = (float(v) for v in array)
    return x, y, z
