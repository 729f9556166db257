"""What the gate says about a number of a table, in a word as well as in a colour."""

import re

from reports.deciding.tables import Cell
from reports.deciding.verdict import believed
from reports.words.wording import limit
from runfiles.timing_protocol import brief

TIMED_OVER = ("frame_time_p50", "frame_time_p95", "frame_time_max")
"""Times beside which stands how many repeats of which frames they are over."""


def cell_note(cell: Cell, ours: str) -> tuple[str, str]:
    """(class, word) of a cell: what the gate says about it, in a word as well as in a colour; of a time, over
    which frames it was taken."""
    row = cell.row
    if row is None or row.value is None:
        return ("missing", "")
    status = believed(row, ours)
    if status == "fail":
        return ("failed", f"fails, limit {limit(row.limit, row.unit)}")
    if status == "waived":
        return ("above", f"waived, above {limit(row.bound, row.unit)}")
    if status == "pass":
        return ("held", "holds")
    if cell.unsaid:
        return ("how", f"not ranked: {cell.unsaid.partition(':')[0]}")
    if row.metric not in TIMED_OVER or not row.note:
        return ("", "")
    # a line of its own for each part, as narrow as the column
    return ("how", re.sub(r"(?<![;,]) ", "\u00a0", brief(row.note).replace(" us", " µs")))
