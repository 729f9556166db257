"""What a step would run into among the pairs in touch: seen from the poses of the links alone, before anything is certified.

The row of a pair is that of one point. A foot that turns before a wall brings another corner into it: carried out with all its
shapes, such a trial would be refused, and be given the row that it is given here.
"""

from avatarsim.collide.support import support
from avatarsim.kernel import kernel
from avatarsim.posture.certificate import accepted_gap
from avatarsim.posture.contact_row import add_row
from avatarsim.posture.kinematics import carry
from avatarsim.posture.workspace import COUNT, FORWARDS, LISTED, NOW, SOFT, SUPPORTS, Memory
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Rows as Boxes
from avatarsim.spatial.vec3 import Vec3, add, along, dot, neg, row, sub
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton


@kernel
def farthest_of(geo: Geometry, poses: Poses, a: int, d: Vec3) -> Vec3:
    """Farthest point [m] of a piece's core along d at poses whose vertices need not have been carried along."""
    body = geo.body[a]
    frame = columns(poses.rotation, body)
    point, _ = support(geo.local, geo.shapes, a, turned_back(frame, d))
    return add(row(poses.position, body), turned(frame, point))


@kernel
def lies_in(boxes: Boxes, b: int, p: Vec3) -> bool:
    """Whether a point is in the box around piece b: beyond the edge of a table nothing is below its top."""
    for k in range(3):
        if not (boxes[b, k] <= p[k] <= boxes[b, 3 + k]):
            return False
    return True


@kernel
def foresee(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, asked: bool, memory_out: Memory
) -> bool:
    """Carry the links to the trial, their shapes not; whether a listed pair would be refused there, which then has one more row.

    asked: whether rows are still wanted. Only for links before bodies that are none: between links the direction that keeps them
    apart turns with them.
    """
    trial, pairs, r = memory_out.trial, memory_out.pairs, memory_out.rows
    first, before, soft = geo.first_shape[skel.first], r.size[COUNT], memory_out.flags[SOFT] > 0.0
    carry(skel, posture, r.x, trial, memory_out.trial_axes)
    for k in range(pairs.marks[LISTED] if asked else 0):
        a, b = pairs.listed[k, 0], pairs.listed[k, 1]
        i = a - first
        n, gap0 = (pairs.nearest[i, b, 0], pairs.nearest[i, b, 1], pairs.nearest[i, b, 2]), pairs.nearest_gap[i, b]
        if geo.body[b] >= skel.first or pairs.nearest_stamp[i, b] != pairs.marks[NOW] or not (gap0 > 0.0):
            continue
        memory_out.counts[SUPPORTS] += 1
        on_b, _ = support(poses.vertices, geo.shapes, b, n)
        on_a, on_b = along(farthest_of(geo, trial, a, neg(n)), -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
        gap = dot(sub(on_a, on_b), n)
        if gap < accepted_gap(settings, gap0) and lies_in(poses.boxes, b, on_a):
            wanted = min(settings.stand_off, max(gap0, settings.wedged_gap)) if soft else settings.stand_off
            add_row(geo, skel, a, b, n, on_a, on_b, wanted - gap, trial, memory_out.trial_axes, r.x, memory_out)
    if r.size[COUNT] == before:
        return False
    memory_out.counts[FORWARDS] += 1
    return True
