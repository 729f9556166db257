"""The least angle beside postures within limits, and beside what is known of single joints."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.measure.posture.limits import joint_limit_excess, least_angles, reach_cone_excess
from scenarios.measure.posture.tracker_offset import angle_offsets
from tests.scenarios.examples import arm_scene, fist_scene, recorded, resting

SCENE = arm_scene()
"""A hinge about y, -30 to 60 degrees; a ball with a swing of 45 and a twist of 20 degrees about x, in a cone of four corners."""


def posed(arm: float, hand: np.ndarray) -> Recording:
    """One frame with the arm's hinge [deg] and the hand's rotation against the arm."""
    at_rest = rest(SCENE.avatars)
    rotations = at_rest.rotations.copy()
    rotations[2] = hand
    return recorded(SCENE, [at_rest, TrackerSample(0.0, at_rest.positions, rotations, np.array([np.radians(arm)]))])


def about(axis: list[float], degrees: float) -> np.ndarray:
    return np.asarray(rotation.from_axis_angle(axis, np.radians(degrees)))


@pytest.mark.parametrize(("arm", "swing", "least"), [
    (0.0, 0.0, (0.0, 0.0, 0.0)), (60.0, 44.0, (0.0, 0.0, 0.0)), (75.0, 0.0, (0.0, 15.0, 0.0)), (-31.0, 50.0, (0.0, 1.0, 5.0)),
    (-179.0, -60.0, (0.0, 121.0, 15.0)),
])
def test_known_joints(arm: float, swing: float, least: tuple[float, ...]) -> None:
    found = least_angles(posed(arm, about([0.0, 0.0, 1.0], swing)), SCENE)
    np.testing.assert_allclose(np.degrees(found), [least], atol=1e-9)


def test_it_is_below_every_posture_within_limits() -> None:
    random = np.random.default_rng(3)
    for _ in range(20):
        user = posed(random.uniform(-180.0, 180.0), about(random.normal(size=3).tolist(), random.uniform(0.0, 180.0)))
        least = least_angles(user, SCENE)
        nearest = np.full(3, np.inf)
        for _ in range(100):
            swing = about([0.0, *random.normal(size=2)], random.uniform(0.0, 45.0))
            hand = rotation.multiply(swing, about([1.0, 0.0, 0.0], random.uniform(-20.0, 20.0)))
            shown = posed(random.uniform(-30.0, 60.0), hand)
            turns, bent = shown.orientations[1:, shown.links], shown.angles[1:]
            if max(joint_limit_excess(SCENE, turns, bent)[0], reach_cone_excess(SCENE, turns)[0]) > 1e-9:
                continue
            beside = replace(shown, raw_orientations=user.raw_orientations)
            nearest = np.minimum(nearest, angle_offsets(beside, SCENE)[0])
        assert np.isfinite(nearest).all() and (least[0] <= nearest + 1e-12).all()


def test_free_joints_and_no_joints_have_no_bound() -> None:
    assert least_angles(resting(fist_scene(), 4), fist_scene()).tolist() == [[0.0]] * 4
