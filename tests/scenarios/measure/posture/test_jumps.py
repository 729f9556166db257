"""Jumps of root, links and joints: only the part beyond the change of the target counts."""


import numpy as np
import pytest

from avatarsim.spatial import rotation
from scenarios.measure.posture.jumps import jumps
from tests.scenarios.examples import arm_scene, fist_scene, resting, walked


def test_a_jump_of_the_root_counts_beyond_the_users_own_way() -> None:
    recording, scene = walked(10), fist_scene()
    assert set(jumps(recording, scene).values()) == {0.0}
    recording.positions[5:, 1, 0] += 0.05
    assert jumps(recording, scene)["root_jump_max"] == pytest.approx(0.05, abs=1e-12)


def test_a_jump_of_a_link_counts_beyond_its_own_targets_way() -> None:
    """The first link's target moves 0.2 m in the frame in which the second link jumps by 0.15 m; this excuses only the first."""
    recording = resting(arm_scene(), 6)
    recording.raw_positions[3:, 0, 0] += 0.2
    recording.positions[3:, recording.links.start + 1, 0] += 0.15
    assert jumps(recording, arm_scene())["link_jump_max"] == pytest.approx(0.15)


def test_a_jump_of_a_joint_comes_out_in_degrees() -> None:
    recording = resting(arm_scene(), 6)
    recording.orientations[3:, 1:] = rotation.from_axis_angle([0.0, 1.0, 0.0], np.radians(9.0))
    assert jumps(recording, arm_scene())["pose_jump_max"] == pytest.approx(9.0, abs=1e-9)
