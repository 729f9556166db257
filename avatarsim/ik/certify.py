"""Certification of an island's trial: each pair that the step could bring together proved apart; rows for those that are not.

Rows that a trial needs, seen from the poses of its links alone, before any shape is carried along or certified.

The row of a pair is that of one point. A foot that turns before a wall brings another corner into it; a push on one joint turns
others, over their limits too. Certified, such a trial would be refused, and given the row that it is given here.
"""

from math import inf

from avatarsim.collision.support import support
from avatarsim.ik.broad_phase import boxes_meet, list_near_bodies, sweep_boxes
from avatarsim.ik.certificate import accepted_gap, certify_pair
from avatarsim.ik.constraints import add_contact, add_failed_pair, check_limits, owner_of
from avatarsim.ik.gaps import least_gap, stand_off_of, wedged_gap
from avatarsim.ik.kinematics import carry_avatar
from avatarsim.ik.state import PAIRS, SUPPORTS, IkScratch, IkState, Rig, slot_of
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses, allowed_depth, may_meet
from avatarsim.model.skeleton import Posture
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, dot, neg, row, sub


@kernel
def carry_trial(
    rig: Rig, settings: PostureSettings, posture: Posture, poses: Poses, first: int, last: int, is_soft: bool, state: IkState,
    scratch_out: IkScratch,
) -> bool:
    """Carry the links of members first .. last to the trial, their shapes not; return whether a limit or a pair in contact would
    be refused there, which then has one more row."""
    s, before = scratch_out, scratch_out.rows.used[0]
    for m in range(first, last):
        check_limits(rig, s.members[m], posture, True, s)
        carry_avatar(rig, s.members[m], posture, s.step, s.trial, s.axes)
    for k in range(state.touching.used[0]):
        a, b = state.touching.pair[k, 0], state.touching.pair[k, 1]
        # between links the direction that keeps them apart turns with them
        if owner_of(rig, a, s) >= 0 and owner_of(rig, b, s) < 0:
            foresee_pair(rig, settings, poses, a, b, is_soft, state, s)
    return bool(s.rows.used[0] > before)


@kernel
def foresee_pair(
    rig: Rig, settings: PostureSettings, poses: Poses, a: int, b: int, is_soft: bool, state: IkState, scratch_out: IkScratch
) -> None:
    """Add a row for a piece of a link that the trial brings too near to a body at rest, along their nearest direction now."""
    geo = rig.geo
    s, pairs = scratch_out, state.pairs
    at = slot_of(pairs, a, b)
    gap0, n = pairs.gap[at], row(pairs.normal, at)
    if pairs.gap_step[at] != pairs.step[0] or not gap0 > 0.0:
        return
    s.counts[SUPPORTS] += 1
    on_b, _ = support(poses.vertices, geo.shapes, b, n)
    on_a = along(farthest_of(geo, s.trial, a, neg(n)), -geo.shapes.radius[a], n)
    gap = dot(sub(on_a, along(on_b, geo.shapes.radius[b], n)), n) + allowed_depth(geo, a, b)
    stand_off = stand_off_of(geo, settings.stand_off, a, b)
    if gap < accepted_gap(stand_off, gap0) and lies_in(poses.boxes, b, on_a):
        wanted = min(stand_off, max(gap0, wedged_gap(stand_off))) if is_soft else stand_off
        add_contact(rig, a, b, n, on_a, on_b, wanted - gap, s.trial, s.axes, s.step, s)


@kernel
def farthest_of(geo: Geometry, poses: Poses, a: int, d: Vec3) -> Vec3:
    """Return the farthest point [m] of a piece's core along d at poses whose vertices need not have been carried along."""
    body = geo.body[a]
    frame = columns(poses.rotation, body)
    point, _ = support(geo.local, geo.shapes, a, turned_back(frame, d))
    return add(row(poses.position, body), turned(frame, point))


@kernel
def lies_in(boxes: Rows, b: int, p: Vec3) -> bool:
    """Return True if a point is in the box around piece b: beyond the edge of a table nothing is below its top."""
    for k in range(3):
        if not (boxes[b, k] <= p[k] <= boxes[b, 3 + k]):
            return False
    return True


