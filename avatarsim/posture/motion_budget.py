"""Motion budget of a planned path: how far may a root and a joint still go in this frame, measured along the path?

The budget of a frame is what the user did in it and what the steps of any frame may do: `steps` times `move_cap` [m] for a root,
`steps` times `turn_cap` [rad] for a joint. All that was gone since the frame began counts, detours included.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import is_led
from avatarsim.posture.workspace import Goal
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import norm
from avatarsim.world.geometry import Array
from avatarsim.world.skeleton import FREE, Skeleton

SPENT = 1e-3
"""Share of a frame's steps that is no longer worth a step of its own. 0: rounding leaves steps of 1e-17 m."""


@kernel
def parts_of(skel: Skeleton, link: int, way: Array) -> tuple[float, float]:
    """How far a root moves [m] and how far a joint turns [rad] on a way (nd) in the tangent space; hinges of a joint together."""
    d, moved, square = skel.first_dof[link], 0.0, 0.0
    if skel.kind[link] == FREE:
        moved = norm((way[d], way[d + 1], way[d + 2]))
        d += 3
    for j in range(d, skel.first_dof[link + 1]):
        square += way[j] * way[j]
    return moved, square**0.5


@kernel
def note_gone(skel: Skeleton, step: Array, goal_out: Goal) -> None:
    """Add a step (nd) that was taken to what has been gone in this frame."""
    for link in range(skel.kind.shape[0]):
        moved, turned = parts_of(skel, link, step)
        goal_out.gone[link, 0] += moved
        goal_out.gone[link, 1] += turned


@kernel
def left_of(skel: Skeleton, settings: PostureSettings, link: int, goal: Goal) -> tuple[float, float]:
    """What is left of the frame's budget for a root's place [m] and a joint [rad]; below 0 where contacts shoved it beyond."""
    root = goal.closeness.root[link]
    move = goal.leapt[root, 0] + settings.steps * settings.move_cap - goal.gone[link, 0]
    turn = goal.leapt[root, 1] + settings.steps * settings.turn_cap - goal.gone[link, 1]
    return move, turn


@kernel
def share_within(skel: Skeleton, settings: PostureSettings, way: Array, goal: Goal) -> float:
    """Largest share up to 1 of a way (nd) that the budget of the led avatars still holds."""
    share = 1.0
    for link in range(skel.kind.shape[0]):
        if not is_led(skel, skel.first + link, goal):
            continue
        moved, turned = parts_of(skel, link, way)
        move, turn = left_of(skel, settings, link, goal)
        if moved > move:
            share = min(share, max(move, 0.0) / moved)
        if turned > turn:
            share = min(share, max(turn, 0.0) / turned)
    return share


@kernel
def is_spent(skel: Skeleton, settings: PostureSettings, goal: Goal) -> bool:
    """Whether a root or a joint of the led avatars has nothing left of its budget in this frame."""
    for link in range(skel.kind.shape[0]):
        if is_led(skel, skel.first + link, goal):
            move, turn = left_of(skel, settings, link, goal)
            if move <= SPENT * settings.steps * settings.move_cap or turn <= SPENT * settings.steps * settings.turn_cap:
                return True
    return False


@kernel
def allow_what_is_left(skel: Skeleton, settings: PostureSettings, goal: Goal, allowed_out: Array) -> None:
    """Allow the led avatars the share of a step (nd) by which it stays within the budget, where contacts do not shove it aside,
    and all others none."""
    for link in range(skel.kind.shape[0]):
        d = skel.first_dof[link]
        move, turn = left_of(skel, settings, link, goal)
        if not is_led(skel, skel.first + link, goal):
            move, turn = 0.0, 0.0
        if skel.kind[link] == FREE:
            allowed_out[d : d + 3] = min(max(move / settings.move_cap, 0.0), 1.0)
            d += 3
        allowed_out[d : skel.first_dof[link + 1]] = min(max(turn / settings.turn_cap, 0.0), 1.0)
