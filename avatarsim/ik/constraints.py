"""Constraint rows of a step: how the gap of a pair changes with every degree of freedom (contact Jacobian), as J x >= bound."""

from math import inf

from avatarsim.collide.gjk import closest_points
from avatarsim.collide.support import support
from avatarsim.ik.certificate import EXACT, keep_nearest, nearest_direction
from avatarsim.ik.pair_cache import axis_at, slot_of
from avatarsim.ik.state import DROPPED, ROWS, Avatars, ConstraintRows, IkScratch, IkState, RowKind, Touching
from avatarsim.jit.kernel import kernel
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, put_row, row, sub
from avatarsim.tolerances import least_gap, wedged_gap
from avatarsim.world.geometry import Array, Geometry, Poses
from avatarsim.world.skeleton import FREE, Skeleton

CONTACT = int(RowKind.CONTACT)

IDLE_STEPS = 3
"""Steps for which a pair keeps its row after that was last active; 0 makes contacts flicker."""


@kernel
def clear_row(avatars: Avatars, k: int, rows_out: ConstraintRows) -> None:
    """Zero the Jacobian of row k over the degrees of its owners."""
    for side in range(2):
        avatar = rows_out.owner[k, side]
        if avatar >= 0:
            for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
                rows_out.jacobian[k, j] = 0.0


@kernel
def add_lever(
    skel: Skeleton, body: int, sign: float, n: Vec3, point: Vec3, poses: Poses, axes: Rows, k: int, jacobian_out: Rows
) -> None:
    """Add to row k how a point of a link moves along n, times sign."""
    link = body - skel.first
    while link >= 0:
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            for i in range(3):
                jacobian_out[k, d + i] += sign * n[i]
            d += 3
        # n . (axis x arm) = axis . (arm x n): one cross product for all axes of the joint
        moment = cross(sub(point, row(poses.position, skel.first + link)), n)
        for j in range(d, last):
            jacobian_out[k, j] += sign * dot(row(axes, j), moment)
        link = skel.parent[link]


@kernel
def owner_of(geo: Geometry, skel: Skeleton, avatars: Avatars, piece: int, scratch: IkScratch) -> int:
    """The avatar of a piece; -1 for a body that is no link, and for an avatar that stands still meanwhile."""
    link = geo.body[piece] - skel.first
    if link < 0 or scratch.is_active[avatars.avatar[link]] == 0:
        return -1
    return int(avatars.avatar[link])


@kernel
def is_solved_for(geo: Geometry, skel: Skeleton, avatars: Avatars, a: int, b: int, scratch: IkScratch) -> bool:
    """Whether one of two pieces is of an avatar of the island that is solved for."""
    return owner_of(geo, skel, avatars, a, scratch) >= 0 or owner_of(geo, skel, avatars, b, scratch) >= 0


@kernel
def add_contact(
    geo: Geometry, skel: Skeleton, avatars: Avatars, a: int, b: int, n: Vec3, on_a: Vec3, on_b: Vec3, missing: float,
    poses: Poses,
    axes: Rows, step: Array, scratch_out: IkScratch,
) -> None:
    """Append the condition J (x' - x) >= missing [m]: from step x on, pieces a and b move apart along n by so much.

    x is zero for poses of the shown state and the trial step for those of the trial.
    """
    r = scratch_out.rows
    k = r.used[0]
    if k == r.bound.shape[0]:
        scratch_out.counts[DROPPED] += 1
        return
    one, other = owner_of(geo, skel, avatars, a, scratch_out), owner_of(geo, skel, avatars, b, scratch_out)
    r.owner[k, 0], r.owner[k, 1] = one, -1 if other == one else other
    clear_row(avatars, k, r)
    if one >= 0:
        add_lever(skel, geo.body[a], 1.0, n, on_a, poses, axes, k, r.jacobian)
    if other >= 0:
        add_lever(skel, geo.body[b], -1.0, n, on_b, poses, axes, k, r.jacobian)
    arm, opposite = sub(on_a, row(poses.position, geo.body[a])), sub(on_b, row(poses.position, geo.body[b]))
    put_row(r.normal, k, n)
    for i in range(3):
        r.arm[k, i], r.arm[k, 3 + i] = arm[i], opposite[i]
    r.kind[k], r.pair[k, 0], r.pair[k, 1], r.multiplier[k] = CONTACT, a, b, 0.0
    r.bound[k] = missing + along_row(avatars, k, step, r.jacobian, r)
    scratch_out.counts[ROWS] += 1
    r.used[0] = k + 1


@kernel
def along_row(avatars: Avatars, k: int, vector: Array, values: Rows, rows: ConstraintRows) -> float:
    """values[k] . vector over the degrees of the row's owners."""
    total = 0.0
    for side in range(2):
        avatar = rows.owner[k, side]
        if avatar >= 0:
            for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
                total += values[k, j] * vector[j]
    return total


