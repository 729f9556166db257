"""Does the world halt? Bodies with a velocity that are not moved by it; frames that ended on a spent budget."""

import numpy as np

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from scenarios.measure.value import Values
from scenarios.record import Recording

MOVES = 0.01
"""Speed [m/s] at both ends of a frame from which a body is moving; resting contact jitters far below."""
STAYS = 1e-9
"""Way [m] of a frame below which a body has not moved at all."""


def halts(recording: Recording, scene: Scene) -> Values:
    """halted_frames: frames in which a simulated body has speed at both ends and did not move. status_frames: frames that an
    engine itself reports as not ended well, under any status. Empty without simulated bodies."""
    bodies = [k for k, role in enumerate(scene.roles) if role is Role.SIMULATED]
    if not bodies or recording.frames == 0:
        return {}
    speed = np.linalg.norm(recording.velocities[:, bodies], axis=-1)
    way = np.linalg.norm(np.diff(recording.positions[:, bodies], axis=0), axis=-1)
    halted = ((speed[:-1] > MOVES) & (speed[1:] > MOVES) & (way < STAYS)).any(axis=1)
    bad = np.zeros(recording.frames + 1, dtype=bool)
    for numbers in recording.statuses.values():
        bad |= numbers > 0
    return {"halted_frames": float(halted.sum()), "status_frames": float(bad.sum())}
