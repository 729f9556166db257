"""Figures from frame records: work as the engine counts it, halts and spent budgets, poses that are no number."""

import numpy as np

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.value import Values, measure

TOTALS = ("waiting", "planning", "following", "out_of_work")
"""Counts that are reported as a sum over the run, under their own name; all others as a mean, `<name>_per_frame`."""


@measure
def work(recording: Recording) -> Values:
    """<name>_per_frame: mean over the frames advanced; those of TOTALS: number in all."""
    totals: dict[str, float] = {}
    for name, numbers in recording.counts.items():
        done = numbers[1:]
        if name in TOTALS:
            totals[name] = float(done.sum())
        elif len(done):
            totals[f"{name}_per_frame"] = float(done.mean())
    return totals


MOVES = 0.01
"""Speed [m/s] at both ends of a frame from which a body is moving; resting contact jitters far below."""
STAYS = 1e-9
"""Way [m] of a frame below which a body has not moved at all."""


@measure
def halts(recording: Recording, scene: Scene) -> Values:
    """Return halted_frames: frames in which a simulated body has speed at both ends and did not move. status_frames: frames that
    an engine itself reports as not ended well, under any status. Empty without simulated bodies."""
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


@measure
def not_finite(recording: Recording) -> Values:
    """Return not_finite_frames: frames, the first state included, with a pose, velocity or angle that is nan or infinite."""
    shown = (
        recording.positions, recording.orientations, recording.velocities, recording.angular_velocities, recording.angles,
    )
    bad = np.zeros(recording.frames + 1, dtype=bool)
    for array in shown:
        bad |= ~np.isfinite(array.reshape(len(array), -1)).all(axis=1)
    return {"not_finite_frames": float(bad.sum())}
