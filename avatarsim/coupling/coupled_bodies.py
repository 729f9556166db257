"""Coupled avatars: transfer of avatars under load from the lower loop to the upper loop, and back."""

from math import log

import numpy as np

from avatarsim.collision.path import spun
from avatarsim.coupling.tracked_motion import TOP_SPEED, TOP_SPIN
from avatarsim.ik.inertia import minmod
from avatarsim.ik.kinematics import place_avatar
from avatarsim.ik.sqp_step import copy_poses, forget_forces
from avatarsim.ik.state import Avatars, Contacts, IkScratch, IkState, Rig
from avatarsim.ik.target import clip_avatar, copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import set_followers
from avatarsim.model.dynamics import DRIVEN, DriveState, Dynamics, Velocities
from avatarsim.model.geometry import Array, Geometry, Poses
from avatarsim.model.skeleton import BALL, FREE, Posture, Skeleton
from avatarsim.rigid.driven import presses
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, put_columns, turn_of
from avatarsim.spatial.vec3 import Vec3, add, along, dot, limited, norm, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED

LONGEST_PAUSE = 0.1
"""Longest interval [s] between two samples of a tracker, 10 Hz. Longer: the first frame after a rest is late; shorter: steps of
slow trackers make a grip slip."""


def enable_coupling(drive: DriveState, skel: Skeleton, posture: PostureSettings) -> None:
    """Mark all avatars as movable by the upper loop, and set the limits of their catch-up velocity."""
    drive.fastest[:], drive.fastest_turn[:] = posture.catch_up_move, posture.catch_up_turn
    drive.may_couple[skel.first :] = 1
    link_together(drive, skel)


def link_together(drive: DriveState, skel: Skeleton) -> None:
    """Mark avatars whose links the upper loop moves together: those with joints, and those that carry something."""
    leader = drive.tied[skel.first :]
    for root in np.unique(leader):
        links = np.flatnonzero(leader == root)
        carries = bool(np.isin(drive.carrier, skel.first + links).any())
        drive.linked[skel.first + links] = int(len(links) > 1 or skel.kind[links[0]] != FREE or carries)


@kernel
def time_to_catch_up(drive: DriveState, avatars: Avatars, avatar: int, first: int) -> float:
    """Return the time [s] in which eq. 6 reduces the lag of any link to JUDGED of itself: rate R / 2m, or K / R if overdamped."""
    slowest = 0.0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        m, r, k = drive.mass[first + link], drive.damping[first + link], drive.stiffness[first + link]
        if r > 0.0:
            # without a spring there is no lag, only a velocity
            slowest = max(slowest, -log(JUDGED) / (min(0.5 * r / m, k / r) if k > 0.0 else r / m))
    return slowest


@kernel
def note_blocked(geo: Geometry, dynamics: Dynamics, contacts: Contacts) -> None:
    """Mark driven bodies that a loose body, or a moving one that gives way, blocked in the lower loop."""
    for k in range(contacts.used[0]):
        a, b = geo.body[contacts.pair[k, 0]], geo.body[contacts.pair[k, 1]]
        if presses(dynamics, b) or presses(dynamics, a):
            dynamics.drive.loaded[a] = 1
            if dynamics.role[b] == DRIVEN:
                dynamics.drive.loaded[b] = 1


ACCELERATES = 0.5 * LONGEST_PAUSE
"""[s] over which the acceleration of a tracker is low-passed, above which it is noise. Longer: hands under load lag behind quick
motion; shorter: noise shakes off held bodies."""


@kernel
def share_of_noise(drive: DriveState, b: int) -> float:
    """Return the share of the noise of a tracker's velocity that the inertia of a body resists.

    Less than 1 for bodies whose time constant sqrt(m / K) exceeds ACCELERATES: a heavy torso would sway behind its tracker. The
    given poses of moving bodies have none.
    """
    if drive.moves[b] == 1:
        return 0.0
    return float(min(1.0, drive.stiffness[b] * ACCELERATES * ACCELERATES / drive.mass[b]))


