"""Freezing: an avatar without motion counts only while its user moves."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.spatial import rotation
from scenarios.measure.posture.stillness import movement, still_frames
from tests.scenarios.examples import fist_scene, resting, walked


def test_injected_stillness_comes_out() -> None:
    """Nobody is still where nobody moves; a nanometre of movement is movement, and no number is none."""
    recording = walked(10)
    assert still_frames(recording) == still_frames(resting(fist_scene(), 10)) == {"still_frames": 0.0}
    recording.positions[4:7] = recording.positions[3]
    assert still_frames(recording) == {"still_frames": 30.0}
    recording.positions[:, 1] = np.arange(11)[:, None] * 2e-9
    assert still_frames(recording) == {"still_frames": 0.0}
    recording.positions[:] = np.nan
    assert still_frames(recording) == {"still_frames": 100.0}


def test_user_who_moves_under_a_millimetre_asks_nothing() -> None:
    recording = walked(10)
    frozen = recording.positions[:1].repeat(11, 0)
    assert still_frames(replace(recording, positions=frozen)) == {"still_frames": 100.0}
    slow = replace(recording, positions=frozen, raw_positions=recording.raw_positions * 0.045)
    assert still_frames(slow) == {"still_frames": 0.0}


def test_a_turn_moves_a_point_a_tenth_of_a_metre_away() -> None:
    turned = np.array([[rotation.IDENTITY], [rotation.from_axis_angle([0.0, 0.0, 1.0], 0.02)]])
    assert movement(np.zeros((2, 1, 3)), turned) == pytest.approx([0.002], abs=1e-15)
