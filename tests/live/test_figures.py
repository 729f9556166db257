"""Figures of a loop's last seconds."""

import numpy as np
import pytest

from avatarsim.live.figures import SPAN, Window
from avatarsim.live.messages import State


def state(frame: int, cost: int = 1000, latency: int = -1, late: bool = False, skipped: int = 0, paused: bool = False) -> State:
    """Return a state of which only the cost matters."""
    nothing = np.zeros((0, 3))
    return State(
        frame, frame / 60.0, nothing, np.zeros((0, 4)), np.zeros(0), 0, latency, cost, late, skipped, 0, {"planning": 1}, {},
        {"posture": cost // 2}, "", paused, cpu_ns=cost // 3,
    )


def test_figures_are_of_the_last_seconds() -> None:
    window = Window(60.0)
    for frame in range(2000):
        window.add(state(frame, cost=10**9 if frame < 1000 else 1000 + frame % 100, latency=frame % 7 - 1, late=frame >= 1994))
    found = window.figures()
    assert found.frames == 60 * SPAN == len(window.states())
    assert found.worst == 1099 and found.worst_cpu == 366 and found.p50 == pytest.approx(1049, abs=1)
    assert found.late == pytest.approx(6 / 600) and found.latency_p99 == 5
    assert found.stages["posture"] == pytest.approx(524, abs=1)


def test_frames_left_out_are_counted_from_the_windows_start() -> None:
    window = Window(60.0)
    for frame in range(10):
        window.add(state(frame, skipped=3 + frame // 5))
    assert window.figures().skipped == 1


def test_a_pause_says_nothing_about_time() -> None:
    window = Window(60.0)
    assert window.figures().frames == 0
    window.add(state(1, cost=5))
    window.add(state(1, cost=0, paused=True))
    assert window.figures().frames == 1 and window.figures().worst == 5
