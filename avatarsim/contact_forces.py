"""Contact forces of the displayed state: one solve of all its contacts, converged to rounding.

Gravity acts on loose bodies, and the spring of equation 6 on avatars with their displayed lag, as in a substep of the upper loop.
The forces are the impulses that keep all contacts from closing in a short time, divided by this time. At rest they balance
weights and springs.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.tracked_motion import last_and_now
from avatarsim.frame import Frames
from avatarsim.jit.arena import pack, view_arena
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import Index, IndexGrid, IndexLine, Line
from avatarsim.lower_loop import IkLoop
from avatarsim.model.dynamics import SIMULATED, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.world import World, WorldParts
from avatarsim.pose_queries import Contact, meeting_pairs
from avatarsim.rigid.contacts import POINTS_OF_PAIR, to_world, weigh_from
from avatarsim.rigid.driven import aim, bound_forces
from avatarsim.rigid.link_rows import weigh_links
from avatarsim.rigid.linkages import has_linkage, move_linkages, show_linkages, weigh_linkages
from avatarsim.rigid.margin_rows import find_rows
from avatarsim.rigid.near_pieces import list_pieces
from avatarsim.rigid.solver import lay_out, passes, take_motion
from avatarsim.rigid.state import Memory, make_memory
from avatarsim.rigid.substep import ROUNDS, SHARE_OF_SOLVE, SUBSTEP, fall_free, sweeps_for, weigh_again
from avatarsim.spatial.vec3 import put_row
from avatarsim.tolerances import PROOF

Array = NDArray[np.float64]

EXACT = PROOF * PROOF
"""[m/s] change of the last sweep: below rounding of the velocities of a substep."""

TRIES = SHARE_OF_SOLVE * ROUNDS
"""Most solves, each from the impulses of the last."""


class ForceParts(NamedTuple):
    """Arrays of one query: dynamics with all avatars coupled, velocities, and its own memory.

    pairs (pairs, 2) bodies whose boxes meet; within (1) [m] largest gap; members bodies that move.
    """

    dynamics: Dynamics
    velocities: Velocities
    memory: Memory
    pairs: IndexGrid
    within: Line
    members: IndexLine


@kernel
def find_all_rows(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, own: ForceParts, dt: float, h: float
) -> bool:
    """Find rows of all contacts for h seconds, without impulses; return False without room for them."""
    memory, members, contacts = own.memory, own.members, own.memory.contacts
    for m in range(members.shape[0]):
        b = members[m]
        if dynamics.role[b] == SIMULATED:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
            to_world(dynamics.inverse_inertia, poses.rotation, b, memory.masses.inverse_inertia)
        else:
            aim(dynamics.drive, poses, velocities, memory, b, dt, dt, h)
    fall_free(dynamics, poses, velocities, memory, members, h)
    weigh_linkages(dynamics, poses, memory, members, h)
    move_linkages(dynamics, poses, memory, members)
    sub_ = memory.substeps
    sub_.room[:], sub_.wider[:], sub_.found[0] = 0.5 * own.within[0], -1.0, 0
    if not list_pieces(geometry, poses, memory, own.pairs, sub_.wider, sub_.room):
        return False
    find_rows(geometry, dynamics, poses, velocities, memory, h)
    for k in range(contacts.used[0]):
        contacts.target[k] = 0.0 if contacts.gap[k] <= own.within[0] else -contacts.gap[k] / h
        put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
    weigh_from(contacts, memory.masses, 0.0, 0)
    weigh_links(dynamics, poses, memory, 0)
    return True


@kernel
def solve_exactly(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index) -> None:
    """Solve for the impulses of all rows, to rounding."""
    contacts = memory.contacts
    count = contacts.used[0]
    lay_out(contacts, memory.masses, 0, count, memory.linear_end, memory.angular_end)
    for _ in range(TRIES):
        worst, _ = passes(contacts, 0, count, EXACT, sweeps_for(count), True, memory.before, memory.direction)
        take_motion(contacts, 0, count, memory.linear_end, memory.angular_end)
        changed = False
        if has_linkage(dynamics, members):
            changed = move_linkages(dynamics, poses, memory, members)
            if changed:
                weigh_again(dynamics, poses, memory)
            show_linkages(dynamics.drive, contacts, memory, members)
        if not (worst > EXACT) and not changed:
            break


@entry_kernel
def solve_forces(world: Index, query: Index, dt: float, h: float) -> bool:
    """Find rows of all contacts, and impulses over h seconds, in ``memory.contacts``; return False without room for them."""
    w, own = view_arena(world, WorldParts), view_arena(query, ForceParts)
    for _ in range(ROUNDS):
        if not find_all_rows(w.geometry, own.dynamics, w.poses, own.velocities, own, dt, h):
            return False
        solve_exactly(own.dynamics, w.poses, own.memory, own.members)
        if not bound_forces(own.dynamics, w.poses, own.memory, own.members, dt, dt, h):
            break
    return True


def contacts_with_forces(frames: Frames, within: float, stand_off: float, dt: float) -> tuple[Contact, ...]:
    """Return contacts up to `within` [m] of the shown state, with their forces; of pairs of which at least one moves."""
    world = frames.world
    query = _query(frames, within, stand_off)
    words, own = pack(query)
    if not solve_forces(world.words, words, dt, SUBSTEP):
        return ()
    found, contacts, names, pieces = [], own.memory.contacts, world.scene.names, len(world.geometry.body)
    for k in range(int(contacts.used[0])):
        if contacts.gap[k] > within:
            continue
        # rows of attached bodies are those of their links: see `attached`
        a, b = (int(world.geometry.body[piece]) for piece in divmod(int(contacts.key[k]) // POINTS_OF_PAIR, pieces))
        force = contacts.impulse[k] @ contacts.frame[k] / SUBSTEP
        point, normal = world.poses.position[contacts.body[k, 0]] + contacts.arm_a[k], contacts.frame[k, 0].copy()
        for array in (point, normal, force):
            array.flags.writeable = False
        found.append(Contact(names[a], names[b], point, normal, float(contacts.gap[k]), force))
    return tuple(found)


def _query(frames: Frames, within: float, stand_off: float) -> ForceParts:
    """Copy the state that the solve changes."""
    world = frames.world
    drive = world.drive._replace(**{
        name: getattr(world.drive, name).copy() for name in world.drive._fields if name != "linkage"
    })
    first = world.skeleton.first
    # a moving body at rest does not yield
    drive.coupled[first:] = np.where(drive.moves[first:] == 1, drive.coupled[first:], drive.may_couple[first:])
    if frames.driven and isinstance(frames.lower, IkLoop) and frames.lower.trackers.turn[0] >= 0:
        _, now = last_and_now(frames.lower.trackers)
        drive.position[first:], drive.turn[first:] = now.position[first:], now.rotation[first:]
        standing = world.drive.coupled[first:] == 0
        drive.linear[first:][standing], drive.angular[first:][standing] = 0.0, 0.0
        drive.lag[first:][standing], drive.lag_turn[first:][standing] = 0.0, 0.0
        _pose_joints(world)
    dynamics = world.dynamics._replace(drive=drive)
    memory = make_memory(world.geometry, dynamics, world.poses, world.scene.effects.gyroscopic, stand_off)
    memory.moving[:] = (dynamics.role == SIMULATED) | (drive.coupled == 1)
    velocities = Velocities(world.velocities.linear.copy(), world.velocities.angular.copy())
    pairs = np.array(meeting_pairs(world, within), dtype=np.int64).reshape(-1, 2)
    return ForceParts(
        dynamics, velocities, memory, pairs, np.array([within]), np.flatnonzero(memory.moving).astype(np.int64),
    )


def _pose_joints(world: World) -> None:
    """Pose the joints of the linkages as shown."""
    joints = world.drive.linkage.joints
    for into, of in zip(joints, world.posture, strict=True):
        into[...] = of


def felt(frames: Frames, avatar: int) -> Array:
    """Return the force of the spring on the user of each link of an avatar [N], world axes."""
    world, first = frames.world, frames.world.skeleton.first
    links = [len(one.links) for one in world.scene.avatars]
    begin = first + sum(links[:avatar])
    rows = slice(begin, begin + links[avatar])
    if not isinstance(frames.lower, IkLoop) or frames.lower.trackers.turn[0] < 0:
        return np.full((links[avatar], 3), np.nan)
    _, now = last_and_now(frames.lower.trackers)
    drive = world.drive
    there = np.where(drive.coupled[rows, None] == 1, drive.position[rows], now.position[rows])
    force = drive.stiffness[rows, None] * (world.poses.position[rows] - there)
    size = np.linalg.norm(force, axis=1, keepdims=True)
    return np.asarray(force * np.minimum(1.0, drive.largest_force[rows, None] / np.maximum(size, 1e-300)))
