"""Continuous collision detection between two recorded postures: interval separating axes with a bound of curvature, and
bisection.

Between two postures a player shows slerp in each joint and straight lines for roots, hinge angles and slides. Over a share h of
that way a point of a link leaves its straight line by at most C h^2 / 8, where C bounds its second derivative. Along a fixed
direction n the gap of a pair is therefore at least (1 - s) g0 + s g1 - 4 s (1 - s) B at the share s of the interval, g0 and g1
the gaps at its ends and B the bulge of both; that is never negative if sqrt(g0) + sqrt(g1) >= 2 sqrt(B). Where no direction shows
it the interval is halved. Directions are proposed by GJK (Gilbert, Johnson and Keerthi 1988), two supports decide.

Zhang, Redon, Lee and Kim 2007, Continuous collision detection for articulated models using Taylor models and temporal culling,
bound the same motion by intervals of its Taylor series; here the second term alone is bounded, and convexity does the rest.

The bound: a point is carried by rotations one after the other, those of the joints above it, which turn by s_1, s_2, ... over the
way, each about an axis that is fixed in its carrier. The second derivative of such a product is a sum of products, each of
rotations and two generators of unit norm, with factors s_i s_j: its norm is at most S^2, S the sum of all turns. So a segment of
length l bends by at most l S^2, and the segments of a chain add up. A pair of links is tested in the frame of their nearest
common ancestor, which only the joints below it move. A slide changes its segment's vector at the constant rate d: its carrier
turns by S, and (R v)'' = R'' v + 2 R' v' adds at most 2 S |d|, with v the longer of its two ends.
"""

from math import ceil, log2, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.gjk import gjk
from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance, signed_distance_up_to
from avatarsim.collision.support import gap_along
from avatarsim.ik.make import empty_posture
from avatarsim.ik.state import PairCache, axis_at, keep_axis, make_pair_cache, slot_of
from avatarsim.jit.arena import view_arena
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import IndexGrid, IndexLine, Line, Vectors
from avatarsim.model.conversion import read_sample
from avatarsim.model.geometry import POINTS, Geometry, Poses, allowed_depth, may_meet
from avatarsim.model.skeleton import BALL, FREE, SLIDE, Posture, Skeleton, carry, has_angles, place_links
from avatarsim.model.world import World, WorldParts
from avatarsim.spatial.tangent import columns, step_between, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, dot, norm, row, scale, sub
from avatarsim.tolerances import POSTURE_GAP, ROUNDING, SAME_DIRECTION, SLIGHT

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SAGITTA = 1.0 / 8.0
"""A path stays within this part of its largest second derivative, times the square of the time, of its chord."""

DEPTH = ceil(0.5 * log2(SAGITTA / SLIGHT))
"""Halvings of a way before it counts as not free: a 4096th. There the bulge of a limb of a metre that turns by a radian is below
SLIGHT. More: touching pairs take longer to fail."""

ROOM_MOST, ROOM_DEEPER = 1 << 20, 1 << 14
"""Most pairs of pieces that may be listed as undecided for a whole way, and further ones for parts of it; pairs beyond that count
as not free."""

HOME = 0.5 * POSTURE_GAP
"""Gap [m], beyond the depth that it may have, from which a pair that overlaps at home is as good as there. Larger: rounding of a
file makes a posture at home one that is changed; smaller: a pair is left nearer to where no step of it is proved."""

PROVED, UNDECIDED, OVERLAPS = range(3)
"""State of a pair of pieces over an interval: apart; not shown to be; not apart at its begin."""