@kernel
def accelerate(
    v: Vec3, b: int, dt: float, share: float, velocity_out: Array, gained_out: Array, ramp_out: Array, lag_out: Array
) -> None:
    """Store the mean velocity v of a frame and its slope within the frame.

    Piecewise linear reconstruction with the minmod limiter (van Leer 1979). A piecewise constant velocity concentrates the
    friction of a frame in its first substep; without the limiter a hand overshoots when it stops. A gain of the velocity beyond
    its low-passed gain is noise: the inertia of the body resists it, so the lag velocity changes by a share of it.
    """
    keeps = ACCELERATES / (ACCELERATES + dt)
    for i in range(3):
        gained = v[i] - velocity_out[b, i]
        smooth = gained + keeps * (gained_out[b, i] - gained)
        ramp_out[b, i] = minmod(gained, smooth) / dt
        lag_out[b, i] -= share * (gained - smooth)
        velocity_out[b, i], gained_out[b, i] = v[i], smooth


@kernel
def load(drive: DriveState, avatars: Avatars, link: int, first: int) -> None:
    """Mark a link as loaded if any link of its avatar is."""
    avatar = avatars.avatar[link]
    for other in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        if drive.loaded[first + other] == 1:
            drive.loaded[first + link] = 1


@kernel
def couple(drive: DriveState, before: Poses, now: Poses, b: int, dt: float) -> None:
    """Couple body b, with its tracker at the start of the frame."""
    drive.coupled[b], drive.paused[b], drive.spread[b] = 1, 0, 0
    put_row(drive.offset, b, (0.0, 0.0, 0.0))
    put_row(drive.position, b, row(before.position, b))
    put_columns(drive.turn, b, columns(before.rotation, b))
    turn = turn_of(columns(before.rotation, b), columns(now.rotation, b))
    put_row(drive.linear, b, scale(sub(row(now.position, b), row(before.position, b)), 1.0 / dt))
    put_row(drive.angular, b, scale(turn, 1.0 / dt))
    for rest in (drive.lag_turn, drive.gained, drive.gained_turn, drive.ramp, drive.ramp_turn):
        put_row(rest, b, (0.0, 0.0, 0.0))


@kernel
def follow(drive: DriveState, before: Poses, now: Poses, b: int, dt: float) -> tuple[Vec3, Vec3]:
    """Compute the tracked pose of body b at the end of a frame of dt seconds; return its translation [m] and rotation [rad].

    A tracker with a lower rate than the frames repeats its samples. Its next step is interpolated over as many frames as it
    repeated one.
    """
    x, r = row(before.position, b), columns(before.rotation, b)
    step, turn = sub(row(now.position, b), x), turn_of(r, columns(now.rotation, b))
    if drive.moves[b] == 1:
        # its pose is given for every frame
        drive.paused[b], drive.spread[b] = 0, 0
    elif dot(step, step) + dot(turn, turn) == 0.0:
        drive.paused[b] = min(drive.paused[b] + 1, int(LONGEST_PAUSE / dt))
    else:
        drive.spread[b], drive.paused[b] = drive.paused[b], 0
    x, r = row(drive.position, b), columns(drive.turn, b)
    step, turn = sub(row(now.position, b), x), turn_of(r, columns(now.rotation, b))
    share = 1.0 / (1.0 + drive.spread[b])
    drive.spread[b] = max(0, drive.spread[b] - 1)
    put_row(drive.position, b, along(x, share, step))
    put_columns(drive.turn, b, spun(r, turn, share) if share < 1.0 else columns(now.rotation, b))
    return scale(step, share), scale(turn, share)


