"""Limits of ball joints as conditions of the step; hinges need none, their limits are bounds."""

from math import atan2

from avatarsim.kernel import kernel
from avatarsim.posture.limits import SURELY, cone_excess, has_cone, limb_of, surely_inside, swing_and_twist
from avatarsim.posture.reach_cone import ROUNDING, has_reach, nearest_in_reach
from avatarsim.posture.workspace import ADDING, COUNT, DROPPED, ROWS, Memory
from avatarsim.spatial.tangent import columns, stepped, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, scale
from avatarsim.world.skeleton import BALL, Posture, Skeleton

INSIDE = 1e-4
"""[rad] rows aim this far inside a limit, so that the curvature of the cone does not leave the next trial outside again."""


@kernel
def beyond_limits(skel: Skeleton, posture: Posture, memory_out: Memory) -> int:
    """Number of balls whose trial rotation is beyond its limits; rows for them if rows are being added.

    The links are marked in memory.touched.
    """
    failed = 0
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == BALL and has_cone(skel, link) and is_beyond(skel, posture, link, memory_out):
            failed += 1
            memory_out.touched[link] = True
    return failed


@kernel
def is_beyond(skel: Skeleton, posture: Posture, link: int, memory_out: Memory) -> bool:
    """Whether the step in rows.x takes a ball with limits beyond these; a row for each that it breaks if rows are being added."""
    d, x = skel.first_dof[link], memory_out.rows.x
    turn = stepped(columns(posture.turn, link), (x[d], x[d + 1], x[d + 2]))
    if surely_inside(skel, link, turn, SURELY) or cone_excess(skel, link, turn) <= 0.0:
        return False
    if memory_out.flags[ADDING] > 0.0:
        swing, twist, back = swing_and_twist(skel, link, turn)
        most = atan2(skel.cone[link, 7], skel.cone[link, 6])
        beyond = swing - most
        if has_reach(skel, link):
            beyond, back = way_back(skel, link, limb_of(skel, link, turn), most)
        if beyond > 0.0:
            turn_row(d, turned_back(turn, back), beyond + INSIDE, memory_out)
        low, high = skel.cone[link, 8], skel.cone[link, 9]
        if twist < low or twist > high:
            # rate of twist of a swung limb: the turn's part along the middle of limb and centre
            centre = (skel.cone[link, 3], skel.cone[link, 4], skel.cone[link, 5])
            limb = turned(turn, (skel.cone[link, 0], skel.cone[link, 1], skel.cone[link, 2]))
            rate = turned_back(turn, scale(add(centre, limb), 1.0 / max(1e-3, 1.0 + dot(centre, limb))))
            if twist < low:
                turn_row(d, rate, low - twist + INSIDE, memory_out)
            else:
                turn_row(d, scale(rate, -1.0), twist - high + INSIDE, memory_out)
    return True


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
def turn_row(d: int, direction: Vec3, missing: float, memory_out: Memory) -> None:
    """Append: the ball at degrees d .. d + 3 turns along `direction` (its axes at the trial) by at least `missing` from there."""
    r = memory_out.rows
    count = r.size[COUNT]
    if count == r.bound.shape[0]:
        memory_out.counts[DROPPED] += 1
        return
    for j in range(r.x.shape[0]):
        r.jacobian[count, j] = 0.0
    # more of the step is not a turn about these axes: the derivative of the exponential map, to second order
    x = (r.x[d], r.x[d + 1], r.x[d + 2])
    once = cross(x, direction)
    direction = along(along(direction, 0.5, once), 1.0 / 6.0, cross(x, once))
    bound = missing
    for k in range(3):
        r.jacobian[count, d + k] = direction[k]
        bound += direction[k] * r.x[d + k]
    r.bound[count] = bound
    r.multiplier[count] = 0.0
    r.pair[count, 0] = -3
    r.pair[count, 1] = d
    memory_out.counts[ROWS] += 1
    r.size[COUNT] = count + 1
