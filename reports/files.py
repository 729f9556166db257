"""Rows of the tables that benchmarks and later questions leave in a run's folder."""

import csv
import io
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from avatarsim.errors import InvalidFile
from avatarsim.files import read_text

Line = TypeVar("Line")
WHOLE = "the whole file that one command wrote"
DAMAGED = (csv.Error, ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""What is raised over a table or an object that lacks something, or holds something of another kind."""


def lines(path: Path, made: Callable[[Mapping[str, str]], Line]) -> tuple[Line, ...]:
    """Every row of a CSV file; none when there is no such file. Raises InvalidFile for a file that is damaged."""
    if not path.exists():
        return ()
    text = read_text(path, str(path), WHOLE)
    try:
        return tuple(made(row) for row in csv.DictReader(io.StringIO(text, newline="")))
    except DAMAGED as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", WHOLE) from error


def number(text: str) -> float:
    """A cell as a number; an empty one is not a number."""
    return float(text) if text else math.nan


def times(ours: float, best: float) -> float:
    """How many times as large; two nothings are the same, something over nothing is infinite, and nan stays nan."""
    if math.isnan(ours) or math.isnan(best):
        return math.nan
    return ours / best if best > 0.0 else 1.0 if ours == 0.0 else math.inf
