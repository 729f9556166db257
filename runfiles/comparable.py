"""Reasons why a figure does not compare engines."""

from collections.abc import Iterable, Mapping
from typing import Protocol

import numpy as np
import pandas as pd

from runfiles.engines import about
from runfiles.timing_protocol import RANKED_REPEATS, TAIL_FRAMES, TAILS, may_rank

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
    def cannot_say(self) -> Mapping[str, str]: ...
    @property
    def settings(self) -> Mapping[str, tuple[str, str]]: ...


def unsupported(run: str, features: Iterable[str]) -> dict[str, str]:
    """Return the metrics that do not compare a run in a scene for which it lacks these features, with the reason."""
    engine, _, preset = run.partition("/")
    one, found = about(engine), dict[str, str]()
    for feature in features:
        lacking = one.unsupported.get(feature)
        if lacking is not None and (not lacking.presets or preset in lacking.presets):
            reason = f"{feature}: not set up in {one.label}" if lacking.lacks == "adapter" else f"{one.label} has no {feature}"
            found |= dict.fromkeys(lacking.metrics, reason)
    return found


def reasons(rows: pd.DataFrame, notes: Iterable[Note]) -> pd.Series:
    """Return for each row why it does not compare engines, "" where it does.

    Args:
        rows: with the columns scenario, run, metric, value and note.
        notes: of all runs.
    """
    notes = tuple(notes)
    why = pd.Series("", index=rows.index, dtype=object)
    times = rows.metric.str.startswith(TIME)
    why[rows.metric.isin(TAILS) & ~_ranks(rows)] = FEW_FRAMES
    sleepers = {(note.scenario, note.run) for note in notes if about(note.run.partition("/")[0]).sleeps or _sleeps(note)}
    resting = rows[(rows.metric == RESTING_METRIC) & rows.value.notna()]
    share: dict[str, float] = {}
    for scene, run, value in zip(resting.scenario, resting.run, resting.value, strict=True):
        if (scene, run) in sleepers or about(run.partition("/")[0]).sleeps:
            share[scene] = max(share.get(scene, 0.0), float(value))
    for metric, least in ASLEEP_FROM.items():
        scenes = [scene for scene, rests in share.items() if rests >= least]
        why[(rows.metric == metric) & rows.scenario.isin(scenes)] = ASLEEP
    avatars = set(rows.scenario[rows.metric == AVATAR_METRIC])
    why[times & rows.scenario.isin(avatars)] = AVATAR_TIME
    lacking = {
        (note.scenario, note.run, metric): reason
        for note in notes
        for metric, reason in unsupported(note.run, note.cannot_say).items()
    }
    for scene, engine in _refused(rows):
        why[(rows.scenario == scene) & (why == "")] = f"{about(engine).label} refuses the scene"
    if lacking:
        keys = zip(rows.scenario, rows.run, rows.metric, strict=True)
        found = pd.Series([lacking.get(key, "") for key in keys], index=rows.index, dtype=object)
        why = why.where(found == "", found)
    return why


def _refused(rows: pd.DataFrame) -> set[tuple[str, str]]:
    """Return (scene, engine) of scenes that an engine refuses, as the scene expects."""
    if "status" not in rows:
        return set()
    refused = rows[rows.status == "refused"]
    return {(scene, run.partition("/")[0]) for scene, run in zip(refused.scenario, refused.run, strict=True)}


def _ranks(rows: pd.DataFrame) -> np.ndarray:
    return np.array([may_rank(metric, note) for metric, note in zip(rows.metric, rows.note, strict=True)], dtype=bool)


def _sleeps(note: Note) -> bool:
    """Return whether a setting puts resting bodies to sleep."""
    return str(note.settings.get("sleep", ("False", ""))[0]).lower() in ("true", "1")
