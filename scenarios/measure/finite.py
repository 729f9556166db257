"""Frames in which something shown is not a number."""

import numpy as np

from scenarios.measure.value import Values
from scenarios.record import Recording


def not_finite(recording: Recording) -> Values:
    """not_finite_frames: frames, the first state included, with a pose, velocity or angle that is nan or infinite."""
    shown = (
        recording.positions, recording.orientations, recording.velocities, recording.angular_velocities, recording.angles,
    )
    bad = np.zeros(recording.frames + 1, dtype=bool)
    for array in shown:
        bad |= ~np.isfinite(array.reshape(len(array), -1)).all(axis=1)
    return {"not_finite_frames": float(bad.sum())}
