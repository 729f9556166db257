"""Rows that a trial needs, seen from the poses of its links alone, before any shape is carried along or certified.

The row of a pair is that of one point. A foot that turns before a wall brings another corner into it; what pushes one joint turns
others, over their limits too. Certified, such a trial would be refused, and given the row that it is given here.
"""

from avatarsim.collide.support import support
from avatarsim.ik.certificate import accepted_gap
from avatarsim.ik.constraints import add_contact, owner_of
from avatarsim.ik.joint_limits import check_limits
from avatarsim.ik.kinematics import carry_avatar
from avatarsim.ik.pair_cache import slot_of
from avatarsim.ik.state import SUPPORTS, Avatars, IkScratch, IkState
from avatarsim.jit.kernel import kernel
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, dot, neg, row, sub
from avatarsim.tolerances import wedged_gap
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton


@kernel
def foresee(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, posture: Posture, poses: Poses, first: int,
    last: int, is_soft: bool, state: IkState, scratch_out: IkScratch,
) -> bool:
    """Carry the links of members first .. last to the trial, their shapes not; whether a limit or a pair in contact would be
    refused there, which then has one more row."""
    s, before = scratch_out, scratch_out.rows.used[0]
    for m in range(first, last):
        check_limits(skel, avatars, s.members[m], posture, True, s)
        carry_avatar(skel, avatars, s.members[m], posture, s.step, s.trial, s.axes)
    for k in range(state.touching.used[0]):
        a, b = state.touching.pair[k, 0], state.touching.pair[k, 1]
        # between links the direction that keeps them apart turns with them
        if owner_of(geo, skel, avatars, a, s) >= 0 and owner_of(geo, skel, avatars, b, s) < 0:
            foresee_pair(geo, skel, avatars, settings, poses, a, b, is_soft, state, s)
    return bool(s.rows.used[0] > before)


@kernel
def foresee_pair(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, poses: Poses, a: int, b: int, is_soft: bool,
    state: IkState, scratch_out: IkScratch,
) -> None:
    """Row for a piece of a link that the trial brings too near to one that stands still, along their nearest direction now."""
    s, pairs = scratch_out, state.pairs
    at = slot_of(pairs, a, b)
    gap0, n = pairs.gap[at], row(pairs.normal, at)
    if pairs.gap_step[at] != pairs.step[0] or not gap0 > 0.0:
        return
    s.counts[SUPPORTS] += 1
    on_b, _ = support(poses.vertices, geo.shapes, b, n)
    on_a = along(farthest_of(geo, s.trial, a, neg(n)), -geo.shapes.radius[a], n)
    gap = dot(sub(on_a, along(on_b, geo.shapes.radius[b], n)), n)
    if gap < accepted_gap(settings, gap0) and lies_in(poses.boxes, b, on_a):
        wanted = min(settings.stand_off, max(gap0, wedged_gap(settings.stand_off))) if is_soft else settings.stand_off
        add_contact(geo, skel, avatars, a, b, n, on_a, on_b, wanted - gap, s.trial, s.axes, s.step, s)


@kernel
def farthest_of(geo: Geometry, poses: Poses, a: int, d: Vec3) -> Vec3:
    """Farthest point [m] of a piece's core along d at poses whose vertices need not have been carried along."""
    body = geo.body[a]
    frame = columns(poses.rotation, body)
    point, _ = support(geo.local, geo.shapes, a, turned_back(frame, d))
    return add(row(poses.position, body), turned(frame, point))


@kernel
def lies_in(boxes: Rows, b: int, p: Vec3) -> bool:
    """Whether a point is in the box around piece b: beyond the edge of a table nothing is below its top."""
    for k in range(3):
        if not (boxes[b, k] <= p[k] <= boxes[b, 3 + k]):
            return False
    return True
