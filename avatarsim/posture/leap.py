"""After a tracker that leaps: as many steps as its leap is long are taken in that frame, and a way is sought at once.

A tracker that finds its user elsewhere, or a user who is put elsewhere in a world, moves farther within a frame than an avatar
goes in one. Whoever then flies after them for half a second is near nobody meanwhile. Each step is certified as ever.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.goal import link_way
from avatarsim.posture.workspace import LEAP, Memory
from avatarsim.settings import PostureSettings
from avatarsim.world.skeleton import FREE, Posture, Skeleton

MOST_STEPS = 100
"""Steps that a leap is followed by at most, 15 m with the usual cap: a tracker may be anywhere. More: a frame takes many
milliseconds."""

SLACK = 1e-3
"""[m] what a root may be beyond its user's leap and still be led: it was that far from its user before, as one in contact is."""


@kernel
def leap_of(settings: PostureSettings, moved: float) -> float:
    """Length [m] of the leap of a tracker whose root moved so far [m] in this frame; 0 where the steps of any frame follow it."""
    return moved if moved > settings.steps * settings.move_cap else 0.0


@kernel
def steps_of_leap(settings: PostureSettings, memory: Memory) -> int:
    """Steps that the leap of this frame is long, as far as they are taken."""
    return int(min(memory.flags[LEAP] / settings.move_cap, MOST_STEPS))


@kernel
def hold_who_has_leapt(skel: Skeleton, settings: PostureSettings, posture: Posture, memory_out: Memory) -> None:
    """After the steps of any frame: who has gone as far as they may waits, and so does everybody whose own user has not leapt.

    A root goes as far as its user leapt. A joint turns as far as any of its user's did, and as the steps of a frame turn it: a
    limb that was held elsewhere comes on a way that is seen.
    """
    goal = memory_out.goal
    for link in range(skel.kind.shape[0]):
        root = goal.closeness.root[link]
        leap, turn = goal.leapt[root, 0], goal.leapt[root, 1] + settings.steps * settings.turn_cap
        follows = leap_of(settings, leap) > 0.0
        way, turned = link_way(skel, link, goal.begun, posture)
        d = skel.first_dof[link]
        if skel.kind[link] == FREE:
            goal.allowed[d : d + 3] = 1.0 if follows and way < leap else 0.0
            d += 3
        goal.allowed[d : skel.first_dof[link + 1]] = 1.0 if follows and turned < turn else 0.0


@kernel
def has_leapt(skel: Skeleton, posture: Posture, memory: Memory) -> bool:
    """Whether nobody leaps, or a root is farther from where the frame began than its user leapt: it is led no farther."""
    goal = memory.goal
    if memory.flags[LEAP] == 0.0:
        return True
    for link in range(skel.kind.shape[0]):
        way, _ = link_way(skel, link, goal.begun, posture)
        if way > goal.leapt[goal.closeness.root[link], 0] + SLACK:
            return True
    return False


@kernel
def is_too_far(skel: Skeleton, settings: PostureSettings, posture: Posture, memory: Memory) -> bool:
    """Whether a root or a joint is farther from where the frame began than its user went and the steps of a frame go."""
    goal = memory.goal
    for link in range(skel.kind.shape[0]):
        root = goal.closeness.root[link]
        way, turned = link_way(skel, link, goal.begun, posture)
        far = goal.leapt[root, 0] + settings.steps * settings.move_cap
        if way > far or turned > goal.leapt[root, 1] + settings.steps * settings.turn_cap:
            return True
    return False
