"""Time of impact by conservative advancement (Mirtich 1996) with exact accelerations: a lower bound, exact to the tolerance.

In each round a plane that touches one shape turns with its body, and the height of every vertex of the other over that plane is
bounded from below: velocity and acceleration are exact, the jerk is bounded. While all heights are positive the shapes are apart.
Without rotation the bound is the motion itself and two or three rounds find the impact.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.edge_edge import edge_step, edges_apart
from avatarsim.collision.motion_bounds import follow, follow_ball, follow_centres, longest_horizon, longest_safe_step, turning
from avatarsim.collision.path import HELD, STILL, Paths, Series, acceleration, move_along, spinning
from avatarsim.collision.scratch import Scratch
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.spatial.vec3 import Vec3, neg, norm, row, sub
from avatarsim.tolerances import EPSILON, FINE, JUDGED, PROOF

Array = NDArray[np.float64]

STAND_OFF = 2e-8
"""Gap [m] at which bodies stop, meet and rest, so that they never overlap by rounding. The first apex of a bounce of height h is
off by 2e-8/h; must stay above about a hundred roundings of a coordinate."""

FAR_OUT = 1e3 * EPSILON
"""The stand-off is at least this part of the coordinates, or rounding would swallow it (beyond 90 km from the origin)."""

TOLERANCE = FINE * STAND_OFF
"""Accuracy [m] of the gap found: above rounding."""

DIP = -0.25 * JUDGED
"""Depth [m] to which bodies that rest or roll on each other may dip before that is an event. Nearer to 0: a hundred segments a
frame for rocking boxes; lower: overlap that one can measure, the promise being JUDGED."""

CREEP = 2.0 * TOLERANCE
"""Further depth [m] to which a pair that has dipped already may go before the next event. Above the tolerance, else such a pair
has an event at once, again and again; resting forces lift it in the meantime."""

TOUCH = JUDGED
"""Gap [m] below which a pair counts as touching at the start of its path: more could be seen."""

LEAVING = 1e-4
"""Normal velocity [m/s] above which a touching pair separates; below it rests or rolls. Larger: a body that flies off is followed
as if it touched, and may dip; smaller: resting pairs that tremble have events. The other slow speeds are multiples of it."""

LIFT = 2.0 * LEAVING
"""Speed [m/s] at which a dip is lifted, if the body has the energy for it (`can_pay`): within 3 ms, and a flight of 2e-9 m at its
end. Lifting by position projection instead would feed rocking bodies with potential energy, and they would never rest."""

LIFTED = 2.5 * LIFT
"""LEAVING of a pair that has dipped [m/s], which forces lift again, by less than this. As a separating one, a rolling egg that
rises by less than the tolerance until its next bound would have an event then, a hundred times a frame."""

RESTING = -3.0 * LIFTED
"""Normal velocity [m/s] down to which a touching pair rests or rolls; below it collides. The slowest rebound is as fast, and so
must be above LIFTED, from which on a contact gets no force."""

assert -JUDGED < DIP < 0.0 < TOLERANCE < CREEP < STAND_OFF < TOUCH
assert 0.0 < LEAVING < LIFT < LIFTED < -RESTING

ROUNDS = 200
"""Advancement rounds per pair; spheres need 3, tumbling boxes 5 to 20. If spent, the last safe time is the event."""

UNKNOWN = 0.0
"""Depth of a pair that is not known to be at an internal edge (`rigid.internal_edges`)."""

STALLED = PROOF / 1e3
"""Advancement has stalled at a safe step shorter than this [s]: at 1 km/s that is a tenth of a nanometre, PROOF."""

CLEAR, IMPACT, DIPPED, BROKEN, SPENT, OVERLAPPING = range(6)
"""Outcome: no event before the horizon; two bodies met; resting bodies came too close; a pose or velocity is not finite; the
budget of rounds is spent; they overlapped from the start (never an outcome of ``time_of_impact``, which lets them part)."""


@kernel
def slowest_touch(rows: Array, count: int) -> float:
    """Return the least velocity [m/s] over the plane of the vertices that touch it; inf if none does."""
    slowest = inf
    for i in range(count):
        if rows[i, 0] < TOUCH:
            slowest = min(slowest, rows[i, 1])
    return slowest


@kernel
def reach_of(geometry: Geometry, paths: Paths, reach: Array, b: int, h: float) -> float:
    """Return a bound of the motion [m] of any point of body b in h seconds; ``reach`` (nb): largest radius about the centre."""
    if paths.kind[b] == STILL:
        return 0.0
    move = h * (norm(row(paths.v, b)) + 0.5 * h * norm(row(paths.linear, b)))
    speed = norm(row(paths.w, b)) + (h * norm(row(paths.angular, b)) if paths.kind[b] == HELD else 0.0)
    # a free body may spin faster later, but no point goes farther than across the body
    turn = 2.0 if paths.kind[b] != HELD and paths.round[b] == 0 and speed > 0.0 else min(2.0, speed * h)
    return float(move + turn * reach[b])


@kernel
def farthest(start: Poses, a: int, b: int) -> float:
    """Return the largest coordinate of two bodies [m]."""
    far = 0.0
    for i in range(3):
        far = max(far, abs(start.position[a, i]), abs(start.position[b, i]))
    return far


@kernel
def margin_of(geometry: Geometry, paths: Paths, reach: Array, a: int, b: int, left: float, stand_off: float) -> float:
    """Return the gap [m] beyond which two bodies cannot meet in ``left`` seconds; nan or inf if a velocity is."""
    margin = reach_of(geometry, paths, reach, a, left) + reach_of(geometry, paths, reach, b, left) + 2.0 * stand_off
    # the minimum in `reach_of` may hide a velocity that is not finite
    return margin + 0.0 * (norm(row(paths.w, a)) + norm(row(paths.w, b)))


@kernel
def follow_both(
    geometry: Geometry, angular: Array, paths: Paths, reach: Array, sa: int, sb: int, n: Vec3, left: float, trial: Poses,
    a_rows: Array, b_rows: Array,
) -> tuple[int, int, float]:
    """Fill both shapes' rows (see ``follow``); return their numbers and the horizon over which their bounds hold."""
    a, b = geometry.body[sa], geometry.body[sb]
    horizon = min(left, longest_horizon(geometry, paths, sa), longest_horizon(geometry, paths, sb))
    ball_a, ball_b = reach[a] == 0.0, reach[b] == 0.0
    most_a, most_b = turning(paths, a, ball_a, horizon), turning(paths, b, ball_b, horizon)
    spin_a, twist_a = spinning(paths, angular, trial.rotation, a)
    spin_b, twist_b = spinning(paths, angular, trial.rotation, b)
    if ball_a:
        spin_a, twist_a = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if ball_b:
        spin_b, twist_b = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    count_a = follow(
        geometry, trial, paths, sa, sb, spin_a, twist_a, spin_b, twist_b, most_a, most_b, horizon, n, a_rows
    )
    count_b = follow(
        geometry, trial, paths, sb, sa, spin_b, twist_b, spin_a, twist_a, most_b, most_a, horizon, neg(n), b_rows
    )
    return count_a, count_b, horizon


