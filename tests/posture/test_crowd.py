"""Who counts as a crowd, and who as held back: what decides how the frame goes on."""

import pytest

from avatarsim.posture.follow import CROWD, SPARSE, TOUCHING, is_crowded, is_held
from avatarsim.posture.workspace import COUPLED, LISTED, NEAR_BODIES, SLOW
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
def test_held_is_who_touches_and_came_no_nearer() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for coupled, slow in ((0.0, 0.0), (1.0, 0.0), (0.0, 3.0), (1.0, 3.0)):
        memory.goal.closeness.mode[COUPLED], memory.flags[SLOW] = coupled, slow
        seen.append(is_held(memory))
    assert seen == [False, False, False, True]


@pytest.mark.nojit
def test_fewer_make_a_crowd_when_as_many_are_in_touch() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for near, touching in ((TOUCHING + 1, TOUCHING), (TOUCHING, CROWD), (TOUCHING + 1, TOUCHING + 1)):
        memory.pairs.marks[NEAR_BODIES], memory.pairs.marks[LISTED] = near, touching
        seen.append(is_crowded(memory))
    assert seen == [False, False, True]
