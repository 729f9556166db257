"""Limits of ball joints as rows of a step: swing, twist and reach cone of a joint that the trial takes beyond them.

Hinges need none, their limits are bounds of the step. The geometry of the limits is in `world.limits`.
"""

from math import atan2

from avatarsim.ik.state import DROPPED, ROWS, Avatars, IkScratch, RowKind
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import columns, stepped, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, scale
from avatarsim.tolerances import ROUNDING
from avatarsim.world.limits import SURELY, cone_excess, has_cone, limb_of, surely_inside, swing_and_twist
from avatarsim.world.reach_cone import has_reach, nearest_in_reach
from avatarsim.world.skeleton import BALL, Posture, Skeleton

LIMIT = int(RowKind.LIMIT)

INSIDE = 1e-4
"""[rad] rows aim this far inside a limit, so that the curvature of the cone does not leave the next trial outside again."""


@kernel
def check_limits(
    skel: Skeleton, avatars: Avatars, avatar: int, posture: Posture, is_adding: bool, scratch_out: IkScratch
) -> int:
    """Number of balls of an avatar that the step takes beyond their limits; a row for each limit broken if rows are being
    added."""
    beyond = 0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        if skel.kind[link] == BALL and has_cone(skel, link):
            d, x = skel.first_dof[link], scratch_out.step
            turn = stepped(columns(posture.turn, link), (x[d], x[d + 1], x[d + 2]))
            if surely_inside(skel, link, turn, SURELY) or cone_excess(skel, link, turn) <= 0.0:
                continue
            beyond += 1
            if is_adding:
                add_limit_rows(skel, avatar, link, turn, scratch_out)
    return beyond


@kernel
def add_limit_rows(
    skel: Skeleton, avatar: int, link: int, turn: tuple[Vec3, Vec3, Vec3], scratch_out: IkScratch
) -> None:
    """Rows that turn the ball of a link, at rotation `turn` at the trial, back inside what it breaks."""
    d = skel.first_dof[link]
    swing, twist, back = swing_and_twist(skel, link, turn)
    most = atan2(skel.cone[link, 7], skel.cone[link, 6])
    beyond = swing - most
    if has_reach(skel, link):
        beyond, back = way_back(skel, link, limb_of(skel, link, turn), most)
    if beyond > 0.0:
        add_turn_row(avatar, d, turned_back(turn, back), beyond + INSIDE, scratch_out)
    low, high = skel.cone[link, 8], skel.cone[link, 9]
    if twist < low or twist > high:
        # rate of twist of a swung limb: the turn's part along the middle of limb and centre
        centre = (skel.cone[link, 3], skel.cone[link, 4], skel.cone[link, 5])
        limb = turned(turn, (skel.cone[link, 0], skel.cone[link, 1], skel.cone[link, 2]))
        rate = turned_back(turn, scale(add(centre, limb), 1.0 / max(1e-3, 1.0 + dot(centre, limb))))
        if twist < low:
            add_turn_row(avatar, d, rate, low - twist + INSIDE, scratch_out)
        else:
            add_turn_row(avatar, d, scale(rate, -1.0), twist - high + INSIDE, scratch_out)


@kernel
def way_back(skel: Skeleton, link: int, limb: Vec3, most: float) -> tuple[float, Vec3]:
    """Angle [rad] and unit axis (parent's axes) of the shortest turn that brings a limb into its polygon and swing cone."""
    allowed = nearest_in_reach(skel, link, limb, most)
    axis = cross(limb, allowed)
    sine = norm(axis)
    if sine < ROUNDING:
        return 0.0, limb
    return atan2(sine, dot(limb, allowed)), scale(axis, 1.0 / sine)


@kernel
def add_turn_row(avatar: int, d: int, direction: Vec3, missing: float, scratch_out: IkScratch) -> None:
    """Append: the ball at degrees d .. d + 3 turns along `direction` (its axes at the trial) by at least `missing` from there."""
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
    scratch_out.counts[ROWS] += 1
    r.used[0] = k + 1
