"""Target of a frame: the tracker's posture clipped to the limits of joints, and how it moved since the last frame."""

from math import exp, floor, pi

from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.motion_budget import AT_REST, open_budget
from avatarsim.ik.state import IkScratch, IkState, Rig, Tracking
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import set_followers
from avatarsim.model.geometry import Array
from avatarsim.model.joint_limits import LEFT_ALONE, has_cone, inside_cone, surely_inside
from avatarsim.model.skeleton import BALL, FREE, HINGES, Posture, has_angles
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row


@kernel
def clip_to_limits(rig: Rig, tracker: Posture, tracking_out: Tracking, target_out: Posture) -> None:
    """Clip the tracker's posture: each joint to the nearest place inside its own limits, followers to where their leaders have
    them; mark avatars that keep them all."""
    for avatar in range(rig.avatars.first_link.shape[0] - 1):
        clip_avatar(rig, avatar, tracker, tracking_out, target_out)


@kernel
def clip_avatar(rig: Rig, avatar: int, tracker: Posture, tracking_out: Tracking, target_out: Posture) -> None:
    """Clip the tracker's posture of one avatar."""
    skel, avatars = rig.skel, rig.avatars
    tracking_out.is_legal[avatar] = 1
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        kind, turn = skel.kind[link], columns(tracker.turn, link)
        put_row(target_out.root, link, row(tracker.root, link))
        if kind == BALL and has_cone(skel.balls, link) and not surely_inside(skel.balls, link, turn, LEFT_ALONE):
            clipped = inside_cone(skel.balls, link, turn)
            if clipped != turn:
                tracking_out.is_legal[avatar] = 0
            turn = clipped
        put_columns(target_out.turn, link, turn)
        if has_angles(skel, link):
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                angle = min(max(tracker.angle[j], skel.limits[j, 0]), skel.limits[j, 1])
                if angle != tracker.angle[j]:
                    tracking_out.is_legal[avatar] = 0
                target_out.angle[j] = angle
    if set_followers(skel, avatars.first_dof[avatar], avatars.first_dof[avatar + 1], 0.0, target_out) > 0.0:
        tracking_out.is_legal[avatar] = 0


@kernel
def copy_posture(rig: Rig, avatar: int, posture: Posture, posture_out: Posture) -> None:
    """Copy the posture of one avatar."""
    skel, avatars = rig.skel, rig.avatars
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        kind = skel.kind[link]
        if kind == FREE:
            put_row(posture_out.root, link, row(posture.root, link))
        if kind == FREE or kind == BALL:
            put_columns(posture_out.turn, link, columns(posture.turn, link))
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            posture_out.angle[j] = posture.angle[j]


@kernel
def largest(values: Array, first: int, last: int) -> float:
    """Return the largest absolute value of those from first to last."""
    most = 0.0
    for j in range(first, last):
        most = max(most, abs(values[j]))
    return most


@kernel
def drop_whole_turns(rig: Rig, avatar: int, step_out: Array) -> None:
    """Make the turns of hinges in a step (nd) at most half a turn: an angle that jumps by 2 pi means the same posture."""
    skel, avatars = rig.skel, rig.avatars
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        for j in range(skel.first_dof[link], skel.first_dof[link + 1] if skel.kind[link] == HINGES else 0):
            step_out[j] -= 2.0 * pi * floor(step_out[j] / (2.0 * pi) + 0.5)


@kernel
def open_budgets(
    rig: Rig, settings: PostureSettings, tracker: Posture, dt: float, has_changed: bool, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Open the budgets of a frame from how far the target went since the last one; islands are formed.

    Writes ``objective.target_motion``, which later stages follow, the budgets, speed and ease of tracking, and this frame's
    target and tracker as ``target_before`` and ``tracker_before`` of the next.

    has_changed: whether a body that is no link moved, which may set an avatar free whose target holds still."""
    avatars = rig.avatars
    s, tracking, least = state_out, state_out.tracking, AT_REST if has_changed else 0.0
    # ways since the last frame: of the clipped target, and of the tracker's own posture
    target_motion, tracker_motion, keeps = scratch_out.objective.target_motion, scratch_out.step, exp(-dt / settings.settle_time)
    for avatar in range(avatars.first_link.shape[0] - 1):
        tangent_error(rig, avatar, s.target_before, scratch_out.target, target_motion)
        speed = largest(target_motion, avatars.first_dof[avatar], avatars.first_dof[avatar + 1]) / dt
        tracking.speed[avatar] = max(speed, keeps * tracking.speed[avatar])
        # a body that one avatar sets free another may hold, so the fastest of an island speaks for all of it
        first = tracking.island[avatar]
        tracking.speed[first] = max(tracking.speed[first], tracking.speed[avatar])
    for avatar in range(avatars.first_link.shape[0] - 1):
        tracking.speed[avatar] = tracking.speed[tracking.island[avatar]]
        tracking.ease[avatar] = min(1.0, tracking.ease[avatar] + dt / settings.settle_time)
        fastest = min(AT_REST, max(least, tracking.speed[avatar])) * tracking.ease[avatar]
        if tracking.is_legal[avatar] > 0:
            open_budget(rig, avatar, settings, dt, fastest, target_motion, target_motion, s.budget)
        else:
            tangent_error(rig, avatar, s.tracker_before, tracker, tracker_motion)
            drop_whole_turns(rig, avatar, tracker_motion)
            open_budget(rig, avatar, settings, dt, fastest, tracker_motion, target_motion, s.budget)
        copy_posture(rig, avatar, scratch_out.target, s.target_before)
        copy_posture(rig, avatar, tracker, s.tracker_before)
        tracking.is_located[avatar] = 0
