"""After a tracker that leaps: a way round what stands between is searched and gone in that frame, as in several frames."""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import copy_led, set_slow
from avatarsim.posture.leap import has_leapt, is_too_far, steps_of_leap
from avatarsim.posture.step import adopt, try_step
from avatarsim.posture.trapped import seek_once, set_free
from avatarsim.posture.untie import forget
from avatarsim.posture.way_memory import AT, LEADING, MODE, REFUSED, SEARCHING, Way, copy_posture
from avatarsim.posture.workspace import LEAP, LED, SLOW, UNDER_WAY, Memory
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton


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
def leap_round(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """Search, and go, until the avatar is as far as its user has leapt, each time with the motion budget of a frame.

    The last place is shown that is no farther from where the frame began than the user went and the steps of any frame go: a
    detour of the way may lead beyond, and is not shown halfway.
    """
    kept, at, searches, too_far = way_out.memory.goal.begun, 0, settings.leap_search, False
    copy_posture(posture, kept)
    for _ in range(searches + steps_of_leap(settings, memory_out)):
        leapt = has_leapt(skel, posture, memory_out)
        leads = way_out.state[MODE] == LEADING and not leapt
        if not leads and (way_out.state[MODE] != SEARCHING or searches == 0 or leapt):
            break
        searches -= 0 if leads else 1
        memory_out.goal.gone[:] = 0.0
        seek_once(geo, skel, settings, posture, poses, memory_out, way_out)
        if leads:
            too_far = is_too_far(skel, settings, posture, memory_out)
            if not too_far:
                copy_posture(posture, kept)
                at = way_out.state[AT]
    if too_far:
        go_back(geo, skel, kept, at, posture, poses, memory_out, way_out)


@kernel
def seek(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture: Posture, poses: Poses, memory_out: Memory, way_out: Way
) -> None:
    """After `follow`, in a frame in which the avatar came no nearer or is led: see the head of `trapped.py`.

    A way that is found is begun in that frame, with what the frame has left of its motion budget.
    """
    flags = memory_out.flags
    if flags[SLOW] <= 1.0:
        # after a leap something may still be under way to where the tracker was
        set_free(memory_out, way_out)
    if flags[SLOW] == 0.0:
        return
    led = way_out.state[MODE] == LEADING
    seek_once(geo, skel, settings, posture, poses, memory_out, way_out)
    if flags[LEAP] > 0.0:
        leap_round(geo, skel, settings, posture, poses, memory_out, way_out)
    elif way_out.state[MODE] == LEADING and not led:
        seek_once(geo, skel, settings, posture, poses, memory_out, way_out)
