"""Time kept: comparison of a body's way with its own shown velocity; where they differ, time stopped for the body."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.measure.value import Values, measure

Array = NDArray[np.float64]

SLOW = 0.02
"""Speed [m/s] that a body has to exceed. Smaller: contacts that settle count; larger: bodies that creep do not."""
STALLED = 0.2
"""Share of its way below which a body stays behind in a frame."""
IN_A_ROW = 3
"""Frames in a row in which a stalled body stays behind. Two bounces within one frame look like one that stays behind: at 2 they
are up to 0.2 % of the bodies of sound engines, at 3 none; at 10 bodies that are stopped for a tenth of a second pass."""


def stated_way(way: Array, before: Array, after: Array) -> Array:
    """Return the displacement (..., 3) [m] on the line from `before` to `after` that is nearest to `way`.

    `before` and `after` are the frame's length times the velocities at its two ends. A body with one impact in the frame, at any
    time in it, and a body with constant acceleration end on that line.
    """
    change = after - before
    square = np.sum(change * change, axis=-1)
    share = np.sum((way - before) * change, axis=-1) / np.where(square > 0.0, square, 1.0)
    return np.asarray(before + np.clip(share, 0.0, 1.0)[..., None] * change)


@measure
def time_kept(recording: Recording, scene: Scene) -> Values:
    """Return time_kept_error [] and stalled_bodies [%], over simulated bodies in frames whose stated way is faster than SLOW.

    time_kept_error: |1 - time kept|, where time kept is the way that centres of mass go along their stated ways, over the sum of
    these. stalled_bodies: share that goes less than STALLED of its way, IN_A_ROW; others that run ahead do not make up for them.
    0 where nothing is that fast; empty without simulated bodies.
    """
    own = [k for k, role in enumerate(scene.roles) if role is Role.SIMULATED]
    if not own or recording.frames == 0:
        return {}
    arms = np.array([mass.centre for k in own if (mass := scene.bodies[k].mass) is not None])
    centres = recording.positions[:, own] + rotation.rotate(recording.orientations[:, own], arms)
    velocities = recording.velocities[:, own] * recording.dt
    if not (np.isfinite(centres).all() and np.isfinite(velocities).all()):
        return {"time_kept_error": float("nan"), "stalled_bodies": float("nan")}
    way = np.diff(centres, axis=0)
    stated = stated_way(way, velocities[:-1], velocities[1:])
    length = np.linalg.norm(stated, axis=-1)
    fast = length > SLOW * recording.dt
    if not fast.any():
        return {"time_kept_error": 0.0, "stalled_bodies": 0.0}
    gone = np.sum(way * stated, axis=-1) / np.where(fast, length, 1.0)
    stalled = _in_a_row(fast & (gone < STALLED * length))
    return {
        "time_kept_error": float(abs(1.0 - gone[fast].sum() / length[fast].sum())),
        "stalled_bodies": 100.0 * float(stalled.sum() / fast.sum()),
    }


def _in_a_row(late: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Keep the frames (F, n) that are among at least IN_A_ROW in a row."""
    padded = np.pad(late, ((IN_A_ROW - 1, IN_A_ROW - 1), (0, 0)))
    full = sliding_window_view(padded, IN_A_ROW, axis=0).all(axis=-1)
    return np.asarray(sliding_window_view(full, IN_A_ROW, axis=0).any(axis=-1))
