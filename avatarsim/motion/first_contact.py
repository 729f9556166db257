"""Continuous collision detection of two bodies: conservative advancement (Mirtich 1996) with accelerations, as a public query.

The search is that of the upper loop, with tolerances and statuses of its own. A pair of pieces is advanced until its gap has come
down to the stand-off: that is ``time``, never late, without overlap. The search goes on to a thousandth of the stand-off: that is
``contact``, when the surfaces meet, never late but by rounding.
"""

from math import inf, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.motion.free_rotation import STEPS_CAP, TURN, Series
from avatarsim.motion.path import FREE, Paths, move_along
from avatarsim.motion.time_of_impact import (
    BROKEN,
    CLEAR,
    FAR_OUT,
    IMPACT,
    OVERLAPPING,
    ROUNDS,
    SPENT,
    STAND_OFF,
    farthest,
    follow_both,
    margin_of,
    safe_time,
)
from avatarsim.spatial.vec3 import norm, row
from avatarsim.world.geometry import Geometry, Poses

Array = NDArray[np.float64]

ROUNDING, ROUNDING_FAR = 64.0 * 2.220446049250313e-16, 4.0 * 2.220446049250313e-16
"""Parts of size and coordinates below which a gap is rounding: pieces so near touch, and do not overlap."""

CONTACT = 1e-3
"""Part of the stand-off at which the surfaces count as met: 1e-11 s at 2 m/s."""

ACCURACY = 0.1
"""Part of its target by which a search may stop above it."""

RESTORED = 2.0
"""Pieces that started nearer than the stand-off keep all of it again once they have been this many times that far apart."""


class Budget(NamedTuple):
    """What a search may cost and how near it may come: stand-off [m], rounds per pair of pieces and phase."""

    stand_off: float = STAND_OFF
    rounds: int = ROUNDS


class Found(NamedTuple):
    """Result of one search: outcome; time [s] up to which the gap surely holds; contact [s], inf if the surfaces do not meet
    before they part again or the horizon ends; gap at ``time`` [m], nan if unknown; rounds spent; pieces."""

    outcome: int
    time: float
    contact: float
    gap: float
    rounds: int
    piece_a: int
    piece_b: int


@kernel
def tumbles_too_far(angular: Array, paths: Paths, b: int, t: float) -> bool:
    """Whether body b turns farther in t seconds than `tumbled` integrates."""
    return bool(paths.kind[b] == FREE and paths.round[b] == 0 and not (norm(row(angular, b)) * t < TURN * STEPS_CAP))


@kernel
def approach(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, sa: int, sb: int,
    begin: float, h: float, target: float, lowered: bool, stand_off: float, rounding: float, rounds: int, trial: Poses,
    a_rows: Array, b_rows: Array, scratch: Scratch,
) -> tuple[int, float, float, int]:
    """Time >= begin at which the gap of shapes sa and sb has come down to ``target``: (outcome, time, gap, rounds).

    A ``lowered`` target is raised to the stand-off once the gap is RESTORED; until then only half of each safe step is taken,
    so that an arc from touch to touch is not crossed in one. A target below 0 stands for touching; the time is then the last
    one at which they did no more than that.
    """
    a, b = geometry.body[sa], geometry.body[sb]
    t, safe, held, n = begin, begin, inf, (0.0, 0.0, 0.0)
    for spent in range(rounds):
        move_along(geometry, start, linear, angular, paths, series, a, t, trial)
        move_along(geometry, start, linear, angular, paths, series, b, t, trial)
        left = h - t
        margin = margin_of(geometry, paths, reach, a, b, left, stand_off)
        status, gap, n, _, _ = signed_distance_up_to(trial.vertices, geometry.shapes, sa, sb, n, margin, scratch)
        if status == NOT_FINITE or not (margin < inf):
            return BROKEN, 0.0, gap, spent + 1
        if gap > margin:
            return CLEAR, h, gap, spent + 1
        if lowered and gap >= RESTORED * stand_off:
            lowered, target = False, stand_off
        if spent == 0 or gap >= max(target, 0.0) - rounding:
            safe, held = t, gap
        if spent > 0 and gap <= target + ACCURACY * abs(target):
            return IMPACT, safe, held, spent + 1
        count_a, count_b, horizon = follow_both(geometry, angular, paths, reach, sa, sb, n, left, trial, a_rows, b_rows)
        step = safe_time(
            geometry, angular, paths, reach, sa, sb, n, target, left, horizon, trial, a_rows, b_rows, count_a, count_b
        )
        if t + step >= h:
            return CLEAR, h, gap, spent + 1
        if tumbles_too_far(angular, paths, a, t + step) or tumbles_too_far(angular, paths, b, t + step):
            return SPENT, safe, held, spent + 1
        step = 0.5 * step if lowered else step
        if spent > 0 and not (t + step > t):
            return IMPACT if gap <= 2.0 * stand_off else SPENT, safe, held, spent + 1
        t += step
    return SPENT, safe, held, rounds


