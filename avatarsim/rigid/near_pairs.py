"""Broad phase of simulated bodies: sweep and prune over AABBs that bound the motion to the end of the frame; wakes sleepers."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import sweep_and_prune
from avatarsim.collision.conservative_advancement import STAND_OFF
from avatarsim.collision.grid import SweepMemory
from avatarsim.collision.path import FREE, STILL, Paths
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import PairFilter, may_meet
from avatarsim.spatial.vec3 import dot, norm, row
from avatarsim.tolerances import POSTURE_GAP, SMALL

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

DRIVEN_TOUCH = 2.0 * POSTURE_GAP
"""Gap [m] below which a driven body has contacts, or twice its stand-off if that is more: at a gap below the stand-off it would
never push anything."""

ROOM_TO_TOUCH = 1.25
"""Broad-phase margin of driven bodies, as a multiple of that gap. At 1 rounding would decide whether a pair is near."""

MARGIN, NARROW = ROOM_TO_TOUCH * DRIVEN_TOUCH, 500.0 * STAND_OFF
"""Margin added to every box [m]. Above the gaps at which bodies touch (`TOUCH`, driven ones DRIVEN_TOUCH); smaller: more broad
phases for bodies that tremble; larger: more pairs. In a world without driven bodies and with one smaller than SMALL it falls
with the smallest radius, but is at least NARROW, ten times `TOUCH`: else neighbours ten radii apart form one island."""

PART = MARGIN / SMALL
"""The margin of small bodies, as a part of their radius."""

SMALL_TURN = 0.3
"""Turns below this [rad] grow the box by the arc of the farthest point; larger ones to the whole bounding ball. Either is a
bound: another gives wider boxes, and more pairs."""


def margin_for(span: Array, simulated: Flags, driven: bool) -> float:
    """Return the margin of every box of a world [m]; ``simulated`` (nb) flags such bodies, ``driven``: there is a driven one."""
    if driven or not simulated.any():
        return MARGIN
    return min(MARGIN, max(NARROW, PART * float(span[simulated].min())))


@kernel
def grow(
    hulls: Array, position: Array, span: Array, b: int, v: Array, a: Array, turn: float, t: float, margin: float, boxes_out: Array
) -> None:
    """Grow a box around body b for t seconds with velocity v[b] and constant acceleration a (3), turning by up to ``turn`` [rad].

    ``span`` (nb): largest distance of a point of the body from its centre of mass, radii included [m].
    """
    for k in range(3):
        reach = t * (abs(v[b, k]) + 0.5 * t * abs(a[k])) + margin
        low, high = position[b, k] - span[b], position[b, k] + span[b]
        if turn < SMALL_TURN:
            low, high = max(low, hulls[b, k] - turn * span[b]), min(high, hulls[b, 3 + k] + turn * span[b])
        boxes_out[b, k], boxes_out[b, 3 + k] = low - reach, high + reach


@kernel
def turn_within(w: float, t: float) -> float:
    """Return the bound of the angle [rad] in t seconds of a free body that spins at w [rad/s] now."""
    return w * t / max(0.5, 1.0 - w * t)


@kernel
def promise(
    hulls: Array, position: Array, span: Array, chosen: Index, moving: Index, linear: Array, angular: Array, gravity: Array,
    left: float, margin: float, widens: bool, boxes_out: Array,
) -> None:
    """Make a box of every body of the list that bounds its motion for ``left`` seconds, if nothing hits it; with ``widens`` it
    contains the box of before."""
    for m in range(chosen.shape[0]):
        b = chosen[m]
        before = row(boxes_out, b), (boxes_out[b, 3], boxes_out[b, 4], boxes_out[b, 5])
        if moving[b] == 1:
            turn = turn_within(norm(row(angular, b)), left)
            grow(hulls, position, span, b, linear, gravity, turn, left, margin, boxes_out)
        else:
            for k in range(3):
                boxes_out[b, k], boxes_out[b, 3 + k] = hulls[b, k] - margin, hulls[b, 3 + k] + margin
        if widens:
            for k in range(3):
                boxes_out[b, k] = min(boxes_out[b, k], before[0][k])
                boxes_out[b, 3 + k] = max(boxes_out[b, 3 + k], before[1][k])


@kernel
def keeps_promise(
    hulls: Array, position: Array, span: Array, b: int, linear: Array, angular: Array, paths: Paths, t: float, margin: float,
    boxes: Array,
) -> bool:
    """Return True if the path of body b stays in its motion bound for t seconds."""
    if paths.kind[b] == STILL:
        return True
    w = norm(row(angular, b))
    turn = turn_within(w, t) if paths.kind[b] == FREE else t * (w + 0.5 * t * norm(row(paths.angular, b)))
    for k in range(3):
        reach = t * (abs(linear[b, k]) + 0.5 * t * abs(paths.linear[b, k])) + 0.5 * margin
        low, high = position[b, k] - span[b], position[b, k] + span[b]
        if turn < SMALL_TURN:
            low, high = max(low, hulls[b, k] - turn * span[b]), min(high, hulls[b, 3 + k] + turn * span[b])
        # half of the margin is left for the gap at which contacts are found
        if not (low - reach >= boxes[b, k] and high + reach <= boxes[b, 3 + k]):
            return False
    return True


@kernel
def near_pairs(
    hulls: Array, position: Array, span: Array, chosen: Index, moving: Index, asleep: Index, linear: Array, angular: Array,
    gravity: Array, left: float, margin: float, widens: bool, wanted: PairFilter, boxes: Array, sweep: SweepMemory, pairs: Index,
) -> tuple[int, int]:
    """Find near pairs by sweep and prune over the motion bounds, anew for the listed bodies; wake sleepers near moving bodies.

    Returns (status of the broad phase, number of pairs).
    """
    promise(hulls, position, span, chosen, moving, linear, angular, gravity, left, margin, widens, boxes)
    while True:
        status, count = sweep_and_prune(boxes, wanted, sweep, pairs)
        woken = 0
        for p in range(min(count, pairs.shape[0])):
            i, k = pairs[p, 0], pairs[p, 1]
            for sleeper, other in ((i, k), (k, i)):
                if asleep[sleeper] == 1 and moving[other] == 1:
                    asleep[sleeper], moving[sleeper] = 0, 1
                    grow(hulls, position, span, sleeper, linear, gravity, 0.0, left, margin, boxes)
                    woken += 1
        if woken == 0:
            return status, count


@kernel
def boxes_near(a: Array, b: Array, i: int, k: int, margin: float) -> bool:
    """Return True if box a[i] comes within the margin of box b[k]."""
    for x in range(3):
        if a[i, x] - margin > b[k, 3 + x] or b[k, x] - margin > a[i, 3 + x]:
            return False
    return True


@kernel
def wake_near(old: Array, new: Array, b: int, margin: float, wanted: PairFilter, asleep: Index, moving: Index) -> None:
    """Wake the bodies that sleep near body b, which was moved: near where it was (hulls ``old``) or where it is (``new``)."""
    for s in range(asleep.shape[0]):
        is_near = asleep[s] == 1 and s != b and (boxes_near(old, new, b, s, margin) or boxes_near(new, new, b, s, margin))
        if is_near and may_meet(wanted, s, b):
            asleep[s], moving[s] = 0, 1


@kernel
def is_still(linear: Array, angular: Array, b: int) -> bool:
    """Return True if both velocities of body b are exactly zero."""
    v, w = row(linear, b), row(angular, b)
    return dot(v, v) + dot(w, w) == 0.0
