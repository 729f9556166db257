"""Target of a frame: the tracker's posture clipped to the limits of joints, and how it moved since the last frame."""

from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.motion_budget import open_budget
from avatarsim.ik.objective import locate
from avatarsim.ik.state import Avatars, IkScratch, IkState
from avatarsim.kernel import kernel
from avatarsim.posture.limits import LEFT_ALONE, has_cone, inside_cone, surely_inside
from avatarsim.settings import IkSettings
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.geometry import Array
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton

AT_REST = 0.06
"""[rad/s or m/s] a target that moves slower rests: a millimetre in a frame of 1/60 s, what a hand that is held still trembles."""


@kernel
def clip_to_limits(skel: Skeleton, tracker: Posture, target_out: Posture) -> None:
    """The tracker's posture with each joint at the nearest place inside its own limits."""
    for link in range(skel.kind.shape[0]):
        kind = skel.kind[link]
        put_row(target_out.root, link, row(tracker.root, link))
        turn = columns(tracker.turn, link)
        if kind == BALL and has_cone(skel, link) and not surely_inside(skel, link, turn, LEFT_ALONE):
            turn = inside_cone(skel, link, turn)
        put_columns(target_out.turn, link, turn)
        if kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                target_out.angle[j] = min(max(tracker.angle[j], skel.limits[j, 0]), skel.limits[j, 1])


@kernel
def copy_posture(skel: Skeleton, avatars: Avatars, avatar: int, posture: Posture, posture_out: Posture) -> None:
    """Copy the posture of one avatar."""
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
    """Largest absolute value of those from first to last."""
    most = 0.0
    for j in range(first, last):
        most = max(most, abs(values[j]))
    return most


@kernel
def meet_target(
    skel: Skeleton, avatars: Avatars, settings: IkSettings, dt: float, has_changed: bool, state_out: IkState, scratch_out: IkScratch
) -> None:
    """Open the budgets of a frame from how far the clipped target went since the last one.

    has_changed: whether a body that is no link moved."""
    s, tracking = state_out, state_out.tracking
    own = scratch_out.objective.error
    for avatar in range(avatars.first_link.shape[0] - 1):
        tangent_error(skel, avatars, avatar, s.before, scratch_out.target, own)
        locate(skel, avatars, avatar, scratch_out.target, scratch_out.objective)
        moved = largest(own, avatars.first_dof[avatar], avatars.first_dof[avatar + 1])
        tracking.speed[avatar] = moved
        rests = moved < AT_REST * dt and not has_changed
        tracking.rest[avatar] = tracking.rest[avatar] + dt if rests else 0.0
        open_budget(
            skel, avatars, avatar, settings, dt, tracking.rest[avatar], own, s.origin, scratch_out.objective.origin, s.budget
        )
        copy_posture(skel, avatars, avatar, scratch_out.target, s.before)
        for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
            put_row(s.origin, link, row(scratch_out.objective.origin, link))
