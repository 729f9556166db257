"""The certificate of a step: proof that a pair of pieces is apart at both ends and passed through nothing in between.

For a pair there is a direction n, fixed in the world or carried by one of the two, along which it is apart at the
checked state and at the trial. Support functions are convex, so the pair stays apart along n while vertices move
straight from one end to the other. The gap along a direction proves separation whatever proposed the direction: GJK
proposes, two supports decide. Every test is written so that a NaN fails it.
"""

from math import inf

from avatarsim.collide.gjk import gjk
from avatarsim.collide.signed_distance import signed_distance
from avatarsim.collide.status import CONVERGED
from avatarsim.collide.support import gap_along
from avatarsim.kernel import kernel
from avatarsim.posture.workspace import BAD_QUERIES, NOW, QUERIES, SUPPORTS, Memory
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, dot, norm, scale
from avatarsim.world.geometry import Geometry, Poses

FAR = 0.02
"""[m] directions of pairs farther apart than this need not be exact: the search stops at the first proof."""


ROUNDING = 1e-12
"""[m] by which a gap may shrink without anybody having moved."""

TOUCHING = 1e-9
"""[m] a start that overlaps by no more than this is accepted, and must not be a trap: from there every way apart is free."""


@kernel
def axis_of(memory: Memory, i: int, b: int) -> Vec3:
    """Direction that last held for driven piece i (counted from the first driven one) and piece b."""
    a = memory.pairs.axis
    return (a[i, b, 0], a[i, b, 1], a[i, b, 2])


@kernel
def remember_axis(memory_out: Memory, i: int, b: int, n: Vec3) -> None:
    """Keep n as the pair's direction; its gap at the checked state is not known yet."""
    pairs = memory_out.pairs
    pairs.axis[i, b, 0] = n[0]
    pairs.axis[i, b, 1] = n[1]
    pairs.axis[i, b, 2] = n[2]
    pairs.axis_stamp[i, b] = -1


@kernel
def cached_axis_holds(geo: Geometry, poses: Poses, memory_out: Memory, i: int, a: int, b: int, least: float) -> bool:
    """Whether the remembered direction certifies the pair: gap > 0 at the checked state, >= `least` at the trial."""
    n, pairs = axis_of(memory_out, i, b), memory_out.pairs
    if not (dot(n, n) > 0.5):
        return False
    if pairs.axis_stamp[i, b] != pairs.marks[NOW]:
        memory_out.counts[SUPPORTS] += 1
        pairs.axis_gap[i, b] = gap_along(poses.vertices, geo.shapes, a, b, n)
        pairs.axis_stamp[i, b] = pairs.marks[NOW]
    if not (pairs.axis_gap[i, b] > -TOUCHING):
        return False
    memory_out.counts[SUPPORTS] += 1
    return gap_along(memory_out.trial.vertices, geo.shapes, a, b, n) >= least


@kernel
def nearest_direction(
    geo: Geometry, poses: Poses, seed: Vec3, a: int, b: int, reach: float, memory_out: Memory
) -> tuple[float, Vec3, int]:
    """Gap [m], unit direction out of b into a and simplex size, exact when below `reach`; gap -inf if cores overlap."""
    memory_out.counts[QUERIES] += 1
    rounding = geo.shapes.radius[a] + geo.shapes.radius[b]
    status, n, distance, count = gjk(poses.vertices, geo.shapes, a, b, seed, rounding + reach, memory_out.scratch)
    if status != CONVERGED:
        memory_out.counts[BAD_QUERIES] += 1
    if not (dot(n, n) > 0.5):
        return -inf, n, count
    return distance - rounding, n, count


@kernel
def checked_direction(geo: Geometry, poses: Poses, i: int, a: int, b: int, memory_out: Memory) -> tuple[float, Vec3]:
    """Gap and direction at the checked state, asked of GJK once per step and pair."""
    pairs = memory_out.pairs
    if pairs.nearest_stamp[i, b] != pairs.marks[NOW]:
        gap, n, _ = nearest_direction(geo, poses, axis_of(memory_out, i, b), a, b, FAR, memory_out)
        if not (dot(n, n) > 0.5):
            # cores that touch exactly have no nearest direction, but the one of least depth
            _, gap, n, _, _ = signed_distance(poses.vertices, geo.shapes, a, b, axis_of(memory_out, i, b), memory_out.scratch)
        remember_nearest(memory_out, i, b, gap, n)
    n = (pairs.nearest[i, b, 0], pairs.nearest[i, b, 1], pairs.nearest[i, b, 2])
    return pairs.nearest_gap[i, b], n


@kernel
def remember_nearest(memory_out: Memory, i: int, b: int, gap: float, n: Vec3) -> None:
    """Keep the nearest direction of the checked state; it is also the best direction to try first."""
    pairs = memory_out.pairs
    if dot(n, n) > 0.5:
        remember_axis(memory_out, i, b, n)
        pairs.nearest[i, b, 0] = n[0]
        pairs.nearest[i, b, 1] = n[1]
        pairs.nearest[i, b, 2] = n[2]
    pairs.nearest_gap[i, b] = gap
    pairs.nearest_stamp[i, b] = pairs.marks[NOW]


@kernel
def apart_along(geo: Geometry, poses: Poses, a: int, b: int, n: Vec3, memory_out: Memory) -> bool:
    """Whether the pair is apart along n, or touches to rounding."""
    memory_out.counts[SUPPORTS] += 1
    return gap_along(poses.vertices, geo.shapes, a, b, n) > -TOUCHING


@kernel
def nothing_crossed(geo: Geometry, poses: Poses, a: int, b: int, n0: Vec3, n1: Vec3, memory_out: Memory) -> bool:
    """Whether one direction separates both ends of the step: n1, the mean of n0 and n1, or either carried by a body.

    n0 is the nearest direction at the checked state, n1 at the trial; at its own end each is known to separate.
    """
    trial = memory_out.trial
    if apart_along(geo, poses, a, b, n1, memory_out):
        return True
    middle = add(n0, n1)
    length = norm(middle)
    if length > 1e-6:
        n = scale(middle, 1.0 / length)
        if apart_along(geo, poses, a, b, n, memory_out) and apart_along(geo, trial, a, b, n, memory_out):
            return True
    body_a, body_b = geo.body[a], geo.body[b]
    carried = turned(columns(trial.rotation, body_a), turned_back(columns(poses.rotation, body_a), n0))
    if apart_along(geo, trial, a, b, carried, memory_out):
        return True
    carried = turned(columns(trial.rotation, body_b), turned_back(columns(poses.rotation, body_b), n0))
    if apart_along(geo, trial, a, b, carried, memory_out):
        return True
    carried = turned(columns(poses.rotation, body_a), turned_back(columns(trial.rotation, body_a), n1))
    return apart_along(geo, poses, a, b, carried, memory_out)


@kernel
def accepted_gap(settings: PostureSettings, gap_now: float) -> float:
    """Smallest gap [m] accepted at the trial: `least_gap`, less for a pair that is squeezed already.

    A squeezed pair may lose half its gap but not below `wedged_gap`, and a pair below that may not come nearer:
    standing still must always be acceptable.
    """
    if gap_now < 2.0 * settings.least_gap:
        return max(0.0, max(0.5 * gap_now, min(settings.wedged_gap, gap_now - ROUNDING)))
    return settings.least_gap
