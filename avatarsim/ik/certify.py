"""Certify the trial of an island: every pair that the step could bring together proved apart; rows for those that are not."""

from math import inf

from avatarsim.ik.broad_phase import boxes_meet, list_near_bodies, sweep_boxes
from avatarsim.ik.certificate import certify_pair
from avatarsim.ik.constraints import add_failed_pair
from avatarsim.ik.joint_limits import check_limits
from avatarsim.ik.state import PAIRS, Avatars, IkScratch, IkState
from avatarsim.jit.kernel import kernel
from avatarsim.settings import PostureSettings
from avatarsim.tolerances import least_gap
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import may_meet
from avatarsim.world.skeleton import Posture, Skeleton


@kernel
def certify(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, posture: Posture, poses: Poses, first: int,
    last: int, is_adding: bool, is_soft: bool, state_out: IkState, scratch_out: IkScratch,
) -> int:
    """Certificates and ball limits of the trial of members first .. last: number of failures, whose avatars are marked.

    is_adding: failing pairs and limits get rows; is_soft: which ask for no more gap than there was.
    """
    s, failed = scratch_out, 0
    s.failed.used[0] = 0
    for m in range(first, last):
        avatar = s.members[m]
        state_out.tracking.has_failed[avatar] = 0
        if state_out.tracking.is_certified[avatar] > 0:
            continue
        beyond = check_limits(skel, avatars, avatar, posture, is_adding, s)
        if is_no_pose(skel, avatars, avatar, s):
            beyond += 1
        if beyond > 0:
            state_out.tracking.has_failed[avatar] = 1
            failed += beyond
        sweep_boxes(geo, skel, avatars, avatar, poses, least_gap(settings.stand_off), s)
        list_near_bodies(skel, avatar, state_out, s)
    if failed > 0 and is_adding:
        # what pushes one joint turns others, over limits too: solved for before pairs are looked at
        return failed
    for m in range(first, last):
        avatar = s.members[m]
        low, high = avatars.first_link[avatar], avatars.first_link[avatar + 1]
        for link in range(low, high if state_out.tracking.is_certified[avatar] == 0 else low):
            body = skel.first + link
            for n in range(state_out.near_count[avatar]):
                other = state_out.near[avatar, n]
                if boxes_meet(s.swept_links, body, other) and may_meet(geo.wanted, body, other):
                    failed += certify_bodies(geo, skel, avatars, settings, poses, body, other, is_adding, is_soft, state_out, s)
            for k in range(link + 1, high):
                other = skel.first + k
                if boxes_meet(s.swept_links, body, other) and may_meet(geo.wanted, body, other):
                    failed += certify_bodies(geo, skel, avatars, settings, poses, body, other, is_adding, is_soft, state_out, s)
        for other in range(avatars.first_link.shape[0] - 1):
            is_new = state_out.tracking.is_certified[avatar] == 0 or (
                s.is_active[other] > 0 and state_out.tracking.is_certified[other] == 0
            )
            if is_new and (other > avatar or (other < avatar and s.is_active[other] == 0)):
                one, two = min(avatar, other), max(avatar, other)
                failed += certify_avatars(geo, skel, avatars, settings, poses, one, two, is_adding, is_soft, state_out, s)
    for m in range(first, last):
        state_out.tracking.is_certified[s.members[m]] = 1 - state_out.tracking.has_failed[s.members[m]]
    return failed


@kernel
def certify_avatars(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, poses: Poses, one: int, other: int,
    is_adding: bool, is_soft: bool, state_out: IkState, scratch_out: IkScratch,
) -> int:
    """The same of the pairs of two avatars, which come in ascending order."""
    s, failed = scratch_out, 0
    if not boxes_meet(s.swept_avatars, one, other):
        return 0
    for link in range(avatars.first_link[one], avatars.first_link[one + 1]):
        body = skel.first + link
        for k in range(avatars.first_link[other], avatars.first_link[other + 1]):
            if boxes_meet(s.swept_links, body, skel.first + k) and may_meet(geo.wanted, body, skel.first + k):
                failed += certify_bodies(
                    geo, skel, avatars, settings, poses, body, skel.first + k, is_adding, is_soft, state_out, s
                )
    return failed


@kernel
def certify_bodies(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, poses: Poses, body: int, other: int,
    is_adding: bool, is_soft: bool, state_out: IkState, scratch_out: IkScratch,
) -> int:
    """The same of the pairs of pieces of a link and another body."""
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
                add_failed_pair(geo, skel, avatars, settings, a, b, gap, n, simplex, is_soft, state_out, s)
    return failed


@kernel
def is_no_pose(skel: Skeleton, avatars: Avatars, avatar: int, scratch: IkScratch) -> bool:
    """Whether a link's trial pose is not finite: boxes of nowhere meet nothing, so no pair would be asked."""
    trial, total = scratch.trial, 0.0
    for b in range(skel.first + avatars.first_link[avatar], skel.first + avatars.first_link[avatar + 1]):
        for i in range(3):
            total += abs(trial.position[b, i])
            for k in range(3):
                total += abs(trial.rotation[b, i, k])
    return not (total < inf)