@kernel
def add_witness_row(
    geo: Geometry, skel: Skeleton, avatars: Avatars, a: int, b: int, n: Vec3, missing: float, simplex: int, poses: Poses,
    axes: Rows, step: Array, scratch_out: IkScratch,
) -> None:
    """Row at the closest points that the last query left in the scratch."""
    on_a, on_b = closest_points(simplex, scratch_out.narrow)
    on_a, on_b = along(on_a, -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
    add_contact(geo, skel, avatars, a, b, n, on_a, on_b, missing, poses, axes, step, scratch_out)


@kernel
def add_support_row(
    geo: Geometry, skel: Skeleton, avatars: Avatars, a: int, b: int, n: Vec3, wanted: float, scratch_out: IkScratch
) -> None:
    """Row at the trial along a direction that separated at the shown state: push back to the side it came from.

    No penetration depth is needed, and its normal would point through thin things.
    """
    trial = scratch_out.trial
    on_a, _ = support(trial.vertices, geo.shapes, a, neg(n))
    on_b, _ = support(trial.vertices, geo.shapes, b, n)
    on_a, on_b = along(on_a, -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
    missing = wanted - dot(sub(on_a, on_b), n)
    add_contact(geo, skel, avatars, a, b, n, on_a, on_b, missing, trial, scratch_out.axes, scratch_out.step, scratch_out)


@kernel
def add_failed_pair(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, a: int, b: int, gap: float, n: Vec3, simplex: int,
    is_soft: bool, state: IkState, scratch_out: IkScratch,
) -> None:
    """Row for a pair that `certify_pair` has just refused, with what it returned."""
    wanted = settings.stand_off
    if is_soft:
        wanted = min(wanted, max(state.pairs.gap[slot_of(state.pairs, a, b)], wedged_gap(settings.stand_off)))
    if gap > -inf:
        trial, axes, step = scratch_out.trial, scratch_out.axes, scratch_out.step
        add_witness_row(geo, skel, avatars, a, b, n, wanted - gap, simplex, trial, axes, step, scratch_out)
    elif dot(n, n) > 0.5:
        add_support_row(geo, skel, avatars, a, b, n, wanted, scratch_out)


@kernel
def add_touching(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, is_soft: bool, poses: Poses,
    state_out: IkState, scratch_out: IkScratch,
) -> None:
    """Begin the rows of an island anew, with those at the shown state of every pair that was in contact lately.

    A pair is never asked to recover more than it must: what is nearer than `stand_off` may stay there, so that standing still
    obeys every row; only what is near to being refused is asked to part, and softly not even that."""
    touching, scratch_out.rows.used[0], scratch_out.rows.ready[0] = state_out.touching, 0, 0
    for k in range(touching.used[0]):
        a, b = touching.pair[k, 0], touching.pair[k, 1]
        if not is_solved_for(geo, skel, avatars, a, b, scratch_out):
            continue
        at = slot_of(state_out.pairs, a, b)
        gap, n, simplex = nearest_direction(geo, poses, axis_at(state_out.pairs, at), a, b, EXACT, scratch_out)
        keep_nearest(at, gap, n, state_out)
        if 0.0 < gap < EXACT:
            wanted = min(settings.stand_off, gap)
            if not is_soft and gap <= 2.0 * least_gap(settings.stand_off):
                wanted = settings.stand_off
            add_witness_row(
                geo, skel, avatars, a, b, n, wanted - gap, simplex, poses, state_out.axes, scratch_out.still, scratch_out
            )


@kernel
def touch(a: int, b: int, touching_out: Touching) -> None:
    """Note that a pair is in contact now."""
    t = touching_out
    for k in range(t.used[0]):
        if t.pair[k, 0] == a and t.pair[k, 1] == b:
            t.age[k] = 0
            return
    k = t.used[0]
    if k < t.age.shape[0]:
        t.pair[k, 0], t.pair[k, 1], t.age[k], t.used[0] = a, b, 0, k + 1


@kernel
def keep_touching(geo: Geometry, skel: Skeleton, avatars: Avatars, state_out: IkState, scratch: IkScratch) -> None:
    """After a step of an island: pairs whose rows were active are in contact; those that were not for IDLE_STEPS are
    forgotten."""
    t, rows = state_out.touching, scratch.rows
    for k in range(rows.used[0]):
        if rows.kind[k] == CONTACT and rows.multiplier[k] > 0.0:
            touch(rows.pair[k, 0], rows.pair[k, 1], t)
    kept = 0
    for k in range(t.used[0]):
        if is_solved_for(geo, skel, avatars, t.pair[k, 0], t.pair[k, 1], scratch):
            t.age[k] += 1
        if t.age[k] <= IDLE_STEPS:
            t.pair[kept, 0], t.pair[kept, 1], t.age[kept] = t.pair[k, 0], t.pair[k, 1], t.age[k]
            kept += 1
    t.used[0] = kept
