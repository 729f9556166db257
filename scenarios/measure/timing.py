"""Frame times: percentiles over frames of what one rendered frame costs, and where it goes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scenarios.measure.value import Missing, Value, Values

Integers = NDArray[np.int64]

ADAPTER = "adapter"
"""Stage in which an engine reports the Python that this project put round somebody else's engine. It is left out of that engine's
own time, in its favour; `frame_time_python_p50` has it."""
REPEATS = 3
"""How often the same frames are run where there is time for it; the least of each frame is what it costs undisturbed. With two, a
disturbance of both is taken for the frame's own cost."""
ENOUGH_FRAMES = 200
"""Different frames below which there is no 99th percentile: it would be the slowest frame, or the one before it."""
PHASE_FRAMES = 30
"""Timed frames of a phase below which it has no median of its own."""


@dataclass(frozen=True, eq=False)
class Timed:
    """What the timing pass saw: R repeats of the same F frames.

    around_ns    (R, F) from outside, with the Python round the engine
    stage_ns     name -> (R, F) as the engine reports its stages, which do not overlap; empty when it reports none
    warmup       [s] import, load and first frames, in a fresh process; other engines may have been warming up beside it. nan in
                 one that had run other scenes
    hashes       state hash of the last frame of each repeat
    warm_frames  frames that were run untimed before the first repeat
    """

    around_ns: Integers
    stage_ns: dict[str, Integers] = field(default_factory=dict)
    warmup: float = 0.0
    hashes: tuple[str, ...] = ()
    warm_frames: int = 0

    @property
    def engine_ns(self) -> Integers:
        """(R, F) engine only: the sum of its stages but the adapter's; the whole call from an engine that reports none."""
        own = [spent for name, spent in self.stage_ns.items() if name != ADAPTER]
        return sum(own, np.zeros_like(self.around_ns)) if own else self.around_ns

    @property
    def best_us(self) -> NDArray[np.float64]:
        """(F,) engine only [us], the least of all repeats: what the frame costs when nothing else disturbs."""
        return np.asarray(self.engine_ns.min(axis=0) / 1e3)


def repeats_said(repeats: int, frames: int, warm_frames: int) -> str:
    """What a time stands on, as every row of a time says it."""
    return f"{repeats} x {frames} frames" + (f" after {warm_frames} untimed" if warm_frames else "")


def lacks_p99(repeats: int, frames: int) -> str:
    """Why a row of so many repeats of so many frames has no 99th percentile; "" if it has one."""
    if repeats >= REPEATS and frames >= ENOUGH_FRAMES:
        return ""
    return f"{repeats_said(repeats, frames, 0)}; it takes {REPEATS} x {ENOUGH_FRAMES}"


def frame_times(timed: Timed, recorded: tuple[str, ...] = (), phases: Sequence[str] = ()) -> Values:
    """frame_time_* [us] from the per-frame minimum over repeats, frame_time_raw_* from all frames of all repeats,
    frame_time_python_p50 [us], warmup [s], stage_share_<stage> [%]; deterministic: 1 when all repeats ended in the same bits, and
    in those of the accuracy pass, another process, whose hashes by frame are `recorded`. `phases` names what happens in each
    frame (`measure/phases.py`): a median for each phase where there are several. A percentile that so few frames do not have is
    Missing, with the reason."""
    best, raw, around = timed.best_us, timed.engine_ns / 1e3, timed.around_ns.min(axis=0) / 1e3
    found: dict[str, Value] = {"frame_time_max": float(best.max()), "frame_time_raw_max": float(raw.max())}
    too_few = lacks_p99(len(timed.around_ns), timed.around_ns.shape[1])
    for share in (50, 95, 99):
        for name, times in (("frame_time_p", best), ("frame_time_raw_p", raw)):
            missing = share == 99 and too_few
            found[f"{name}{share}"] = Missing(too_few, "scene") if missing else float(np.percentile(times, share))
    found["frame_time_python_p50"] = float(np.percentile(around, 50))
    found |= phase_medians(best, phases)
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


def phase_medians(times: NDArray[np.float64], phases: Sequence[str]) -> Mapping[str, float]:
    """frame_time_<phase>_p50 [us] of each phase with PHASE_FRAMES timed frames, where at least two have that many."""
    names = np.array(phases[: len(times)], dtype=np.str_)
    apart = {name: times[: len(names)][names == name] for name in dict.fromkeys(names.tolist())}
    long = {name: spent for name, spent in apart.items() if len(spent) >= PHASE_FRAMES}
    return {f"frame_time_{name}_p50": float(np.median(spent)) for name, spent in long.items()} if len(long) > 1 else {}
