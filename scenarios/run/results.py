"""Files of a run for reports and other readers: results.json, results.csv, bench.csv."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from runfiles.comparable import reasons
from runfiles.files import plain, write_json, write_text
from runfiles.published import SCHEMA_VERSION, check
from runfiles.table import RESULTS, Row, csv_text
from scenarios.job import Outcome

FIELDS = (*RESULTS, "ceiling", "note")
"""Fields of a row in results.json."""
MORE = ("waiver", "comparable", "why")
"""Last columns of results.csv: limit up to which a figure is waived, whether it compares engines, the reason if not."""


@dataclass(frozen=True, eq=False)
class Results:
    """All that a run has found so far. `series`: scenario -> engine/preset -> name -> numbers per frame."""

    rows: Sequence[Row]
    outcomes: Sequence[Outcome]
    series: Mapping[str, Mapping[str, Mapping[str, Sequence[float | None]]]]
    scenes: Mapping[str, Mapping[str, str | bool | float]]
    provenance: Mapping[str, object]
    exit_code: int | None
    notes: Sequence[str] = ()


class _Note(NamedTuple):
    """Unsupported features and settings of one run."""

    scenario: str
    run: str
    unsupported: Mapping[str, str]
    settings: Mapping[str, tuple[str, str]]


def _reasons(results: Results) -> list[str]:
    """Return for each row the reason why it does not compare engines, "" where it does."""
    if not results.rows:
        return []
    notes = []
    for one in results.outcomes:
        about: Mapping[str, Any] = one.about
        notes.append(_Note(one.job.scenario, one.job.run, about.get("unsupported", {}), about.get("settings", {})))
    found = reasons(pd.DataFrame([{**vars(row), "run": row.run} for row in results.rows]), notes)
    return [str(why) or (row.note if row.metric == "run" else "") for row, why in zip(results.rows, found, strict=True)]


def write(results: Results, folder: Path) -> None:
    """Write results.csv, results.json and, once something was timed, bench.csv, each whole or not at all.

    Raises:
        InvalidFile: if the results of a run that has ended, by then safe in their file, break their published layout.
    """
    more = [
        {"waiver": row.ceiling, "comparable": "no" if why else "yes", "why": why}
        for row, why in zip(results.rows, _reasons(results), strict=True)
    ]
    write_text(folder / "results.csv", csv_text(results.rows, (*RESULTS, *MORE), more))
    if times := [row for row in results.rows if is_time(row.metric)]:
        write_text(folder / "bench.csv", csv_text(times, (*RESULTS, "note")))
    whole = {
        "schema_version": SCHEMA_VERSION, "provenance": results.provenance, "exit_code": results.exit_code,
        "scenes": results.scenes, "rows": [{name: getattr(row, name) for name in FIELDS} for row in results.rows],
        "engines": [
            {
                "name": one.job.engine, "preset": one.job.preset, "scenario": one.job.scenario, "seed": one.job.seed,
                "recording": one.recording.name if one.recording else None, "version": one.about.get("version", ""),
                "unsupported": one.about.get("unsupported", {}), "settings": one.about.get("settings", {}),
            }
            for one in results.outcomes
        ],
        "series": results.series, "notes": list(results.notes),
    }
    write_json(folder / "results.json", whole)
    if results.exit_code is not None and results.rows and find_spec("jsonschema"):
        # without the report's packages there is no checker, and no report that could mislead
        check(plain(whole), folder / "results.json")


def is_time(metric: str) -> bool:
    """Return whether a metric comes from the timing pass."""
    return metric.startswith(("frame_time", "stage_share")) or metric in ("warmup", "deterministic")
