"""Joint limits: intervals of hinges, swing cone and twist interval of ball joints; excess beyond them, projection into them.

With T the shortest rotation of `axis` onto `centre` and R the rotation of a ball joint, R T^-1 is decomposed into swing and twist
about `centre`: the swing is the angle between R axis and centre, the twist the remaining rotation about centre.

Reach cones (Wilhelms and Van Gelder 2001): the allowed directions of a limb as a spherical polygon; tests and projection.

The polygon may be concave and wider than a hemisphere: it is the union of the spherical triangles between its edges and a point
that sees every edge. A circular swing cone applies as well; the projection is into both.
"""

from math import atan2, cos, inf, sin, sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.model.ball_limits import BallLimits
from avatarsim.spatial.tangent import Columns, about, columns, product, turned
from avatarsim.spatial.vec3 import Vec3, add, cross, dot, norm, perpendicular, row, scale, sub, unit
from avatarsim.tolerances import FINE, NOTHING, PROOF, ROUNDING


@kernel
def has_reach(balls: BallLimits, link: int) -> bool:
    """Return True if the limb of a link has a spherical polygon."""
    return bool(balls.first_corner[link + 1] > balls.first_corner[link])


@kernel
def edge(balls: BallLimits, link: int, k: int) -> tuple[Vec3, Vec3, Vec3]:
    """Return the corner k of a link's polygon, the next one, and the unit normal of the edge's plane, which points inside."""
    first, last = balls.first_corner[link], balls.first_corner[link + 1]
    start = row(balls.corner, first + k)
    end = row(balls.corner, first + k + 1 if first + k + 1 < last else first)
    normal = cross(start, end)
    return start, end, scale(normal, 1.0 / norm(normal))


@kernel
def is_in_reach(balls: BallLimits, link: int, limb: Vec3) -> bool:
    """Return True if a unit direction is in one of the triangles of the seeing point and an edge."""
    first, last = balls.first_corner[link], balls.first_corner[link + 1]
    side = dot(row(balls.side, first), limb)
    for k in range(first, last):
        following = k + 1 if k + 1 < last else first
        # the side where one triangle ends is where the next one begins
        next_side = dot(row(balls.side, following), limb)
        # a direction so little outside an edge counts as on it: projected ones are, by rounding
        if side >= -ROUNDING and next_side <= ROUNDING:
            normal = cross(row(balls.corner, k), row(balls.corner, following))
            if dot(scale(normal, 1.0 / norm(normal)), limb) >= -ROUNDING:
                return True
        side = next_side
    return False


@kernel
def angle_between(a: Vec3, b: Vec3) -> float:
    """Return the angle [rad] of two unit vectors."""
    return atan2(norm(cross(a, b)), dot(a, b))


@kernel
def squared_chord(a: Vec3, b: Vec3) -> float:
    """Return the squared distance of two unit vectors: it grows as their angle does and costs no arc tangent."""
    apart = sub(a, b)
    return dot(apart, apart)


@kernel
def nearest_on_edge(start: Vec3, end: Vec3, inward: Vec3, limb: Vec3) -> Vec3:
    """Return the point of the great arc from start to end that is nearest to a unit direction."""
    foot = sub(limb, scale(inward, dot(inward, limb)))
    length = norm(foot)
    if length > ROUNDING:
        foot = scale(foot, 1.0 / length)
        if dot(cross(inward, start), foot) >= 0.0 and dot(cross(end, inward), foot) >= 0.0:
            return foot
    return start if dot(start, limb) >= dot(end, limb) else end


@kernel
def reach_excess(balls: BallLimits, link: int, limb: Vec3) -> float:
    """Return the angle [rad] by which a unit direction is outside the polygon; 0 inside."""
    if is_in_reach(balls, link, limb):
        return 0.0
    nearest = 10.0
    for k in range(balls.first_corner[link + 1] - balls.first_corner[link]):
        start, end, inward = edge(balls, link, k)
        nearest = min(nearest, angle_between(nearest_on_edge(start, end, inward, limb), limb))
    return nearest


@kernel
def most_swing(balls: BallLimits, link: int) -> float:
    """Return the largest swing [rad] of a ball."""
    return atan2(balls.swing_sine[link], balls.swing_cosine[link])


@kernel
def swing_of(balls: BallLimits, link: int, limb: Vec3) -> float:
    """Return the angle [rad] of a unit direction to the centre of the circular swing cone."""
    return angle_between(row(balls.centre, link), limb)


