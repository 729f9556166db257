"""Limits of speed and acceleration of the degrees of freedom: which steps of a call keep them, and which one is wanted.

A group of degrees has one limit of its norm: a hinge by itself, the translation of a root, the rotation of a root or a ball. A
step y [rad, m] of a group keeps the limits where |y| <= most and |y - y0| <= change, y0 the step of the call before. Both sets
are convex, and so is their intersection: a step between two that keep the limits keeps them too.

The uniform braking from a step y takes all degrees to rest by one factor: y (1 - 1/n), y (1 - 2/n), ..., 0, where n is the number
of calls that the degree needs that brakes longest. The step and the braking after it together go (n + 1) / 2 times y.
"""

from math import ceil, inf, pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.make import empty_posture, make_solver
from avatarsim.ik.state import Avatars, IkScratch, PairCache, Rig, Tracking
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Line
from avatarsim.model.skeleton import BALL, FREE, Posture, Skeleton
from avatarsim.model.world import World
from avatarsim.tolerances import JUDGED, PROOF

Array = NDArray[np.float64]
Index = NDArray[np.int64]

KEPT = 1.0 - JUDGED
"""Share of a limit that is used. Closer to 1: speeds that are measured on rounded postures, at rates of 1/ms, pass the limit by
rounding; less: the avatar is slower than it may be."""

WIDEST_TURN = 0.9 * pi
"""[rad] by which a root or ball may turn until it is at rest: the way between two rotations is unique below half a turn."""

REACHED = 60.0
"""[s] of full acceleration after which a limit of speed counts as none when degrees are weighed: files state 1e4 rad/s where they
mean none. Longer: such a joint yields to all near pairs alone; shorter: joints that accelerate slowly yield like fast ones."""

EASE = 0.5
"""Share of the acceleration limit that catching up with the target plans its braking with. More: the target's motion meanwhile,
and obstacles, leave it too little, and it overshoots; less: it catches up later."""


class Braking(NamedTuple):
    """Working memory and state of steps within limits, of one avatar with nd degrees in ng groups.

    first, last      (ng) degrees first .. last - 1 are a group
    most, change     (ng) largest step of a call [rad, m], and largest change of it from one call to the next; infinite: no limit
    turning          (ng) 1 for rotations of a root or a ball
    cap              (ng) largest step of the candidate that is looked for
    avatars, scratch, tracking of the posture solver; the metric in `scratch` is diagonal and stays
    pairs            nearest directions of near pairs, for the next query
    shown            the posture of the last call; step (nd) the step to it; calls (1) that the braking from there takes
    target, incoming posture requested in the last call and in this one, within limits of joints
    error, wanted    (nd) way to the incoming posture, and the step that is wanted
    brake, trial     (nd) step of the braking, and the candidate
    """

    first: IndexLine
    last: IndexLine
    most: Line
    change: Line
    turning: IndexLine
    cap: Line
    avatars: Avatars
    scratch: IkScratch
    tracking: Tracking
    pairs: PairCache
    shown: Posture
    step: Line
    calls: IndexLine
    target: Posture
    incoming: Posture
    error: Line
    wanted: Line
    brake: Line
    trial: Line


def degree_groups(skel: Skeleton) -> list[tuple[int, int, int, bool]]:
    """Return groups of degrees: first, one behind the last, link, and whether it is a rotation of three degrees."""
    found: list[tuple[int, int, int, bool]] = []
    for link, kind in enumerate(skel.kind.tolist()):
        first, last = int(skel.first_dof[link]), int(skel.first_dof[link + 1])
        if kind == FREE:
            found += [(first, first + 3, link, False), (first + 3, last, link, True)]
        elif kind == BALL:
            found.append((first, last, link, True))
        else:
            found += [(j, j + 1, link, False) for j in range(first, last)]
    return found


def make_braking(world: World, speed: Array, acceleration: Array, dt: float) -> Braking:
    """Return the state of an avatar at rest with limits of `speed` (ng) [rad/s, m/s] and `acceleration` (ng) of its groups, for
    calls of dt [s]."""
    geo, skel = world.geometry, world.skeleton
    nl, nd = len(skel.kind), int(skel.first_dof[-1])
    groups = degree_groups(skel)
    first, last = (np.array([one[k] for one in groups], dtype=np.int64) for k in (0, 1))
    turning = np.array([one[3] for one in groups], dtype=np.int64)
    most, change = KEPT * speed * dt, KEPT * acceleration * dt * dt
    most = np.where(turning == 1, np.minimum(most, WIDEST_TURN), most)
    avatars, state, scratch = make_solver(geo, skel, world.posture, world.poses)
    scratch.is_active[:] = 1
    # the metric: a degree yields by its share of its largest step; where none has one, a radian counts as a metre
    is_reached = np.isfinite(most) & (most * dt <= REACHED * change)
    scale = np.where(is_reached, most, most[is_reached].max(initial=0.0) or 1.0)
    for group, size in zip(groups, scale / max(scale.max(initial=0.0), PROOF), strict=True):
        for j in range(group[0], group[1]):
            scratch.objective.factor[j, avatars.depth[j]] = 1.0 / size
    postures = [empty_posture(nl, nd) for _ in range(3)]
    lines = [np.zeros(nd) for _ in range(5)]
    return Braking(
        first, last, most, change, turning, most.copy(), avatars, scratch,
        state.tracking, state.pairs, postures[0], lines[0], np.zeros(1, dtype=np.int64), postures[1], postures[2],
        *lines[1:],
    )


@kernel
def length_of(values: Line, first: int, last: int) -> float:
    """Return the norm of degrees first .. last - 1."""
    square = 0.0
    if last == first + 1:
        return float(abs(values[first]))
    for j in range(first, last):
        square += values[j] * values[j]
    return sqrt(square)


