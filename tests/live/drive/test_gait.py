"""Walking: feet that stay on the ground, a period, a crouch."""

import numpy as np
import pytest

from avatarsim.live.stages import stage
from avatarsim.scene.tracker import TrackerSample
from tests.live.drive.stages_driven import DT, driver, excess, places, ticks

SCENE = stage("gallery").scene
NAMES = [link.name for link in SCENE.links]
LEFT, RIGHT = NAMES.index("left_foot"), NAMES.index("right_foot")


def walked(seconds: float, keys: str = "i") -> list[TrackerSample]:
    """Return postures while keys are held."""
    return ticks(driver("gallery"), round(seconds / DT), keys)


def test_feet_stand_and_swing_in_turn_with_the_period() -> None:
    feet = np.array([places(SCENE, sample)[[LEFT, RIGHT]] for sample in walked(8.0)])
    feet = feet[-round(5.0 * driver("gallery").period / DT):]
    speeds = np.linalg.norm(np.diff(feet, axis=0), axis=2) / DT
    stands = speeds < 0.2
    # each foot is on the ground for six tenths of the time, and both never swing
    assert stands.mean(axis=0) == pytest.approx(0.6, abs=0.08)
    assert (stands.any(axis=1)).mean() > 0.98
    begins = np.flatnonzero(stands[1:, 0] & ~stands[:-1, 0])
    # a frame that crosses the threshold only by rounding is no step
    begins = begins[np.diff(begins, prepend=-100) > 10]
    assert np.diff(begins).mean() * DT == pytest.approx(driver("gallery").period, rel=0.03)


def test_a_walk_goes_ahead_level_and_within_limits() -> None:
    samples = walked(4.0)
    roots = np.array([sample.positions[0] for sample in samples])
    assert roots[-1, 0] - roots[0, 0] > 2.5
    assert np.abs(roots[:, 1]).max() < 1e-6
    assert np.ptp(roots[120:, 2]) < 0.01
    assert max(excess(SCENE, sample) for sample in samples[::10]) < 1e-6
    lowest = min(float(places(SCENE, sample)[[LEFT, RIGHT], 2].min()) for sample in samples)
    assert lowest > places(SCENE, SCENE.first_sample)[LEFT, 2] - 0.01


def test_turning_turns_the_feet_along() -> None:
    turned = walked(2.0, "u")
    joints = places(SCENE, turned[-1])
    hips = joints[NAMES.index("left_hip")] - joints[NAMES.index("right_hip")]
    feet = joints[LEFT] - joints[RIGHT]
    assert np.degrees(np.arctan2(-hips[0], hips[1])) > 100.0
    across = float(hips[:2] @ feet[:2] / np.linalg.norm(hips[:2]))
    assert across > 0.05


def test_a_crouch_lowers_the_root_over_standing_feet() -> None:
    one, start = driver("gallery"), places(SCENE, SCENE.first_sample)
    sample = ticks(one, 240, "f")[-1]
    low = places(SCENE, sample)
    assert 0.3 < start[0, 2] - low[0, 2] < 0.5
    assert low[[LEFT, RIGHT]] == pytest.approx(start[[LEFT, RIGHT]], abs=0.015)
    assert excess(SCENE, sample) < 1e-6
    assert places(SCENE, ticks(one, 240, "r")[-1])[0, 2] == pytest.approx(start[0, 2], abs=1e-3)


def test_a_walk_that_is_let_go_comes_to_rest() -> None:
    one = driver("gallery")
    ticks(one, 60, "i")
    sample = ticks(one, 240)[-1]
    assert one.source == "still"
    joints, start = places(SCENE, sample), places(SCENE, SCENE.first_sample)
    assert joints[[LEFT, RIGHT]] - joints[0] == pytest.approx(start[[LEFT, RIGHT]] - start[0], abs=0.01)
