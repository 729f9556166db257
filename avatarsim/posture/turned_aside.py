"""What does it cost an avatar without joints to be turned away from its user?

With turn_weight angle^2 / 2 alone a hand tilts by tenths of a degree for tenths of a millimetre on whatever it lies on, and
pressed against a wall it folds. So the angle's square q [rad^2] is weighed as

    q (1 + (q / ASIDE^2)^2 / 3) + STRAIGHT SLIGHT^2 q / (SLIGHT^2 + q):

a hand does not turn for nothing, turns where that brings it much nearer, and not without end.
"""

from avatarsim.kernel import kernel

ASIDE = 2.0
"""Angle [rad] at which a radian more weighs twice what it does before. 1.35: behind a thin wall a hand's place is 7 %
farther from the user's; infinite: there it folds so far that in two of eight seeds it is late where the way is free again."""

STRAIGHT, SLIGHT = 10.0, 0.02
"""How much more the first angles weigh than those that follow, and the angle [rad] at which three quarters of that are gone. 0: a
palm that pushes a box turns by a tenth of a degree with it, here by 0.009."""


@kernel
def cost(square: float) -> float:
    """What the squared angle [rad^2] counts as: the head of this file."""
    slight, far = SLIGHT * SLIGHT, square / (ASIDE * ASIDE)
    return square * (1.0 + far * far / 3.0) + STRAIGHT * slight * square / (slight + square)


@kernel
def rise(square: float) -> float:
    """Slope of `cost` in the squared angle: what the angle pulls with, in units of its square alone."""
    near, far = 1.0 + square / (SLIGHT * SLIGHT), square / (ASIDE * ASIDE)
    return 1.0 + far * far + STRAIGHT / (near * near)


@kernel
def bent(square: float) -> float:
    """Second derivative of half of `cost` in the angle, without what bends it down: that would make steps too long."""
    far = square / (ASIDE * ASIDE)
    return rise(square) + 4.0 * far * far
