"""Joint limits: intervals of hinges, swing cone and twist interval of ball joints; excess beyond them, projection into them.

With T the shortest rotation of `axis` onto `centre` and R the rotation of a ball joint, R T^-1 is decomposed into swing and twist
about `centre`: the swing is the angle between R axis and centre, the twist the remaining rotation about centre.
"""

from math import atan2, cos, sin

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import Columns, about, columns, product, turned
from avatarsim.spatial.vec3 import Vec3, add, cross, dot, norm, scale, unit
from avatarsim.world.reach_cone import has_reach, is_in_reach, nearest_in_reach, reach_excess
from avatarsim.world.skeleton import Skeleton

UNLIMITED_COSINE = -2.0
"""Marks a ball without limits in Skeleton.cone: no cosine is below -1."""

SURELY = 1e-10
"""[rad] a ball so far inside its limits is inside whatever the rounding; smaller: rounding could pass one that is outside. Within
this of a half turn from an end the sine is not conclusive; then the angles are computed."""

INWARD = 1e-9
"""Target postures are put this far [rad] inside their limits, so that rounding never shows as an excess."""

LEFT_ALONE = 2.0 * INWARD
"""[rad] a target so far inside its limits stays as it is, without computing its angles."""


@kernel
def swing_and_twist(skel: Skeleton, link: int, turn: Columns) -> tuple[float, float, Vec3]:
    """Swing [rad], twist [rad] and the unit axis about which the limb swings back to the centre (parent's axes)."""
    axis = (skel.cone[link, 0], skel.cone[link, 1], skel.cone[link, 2])
    centre = (skel.cone[link, 3], skel.cone[link, 4], skel.cone[link, 5])
    limb = turned(turn, axis)
    back = cross(limb, centre)
    sine = norm(back)
    swing = atan2(sine, dot(limb, centre))
    if sine > 1e-12:
        back = scale(back, 1.0 / sine)
    else:
        back = any_normal(centre)
        if swing < 1.0:
            swing = 0.0
    # swing the limb back onto the centre; what is left turns about the centre
    relative = product(turn, columns(skel.untwist, link))
    probe = any_normal(centre)
    left = about(back, swing, turned(relative, probe))
    return swing, atan2(dot(centre, cross(probe, left)), dot(probe, left)), back


@kernel
def any_normal(v: Vec3) -> Vec3:
    """A unit vector at right angles to the unit vector v."""
    if abs(v[0]) < 0.6:
        return unit(cross(v, (1.0, 0.0, 0.0)))
    return unit(cross(v, (0.0, 1.0, 0.0)))


@kernel
def has_cone(skel: Skeleton, link: int) -> bool:
    """Whether the ball of a link has limits."""
    return bool(skel.cone[link, 6] > UNLIMITED_COSINE + 0.5)


@kernel
def cone_excess(skel: Skeleton, link: int, turn: Columns) -> float:
    """How far the rotation of a ball is beyond its limits [rad], the largest of swing, twist and reach; 0 or less inside."""
    swing, twist, _ = swing_and_twist(skel, link, turn)
    most = atan2(skel.cone[link, 7], skel.cone[link, 6])
    excess = float(max(swing - most, max(skel.cone[link, 8] - twist, twist - skel.cone[link, 9])))
    return max(excess, reach_excess(skel, link, limb_of(skel, link, turn))) if has_reach(skel, link) else excess


@kernel
def surely_inside(skel: Skeleton, link: int, turn: Columns, spare: float) -> bool:
    """Whether the rotation of a ball is inside its limits by more than `spare` [rad], at least SURELY: a test without angles,
    which nearly every ball of every trial passes. Where it fails `cone_excess` decides."""
    limb, t = limb_of(skel, link, turn), skel.cone
    centre, edge = (t[link, 3], t[link, 4], t[link, 5]), (t[link, 6], t[link, 7])
    probe, untwisted = (t[link, 10], t[link, 11], t[link, 12]), (t[link, 13], t[link, 14], t[link, 15])
    low, high = (t[link, 16], t[link, 17]), (t[link, 18], t[link, 19])
    if not surely_in_cone(limb, centre, edge, probe, turned(turn, untwisted), low, high, spare):
        return False
    return not has_reach(skel, link) or is_in_reach(skel, link, limb)


@kernel
def surely_in_cone(
    limb: Vec3, centre: Vec3, edge: tuple[float, float], probe: Vec3, swung: Vec3, low: tuple[float, float],
    high: tuple[float, float], spare: float,
) -> bool:
    """The same for swing and twist alone. `edge`: cosine and sine of the largest swing; the twist takes `probe` to `swung` with
    the swing undone; low, high: cosines and sines of its ends.

    Takes numbers and not the skeleton, since passing that takes longer than the test.
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
    # the sines of what is left to the ends; where zero is between these only the end on the twist's own side counts
    to_low, to_high = low[0] * y - low[1] * x, high[1] * x - high[0] * y
    if low[1] < 0.0 < high[1]:
        return bool((to_high if y >= 0.0 else to_low) > spare)
    return bool(min(to_low, to_high) > spare)


@kernel
def limb_of(skel: Skeleton, link: int, turn: Columns) -> Vec3:
    """Where the limb of a ball points, in the parent's axes."""
    return turned(turn, (skel.cone[link, 0], skel.cone[link, 1], skel.cone[link, 2]))


@kernel
def inside_cone(skel: Skeleton, link: int, turn: Columns) -> Columns:
    """The rotation itself if the ball allows it, else the limb on the nearest edge of cone and polygon and the twist clipped."""
    swing, twist, back = swing_and_twist(skel, link, turn)
    centre = (skel.cone[link, 3], skel.cone[link, 4], skel.cone[link, 5])
    most = max(0.0, atan2(skel.cone[link, 7], skel.cone[link, 6]) - INWARD)
    low, high = skel.cone[link, 8] + INWARD, skel.cone[link, 9] - INWARD
    if low > high:
        low = high = 0.5 * (low + high)
    # an angle outside the interval goes to the nearer end, measured around the circle
    clipped = twist
    if twist < low or twist > high:
        to_low, to_high = abs(wrapped(twist - low)), abs(wrapped(twist - high))
        clipped = low if to_low < to_high else high
    inside = swing <= most
    limb = limb_of(skel, link, turn)
    allowed = limb
    if has_reach(skel, link):
        inside = inside and is_in_reach(skel, link, limb)
        if not inside:
            allowed = nearest_in_reach(skel, link, limb, most)
    if inside and clipped == twist:
        return turn
    # unswing, correct the twist, swing out again as far as allowed
    out, again = min(swing, most), back
    if not inside and has_reach(skel, link):
        again = cross(allowed, centre)
        sine = norm(again)
        out = atan2(sine, dot(allowed, centre))
        again = scale(again, 1.0 / sine) if sine > 1e-12 else back
    x, y, z = turn
    x, y, z = about(back, swing, x), about(back, swing, y), about(back, swing, z)
    x, y, z = about(centre, clipped - twist, x), about(centre, clipped - twist, y), about(centre, clipped - twist, z)
    return about(again, -out, x), about(again, -out, y), about(again, -out, z)


@kernel
def wrapped(angle: float) -> float:
    """The same angle in [-pi, pi]."""
    return atan2(sin(angle), cos(angle))
