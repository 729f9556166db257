"""Residual overlap: known depths are found in frames and sub-steps, and without a judge there is no figure."""

import numpy as np
import pytest

from scenarios.measure.everything import measured
from scenarios.measure.known import Known
from scenarios.measure.overlap import residual_overlap, substep_overlap
from scenarios.measure.value import Missing
from tests.scenarios.examples import DT, RADIUS, WALL_FACE, fist, fist_scene, resting, with_inside


def test_known_depths_come_out_exactly() -> None:
    found = residual_overlap(np.array([0.0, 5e-7, 2e-3, 0.0]))
    assert found == {
        "residual_overlap_max": 2e-3, "residual_overlap_p95": float(np.percentile([0.0, 5e-7, 2e-3, 0.0], 95)),
        "residual_overlap_mean": (5e-7 + 2e-3) / 4, "overlap_frames": 25.0,
    }


def test_a_pose_that_is_no_number_is_no_free_frame() -> None:
    found = residual_overlap(np.array([0.0, np.nan]))
    assert found["residual_overlap_max"] == pytest.approx(np.nan, nan_ok=True) and found["overlap_frames"] == 50.0


def test_overlap_inside_a_frame_is_seen_though_no_frame_shows_it() -> None:
    scene, recording = fist_scene(), resting(fist_scene(), 2)
    within = np.tile(recording.positions[0], (3, 1, 1))
    within[1, 1, 0] = WALL_FACE - RADIUS + 3e-3
    recording = with_inside(recording, [0.2 * DT, 0.4 * DT, 0.6 * DT], [1, 1, 1], ["step"] * 3, within, np.zeros((3, 2, 3)))
    values = measured(recording, Known(fist(2), scene)).values
    assert values["residual_overlap_max"] == 0.0
    assert values["substep_overlap_max"] == pytest.approx(3e-3, abs=1e-8)


def test_thinned_or_absent_substeps_say_so() -> None:
    recording = resting(fist_scene(), 1)
    within = np.tile(recording.positions[0], (10, 1, 1))
    recording = with_inside(recording, [0.0] * 10, [1] * 10, ["step"] * 10, within, np.zeros((10, 2, 3)))
    asked: list[int] = []

    def deepest(p: np.ndarray, q: np.ndarray) -> float:
        asked.append(len(p))
        return 0.0

    assert substep_overlap(recording, deepest, 5) == (0.0, "every 2th of 10 sub-steps judged")
    assert asked == [5]
    assert substep_overlap(recording, deepest, None) == (0.0, "")
    # without sub-steps it is missing, and not zero
    assert isinstance(substep_overlap(resting(fist_scene(), 1), deepest)[0], Missing)
