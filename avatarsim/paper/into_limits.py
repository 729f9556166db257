"""Projection of an interpolated posture into the joint limits."""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.world.limits import has_cone, inside_cone
from avatarsim.world.skeleton import BALL, HINGES, Posture, Skeleton


@kernel
def into_limits(skel: Skeleton, posture_out: Posture) -> None:
    """Clip every hinge and project every ball.

    Between two angles inside an interval all are inside; between two rotations inside a wide swing cone the great circle may
    leave it, by more than a radian.
    """
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = min(max(posture_out.angle[j], skel.limits[j, 0]), skel.limits[j, 1])
        elif skel.kind[link] == BALL and has_cone(skel, link):
            put_columns(posture_out.turn, link, inside_cone(skel, link, columns(posture_out.turn, link)))
