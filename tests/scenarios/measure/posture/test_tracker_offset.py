"""Tracking error: injected offsets and turns are found, and frames with a free target are reported separately."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.spatial import rotation
from scenarios.measure.posture.free import free_frames
from scenarios.measure.posture.tracker_offset import tracker_offset
from scenarios.measure.value import Missing
from tests.scenarios.examples import arm_scene, fist, fist_scene, recorded, resting, walked

EVERY = np.ones(5, dtype=bool)


def test_following_exactly_is_zero() -> None:
    found = dict(tracker_offset(resting(arm_scene(), 4), arm_scene(), EVERY))
    assert found.pop("free_frames") == 100.0 and set(found.values()) == {0.0}
    offsets = {"tracker_offset_max", "tracker_offset_rms", "tracker_offset_rms_free"}
    assert set(found) == {*offsets, "tracker_angle_rms", "tracker_angle_rms_free"}


def test_an_injected_offset_comes_out_and_free_frames_apart() -> None:
    recording = resting(fist_scene(), 4)
    recording.positions[1:, 1, 1] += 0.003
    recording.positions[3, 1, 1] += 0.004
    free = np.array([True, True, True, False, True])
    found = tracker_offset(recording, fist_scene(), free)
    assert found["free_frames"] == 75.0 and found["tracker_offset_max"] == pytest.approx(0.007, abs=1e-15)
    assert found["tracker_offset_rms_free"] == pytest.approx(0.003, abs=1e-15)
    assert found["tracker_offset_rms"] == pytest.approx(np.sqrt((3 * 0.003**2 + 0.007**2) / 4), abs=1e-15)


def test_an_injected_turn_comes_out_over_joints() -> None:
    scene, recording = arm_scene(), resting(arm_scene(), 4)
    # the whole arm turns at its hinge: one joint of three by 6 degrees
    recording.orientations[1:, 1:] = rotation.from_axis_angle([0.0, 1.0, 0.0], np.radians(6.0))
    found = tracker_offset(recording, scene, EVERY)
    assert found["tracker_angle_rms"] == pytest.approx(6.0 / np.sqrt(3.0), abs=1e-12)


def test_without_a_free_frame_the_figure_is_missing_and_not_zero() -> None:
    value = tracker_offset(resting(fist_scene(), 4), fist_scene(), ~EVERY)["tracker_offset_rms_free"]
    assert isinstance(value, Missing) and value.fault == "scene"


def test_free_means_no_overlap_right_side_and_within_limits() -> None:
    scene, recording = fist_scene(), walked(30)
    asked: list[float] = []

    def deep(positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
        asked.extend(positions[:, 1, 0])
        return np.maximum(0.0, positions[:, 1, 0] - 0.4)

    free = free_frames(recording, fist(), scene, deep)
    # 20 mm per frame: touches the wall at 0.4 m in frame 20; beyond 0.5 m it is on the wrong side and the judge is not needed
    assert free.tolist() == [True] * 21 + [False] * 10
    assert max(asked) == pytest.approx(0.5)


def test_a_raw_posture_beyond_its_limits_is_not_free() -> None:
    scene = arm_scene()
    bent = replace(scene.first_sample, angles=np.array([np.radians(61.0)]))
    recording = recorded(scene, [scene.first_sample, bent])
    anywhere = replace(fist(1), regions=())
    assert free_frames(recording, anywhere, scene, lambda p, q: np.zeros(len(p))).tolist() == [True, False]
