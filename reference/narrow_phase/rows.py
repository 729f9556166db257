"""One row per cell, mode and contender: time and error, as narrow_phase.csv holds them."""

import csv
import io
from collections.abc import Sequence as Many
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.narrow_phase.cells import Cell
from reference.narrow_phase.clock import Clocked
from reference.narrow_phase.contender import Identity
from reference.narrow_phase.truth import errors

Array = NDArray[np.float64]

RIGHT = 1e-6
"""Metres up to which an answer counts as right: the bound on residual overlap. Only contenders that are right in every judged
query of a cell are rivals there."""

COARSE = 1e-4
"""Metres at which an error can be seen."""

NAMES = {"share_over_right": f"share_over_{RIGHT:g}", "share_over_coarse": f"share_over_{COARSE:g}"}
"""Columns whose names no field can have."""


@dataclass(frozen=True)
class Row:
    """Times [us] per query and errors [m] of one contender in one cell and mode; nan where nothing was measured.

    call_us is the cost of a call from Python that computes next to nothing: two spheres, measured in the same turns.
    Shares are of the judged queries; unanswered ones count as errors without end, in max_error_m too.
    """

    shape_a: str
    shape_b: str
    regime: str
    mode: str
    engine: str
    library: str
    per_call: bool
    us_p50: float
    us_p25: float
    us_p75: float
    call_us: float
    max_error_m: float
    share_over_right: float
    share_over_coarse: float
    unanswered: float
    judged: int
    repeats: int
    note: str = ""

    @property
    def cell(self) -> Cell:
        """Where it was measured."""
        return Cell(self.shape_a, self.shape_b, self.regime)

    @property
    def right(self) -> bool:
        """Whether every judged answer was right."""
        return self.max_error_m <= RIGHT


def row(cell: Cell, mode: str, identity: Identity, clocked: Clocked, truth: Array) -> Row:
    """The row of a contender that ran, or of one that did not: then all figures are nan and the note says why."""
    head = (cell.shape_a, cell.shape_b, cell.regime, mode, identity.name, identity.library, identity.per_call)
    if clocked.trouble:
        note, nothing = f"not measured: {clocked.trouble}", float("nan")
        return Row(*head, nothing, nothing, nothing, nothing, nothing, nothing, nothing, nothing, 0, 0, note)
    wrong = errors(clocked.answers, truth)
    low, middle, high = clocked.quartiles
    return Row(
        *head, middle, low, high, clocked.call, float(wrong.max()), float((wrong > RIGHT).mean()), float((wrong > COARSE).mean()),
        float(np.isinf(wrong).mean()), wrong.size, len(clocked.times),
    )


def csv_text(rows: Many[Any]) -> str:
    """Rows of one kind of dataclass as CSV; nan reads nan."""
    names = [entry.name for entry in fields(rows[0])]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([NAMES.get(name, name) for name in names])
    for each in rows:
        values = (getattr(each, name) for name in names)
        writer.writerow([f"{value:.6g}" if isinstance(value, float) else value for value in values])
    return text.getvalue()
