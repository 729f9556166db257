"""Reasons why a figure does not compare engines."""

from collections.abc import Iterable, Mapping
from typing import Protocol

import numpy as np
import pandas as pd

from runfiles.engines import about, run_label
from runfiles.timing_protocol import RANKED_REPEATS, TAIL_FRAMES, may_rank

AVATAR_METRIC = "tracker_offset_rms"
"""Metric that exactly the scenes with an avatar have."""

RESTING_METRIC, TIME = "resting_frames", "frame_time_"

ASLEEP_FROM: Mapping[str, float] = {"frame_time_p50": 50.0, "frame_time_p95": 95.0, "frame_time_p99": 99.0}
"""Share of resting frames [%] from which on a percentile of the frame time is that of a frame at rest."""

AVATAR_TIME = "avatarsim moves the avatar kinematically; other engines also simulate its dynamics"
ASLEEP = "bodies sleep in this frame"
FEW_FRAMES = f"timed over fewer than {RANKED_REPEATS} x {TAIL_FRAMES} frames"


class Note(Protocol):
    """Features that one run lacks in one scene."""

    @property
    def scenario(self) -> str: ...
    @property
    def run(self) -> str: ...
    @property
    def unsupported(self) -> Mapping[str, str]: ...
    @property
    def settings(self) -> Mapping[str, tuple[str, str]]: ...


def silenced_metrics(run: str, features: Iterable[str]) -> dict[str, str]:
    """Return the metrics that do not compare a run in a scene for which it lacks these features, with the reason."""
    engine, _, preset = run.partition("/")
    one, silenced = about(engine), dict[str, str]()
    for feature in features:
        if (lacking := one.unsupported.get(feature)) and (not lacking.presets or preset in lacking.presets):
            has_not = f"{run_label(run) if lacking.presets else one.label} has no {feature}"
            reason = has_not if lacking.lacks == "engine" else f"{feature}: not set up in {one.label}"
            silenced |= dict.fromkeys(lacking.metrics, reason)
    return silenced


def reasons(rows: pd.DataFrame, notes: Iterable[Note]) -> pd.Series:
    """Return for each row why it does not compare engines, "" where it does.

    Args:
        rows: with the columns scenario, run, metric, value and note.
        notes: of all runs.
    """
    notes, why = tuple(notes), pd.Series("", index=rows.index, dtype=object)
    if rows.empty:
        return why
    ranks = [may_rank(metric, note) for metric, note in zip(rows.metric, rows.note, strict=True)]
    why[~np.array(ranks, dtype=bool)] = FEW_FRAMES
    engine = rows.run.str.partition("/")[0]
    sleeping = {(note.scenario, note.run) for note in notes if _sleeps(note)}
    sleeps = engine.map(lambda name: about(name).sleeps).astype(bool) | pd.Series(_keys(rows), index=rows.index).isin(sleeping)
    rests = rows[(rows.metric == RESTING_METRIC) & sleeps].groupby("scenario").value.max()
    for metric, least in ASLEEP_FROM.items():
        why[(rows.metric == metric) & rows.scenario.isin(rests.index[rests >= least])] = ASLEEP
    why[rows.metric.str.startswith(TIME) & rows.scenario.isin(rows.scenario[rows.metric == AVATAR_METRIC])] = AVATAR_TIME
    if "status" in rows:
        for scene, name in {(scene, run.partition("/")[0]) for scene, run in _keys(rows[rows.status == "refused"])}:
            why[(rows.scenario == scene) & (why == "")] = f"{about(name).label} refuses the scene"
    lacking = {(note.scenario, note.run): silenced_metrics(note.run, note.unsupported) for note in notes}
    lacks = [lacking.get(key, {}).get(metric, "") for key, metric in zip(_keys(rows), rows.metric, strict=True)]
    return why.where([not reason for reason in lacks], pd.Series(lacks, index=rows.index, dtype=object))


def _keys(rows: pd.DataFrame) -> list[tuple[str, str]]:
    """Return (scene, run) of each row."""
    return list(zip(rows.scenario, rows.run, strict=True))


def _sleeps(note: Note) -> bool:
    """Return whether a setting puts resting bodies to sleep."""
    return str(note.settings.get("sleep", ("False", ""))[0]).lower() in ("true", "1")
