"""Whether anything turns against anything in the avatars."""

from avatarsim.kernel import kernel
from avatarsim.world.skeleton import FREE, Skeleton


@kernel
def has_joints(skel: Skeleton) -> bool:
    """Whether there is a joint that is no free root."""
    rates = 0
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] != FREE:
            rates += skel.first_dof[link + 1] - skel.first_dof[link]
    return rates > 0