@kernel
def nearest_in_reach(balls: BallLimits, link: int, limb: Vec3, most: float) -> Vec3:
    """Return the direction nearest to a limb's that is in the polygon and swings at most `most` [rad] from the cone's centre.

    The edge of the allowed region consists of arcs of the polygon and of the cone's circle. So the nearest point is the nearest
    of an arc of one, if the other allows it, or a point where the two cross; the point that sees all edges is always allowed.
    """
    if is_in_reach(balls, link, limb) and swing_of(balls, link, limb) <= most:
        return limb
    centre = row(balls.centre, link)
    best = row(balls.sight, link)
    least = squared_chord(best, limb)
    candidate = nearest_on_circle(centre, most, limb)
    if squared_chord(candidate, limb) < least and is_in_reach(balls, link, candidate):
        best, least = candidate, squared_chord(candidate, limb)
    for k in range(balls.first_corner[link + 1] - balls.first_corner[link]):
        if is_plane_beyond(balls, link, k, limb, least):
            continue
        start, end, inward = edge(balls, link, k)
        # where that of an edge which is nearest is too far, or allowed, the rest of the edge has nothing to add;
        # its end is the start of another
        for which in range(4):
            if which == 0:
                candidate = nearest_on_edge(start, end, inward, limb)
                if not (squared_chord(candidate, limb) < least):
                    break
            elif which == 1:
                candidate = start
            else:
                crosses, candidate = crossing(start, end, inward, centre, most, which == 2)
                if not crosses:
                    continue
            away = squared_chord(candidate, limb)
            if away < least and swing_of(balls, link, candidate) <= most + ROUNDING:
                best, least = candidate, away
                if which == 0:
                    break
    return best


@kernel
def is_plane_beyond(balls: BallLimits, link: int, k: int, limb: Vec3, square: float) -> bool:
    """Return True if a limb's direction is farther from an edge's plane than the root of `square`, without computing it."""
    first, last = balls.first_corner[link], balls.first_corner[link + 1]
    normal = cross(row(balls.corner, first + k), row(balls.corner, first + k + 1 if first + k + 1 < last else first))
    away = dot(normal, limb)
    return away * away > square * dot(normal, normal)


@kernel
def nearest_on_circle(centre: Vec3, radius: float, limb: Vec3) -> Vec3:
    """Return the direction at angle `radius` [rad] from the centre that is nearest to a limb's."""
    sideways = sub(limb, scale(centre, dot(centre, limb)))
    length = norm(sideways)
    if length < ROUNDING:
        sideways, length = perpendicular(centre), 1.0  # every one is as near
    return add(scale(centre, cos(radius)), scale(sideways, sin(radius) / length))


@kernel
def crossing(start: Vec3, end: Vec3, inward: Vec3, centre: Vec3, radius: float, first: bool) -> tuple[bool, Vec3]:
    """Return where the great arc from start to end meets the circle of angle `radius` [rad] about a centre: one of two places."""
    # on the great circle, in the plane of the arc, the angle to the centre is least towards the centre's own foot
    foot = sub(centre, scale(inward, dot(inward, centre)))
    length = norm(foot)
    if not (length > ROUNDING and abs(cos(radius)) <= length):
        return False, start
    towards = scale(foot, 1.0 / length)
    turn = acos_of(cos(radius) / length)
    along_arc = cross(inward, towards)
    place = add(scale(towards, cos(turn)), scale(along_arc, sin(turn) if first else -sin(turn)))
    within = dot(cross(inward, start), place) >= 0.0 and dot(cross(end, inward), place) >= 0.0
    return within, place


@kernel
def acos_of(cosine: float) -> float:
    """Return the angle [rad] of a cosine in [-1, 1], by the arc tangent."""
    return atan2(sqrt(max(0.0, (1.0 - cosine) * (1.0 + cosine))), cosine)


SURELY = PROOF
"""[rad] a ball so far inside its limits is inside whatever the rounding; smaller: rounding could pass one that is outside. Within
this of a half turn from an end the sine is not conclusive; then the angles are computed."""

INWARD = NOTHING
"""Target postures are put this far [rad] inside their limits, so that rounding never shows as an excess."""

LEFT_ALONE = 2.0 * INWARD
"""[rad] a target so far inside its limits stays as it is, without computing its angles."""


FLAT = 1e-3
"""Least of 1 + cosine of the swing by which a twist is divided: beyond 177 degrees a twist has no gradient."""


