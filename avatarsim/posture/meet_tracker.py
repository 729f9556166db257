"""What the way of the tracker since the last frame says of how to follow it in this one."""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import all_are_led, set_slow
from avatarsim.posture.goal import tracker_speed
from avatarsim.posture.workspace import (
    CALM,
    CLOSE,
    LEAP,
    LED,
    PRESSED,
    RESTED,
    SLOW,
    SPEED,
    TRACKER_SPEED,
    UNDER_WAY,
    Memory,
)
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import UNLIMITED, Skeleton

JUMP = 0.31
"""[rad or m] a tracker that moves more than this within a frame has jumped: whether one comes nearer to it is judged anew. Less,
and the search for a path is begun again and again while the user swings an arm."""

CALM_SPEED, PUSHING = 1e-3, 1e-2
"""[rad or m] a tracker that moves less than the first per frame rests; one that moves more than the second is followed as fast
as one can, whatever limbs are pressed into."""

SPEED_MEMORY = 0.8
"""Share of the tracker's speed that is remembered from frame to frame: it may rest for one frame and go on."""

FASTEST = 100.0
"""[rad or m] speed of a tracker per frame beyond which more is not remembered: one sample from the end of the world would count
for all that come after."""


@kernel
def meet_the_tracker(geo: Geometry, skel: Skeleton, changed: bool, memory_out: Memory) -> float:
    """What the way of the tracker since the last frame says of how to follow it; that of a root's place [m].

    changed: whether anything near has moved."""
    flags = memory_out.flags
    speed, moved = tracker_speed(skel, memory_out.goal)
    flags[TRACKER_SPEED] = min(max(speed, SPEED_MEMORY * flags[TRACKER_SPEED]), FASTEST)
    flags[SPEED], flags[LEAP] = speed, 0.0
    # along a way that was found too: who is led late is not seen to wander at its end
    flags[RESTED] = flags[RESTED] + 1.0 if speed < CALM_SPEED and not changed else 0.0
    if speed > JUMP:
        # whoever jumps wants to go elsewhere
        flags[LED] = 0.0
        memory_out.goal.past[:] = UNLIMITED
    if flags[LED] == UNDER_WAY and all_are_led(skel, memory_out.goal):
        set_slow(flags[SLOW] + 1.0, memory_out)
        flags[CLOSE] = 0.0
        return moved
    flags[CLOSE] = 1.0
    flags[CALM] = flags[CALM] + 1.0 if speed < CALM_SPEED else 0.0
    if speed >= PUSHING:
        flags[PRESSED] = 0.0
    return moved