@kernel
def first_contact_of_pieces(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, sa: int, sb: int,
    h: float, budget: Budget, trial: Poses, a_rows: Array, b_rows: Array, scratch: Scratch,
) -> Found:
    """First contact of shapes sa and sb on the paths of their bodies within h seconds.

    Args:
        start, linear, angular, paths, series, reach, trial, a_rows, b_rows: see `time_of_impact`; ``paths.time`` must not be 0
            or ``trial`` must stand at ``start``.
        budget: the stand-off may be as small as 1e-12 of the coordinates; it is raised to 2e-13 of them.

    Returns:
        CLEAR: no gap as small as the stand-off within h. IMPACT: see `Found`; time is early by at most 1.1 stand-offs / closing
        speed, contact by 1.1e-3 of that. OVERLAPPING at the start: time and contact 0, gap the depth. SPENT: the gap holds up to
        time, nothing is known of what follows (out of rounds, or tumbled by 1000 rad). BROKEN: something is not finite, or h < 0.

        Pieces that start nearer than the stand-off keep half their gap instead; if they touch, only an approach by more than
        rounding is an impact, at 0. Once apart they keep the stand-off.
    """
    a, b = geometry.body[sa], geometry.body[sb]
    if not (isfinite(h) and h >= 0.0 and budget.stand_off > 0.0):
        return Found(BROKEN, 0.0, 0.0, inf, 0, sa, sb)
    far = farthest(start, a, b)
    stand_off = max(budget.stand_off, FAR_OUT * far)
    rounding = ROUNDING * max(geometry.shapes.extent[sa], geometry.shapes.extent[sb]) + ROUNDING_FAR * far
    move_along(geometry, start, linear, angular, paths, series, a, 0.0, trial)
    move_along(geometry, start, linear, angular, paths, series, b, 0.0, trial)
    zero = (0.0, 0.0, 0.0)
    status, gap, _, _, _ = signed_distance_up_to(trial.vertices, geometry.shapes, sa, sb, zero, 2.0 * stand_off, scratch)
    if status == NOT_FINITE:
        return Found(BROKEN, 0.0, 0.0, gap, 1, sa, sb)
    if gap < -rounding:
        return Found(OVERLAPPING, 0.0, 0.0, gap, 1, sa, sb)
    target = stand_off
    if gap < stand_off:
        target = 0.5 * gap if gap > 4.0 * rounding else -4.0 * rounding
    outcome, t, held, rounds = approach(
        geometry, start, linear, angular, paths, series, reach, sa, sb, 0.0, h, target, target < stand_off, stand_off, rounding,
        budget.rounds, trial, a_rows, b_rows, scratch,
    )
    if outcome != IMPACT:
        return Found(outcome, t, inf, held, rounds + 1, sa, sb)
    close = max(CONTACT * stand_off, 2.0 * rounding)
    if not (held > close):
        return Found(outcome, t, t, held, rounds + 1, sa, sb)
    outcome, contact, _, more = approach(
        geometry, start, linear, angular, paths, series, reach, sa, sb, t, h, close, False, close, rounding, budget.rounds, trial,
        a_rows, b_rows, scratch,
    )
    if outcome == CLEAR:
        contact = inf
    return Found(IMPACT, t, contact, held, rounds + more + 1, sa, sb)


@kernel
def first_contact(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, a: int, b: int,
    h: float, budget: Budget, trial: Poses, a_rows: Array, b_rows: Array, scratch: Scratch,
) -> Found:
    """First contact of any piece of body a with any of body b; arguments and result as for pieces.

    The earliest time and the earliest contact may be of different pieces; those named are of the earliest time.
    """
    best, rounds, contact = Found(CLEAR, h, inf, inf, 0, -1, -1), 0, inf
    for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
        for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
            found = first_contact_of_pieces(
                geometry, start, linear, angular, paths, series, reach, sa, sb, min(h, contact), budget, trial, a_rows, b_rows,
                scratch,
            )
            rounds += found.rounds
            if found.outcome == BROKEN or found.outcome == OVERLAPPING:
                return found
            contact = min(contact, found.contact)
            if found.outcome != CLEAR and (best.outcome == CLEAR or found.time < best.time):
                best = found
    return Found(best.outcome, best.time, contact, best.gap, rounds, best.piece_a, best.piece_b)
