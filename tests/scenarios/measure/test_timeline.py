"""The timeline: states inside a frame come before its end, body by body."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from runfiles.record import EVENTS, Recording
from scenarios.measure.timeline import timeline
from tests.scenarios.examples import drop_scene, resting


def eventful() -> Recording:
    """Return three frames with two events in the first and one in the third; every number encodes its place."""
    recording = resting(drop_scene(), 3)
    n = recording.positions.shape[1]

    def numbered(states: int, width: int, tens: float) -> np.ndarray:
        return tens + np.arange(states * n * width, dtype=np.float64).reshape(states, n, width)

    wide: dict[str, Any] = {
        f"{where}{name}": numbered(states, width, tens)
        for where, states, tens in (("", 4, 0.0), ("inside_", 3, 1000.0))
        for name, width in (("positions", 3), ("orientations", 4), ("velocities", 3), ("angular_velocities", 3))
    }
    return replace(
        recording, inside_frame=np.array([1, 1, 3]), inside_time=np.array([0.1, 0.2, 2.5]) * recording.dt,
        inside_event=np.array([EVENTS.index("approach"), EVENTS.index("impact"), EVENTS.index("step")]), **wide,
    )


def test_what_is_inside_a_frame_comes_before_its_end() -> None:
    recording = eventful()
    line = timeline(recording, [0, 1])
    assert line.frame.tolist() == [0, 1, 1, 1, 2, 3, 3]
    assert np.all(np.diff(line.time) > 0.0)
    assert [EVENTS[k] for k in line.event] == ["step", "approach", "impact", "step", "step", "step", "step"]
    assert line.inside.tolist() == [1, 2, 5]


@pytest.mark.parametrize("bodies", [[0, 1], [1, 0], [1], [0], []])
def test_states_are_those_of_the_bodies_asked_for_one_by_one(bodies: list[int]) -> None:
    recording = eventful()
    line = timeline(recording, bodies)
    for name in ("positions", "orientations", "velocities", "angular_velocities"):
        shown, inside = getattr(recording, name), getattr(recording, f"inside_{name}")
        states = [shown[0], inside[0], inside[1], shown[1], shown[2], inside[2], shown[3]]
        assert getattr(line, name).tolist() == [[state[k].tolist() for k in bodies] for state in states]
