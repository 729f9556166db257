"""Frames at rest: by poses alone, independent of an engine's velocities, at any frame time."""

import numpy as np
import pytest

from avatarsim.scene.scene import Scene
from runfiles.visible_motion import STILL
from scenarios.measure.phases import resting
from tests.scenarios.examples import drop_scene, fist_scene
from tests.scenarios.examples import resting as at_rest


def test_where_nothing_moves_every_frame_rests() -> None:
    assert resting(at_rest(fist_scene(), 5), fist_scene()).tolist() == [True] * 5


@pytest.mark.parametrize(("factor", "rests"), [(0.9, True), (1.1, False), (float("nan"), False)])
@pytest.mark.parametrize("scene", [fist_scene(), drop_scene()], ids=["a link", "a body"])
def test_one_step_of_a_link_or_a_simulated_body_is_motion(scene: Scene, factor: float, rests: bool) -> None:
    recording = at_rest(scene, 5)
    last = next(k for k, role in reversed(list(enumerate(scene.roles))) if role.name != "FIXED")
    recording.positions[3:, last, 2] += factor * STILL * recording.dt
    found = resting(recording, scene)
    assert found[2] == rests and found[:2].all()


def test_a_turn_in_place_is_motion() -> None:
    recording = at_rest(fist_scene(), 3)
    recording.orientations[2:, -1] = (np.cos(0.1), np.sin(0.1), 0.0, 0.0)
    assert resting(recording, fist_scene()).tolist() == [True, False, True]