@kernel
def swing_and_twist(balls: BallLimits, link: int, turn: Columns) -> tuple[float, float, Vec3]:
    """Return the swing [rad], twist [rad] and the unit axis about which the limb swings back to the centre (parent's axes)."""
    axis = row(balls.axis, link)
    centre = row(balls.centre, link)
    limb = turned(turn, axis)
    back = cross(limb, centre)
    sine = norm(back)
    swing = atan2(sine, dot(limb, centre))
    if sine > ROUNDING:
        back = scale(back, 1.0 / sine)
    else:
        back = any_normal(centre)
        if swing < 1.0:
            swing = 0.0
    # swing the limb back onto the centre; the rest turns about the centre
    relative = product(turn, columns(balls.untwist, link))
    probe = any_normal(centre)
    left = about(back, swing, turned(relative, probe))
    return swing, atan2(dot(centre, cross(probe, left)), dot(probe, left)), back


@kernel
def any_normal(v: Vec3) -> Vec3:
    """Return a unit vector at right angles to the unit vector v."""
    if abs(v[0]) < 0.6:
        return unit(cross(v, (1.0, 0.0, 0.0)))
    return unit(cross(v, (0.0, 1.0, 0.0)))


@kernel
def has_cone(balls: BallLimits, link: int) -> bool:
    """Return True if the ball of a link has limits."""
    return bool(balls.is_limited[link])


@kernel
def cone_excess(balls: BallLimits, link: int, turn: Columns) -> float:
    """Return how far the rotation of a ball is beyond its limits [rad], the most of swing, twist and reach; 0 or less inside."""
    swing, twist, _ = swing_and_twist(balls, link, turn)
    most = most_swing(balls, link)
    excess = float(max(swing - most, max(balls.twist[link, 0] - twist, twist - balls.twist[link, 1])))
    return max(excess, reach_excess(balls, link, limb_of(balls, link, turn))) if has_reach(balls, link) else excess


@kernel
def surely_inside(balls: BallLimits, link: int, turn: Columns, spare: float) -> bool:
    """Return True if the rotation of a ball is inside its limits by more than `spare` [rad], at least SURELY: a test without
    angles, which nearly every ball of every trial passes. Where it fails `cone_excess` decides."""
    limb, b = limb_of(balls, link, turn), balls
    edge = b.swing_cosine[link], b.swing_sine[link]
    low, high = (b.twist_low[link, 0], b.twist_low[link, 1]), (b.twist_high[link, 0], b.twist_high[link, 1])
    swung = turned(turn, row(b.untwisted, link))
    if not surely_in_cone(limb, row(b.centre, link), edge, row(b.probe, link), swung, low, high, spare):
        return False
    return not has_reach(balls, link) or is_in_reach(balls, link, limb)


@kernel
def surely_in_cone(
    limb: Vec3, centre: Vec3, edge: tuple[float, float], probe: Vec3, swung: Vec3, low: tuple[float, float],
    high: tuple[float, float], spare: float,
) -> bool:
    """Return True if swing and twist alone are surely inside. `edge`: cosine and sine of the largest swing; the twist takes
    `probe` to `swung` with the swing undone; low, high: cosines and sines of its ends.

    Takes numbers and not the limits, since passing these takes longer than the test.
    """
    back, cosine = cross(limb, centre), dot(limb, centre)
    sine = norm(back)
    # sine of the angle between the limb and the edge of the cone
    if not (edge[1] * cosine - edge[0] * sine > spare and sine > spare):
        return False
    back = scale(back, 1.0 / sine)
    # turned back by the swing, whose sine and cosine are known
    left = add(add(scale(swung, cosine), scale(cross(back, swung), sine)), scale(back, (1.0 - cosine) * dot(back, swung)))
    x, y = dot(probe, left), dot(centre, cross(probe, left))
    # the sines of the angles to the ends; where zero is between these only the end on the twist's own side counts
    to_low, to_high = low[0] * y - low[1] * x, high[1] * x - high[0] * y
    if low[1] < 0.0 < high[1]:
        return bool((to_high if y >= 0.0 else to_low) > spare)
    return bool(min(to_low, to_high) > spare)


@kernel
def limb_of(balls: BallLimits, link: int, turn: Columns) -> Vec3:
    """Return the direction of the limb of a ball, in the parent's axes."""
    return turned(turn, row(balls.axis, link))


