"""Each avatar is behind, or not, for itself; what is sought for one leaves the others alone."""

import numpy as np
import pytest

from avatarsim.posture.behind import (
    NEAR_ENOUGH,
    all_are_led,
    anybody_is_led,
    count_slow,
    hold,
    is_led,
    judge_anew,
    judge_progress,
    keep_others,
    largest_of_tree,
    merit_of_tree,
    set_slow,
    speed_of_led,
    way_of_led,
)
from avatarsim.posture.goal import largest_part, measure_way, merit, root_way
from avatarsim.posture.workspace import FRAME, LED, PAST_FRAMES, SLOW, SPEED, UNDER_WAY
from avatarsim.scene.scene import Scene
from avatarsim.world.skeleton import Posture
from avatarsim.world.world import posture_of
from tests.posture.little_worlds import Little, hand, little, mixed_avatar, random_sample

pytestmark = [pytest.mark.nojit]
SECOND, THIRD = 5, 6
"""Rows of the roots after the first avatar's, which has five links."""


def three() -> Little:
    """An avatar with every kind of joint and two hands, each on its way somewhere."""
    avatars = (mixed_avatar(), hand(), hand(name="other"))
    found = little(Scene("s", (), avatars))
    goal = found.memory.goal
    aim = posture_of(found.world.skeleton, found.world.hinges, random_sample(avatars, 3))
    for there, here in zip(goal.tracker, aim, strict=True):
        there[:] = here
    measure_way(found.world.skeleton, found.world.posture, goal)
    return found


def test_trees_together_are_the_whole() -> None:
    found = three()
    skel, goal = found.world.skeleton, found.memory.goal
    roots = (0, SECOND, THIRD)
    assert sum(merit_of_tree(skel, root, goal) for root in roots) == pytest.approx(merit(goal), rel=1e-14)
    assert max(largest_of_tree(skel, root, goal) for root in roots) == largest_part(goal.full)
    goal.led[list(roots)] = 1.0
    assert way_of_led(skel, goal) == root_way(skel, goal.full) and all_are_led(skel, goal)


def test_who_comes_nearer_is_not_slow_because_another_is() -> None:
    found = three()
    skel, memory, goal = found.world.skeleton, found.memory, found.memory.goal
    judge_anew(skel, memory)
    full, seen = goal.full.copy(), []
    first = slice(int(skel.first_dof[SECOND]), int(skel.first_dof[THIRD]))
    for k in range(2 * PAST_FRAMES):
        goal.full[first] = full[first] * 0.9 ** (k + 1)
        memory.flags[FRAME] = k
        judge_progress(skel, memory)
        seen.append(goal.slow[[0, SECOND, THIRD]].tolist())
    assert [one[0] for one in seen] == [one[2] for one in seen] == [float(k + 1) for k in range(2 * PAST_FRAMES)]
    assert seen[-1][1] == 0.0 and memory.flags[SLOW] == 2 * PAST_FRAMES


def test_who_is_near_is_never_slow_and_all_near_end_a_journey() -> None:
    found = three()
    skel, memory, goal = found.world.skeleton, found.memory, found.memory.goal
    goal.full[:] = 0.9 * NEAR_ENOUGH
    goal.full[int(skel.first_dof[THIRD])] = 2.0 * NEAR_ENOUGH
    judge_anew(skel, memory)
    for _ in range(9):
        judge_progress(skel, memory)
    assert goal.slow.tolist() == [0.0] * THIRD + [9.0]
    goal.full[:] = 0.0
    judge_progress(skel, memory)
    assert goal.slow.max() == memory.flags[SLOW] == 0.0


def test_whoever_is_led_counts_for_all_and_comes_no_nearer_meanwhile() -> None:
    found = three()
    skel, memory, goal = found.world.skeleton, found.memory, found.memory.goal
    judge_anew(skel, memory)
    goal.slow[0], goal.slow[THIRD] = 40.0, 3.0
    count_slow(memory)
    assert memory.flags[SLOW] == 40.0
    goal.led[THIRD], memory.flags[LED] = 1.0, UNDER_WAY
    goal.full[:] = 0.0
    judge_progress(skel, memory)
    assert goal.slow[THIRD] == memory.flags[SLOW] == 4.0 and goal.slow[0] == 0.0
    set_slow(1.0, memory)
    assert goal.slow.tolist() == [0.0] * THIRD + [1.0]


def test_others_are_held_or_kept_link_by_link() -> None:
    found = three()
    skel, memory, goal = found.world.skeleton, found.memory, found.memory.goal
    assert not anybody_is_led(goal)
    goal.led[SECOND] = 1.0
    assert anybody_is_led(goal) and not all_are_led(skel, goal)
    assert [is_led(skel, skel.first + link, goal) for link in range(THIRD + 1)] == [False] * 5 + [True, False]
    low, high = int(skel.first_dof[SECOND]), int(skel.first_dof[THIRD])
    for led in (True, False):
        goal.allowed[:] = 1.0
        hold(skel, led, goal, goal.allowed)
        inside = np.zeros(len(goal.allowed), dtype=bool)
        inside[low:high] = True
        assert (goal.allowed == np.where(inside == led, 0.0, 1.0)).all()
    there = Posture(*(part.copy() for part in goal.tracker))
    keep_others(skel, found.world.posture, goal, there)
    assert (there.root[SECOND] == goal.tracker.root[SECOND]).all() and (there.root[[0, THIRD]] == 0.0).all()
    assert (there.angle == found.world.posture.angle).all()
    assert way_of_led(skel, goal) == pytest.approx(float(np.linalg.norm(goal.tracker.root[SECOND])))
    memory.flags[SPEED], goal.leapt[SECOND] = 9.0, (0.2, 0.3)
    assert speed_of_led(skel, memory) == 0.3
    goal.led[:] = 0.0
    assert speed_of_led(skel, memory) == 9.0
