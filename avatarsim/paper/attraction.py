"""Exponential attraction of the shown joints to the tracker's: coach and trainee of Schmidl and Lin 2004.

A joint that is d away from the tracker's is d exp(-rate t) away after t seconds, at any frame rate: each frame takes the
share 1 - exp(-rate dt) of the rest, and exp(-rate dt) exp(-rate dt') = exp(-rate (dt + dt')). A tracker that moves at a
constant speed v is followed at the steady distance v dt / (exp(rate dt) - 1), close to v / rate for short frames.

Virtual coupling of the roots (eq. 6 of Schmidl and Lin 2004): spring and damper to the tracker, solved exactly over a frame.

x in m x'' = -K x - R x' is the position of the root relative to the tracker's, and x' its relative velocity: behind a tracker of
constant velocity there is no lag. The orientation of the root has no spring in the paper; it is attracted like a joint.
"""

from math import expm1, inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.equation_6 import coupled
from avatarsim.jit.kernel import kernel
from avatarsim.model.joint_limits import has_cone, inside_cone
from avatarsim.model.skeleton import BALL, FREE, HINGES, Posture, Skeleton
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.tangent import columns, put_columns, step_between, stepped, straightened
from avatarsim.spatial.vec3 import Rows, add, norm, put_row, row, scale, sub
from avatarsim.tolerances import ROUNDING


@kernel
def share_of_distance(rate: float, dt: float) -> float:
    """Return the share 1 - exp(-rate dt) of the distance to the tracker covered in a frame of ``dt`` [s]; ``rate`` >= 0 [1/s]."""
    return -expm1(-rate * dt)


@kernel
def attract(skel: Skeleton, target: Posture, share: float, posture_out: Posture) -> None:
    """Move every joint by ``share`` of its way to ``target``, clipped to the limits; free roots are put at target.root [m].

    Hinges go straight, balls and the orientation of free roots on the great circle. The position of a root (eq. 6) is set by the
    caller.
    """
    for link in range(skel.kind.shape[0]):
        kind = skel.kind[link]
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                low, high, now = skel.limits[j, 0], skel.limits[j, 1], posture_out.angle[j]
                inside = min(max(target.angle[j], low), high)
                posture_out.angle[j] = min(max(now + share * (inside - now), low), high)
            continue
        if kind == FREE:
            put_row(posture_out.root, link, row(target.root, link))
        if kind == FREE or kind == BALL:
            limited = kind == BALL and has_cone(skel.balls, link)
            before, wanted = columns(posture_out.turn, link), columns(target.turn, link)
            if limited:
                wanted = inside_cone(skel.balls, link, wanted)
            turn = straightened(stepped(before, scale(step_between(before, wanted), share)))
            # a great circle between two rotations inside a swing cone may leave it
            put_columns(posture_out.turn, link, inside_cone(skel.balls, link, turn) if limited else turn)


Index = NDArray[np.int64]
Lengths = NDArray[np.float64]

UNDISTURBED = ROUNDING
"""[m] a root displayed this near to where eq. 6 put it keeps the velocity of eq. 6; else it has that of its displayed motion."""


@kernel
def couple_roots(
    kind: Index, tracker: Rows, tracked: Rows, shown: Rows, mass: Lengths, dt: float, coupling: CouplingSettings, couple: int,
    velocity_out: Rows, target_out: Rows,
) -> None:
    """Compute the place of every free root by eq. 6 after ``dt`` seconds, and its velocity there.

    kind (nl) of joints; tracker, tracked (nl, 3) the user's roots now and at the last frame [m]; shown (nl, 3) the roots on
    display; mass (nl) [kg]; velocity (nl, 3) [m/s], read and written; target (nl, 3) [m]. With ``couple`` 0 the root is where
    the user is.
    """
    for link in range(kind.shape[0]):
        if kind[link] != FREE:
            continue
        there, before = row(tracker, link), row(tracked, link)
        if couple == 0 or not (dt > 0.0):
            put_row(target_out, link, there)
            continue
        tracker_velocity = scale(sub(there, before), 1.0 / dt)
        offset, velocity = sub(row(shown, link), before), sub(row(velocity_out, link), tracker_velocity)
        moved, slowed = coupled(mass[link], coupling.spring, coupling.damping, offset, velocity, dt)
        put_row(target_out, link, add(there, moved))
        put_row(velocity_out, link, add(slowed, tracker_velocity))


@kernel
def settle_roots(
    kind: Index, tracker: Rows, target: Rows, before: Rows, shown: Rows, dt: float, velocity_out: Rows, tracked_out: Rows
) -> None:
    """Settle roots after the frame: one that was pushed or walked back has the velocity of its displayed motion, from ``before``
    (nl, 3) to ``shown`` [m]; the user's roots are kept for the next frame."""
    for link in range(kind.shape[0]):
        if kind[link] != FREE or not (dt > 0.0):
            continue
        now, there = row(shown, link), row(tracker, link)
        if not (norm(sub(now, row(target, link))) <= UNDISTURBED):
            put_row(velocity_out, link, scale(sub(now, row(before, link)), 1.0 / dt))
        # a tracker position that is not finite must not be kept
        put_row(tracked_out, link, there if norm(there) < inf else now)
