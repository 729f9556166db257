"""One frame of method `default`: from the last checked posture towards the tracker's, every state certified."""

from avatarsim.kernel import kernel
from avatarsim.posture.again import leave_the_rest
from avatarsim.posture.behind import all_are_led, judge_anew, judge_progress
from avatarsim.posture.goal import clip_to_limits, measure_way
from avatarsim.posture.jointed import has_joints
from avatarsim.posture.leap import leap_of, steps_of_leap
from avatarsim.posture.meet_tracker import meet_the_tracker
from avatarsim.posture.notice import notice_movers, notice_others
from avatarsim.posture.untie import unstick
from avatarsim.posture.walk import walk
from avatarsim.posture.way_memory import copy_posture
from avatarsim.posture.workspace import (
    FRAME,
    LEAP,
    LEAPS,
    LED,
    RESTED,
    STEPPED,
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
        flags[RESTED] = 0.0 if changed else flags[RESTED]
    else:
        memory_out.goal.gone[:] = 0.0
        copy_posture(posture_out, memory_out.goal.begun)
        moved = meet_the_tracker(geo, skel, changed, memory_out)
    everybody = flags[LED] > 0.0 and all_are_led(skel, memory_out.goal)
    if everybody and flags[LED] == UNDER_WAY:
        return
    if not everybody:
        if again:
            leave_the_rest(skel, settings, steps, posture_out, memory_out.goal)
        else:
            flags[LEAP] = leap_of(settings, moved)
            memory_out.counts[LEAPS] += 1 if flags[LEAP] > 0.0 else 0
            steps += steps_of_leap(settings, memory_out)
            if moved > HURRIED * settings.move_cap and not has_joints(skel):
                steps = max(steps, settings.steps + 1)
            flags[FRAME] += 1.0
        flags[STEPPED] = walk(geo, skel, settings, steps, posture_out, poses_out, memory_out)
    if again:
        return
    if flags[LED] == UNDER_WAY:
        measure_way(skel, posture_out, memory_out.goal)
    else:
        unstick(geo, skel, settings, posture_out, poses_out, memory_out)
    if flags[LEAP] > 0.0:
        # whoever had steps for all of the way and is not there is held up by something
        judge_anew(skel, memory_out)
    judge_progress(skel, memory_out)
