"""Where tracker, posture and impacts meet: eq. 6 on the offset that collisions leave between a driven link and its tracker.

In free motion there is no offset and no lag. A collision changes the velocity of the coupled mass of the link that was hit, of
no other; the spring between it and the tracker brings it back, by the exact solution for any frame time. Offsets of free roots
displace the whole avatar, those of other links bend the joints that hold them (`reaction.py`).

Velocities of driven links projected onto the non-penetration cone of active contacts with fixed bodies, before impacts.
"""

from math import ceil, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.reaction import joint_weights, recoil
from avatarsim.coupling.spring import coupled, press
from avatarsim.ik.state import Contacts
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Line, Vectors
from avatarsim.model.dynamics import FIXED, DriveState, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.model.skeleton import FREE, Posture, Skeleton, carry, displace
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.tangent import columns, turn_of
from avatarsim.spatial.vec3 import add, along, dot, limited, norm, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED, NOTHING

ROUNDS = ceil(log(JUDGED, 0.25))
"""Times that all that holds a link is gone through: what one wall leaves may go into another. In a corner of 60 degrees each time
leaves a quarter of that, so that JUDGED of it is left; fewer would leave a hand in a corner a velocity."""


@kernel
def hold(geo: Geometry, dynamics: Dynamics, contacts: Contacts, velocities_out: Velocities) -> None:
    """Take from the velocity of each link what goes into the fixed bodies that held it last; what goes along them stays.

    A hand at a wall stands still while its user goes on: a ball that meets it must not be struck with the user's velocity. A link
    held by simulated bodies keeps its velocity, by which it pushes them.
    """
    v = velocities_out.linear
    for _ in range(ROUNDS):
        done = True
        for k in range(contacts.used[0]):
            a, other = contacts.pair[k, 0], contacts.pair[k, 1]
            if dynamics.role[geo.body[other]] == FIXED:
                n, b = row(contacts.normal, k), geo.body[a]
                into = dot(row(v, b), n)
                if into < 0.0:
                    put_row(v, b, along(row(v, b), -into, n))
                    done = False
        if done:
            break


Array = NDArray[np.float64]
Index = NDArray[np.int64]

TOP_SPEED = 30.0
"""[m/s] fastest that a driven body hits anything; a tracker that teleports would shoot objects away at any speed."""

TOP_SPIN = 60.0
"""[rad/s] the same for its rotation: ten turns a second."""


class Springs(NamedTuple):
    """The springs of all links of a world.

    offset, rate (nl, 3) against the tracker [m], [m/s]; pressed (nl, 3) the part of the rate that `press`
    added [m/s]; inverse_weight (nd) of a degree where joints share an offset; still (nd) no step; axes
    (nd, 3) of the degrees at the tracker's posture, world axes; way (nd) the step by which its joints yield [rad], or its roots
    [m]; one, other: where the tracker has the links in this frame and in the last, taking turns by turn (1), with boxes only of
    links with an offset.
    """

    offset: Vectors
    rate: Vectors
    pressed: Vectors
    inverse_weight: Line
    still: Line
    axes: Vectors
    way: Line
    one: Poses
    other: Poses
    turn: IndexLine


@kernel
def tracked_velocities(skel: Skeleton, before: Poses, now: Poses, rate: Array, dt: float, velocities_out: Velocities) -> None:
    """Velocity of every link as its tracker moves it, plus its own and that of its free root against the tracker."""
    for b in range(skel.first, now.position.shape[0]):
        link = b - skel.first
        root, against = root_of(skel, link), row(rate, link)
        if root != link and skel.kind[root] == FREE:
            against = add(against, row(rate, root))
        way = sub(row(now.position, b), row(before.position, b))
        put_row(velocities_out.linear, b, add(limited(scale(way, 1.0 / dt), TOP_SPEED), against))
        turn = turn_of(columns(before.rotation, b), columns(now.rotation, b))
        put_row(velocities_out.angular, b, limited(scale(turn, 1.0 / dt), TOP_SPIN))


@kernel
def relax(
    skel: Skeleton, drive: DriveState, dt: float, offset_out: Array, rate_out: Array, root_out: Array
) -> None:
    """Eq. 6 over dt for the offset of every link; that of a free root then displaces its target."""
    for link in range(skel.kind.shape[0]):
        x, v = row(offset_out, link), row(rate_out, link)
        if norm(x) == 0.0 and norm(v) == 0.0:
            continue
        b = skel.first + link
        x, v = coupled(drive.mass[b], drive.stiffness[b], drive.damping[b], x, v, dt)
        # below what shows, so that a coupling at rest costs nothing
        if norm(x) < NOTHING and norm(v) < NOTHING:
            x, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        put_row(offset_out, link, x)
        put_row(rate_out, link, v)
        if skel.kind[link] == FREE:
            put_row(root_out, link, add(row(root_out, link), x))


@kernel
def root_of(skel: Skeleton, link: int) -> int:
    """The root of a link's avatar."""
    while skel.parent[link] >= 0:
        link = skel.parent[link]
    return link


