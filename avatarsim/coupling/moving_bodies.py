"""Moving bodies in the coupling: when the upper loop moves them, and which avatars they put under load."""

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DriveState, Dynamics
from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import Skeleton
from avatarsim.spatial.tangent import columns, turn_of
from avatarsim.spatial.vec3 import dot, norm, row, sub
from avatarsim.tolerances import JUDGED


@kernel
def is_target_still(before: Poses, now: Poses, b: int) -> bool:
    """Return whether the given pose of body b is equal at the start and at the end of the frame."""
    same = True
    for i in range(3):
        same = same and before.position[b, i] == now.position[b, i]
        for k in range(3):
            same = same and before.rotation[b, i, k] == now.rotation[b, i, k]
    return bool(same)


@kernel
def carries(drive: DriveState, b: int) -> bool:
    """Return whether a body is attached to body b."""
    for other in range(drive.carrier.shape[0]):
        if drive.carrier[other] == b:
            return True
    return False


@kernel
def is_lagging(drive: DriveState, poses: Poses, now: Poses, b: int) -> bool:
    """Return whether body b is shown elsewhere than at its given pose."""
    if drive.stiffness[b] == 0.0:
        return False
    turn = norm(turn_of(columns(poses.rotation, b), columns(now.rotation, b)))
    return bool(norm(sub(row(now.position, b), row(poses.position, b))) + turn > JUDGED)


@kernel
def is_active(dynamics: Dynamics, poses: Poses, before: Poses, now: Poses, b: int) -> bool:
    """Return whether the upper loop has to move body b in this frame: it moves, is blocked, or was pushed.

    A body at rest counts as fixed, so that loose bodies on it can sleep.
    """
    drive, surface = dynamics.drive, row(dynamics.surface, b)
    if drive.coupled[b] == 1:
        speed, blocked = norm(row(drive.lag, b)) + norm(row(drive.lag_turn, b)), drive.blocked[b] + drive.blocked_turn[b] > 0
        if blocked or speed > JUDGED or (drive.loaded[b] == 0 and is_lagging(drive, poses, now, b)):
            return True
    pushed = drive.stiffness[b] == 0.0 and drive.loaded[b] == 1
    return bool(pushed or carries(drive, b) or dot(surface, surface) > 0.0 or not is_target_still(before, now, b))


@kernel
def goes_at_most(drive: DriveState, poses: Poses, before: Poses, now: Poses, b: int, dt: float) -> float:
    """Return a bound of the way [m] of the points of body b in dt seconds.

    The step of its tracker and the making up of its lag; without a spring its velocity.
    """
    hulls, diagonal = poses.hulls, 0.0
    for i in range(3):
        diagonal += (hulls[b, 3 + i] - hulls[b, i]) ** 2
    # the origin may be outside of the pieces
    far = diagonal**0.5 + norm(sub(row(poses.position, b), (hulls[b, 0], hulls[b, 1], hulls[b, 2])))
    if drive.stiffness[b] == 0.0:
        return float(dt * (norm(row(drive.lag, b)) + norm(row(drive.lag_turn, b)) * far))
    turn = norm(turn_of(columns(poses.rotation, b), columns(now.rotation, b)))
    most_turn = norm(turn_of(columns(before.rotation, b), columns(now.rotation, b))) + dt * drive.fastest_turn[b]
    distance = norm(sub(row(now.position, b), row(poses.position, b)))
    most = norm(sub(row(now.position, b), row(before.position, b))) + dt * drive.fastest[b]
    return float(min(distance, most) + min(2.0, turn, most_turn) * far)


@kernel
def load_near(
    skel: Skeleton, drive: DriveState, poses: Poses, before: Poses, now: Poses, b: int, dt: float, room: float
) -> bool:
    """Put under load the avatars that body b may come nearer to than ``room`` [m] in this frame; return whether there are any."""
    hulls, reach, any_ = poses.hulls, room + goes_at_most(drive, poses, before, now, b, dt), False
    for link in range(skel.kind.shape[0]):
        other = skel.first + link
        if drive.moves[other] == 1 or drive.loaded[other] == 1:
            continue
        apart, far = False, reach + goes_at_most(drive, poses, before, now, other, dt)
        for i in range(3):
            apart = apart or hulls[other, i] - hulls[b, 3 + i] > far or hulls[b, i] - hulls[other, 3 + i] > far
        if not apart:
            any_ = True
            for mate in range(skel.kind.shape[0]):
                if drive.tied[skel.first + mate] == drive.tied[other]:
                    drive.loaded[skel.first + mate] = 1
    return any_


@kernel
def load_moving(
    skel: Skeleton, dynamics: Dynamics, poses: Poses, before: Poses, now: Poses, dt: float, room: float
) -> None:
    """Mark as loaded: moving bodies that the upper loop has to move, avatars that they may touch, and those that these may touch.

    Args:
        poses: that are shown. before, now: given poses at the start and at the end of the frame.
        room: [m] between touching bodies.
    """
    drive, again = dynamics.drive, False
    for link in range(skel.kind.shape[0]):
        b = skel.first + link
        if drive.moves[b] * drive.may_couple[b] == 1:
            drive.loaded[b] = 1 if is_active(dynamics, poses, before, now, b) else 0
            if drive.coupled[b] + drive.loaded[b] > 0:
                again = load_near(skel, drive, poses, before, now, b, dt, room) or again
    while again:
        again = False
        for link in range(skel.kind.shape[0]):
            b = skel.first + link
            if drive.moves[b] == 0 and drive.loaded[b] == 1:
                again = load_near(skel, drive, poses, before, now, b, dt, room) or again
