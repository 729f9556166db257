"""Progress monitor and supervisor: does the objective of an avatar still fall, and which target does the avatar follow?"""

from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.objective import LOSS_RADIUS, locate, value_of
from avatarsim.ik.state import WAITING, Avatars, IkScratch, IkState, Mode
from avatarsim.kernel import kernel
from avatarsim.settings import IkSettings
from avatarsim.world.geometry import Poses
from avatarsim.world.skeleton import Posture, Skeleton

TRACK, WAIT = int(Mode.TRACK), int(Mode.WAIT)

SLOWEST = 0.1
"""Share of the catch-up speed with which the farthest link origin comes nearer where an avatar makes progress."""


@kernel
def measure_begin(
    skel: Skeleton, avatars: Avatars, settings: IkSettings, posture: Posture, poses: Poses, state_out: IkState,
    scratch_out: IkScratch
) -> None:
    """As a frame begins: the objective of each avatar that was far from its target, towards the target of this frame."""
    t = state_out.tracking
    for avatar in range(avatars.first_link.shape[0] - 1):
        if t.distance[avatar] > settings.near:
            locate(skel, avatars, avatar, state_out.own, t, scratch_out.objective)
            tangent_error(skel, avatars, avatar, posture, scratch_out.target, scratch_out.objective.error)
            t.objective[avatar], _ = value_of(skel, avatars, avatar, state_out, poses, scratch_out.objective)


@kernel
def supervise(
    skel: Skeleton, avatars: Avatars, settings: IkSettings, dt: float, posture: Posture, poses: Poses, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """After the steps of a frame: how far each avatar is from its target, for how long it has come no nearer, and its mode."""
    t = state_out.tracking
    for avatar in range(avatars.first_link.shape[0] - 1):
        was_far = t.distance[avatar] > settings.near
        if t.has_arrived[avatar] > 0:
            t.distance[avatar], t.stalled[avatar], t.mode[avatar] = 0.0, 0.0, TRACK
            continue
        locate(skel, avatars, avatar, state_out.own, t, scratch_out.objective)
        tangent_error(skel, avatars, avatar, posture, scratch_out.target, scratch_out.objective.error)
        value, far = value_of(skel, avatars, avatar, state_out, poses, scratch_out.objective)
        t.distance[avatar] = far
        # what one origin that comes nearer with this speed takes of the objective
        least = SLOWEST * settings.catch_up_move * dt * min(far, LOSS_RADIUS * t.reach[avatar])
        is_stalled = was_far and far > settings.near and t.objective[avatar] - value < least
        t.stalled[avatar] = t.stalled[avatar] + dt if is_stalled else 0.0
        t.mode[avatar] = WAIT if t.stalled[avatar] >= settings.stall_time else TRACK
        if t.mode[avatar] == WAIT:
            scratch_out.counts[WAITING] += 1
