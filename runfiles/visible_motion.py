"""Motion that a viewer sees: least speeds and distances, reversals and shaking of link origins."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
STILL = 6e-3
"""Speed [m/s] up to which a body or link counts as resting over a frame: 0.1 mm in a sixtieth of a second. Ten times less, and
contacts that give way by design would never rest; ten times more, and a slow hand would."""
SHAKES = 0.18
"""Speed [m/s] from which a displacement that reverses is seen: 3 mm in a frame of 60 Hz. Lower, and a screen does not show it."""
WINDOW, ENOUGH = 4, 3
"""A link shakes in a frame if it reversed in so many (ENOUGH) of the last WINDOW frames: one bounce off a wall is no shaking."""
FAR = 0.1
"""Distance [m] of a link origin from its target's from which an avatar is elsewhere."""


def reversals(shown: Array, target: Array) -> Array:
    """Return the smaller [m] (F, L) of the displacements of link origins (F+1, L, 3) in this frame and the last one, where they
    point against each other and the target's do not; 0 elsewhere, nan where a place is no number."""
    smaller = np.zeros(shown[1:].shape[:-1])
    step, wanted = np.diff(shown, axis=0), np.diff(target, axis=0)
    back = ~((step[1:] * step[:-1]).sum(axis=-1) >= 0.0) & ~((wanted[1:] * wanted[:-1]).sum(axis=-1) < 0.0)
    length = np.linalg.norm(step, axis=-1)
    smaller[1:] = np.where(back, np.minimum(length[1:], length[:-1]), 0.0)
    return smaller


def shaking(reversed_by: Array, dt: float) -> Flags:
    """Return (F,) True where one of the reversals (F, L) [m] is more than SHAKES times `dt` [s] in ENOUGH of the last WINDOW
    frames."""
    seen = np.concatenate([np.zeros((WINDOW - 1, reversed_by.shape[1]), dtype=np.int64), ~(reversed_by <= SHAKES * dt)])
    often = np.lib.stride_tricks.sliding_window_view(seen, WINDOW, axis=0).sum(axis=-1) >= ENOUGH
    return np.asarray(often.any(axis=1))