class MotionSegment(NamedTuple):
    """The motion from one posture to another, and the working memory of its certificate: nl links, nd degrees, ns pieces.

    hinges       degree of every hinge angle of a sample
    ancestor     (nl, nl) nearest common ancestor of two links, the link itself included; -1 for links of two avatars
    length, slid (nl) from the joint of a link's parent to its own [m], of a slide at most; and how far it slides [m]
    reach        (ns) how far the core of a link's piece reaches from the link's joint [m]
    start, end   the two postures
    step         (nd) from one to the other in the tangent space; part (nd) a share of it
    axes         (nd, 3) axes of the degrees, which nothing here reads
    turn         (nl) sum of the turns of all joints above a link's points [rad]
    curvature    (ns) bound of the second derivative of a piece's points in the world [m]
    one, other   poses at the ends of the interval that is tested
    near         bodies in reach of the avatars
    pending      (m, 2) pairs of pieces that are not decided: those of depth d are span[d] .. span[d + 1]
    ends, depth  (DEPTH + 2) ends of the intervals that are still to be tested, the first last, and how deep each is
    pairs        separating axes, in the frame in which the pair is tested
    """

    hinges: IndexLine
    ancestor: IndexGrid
    length: Line
    slid: Line
    reach: Line
    start: Posture
    end: Posture
    step: Line
    part: Line
    axes: Vectors
    turn: Line
    curvature: Line
    one: Poses
    other: Poses
    near: IndexLine
    pending: IndexGrid
    span: IndexLine
    ends: Line
    depth: IndexLine
    pairs: PairCache
    narrow: Scratch


def make_motion_segment(world: World) -> MotionSegment:
    """Return memory for motion segments of the avatars of a world among its fixed bodies."""
    geo, skel = world.geometry, world.skeleton
    nl, nd, ns = len(skel.kind), int(skel.first_dof[-1]), len(geo.body)
    driven = ns - int(geo.first_shape[skel.first])
    room = min(driven * ns, ROOM_MOST) + ROOM_DEEPER
    copies = [Poses(*(array.copy() for array in world.poses)) for _ in range(2)]
    return MotionSegment(
        world.hinges.copy(), common_ancestors(skel), np.linalg.norm(skel.anchor, axis=1), np.zeros(nl),
        core_reaches(geo, skel), empty_posture(nl, nd), empty_posture(nl, nd), np.zeros(nd), np.zeros(nd), np.zeros((nd, 3)),
        np.zeros(nl), np.zeros(ns), copies[0], copies[1], np.zeros(max(skel.first, 1), dtype=np.int64), np.zeros((room, 2),
        dtype=np.int64), np.zeros(DEPTH + 3, dtype=np.int64), np.zeros(DEPTH + 2), np.zeros(DEPTH + 2, dtype=np.int64),
        make_pair_cache(driven, ns), make_scratch(),
    )


def common_ancestors(skel: Skeleton) -> Index:
    """Return (nl, nl) the last link from the root on that carries both; -1 without any."""
    # parents come before children, so that of all common ancestors the nearest has the greatest number
    both = skel.related[:, None, :] & skel.related[None, :, :]
    numbers = np.where(both, np.arange(len(skel.kind)), -1)
    return np.asarray(numbers.max(axis=2, initial=-1), dtype=np.int64)


def core_reaches(geo: Geometry, skel: Skeleton) -> Array:
    """Return (ns) how far the core of each link's piece reaches from the link's joint [m]; 0 for pieces of other bodies."""
    found = np.zeros(len(geo.body))
    for s in range(int(geo.first_shape[skel.first]), len(geo.body)):
        points = geo.local[geo.shapes.start[s] : geo.shapes.start[s + 1]]
        lengths = np.linalg.norm(points, axis=1)
        # of an ellipsoid the first row is the centre, the others are semi-axes
        found[s] = lengths.max() if geo.shapes.kind[s] == POINTS else lengths[0] + lengths[1:].max()
    return found


@kernel
def measure_step(skel: Skeleton, segment_out: MotionSegment) -> None:
    """Measure the step between the two postures, and its turns."""
    c = segment_out
    for link in range(skel.kind.shape[0]):
        d, kind, parent = skel.first_dof[link], skel.kind[link], skel.parent[link]
        c.turn[link] = c.turn[parent] if parent >= 0 else 0.0
        if kind == FREE:
            move = sub(row(c.end.root, link), row(c.start.root, link))
            for k in range(3):
                c.step[d + k] = move[k]
            d += 3
        if kind == FREE or kind == BALL:
            w = step_between(columns(c.start.turn, link), columns(c.end.turn, link))
            for k in range(3):
                c.step[d + k] = w[k]
            c.turn[link] += norm(w)
        elif kind == SLIDE:
            c.step[d] = c.end.angle[d] - c.start.angle[d]
            c.slid[link] = abs(c.step[d])
            axis = turned(columns(skel.rest, link), row(skel.axis, d))
            ends = along(row(skel.anchor, link), c.start.angle[d], axis), along(row(skel.anchor, link), c.end.angle[d], axis)
            c.length[link] = max(norm(ends[0]), norm(ends[1]))
        elif has_angles(skel, link):
            for j in range(d, skel.first_dof[link + 1]):
                c.step[j] = c.end.angle[j] - c.start.angle[j]
                c.turn[link] += abs(c.step[j])


