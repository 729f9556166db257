"""When the steps of a frame are enough."""

import pytest

from avatarsim.posture.walk import is_held
from avatarsim.posture.workspace import COUPLED, SLOW
from avatarsim.scene.scene import Scene
from tests.posture.little_worlds import hand, little


@pytest.mark.nojit
def test_held_is_who_touches_and_came_no_nearer() -> None:
    memory = little(Scene("s", (), (hand(),))).memory
    seen = []
    for coupled, slow in ((0.0, 0.0), (1.0, 0.0), (0.0, 3.0), (1.0, 3.0)):
        memory.goal.closeness.mode[COUPLED], memory.flags[SLOW] = coupled, slow
        seen.append(is_held(memory))
    assert seen == [False, False, False, True]
