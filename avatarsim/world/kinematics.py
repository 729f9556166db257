"""Forward kinematics: from a posture and a step in its tangent space to the poses of links.

Tangent space: translation of a free root in the world's axes, rotation vector of roots and balls in the link's own axes (the step
R exp(w)), angles of hinges. World axes are those of the geometric Jacobian (Featherstone 2008, chapter 4).
"""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import about, columns, product, put_columns, stepped, straightened, turned
from avatarsim.spatial.vec3 import Rows, add, put_row, row
from avatarsim.world.geometry import Geometry, Poses, place
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton


@kernel
def forward(geo: Geometry, skel: Skeleton, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows) -> None:
    """Poses of all links at `posture` displaced by `step` (nd), shapes and all; world axes (nd, 3) of every degree of freedom."""
    carry(skel, posture, step, poses_out, axes_out)
    place_links(geo, skel, poses_out)


@kernel
def place_links(geo: Geometry, skel: Skeleton, poses_out: Poses) -> None:
    """Carry the shapes of all links to where `carry` has put these."""
    for link in range(skel.kind.shape[0]):
        place(geo, poses_out, skel.first + link)


@kernel
def carry(skel: Skeleton, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows) -> None:
    """The same of positions, rotations and axes alone: a hand of many pieces takes most of its time for their vertices."""
    carry_links(skel, 0, skel.kind.shape[0], posture, step, poses_out, axes_out)


@kernel
def carry_links(
    skel: Skeleton, first: int, end: int, posture: Posture, step: Rows, poses_out: Poses, axes_out: Rows
) -> None:
    """Positions and rotations of links first .. end - 1, whole avatars, at `posture` displaced by `step` (nd), and axes (nd, 3).

    Hinge: angle + step. Ball and root: R exp(step), the step in the link's own axes. Root position: + step.
    """
    kinds, first_dof, parents, bodies = skel.kind, skel.first_dof, skel.parent, skel.first
    anchors, rests, axis_of = skel.anchor, skel.rest, skel.axis
    turns, roots, angles, positions, rotations = posture.turn, posture.root, posture.angle, poses_out.position, poses_out.rotation
    for link in range(first, end):
        d, kind, parent = first_dof[link], kinds[link], parents[link]
        if kind == FREE:
            origin = (roots[link, 0] + step[d], roots[link, 1] + step[d + 1], roots[link, 2] + step[d + 2])
            frame = stepped(columns(turns, link), (step[d + 3], step[d + 4], step[d + 5]))
            for i in range(3):
                for k in range(3):
                    axes_out[d + i, k] = 1.0 if i == k else 0.0
                put_row(axes_out, d + 3 + i, frame[i])
        else:
            if parent >= 0:
                carrier = columns(rotations, bodies + parent)
                origin = add(row(positions, bodies + parent), turned(carrier, row(anchors, link)))
                frame = product(carrier, columns(rests, link))
            else:
                origin, frame = row(anchors, link), columns(rests, link)
            if kind == BALL:
                frame = product(frame, stepped(columns(turns, link), (step[d], step[d + 1], step[d + 2])))
                for i in range(3):
                    put_row(axes_out, d + i, frame[i])
            elif kind == HINGES:
                for j in range(d, first_dof[link + 1]):
                    axis, angle = turned(frame, row(axis_of, j)), angles[j] + step[j]
                    put_row(axes_out, j, axis)
                    frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        put_row(positions, bodies + link, origin)
        put_columns(rotations, bodies + link, frame)


@kernel
def displace(skel: Skeleton, posture_out: Posture, step: Rows) -> None:
    """Make posture + step the posture, limits or not."""
    displace_links(skel, 0, skel.kind.shape[0], posture_out, step)


@kernel
def displace_links(skel: Skeleton, first: int, end: int, posture_out: Posture, step: Rows) -> None:
    """The same of links first .. end - 1; rotations are straightened, or they would drift apart over the frames."""
    for link in range(first, end):
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
                posture_out.angle[j] += step[j]
