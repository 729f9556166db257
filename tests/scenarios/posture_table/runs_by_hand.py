"""Runs with hand-made series: a few frames whose pooled figures can be worked out on paper."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from scenarios.job import Job
from scenarios.posture_table.runs import Seen
from scenarios.posture_table.series import Series


def series(frames: int = 4, **given: Sequence[float]) -> Series:
    """Zeros, but for what is given."""
    return Series(**{entry.name: np.array(given.get(entry.name, [0.0] * frames), dtype=np.float64) for entry in fields(Series)})


def run(
    scene: str = "scene", preset: str = "default", seed: int = 0, times: Sequence[float] = (), frames: int = 4,
    figures: dict[str, float] | None = None, **given: Sequence[float],
) -> Seen:
    """A run that was measured."""
    job = Job(scene, "avatarsim", preset, seed)
    return Seen(job, "measured", "", figures or {}, series(frames, **given), np.array(times, dtype=np.float64))
