"""Contact Jacobian: how the gap of a pair changes with every degree of freedom, as one row of the step's conditions."""

from avatarsim.collide.gjk import closest_points
from avatarsim.collide.support import support
from avatarsim.kernel import kernel
from avatarsim.posture.certificate import axis_of, nearest_direction, remember_nearest
from avatarsim.posture.workspace import COUNT, DROPPED, LISTED, ROWS, SOFT, Memory
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import Rows as Points
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, neg, put_row, row, sub
from avatarsim.world.geometry import Array as Step
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import FREE, Skeleton


@kernel
def add_lever(
    skel: Skeleton, body: int, sign: float, n: Vec3, point: Vec3, poses: Poses, axes: Points, jacobian_out: Points, k: int
) -> None:
    """Add to row k how a point of a link moves along n, times sign; nothing for a body that is not a link."""
    link = body - skel.first
    while link >= 0:
        d = skel.first_dof[link]
        last = skel.first_dof[link + 1]
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
def add_row(
    geo: Geometry, skel: Skeleton, a: int, b: int, n: Vec3, on_a: Vec3, on_b: Vec3, missing: float, poses: Poses, axes: Points,
    x: Step, memory_out: Memory,
) -> None:
    """Append the condition J (x' - x) >= missing [m]: from step x on, pieces a and b move apart along n by so much.

    x is zero for poses of the checked state and the trial step for those of the trial.
    """
    r = memory_out.rows
    count = r.size[COUNT]
    if count == r.bound.shape[0]:
        memory_out.counts[DROPPED] += 1
        return
    nd = r.x.shape[0]
    for j in range(nd):
        r.jacobian[count, j] = 0.0
    add_lever(skel, geo.body[a], 1.0, n, on_a, poses, axes, r.jacobian, count)
    add_lever(skel, geo.body[b], -1.0, n, on_b, poses, axes, r.jacobian, count)
    arm, other = sub(on_a, row(poses.position, geo.body[a])), sub(on_b, row(poses.position, geo.body[b]))
    put_row(r.normal, count, n)
    for i in range(3):
        r.arms[count, i], r.arms[count, 3 + i] = arm[i], other[i]
    bound = missing
    for j in range(nd):
        bound += r.jacobian[count, j] * x[j]
    r.bound[count] = bound
    r.multiplier[count] = 0.0
    r.pair[count, 0] = a
    r.pair[count, 1] = b
    memory_out.counts[ROWS] += 1
    r.size[COUNT] = count + 1


@kernel
def witness_row(
    geo: Geometry, skel: Skeleton, a: int, b: int, n: Vec3, gap: float, wanted: float, simplex: int, poses: Poses, axes: Points,
    x: Step, memory_out: Memory,
) -> None:
    """Row at the closest points that the last query left in the scratch."""
    on_a, on_b = closest_points(simplex, memory_out.scratch)
    on_a, on_b = along(on_a, -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
    add_row(geo, skel, a, b, n, on_a, on_b, wanted - gap, poses, axes, x, memory_out)


@kernel
def support_row(geo: Geometry, skel: Skeleton, a: int, b: int, n: Vec3, wanted: float, memory_out: Memory) -> None:
    """Row at the trial along a direction that separated at the checked state: push back to the side it came from.

    No penetration depth is needed, and its normal would point through thin things.
    """
    trial = memory_out.trial
    on_a, _ = support(trial.vertices, geo.shapes, a, neg(n))
    on_b, _ = support(trial.vertices, geo.shapes, b, n)
    on_a, on_b = along(on_a, -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
    missing = wanted - dot(sub(on_a, on_b), n)
    add_row(geo, skel, a, b, n, on_a, on_b, missing, trial, memory_out.trial_axes, memory_out.rows.x, memory_out)


@kernel
def rows_of_listed(geo: Geometry, skel: Skeleton, poses: Poses, settings: PostureSettings, memory_out: Memory) -> None:
    """Begin the rows anew, with those at the checked state of every pair that was in touch lately.

    A pair is never asked to recover more than it must: what is nearer than `stand_off` may stay there, so that
    standing still obeys every row.
    """
    pairs, soft = memory_out.pairs, memory_out.flags[SOFT] > 0.0
    first = geo.first_shape[skel.first]
    memory_out.rows.size[:] = 0
    for k in range(pairs.marks[LISTED]):
        a, b = pairs.listed[k, 0], pairs.listed[k, 1]
        i = a - first
        gap, n, simplex = nearest_direction(geo, poses, axis_of(memory_out, i, b), a, b, 0.02, memory_out)
        remember_nearest(memory_out, i, b, gap, n)
        if gap > 0.0 and gap < 0.02:
            wanted = min(settings.stand_off, gap)
            if not soft and gap <= 2.0 * settings.least_gap:
                wanted = settings.stand_off
            witness_row(geo, skel, a, b, n, gap, wanted, simplex, poses, memory_out.axes, memory_out.rows.here, memory_out)


@kernel
def list_pair(a: int, b: int, first: int, memory_out: Memory) -> None:
    """Put a pair on the list of those in touch, or make it young again."""
    pairs = memory_out.pairs
    if pairs.active[a - first, b]:
        for k in range(pairs.marks[LISTED]):
            if pairs.listed[k, 0] == a and pairs.listed[k, 1] == b:
                pairs.age[k] = 0
        return
    k = pairs.marks[LISTED]
    if k < pairs.listed.shape[0]:
        pairs.active[a - first, b] = True
        pairs.listed[k, 0] = a
        pairs.listed[k, 1] = b
        pairs.age[k] = 0
        pairs.marks[LISTED] = k + 1


@kernel
def forget_idle_pairs(first: int, oldest: int, memory_out: Memory) -> None:
    """Age the list by one step and drop the pairs that no row needed for more than `oldest` steps."""
    pairs, kept = memory_out.pairs, 0
    for k in range(pairs.marks[LISTED]):
        pairs.age[k] += 1
        a, b = pairs.listed[k, 0], pairs.listed[k, 1]
        if pairs.age[k] <= oldest:
            pairs.listed[kept, 0] = a
            pairs.listed[kept, 1] = b
            pairs.age[kept] = pairs.age[k]
            kept += 1
        else:
            pairs.active[a - first, b] = False
    pairs.marks[LISTED] = kept


@kernel
def list_rows(first: int, memory_out: Memory) -> None:
    """List the pairs whose rows were active: they get a row in the next step before anything fails."""
    r = memory_out.rows
    for k in range(r.size[COUNT]):
        if r.multiplier[k] > 0.0 and r.pair[k, 0] >= 0:
            list_pair(r.pair[k, 0], r.pair[k, 1], first, memory_out)
