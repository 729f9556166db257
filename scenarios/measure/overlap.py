"""Residual overlap: depth of bodies in one another, found from poses by one judge for every engine."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from runfiles.record import Recording
from scenarios.measure.value import Missing, Value, Values

Array = NDArray[np.float64]
Deepest = Callable[[Array, Array], float]
"""Deepest overlap [m] in any of F states (F, n, 3), (F, n, 4): 0 when all are free, nan when the poses of one are no poses."""

SEEN = 1e-6
"""Depth [m] from which a frame counts as overlapping. The judge is right to 1e-8; smaller would count its own error."""
INSIDE_JUDGED = 1500
"""Most snapshots inside frames that are judged, spread evenly over all of them. Judging eight sub-steps of every frame
would take several times as long as the runs themselves; `--full` judges all."""


def residual_overlap(depths_shown: Array) -> Values:
    """Return residual_overlap_max, _p95, _mean [m] and overlap_frames [%] of the depths of all states shown; nan stays nan."""
    return {
        "residual_overlap_max": float(np.max(depths_shown)),
        "residual_overlap_p95": float(np.percentile(depths_shown, 95.0)),
        "residual_overlap_mean": float(np.mean(depths_shown)),
        # not (depth <= SEEN) rather than depth > SEEN: a pose that is no number is no free frame
        "overlap_frames": 100.0 * float(np.mean(~(depths_shown <= SEEN))),
    }


def substep_overlap(recording: Recording, deepest: Deepest, most: int | None = INSIDE_JUDGED) -> tuple[Value, str]:
    """Return substep_overlap_max [m] over the snapshots inside frames, and a note when only every k-th was judged."""
    total = len(recording.inside_time)
    if total == 0:
        return Missing("the engine gave no sub-steps", "scene"), ""
    stride = 1 if most is None else max(1, math.ceil(total / most))
    depth = deepest(recording.inside_positions[::stride], recording.inside_orientations[::stride])
    return depth, (f"every {stride}th of {total} sub-steps judged" if stride > 1 else "")
