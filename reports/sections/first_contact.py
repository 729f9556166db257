"""Frame times of the frames in which contact begins, apart from all others: a mean hides what a user feels as a hitch."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reports.deciding.tables import RAW_TRACKER, engine_of
from reports.reading.load import Array, Results, Series
from reports.words.wording import count, listed, quantity

SEEN = 1e-6
"""Overlap [m] of the raw tracker from which it is in contact: the same instants for all engines."""
CALM, LASTS = 5, 3
"""Frames without contact before it counts as beginning, and frames for which it counts as just begun."""


@dataclass(frozen=True)
class Split:
    """One engine in one scene: median time [us] of frames just after contact began, the slowest of them, median of the others."""

    scene: str
    run: str
    begun: float
    slowest: float
    others: float
    onsets: int

    @property
    def factor(self) -> float:
        """How many times as long a frame takes in which contact has just begun."""
        return self.begun / self.others if self.others > 0.0 else math.nan


def onsets(overlap: Array) -> NDArray[np.int64]:
    """States of the raw tracker (F+1,) in which it begins to overlap after CALM states without."""
    touches = ~(overlap <= SEEN)
    return np.array([k for k in range(CALM, len(touches)) if touches[k] and not touches[k - CALM : k].any()], dtype=np.int64)


def splits(results: Results) -> tuple[Split, ...]:
    """Every engine that was timed in a scene in which the tracker's contact begins within the timed frames."""
    found = []
    for scene, runs in results.series.items():
        raw = next((series.overlap for run, series in runs.items() if engine_of(run) == RAW_TRACKER), np.zeros(0))
        begins = onsets(raw)
        for run, series in runs.items():
            if (split := _split(scene, run, series, begins)) is not None:
                found.append(split)
    return tuple(found)


def _split(scene: str, run: str, series: Series, begins: NDArray[np.int64]) -> Split | None:
    times = series.frame_time
    fresh = np.zeros(times.size, dtype=bool)
    counted = 0
    for state in begins:
        # state k is what frame k, the k-th to be timed, has led to
        if state - 1 < times.size:
            fresh[state - 1 : state - 1 + LASTS] = True
            counted += 1
    sound = np.isfinite(times)
    if not counted or not (fresh & sound).any() or not (~fresh & sound).any():
        return None
    begun, others = times[fresh & sound], times[~fresh & sound]
    return Split(scene, run, float(np.median(begun)), float(begun.max()), float(np.median(others)), counted)


def sentence(found: Sequence[Split], ours: str) -> str:
    """What to conclude about ours, and which engine is hit most."""
    own = [split for split in found if split.run == ours]
    if not own:
        return f"No contact of the raw tracker begins in any frame in which {ours} was timed."
    worst = max(own, key=lambda split: split.factor)
    said = (f"Where contact begins, a frame of ours takes {worst.factor:.2g} times its usual time at most "
            f"({worst.scene}: {quantity(worst.begun, 'us')} against {quantity(worst.others, 'us')}), and its slowest "
            f"{quantity(max(split.slowest for split in own), 'us')}")
    scenes = {split.scene: split for split in own}
    ahead = tuple(f"{split.run} in {split.scene}" for split in found
                  if split.run != ours and engine_of(split.run) != engine_of(ours) and split.scene in scenes
                  and split.slowest < scenes[split.scene].slowest)
    return f"{said}. Faster in their slowest such frame: {listed(ahead, 4)}." if ahead else (
        f"{said}. No other engine's slowest such frame is faster, in {count(len(own), 'scene')}.")


def by_scene(found: Sequence[Split]) -> Mapping[str, Sequence[Split]]:
    """The same, gathered by scene."""
    return {scene: [split for split in found if split.scene == scene] for scene in dict.fromkeys(s.scene for s in found)}
