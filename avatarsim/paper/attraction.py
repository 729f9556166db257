"""Exponential attraction of the shown joints to the tracker's: coach and trainee of Schmidl and Lin 2004.

A joint that is d away from the tracker's is d exp(-rate t) away after t seconds, at any frame rate: each frame takes the
share 1 - exp(-rate dt) of what is left, and exp(-rate dt) exp(-rate dt') = exp(-rate (dt + dt')). A tracker that moves at a
constant speed v is followed at the steady distance v dt / (exp(rate dt) - 1), close to v / rate for short frames.
"""

from math import expm1

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import columns, put_columns, step_between, stepped, straightened
from avatarsim.spatial.vec3 import put_row, row, scale
from avatarsim.world.limits import has_cone, inside_cone
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def share_of_way(rate: float, dt: float) -> float:
    """Share 1 - exp(-rate dt) of the way to the tracker that a frame of ``dt`` seconds takes; ``rate`` >= 0 [1/s]."""
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
            limited = kind == BALL and has_cone(skel, link)
            before, wanted = columns(posture_out.turn, link), columns(target.turn, link)
            if limited:
                wanted = inside_cone(skel, link, wanted)
            turn = straightened(stepped(before, scale(step_between(before, wanted), share)))
            # a great circle between two rotations inside a swing cone may leave it
            put_columns(posture_out.turn, link, inside_cone(skel, link, turn) if limited else turn)
