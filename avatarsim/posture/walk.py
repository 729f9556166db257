"""The certified steps of one frame towards a goal: how many, with what trust, and when it is enough."""

from avatarsim.kernel import kernel
from avatarsim.posture.again import leave_the_rest
from avatarsim.posture.behind import hold
from avatarsim.posture.creep import creeps
from avatarsim.posture.goal import measure_way, merit
from avatarsim.posture.leap import hold_who_has_leapt
from avatarsim.posture.step import budget, step, work_done
from avatarsim.posture.workspace import (
    BEYOND,
    CLOSE,
    COUNT,
    COUPLED,
    FRAME,
    LEAP,
    LED,
    LISTED,
    MERIT_WINDOW,
    SLOW,
    STIFF,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

ARRIVED = 5e-3
"""[rad or m] a step smaller than this ends the frame: what is left is left for the next one."""

ALONE, CHANGE = 1.4, 0.25
"""What angles weigh where nothing but limits is in the way, in units of what they weigh in contact, and the share of the way
there that a frame goes, so that a touch turns no limb at once. 1: joints that are within their limits turn a twentieth more."""

UNREACHED = 0.43
"""The same in contact, of a user who is beyond limits: no posture has those angles, but origins may be where the user's are. 1:
in mocap_dance_a origins are 7.8 mm from the user's and angles 3.8 degrees, in mocap_roll 12.1 and 3.5; here 6.5 and 4.0, 11.3
and 3.7. Less than 0.41: a leg that kicks is caught."""

SETTLED = 0.05
"""[rad or m] a step in contact that moves nothing farther ends the frame of an avatar that came no nearer lately: another one
takes as long and brings a hundredth of the way, which the next frame brings as well. 0.1: limbs rest more than a millimetre short
of a wall that turns them. Where something has just come in the way all steps are taken, or a foot that the floor caught stays
caught."""


@kernel
def stiffen(memory_out: Memory) -> None:
    """Bring the weight of angles nearer to that of a posture in contact, of one beyond limits, or of both: listed pairs press."""
    mode, touches = memory_out.goal.closeness.mode, memory_out.pairs.marks[LISTED] > 0
    if touches or mode[BEYOND] > 0.0:
        wanted = ALONE if not touches else UNREACHED if mode[BEYOND] > 0.0 else 1.0
        mode[STIFF] += CHANGE * (wanted - mode[STIFF])


@kernel
def is_held(memory: Memory) -> bool:
    """Whether the last step was one in contact, towards a posture that the avatar has not come a fifth nearer to of late."""
    return bool(memory.goal.closeness.mode[COUPLED] > 0.0 and memory.flags[SLOW] > 0.0)


@kernel
def begin_frame(skel: Skeleton, posture: Posture, memory_out: Memory) -> None:
    """One more frame of steps begins, with the merit that its steps are judged by."""
    stiffen(memory_out)
    frame, now = int(memory_out.flags[FRAME]), 0.0
    if memory_out.flags[CLOSE] == 0.0:
        # where the nearest posture is sought its merit is known once there is a contact
        measure_way(skel, posture, memory_out.goal)
        now = merit(memory_out.goal)
    memory_out.goal.window[frame % MERIT_WINDOW] = now
    memory_out.flags[FRAME] = frame + 1


@kernel
def walk(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, steps: int, posture_out: Posture, poses_out: Poses,
    memory_out: Memory,
) -> float:
    """At most `steps` certified steps towards the goal that `clip_to_limits` has set; the largest part of the last one."""
    largest = 0.0
    for k in range(steps):
        if k >= settings.steps:
            if memory_out.flags[LEAP] > 0.0:
                hold_who_has_leapt(skel, settings, posture_out, memory_out)
            else:
                leave_the_rest(skel, settings, steps - k, posture_out, memory_out.goal)
        if memory_out.flags[LED] > 0.0:
            # some wait, or are led, and the others follow their users
            hold(skel, True, memory_out.goal, memory_out.goal.allowed)
        largest, to_turn, to_move = step(geo, skel, posture_out, poses_out, settings, memory_out)
        there = memory_out.rows.size[COUNT] == 0 and to_turn <= settings.turn_cap and to_move <= settings.move_cap
        enough = SETTLED if is_held(memory_out) else ARRIVED
        if there or largest < enough or creeps(memory_out) or work_done(memory_out) > 0.6 * budget(settings, memory_out):
            break
    memory_out.goal.allowed[:] = 1.0
    return largest
