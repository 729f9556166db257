"""Which phase each frame belongs to, from what was shown alone, so that landing, flight and rest are timed apart.

rest     nothing that may move did: every body and link is where it was, to REST
contact  else, and something acts on it: a simulated body's velocity changed by more than gravity explains, or a link is shown
         elsewhere than its target
free     all other frames
"""

import numpy as np

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from scenarios.record import Recording

REST = 1e-6
"""Way [m] and change of a quaternion's parts in a frame below which nothing moved: the bound on overlap is as large."""
PUSHED = 1e-2
"""Change of a velocity [m/s] in a frame, beyond gravity's, from which on something pushed: rounding of engines with steps is a
thousandth of it, the slowest impact that a scene expects thirty times as large."""
ELSEWHERE = 1e-3
"""Distance [m] between a link and its target from which on something holds it; the lag of a spring drive is smaller at rest."""


def phases(recording: Recording, scene: Scene) -> tuple[str, ...]:
    """The phase of each of the F frames of a recording."""
    moving = [k for k, role in enumerate(scene.roles) if role is not Role.FIXED]
    simulated = [k for k, role in enumerate(scene.roles) if role is Role.SIMULATED]
    way = np.linalg.norm(np.diff(recording.positions[:, moving], axis=0), axis=-1)
    turn = np.abs(np.diff(recording.orientations[:, moving], axis=0)).max(axis=-1)
    at_rest = (way <= REST).all(axis=1) & (turn <= REST).all(axis=1)
    gain = np.diff(recording.velocities[:, simulated], axis=0) - np.asarray(scene.gravity) * recording.dt
    pushed = (np.linalg.norm(gain, axis=-1) > PUSHED).any(axis=1)
    off = np.linalg.norm(recording.positions[1:, recording.links] - recording.raw_positions[1:], axis=-1)
    held = (off > ELSEWHERE).any(axis=1)
    return tuple(np.where(at_rest, "rest", np.where(pushed | held, "contact", "free")).tolist())
