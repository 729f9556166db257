"""Whether anything turns against anything in the avatars, or in one of them."""

from avatarsim.kernel import kernel
from avatarsim.world.geometry import Index
from avatarsim.world.skeleton import FREE, Skeleton


@kernel
def has_joints(skel: Skeleton) -> bool:
    """Whether there is a joint that is no free root."""
    for link in range(skel.kind.shape[0]):
        if is_joint(skel, link):
            return True
    return False


@kernel
def has_joints_of_its_own(skel: Skeleton, root: int, roots: Index) -> bool:
    """Whether the avatar that begins at link `root` has a joint that is no free root; roots (nl) of each link's tree."""
    for link in range(root, skel.kind.shape[0]):
        if roots[link] == root and is_joint(skel, link):
            return True
    return False


@kernel
def is_joint(skel: Skeleton, link: int) -> bool:
    """Whether a link turns against its parent."""
    return bool(skel.kind[link] != FREE and skel.first_dof[link + 1] > skel.first_dof[link])
