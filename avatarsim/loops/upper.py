"""Event-driven rigid-body simulation: the upper loop of Schmidl and Lin 2004 (Figure 3), from collision to collision.

Contacts -> impacts of this instant (eqs 7 to 10) -> contact forces constant until the next event -> advance to the next time of
impact; island by island, the one whose clock is farthest behind first.
"""

from avatarsim.impact.events import Events
from avatarsim.jit.kernel import kernel
from avatarsim.loops.island_step import step
from avatarsim.loops.islands import behind
from avatarsim.loops.upper_memory import DONE, NOT_FINITE, OUT_OF_SEGMENTS, STATUS_NAMES, Memory, Switches
from avatarsim.loops.waiting import go_on
from avatarsim.loops.waking import begin, regroup
from avatarsim.loops.zeno_tail import show_tails, take_up_tails
from avatarsim.motion.path import STILL
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses, place

__all__ = ["DONE", "STATUS_NAMES", "advance"]

STEPS_CAP = 200
"""Segments of all islands of a frame, per body, whatever happens."""


@kernel
def advance(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, memory: Memory, events: Events,
    switches: Switches,
) -> int:
    """One frame of ``dt`` seconds for all simulated bodies; fixed and driven ones do not move.

    Args:
        poses, velocities: changed in place. Driven bodies keep their poses, but have velocities: set by the caller, changed by
            impacts as those of a body of the coupled mass.
        memory: from `make_memory`; afterwards ``received`` holds the impulses on driven bodies, ``counts`` the work done.
        events: emptied, then filled if ``switches.record``; more than fit are counted but not kept.

    Returns:
        A status (see DONE); DONE is 0.
    """
    events.kept[0] = 0
    take_up_tails(velocities, memory)
    if begin(geometry, dynamics, poses, velocities, dt, memory, switches.sleeping) == 0:
        return DONE
    memory.frames[0] += 1
    bodies, islands, paths = memory.moving.shape[0], memory.islands, memory.paths
    status, now, i = regroup(geometry, dynamics, poses, velocities, memory, memory.all_bodies, 0.0, dt), 0.0, 0
    if status == NOT_FINITE:
        return status
    for _ in range(STEPS_CAP * bodies):
        i = behind(islands, dt, now, i if i < islands.found[0] else 0)
        if i < 0:
            break
        now = islands.due[islands.order[islands.first[i]]]
        outcome = step(geometry, dynamics, poses, velocities, dt, i, memory, events, switches)
        if outcome == NOT_FINITE:
            return NOT_FINITE
        # AGAIN is below all statuses; the worst is returned
        status = max(status, outcome)
    go_on(velocities, memory, memory.all_bodies)
    show_tails(velocities, memory, dt)
    for b in range(bodies):
        if memory.moving[b] == 1:
            if switches.sleeping and memory.held[b] == 1 and paths.kind[b] == STILL and memory.tail_end[b] < 0.0:
                memory.asleep[b] = 1
            put_row(memory.trial.position, b, row(poses.position, b))
            put_columns(memory.trial.rotation, b, columns(poses.rotation, b))
            if switches.record:
                place(geometry, memory.trial, b)
    return OUT_OF_SEGMENTS if i >= 0 else status
