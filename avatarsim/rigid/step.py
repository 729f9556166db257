"""Event-driven rigid-body simulation: the upper loop of Schmidl and Lin 2004 (Figure 3), from collision to collision.

Contacts -> impacts of this instant (eqs 7 to 10) -> contact forces constant until the next event -> advance to the next time of
impact; island by island, the one whose clock is farthest behind first.

Upper loop (Schmidl and Lin 2004, Figure 3) as the frame sees it: simulated bodies move, driven ones receive impulses.
"""

from typing import Annotated, ClassVar, NamedTuple

import numpy as np

from avatarsim.collision.path import STILL
from avatarsim.counters import Tally
from avatarsim.engine import Snapshot
from avatarsim.jit.arena import pack, view_arena
from avatarsim.jit.kept import NOT_KEPT
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Index
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.model.world import World, WorldParts
from avatarsim.rigid.deferred_impacts import restore_deferred
from avatarsim.rigid.impacts import resume_zeno, show_zeno
from avatarsim.rigid.island_step import step
from avatarsim.rigid.islands import next_island
from avatarsim.rigid.sleeping import begin, regroup
from avatarsim.rigid.state import (
    COUNT_NAMES,
    DONE,
    EVENTS_CAP,
    NOT_FINITE,
    OUT_OF_ROOM,
    OUT_OF_SEGMENTS,
    STATUS_NAMES,
    Events,
    Memory,
    Switches,
    make_events,
    make_memory,
    snapshots,
)
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row

__all__ = ["DONE", "STATUS_NAMES", "advance"]

STEPS_CAP = 2 * EVENTS_CAP
"""Segments of all islands of a frame, per body, in any case: after so many of its own an island keeps its members."""


@kernel
def advance(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, memory: Memory, events: Events,
    switches: Switches,
) -> int:
    """Advance all simulated bodies by one frame of ``dt`` seconds; fixed and driven ones do not move.

    Args:
        poses, velocities: changed in place. Driven bodies keep their poses, but have velocities: set by the caller, changed by
            impacts as those of a body of the coupled mass.
        memory: from `make_memory`; afterwards ``received`` holds the impulses on driven bodies, ``counts`` the work done.
        events: emptied, then filled if ``switches.record``; more than fit are counted but not kept.

    Returns:
        A status (see DONE); DONE is 0.
    """
    events.used[0] = 0
    resume_zeno(velocities, memory)
    if begin(geometry, dynamics, poses, velocities, dt, memory, switches.sleeping) == 0:
        return DONE
    bodies, islands, paths = memory.moving.shape[0], memory.islands, memory.paths
    memory.horizon[0] = dt
    status, now, i = regroup(geometry, dynamics, poses, velocities, memory, memory.all_bodies, 0.0, dt, False), 0.0, 0
    if status == NOT_FINITE:
        return status
    for _ in range(STEPS_CAP * bodies):
        i = next_island(islands, dt, now, i if i < islands.found[0] else 0)
        if i < 0 or memory.horizon[0] == 0.0:
            break
        now = islands.due[islands.order[islands.first[i]]]
        outcome = step(geometry, dynamics, poses, velocities, dt, i, memory, events, switches)
        if outcome == NOT_FINITE:
            return NOT_FINITE
        # AGAIN is below all statuses; the worst is returned
        status = max(status, outcome)
    restore_deferred(velocities, memory, memory.all_bodies)
    show_zeno(velocities, memory, dt)
    for b in range(bodies):
        if memory.moving[b] == 1:
            if switches.sleeping and memory.supported[b] == 1 and paths.kind[b] == STILL and memory.tail_end[b] < 0.0:
                memory.asleep[b] = 1
            put_row(memory.trial.position, b, row(poses.position, b))
            put_columns(memory.trial.rotation, b, columns(poses.rotation, b))
            if switches.record:
                place(geometry, memory.trial, b)
    if memory.horizon[0] == 0.0:
        return OUT_OF_ROOM
    return OUT_OF_SEGMENTS if i >= 0 else status


EVENTS_KEPT = 256
"""Most events of one frame that a recording keeps (two per impact); more are counted."""


class UpperParts(NamedTuple):
    """Contents of the arena of the upper loop."""

    memory: Memory
    events: Annotated[Events, NOT_KEPT]
    switches: Switches


@kernel
def advance_opened(world: Index, upper: Index, dt: float) -> int:
    """Run `advance` on the arenas of a world and of its upper loop."""
    w, own = view_arena(world, WorldParts), view_arena(upper, UpperParts)
    return advance(w.geometry, w.dynamics, w.poses, w.velocities, dt, own.memory, own.events, own.switches)


class SimulatedLoop:
    """The simulated bodies of a world, and driven ones that keep `stand_off` [m] from them."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)

    def __init__(self, world: World, *, paper: bool, record: bool, stand_off: float = 0.0) -> None:
        self.world, self.record = world, record
        on = world.scene.effects
        switches = Switches(on.gyroscopic, on.continuous, on.sleeping, paper, record)
        memory = make_memory(world.geometry, world.dynamics, world.poses, on.gyroscopic, stand_off)
        events = make_events(len(world.scene.names), EVENTS_KEPT if record else 0)
        self.words, self._parts = pack(UpperParts(memory, events, switches))
        self.memory, self.events = self._parts.memory, self._parts.events
        self._moving = np.flatnonzero(world.drive.moves)

    def retained_state(self) -> UpperParts:
        """Return what passes from frame to frame."""
        return self._parts

    def resume(self) -> None:
        """Continue after the memory was replaced; the broad phase finds by itself that its fat boxes no longer hold."""

    def counts(self) -> Tally:
        """Return the work done in the last frame."""
        return Tally(COUNT_NAMES, self.memory.counts.tobytes())

    def statuses(self, status: int) -> dict[str, int]:
        """Return counts of failures in the last frame, by name; `advance` returned `status`."""
        found = {} if status == DONE else {f"motion {STATUS_NAMES[status]}": 1}
        drive, moving = self.world.drive, self._moving
        if len(moving) and (blocked := int((drive.blocked[moving] | drive.blocked_turn[moving]).sum())) > 0:
            found["blocked"] = blocked
        if self.record and (lost := int(self.events.used[0]) - len(self.events.time)) > 0:
            found["events not recorded"] = lost
        return found

    def inside(self, begun: float) -> tuple[Snapshot, ...]:
        """Return events of the last frame, which began at `begun` [s], if they are recorded."""
        return snapshots(self.world, self.events, begun) if self.record else ()