@kernel
def inside_cone(balls: BallLimits, link: int, turn: Columns) -> Columns:
    """Return the rotation if the ball allows it, else the limb on the nearest edge of cone and polygon and the twist clipped."""
    swing, twist, back = swing_and_twist(balls, link, turn)
    centre = row(balls.centre, link)
    most = max(0.0, most_swing(balls, link) - INWARD)
    low, high = balls.twist[link, 0] + INWARD, balls.twist[link, 1] - INWARD
    if low > high:
        low = high = 0.5 * (low + high)
    # an angle outside the interval goes to the nearer end, measured around the circle
    clipped = twist
    if twist < low or twist > high:
        to_low, to_high = abs(wrapped(twist - low)), abs(wrapped(twist - high))
        clipped = low if to_low < to_high else high
    inside = swing <= most
    limb = limb_of(balls, link, turn)
    allowed = limb
    if has_reach(balls, link):
        inside = inside and is_in_reach(balls, link, limb)
        if not inside:
            allowed = nearest_in_reach(balls, link, limb, most)
    if inside and clipped == twist:
        return turn
    # unswing, correct the twist, swing out again as far as allowed
    out, again = min(swing, most), back
    if not inside and has_reach(balls, link):
        again = cross(allowed, centre)
        sine = norm(again)
        out = atan2(sine, dot(allowed, centre))
        again = scale(again, 1.0 / sine) if sine > ROUNDING else back
    x, y, z = turn
    x, y, z = about(back, swing, x), about(back, swing, y), about(back, swing, z)
    x, y, z = about(centre, clipped - twist, x), about(centre, clipped - twist, y), about(centre, clipped - twist, z)
    return about(again, -out, x), about(again, -out, y), about(again, -out, z)


@kernel
def room_of_ball(balls: BallLimits, link: int, turn: Columns) -> tuple[float, Vec3, float, Vec3]:
    """Linearise the limits of the limb of a ball at a rotation: the nearest edge of cone and polygon, and the nearest across it.

    Returns:
        Room [rad] to the nearest edge, 0 beyond it, and the unit axis (parent's axes) about which a turn leads away from it; the
        same of the second, inf and zero where there is none.
    """
    swing, _, away = swing_and_twist(balls, link, turn)
    limb = limb_of(balls, link, turn)
    most = most_swing(balls, link)
    room, second, other = most - swing, inf, (0.0, 0.0, 0.0)
    if not has_reach(balls, link):
        return max(0.0, room - INWARD), away, second, other
    if room <= 0.0 or not is_in_reach(balls, link, limb):
        allowed = nearest_in_reach(balls, link, limb, most)
        back = cross(limb, allowed)
        if norm(back) > ROUNDING:
            room, away, limb = 0.0, direction_of(back, away), allowed
    for k in range(balls.first_corner[link + 1] - balls.first_corner[link]):
        start, end, inward = edge(balls, link, k)
        nearest = nearest_on_edge(start, end, inward, limb)
        beyond, axis = angle_between(nearest, limb), direction_of(cross(nearest, limb), cross(limb, inward))
        is_across = norm(cross(axis, away)) > FINE
        if beyond < room:
            if is_across:
                room, away, second, other = beyond, axis, room, away
            else:
                room, away = beyond, axis
        elif is_across and beyond < second:
            second, other = beyond, axis
    return max(0.0, room - INWARD), away, max(0.0, second - INWARD), other


@kernel
def room_of_twist(balls: BallLimits, link: int, turn: Columns) -> tuple[float, float, Vec3]:
    """Return the least and largest change of a ball's twist [rad] at a rotation, and its gradient (parent's axes)."""
    _, twist, _ = swing_and_twist(balls, link, turn)
    limb, centre = limb_of(balls, link, turn), row(balls.centre, link)
    gradient = scale(add(centre, limb), 1.0 / max(FLAT, 1.0 + dot(centre, limb)))
    low, high = min(0.0, balls.twist[link, 0] + INWARD - twist), max(0.0, balls.twist[link, 1] - INWARD - twist)
    return low, high, gradient


@kernel
def direction_of(v: Vec3, otherwise: Vec3) -> Vec3:
    """Return the unit vector along v, or another one if v is zero."""
    size = norm(v)
    return scale(v, 1.0 / size) if size > ROUNDING else otherwise


@kernel
def wrapped(angle: float) -> float:
    """Return an angle in [-pi, pi], modulo whole turns."""
    return atan2(sin(angle), cos(angle))
