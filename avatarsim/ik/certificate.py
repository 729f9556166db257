"""Certificate of a step: proof that a pair of pieces is apart at both ends and passed through nothing in between.

For a pair there is a direction n, fixed in the world or carried by one of the two, along which it is apart at the shown state and
at the trial: a separating axis. Support functions are convex, so the pair stays apart along n while vertices move straight from
one end to the other. The gap along a direction proves separation independently of its source: GJK (Gilbert, Johnson and Keerthi
1988) proposes, two supports decide. Every test is written so that a NaN fails it.

A pair that overlaps at home may stay as deep (`Scene.at_rest`): its gap is the signed distance plus that depth, so that the
proofs are those of 0 for all others. Where its cores overlap, EPA (van den Bergh 2001) proposes the direction.
"""

from math import cos, inf

from avatarsim.collision.gjk import gjk
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CONVERGED
from avatarsim.collision.support import gap_along
from avatarsim.ik.gaps import least_gap, stand_off_of, wedged_gap
from avatarsim.ik.state import BAD_QUERIES, QUERIES, SUPPORTS, IkScratch, IkState, axis_at, keep_axis, slot_of
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses, allowed_depth
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, dot, norm, put_row, row, scale
from avatarsim.tolerances import NOTHING, ROUNDING, SAME_DIRECTION

LEAST_TRACE = 1.0 + 2.0 * cos(0.35)
"""Trace of the turn [rad] of two bodies against each other up to which directions are carried by one of them. A larger angle: a
wall may lie between both ends; a smaller: steps that are free are refused."""

EXACT = 0.02
"""[m] directions of pairs farther apart than this need not be exact: the search stops at the first proof. Larger:
longer searches; smaller: directions of pairs that touch next are off."""


@kernel
def cached_axis_holds(
    geo: Geometry, poses: Poses, at: int, a: int, b: int, least: float, state_out: IkState, scratch_out: IkScratch
) -> bool:
    """Return True if the direction in a slot certifies the pair: gap > 0 as shown, at least `least` [m] at the trial."""
    pairs, depth = state_out.pairs, allowed_depth(geo, a, b)
    n = axis_at(pairs, at)
    if not (dot(n, n) > 0.5):
        return False
    if pairs.axis_step[at] != pairs.step[0]:
        scratch_out.counts[SUPPORTS] += 1
        pairs.axis_gap[at] = gap_along(poses.vertices, geo.shapes, a, b, n) + depth
        pairs.axis_step[at] = pairs.step[0]
    if not (pairs.axis_gap[at] > -NOTHING):
        return False
    scratch_out.counts[SUPPORTS] += 1
    return gap_along(scratch_out.trial.vertices, geo.shapes, a, b, n) + depth >= least


@kernel
def nearest_direction(
    geo: Geometry, poses: Poses, seed: Vec3, a: int, b: int, reach: float, scratch_out: IkScratch
) -> tuple[float, Vec3, int]:
    """Return the gap [m], unit direction out of b into a and simplex size, exact when below `reach`; gap -inf if cores overlap.

    Of a pair that overlaps at home the gap is exact then as well, and the simplex size 0."""
    scratch_out.counts[QUERIES] += 1
    depth = allowed_depth(geo, a, b)
    rounding = geo.shapes.radius[a] + geo.shapes.radius[b] - depth
    most = max(0.0, rounding + reach)
    status, n, distance, count = gjk(poses.vertices, geo.shapes, a, b, seed, most, scratch_out.narrow)
    if depth > 0.0 and not (dot(n, n) > 0.5):
        status, gap, n, _, _ = signed_distance(poses.vertices, geo.shapes, a, b, seed, scratch_out.narrow)
        distance, count = gap + geo.shapes.radius[a] + geo.shapes.radius[b], 0
    if status != CONVERGED:
        scratch_out.counts[BAD_QUERIES] += 1
    if not (dot(n, n) > 0.5):
        return -inf, n, count
    return distance - rounding, n, count


@kernel
def shown_direction(
    geo: Geometry, poses: Poses, at: int, a: int, b: int, state_out: IkState, scratch_out: IkScratch
) -> tuple[float, Vec3]:
    """Return the gap [m] and nearest direction at the shown state, by one GJK query per step and pair."""
    pairs = state_out.pairs
    if pairs.gap_step[at] != pairs.step[0]:
        gap, n, _ = nearest_direction(geo, poses, axis_at(pairs, at), a, b, EXACT, scratch_out)
        if not (dot(n, n) > 0.5):
            # cores that touch exactly have no nearest direction, but the one of least depth
            _, gap, n, _, _ = signed_distance(poses.vertices, geo.shapes, a, b, axis_at(pairs, at), scratch_out.narrow)
            gap += allowed_depth(geo, a, b)
        keep_nearest(at, gap, n, state_out)
    return pairs.gap[at], row(pairs.normal, at)


