"""One row per layout, motion, number of objects and kernel, as broad_phase.csv holds them, and whether a row of them is flat."""

import csv
import io
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from typing import Final

FLAT: Final = 2.0
"""Largest figure per object over the smallest, up to which growth is called flat."""


@dataclass(frozen=True)
class Row:
    """Time per object and frame [us], memory per object [bytes] kept between frames, near pairs, and whether the same pairs
    were found as by trying all."""

    layout: str
    motion: str
    objects: int
    kernel: str
    us_per_object_p50: float
    bytes_per_object: float
    near_pairs: int
    found_is_twin: bool


def csv_text(rows: Sequence[Row]) -> str:
    """All rows as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([entry.name for entry in fields(Row)])
    for row in rows:
        writer.writerow([f"{value:.6g}" if isinstance(value, float) else value for value in astuple(row)])
    return text.getvalue()


def growth(rows: Sequence[Row], of: str) -> tuple[float, int, int]:
    """(largest over smallest figure per object, the number of objects with each) for rows that differ in it alone."""
    ordered = sorted(rows, key=lambda row: float(getattr(row, of)))
    low, high = float(getattr(ordered[0], of)), float(getattr(ordered[-1], of))
    return (high / low if low > 0.0 else float("inf")), ordered[-1].objects, ordered[0].objects
