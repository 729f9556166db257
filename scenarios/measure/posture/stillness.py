"""Freezing: the shown avatar does not move while its user does, which is the cheapest way to overlap nothing."""

import numpy as np
from numpy.typing import NDArray

from runfiles.record import Recording
from scenarios.measure.posture.joints import angle_between
from scenarios.measure.value import Values, measure

Array = NDArray[np.float64]

ARM = 0.1
"""Length [m] by which a link's turn counts as movement: a point this far from the link's origin moves by angle times it."""
USER_MOVES = 1e-3
"""Movement [m] of a frame from which the user counts as moving."""
DOES_NOT_MOVE = 1e-9
"""Movement [m] of a frame below which a shown posture has not moved at all; rounding in an engine is far below."""


def movement(positions: Array, orientations: Array) -> Array:
    """Return (F,) largest movement [m] of a link between states, of (F+1, L, 3) and (F+1, L, 4): origin plus turn times ARM."""
    moved = np.linalg.norm(np.diff(positions, axis=0), axis=-1)
    moved += ARM * angle_between(orientations[:-1], orientations[1:])
    return np.asarray(moved.max(axis=1))


@measure
def still_frames(recording: Recording) -> Values:
    """Return still_frames [%]: the user moved, the posture did not. A non-finite one has not moved. Empty without links."""
    if recording.raw_positions.shape[1] == 0 or recording.frames == 0:
        return {}
    shown = movement(recording.positions[:, recording.links], recording.orientations[:, recording.links])
    user = movement(recording.raw_positions, recording.raw_orientations)
    return {"still_frames": 100.0 * float(np.mean((user > USER_MOVES) & ~(shown >= DOES_NOT_MOVE)))}
