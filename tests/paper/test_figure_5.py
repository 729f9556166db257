"""Figure 5: an articulated hand and arm slide along a non-convex corner between two walls, without jumps or artifacts."""

import numpy as np
import pytest

from tests.coupling.scenes import deepest
from tests.paper.scene_run import of_shown, of_user, scene_run

FRAMES = 120


@pytest.mark.parametrize("name", ["hand_in_corner", "hand_in_corner_rigid"])
def test_it_slides_along_the_corner_and_never_jumps(name: str) -> None:
    scene, records = scene_run(name, FRAMES)
    user, shown = of_user(name, FRAMES), of_shown(name, FRAMES)
    assert deepest(scene, records[::4]) <= 1e-6
    # pressed some centimetres into both walls, it follows the slide, which goes up and down along the corner
    assert np.linalg.norm(user - shown, axis=-1).max() > 0.02
    assert np.ptp(shown[:, 0, 2]) > 0.9 * np.ptp(user[:, 0, 2]) > 0.5
    # no link goes farther in a frame than its user's farthest, but for the way out of the walls
    ways = [np.linalg.norm(np.diff(path, axis=0), axis=-1).max(axis=1) for path in (shown, user)]
    assert (ways[0] - ways[1]).max() < 0.02