@kernel
def safe_time(
    geometry: Geometry, angular: Array, paths: Paths, reach: Array, sa: int, sb: int, n: Vec3, target: float, left: float,
    horizon: float, trial: Poses, a_rows: Array, b_rows: Array, count_a: int, count_b: int,
) -> float:
    """Return a time <= left during which the gap of the shapes stays above ``target``: the longest of the steps proved by a plane
    that turns with B, by one that turns with A, and, for bodies that turn, by their bounding balls. The rows are overwritten."""
    a, b = geometry.body[sa], geometry.body[sb]
    ball_a, ball_b = reach[a] == 0.0, reach[b] == 0.0
    step = longest_safe_step(a_rows, count_a, paths, a, b, ball_a, ball_b, target, horizon)
    if step < horizon:
        step = max(step, longest_safe_step(b_rows, count_b, paths, b, a, ball_b, ball_a, target, horizon))
    if step >= left:
        return left
    radius_a, radius_b = reach[a] + geometry.shapes.radius[sa], reach[b] + geometry.shapes.radius[sb]
    turns_a, turns_b = norm(row(paths.w, a)) * reach[a] > 0.0, norm(row(paths.w, b)) * reach[b] > 0.0
    if turns_a:
        spin, twist = spinning(paths, angular, trial.rotation, b)
        if ball_b:
            spin, twist = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        follow_ball(geometry, trial, paths, radius_a, a, sb, spin, twist, n, a_rows)
        if a_rows[0, 0] > target:
            h = min(left, longest_horizon(geometry, paths, sb))
            step = max(step, longest_safe_step(a_rows, 1, paths, a, b, True, ball_b, target, h))
    if turns_b:
        spin, twist = spinning(paths, angular, trial.rotation, a)
        if ball_a:
            spin, twist = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        follow_ball(geometry, trial, paths, radius_b, b, sa, spin, twist, neg(n), b_rows)
        if b_rows[0, 0] > target:
            h = min(left, longest_horizon(geometry, paths, sa))
            step = max(step, longest_safe_step(b_rows, 1, paths, b, a, True, ball_a, target, h))
    if turns_a and turns_b:
        follow_centres(geometry, trial, paths, radius_a + radius_b, a, b, a_rows)
        if a_rows[0, 0] > target:
            step = max(step, longest_safe_step(a_rows, 1, paths, a, b, True, True, target, left))
    return step


