"""The table as Markdown and as CSV, with the units that a reader expects: millimetres where the figures are small."""

import math
from collections.abc import Iterable, Sequence

from runfiles.csv_rows import csv_text
from scenarios.posture_table.rows import MOVES, TURNS, Row

COLUMNS: tuple[tuple[str, str, float, str], ...] = (
    ("engine", "engine", 0.0, ""), ("group", "group", 0.0, ""), ("runs", "runs", 1.0, "d"), ("frames", "frames", 1.0, "d"),
    ("overlap", "overlap m", 1.0, ".2g"), ("limits", "limits deg", 1.0, ".2g"), ("not_finite", "not finite", 1.0, "d"),
    ("wrong_side", "wrong side", 1.0, "d"),
    ("contact", "contact frames", 1.0, "d"), ("chatter", "chatter %", 1.0, ".2f"),
    ("reversal_p95", "reversal p95 mm", 1e3, ".2f"), ("jerk_ratio", "jerk ratio", 1.0, ".2f"),
    ("turns", f"turns > {TURNS:g} deg", 1.0, "d"), ("turn_max", "largest deg", 1.0, ".1f"),
    ("root_moves", f"root > {MOVES:g} m", 1.0, "d"), ("root_max", "largest m", 1.0, ".3f"), ("silent", "silent frames", 1.0, "d"),
    ("owed", "free 0.5 s", 1.0, "d"), ("far", "of these > 10 cm off %", 1.0, ".2f"), ("offset_p50", "offset p50 mm", 1e3, ".2f"),
    ("offset_p95", "p95 mm", 1e3, ".1f"), ("angle_p50", "angle p50 deg", 1.0, ".2f"), ("angle_p95", "p95 deg", 1.0, ".1f"),
    ("time_p50", "time p50 us", 1.0, ".1f"), ("time_p99", "p99 us", 1.0, ".1f"), ("time_max", "max us", 1.0, ".0f"),
    ("slowest", "slowest frame", 0.0, ""),
)
"""Field of a row, head of its column, factor to the unit in the head, and format."""


def cell(row: Row, name: str, factor: float, form: str) -> str:
    """One figure; "-" where there is none."""
    value = getattr(row, name)
    if isinstance(value, str):
        return value or "-"
    return "-" if math.isnan(value) else format(value if form == "d" else factor * value, form)


def markdown(lines: Iterable[Sequence[str]]) -> str:
    """A head and lines of cells as a Markdown table with columns that also line up as text."""
    cells = [[text.replace("|", "\\|") for text in line] for line in lines]
    widths = [max(len(line[k]) for line in cells) for k in range(len(cells[0]))]
    told = ["| " + " | ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)) + " |" for line in cells]
    return "\n".join([told[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *told[1:]])


def table(found: Sequence[Row]) -> str:
    """All rows as Markdown."""
    return markdown([[head for _, head, _, _ in COLUMNS],
                     *([cell(row, name, factor, form) for name, _, factor, form in COLUMNS] for row in found)])


def as_csv(found: Sequence[Row]) -> str:
    """All rows as CSV, in SI units and degrees, shares in percent, times in microseconds."""
    return csv_text(found, Row)
