"""Sleeping and broad phase of the upper loop: begins a frame, wakes bodies next to driven ones that moved, finds near pairs."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import STILL
from avatarsim.collision.status import NOT_FINITE as SWEEP_NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, SIMULATED, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.rigid.clocks import go_back
from avatarsim.rigid.contact_generation import note_shown
from avatarsim.rigid.driven import is_kinematic
from avatarsim.rigid.islands import due_of, part
from avatarsim.rigid.near_pairs import is_still, keeps_promise, near_pairs, wake_near
from avatarsim.rigid.state import DONE, ISLANDS, NOT_FINITE, OUT_OF_ROOM, SEGMENTS, SWEEPS, Memory
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row

Index = NDArray[np.int64]

HALVINGS = 16
"""Times that a horizon is halved where near pairs have no room. After so many, bodies below 650 m/s bound their motion within one
frame of 1/60 s to 0.2 mm. Fewer: fast crowds wait that could move; more: a heap without room for its pairs costs more sweeps."""


@kernel
def begin(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, memory: Memory, sleeping: bool
) -> int:
    """Mark the moving bodies, wake those next to a driven body that moved, and return how many will move in dt seconds.

    Only the flags of fixed and sleeping bodies are read, of which there may be thousands.
    """
    moving, asleep = memory.moving, memory.asleep
    memory.counts[:] = 0
    memory.owing[0] = 0
    bodies, awake = moving.shape[0], 0
    for b in range(bodies):
        moved, role = moving[b] == 1, dynamics.role[b]
        if role == SIMULATED and not (sleeping and asleep[b] == 1):
            asleep[b], moving[b] = 0, 1
        else:
            moving[b] = dynamics.drive.coupled[b]
        # a body that fell asleep in the last frame is reset once more, now at rest
        if moved or moving[b] == 1 or role == DRIVEN:
            make_ready(velocities, memory, b)
    for b in range(bodies):
        if is_kinematic(dynamics, b):
            memory.masses.inverse_mass[b] = 0.0
            for i in range(3):
                for k in range(3):
                    memory.masses.inverse_inertia[b, i, k] = 0.0
            notice_driven(geometry, poses, velocities, dt, memory, b)
    for b in range(bodies):
        awake += moving[b]
    return awake


@kernel
def make_ready(velocities: Velocities, memory: Memory, b: int) -> None:
    """Reset the per-frame state of body b."""
    nothing = (0.0, 0.0, 0.0)
    put_row(memory.received, b, nothing)
    put_row(memory.owed_linear, b, nothing)
    put_row(memory.owed_angular, b, nothing)
    memory.paths.kind[b] = STILL
    memory.islands.spent[b], memory.islands.charged[b] = 0, 0
    memory.islands.begun[b], memory.islands.due[b] = 0.0, 0.0
    memory.corrected[b] = -1.0
    # contacts with bodies at rest read these rows too
    put_row(memory.linear_end, b, row(velocities.linear, b))
    put_row(memory.angular_end, b, row(velocities.angular, b))


@kernel
def notice_driven(geometry: Geometry, poses: Poses, velocities: Velocities, dt: float, memory: Memory, b: int) -> None:
    """Wake bodies that sleep next to driven body b if it was moved, or moves, and copy its pose and displayed velocity."""
    trial = memory.trial
    same = is_still(velocities.linear, velocities.angular, b)
    for i in range(3):
        same = same and poses.position[b, i] == trial.position[b, i]
        for k in range(3):
            same = same and poses.rotation[b, i, k] == trial.rotation[b, i, k]
    if same:
        put_row(memory.shown_linear, b, (0.0, 0.0, 0.0))
        put_row(memory.shown_angular, b, (0.0, 0.0, 0.0))
        return
    note_shown(poses, dt, memory, b)
    wake_near(trial.hulls, poses.hulls, b, memory.margin[0], memory.wanted, memory.asleep, memory.moving)
    put_row(memory.began.position, b, row(poses.position, b))
    put_row(trial.position, b, row(poses.position, b))
    put_columns(trial.rotation, b, columns(poses.rotation, b))
    place(geometry, trial, b)


@kernel
def regroup(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, chosen: Index, now: float,
    dt: float, widens: bool,
) -> int:
    """Bound the motion of these bodies from ``now`` to the end of the frame anew, and form the islands that follow; those bounds
    contain the ones of before if ``widens``.

    Where the near pairs have no room the horizon of the frame is halved until they have: bodies that reach the end of their
    bounds get new ones. Bodies of an island that is joined by one at ``now`` are rolled back to ``now``.

    Returns:
        DONE or NOT_FINITE; OUT_OF_ROOM: no horizon is short enough, the islands are not formed, and the frame has to end.
    """
    room, islands, count, horizon = memory.pairs.shape[0], memory.islands, 0, min(dt - now, memory.horizon[0])
    for attempt in range(HALVINGS + 1):
        memory.counts[SWEEPS] += 1
        status, count = near_pairs(
            poses.hulls, poses.position, memory.span, chosen, memory.moving, memory.asleep, velocities.linear,
            velocities.angular, dynamics.gravity, horizon, memory.margin[0], widens and attempt == 0, memory.wanted,
            memory.boxes, memory.sweep, memory.pairs,
        )
        if status == SWEEP_NOT_FINITE:
            return NOT_FINITE
        if count <= room:
            break
        horizon *= 0.5
        memory.horizon[0] = horizon
    if count > room:
        memory.horizon[0] = 0.0
        return OUT_OF_ROOM
    for b in range(memory.moving.shape[0]):
        if memory.moving[b] == 1 and memory.joins[b] == 0:
            # woken just now
            islands.begun[b], islands.due[b] = now, now
        memory.joins[b] = 1 if memory.moving[b] == 1 or dynamics.role[b] == DRIVEN else 0
    part(islands, memory.pairs, count, memory.moving, memory.joins, dynamics.drive.tied)
    memory.counts[ISLANDS] = max(memory.counts[ISLANDS], islands.found[0])
    # at the start of a frame too: an island already at the end of the frame may be joined by bodies at its start
    for b in range(memory.moving.shape[0]):
        if islands.label[b] >= 0 and islands.due[b] > now and due_of(islands, islands.label[b]) <= now:
            go_back(geometry, dynamics, poses, velocities, memory, b, now)
    return DONE


@kernel
def all_keep(poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float) -> bool:
    """Return True if the members stay in their promised boxes for h seconds."""
    for m in range(members.shape[0]):
        if not keeps_promise(
            poses.hulls, poses.position, memory.span, members[m], velocities.linear, velocities.angular, memory.paths, h,
            memory.margin[0], memory.boxes,
        ):
            return False
    return True


@kernel
def charged_last(memory: Memory, i: int) -> bool:
    """Return True if island i consists only of bodies charged last: those whose contacts are in ``memory.contacts``."""
    islands = memory.islands
    for m in range(islands.first[i], islands.first[i + 1]):
        if islands.charged[islands.order[m]] != memory.counts[SEGMENTS]:
            return False
    return True
