"""Frame times: percentiles over frames of what one rendered frame costs, and where it goes."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scenarios.measure.value import Values

Integers = NDArray[np.int64]

ADAPTER = "adapter"
"""Stage in which an engine reports the Python that this project put round somebody else's engine. It is left out of that engine's
own time, in its favour; `frame_time_python_p50` has it."""


@dataclass(frozen=True, eq=False)
class Timed:
    """What the timing pass saw: R repeats of the same F frames.

    around_ns  (R, F) from outside, with the Python round the engine
    stage_ns   name -> (R, F) as the engine reports its stages, which do not overlap; empty when it reports none
    warmup     [s] import, load and first frames, in a fresh process; other engines may have been warming up beside it. nan in one
               that had run other scenes
    hashes     state hash of the last frame of each repeat
    """

    around_ns: Integers
    stage_ns: dict[str, Integers] = field(default_factory=dict)
    warmup: float = 0.0
    hashes: tuple[str, ...] = ()

    @property
    def engine_ns(self) -> Integers:
        """(R, F) engine only: the sum of its stages but the adapter's; the whole call from an engine that reports none."""
        own = [spent for name, spent in self.stage_ns.items() if name != ADAPTER]
        return sum(own, np.zeros_like(self.around_ns)) if own else self.around_ns

    @property
    def best_us(self) -> NDArray[np.float64]:
        """(F,) engine only [us], the least of all repeats: what the frame costs when nothing else disturbs."""
        return np.asarray(self.engine_ns.min(axis=0) / 1e3)


def frame_times(timed: Timed, recorded: tuple[str, ...] = ()) -> Values:
    """frame_time_* [us] from the per-frame minimum over repeats, frame_time_raw_* from all frames of all repeats,
    frame_time_python_p50 [us], warmup [s], stage_share_<stage> [%]; deterministic: 1 when all repeats ended in the same bits, and
    in those of the accuracy pass, another process, whose hashes by frame are `recorded`."""
    best, raw, around = timed.best_us, timed.engine_ns / 1e3, timed.around_ns.min(axis=0) / 1e3
    found = {"frame_time_max": float(best.max()), "frame_time_raw_max": float(raw.max())}
    for share in (50, 95, 99):
        found[f"frame_time_p{share}"] = float(np.percentile(best, share))
        found[f"frame_time_raw_p{share}"] = float(np.percentile(raw, share))
    found["frame_time_python_p50"] = float(np.percentile(around, 50))
    if not math.isnan(timed.warmup):
        found["warmup"] = timed.warmup
    total = float(timed.engine_ns.sum())
    for name, spent in timed.stage_ns.items():
        if name == ADAPTER:
            continue
        found[f"stage_share_{name}"] = 100.0 * float(spent.sum()) / total if total > 0.0 else 0.0
    if timed.hashes:
        frames = timed.around_ns.shape[1]
        elsewhere = recorded[frames : frames + 1]
        found["deterministic"] = float(len({*timed.hashes, *elsewhere}) == 1)
    return found
