"""Settings of engines tried in a run: error against frame time, and the options of each."""

import json
import math
import tomllib
from collections.abc import Collection
from pathlib import Path

import pandas as pd

from reports.tables.run import Run
from runfiles.accuracy import FOLLOWING, follows, lengths
from runfiles.comparable import ASLEEP_FROM
from runfiles.engines import about
from runfiles.table import read_study, wide
from runfiles.timing_protocol import may_rank

STUDY = "settings"

LEVELS = (("10 mm", 1e-2), ("1 mm", 1e-3), ("0.1 mm", 1e-4), ("1 µm", 1e-6))
"""Accuracies that a reader chooses from [m]."""
KEYS = ["scenario", "engine", "preset", "change", "options"]
"""Columns that tell settings apart."""
SPOILS = ("wrong_side_frames", "not_finite_frames")
"""Metrics that must be 0, or a small error means nothing."""


def settings(folder: Path) -> pd.DataFrame | None:
    """Read the settings of a run; None where none were tried.

    Returns:
        A row per scene, engine and setting with the columns scenario, engine, setting, preset (flag), base, step [1/s]: NaN
        unless it alone differs from the preset, error: the largest [m], inf where a free user is not followed, worst: the metric
        of it, median, p95, slowest [us], few (flag): too few frames were timed for the last two, asleep (flag), measured
        (flag), alone (flag): its options are all that it changes in the preset's model, options: the line of this project.

    Raises:
        InvalidFile: for a damaged file.
    """
    table = read_study(folder, STUDY)
    if table is None:
        return None
    ranks = [may_rank(metric, note) for metric, note in zip(table.metric, table.note, strict=True)]
    few = set(table.loc[[not one for one in ranks], KEYS].itertuples(index=False, name=None))
    return pd.DataFrame([_setting(row, few) for row in wide(table).to_dict("records")])


def preset_options(run: Run, scenario: str, engine: str, preset: str) -> dict[str, object]:
    """Return the options of a preset in a scene that differ from the engine's default."""
    notes = {note.run: note.settings for note in run.results.engines if note.scenario == scenario}
    plain, chosen = (notes.get(f"{engine}/{name}", {}) for name in ("default", preset))
    differing = {name: value for name, (value, _) in chosen.items() if name in plain and plain[name][0] != value}
    return {name: _parsed(value) for name, value in differing.items() if name != "optimises" and " " not in name}


def _parsed(text: str) -> object:
    try:
        return json.loads(text)
    except ValueError:
        return text


def _setting(row: dict[str, object], few: Collection[tuple[object, ...]]) -> dict[str, object]:
    def number(metric: str) -> float:
        value = row.get(metric)
        return float(value) if isinstance(value, int | float) else math.nan

    engine, base, change, options = (str(row[name]) for name in ("engine", "preset", "change", "options"))
    values = options_of(engine, options)
    sound = all(number(metric) == 0.0 for metric in SPOILS if metric in row and not math.isnan(number(metric)))
    names = [name for name in row if name.endswith(("_max", "_rms", "_rms_free")) and not name.startswith("frame_time_")]
    errors = lengths({name: number(name) for name in names if not math.isnan(number(name))})
    error = max(errors.values(), default=math.nan) if sound else math.nan
    if sound and not all(follows(number(name)) for name in FOLLOWING):
        error = math.inf
    moving, one = number("frame_time_moving_p50"), about(engine)
    sleeps = one.sleeps and "sleeping" not in options or base == "sleeping" or values.get("sleep") is True
    return {
        "scenario": row["scenario"], "engine": engine, "setting": change or base, "preset": not change, "base": base,
        "step": _step(engine, values, number("time_step")), "error": error,
        "worst": max(errors, key=errors.__getitem__, default=""), "median": number("frame_time_p50"),
        "p95": number("frame_time_p95"), "slowest": number("frame_time_max"),
        "few": tuple(row[key] for key in KEYS) in few,
        "asleep": sleeps and math.isnan(moving) and number("resting_frames") >= ASLEEP_FROM["frame_time_p50"],
        "measured": sound and not math.isnan(error) and math.isfinite(number("frame_time_p50")),
        "alone": bool(values) and set(values) <= set(one.alone),
        "options": options,
    }


def _step(engine: str, values: dict[str, object], stated: float) -> float:
    """Return the steps a second of a setting that changes nothing else; NaN for an engine without a step of its own."""
    if set(values) - {"dt"} or not about(engine).has_time_step:
        return math.nan
    given = values.get("dt")
    step = float(given) if isinstance(given, int | float) else stated
    return 1.0 / step if step > 0.0 else math.nan


def options_of(engine: str, options: str) -> dict[str, object]:
    """Return the options in a line of TOML of this project; empty for a preset."""
    return {name: value for row in rows_of(engine, options).values() for name, value in row.items() if name != "preset"}


def rows_of(engine: str, options: str) -> dict[str, dict[str, object]]:
    """Return the rows of an engine in a line of TOML of this project, by name; empty for a preset."""
    try:
        return {str(name): dict(row) for name, row in tomllib.loads(options.partition("; ")[0]).get(engine, {}).items()}
    except tomllib.TOMLDecodeError:
        return {}
