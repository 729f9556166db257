"""The table of figures that every run and study writes and every report reads: one row per figure."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import pandas as pd

from avatarsim.errors import InvalidFile

Status = Literal["pass", "waived", "fail", "info", "crashed", "not-measured", "cannot-say", "refused"]

STATUSES: tuple[Status, ...] = get_args(Status)

RESULTS = ("scenario", "engine", "preset", "seed", "frames", "metric", "value", "unit", "bound", "status")
"""First columns of results.csv, fixed: scripts of users read them."""

STUDIED = ("study", "scenario", "engine", "preset", "change", "seed", "frames", "metric", "value", "unit", "bound", "status",
           "note", "options")
"""Columns of the file of a study, NAME.csv."""

NUMBERS = ("seed", "frames", "value", "bound")


@dataclass(frozen=True)
class Row:
    """One figure of one run.

    value    None where nothing was measured, NaN where the number is not finite
    bound    promised limit, None without one
    ceiling  limit up to which a broken bound is waived, None without one
    note     reason of the status, or the protocol of a time
    study    name of the study, "" in the comparison itself
    change   difference of the run from its preset in its scene, "" without one
    options  the change as text to copy
    """

    scenario: str
    engine: str
    preset: str
    seed: int
    frames: int
    metric: str
    value: float | None
    unit: str
    bound: float | None
    ceiling: float | None
    status: Status
    note: str = ""
    study: str = ""
    change: str = ""
    options: str = ""

    @property
    def run(self) -> str:
        """Engine and preset as tables name them."""
        return f"{self.engine}/{self.preset}"

    @property
    def limit(self) -> float | None:
        """Limit above which a check fails."""
        return self.bound if self.ceiling is None else self.ceiling


def csv_text(rows: Sequence[Row], columns: Sequence[str], more: Iterable[Mapping[str, object]] = ()) -> str:
    """Return rows as CSV; a figure that was not measured is an empty field, one that is not finite reads nan or inf.

    Args:
        more: further fields of each row, whose names are among the columns.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    further: Sequence[Mapping[str, object]] = list(more) or [{}] * len(rows)
    writer.writerows(vars(row) | dict(fields) for row, fields in zip(rows, further, strict=True))
    return text.getvalue()


def read_study(folder: Path, study: str) -> pd.DataFrame | None:
    """Read the rows of a study; None where the run has none.

    Returns:
        The columns STUDIED, and run: engine/preset. Numbers are floats, NaN where nothing was measured; texts are "" where
        there are none.

    Raises:
        InvalidFile: for a damaged file.
    """
    path = folder / f"{study}.csv"
    if not path.exists():
        return None
    texts = [name for name in STUDIED if name not in NUMBERS]
    empty = dict.fromkeys(NUMBERS, ["", "nan"])
    try:
        table = pd.read_csv(path, dtype=dict.fromkeys(texts, str), keep_default_na=False, na_values=empty)
        table = table[list(STUDIED)].astype(dict.fromkeys(NUMBERS, float))
    except (ValueError, KeyError, OverflowError, AttributeError, pd.errors.ParserError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the whole file that a study wrote") from error
    if not table.status.isin(STATUSES).all():
        raise InvalidFile(f"status in {path}", sorted(set(table.status) - set(STATUSES)), f"one of {', '.join(STATUSES)}")
    return table.assign(run=table.engine + "/" + table.preset) if len(table) else None


def wide(table: pd.DataFrame) -> pd.DataFrame:
    """Turn rows into one row per scenario, run and change with a column per metric, NaN where nothing was measured."""
    keys = ["scenario", "engine", "preset", "run", "change", "options"]
    listed = table[keys].drop_duplicates()
    figures = table[table.metric != "run"].drop_duplicates([*keys, "metric"])
    values = figures.pivot(index=keys, columns="metric", values="value")
    return values.reindex(pd.MultiIndex.from_frame(listed)).reset_index()