@kernel
def slowest_edge(
    geometry: Geometry, angular: Array, paths: Paths, sa: int, sb: int, n: Vec3, on_a: Vec3, on_b: Vec3, trial: Poses,
    edges: Array,
) -> float:
    """Return the separation velocity [m/s] of two edges that face each other; -inf if the closest features are no such edges."""
    a, b = geometry.body[sa], geometry.body[sb]
    spin_a, twist_a = spinning(paths, angular, trial.rotation, a)
    spin_b, twist_b = spinning(paths, angular, trial.rotation, b)
    if not edges_apart(geometry, trial, paths, sa, sb, n, on_a, on_b, spin_a, twist_a, spin_b, twist_b, edges):
        return -inf
    return float(edges[0, 1] / edges[0, 3])


@kernel
def edge_time(
    geometry: Geometry, angular: Array, paths: Paths, sa: int, sb: int, n: Vec3, on_a: Vec3, on_b: Vec3, target: float,
    left: float, trial: Poses, edges: Array,
) -> float:
    """Return `safe_time` by the plane along two edges that face each other; 0 if the closest features are no such edges."""
    a, b = geometry.body[sa], geometry.body[sb]
    spin_a, twist_a = spinning(paths, angular, trial.rotation, a)
    spin_b, twist_b = spinning(paths, angular, trial.rotation, b)
    if not edges_apart(geometry, trial, paths, sa, sb, n, on_a, on_b, spin_a, twist_a, spin_b, twist_b, edges):
        return 0.0
    slide = norm(sub(acceleration(paths, a), acceleration(paths, b)))
    return edge_step(paths, a, b, norm(sub(spin_a, spin_b)), slide, edges, target, left)


@kernel
def time_of_impact(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, sa: int, sb: int,
    begin: float, h: float, depth: float, pace: float, trial: Poses, a_rows: Array, b_rows: Array, edges: Array,
    scratch: Scratch,
) -> tuple[int, float, int]:
    """Return the first event of shapes sa and sb on the paths of their bodies from ``begin`` to h seconds, for the upper loop.

    Args:
        start, linear, angular: poses and velocities at the start of the segment.
        reach: (nb) largest distance of a body's points from its centre of mass, rounding radii left out [m].
        depth: the gap [m] < 0 at which they have an event if they are known to be at an internal edge; else UNKNOWN.
        pace: factor on LEAVING and RESTING.
        trial: poses, overwritten. a_rows, b_rows: (most vertices of a shape, 6), edges: (2, 6) working memory.

    Returns:
        (CLEAR, h), or (IMPACT, t) when the gap came down to the stand-off, or (DIPPED, t) when a resting pair reached DIP, or
        (BROKEN, 0), or (SPENT, t) when the budget of rounds is; and the rounds begun. Up to t the gap is never below its target.
    """
    a, b = geometry.body[sa], geometry.body[sb]
    t, n = begin, (0.0, 0.0, 0.0)
    stand_off = max(STAND_OFF, FAR_OUT * farthest(start, a, b))
    target, event = (stand_off, IMPACT) if depth == UNKNOWN else (depth, DIPPED)
    for rounds in range(ROUNDS):
        move_along(geometry, start, linear, angular, paths, series, a, t, trial)
        move_along(geometry, start, linear, angular, paths, series, b, t, trial)
        left = h - t
        margin = margin_of(geometry, paths, reach, a, b, left, stand_off)
        status, gap, n, on_a, on_b = signed_distance_up_to(trial.vertices, geometry.shapes, sa, sb, n, margin, scratch)
        if status == NOT_FINITE or not (margin < inf):
            return BROKEN, 0.0, rounds + 1
        if gap > margin:
            return CLEAR, h, rounds + 1
        if rounds > 0 and gap <= target + TOLERANCE:
            return event, t, rounds + 1
        count_a, count_b, horizon = follow_both(geometry, angular, paths, reach, sa, sb, n, left, trial, a_rows, b_rows)
        if rounds == 0 and gap < TOUCH and depth == UNKNOWN:
            slowest = max(slowest_touch(a_rows, count_a), slowest_touch(b_rows, count_b))
            if slowest <= RESTING * pace:
                slowest = max(slowest, slowest_edge(geometry, angular, paths, sa, sb, n, on_a, on_b, trial, edges))
            if slowest > (LEAVING if gap >= 0.0 else LIFTED) * pace:
                target = min(stand_off, gap)
            elif slowest > RESTING * pace:
                target, event = min(DIP, gap - CREEP), DIPPED
        step = safe_time(
            geometry, angular, paths, reach, sa, sb, n, target, left, horizon, trial, a_rows, b_rows, count_a, count_b
        )
        if step < left and (rounds > 0 or gap < TOUCH):
            step = max(step, edge_time(geometry, angular, paths, sa, sb, n, on_a, on_b, target, left, trial, edges))
        if t + step >= h:
            return CLEAR, h, rounds + 1
        if step < STALLED and rounds > 0:
            return event, t, rounds + 1
        t += step
    return SPENT, t, ROUNDS
