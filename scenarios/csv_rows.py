"""Rows of figures as CSV text: what reports and spreadsheets read. A figure that there is none of is an empty cell."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, fields

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
