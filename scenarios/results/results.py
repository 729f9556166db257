"""Files of a run for reports and other readers: results.json, results.csv, bench.csv."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal

import pandas as pd

from runfiles.comparable import reasons
from runfiles.files import plain, write_json, write_text
from runfiles.published import SCHEMA_VERSION, check
from scenarios.job import Outcome

Status = Literal["pass", "waived", "fail", "info", "crashed", "not-measured", "cannot-say", "refused"]
COLUMNS = ("scenario", "engine", "preset", "seed", "frames", "metric", "value", "unit", "bound", "status")
"""First columns of results.csv, fixed: scripts of users read them."""
MORE = ("waiver", "comparable", "why")
"""Columns of results.csv behind those: up to which value a figure is waived; whether it compares engines, and why not."""


@dataclass(frozen=True)
class Row:
    """One figure of one run. `value` is None where nothing was measured; `bound` is the promise, `ceiling` up to where
    it is waived; `note` says why a status is what it is."""

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

    @property
    def run(self) -> str:
        """Engine and preset as tables name them."""
        return f"{self.engine}/{self.preset}"


@dataclass(frozen=True, eq=False)
class Results:
    """Everything a run has found so far. `series`: scenario -> engine/preset -> name -> numbers per frame."""

    rows: Sequence[Row]
    outcomes: Sequence[Outcome]
    series: Mapping[str, Mapping[str, Mapping[str, Sequence[float | None]]]]
    scenes: Mapping[str, Mapping[str, str | bool | float]]
    provenance: Mapping[str, object]
    exit_code: int | None
    notes: Sequence[str] = ()


def csv_text(rows: Sequence[Row], columns: Sequence[str] = COLUMNS, whys: Sequence[str] | None = None) -> str:
    """Rows as CSV, with MORE columns where ``whys`` says of each why it does not compare engines, "" where it does.

    A figure that was not measured is an empty field, one that is no number reads nan.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, columns if whys is None else (*columns, *MORE), extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    for row, why in zip(rows, [""] * len(rows) if whys is None else whys, strict=True):
        more = {"waiver": row.ceiling, "comparable": "no" if why else "yes", "why": why}
        writer.writerow({name: "" if value is None else value for name, value in (vars(row) | more).items()})
    return text.getvalue()


@dataclass(frozen=True, eq=False)
class _Said:
    """Unsupported features and settings of one run."""

    scenario: str
    run: str
    cannot_say: Mapping[str, str]
    settings: Mapping[str, tuple[str, str]]


def _whys(results: Results) -> list[str]:
    """Return for each row why it does not compare engines, "" where it does."""
    if not results.rows:
        return []
    table = pd.DataFrame([{**vars(row), "run": row.run} for row in results.rows])
    said = []
    for one in results.outcomes:
        about: Mapping[str, Any] = one.about
        said.append(_Said(one.job.scenario, one.job.run, about.get("cannot_say", {}), about.get("settings", {})))
    return [str(why) for why in reasons(table, said)]


def write(results: Results, folder: Path) -> None:
    """Write results.csv, results.json and, once something was timed, bench.csv, in which each time says how it was taken; each
    whole or not at all.

    The results of a run that has ended are checked against their published layout, once they are safe in their file; raises
    InvalidFile if they break it.
    """
    write_text(folder / "results.csv", csv_text(results.rows, whys=_whys(results)))
    times = [row for row in results.rows if is_time(row.metric)]
    if times:
        write_text(folder / "bench.csv", csv_text(times, (*COLUMNS, "note")))
    whole = {
        "schema_version": SCHEMA_VERSION,
        "provenance": results.provenance,
        "exit_code": results.exit_code,
        "scenes": results.scenes,
        "rows": [vars(row) for row in results.rows],
        "engines": [
            {
                "name": outcome.job.engine, "preset": outcome.job.preset, "scenario": outcome.job.scenario,
                "seed": outcome.job.seed, "recording": outcome.recording.name if outcome.recording else None,
                "version": outcome.about.get("version", ""), "cannot_say": outcome.about.get("cannot_say", {}),
                "settings": outcome.about.get("settings", {}),
            }
            for outcome in results.outcomes
        ],
        "series": results.series,
        "notes": list(results.notes),
    }
    write_json(folder / "results.json", whole)
    if results.exit_code is not None and results.rows and find_spec("jsonschema"):
        # without the report's packages there is no checker, and no report that could mislead
        check(plain(whole), folder / "results.json")


def is_time(metric: str) -> bool:
    """Whether a metric comes from the timing pass."""
    return metric.startswith(("frame_time", "stage_share")) or metric in ("warmup", "deterministic")
