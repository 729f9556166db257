"""Forward kinematics of one link from its parent's pose, for CCD, without transforming vertices."""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import about, columns, product, put_columns, turned
from avatarsim.spatial.vec3 import Rows, add, put_row, row
from avatarsim.world.geometry import Poses
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def pose_link(skel: Skeleton, posture: Posture, link: int, poses_out: Poses, axes_out: Rows) -> None:
    """Position and rotation of ``link`` in ``poses_out``, and its world axes in ``axes_out``; its parent's pose must be right.

    A ball's axes are the columns of its own frame: three hinges that share a centre. A free root has no joint to turn.
    """
    d, kind, parent, body = skel.first_dof[link], skel.kind[link], skel.parent[link], skel.first + link
    if kind == FREE:
        put_row(poses_out.position, body, row(posture.root, link))
        put_columns(poses_out.rotation, body, columns(posture.turn, link))
        return
    origin, frame = row(skel.anchor, link), columns(skel.rest, link)
    if parent >= 0:
        carrier = columns(poses_out.rotation, skel.first + parent)
        origin = add(row(poses_out.position, skel.first + parent), turned(carrier, origin))
        frame = product(carrier, frame)
    if kind == BALL:
        frame = product(frame, columns(posture.turn, link))
        for k in range(3):
            put_row(axes_out, d + k, frame[k])
    elif kind == HINGES:
        for j in range(d, skel.first_dof[link + 1]):
            axis, angle = turned(frame, row(skel.axis, j)), posture.angle[j]
            put_row(axes_out, j, axis)
            frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
    put_row(poses_out.position, body, origin)
    put_columns(poses_out.rotation, body, frame)
