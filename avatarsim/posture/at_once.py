"""What of a way is gone in the frame in which it is found: all of it after a leap, or to where a frame could go."""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import copy_led, set_slow
from avatarsim.posture.goal import largest_part, root_way
from avatarsim.posture.leap import has_leapt, is_too_far, steps_of_leap
from avatarsim.posture.step import adopt, try_step
from avatarsim.posture.trapped import seek_once, set_free
from avatarsim.posture.untie import forget
from avatarsim.posture.way_memory import AT, LEADING, MODE, REFUSED, SEARCHING, Way, copy_posture
from avatarsim.posture.workspace import LED, SLOW, UNDER_WAY, Goal, Memory
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

AT_ONCE, HARDLY = 12, 0.1
"""Frames' worth of steps along a way to where a frame could go, and how far [m] a root may be from there: a leg on the wrong side
of the other, when the user's is found free, is there in that frame and not after three."""


@kernel
def is_near(skel: Skeleton, settings: PostureSettings, goal: Goal) -> bool:
    """Whether the way `full` to the tracker's posture is no longer than a frame's steps turn, and hardly moves a root."""
    turns = settings.steps * settings.turn_cap
    return bool(largest_part(goal.full) <= turns and root_way(skel, goal.full) <= HARDLY)


@kernel
def go_back(
    geo: Geometry, skel: Skeleton, kept: Posture, at: int, posture_out: Posture, poses_out: Poses, memory_out: Memory,
    way_out: Way,
) -> None:
    """Be shown at place `at` of the way, at posture `kept`: free a moment ago, and still, since nothing else has moved.

    What is left of the way is gone in the frames after; one that was refused meanwhile is sought anew.
    """
    copy_posture(kept, posture_out)
    memory_out.rows.x[:] = 0.0
    try_step(geo, skel, posture_out, memory_out)
    adopt(geo, skel, posture_out, poses_out, memory_out)
    forget(memory_out)
    if way_out.state[MODE] == SEARCHING:
        set_free(memory_out, way_out)
        return
    memory_out.flags[LED] = UNDER_WAY
    copy_led(way_out.memory.goal, memory_out.goal)
    set_slow(1.0, memory_out)
    way_out.state[MODE], way_out.state[AT], way_out.state[REFUSED] = LEADING, at, 0


@kernel
def seek(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """After `follow`, in a frame in which the avatar came no nearer or is led: see the head of `trapped.py`.

    After a leap a way is sought and gone as in several frames, until the avatar is as far as its user has leapt. A way round
    something to where a frame could go, were nothing there, is gone in the frame in which it is found. Of either the last place
    is shown that is no farther from where the frame began than one may be suddenly: nobody is shown in the middle of a detour.
    """
    flags = memory_out.flags
    if flags[SLOW] <= 1.0:
        # after a leap something may still be under way to where the tracker was
        set_free(memory_out, way_out)
    if flags[SLOW] == 0.0:
        return
    near = way_out.state[MODE] != LEADING and is_near(skel, settings, memory_out.goal)
    seek_once(geo, skel, settings, posture, poses, memory_out, way_out)
    kept, at, searches, too_far = way_out.memory.goal.begun, 0, settings.leap_search, False
    copy_posture(posture, kept)
    for _ in range(searches + max(steps_of_leap(settings, memory_out), AT_ONCE)):
        leapt = has_leapt(skel, posture, memory_out)
        leads = way_out.state[MODE] == LEADING and (near or not leapt)
        if not leads and (way_out.state[MODE] != SEARCHING or searches == 0 or leapt):
            break
        searches -= 0 if leads else 1
        seek_once(geo, skel, settings, posture, poses, memory_out, way_out)
        if leads:
            too_far = is_too_far(skel, settings, posture, memory_out)
            if not too_far:
                copy_posture(posture, kept)
                at = way_out.state[AT]
    if too_far:
        go_back(geo, skel, kept, at, posture, poses, memory_out, way_out)
