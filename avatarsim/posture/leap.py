"""After a tracker that leaps: as many steps as its leap is long are taken in that frame, and a way is sought at once.

A tracker that finds its user elsewhere, or a user who is put elsewhere in a world, moves farther within a frame than an avatar
goes in one. Whoever then flies after them for half a second is near nobody meanwhile. Each step is certified as ever.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.workspace import LEAP, Memory
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import norm, row, sub
from avatarsim.world.skeleton import FREE, Skeleton

MOST_STEPS = 100
"""Steps that a leap is followed by at most, 15 m with the usual cap: a tracker may be anywhere. More: a frame takes many
milliseconds."""


@kernel
def leap_of(settings: PostureSettings, moved: float) -> float:
    """Length [m] of the leap of a tracker whose root moved so far [m] in this frame; 0 where the steps of any frame follow it."""
    return moved if moved > settings.steps * settings.move_cap else 0.0


@kernel
def steps_of_leap(settings: PostureSettings, memory: Memory) -> int:
    """Steps that the leap of this frame is long, as far as they are taken."""
    return int(min(memory.flags[LEAP] / settings.move_cap, MOST_STEPS))


@kernel
def has_leapt(skel: Skeleton, memory: Memory) -> bool:
    """Whether a root is as far from where it was before this frame as the tracker leapt: it goes no farther than its user."""
    begun, here, most = memory.goal.begun, memory.goal.closeness.here, 0.0
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == FREE:
            most = max(most, norm(sub(row(here, link), row(begun, link))))
    return bool(most >= memory.flags[LEAP])
