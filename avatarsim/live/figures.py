"""Order statistics of the last seconds of a loop: frame time, latency, late frames (nearest-rank percentiles, ISO 3534-1)."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from avatarsim.live.messages import State

SPAN = 10.0
"""[s] of frames that the figures cover: long enough for a p99 of 600 frames, short enough to show the effect of a motion."""


def ranked(values: Sequence[int], *percents: float) -> list[int]:
    """Return, for each percentage, the smallest of `values` that at least this share does not exceed; 0 without values."""
    return [int(found) for found in np.percentile(values or [0], percents, method="inverted_cdf")]


@dataclass(frozen=True)
class Figures:
    """Frame times and latencies [ns] of the last `SPAN` seconds, share of late frames, skipped frames, medians of stages [ns],
    and the largest processor time of a frame [ns], which `worst` may exceed by the time that other programs took."""

    frames: int = 0
    p50: int = 0
    p99: int = 0
    worst: int = 0
    late: float = 0.0
    skipped: int = 0
    latency_p50: int = 0
    latency_p99: int = 0
    stages: dict[str, int] = field(default_factory=dict)
    worst_cpu: int = 0


class Window:
    """Sliding window over the states of the last seconds of a loop."""

    def __init__(self, rate: float) -> None:
        self._states: deque[State] = deque(maxlen=max(1, round(rate * SPAN)))

    def add(self, state: State) -> None:
        """Add a state; states of a pause are ignored, since they carry no timing."""
        if not state.is_paused:
            self._states.append(state)

    def states(self) -> tuple[State, ...]:
        """Return all states, oldest first."""
        return tuple(self._states)

    def figures(self) -> Figures:
        """Return the figures of the states in the window."""
        states = list(self._states)
        if not states:
            return Figures()
        stages = {name: ranked([s.stage_ns.get(name, 0) for s in states], 50.0)[0] for name in states[-1].stage_ns}
        p50, p99, worst = ranked([s.engine_ns for s in states], 50.0, 99.0, 100.0)
        latency_p50, latency_p99 = ranked([s.latency for s in states if s.latency >= 0], 50.0, 99.0)
        return Figures(
            len(states), p50, p99, worst, sum(s.is_late for s in states) / len(states), states[-1].skipped - states[0].skipped,
            latency_p50, latency_p99, stages, max(s.cpu_ns for s in states),
        )