@kernel
def curvature_below(skel: Skeleton, segment: MotionSegment, above: int, link: int, reach: float) -> float:
    """Bound the second derivative [m] of points up to `reach` [m] from the joint of `link`, seen from link `above`, or the world
    (-1)."""
    turn0 = segment.turn[above] if above >= 0 else 0.0
    total, length, k = 0.0, reach, link
    while k != above:
        turn = segment.turn[k] - turn0
        total += length * turn * turn
        length, slid, k = segment.length[k], segment.slid[k], skel.parent[k]
        total += 2.0 * slid * (segment.turn[k] - turn0) if k != above else 0.0
    return total


@kernel
def put_at(geo: Geometry, skel: Skeleton, share: float, segment_out: MotionSegment, poses_out: Poses) -> None:
    """Set the poses at a share of the way."""
    for j in range(segment_out.step.shape[0]):
        segment_out.part[j] = share * segment_out.step[j]
    carry(skel, segment_out.start, segment_out.part, poses_out, segment_out.axes)
    place_links(geo, skel, poses_out)


@kernel
def swept_meet(left: Array, right: Array, i: int, j: int, grow: float) -> bool:
    """Return True if boxes i and j, each around both ends of an interval and together grown by `grow` [m], meet."""
    for k in range(3):
        if not (
            min(left[i, k], right[i, k]) - grow <= max(left[j, 3 + k], right[j, 3 + k])
            and min(left[j, k], right[j, k]) - grow <= max(left[i, 3 + k], right[i, 3 + k])
        ):
            return False
    return True


@kernel
def link_curvature(geo: Geometry, segment: MotionSegment, body: int) -> float:
    """Return the largest bound of the second derivative of a link's pieces."""
    most = 0.0
    for s in range(geo.first_shape[body], geo.first_shape[body + 1]):
        most = max(most, segment.curvature[s])
    return most


@kernel
def list_near(geo: Geometry, skel: Skeleton, least: float, segment_out: MotionSegment) -> int:
    """List the bodies that are no links whose boxes meet that around all links over the whole way; return their number."""
    c, count = segment_out, 0
    low, high = (np.inf, np.inf, np.inf), (-np.inf, -np.inf, -np.inf)
    for body in range(skel.first, skel.first + skel.kind.shape[0]):
        if geo.first_shape[body] == geo.first_shape[body + 1]:
            continue
        grow, p, q = SAGITTA * link_curvature(geo, c, body) + least, c.one.hulls, c.other.hulls
        low = (
            min(low[0], p[body, 0] - grow, q[body, 0] - grow), min(low[1], p[body, 1] - grow, q[body, 1] - grow),
            min(low[2], p[body, 2] - grow, q[body, 2] - grow),
        )
        high = (
            max(high[0], p[body, 3] + grow, q[body, 3] + grow), max(high[1], p[body, 4] + grow, q[body, 4] + grow),
            max(high[2], p[body, 5] + grow, q[body, 5] + grow),
        )
    for b in range(skel.first):
        meets = True
        for k in range(3):
            meets = meets and c.one.hulls[b, k] <= high[k] and low[k] <= c.one.hulls[b, 3 + k]
        if meets:
            c.near[count] = b
            count += 1
    return count


