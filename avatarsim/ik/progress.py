"""Progress monitor: does the objective of an avatar that is far from its target still fall?"""

from avatarsim.ik.objective import LOSS_RADIUS, value_of
from avatarsim.ik.state import Avatars, IkScratch, IkState
from avatarsim.jit.kernel import kernel
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Poses
from avatarsim.world.skeleton import Skeleton

SLOWEST = 0.25
"""Share of the catch-up speed with which all link origins come nearer where an avatar makes progress."""

FALLEN = 1.0 / 3.0
"""Or share of itself by which the objective falls within the stall time: near the target most origins are there already."""


@kernel
def measure(
    skel: Skeleton, avatars: Avatars, avatar: int, settings: PostureSettings, dt: float, poses: Poses, state_out: IkState,
    scratch: IkScratch,
) -> float:
    """After the steps of a frame of dt [s], with the error to the target at hand: how far the avatar is from it, and for how
    long the objective has not fallen as it must; the objective.

    It is compared with what it was a stall time before at most, as the frames ended: what is lost again to a target that walks on
    is no progress."""
    t = state_out.tracking
    value, far = value_of(skel, avatars, avatar, state_out, poses, scratch.objective)
    t.distance[avatar] = far
    t.since[avatar] += dt
    links = avatars.first_link[avatar + 1] - avatars.first_link[avatar]
    # what origins beyond the loss radius that come nearer with this speed take of the objective
    least = SLOWEST * settings.catch_up_move * links * LOSS_RADIUS * t.reach[avatar]
    least = min(least, FALLEN * t.objective[avatar] / settings.stall_time) * t.since[avatar]
    if far <= settings.near or t.objective[avatar] - value >= least:
        t.stalled[avatar], t.since[avatar], t.objective[avatar] = 0.0, 0.0, value
    elif t.since[avatar] >= settings.stall_time:
        t.stalled[avatar] += t.since[avatar]
        t.since[avatar], t.objective[avatar] = 0.0, value
    return value
