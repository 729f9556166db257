"""Rows of the tables that benchmarks and later questions leave in a run's folder."""

import csv
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from avatarsim.errors import InvalidFile

Line = TypeVar("Line")


def lines(path: Path, made: Callable[[Mapping[str, str]], Line]) -> tuple[Line, ...]:
    """Every row of a CSV file; none when there is no such file. Raises InvalidFile for a file that is damaged."""
    if not path.exists():
        return ()
    try:
        with path.open(encoding="utf-8", newline="") as file:
            return tuple(made(row) for row in csv.DictReader(file))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the whole file that one command wrote") from error


def number(text: str) -> float:
    """A cell as a number; an empty one is not a number."""
    return float(text) if text else math.nan


def times(ours: float, best: float) -> float:
    """How many times as large; two nothings are the same, something over nothing is infinite, and nan stays nan."""
    if math.isnan(ours) or math.isnan(best):
        return math.nan
    return ours / best if best > 0.0 else 1.0 if ours == 0.0 else math.inf
