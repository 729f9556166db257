"""Numbers and texts of files from strangers: what a word says, if it says a number that means anything."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.caps import LARGEST_NUMBER
from avatarsim.errors import InvalidFile

Array = NDArray[np.float64]

SHOWN = 80
"""Characters of a line that a sentence quotes."""


def quoted(text: str) -> str:
    """The beginning of a text, as far as a sentence quotes it."""
    return text[:SHOWN]


def decoded(content: bytes) -> tuple[str, str]:
    """The text of a file and its encoding: UTF-8, with or without a byte order mark, or else Latin-1, which takes all."""
    encoding = "utf-8-sig" if content.startswith(b"\xef\xbb\xbf") else "utf-8"
    try:
        return content.decode(encoding), encoding
    except UnicodeDecodeError:
        return content.decode("latin-1"), "latin-1"


def number(at: str, word: str) -> float:
    """The number that a word says; InvalidFile if it is none, or too large to mean anything."""
    try:
        found = float(word) if "_" not in word else np.nan
    except ValueError:
        found = np.nan
    if not abs(found) <= LARGEST_NUMBER:
        raise InvalidFile(f"number in {at}", quoted(word), f"a finite number from {-LARGEST_NUMBER:g} to {LARGEST_NUMBER:g}")
    return found


def vector(array: Array) -> tuple[float, float, float]:
    """An array (3,) as three numbers."""
    x, y, z = (float(v) for v in array)
    return x, y, z