@kernel
def keep_nearest(at: int, gap: float, n: Vec3, state_out: IkState) -> None:
    """Keep the nearest direction of the shown state; it is also the best direction to try first."""
    pairs = state_out.pairs
    if dot(n, n) > 0.5:
        keep_axis(pairs, at, n)
        put_row(pairs.normal, at, n)
    pairs.gap[at] = gap
    pairs.gap_step[at] = pairs.step[0]


@kernel
def is_apart(geo: Geometry, poses: Poses, a: int, b: int, n: Vec3, scratch_out: IkScratch) -> bool:
    """Return True if the pair is apart along n, or touches to rounding."""
    scratch_out.counts[SUPPORTS] += 1
    return gap_along(poses.vertices, geo.shapes, a, b, n) + allowed_depth(geo, a, b) > -NOTHING


@kernel
def nothing_crossed(geo: Geometry, poses: Poses, a: int, b: int, n0: Vec3, n1: Vec3, scratch_out: IkScratch) -> bool:
    """Return True if one direction separates both ends of the step: n1, the mean of n0 and n1, or one of these carried by a body.

    n0 is the nearest direction at the shown state, n1 at the trial; at its own end each is known to separate.
    """
    trial = scratch_out.trial
    if is_apart(geo, poses, a, b, n1, scratch_out):
        return True
    middle = add(n0, n1)
    length = norm(middle)
    if length > SAME_DIRECTION:
        n = scale(middle, 1.0 / length)
        if is_apart(geo, poses, a, b, n, scratch_out) and is_apart(geo, trial, a, b, n, scratch_out):
            return True
    if not turn_little(poses, trial, geo.body[a], geo.body[b]):
        return False
    for side in range(2):
        body = geo.body[a] if side == 0 else geo.body[b]
        carried = turned(columns(trial.rotation, body), turned_back(columns(poses.rotation, body), n0))
        if is_apart(geo, trial, a, b, carried, scratch_out):
            return True
        # links that turn a little against each other while the whole avatar turns far
        middle = add(carried, n1)
        length = norm(middle)
        if length > SAME_DIRECTION:
            n = scale(middle, 1.0 / length)
            back = turned(columns(poses.rotation, body), turned_back(columns(trial.rotation, body), n))
            if is_apart(geo, trial, a, b, n, scratch_out) and is_apart(geo, poses, a, b, back, scratch_out):
                return True
    body = geo.body[a]
    carried = turned(columns(poses.rotation, body), turned_back(columns(trial.rotation, body), n1))
    return is_apart(geo, poses, a, b, carried, scratch_out)


@kernel
def turn_little(poses: Poses, trial: Poses, one: int, other: int) -> bool:
    """Return True if two bodies turn so little against each other in a step that a direction carried by one is a proof.

    Seen from a body that spins, all else moves on arcs: both ends may lie on the same side of it with a wall passed in
    between."""
    trace = 0.0
    for i in range(3):
        for k in range(3):
            now, then = 0.0, 0.0
            for m in range(3):
                now += poses.rotation[one, m, i] * poses.rotation[other, m, k]
                then += trial.rotation[one, m, i] * trial.rotation[other, m, k]
            trace += now * then
    return trace > LEAST_TRACE


@kernel
def accepted_gap(stand_off: float, gap_now: float) -> float:
    """Return the smallest gap [m] accepted at the trial of a pair with this stand-off [m]: `least_gap`, or less if squeezed.

    A squeezed pair may lose half its gap but not below `wedged_gap`, and a pair below that may not come nearer:
    standing still must always be acceptable.
    """
    if gap_now < 2.0 * least_gap(stand_off):
        return max(0.0, max(0.5 * gap_now, min(wedged_gap(stand_off), gap_now - ROUNDING)))
    return least_gap(stand_off)


@kernel
def certify_pair(
    geo: Geometry, poses: Poses, settings: PostureSettings, a: int, b: int, state_out: IkState, scratch_out: IkScratch
) -> tuple[bool, float, Vec3, int]:
    """Return True if pieces a and b hold their certificate. If not: the gap [m] and direction at the trial and the simplex size
    of the query, where a direction separates both ends; else -inf and the direction that separated at the shown state."""
    at, stand_off = slot_of(state_out.pairs, a, b), stand_off_of(geo, settings.stand_off, a, b)
    if cached_axis_holds(geo, poses, at, a, b, least_gap(stand_off), state_out, scratch_out):
        return True, 0.0, (0.0, 0.0, 0.0), 0
    gap0, n0 = shown_direction(geo, poses, at, a, b, state_out, scratch_out)
    least = accepted_gap(stand_off, gap0)
    if cached_axis_holds(geo, poses, at, a, b, least, state_out, scratch_out):
        return True, 0.0, n0, 0
    gap1, n1, simplex = nearest_direction(geo, scratch_out.trial, axis_at(state_out.pairs, at), a, b, EXACT, scratch_out)
    if gap1 > 0.0 and nothing_crossed(geo, poses, a, b, n0, n1, scratch_out):
        if gap1 >= least:
            keep_axis(state_out.pairs, at, n1)
            return True, gap1, n1, simplex
        return False, gap1, n1, simplex
    return False, -inf, n0, simplex
