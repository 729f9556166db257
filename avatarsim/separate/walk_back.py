"""Walk back (Schmidl and Lin 2004, Algorithm 1, step 4): interpolation to the last checked state, and its bisection."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import columns, put_columns, step_between, stepped, straightened
from avatarsim.spatial.vec3 import along, put_row, row, scale, sub
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def interpolate(
    skel: Skeleton, checked: Posture, present: Posture, fraction: float, chosen: NDArray[np.bool_], posture_out: Posture
) -> None:
    """Posture between ``checked`` (fraction 0) and ``present`` (1) in the ``chosen`` (nl) links; the others are ``present``.

    Hinges and root positions on the straight line, balls and orientations of roots on the great circle. At fraction 0 and 1
    the bits are those of the ends: 0 holds even when the present posture is not a number.
    """
    for link in range(skel.kind.shape[0]):
        kind, f = skel.kind[link], fraction if chosen[link] else 1.0
        between = 0.0 < f < 1.0
        end_root, end_turn, end_angle = present.root, present.turn, present.angle
        if f <= 0.0:
            end_root, end_turn, end_angle = checked.root, checked.turn, checked.angle
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = end_angle[j]
                if between:
                    posture_out.angle[j] = checked.angle[j] + f * (present.angle[j] - checked.angle[j])
        if kind == FREE:
            start, end = row(checked.root, link), row(end_root, link)
            put_row(posture_out.root, link, along(start, f, sub(end, start)) if between else end)
        if kind == FREE or kind == BALL:
            turn = columns(end_turn, link)
            if between:
                first = columns(checked.turn, link)
                turn = straightened(stepped(first, scale(step_between(first, turn), f)))
            put_columns(posture_out.turn, link, turn)


@kernel
def narrowed(low: float, high: float, is_free: bool) -> tuple[float, float]:
    """One bisection: the half interval whose lower end is free and whose upper end is not, after its middle was tested."""
    middle = 0.5 * (low + high)
    return (middle, high) if is_free else (low, middle)
