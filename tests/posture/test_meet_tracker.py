"""What is remembered of how fast the tracker was, which decides how the frame goes on."""

import pytest

from avatarsim.posture.meet_tracker import FASTEST, SPEED_MEMORY, meet_the_tracker
from avatarsim.posture.workspace import SPEED, TRACKER_SPEED
from avatarsim.scene.scene import Scene
from tests.posture.little_worlds import hand, little


@pytest.mark.parametrize("far", [1e3, 1e9, 1e200])
def test_one_sample_from_the_end_of_the_world_is_soon_forgotten(far: float) -> None:
    """1e200 m has no square: a speed without an end would be remembered for good."""
    found = little(Scene("s", (), (hand(),)))
    (geo, skel, _, _), memory = found.parts, found.memory
    for x in (far, 0.0):
        memory.goal.tracker.root[0, 0] = x
        meet_the_tracker(geo, skel, False, memory)
        assert memory.flags[TRACKER_SPEED] == FASTEST
    for k in range(60):
        meet_the_tracker(geo, skel, False, memory)
        assert memory.flags[SPEED] == 0.0
        assert memory.flags[TRACKER_SPEED] == pytest.approx(FASTEST * SPEED_MEMORY ** (k + 1))
    assert memory.flags[TRACKER_SPEED] < 1e-3
