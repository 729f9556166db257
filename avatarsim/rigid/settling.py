"""Rest of a crowd: its bodies stand still when the contacts can hold all of them from rest.

The test is a solve of the contacts for bodies at rest under gravity: it leaves a velocity where nothing holds them. It is made
once all have been slow for some frames.
"""

from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import STILL
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.contacts import is_full, recall_forces, scale_impulses, weigh_from
from avatarsim.rigid.margin_rows import LOWER, UPPER, find_rows, stand_off_of
from avatarsim.rigid.near_pieces import list_pieces_of, may_go
from avatarsim.rigid.solver import FIRST_TRY, solve_contacts
from avatarsim.rigid.state import SOLVES, Memory
from avatarsim.rigid.substep import VISITS, apply_impulses, fall_free
from avatarsim.spatial.vec3 import norm, put_row, row
from avatarsim.tolerances import FINE, ROUGH, ROUNDING

Index = NDArray[np.int64]

AT_LAST = 0.5
CALM, AGAIN_AFTER = AT_LAST / 10.0, AT_LAST / 3.0
"""Times [s] for which all were slow after which all stand untried, before rest is tried, and after which it is tried again, since
half a second of slowness is rest to the eye. Shorter: bodies that are slow for a moment are tried, or stop too soon; longer:
heaps sleep later, and bodies at rest are solved for as long as moving ones."""

REST_SHARE, REST_VISITS = 5e-4, 5 * VISITS
"""Share of gravity that the test may leave to a body that counts as supported, and most contact points that each stage of
its solve visits. Larger share: a body farther from its balance, in radians, stands; smaller, or fewer visits: heaps never sleep,
for the solver does not come so far."""

REST_GAP = UPPER + LOWER
"""[stand-offs] gap up to which a contact holds from rest: substeps leave gaps of 0.5 to 1.5."""


@kernel
def gravity_strength(dynamics: Dynamics) -> float:
    """Return the size of gravity [m/s^2]."""
    return float(norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])))


@kernel
def slow_speed(dynamics: Dynamics, memory: Memory) -> float:
    """Return the speed [m/s] below which a body may come to rest: a tenth of that of a fall through the stand-off."""
    return FINE * sqrt(2.0 * stand_off_of(memory) * gravity_strength(dynamics))


@kernel
def note_calm(dynamics: Dynamics, velocities: Velocities, memory: Memory, members: Index) -> None:
    """Count the frames in which each member was slow, at the end of a frame."""
    calm, slow = memory.substeps.calm, slow_speed(dynamics, memory)
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            speed = max(norm(row(velocities.linear, b)), norm(row(velocities.angular, b)) * memory.span[b])
            calm[b] = calm[b] + 1 if speed < slow else 0


@kernel
def frames_in(time: float, dt: float) -> int:
    """Return the number of frames of dt seconds that last for ``time`` [s] or longer."""
    return max(1, int(ceil(time / dt - ROUNDING)))


@kernel
def calm_frames(memory: Memory, members: Index, most: int) -> int:
    """Return frames, at most so many, for which all members that move have been slow."""
    least = most
    for m in range(members.shape[0]):
        if memory.moving[members[m]] == 1:
            least = min(least, memory.substeps.calm[members[m]])
    return least


@kernel
def rest_is_due(memory: Memory, members: Index, dt: float) -> tuple[bool, bool]:
    """Return whether rest is to be tried at the start of a frame of dt seconds, and whether the members stand untried."""
    first, again, last = frames_in(CALM, dt), frames_in(AGAIN_AFTER, dt), frames_in(AT_LAST, dt)
    calm = calm_frames(memory, members, last)
    return calm == last or (calm >= first and (calm - first) % again == 0), calm == last


@kernel
def holds_from_rest(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index,
    h: float,
) -> bool:
    """Return whether the contacts hold all members at rest for h seconds. Sets their velocities to zero in any case."""
    contacts = memory.contacts
    for m in range(members.shape[0]):
        put_row(velocities.linear, members[m], (0.0, 0.0, 0.0))
        put_row(velocities.angular, members[m], (0.0, 0.0, 0.0))
    fall_free(dynamics, poses, velocities, memory, members, h)
    may_go(dynamics, memory, members, h)
    if not list_pieces_of(geometry, poses, memory, members):
        return False
    find_rows(geometry, dynamics, poses, velocities, memory, h)
    if is_full(memory.contacts):
        return False
    count, d = contacts.used[0], stand_off_of(memory)
    contacts.standing[0] = 1
    weigh_from(contacts, memory.masses, 0.0, 0)
    for k in range(count):
        contacts.target[k] = -max(0.0, contacts.gap[k] - REST_GAP * d) / h
    recall_forces(contacts, memory.last)
    scale_impulses(contacts, h)
    apply_impulses(memory, count)
    solve_contacts(
        contacts, memory.masses, 0, count, memory.linear_end, memory.angular_end, ROUGH, FIRST_TRY,
        max(FIRST_TRY, REST_VISITS // (2 * max(1, count))), memory.before, memory.direction,
    )
    memory.counts[SOLVES] += 1
    worst = 0.0
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            worst = max(worst, norm(row(memory.linear_end, b)), norm(row(memory.angular_end, b)) * memory.span[b])
    return worst < REST_SHARE * gravity_strength(dynamics) * h


@kernel
def put_to_rest(memory: Memory, members: Index) -> None:
    """Let the members stand still for the rest of the frame, after which they fall asleep."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            memory.paths.kind[b], memory.supported[b] = STILL, 1
            put_row(memory.paths.linear, b, (0.0, 0.0, 0.0))
