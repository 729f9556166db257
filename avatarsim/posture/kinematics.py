"""Forward kinematics: from a posture and a step in its tangent space to poses of all links."""

from avatarsim.kernel import kernel
from avatarsim.spatial.tangent import about, columns, product, put_columns, stepped, straightened, turned
from avatarsim.spatial.vec3 import Rows, add, put_row, row
from avatarsim.world.geometry import Geometry, Poses, place
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def forward(geo: Geometry, skel: Skeleton, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows) -> None:
    """Poses of all links at `posture` displaced by `step` (nd), shapes and all; world axes (nd, 3) of every degree of freedom."""
    carry(skel, posture, step, poses_out, axes_out)
    for link in range(skel.kind.shape[0]):
        place(geo, poses_out, skel.first + link)


@kernel
def carry(skel: Skeleton, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows) -> None:
    """The same of positions, rotations and axes alone: a hand of many pieces takes most of its time for their vertices.

    Hinge: angle + step. Ball and root: R exp(step), the step in the link's own axes. Root position: + step.
    """
    for link in range(skel.kind.shape[0]):
        d, kind, parent = skel.first_dof[link], skel.kind[link], skel.parent[link]
        if kind == FREE:
            origin = (posture.root[link, 0] + step[d], posture.root[link, 1] + step[d + 1], posture.root[link, 2] + step[d + 2])
            frame = stepped(columns(posture.turn, link), (step[d + 3], step[d + 4], step[d + 5]))
            for i in range(3):
                for k in range(3):
                    axes_out[d + i, k] = 1.0 if i == k else 0.0
                put_row(axes_out, d + 3 + i, frame[i])
        else:
            if parent >= 0:
                carrier = columns(poses_out.rotation, skel.first + parent)
                origin = add(row(poses_out.position, skel.first + parent), turned(carrier, row(skel.anchor, link)))
                frame = product(carrier, columns(skel.rest, link))
            else:
                origin, frame = row(skel.anchor, link), columns(skel.rest, link)
            if kind == BALL:
                frame = product(frame, stepped(columns(posture.turn, link), (step[d], step[d + 1], step[d + 2])))
                for i in range(3):
                    put_row(axes_out, d + i, frame[i])
            elif kind == HINGES:
                for j in range(d, skel.first_dof[link + 1]):
                    axis, angle = turned(frame, row(skel.axis, j)), posture.angle[j] + step[j]
                    put_row(axes_out, j, axis)
                    frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        put_row(poses_out.position, skel.first + link, origin)
        put_columns(poses_out.rotation, skel.first + link, frame)


@kernel
def take(skel: Skeleton, posture_out: Posture, step: Rows) -> None:
    """Make posture + step the posture; rotations are straightened, or they would drift apart over the frames."""
    for link in range(skel.kind.shape[0]):
        d, kind = skel.first_dof[link], skel.kind[link]
        if kind == FREE:
            for k in range(3):
                posture_out.root[link, k] += step[d + k]
            d += 3
        if kind == FREE or kind == BALL:
            frame = stepped(columns(posture_out.turn, link), (step[d], step[d + 1], step[d + 2]))
            put_columns(posture_out.turn, link, straightened(frame))
        elif kind == HINGES:
            for j in range(d, skel.first_dof[link + 1]):
                posture_out.angle[j] = min(max(posture_out.angle[j] + step[j], skel.limits[j, 0]), skel.limits[j, 1])
