"""Numbers and texts of untrusted files: what a word says, if it says a number that means anything."""

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
    """The beginning of a text, as far as a sentence quotes it."""
    return text[:SHOWN]


def lines_of(path: Path, kind: str) -> tuple[list[str], str]:
    """The lines of a file, `kind` in words, and how they end. Each character is one byte: whatever the encoding, what is written
    back by `in_bytes` is the same. Raises InvalidFile for what is no file, and for too many bytes or lines."""
    content = read_bytes(path, path.name, kind, caps.BYTES)
    count = content.count(b"\n") + content.count(b"\r")
    if count > caps.LINES:
        raise InvalidFile(f"lines of {path.name}", count, f"up to {caps.LINES}")
    newline = "\r\n" if b"\r\n" in content else "\n"
    return content.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n").split("\n"), newline


def in_bytes(text: str) -> bytes:
    """The bytes that `lines_of` read a text from."""
    return text.encode("latin-1")


def readable(text: str) -> str:
    """A name as it is meant: read as UTF-8 where its bytes are."""
    try:
        return in_bytes(text).decode("utf-8")
    except UnicodeDecodeError:
        return text


def without_mark(line: str) -> str:
    """A first line without the byte order mark that some editors put there."""
    return line.removeprefix(MARK)


def number(at: str, word: str) -> float:
    """The number that a word says; InvalidFile if it is none, or too large to mean anything."""
    try:
        found = float(word) if "_" not in word else np.nan
    except ValueError:
        found = np.nan
    if not abs(found) <= caps.NUMBER:
        raise InvalidFile(f"number in {at}", quoted(word), f"a finite number from {-caps.NUMBER:g} to {caps.NUMBER:g}")
    return found


def vector(array: Array) -> tuple[float, float, float]:
    """An array (3,) as three numbers."""
    x, y, z = (float(v) for v in array)
    return x, y, z