@kernel
def list_bodies(geo: Geometry, body: int, other: int, least: float, segment_out: MotionSegment, count: int) -> int:
    """List pairs of pieces of two bodies whose boxes may meet over the whole way; return the number so far, -1 for too many."""
    c = segment_out
    grow = SAGITTA * (link_curvature(geo, c, body) + link_curvature(geo, c, other)) + least
    if not swept_meet(c.one.hulls, c.other.hulls, body, other, grow) or not may_meet(geo.wanted, body, other):
        return count
    for s in range(geo.first_shape[body], geo.first_shape[body + 1]):
        for t in range(geo.first_shape[other], geo.first_shape[other + 1]):
            if swept_meet(c.one.boxes, c.other.boxes, s, t, SAGITTA * (c.curvature[s] + c.curvature[t]) + least):
                if count >= c.pending.shape[0] - ROOM_DEEPER:
                    return -1
                c.pending[count, 0], c.pending[count, 1] = s, t
                count += 1
    return count


@kernel
def list_pairs(geo: Geometry, skel: Skeleton, least: float, segment_out: MotionSegment) -> int:
    """List pairs of pieces that may meet over the whole way, from `one` to `other`; return their number, -1 for too many."""
    near, count, links = list_near(geo, skel, least, segment_out), 0, skel.kind.shape[0]
    for link in range(links):
        for k in range(near):
            count = list_bodies(geo, skel.first + link, segment_out.near[k], least, segment_out, count)
            if count < 0:
                return -1
        for k in range(link + 1, links):
            count = list_bodies(geo, skel.first + link, skel.first + k, least, segment_out, count)
            if count < 0:
                return -1
    return count


@kernel
def carried(skel: Skeleton, poses: Poses, above: int, n: Vec3) -> Vec3:
    """Return a direction in the frame of the link `above`, in the world; in the world already for -1."""
    return turned(columns(poses.rotation, skel.first + above), n) if above >= 0 else n


@kernel
def brought(skel: Skeleton, poses: Poses, above: int, n: Vec3) -> Vec3:
    """Return the inverse of `carried`."""
    return turned_back(columns(poses.rotation, skel.first + above), n) if above >= 0 else n


@kernel
def holds(
    geo: Geometry, skel: Skeleton, left: Poses, right: Poses, above: int, a: int, b: int, n: Vec3, bulge: float, least: float
) -> bool:
    """Return True if the direction n, in the frame of link `above`, always keeps pieces a and b at least `least` [m] apart."""
    if not (dot(n, n) > 0.5):
        return False
    gap0 = gap_along(left.vertices, geo.shapes, a, b, carried(skel, left, above, n)) - least
    if not (gap0 >= 0.0):
        return False
    gap1 = gap_along(right.vertices, geo.shapes, a, b, carried(skel, right, above, n)) - least
    if not (gap1 >= 0.0):
        return False
    return sqrt(gap0) + sqrt(gap1) >= 2.0 * sqrt(bulge + ROUNDING)


@kernel
def proposed(geo: Geometry, poses: Poses, a: int, b: int, seed: Vec3, enough: float, segment_out: MotionSegment) -> Vec3:
    """Return the nearest direction of pieces a and b, or one along which they are farther apart than `enough` [m]."""
    rounding = geo.shapes.radius[a] + geo.shapes.radius[b]
    _, n, _, _ = gjk(poses.vertices, geo.shapes, a, b, seed, rounding + enough, segment_out.narrow)
    if not (dot(n, n) > 0.5):
        # cores that touch or overlap have no nearest direction, but one of least depth
        _, _, n, _, _ = signed_distance(poses.vertices, geo.shapes, a, b, seed, segment_out.narrow)
    return n