@kernel
def give(skel: Skeleton, received: Array, inverse_mass: Array, pressed: Array, rate_out: Array) -> None:
    """Impulses (nb, 3) [N s] change the velocity of the coupled mass that took them: the link's own, as in eq. 9.

    A link that pressed and had no impact has not moved: it loses the velocity of pressing.
    """
    for link in range(skel.kind.shape[0]):
        j, b = row(received, skel.first + link), skel.first + link
        if dot(j, j) == 0.0:
            put_row(rate_out, link, sub(row(rate_out, link), row(pressed, link)))
        else:
            put_row(rate_out, link, add(row(rate_out, link), scale(j, inverse_mass[b])))


@kernel
def give_to_roots(skel: Skeleton, received: Array, inverse_mass: Array, rate_out: Array) -> None:
    """The same where only roots have springs (method `paper`): every impulse moves the coupled mass of the root."""
    for link in range(skel.kind.shape[0]):
        root = root_of(skel, link)
        if skel.kind[root] == FREE:
            gained = scale(row(received, skel.first + link), inverse_mass[skel.first + root])
            put_row(rate_out, root, add(row(rate_out, root), gained))


@kernel
def place_displaced(geo: Geometry, skel: Skeleton, offset: Array, poses_out: Poses) -> None:
    """Update the boxes of the links that have an offset (nl, 3); only their middles are read."""
    for link in range(skel.kind.shape[0]):
        x = row(offset, link)
        if dot(x, x) > 0.0:
            place(geo, poses_out, skel.first + link)


@kernel
def turned_over(springs_out: Springs) -> tuple[Poses, Poses]:
    """Where the tracker had the links in the last frame, and room for where it has them in this one."""
    springs_out.turn[0] = 1 - springs_out.turn[0]
    return tracked(springs_out)


@kernel
def tracked(springs: Springs) -> tuple[Poses, Poses]:
    """Where the tracker had the links in the last frame, and where it has them in this one."""
    if springs.turn[0] == 1:
        return springs.one, springs.other
    return springs.other, springs.one


@kernel
def strike(skel: Skeleton, target: Posture, dt: float, velocities_out: Velocities, springs_out: Springs) -> None:
    """Set the velocities of driven bodies that no impact displaces: those of their tracker."""
    s = springs_out
    before, now = turned_over(s)
    carry(skel, target, s.still, now, s.axes)
    tracked_velocities(skel, before, now, s.rate, dt, velocities_out)


@kernel
def pull(
    geo: Geometry, skel: Skeleton, dynamics: Dynamics, shown: Poses, contacts: Contacts, dt: float,
    target_out: Posture, velocities_out: Velocities, springs_out: Springs,
) -> None:
    """Let the springs act for dt, displace the target by their offsets and set the velocities of driven bodies.

    shown: poses at the end of the last frame; contacts: what held them there.
    """
    s = springs_out
    before, now = turned_over(s)
    carry(skel, target_out, s.still, now, s.axes)
    # with the offsets of the last frame, which the shown poses belong to
    press(geo, skel, dynamics, contacts, shown, s.offset, dt, before, s.pressed)
    relax(skel, dynamics.drive, dt, s.offset, s.rate, target_out.root)
    for link in range(skel.kind.shape[0]):
        put_row(s.rate, link, add(row(s.rate, link), row(s.pressed, link)))
    place_displaced(geo, skel, s.offset, now)
    if recoil(skel, target_out, now, s.axes, s.offset, s.inverse_weight, s.way):
        # a user beyond limits is taken as he is
        displace(skel, target_out, s.way)
    tracked_velocities(skel, before, now, s.rate, dt, velocities_out)
    hold(geo, dynamics, contacts, velocities_out)


def make_springs(
    geo: Geometry, skel: Skeleton, dynamics: Dynamics, posture: Posture, poses: Poses, settings: CouplingSettings
) -> Springs:
    """Springs at rest, for driven bodies that stand at `posture` and `poses`; the settings are of those without a drive."""
    drive = dynamics.drive
    for constants, value in ((drive.stiffness, settings.spring), (drive.damping, settings.damping)):
        constants[np.isnan(constants)] = value
    links, degrees = len(skel.kind), int(skel.first_dof[-1])
    still, axes = np.zeros(degrees), np.zeros((degrees, 3))
    one, other = (Poses(*(array.copy() for array in poses)) for _ in range(2))
    carry(skel, posture, still, one, axes)
    return Springs(
        np.zeros((links, 3)), np.zeros((links, 3)), np.zeros((links, 3)), 1.0 / joint_weights(geo, skel, one, axes), still,
        np.zeros((degrees, 3)), np.zeros(degrees), one, other, np.zeros(1, dtype=np.int64),
    )


def no_springs(poses: Poses) -> Springs:
    """For a scene in which nothing can be struck: empty arrays."""
    none, rows = np.zeros(0), np.zeros((0, 3))
    nowhere = Poses(*(array[:0].copy() for array in poses))
    return Springs(rows, rows, rows, none, none, rows, none, nowhere, nowhere, np.zeros(1, dtype=np.int64))
