"""Frame times: percentiles over frames of the cost of one rendered frame, and its parts."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import ADAPTER
from runfiles.timing_protocol import PHASE_FRAMES, Protocol
from scenarios.measure.value import Missing, Value, Values

Integers = NDArray[np.int64]
Array = NDArray[np.float64]

TAIL = ("frame_time_p99", "frame_time_raw_p99")
"""Figures that few frames decide: only from a row with enough of them."""
SLOWEST = "frame_time_max"
"""Slowest of all frames that were timed."""


class Round(NamedTuple):
    """So many repeats of so many frames from frame `first` of the scene on."""

    repeats: int
    first: int
    frames: int


@dataclass(frozen=True, eq=False)
class Timed:
    """Times measured by the timing pass: R repeats of the same F frames.

    around_ns   (R, F) from outside, with the Python round the engine
    stage_ns    name -> (R, F) as the engine reports its stages, which do not overlap; empty when it reports none
    warmup      [s] import, load and first frames, in a fresh process; other engines may have been warming up meanwhile. nan in
                one that had run other scenes
    hashes      state hash of the last frame of each repeat
    warm_frames frames run before, not timed
    first       frame of the scene at which timing begins; those before it ran and were not timed
    shared      repeats and frames that every engine of the scene had; None: all
    """

    around_ns: Integers
    stage_ns: dict[str, Integers] = field(default_factory=dict)
    warmup: float = 0.0
    hashes: tuple[str, ...] = ()
    warm_frames: int = 0
    first: int = 0
    shared: Round | None = None

    @property
    def protocol(self) -> Protocol:
        """The protocol by which all of it was timed."""
        repeats, frames = self.around_ns.shape
        return Protocol(repeats, frames, self.warm_frames, self.first)

    @property
    def compared(self) -> Protocol:
        """The part of it that every engine of the scene had."""
        if self.shared is None:
            return self.protocol
        return Protocol(self.shared.repeats, self.shared.frames, self.warm_frames, self.shared.first)

    def of_compared(self, nanoseconds: Integers) -> Integers:
        """Return (repeats, frames) that every engine of the scene had, of (R, F)."""
        begins = self.compared.first - self.first
        return nanoseconds[: self.compared.repeats, begins : begins + self.compared.frames]

    @property
    def engine_ns(self) -> Integers:
        """(R, F) engine only: the sum of its stages but the adapter's (`frame_time_python_p50` has that too); the whole call
        from an engine that reports none."""
        own = [spent for name, spent in self.stage_ns.items() if name != ADAPTER]
        return sum(own, np.zeros_like(self.around_ns)) if own else self.around_ns

    @property
    def best_us(self) -> Array:
        """(F,) engine only [us], the least of all repeats: the cost of the frame when nothing else disturbs."""
        return np.asarray(self.engine_ns.min(axis=0) / 1e3)

    @property
    def compared_us(self) -> Array:
        """(frames,) the same over the repeats and frames that every engine of the scene had."""
        return np.asarray(self.of_compared(self.engine_ns).min(axis=0) / 1e3)


def frame_times(timed: Timed, recorded: tuple[str, ...] = (), resting: Sequence[bool] = ()) -> Values:
    """Return frame_time_* [us], warmup [s], stage_share_* [%], resting_frames [%] and deterministic.

    A frame counts with the least of its repeats, in frame_time_raw_* and frame_time_max with each of them. Medians and 95th
    percentiles are over the part that every engine of the scene had; 99th percentiles over all that this one had, Missing where
    that is not enough, or where they would lie below the 95th percentile of fewer frames. The slowest frame is the slowest of
    all that were timed: a user meets the disturbed frames too. Where frames in which all is `resting` and others are both many,
    each kind has its median.

    Args:
        recorded: state hashes by frame of the accuracy pass, another process: deterministic is 1 when all repeats ended in them.
        resting: of every frame whether nothing moves.
    """
    raw = timed.of_compared(timed.engine_ns) / 1e3
    best, around = timed.compared_us, timed.of_compared(timed.around_ns).min(axis=0) / 1e3
    values: dict[str, Value] = {}
    for share in (50, 95):
        values[f"frame_time_p{share}"] = float(np.percentile(best, share))
        values[f"frame_time_raw_p{share}"] = float(np.percentile(raw, share))
    values |= _tail(timed)
    values[SLOWEST] = float(timed.engine_ns.max() / 1e3)
    values["frame_time_python_p50"] = float(np.percentile(around, 50))
    if len(rests := _rests(timed, resting)):
        values["resting_frames"] = 100.0 * float(rests.mean())
    for name, kind in _phases(timed, resting).items():
        values[name] = float(np.percentile(best[kind], 50))
    if not math.isnan(timed.warmup):
        values["warmup"] = timed.warmup
    total = float(timed.engine_ns.sum())
    for name, spent in timed.stage_ns.items():
        if name == ADAPTER:
            continue
        values[f"stage_share_{name}"] = 100.0 * float(spent.sum()) / total if total > 0.0 else 0.0
    if timed.hashes:
        last = timed.first + timed.around_ns.shape[1]
        elsewhere = recorded[last : last + 1]
        values["deterministic"] = float(len({*timed.hashes, *elsewhere}) == 1)
    return values


def _tail(timed: Timed) -> dict[str, Value]:
    if not timed.protocol.has_tail:
        return dict.fromkeys(TAIL, Missing(timed.protocol.no_tail, "scene"))
    values: dict[str, Value] = {}
    whole, compared = (timed.best_us, timed.engine_ns / 1e3), (timed.compared_us, timed.of_compared(timed.engine_ns) / 1e3)
    for name, times, few in zip(TAIL, whole, compared, strict=True):
        figure = float(np.percentile(times, 99))
        dearer = f"over {timed.protocol.said}, those of the 95th percentile being dearer: {timed.compared.said}"
        values[name] = Missing(dearer, "scene") if figure < np.percentile(few, 95) else figure
    return values


def _phases(timed: Timed, resting: Sequence[bool]) -> dict[str, NDArray[np.bool_]]:
    """Return metric -> (frames,) flags of the compared frames that it is of; empty unless both kinds have enough."""
    rests = _rests(timed, resting)
    if min(rests.sum(), (~rests).sum()) < PHASE_FRAMES:
        return {}
    return {"frame_time_moving_p50": ~rests, "frame_time_resting_p50": rests}


def _rests(timed: Timed, resting: Sequence[bool]) -> NDArray[np.bool_]:
    """Return (frames,) True for compared frames in which nothing moves; empty where that is not known of all."""
    begins = timed.compared.first
    rests = np.asarray(resting[begins : begins + timed.compared.frames], dtype=np.bool_)
    return rests if len(rests) == timed.compared.frames else rests[:0]


def time_notes(timed: Timed, values: Mapping[str, Value], resting: Sequence[bool] = ()) -> dict[str, str]:
    """Return the notes to the frame_time_* `values`: repeats x frames, warm-up, and at the median the frames it mixes."""
    notes = {}
    for name, value in values.items():
        if name.startswith("frame_time_") and not isinstance(value, Missing):
            notes[name] = (timed.protocol if name in (*TAIL, SLOWEST) else timed.compared).said
    phases = _phases(timed, resting)
    for name, kind in phases.items():
        notes[name] = f"{int(kind.sum())} of {notes[name]}"
    if phases:
        mixed = (f"{name.split('_')[2]} {values[name]:.3g} us" for name in phases)
        notes["frame_time_p50"] += f"; {', '.join(mixed)}"
    return notes
