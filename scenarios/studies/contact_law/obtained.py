"""Restitution and friction that were obtained, from the poses and velocities shown, by one method for every engine.

Only states at the ends of frames are used, which are those of an engine's own steps; the events that it reports are not used.
"""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

JOLT = 20.0
"""Vertical acceleration in one step [m/s^2], beyond gravity's, from which on a contact acts. The drag of an engine's defaults
stays ten times below it; the softest contact (a time constant of 20 ms, at 2 m/s) begins with nearly ten times as much."""
THROUGH = 0.1
"""Depth of the centre below where it touches [m] from which on a body counts as gone through the floor, at half its thickness.
The coarsest step goes 0.074 m deep before its contact is found."""


def first_jolt(speed: Array, gravity: float, dt: float) -> int | None:
    """Return the first state k >= 1 that a contact has changed; None if there is none. `speed` (F,) vertical [m/s]."""
    felt = np.flatnonzero(np.diff(speed) / dt + gravity > JOLT)
    return int(felt[0]) + 1 if len(felt) else None


def restitution(height: Array, speed: Array, gravity: float, dt: float) -> float:
    """Return the speed of leaving over speed of arriving, both at the surface; nan if it never arrived or went through.

    `height` (F,) [m] of the centre above where it is when it touches, `speed` (F,) [m/s] vertical. The last state before the
    contact, inside the floor or above it, gives the energy with which the body crosses the surface; those after it which are
    above and rise give the energy with which it leaves. 0 where none does.
    """
    k = first_jolt(speed, gravity, dt)
    if k is None or not float(np.min(height)) > -THROUGH:
        return math.nan
    arrived = float(speed[k - 1] ** 2 + 2.0 * gravity * height[k - 1])
    risen = (speed[k:] > 0.0) & (height[k:] >= 0.0)
    left = speed[k:][risen] ** 2 + 2.0 * gravity * height[k:][risen]
    return math.sqrt(float(np.max(left, initial=0.0)) / arrived) if arrived > 0.0 else math.nan


def friction(velocity: Array, height: Array, dt: float) -> float:
    """Return the tangential over normal impulse of a body that slides while it is hit; nan if it was not hit or went through.

    `velocity` (F, 3) [m/s] of the centre, without gravity. From the last state before the contact to the first in which it is
    over, or to the end where it lasts. Positive against the first direction of motion. The velocity lost in the last step of
    free flight is drag (PyBullet's default, which grows with the square of the speed) and is taken off for every step since.
    """
    k = first_jolt(velocity[:, 2], 0.0, dt)
    if k is None or k < 2 or not float(np.min(height)) > -THROUGH:
        return math.nan
    rest = np.append(np.abs(np.diff(velocity[:, 2])) / dt, np.inf)
    over = np.flatnonzero((rest[k:] <= JOLT) & (velocity[k:, 2] > 0.0))
    end = k + int(over[0]) if len(over) else len(velocity) - 1
    change = velocity[end] - velocity[k - 1] - (end - k + 1) * (velocity[k - 1] - velocity[k - 2])
    along = velocity[0, :2] / np.linalg.norm(velocity[0, :2])
    return -float(change[:2] @ along) / float(change[2])
