"""Rigid avatars that loose bodies lean on: the lower loop leaves them to the upper one, and takes them up again afterwards."""

from math import log

from avatarsim.coupling.virtual_coupling import TOP_SPEED, TOP_SPIN, limited
from avatarsim.ik.kinematics import place_avatar
from avatarsim.ik.sqp_step import copy_poses, forget_forces
from avatarsim.ik.state import Avatars, Budget, Contacts, IkScratch, IkState
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED, Drive, Dynamics, Velocities
from avatarsim.model.geometry import Array, Geometry, Poses
from avatarsim.model.skeleton import FREE, Posture, Skeleton
from avatarsim.spatial.tangent import columns, put_columns, turn_of
from avatarsim.spatial.vec3 import Vec3, add, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED


def allow(drive: Drive, skel: Skeleton, spring: float, damping: float) -> None:
    """Let the upper loop move rigid avatars under load, with these constants of eq. 6."""
    for link in range(len(skel.kind)):
        alone = skel.kind[link] == FREE and not (skel.parent == link).any()
        drive.may_couple[skel.first + link] = int(alone)
    drive.stiffness[:], drive.damping[:] = spring, damping


@kernel
def time_to_catch_up(drive: Drive, b: int) -> float:
    """Time [s] in which eq. 6 leaves JUDGED of a lag: it decays with R / 2m, or with K / R if damped above critically."""
    m, r, k = drive.mass[b], drive.damping[b], drive.stiffness[b]
    return -log(JUDGED) / min(0.5 * r / m, k / r) if r > 0.0 else 0.0


@kernel
def note_blocked(geo: Geometry, dynamics: Dynamics, contacts: Contacts) -> None:
    """Mark the driven bodies that loose ones held back in the lower loop."""
    for k in range(contacts.used[0]):
        a, b = geo.body[contacts.pair[k, 0]], geo.body[contacts.pair[k, 1]]
        if dynamics.role[b] == SIMULATED:
            dynamics.drive.loaded[a] = 1


@kernel
def accelerate(v: Vec3, b: int, dt: float, velocity_out: Array, gained_out: Array, ramp_out: Array) -> None:
    """Take over the mean velocity v of a frame, and how it changes within: as from the last frame to this, if it has before.

    The slope of a piecewise linear reconstruction with the minmod limiter (van Leer 1979): a velocity in steps would ask in the
    first substep of a frame for the friction of all of them, and without the limiter a hand that stops would swing.
    """
    for i in range(3):
        gained, before = v[i] - velocity_out[b, i], gained_out[b, i]
        ramp_out[b, i] = (gained if abs(gained) < abs(before) else before) / dt if gained * before > 0.0 else 0.0
        velocity_out[b, i], gained_out[b, i] = v[i], gained


@kernel
def leave(
    skel: Skeleton, avatars: Avatars, dynamics: Dynamics, before: Poses, now: Poses, posture: Posture, dt: float, rate: Array,
    target_out: Posture, velocities_out: Velocities,
) -> None:
    """Leave avatars under load where they are, and tell the upper loop where their trackers go in dt seconds.

    before, now: where the tracker has the links at the start and at the end of the frame; rate (nl, 3): velocity of links against
    it [m/s].
    """
    drive = dynamics.drive
    for link in range(skel.kind.shape[0]):
        b = skel.first + link
        if drive.may_couple[b] == 0:
            continue
        way = sub(row(now.position, b), row(before.position, b))
        turn = turn_of(columns(before.rotation, b), columns(now.rotation, b))
        put_row(drive.position, b, row(now.position, b))
        put_columns(drive.turn, b, columns(now.rotation, b))
        accelerate(limited(scale(way, 1.0 / dt), TOP_SPEED), b, dt, drive.linear, drive.gained, drive.ramp)
        accelerate(limited(scale(turn, 1.0 / dt), TOP_SPIN), b, dt, drive.angular, drive.gained_turn, drive.ramp_turn)
        if drive.coupled[b] == 0 and drive.loaded[b] == 1:
            drive.coupled[b] = 1
            put_row(drive.lag, b, row(rate, link))
            put_row(drive.lag_turn, b, (0.0, 0.0, 0.0))
        drive.unloaded[b] = 0.0 if drive.loaded[b] == 1 else drive.unloaded[b] + dt
        drive.loaded[b] = 0
        if drive.unloaded[b] > time_to_catch_up(drive, b):
            drive.coupled[b] = 0
        if drive.coupled[b] == 1:
            copy_posture(skel, avatars, avatars.avatar[link], posture, target_out)
            put_row(velocities_out.linear, b, add(row(drive.linear, b), row(drive.lag, b)))
            put_row(velocities_out.angular, b, add(row(drive.angular, b), row(drive.lag_turn, b)))


@kernel
def keep_still(skel: Skeleton, dynamics: Dynamics, budget_out: Budget) -> None:
    """Leave no motion to coupled avatars in the lower loop."""
    for link in range(skel.kind.shape[0]):
        if dynamics.drive.coupled[skel.first + link] == 1:
            budget_out.move[link], budget_out.turn[link] = 0.0, 0.0


@kernel
def take_up(
    geo: Geometry, skel: Skeleton, avatars: Avatars, dynamics: Dynamics, poses: Poses, offset_out: Array, rate_out: Array,
    posture_out: Posture, target_out: Posture, state_out: IkState, scratch_out: IkScratch,
) -> None:
    """After the upper loop: coupled avatars are where it has moved them, and stay there for the rest of the frame.

    Their offsets and rates (nl, 3) against the tracker are kept, so that eq. 6 goes on from there once they are let go.
    """
    drive, found = dynamics.drive, False
    for link in range(skel.kind.shape[0]):
        b, avatar = skel.first + link, avatars.avatar[link]
        if drive.coupled[b] == 0:
            continue
        found = True
        put_row(posture_out.root, link, row(poses.position, b))
        put_columns(posture_out.turn, link, columns(poses.rotation, b))
        copy_posture(skel, avatars, avatar, posture_out, target_out)
        put_row(offset_out, link, sub(row(poses.position, b), row(drive.position, b)))
        put_row(rate_out, link, row(drive.lag, b))
        place_avatar(geo, skel, avatars, avatar, poses)
        copy_poses(geo, skel, avatars, avatar, poses, scratch_out.trial)
        forget_forces(avatars, avatar, state_out)
    if found:
        state_out.pairs.step[0] += 1