@kernel
def certify(
    rig: Rig, settings: PostureSettings, posture: Posture, poses: Poses, first: int, last: int, is_adding: bool, is_soft: bool,
    state_out: IkState, scratch_out: IkScratch,
) -> int:
    """Check certificates and ball limits of the trial of members first .. last; return the failures, whose avatars are marked.

    is_adding: failing pairs and limits get rows; is_soft: these require no more gap than there was.
    """
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    s, failed = scratch_out, 0
    s.failed.used[0] = 0
    for m in range(first, last):
        avatar = s.members[m]
        state_out.tracking.has_failed[avatar] = 0
        if state_out.tracking.is_certified[avatar] > 0:
            continue
        beyond = check_limits(rig, avatar, posture, is_adding, s)
        if is_no_pose(rig, avatar, s):
            beyond += 1
        if beyond > 0:
            state_out.tracking.has_failed[avatar] = 1
            failed += beyond
        sweep_boxes(rig, avatar, poses, least_gap(settings.stand_off), s)
        list_near_bodies(skel, avatar, state_out, s)
    if failed > 0 and is_adding:
        # a push on one joint turns others, over limits too: solved for before pairs are looked at
        return failed
    for m in range(first, last):
        avatar = s.members[m]
        low, high = avatars.first_link[avatar], avatars.first_link[avatar + 1]
        for link in range(low, high if state_out.tracking.is_certified[avatar] == 0 else low):
            body = skel.first + link
            for n in range(state_out.near_count[avatar]):
                other = state_out.near[avatar, n]
                if boxes_meet(s.swept_links, body, other) and may_meet(geo.wanted, body, other):
                    failed += certify_bodies(rig, settings, poses, body, other, is_adding, is_soft, state_out, s)
            for k in range(link + 1, high):
                other = skel.first + k
                if boxes_meet(s.swept_links, body, other) and may_meet(geo.wanted, body, other):
                    failed += certify_bodies(rig, settings, poses, body, other, is_adding, is_soft, state_out, s)
        for other in range(avatars.first_link.shape[0] - 1):
            is_new = state_out.tracking.is_certified[avatar] == 0 or (
                s.is_active[other] > 0 and state_out.tracking.is_certified[other] == 0
            )
            if is_new and (other > avatar or (other < avatar and s.is_active[other] == 0)):
                one, two = min(avatar, other), max(avatar, other)
                failed += certify_avatars(rig, settings, poses, one, two, is_adding, is_soft, state_out, s)
    for m in range(first, last):
        state_out.tracking.is_certified[s.members[m]] = 1 - state_out.tracking.has_failed[s.members[m]]
    return failed


@kernel
def certify_avatars(
    rig: Rig, settings: PostureSettings, poses: Poses, one: int, other: int, is_adding: bool, is_soft: bool, state_out: IkState,
    scratch_out: IkScratch,
) -> int:
    """Certify the pairs of two avatars, which come in ascending order; return the number of failures."""
    skel, avatars = rig.skel, rig.avatars
    s, failed = scratch_out, 0
    if not boxes_meet(s.swept_avatars, one, other):
        return 0
    for link in range(avatars.first_link[one], avatars.first_link[one + 1]):
        body = skel.first + link
        for k in range(avatars.first_link[other], avatars.first_link[other + 1]):
            if boxes_meet(s.swept_links, body, skel.first + k) and may_meet(rig.geo.wanted, body, skel.first + k):
                failed += certify_bodies(rig, settings, poses, body, skel.first + k, is_adding, is_soft, state_out, s)
    return failed


@kernel
def certify_bodies(
    rig: Rig, settings: PostureSettings, poses: Poses, body: int, other: int, is_adding: bool, is_soft: bool, state_out: IkState,
    scratch_out: IkScratch,
) -> int:
    """Certify the pairs of pieces of a link and another body; return the number of failures."""
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    s, failed = scratch_out, 0
    for a in range(geo.first_shape[body], geo.first_shape[body + 1]):
        for b in range(geo.first_shape[other], geo.first_shape[other + 1]):
            if not boxes_meet(s.swept, a, b):
                continue
            s.counts[PAIRS] += 1
            holds, gap, n, simplex = certify_pair(geo, poses, settings, a, b, state_out, s)
            if holds:
                continue
            failed += 1
            k = s.failed.used[0]
            if k < s.failed.pair.shape[0]:
                s.failed.pair[k, 0], s.failed.pair[k, 1], s.failed.used[0] = a, b, k + 1
            state_out.tracking.has_failed[avatars.avatar[body - skel.first]] = 1
            if other >= skel.first:
                state_out.tracking.has_failed[avatars.avatar[other - skel.first]] = 1
            if is_adding:
                add_failed_pair(rig, settings, a, b, gap, n, simplex, is_soft, state_out, s)
    return failed


@kernel
def is_no_pose(rig: Rig, avatar: int, scratch: IkScratch) -> bool:
    """Return True if a link's trial pose is not finite: boxes of nowhere meet nothing, so no pair would be tested."""
    skel, avatars = rig.skel, rig.avatars
    trial, total = scratch.trial, 0.0
    for b in range(skel.first + avatars.first_link[avatar], skel.first + avatars.first_link[avatar + 1]):
        for i in range(3):
            total += abs(trial.position[b, i])
            for k in range(3):
                total += abs(trial.rotation[b, i, k])
    return not (total < inf)
