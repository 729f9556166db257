"""Which avatars came no nearer to their users of late, and for which of these a way is sought: each avatar for itself.

What stands in the way of one hand is no reason to hold another, nor to leave one in a trap because another presses on a wall.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.goal import farthest
from avatarsim.posture.workspace import FRAME, LED, PAST_FRAMES, SLOW, SPEED, UNDER_WAY, Goal, Memory
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import norm, put_row, row
from avatarsim.world.geometry import Array
from avatarsim.world.skeleton import FREE, Posture, Skeleton

NEAR_ENOUGH = 0.05
"""[rad or m] an avatar nearer than this to the tracker's posture in every joint needs no other way."""

NEARER = 0.64
"""Share to which half the squared distance to the tracker must fall within PAST_FRAMES: a fifth of the distance."""


@kernel
def merit_of_tree(skel: Skeleton, root: int, goal: Goal) -> float:
    """`goal.merit` of one avatar."""
    total = 0.0
    for link in range(root, skel.kind.shape[0]):
        if goal.closeness.root[link] == root:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                total += 0.5 * goal.full[j] * goal.full[j] / goal.inverse_weight[j]
    return total


@kernel
def largest_of_tree(skel: Skeleton, root: int, goal: Goal) -> float:
    """Largest part [rad or m] of one avatar's way to its user's posture."""
    most = 0.0
    for link in range(root, skel.kind.shape[0]):
        if goal.closeness.root[link] == root:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                most = max(most, abs(goal.full[j]))
    return most


@kernel
def anybody_is_led(goal: Goal) -> bool:
    """Whether a way is sought for anybody."""
    for root in range(goal.led.shape[0]):
        if goal.led[root] > 0.0:
            return True
    return False


@kernel
def copy_led(goal: Goal, goal_out: Goal) -> None:
    """Seek a way for the same avatars."""
    for root in range(goal.led.shape[0]):
        goal_out.led[root] = goal.led[root]


@kernel
def count_slow(memory_out: Memory) -> None:
    """Frames for which the slowest avatar came no nearer: of those for which a way is sought, else of all."""
    goal, most, sought = memory_out.goal, 0.0, anybody_is_led(memory_out.goal)
    for root in range(goal.led.shape[0]):
        if goal.led[root] > 0.0 or not sought:
            most = max(most, goal.slow[root])
    memory_out.flags[SLOW] = most


@kernel
def set_slow(frames: float, memory_out: Memory) -> None:
    """Say of those for which a way is sought, else of all, that they came no nearer for so many frames."""
    goal, sought = memory_out.goal, anybody_is_led(memory_out.goal)
    for root in range(goal.led.shape[0]):
        if goal.led[root] > 0.0 or (not sought and goal.slow[root] > 0.0):
            goal.slow[root] = frames
    count_slow(memory_out)


@kernel
def judge_anew(skel: Skeleton, memory_out: Memory) -> None:
    """Nobody was slow so far, and from where they are it is judged whether they come nearer."""
    goal = memory_out.goal
    goal.slow[:] = 0.0
    memory_out.flags[SLOW] = 0.0
    for root in range(skel.kind.shape[0]):
        if skel.parent[root] < 0:
            goal.past[root, :] = merit_of_tree(skel, root, goal)


@kernel
def judge_progress(skel: Skeleton, memory_out: Memory) -> None:
    """Count for each avatar the frames in a row in which it is not a fifth nearer to the tracker than PAST_FRAMES before.

    After `unstick`, which has measured the way from where the frame ends. Who is led comes no nearer meanwhile.
    """
    flags, goal = memory_out.flags, memory_out.goal
    place, anybody = int(flags[FRAME]) % PAST_FRAMES, farthest(goal) > NEAR_ENOUGH
    for root in range(skel.kind.shape[0]):
        if skel.parent[root] >= 0:
            continue
        far = anybody and largest_of_tree(skel, root, goal) > NEAR_ENOUGH
        if flags[LED] == UNDER_WAY and goal.led[root] > 0.0:
            goal.slow[root] += 1.0
            continue
        now = merit_of_tree(skel, root, goal)
        goal.slow[root] = goal.slow[root] + 1.0 if far and now > NEARER * goal.past[root, place] else 0.0
        goal.past[root, place] = now
    count_slow(memory_out)


@kernel
def all_are_led(skel: Skeleton, goal: Goal) -> bool:
    """Whether a way is sought for everybody."""
    for root in range(skel.kind.shape[0]):
        if skel.parent[root] < 0 and goal.led[root] == 0.0:
            return False
    return True


@kernel
def is_led(skel: Skeleton, body: int, goal: Goal) -> bool:
    """Whether a body is a link of somebody for whom a way is sought."""
    return bool(body >= skel.first and goal.led[goal.closeness.root[body - skel.first]] > 0.0)


@kernel
def speed_of_led(skel: Skeleton, memory: Memory) -> float:
    """How fast the users are for whose avatars a way is sought [rad or m per frame]; without any, how fast the fastest is."""
    goal, fastest = memory.goal, 0.0
    if not anybody_is_led(goal) or all_are_led(skel, goal):
        return float(memory.flags[SPEED])
    for root in range(goal.led.shape[0]):
        if goal.led[root] > 0.0:
            fastest = max(fastest, goal.leapt[root, 0], goal.leapt[root, 1])
    return fastest


@kernel
def way_of_led(skel: Skeleton, goal: Goal) -> float:
    """How far the farthest root for which a way is sought is from its user's [m]."""
    most = 0.0
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == FREE and is_led(skel, skel.first + link, goal):
            d = skel.first_dof[link]
            most = max(most, norm((goal.full[d], goal.full[d + 1], goal.full[d + 2])))
    return most


@kernel
def keep_others(skel: Skeleton, kept: Posture, goal: Goal, posture_out: Posture) -> None:
    """Give those for whom no way is sought the posture `kept`."""
    for link in range(skel.kind.shape[0]):
        if not is_led(skel, skel.first + link, goal):
            put_row(posture_out.root, link, row(kept.root, link))
            put_columns(posture_out.turn, link, columns(kept.turn, link))
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = kept.angle[j]


@kernel
def hold(skel: Skeleton, led: bool, goal: Goal, allowed_out: Array) -> None:
    """Allow those for whom a way is sought (`led`), or all others, no part of a step (nd)."""
    for link in range(skel.kind.shape[0]):
        if is_led(skel, skel.first + link, goal) == led:
            allowed_out[skel.first_dof[link] : skel.first_dof[link + 1]] = 0.0
