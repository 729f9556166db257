"""Rows of figures as CSV text, written and read: what benchmarks and later questions leave in a run's folder (RFC 4180)."""

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import astuple, fields
from pathlib import Path
from typing import TypeVar

from avatarsim.errors import InvalidFile
from avatarsim.files import read_text

DIGITS = 6
"""Significant digits of a figure: measurements of time and error have no more."""


def csv_lines(head: Sequence[str], lines: Iterable[Sequence[object]], digits: int = DIGITS) -> str:
    """A head and lines; numbers with a point to so many significant digits, nan empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    for line in lines:
        writer.writerow([_cell(value, digits) for value in line])
    return text.getvalue()


def csv_text(rows: Iterable[object], kind: type, digits: int = DIGITS) -> str:
    """Dataclass rows of one `kind`, which names the columns even where there is no row."""
    return csv_lines([entry.name for entry in fields(kind)], (astuple(row) for row in rows), digits)  # type: ignore[call-overload]


def _cell(value: object, digits: int) -> object:
    if not isinstance(value, float):
        return value
    return "" if math.isnan(value) else f"{value:.{digits}g}"


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
