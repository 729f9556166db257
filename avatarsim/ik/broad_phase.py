"""Broad phase of the avatars: axis-aligned boxes swept over a step, lists of bodies in reach, and islands of avatars.

Two avatars are of one island if their boxes, grown by what they may move in a frame, meet: then one may push the other. Islands
are the connected components (union by the least number).
"""

from math import inf

from avatarsim.ik.state import ISLANDS, Avatars, IkScratch, IkState
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Rows as Boxes
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Skeleton

REACH = 0.5
"""[m] the box around an avatar is grown by this before bodies near it are listed; beyond it the list is made again."""


@kernel
def boxes_meet(boxes: Boxes, i: int, j: int) -> bool:
    """Whether two axis-aligned boxes touch."""
    return bool(
        boxes[i, 0] <= boxes[j, 3] and boxes[j, 0] <= boxes[i, 3]
        and boxes[i, 1] <= boxes[j, 4] and boxes[j, 1] <= boxes[i, 4]
        and boxes[i, 2] <= boxes[j, 5] and boxes[j, 2] <= boxes[i, 5]
    )


@kernel
def sweep_boxes(
    geo: Geometry, skel: Skeleton, avatars: Avatars, avatar: int, poses: Poses, least: float, scratch_out: IkScratch
) -> None:
    """Boxes around both ends of the step of an avatar, of its pieces, its links, and all of it, grown by the least gap [m]."""
    s, trial = scratch_out, scratch_out.trial
    for k in range(3):
        s.swept_avatars[avatar, k], s.swept_avatars[avatar, 3 + k] = inf, -inf
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        b = skel.first + link
        for k in range(3):
            s.swept_links[b, k] = min(poses.hulls[b, k], trial.hulls[b, k]) - least
            s.swept_links[b, 3 + k] = max(poses.hulls[b, 3 + k], trial.hulls[b, 3 + k]) + least
            s.swept_avatars[avatar, k] = min(s.swept_avatars[avatar, k], s.swept_links[b, k])
            s.swept_avatars[avatar, 3 + k] = max(s.swept_avatars[avatar, 3 + k], s.swept_links[b, 3 + k])
        for piece in range(geo.first_shape[b], geo.first_shape[b + 1]):
            for k in range(3):
                s.swept[piece, k] = min(poses.boxes[piece, k], trial.boxes[piece, k]) - least
                s.swept[piece, 3 + k] = max(poses.boxes[piece, 3 + k], trial.boxes[piece, 3 + k]) + least


@kernel
def list_near_bodies(skel: Skeleton, avatar: int, state_out: IkState, scratch: IkScratch) -> None:
    """List the bodies that are no links in reach of an avatar; made again when it leaves the box that the list was made for."""
    box, good, links = scratch.swept_avatars, state_out.near_box, scratch.swept_links
    is_inside = True
    for k in range(3):
        is_inside = is_inside and box[avatar, k] >= good[avatar, k] and box[avatar, 3 + k] <= good[avatar, 3 + k]
    if is_inside:
        return
    for k in range(3):
        good[avatar, k], good[avatar, 3 + k] = box[avatar, k] - REACH, box[avatar, 3 + k] + REACH
    count = 0
    for b in range(skel.first):
        meets = True
        for k in range(3):
            meets = meets and links[b, k] <= good[avatar, 3 + k] and good[avatar, k] <= links[b, 3 + k]
        if meets:
            state_out.near[avatar, count] = b
            count += 1
    state_out.near_count[avatar] = count


@kernel
def forget_near(state_out: IkState) -> None:
    """A body moved: the lists are made anew."""
    for avatar in range(state_out.near_count.shape[0]):
        for k in range(3):
            state_out.near_box[avatar, k], state_out.near_box[avatar, 3 + k] = inf, -inf


@kernel
def grow_box(
    skel: Skeleton, avatars: Avatars, avatar: int, poses: Poses, state: IkState, scratch_out: IkScratch
) -> None:
    """Box of an avatar, grown by what the budget lets its root move, and by the mean reach of a link, which may swing."""
    box, root = scratch_out.swept_avatars, avatars.first_link[avatar]
    far = state.budget.move[root] + state.tracking.reach[avatar]
    for k in range(3):
        box[avatar, k], box[avatar, 3 + k] = inf, -inf
    for b in range(skel.first + root, skel.first + avatars.first_link[avatar + 1]):
        for k in range(3):
            box[avatar, k] = min(box[avatar, k], poses.hulls[b, k] - far)
            box[avatar, 3 + k] = max(box[avatar, 3 + k], poses.hulls[b, 3 + k] + far)


@kernel
def form_islands(skel: Skeleton, avatars: Avatars, poses: Poses, state_out: IkState, scratch_out: IkScratch) -> None:
    """Number the islands by the least avatar in each, and list their members one after the other.

    An island decides which avatars may push each other; that none gets into another is proved in each step against all of
    them."""
    island, s, count = state_out.tracking.island, scratch_out, avatars.first_link.shape[0] - 1
    for avatar in range(count):
        island[avatar] = avatar
        if count > 1:
            grow_box(skel, avatars, avatar, poses, state_out, s)
    for avatar in range(count):
        for other in range(avatar):
            if island[avatar] != island[other] and boxes_meet(s.swept_avatars, avatar, other):
                old, new = max(island[avatar], island[other]), min(island[avatar], island[other])
                for k in range(count):
                    island[k] = new if island[k] == old else island[k]
    listed = 0
    for first in range(count):
        if island[first] == first:
            s.counts[ISLANDS] += 1
            for avatar in range(first, count):
                if island[avatar] == first:
                    s.members[listed] = avatar
                    listed += 1
