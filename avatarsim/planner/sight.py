"""Sight: is the straight motion from one posture to another certified, with all else where it stands?"""

from avatarsim.ik.certify import certify
from avatarsim.ik.kinematics import tangent_error, try_step
from avatarsim.ik.sqp_step import work_done
from avatarsim.ik.state import Avatars, IkScratch, IkState
from avatarsim.jit.kernel import kernel
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton


@kernel
def is_in_sight(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, m: int, posture: Posture, poses: Poses,
    state_out: IkState, scratch_out: IkScratch,
) -> bool:
    """Whether the straight motion of member m, the only active one, to its target is certified; not so once the work of the frame
    is spent. The trial is left there."""
    s = scratch_out
    avatar = s.members[m]
    if work_done(s) >= settings.work:
        return False
    # what is known of the shown state is of the last step
    state_out.pairs.step[0] += 1
    tangent_error(skel, avatars, avatar, posture, s.target, s.step)
    try_step(geo, skel, avatars, avatar, posture, s)
    state_out.tracking.is_certified[avatar] = 0
    return certify(geo, skel, avatars, settings, posture, poses, m, m + 1, False, False, state_out, s) == 0
