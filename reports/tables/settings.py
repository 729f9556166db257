"""Settings of engines tried in a run: error against frame time, and how to copy them."""

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
from runfiles.native_files import written
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
        (flag), native: lines to copy, alone (flag): they are
        all that the setting changes in the preset's model, options: the line of this project.

    Raises:
        InvalidFile: for a damaged file.
    """
    table = read_study(folder, STUDY)
    if table is None:
        return None
    ranks = [may_rank(metric, note) for metric, note in zip(table.metric, table.note, strict=True)]
    few = set(table.loc[[not one for one in ranks], KEYS].itertuples(index=False, name=None))
    return pd.DataFrame([_setting(row, few) for row in wide(table).to_dict("records")])


def preset_words(run: Run, scenario: str, name: str) -> tuple[str, list[str]]:
    """Return the line that loads a run "engine/preset", "" without one; and a line for its step and each option that differs from
    the engine's default and is all that it changes in a model."""
    engine, _, preset = name.partition("/")
    one, notes = about(engine), {note.run: note.settings for note in run.results.engines if note.scenario == scenario}
    file = Path(written(run.folder, scenario, name, int(run.rows.seed.iloc[0]))).name.removesuffix(".gz")
    loads = one.loads.format(file=file, preset=preset) if file or "{file}" not in one.loads else ""
    plain = notes.get(f"{engine}/default", {})
    differing = {
        key: _parsed(value) for key, (value, _) in notes.get(name, {}).items()
        if key in ("dt", *one.alone) and key in one.native and plain.get(key, ("", ""))[0] != value
    }
    return loads, one.in_own_words(differing)


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
    values = _values(engine, options)
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
        "native": "\n".join(one.in_own_words(values)), "alone": bool(values) and set(values) <= set(one.alone),
        "options": options,
    }


def _step(engine: str, values: dict[str, object], stated: float) -> float:
    """Return the steps a second of a setting that changes nothing else; NaN for an engine without a step of its own."""
    if set(values) - {"dt"} or not about(engine).has_time_step:
        return math.nan
    given = values.get("dt")
    step = float(given) if isinstance(given, int | float) else stated
    return 1.0 / step if step > 0.0 else math.nan


def _values(engine: str, options: str) -> dict[str, object]:
    """Return the options of a line of TOML of this project; empty for a preset."""
    try:
        rows = tomllib.loads(options).get(engine, {})
    except tomllib.TOMLDecodeError:
        return {}
    return {str(name): value for row in rows.values() for name, value in row.items() if name != "preset"}
