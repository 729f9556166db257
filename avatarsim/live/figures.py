"""Order statistics of the last seconds of a loop: frame time, latency, late frames (nearest-rank percentiles, ISO 3534-1)."""

from collections import deque
from dataclasses import dataclass, field
from math import ceil

from avatarsim.live.messages import State

SPAN = 10.0
"""[s] over which figures are taken: long enough for a p99 of 600 frames, short enough to see what a hand just did."""


def rank(values: list[int], percent: float) -> int:
    """The smallest value that at least `percent` of the sorted `values` do not exceed; 0 of none."""
    return values[max(0, ceil(0.01 * percent * len(values)) - 1)] if values else 0


@dataclass(frozen=True)
class Figures:
    """Of the frames of the last `SPAN` seconds: frame times and latencies [ns], share late, frames left out, medians of stages
    [ns], how often each status was reported, and the longest that a frame had the processor [ns], which `worst` may exceed by
    what other programs took."""

    frames: int = 0
    p50: int = 0
    p99: int = 0
    worst: int = 0
    late: float = 0.0
    skipped: int = 0
    latency_p50: int = 0
    latency_p99: int = 0
    stages: dict[str, int] = field(default_factory=dict)
    statuses: dict[str, int] = field(default_factory=dict)
    worst_cpu: int = 0


class Window:
    """The last seconds of a loop's states, one by one."""

    def __init__(self, rate: float) -> None:
        self._states: deque[State] = deque(maxlen=max(1, round(rate * SPAN)))

    def add(self, state: State) -> None:
        """One more state; those of a pause say nothing about time."""
        if not state.is_paused:
            self._states.append(state)

    def states(self) -> tuple[State, ...]:
        """All of them, oldest first."""
        return tuple(self._states)

    def figures(self) -> Figures:
        """Of the states in the window."""
        states = list(self._states)
        if not states:
            return Figures()
        times, latencies = sorted(s.engine_ns for s in states), sorted(s.latency for s in states if s.latency >= 0)
        stages = {name: rank(sorted(s.stage_ns.get(name, 0) for s in states), 50.0) for name in states[-1].stage_ns}
        statuses: dict[str, int] = {}
        for state in states:
            for name, count in state.statuses.items():
                statuses[name] = statuses.get(name, 0) + count
        return Figures(
            len(states), rank(times, 50.0), rank(times, 99.0), times[-1], sum(s.is_late for s in states) / len(states),
            states[-1].skipped - states[0].skipped, rank(latencies, 50.0), rank(latencies, 99.0), stages, statuses,
            max(s.cpu_ns for s in states),
        )
