"""Sampled frames of recordings made by hand, in which the nearest free posture is known."""

from dataclasses import replace

import numpy as np
import pytest

from runfiles.record import Recording
from scenarios.nearest.frames import Frames
from scenarios.nearest.summary import summarised
from tests.scenarios.examples import RADIUS, WALL_FACE, arm_scene, fist, fist_motion, fist_scene, recorded, resting


def pushed(back: float) -> Recording:
    """The fist's user goes into the wall; what is shown stops `back` before the wall's face."""
    scene = fist_scene()
    motion = fist_motion(scene, 0)
    recording = recorded(scene, [scene.first_sample, *(motion(k) for k in range(30))])
    positions = recording.positions.copy()
    positions[:, 1, 0] = np.minimum(positions[:, 1, 0], WALL_FACE - RADIUS - back)
    return replace(recording, positions=positions)


def frames_of(recording: Recording) -> Frames:
    return Frames(fist(), fist_scene(), recording, [])


def test_frames_in_contact_are_those_in_which_the_user_is_in_the_wall() -> None:
    # 20 mm a frame: the 20th touches, the 21st is inside
    assert frames_of(pushed(0.0)).in_contact().tolist() == list(range(21, 31))


def test_what_stands_at_the_wall_is_the_nearest() -> None:
    samples = list(frames_of(pushed(0.0)).samples(4))
    assert len(samples) == 4
    for sample in samples:
        depth = 0.02 * sample.frame - WALL_FACE + RADIUS
        assert sample.offset == pytest.approx(depth, abs=1e-12)
        assert sample.nearest_offset == pytest.approx(depth, abs=3e-6)
        assert sample.downhill_offset == pytest.approx(depth, abs=3e-6)
        assert 0 < sample.ends <= sample.starts
    summary = summarised(samples)
    assert summary.times[0] == pytest.approx(1.0, abs=1e-3) and summary.within


def test_what_stands_far_back_is_found_out() -> None:
    summary = summarised(list(frames_of(pushed(0.3)).samples(4)))
    assert summary.times[0] > 2.0 and not summary.within and summary.near_offset == 0.0


def test_a_user_who_is_never_in_the_way_gives_no_samples() -> None:
    assert list(frames_of(resting(fist_scene(), 5)).samples(4)) == []


def test_an_engine_without_angles_has_no_posture_to_start_from() -> None:
    scene, recording = arm_scene(), resting(arm_scene(), 3)
    frames = Frames(replace(fist(), regions=()), scene, recording, [])
    assert frames.shown(recording, 1) is not None
    assert frames.shown(replace(recording, angles=np.zeros((4, 0))), 1) is None
    assert frames.shown(replace(recording, positions=np.full_like(recording.positions, np.nan)), 1) is None
