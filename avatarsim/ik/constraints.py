"""Constraint rows of a step: how the gap of a pair changes with every degree of freedom (contact Jacobian), as J x >= bound.

Limits of ball joints as rows of a step: swing, twist and reach cone of a joint that the trial takes beyond them.

Hinges and slides need none, their limits are bounds of the step. The geometry of the limits is in `model.joint_limits`.
"""

from math import atan2, inf

from avatarsim.collision.gjk import closest_points
from avatarsim.collision.support import support
from avatarsim.ik.certificate import EXACT, keep_nearest, nearest_direction
from avatarsim.ik.couplings import fold_row
from avatarsim.ik.gaps import least_gap, stand_off_of, wedged_gap
from avatarsim.ik.state import (
    DROPPED,
    MOST_PRESSED,
    ROWS,
    Avatars,
    ConstraintRows,
    IkScratch,
    IkState,
    Rig,
    RowKind,
    Touching,
    axis_at,
    slot_of,
)
from avatarsim.jit.kernel import kernel
from avatarsim.model.ball_limits import BallLimits
from avatarsim.model.geometry import Array, Poses, allowed_depth
from avatarsim.model.joint_limits import (
    FLAT,
    SURELY,
    cone_excess,
    has_cone,
    has_reach,
    limb_of,
    most_swing,
    nearest_in_reach,
    surely_inside,
    swing_and_twist,
)
from avatarsim.model.skeleton import BALL, FREE, SLIDE, Posture, Skeleton
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, stepped, turned_back
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, neg, norm, put_row, row, scale, sub
from avatarsim.tolerances import ROUNDING

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
def add_point_jacobian(
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
        elif skel.kind[link] == SLIDE:
            jacobian_out[k, d] += sign * dot(row(axes, d), n)
            link = skel.parent[link]
            continue
        # n . (axis x arm) = axis . (arm x n): one cross product for all axes of the joint
        moment = cross(sub(point, row(poses.position, skel.first + link)), n)
        for j in range(d, last):
            jacobian_out[k, j] += sign * dot(row(axes, j), moment)
        link = skel.parent[link]


@kernel
def owner_of(rig: Rig, piece: int, scratch: IkScratch) -> int:
    """Return the avatar of a piece; -1 for a body that is no link, and for an avatar that is not moved meanwhile."""
    avatars = rig.avatars
    link = rig.geo.body[piece] - rig.skel.first
    if link < 0 or scratch.is_active[avatars.avatar[link]] == 0:
        return -1
    return int(avatars.avatar[link])


@kernel
def is_solved_for(rig: Rig, a: int, b: int, scratch: IkScratch) -> bool:
    """Return True if one of two pieces is of an avatar of the island that is solved for."""
    return owner_of(rig, a, scratch) >= 0 or owner_of(rig, b, scratch) >= 0


@kernel
def add_contact(
    rig: Rig, a: int, b: int, n: Vec3, on_a: Vec3, on_b: Vec3, missing: float, poses: Poses, axes: Rows, step: Array,
    scratch_out: IkScratch,
) -> None:
    """Append the condition J (x' - x) >= missing [m]: from step x on, pieces a and b move apart along n by so much.

    x is zero for poses of the shown state and the trial step for those of the trial.
    """
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    r = scratch_out.rows
    k = r.used[0]
    if k == r.bound.shape[0]:
        scratch_out.counts[DROPPED] += 1
        return
    one, other = owner_of(rig, a, scratch_out), owner_of(rig, b, scratch_out)
    r.owner[k, 0], r.owner[k, 1] = one, -1 if other == one else other
    clear_row(avatars, k, r)
    if one >= 0:
        add_point_jacobian(skel, geo.body[a], 1.0, n, on_a, poses, axes, k, r.jacobian)
    if other >= 0:
        add_point_jacobian(skel, geo.body[b], -1.0, n, on_b, poses, axes, k, r.jacobian)
    fold_row(rig, k, r)
    arm, opposite = sub(on_a, row(poses.position, geo.body[a])), sub(on_b, row(poses.position, geo.body[b]))
    put_row(r.normal, k, n)
    for i in range(3):
        r.arm[k, i], r.arm[k, 3 + i] = arm[i], opposite[i]
    r.kind[k], r.pair[k, 0], r.pair[k, 1], r.multiplier[k] = CONTACT, a, b, 0.0
    r.least[k], r.most[k] = 0.0, MOST_PRESSED
    r.bound[k] = missing + along_row(avatars, k, step, r.jacobian, r)
    scratch_out.counts[ROWS] += 1
    r.used[0] = k + 1


@kernel
def along_row(avatars: Avatars, k: int, vector: Array, values: Rows, rows: ConstraintRows) -> float:
    """Return values[k] . vector over the degrees of the row's owners."""
    total = 0.0
    for side in range(2):
        avatar = rows.owner[k, side]
        if avatar >= 0:
            for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
                total += values[k, j] * vector[j]
    return total


@kernel
def add_witness_row(
    rig: Rig, a: int, b: int, n: Vec3, missing: float, simplex: int, poses: Poses, axes: Rows, step: Array, scratch_out: IkScratch
) -> None:
    """Add a row at the closest points that the last query left in the scratch, or at the supports along n where it left none."""
    geo = rig.geo
    if simplex > 0:
        on_a, on_b = closest_points(simplex, scratch_out.narrow)
    else:
        on_a, _ = support(poses.vertices, geo.shapes, a, neg(n))
        on_b, _ = support(poses.vertices, geo.shapes, b, n)
    on_a, on_b = along(on_a, -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
    add_contact(rig, a, b, n, on_a, on_b, missing, poses, axes, step, scratch_out)


@kernel
def add_support_row(rig: Rig, a: int, b: int, n: Vec3, wanted: float, scratch_out: IkScratch) -> None:
    """Add a row at the trial along a direction that separated at the shown state: push back to the side it came from.

    No penetration depth is needed, and its normal would point through thin things.
    """
    geo = rig.geo
    trial = scratch_out.trial
    on_a, _ = support(trial.vertices, geo.shapes, a, neg(n))
    on_b, _ = support(trial.vertices, geo.shapes, b, n)
    on_a, on_b = along(on_a, -geo.shapes.radius[a], n), along(on_b, geo.shapes.radius[b], n)
    missing = wanted - dot(sub(on_a, on_b), n) - allowed_depth(geo, a, b)
    add_contact(rig, a, b, n, on_a, on_b, missing, trial, scratch_out.axes, scratch_out.step, scratch_out)


@kernel
def add_failed_pair(
    rig: Rig, settings: PostureSettings, a: int, b: int, gap: float, n: Vec3, simplex: int, is_soft: bool, state: IkState,
    scratch_out: IkScratch,
) -> None:
    """Add a row for a pair that `certify_pair` has just refused, with its results."""
    wanted = stand_off_of(rig.geo, settings.stand_off, a, b)
    if is_soft:
        wanted = min(wanted, max(state.pairs.gap[slot_of(state.pairs, a, b)], wedged_gap(wanted)))
    if gap > -inf:
        trial, axes, step = scratch_out.trial, scratch_out.axes, scratch_out.step
        add_witness_row(rig, a, b, n, wanted - gap, simplex, trial, axes, step, scratch_out)
    elif dot(n, n) > 0.5:
        add_support_row(rig, a, b, n, wanted, scratch_out)


@kernel
def add_touching(
    rig: Rig, settings: PostureSettings, is_soft: bool, poses: Poses, state_out: IkState, scratch_out: IkScratch
) -> None:
    """Begin the rows of an island anew, with those at the shown state of every pair that was in contact lately.

    No row requires more than it must: a pair nearer than `stand_off` may stay there, so that standing still obeys every row; only
    a pair that is nearly refused has to part, and if soft not even that."""
    geo = rig.geo
    touching, scratch_out.rows.used[0], scratch_out.rows.ready[0] = state_out.touching, 0, 0
    for k in range(touching.used[0]):
        a, b = touching.pair[k, 0], touching.pair[k, 1]
        if not is_solved_for(rig, a, b, scratch_out):
            continue
        at = slot_of(state_out.pairs, a, b)
        gap, n, simplex = nearest_direction(geo, poses, axis_at(state_out.pairs, at), a, b, EXACT, scratch_out)
        keep_nearest(at, gap, n, state_out)
        if 0.0 < gap < EXACT:
            stand_off = stand_off_of(geo, settings.stand_off, a, b)
            wanted = min(stand_off, gap)
            if not is_soft and gap <= 2.0 * least_gap(stand_off):
                wanted = stand_off
            add_witness_row(rig, a, b, n, wanted - gap, simplex, poses, state_out.axes, scratch_out.still, scratch_out)


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
def keep_touching(rig: Rig, state_out: IkState, scratch: IkScratch) -> None:
    """Update the pairs in contact after an island's step: pairs with active rows are kept; those idle for IDLE_STEPS dropped."""
    t, rows = state_out.touching, scratch.rows
    for k in range(rows.used[0]):
        if rows.kind[k] == CONTACT and rows.multiplier[k] > 0.0:
            touch(rows.pair[k, 0], rows.pair[k, 1], t)
    kept = 0
    for k in range(t.used[0]):
        if is_solved_for(rig, t.pair[k, 0], t.pair[k, 1], scratch):
            t.age[k] += 1
        if t.age[k] <= IDLE_STEPS:
            t.pair[kept, 0], t.pair[kept, 1], t.age[kept] = t.pair[k, 0], t.pair[k, 1], t.age[k]
            kept += 1
    t.used[0] = kept


LIMIT = int(RowKind.LIMIT)

INSIDE = 1e-4
"""[rad] rows aim this far inside a limit, so that the curvature of the cone does not leave the next trial outside again."""


@kernel
def check_limits(rig: Rig, avatar: int, posture: Posture, is_adding: bool, scratch_out: IkScratch) -> int:
    """Count the balls of an avatar that the step takes beyond their limits; add a row per limit broken if rows are added."""
    skel, avatars = rig.skel, rig.avatars
    beyond = 0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        if skel.kind[link] == BALL and has_cone(skel.balls, link):
            d, x = skel.first_dof[link], scratch_out.step
            turn = stepped(columns(posture.turn, link), (x[d], x[d + 1], x[d + 2]))
            if surely_inside(skel.balls, link, turn, SURELY) or cone_excess(skel.balls, link, turn) <= 0.0:
                continue
            beyond += 1
            if is_adding:
                add_limit_rows(skel, avatar, link, turn, scratch_out)
    return beyond


@kernel
def add_limit_rows(skel: Skeleton, avatar: int, link: int, turn: tuple[Vec3, Vec3, Vec3], scratch_out: IkScratch) -> None:
    """Add rows that turn the ball of a link, at rotation `turn` at the trial, back inside the limits that it breaks."""
    d = skel.first_dof[link]
    swing, twist, back = swing_and_twist(skel.balls, link, turn)
    most = most_swing(skel.balls, link)
    beyond = swing - most
    if has_reach(skel.balls, link):
        beyond, back = shortest_return(skel.balls, link, limb_of(skel.balls, link, turn), most)
    if beyond > 0.0:
        add_turn_row(avatar, d, turned_back(turn, back), beyond + INSIDE, scratch_out)
    low, high = skel.balls.twist[link, 0], skel.balls.twist[link, 1]
    if twist < low or twist > high:
        # rate of twist of a swung limb: the turn's part along the middle of limb and centre
        centre, limb = row(skel.balls.centre, link), limb_of(skel.balls, link, turn)
        rate = turned_back(turn, scale(add(centre, limb), 1.0 / max(FLAT, 1.0 + dot(centre, limb))))
        if twist < low:
            add_turn_row(avatar, d, rate, low - twist + INSIDE, scratch_out)
        else:
            add_turn_row(avatar, d, scale(rate, -1.0), twist - high + INSIDE, scratch_out)


@kernel
def shortest_return(balls: BallLimits, link: int, limb: Vec3, most: float) -> tuple[float, Vec3]:
    """Return the angle [rad] and unit axis (parent's axes) of the shortest turn of a limb into its polygon and swing cone."""
    allowed = nearest_in_reach(balls, link, limb, most)
    axis = cross(limb, allowed)
    sine = norm(axis)
    if sine < ROUNDING:
        return 0.0, limb
    return atan2(sine, dot(limb, allowed)), scale(axis, 1.0 / sine)


@kernel
def add_turn_row(avatar: int, d: int, direction: Vec3, missing: float, scratch_out: IkScratch) -> None:
    """Append the condition that the ball at degree d turn along `direction` (its axes at the trial) by at least `missing`."""
    r, step = scratch_out.rows, scratch_out.step
    k = r.used[0]
    if k == r.bound.shape[0]:
        scratch_out.counts[DROPPED] += 1
        return
    r.owner[k, 0], r.owner[k, 1] = avatar, -1
    # more of the step is not a turn about these axes: the derivative of the exponential map, to second order
    x = (step[d], step[d + 1], step[d + 2])
    once = cross(x, direction)
    direction = along(along(direction, 0.5, once), 1.0 / 6.0, cross(x, once))
    r.jacobian[k, :] = 0.0
    bound = missing
    for i in range(3):
        r.jacobian[k, d + i] = direction[i]
        bound += direction[i] * step[d + i]
    r.kind[k], r.pair[k, 0], r.pair[k, 1], r.bound[k], r.multiplier[k] = LIMIT, d, -1, bound, 0.0
    r.least[k], r.most[k] = 0.0, MOST_PRESSED
    scratch_out.counts[ROWS] += 1
    r.used[0] = k + 1
