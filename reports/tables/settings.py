"""Settings of engines tried in a run: error against frame time, and how to copy them."""

import math
import tomllib
from pathlib import Path

import pandas as pd

from avatarsim.errors import InvalidFile
from runfiles.accuracy import FOLLOWING, counts, follows, length
from runfiles.engines import about

FILE = "sweep.csv"

TEXTS = ("scenario", "engine", "setting", "base", "options", "metric", "unit", "state", "settable")
NUMBERS = ("error", "p50", "p95", "slowest", "moving", "step", "rests", "sleeps", "avatar")
"""Columns of texts and of numbers."""

LEVELS = (("10 mm", 1e-2), ("1 mm", 1e-3), ("0.1 mm", 1e-4), ("1 µm", 1e-6))
"""Accuracies that a reader chooses from [m]."""

ASLEEP_FROM = 0.5
"""Share of resting frames from which on the median is that of a sleeping frame."""


def settings(folder: Path) -> pd.DataFrame | None:
    """Read the settings of a run; None where none were tried.

    Returns:
        A row per scene, engine and setting with the columns scenario, engine, setting, preset (flag), base, step [1/s]: NaN
        unless it alone differs from the preset, error: the largest [m], inf where a free user is not followed, worst: the metric
        of it, median, moving, p95, slowest [us], asleep (flag), measured (flag), native: lines to copy, alone (flag): they are
        all that the setting changes in the preset's model, options: the line of this project, avatar (flag).

    Raises:
        InvalidFile: for a damaged file.
    """
    path = folder / FILE
    if not path.exists():
        return None
    try:
        table = pd.read_csv(path, keep_default_na=True, dtype={name: str for name in TEXTS})
        table = table.astype(dict.fromkeys(NUMBERS, float)).fillna(dict.fromkeys(TEXTS, ""))
        found = [_setting(part) for _, part in table.groupby(["scenario", "engine", "setting"], sort=False)]
    except (ValueError, KeyError, AttributeError, OverflowError, pd.errors.ParserError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the file of one sweep") from error
    return pd.DataFrame(found) if found else None


def _setting(part: pd.DataFrame) -> dict[str, object]:
    first, measured = part.iloc[0], part[part.state == "measured"]
    engine, setting = str(first.engine), str(first.setting)
    errors = {
        row.metric: length(row.metric, row.error)
        for row in measured.itertuples()
        if counts(row.metric, row.unit if isinstance(row.unit, str) else "")
    }
    offsets = [row.error for row in measured.itertuples() if row.metric in FOLLOWING]
    error = max(errors.values(), default=math.nan)
    if any(not follows(float(one)) for one in offsets):
        error = math.inf
    options = first.options if isinstance(first.options, str) else ""
    moving = first.moving if pd.notna(first.moving) else math.nan
    return {
        "scenario": first.scenario,
        "engine": engine,
        "setting": setting,
        "preset": setting == first.base,
        "base": first.base,
        "step": _step(engine, options, first.step),
        "error": error,
        "worst": max(errors, key=errors.__getitem__, default=""),
        "median": first.p50,
        "moving": moving,
        "p95": first.p95,
        "slowest": first.slowest,
        "asleep": bool(first.sleeps) and pd.isna(moving) and first.rests >= ASLEEP_FROM,
        "measured": len(measured) > 0 and math.isfinite(first.p50),
        "native": "\n".join(about(engine).in_own_words(_values(engine, options))),
        "alone": first.settable != "",
        "options": options,
        "avatar": bool(first.avatar),
    }


def _step(engine: str, options: str, stated: float) -> float:
    """Steps a second of a setting that changes nothing else; NaN for an engine without a step of its own."""
    values = _values(engine, options)
    if set(values) - {"dt"}:
        # more than the step differs from the preset
        return math.nan
    given = values.get("dt")
    step = (
        float(given) if isinstance(given, int | float) and given else float(stated) if pd.notna(stated) and stated else math.nan
    )
    return 1.0 / step if step > 0.0 and "dt" in about(engine).native else math.nan


def _values(engine: str, options: str) -> dict[str, object]:
    """Options of a line of TOML of this project; empty for a preset."""
    try:
        rows = tomllib.loads(options).get(engine, {})
    except tomllib.TOMLDecodeError:
        return {}
    return {str(name): value for row in rows.values() for name, value in row.items() if name != "preset"}