@kernel
def calls_to_rest(braking: Braking, step: Line) -> int:
    """Return calls that the uniform braking from a step takes; 0 at rest."""
    b, longest, is_moving = braking, 0.0, False
    for g in range(b.first.shape[0]):
        size = length_of(step, b.first[g], b.last[g])
        is_moving = is_moving or size > 0.0
        longest = max(longest, size / b.change[g])
    return max(1, int(ceil(longest - PROOF))) if is_moving else 0


@kernel
def steps_to_rest(calls: int) -> float:
    """Return the way of a step and of the braking after it, in steps."""
    return max(1.0, 0.5 * (calls + 1.0))


@kernel
def most_calls_to_rest(braking: Braking) -> int:
    """Return calls that the braking takes from any step that the next call may take."""
    b, longest = braking, 1.0
    for g in range(b.first.shape[0]):
        if b.change[g] < inf:
            longest = max(longest, b.most[g] / b.change[g])
    return int(ceil(min(b.calls[0] + 1.0, longest)))


@kernel
def set_caps(calls: int, braking_out: Braking) -> float:
    """Limit the candidate to one that takes at most so many calls to rest; return its way then, in steps."""
    b = braking_out
    for g in range(b.first.shape[0]):
        b.cap[g] = min(b.most[g], calls * b.change[g])
    return steps_to_rest(calls)


@kernel
def set_brake(braking_out: Braking) -> None:
    """Set the step of the braking in this call."""
    b = braking_out
    left = 1.0 - 1.0 / b.calls[0] if b.calls[0] > 1 else 0.0
    for j in range(b.brake.shape[0]):
        b.brake[j] = left * b.step[j]


@kernel
def share_inside(point: Line, other: Line, centre: Line, is_centred: bool, radius: float, first: int, last: int) -> float:
    """Return the share, at most 1, of the step from a point in a ball of degrees first .. last - 1 to `other`, which is in it;
    the ball is about `centre`, or about zero."""
    along, across, rest = 0.0, 0.0, -radius * radius
    for j in range(first, last):
        step, from_centre = other[j] - point[j], point[j] - (centre[j] if is_centred else 0.0)
        along += step * step
        across += step * from_centre
        rest += from_centre * from_centre
    if not (along > 0.0):
        return 1.0
    return min(1.0, max(0.0, (sqrt(max(0.0, across * across - along * min(0.0, rest))) - across) / along))


@kernel
def keep_limits(braking: Braking, step_out: Line) -> None:
    """Bring a step within the limits: a single degree to the nearest value, a group of three towards the braking."""
    b = braking
    for g in range(b.first.shape[0]):
        first, last, most, change = b.first[g], b.last[g], b.cap[g], b.change[g]
        if last == first + 1:
            low, high = max(-most, b.step[first] - change), min(most, b.step[first] + change)
            step_out[first] = min(max(step_out[first], low), high)
            continue
        share = 1.0
        if most < inf:
            share = share_inside(b.brake, step_out, b.step, False, most, first, last)
        if change < inf:
            share = min(share, share_inside(b.brake, step_out, b.step, True, change, first, last))
        for j in range(first, last):
            step_out[j] = b.brake[j] + share * (step_out[j] - b.brake[j])


@kernel
def caught_up(lag: float, change: float) -> float:
    """Return the step to a target at rest `lag` away: all of it, or as much as can be braked in time, in calls, by EASE of the
    largest change."""
    if not (change < inf):
        return lag
    ease = EASE * change
    return min(lag, sqrt(0.25 * ease * ease + 2.0 * ease * lag) - 0.5 * ease)


@kernel
def choose_wanted(rig: Rig, braking_out: Braking) -> None:
    """Set the wanted step: the target's own since the last call, and a part that catches up with it; within limits."""
    b = braking_out
    tangent_error(rig, 0, b.shown, b.incoming, b.error)
    tangent_error(rig, 0, b.shown, b.target, b.wanted)
    for g in range(b.first.shape[0]):
        first, last, square = b.first[g], b.last[g], 0.0
        lag = length_of(b.wanted, first, last)
        share = caught_up(lag, b.change[g]) / lag if lag > 0.0 else 1.0
        for j in range(first, last):
            square += (b.error[j] - b.wanted[j]) * (b.error[j] - b.wanted[j])
        own = sqrt(square)
        cut = b.most[g] / own if own > b.most[g] else 1.0
        for j in range(first, last):
            if cut == 1.0 and share == 1.0:
                b.wanted[j] = b.error[j]
            else:
                b.wanted[j] = cut * (b.error[j] - b.wanted[j]) + share * b.wanted[j]
    keep_limits(b, b.wanted)


@kernel
def set_bounds(skel: Skeleton, steps: float, braking_out: Braking) -> None:
    """Set bounds of every degree by the limits, and so that after so many such steps a hinge is within its range, if possible."""
    b, s = braking_out, braking_out.scratch
    for g in range(b.first.shape[0]):
        most, change = b.cap[g], b.change[g]
        for j in range(b.first[g], b.last[g]):
            s.low[j], s.high[j] = max(-most, b.step[j] - change), min(most, b.step[j] + change)
        if b.last[g] == b.first[g] + 1:
            j = b.first[g]
            below, above = b.shown.angle[j] - skel.limits[j, 0], skel.limits[j, 1] - b.shown.angle[j]
            s.high[j] = max(b.step[j] - change, min(s.high[j], max(0.0, above) / steps))
            s.low[j] = min(b.step[j] + change, max(s.low[j], -max(0.0, below) / steps))
