"""Who moves in this frame, and who could meet whom: begins a frame of the upper loop and finds its near pairs."""

from avatarsim.collide.status import NOT_FINITE as SWEEP_NOT_FINITE
from avatarsim.kernel import kernel
from avatarsim.loops.touching import SIMULATED
from avatarsim.loops.upper_memory import DONE, NOT_FINITE, OUT_OF_ROOM, SWEEPS, Memory
from avatarsim.motion.near import near_pairs, stands, wake_beside
from avatarsim.motion.path import STILL
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses, place


@kernel
def begin(geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, sleeping: bool) -> int:
    """Look for what the caller changed, wake whom it concerns, and return how many bodies will move."""
    moving, asleep, trial = memory.moving, memory.asleep, memory.trial
    memory.counts[:] = 0
    memory.received[:, :] = 0.0
    memory.owed_linear[:, :] = 0.0
    memory.owed_angular[:, :] = 0.0
    memory.owing[0] = 0
    bodies = moving.shape[0]
    for b in range(bodies):
        sleeps = sleeping and asleep[b] == 1 and stands(velocities.linear, velocities.angular, b)
        if dynamics.role[b] == SIMULATED and not sleeps:
            asleep[b], moving[b] = 0, 1
        else:
            moving[b] = 0
        memory.paths.kind[b] = STILL
    for b in range(bodies):
        same = dynamics.role[b] == SIMULATED or stands(velocities.linear, velocities.angular, b)
        for i in range(3):
            same = same and poses.position[b, i] == trial.position[b, i]
            for k in range(3):
                same = same and poses.rotation[b, i, k] == trial.rotation[b, i, k]
        if not same:
            wake_beside(trial.hulls, poses.hulls, b, memory.wanted, asleep, moving)
            if dynamics.role[b] == SIMULATED:
                asleep[b], moving[b] = 0, 1
            put_row(trial.position, b, row(poses.position, b))
            put_columns(trial.rotation, b, columns(poses.rotation, b))
            place(geometry, trial, b)
    awake = 0
    for b in range(bodies):
        awake += moving[b]
    return awake


@kernel
def sweep_pairs(dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, left: float) -> tuple[int, int]:
    """Near pairs for the time left: (DONE, OUT_OF_ROOM or NOT_FINITE, number of pairs)."""
    memory.counts[SWEEPS] += 1
    status, count = near_pairs(
        poses.hulls, poses.position, memory.span, memory.moving, memory.asleep, velocities.linear, velocities.angular,
        dynamics.gravity, left, memory.wanted, memory.boxes, memory.sweep, memory.pairs,
    )
    room = memory.pairs.shape[0]
    if status == SWEEP_NOT_FINITE:
        return NOT_FINITE, 0
    return (DONE if count <= room else OUT_OF_ROOM), min(count, room)
