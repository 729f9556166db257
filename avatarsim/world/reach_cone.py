"""Reach cones (Wilhelms and Van Gelder 2001): the allowed directions of a limb as a spherical polygon; tests and projection.

The polygon may be concave and wider than a hemisphere: it is the union of the spherical triangles between its edges and a point
that sees every edge. A circular swing cone applies as well; the projection is into both.
"""

from math import atan2, cos, sin, sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, cross, dot, norm, perpendicular, row, scale, sub
from avatarsim.tolerances import ROUNDING
from avatarsim.world.skeleton import Skeleton


@kernel
def has_reach(skel: Skeleton, link: int) -> bool:
    """Whether the limb of a link has a spherical polygon."""
    return bool(skel.reach_first[link + 1] > skel.reach_first[link])


@kernel
def edge(skel: Skeleton, link: int, k: int) -> tuple[Vec3, Vec3, Vec3]:
    """Corner k of a link's polygon, the next one, and the unit normal of the edge's plane, which points inside."""
    first, last = skel.reach_first[link], skel.reach_first[link + 1]
    start = row(skel.reach_corner, first + k)
    end = row(skel.reach_corner, first + k + 1 if first + k + 1 < last else first)
    normal = cross(start, end)
    return start, end, scale(normal, 1.0 / norm(normal))


@kernel
def is_in_reach(skel: Skeleton, link: int, limb: Vec3) -> bool:
    """Whether a unit direction is in one of the triangles of the seeing point and an edge."""
    first, last = skel.reach_first[link], skel.reach_first[link + 1]
    beside = dot(row(skel.reach_side, first), limb)
    for k in range(first, last):
        following = k + 1 if k + 1 < last else first
        # the side where one triangle ends is where the next one begins
        next_beside = dot(row(skel.reach_side, following), limb)
        # a direction so little outside an edge counts as on it: projected ones are, by rounding
        if beside >= -ROUNDING and next_beside <= ROUNDING:
            normal = cross(row(skel.reach_corner, k), row(skel.reach_corner, following))
            if dot(scale(normal, 1.0 / norm(normal)), limb) >= -ROUNDING:
                return True
        beside = next_beside
    return False


@kernel
def angle_between(a: Vec3, b: Vec3) -> float:
    """Angle [rad] of two unit vectors."""
    return atan2(norm(cross(a, b)), dot(a, b))


@kernel
def chord(a: Vec3, b: Vec3) -> float:
    """Squared distance of two unit vectors: it grows as their angle does and costs no arc tangent."""
    way = sub(a, b)
    return dot(way, way)


@kernel
def nearest_on_edge(start: Vec3, end: Vec3, inward: Vec3, limb: Vec3) -> Vec3:
    """The point of the great arc from start to end that is nearest to a unit direction."""
    foot = sub(limb, scale(inward, dot(inward, limb)))
    length = norm(foot)
    if length > ROUNDING:
        foot = scale(foot, 1.0 / length)
        if dot(cross(inward, start), foot) >= 0.0 and dot(cross(end, inward), foot) >= 0.0:
            return foot
    return start if dot(start, limb) >= dot(end, limb) else end


@kernel
def reach_excess(skel: Skeleton, link: int, limb: Vec3) -> float:
    """Angle [rad] by which a unit direction is outside the polygon; 0 inside."""
    if is_in_reach(skel, link, limb):
        return 0.0
    nearest = 10.0
    for k in range(skel.reach_first[link + 1] - skel.reach_first[link]):
        start, end, inward = edge(skel, link, k)
        nearest = min(nearest, angle_between(nearest_on_edge(start, end, inward, limb), limb))
    return nearest


@kernel
def swing_of(skel: Skeleton, link: int, limb: Vec3) -> float:
    """Angle [rad] of a unit direction to the centre of the circular swing cone."""
    return angle_between((skel.cone[link, 3], skel.cone[link, 4], skel.cone[link, 5]), limb)


@kernel
def nearest_in_reach(skel: Skeleton, link: int, limb: Vec3, most: float) -> Vec3:
    """The direction nearest to a limb's that is in the polygon and swings at most `most` [rad] from the cone's centre.

    The edge of what is allowed consists of arcs of the polygon and of the cone's circle. So the nearest point is the nearest of
    an arc of one, if the other allows it, or a point where the two cross; the point that sees all edges is always allowed.
    """
    if is_in_reach(skel, link, limb) and swing_of(skel, link, limb) <= most:
        return limb
    centre = (skel.cone[link, 3], skel.cone[link, 4], skel.cone[link, 5])
    best = row(skel.sight, link)
    least = chord(best, limb)
    candidate = nearest_on_circle(centre, most, limb)
    if chord(candidate, limb) < least and is_in_reach(skel, link, candidate):
        best, least = candidate, chord(candidate, limb)
    for k in range(skel.reach_first[link + 1] - skel.reach_first[link]):
        if is_plane_beyond(skel, link, k, limb, least):
            continue
        start, end, inward = edge(skel, link, k)
        # where that of an edge which is nearest is too far, or allowed, the rest of the edge has nothing to add;
        # its end is the start of another
        for which in range(4):
            if which == 0:
                candidate = nearest_on_edge(start, end, inward, limb)
                if not (chord(candidate, limb) < least):
                    break
            elif which == 1:
                candidate = start
            else:
                crosses, candidate = crossing(start, end, inward, centre, most, which == 2)
                if not crosses:
                    continue
            away = chord(candidate, limb)
            if away < least and swing_of(skel, link, candidate) <= most + ROUNDING:
                best, least = candidate, away
                if which == 0:
                    break
    return best


@kernel
def is_plane_beyond(skel: Skeleton, link: int, k: int, limb: Vec3, square: float) -> bool:
    """Whether a limb's direction is farther from the plane of an edge than the root of `square`, without computing the root."""
    first, last = skel.reach_first[link], skel.reach_first[link + 1]
    normal = cross(row(skel.reach_corner, first + k), row(skel.reach_corner, first + k + 1 if first + k + 1 < last else first))
    away = dot(normal, limb)
    return away * away > square * dot(normal, normal)


@kernel
def nearest_on_circle(centre: Vec3, radius: float, limb: Vec3) -> Vec3:
    """The direction at angle `radius` [rad] from the centre that is nearest to a limb's."""
    sideways = sub(limb, scale(centre, dot(centre, limb)))
    length = norm(sideways)
    if length < ROUNDING:
        sideways, length = perpendicular(centre), 1.0  # every one is as near
    return add(scale(centre, cos(radius)), scale(sideways, sin(radius) / length))


@kernel
def crossing(start: Vec3, end: Vec3, inward: Vec3, centre: Vec3, radius: float, first: bool) -> tuple[bool, Vec3]:
    """Where the great arc from start to end meets the circle of angle `radius` [rad] about a centre: one of two places."""
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
    """The angle [rad] of a cosine in [-1, 1], by the arc tangent."""
    return atan2(sqrt(max(0.0, (1.0 - cosine) * (1.0 + cosine))), cosine)
