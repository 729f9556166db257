"""How an avatar moves that many bodies are near to: when do its joints go their own way, and how far may it go in a frame?

Fingers that press on many things are wedged for some frames, and when they come free the whole hand jumps. So while it comes
nearer to its user each joint goes its own way, which no wedge stops for long. Held by many for a while it seeks the nearest
posture, as anybody in contact does; and while it is held none of its links goes much farther in a frame than its user's farthest.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.closeness import locate
from avatarsim.posture.kinematics import forward
from avatarsim.posture.workspace import (
    CROWDED,
    FORWARDS,
    LED,
    LISTED,
    NEAR_BODIES,
    SLOW,
    SOUGHT,
    TRAVELS,
    UNDER_WAY,
    Memory,
)
from avatarsim.spatial.vec3 import norm, put_row, row, sub
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import UNLIMITED, Posture, Skeleton

CROWD, TOUCHING, SPARSE, SPARSE_FRAMES = 9, 5, 4, 3.0
"""Near pairs of bodies in the last trial beyond which many are near, or more than TOUCHING of them and of pairs in touch. Six
near pairs alone are arms that fold before a chest, or a human who gets up: going their own way they end a twentieth farther from
the user's, and jump twice as far; 100, and a hand that comes free is a frame late. It is over once no more than SPARSE were near
in so many frames: with one number for both a body shifted to and fro by 0.2 m, and a hand that grasps came home late."""

HELD_FRAMES, HELD_BY = 6.0, 8
"""Frames without coming nearer after which an avatar in a crowd seeks the nearest posture, and how many pairs in touch are not
enough for that. A hand pressed into a corner has 10 to 17, fingers that close on a mug at most 7: seeking it they end nearer by a
tenth, but turned by three times as much as in the nearest posture, since the way there is not downhill."""

SLIDE, CATCH_UP = 5e-3, 0.1
"""[m], and share of the way to the user: what a link goes farther than its user's farthest in a frame, whichever is more. 5 mm
are half of the bound of `hand_in_corner`, where a hand without it jumps by 18 mm and its fingers by 25. Without the share a hand
that was held far off comes home late."""


@kernel
def is_crowded(memory_out: Memory) -> bool:
    """Whether many pairs of bodies are near or in touch, or were and there have not yet been frames enough with few."""
    pairs, flags = memory_out.pairs, memory_out.flags
    near, touching = pairs.marks[NEAR_BODIES], pairs.marks[LISTED]
    if near > CROWD or min(near, touching) > TOUCHING:
        flags[CROWDED] = SPARSE_FRAMES
    elif near <= SPARSE:
        flags[CROWDED] = max(0.0, flags[CROWDED] - 1.0)
    return bool(flags[CROWDED] > 0.0)


@kernel
def is_pressed(geo: Geometry, skel: Skeleton, root: int, memory: Memory) -> bool:
    """Whether an avatar is held by many, of whom at least one is no link of its own: a fist in the air is no crowd."""
    roots, listed = memory.goal.closeness.root, memory.pairs.listed
    if memory.pairs.marks[LISTED] <= HELD_BY:
        return False
    for k in range(memory.pairs.marks[LISTED]):
        a, b = geo.body[listed[k, 0]] - skel.first, geo.body[listed[k, 1]] - skel.first
        first, second = roots[a] if a >= 0 else -1, roots[b] if b >= 0 else -1
        if first != second and (first == root or second == root):
            return True
    return False


@kernel
def measure_strides(geo: Geometry, skel: Skeleton, memory_out: Memory) -> None:
    """How far the links of each avatar may go in this frame that something presses on: as far as its user's farthest link, and a
    little.

    Before `tracker_speed`, which forgets where the user was; fills goal.stood and goal.stride."""
    goal, root = memory_out.goal, memory_out.goal.closeness.root
    c, stood, stride = goal.closeness, goal.stood, goal.stride
    locate(skel, goal.before, c)
    for link in range(root.shape[0]):
        put_row(c.way, link, row(c.there, link))
        put_row(stood, link, row(c.here, link))
    locate(skel, goal.tracker, c)
    strode, behind = 0.0, 0.0
    for first in range(root.shape[0]):
        if root[first] != first:
            continue
        if not is_pressed(geo, skel, first, memory_out):
            stride[first] = UNLIMITED
            continue
        strode, behind = 0.0, 0.0
        for link in range(first, root.shape[0]):
            if root[link] == first:
                user = row(c.there, link)
                strode = max(strode, norm(sub(user, row(c.way, link))))
                behind = max(behind, norm(sub(user, row(stood, link))))
        stride[first] = strode + max(SLIDE, CATCH_UP * behind)


@kernel
def meet_a_crowd(geo: Geometry, skel: Skeleton, memory_out: Memory) -> bool:
    """Measure strides in a crowd; whether each joint goes its own way: there, unless the slowest avatar is held for a while."""
    if not is_crowded(memory_out):
        return False
    measure_strides(geo, skel, memory_out)
    return bool(memory_out.flags[SLOW] < HELD_FRAMES or memory_out.pairs.marks[LISTED] <= HELD_BY)


@kernel
def is_held_in(memory: Memory) -> bool:
    """Whether strides are short in this frame: not of a user who is elsewhere, nor where there is a free way to them."""
    flags = memory.flags
    return bool(flags[CROWDED] > 0.0 and flags[TRAVELS] == 0.0 and flags[SOUGHT] == 0.0)


@kernel
def share_left(skel: Skeleton, root: int, poses: Poses, memory: Memory) -> float:
    """Share of the step in rows.x, whose trial is at hand, by which no link of an avatar goes farther than it may."""
    goal, share = memory.goal, 1.0
    if memory.flags[LED] == UNDER_WAY and goal.led[root] > 0.0:
        # a way that was found is gone at full speed
        return share
    for link in range(root, skel.kind.shape[0]):
        if goal.closeness.root[link] != root:
            continue
        there = row(memory.trial.position, skel.first + link)
        if norm(sub(there, row(goal.stood, link))) > goal.stride[root]:
            here = row(poses.position, skel.first + link)
            left, far = max(goal.stride[root] - norm(sub(here, row(goal.stood, link))), 0.0), norm(sub(there, here))
            if left < share * far:
                share = left / far
    return share


@kernel
def slide(geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, memory_out: Memory) -> bool:
    """In a crowd, shorten the steps in rows.x of those of whom a link would go too far, and make the trial anew; whether it was.

    All of an avatar's step together: a root alone that stays behind tears the rest off the nearest posture."""
    shortened = False
    if not is_held_in(memory_out):
        return shortened
    for root in range(skel.kind.shape[0]):
        if skel.parent[root] >= 0:
            continue
        share = share_left(skel, root, poses, memory_out)
        if share < 1.0:
            shortened = True
            for link in range(root, skel.kind.shape[0]):
                if memory_out.goal.closeness.root[link] == root:
                    for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                        memory_out.rows.x[j] *= share
    if shortened:
        memory_out.counts[FORWARDS] += 1
        forward(geo, skel, posture, memory_out.rows.x, memory_out.trial, memory_out.trial_axes)
    return shortened
