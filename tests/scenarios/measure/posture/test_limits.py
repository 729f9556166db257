"""Angles beyond joint limits, taken from poses alone: hinges, gaps at joints, reach cones."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.scene.joint import ReachCone
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.measure.posture.limits import beyond_cone, limit_excess
from tests.scenarios.examples import arm_scene, recorded

SCENE = arm_scene()


def posed(arm: float = 0.0, swing: float = 0.0, twist: float = 0.0) -> Recording:
    """Return three frames; in the middle one the arm, the hand's swing about z and its twist about x are as given [deg]."""
    at_rest = rest(SCENE.avatars)
    about_x = rotation.from_axis_angle([1.0, 0.0, 0.0], np.radians(twist))
    hand = rotation.multiply(rotation.from_axis_angle([0.0, 0.0, 1.0], np.radians(swing)), about_x)
    rotations = at_rest.rotations.copy()
    rotations[2] = hand
    moved = TrackerSample(0.0, at_rest.positions, rotations, np.array([np.radians(arm)]))
    return recorded(SCENE, [at_rest, moved, at_rest])


@pytest.mark.parametrize(("arm", "swing", "twist", "excess"), [
    (0.0, 0.0, 0.0, 0.0), (60.0, 45.0, 20.0, 0.0), (-30.0, -45.0, -20.0, 0.0), (63.0, 0.0, 0.0, 3.0), (-30.5, 0.0, 0.0, 0.5),
    (0.0, 50.0, 0.0, 5.0), (0.0, -50.0, 0.0, 5.0), (0.0, 30.0, 27.0, 7.0), (0.0, 0.0, -21.0, 1.0), (179.0, 0.0, 0.0, 119.0),
    # -179 degrees is 181: nearer to the upper limit than to the lower
    (-179.0, 0.0, 0.0, 121.0),
])
def test_an_injected_excess_comes_out(arm: float, swing: float, twist: float, excess: float) -> None:
    found = limit_excess(posed(arm, swing, twist), SCENE)
    assert found["joint_limit_excess_max"] == pytest.approx(excess, abs=1e-10)
    assert found["joint_gap_max"] == pytest.approx(0.0, abs=1e-15)


def test_angle_is_taken_from_the_pose_not_the_engines_word() -> None:
    liar = posed(arm=70.0)
    found = limit_excess(replace(liar, angles=np.zeros_like(liar.angles)), SCENE)
    assert found["joint_limit_excess_max"] == pytest.approx(10.0, abs=1e-10)


def test_a_hinge_bent_off_its_axis_is_an_excess() -> None:
    recording = posed()
    recording.orientations[1, 1:] = rotation.from_axis_angle([1.0, 0.0, 0.0], np.radians(4.0))
    found = limit_excess(recording, SCENE)
    assert found["joint_limit_excess_max"] == pytest.approx(4.0, abs=1e-9)


def test_torn_link_is_a_gap_and_nan_is_no_excess_of_zero() -> None:
    recording = posed()
    recording.positions[1, 2, 1] += 0.007
    assert limit_excess(recording, SCENE)["joint_gap_max"] == pytest.approx(0.007, abs=1e-15)
    recording.orientations[1, 1, 0] = np.nan
    assert limit_excess(recording, SCENE)["joint_limit_excess_max"] == pytest.approx(np.nan, nan_ok=True)


def test_excess_beyond_a_face_of_the_reach_cone() -> None:
    # the cone's faces are planes at 45 degrees to x, so a swing of 50 degrees about z leaves it by 5
    assert limit_excess(posed(swing=50.0), SCENE)["reach_cone_excess_max"] == pytest.approx(5.0, abs=1e-9)
    assert limit_excess(posed(swing=44.0), SCENE)["reach_cone_excess_max"] == 0.0


def test_beyond_a_corner_the_distance_is_to_the_corner() -> None:
    corners = np.eye(3)
    cone = ReachCone(corners, (1.0, 1.0, 1.0))
    inside = np.full(3, 1.0 / np.sqrt(3.0))
    away = np.array([np.cos(0.2), -np.sin(0.2) / np.sqrt(2.0), -np.sin(0.2) / np.sqrt(2.0)])
    found = beyond_cone(cone, np.stack([inside, away, np.full(3, np.nan), corners[0]]))
    assert found == pytest.approx([0.0, 0.2, np.nan, 0.0], abs=1e-12, nan_ok=True) and found[0] == 0.0
    assert beyond_cone(cone, np.zeros((0, 3))).shape == (0,)
