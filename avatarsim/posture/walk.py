"""The certified steps of one frame towards a goal: how many, with what trust, and when it is enough."""

from avatarsim.kernel import kernel
from avatarsim.posture.again import leave_the_rest
from avatarsim.posture.behind import hold
from avatarsim.posture.creep import creeps
from avatarsim.posture.leap import hold_who_has_leapt
from avatarsim.posture.step import budget, step, work_done
from avatarsim.posture.workspace import (
    COUNT,
    COUPLED,
    LEAP,
    LED,
    SLOW,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

ARRIVED = 5e-3
"""[rad or m] a step smaller than this ends the frame: what is left is left for the next one."""

SETTLED = 0.05
"""[rad or m] a step in contact that moves nothing farther ends the frame of an avatar that came no nearer lately: another one
takes as long and brings little that the next frame does not bring as well. 0.02: limbs go to and fro a tenth less often, and
frames in contact take a sixth longer; 0.1: limbs rest more than a millimetre short of a wall that turns them. Where something has
just come in the way all steps are taken, or a foot that the floor caught stays caught."""


@kernel
def is_held(memory: Memory) -> bool:
    """Whether the last step was one in contact, towards a posture that the avatar has not come a fifth nearer to of late."""
    return bool(memory.goal.closeness.mode[COUPLED] > 0.0 and memory.flags[SLOW] > 0.0)


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
