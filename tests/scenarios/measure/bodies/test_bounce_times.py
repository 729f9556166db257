"""Times of impacts and of coming to rest, from recordings made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from reference.closed_form import bounce_state, zeno_time
from runfiles.record import Recording
from scenarios.measure.bodies.bounce import bounce_times, zeno_ends
from scenarios.measure.value import Missing
from tests.scenarios.examples import RADIUS, drop, drop_scene, resting

BALL, G, E = 1, 9.81, 0.3


def bouncing(late: float, frames: int = 90) -> Recording:
    """Return the closed form at every frame, all `late` [s]. Impacts appear as reversals between frames."""
    recording = resting(drop_scene(), frames)
    for k, time in enumerate(recording.times):
        height, speed = bounce_state(1.0, E, G, max(0.0, float(time) - late))
        recording.positions[k, BALL, 2], recording.velocities[k, BALL, 2] = height + RADIUS, speed
    return recording


def test_the_end_is_the_first_state_from_which_on_nothing_moves() -> None:
    scenario = replace(drop(90, E), expects={**drop(90, E).expects, "zeno": True})
    end = zeno_time(1.0, E, G)
    for late in (0.0, 0.05):
        first_at_rest = np.ceil((end + late) * 60.0) / 60.0
        found = zeno_ends(bouncing(late), scenario, drop_scene())["zeno_end_error_max"]
        assert found == pytest.approx(first_at_rest - end, abs=1e-12)


def test_who_never_moves_or_never_rests_has_not_ended() -> None:
    scenario = replace(drop(90, E), expects={**drop(90, E).expects, "zeno": True})
    restless = bouncing(0.0)
    restless.velocities[-1, BALL, 2] = 0.01
    for recording in (resting(drop_scene(), 90), restless):
        found = zeno_ends(recording, scenario, drop_scene())["zeno_end_error_max"]
        assert isinstance(found, Missing) and found.fault == "engine"
    assert zeno_ends(restless, drop(90, E), drop_scene()) == {}


def test_impacts_seen_between_frames_are_right_to_a_frame() -> None:
    found = bounce_times(bouncing(0.0), drop(90, E), drop_scene())["bounce_time_error_max"]
    assert isinstance(found, float) and 0.0 < found <= 1.0 / 60.0


def test_a_ball_that_hangs_in_the_air_never_bounced() -> None:
    found = bounce_times(resting(drop_scene(), 90), drop(90, E), drop_scene())["bounce_time_error_max"]
    assert isinstance(found, Missing) and found.fault == "engine"
    early = bounce_times(resting(drop_scene(), 20), drop(90, E), drop_scene())["bounce_time_error_max"]
    assert isinstance(early, Missing) and early.fault == "scene"
