"""How far may a root go in further steps of a frame: those after loose objects have moved on, or that one in a hurry has more?"""

from avatarsim.kernel import kernel
from avatarsim.posture.goal import link_way
from avatarsim.posture.workspace import Goal
from avatarsim.settings import PostureSettings
from avatarsim.world.skeleton import FREE, Posture, Skeleton


@kernel
def leave_the_rest(skel: Skeleton, settings: PostureSettings, steps: int, posture: Posture, goal_out: Goal) -> None:
    """Shorten the place's part of `steps` more steps of each root to what it has left in this frame: as far as its user went and
    the steps of any frame go. A hand that a loose pile lets go of jumps no farther than one that had nothing in its way.

    Limbs are not held: what they push on gives way all the sooner."""
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == FREE:
            d = skel.first_dof[link]
            way, _ = link_way(skel, link, goal_out.begun, posture)
            left = goal_out.leapt[link, 0] + settings.steps * settings.move_cap - way
            goal_out.allowed[d : d + 3] = min(max(left / (steps * settings.move_cap), 0.0), 1.0)
