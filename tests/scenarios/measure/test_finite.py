"""Frames with a pose that is not finite are counted, each once."""


import numpy as np
import pytest

from scenarios.measure.frames import not_finite
from tests.scenarios.examples import fist_scene, resting


@pytest.mark.parametrize("field", ["positions", "orientations", "velocities", "angular_velocities"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_each_bad_frame_counts_once(field: str, bad: float) -> None:
    recording = resting(fist_scene(), 5)
    values = getattr(recording, field)
    values[2, :, 0] = values[4, 1, 2] = bad
    assert not_finite(recording) == {"not_finite_frames": 2.0}
