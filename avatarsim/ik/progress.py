"""Progress monitor and supervisor: does the objective of an avatar still fall, and which target does the avatar follow?"""

from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.objective import value_of
from avatarsim.ik.state import WAITING, Avatars, IkScratch, IkState, Mode
from avatarsim.kernel import kernel
from avatarsim.settings import IkSettings
from avatarsim.world.geometry import Poses
from avatarsim.world.skeleton import Posture, Skeleton

TRACK, WAIT = int(Mode.TRACK), int(Mode.WAIT)

FALLS = 2.0 / 3.0
"""Share to which the objective falls where an avatar makes progress: a sixth to a fifth of the distance."""


@kernel
def supervise(
    skel: Skeleton, avatars: Avatars, settings: IkSettings, dt: float, posture: Posture, poses: Poses, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """After the steps of a frame: measure each avatar's objective, count the time for which it has not fallen, and choose the mode."""
    t = state_out.tracking
    for avatar in range(avatars.first_link.shape[0] - 1):
        tangent_error(skel, avatars, avatar, posture, scratch_out.target, scratch_out.objective.error)
        value, far = value_of(skel, avatars, avatar, state_out, poses, scratch_out.objective)
        t.objective[avatar], t.distance[avatar] = value, far
        if far <= settings.near:
            t.mark[avatar], t.stalled[avatar], t.mode[avatar] = value, 0.0, TRACK
            continue
        if value <= FALLS * t.mark[avatar]:
            t.mark[avatar], t.stalled[avatar] = value, 0.0
        else:
            t.mark[avatar] = max(t.mark[avatar], value)
            t.stalled[avatar] += dt
        t.mode[avatar] = WAIT if t.stalled[avatar] >= settings.stall_time else TRACK
        if t.mode[avatar] == WAIT:
            scratch_out.counts[WAITING] += 1
