"""What the way of the tracker since the last frame says of how to follow it in this one."""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import all_are_led, set_slow
from avatarsim.posture.body_place import MOST_TURNED
from avatarsim.posture.goal import tracker_speed
from avatarsim.posture.jointed import has_joints
from avatarsim.posture.workspace import (
    ASTRAY,
    CALM,
    CLOSE,
    LEAP,
    LED,
    PRESSED,
    RESTED,
    SLOW,
    SOUGHT,
    SPEED,
    TRACKER_SPEED,
    TRAVELS,
    UNDER_WAY,
    Memory,
)
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import UNLIMITED, Skeleton

JUMP = MOST_TURNED + 0.01
"""[rad or m] a tracker that moves more than this within a frame has jumped: whether one comes nearer to it is judged anew. Less,
and a body that comes back from aside counts as a jump in each frame: a way that is sought meanwhile is begun again and again."""

OUTRUN = 0.7
"""[rad] a tracker that turns a joint more than this within a frame, as no joint can in two steps, or a root by a jump, is
elsewhere: it is followed joint by joint until the avatar is there or the tracker's posture is found to be not free, since on a
long way the nearest posture is no guide: limbs that stretch get caught. Who has no joints has none, and is nearest all the way.
0.2: a kick is followed so, and its limbs end twice as far from the user's."""

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
    flags, mode = memory_out.flags, memory_out.goal.closeness.mode
    speed, moved = tracker_speed(skel, memory_out.goal)
    flags[TRACKER_SPEED] = min(max(speed, SPEED_MEMORY * flags[TRACKER_SPEED]), FASTEST)
    flags[SPEED], flags[LEAP] = speed, 0.0
    # along a way that was found too: who is led late is not seen to wander at its end
    flags[RESTED] = flags[RESTED] + 1.0 if speed < CALM_SPEED and not changed else 0.0
    if speed > JUMP:
        # whoever jumps wants to go elsewhere
        flags[LED] = 0.0
        memory_out.goal.past[:] = UNLIMITED
    if (speed > OUTRUN or moved > JUMP) and has_joints(skel):
        flags[TRAVELS] = 1.0
    if flags[LED] == UNDER_WAY and all_are_led(skel, memory_out.goal):
        set_slow(flags[SLOW] + 1.0, memory_out)
        flags[CLOSE] = 0.0
        return moved
    # to a posture known to be free, and to one that is far, each joint goes its own way: limbs that stretch get caught
    lost = mode[ASTRAY] > 0.0
    close = 1.0 if flags[TRAVELS] == 0.0 and flags[SOUGHT] == 0.0 and not lost else 0.0
    if close != flags[CLOSE]:
        flags[CLOSE] = close
        memory_out.goal.window[:] = 0.0
    flags[CALM] = flags[CALM] + 1.0 if speed < CALM_SPEED else 0.0
    if speed >= PUSHING:
        flags[PRESSED] = 0.0
    return moved
