"""Bodies outside their region are counted, in frames shown and inside them."""

import numpy as np

from scenarios.measure.side import wrong_side
from tests.scenarios.examples import DT, fist, fist_scene, resting, with_inside


def test_frames_beyond_the_wall_are_counted() -> None:
    recording = resting(fist_scene(), 8)
    recording.positions[2:4, 1, 0] = 0.51
    recording.positions[5, 1, 2] = np.nan
    within = np.tile(recording.positions[0], (2, 1, 1))
    within[:, 1, 0] = 0.7
    recording = with_inside(recording, [DT, 3.5 * DT], [1, 3], ["step", "step"], within, np.zeros((2, 2, 3)))
    # frame 1 inside, frames 2 and 3 shown (3 also inside), frame 5 is not finite
    assert wrong_side(recording, fist(8), fist_scene()) == {"wrong_side_frames": 4.0}
