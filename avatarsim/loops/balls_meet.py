"""Time of impact of two balls: conservative advancement (Mirtich 1996) on centres alone, since their rotation moves no surface.

Also an early out for any two bodies: they cannot meet if their bounding balls do not.
"""

from math import inf

from avatarsim.jit.kernel import kernel
from avatarsim.loops.upper_memory import Memory
from avatarsim.motion.path import STILL
from avatarsim.motion.safe_step import earliest_touch
from avatarsim.motion.time_of_impact import (
    BROKEN,
    CLEAR,
    CREEP,
    DIP,
    DIPPED,
    FAR_OUT,
    IMPACT,
    LEAVING,
    RESTING,
    ROUNDS,
    SPENT,
    STALLED,
    STAND_OFF,
    TOLERANCE,
    TOUCH,
    farthest,
)
from avatarsim.spatial.vec3 import Vec3, along, dot, norm, row, sub


@kernel
def motion_of(memory: Memory, b: int, t: float) -> tuple[Vec3, Vec3, Vec3]:
    """Position, velocity and acceleration of the centre of body b, t seconds along its path."""
    if memory.paths.kind[b] == STILL:
        # a body that stands or was stopped is at the pose of the last trial
        return row(memory.trial.position, b), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    x, v, a = row(memory.began.position, b), row(memory.islands.linear, b), row(memory.paths.linear, b)
    return along(along(x, t, v), 0.5 * t * t, a), along(v, t, a), a


@kernel
def ahead_of(memory: Memory, a: int, b: int, t: float) -> tuple[float, float, float]:
    """Gap [m] of the bounding balls of bodies a and b at t, its rate [m/s] and acceleration [m/s^2] along the line of centres;
    nan or inf if any number is."""
    (x_a, v_a, a_a), (x_b, v_b, a_b) = motion_of(memory, a, t), motion_of(memory, b, t)
    d = sub(x_a, x_b)
    apart = norm(d)
    rate, gain = dot(d, sub(v_a, v_b)) / apart, dot(d, sub(a_a, a_b)) / apart
    return apart - memory.span[a] - memory.span[b], rate, gain


@kernel
def balls_meet(memory: Memory, a: int, b: int, begin: float, h: float) -> tuple[int, float]:
    """First event of two balls on their paths from ``begin`` to h seconds: (outcome, time) as `time_of_impact` has them.

    The separating plane is fixed over a round, so the gap along its normal bounds the true one from below: each round advances to
    the zero of that bound, and two or three find the impact.
    """
    t, target, event = begin, max(STAND_OFF, FAR_OUT * farthest(memory.began, a, b)), IMPACT
    spin = norm(row(memory.islands.angular, a)) + norm(row(memory.islands.angular, b))
    for rounds in range(ROUNDS):
        gap, rate, gain = ahead_of(memory, a, b, t)
        if not (abs(gap) + abs(rate) + abs(gain) + spin < inf):
            return BROKEN, 0.0
        if rounds > 0 and gap <= target + TOLERANCE:
            return event, t
        if rounds == 0 and gap < TOUCH:
            if rate > LEAVING * memory.contacts.pace[0]:
                target = min(target, gap)
            elif rate > RESTING * memory.contacts.pace[0]:
                target, event = min(DIP, gap - CREEP), DIPPED
        step = earliest_touch(gap - target, rate, gain, h - t)
        if t + step >= h:
            return CLEAR, h
        if step < STALLED and rounds > 0:
            return event, t
        t += step
    return SPENT, t


@kernel
def farthest_along(v: float, a: float, h: float) -> float:
    """Farthest distance [m], at least zero, within h seconds at the initial velocity v [m/s] and acceleration a [m/s^2]."""
    most = max(0.0, v * h + 0.5 * a * h * h)
    return max(most, -0.5 * v * v / a) if a < 0.0 < v < -a * h else most


@kernel
def never_meet(memory: Memory, a: int, b: int, h: float) -> bool:
    """Whether bodies a and b stay apart for h seconds, wherever on their paths either of them is stopped.

    The plane between their bounding balls separates them throughout if it does at the farthest that each of them goes towards it.
    """
    (x_a, v_a, a_a), (x_b, v_b, a_b) = motion_of(memory, a, 0.0), motion_of(memory, b, 0.0)
    d = sub(x_a, x_b)
    apart = norm(d)
    gap = apart - memory.span[a] - memory.span[b]
    if not (TOUCH < gap < inf):
        return False
    one = farthest_along(-dot(d, v_a) / apart, -dot(d, a_a) / apart, h)
    return bool(one + farthest_along(dot(d, v_b) / apart, dot(d, a_b) / apart, h) < gap - TOUCH)