@kernel
def exclude_coupled(
    rig: Rig, dynamics: Dynamics, before: Poses, now: Poses, posture: Posture, dt: float, target_out: Posture,
    velocities_out: Velocities,
) -> None:
    """Exclude coupled avatars and moving bodies from the lower loop, and compute the motion of their trackers in dt seconds.

    Args:
        before, now: tracked poses of the links at the start and at the end of the frame.
    """
    skel, avatars = rig.skel, rig.avatars
    drive = dynamics.drive
    for b in range(drive.carrier.shape[0]):
        if drive.carrier[b] >= 0:
            drive.loaded[drive.carrier[b]] = 1
    for link in range(skel.kind.shape[0]):
        b = skel.first + link
        if drive.may_couple[b] == 0:
            continue
        load(drive, avatars, link, skel.first)
        if drive.coupled[b] + drive.loaded[b] == 0:
            if drive.moves[b] == 1:
                take_out(rig, drive, link, posture, target_out)
            continue
        if drive.coupled[b] == 0:
            couple(drive, before, now, b, dt)
        step, turn = follow(drive, before, now, b, dt)
        top = min(TOP_SPEED, drive.fastest[b]) if drive.moves[b] == 1 else TOP_SPEED
        v, w, share = limited(scale(step, 1.0 / dt), top), limited(scale(turn, 1.0 / dt), TOP_SPIN), share_of_noise(drive, b)
        accelerate(v, b, dt, share, drive.linear, drive.gained, drive.ramp, drive.lag)
        accelerate(w, b, dt, share, drive.angular, drive.gained_turn, drive.ramp_turn, drive.lag_turn)
        drive.unloaded[b] = 0.0 if drive.loaded[b] == 1 else drive.unloaded[b] + dt
        if drive.unloaded[b] > time_to_catch_up(drive, avatars, avatars.avatar[link], skel.first):
            drive.coupled[b], drive.blocked[b], drive.blocked_turn[b] = 0, 0, 0
            put_row(drive.lag, b, (0.0, 0.0, 0.0))
            put_row(drive.offset, b, (0.0, 0.0, 0.0))
        if drive.coupled[b] + drive.moves[b] > 0:
            take_out(rig, drive, link, posture, target_out)
        if drive.coupled[b] == 1:
            put_row(velocities_out.linear, b, add(row(drive.linear, b), row(drive.lag, b)))
            put_row(velocities_out.angular, b, add(row(drive.angular, b), row(drive.lag_turn, b)))
    for link in range(skel.kind.shape[0]):
        drive.loaded[skel.first + link] = 0


@kernel
def take_out(rig: Rig, drive: DriveState, link: int, posture: Posture, target_out: Posture) -> None:
    """Let the lower loop leave the avatar of a root link as it is; the upper loop knows its tracked posture."""
    skel = rig.skel
    avatar = rig.avatars.avatar[link]
    if drive.tied[skel.first + link] == skel.first + link:
        copy_posture(rig, avatar, target_out, drive.linkage.user)
        copy_posture(rig, avatar, posture, target_out)
        copy_posture(rig, avatar, posture, drive.linkage.joints)


@kernel
def freeze_coupled(rig: Rig, dynamics: Dynamics, state_out: IkState) -> None:
    """Set the motion budget of coupled avatars and moving bodies to zero, and their last target to the tracked posture.

    The speed of the tracker and an eased start limit how fast a released avatar makes up its lag.
    """
    skel, avatars = rig.skel, rig.avatars
    drive = dynamics.drive
    for link in range(skel.kind.shape[0]):
        b = skel.first + link
        if drive.coupled[b] + drive.moves[b] * drive.may_couple[b] > 0:
            state_out.budget.move[link], state_out.budget.turn[link] = 0.0, 0.0
            speed, tracking, avatar = norm(row(drive.linear, b)), state_out.tracking, avatars.avatar[link]
            tracking.speed[avatar] = speed if drive.tied[b] == b else max(tracking.speed[avatar], speed)
            tracking.ease[avatar], tracking.is_led[avatar] = 0.0, 1
            if drive.tied[b] == b:
                clip_avatar(rig, avatar, drive.linkage.user, tracking, state_out.target_before)
                copy_posture(rig, avatars.avatar[link], drive.linkage.user, state_out.tracker_before)


@kernel
def return_coupled(
    rig: Rig, dynamics: Dynamics, poses: Poses, posture_out: Posture, target_out: Posture, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Copy the poses of coupled avatars from the upper loop into the posture and the target of the lower loop."""
    skel, avatars = rig.skel, rig.avatars
    drive, found = dynamics.drive, False
    for link in range(skel.kind.shape[0]):
        b, avatar = skel.first + link, avatars.avatar[link]
        if drive.coupled[b] == 0:
            continue
        found = True
        if skel.kind[link] == FREE:
            put_row(posture_out.root, link, row(poses.position, b))
            put_columns(posture_out.turn, link, columns(poses.rotation, b))
            put_row(drive.offset, b, sub(row(poses.position, b), row(drive.position, b)))
        elif skel.kind[link] == BALL:
            put_columns(posture_out.turn, link, columns(drive.linkage.joints.turn, link))
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            posture_out.angle[j] = drive.linkage.joints.angle[j]
        set_followers(skel, skel.first_dof[link], skel.first_dof[link + 1], 0.0, posture_out)
        copy_posture(rig, avatar, posture_out, target_out)
        place_avatar(rig, avatar, poses)
        copy_poses(rig, avatar, poses, scratch_out.trial)
        forget_forces(avatars, avatar, state_out)
    if found:
        state_out.pairs.step[0] += 1
