"""Who counts as a crowd, and what is remembered of how fast the tracker was: what decides how the frame goes on."""

import pytest

from avatarsim.posture.meet_tracker import CROWD, FASTEST, SPARSE, SPEED_MEMORY, TOUCHING, is_crowded, meet_the_tracker
from avatarsim.posture.workspace import LISTED, NEAR_BODIES, SPEED, TRACKER_SPEED
from avatarsim.scene.scene import Scene
from tests.posture.little_worlds import hand, little


@pytest.mark.nojit
def test_a_crowd_lasts_until_few_were_near_in_some_frames() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for near in (CROWD, CROWD + 1, CROWD, SPARSE, SPARSE, CROWD + 1, SPARSE, CROWD, SPARSE, SPARSE, CROWD, SPARSE):
        memory.pairs.marks[NEAR_BODIES] = near
        seen.append(is_crowded(memory))
    # three frames with few, those with some not counted; then it takes a crowd again
    assert seen == [False, True, True, True, True, True, True, True, True, False, False, False]


@pytest.mark.nojit
def test_fewer_make_a_crowd_when_as_many_are_in_touch() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for near, touching in ((TOUCHING + 1, TOUCHING), (TOUCHING, CROWD), (TOUCHING + 1, TOUCHING + 1)):
        memory.pairs.marks[NEAR_BODIES], memory.pairs.marks[LISTED] = near, touching
        seen.append(is_crowded(memory))
    assert seen == [False, False, True]


@pytest.mark.parametrize("far", [1e3, 1e9, 1e200])
def test_one_sample_from_the_end_of_the_world_is_soon_forgotten(far: float) -> None:
    """1e200 m has no square: a speed without an end would be remembered for good."""
    found = little(Scene("s", (), (hand(),)))
    (_, skel, _, _), memory = found.parts, found.memory
    for x in (far, 0.0):
        memory.goal.tracker.root[0, 0] = x
        meet_the_tracker(skel, False, memory)
        assert memory.flags[TRACKER_SPEED] == FASTEST
    for k in range(60):
        meet_the_tracker(skel, False, memory)
        assert memory.flags[SPEED] == 0.0
        assert memory.flags[TRACKER_SPEED] == pytest.approx(FASTEST * SPEED_MEMORY ** (k + 1))
    assert memory.flags[TRACKER_SPEED] < 1e-3
