"""A hand that is asked a second time in a frame, after loose objects have moved on, has what that frame has left."""

import pytest

from avatarsim.loops.checked import NOBODY
from avatarsim.posture.again import leave_the_rest
from avatarsim.posture.follow import follow
from avatarsim.posture.workspace import (
    CALM,
    FRAME,
    LEAP,
    RESTED,
    SLOW,
    SPEED,
    STUCK,
    TRACKER_SPEED,
    ready_memory,
)
from avatarsim.scene.scene import Scene
from avatarsim.settings import PostureSettings
from avatarsim.world.world import build, posture_of
from tests.posture.little_worlds import at, hand, little, mixed_avatar, panel

SETTINGS = PostureSettings()
ANY_FRAME = SETTINGS.steps * SETTINGS.move_cap
"""[m] what a root goes in a frame in which nobody leaps."""


@pytest.mark.parametrize(("way", "user", "steps", "share"), [
    (0.0, 0.0, SETTINGS.steps, 1.0), (0.3 * ANY_FRAME, 0.0, SETTINGS.steps, 0.7), (ANY_FRAME, 0.0, SETTINGS.steps, 0.0),
    (2.0 * ANY_FRAME, 0.0, SETTINGS.steps, 0.0), (ANY_FRAME, 0.5 * SETTINGS.move_cap, 1, 0.5), (0.1, 1.0, 1, 1.0),
])
def test_a_root_has_what_is_left_and_joints_are_not_held(way: float, user: float, steps: int, share: float) -> None:
    world = little(Scene("s", (), (mixed_avatar(),)))
    goal, (_, skel, posture, _) = world.memory.goal, world.parts
    goal.allowed[:] = 1.0
    goal.leapt[0, 0] = user
    for begun, now in zip(goal.begun, posture, strict=True):
        begun[:] = now
    goal.begun.root[0, 1] -= way
    leave_the_rest(skel, SETTINGS, steps, posture, goal)
    assert goal.allowed[:3] == pytest.approx(share, abs=1e-12) and (goal.allowed[3:] == 1.0).all()


def test_the_second_time_in_a_frame_goes_on_from_where_it_began() -> None:
    scene = Scene("s", (), (hand(),))
    world = build(scene)
    geo, skel, posture, poses = world.geometry, world.skeleton, world.posture, world.poses
    memory = ready_memory(geo, skel, posture, poses, SETTINGS)
    user = posture_of(skel, world.hinges, at(scene.first_sample, (2.0, 0.0, 0.0)))
    # the user has been there for a while: nobody leaps
    memory.goal.before.root[:] = user.root

    def shown(again: bool) -> float:
        follow(geo, skel, user, SETTINGS, again, NOBODY, posture, poses, memory)
        return float(posture.root[0, 0])

    assert shown(False) == pytest.approx(ANY_FRAME) and shown(True) == pytest.approx(ANY_FRAME)
    assert shown(False) == pytest.approx(2.0 * ANY_FRAME)
    # who was held has all of the frame left
    memory.goal.begun.root[:] = posture.root
    assert shown(True) == pytest.approx(3.0 * ANY_FRAME)


def test_the_second_time_counts_no_frame() -> None:
    """What counts frames, remembers speeds or moves so far a frame would otherwise do so twice where loose objects move."""
    scene = Scene("s", (panel(x=0.8),), (mixed_avatar(),))
    world = build(scene)
    geo, skel, posture, poses = world.geometry, world.skeleton, world.posture, world.poses
    memory = ready_memory(geo, skel, posture, poses, SETTINGS)
    user = posture_of(skel, world.hinges, at(scene.first_sample, (0.7, 0.0, 0.0)))
    for _ in range(20):
        follow(geo, skel, user, SETTINGS, False, NOBODY, posture, poses, memory)
    flags = memory.flags
    before = flags.copy()
    assert flags[FRAME] == 20 and flags[CALM] >= 19
    follow(geo, skel, user, SETTINGS, True, NOBODY, posture, poses, memory)
    counted = [FRAME, CALM, RESTED, SLOW, STUCK, TRACKER_SPEED, SPEED, LEAP]
    assert flags[counted].tolist() == before[counted].tolist()
    follow(geo, skel, user, SETTINGS, False, NOBODY, posture, poses, memory)
    assert flags[FRAME] == 21 and flags[CALM] == before[CALM] + 1
