"""What the gate says about a number of a table, in a word as well as in a colour."""

from reports.tables import Cell
from reports.verdict import believed
from reports.wording import limit


def cell_note(cell: Cell, ours: str) -> tuple[str, str]:
    """(class, word) of a cell: what the gate says about it, in a word as well as in a colour."""
    row = cell.row
    if row is None or row.value is None:
        return ("missing", "")
    status = believed(row, ours)
    if status == "fail":
        return ("failed", f"fails, limit {limit(row.limit, row.unit)}")
    if status == "ceiling":
        return ("above", f"above {limit(row.bound, row.unit)}")
    return ("held", "holds") if status == "pass" else ("", "")
