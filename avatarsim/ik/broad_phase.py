"""Broad phase of the avatars: axis-aligned boxes swept over a step, lists of bodies in reach, and islands of avatars.

Two avatars are of one island if their boxes, grown by their largest motion in a frame, meet: then one may push the other. Islands
are the connected components (union by the least number).

Poses of the bodies that are no links, copied into the trial as a frame begins: they do not move while the avatars move.
"""

from math import inf

from avatarsim.ik.state import ISLANDS, IkScratch, IkState, Rig
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Index
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.skeleton import Skeleton
from avatarsim.spatial.vec3 import Rows as Boxes


@kernel
def notice_bodies(geo: Geometry, skel: Skeleton, poses: Poses, moving: Index, scratch_out: IkScratch) -> bool:
    """Copy the poses of bodies that may have moved, all of them where `moving` (nb) is empty; return whether any had."""
    has_changed, is_known = False, moving.shape[0] > 0
    for b in range(skel.first):
        if not is_known or moving[b] == 1:
            has_changed = notice(geo, poses, b, scratch_out) or has_changed
    return has_changed


@kernel
def notice(geo: Geometry, poses: Poses, b: int, scratch_out: IkScratch) -> bool:
    """Copy the pose of one body; return whether it was another one before."""
    trial, has_moved = scratch_out.trial, False
    for i in range(3):
        has_moved = has_moved or trial.position[b, i] != poses.position[b, i]
        for k in range(3):
            has_moved = has_moved or trial.rotation[b, i, k] != poses.rotation[b, i, k]
    if not has_moved:
        return False
    for i in range(3):
        trial.position[b, i] = poses.position[b, i]
        for k in range(3):
            trial.rotation[b, i, k] = poses.rotation[b, i, k]
    for i in range(6):
        trial.hulls[b, i] = poses.hulls[b, i]
        scratch_out.swept_links[b, i] = poses.hulls[b, i]
    for piece in range(geo.first_shape[b], geo.first_shape[b + 1]):
        for i in range(6):
            trial.boxes[piece, i] = poses.boxes[piece, i]
            scratch_out.swept[piece, i] = poses.boxes[piece, i]
        for v in range(geo.shapes.start[piece], geo.shapes.start[piece + 1]):
            for i in range(3):
                trial.vertices[v, i] = poses.vertices[v, i]
    return True


REACH = 0.5
"""[m] the box around an avatar is grown by this before bodies near it are listed; beyond it the list is made again. Larger:
longer lists in every frame; smaller: they are made more often."""


@kernel
def boxes_meet(boxes: Boxes, i: int, j: int) -> bool:
    """Return True if two axis-aligned boxes touch."""
    return bool(
        boxes[i, 0] <= boxes[j, 3] and boxes[j, 0] <= boxes[i, 3]
        and boxes[i, 1] <= boxes[j, 4] and boxes[j, 1] <= boxes[i, 4]
        and boxes[i, 2] <= boxes[j, 5] and boxes[j, 2] <= boxes[i, 5]
    )


@kernel
def sweep_boxes(rig: Rig, avatar: int, poses: Poses, least: float, scratch_out: IkScratch) -> None:
    """Compute boxes around both ends of an avatar's step, of its pieces, links, and all of it, grown by the least gap [m]."""
    geo, avatars = rig.geo, rig.avatars
    s, trial = scratch_out, scratch_out.trial
    for k in range(3):
        s.swept_avatars[avatar, k], s.swept_avatars[avatar, 3 + k] = inf, -inf
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        b = rig.skel.first + link
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
def sweep_all(rig: Rig, poses: Poses, least: float, scratch_out: IkScratch) -> None:
    """Compute boxes of all avatars as a frame begins, for islands are certified against those that were not solved for yet."""
    count = rig.avatars.first_link.shape[0] - 1
    for avatar in range(count if count > 1 else 0):
        sweep_boxes(rig, avatar, poses, least, scratch_out)


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
    """Have the lists of near bodies made anew, since a body moved."""
    for avatar in range(state_out.near_count.shape[0]):
        for k in range(3):
            state_out.near_box[avatar, k], state_out.near_box[avatar, 3 + k] = inf, -inf


@kernel
def form_islands(rig: Rig, state_out: IkState, scratch_out: IkScratch) -> None:
    """Number the islands by the least avatar in each, and list their members one after the other.

    An island decides which avatars may push each other in this frame; that none gets into another is proved in each step against
    all of them."""
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    island, s, count, touching = state_out.tracking.island, scratch_out, avatars.first_link.shape[0] - 1, state_out.touching
    for avatar in range(count):
        island[avatar] = avatar
    for k in range(touching.used[0]):
        link, other = geo.body[touching.pair[k, 0]] - skel.first, geo.body[touching.pair[k, 1]] - skel.first
        if other >= 0 and island[avatars.avatar[link]] != island[avatars.avatar[other]]:
            old = max(island[avatars.avatar[link]], island[avatars.avatar[other]])
            new = min(island[avatars.avatar[link]], island[avatars.avatar[other]])
            for avatar in range(count):
                island[avatar] = new if island[avatar] == old else island[avatar]
    listed = 0
    for first in range(count):
        if island[first] == first:
            s.counts[ISLANDS] += 1
            for avatar in range(first, count):
                if island[avatar] == first:
                    s.members[listed] = avatar
                    listed += 1