@kernel
def test_pair(
    geo: Geometry, skel: Skeleton, left: Poses, right: Poses, share: float, a: int, b: int, least: float,
    segment_out: MotionSegment,
) -> int:
    """Return True if pieces a and b are shown to be at least `least` [m] apart over an interval of so large a share of the way;
    less by the depth that a pair may have which overlaps at home."""
    least -= allowed_depth(geo, a, b)
    c, one, other = segment_out, geo.body[a] - skel.first, geo.body[b] - skel.first
    square = SAGITTA * share * share
    if not swept_meet(left.boxes, right.boxes, a, b, square * (c.curvature[a] + c.curvature[b]) + max(least, 0.0)):
        return PROVED
    above = c.ancestor[one, other] if one >= 0 and other >= 0 else -1
    bulge = square * (c.curvature[a] + c.curvature[b])
    if above >= 0:
        bulge = square * (curvature_below(skel, c, above, one, c.reach[a]) + curvature_below(skel, c, above, other, c.reach[b]))
    at = slot_of(c.pairs, a, b)
    n = axis_at(c.pairs, at)
    if holds(geo, skel, left, right, above, a, b, n, bulge, least):
        return PROVED
    enough = 4.0 * bulge + max(least, 0.0) + 2.0 * ROUNDING
    there = proposed(geo, left, a, b, carried(skel, left, above, n), enough, c)
    if not (gap_along(left.vertices, geo.shapes, a, b, there) >= least):
        return OVERLAPS
    n0 = brought(skel, left, above, there)
    keep_axis(c.pairs, at, n0)
    if holds(geo, skel, left, right, above, a, b, n0, bulge, least):
        return PROVED
    n1 = brought(skel, right, above, proposed(geo, right, a, b, carried(skel, right, above, n0), enough, c))
    if holds(geo, skel, left, right, above, a, b, n1, bulge, least):
        keep_axis(c.pairs, at, n1)
        return PROVED
    middle = add(n0, n1)
    length = norm(middle)
    if length > SAME_DIRECTION:
        n = scale(middle, 1.0 / length)
        if holds(geo, skel, left, right, above, a, b, n, bulge, least):
            keep_axis(c.pairs, at, n)
            return PROVED
    return UNDECIDED


@kernel
def test_interval(
    geo: Geometry, skel: Skeleton, left: Poses, right: Poses, share: float, depth: int, least: float, segment_out: MotionSegment
) -> int:
    """Test the pairs that are pending at a depth; those that are left are listed at the next one. Return the worst state found;
    where that is OVERLAPS, or the interval is the shortest, the first listed is the pair that failed."""
    c, worst = segment_out, PROVED
    first, last = c.span[depth], c.span[depth + 1]
    count = last
    for k in range(first, last):
        a, b = c.pending[k, 0], c.pending[k, 1]
        found = test_pair(geo, skel, left, right, share, a, b, least, c)
        if found == PROVED:
            continue
        if found == OVERLAPS or count >= c.pending.shape[0]:
            place = min(last, c.pending.shape[0] - 1)
            c.pending[place, 0], c.pending[place, 1] = a, b
            c.span[depth + 1] = place
            return OVERLAPS
        worst = UNDECIDED
        c.pending[count, 0], c.pending[count, 1] = a, b
        count += 1
    c.span[depth + 2] = count
    return worst


@kernel
def go_along(geo: Geometry, skel: Skeleton, least: float, segment_out: MotionSegment) -> tuple[float, int, int]:
    """Return the share of the way from `start` to `end` that is proved to keep all pairs at least `least` [m] apart, from its
    begin on, and the pieces of the pair that ends it, -1 without any."""
    c = segment_out
    measure_step(skel, c)
    for s in range(geo.first_shape[skel.first], geo.body.shape[0]):
        c.curvature[s] = curvature_below(skel, c, -1, geo.body[s] - skel.first, c.reach[s])
    c.pairs.step[0] += 1
    put_at(geo, skel, 0.0, c, c.one)
    put_at(geo, skel, 1.0, c, c.other)
    listed = list_pairs(geo, skel, max(least, 0.0), c)
    if listed < 0:
        return 0.0, -1, -1
    c.span[0], c.span[1] = 0, listed
    begun, is_first, count, placed = 0.0, True, 1, 1.0
    c.ends[0], c.depth[0] = 1.0, 0
    while count > 0:
        end, depth = c.ends[count - 1], c.depth[count - 1]
        # `one` is the begin of the interval, or, every time the begin has moved on, its end
        if is_first:
            if placed != end:
                put_at(geo, skel, end, c, c.other)
            found = test_interval(geo, skel, c.one, c.other, end - begun, depth, least, c)
        else:
            if placed != end:
                put_at(geo, skel, end, c, c.one)
            found = test_interval(geo, skel, c.other, c.one, end - begun, depth, least, c)
        placed = end
        if found == PROVED:
            begun, is_first, count, placed = end, not is_first, count - 1, -1.0
        elif found == OVERLAPS or depth == DEPTH:
            failed = c.span[depth + 1]
            return begun, c.pending[failed, 0], c.pending[failed, 1]
        else:
            c.depth[count - 1], c.ends[count], c.depth[count] = depth + 1, 0.5 * (begun + end), depth + 1
            count += 1
    return 1.0, -1, -1


