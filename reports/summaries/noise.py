"""Bootstrap over frames: how sure a change of frame time between two runs of the same scene is."""

import numpy as np

from reports.reading.load import Array

RESAMPLES = 500
"""Resamples; more narrow the ends of the interval by less than they mean."""
BLOCK = 10
"""Frames drawn together: neighbouring frames are alike, and drawn one by one they would look surer than they are."""
CERTAINTY = 99.0
"""Percent of the resamples that the interval holds; with a hundred comparisons a run, one would be wrong at 99 by chance alone,
and the factor that a change must have besides takes care of those."""


def interval(old: Array, new: Array, percent: float, seed: int = 0) -> tuple[float, float] | None:
    """Ends of the interval of new over old in the `percent`-th percentile of frame times (F,); None with too few frames.

    Frames are drawn in blocks, the same ones from both runs as far as both have them: frame k is the same instant of the scene.
    """
    frames = min(old.size, new.size)
    sound = np.flatnonzero(np.isfinite(old[:frames]) & np.isfinite(new[:frames]) & (old[:frames] > 0.0))
    if sound.size < 3 * BLOCK:
        return None
    a, b = old[sound], new[sound]
    draw = np.random.default_rng(seed)
    starts = draw.integers(0, sound.size - BLOCK + 1, size=(RESAMPLES, sound.size // BLOCK))
    chosen = (starts[..., None] + np.arange(BLOCK)).reshape(RESAMPLES, -1)
    ratios = np.percentile(b[chosen], percent, axis=1) / np.percentile(a[chosen], percent, axis=1)
    tail = 0.5 * (100.0 - CERTAINTY)
    return float(np.percentile(ratios, tail)), float(np.percentile(ratios, 100.0 - tail))
