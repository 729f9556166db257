"""Certify a trial: every near pair proved apart and uncrossed; rows for those that are not."""

from math import inf

from avatarsim.kernel import kernel
from avatarsim.posture.certificate import (
    accepted_gap,
    axis_of,
    cached_axis_holds,
    checked_direction,
    nearest_direction,
    nothing_crossed,
    remember_axis,
)
from avatarsim.posture.contact_row import support_row, witness_row
from avatarsim.posture.workspace import ADDING, ASKED, FAILED, NEAR, NEARBY, SOFT, Memory
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import Rows as Boxes
from avatarsim.spatial.vec3 import dot
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import may_meet
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
def sweep_boxes(geo: Geometry, skel: Skeleton, poses: Poses, least: float, memory_out: Memory) -> None:
    """Boxes around both ends of the step, of driven pieces and links, grown by the least gap."""
    trial, swept, hulls = memory_out.trial, memory_out.swept, memory_out.swept_hulls
    first, nb = geo.first_shape[skel.first], geo.first_shape.shape[0] - 1
    for s in range(first, geo.body.shape[0]):
        for k in range(3):
            swept[s, k] = min(poses.boxes[s, k], trial.boxes[s, k]) - least
            swept[s, 3 + k] = max(poses.boxes[s, 3 + k], trial.boxes[s, 3 + k]) + least
    for b in range(skel.first, nb):
        for k in range(3):
            hulls[b, k] = min(poses.hulls[b, k], trial.hulls[b, k]) - least
            hulls[b, 3 + k] = max(poses.hulls[b, 3 + k], trial.hulls[b, 3 + k]) + least


@kernel
def list_near_bodies(skel: Skeleton, memory_out: Memory) -> None:
    """List the bodies in reach of the avatars; made again when the avatars leave the box it was made for."""
    hulls, reach, near = memory_out.swept_hulls, memory_out.reach, memory_out.pairs.near
    stale = False
    for b in range(skel.first, hulls.shape[0]):
        for k in range(3):
            if not (hulls[b, k] >= reach[k] and hulls[b, 3 + k] <= reach[3 + k]):
                stale = stale or hulls[b, k] <= hulls[b, 3 + k]
    if not stale:
        return
    for k in range(3):
        reach[k], reach[3 + k] = inf, -inf
        for b in range(skel.first, hulls.shape[0]):
            reach[k], reach[3 + k] = min(reach[k], hulls[b, k] - REACH), max(reach[3 + k], hulls[b, 3 + k] + REACH)
    count = 0
    for b in range(skel.first):
        inside = True
        for k in range(3):
            inside = inside and hulls[b, k] <= reach[3 + k] and reach[k] <= hulls[b, 3 + k]
        if inside:
            near[count] = b
            count += 1
    memory_out.pairs.marks[NEARBY] = count


@kernel
def is_no_pose(skel: Skeleton, memory: Memory) -> bool:
    """Whether a link's trial pose is not finite: boxes of nowhere meet nothing, so no pair would be asked."""
    trial, total = memory.trial, 0.0
    for b in range(skel.first, trial.position.shape[0]):
        for i in range(3):
            total += abs(trial.position[b, i])
            for k in range(3):
                total += abs(trial.rotation[b, i, k])
    return not (total < inf)


@kernel
def certify_pair(
    geo: Geometry, skel: Skeleton, poses: Poses, a: int, b: int, settings: PostureSettings, memory_out: Memory
) -> bool:
    """Whether pieces a and b hold their certificate; a failing pair gets a row if rows are being added."""
    i = a - geo.first_shape[skel.first]
    if cached_axis_holds(geo, poses, memory_out, i, a, b, settings.least_gap):
        return True
    gap0, n0 = checked_direction(geo, poses, i, a, b, memory_out)
    least = accepted_gap(settings, gap0)
    if cached_axis_holds(geo, poses, memory_out, i, a, b, least):
        return True
    gap1, n1, simplex = nearest_direction(geo, memory_out.trial, axis_of(memory_out, i, b), a, b, 0.02, memory_out)
    uncrossed = gap1 > 0.0 and nothing_crossed(geo, poses, a, b, n0, n1, memory_out)
    if uncrossed and gap1 >= least:
        remember_axis(memory_out, i, b, n1)
        return True
    if memory_out.flags[ADDING] > 0.0:
        wanted = settings.stand_off
        if memory_out.flags[SOFT] > 0.0:
            wanted = min(wanted, max(gap0, settings.wedged_gap))
        if uncrossed:
            trial, axes = memory_out.trial, memory_out.trial_axes
            witness_row(geo, skel, a, b, n1, gap1, wanted, simplex, trial, axes, memory_out.rows.x, memory_out)
        elif dot(n0, n0) > 0.5:
            support_row(geo, skel, a, b, n0, wanted, memory_out)
    return False


@kernel
def certify(
    geo: Geometry, skel: Skeleton, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> int:
    """Certify the trial; return the number of failed pairs, some of them named in pairs.failed."""
    sweep_boxes(geo, skel, poses, settings.least_gap, memory_out)
    list_near_bodies(skel, memory_out)
    swept, hulls, pairs = memory_out.swept, memory_out.swept_hulls, memory_out.pairs
    nb, failed = geo.first_shape.shape[0] - 1, 0
    pairs.marks[FAILED], pairs.marks[ASKED] = 0, 0
    if is_no_pose(skel, memory_out):
        memory_out.touched[:] = True
        return 1
    for link in range(skel.first, nb):
        for other in range(pairs.marks[NEARBY] + nb - link - 1):
            k = pairs.near[other] if other < pairs.marks[NEARBY] else link + 1 + other - pairs.marks[NEARBY]
            if not boxes_meet(hulls, link, k) or not may_meet(geo.wanted, link, k):
                continue
            for a in range(geo.first_shape[link], geo.first_shape[link + 1]):
                for b in range(geo.first_shape[k], geo.first_shape[k + 1]):
                    if boxes_meet(swept, a, b):
                        memory_out.counts[NEAR] += 1
                        pairs.marks[ASKED] += 1
                        if not certify_pair(geo, skel, poses, a, b, settings, memory_out):
                            failed += 1
                            if pairs.marks[FAILED] < pairs.failed.shape[0]:
                                pairs.failed[pairs.marks[FAILED], 0] = a
                                pairs.failed[pairs.marks[FAILED], 1] = b
                                pairs.marks[FAILED] += 1
    return failed