@entry_kernel
def free_until(
    world: Index, segment: Index, positions: Array, rotations: Array, angles: Array, next_positions: Array, next_rotations: Array,
    next_angles: Array, least: float,
) -> tuple[float, int, int]:
    """Return `go_along` from one posture (positions (nl, 3), rotations (nl, 4), angles (nh)) to the next, which have been
    checked, on the arenas of a world and of its `MotionSegment`."""
    w, c = view_arena(world, WorldParts), view_arena(segment, MotionSegment)
    read_sample(positions, rotations, angles, c.hinges, c.start)
    read_sample(next_positions, next_rotations, next_angles, c.hinges, c.end)
    return go_along(w.geometry, w.skeleton, least, c)


@entry_kernel
def nearest_at(
    world: Index, segment: Index, positions: Array, rotations: Array, angles: Array, within: float
) -> tuple[float, int, int]:
    """Return the smallest signed distance [m] of all pairs of pieces at a posture, negative where they overlap, and the pieces;
    infinite, and -1, where no boxes are within `within` [m] of each other, nan where boxes of too many pairs are.

    Of a pair that overlaps at home the gap is that beyond the depth that it may have, and it does not count where it is hardly
    deeper than at home."""
    w, c = view_arena(world, WorldParts), view_arena(segment, MotionSegment)
    geo, skel = w.geometry, w.skeleton
    read_sample(positions, rotations, angles, c.hinges, c.start)
    c.step[:] = 0.0
    c.curvature[:] = 0.0
    put_at(geo, skel, 0.0, c, c.one)
    put_at(geo, skel, 0.0, c, c.other)
    listed = list_pairs(geo, skel, within, c)
    if listed < 0:
        return np.nan, -1, -1
    best, first, second = np.inf, -1, -1
    for k in range(listed):
        a, b = c.pending[k, 0], c.pending[k, 1]
        most = min(best, within)
        _, gap, _, _, _ = signed_distance_up_to(c.one.vertices, geo.shapes, a, b, (0.0, 0.0, 0.0), most, c.narrow)
        allowed = allowed_depth(geo, a, b)
        gap += allowed
        if allowed > 0.0 and gap >= HOME:
            continue
        if not (gap >= best):
            best, first, second = gap, a, b
    return best, first, second


@entry_kernel
def pair_gaps(
    world: Index, segment: Index, positions: Array, rotations: Array, angles: Array, pairs: Index, gaps_out: Array
) -> None:
    """Write the signed distance (m,) [m] at a posture of each pair (m, 2) of bodies, whether or not it may overlap; infinite
    without pieces. A distance above zero is known by its sign alone."""
    w, c = view_arena(world, WorldParts), view_arena(segment, MotionSegment)
    geo = w.geometry
    read_sample(positions, rotations, angles, c.hinges, c.start)
    c.step[:] = 0.0
    put_at(geo, w.skeleton, 0.0, c, c.one)
    for k in range(pairs.shape[0]):
        gaps_out[k] = np.inf
        for s in range(geo.first_shape[pairs[k, 0]], geo.first_shape[pairs[k, 0] + 1]):
            for t in range(geo.first_shape[pairs[k, 1]], geo.first_shape[pairs[k, 1] + 1]):
                _, gap, _, _, _ = signed_distance_up_to(c.one.vertices, geo.shapes, s, t, (0.0, 0.0, 0.0), 0.0, c.narrow)
                gaps_out[k] = min(gaps_out[k], gap)
