"""One frame of method `default`: from the last checked posture towards the tracker's, every state certified."""

from avatarsim.kernel import kernel
from avatarsim.posture.again import leave_the_rest
from avatarsim.posture.body_place import place_bodies, stay_aside
from avatarsim.posture.goal import clip_to_limits, farthest, merit
from avatarsim.posture.jointed import has_joints
from avatarsim.posture.leap import leap_of, steps_of_leap
from avatarsim.posture.meet_tracker import meet_the_tracker
from avatarsim.posture.notice import notice_movers, notice_others
from avatarsim.posture.untie import unstick
from avatarsim.posture.walk import begin_frame, walk
from avatarsim.posture.way_memory import copy_posture
from avatarsim.posture.workspace import (
    FRAME,
    HELD_STILL,
    LEAP,
    LEAPS,
    LED,
    PAST,
    PAST_FRAMES,
    RESTED,
    SLOW,
    STEPPED,
    TRAVELS,
    UNDER_WAY,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.world.arena import Index
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

HURRIED = 0.5
"""A tracker whose root goes farther in a frame than this share of a step is followed by one more step of an avatar without
joints, for which it costs little: without, a hand that lies turned on a wall and is pulled off it is 37 mm short in the first
frame that is free. 0: with `turn_alone` 0.35 a hand that slides along a corner jumps by 11 mm."""

NEAR_ENOUGH = 0.05
"""[rad or m] an avatar nearer than this to the tracker's posture in every joint needs no other way."""

NEARER = 0.64
"""Share to which half the squared distance to the tracker must fall within PAST_FRAMES: a fifth of the distance."""


@kernel
def judge_progress(memory_out: Memory) -> None:
    """Count the frames in a row in which the avatar is not a fifth nearer to the tracker than PAST_FRAMES before.

    After `unstick`, which has measured the way from where the frame ends.
    """
    flags, goal = memory_out.flags, memory_out.goal
    now, place, far = merit(goal), PAST + int(flags[FRAME]) % PAST_FRAMES, farthest(goal) > NEAR_ENOUGH
    flags[SLOW] = flags[SLOW] + 1.0 if far and now > NEARER * flags[place] else 0.0
    if not far:
        flags[TRAVELS] = 0.0
    flags[place] = now


@kernel
def follow(
    geo: Geometry, skel: Skeleton, tracker: Posture, settings: PostureSettings, again: bool, moving: Index,
    posture_out: Posture, poses_out: Poses, memory_out: Memory,
) -> None:
    """Bring the posture towards the tracker's by `settings.steps` certified steps at most, more after one that leaps or hurries;
    the work adds to the counts.

    again: whether it is the second time in this frame, which then goes on from where it began (`again.py`): steps alone, since
    all that counts frames has counted this one.
    moving (nb): 1 for bodies that may have moved since the last call; empty if nobody knows.
    """
    flags = memory_out.flags
    if moving.shape[0] > 0:
        changed = notice_movers(geo, skel, poses_out, moving, memory_out)
    else:
        changed = notice_others(geo, skel, poses_out, memory_out)
    clip_to_limits(skel, tracker, memory_out.goal)
    steps, moved = settings.steps, 0.0
    if again:
        stay_aside(skel, memory_out.goal)
        flags[RESTED] = 0.0 if changed else flags[RESTED]
    else:
        place_bodies(skel, memory_out.goal)
        copy_posture(posture_out, memory_out.goal.begun)
        moved = meet_the_tracker(skel, changed, memory_out)
    if flags[LED] == UNDER_WAY:
        return
    if flags[LED] != HELD_STILL:
        if again:
            leave_the_rest(skel, settings, steps, posture_out, memory_out.goal)
        else:
            flags[LEAP] = leap_of(settings, moved)
            memory_out.counts[LEAPS] += 1 if flags[LEAP] > 0.0 else 0
            steps += steps_of_leap(settings, memory_out)
            if moved > HURRIED * settings.move_cap and not has_joints(skel):
                steps = max(steps, settings.steps + 1)
            begin_frame(skel, posture_out, memory_out)
        flags[STEPPED] = walk(geo, skel, settings, steps, posture_out, poses_out, memory_out)
    if again:
        return
    unstick(geo, skel, settings, posture_out, poses_out, memory_out)
    if flags[LEAP] > 0.0:
        # whoever had steps for all of the way and is not there is held up by something
        flags[SLOW], flags[PAST : PAST + PAST_FRAMES] = 0.0, merit(memory_out.goal)
    judge_progress(memory_out)
