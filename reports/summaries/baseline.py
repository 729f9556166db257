"""The committed baseline: what our engine's accuracy was, in one small file that later runs are compared with."""

import csv
import io
import math
from pathlib import Path

from avatarsim.errors import InvalidFile
from reports.deciding.columns import COLUMNS, worst
from reports.deciding.tables import gated_run
from reports.reading.load import Results, Row
from reports.sections.unseen import changes_with_commits
from runfiles.csv_rows import lines, number

BASELINE = "baseline"
"""Name in the provenance of results that are only such a file."""
HEAD = ("scenario", "run", "metric", "unit", "value")


def text(results: Results) -> str:
    """The file for a run: every accuracy figure of the verdict table of the gated engine, worst seed. Three digits: what is finer
    is the machine's."""
    ours = gated_run(results.rows)
    grouped: dict[tuple[str, str], list[Row]] = {}
    for row in results.rows:
        if changes_with_commits(row.scenario):
            continue
        if row.run == ours and row.unit != "us" and row.value is not None and any(c.takes(row.metric) for c in COLUMNS):
            grouped.setdefault((row.scenario, row.metric), []).append(row)
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    writer.writerow(HEAD)
    for (scene, metric), rows in sorted(grouped.items()):
        shown = worst(rows)
        if shown is not None and shown.value is not None:
            writer.writerow([scene, shown.run, metric, shown.unit, f"{shown.value:.3g}"])
    return written.getvalue()


def load(path: Path) -> Results:
    """The file as results without series. Raises InvalidFile when it is missing, damaged or empty."""
    found = lines(path, lambda row: _row(row["scenario"], row["run"], row["metric"], row["unit"], number(row["value"])))
    if not found:
        raise InvalidFile(str(path), "no row", "a file that `python -m reports baseline` wrote")
    return Results(found, {}, (), {BASELINE: str(path)}, 0, {}, ())


def _row(scene: str, run: str, metric: str, unit: str, value: float) -> Row:
    engine, _, preset = run.partition("/")
    if not math.isfinite(value):
        raise ValueError(f"{metric} of {scene} is {value}")
    return Row(scene, engine, preset, 0, 0, metric, value, unit, None, None, "info", "")
