"""Local times of bodies within a frame: advance along a path, roll back to an earlier time (timewarp: Mirtich 2000), sample."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import STILL, move_along
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.rigid.linkages import scale_last_step
from avatarsim.rigid.state import Events, Memory, record
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import add, along, put_row, row, sub

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@kernel
def depart(poses: Poses, velocities: Velocities, memory: Memory, members: Index, now: float) -> None:
    """Save the state of the members as the start of their paths, to which `go_back` can return."""
    islands = memory.islands
    for m in range(members.shape[0]):
        b = members[m]
        islands.begun[b], islands.at_once[b] = now, 0
        put_row(memory.began.position, b, row(poses.position, b))
        put_columns(memory.began.rotation, b, columns(poses.rotation, b))
        put_row(islands.linear, b, row(velocities.linear, b))
        put_row(islands.angular, b, row(velocities.angular, b))
        put_row(islands.linear_before, b, row(velocities.linear, b))
        put_row(islands.angular_before, b, row(velocities.angular, b))
        put_row(islands.received, b, row(memory.received, b))
        put_row(islands.owed_linear, b, row(memory.owed_linear, b))
        put_row(islands.owed_angular, b, row(memory.owed_angular, b))


@kernel
def arrive(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, b: int, t: float) -> None:
    """Take body b to where its path leads in t seconds, with the velocities that it has then."""
    if memory.paths.kind[b] != STILL:
        move_along(
            geometry, memory.began, memory.islands.linear, memory.islands.angular, memory.paths, memory.series, b, t, memory.trial
        )
        put_row(poses.position, b, row(memory.trial.position, b))
        put_columns(poses.rotation, b, columns(memory.trial.rotation, b))
        put_row(velocities.linear, b, row(memory.paths.v, b))
        put_row(velocities.angular, b, row(memory.paths.w, b))
        place(geometry, poses, b)


@kernel
def go_back(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, b: int, now: float
) -> None:
    """Roll body b back to ``now``, which lies on its last path; impulses of that path count as spread evenly over its time.

    After a substep, whose path has a velocity of its own, the velocity is between those before and after it: the energy too.
    """
    islands = memory.islands
    lasted, t = islands.due[b] - islands.begun[b], max(0.0, now - islands.begun[b])
    share = t / lasted if lasted > 0.0 else 0.0
    v_end, w_end = row(velocities.linear, b), row(velocities.angular, b)
    arrive(geometry, poses, velocities, memory, b, t)
    if islands.at_once[b] == 1:
        v, w = row(islands.linear_before, b), row(islands.angular_before, b)
        put_row(velocities.linear, b, along(v, share, sub(v_end, v)))
        put_row(velocities.angular, b, along(w, share, sub(w_end, w)))
    take_share(islands.received, b, share, memory.received)
    take_share(islands.owed_linear, b, share, memory.owed_linear)
    take_share(islands.owed_angular, b, share, memory.owed_angular)
    islands.due[b] = now
    linkage = dynamics.drive.linkage
    if dynamics.drive.linked[b] == 1:
        scale_last_step(linkage, b - linkage.skeleton.first, share)


@kernel
def take_share(before: Array, b: int, share: float, after: Array) -> None:
    """Set after[b] to before[b] and ``share`` of the change since."""
    put_row(after, b, along(row(before, b), share, sub(row(after, b), row(before, b))))


@kernel
def witness(
    geometry: Geometry, events: Events, kind: int, time: float, now: float, a: int, b: int, poses: Poses, velocities: Velocities,
    memory: Memory,
) -> None:
    """Record an event of bodies a and b at ``now``, with all other bodies sampled on their paths at that time."""
    k, islands, paths, sampled = events.used[0], memory.islands, memory.paths, memory.substeps.low
    record(events, kind, time, a, b, poses.position, poses.rotation, velocities.linear, velocities.angular)
    if k >= events.time.shape[0]:
        return
    for other in range(memory.moving.shape[0]):
        if memory.moving[other] == 1 and islands.due[other] > now and paths.kind[other] != STILL:
            # to record changes nothing: neither the trial poses nor the data of the path
            paths.time[other] = -1.0
            move_along(
                geometry, memory.began, islands.linear, islands.angular, paths, memory.series, other,
                max(0.0, now - islands.begun[other]), sampled,
            )
            paths.time[other] = -1.0
            put_row(events.position[k], other, row(sampled.position, other))
            put_columns(events.rotation[k], other, columns(sampled.rotation, other))
            put_row(events.linear[k], other, row(paths.v, other))
            put_row(events.angular[k], other, row(paths.w, other))
        if memory.tail_end[other] >= now:
            put_row(events.linear[k], other, add(row(events.linear[k], other), row(memory.tail_speed, other)))
